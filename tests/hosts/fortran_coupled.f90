! fortran_coupled.f90 - coupled contacts from Fortran: a column of spheres at rest, and a sphere that slides. Exits
! with 1 if they do not have their closed forms.
! SPDX-License-Identifier: BSD-3-Clause
program fortran_coupled
  use, intrinsic :: iso_c_binding
  use ilaw
  use ilaw_coupled
  implicit none
  integer, parameter :: dp = c_double, most = 8
  real(dp), parameter :: h = 1e-3_dp, g = 10, radius = 0.5_dp
  real(dp) :: r(3, most), v(3, most), w(3, most)
  integer :: k

  ! Masses 1, 2, ..., 8 from the floor up: contact k carries the weight of k to 8, and nothing moves.
  call step(most, 0._dp, 0.3_dp)
  call expect(all(abs(r(3, :) - [(0.5_dp*(k + most)*(most - k + 1)*g*h, k=1, most)]) <= 1e-11_dp), 'weights')
  call expect(maxval(abs(v)) <= 1e-13_dp .and. maxval(abs(w)) <= 1e-13_dp, 'rest')
  ! A sphere of mass 1 that slides: mu m g h against it, which also turns it by R mu m g h/J.
  call step(1, 2._dp, 0.1_dp)
  call expect(abs(r(1, 1) + 1e-3_dp) <= 1e-16_dp .and. abs(v(1, 1) - 2 + 1e-3_dp) <= 1e-15_dp, 'friction')
  call expect(abs(w(2, 1) - 0.5_dp*1e-3_dp/0.1_dp) <= 1e-15_dp, 'spin')

contains

  subroutine expect(is_so, what)
    logical, intent(in) :: is_so
    character(*), intent(in) :: what
    if (is_so) return
    print '(a)', what
    stop 1
  end subroutine

  ! Spheres of masses 1, 2, ... on each other, the first on the floor; one step of their weight. slide: velocity
  ! of the first before the step. Leaves impulses of the contacts from the floor up, velocities and spins.
  subroutine step(count, slide, mu)
    integer, intent(in) :: count
    real(dp), intent(in) :: slide, mu
    real(dp), target :: impulse(3, count), velocity(3, count), spin(3, count)
    real(dp), target :: inverse_mass(count), inverse_inertia(count), before(3, count), still(3, count)
    real(dp), target :: up(3), down(3), over(3), gap(1), state(0, count)
    integer(c_int32_t), target :: body(count), counterpart(count)
    integer(c_int32_t), target :: calls ! of the exchange, which alone has its address
    type(c_ptr) :: interface, solver
    type(ilaw_batch), target :: batch
    type(ilaw_bodies) :: bodies
    type(ilaw_contacts) :: contacts
    type(ilaw_coupled_options) :: options
    type(ilaw_coupled_report) :: report
    type(ilaw_exchange), target :: alone
    integer :: i

    interface = created(mu)
    up = [0, 0, 1]; down = -radius*up; over = radius*up; gap = 0
    body = [(i, i=1, count)]
    counterpart = body - 1_c_int32_t ! 0: the floor
    inverse_mass = 1/real(body, dp)
    inverse_inertia = 2.5_dp*inverse_mass/radius**2
    velocity = 0; spin = 0; still = 0; impulse = 0
    velocity(1, 1) = slide
    before = velocity
    velocity(3, :) = velocity(3, :) - h*g

    bodies%dimension = 3
    bodies%count = count
    bodies%owned_count = count
    bodies%inverse_mass = ilaw_input_of(inverse_mass)
    bodies%inverse_inertia = ilaw_input_of(inverse_inertia) ! one value each: spheres
    bodies%v_free = ilaw_input_of(velocity)
    bodies%spin_free = ilaw_input_of(spin)
    bodies%v_previous = ilaw_input_of(before)
    bodies%spin_previous = ilaw_input_of(still)
    bodies%velocity = ilaw_output_of(velocity)
    bodies%spin = ilaw_output_of(spin)

    batch%node_count = count
    batch%velocity_step = h
    batch%position_step = h
    batch%gap = ilaw_uniform(gap)
    batch%normal = ilaw_uniform(up)
    batch%state_in = ilaw_input_of(state)
    batch%state_out = ilaw_output_of(state)
    batch%impulse = ilaw_output_of(impulse)
    contacts = ilaw_contacts_of(interface, ILAW_DELASSUS_FULL, batch, body, counterpart)
    contacts%arm = ilaw_uniform(down)
    contacts%counterpart_arm = ilaw_uniform(over)
    options%most_sweeps = 20000
    options%tolerance = 1e-14_dp
    alone%sum_bodies = c_funloc(agree); alone%largest = c_funloc(agree); alone%sum = c_funloc(agree)
    alone%context = c_loc(calls)
    calls = 0
    options%exchange = c_loc(alone)
    solver = ilaw_coupled_create()
    call expect(ilaw_solve(solver, bodies, [contacts], options, report) == ILAW_OK, ilaw_text(report%reason))
    call expect(report%residual <= 1e-14_dp .and. calls > 0, 'residual, and an exchange')
    call ilaw_coupled_destroy(solver)
    call ilaw_interface_destroy(interface)
    r(:, :count) = impulse
    v(:, :count) = velocity
    w(:, :count) = spin
  end subroutine

  ! One rank agrees with itself, and counts how often it is asked.
  subroutine agree(context, values, count) bind(c)
    type(c_ptr), value :: context
    real(c_double), intent(inout) :: values(*)
    integer(c_int64_t), value :: count
    integer(c_int32_t), pointer :: calls
    call c_f_pointer(context, calls)
    if (count > 0) calls = calls + 1
    if (count < 0) values(1) = 0
  end subroutine

  type(c_ptr) function created(mu) result(interface)
    real(dp), intent(in) :: mu
    character(256) :: message
    type(c_ptr) :: library
    type(ilaw_setup) :: setup
    type(ilaw_values) :: values
    call expect(ilaw_open('coulomb', library, message) == ILAW_OK, message)
    setup%dimension = 3
    setup%delassus_form = ILAW_DELASSUS_FULL
    setup%frame = ILAW_FRAME_GLOBAL
    call values%set('friction', mu)
    call expect(ilaw_create(library, '', setup, values, interface, message) == ILAW_OK, message)
    call ilaw_library_close(library)
  end function
end program fortran_coupled
