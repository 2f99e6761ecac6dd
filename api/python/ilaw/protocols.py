"""Protocols that prove a host: small problems with known answers, in a form that any language reads.

    python3 -m ilaw.protocols write FOLDER      writes FOLDER/NAME.txt, a protocol each
    python3 -m ilaw.protocols judge FOLDER      judges FOLDER/NAME.out, which your host wrote

One point against the plane z = 0. Each line of a protocol is a name and numbers (SI):

    law NAME, parameter NAME NUMBER        any number of parameters
    mass, area; position, velocity         x, y, z at time 0; the plane's normal is z
    stiffness                              of springs along x, y, z to the place at time 0
    force                                  constant
    wall                                   velocity of the plane
    step, steps                            fixed; the start is half a kick in which the law acts, too
    restart                                after so many steps save all, end, begin anew; 0: never

A host writes nine numbers, with 17 digits: displacement, velocity at the last half step, and the sum of all impulses,
that of the start included. They must fit the closed form, and the host below: where the arithmetic is the same, to the
last bit.
"""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import math
import sys
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Mapping

import numpy as np
from numpy.typing import NDArray

from .interface import Interface

Vector = tuple[float, float, float]
NONE: Vector = (0.0, 0.0, 0.0)
SAME = 1e-12  # relative, for hosts whose arithmetic has another order
NAMES = ["u.x", "u.y", "u.z", "v.x", "v.y", "v.z", "r.x", "r.y", "r.z"]


@dataclass(frozen=True)
class Protocol:
    name: str
    law: str
    step: float
    steps: int
    exact: Mapping[str, tuple[float, float]]  # by NAMES: value, tolerance
    because: str
    parameters: Mapping[str, float] = field(default_factory=dict)
    mass: float = 1.0
    area: float = 1.0
    position: Vector = NONE
    velocity: Vector = NONE
    stiffness: Vector = NONE
    force: Vector = NONE
    wall: Vector = NONE
    restart: int = 0

    def text(self) -> str:
        vectors = ("position", "velocity", "stiffness", "force", "wall")
        lines = [f"law {self.law}", *(f"parameter {name} {value!r}" for name, value in self.parameters.items())]
        lines += [f"{name} {getattr(self, name)!r}" for name in ("mass", "area", "step", "steps", "restart")]
        lines += [f"{name} " + " ".join(repr(value) for value in getattr(self, name)) for name in vectors]
        return "\n".join(lines) + "\n"


def _protocols() -> list[Protocol]:
    h = 1e-3
    tiny = 1e-12
    drop = Protocol(
        "drop", "contact", h, 500, {"u.z": (-0.0497, tiny), "v.z": (0.0, tiny), "r.z": (2 * 10 * 500.5 * h, 1e-11)},
        "it lies on the plane, whose impulses balance the weight over 500 steps and the half one",
        mass=2.0, position=(0.0, 0.0, 0.0497), force=(0.0, 0.0, -20.0))  # fmt: skip
    slide = Protocol(
        "slide", "coulomb", h, 800,
        {"u.x": (0.3, 0.4 * 10 * h * h / 8 + tiny), "u.y": (0.4, 0.4 * 10 * h * h / 8 + tiny), "u.z": (0.0, tiny),
         "r.x": (-2.4, tiny), "r.y": (-3.2, tiny), "r.z": (2 * 10 * 800.5 * h, 1e-11)},
        "v^2 / (2 mu g) = 0.5 along the velocity, at steps to mu g h^2 / 8",
        {"friction": 0.4}, mass=2.0, velocity=(1.2, 1.6, 0.0), force=(0.0, 0.0, -20.0))  # fmt: skip
    late = 0.1 * h + 1e-5
    stick_slip = Protocol(
        "stick_slip", "coulomb", h, 700, {"u.x": (0.04 + 0.01 * math.sin(3.0), late), "u.z": (0.0, tiny)},
        "drawn along until k x = mu m g, x = 0.04, then a swing about it; the slip begins up to a step late",
        {"friction": 0.4}, velocity=(0.1, 0.0, 0.0), stiffness=(100.0, 0.0, 0.0), force=(0.0, 0.0, -10.0),
        wall=(0.1, 0.0, 0.0))  # fmt: skip
    peel = Protocol(
        "peel", "tie", h, 200, {"u.z": (0.09, 8 * 0.15 * h + 1e-5), "r.z": (-0.4, 8 * h)},
        "a pull of 8 breaks a strength of 0.4 N.s after 0.05 s; then F t^2 / (2 m), both to a step",
        {"strength": 0.4, "memory": 0.1}, force=(0.0, 0.0, 8.0))  # fmt: skip
    oblique = Protocol(
        "oblique", "coulomb", h, 200, {"v.x": (2.4, tiny), "v.z": (1.0, tiny), "r.x": (-1.2, tiny), "r.z": (6.0, tiny)},
        "v_n -> -e v_n, and friction takes mu (1 + e) v_n, less than stops a sphere that turns",
        {"friction": 0.2, "restitution": 0.5},
        mass=2.0, position=(0.0, 0.0, 0.0997), velocity=(3.0, 0.0, -2.0))  # fmt: skip
    moving_wall = Protocol(
        "moving_wall", "contact", h, 200, {"v.z": (1.5, tiny), "r.z": (3.0, tiny)},
        "a wall of velocity 1 hits a mass at rest, which leaves with 1 + e", {"restitution": 0.5},
        mass=2.0, position=(0.0, 0.0, 0.0997), wall=(0.0, 0.0, 1.0))  # fmt: skip
    longer = {name: (1e3 * value, 1e3 * bound) for name, (value, bound) in oblique.exact.items() if name[0] != "r"}
    same = {name: oblique.exact[name] for name in ("r.x", "r.z")}
    units = replace(
        oblique, name="units", exact={**longer, **same}, because="oblique in t and mm: the same impulses", mass=2e-3,
        position=(0.0, 0.0, 99.7), velocity=(3e3, 0.0, -2e3))  # fmt: skip
    return [drop, slide, stick_slip, peel, oblique, moving_wall, units, *_other_laws(h, peel),
            replace(peel, name="restart", restart=30, because="peel, saved and read back at step 30: the same bits")]  # fmt: skip


