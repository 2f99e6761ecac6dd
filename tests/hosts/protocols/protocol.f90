! protocol.f90 - a host in Fortran 2008 for the protocols of ilaw.protocols: one point against the plane z = 0.
!
! Usage: protocol_fortran FILE. Prints displacement, velocity and the sum of the impulses.
!
! SPDX-License-Identifier: BSD-3-Clause
program protocol
  use, intrinsic :: iso_c_binding
  use, intrinsic :: iso_fortran_env, only: error_unit, iostat_end
  use ilaw
  implicit none
  character(64) :: law, names(16)
  real(c_double) :: values(16), h, position(3), v(3), stiffness(3), force(3), wall(3)
  real(c_double) :: u(3) = 0, total(3) = 0
  real(c_double), target :: v_free(3, 1), v_before(3, 1), gap(1), impulse(3, 1), inverse_mass(1), area(1)
  real(c_double), target :: normal(3, 1) = reshape(real([0, 0, 1], c_double), [3, 1])
  real(c_double), allocatable, target :: state(:, :)
  integer :: parameters = 0, steps, restart, n
  type(c_ptr) :: interface
  type(ilaw_instance_info) :: info
  type(ilaw_batch) :: batch
  type(ilaw_report) :: report

  call read_protocol()
  call create_interface()
  if (ilaw_interface_info(interface, info) /= ILAW_OK) call fail('info', 'refused')
  allocate (state(info%state_size, 1), source=0._c_double)
  batch%node_count = 1
  batch%position_step = h
  batch%v_free = ilaw_input_of(v_free)
  batch%delassus = ilaw_input_of(inverse_mass)
  batch%gap = ilaw_input_of(gap)
  batch%v_previous = ilaw_input_of(v_before)
  batch%area = ilaw_input_of(area)
  batch%normal = ilaw_input_of(normal)
  batch%state_in = ilaw_input_of(state)
  batch%state_out = ilaw_output_of(state)
  batch%impulse = ilaw_output_of(impulse)
  if (ilaw_interface_initialise(interface, batch, report) /= ILAW_OK) &
    call fail('initialise', ilaw_text(report%reason))
  call kick(0._c_double, 0.5d0*h)
  do n = 1, steps
    u = u + h*v
    call kick(n*h, h)
    if (n == restart) then ! the state is all that an instance leaves
      call ilaw_interface_destroy(interface)
      call create_interface()
    end if
  end do
  write (*, '(es24.16e3)') u, v, total
  deallocate (state)
  call ilaw_interface_destroy(interface)

contains

  subroutine kick(time, duration)
    real(c_double), intent(in) :: time, duration
    v_before(:, 1) = v - wall
    v = v + duration*inverse_mass(1)*(force - stiffness*u)
    v_free(:, 1) = v - wall
    gap = position(3) + u(3) - time*wall(3)
    batch%time = time
    batch%velocity_step = duration
    if (ilaw_interface_evaluate(interface, batch, report) /= ILAW_OK) &
      call fail('evaluate', ilaw_text(report%reason))
    v = v + inverse_mass(1)*impulse(:, 1)
    total = total + impulse(:, 1)
  end subroutine

  subroutine create_interface()
    character(512) :: message
    type(c_ptr) :: library
    type(ilaw_setup) :: setup
    type(ilaw_values) :: given
    integer :: k
    if (ilaw_open(law, library, message) /= ILAW_OK) call fail('open', message)
    setup%dimension = 3
    setup%delassus_form = ILAW_DELASSUS_SCALAR
    setup%frame = ILAW_FRAME_GLOBAL
    do k = 1, parameters
      call given%set(trim(names(k)), values(k))
    end do
    if (ilaw_create(library, '', setup, given, interface, message) /= ILAW_OK) call fail('create', message)
    call ilaw_library_close(library)
  end subroutine

  subroutine read_protocol()
    character(512) :: path
    character(256) :: line
    character(64) :: name
    integer :: unit, status
    real(c_double) :: mass
    if (command_argument_count() /= 1) call fail('usage', 'protocol_fortran FILE')
    call get_command_argument(1, path)
    open (newunit=unit, file=path, status='old', action='read', iostat=status)
    if (status /= 0) call fail(path, 'cannot be opened')
    do
      read (unit, '(a)', iostat=status) line
      if (status == iostat_end) exit
      read (line, *) name
      line = line(len_trim(name) + 1:)
      select case (name)
      case ('law'); read (line, *) law
      case ('parameter')
        parameters = parameters + 1
        read (line, *) names(parameters), values(parameters)
      case ('mass'); read (line, *) mass
      case ('area'); read (line, *) area
      case ('step'); read (line, *) h
      case ('steps'); read (line, *) steps
      case ('restart'); read (line, *) restart
      case ('position'); read (line, *) position
      case ('velocity'); read (line, *) v
      case ('stiffness'); read (line, *) stiffness
      case ('force'); read (line, *) force
      case ('wall'); read (line, *) wall
      case default; call fail(name, 'not known')
      end select
    end do
    close (unit)
    inverse_mass = 1/mass
  end subroutine

  subroutine fail(what, why)
    character(*), intent(in) :: what, why
    write (error_unit, '(4a)') 'protocol_fortran: ', trim(what), ': ', trim(why)
    stop 1
  end subroutine
end program protocol
