"""Gaps and normals of points to rigid shapes, for hosts that have no surfaces of their own.

Each function takes positions x (n, 3) and gives the signed distance (n,), positive outside, and the unit normal
(n, 3) from the shape to the point. A shape that moves: pass x less its displacement, and subtract its velocity from
v_free and v_previous.
"""
from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import InvalidArgument

Surface = tuple[NDArray[np.float64], NDArray[np.float64]]


def _unit(name: str, vector: Any) -> NDArray[np.float64]:
    made = np.asarray(vector, float)
    length = np.linalg.norm(made) if made.shape == (3,) else 0.0
    if not 0.0 < length < np.inf:
        raise InvalidArgument(f"{name}: {vector}, expected three numbers that are a direction")
    return made / length


def _round(offset: NDArray[np.float64], radius: float) -> Surface:
    if not radius > 0.0:
        raise InvalidArgument(f"radius: {radius}, expected a number above 0")
    distance = np.linalg.norm(offset, axis=1)
    return distance - radius, offset / distance[:, None]


def plane(x: NDArray[np.float64], point: Any, normal: Any) -> Surface:
    """A plane through point; the normal points to the body."""
    n = _unit("normal", normal)
    return (x - np.asarray(point, float)) @ n, np.tile(n, (len(x), 1))


def sphere(x: NDArray[np.float64], center: Any, radius: float) -> Surface:
    return _round(x - np.asarray(center, float), radius)


def cylinder(x: NDArray[np.float64], point: Any, axis: Any, radius: float) -> Surface:
    """An infinite cylinder; its axis goes through point."""
    a, offset = _unit("axis", axis), x - np.asarray(point, float)
    return _round(offset - np.outer(offset @ a, a), radius)
