"""The closed form of a point under the Post-it law."""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import bisect
import math
from typing import Callable

import numpy as np

from ._motions import Case, Exact, Path, instants_of, of_paths, require


def postit_point(case: Case, wanted: str) -> Exact:
    """A point that rests on a plane, with shocks of any sign and forces that pull."""
    body, interface = case.body, case.interface
    require(case.scene["model"]["dimension"] == 1 and "stiffness" not in body and not any(body.get("velocity", []))
            and len(case.scene["interfaces"]) == 1 and interface["law"] == "postit"
            and interface["obstacle"]["type"] == "plane" and interface["obstacle"]["point"] == body["position"]
            and interface["obstacle"]["normal"][0] > 0.0
            and case.parameters.get("rupture", "brittle") == "brittle", wanted)  # fmt: skip
    values = {"initial_adhesion": 0.0, "adhesion_limit": math.inf, "efficiency_decrease": math.inf, "memory": 0.0}
    for name in values:
        given = case.parameters.get(name, values[name])
        require(isinstance(given, (int, float)) or given == "inf", f"a number for '{name}'")
        values[name] = float(given) * (body.get("area", 1.0) if "adhesion" in name else 1.0)
    require(all(load["type"] in ("force", "shock") for load in case.loads), wanted)
    forces = [load for load in case.loads if load["type"] == "force"]
    times = sorted({0.0, *(row[0] for load in forces for row in load["history"])})
    pull = sum((load["direction"][0] * np.interp(times, *np.transpose(load["history"])) for load in forces),
               np.zeros(len(times)))  # fmt: skip
    require(bool((pull >= 0.0).all()), wanted)
    shocks = [(load["time"], load["impulse"][0]) for load in case.loads if load["type"] == "shock"]
    story = Postit(body["mass"], times, pull.tolist(), **values)
    story.tell(sorted(shocks, key=lambda shock: shock[0]), case.end + case.step)
    return of_paths([Path(story.pieces)], [instants_of(story.first_impulse, rupture=story.last_rupture)])


def sign_change(low: float, high: float, function: Callable[[float], float]) -> float:
    """Where a function that is <= 0 at low and > 0 at high changes its sign, to the last bit."""
    while low < (middle := 0.5 * (low + high)) < high:
        low, high = (low, middle) if function(middle) > 0.0 else (middle, high)
    return high


