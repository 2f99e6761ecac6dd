"""The structs and constants of <ilaw/ilaw.h>, ABI 1.0, for ctypes.

Member for member as the header has them, which says what each means, in which unit and who owns it.
A test compares sizes, places and values with the C compiler's.
"""
from __future__ import annotations

import ctypes
from ctypes import POINTER, c_char_p, c_double, c_int32, c_int64, c_size_t, c_uint8, c_uint16, c_uint32, c_uint64
from ctypes import c_void_p
from enum import IntEnum, IntFlag

ABI_MAJOR, ABI_MINOR = 1, 0


class Code(IntEnum):
    """What a function returns."""

    OK = 0
    BAD_NODES = 1
    INVALID_ARGUMENT = -1
    INVALID_PARAMETER = -2
    UNSUPPORTED = -3
    OUT_OF_MEMORY = -4
    NOT_FOUND = -5
    BAD_LIBRARY = -6


class Dimension(IntFlag):
    ONE = 2
    TWO = 4
    THREE = 8


class Delassus(IntFlag):
    """Form of the inverse mass H at a node; see ilaw.h for the order of its components."""

    SCALAR = 1
    DIAGONAL = 2
    FULL = 4
    TRANSVERSE = 8


class Frame(IntEnum):
    LOCAL = 0
    GLOBAL = 1


class Named(IntFlag):
    """Printed by its names, as `ilaw describe` does."""

    def __str__(self) -> str:
        return ", ".join(str(flag.name).lower() for flag in type(self) if flag in self)


class Input(Named):
    """Arrays of a batch that a law reads besides v_free and delassus."""

    GAP = 1
    V_PREVIOUS = 2
    AREA = 4
    NORMAL = 8
    TANGENT = 16


class Output(Named):
    VELOCITY = 1
    STATUS = 2
    ENERGY = 4


class Capability(Named):
    ADHERE = 1
    STORE_ENERGY = 2
    ACT_AT_DISTANCE = 4
    REST = 8


class ParameterKind(IntEnum):
    NUMBER = 0
    COUNT = 1
    CHOICE = 2


class ValueKind(IntEnum):
    NUMBER = 0
    TEXT = 1
    TABLE = 2
    PER_NODE = 3


class MayBe(Named):
    TABLE = 1
    PER_NODE = 2


class StateKind(IntEnum):
    SCALAR = 0
    VECTOR = 1
    HISTORY = 2
    AXIS = 3
    TANGENTIAL = 4


class VariableFlag(IntFlag):
    INTERNAL = 1


class Status(IntEnum):
    """What happened at a node in the last step."""

    FREE = 0
    CLOSED = 1
    STICK = 2
    SLIP = 3
    BONDED = 4
    BROKEN = 5
    HEALED = 6
    BAD_INPUT = 7


STATUS_COUNT = 8


class Energy(IntEnum):
    """Column of the energy output."""

    FRICTION = 0
    IMPACT = 1
    RUPTURE = 2
    STORED = 3


ENERGY_COUNT = 4


class parameter(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("kind", c_uint32),
        ("name", c_char_p),
        ("symbol", c_char_p),
        ("unit", c_char_p),
        ("doc", c_char_p),
        ("minimum", c_double),
        ("maximum", c_double),
        ("default_value", c_double),
        ("required", c_uint32),
        ("minimum_excluded", c_uint32),
        ("infinity_allowed", c_uint32),
        ("may_be", c_uint32),
        ("choices", POINTER(c_char_p)),
        ("choice_count", c_uint32),
        ("reserved", c_uint32),
    ]


class state_variable(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("kind", c_uint32),
        ("name", c_char_p),
        ("unit", c_char_p),
        ("doc", c_char_p),
        ("count", c_uint64),
        ("flags", c_uint32),
        ("reserved", c_uint32),
    ]


class argument(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("kind", c_uint32),
        ("name", c_char_p),
        ("number", c_double),
        ("text", c_char_p),
        ("values", POINTER(c_double)),
        ("count", c_uint64),
    ]


class setup(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("dimension", c_uint32),
        ("delassus_form", c_uint32),
        ("frame", c_uint32),
        ("flags", c_uint64),
        ("arguments", POINTER(POINTER(argument))),
        ("argument_count", c_uint32),
        ("tangent_given", c_uint32),
    ]


