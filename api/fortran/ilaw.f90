! ilaw.f90 - hosts in Fortran 2008: the loader (<ilaw/loader.h>) and arrays that go in without a copy.
!
! Libraries and interfaces are opaque handles, type(c_ptr). Functions return an ILAW_* code of ilaw_abi;
! message, where there is one, receives one blank-padded line that says what was found and what is allowed.
! Threading and ownership are those of loader.h.
!
! SPDX-License-Identifier: BSD-3-Clause
module ilaw
  use, intrinsic :: iso_c_binding
  use ilaw_abi
  implicit none
  private :: opened, argument_of, law_in, sorted, blank_padded, address, input_at, output_at
  private :: set_number, set_choice, set_time_table, set_table_1, set_table_2, set_table_3, set_table, set_axis
  private :: set_per_node, has, append, add_doubles, add_floats, add_input, use_nodes_32, use_nodes_64
  private :: input_of_doubles, input_of_double_vectors, input_of_floats, input_of_float_vectors
  private :: output_of_doubles, output_of_double_vectors, output_of_floats, output_of_float_vectors
  private :: uniform_doubles, uniform_floats

  type, private :: table_axis
    character(:), allocatable :: name
    real(c_double), allocatable :: points(:)
  end type

  ! The value of a parameter of a law.
  type, private :: value
    integer(c_int32_t) :: kind = ILAW_KIND_VALUE_NUMBER
    character(:), allocatable :: name
    real(c_double) :: number = 0
    character(:), allocatable :: text
    real(c_double), allocatable :: table(:)
    type(table_axis), allocatable :: axes(:) ! the last varies fastest
    character(:), allocatable :: fault       ! why it can be no value
    type(ilaw_axis), allocatable :: axis(:)  ! the axes as the ABI has them
    type(c_ptr), allocatable :: axis_pointers(:)
  end type

  ! The parameters of a law, for ilaw_create.
  !   call values%set('friction', 0.3_c_double)      a number
  !   call values%set('activation', 'moreau')        one of its choices
  !   call values%set('friction', pairs)             a time table, (time, value) pairs of shape (2,n)
  !   call values%set('friction', table, 'slip_speed', v, 'temperature', t)
  !                                                  a table of 1 to 3 dimensions, an axis and its points for
  !                                                  each: table(i,j) is the value at v(i) and t(j)
  !   call values%set_per_node('friction')           comes with every batch, one value per node: ilaw_use_fields
  type :: ilaw_values
    type(value), allocatable, private :: list(:)
  contains
    generic :: set => set_number, set_choice, set_time_table, set_table_1, set_table_2, set_table_3
    procedure :: set_per_node, has
    procedure, private :: set_number, set_choice, set_time_table, set_table_1, set_table_2, set_table_3
    procedure, private :: set_table, append
  end type

  ! Arrays by name, for ilaw_use_fields and ilaw_use_amounts: one number per node, in real(c_double) or
  ! real(c_float) as the setup's numbers say. They are used where they are, as those of ilaw_input_of.
  !   call fields%add('temperature', temperature)
  type, private :: named_array
    character(:), allocatable :: name
    type(ilaw_input) :: place
  end type
  type :: ilaw_arrays
    type(named_array), allocatable, private :: list(:)
    type(ilaw_input), allocatable, private :: in_order(:)
  contains
    generic :: add => add_doubles, add_floats, add_input
    procedure, private :: add_doubles, add_floats, add_input
  end type

  ! An array of the host as an argument of a batch, real(c_double) or real(c_float) as the setup's numbers say.
  ! The array needs the target (or pointer) attribute, is not copied, may be any section, and is used where it
  ! is for as long as the batch is.
  !   a(:)    one value per node
  !   a(:,:)  components first, (3,n); with nodes_first=.true. it is (n,3)
  interface ilaw_input_of
    procedure input_of_doubles, input_of_double_vectors, input_of_floats, input_of_float_vectors
  end interface
  interface ilaw_output_of
    procedure output_of_doubles, output_of_double_vectors, output_of_floats, output_of_float_vectors
  end interface

  ! One vector that is the same at every node, such as the normal of a plane.
  interface ilaw_uniform
    procedure uniform_doubles, uniform_floats
  end interface

  ! Names the nodes of a batch: call ilaw_use_nodes(batch, nodes), with an array of integer(c_int32_t) or of
  ! integer(c_int64_t) that has the target attribute and lives as long as the batch; its size is node_count.
  interface ilaw_use_nodes
    procedure use_nodes_32, use_nodes_64
  end interface

