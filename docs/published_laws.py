#!/usr/bin/env python3
"""Laws as their papers print them: what `ilaw check` finds, and what one node does beside what can be derived.

    docs/published_laws.py [--check]    ILAW_BUILD: the build folder, otherwise build/release

Writes the tables of docs/published_laws.md. --check compares with the page instead.
"""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import dataclasses
import json
import math
import os
import subprocess
import sys
from pathlib import Path
from typing import Any, Callable

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
BUILD = Path(os.environ.get("ILAW_BUILD", ROOT / "build/release"))
LIBRARY = BUILD / "lib/published_laws/published_laws.so"
PAGE = ROOT / "docs/published_laws.md"
os.environ.setdefault("ILAW_LOADER", str(BUILD / "lib/libilaw_loader.so.1"))
sys.path.insert(0, str(ROOT / "api/python"))
sys.dont_write_bytecode = True

import ilaw  # noqa: E402

JUDGED = {
    "hunt_crossley": {},
    "lankarani_nikravesh": {},
    "regularized_coulomb": {"friction": 2.0, "slow_speed": 0.01, "direction": "vector"},
    "regularized_coulomb, by component": {"friction": 2.0, "slow_speed": 0.01, "direction": "components"},
    "lagged_coulomb": {},
    "park_paulino_roesler": {},
}


class Node:
    """One node of mass 1 above the plane z = 0, in a central-difference host; H = 1 unless it is driven."""

    def __init__(self, law: str, step: float, place: float, velocity: list[float], delassus: float = 1.0,
                 **parameters: Any) -> None:  # fmt: skip
        self.h, self.u, self.time = step, np.zeros((1, len(velocity))), 0.0
        self.v, self.before = np.array([velocity], dtype=float), np.array([velocity], dtype=float)
        self.gap, self.work = np.array([place]), 0.0
        library = str(LIBRARY) if law in JUDGED else law
        interface = ilaw.Interface(library, law=law, dimension=len(velocity), frame="local", velocity_step=step,
                                   **parameters)  # fmt: skip
        self.batch = interface.batch(v_free=self.v, v_previous=self.before, delassus=delassus, gap=self.gap, area=1.0)
        self.batch.initialise()
        self.delassus = delassus

    def go(self, force: list[float] | None = None, velocity: list[float] | None = None) -> np.ndarray:
        """One step under a force, or driven at a velocity; returns the impulse."""
        self.time += self.h
        self.u += self.h * self.v
        self.gap[0] += self.h * self.v[0, 0]
        self.before[:] = self.v
        self.v[:] = self.v + self.h * np.array(force) if force else self.v
        self.v[:] = velocity or self.v
        self.batch.evaluate(time=self.time)
        impulse = self.batch.impulse[0].copy()
        self.v += self.delassus * impulse
        self.work += 0.5 * float(impulse @ (self.before + self.v)[0])
        return impulse

    def energy(self) -> float:
        return 0.5 * float(self.v[0] @ self.v[0])


def root_of(function: Callable[[float], float], low: float, high: float) -> float:
    rising = function(high) > 0.0
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if (function(middle) > 0.0) == rising else (middle, high)
    return 0.5 * (low + high)


def rebound(loss: float) -> float:
    """m x'' = -k x^p (1 + loss x'): x' dx'/(1 + loss x') = -k/m x^p dx, whose right side is 0 over an impact at 1."""
    lost = loss - math.log1p(loss)
    return root_of(lambda out: -loss * out - math.log1p(-loss * out) - lost, 0.0, min(1.0, (1.0 - 1e-15) / loss))


def impact(law: str, **parameters: Any) -> float:
    node = Node(law, 1e-5, 1e-6, [-1.0], stiffness=1e4, **parameters)
    for _ in range(20000):
        node.go()
    return float(node.v[0, 0])


def touching(law: str, **parameters: Any) -> float:
    """Kinetic energy after over before, of a node that stands at gap 0 and comes at the speed 1, with h = 1."""
    node = Node(law, 1.0, 0.0, [-1.0], stiffness=3.0, **parameters)
    for _ in range(4):
        node.go()
    return node.energy() / 0.5


