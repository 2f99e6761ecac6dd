"""What closed forms are made of: a scene of one body, motions by pieces, and the functions of time that errors need."""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import math
from typing import Any, Callable, NamedTuple, Optional, Sequence

import numpy as np

from ._command import BadInput

Scene = dict[str, Any]
OfTime = Callable[[np.ndarray], np.ndarray]


class Exact(NamedTuple):
    """Functions of instants: a row for each, and a column per component of the watched nodes."""

    u: OfTime
    v: OfTime
    instants: np.ndarray  # per watched node: first and last impulse, last rupture; nan: none
    # Given and done by the interface so far, if they are known; energy: the largest of the motion.
    impulse: Optional[OfTime] = None
    work: Optional[OfTime] = None
    energy: float = math.nan


class Case(NamedTuple):
    """A scene of one body, and the facts that its solution depends on."""

    scene: Scene
    body: Scene
    interface: Scene
    loads: list[Scene]  # without bulk viscosity, an aid of the mesh, which the body does not have
    end: float  # of the run, by whole steps
    step: float

    @property
    def parameters(self) -> Scene:
        return self.interface.get("parameters", {})

    def obstacle_at(self, component: int = 0) -> float:
        return self.interface["obstacle"]["point"][component]


class Path:
    """A motion by pieces, each with the position, velocity, acceleration and jerk of its start."""

    def __init__(self, pieces: Sequence[Sequence[float]]) -> None:
        table = np.array([[*piece, *[0.0] * (5 - len(piece))] for piece in pieces])
        self.starts, self.begun = table[:, 0], table[:, 1:]

    def at(self, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        piece = np.maximum(np.searchsorted(self.starts, time, side="right") - 1, 0)
        s = time - self.starts[piece]
        x, v, a, j = self.begun[piece].T
        return x + s * (v + s * (a / 2.0 + s * j / 6.0)), v + s * (a + s * j / 2.0)


def constant_between(instants: Sequence[float], velocities: Sequence[float], begins_at: float = 0.0) -> Path:
    pieces = [(0.0, begins_at, velocities[0])]
    for instant, velocity in zip(instants, velocities[1:]):
        start, x, v = pieces[-1]
        pieces.append((instant, x + v * (instant - start), velocity))
    return Path(pieces)


def of_paths(paths: Sequence[Path], instants: Sequence[Sequence[float]], **known: Any) -> Exact:
    return Exact(lambda t: np.column_stack([path.at(t)[0] for path in paths]),
                 lambda t: np.column_stack([path.at(t)[1] for path in paths]), np.array(instants, float), **known)  # fmt: skip


def instants_of(first: float = math.nan, last: float = math.nan, rupture: float = math.nan) -> list[float]:
    return [first, last, rupture]


def pushes(force: float, begins: float, ends: float) -> OfTime:
    """The impulse of a force that is constant for a while."""
    return lambda t: force * (np.clip(t, begins, ends) - begins)[:, None]


def no_work(t: np.ndarray) -> np.ndarray:
    return np.zeros(len(t))


def require(good: bool, expected: str) -> None:
    if not good:
        raise BadInput(f"/exact: expected {expected}")
