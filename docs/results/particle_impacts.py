#!/usr/bin/env python3
"""The eight tests of Chung and Ooi (2011), Granular Matter 13: impacts of one or two spheres, in four hosts.

    docs/results/particle_impacts.py [--hosts run,python,lammps,yade] [--tests 1,2,...] [--steps] [--points]
    docs/results/particle_impacts.py --picture FILE     the curves of test 4, in Python; needs matplotlib

Runs the laws coulomb, penalty and grain in `ilaw run` (tests 1 to 3, since its points do not rotate), in Python, in
LAMMPS and in Yade, and the own models of LAMMPS and Yade beside them; prints the table of particle_impacts.md, with
--steps errors at 170, 53 and 17 steps instead of 53, with --points each curve. Needs ILAW_PROGRAM, ILAW_PATH (an absolute folder lib/ilaw), ILAW_LOADER; lmp and yade for theirs.
"""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import argparse
import dataclasses
import functools
import math
import sys
from pathlib import Path
from typing import Any, Callable, Dict, Optional, Tuple

import numpy as np

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))

from particle_hosts import HOSTS, Found, in_python, in_yade  # noqa: E402

RESOLUTIONS = (17, 53, 170)  # steps within the impact: no factor in common
LAWS = ("coulomb", "penalty", "grain")
Results = Dict[Tuple[int, str, str, int], Optional[Found]]  # by test, law, host and resolution


@dataclasses.dataclass(frozen=True)
class Sphere:
    radius: float
    density: float
    young: float
    poisson: float

    @property
    def mass(self) -> float:
        return self.density * 4.0 / 3.0 * math.pi * self.radius**3


@dataclasses.dataclass(frozen=True)
class Test:
    """Spheres that fall at `speed` along -z, glide along x and spin about y; without `other`, on a rigid plane."""

    name: str
    sphere: Sphere
    speed: np.ndarray
    along: np.ndarray
    spin: np.ndarray
    exact: Callable[["Test", str], Found]  # values of quantities, for a law; NaN where nothing is known
    judge: str
    other: Sphere | None = None
    is_mirrored: bool = False  # the other sphere comes with the opposite speed and spin
    restitution: float = 1.0
    friction: float = 0.0

    @property
    def mass(self) -> float:
        """Of the relative motion."""
        return 1.0 / (1.0 / self.sphere.mass + (1.0 / self.other.mass if self.other else 0.0))

    @property
    def radius(self) -> float:
        return 1.0 / (1.0 / self.sphere.radius + (1.0 / self.other.radius if self.other else 0.0))

    @property
    def modulus(self) -> float:
        pair = [body for body in (self.sphere, self.other) if body]
        return 1.0 / sum((1.0 - body.poisson**2) / body.young for body in pair)

    @property
    def shear(self) -> float:
        pair = [body for body in (self.sphere, self.other) if body]
        return 1.0 / sum(2.0 * (2.0 - body.poisson) * (1.0 + body.poisson) / body.young for body in pair)

    @property
    def stiffness(self) -> float:
        return 4.0 / 3.0 * self.modulus * math.sqrt(self.radius)

    @property
    def approach(self) -> np.ndarray:
        return self.speed * (2.0 if self.is_mirrored else 1.0)

    @property
    def depth(self) -> np.ndarray:
        """Hertz: (5 m v^2/(4 K))^(2/5)."""
        return (1.25 * self.mass * self.approach**2 / self.stiffness) ** 0.4

    @property
    def duration(self) -> float:
        """Of the fastest impact, 2.9432 depths over the speed."""
        return float((2.943275 * self.depth / self.approach).min())

    @property
    def slip(self) -> np.ndarray:
        """Relative velocity at the contact; a mirrored sphere has the same velocity there."""
        return np.zeros_like(self.speed) if self.is_mirrored else self.along - self.spin * self.sphere.radius

    def steps_of(self, resolution: int) -> tuple[float, int]:
        slowest = float((2.943275 * self.depth / self.approach).max())
        step = self.duration / resolution
        return step, math.ceil(1.6 * slowest / step) + 3

    def parameters_of(self, law: str) -> dict[str, Any]:
        if law == "coulomb":
            return {"restitution": self.restitution, "friction": self.friction}
        if law == "grain":
            given = {"radius": self.radius, "modulus": self.modulus, "viscous_time": viscosity(self, law)}
            return {**given, "friction": self.friction, "shear_modulus": self.shear} if self.friction else given
        given = {"stiffness": self.stiffness, "exponent": 1.5, "integration": "implicit",
                 "damping": viscosity(self, law)}  # fmt: skip
        if self.friction:  # Mindlin's 8 G a at the largest indentation of the fastest: the law has a constant one
            radius = math.sqrt(self.radius * float(self.depth.max()))
            given |= {"friction": self.friction, "tangential_stiffness": 8.0 * self.shear * radius}
        return given


