! Fields, amounts and tables from Fortran, in both kinds of numbers, for fortran_fields_test: template_c in two
! dimensions, local frame.
module fortran_fields
  use, intrinsic :: iso_c_binding
  use ilaw
  implicit none
  integer, parameter :: dp = c_double, sp = c_float

  ! Ways to give parameters and arrays, most of them wrong.
  integer(c_int), parameter :: right = 0, no_field = 1, no_amount = 2, wrong_shape = 3, wrong_pairs = 4
  integer(c_int), parameter :: by_number = 5, other_kind = 6, wrong_axis = 7
contains

  ! Friction mu(speed, temperature) at speeds 0, 1, 4 m/s (rows) and 293, 593 K (columns).
  function friction_table(way) result(values)
    integer(c_int), intent(in) :: way
    type(ilaw_values) :: values
    real(dp), parameter :: speed(3) = [0._dp, 1._dp, 4._dp], hot(2) = [293._dp, 593._dp]
    real(dp), parameter :: mu(3, 2) = reshape([0.6_dp, 0.5_dp, 0.4_dp, 0.3_dp, 0.25_dp, 0.2_dp], [3, 2])
    if (way == wrong_shape) then
      call values%set('friction', mu, 'temperature', hot, 'slip_speed', speed)
    else if (way == wrong_pairs) then
      call values%set('friction', mu)
    else
      call values%set('friction', mu, 'slip_speed', speed, 'temperature', hot)
    end if
    if (way == by_number) call values%set('temperature', 443._dp)
    if (way == wrong_axis) call values%set('partition', [1._dp], 'time', [0._dp])
  end function

  ! Offers the temperature, and creates.
  integer(c_int32_t) function created(way, numbers, interface, message) result(code)
    integer(c_int), intent(in) :: way
    integer(c_int32_t), intent(in) :: numbers
    type(c_ptr), intent(out) :: interface
    character(*), intent(out) :: message
    type(c_ptr) :: library
    type(ilaw_setup) :: setup
    type(ilaw_values) :: values
    interface = c_null_ptr
    code = ilaw_open('template_c', library, message)
    if (code /= ILAW_OK) return
    setup%dimension = 2
    setup%delassus_form = ILAW_DELASSUS_SCALAR
    setup%frame = ILAW_FRAME_LOCAL
    setup%numbers = numbers
    values = friction_table(way)
    call ilaw_offer_field(library, '', 'temperature', values)
    call ilaw_offer_field(library, 'template_c', 'humidity', values) ! the law has none
    call ilaw_offer_field(library, '', 'partition', values)          ! is no field
    code = ilaw_create(library, '', setup, values, interface, message)
    call ilaw_library_close(library)
  end function

  ! One step of `count` nodes: v(:,i) in, r(:,i) out; temperature is a row of a wider array.
  integer(c_int32_t) function fortran_doubles(way, count, v, temperature, r, heat, line) result(code) bind(c)
    integer(c_int), value :: way, count
    real(dp), intent(in), target :: v(2, count), temperature(2, count)
    real(dp), intent(inout), target :: r(2, count), heat(count)
    character(kind=c_char), intent(out) :: line(200)
    real(dp), target :: inverse_mass(1), gap(1), state(0, count)
    real(sp), target :: narrow(count)
    type(c_ptr) :: interface
    type(ilaw_batch) :: batch
    type(ilaw_arrays), target :: fields, amounts
    character(200) :: message
    inverse_mass = 0.5_dp
    gap = 0
    narrow = real(temperature(2, :), sp)
    code = created(way, ILAW_NUMBERS_DOUBLE, interface, message)
    if (code == ILAW_OK) then
      batch%v_free = ilaw_input_of(v)
      batch%v_previous = ilaw_input_of(v)
      batch%delassus = ilaw_uniform(inverse_mass)
      batch%gap = ilaw_uniform(gap)
      batch%impulse = ilaw_output_of(r)
      batch%state_in = ilaw_input_of(state)
      batch%state_out = ilaw_output_of(state)
      call fields%add('fluid_pressure', heat)
      if (way == other_kind) call fields%add('temperature', narrow)
      if (way /= no_field .and. way /= other_kind) call fields%add('temperature', temperature(2, :))
      call amounts%add(trim(merge('wear', 'heat', way == no_amount)), heat)
      code = evaluated(interface, batch, count, fields, amounts, message)
    end if
    call ilaw_interface_destroy(interface)
    call return_line(message, line)
  end function

  ! The same in real(c_float).
  integer(c_int32_t) function fortran_floats(count, v, temperature, r, heat, line) result(code) bind(c)
    integer(c_int), value :: count
    real(sp), intent(in), target :: v(2, count), temperature(2, count)
    real(sp), intent(inout), target :: r(2, count), heat(count)
    character(kind=c_char), intent(out) :: line(200)
    real(sp), target :: inverse_mass(1), gap(1)
    real(dp), target :: state(0, count)
    type(c_ptr) :: interface
    type(ilaw_batch) :: batch
    type(ilaw_arrays), target :: fields, amounts
    character(200) :: message
    inverse_mass = 0.5_sp
    gap = 0
    code = created(right, ILAW_NUMBERS_FLOAT, interface, message)
    if (code == ILAW_OK) then
      batch%v_free = ilaw_input_of(v)
      batch%v_previous = ilaw_input_of(v)
      batch%delassus = ilaw_uniform(inverse_mass)
      batch%gap = ilaw_uniform(gap)
      batch%impulse = ilaw_output_of(r)
      batch%state_in = ilaw_input_of(state)
      batch%state_out = ilaw_output_of(state)
      call fields%add('temperature', temperature(2, :))
      call amounts%add('heat', heat)
      code = evaluated(interface, batch, count, fields, amounts, message)
    end if
    call ilaw_interface_destroy(interface)
    call return_line(message, line)
  end function

  integer(c_int32_t) function evaluated(interface, batch, count, fields, amounts, message) result(code)
    type(c_ptr), intent(in) :: interface
    type(ilaw_batch), intent(inout) :: batch
    integer(c_int), intent(in) :: count
    type(ilaw_arrays), intent(inout), target :: fields, amounts
    character(*), intent(out) :: message
    type(ilaw_report) :: report
    code = ilaw_use_fields(interface, batch, fields, message)
    if (code == ILAW_OK) code = ilaw_use_amounts(interface, batch, amounts, message)
    if (code /= ILAW_OK) return
    batch%node_count = count
    batch%velocity_step = 1
    batch%position_step = 1
    code = ilaw_interface_initialise(interface, batch, report)
    if (code == ILAW_OK) code = ilaw_interface_evaluate(interface, batch, report)
    message = ilaw_text(report%reason)
  end function

  subroutine return_line(message, line)
    character(*), intent(in) :: message
    character(kind=c_char), intent(out) :: line(200)
    integer :: k
    line = [(message(k:k), k=1, 199), c_null_char]
  end subroutine
end module fortran_fields
