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
  private :: address, stride, blank_padded, argument_of, append, opened

  ! The value of a parameter of a law.
  type, private :: value
    integer(c_int32_t) :: kind = ILAW_VALUE_NUMBER
    character(:), allocatable :: name
    real(c_double) :: number = 0
    character(:), allocatable :: text
    real(c_double), allocatable :: pairs(:, :)
  end type

  ! The parameters of a law, for ilaw_create.
  !   call values%set('friction', 0.3_c_double)      a number
  !   call values%set('activation', 'moreau')        one of its choices
  !   call values%set('friction', pairs)             a table, (time, value) pairs of shape (2,n), times increasing
  !   call values%set_per_node('friction')           comes with every batch, one value per node
  type :: ilaw_values
    type(value), allocatable, private :: list(:)
  contains
    generic :: set => set_number, set_choice, set_table
    procedure :: set_per_node
    procedure, private :: set_number, set_choice, set_table, append
  end type

  ! An array of the host as an argument of a batch. The array needs the target (or pointer) attribute, is not
  ! copied, may be any section, and is used where it is for as long as the batch is.
  !   a(:)    one value per node
  !   a(:,:)  components first, (3,n); with nodes_first=.true. it is (n,3)
  interface ilaw_input_of
    procedure input_of_scalars, input_of_vectors
  end interface
  interface ilaw_output_of
    procedure output_of_scalars, output_of_vectors
  end interface

  ! Names the nodes of a batch: call ilaw_use_nodes(batch, nodes), with an array of integer(c_int32_t) or of
  ! integer(c_int64_t) that has the target attribute and lives as long as the batch; its size is node_count.
  interface ilaw_use_nodes
    procedure use_nodes_32, use_nodes_64
  end interface

  interface
    subroutine ilaw_library_close(library) bind(c, name='ilaw_library_close')
      import :: c_ptr
      type(c_ptr), value :: library
    end subroutine

    ! Pointer to an ilaw_plugin.
    type(c_ptr) function ilaw_library_plugin(library) bind(c, name='ilaw_library_plugin')
      import :: c_ptr
      type(c_ptr), value :: library
    end function

    ! Pointer to text.
    type(c_ptr) function ilaw_library_path(library) bind(c, name='ilaw_library_path')
      import :: c_ptr
      type(c_ptr), value :: library
    end function

    subroutine ilaw_interface_destroy(interface) bind(c, name='ilaw_interface_destroy')
      import :: c_ptr
      type(c_ptr), value :: interface
    end subroutine

    ! Pointer to an ilaw_law.
    type(c_ptr) function ilaw_interface_law(interface) bind(c, name='ilaw_interface_law')
      import :: c_ptr
      type(c_ptr), value :: interface
    end function

    integer(c_int32_t) function ilaw_interface_info(interface, info) bind(c, name='ilaw_interface_info')
      import :: c_int32_t, c_ptr, ilaw_instance_info
      type(c_ptr), value :: interface
      type(ilaw_instance_info), intent(inout) :: info
    end function

    integer(c_int32_t) function ilaw_interface_initialise(interface, batch, report) &
      bind(c, name='ilaw_interface_initialise')
      import :: c_int32_t, c_ptr, ilaw_batch, ilaw_report
      type(c_ptr), value :: interface
      type(ilaw_batch), intent(in) :: batch
      type(ilaw_report), intent(inout) :: report
    end function

    integer(c_int32_t) function ilaw_interface_evaluate(interface, batch, report) &
      bind(c, name='ilaw_interface_evaluate')
      import :: c_int32_t, c_ptr, ilaw_batch, ilaw_report
      type(c_ptr), value :: interface
      type(ilaw_batch), intent(in) :: batch
      type(ilaw_report), intent(inout) :: report
    end function
  end interface

  ! What the two functions of the loader that open a library have in common.
  abstract interface
    integer(c_int32_t) function ilaw_library_opener(name, library, message, message_size) bind(c)
      import :: c_int32_t, c_ptr, c_char, c_size_t
      character(kind=c_char), intent(in) :: name(*)
      type(c_ptr), intent(out) :: library
      character(kind=c_char), intent(out) :: message(*)
      integer(c_size_t), value :: message_size
    end function
  end interface