def rebound(ratio: float, power: float) -> float:
    """Restitution of x'' = -(5/4)(x^(3/2) + ratio x^power x'), no pull, from x = 0, x' = 1, by Runge and Kutta."""

    def slope(x: float, v: float) -> tuple[float, float]:
        x = max(x, 0.0)
        return v, -1.25 * max(x**1.5 + ratio * x**power * v, 0.0)

    x, v, h = 0.0, 1.0, 2e-3
    while x >= 0.0:
        a, b = slope(x, v)
        c, d = slope(x + 0.5 * h * a, v + 0.5 * h * b)
        e, f = slope(x + 0.5 * h * c, v + 0.5 * h * d)
        p, q = slope(x + h * e, v + h * f)
        x, v = x + h * (a + 2 * c + 2 * e + p) / 6.0, v + h * (b + 2 * d + 2 * f + q) / 6.0
        if v < 0.0 and slope(x, v)[1] == 0.0:
            break
    return -v


@functools.lru_cache(maxsize=None)
def ratio_of(restitution: float, power: float) -> float:
    """With which the equation of motion, not the law, has this restitution."""
    low, high = 0.0, 8.0
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if rebound(middle, power) > restitution else (low, middle)
    return low if restitution < 1.0 else 0.0


def viscosity(test: Test, law: str) -> float:
    """Of grain A in 2 E a A x' = K x^(3/2) (3/2) A x'/x, of penalty c in c x': right for the fastest impact."""
    depth, speed = float(test.depth.max()), float(test.approach.max())
    if law == "grain":
        return ratio_of(test.restitution, 0.5) * depth / (1.5 * speed)
    return ratio_of(test.restitution, 0.0) * test.stiffness * depth**1.5 / speed


def restitution_of(test: Test, law: str) -> np.ndarray:
    """Slower impacts of a viscous law lose less, of a damper more."""
    if law not in ("grain", "penalty") or test.restitution == 1.0:
        return np.full(len(test.speed), test.restitution)
    value = viscosity(test, law)
    if law == "grain":
        return np.array([rebound(1.5 * value * v / x, 0.5) for v, x in zip(test.approach, test.depth)])
    return np.array([rebound(value * v / (test.stiffness * x**1.5), 0.0) for v, x in zip(test.approach, test.depth)])


# --- closed forms


def hertz(test: Test, law: str) -> Found:
    return {"largest force": test.stiffness * test.depth**1.5, "normal velocity": test.restitution * test.speed}


def restitution(test: Test, law: str) -> Found:
    return {"normal velocity": test.restitution * test.speed}


def gross_sliding(test: Test, law: str) -> Found:
    """Coulomb's law if the contact slides to its end: from 3.5 (1 + e) mu v_n of slip on for any stiffness."""
    impulse = test.friction * (1.0 + restitution_of(test, law)) * test.mass * test.approach
    slides = np.abs(test.slip) >= 3.5 * impulse / test.mass
    along = test.along - np.sign(test.slip) * impulse / test.sphere.mass
    spin = test.spin + np.sign(test.slip) * 2.5 * impulse / (test.sphere.mass * test.sphere.radius)
    return {"tangential velocity": np.where(slides, along, np.nan),
            "spin times radius": np.where(slides, spin * test.sphere.radius, np.nan)}  # fmt: skip


def kharaz(test: Test, law: str) -> Found:
    return {"tangential velocity": np.array(list(KHARAZ.values())) * test.along}


def of_figure(points: dict[float, float]) -> Callable[[Test, str], Found]:
    return lambda test, _: {"spin times radius": np.array(list(points.values())) * test.friction * test.speed}


def nothing_changes(test: Test, law: str) -> Found:
    return {"tangential velocity": test.along, "spin times radius": test.spin * test.sphere.radius}


# Kharaz, Gorham and Salman 2001: rebound over impact velocity along the plate, over the angle from the normal.
KHARAZ = {5.17: 0.948, 10.2: 0.687, 15: 0.624, 20: 0.616, 25: 0.634, 30: 0.684, 35: 0.737, 40: 0.781, 50: 0.845,
          60: 0.893, 70: 0.932, 80: 0.966, 85: 0.983}  # fmt: skip
