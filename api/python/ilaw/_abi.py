"""Structs, constants and functions of the ABI and the loader, for ctypes.

Made by api/bindings/generate.py from <ilaw/ilaw.h>, <ilaw/loader.h>: do not edit, change the header and run
the script. The header says what each member means, in which unit and who owns it. Names lose their `ilaw_` or `ILAW_`.
"""
from __future__ import annotations

import ctypes
from ctypes import CFUNCTYPE, POINTER
from ctypes import c_char_p, c_double, c_int32, c_int64, c_size_t, c_uint16, c_uint32, c_uint64, c_void_p
from enum import IntEnum, IntFlag

ABI_MAJOR = 1
ABI_MINOR = 0
STACK_SIZE = 65536
DIMENSION_1 = 2
DIMENSION_2 = 4
DIMENSION_3 = 8
BATCH_HOLD_BONDS = 1
BATCH_BREAK_BONDS = 2
STATUS_COUNT = 8
ENERGY_COUNT = 4
TABLE_MAX_VALUES = 16777216


class Flags(IntFlag):
    """Printed by its names, as `ilaw describe` does."""

    def __str__(self) -> str:
        return ", ".join(str(flag.name).lower() for flag in type(self) if flag in self)


class Code(IntEnum):
    """Codes that functions return."""

    OK = 0
    BAD_NODES = 1
    INVALID_ARGUMENT = -1
    INVALID_PARAMETER = -2
    UNSUPPORTED = -3
    OUT_OF_MEMORY = -4
    NOT_FOUND = -5
    BAD_LIBRARY = -6


class Delassus(Flags):
    """Form of the inverse mass H at a node."""

    SCALAR = 1
    DIAGONAL = 2
    FULL = 4
    TRANSVERSE = 8
    TRANSVERSE_SPIN = 16


class Frame(Flags):
    """Axes in which vectors and H are given."""

    LOCAL = 1
    GLOBAL = 2


class Numbers(Flags):
    """Number type of the arrays of a batch."""

    DOUBLE = 1
    FLOAT = 2


class Input(Flags):
    """Arrays that a law reads besides v_free and delassus."""

    GAP = 1
    V_PREVIOUS = 2
    AREA = 4
    NORMAL = 8
    TANGENT = 16
    V_SMOOTH = 32


class Output(Flags):
    """Optional arrays that a law can write."""

    VELOCITY = 1
    STATUS = 2
    ENERGY = 4


class Capability(Flags):
    """Further abilities of a law."""

    ADHERE = 1
    STORE_ENERGY = 2
    HOLD_BONDS = 4


class Permission(Flags):
    """Nodes out of reach that the host may skip."""

    SKIP_FRESH = 1
    SKIP_FREE = 2


class ParameterKind(IntEnum):
    """Kind of a parameter."""

    NUMBER = 0
    INTEGER = 1
    CHOICE = 2


class ParameterFlag(Flags):
    """Flags of a parameter."""

    REQUIRED = 1
    EXCLUDES_MINIMUM = 2
    ALLOWS_INFINITY = 4
    ALLOWS_PER_NODE = 8
    FIELD = 16
    NEEDS_SPINS = 32


class ValueKind(IntEnum):
    """How the value of a parameter is given."""

    NUMBER = 0
    TEXT = 1
    TABLE = 2
    PER_NODE = 3


class StateKind(IntEnum):
    """Kind of a state variable."""

    SCALAR = 0
    VECTOR = 1
    HISTORY = 2
    AXIS = 3
    TANGENTIAL = 4


class VariableFlag(Flags):
    """Flags of a state variable."""

    INTERNAL = 1


class Status(IntEnum):
    """State of a node after a step."""

    FREE = 0
    CLOSED = 1
    STICK = 2
    SLIP = 3
    BONDED = 4
    BROKEN = 5
    HEALED = 6
    BAD_INPUT = 7


class Energy(IntEnum):
    """Column of the energy output."""

    FRICTION = 0
    IMPACT = 1
    RUPTURE = 2
    STORED = 3


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
        ("flags", c_uint32),
        ("choice_count", c_uint32),
        ("choices", POINTER(c_char_p)),
        ("axes", POINTER(c_char_p)),
        ("axis_count", c_uint32),
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


class amount(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("name", c_char_p),
        ("unit", c_char_p),
        ("doc", c_char_p),
    ]


class axis(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("name", c_char_p),
        ("points", c_void_p),
        ("count", c_uint64),
    ]


class argument(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("kind", c_uint32),
        ("name", c_char_p),
        ("number", c_double),
        ("text", c_char_p),
        ("values", c_void_p),
        ("axes", POINTER(POINTER(axis))),
        ("axis_count", c_uint32),
        ("reserved", c_uint32),
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
        ("has_tangent", c_uint32),
        ("numbers", c_uint32),
        ("reserved", c_uint32),
    ]


