"""Structs and functions of the search for facets, for ctypes.

Made by api/bindings/generate.py from <ilaw/search.h>: do not edit, change the header and run
the script. The header says what each member means, in which unit and who owns it. Names lose their `ilaw_` or `ILAW_`.
"""
from __future__ import annotations

import ctypes
from ctypes import CFUNCTYPE, POINTER
from ctypes import c_double, c_int32, c_int64, c_uint32, c_void_p
from enum import IntEnum

from . import _abi


class Place(IntEnum):
    """Where a point is beside the closest facet."""

    OVER = 0
    BESIDE = 1
    BEYOND = 2


class facets_setup(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("dimension", c_uint32),
        ("corner_count", c_uint32),
        ("index_base", c_int32),
        ("node_count", c_int64),
        ("facet_count", c_int64),
        ("facets", c_void_p),
        ("point_count", c_int64),
        ("points", c_void_p),
        ("position", _abi.input),
    ]


class facets_positions(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("position", _abi.input),
        ("displacement", _abi.input),
    ]


class facets_nearby(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("forced", c_uint32),
        ("reach", c_double),
        ("is_new", c_uint32),
        ("reserved", c_uint32),
        ("count", c_int64),
        ("points", c_void_p),
        ("horizon", c_double),
        ("slack", c_double),
    ]


class facets_pairs_of(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("count", c_int64),
        ("points", c_void_p),
        ("rim", _abi.input),
        ("facet", c_void_p),
        ("place", c_void_p),
        ("gap", _abi.output),
        ("normal", _abi.output),
        ("weights", _abi.output),
        ("approach", _abi.output),
    ]


class facets_overlaps_of(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("corner_count", c_uint32),
        ("count", c_int64),
        ("points", c_void_p),
        ("distance", c_double),
        ("capacity", c_int64),
        ("first", c_void_p),
        ("facets", c_void_p),
    ]


class facets_counts(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("updates", c_int64),
        ("refreshes", c_int64),
        ("refits", c_int64),
        ("pairs", c_int64),
        ("facets", c_int64),
        ("shortest_edge", c_double),
        ("motion", c_double),
    ]


SIGNATURES = {
    "ilaw_facets_create": (c_int32, [POINTER(facets_setup), POINTER(c_void_p)]),
    "ilaw_facets_destroy": (None, [c_void_p]),
    "ilaw_facets_update": (c_int32, [c_void_p, POINTER(facets_positions)]),
    "ilaw_facets_near": (c_int32, [c_void_p, POINTER(facets_nearby)]),
    "ilaw_facets_pairs": (c_int32, [c_void_p, POINTER(facets_pairs_of)]),
    "ilaw_facets_overlaps": (c_int32, [c_void_p, POINTER(facets_overlaps_of)]),
    "ilaw_facets_count": (c_int32, [c_void_p, POINTER(facets_counts)]),
}
