"""How far a run is from a reference, in norms that suit motions with jumps.

u_L2     root of the mean square of position errors over time, relative to that of the reference
u_max    largest position error, relative to the largest displacement of the reference
v_L1     mean of |velocity errors|, relative to that of the reference: a jump that is displaced by one step changes it
         by O(h); in L2 it would be O(sqrt h), in the maximum norm nothing would ever converge
instant  largest error of an instant (first and last impulse of a contact, its last rupture), in time units
impulse  mean of |errors| of the impulse that interfaces have given so far, relative to the mean of that impulse
energy   mean error of the work that interfaces have done so far, relative to the largest energy
"""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import math
from typing import NamedTuple, Optional, Sequence

import numpy as np

from ._exact import Exact

NORMS = ("u_L2", "u_max", "v_L1", "instant", "impulse", "energy")
NO_ERRORS = dict.fromkeys(NORMS, math.nan)
# Errors below this part of their quantity are those of the arithmetic: 1e5 steps add up to so many roundings.
ROUNDING = 1e-11


class Trace(NamedTuple):
    """Watched nodes and interfaces in a run: a row per step, a column per component."""

    dt: float
    seconds: float
    penetration: float
    energy: float  # the largest
    u: np.ndarray  # at t_{n+1}
    v: np.ndarray  # at the half step after it, as what follows
    impulse: np.ndarray  # given so far by each interface
    work: np.ndarray  # done so far by all of them
    instants: np.ndarray  # per watched node: first and last impulse, last rupture; nan: none


def errors_against_exact(exact: Exact, trace: Trace) -> dict[str, float]:
    time = trace.dt * np.arange(1, len(trace.u) + 1)
    after = time + 0.5 * trace.dt
    return _errors(trace, exact.instants, exact.energy, exact.u(time), exact.v(after),
                   exact.impulse and exact.impulse(after), exact.work and exact.work(after))  # fmt: skip


def errors_against_run(fine: Trace, trace: Trace) -> dict[str, float]:
    """Linear between steps of the finer run, constant beyond its ends."""
    time = trace.dt * np.arange(1, len(trace.u) + 1) / fine.dt - 1.0

    def at(entries: np.ndarray, place: np.ndarray) -> np.ndarray:
        place = np.clip(place, 0.0, len(entries) - 1)
        before = place.astype(int)
        part = (place - before).reshape(-1, *[1] * (entries.ndim - 1))
        return (1.0 - part) * entries[before] + part * entries[np.minimum(before + 1, len(entries) - 1)]

    half = time + 0.5 * (trace.dt / fine.dt - 1.0)
    return _errors(trace, fine.instants, fine.energy, at(fine.u, time), at(fine.v, half), at(fine.impulse, half),
                   at(fine.work, half))  # fmt: skip


def _errors(trace: Trace, instants: np.ndarray, energy: float, u: np.ndarray, v: np.ndarray,
            impulse: Optional[np.ndarray], work: Optional[np.ndarray]) -> dict[str, float]:  # fmt: skip
    def mean_error(found: np.ndarray, wanted: Optional[np.ndarray]) -> float:
        if wanted is None or wanted.shape != found.shape:
            return math.nan
        return np.abs(found - wanted).sum() / np.abs(wanted).sum()

    late = np.abs(trace.instants - instants)
    with np.errstate(divide="ignore", invalid="ignore"):
        found = (
            np.sqrt(((trace.u - u) ** 2).sum() / (u**2).sum()),
            np.abs(trace.u - u).max() / np.abs(u).max(),
            mean_error(trace.v, v),
            math.nan if np.isnan(late).all() else np.nanmax(late),
            mean_error(trace.impulse, impulse),
            math.nan if work is None else np.abs(trace.work - work).mean() / energy,
        )
    return dict(zip(NORMS, map(float, found)))


def order_of(steps: Sequence[float], errors: Sequence[float], scale: float = 1.0) -> float:
    """Slope of log(error) over log(h) by least squares.

    Errors at rounding level, that part of the scale, are left out: they do not depend on h. nan if fewer than three are
    left, for two make a slope of chance, or if one is missing.
    """
    h, e = np.array(steps), np.array(errors)
    told = e > ROUNDING * scale
    if not np.isfinite(e).all() or told.sum() < 3:
        return math.nan
    return float(np.polyfit(np.log(h[told]), np.log(e[told]), 1)[0])


def scale_of(norm: str, dt: float, steps: int) -> float:
    """The size of what an error is part of: errors are relative, except those of instants."""
    return dt * steps if norm == "instant" else 1.0