class instance_info(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("inputs", c_uint32),
        ("energy_inputs", c_uint32),
        ("state_variable_count", c_uint32),
        ("state_size", c_uint64),
        ("state_variables", POINTER(POINTER(state_variable))),
        ("per_node_parameters", POINTER(c_char_p)),
        ("per_node_parameter_count", c_uint32),
        ("capabilities", c_uint32),
        ("state_version", c_uint32),
        ("reserved", c_uint32),
    ]


class input(ctypes.Structure):
    _fields_ = [("values", c_void_p), ("node_stride", c_int64), ("component_stride", c_int64)]


class output(ctypes.Structure):
    _fields_ = [("values", c_void_p), ("node_stride", c_int64), ("component_stride", c_int64)]


class batch(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("index_base", c_int32),
        ("flags", c_uint64),
        ("node_count", c_int64),
        ("index", c_void_p),
        ("index64", c_void_p),
        ("time", c_double),
        ("velocity_step", c_double),
        ("position_step", c_double),
        ("v_free", input),
        ("delassus", input),
        ("gap", input),
        ("gap_offset", input),
        ("v_previous", input),
        ("area", input),
        ("normal", input),
        ("tangent", input),
        ("per_node_parameters", POINTER(input)),
        ("state_in", input),
        ("state_out", output),
        ("impulse", output),
        ("velocity", output),
        ("energy", output),
        ("status", c_void_p),
        ("status_stride", c_int64),
    ]


class report(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("bad_count", c_int64),
        ("first_bad_node", c_int64),
        ("reason", c_char_p),
        ("stable_velocity_step", c_double),
    ]


class law(ctypes.Structure):
    # The functions are called through the loader, so their places are all that is told here.
    _fields_ = [
        ("struct_size", c_uint32),
        ("dimensions", c_uint32),
        ("delassus_forms", c_uint32),
        ("inputs", c_uint32),
        ("outputs", c_uint32),
        ("capabilities", c_uint32),
        ("id", c_char_p),
        ("title", c_char_p),
        ("doc", c_char_p),
        ("references", POINTER(c_char_p)),
        ("parameters", POINTER(POINTER(parameter))),
        ("state_variables", POINTER(POINTER(state_variable))),
        ("reference_count", c_uint32),
        ("parameter_count", c_uint32),
        ("state_variable_count", c_uint32),
        ("reserved", c_uint32),
        ("create", c_void_p),
        ("destroy", c_void_p),
        ("info", c_void_p),
        ("initialise", c_void_p),
        ("evaluate", c_void_p),
        ("extension", c_void_p),
    ]


class plugin(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("abi_major", c_uint16),
        ("abi_minor", c_uint16),
        ("name", c_char_p),
        ("version", c_char_p),
        ("vendor", c_char_p),
        ("licence", c_char_p),
        ("laws", POINTER(POINTER(law))),
        ("law_count", c_uint32),
        ("reserved", c_uint32),
        ("extension", c_void_p),
    ]


def sized(struct: type[ctypes.Structure]) -> ctypes.Structure:
    """A zeroed struct with its size set."""
    made = struct()
    made.struct_size = ctypes.sizeof(struct)
    return made


SIGNATURES = {
    "ilaw_library_open": (c_int32, [c_char_p, POINTER(c_void_p), c_char_p, c_size_t]),
    "ilaw_library_close": (None, [c_void_p]),
    "ilaw_library_plugin": (POINTER(plugin), [c_void_p]),
    "ilaw_library_path": (c_char_p, [c_void_p]),
    "ilaw_interface_create": (c_int32, [c_void_p, c_char_p, POINTER(setup), POINTER(c_void_p), c_char_p, c_size_t]),
    "ilaw_interface_destroy": (None, [c_void_p]),
    "ilaw_interface_law": (POINTER(law), [c_void_p]),
    "ilaw_interface_instance": (c_void_p, [c_void_p]),
    "ilaw_interface_info": (c_int32, [c_void_p, POINTER(instance_info)]),
    "ilaw_interface_initialise": (c_int32, [c_void_p, POINTER(batch), POINTER(report)]),
    "ilaw_interface_evaluate": (c_int32, [c_void_p, POINTER(batch), POINTER(report)]),
    "ilaw_search": (c_int32, [ctypes.CFUNCTYPE(c_int32, c_char_p, c_void_p), c_void_p]),
    "ilaw_search_path": (c_size_t, [c_char_p, c_size_t]),
}