class Postit:
    """In one dimension, from rest on the plane, moved by a force that never pushes and by shocks of either sign."""

    AT_THE_LIMIT = 1.0 + 1e-9

    def __init__(self, mass: float, times: list[float], pull: list[float], initial_adhesion: float,
                 adhesion_limit: float, efficiency_decrease: float, memory: float) -> None:  # fmt: skip
        self.mass, self.times, self.pull = mass, times, pull
        self.adhesion, self.limit, self.decrease, self.memory = (
            initial_adhesion, adhesion_limit, efficiency_decrease, memory)  # fmt: skip
        self.now = self.x = self.v = self.ruptures = self.holds_since = 0.0
        self.flies = False
        self.window: list[tuple[float, float]] = []  # impulses on the point since the last rupture
        self.pieces: list[tuple[float, ...]] = []
        self.first_impulse = self.last_rupture = math.nan

    def tell(self, shocks: list[tuple[float, float]], end: float) -> None:
        if self.adhesion == 0.0:
            self.take_off()
        for time, impulse in shocks:
            if time > end:
                break
            self.advance(time)
            self.strike(impulse)
        self.advance(end)

    def force(self, time: float) -> float:
        return float(np.interp(time, self.times, self.pull))

    def force_impulse(self, start: float, end: float) -> float:
        inside = self.times[bisect.bisect_right(self.times, start) : bisect.bisect_left(self.times, end)]
        knots = [start, *inside, end] if start < end else []
        return sum(0.5 * (self.force(a) + self.force(b)) * (b - a) for a, b in zip(knots, knots[1:]))

    def advance(self, to: float) -> None:
        """To a time before which no shock falls, from one kink of the force or of the window's sum to the next."""
        while self.now < to:
            until = min(to, self.next_kink())
            if self.flies:
                self.fly(until)
            else:
                self.rest(until)

    def next_kink(self) -> float:
        past = [*self.times, *(time for time, _ in self.window), self.holds_since]
        return min((time for time in [*self.times, *(time + self.memory for time in past)] if time > self.now),
                   default=math.inf)  # fmt: skip

    def pulled(self, time: float) -> float:
        """The impulse that pulled at the bond within its memory, without the one that pressed it.

        That of the force counts since it holds; a shock counts at its own instant, even without memory.
        """
        counted = (impulse for past, impulse in self.window if past > time - self.memory or past == time)
        return self.force_impulse(max(self.holds_since, time - self.memory), time) - sum(counted)

    def rest(self, until: float) -> None:
        self.pieces.append((self.now, self.x, self.v))
        if self.adhesion > 0.0 and self.memory > 0.0:
            if self.force(0.5 * (self.now + until)) > 0.0:
                self.note_impulse()
            breaks = self.rupture_before(until)
            if breaks < until:
                self.now = breaks
                return self.break_bond()
        self.now = until
        if self.adhesion == 0.0:
            self.take_off()

    def rupture_before(self, until: float) -> float:
        """Up to the next kink the sum is quadratic: it passes the adhesion on its way to its top.

        An impulse that leaves the window at a kink counts before it and not after.
        """
        def excess(time: float) -> float:
            return self.pulled(time) - self.adhesion * self.AT_THE_LIMIT

        margin = 1e-12 * (until - self.now)
        first, last = self.now + margin, until - margin
        middle, top = 0.5 * (first + last), last
        curvature, rise = excess(first) + excess(last) - 2.0 * excess(middle), excess(last) - excess(first)
        if curvature < 0.0:
            top = min(max(middle - 0.25 * rise / curvature * (last - first), first), last)
        return sign_change(first, top, excess) if excess(top) > 0.0 else until

    def fly(self, until: float) -> None:
        """Pulled away, the motion is convex: it meets the plane before its velocity turns, or not at all."""
        force = self.force(self.now)
        slope = (self.force(until) - force) / (until - self.now)
        piece = (self.now, self.x, self.v, force / self.mass, slope / self.mass)
        self.pieces.append(piece)

        def at(time: float) -> tuple[float, float]:
            start, x, v, a, j = piece
            s = time - start
            return x + s * (v + s * (a / 2.0 + s * j / 6.0)), v + s * (a + s * j / 2.0)

        low, start = until, self.now
        if self.v < 0.0 < at(until)[1]:
            low = sign_change(start, until, lambda time: at(time)[1])
        if self.v < 0.0 and at(low)[0] <= 0.0:
            self.now = sign_change(start, low, lambda time: -at(time)[0])
            speed = at(self.now)[1]
            self.x, self.v, self.flies = 0.0, 0.0, False
            self.press(-self.mass * speed)
        else:
            self.now = until
            self.x, self.v = at(until)

    def strike(self, impulse: float) -> None:
        if self.flies:
            self.v += impulse / self.mass
        elif impulse < 0.0:
            self.press(-impulse)
        elif self.adhesion > 0.0 and self.pulled(self.now) + impulse <= self.adhesion * self.AT_THE_LIMIT:
            self.window.append((self.now, -impulse))
            self.note_impulse()
        else:
            if self.adhesion > 0.0:
                self.break_bond()
            self.v, self.flies = impulse / self.mass, True

    def press(self, impulse: float) -> None:
        """R_Y = max(R_Y, min(eta S_N, R_Y,max))."""
        self.note_impulse()
        if self.adhesion == 0.0:
            self.holds_since = self.now
        self.window.append((self.now, impulse))
        efficiency = math.exp(-self.ruptures / self.decrease)
        self.adhesion = max(self.adhesion, min(efficiency * max(-self.pulled(self.now), 0.0), self.limit))
        if self.adhesion == 0.0:
            self.take_off()

    def break_bond(self) -> None:
        self.last_rupture, self.adhesion = self.now, 0.0
        self.ruptures += 1.0
        self.window.clear()
        self.take_off()

    def take_off(self) -> None:
        """Nothing holds it against a pull, not even one that is about to grow from zero."""
        self.flies = self.force(self.now) > 0.0 or self.force(self.next_kink()) > 0.0

    def note_impulse(self) -> None:
        if math.isnan(self.first_impulse):
            self.first_impulse = self.now