def _other_laws(h: float, peel: Protocol) -> list[Protocol]:
    """One point with a closed form for each: impulses that only these laws give."""
    tiny = 1e-12
    fall = math.sqrt(2 * 0.0497 / 10)
    rise = 0.15 - fall
    bounce = Protocol(
        "bounce", "impact", h, 150, {"u.z": (5 * fall * rise - 5 * rise**2 - 0.0497, tiny)},
        "falls for sqrt(2 z/g), leaves with e times that speed; exact at any step", {"restitution": 0.5},
        mass=2.0, position=(0.0, 0.0, 0.0497), force=(0.0, 0.0, -20.0))  # fmt: skip
    stiffness = 1e4
    spring = Protocol(
        "spring", "penalty", h, 200, {"v.z": (2.0, 2.0 * stiffness * h * h / (4 * 2.0))},
        "a spring gives back the speed, to the energy k |g_n g_n+1| / 2 of two steps over its end",
        {"stiffness": stiffness}, mass=2.0, position=(0.0, 0.0, 0.0997), velocity=(0.0, 0.0, -2.0))  # fmt: skip
    hertz = replace(
        spring, name="hertz", law="grain", exact={"v.z": (2.0, tiny), "r.z": (8.0, 4 * tiny)},
        because="elastic spheres give back the speed, at any step", parameters={"radius": 0.1, "modulus": 1e6})  # fmt: skip
    # Pulled by F from a strength s: m u'' = F - s (1 - u/w) up to w = 2 G/s, then F.
    pull, strength, width, mass = 8.0, 4.0, 0.02, 2.0
    start, growth = (pull - strength) / mass, math.sqrt(strength / (mass * width))
    parted = math.acosh(1 + width * growth**2 / start) / growth
    left = 0.2 - parted
    end = width + start / growth * math.sinh(growth * parted) * left + pull / mass * left**2 / 2
    soften = Protocol(
        "soften", "cohesive", h, 200, {"u.z": (end, width * (growth * h) ** 2)},
        "a traction that falls with the opening from 4 to 0 at 0.02, to the second order of the step",
        {"strength": strength, "toughness": strength * width / 2}, mass=mass, force=(0.0, 0.0, pull))  # fmt: skip
    post_it = replace(
        peel, name="post_it", law="postit", parameters={"initial_adhesion": 0.4, "memory": 0.1},
        because="an adhesion of 0.4 N.s breaks after 0.05 s as in peel")
    bond, turns = 1000.0, math.sqrt(1000.0 / 2.0)
    swing = Protocol(
        "swing", "rccm", h, 200, {"u.z": (8 / bond * (1 - math.cos(0.2 * turns)), 8 / bond * (turns * h) ** 2)},
        "a bond that stays intact is a spring: F/k (1 - cos wt), to the second order of the step",
        {"normal_stiffness": bond, "tangential_stiffness": bond, "adhesion_energy": 1.0}, mass=2.0,
        force=(0.0, 0.0, 8.0))  # fmt: skip
    weaken = Protocol(
        "weaken", "slip_weakening", h, 1000, {"u.x": (0.8, 20 * h * h), "u.z": (0.0, tiny)},
        "friction falls from 0.6 to 0.2 over 0.2: v^2/2 = g (0.4 0.2 + 0.2 (x - 0.2)), to the second order",
        {"friction": 0.6, "dynamic_friction": 0.2, "critical_slip": 0.2}, mass=2.0, velocity=(2.0, 0.0, 0.0),
        force=(0.0, 0.0, -20.0))  # fmt: skip
    return [bounce, spring, hertz, soften, post_it, swing, weaken]