def first_pull() -> float:
    """Speed of separation above which a node is pulled: the kit refuses a push that is negative."""

    def pulls(speed: float) -> float:
        node = Node("hunt_crossley", 1e-4, -0.01 - 1e-4 * speed, [speed], stiffness=1e4, loss=1.0 / 3.0)
        try:
            node.go()
        except ilaw.BadNodes:
            return 1.0
        return -1.0

    return root_of(pulls, 0.1, 10.0)


STRUCK = {"step": 1e-3, "stiffness": 1e4, "touch": 1e-3, "struck": 1.0, "restitution": 0.5}


def struck(law: str, **parameters: Any) -> float:
    """Speed of a node that touched slowly and was struck to 1 m/s, a step later."""
    node = Node(law, STRUCK["step"], 0.0, [-STRUCK["touch"]], stiffness=STRUCK["stiffness"],
                restitution=STRUCK["restitution"], **parameters)  # fmt: skip
    node.go(velocity=[-STRUCK["struck"]])
    node.go()
    return float(node.v[0, 0])


def struck_by_hand() -> float:
    h, k, touch = STRUCK["step"], STRUCK["stiffness"], STRUCK["touch"]
    loss = 0.75 * (1.0 - STRUCK["restitution"] ** 2) / touch
    deep = h * touch
    speed = -STRUCK["struck"] + h * k * deep * (1.0 + loss * touch)
    deep -= h * speed
    return speed + h * k * deep * (1.0 - loss * speed)


def is_refused_at_rest() -> float:
    try:
        Node("lankarani_nikravesh", 1e-3, -1e-6, [0.0], stiffness=1e4, restitution=0.5).go()
    except ilaw.BadNodes:
        return 1.0
    return 0.0


def damping_of_laid(step: float) -> float:
    """Per speed and elastic force, of a node that is laid down without speed and has weight."""
    node = Node("lankarani_nikravesh", step, 0.0, [0.0], stiffness=1e4, restitution=0.5)
    for _ in range(2):
        node.go(force=[-10.0])
    return 0.5625 / float(node.batch.variable("speed")[0])


def creep(law: str, step: float, load: float, **parameters: Any) -> float:
    """Mean speed over the second second, of a node pressed by 10 and pushed along by `load`, from rest."""
    node = Node(law, step, 0.0, [0.0, 0.0], friction=0.3, **parameters)
    steps = round(1.0 / step)
    for _ in range(steps):
        node.go(force=[-10.0, load])
    start = node.u[0, 1]
    for _ in range(steps):
        node.go(force=[-10.0, load])
    return float(node.u[0, 1] - start) / (steps * step)


def chatter(law: str, step: float, **parameters: Any) -> float:
    """Speeds of two steps, of a pressed node without load that had 1 m/s, 1000 steps later."""
    node = Node(law, step, 0.0, [0.0, 1.0], friction=0.3, **parameters)
    for _ in range(1000):
        node.go(force=[-10.0, 0.0])
    return abs(float(node.v[0, 1])) + abs(float(node.before[0, 1]))


def drag_at_45_degrees(law: str, **parameters: Any) -> float:
    node = Node(law, 1e-3, 0.0, [0.0, 1.0, 1.0], friction=0.3, **parameters)
    impulse = node.go(force=[-10.0, 0.0, 0.0])
    return math.hypot(impulse[1], impulse[2]) / (0.3 * impulse[0])


def reversal(law: str, step: float) -> float:
    """Kinetic energy of the node that a step of friction leaves, from a speed of 1e-9."""
    node = Node(law, step, 0.0, [0.0, 1e-9], friction=0.3)
    node.go(force=[-10.0, 0.0])
    return node.energy()


SHAPE, PEAK = 3.0, 0.125


def left(x: float) -> float:
    """The part of the toughness that a mode has left at the part x of its final opening."""
    m = SHAPE * (SHAPE - 1.0) * PEAK**2 / (1.0 - SHAPE * PEAK**2)
    return (SHAPE / m) ** m * (1.0 - x) ** SHAPE * (m / SHAPE + x) ** m


