! ilaw_vfric.f90 - friction of Abaqus/Explicit by a law: what vfric.f calls.
!
! Abaqus finds the normal force, and the force that would stop the slip in the increment. So a contact needs no
! mass: the impulse stick*dt stops the predicted slip speed slip/dt, and its inverse mass is
! H = slip/(stick dt**2). The law sees a closed contact whose normal impulse comes out as pressing*dt.
!
! SPDX-License-Identifier: BSD-3-Clause
module ilaw_vfric
  use, intrinsic :: iso_c_binding
  use ilaw
  implicit none
  private
  public :: friction_law, create_friction, friction_forces, ilaw_values

  type :: friction_law
    type(c_ptr) :: interface = c_null_ptr
    integer :: state_size = 0
  end type

contains

  ! message is blank where the law is created.
  subroutine create_friction(name, values, dimension, law, message)
    character(*), intent(in) :: name
    type(ilaw_values), intent(in) :: values
    integer, intent(in) :: dimension
    type(friction_law), intent(out) :: law
    character(*), intent(out) :: message
    integer(c_int32_t), parameter :: given = &
      ior(ior(ILAW_INPUT_GAP, ior(ILAW_INPUT_V_PREVIOUS, ILAW_INPUT_V_SMOOTH)), &
          ior(ILAW_INPUT_NORMAL, ILAW_INPUT_AREA))
    type(c_ptr) :: library
    type(ilaw_setup) :: setup
    type(ilaw_instance_info) :: info
    if (ilaw_open(name, library, message) /= ILAW_OK) return
    setup%dimension = dimension
    setup%delassus_form = ILAW_DELASSUS_SCALAR
    setup%frame = ILAW_FRAME_GLOBAL
    if (ilaw_create(library, '', setup, values, law%interface, message) == ILAW_OK) then
      if (ilaw_interface_info(law%interface, info) /= ILAW_OK) message = 'info refuses the law'
      if (iand(info%inputs, not(given)) /= 0) message = trim(name)//' reads an input that VFRIC does not have'
      law%state_size = int(info%state_size)
    end if
    call ilaw_library_close(library)
  end subroutine

  ! Forces f(:,k) in local axes: along the predicted slip `tangent`, and across it. Each contact gives the slip
  ! of the increment, the force that stops it, the normal force, and memory(:,k): the end of the last increment
  ! in which it touched (0: none), its slip velocity, the state of the law. A contact that begins, or that was
  ! open meanwhile, rests if the law holds it at rest; else the predicted velocity is that before.
  ! message is blank where all is well.
  subroutine friction_forces(law, time, dt, slip, stick, pressing, tangent, normal, area, memory, f, message)
    type(friction_law), intent(in) :: law
    real(c_double), intent(in) :: time, dt, slip(:), stick(:), pressing(:)
    real(c_double), intent(in), target :: tangent(:, :), normal(:, :), area(:)
    real(c_double), intent(inout) :: memory(:, :)
    real(c_double), intent(out) :: f(:, :)
    character(*), intent(out) :: message
    real(c_double), target, dimension(size(normal, 1), size(slip)) :: v_free, v_before, v, r
    real(c_double), target :: h(size(slip)), gap(size(slip))
    real(c_double), target, dimension(law%state_size, size(slip)) :: state, trial
    integer(c_int32_t), allocatable, target :: moving(:), fresh(:), begun(:)
    integer(c_int8_t), target :: status(size(slip))
    type(ilaw_batch) :: batch
    type(ilaw_report) :: report
    logical :: continues(size(slip))
    integer :: d, i, k

    message = ''
    f = 0
    d = size(normal, 1)
    if (size(memory, 1) < 1 + d + law%state_size) then
      write (message, '(a,i0,a)') 'the law needs ', 1 + d + law%state_size, ' state variables per node (*DEPVAR)'
      return
    end if
    ! Times may come rounded to single precision.
    continues = memory(1, :) > 0 .and. time - memory(1, :) < 0.5d0*dt + 4*epsilon(1.0)*abs(time)
    do k = 1, size(slip)
      if (slip(k) <= 0) memory(2:1 + d, k) = 0
      if (memory(1, k) > 0) memory(1, k) = time + dt
    end do
    moving = pack([(k, k=1, size(slip))], slip > 0 .and. stick > 0)
    if (size(moving) == 0) return
    do i = 1, size(moving)
      k = moving(i)
      h(k) = slip(k)/(stick(k)*dt**2)
      v_free(:, k) = slip(k)/dt*tangent(:, k) - h(k)*pressing(k)*dt*normal(:, k)
      v_before(:, k) = merge(memory(2:1 + d, k), 0.0_c_double, continues(k))
      state(:, k) = memory(2 + d:1 + d + law%state_size, k)
    end do
    gap = 0
    batch%time = time
    batch%velocity_step = dt
    batch%position_step = dt
    batch%v_free = ilaw_input_of(v_free)
    batch%delassus = ilaw_input_of(h)
    batch%gap = ilaw_input_of(gap)
    batch%v_previous = ilaw_input_of(v_before)
    batch%normal = ilaw_input_of(normal)
    batch%area = ilaw_input_of(area)
    batch%state_in = ilaw_input_of(state)
    batch%state_out = ilaw_output_of(state)
    batch%impulse = ilaw_output_of(r)
    batch%velocity = ilaw_output_of(v)
    fresh = pack(moving, memory(1, moving) <= 0)
    if (size(fresh) > 0) then
      call ilaw_use_nodes(batch, fresh)
      if (ilaw_interface_initialise(law%interface, batch, report) /= ILAW_OK) message = ilaw_text(report%reason)
    end if
    begun = pack(moving, .not. continues(moving))
    if (size(begun) > 0) then
      trial = state
      status = ILAW_SLIP  ! a law need not give it
      batch%state_out = ilaw_output_of(trial)
      batch%status = c_loc(status)
      batch%status_stride = 1
      call ilaw_use_nodes(batch, begun)
      if (ilaw_interface_evaluate(law%interface, batch, report) /= ILAW_OK) message = ilaw_text(report%reason)
      do i = 1, size(begun)
        k = begun(i)
        if (status(k) == ILAW_SLIP) v_before(:, k) = slip(k)/dt*tangent(:, k)
      end do
      batch%state_out = ilaw_output_of(state)
    end if
    call ilaw_use_nodes(batch, moving)
    if (ilaw_interface_evaluate(law%interface, batch, report) /= ILAW_OK) message = ilaw_text(report%reason)
    do i = 1, size(moving)
      k = moving(i)
      f(1, k) = dot_product(r(:, k), tangent(:, k))/dt
      if (d == 3) f(2, k) = dot_product(r(:, k), cross(normal(:, k), tangent(:, k)))/dt
      memory(1, k) = time + dt
      memory(2:1 + d, k) = v(:, k) - dot_product(v(:, k), normal(:, k))*normal(:, k)
      memory(2 + d:1 + d + law%state_size, k) = state(:, k)
    end do
  end subroutine

  pure function cross(a, b)
    real(c_double), intent(in) :: a(3), b(3)
    real(c_double) :: cross(3)
    cross = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
  end function
end module