PROTOCOLS = {protocol.name: protocol for protocol in _protocols()}


class Host:
    """The reference: central differences, the law in each kick."""

    def __init__(self, protocol: Protocol):
        p = self.protocol = protocol
        self.u, self.v, self.before = np.zeros((1, 3)), np.array([p.velocity]), np.zeros((1, 3))
        self.v_free, self.gap, self.sum, self.steps = np.zeros((1, 3)), np.zeros(1), np.zeros(3), 0
        self.create()
        self.contact.initialise()
        self.kick(0.0, 0.5 * p.step)

    def create(self) -> None:
        p = self.protocol
        law = Interface(p.law, velocity_step=p.step, parameters=p.parameters)
        self.contact = law.batch(v_free=self.v_free, v_previous=self.before, gap=self.gap, delassus=1.0 / p.mass,
                                 normal=(0.0, 0.0, 1.0), area=p.area)  # fmt: skip

    def kick(self, time: float, duration: float) -> None:
        p, wall = self.protocol, np.array(self.protocol.wall)
        force = np.array(p.force) - np.array(p.stiffness) * self.u[0]
        self.before[0] = self.v[0] - wall
        self.v[0] += duration * (1.0 / p.mass) * force
        self.v_free[0] = self.v[0] - wall
        self.gap[0] = p.position[2] + self.u[0, 2] - time * wall[2]
        self.contact.evaluate(time, velocity_step=duration, position_step=p.step)
        self.v[0] += (1.0 / p.mass) * self.contact.impulse[0]
        self.sum += self.contact.impulse[0]

    def run(self) -> NDArray[np.float64]:
        p = self.protocol
        while self.steps < p.steps:
            self.u += p.step * self.v
            self.kick((self.steps + 1) * p.step, p.step)
            self.steps += 1
            if self.steps == p.restart:
                state = self.contact.state.copy()
                self.create()
                self.contact.state[:] = state
        return np.concatenate([self.u[0], self.v[0], self.sum])


def difference(found: NDArray[np.float64], expected: NDArray[np.float64]) -> float:
    """Largest of the nine, each triple in the scale of its own largest number."""
    scale = np.repeat([max(abs(expected[k : k + 3])) or 1.0 for k in (0, 3, 6)], 3)
    return float(np.max(np.abs(found - expected) / scale))


def judge(protocol: Protocol, found: NDArray[np.float64]) -> list[str]:
    """What is wrong with the nine numbers of a host; empty if nothing is."""
    if found.shape != (9,):
        return [f"found {found.size} numbers, expected 9"]
    wrong = []
    for name, (value, tolerance) in protocol.exact.items():
        number = float(found[NAMES.index(name)])
        if not abs(number - value) <= tolerance:
            wrong.append(f"{name}: found {number:.17g}, expected {value:.17g} to {tolerance:.2g}: {protocol.because}")
    apart = difference(found, Host(protocol).run())
    if not apart <= SAME:
        wrong.append(f"found {apart:.1e} from the reference host, expected at most {SAME:g}")
    return wrong


def judge_folder(folder: Path) -> int:
    failures = 0
    for protocol in PROTOCOLS.values():
        file = folder / f"{protocol.name}.out"
        try:
            found = np.array([float(word) for word in file.read_text(encoding="utf-8").split()])
        except (OSError, ValueError) as error:
            print(f"{protocol.name}: {error}")
            failures += 1
            continue
        wrong = judge(protocol, found)
        same = np.array_equal(found, Host(protocol).run()) if not wrong else False
        print(f"{protocol.name}: " + ("; ".join(wrong) or ("the same bits" if same else "passed")))
        failures += bool(wrong)
    return 1 if failures else 0


def main(words: list[str]) -> int:
    if len(words) != 2 or words[0] not in ("write", "judge"):
        print(__doc__)
        return 0 if words in (["-h"], ["--help"]) else 2
    folder = Path(words[1])
    if words[0] == "judge":
        return judge_folder(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for protocol in PROTOCOLS.values():
        (folder / f"{protocol.name}.txt").write_text(protocol.text(), encoding="utf-8")
    print(f"{len(PROTOCOLS)} protocols in {folder}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