# R w'/(mu v_n) over v_t/(mu v_n) in the figure of test 5, as digitized in the tests of Kratos: finite elements of Wu,
# and the curve of steel that Chung and Ooi print.
WU = {0.89: 0.665, 1.53: 1.355, 2.28: 2.321, 3.3: 3.441, 3.89: 4.041, 4.69: 4.569, 5.66: 4.941, 7.03: 4.941,
      9.04: 4.972, 12.34: 4.97}  # fmt: skip
PRINTED = {0.353: 0.430, 0.682: 0.820, 1.341: 1.664, 2.0: 2.524, 2.988: 3.904, 3.994: 4.837, 5.0: 5.007, 6.006: 5.006,
           10.01: 5.004}  # fmt: skip
ALUMINA, ALLOY = Sphere(2.5e-3, 4000.0, 3.8e11, 0.23), Sphere(0.1, 2700.0, 7e10, 0.33)


def oblique(angle: np.ndarray, exact: Callable[[Test, str], Found], judge: str) -> Test:
    speed, along = 3.9 * np.cos(angle), 3.9 * np.sin(angle)
    return Test("4 angles at 3.9 m/s", ALUMINA, speed, along, 0.0 * angle, exact, judge, restitution=0.98, friction=0.092)


def tests() -> list[Test]:
    none = np.zeros(1)
    glass, limestone = Sphere(0.01, 2800.0, 4.8e10, 0.2), Sphere(0.01, 2500.0, 2e10, 0.25)
    alloy, magnesium = Sphere(0.1, 2699.0, 7e10, 0.3), Sphere(0.1, 1800.0, 4e10, 0.35)
    found = [Test(f"1 two spheres of {name}", body, none + 10.0, none, none, hertz, "Hertz 1882", body, True)
             for name, body in (("glass", glass), ("limestone", limestone))]  # fmt: skip
    found += [Test(f"2 {name} on a plane", body, none + 0.2, none, none, hertz, "Hertz 1882")
              for name, body in (("aluminum", alloy), ("magnesium", magnesium))]  # fmt: skip
    found += [Test(f"3 restitution {e}", ALUMINA, none + 3.9, none, none, restitution, "the given one", restitution=e)
              for e in (0.2, 0.4, 0.6, 0.8, 1.0)]  # fmt: skip
    slides = {"exact": gross_sliding, "judge": "Coulomb, where it slides"}
    angle = np.radians(list(KHARAZ))
    found += [oblique(angle, **slides), oblique(angle, kharaz, "experiment, Kharaz et al. 2001")]
    steel = Sphere(1e-5, 7850.0, 2.08e11, 0.3)
    for points, judged in ((WU, slides), (WU, {"exact": of_figure(WU), "judge": "finite elements, Wu *"}),
                           (PRINTED, {"exact": of_figure(PRINTED), "judge": "curve printed for steel *"})):  # fmt: skip
        glides = np.array(list(points))
        found.append(Test("5 velocities along the plane", steel, 0.0 * glides + 5.0, 1.5 * glides, 0.0 * glides,
                          friction=0.3, **judged))  # fmt: skip
    spins = 2.0 * np.tan(np.radians(np.arange(5.0, 90.0, 8.0)))
    spinning = dict(sphere=ALLOY, speed=0.0 * spins + 0.2, along=0.0 * spins, restitution=0.5, friction=0.4)
    found += [Test("6 spins on a plane", **spinning, spin=-spins, **slides),
              Test("7 two equal spheres, opposite spins", **spinning, spin=spins, exact=nothing_changes, judge="symmetry",
                   other=ALLOY, is_mirrored=True),
              Test("8 a sphere spins at a large one", **spinning, spin=-spins, **slides,
                   other=Sphere(0.5, 2.7e6, 7e13, 0.33))]  # fmt: skip
    return found


# --- tables


def measure(chosen: list[Test], hosts: list[str]) -> Results:
    """By test, law, host and resolution; a law `own` is the host's."""
    found = {}
    asked = [(test, law, n) for test in chosen for law in LAWS for n in RESOLUTIONS]
    for host in hosts:
        own = [(test, "own", n) for test in chosen for n in RESOLUTIONS] if host in ("lammps", "yade") else []
        results = in_yade(asked + own) if host == "yade" else [HOSTS[host](*one) for one in asked + own]
        found |= {(id(test), law, host, n): result for (test, law, n), result in zip(asked + own, results)}
    return found


