! ilaw_abi.f90 - structs, constants and functions of the ABI and the loader, for Fortran 2008.
!
! Made by api/bindings/generate.py from <ilaw/ilaw.h>, <ilaw/loader.h>: do not edit, change the header and
! run the script. The header says what each member means, in which unit and who owns it. Every type is
! interoperable with the C struct of the same name on 64-bit machines. Declared variables have their struct_size,
! null pointers and index_base 1. Texts are pointers to C strings: ilaw_text (module ilaw) reads them.
!
! SPDX-License-Identifier: BSD-3-Clause
module ilaw_abi
  use, intrinsic :: iso_c_binding
  implicit none
  public

  integer(c_int32_t), parameter :: &
    ILAW_ABI_MAJOR = 1, ILAW_ABI_MINOR = 0, ILAW_STACK_SIZE = 65536

  integer(c_int32_t), parameter :: &
    ILAW_OK = 0, ILAW_BAD_NODES = 1, ILAW_INVALID_ARGUMENT = -1, ILAW_INVALID_PARAMETER = -2, &
    ILAW_UNSUPPORTED = -3, ILAW_OUT_OF_MEMORY = -4, ILAW_NOT_FOUND = -5, ILAW_BAD_LIBRARY = -6

  integer(c_int32_t), parameter :: &
    ILAW_DIMENSION_1 = 2, ILAW_DIMENSION_2 = 4, ILAW_DIMENSION_3 = 8

  integer(c_int32_t), parameter :: &
    ILAW_DELASSUS_SCALAR = 1, ILAW_DELASSUS_DIAGONAL = 2, ILAW_DELASSUS_FULL = 4, &
    ILAW_DELASSUS_TRANSVERSE = 8, ILAW_DELASSUS_TRANSVERSE_SPIN = 16

  integer(c_int32_t), parameter :: &
    ILAW_FRAME_LOCAL = 1, ILAW_FRAME_GLOBAL = 2

  integer(c_int32_t), parameter :: &
    ILAW_NUMBERS_DOUBLE = 1, ILAW_NUMBERS_FLOAT = 2

  integer(c_int32_t), parameter :: &
    ILAW_INPUT_GAP = 1, ILAW_INPUT_V_PREVIOUS = 2, ILAW_INPUT_AREA = 4, ILAW_INPUT_NORMAL = 8, &
    ILAW_INPUT_TANGENT = 16, ILAW_INPUT_V_SMOOTH = 32

  integer(c_int32_t), parameter :: &
    ILAW_OUTPUT_VELOCITY = 1, ILAW_OUTPUT_STATUS = 2, ILAW_OUTPUT_ENERGY = 4

  integer(c_int32_t), parameter :: &
    ILAW_CAN_ADHERE = 1, ILAW_CAN_STORE_ENERGY = 2, ILAW_CAN_HOLD_BONDS = 4

  integer(c_int32_t), parameter :: &
    ILAW_BATCH_HOLD_BONDS = 1, ILAW_BATCH_BREAK_BONDS = 2

  integer(c_int32_t), parameter :: &
    ILAW_MAY_SKIP_FRESH = 1, ILAW_MAY_SKIP_FREE = 2

  integer(c_int32_t), parameter :: &
    ILAW_KIND_NUMBER = 0, ILAW_KIND_INTEGER = 1, ILAW_KIND_CHOICE = 2

  integer(c_int32_t), parameter :: &
    ILAW_FLAG_REQUIRED = 1, ILAW_FLAG_EXCLUDES_MINIMUM = 2, ILAW_FLAG_ALLOWS_INFINITY = 4, &
    ILAW_FLAG_ALLOWS_PER_NODE = 8, ILAW_FLAG_FIELD = 16, ILAW_FLAG_NEEDS_SPINS = 32

  integer(c_int32_t), parameter :: &
    ILAW_KIND_VALUE_NUMBER = 0, ILAW_KIND_VALUE_TEXT = 1, ILAW_KIND_VALUE_TABLE = 2, &
    ILAW_KIND_VALUE_PER_NODE = 3

  integer(c_int32_t), parameter :: &
    ILAW_KIND_SCALAR = 0, ILAW_KIND_VECTOR = 1, ILAW_KIND_HISTORY = 2, ILAW_KIND_AXIS = 3, &
    ILAW_KIND_TANGENTIAL = 4

  integer(c_int32_t), parameter :: &
    ILAW_FLAG_INTERNAL = 1

  integer(c_int32_t), parameter :: &
    ILAW_FREE = 0, ILAW_CLOSED = 1, ILAW_STICK = 2, ILAW_SLIP = 3, ILAW_BONDED = 4, ILAW_BROKEN = 5, &
    ILAW_HEALED = 6, ILAW_BAD_INPUT = 7, ILAW_STATUS_COUNT = 8

  integer(c_int32_t), parameter :: &
    ILAW_ENERGY_FRICTION = 0, ILAW_ENERGY_IMPACT = 1, ILAW_ENERGY_RUPTURE = 2, ILAW_ENERGY_STORED = 3, &
    ILAW_ENERGY_COUNT = 4

  integer(c_int32_t), parameter :: &
    ILAW_TABLE_MAX_VALUES = 16777216

  type, bind(c) :: ilaw_parameter
    integer(c_int32_t) :: struct_size = 96
    integer(c_int32_t) :: kind = 0
    type(c_ptr) :: name = c_null_ptr
    type(c_ptr) :: symbol = c_null_ptr
    type(c_ptr) :: unit = c_null_ptr
    type(c_ptr) :: doc = c_null_ptr
    real(c_double) :: minimum = 0
    real(c_double) :: maximum = 0
    real(c_double) :: default_value = 0
    integer(c_int32_t) :: flags = 0
    integer(c_int32_t) :: choice_count = 0
    type(c_ptr) :: choices = c_null_ptr
    type(c_ptr) :: axes = c_null_ptr
    integer(c_int32_t) :: axis_count = 0
    integer(c_int32_t) :: reserved = 0
  end type

  type, bind(c) :: ilaw_state_variable
    integer(c_int32_t) :: struct_size = 48
    integer(c_int32_t) :: kind = 0
    type(c_ptr) :: name = c_null_ptr
    type(c_ptr) :: unit = c_null_ptr
    type(c_ptr) :: doc = c_null_ptr
    integer(c_int64_t) :: count = 0
    integer(c_int32_t) :: flags = 0
    integer(c_int32_t) :: reserved = 0
  end type

  type, bind(c) :: ilaw_amount
    integer(c_int32_t) :: struct_size = 32
    integer(c_int32_t) :: reserved = 0
    type(c_ptr) :: name = c_null_ptr
    type(c_ptr) :: unit = c_null_ptr
    type(c_ptr) :: doc = c_null_ptr
  end type

  type, bind(c) :: ilaw_axis
    integer(c_int32_t) :: struct_size = 32
    integer(c_int32_t) :: reserved = 0
    type(c_ptr) :: name = c_null_ptr
    type(c_ptr) :: points = c_null_ptr
    integer(c_int64_t) :: count = 0
  end type

  type, bind(c) :: ilaw_argument
    integer(c_int32_t) :: struct_size = 56
    integer(c_int32_t) :: kind = 0
    type(c_ptr) :: name = c_null_ptr
    real(c_double) :: number = 0
    type(c_ptr) :: text = c_null_ptr
    type(c_ptr) :: values = c_null_ptr
    type(c_ptr) :: axes = c_null_ptr
    integer(c_int32_t) :: axis_count = 0
    integer(c_int32_t) :: reserved = 0
  end type

  type, bind(c) :: ilaw_setup
    integer(c_int32_t) :: struct_size = 48
    integer(c_int32_t) :: dimension = 0
    integer(c_int32_t) :: delassus_form = 0
    integer(c_int32_t) :: frame = 0
    integer(c_int64_t) :: flags = 0
    type(c_ptr) :: arguments = c_null_ptr
    integer(c_int32_t) :: argument_count = 0
    integer(c_int32_t) :: has_tangent = 0
    integer(c_int32_t) :: numbers = ILAW_NUMBERS_DOUBLE
    integer(c_int32_t) :: reserved = 0
  end type

  type, bind(c) :: ilaw_instance_info
    integer(c_int32_t) :: struct_size = 72
    integer(c_int32_t) :: inputs = 0
    integer(c_int32_t) :: balance_inputs = 0
    integer(c_int32_t) :: state_variable_count = 0
    integer(c_int64_t) :: state_size = 0
    type(c_ptr) :: state_variables = c_null_ptr
    type(c_ptr) :: per_node_parameters = c_null_ptr
    integer(c_int32_t) :: per_node_parameter_count = 0
    integer(c_int32_t) :: capabilities = 0
    integer(c_int32_t) :: state_version = 0
    integer(c_int32_t) :: permissions = 0
    type(c_ptr) :: amounts = c_null_ptr
    integer(c_int32_t) :: amount_count = 0
    integer(c_int32_t) :: reserved = 0
  end type

  type, bind(c) :: ilaw_input
    type(c_ptr) :: values = c_null_ptr
    type(c_ptr) :: floats = c_null_ptr
    integer(c_int64_t) :: node_stride = 0
    integer(c_int64_t) :: component_stride = 0
  end type

  type, bind(c) :: ilaw_output
    type(c_ptr) :: values = c_null_ptr
    type(c_ptr) :: floats = c_null_ptr
    integer(c_int64_t) :: node_stride = 0
    integer(c_int64_t) :: component_stride = 0
  end type

  type, bind(c) :: ilaw_batch
    integer(c_int32_t) :: struct_size = 672
    integer(c_int32_t) :: index_base = 1
    integer(c_int64_t) :: flags = 0
    integer(c_int64_t) :: node_count = 0
    type(c_ptr) :: index = c_null_ptr
    type(c_ptr) :: index64 = c_null_ptr
    real(c_double) :: time = 0
    real(c_double) :: velocity_step = 0
    real(c_double) :: position_step = 0
    type(ilaw_input) :: v_free
    type(ilaw_input) :: v_smooth
    type(ilaw_input) :: delassus
    type(ilaw_input) :: gap
    type(ilaw_input) :: gap_offset
    type(ilaw_input) :: v_previous
    type(ilaw_input) :: spin_free
    type(ilaw_input) :: spin_previous
    type(ilaw_input) :: area
    type(ilaw_input) :: normal
    type(ilaw_input) :: tangent
    type(c_ptr) :: per_node_parameters = c_null_ptr
    type(ilaw_input) :: state_in
    type(ilaw_output) :: state_out
    type(ilaw_output) :: impulse
    type(ilaw_output) :: moment
    type(ilaw_output) :: velocity
    type(ilaw_output) :: spin
    type(ilaw_output) :: energy
    type(c_ptr) :: status = c_null_ptr
    integer(c_int64_t) :: status_stride = 0
    type(c_ptr) :: amounts = c_null_ptr
  end type

  type, bind(c) :: ilaw_report
    integer(c_int32_t) :: struct_size = 40
    integer(c_int32_t) :: reserved = 0
    integer(c_int64_t) :: bad_count = 0
    integer(c_int64_t) :: first_bad_node = -1
    type(c_ptr) :: reason = c_null_ptr
    real(c_double) :: stable_velocity_step = 0
  end type

  type, bind(c) :: ilaw_law
    integer(c_int32_t) :: struct_size = 160
    integer(c_int32_t) :: dimensions = 0
    integer(c_int32_t) :: delassus_forms = 0
    integer(c_int32_t) :: frames = 0
    integer(c_int32_t) :: numbers = 0
    integer(c_int32_t) :: inputs = 0
    integer(c_int32_t) :: outputs = 0
    integer(c_int32_t) :: capabilities = 0
    integer(c_int32_t) :: permissions = 0
    integer(c_int32_t) :: reserved = 0
    type(c_ptr) :: id = c_null_ptr
    type(c_ptr) :: title = c_null_ptr
    type(c_ptr) :: doc = c_null_ptr
    type(c_ptr) :: references = c_null_ptr
    type(c_ptr) :: parameters = c_null_ptr
    type(c_ptr) :: state_variables = c_null_ptr
    integer(c_int32_t) :: reference_count = 0
    integer(c_int32_t) :: parameter_count = 0
    integer(c_int32_t) :: state_variable_count = 0
    integer(c_int32_t) :: amount_count = 0
    type(c_ptr) :: amounts = c_null_ptr
    type(c_funptr) :: create = c_null_funptr
    type(c_funptr) :: destroy = c_null_funptr
    type(c_funptr) :: info = c_null_funptr
    type(c_funptr) :: initialise = c_null_funptr
    type(c_funptr) :: evaluate = c_null_funptr
    type(c_funptr) :: extension = c_null_funptr
  end type

  type, bind(c) :: ilaw_plugin
    integer(c_int32_t) :: struct_size = 64
    integer(c_int16_t) :: abi_major = ILAW_ABI_MAJOR
    integer(c_int16_t) :: abi_minor = ILAW_ABI_MINOR
    type(c_ptr) :: name = c_null_ptr
    type(c_ptr) :: version = c_null_ptr
    type(c_ptr) :: vendor = c_null_ptr
    type(c_ptr) :: licence = c_null_ptr
    type(c_ptr) :: laws = c_null_ptr
    integer(c_int32_t) :: law_count = 0
    integer(c_int32_t) :: reserved = 0
    type(c_funptr) :: extension = c_null_funptr
  end type

  abstract interface
    integer(c_int32_t) function ilaw_create_function(id, setup, instance, message, message_size) bind(c)
      import :: c_int32_t, c_ptr, c_size_t, ilaw_setup
      type(c_ptr), value :: id
      type(ilaw_setup), intent(in), target :: setup
      type(c_ptr), intent(out) :: instance
      type(c_ptr), value :: message
      integer(c_size_t), value :: message_size
    end function
    subroutine ilaw_destroy_function(instance) bind(c)
      import :: c_ptr
      type(c_ptr), value :: instance
    end subroutine
    integer(c_int32_t) function ilaw_info_function(instance, info) bind(c)
      import :: c_int32_t, c_ptr, ilaw_instance_info
      type(c_ptr), value :: instance
      type(ilaw_instance_info), intent(inout), target :: info
    end function
    integer(c_int32_t) function ilaw_batch_function(instance, batch, report) bind(c)
      import :: c_int32_t, c_ptr, ilaw_batch, ilaw_report
      type(c_ptr), value :: instance
      type(ilaw_batch), intent(in), target :: batch
      type(ilaw_report), intent(inout), target :: report
    end function
    type(c_ptr) function ilaw_extension_function(name) bind(c)
      import :: c_ptr
      type(c_ptr), value :: name
    end function
    type(c_ptr) function ilaw_entry_function() bind(c)
      import :: c_ptr
    end function
    integer(c_int32_t) function ilaw_visit_function(path, context) bind(c)
      import :: c_int32_t, c_ptr
      type(c_ptr), value :: path
      type(c_ptr), value :: context
    end function
  end interface

  interface
    integer(c_int32_t) function ilaw_library_open(name_or_path, library, message, message_size) &
      bind(c, name='ilaw_library_open')
      import :: c_int32_t, c_ptr, c_size_t
      type(c_ptr), value :: name_or_path
      type(c_ptr), intent(out) :: library
      type(c_ptr), value :: message
      integer(c_size_t), value :: message_size
    end function
    integer(c_int32_t) function ilaw_library_open_named(name, library, message, message_size) &
      bind(c, name='ilaw_library_open_named')
      import :: c_int32_t, c_ptr, c_size_t
      type(c_ptr), value :: name
      type(c_ptr), intent(out) :: library
      type(c_ptr), value :: message
      integer(c_size_t), value :: message_size
    end function
    integer(c_int32_t) function ilaw_library_read_description(name_or_path, buffer, size, length, message, message_size) &
      bind(c, name='ilaw_library_read_description')
      import :: c_int32_t, c_ptr, c_size_t
      type(c_ptr), value :: name_or_path
      type(c_ptr), value :: buffer
      integer(c_size_t), value :: size
      integer(c_size_t), intent(inout) :: length(*)
      type(c_ptr), value :: message
      integer(c_size_t), value :: message_size
    end function
    subroutine ilaw_library_close(library) bind(c, name='ilaw_library_close')
      import :: c_ptr
      type(c_ptr), value :: library
    end subroutine
    type(c_ptr) function ilaw_library_plugin(library) bind(c, name='ilaw_library_plugin')
      import :: c_ptr
      type(c_ptr), value :: library
    end function
    integer(c_size_t) function ilaw_library_describe(library, buffer, size) &
      bind(c, name='ilaw_library_describe')
      import :: c_ptr, c_size_t
      type(c_ptr), value :: library
      type(c_ptr), value :: buffer
      integer(c_size_t), value :: size
    end function
    type(c_ptr) function ilaw_library_path(library) bind(c, name='ilaw_library_path')
      import :: c_ptr
      type(c_ptr), value :: library
    end function
    type(c_ptr) function ilaw_library_law(library, id) bind(c, name='ilaw_library_law')
      import :: c_ptr
      type(c_ptr), value :: library
      type(c_ptr), value :: id
    end function
    integer(c_int32_t) function ilaw_interface_create(library, id, setup, interface, message, message_size) &
      bind(c, name='ilaw_interface_create')
      import :: c_int32_t, c_ptr, c_size_t, ilaw_setup
      type(c_ptr), value :: library
      type(c_ptr), value :: id
      type(ilaw_setup), intent(in), target :: setup
      type(c_ptr), intent(out) :: interface
      type(c_ptr), value :: message
      integer(c_size_t), value :: message_size
    end function
    subroutine ilaw_interface_destroy(interface) bind(c, name='ilaw_interface_destroy')
      import :: c_ptr
      type(c_ptr), value :: interface
    end subroutine
    type(c_ptr) function ilaw_interface_law(interface) bind(c, name='ilaw_interface_law')
      import :: c_ptr
      type(c_ptr), value :: interface
    end function
    type(c_ptr) function ilaw_interface_instance(interface) bind(c, name='ilaw_interface_instance')
      import :: c_ptr
      type(c_ptr), value :: interface
    end function
    integer(c_int32_t) function ilaw_interface_info(interface, info) bind(c, name='ilaw_interface_info')
      import :: c_int32_t, c_ptr, ilaw_instance_info
      type(c_ptr), value :: interface
      type(ilaw_instance_info), intent(inout), target :: info
    end function
    integer(c_int32_t) function ilaw_interface_initialise(interface, batch, report) &
      bind(c, name='ilaw_interface_initialise')
      import :: c_int32_t, c_ptr, ilaw_batch, ilaw_report
      type(c_ptr), value :: interface
      type(ilaw_batch), intent(in), target :: batch
      type(ilaw_report), intent(inout), target :: report
    end function
    integer(c_int32_t) function ilaw_interface_evaluate(interface, batch, report) &
      bind(c, name='ilaw_interface_evaluate')
      import :: c_int32_t, c_ptr, ilaw_batch, ilaw_report
      type(c_ptr), value :: interface
      type(ilaw_batch), intent(in), target :: batch
      type(ilaw_report), intent(inout), target :: report
    end function
    integer(c_int32_t) function ilaw_search(visit, context) bind(c, name='ilaw_search')
      import :: c_funptr, c_int32_t, c_ptr
      type(c_funptr), value :: visit
      type(c_ptr), value :: context
    end function
    integer(c_size_t) function ilaw_search_path(buffer, size) bind(c, name='ilaw_search_path')
      import :: c_ptr, c_size_t
      type(c_ptr), value :: buffer
      integer(c_size_t), value :: size
    end function
  end interface
end module ilaw_abi