contains

  ! Opens a library by name or explicit path; null on failure. Trailing blanks of name do not count.
  integer(c_int32_t) function ilaw_open(name, library, message) result(code)
    character(*), intent(in) :: name
    type(c_ptr), intent(out) :: library
    character(*), intent(out) :: message
    procedure(ilaw_library_opener), bind(c, name='ilaw_library_open') :: ilaw_library_open
    code = opened(ilaw_library_open, name, library, message)
  end function

  ! The same by name alone, along the search path: for names that come from an input file.
  integer(c_int32_t) function ilaw_open_named(name, library, message) result(code)
    character(*), intent(in) :: name
    type(c_ptr), intent(out) :: library
    character(*), intent(out) :: message
    procedure(ilaw_library_opener), bind(c, name='ilaw_library_open_named') :: ilaw_library_open_named
    code = opened(ilaw_library_open_named, name, library, message)
  end function

  integer(c_int32_t) function opened(open, name, library, message) result(code)
    procedure(ilaw_library_opener) :: open
    character(*), intent(in) :: name
    type(c_ptr), intent(out) :: library
    character(*), intent(out) :: message
    character(len(message) + 1, c_char) :: line
    line = c_null_char
    code = open(trim(name)//c_null_char, library, line, len(line, c_size_t))
    message = blank_padded(line)
  end function

  ! Creates an interface with a law of the library, of the given id (blank: the library's only law). The
  ! arguments of the setup are those in values. Null on failure.
  integer(c_int32_t) function ilaw_create(library, id, setup, values, interface, message) result(code)
    type(c_ptr), intent(in) :: library
    character(*), intent(in) :: id
    type(ilaw_setup), intent(in) :: setup
    type(ilaw_values), intent(in), target :: values
    type(c_ptr), intent(out) :: interface
    character(*), intent(out) :: message
    interface
      integer(c_int32_t) function ilaw_interface_create(library, id, setup, interface, message, message_size) &
        bind(c, name='ilaw_interface_create')
        import :: c_int32_t, c_ptr, c_char, c_size_t, ilaw_setup
        type(c_ptr), value :: library, id
        type(ilaw_setup), intent(in) :: setup
        type(c_ptr), intent(out) :: interface
        character(kind=c_char), intent(out) :: message(*)
        integer(c_size_t), value :: message_size
      end function
    end interface
    type(ilaw_setup) :: filled
    type(ilaw_argument), allocatable, target :: arguments(:)
    type(c_ptr), allocatable, target :: argument_pointers(:)
    character(len_trim(id) + 1, c_char), target :: law
    character(len(message) + 1, c_char) :: line
    integer :: k

    filled = setup
    filled%argument_count = 0
    if (allocated(values%list)) filled%argument_count = size(values%list)
    allocate (arguments(filled%argument_count), argument_pointers(filled%argument_count))
    do k = 1, size(arguments)
      arguments(k) = argument_of(values%list(k))
      argument_pointers(k) = c_loc(arguments(k))
    end do
    filled%arguments = c_null_ptr
    if (size(arguments) > 0) filled%arguments = c_loc(argument_pointers)
    law = trim(id)//c_null_char
    line = c_null_char
    code = ilaw_interface_create(library, merge(c_loc(law), c_null_ptr, len_trim(id) > 0), filled, interface, &
                                 line, len(line, c_size_t))
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
    added%kind = ILAW_VALUE_TEXT
    added%text = trim(text)//c_null_char
    call self%append(name, added)
  end subroutine

  subroutine set_table(self, name, pairs)
    class(ilaw_values), intent(inout) :: self
    character(*), intent(in) :: name
    real(c_double), intent(in) :: pairs(:, :)
    type(value) :: added
    added%kind = ILAW_VALUE_TABLE
    allocate (added%pairs, source=pairs)
    call self%append(name, added)
  end subroutine

  subroutine set_per_node(self, name)
    class(ilaw_values), intent(inout) :: self
    character(*), intent(in) :: name
    type(value) :: added
    added%kind = ILAW_VALUE_PER_NODE
    call self%append(name, added)
  end subroutine

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
    type(value), intent(in), target :: given
    type(ilaw_argument) :: argument
    argument%kind = given%kind
    argument%name = c_loc(given%name)
    argument%number = given%number
    if (allocated(given%text)) argument%text = c_loc(given%text)
    if (allocated(given%pairs)) then
      argument%values = c_loc(given%pairs)
      argument%count = size(given%pairs, 2)
    end if
  end function

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

  function input_of_scalars(a) result(input)
    real(c_double), intent(in), target :: a(:)
    type(ilaw_input) :: input
    if (size(a) == 0) return
    input%values = c_loc(a(1))
    if (size(a) > 1) input%node_stride = stride(c_loc(a(1)), c_loc(a(2)))
  end function

  function input_of_vectors(a, nodes_first) result(input)
    real(c_double), intent(in), target :: a(:, :)
    logical, intent(in), optional :: nodes_first
    type(ilaw_input) :: input
    integer(c_int64_t) :: strides(2)
    if (size(a) == 0) return
    strides = 0
    if (size(a, 1) > 1) strides(1) = stride(c_loc(a(1, 1)), c_loc(a(2, 1)))
    if (size(a, 2) > 1) strides(2) = stride(c_loc(a(1, 1)), c_loc(a(1, 2)))
    if (present(nodes_first)) then
      if (nodes_first) strides = strides([2, 1])
    end if
    input = ilaw_input(c_loc(a(1, 1)), strides(2), strides(1))
  end function

  function output_of_scalars(a) result(output)
    real(c_double), intent(inout), target :: a(:)
    type(ilaw_output) :: output
    type(ilaw_input) :: same
    same = input_of_scalars(a)
    output = ilaw_output(same%values, same%node_stride, same%component_stride)
  end function

  function output_of_vectors(a, nodes_first) result(output)
    real(c_double), intent(inout), target :: a(:, :)
    logical, intent(in), optional :: nodes_first
    type(ilaw_output) :: output
    type(ilaw_input) :: same
    same = input_of_vectors(a, nodes_first)
    output = ilaw_output(same%values, same%node_stride, same%component_stride)
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

  ! One vector that is the same at every node, such as the normal of a plane.
  function ilaw_uniform(a) result(input)
    real(c_double), intent(in), target :: a(:)
    type(ilaw_input) :: input
    input = input_of_scalars(a)
    input%component_stride = input%node_stride
    input%node_stride = 0
  end function

  ! Doubles from one element to the next: asked of the addresses, so that any section goes in without a copy.
  integer(c_int64_t) function stride(first, second)
    type(c_ptr), intent(in) :: first, second
    stride = (address(second) - address(first))/(storage_size(0._c_double)/8)
  end function

  integer(c_intptr_t) function address(pointer)
    type(c_ptr), intent(in) :: pointer
    address = transfer(pointer, address)
  end function

  function blank_padded(line) result(text)
    character(*), intent(in) :: line
    character(:), allocatable :: text
    text = line(:index(line, c_null_char) - 1)
  end function
end module ilaw
