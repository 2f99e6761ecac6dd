! bar.f90 - an explicit code for an elastic bar that meets a wall, as such codes are: lumped masses, central
! differences, contact by a penalty spring. With the name of a library it takes the law's impulse instead, by
! three calls: create, once, info, once, and evaluate, every step.
! Usage: bar_fortran STEP COUNT [LIBRARY]; a line per step with displacement, half-step velocity and contact
! impulse of the bar's left end. The scene is host_mock/scenes/bar_on_wall.json.
!
! SPDX-License-Identifier: BSD-3-Clause
program bar
  use, intrinsic :: iso_c_binding
  use, intrinsic :: iso_fortran_env, only: error_unit
  use ilaw
  implicit none
  integer, parameter :: dp = c_double, elements = 100
  real(dp), parameter :: young = 900, density = 1, length = 10, start = 5
  real(dp), parameter :: spacing = length/elements, stiffness = young/spacing
  real(dp), parameter :: penalty = 2*stiffness
  real(dp), target :: u(elements + 1) = 0, v(elements + 1) = -10, v_previous(elements + 1)
  real(dp), target :: inverse_mass(elements + 1), gap(1), impulse(1) = 0
  real(dp), allocatable, target :: state(:, :)
  real(dp) :: mass(elements + 1), force(elements + 1), h
  type(c_ptr) :: interface
  type(ilaw_instance_info) :: info
  type(ilaw_batch) :: batch
  type(ilaw_report) :: report
  character(512) :: word
  integer :: n, count
  logical :: by_law

  call get_command_argument(1, word); read (word, *) h
  call get_command_argument(2, word); read (word, *) count
  by_law = command_argument_count() == 3
  mass = density*spacing
  mass(1) = 0.5_dp*mass(1); mass(elements + 1) = mass(1)
  inverse_mass = 1/mass
  if (by_law) call create_interface()

  do n = 1, count
    u = u + h*v
    gap = start + u(1)
    call sum_internal_forces()
    if (.not. by_law) then
      impulse = h*penalty*max(-gap, 0._dp)
      force(1) = force(1) + impulse(1)/h
    end if
    v_previous = v
    v = v + (h*force)*inverse_mass
    if (by_law) then ! v is v_free now
      batch%time = n*h
      if (ilaw_interface_evaluate(interface, batch, report) /= ILAW_OK) &
        call fail('evaluate', ilaw_text(report%reason))
      v(1) = v(1) + inverse_mass(1)*impulse(1)
    end if
    write (*, '(3(1x,es24.16e3))') u(1), v(1), impulse
  end do
  if (by_law) call ilaw_interface_destroy(interface)

contains

  subroutine create_interface()
    character(512) :: library_name, message
    real(dp), save, target :: up(1) = 1
    type(c_ptr) :: library
    type(ilaw_setup) :: setup
    type(ilaw_values) :: values

    call get_command_argument(3, library_name)
    if (ilaw_open(library_name, library, message) /= ILAW_OK) call fail('open', message)
    setup%dimension = 1
    setup%delassus_form = ILAW_DELASSUS_SCALAR
    setup%frame = ILAW_FRAME_LOCAL
    if (ilaw_create(library, '', setup, values, interface, message) /= ILAW_OK) call fail('create', message)
    call ilaw_library_close(library) ! the interface keeps it loaded
    if (ilaw_interface_info(interface, info) /= ILAW_OK) call fail('info', 'refused')
    allocate (state(info%state_size, 1), source=0._dp)
    batch%node_count = 1 ! the first node of the arrays
    batch%velocity_step = h
    batch%position_step = h
    batch%v_free = ilaw_input_of(v)
    batch%delassus = ilaw_input_of(inverse_mass)
    batch%gap = ilaw_input_of(gap)
    batch%v_previous = ilaw_input_of(v_previous)
    batch%normal = ilaw_uniform(up)
    batch%state_in = ilaw_input_of(state)
    batch%state_out = ilaw_output_of(state)
    batch%impulse = ilaw_output_of(impulse)
    if (ilaw_interface_initialise(interface, batch, report) /= ILAW_OK) &
      call fail('initialise', ilaw_text(report%reason))
  end subroutine

  subroutine sum_internal_forces()
    real(dp) :: tension
    integer :: k
    force = 0
    do k = 1, elements
      tension = stiffness*(u(k + 1) - u(k))
      force(k) = force(k) + tension
      force(k + 1) = force(k + 1) - tension
    end do
  end subroutine

  subroutine fail(what, why)
    character(*), intent(in) :: what, why
    write (error_unit, '(4a)') 'bar_fortran: ', trim(what), ': ', trim(why)
    stop 1
  end subroutine
end program bar
