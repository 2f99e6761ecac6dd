"""Which points meet which facets of a surface: the closest facet with gap, normal and the weights of its nodes.

    from ilaw.search import Facets

    surface = Facets(facets, points, x0)                # (m, 4) nodes of each facet, (k,) nodes that may meet it
    for n in range(steps):
        ...
        surface.update(x)                               # positions of all nodes
        near = surface.near(reach=2 * speed * h)        # numbers of the points that may touch
        pairs = surface.pairs(near)                     # pairs.gap, .normal, .weights, .facet
        ilaw.coupled.Contacts(law, body=points[near], counterpart=facets[pairs.facet],
                              counterpart_weight=pairs.weights, gap=pairs.gap, normal=pairs.normal, ...)

What it promises is in ilaw/search.h.
"""
from __future__ import annotations

import ctypes
import functools
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _search_abi, arrays
from ._loader import open_library
from ._objects import Handle, NotCopied, sized
from .errors import InvalidArgument, raise_for

Place = _search_abi.Place

__all__ = ["Facets", "Pairs", "Place"]


@functools.cache
def library() -> ctypes.CDLL:
    """The functions of the search, with their types. Calls release the interpreter's lock."""
    return open_library("libilaw_search.so.1", "ILAW_SEARCH", _search_abi.SIGNATURES)


@dataclass(frozen=True)
class Pairs:
    """For each of k points: number of the closest facet, `Place`, gap (k,), unit normal (k, d) of the facet, weights
    (k, corners) of its nodes."""

    facet: NDArray[np.int32]
    place: NDArray[np.int32]
    gap: NDArray[np.float64]
    normal: NDArray[np.float64]
    weights: NDArray[np.float64]


def _numbers(name: str, value: Any, limit: int) -> NDArray[np.int32]:
    array = np.ascontiguousarray(value)
    if array.size and not np.issubdtype(array.dtype, np.integer):
        raise InvalidArgument(f"{name}: {array.dtype}, expected whole numbers")
    for number in (int(array.min()), int(array.max())) if array.size else ():
        if not 0 <= number < limit:
            raise InvalidArgument(f"{name}: {number}, expected 0 to {limit - 1}")
    return array.astype(np.int32)


class Facets(NotCopied):
    """Points that may meet the facets of a surface.

    facets (m, 2) in 2D, (m, 3) or (m, 4) in 3D: nodes, counterclockwise as the points see them. points (k,): the
    node that each point is. position (n, d): of all nodes before the run.
    """

    def __init__(self, facets: Any, points: Any, position: NDArray[np.float64]) -> None:
        position = arrays.as_array("position", position)
        if position.ndim != 2 or position.shape[1] not in (2, 3):
            raise InvalidArgument(f"position: shape {position.shape}, expected (nodes, 2) or (nodes, 3)")
        count, self.dimension = position.shape
        facets, points = _numbers("facets", facets, count), _numbers("points", points, count)
        allowed = (2,) if self.dimension == 2 else (3, 4)
        if facets.ndim != 2 or facets.shape[1] not in allowed or not len(facets):
            corners = " or ".join(f"(facets, {n})" for n in allowed)
            raise InvalidArgument(f"facets: shape {facets.shape}, expected {corners}, at least one")
        if points.ndim != 1:
            raise InvalidArgument(f"points: shape {points.shape}, expected (points,)")
        self.count, self._corners, self._nodes = len(points), facets.shape[1], count
        setup = sized(_search_abi.facets_setup)
        setup.dimension, setup.corner_count = self.dimension, self._corners
        setup.node_count, setup.facet_count, setup.point_count = count, len(facets), len(points)
        setup.facets, setup.points = facets.ctypes.data, points.ctypes.data
        setup.position = arrays.read("position", position, count, self.dimension)
        handle = ctypes.c_void_p()
        raise_for(library().ilaw_facets_create(ctypes.byref(setup), ctypes.byref(handle)), "facets")
        self._handle = Handle(handle, library().ilaw_facets_destroy)

    def update(self, position: NDArray[np.float64], displacement: NDArray[np.float64] | None = None) -> None:
        """Takes the positions of all nodes, with their displacements if there are some. Comes first."""
        given = sized(_search_abi.facets_positions)
        for name, array in {"position": position, "displacement": displacement}.items():
            if array is not None:
                array = arrays.as_array(name, array)
                setattr(given, name, arrays.read(name, array, self._nodes, self.dimension))
        raise_for(library().ilaw_facets_update(self._handle, ctypes.byref(given)), "update of facets")

    def near(self, reach: float, forced: bool = False) -> NDArray[np.int32]:
        """Numbers of the points, ascending, that may have a gap up to reach [m]."""
        nearby = sized(_search_abi.facets_nearby)
        nearby.reach, nearby.forced = reach, forced
        raise_for(library().ilaw_facets_near(self._handle, ctypes.byref(nearby)), f"reach {reach}")
        if nearby.count == 0:
            return np.empty(0, np.int32)
        points = (ctypes.c_int32 * nearby.count).from_address(nearby.points)
        return np.sort(np.ctypeslib.as_array(points))

    def pairs(self, points: Any = None, rim: float = 0.0) -> Pairs:
        """Pairs of some points, by their numbers, or of all.

        rim [m]: how far a facet goes on beyond the border, and how deep behind it a point there belongs to it.
        """
        chosen = np.arange(self.count, dtype=np.int32) if points is None else _numbers("points", points, self.count)
        count = len(chosen)
        made = Pairs(*np.empty((2, count), np.int32), np.empty(count), np.empty((count, self.dimension)),
                     np.empty((count, self._corners)))  # fmt: skip
        asked, border = sized(_search_abi.facets_pairs_of), np.array(rim, np.float64)
        asked.count, asked.points = count, chosen.ctypes.data
        asked.rim = arrays.read("rim", border, count, 1)
        asked.facet, asked.place = made.facet.ctypes.data, made.place.ctypes.data
        asked.gap = arrays.written("gap", made.gap, (count,))
        asked.normal = arrays.written("normal", made.normal, made.normal.shape)
        asked.weights = arrays.written("weights", made.weights, made.weights.shape)
        raise_for(library().ilaw_facets_pairs(self._handle, ctypes.byref(asked)), "pairs of facets")
        return made