def traction(x: float) -> float:
    """-F', of a toughness and a final opening of 1."""
    m = SHAPE * (SHAPE - 1.0) * PEAK**2 / (1.0 - SHAPE * PEAK**2)
    return left(x) * (SHAPE + m) * x / ((1.0 - x) * (m / SHAPE + x))


STRENGTH = traction(PEAK)  # for a final opening of 1
OPEN, SHEARED = 0.2, 0.5


def drive(law: str, step: float, path: list[tuple[float, float]], cycles: int = 1) -> float:
    """Work that the bond does on the bodies in the last cycle, as opening and slip follow a polygon at unit speed."""
    strengths = {"strength": STRENGTH, "toughness": 1.0, "strength_2": STRENGTH, "toughness_2": 1.0}
    node = Node(law, step, 0.0, [0.0, 0.0], delassus=1e-30, **strengths)
    start, here = 0.0, (0.0, 0.0)
    for _ in range(cycles):
        start = node.work
        for there in path:
            count = round(math.hypot(there[0] - here[0], there[1] - here[1]) / step)
            for _ in range(count):
                node.go(velocity=[(there[k] - here[k]) / (count * step) for k in (0, 1)])
            here = there
    return node.work - start


def gained_in_a_cycle() -> float:
    """Slip first, then open, at the largest openings of before. T_N = S_N n F(t), T_T = F(n) S_T t: see the page."""
    secant, secant_2 = traction(OPEN) / OPEN, traction(SHEARED) / SHEARED
    return 0.5 * secant * OPEN**2 * (1.0 - left(SHEARED)) - 0.5 * secant_2 * SHEARED**2 * (1.0 - left(OPEN))


def cycle(law: str, step: float) -> float:
    corners = [(0.0, SHEARED), (OPEN, SHEARED), (OPEN, 0.0), (0.0, 0.0)]
    return max(drive(law, step, corners, 3), drive(law, step, corners[2::-1] + corners[3:], 3))


@dataclasses.dataclass
class Case:
    law: str
    case: str
    quantity: str
    derived: Callable[[], float]
    found: Callable[[], float]
    bound: float  # of the difference, over the derived value
    ours: tuple[str, Callable[[], float]] | None = None  # a law of the tree in the same case