def error_of(test: Test, law: str, quantity: str, found: Found | None) -> float:
    """Largest over the curve, over the largest value of the curve."""
    if found is None or quantity not in found or (law, quantity) == ("coulomb", "largest force"):  # rigid: no force
        return math.nan
    exact = test.exact(test, law)[quantity]
    known = ~np.isnan(exact)
    scale = np.abs(exact[known]).max()
    return float(np.abs(found[quantity] - exact)[known].max() / (scale or np.abs(test.speed).max()))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--hosts", default="run,python,lammps,yade")
    parser.add_argument("--tests", default="1,2,3,4,5,6,7,8")
    parser.add_argument("--steps", action="store_true", help="print the errors at 170, 53 and 17 steps")
    parser.add_argument("--points", action="store_true", help="print each curve")
    parser.add_argument("--picture", type=Path, metavar="FILE")
    given = parser.parse_args()
    if given.picture:
        picture(given.picture)
        return
    hosts, chosen = given.hosts.split(","), [test for test in tests() if test.name[0] in given.tests.split(",")]
    found = measure(chosen, hosts)
    models = [(law, hosts) for law in LAWS] + [("own", [host]) for host in hosts if host in ("lammps", "yade")]
    shown = RESOLUTIONS[::-1] if given.steps else (53,)
    names = [f"own model of {of[0]}" if law == "own" else law for law, of in models]
    print("| test | judge | quantity | " + " | ".join(names) + " |\n" + "| --- " * (3 + len(models)) + "|")
    for test in chosen:
        for quantity in test.exact(test, "own"):
            cells = [errors(test, law, quantity, [[found[id(test), law, host, n] for host in of] for n in shown])
                     for law, of in models]  # fmt: skip
            print(f"| {test.name} | {test.judge} | {quantity} | " + " | ".join(cells) + " |")
            if given.points:
                print(quantity, "exact", np.array2string(test.exact(test, "own")[quantity], precision=5))
                for key, one in found.items():
                    if key[0] == id(test) and key[3] == 170 and one and quantity in one:
                        print(" ", *key[1:3], np.array2string(one[quantity], precision=5))
    for law in LAWS:
        print(f"{law}: velocities of two hosts differ by {differ(chosen, hosts, law, found):.1e} of the speed at most")


def errors(test: Test, law: str, quantity: str, found: list[list[Found | None]]) -> str:
    """The worst host, by resolution."""
    at = [[error for one in hosts if not math.isnan(error := error_of(test, law, quantity, one))] for hosts in found]
    return " ".join(f"{max(one):.0e}" if one else "-" for one in at) if any(at) else "-"


def differ(chosen: list[Test], hosts: list[str], law: str, found: Results) -> float:
    """Largest difference of a velocity between two hosts, over the speed of impact."""
    worst = 0.0
    for test in chosen:
        for n in RESOLUTIONS:
            results = [found[id(test), law, host, n] for host in hosts if found[id(test), law, host, n]]
            for quantity in ("normal velocity", "tangential velocity", "spin times radius"):
                values = np.array([one[quantity] for one in results if quantity in one])
                if len(values) > 1:
                    worst = max(worst, float(np.ptp(values, axis=0).max() / np.abs(test.speed).max()))
    return worst


def picture(file: Path) -> None:
    import matplotlib.pyplot as plt
    from case_script import save

    figure, plot = plt.subplots(figsize=(6.2, 3.6))
    angles = np.linspace(3.0, 88.0, 86)
    test = oblique(np.radians(angles), kharaz, "")
    for law, style in (("penalty", "tab:orange"), ("grain", "tab:blue"), ("coulomb", "gray")):
        found = in_python(test, law, 53)["tangential velocity"] / test.along
        plot.plot(angles, found, "--" if law == "coulomb" else "-", color=style, lw=1, label=law)
    plot.plot(list(KHARAZ), list(KHARAZ.values()), "ko", ms=4, label="measured (Kharaz et al. 2001)")
    plot.set_xlabel("angle of impact to the normal [degrees]")
    plot.set_ylabel("rebound / impact velocity\nalong the plate")
    plot.set_ylim(0.5, 1.02)
    plot.legend(fontsize=8, frameon=False, loc="lower right")
    save(figure, file)


if __name__ == "__main__":
    main()
