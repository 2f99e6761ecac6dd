! fortran_test.f90 - module ilaw as a host uses it: arrays without a copy, lists of nodes, libraries, every kind
! of parameter, tables over axes with fields and amounts in both kinds of numbers. Prints each failure and exits
! with 1 if there is one. Layouts of structs are for python/test_bindings.py.
! SPDX-License-Identifier: BSD-3-Clause
program fortran_test
  use, intrinsic :: iso_c_binding
  use, intrinsic :: iso_fortran_env, only: error_unit
  use ilaw
  implicit none
  integer, parameter :: dp = c_double, sp = c_float, count = 6
  ! Friction mu(speed, temperature) at speeds 0, 1, 4 m/s (rows) and 293, 593 K (columns).
  real(dp), parameter :: speed(3) = [0._dp, 1._dp, 4._dp], hot(2) = [293._dp, 593._dp]
  real(dp), parameter :: mu(3, 2) = reshape([0.6_dp, 0.5_dp, 0.4_dp, 0.3_dp, 0.25_dp, 0.2_dp], [3, 2])
  ! Pairs (normal, tangential) velocity; temperatures stand in the second row of two.
  real(dp), parameter :: motion(2, count) = reshape(real([-2, 4, -2, 6, -4, 18, -2, 10, -3, 5, -1, 8], dp)/2, [2, count])
  real(dp), parameter :: kelvin(count) = real([293, 393, 443, 593, 200, 900], dp)
  real(dp), parameter :: mass = 2, partition = 0.5_dp
  integer :: failures = 0

  call test_arrays()
  call test_lists_of_nodes()
  call test_libraries()
  call test_parameters()
  call test_fields()
  call test_refused_fields()
  if (failures > 0) stop 1

