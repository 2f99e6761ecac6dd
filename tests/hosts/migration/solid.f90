! solid.f90 - an explicit code for a plane block, as such codes are: 4-node quadrilaterals, St. Venant-Kirchhoff,
! total Lagrange, lumped mass, central differences with a variable step. The block slides on a floor against a
! cylinder; contact is a penalty with regularized Coulomb friction. Usage: solid NX CFL T_END STIFFNESS
! SPDX-License-Identifier: BSD-3-Clause
module block_model
  implicit none
  integer, parameter :: dp = kind(1d0)
  real(dp), parameter :: width = 1, height = 0.5_dp, young = 1e7_dp, poisson = 0.3_dp, density = 1000
  real(dp), parameter :: gravity(2) = [0._dp, -10._dp], velocity_0(2) = [2._dp, 0._dp], friction = 0.3_dp
  real(dp), parameter :: center(2) = [1.4_dp, 0.3_dp], radius = 0.3_dp ! of the cylinder
  integer :: node_count, element_count
  integer, allocatable :: element(:, :), floor_nodes(:), cylinder_nodes(:)
  real(dp), allocatable :: x_0(:, :), u(:, :), v(:, :), v_before(:, :), f(:, :), mass(:), area(:)
  real(dp) :: lambda, mu, wave_speed
contains
  subroutine make_block(nx)
    integer, intent(in) :: nx
    integer :: ny, i, j, k, e
    real(dp) :: dx, dy
    ny = nx/2
    dx = width/nx
    dy = height/ny
    node_count = (nx + 1)*(ny + 1)
    element_count = nx*ny
    allocate (element(4, element_count), x_0(2, node_count))
    allocate (mass(node_count), area(node_count), source=0._dp)
    allocate (u(2, node_count), v(2, node_count), v_before(2, node_count), f(2, node_count), source=0._dp)
    do j = 0, ny
      do i = 0, nx
        x_0(:, 1 + i + j*(nx + 1)) = [i*dx, j*dy]
      end do
    end do
    do j = 1, ny
      do i = 1, nx
        e = i + (j - 1)*nx
        k = i + (j - 1)*(nx + 1)
        element(:, e) = [k, k + 1, k + nx + 2, k + nx + 1]
        mass(element(:, e)) = mass(element(:, e)) + density*dx*dy/4
      end do
    end do
    floor_nodes = [(i, i=1, nx + 1)]
    cylinder_nodes = [((j + 1)*(nx + 1), j=1, ny)] ! the right side but its corner, which is on the floor
    area(floor_nodes) = dx
    area([1, nx + 1]) = dx/2
    area(cylinder_nodes) = dy
    area((ny + 1)*(nx + 1)) = dy/2
    lambda = young*poisson/((1 + poisson)*(1 - 2*poisson))
    mu = young/(2*(1 + poisson))
    wave_speed = sqrt((lambda + 2*mu)/density)
  end subroutine

  ! f = -f_int: 2 x 2 points, P = F S, S = lambda tr(E) I + 2 mu E.
  subroutine sum_forces()
    real(dp), parameter :: g = 1/sqrt(3._dp), xi(4) = [-g, g, g, -g], eta(4) = [-g, -g, g, g]
    real(dp), parameter :: sx(4) = [-1, 1, 1, -1], sy(4) = [-1, -1, 1, 1]
    real(dp), parameter :: identity(2, 2) = reshape([1._dp, 0._dp, 0._dp, 1._dp], [2, 2])
    real(dp) :: dn(2, 4), jac(2, 2), inverse(2, 2), det, grad(2, 2), strain(2, 2), stress(2, 2)
    integer :: e, p
    f = 0
    do e = 1, element_count
      do p = 1, 4
        dn(1, :) = sx*(1 + sy*eta(p))/4
        dn(2, :) = sy*(1 + sx*xi(p))/4
        jac = matmul(dn, transpose(x_0(:, element(:, e))))
        det = jac(1, 1)*jac(2, 2) - jac(1, 2)*jac(2, 1)
        inverse = reshape([jac(2, 2), -jac(2, 1), -jac(1, 2), jac(1, 1)], [2, 2])/det
        dn = matmul(inverse, dn)
        grad = identity + matmul(u(:, element(:, e)), transpose(dn))
        strain = (matmul(transpose(grad), grad) - identity)/2
        stress = lambda*(strain(1, 1) + strain(2, 2))*identity + 2*mu*strain
        f(:, element(:, e)) = f(:, element(:, e)) - det*matmul(matmul(grad, stress), dn)
      end do
    end do
  end subroutine

  ! The smallest edge over the wave speed.
  real(dp) function critical_step()
    integer :: e, k
    real(dp) :: edge(2), least
    least = huge(1._dp)
    do e = 1, element_count
      do k = 1, 4
        edge = position_of(element(modulo(k, 4) + 1, e)) - position_of(element(k, e))
        least = min(least, sqrt(sum(edge**2)))
      end do
    end do
    critical_step = least/wave_speed
  end function

  function position_of(node) result(x)
    integer, intent(in) :: node
    real(dp) :: x(2)
    x = x_0(:, node) + u(:, node)
  end function

  subroutine meet_floor(node, gap, normal)
    integer, intent(in) :: node
    real(dp), intent(out) :: gap, normal(2)
    gap = x_0(2, node) + u(2, node)
    normal = [0._dp, 1._dp]
  end subroutine

  subroutine meet_cylinder(node, gap, normal)
    integer, intent(in) :: node
    real(dp), intent(out) :: gap, normal(2)
    real(dp) :: d(2)
    d = position_of(node) - center
    gap = sqrt(sum(d**2)) - radius
    normal = d/(gap + radius)
  end subroutine