contains

  ! Opens a library by name or explicit path; null on failure. Trailing blanks of name do not count.
  integer(c_int32_t) function ilaw_open(name, library, message) result(code)
    character(*), intent(in) :: name
    type(c_ptr), intent(out) :: library
    character(*), intent(out) :: message
    code = opened(ilaw_library_open, name, library, message)
  end function

  ! The same by name alone, along the search path: for names that come from an input file.
  integer(c_int32_t) function ilaw_open_named(name, library, message) result(code)
    character(*), intent(in) :: name
    type(c_ptr), intent(out) :: library
    character(*), intent(out) :: message
    code = opened(ilaw_library_open_named, name, library, message)
  end function

  integer(c_int32_t) function opened(open, name, library, message) result(code)
    procedure(ilaw_library_open) :: open
    character(*), intent(in) :: name
    type(c_ptr), intent(out) :: library
    character(*), intent(out) :: message
    character(len_trim(name) + 1, c_char), target :: text
    character(len(message) + 1, c_char), target :: line
    text = trim(name)//c_null_char
    line = c_null_char
    code = open(c_loc(text), library, c_loc(line), len(line, c_size_t))
    message = blank_padded(line)
  end function

  ! Creates an interface with a law of the library, of the given id (blank: the library's only law). The
  ! arguments of the setup are those in values. Null on failure.
  integer(c_int32_t) function ilaw_create(library, id, setup, values, interface, message) result(code)
    type(c_ptr), intent(in) :: library
    character(*), intent(in) :: id
    type(ilaw_setup), intent(in) :: setup
    type(ilaw_values), intent(in) :: values
    type(c_ptr), intent(out) :: interface
    character(*), intent(out) :: message
    type(ilaw_setup) :: filled
    type(value), allocatable, target :: given(:)
    type(ilaw_argument), allocatable, target :: arguments(:)
    type(c_ptr), allocatable, target :: argument_pointers(:)
    character(len_trim(id) + 1, c_char), target :: law
    character(len(message) + 1, c_char), target :: line
    integer :: k

    interface = c_null_ptr
    allocate (given(0))
    if (allocated(values%list)) given = values%list
    allocate (arguments(size(given)), argument_pointers(size(given)))
    do k = 1, size(given)
      if (allocated(given(k)%fault)) then
        code = ILAW_INVALID_PARAMETER
        message = given(k)%fault
        return
      end if
      arguments(k) = argument_of(given(k))
      argument_pointers(k) = c_loc(arguments(k))
    end do
    filled = setup
    filled%argument_count = size(given)
    filled%arguments = c_null_ptr
    if (size(given) > 0) filled%arguments = c_loc(argument_pointers)
    law = trim(id)//c_null_char
    line = c_null_char
    code = ilaw_interface_create(library, merge(c_loc(law), c_null_ptr, len_trim(id) > 0), filled, interface, &
                                 c_loc(line), len(line, c_size_t))
    message = blank_padded(line)
  end function

  subroutine set_number(self, name, number)
    class(ilaw_values), intent(inout) :: self
    character(*), intent(in) :: name
    real(c_double), intent(in) :: number
    type(value) :: added
    added%number = number
    call self%append(name, added)
  end subroutine

  subroutine set_choice(self, name, text)
    class(ilaw_values), intent(inout) :: self
    character(*), intent(in) :: name, text
    type(value) :: added
    added%kind = ILAW_KIND_VALUE_TEXT
    added%text = trim(text)//c_null_char
    call self%append(name, added)
  end subroutine

  subroutine set_time_table(self, name, pairs)
    class(ilaw_values), intent(inout) :: self
    character(*), intent(in) :: name
    real(c_double), intent(in) :: pairs(:, :)
    type(value) :: added
    if (size(pairs, 1) == 2) then
      call self%set_table_1(name, pairs(2, :), 'time', pairs(1, :))
    else
      added%fault = 'parameter '''//trim(name)//''': pairs (time, value) have the shape (2,n)'
      call self%append(name, added)
    end if
  end subroutine

  subroutine set_table_1(self, name, table, axis, points)
    class(ilaw_values), intent(inout) :: self
    character(*), intent(in) :: name, axis
    real(c_double), intent(in) :: table(:), points(:)
    type(value) :: added
    allocate (added%axes(1))
    call set_axis(added, 1, axis, points, size(table))
    call self%set_table(name, table, added)
  end subroutine

  subroutine set_table_2(self, name, table, axis_1, points_1, axis_2, points_2)
    class(ilaw_values), intent(inout) :: self
    character(*), intent(in) :: name, axis_1, axis_2
    real(c_double), intent(in) :: table(:, :), points_1(:), points_2(:)
    type(value) :: added
    allocate (added%axes(2))
    call set_axis(added, 1, axis_1, points_1, size(table, 1))
    call set_axis(added, 2, axis_2, points_2, size(table, 2))
    call self%set_table(name, reshape(table, [size(table)]), added)
  end subroutine

  subroutine set_table_3(self, name, table, axis_1, points_1, axis_2, points_2, axis_3, points_3)
    class(ilaw_values), intent(inout) :: self
    character(*), intent(in) :: name, axis_1, axis_2, axis_3
    real(c_double), intent(in) :: table(:, :, :), points_1(:), points_2(:), points_3(:)
    type(value) :: added
    allocate (added%axes(3))
    call set_axis(added, 1, axis_1, points_1, size(table, 1))
    call set_axis(added, 2, axis_2, points_2, size(table, 2))
    call set_axis(added, 3, axis_3, points_3, size(table, 3))
    call self%set_table(name, reshape(table, [size(table)]), added)
  end subroutine

  ! Axis k of a table of this extent along it. Fortran's first index varies fastest, the ABI's last axis.
  subroutine set_axis(added, k, axis, points, extent)
    type(value), intent(inout) :: added
    integer, intent(in) :: k, extent
    character(*), intent(in) :: axis
    real(c_double), intent(in) :: points(:)
    integer :: place
    place = size(added%axes) + 1 - k
    added%axes(place)%name = trim(axis)//c_null_char
    added%axes(place)%points = points
    if (size(points) /= extent) added%fault = 'a table has one value per point of its axis '''//trim(axis)//''''
  end subroutine

  subroutine set_table(self, name, table, added)
    class(ilaw_values), intent(inout) :: self
    character(*), intent(in) :: name
    real(c_double), intent(in) :: table(:)
    type(value), intent(inout) :: added
    added%kind = ILAW_KIND_VALUE_TABLE
    added%table = table
    if (allocated(added%fault)) added%fault = 'parameter '''//trim(name)//''': '//added%fault
    call self%append(name, added)
  end subroutine

  subroutine set_per_node(self, name)
    class(ilaw_values), intent(inout) :: self
    character(*), intent(in) :: name
    type(value) :: added
    added%kind = ILAW_KIND_VALUE_PER_NODE
    call self%append(name, added)
  end subroutine

  ! Whether a value was set.
  logical function has(self, name)
    class(ilaw_values), intent(in) :: self
    character(*), intent(in) :: name
    integer :: k
    has = .false.
    if (.not. allocated(self%list)) return
    do k = 1, size(self%list)
      has = has .or. self%list(k)%name == trim(name)//c_null_char
    end do
  end function

  subroutine append(self, name, added)
    class(ilaw_values), intent(inout) :: self
    character(*), intent(in) :: name
    type(value), intent(in) :: added
    type(value), allocatable :: longer(:)
    integer :: count
    count = 0
    if (allocated(self%list)) count = size(self%list)
    allocate (longer(count + 1))
    if (count > 0) longer(:count) = self%list
    longer(count + 1) = added
    longer(count + 1)%name = trim(name)//c_null_char
    call move_alloc(longer, self%list)
  end subroutine

  ! The argument points into the value.
  function argument_of(given) result(argument)
    type(value), intent(inout), target :: given
    type(ilaw_argument) :: argument
    integer :: k
    argument%kind = given%kind
    argument%name = c_loc(given%name)
    argument%number = given%number
    if (allocated(given%text)) argument%text = c_loc(given%text)
    if (.not. allocated(given%table)) return
    allocate (given%axis(size(given%axes)), given%axis_pointers(size(given%axes)))
    do k = 1, size(given%axes)
      given%axis(k)%name = c_loc(given%axes(k)%name)
      given%axis(k)%points = c_loc(given%axes(k)%points)
      given%axis(k)%count = size(given%axes(k)%points)
      given%axis_pointers(k) = c_loc(given%axis(k))
    end do
    argument%values = c_loc(given%table)
    argument%axes = c_loc(given%axis_pointers)
    argument%axis_count = size(given%axes)
  end function

  ! Offers a field that the host has per node, such as a temperature: it is set per node where the law has a
  ! parameter of this name that is a field, and values has none of this name yet. id: as of ilaw_create.
  subroutine ilaw_offer_field(library, id, name, values)
    type(c_ptr), intent(in) :: library
    character(*), intent(in) :: id, name
    type(ilaw_values), intent(inout) :: values
    type(ilaw_law), pointer :: law
    type(ilaw_parameter), pointer :: parameter
    type(c_ptr), pointer :: list(:)
    integer :: k
    law => law_in(library, id)
    if (.not. associated(law) .or. values%has(name)) return
    call c_f_pointer(law%parameters, list, [law%parameter_count])
    do k = 1, size(list)
      call c_f_pointer(list(k), parameter)
      if (ilaw_text(parameter%name) /= name) cycle
      if (iand(parameter%flags, ILAW_FLAG_FIELD) /= 0) call values%set_per_node(name)
    end do
  end subroutine

  function law_in(library, id) result(law)
    type(c_ptr), intent(in) :: library
    character(*), intent(in) :: id
    type(ilaw_law), pointer :: law
    type(ilaw_plugin), pointer :: plugin
    type(c_ptr), pointer :: list(:)
    integer :: k
    call c_f_pointer(ilaw_library_plugin(library), plugin)
    call c_f_pointer(plugin%laws, list, [plugin%law_count])
    do k = 1, size(list)
      call c_f_pointer(list(k), law)
      if (ilaw_text(law%id) == id .or. (len_trim(id) == 0 .and. size(list) == 1)) return
    end do
    nullify (law)
  end function

  subroutine add_input(self, name, place)
    class(ilaw_arrays), intent(inout) :: self
    character(*), intent(in) :: name
    type(ilaw_input), intent(in) :: place
    type(named_array), allocatable :: longer(:)
    integer :: count
    count = 0
    if (allocated(self%list)) count = size(self%list)
    allocate (longer(count + 1))
    if (count > 0) longer(:count) = self%list
    longer(count + 1)%name = trim(name)
    longer(count + 1)%place = place
    call move_alloc(longer, self%list)
  end subroutine

  subroutine add_doubles(self, name, a)
    class(ilaw_arrays), intent(inout) :: self
    character(*), intent(in) :: name
    real(c_double), intent(in), target :: a(:)
    call self%add_input(name, input_of_doubles(a))
  end subroutine

  subroutine add_floats(self, name, a)
    class(ilaw_arrays), intent(inout) :: self
    character(*), intent(in) :: name
    real(c_float), intent(in), target :: a(:)
    call self%add_input(name, input_of_floats(a))
  end subroutine

  ! Gives a batch the parameters that the interface has per node; other arrays in fields are not read. fields
  ! has the target attribute, lives as long as the batch and is not changed any more.
  integer(c_int32_t) function ilaw_use_fields(interface, batch, fields, message) result(code)
    type(c_ptr), intent(in) :: interface
    type(ilaw_batch), intent(inout) :: batch
    type(ilaw_arrays), intent(inout), target :: fields
    character(*), intent(out) :: message
    type(ilaw_instance_info) :: info
    type(c_ptr), pointer :: names(:)
    logical, allocatable :: used(:)
    integer :: missing
    message = ''
    batch%per_node_parameters = c_null_ptr
    code = ilaw_interface_info(interface, info)
    if (code /= ILAW_OK .or. info%per_node_parameter_count == 0) return
    call c_f_pointer(info%per_node_parameters, names, [info%per_node_parameter_count])
    call sorted(fields, names, used, missing)
    if (missing > 0) then
      code = ILAW_INVALID_ARGUMENT
      message = 'the law reads '''//ilaw_text(names(missing))//''' per node; expected an array of this name'
      return
    end if
    batch%per_node_parameters = c_loc(fields%in_order)
  end function

  ! Asks for amounts of the law, such as the heat of friction: a batch writes them to these arrays. An amount that
  ! this interface does not give is ILAW_UNSUPPORTED. amounts: as the fields of ilaw_use_fields.
  integer(c_int32_t) function ilaw_use_amounts(interface, batch, amounts, message) result(code)
    type(c_ptr), intent(in) :: interface
    type(ilaw_batch), intent(inout) :: batch
    type(ilaw_arrays), intent(inout), target :: amounts
    character(*), intent(out) :: message
    type(ilaw_instance_info) :: info
    type(ilaw_amount), pointer :: amount
    type(c_ptr), pointer :: list(:)
    type(c_ptr), allocatable :: names(:)
    logical, allocatable :: used(:)
    integer :: k, missing
    message = ''
    batch%amounts = c_null_ptr
    code = ilaw_interface_info(interface, info)
    if (code /= ILAW_OK) return
    allocate (names(info%amount_count))
    if (size(names) > 0) call c_f_pointer(info%amounts, list, [info%amount_count])
    do k = 1, size(names)
      call c_f_pointer(list(k), amount)
      names(k) = amount%name
    end do
    call sorted(amounts, names, used, missing)
    if (.not. all(used)) then
      code = ILAW_UNSUPPORTED
      k = findloc(used, .false., 1)
      message = 'the law gives no amount '''//amounts%list(k)%name//''' with these parameters'
      return
    end if
    ! An ilaw_output has the members of an ilaw_input.
    if (size(used) > 0) batch%amounts = c_loc(amounts%in_order)
  end function

  ! Sorts arrays as the names are; absent where there is none, and missing is the last of these. used: by arrays.
  subroutine sorted(arrays, names, used, missing)
    type(ilaw_arrays), intent(inout) :: arrays
    type(c_ptr), intent(in) :: names(:)
    logical, allocatable, intent(out) :: used(:)
    integer, intent(out) :: missing
    logical :: found
    integer :: k, j
    if (.not. allocated(arrays%list)) allocate (arrays%list(0))
    if (allocated(arrays%in_order)) deallocate (arrays%in_order)
    allocate (arrays%in_order(size(names)))
    allocate (used(size(arrays%list)), source=.false.)
    missing = 0
    do k = 1, size(names)
      found = .false.
      do j = 1, size(used)
        if (arrays%list(j)%name /= ilaw_text(names(k))) cycle
        arrays%in_order(k) = arrays%list(j)%place
        used(j) = .true.
        found = .true.
      end do
      if (.not. found) missing = k
    end do
  end subroutine

  ! The text at a pointer of a description or a report; empty where the pointer is null.
  function ilaw_text(pointer) result(text)
    type(c_ptr), intent(in) :: pointer
    character(:), allocatable :: text
    character(kind=c_char), pointer :: characters(:)
    integer :: k, length
    interface
      integer(c_size_t) function c_strlen(text) bind(c, name='strlen')
        import :: c_size_t, c_ptr
        type(c_ptr), value :: text
      end function
    end interface

    text = ''
    if (.not. c_associated(pointer)) return
    length = int(c_strlen(pointer))
    call c_f_pointer(pointer, characters, [length])
    text = repeat(' ', length)
    do k = 1, length
      text(k:k) = characters(k)
    end do
  end function

  function input_of_doubles(a) result(input)
    real(c_double), intent(in), target :: a(:)
    type(ilaw_input) :: input
    if (size(a) > 0) input = input_at(c_loc(a(1)), c_loc(a(min(2, size(a)))), c_loc(a(1)), c_sizeof(a(1)))
  end function

  function input_of_floats(a) result(input)
    real(c_float), intent(in), target :: a(:)
    type(ilaw_input) :: input
    if (size(a) > 0) input = input_at(c_loc(a(1)), c_loc(a(min(2, size(a)))), c_loc(a(1)), c_sizeof(a(1)))
  end function

  function input_of_double_vectors(a, nodes_first) result(input)
    real(c_double), intent(in), target :: a(:, :)
    logical, intent(in), optional :: nodes_first
    type(ilaw_input) :: input
    if (size(a) > 0) input = input_at(c_loc(a(1, 1)), c_loc(a(1, min(2, size(a, 2)))), &
                                      c_loc(a(min(2, size(a, 1)), 1)), c_sizeof(a(1, 1)), nodes_first)
  end function

  function input_of_float_vectors(a, nodes_first) result(input)
    real(c_float), intent(in), target :: a(:, :)
    logical, intent(in), optional :: nodes_first
    type(ilaw_input) :: input
    if (size(a) > 0) input = input_at(c_loc(a(1, 1)), c_loc(a(1, min(2, size(a, 2)))), &
                                      c_loc(a(min(2, size(a, 1)), 1)), c_sizeof(a(1, 1)), nodes_first)
  end function

  function output_of_doubles(a) result(output)
    real(c_double), intent(inout), target :: a(:)
    type(ilaw_output) :: output
    output = output_at(input_of_doubles(a))
  end function

  function output_of_floats(a) result(output)
    real(c_float), intent(inout), target :: a(:)
    type(ilaw_output) :: output
    output = output_at(input_of_floats(a))
  end function

  function output_of_double_vectors(a, nodes_first) result(output)
    real(c_double), intent(inout), target :: a(:, :)
    logical, intent(in), optional :: nodes_first
    type(ilaw_output) :: output
    output = output_at(input_of_double_vectors(a, nodes_first))
  end function

  function output_of_float_vectors(a, nodes_first) result(output)
    real(c_float), intent(inout), target :: a(:, :)
    logical, intent(in), optional :: nodes_first
    type(ilaw_output) :: output
    output = output_at(input_of_float_vectors(a, nodes_first))
  end function

  function uniform_doubles(a) result(input)
    real(c_double), intent(in), target :: a(:)
    type(ilaw_input) :: input
    if (size(a) > 0) input = input_at(c_loc(a(1)), c_loc(a(1)), c_loc(a(min(2, size(a)))), c_sizeof(a(1)))
  end function

  function uniform_floats(a) result(input)
    real(c_float), intent(in), target :: a(:)
    type(ilaw_input) :: input
    if (size(a) > 0) input = input_at(c_loc(a(1)), c_loc(a(1)), c_loc(a(min(2, size(a)))), c_sizeof(a(1)))
  end function

  ! Strides come from the addresses of the first element, its right and its lower neighbour, so that any section
  ! goes in without a copy. The size of an element tells doubles from floats.
  function input_at(first, node, component, bytes, nodes_first) result(input)
    type(c_ptr), intent(in) :: first, node, component
    integer(c_size_t), intent(in) :: bytes
    logical, intent(in), optional :: nodes_first
    type(ilaw_input) :: input
    integer(c_int64_t) :: strides(2)
    strides = [address(node) - address(first), address(component) - address(first)]/bytes
    if (present(nodes_first)) then
      if (nodes_first) strides = strides([2, 1])
    end if
    if (bytes == c_sizeof(0._c_double)) input%values = first
    if (bytes == c_sizeof(0._c_float)) input%floats = first
    input%node_stride = strides(1)
    input%component_stride = strides(2)
  end function

  function output_at(input) result(output)
    type(ilaw_input), intent(in) :: input
    type(ilaw_output) :: output
    output = ilaw_output(input%values, input%floats, input%node_stride, input%component_stride)
  end function

  integer(c_intptr_t) function address(pointer)
    type(c_ptr), intent(in) :: pointer
    address = transfer(pointer, address)
  end function

  subroutine use_nodes_32(batch, nodes)
    type(ilaw_batch), intent(inout) :: batch
    integer(c_int32_t), intent(in), target, contiguous :: nodes(:)
    batch%node_count = size(nodes, kind=c_int64_t)
    batch%index = c_null_ptr
    if (size(nodes) > 0) batch%index = c_loc(nodes)
    batch%index64 = c_null_ptr
  end subroutine

  subroutine use_nodes_64(batch, nodes)
    type(ilaw_batch), intent(inout) :: batch
    integer(c_int64_t), intent(in), target, contiguous :: nodes(:)
    batch%node_count = size(nodes, kind=c_int64_t)
    batch%index = c_null_ptr
    batch%index64 = c_null_ptr
    if (size(nodes) > 0) batch%index64 = c_loc(nodes)
  end subroutine

  function blank_padded(line) result(text)
    character(*), intent(in) :: line
    character(:), allocatable :: text
    text = line(:index(line, c_null_char) - 1)
  end function
end module ilaw