class instance_info(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("inputs", c_uint32),
        ("balance_inputs", c_uint32),
        ("state_variable_count", c_uint32),
        ("state_size", c_uint64),
        ("state_variables", POINTER(POINTER(state_variable))),
        ("per_node_parameters", POINTER(c_char_p)),
        ("per_node_parameter_count", c_uint32),
        ("capabilities", c_uint32),
        ("state_version", c_uint32),
        ("permissions", c_uint32),
        ("amounts", POINTER(POINTER(amount))),
        ("amount_count", c_uint32),
        ("reserved", c_uint32),
    ]


class input(ctypes.Structure):
    _fields_ = [
        ("values", c_void_p),
        ("floats", c_void_p),
        ("node_stride", c_int64),
        ("component_stride", c_int64),
    ]


class output(ctypes.Structure):
    _fields_ = [
        ("values", c_void_p),
        ("floats", c_void_p),
        ("node_stride", c_int64),
        ("component_stride", c_int64),
    ]


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
        ("v_smooth", input),
        ("delassus", input),
        ("gap", input),
        ("gap_offset", input),
        ("v_previous", input),
        ("spin_free", input),
        ("spin_previous", input),
        ("area", input),
        ("normal", input),
        ("tangent", input),
        ("per_node_parameters", POINTER(input)),
        ("state_in", input),
        ("state_out", output),
        ("impulse", output),
        ("moment", output),
        ("velocity", output),
        ("spin", output),
        ("energy", output),
        ("status", c_void_p),
        ("status_stride", c_int64),
        ("amounts", POINTER(output)),
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


create_function = CFUNCTYPE(c_int32, c_char_p, POINTER(setup), POINTER(c_void_p), c_char_p, c_size_t)
destroy_function = CFUNCTYPE(None, c_void_p)
info_function = CFUNCTYPE(c_int32, c_void_p, POINTER(instance_info))
batch_function = CFUNCTYPE(c_int32, c_void_p, POINTER(batch), POINTER(report))
extension_function = CFUNCTYPE(c_void_p, c_char_p)


class law(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("dimensions", c_uint32),
        ("delassus_forms", c_uint32),
        ("frames", c_uint32),
        ("numbers", c_uint32),
        ("inputs", c_uint32),
        ("outputs", c_uint32),
        ("capabilities", c_uint32),
        ("permissions", c_uint32),
        ("reserved", c_uint32),
        ("id", c_char_p),
        ("title", c_char_p),
        ("doc", c_char_p),
        ("references", POINTER(c_char_p)),
        ("parameters", POINTER(POINTER(parameter))),
        ("state_variables", POINTER(POINTER(state_variable))),
        ("reference_count", c_uint32),
        ("parameter_count", c_uint32),
        ("state_variable_count", c_uint32),
        ("amount_count", c_uint32),
        ("amounts", POINTER(POINTER(amount))),
        ("create", create_function),
        ("destroy", destroy_function),
        ("info", info_function),
        ("initialise", batch_function),
        ("evaluate", batch_function),
        ("extension", extension_function),
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
        ("extension", extension_function),
    ]


entry_function = CFUNCTYPE(POINTER(plugin))
visit_function = CFUNCTYPE(c_int32, c_char_p, c_void_p)


SIGNATURES = {
    "ilaw_library_open": (c_int32, [c_char_p, POINTER(c_void_p), c_char_p, c_size_t]),
    "ilaw_library_open_named": (c_int32, [c_char_p, POINTER(c_void_p), c_char_p, c_size_t]),
    "ilaw_library_read_description": (c_int32, [c_char_p, c_char_p, c_size_t, POINTER(c_size_t), c_char_p, c_size_t]),
    "ilaw_library_close": (None, [c_void_p]),
    "ilaw_library_plugin": (POINTER(plugin), [c_void_p]),
    "ilaw_library_describe": (c_size_t, [c_void_p, c_char_p, c_size_t]),
    "ilaw_library_path": (c_char_p, [c_void_p]),
    "ilaw_library_law": (POINTER(law), [c_void_p, c_char_p]),
    "ilaw_interface_create": (c_int32, [c_void_p, c_char_p, POINTER(setup), POINTER(c_void_p), c_char_p, c_size_t]),
    "ilaw_interface_destroy": (None, [c_void_p]),
    "ilaw_interface_law": (POINTER(law), [c_void_p]),
    "ilaw_interface_instance": (c_void_p, [c_void_p]),
    "ilaw_interface_info": (c_int32, [c_void_p, POINTER(instance_info)]),
    "ilaw_interface_initialise": (c_int32, [c_void_p, POINTER(batch), POINTER(report)]),
    "ilaw_interface_evaluate": (c_int32, [c_void_p, POINTER(batch), POINTER(report)]),
    "ilaw_search": (c_int32, [visit_function, c_void_p]),
    "ilaw_search_path": (c_size_t, [c_char_p, c_size_t]),
}
