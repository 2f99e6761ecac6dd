"""Structs and functions of coupled contacts, for ctypes.

Made by api/bindings/generate.py from <ilaw/coupled.h>: do not edit, change the header and run
the script. The header says what each member means, in which unit and who owns it. Names lose their `ilaw_` or `ILAW_`.
"""
from __future__ import annotations

import ctypes
from ctypes import CFUNCTYPE, POINTER
from ctypes import c_char_p, c_double, c_int32, c_int64, c_uint32, c_void_p
from enum import IntEnum

from . import _abi


class Method(IntEnum):
    """Method of the last iteration of a solve."""

    GAUSS_SEIDEL = 0
    CONJUGATE = 1
    ANDERSON = 2
    DOUGLAS_RACHFORD = 3
    NEWTON = 4


class bodies(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("dimension", c_uint32),
        ("count", c_int64),
        ("owned_count", c_int64),
        ("id", c_void_p),
        ("inverse_mass", _abi.input),
        ("inverse_inertia", _abi.input),
        ("v_free", _abi.input),
        ("spin_free", _abi.input),
        ("v_previous", _abi.input),
        ("spin_previous", _abi.input),
        ("velocity", _abi.output),
        ("spin", _abi.output),
        ("impulse", _abi.output),
        ("angular_impulse", _abi.output),
    ]


class contacts(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("delassus_form", c_uint32),
        ("law", POINTER(_abi.law)),
        ("instance", c_void_p),
        ("batch", POINTER(_abi.batch)),
        ("body", c_void_p),
        ("counterpart", c_void_p),
        ("arm", _abi.input),
        ("counterpart_arm", _abi.input),
        ("wall_velocity", _abi.input),
        ("wall_previous", _abi.input),
        ("wall_spin", _abi.input),
        ("wall_spin_previous", _abi.input),
        ("body_count", c_uint32),
        ("counterpart_count", c_uint32),
        ("body_weight", _abi.input),
        ("counterpart_weight", _abi.input),
        ("weight_size", c_uint32),
        ("reserved", c_uint32),
    ]


sum_bodies_function = CFUNCTYPE(None, c_void_p, POINTER(c_double), c_int64)
reduce_function = CFUNCTYPE(None, c_void_p, POINTER(c_double), c_int64)


class exchange(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("context", c_void_p),
        ("sum_bodies", sum_bodies_function),
        ("largest", reduce_function),
        ("sum", reduce_function),
    ]


work_function = CFUNCTYPE(None, c_void_p, c_uint32, c_uint32)
run_function = CFUNCTYPE(None, c_void_p, c_uint32, work_function, c_void_p)


class threads(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("context", c_void_p),
        ("run", run_function),
    ]


class coupled_options(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("most_sweeps", c_uint32),
        ("tolerance", c_double),
        ("exchange", POINTER(exchange)),
        ("speed", c_double),
        ("rounding", c_double),
        ("threads", c_uint32),
        ("reserved", c_uint32),
        ("pool", POINTER(threads)),
    ]


class coupled_report(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("sweeps", c_uint32),
        ("residual", c_double),
        ("work", c_double),
        ("energy", c_double * 4),
        ("bad_count", c_int64),
        ("bad_group", c_int64),
        ("bad_contact", c_int64),
        ("reason", c_char_p),
        ("stable_velocity_step", c_double),
        ("method", c_uint32),
        ("stalled", c_uint32),
        ("worst_group", c_int64),
        ("worst_contact", c_int64),
        ("law", c_char_p),
        ("other_law", c_char_p),
        ("speed", c_double),
        ("first_speed", c_double),
        ("energy_error", c_double),
        ("island_contacts", c_int64),
        ("mass_ratio", c_double),
        ("message", c_char_p),
    ]


SIGNATURES = {
    "ilaw_coupled_create": (c_void_p, []),
    "ilaw_coupled_destroy": (None, [c_void_p]),
    "ilaw_coupled_solve": (c_int32, [
        c_void_p, POINTER(bodies), POINTER(POINTER(contacts)), c_int64, POINTER(coupled_options),
        POINTER(coupled_report)
    ]),
}