contains

  subroutine expect(is_so, what)
    logical, intent(in) :: is_so
    character(*), intent(in) :: what
    if (is_so) return
    write (error_unit, '(2a)') 'fortran_test: not so: ', what
    failures = failures + 1
  end subroutine

  ! The number at a node and component, counted from 0.
  real(dp) function number_at(input, node, component) result(number)
    type(ilaw_input), intent(in) :: input
    integer, intent(in) :: node, component
    real(dp), pointer :: double
    real(sp), pointer :: float
    integer(c_intptr_t) :: place
    place = node*input%node_stride + component*input%component_stride
    if (c_associated(input%values)) then
      call c_f_pointer(transfer(transfer(input%values, place) + 8*place, c_null_ptr), double)
      number = double
    else
      call c_f_pointer(transfer(transfer(input%floats, place) + 4*place, c_null_ptr), float)
      number = float
    end if
  end function

  logical function is_absent(input)
    type(ilaw_input), intent(in) :: input
    is_absent = .not. (c_associated(input%values) .or. c_associated(input%floats))
  end function

  subroutine test_arrays()
    real(dp), target :: a(8, 9), line(9)
    real(sp), target :: b(8, 9), short(9)
    type(ilaw_input) :: in(8, 2)
    type(ilaw_output) :: out(3, 2)
    ! The first number of each, what the next node and the next component have more, how many there are.
    integer, parameter :: expected(5, 8) = reshape([11, 1, 10, 9, 8, 11, 10, 1, 8, 9, 41, 1, 10, 9, 3, &
      29, -3, 20, 3, 4, 1, 1, 0, 9, 1, 31, 1, 0, 9, 1, 25, 0, 10, 5, 3, 47, 0, 10, 1, 3], [5, 8])
    integer, parameter :: input_of_output(3) = [1, 2, 5]
    character(40) :: at
    integer :: width, k, i, j
    in(:, 1) = [ilaw_input_of(a), ilaw_input_of(a, nodes_first=.true.), ilaw_input_of(a(4:6, :)), &
                ilaw_input_of(a(2:8:2, 9:1:-3)), ilaw_input_of(line), ilaw_input_of(a(3, :)), &
                ilaw_uniform(a(2:4, 5)), ilaw_input_of(a(4:6, 7:7))]
    in(:, 2) = [ilaw_input_of(b), ilaw_input_of(b, nodes_first=.true.), ilaw_input_of(b(4:6, :)), &
                ilaw_input_of(b(2:8:2, 9:1:-3)), ilaw_input_of(short), ilaw_input_of(b(3, :)), &
                ilaw_uniform(b(2:4, 5)), ilaw_input_of(b(4:6, 7:7))]
    out(:, 1) = [ilaw_output_of(a), ilaw_output_of(a, nodes_first=.true.), ilaw_output_of(line)]
    out(:, 2) = [ilaw_output_of(b), ilaw_output_of(b, nodes_first=.true.), ilaw_output_of(short)]
    ! Written after all are described: a copy would not have these numbers.
    do j = 1, 9
      a(:, j) = [(10._dp*i + j, i=1, 8)]
    end do
    line = [(real(i, dp), i=1, 9)]
    b = real(a, sp)
    short = real(line, sp)
    do width = 1, 2
      do k = 1, 8
        write (at, '(a,i0,a,i0,a)') 'section ', k, ' of ', 8/width, ' bytes'
        call expect(c_associated(in(k, width)%values) .neqv. width == 2, at)
        call expect(c_associated(in(k, width)%floats) .eqv. width == 2, at)
        do i = 0, expected(4, k) - 1
          do j = 0, expected(5, k) - 1
            call expect(nint(number_at(in(k, width), i, j)) == sum(expected(:3, k)*[1, i, j]), at)
          end do
        end do
      end do
      do k = 1, 3
        call expect(all(transfer(out(k, width), [0_c_int64_t]) == &
                        transfer(in(input_of_output(k), width), [0_c_int64_t])), 'outputs are described as inputs')
      end do
    end do
    call expect(is_absent(ilaw_input_of(a(:, 5:4))) .and. is_absent(ilaw_input_of(b(:, 5:4))), 'an empty array is absent')
  end subroutine

  subroutine test_lists_of_nodes()
    integer(c_int32_t), target :: nodes(3) = [3, 1, 7]
    integer(c_int64_t), target :: far(3) = [3, 1, 7]
    type(ilaw_batch) :: batch
    call expect(batch%index_base == 1 .and. batch%node_count == 0 .and. batch%flags == 0 .and. &
                is_absent(batch%v_free) .and. .not. (c_associated(batch%index) .or. c_associated(batch%index64)), &
                'a batch that is declared is empty and counts from 1')
    call ilaw_use_nodes(batch, far)
    call expect(c_associated(batch%index64, c_loc(far)) .and. .not. c_associated(batch%index) .and. &
                batch%node_count == 3, 'a list of 64 bits')
    call ilaw_use_nodes(batch, nodes)
    call expect(c_associated(batch%index, c_loc(nodes)) .and. .not. c_associated(batch%index64) .and. &
                batch%node_count == 3, 'a list of 32 bits takes its place')
    call ilaw_use_nodes(batch, nodes(1:0))
    call expect(.not. (c_associated(batch%index) .or. c_associated(batch%index64)) .and. batch%node_count == 0, 'no node')
  end subroutine

  subroutine test_libraries()
    character(200) :: message
    type(c_ptr) :: library, interface
    type(ilaw_setup) :: setup
    type(ilaw_values) :: values
    call expect(ilaw_open_named('coulomb', library, message) == ILAW_OK, 'opens by name')
    call expect(ilaw_create(library, 'absent', setup, values, interface, message) == ILAW_NOT_FOUND .and. &
                says(message, 'absent') .and. says(message, 'coulomb'), 'names a law that is absent, and those that are not')
    call ilaw_library_close(library)
    call expect(ilaw_open_named('./coulomb.so', library, message) == ILAW_NOT_FOUND, 'a path is no name')
    call expect(ilaw_open('/no/such/library.so', library, message) == ILAW_NOT_FOUND .and. &
                says(message, '/no/such/library.so'), 'names a library that is not there')
  end subroutine

  logical function says(message, part)
    character(*), intent(in) :: message, part
    says = index(message, part) > 0
  end function

  ! An interface of a law whose H is one number. Fields are offered, of which template_c alone has the first.
  subroutine create(law, dimension, frame, numbers, values, interface, code, message)
    character(*), intent(in) :: law
    integer(c_int32_t), intent(in) :: dimension, frame, numbers
    type(ilaw_values), intent(inout) :: values
    type(c_ptr), intent(out) :: interface
    integer(c_int32_t), intent(out) :: code
    character(*), intent(out) :: message
    type(c_ptr) :: library
    type(ilaw_setup) :: setup
    code = ilaw_open(law, library, message)
    if (code /= ILAW_OK) return
    setup%dimension = dimension
    setup%delassus_form = ILAW_DELASSUS_SCALAR
    setup%frame = frame
    setup%numbers = numbers
    call ilaw_offer_field(library, '', 'temperature', values)
    call ilaw_offer_field(library, law, 'humidity', values) ! no law has it
    call ilaw_offer_field(library, '', 'partition', values) ! is no field
    code = ilaw_create(library, '', setup, values, interface, message)
    call ilaw_library_close(library)
  end subroutine

  ! Creates coulomb; code and message are what the loader says.
  subroutine create_coulomb(values, frame, code, message, per_node_count)
    type(ilaw_values), intent(inout) :: values
    integer(c_int32_t), intent(in) :: frame
    integer(c_int32_t), intent(out) :: code, per_node_count
    character(*), intent(out) :: message
    type(c_ptr) :: interface
    type(ilaw_instance_info) :: info
    call create('coulomb', 3_c_int32_t, frame, ILAW_NUMBERS_DOUBLE, values, interface, code, message)
    if (code == ILAW_OK) code = ilaw_interface_info(interface, info)
    per_node_count = info%per_node_parameter_count
    call ilaw_interface_destroy(interface)
  end subroutine

  subroutine test_parameters()
    type(ilaw_values) :: number, rising, per_node, negative, choice, none, falling
    real(dp), parameter :: times(2, 2) = reshape([0._dp, 1._dp, 2._dp, 3._dp], [2, 2])
    call number%set('friction', 0.5_dp)
    call number%set('activation ', 'predictive ')
    call rising%set('friction', times)
    call per_node%set_per_node('friction')
    call negative%set('friction', -2._dp)
    call choice%set('friction', 0.5_dp)
    call choice%set('activation', 'sometimes')
    call falling%set('friction', times(:, [2, 1]))
    call expect_created(number, 0_c_int32_t, 'a number and a choice')
    call expect_created(rising, 0_c_int32_t, 'a table in time')
    call expect_created(per_node, 1_c_int32_t, 'a value per node')
    call expect_refused(negative, 'friction', '-2')
    call expect_refused(choice, 'sometimes', 'predictive')
    call expect_refused(none, 'friction', '')
    call expect_refused(falling, 'friction', '')
  end subroutine

  subroutine expect_created(values, of_nodes, what)
    type(ilaw_values), intent(inout) :: values
    integer(c_int32_t), intent(in) :: of_nodes
    character(*), intent(in) :: what
    integer(c_int32_t) :: code, per_node_count
    character(200) :: message
    call create_coulomb(values, ILAW_FRAME_LOCAL, code, message, per_node_count)
    call expect(code == ILAW_OK .and. message == '' .and. per_node_count == of_nodes, what//': '//message)
    call create_coulomb(values, 0_c_int32_t, code, message, per_node_count)
    call expect(code == ILAW_UNSUPPORTED, 'a forgotten frame is refused')
  end subroutine

  subroutine expect_refused(values, one, other)
    type(ilaw_values), intent(inout) :: values
    character(*), intent(in) :: one, other
    integer(c_int32_t) :: code, per_node_count
    character(200) :: message
    call create_coulomb(values, ILAW_FRAME_LOCAL, code, message, per_node_count)
    call expect(code == ILAW_INVALID_PARAMETER .and. says(message, one) .and. says(message, other), message)
  end subroutine

  ! ---- fields, amounts and tables: template_c in two dimensions, local frame

  ! One step of all nodes in doubles; temperatures stand in a row of a wider array.
  subroutine brake(values, field, amount, r, heat, code, message)
    type(ilaw_values), intent(inout) :: values
    character(*), intent(in) :: field, amount
    real(dp), intent(out), target :: r(2, count), heat(count)
    integer(c_int32_t), intent(out) :: code
    character(*), intent(out) :: message
    real(dp), target :: v(2, count), temperature(2, count), inverse_mass(1), gap(1), state(0, count)
    real(sp), target :: narrow(count)
    type(c_ptr) :: interface
    type(ilaw_batch) :: batch
    type(ilaw_arrays), target :: fields, amounts
    v = motion
    temperature(1, :) = 0
    temperature(2, :) = kelvin
    narrow = real(kelvin, sp)
    inverse_mass = 1/mass
    gap = 0
    r = 0
    heat = 0
    call create('template_c', 2_c_int32_t, ILAW_FRAME_LOCAL, ILAW_NUMBERS_DOUBLE, values, interface, code, message)
    if (code /= ILAW_OK) return
    batch%v_free = ilaw_input_of(v)
    batch%v_previous = ilaw_input_of(v)
    batch%delassus = ilaw_uniform(inverse_mass)
    batch%gap = ilaw_uniform(gap)
    batch%impulse = ilaw_output_of(r)
    batch%state_in = ilaw_input_of(state)
    batch%state_out = ilaw_output_of(state)
    call fields%add('fluid_pressure', heat)
    if (field == 'floats') call fields%add('temperature', narrow)
    if (field == 'doubles') call fields%add('temperature', temperature(2, :))
    call amounts%add(amount, heat)
    call evaluate(interface, batch, fields, amounts, code, message)
    call ilaw_interface_destroy(interface)
  end subroutine

  ! The same in floats.
  subroutine brake_in_floats(r, heat, code, message)
    real(sp), intent(out), target :: r(2, count), heat(count)
    integer(c_int32_t), intent(out) :: code
    character(*), intent(out) :: message
    real(sp), target :: v(2, count), temperature(2, count), inverse_mass(1), gap(1)
    type(ilaw_values) :: values
    type(c_ptr) :: interface
    type(ilaw_batch) :: batch
    type(ilaw_arrays), target :: fields, amounts
    v = real(motion, sp)
    temperature(1, :) = 0
    temperature(2, :) = real(kelvin, sp)
    inverse_mass = real(1/mass, sp)
    gap = 0
    call values%set('friction', mu, 'slip_speed', speed, 'temperature', hot)
    call create('template_c', 2_c_int32_t, ILAW_FRAME_LOCAL, ILAW_NUMBERS_FLOAT, values, interface, code, message)
    if (code /= ILAW_OK) return
    batch%v_free = ilaw_input_of(v)
    batch%v_previous = ilaw_input_of(v)
    batch%delassus = ilaw_uniform(inverse_mass)
    batch%gap = ilaw_uniform(gap)
    batch%impulse = ilaw_output_of(r)
    call fields%add('temperature', temperature(2, :))
    call amounts%add('heat', heat)
    call evaluate(interface, batch, fields, amounts, code, message)
    call ilaw_interface_destroy(interface)
  end subroutine

  subroutine evaluate(interface, batch, fields, amounts, code, message)
    type(c_ptr), intent(in) :: interface
    type(ilaw_batch), intent(inout) :: batch
    type(ilaw_arrays), intent(inout), target :: fields, amounts
    integer(c_int32_t), intent(out) :: code
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
  end subroutine

  ! The table, linear along each axis and constant beyond its ends: half as high at the hot end.
  pure real(dp) function friction_at(v, temperature) result(friction)
    real(dp), intent(in) :: v, temperature
    friction = merge(0.6_dp - 0.1_dp*v, 0.5_dp - 0.1_dp*(min(v, 4._dp) - 1)/3, v < 1)
    friction = friction*(1 - 0.5_dp*min(max((temperature - 293)/300, 0._dp), 1._dp))
  end function

  subroutine expect_brake(values, temperature, what)
    type(ilaw_values), intent(inout) :: values
    real(dp), intent(in) :: temperature(count)
    character(*), intent(in) :: what
    real(dp) :: r(2, count), heat(count), slip
    integer(c_int32_t) :: code
    character(200) :: message
    integer :: i
    call brake(values, 'doubles', 'heat', r, heat, code, message)
    call expect(code == ILAW_OK, what//': '//message)
    do i = 1, count
      slip = motion(2, i) + r(2, i)/mass
      call expect(abs(r(1, i) + mass*motion(1, i)) <= 1e-15_dp .and. &
                  abs(r(2, i) + friction_at(slip, temperature(i))*r(1, i)) <= 1e-13_dp .and. &
                  abs(heat(i) + partition*r(2, i)*(motion(2, i) + slip)/2) <= 1e-13_dp, what)
    end do
  end subroutine

  subroutine test_fields()
    type(ilaw_values) :: table, by_number
    real(dp) :: r(2, count), heat(count)
    real(sp) :: r_float(2, count), heat_float(count)
    integer(c_int32_t) :: code
    character(200) :: message
    call table%set('friction', mu, 'slip_speed', speed, 'temperature', hot)
    call by_number%set('friction', mu, 'slip_speed', speed, 'temperature', hot)
    call by_number%set('temperature', 443._dp)
    call expect_brake(by_number, spread(443._dp, 1, count), 'a field that is given as a number is not offered')
    call expect_brake(table, kelvin, 'friction and heat follow the table')
    call brake(table, 'doubles', 'heat', r, heat, code, message)
    call brake_in_floats(r_float, heat_float, code, message)
    call expect(code == ILAW_OK, message)
    call expect(.not. any(r_float < real(r, sp) .or. r_float > real(r, sp)) .and. &
                .not. any(heat_float < real(heat, sp) .or. heat_float > real(heat, sp)), &
                'floats are the doubles rounded')
  end subroutine

  subroutine test_refused_fields()
    type(ilaw_values) :: right, wrong_shape, wrong_pairs, wrong_axis
    call right%set('friction', mu, 'slip_speed', speed, 'temperature', hot)
    call wrong_axis%set('friction', mu, 'slip_speed', speed, 'temperature', hot)
    call wrong_axis%set('partition', [1._dp], 'time', [0._dp])
    call wrong_shape%set('friction', mu, 'temperature', hot, 'slip_speed', speed)
    call wrong_pairs%set('friction', mu)
    call expect_no_brake(right, 'none', 'heat', ILAW_INVALID_ARGUMENT, 'reads ''temperature'' per node')
    call expect_no_brake(right, 'floats', 'heat', ILAW_INVALID_ARGUMENT, '')
    call expect_no_brake(right, 'doubles', 'wear', ILAW_UNSUPPORTED, 'no amount ''wear''')
    call expect_no_brake(wrong_shape, 'doubles', 'heat', ILAW_INVALID_PARAMETER, &
                         'parameter ''friction'': a table has one value per point of its axis')
    call expect_no_brake(wrong_pairs, 'doubles', 'heat', ILAW_INVALID_PARAMETER, 'parameter ''friction'': pairs (time, value)')
    call expect_no_brake(wrong_axis, 'doubles', 'heat', ILAW_INVALID_PARAMETER, '''partition''')
  end subroutine

  ! Nothing is written.
  subroutine expect_no_brake(values, field, amount, wanted, part)
    type(ilaw_values), intent(inout) :: values
    character(*), intent(in) :: field, amount, part
    integer(c_int32_t), intent(in) :: wanted
    real(dp) :: r(2, count), heat(count)
    integer(c_int32_t) :: code
    character(200) :: message
    call brake(values, field, amount, r, heat, code, message)
    call expect(code == wanted .and. says(message, part), part//': '//message)
    call expect(.not. any(abs(r) > 0), 'a refusal writes nothing')
  end subroutine
end program fortran_test