end module

program solid
  use block_model
  implicit none
  integer :: nx, step, k
  real(dp) :: cfl, t_end, stiffness, t, h, h_next, h_mid, work
  real(dp), allocatable :: contact(:, :)
  character(256) :: text
  call get_command_argument(1, text); read (text, *) nx
  call get_command_argument(2, text); read (text, *) cfl
  call get_command_argument(3, text); read (text, *) t_end
  call get_command_argument(4, text); read (text, *) stiffness
  call make_block(nx)
  allocate (contact(2, node_count))
  v = spread(velocity_0, 2, node_count)
  step = 0
  t = 0
  work = 0
  h = next_step()
  call sum_forces()
  v_before = v
  call add_contact()
  call kick(h/2)
  do while (t < t_end*(1 - 1d-12))
    u = u + h*v
    t = t + h
    h_next = next_step()
    h_mid = (h + h_next)/2
    call sum_forces()
    v_before = v
    call add_contact()
    call kick(h_mid)
    work = work + h_mid*sum(contact*(v_before + v)/2)
    h = h_next
    step = step + 1
  end do
  print '(a,i0)', 'steps ', step
  print '(a,es12.4,a,es12.4)', 'floor penetration ', deepest(floor_nodes, meet_floor), ' cylinder ', &
    deepest(cylinder_nodes, meet_cylinder)
  print '(a,2es24.16,a,es24.16)', 'velocity ', matmul(v, mass)/sum(mass), ' at time ', t + h/2
  print '(a,es24.16)', 'work of contact ', work
contains
  real(dp) function next_step()
    ! of the mesh, and of a node of the floor on its spring
    next_step = min(cfl*critical_step(), cfl*sqrt(2*minval(mass)/(stiffness*width/nx)), t_end - t)
    if (next_step <= 0) next_step = cfl*critical_step()
  end function
  subroutine kick(span)
    real(dp), intent(in) :: span
    do k = 1, node_count
      v(:, k) = v(:, k) + span*(f(:, k)/mass(k) + gravity)
    end do
  end subroutine
  subroutine add_contact()
    contact = 0
    call push(floor_nodes, meet_floor)
    call push(cylinder_nodes, meet_cylinder)
    f = f + contact
  end subroutine
  subroutine push(nodes, meet)
    integer, intent(in) :: nodes(:)
    procedure(meet_floor) :: meet
    real(dp), parameter :: slow = 1e-3_dp
    real(dp) :: gap, n(2), tangent(2), pressing, slip
    integer :: i
    do i = 1, size(nodes)
      call meet(nodes(i), gap, n)
      if (gap >= 0) cycle
      pressing = -stiffness*area(nodes(i))*gap
      tangent = [-n(2), n(1)]
      slip = sum(tangent*v_before(:, nodes(i)))
      contact(:, nodes(i)) = contact(:, nodes(i)) + pressing*n - friction*pressing*slip/max(abs(slip), slow)*tangent
    end do
  end subroutine
  real(dp) function deepest(nodes, meet)
    integer, intent(in) :: nodes(:)
    procedure(meet_floor) :: meet
    real(dp) :: gap, n(2)
    integer :: i
    deepest = 0
    do i = 1, size(nodes)
      call meet(nodes(i), gap, n)
      deepest = max(deepest, -gap)
    end do
  end function
end program
