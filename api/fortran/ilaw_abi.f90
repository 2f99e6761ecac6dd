! ilaw_abi.f90 - the structs and constants of <ilaw/ilaw.h>, ABI 1.0, for Fortran 2008.
!
! Every type is interoperable with the C struct of the same name, member for member; ilaw.h says what each
! means, in which unit and who owns it. struct_size has its value already, and every pointer is null, in a
! variable that is merely declared. Text is a pointer to a C string: ilaw_text (module ilaw) reads it.
!
! SPDX-License-Identifier: BSD-3-Clause
module ilaw_abi
  use, intrinsic :: iso_c_binding, only: c_int8_t, c_int16_t, c_int32_t, c_int64_t, c_double, c_size_t, &
                                         c_char, c_ptr, c_funptr, c_null_ptr, c_null_funptr
  implicit none
  public

  integer(c_int32_t), parameter :: ILAW_ABI_MAJOR = 1, ILAW_ABI_MINOR = 0

  ! What a function returns.
  integer(c_int32_t), parameter :: &
    ILAW_OK = 0, ILAW_BAD_NODES = 1, ILAW_INVALID_ARGUMENT = -1, ILAW_INVALID_PARAMETER = -2, &
    ILAW_UNSUPPORTED = -3, ILAW_OUT_OF_MEMORY = -4, ILAW_NOT_FOUND = -5, ILAW_BAD_LIBRARY = -6

  ! Dimensions served, a bit mask.
  integer(c_int32_t), parameter :: ILAW_DIMENSION_1 = 2, ILAW_DIMENSION_2 = 4, ILAW_DIMENSION_3 = 8

  ! Form of H at a node, one bit each in masks.
  integer(c_int32_t), parameter :: &
    ILAW_DELASSUS_SCALAR = 1, ILAW_DELASSUS_DIAGONAL = 2, ILAW_DELASSUS_FULL = 4, &
    ILAW_DELASSUS_TRANSVERSE = 8

  ! Axes of vectors and of H.
  integer(c_int32_t), parameter :: ILAW_FRAME_LOCAL = 0, ILAW_FRAME_GLOBAL = 1

  ! Arrays of a batch that a law reads, a bit mask.
  integer(c_int32_t), parameter :: &
    ILAW_INPUT_GAP = 1, ILAW_INPUT_V_PREVIOUS = 2, ILAW_INPUT_AREA = 4, ILAW_INPUT_NORMAL = 8, &
    ILAW_INPUT_TANGENT = 16

  ! Optional arrays that a law can write, a bit mask.
  integer(c_int32_t), parameter :: ILAW_OUTPUT_VELOCITY = 1, ILAW_OUTPUT_STATUS = 2, ILAW_OUTPUT_ENERGY = 4

  ! What more a law can do, a bit mask.
  integer(c_int32_t), parameter :: &
    ILAW_CAN_ADHERE = 1, ILAW_CAN_STORE_ENERGY = 2, ILAW_CAN_ACT_AT_DISTANCE = 4, ILAW_CAN_REST = 8

  ! Kind of a parameter, how its value is given, and ways to give it besides a constant (a bit mask).
  integer(c_int32_t), parameter :: &
    ILAW_PARAMETER_NUMBER = 0, ILAW_PARAMETER_COUNT = 1, ILAW_PARAMETER_CHOICE = 2
  integer(c_int32_t), parameter :: &
    ILAW_VALUE_NUMBER = 0, ILAW_VALUE_TEXT = 1, ILAW_VALUE_TABLE = 2, ILAW_VALUE_PER_NODE = 3
  integer(c_int32_t), parameter :: ILAW_MAY_BE_TABLE = 1, ILAW_MAY_BE_PER_NODE = 2

  ! Kind of a state variable, and flags of one (a bit mask).
  integer(c_int32_t), parameter :: &
    ILAW_STATE_SCALAR = 0, ILAW_STATE_VECTOR = 1, ILAW_STATE_HISTORY = 2, ILAW_STATE_AXIS = 3, &
    ILAW_STATE_TANGENTIAL = 4
  integer(c_int32_t), parameter :: ILAW_VARIABLE_INTERNAL = 1

  ! Status of a node after a step.
  integer(c_int32_t), parameter :: &
    ILAW_FREE = 0, ILAW_CLOSED = 1, ILAW_STICK = 2, ILAW_SLIP = 3, ILAW_BONDED = 4, ILAW_BROKEN = 5, &
    ILAW_HEALED = 6, ILAW_BAD_INPUT = 7, ILAW_STATUS_COUNT = 8

  ! Components of the energy output, counted from 0 as in C.
  integer(c_int32_t), parameter :: &
    ILAW_ENERGY_FRICTION = 0, ILAW_ENERGY_IMPACT = 1, ILAW_ENERGY_RUPTURE = 2, ILAW_ENERGY_STORED = 3, &
    ILAW_ENERGY_COUNT = 4

  type, bind(c) :: ilaw_parameter
    integer(c_int32_t) :: struct_size = 96, kind = 0
    type(c_ptr) :: name = c_null_ptr, symbol = c_null_ptr, unit = c_null_ptr, doc = c_null_ptr
    real(c_double) :: minimum = 0, maximum = 0, default_value = 0
    integer(c_int32_t) :: required = 0, minimum_excluded = 0, infinity_allowed = 0, may_be = 0
    type(c_ptr) :: choices = c_null_ptr ! choice_count pointers to text
    integer(c_int32_t) :: choice_count = 0, reserved = 0
  end type

  type, bind(c) :: ilaw_state_variable
    integer(c_int32_t) :: struct_size = 48, kind = 0
    type(c_ptr) :: name = c_null_ptr, unit = c_null_ptr, doc = c_null_ptr
    integer(c_int64_t) :: count = 0
    integer(c_int32_t) :: flags = 0, reserved = 0
  end type

  type, bind(c) :: ilaw_argument
    integer(c_int32_t) :: struct_size = 48, kind = 0
    type(c_ptr) :: name = c_null_ptr
    real(c_double) :: number = 0
    type(c_ptr) :: text = c_null_ptr, values = c_null_ptr
    integer(c_int64_t) :: count = 0
  end type

  type, bind(c) :: ilaw_setup
    integer(c_int32_t) :: struct_size = 40
    integer(c_int32_t) :: dimension = 3, delassus_form = ILAW_DELASSUS_SCALAR, frame = ILAW_FRAME_LOCAL
    integer(c_int64_t) :: flags = 0
    type(c_ptr) :: arguments = c_null_ptr ! argument_count pointers to ilaw_argument; ilaw_create fills it
    integer(c_int32_t) :: argument_count = 0, tangent_given = 0
  end type

  type, bind(c) :: ilaw_instance_info
    integer(c_int32_t) :: struct_size = 56
    integer(c_int32_t) :: inputs = 0, energy_inputs = 0, state_variable_count = 0
    integer(c_int64_t) :: state_size = 0
    type(c_ptr) :: state_variables = c_null_ptr     ! state_variable_count pointers to ilaw_state_variable
    type(c_ptr) :: per_node_parameters = c_null_ptr ! per_node_parameter_count pointers to text
    integer(c_int32_t) :: per_node_parameter_count = 0, capabilities = 0
    integer(c_int32_t) :: state_version = 0, reserved = 0
  end type

  type, bind(c) :: ilaw_input
    type(c_ptr) :: values = c_null_ptr
    integer(c_int64_t) :: node_stride = 0, component_stride = 0
  end type

  type, bind(c) :: ilaw_output
    type(c_ptr) :: values = c_null_ptr
    integer(c_int64_t) :: node_stride = 0, component_stride = 0
  end type

  ! index_base is 1 here, for indices that count from 1 as Fortran's do. A list of nodes is given as index, of
  ! integer(c_int32_t), or as index64, of integer(c_int64_t), for codes built with integers of 8 bytes; not both.
  type, bind(c) :: ilaw_batch
    integer(c_int32_t) :: struct_size = 400, index_base = 1
    integer(c_int64_t) :: flags = 0
    integer(c_int64_t) :: node_count = 0
    type(c_ptr) :: index = c_null_ptr, index64 = c_null_ptr
    real(c_double) :: time = 0, velocity_step = 0, position_step = 0
    type(ilaw_input) :: v_free, delassus, gap, gap_offset, v_previous, area, normal, tangent
    type(c_ptr) :: per_node_parameters = c_null_ptr ! array of ilaw_input
    type(ilaw_input) :: state_in
    type(ilaw_output) :: state_out, impulse, velocity, energy
    type(c_ptr) :: status = c_null_ptr ! array of integer(c_int8_t)
    integer(c_int64_t) :: status_stride = 0
  end type

  type, bind(c) :: ilaw_report
    integer(c_int32_t) :: struct_size = 40, reserved = 0
    integer(c_int64_t) :: bad_count = 0
    integer(c_int64_t) :: first_bad_node = -1 ! counted from 0, whatever index_base is
    type(c_ptr) :: reason = c_null_ptr
    real(c_double) :: stable_velocity_step = 0 ! infinity: any; 0: the library did not say
  end type

  ! A law; ilaw_interface_info, _initialise and _evaluate (module ilaw) call its functions.
  type, bind(c) :: ilaw_law
    integer(c_int32_t) :: struct_size = 136
    integer(c_int32_t) :: dimensions = 0, delassus_forms = 0, inputs = 0, outputs = 0, capabilities = 0
    type(c_ptr) :: id = c_null_ptr, title = c_null_ptr, doc = c_null_ptr
    type(c_ptr) :: references = c_null_ptr, parameters = c_null_ptr, state_variables = c_null_ptr
    integer(c_int32_t) :: reference_count = 0, parameter_count = 0, state_variable_count = 0, reserved = 0
    type(c_funptr) :: create = c_null_funptr, destroy = c_null_funptr, info = c_null_funptr
    type(c_funptr) :: initialise = c_null_funptr, evaluate = c_null_funptr
    type(c_funptr) :: extension = c_null_funptr
  end type

  type, bind(c) :: ilaw_plugin
    integer(c_int32_t) :: struct_size = 64
    integer(c_int16_t) :: abi_major = 1, abi_minor = 0
    type(c_ptr) :: name = c_null_ptr, version = c_null_ptr, vendor = c_null_ptr, licence = c_null_ptr
    type(c_ptr) :: laws = c_null_ptr ! law_count pointers to ilaw_law
    integer(c_int32_t) :: law_count = 0, reserved = 0
    type(c_funptr) :: extension = c_null_funptr
  end type
end module ilaw_abi
