! Conversions in module ilaw of the host's arrays and of a law's parameters, for fortran_module_test.
module fortran_arguments
  use, intrinsic :: iso_c_binding
  use ilaw
  implicit none
  real(c_double), target, save :: numbered(8, 9), line(9)
  real(c_float), target, save :: narrow(8, 9), narrow_line(9)
contains

  ! numbered(i,j) = 10 i + j, line(i) = i.
  subroutine number_arrays()
    integer :: i, j
    do j = 1, 9
      numbered(:, j) = [(10._c_double*i + j, i=1, 8)]
    end do
    line = [(real(i, c_double), i=1, 9)]
    narrow = real(numbered, c_float)
    narrow_line = real(line, c_float)
  end subroutine

  ! Arrays and sections as users have them; the test knows what each holds.
  type(ilaw_input) function fortran_input(section, bytes) result(input) bind(c)
    integer(c_int), value :: section, bytes
    call number_arrays()
    if (bytes == 4) then
      input = fortran_float_input(section)
      return
    end if
    select case (section)
    case (0); input = ilaw_input_of(numbered)                             ! whole, components first
    case (1); input = ilaw_input_of(numbered, nodes_first=.true.)         ! whole, nodes first
    case (2); input = ilaw_input_of(numbered(4:6, :))                     ! three rows of a wider array
    case (3); input = ilaw_input_of(numbered(2:8:2, 9:1:-3))              ! steps, also backwards
    case (4); input = ilaw_input_of(line)                                 ! a scalar per node
    case (5); input = ilaw_input_of(numbered(3, :))                       ! one component of an array
    case (6); input = ilaw_uniform(numbered(2:4, 5))                      ! the same vector at every node
    case (7); input = ilaw_input_of(numbered(4:6, 7:7))                   ! one node
    case default; input = ilaw_input_of(numbered(:, 5:4))                 ! none
    end select
  end function

  type(ilaw_input) function fortran_float_input(section) result(input)
    integer(c_int), intent(in) :: section
    select case (section)
    case (0); input = ilaw_input_of(narrow)
    case (1); input = ilaw_input_of(narrow, nodes_first=.true.)
    case (2); input = ilaw_input_of(narrow(4:6, :))
    case (3); input = ilaw_input_of(narrow(2:8:2, 9:1:-3))
    case (4); input = ilaw_input_of(narrow_line)
    case (5); input = ilaw_input_of(narrow(3, :))
    case (6); input = ilaw_uniform(narrow(2:4, 5))
    case (7); input = ilaw_input_of(narrow(4:6, 7:7))
    case default; input = ilaw_input_of(narrow(:, 5:4))
    end select
  end function

  type(ilaw_output) function fortran_output(section, bytes) result(output) bind(c)
    integer(c_int), value :: section, bytes
    call number_arrays()
    select case (section + merge(3, 0, bytes == 4))
    case (0); output = ilaw_output_of(numbered)
    case (1); output = ilaw_output_of(numbered, nodes_first=.true.)
    case (2); output = ilaw_output_of(line)
    case (3); output = ilaw_output_of(narrow)
    case (4); output = ilaw_output_of(narrow, nodes_first=.true.)
    case default; output = ilaw_output_of(narrow_line)
    end select
  end function

  type(ilaw_batch) function fortran_default_batch() result(batch) bind(c)
    batch = ilaw_batch()
  end function

  ! A batch of the nodes 3, 1 and 7, listed in integers of 4 or of 8 bytes, or of none.
  type(ilaw_batch) function fortran_nodes(width) result(batch) bind(c)
    integer(c_int), value :: width
    integer(c_int32_t), target, save :: nodes_32(3) = [3, 1, 7]
    integer(c_int64_t), target, save :: nodes_64(3) = [3, 1, 7]
    call ilaw_use_nodes(batch, nodes_64) ! what another list was there before is forgotten
    if (width == 4) call ilaw_use_nodes(batch, nodes_32)
    if (width == 0) call ilaw_use_nodes(batch, nodes_32(1:0))
  end function

  ! Opens by name alone.
  integer(c_int32_t) function fortran_open_named(name) result(code) bind(c)
    type(c_ptr), value :: name
    type(c_ptr) :: library
    character(200) :: text
    code = ilaw_open_named(ilaw_text(name), library, text)
    call ilaw_library_close(library)
  end function

  ! Creates an interface with coulomb, the friction given in one of the ways there are; message is the loader's.
  integer(c_int32_t) function fortran_create(library_name, way, per_node_count, message) result(code) bind(c)
    type(c_ptr), value :: library_name
    integer(c_int), value :: way
    integer(c_int32_t), intent(out) :: per_node_count
    character(kind=c_char), intent(out) :: message(200)
    character(200) :: text
    type(c_ptr) :: library, interface
    type(ilaw_setup) :: setup
    type(ilaw_instance_info) :: info
    integer :: k

    per_node_count = -1
    interface = c_null_ptr
    setup%dimension = 3
    setup%delassus_form = ILAW_DELASSUS_SCALAR
    setup%frame = merge(0_c_int32_t, ILAW_FRAME_LOCAL, way == 8) ! 8: forgotten
    code = ilaw_open(ilaw_text(library_name), library, text)
    if (code == ILAW_OK) then
      code = ilaw_create(library, merge('coulomb', 'absent ', way /= 6), setup, friction_given(way), interface, text)
      call ilaw_library_close(library)
    end if
    if (code == ILAW_OK) then
      code = ilaw_interface_info(interface, info)
      per_node_count = info%per_node_parameter_count
    end if
    call ilaw_interface_destroy(interface)
    do k = 1, len(text)
      message(k) = text(k:k)
    end do
  end function

  function friction_given(way) result(values)
    integer(c_int), intent(in) :: way
    type(ilaw_values) :: values
    real(c_double), parameter :: rising(2, 3) = reshape(real([0, 1, 2, 3, 4, 5], c_double), [2, 3])
    real(c_double), parameter :: falling(2, 2) = reshape(real([1, 1, 0, 1], c_double), [2, 2])
    select case (way)
    case (0, 6, 8)
      call values%set('friction', 0.5_c_double)
      call values%set('activation ', 'predictive ')
    case (1)
      call values%set('friction', -2._c_double)
    case (2)
      call values%set('friction', 0.5_c_double)
      call values%set('activation', 'sometimes')
    case (3)
      call values%set('friction', rising)
    case (4)
      call values%set('friction', falling)
    case (5)
      call values%set_per_node('friction')
    end select
  end function
end module fortran_arguments
