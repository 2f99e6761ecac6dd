"""Gaps and normals of points to rigid shapes, and H of points of rigid bodies, for hosts that have none of their own.

Each shape takes positions x (n, 3) and gives the signed distance (n,), positive outside, and the unit normal
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


def delassus(inverse_mass: Any, inverse_inertia: NDArray[np.float64], arm: NDArray[np.float64]) -> NDArray[np.float64]:
    """H (n, 6) of points of rigid bodies at arm (n, 3) from their centers of mass, as the form "full" takes it.

    inverse_mass (n,) or a number, inverse_inertia (n, 3, 3) or (3, 3), about the center. Of two bodies that touch,
    the sum.
    """
    moment = np.swapaxes(np.cross(np.asarray(arm, float)[:, None, :], np.eye(3)), 1, 2)  # per impulse
    h = np.swapaxes(moment, 1, 2) @ inverse_inertia @ moment
    h += np.asarray(inverse_mass, float).reshape(-1, 1, 1) * np.eye(3)
    return h[:, [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