IMPLICIT = {"integration": "implicit"}
SLOW = {"slow_speed": 0.01}
HC, LN, RC, LC, PPR = (name for name in JUDGED if "," not in name)
CASES = [
    Case(HC, "impact at 1 m/s, alpha = 0.3 s/m, h = 1e-5", "speed after it (1 - alpha v is 0.7)",
         lambda: rebound(0.45), lambda: impact(HC, loss=0.3), 1e-6),
    Case(HC, "alpha = 0, p = 1, k h^2/m = 3, from gap 0", "kinetic energy after over before", lambda: 4.0,
         lambda: touching(HC, exponent=1.0), 1e-12, ("penalty", lambda: touching("penalty", **IMPLICIT))),
    Case(HC, "indented, drawn away, alpha = 1/3 s/m", "speed from which it pulls", lambda: 2.0, first_pull, 1e-12),
    Case(LN, "impact at 1 m/s, e = 0.5, h = 1e-5", "restitution", lambda: rebound(0.5625),
         lambda: impact(LN, restitution=0.5), 1e-6,
         ("penalty", lambda: impact("penalty", restitution=0.5, **IMPLICIT))),
    Case(LN, "the same, e = 0", "restitution", lambda: rebound(0.75), lambda: impact(LN, restitution=0.0), 1e-6),
    Case(LN, "touches at 1 mm/s, is struck to 1 m/s, k h^2/m = 0.01", "speed a step later", struck_by_hand,
         lambda: struck(LN, exponent=1.0), 1e-12, ("penalty", lambda: struck("penalty", **IMPLICIT))),
    Case(LN, "laid down without speed, h = 1e-3", "damping [s/m]: 3 (1 - e^2)/(4 g h)", lambda: 0.5625e2,
         lambda: damping_of_laid(1e-3), 1e-12),
    Case(LN, "the same, h = 1e-5", "damping [s/m]", lambda: 0.5625e4, lambda: damping_of_laid(1e-5), 1e-12),
    Case(LN, "starts indented and at rest", "1: refused, 0/0", lambda: 1.0, is_refused_at_rest, 0.0),
    Case(RC, "pressed by 10 N, pulled by half of mu N", "speed [m/s]: v_s/2", lambda: 0.005,
         lambda: creep(RC, 1e-3, 1.5, **SLOW), 1e-9, ("coulomb", lambda: creep("coulomb", 1e-3, 1.5))),
    Case(RC, "slides to rest, h above 2 v_s/(mu g)", "speeds of two steps: mu g h", lambda: 0.03,
         lambda: chatter(RC, 1e-2, **SLOW), 1e-9, ("coulomb", lambda: chatter("coulomb", 1e-2))),
    Case(RC, "slides at 45 degrees, by component", "friction over mu N", lambda: math.sqrt(2.0),
         lambda: drag_at_45_degrees(RC, direction="components", **SLOW), 1e-12,
         ("coulomb", lambda: drag_at_45_degrees("coulomb"))),
    Case(LC, "a step from 1e-9 m/s, h = 1e-3", "kinetic energy: m (mu g h)^2/2", lambda: 0.5 * (3e-3 - 1e-9) ** 2,
         lambda: reversal(LC, 1e-3), 1e-9, ("coulomb", lambda: reversal("coulomb", 1e-3))),
    *(Case(LC, f"pressed by 10 N, pulled by 1.234567 N, h = {h:g}", "mean speed [m/s]: h q/m", lambda h=h: 1.234567 * h,
           lambda h=h: creep(LC, h, 1.234567), 2e-2, ("coulomb", lambda h=h: creep("coulomb", h, 1.234567)))
      for h in (1e-3, 3e-4, 7e-5)),
    Case(PPR, "opened to its end, h = 1e-3", "work over toughness", lambda: 1.0,
         lambda: -drive(PPR, 1e-3, [(1.0, 0.0)]), 1e-4),
    *(Case(PPR, f"third cycle of slip and opening, h = {h:g}", "energy made over toughness", gained_in_a_cycle,
           lambda h=h: cycle(PPR, h), 1e-9, ("cohesive", lambda h=h: cycle("cohesive", h)))
      for h in (1e-2, 1e-3)),
]  # fmt: skip


def broken_rules(name: str, parameters: dict[str, Any]) -> str:
    command = [str(BUILD / "bin/ilaw-check"), str(LIBRARY), "--law", name.split(",")[0], "--json"]
    if parameters:
        command += ["--parameters", json.dumps(parameters)]
    found = subprocess.run(command, capture_output=True, text=True, check=False)
    return ", ".join(f"`{rule['rule']}`" for rule in json.loads(found.stdout) if rule["result"] == "broken")


def rules_table() -> list[str]:
    rows = [f"| {name} | {broken_rules(name, parameters) or 'none'} |" for name, parameters in JUDGED.items()]
    return ["| law | rules broken |", "| --- | --- |", *rows]


def cases_table() -> list[str]:
    head = "| law | case | quantity | derived | found | a law of ilaw |"
    rows = [head, "| --- " * (head.count("|") - 1) + "|"]
    for case in CASES:
        derived, found = case.derived(), case.found()
        if not abs(found - derived) <= case.bound * abs(derived):
            raise SystemExit(f"{case.law}, {case.case}: found {found!r}, derived {derived!r}")
        ours = f"{case.ours[0]}: {case.ours[1]():.4g}" if case.ours else "-"
        rows.append(f"| {case.law} | {case.case} | {case.quantity} | {derived:.6g} | {found:.6g} | {ours} |")
    return rows


def main() -> int:
    os.environ.setdefault("ILAW_PATH", str(BUILD / "lib/ilaw"))
    lines = [*rules_table(), "", *cases_table()]
    if sys.argv[1:] == ["--check"]:
        page = PAGE.read_text(encoding="utf-8").splitlines()
        wrong = [line for line in lines if line and line not in page]
        print("\n".join(["not on the page:", *wrong]) if wrong else "the tables are as on the page")
        return 1 if wrong else 0
    print("\n".join(lines))
    return 0


if __name__ == "__main__":
    sys.exit(main())
