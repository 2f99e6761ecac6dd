"""Closed forms of elastic bars, by the waves in them."""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import math
from typing import Any

import numpy as np

from ._motions import (Case, Exact, Path, Scene, constant_between, instants_of, no_work, of_paths, pushes, require)  # fmt: skip


class Bar:
    def __init__(self, bar: Scene) -> None:
        self.start, self.length, self.velocity = bar.get("start", 0.0), bar["length"], bar.get("velocity", 0.0)
        section, young, density = bar.get("section", 1.0), bar["young"], bar["density"]
        self.speed = math.sqrt(young / density)  # of waves
        self.impedance = section * math.sqrt(young * density)
        self.mass, self.stiffness, self.section = density * section * self.length, young * section, section
        self.back = 2.0 * self.length / self.speed  # time in which a wave returns


def is_right_end(case: Case, nodes: Any) -> bool:
    """Whether a selection of nodes is the last one of the bar: a name, a number, near, or a box."""
    bar, elements = Bar(case.body), case.body["elements"]
    end, edge = bar.start + bar.length, bar.length / elements
    if isinstance(nodes, str) and nodes in case.scene.get("sets", {}):
        return is_right_end(case, case.scene["sets"][nodes])
    if not isinstance(nodes, dict):
        return nodes in (f"{case.body.get('name', 'bar0')}.right", elements, [elements])
    if "near" in nodes:
        places = np.ravel(nodes["near"])
        return len(places) == 1 and places[0] > end - 0.5 * edge
    (low,), (high,) = nodes["box"]
    return end - edge < low <= end <= high


def bar_on_wall(case: Case, wanted: str) -> Exact:
    """Contact for the return time 2L/c of a wave, at rest, then rebound at the speed of impact (Doyen et al. 2011)."""
    require(not case.loads, wanted)
    bar = Bar(case.body)
    gap = bar.start - case.obstacle_at()
    require(gap >= 0.0 and bar.velocity < 0.0, "a bar that flies towards the plane")
    meets = -gap / bar.velocity
    leaves = meets + bar.back
    return of_paths([constant_between([meets, leaves], [bar.velocity, 0.0, -bar.velocity])],
                    [instants_of(meets, leaves)], impulse=pushes(-bar.impedance * bar.velocity, meets, leaves),
                    work=no_work, energy=0.5 * bar.mass * bar.velocity**2)  # fmt: skip


def two_bars(case: Case, wanted: str) -> Exact:
    """While no wave has come back both ends move at (Z_A v_A + Z_B v_B)/(Z_A + Z_B).

    With equal impedances the shorter bar is then at rest relative to the longer one's initial speed, and so is the
    longer one's end, until its own wave is back.
    """
    a, b = map(Bar, case.scene["model"]["bars"])
    gap = b.start - (a.start + a.length)
    require(gap >= 0.0 and a.velocity > b.velocity, "a left bar that catches up with the right one")
    meets = gap / (a.velocity - b.velocity)
    together = (a.impedance * a.velocity + b.impedance * b.velocity) / (a.impedance + b.impedance)
    first_back = meets + min(a.back, b.back)
    equal = abs(a.impedance - b.impedance) <= 1e-12 * a.impedance and a.back <= b.back
    require(case.end <= first_back or (equal and case.end <= meets + max(a.back, b.back)),
            "an end before the first wave comes back, or a shorter left bar of equal impedance and an end before the "
            "second does")  # fmt: skip
    paths = [constant_between([meets, first_back], [v, together, b.velocity]) for v in (b.velocity, a.velocity)]
    return of_paths(paths, [instants_of(meets)] * 2, work=no_work,
                    impulse=pushes(b.impedance * (together - b.velocity), meets, first_back),
                    energy=0.5 * (a.mass * a.velocity**2 + b.mass * b.velocity**2))  # fmt: skip


