! blocks.f90 - a small explicit code that hosts an interface law, in Fortran 2008.
!
! Blocks on springs slide on a floor (z up): central differences with a lumped mass matrix, and at each step
! the law's impulse. The last block hangs in the air and is no interface node. Usage: blocks_fortran LIBRARY
! blocks.c is the same host in C and prints the same bits.
!
! SPDX-License-Identifier: BSD-3-Clause
program blocks
  use, intrinsic :: iso_c_binding
  use, intrinsic :: iso_fortran_env, only: error_unit
  use ilaw
  implicit none
  integer, parameter :: blocks_count = 7, steps = 3000
  real(c_double), parameter :: h = 1e-3_c_double, gravity(3) = [0._c_double, 0._c_double, -10._c_double]
  real(c_double), parameter :: mass(blocks_count) = &
    real([1d0, 2.5d0, 0.7d0, 2d0, 1.5d0, 1d0, 0.8d0], c_double)
  real(c_double), parameter :: stiffness(blocks_count) = &
    real([0d0, 0d0, 0d0, 50d0, 20d0, 100d0, 30d0], c_double)
  integer(c_int32_t), target :: floor_nodes(6) = [1, 2, 3, 4, 5, 6]
  real(c_double), target :: up(3) = real([0, 0, 1], c_double)
  real(c_double), target :: u(3, blocks_count) = 0, v(3, blocks_count) = 0, v_previous(3, blocks_count)
  real(c_double), target :: impulse(3, blocks_count) = 0, energy(ILAW_ENERGY_COUNT, blocks_count) = 0
  real(c_double), target :: inverse_mass(blocks_count)
  integer(c_int8_t), target :: status(blocks_count) = 0
  real(c_double), allocatable, target :: state(:, :)
  type(c_ptr) :: interface
  type(ilaw_instance_info) :: info
  type(ilaw_batch) :: batch
  type(ilaw_report) :: report
  real(c_double) :: force(3, blocks_count), friction_work(blocks_count) = 0
  integer :: n, i

  u(3, 3) = 0.05d0; u(:, 4) = [0.4d0, -0.3d0, 0d0]; u(:, 5) = [0.06d0, 0.08d0, 0d0]
  u(:, 6) = [-0.24d0, 0.32d0, 0d0]; u(3, 7) = 0.1d0
  v(:, 1) = [0.72d0, 0.96d0, 0d0]; v(:, 2) = [-1.6d0, 1.2d0, 0d0]; v(:, 3) = [1.8d0, 2.4d0, 0d0]
  inverse_mass = 1/mass

  call create_interface()
  if (ilaw_interface_info(interface, info) /= ILAW_OK) call fail('info', 'refused')
  allocate (state(info%state_size, blocks_count), source=0._c_double)
  call describe_batch()
  if (ilaw_interface_initialise(interface, batch, report) /= ILAW_OK) &
    call fail('initialise', ilaw_text(report%reason))
  call kick_with_law(0._c_double, 0.5d0*h) ! V_1/2
  do n = 0, steps - 1
    u = u + h*v
    call kick_with_law((n + 1)*h, h)
  end do
  do i = 1, blocks_count
    write (*, '(i2,4(1x,es24.16e2),1x,i2)') i - 1, u(:, i), friction_work(i), status(i)
  end do
  deallocate (state)
  call ilaw_interface_destroy(interface)

contains

  subroutine create_interface()
    character(512) :: library_name, message
    type(c_ptr) :: library
    type(ilaw_setup) :: setup
    type(ilaw_values) :: values

    if (command_argument_count() /= 1) call fail('usage', 'blocks_fortran LIBRARY')
    call get_command_argument(1, library_name)
    if (ilaw_open(library_name, library, message) /= ILAW_OK) call fail('open', message)
    setup%dimension = 3
    setup%delassus_form = ILAW_DELASSUS_SCALAR
    setup%frame = ILAW_FRAME_GLOBAL
    call values%set('friction', 0.3_c_double)
    call values%set('activation', 'predictive')
    if (ilaw_create(library, '', setup, values, interface, message) /= ILAW_OK) call fail('create', message)
    call ilaw_library_close(library) ! the interface keeps it loaded
  end subroutine

  subroutine describe_batch()
    integer(c_int32_t), parameter :: given = ior(ior(ILAW_INPUT_GAP, ILAW_INPUT_V_PREVIOUS), ILAW_INPUT_NORMAL)
    if (iand(ior(info%inputs, info%balance_inputs), not(given)) /= 0) &
      call fail('law', 'reads an input that this code does not have')
    call ilaw_use_nodes(batch, floor_nodes) ! the arrays below are the solver's own, over all its nodes
    batch%position_step = h
    batch%v_free = ilaw_input_of(v)
    batch%delassus = ilaw_input_of(inverse_mass)
    batch%gap = ilaw_input_of(u(3, :)) ! height over the floor: a component of u, in place
    batch%v_previous = ilaw_input_of(v_previous)
    batch%normal = ilaw_uniform(up) ! the same at every node
    batch%state_in = ilaw_input_of(state)
    batch%state_out = ilaw_output_of(state)
    batch%impulse = ilaw_output_of(impulse)
    batch%energy = ilaw_output_of(energy)
    batch%status = c_loc(status)
    batch%status_stride = 1
  end subroutine

  ! A kick by all forces, then the impulse of the law. impulse and energy stay 0 outside floor_nodes.
  subroutine kick_with_law(time, duration)
    real(c_double), intent(in) :: time, duration
    call sum_forces()
    v_previous = v
    call kick(duration) ! v is v_free now

    batch%time = time
    batch%velocity_step = duration
    if (ilaw_interface_evaluate(interface, batch, report) /= ILAW_OK) &
      call fail('evaluate', ilaw_text(report%reason))

    v = v + spread(inverse_mass, 1, 3)*impulse
    friction_work = friction_work + energy(1 + ILAW_ENERGY_FRICTION, :)
  end subroutine

  subroutine sum_forces()
    force = spread(gravity, 2, blocks_count)*spread(mass, 1, 3) - spread(stiffness, 1, 3)*u
  end subroutine

  subroutine kick(duration)
    real(c_double), intent(in) :: duration
    v = v + duration*spread(inverse_mass, 1, 3)*force
  end subroutine

  subroutine fail(what, why)
    character(*), intent(in) :: what, why
    write (error_unit, '(4a)') 'blocks_fortran: ', trim(what), ': ', trim(why)
    stop 1
  end subroutine
end program blocks