def glued_bar(case: Case, wanted: str) -> Exact:
    """The glue feels 2F from L/c on; it breaks R_Y/(2F) later if its window is longer.

    The end then moves at 2F/Z until the next reflection at 3L/c.
    """
    require([load["type"] for load in case.loads] == ["force"] and len(case.loads[0]["history"]) == 1
            and case.interface["law"] == "postit", wanted)  # fmt: skip
    bar, memory = Bar(case.body), case.parameters.get("memory", 0.0)
    force = case.loads[0]["history"][0][1] * case.loads[0]["direction"][0]
    adhesion = case.parameters["initial_adhesion"] * bar.section
    require(isinstance(memory, (int, float)), wanted)
    window = "a window longer than R_Y/(2F), and an end before the next reflection at 3L/c"
    require(force > 0.0, window)
    arrives = bar.length / bar.speed
    breaks = arrives + adhesion / (2.0 * force)
    require(memory > adhesion / (2.0 * force) and breaks < 3.0 * arrives and case.end <= 3.0 * arrives, window)
    return of_paths([constant_between([breaks], [0.0, 2.0 * force / bar.impedance])], [instants_of(rupture=breaks)],
                    impulse=pushes(-2.0 * force, arrives, breaks), work=no_work,
                    energy=2.0 * force**2 * bar.length / bar.stiffness)  # fmt: skip


def bouncing_bar(case: Case, wanted: str) -> Exact:
    """A bar dropped on a plane, which it leaves as a whole after 2L/c.

    It is undeformed before the first impact, compressed by twice its weight after it, and undeformed again after the
    second if the flight between took a whole number of its vibrations, which then bring its end back.
    """
    require([load["type"] for load in case.loads] == ["gravity"] and "nodes" not in case.loads[0], wanted)
    bar = Bar(case.body)
    g, height = -case.loads[0]["acceleration"][0], bar.start - case.obstacle_at()
    require(g > 0.0 and height > 0.0 and bar.velocity == 0.0, wanted)
    fall, stay = math.sqrt(2.0 * height / g), bar.back
    vibrations = 2.0 * fall / stay
    require(abs(vibrations - round(vibrations)) <= 1e-9 * vibrations and vibrations > 1.5,
            "a flight of 2 sqrt(2 h/g) that is a multiple of the vibration's period 2L/c, by 2 at least")  # fmt: skip
    pieces: list[tuple[float, ...]] = []
    start = 0.0
    while start < case.end + case.step:
        up = start + fall + stay
        pieces += [(start, 0.0, 0.0, -g), (start + fall, -height, 0.0)]
        for s in stay * np.arange(round(vibrations)):
            pieces.append((up + s, g * s * (fall - 0.5 * s) - height, g * (fall - s - stay), g))
        second = up + 2.0 * fall
        pieces += [(second, -height, 0.0), (second + stay, -height, g * fall, -g)]
        start = second + stay + fall
    return of_paths([Path(pieces)], [instants_of(fall)])


def held_rod(case: Case, wanted: str) -> Exact:
    """A rod stretched by a over its length, let go, its far end held.

    It falls at c a/L, rests on the plane while the waves cross, and is thrown back to where it was, each for L/c.
    """
    bar, (load,), (initial,) = Bar(case.body), case.loads, case.scene["initial"]
    require(load["type"] == "motion" and is_right_end(case, load["nodes"]) and not {"velocity", "path"} & load.keys(), wanted)
    ends = [initial["displacement"][0] + initial["gradient"][0][0] * x for x in (bar.start, bar.start + bar.length)]
    require("nodes" not in initial and ends[0] > 0.0 and abs(ends[1]) <= 1e-12 * ends[0], wanted)
    require(bar.velocity == 0.0 and case.obstacle_at() == bar.start, wanted)
    third = bar.length / bar.speed
    speed = ends[0] / third
    instants = np.arange(1, math.ceil((case.end + case.step) / third) + 1) * third
    velocities = [(-speed, 0.0, speed)[k % 3] for k in range(len(instants) + 1)]
    return of_paths([constant_between(instants, velocities, ends[0])], [instants_of(third)])
