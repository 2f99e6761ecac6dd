#!/usr/bin/env python3
"""The validation matrix: what runs give beside closed forms, and what the best penalty gives in the same scene.

    docs/validation.py [--check] [NAME ...]    ILAW_PROGRAM: the program, otherwise build/release/bin/ilaw

Writes the table of docs/validation.md. --check runs the laws alone: each must give the number of the page, within the
bound of its case, and keep the bound at another step, or at two of them with ILAW_TEST_WHOLE in the environment: 10, 11
and 13 steps of the three runs take the same time.
"""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import argparse
import contextlib
import copy
import dataclasses
import functools
import json
import math
import os
import sys
import tempfile
from pathlib import Path
from typing import Any, Callable, Sequence, Union

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "api/python"))
sys.dont_write_bytecode = True

from ilaw import runs  # noqa: E402

PAGE = ROOT / "docs/validation.md"
HEAD = "| case | law | quantity | reference | exact | found | error | at other steps | best penalty | its steps | scene |"
Scene = dict[str, Any]


class Found:
    """What a run left: columns of history.csv, the summary, and events by interface."""

    def __init__(self, results: runs.Results) -> None:
        self.columns, self.summary = results.history, results.summary
        self.events = (results.folder / "events.csv").read_text(encoding="utf-8")
        self.time = self.columns["time"]

    def __getitem__(self, column: str) -> np.ndarray:
        return self.columns[column]

    def last(self, column: str) -> float:
        return float(self[column][-1])

    def mean_after(self, time: float, column: str) -> float:
        return float(self[column][self.time > time].mean())

    def first_event(self, kind: str) -> float:
        lines = [line.split(",") for line in self.events.splitlines()]
        return min(float(line[lines[0].index("time")]) for line in lines[1:] if kind in line)


@dataclasses.dataclass
class Case:
    name: str
    quantity: str
    reference: str  # the closed form and its source
    scene: Union[Path, Scene]
    exact: Union[float, Callable[[Found], float]]
    found: Callable[[Found], float]
    bound: float  # of the error: relative, or absolute if the exact value is 0
    stiffness: tuple[float, float] = (0.0, 0.0)  # range of the rival's; 0: none, since a spring has no such law

    def source(self) -> Scene:
        if isinstance(self.scene, dict):
            return copy.deepcopy(self.scene)
        source = json.loads(self.scene.read_text(encoding="utf-8"))
        source.pop("expect", None)  # of the law at the scene's own step
        for mesh in source["model"].get("meshes", []):
            mesh["file"] = str(self.scene.parent / mesh["file"])
        return source

    def exact_of(self, found: Found) -> float:
        return self.exact(found) if callable(self.exact) else self.exact

    def error_of(self, found: Found) -> float:
        exact = self.exact_of(found)
        return abs(self.found(found) - exact) / (abs(exact) or 1.0)


@functools.lru_cache(maxsize=None)
def run_text(text: str) -> Found:
    with tempfile.TemporaryDirectory(prefix="ilaw_") as folder, open(os.devnull, "w", encoding="utf-8") as quiet:
        with contextlib.redirect_stdout(quiet):
            results = runs.run(json.loads(text), Path(folder))
        return Found(results)


def run(scene: Scene) -> Found:
    """Several quantities of a scene take one run."""
    return run_text(json.dumps({**scene, "output": {**scene["output"], "events": True}}))


OTHER_STEPS = (10.0 / 11.0, 10.0 / 13.0)


def with_step(scene: Scene, factor: float) -> Scene:
    scene["time"]["cfl" if "cfl" in scene["time"] else "dt"] *= factor
    return scene


def with_penalty(scene: Scene, stiffness: float) -> Scene:
    """Springs in the place of contact and of Coulomb's law."""
    scene = copy.deepcopy(scene)
    for interface in scene["interfaces"]:
        friction = interface.get("parameters", {}).get("friction", 0.0)
        interface["law"] = "penalty"
        interface["parameters"] = {"stiffness": stiffness, "friction": friction, "tangential_stiffness": stiffness}
    return scene


def best_penalty(case: Case, law: Found) -> str:
    """The least error of nine stiffnesses, each at the largest step, of the law's and its halves, at which it runs."""
    found = []
    for stiffness in np.geomspace(*case.stiffness, 9):
        for halvings in range(6):
            scene = with_step(with_penalty(case.source(), float(stiffness)), 0.5**halvings)
            try:
                ran = run(scene)
            except runs.RunFailed:
                continue
            found.append((case.error_of(ran), ran.summary["steps"] / law.summary["steps"]))
            break
    return "{:.1e} | {:.2g}".format(*min(found))


HOST, ANALYST = ROOT / "host_mock/scenes", ROOT / "tests/host/analyst_scenes"


def shaken_ball() -> Case:
    """A dead ball leaves a table z = A sin(w t) where the table slows down by g, and flies until both meet again."""
    amplitude, omega, gravity = 0.02, 40.0, 10.0
    leaves = math.asin(gravity / (amplitude * omega**2)) / omega
    speed = amplitude * omega * math.cos(omega * leaves)

    def apart(t: float) -> float:
        flown = amplitude * math.sin(omega * leaves) + speed * (t - leaves) - 0.5 * gravity * (t - leaves) ** 2
        return flown - amplitude * math.sin(omega * t)

    low, high = leaves + 0.02, leaves + 0.2
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if apart(middle) > 0 else (low, middle)
    path = {"sine": {"amplitude": [amplitude], "frequency": omega / (2 * math.pi)}}
    scene = {
        "title": "A dead ball on a shaking table",
        "model": {"type": "points", "dimension": 1, "points": [
            {"mass": 1.0, "position": [0.0], "velocity": [amplitude * omega]}]},
        "time": {"dt": 1e-4, "end": 0.2},
        "loads": [{"type": "gravity", "acceleration": [-gravity]}],
        "interfaces": [{"name": "table", "law": "contact", "nodes": "all",
                        "obstacle": {"type": "plane", "point": [0.0], "normal": [1.0], "path": path}}],
        "output": {"every": 1, "watch": [0]},
    }  # fmt: skip

    def lands(found: Found) -> float:
        free = np.flatnonzero(found["n0.r0"] == 0.0)
        return float(found.time[free[np.flatnonzero(np.diff(free, append=0) != 1)[0]] + 1])

    return Case("ball on a shaking table", "instant of landing [s]",
                "free flight from where the table slows down by g; root of a transcendental equation",
                scene, low, lands, 2e-3, (1e4, 1e8))  # fmt: skip


def rope_on_drum() -> Case:
    """One end of a rope that lies half around a drum bears a load, the other is drawn slowly."""
    count, radius, friction = 60, 1.0, 0.3
    half = 0.5 * math.pi / count
    around = [[radius * math.cos(a), radius * math.sin(a)] for a in np.linspace(math.pi, 0.0, count + 1)]
    length = 2.0 * radius * math.sin(half)
    places = [[-radius, -length], *around, [radius, -length]]
    last = len(places) - 1
    scene = {
        "title": "A rope drawn over a drum",
        "model": {"type": "points", "dimension": 2,
                  "points": [{"mass": 1e-3, "position": place} for place in places]},
        "springs": [{"name": "rope", "nodes": list(range(last)), "to": list(range(1, last + 1)), "stiffness": 2e4,
                     "damping": 0.3}],
        "time": {"dt": 1e-4, "end": 3.0},
        "loads": [{"type": "force", "name": "weight", "nodes": [0], "direction": [0.0, -1.0],
                   "history": [[0.0, 0.0], [0.5, 1.0]]},
                  {"type": "damping", "name": "air", "rate": 5.0},
                  {"type": "motion", "name": "pull", "nodes": [last], "path": [[0.0, 0.0, 0.0], [3.0, 0.0, -0.03]]}],
        "interfaces": [{"name": "drum", "law": "coulomb", "parameters": {"friction": friction},
                        "nodes": list(range(1, last)),
                        "obstacle": {"type": "sphere", "center": [0.0, 0.0], "radius": radius}}],
        "output": {"every": 50, "watch": [0], "forces": ["drum", "pull", "weight"]},
    }  # fmt: skip
    # A corner of the polygon that slides turns the rope by `turn`: T' - T is mu (T' + T) tan(turn/2).
    turns = [half, *[2.0 * half] * (count - 1), half]
    ratio = math.prod((1.0 + friction * math.tan(turn / 2)) / (1.0 - friction * math.tan(turn / 2)) for turn in turns)
    return Case("capstan", "pull over load", "exp(mu theta) of Euler and Eytelwein, of a polygon",
                scene, ratio, lambda found: -found.mean_after(2.0, "pull.F1"), 1e-2, (1e2, 1e5))  # fmt: skip


def vibrated_friction() -> Case:
    """A body slides at half of the largest speed of a vibrating belt: friction pushes it on for a third of the time
    and back for two thirds. The part in which it is the slower one is acos(1/2)/pi."""
    frequency, largest, friction, gravity, end = 1000.0, 10.0, 0.3, 10.0, 0.01
    path = {"sine": {"amplitude": [largest / (2.0 * math.pi * frequency), 0.0], "frequency": frequency}}
    scene = {
        "title": "Friction on a belt that vibrates along the motion",
        "model": {"type": "points", "dimension": 2, "points": [
            {"mass": 1.0, "position": [0.0, 0.0], "velocity": [0.5 * largest, 0.0]}]},
        "time": {"dt": 2e-6, "end": end},
        "loads": [{"type": "gravity", "acceleration": [0.0, -gravity]}],
        "interfaces": [{"name": "belt", "law": "coulomb", "parameters": {"friction": friction}, "nodes": "all",
                        "obstacle": {"type": "plane", "point": [0.0, 0.0], "normal": [0.0, 1.0], "path": path}}],
        "output": {"every": 10, "watch": [0]},
    }  # fmt: skip
    return Case("friction on a vibrating belt", "mean friction over mu N", "1 - 2 acos(v/(A w))/pi (Coulomb, averaged)",
                scene, 1.0 / 3.0, lambda found: (0.5 * largest - found.last("n0.v0")) / (friction * gravity * end),
                1e-2)  # fmt: skip


def hertz_impacts() -> list[Case]:
    """m x'' = -K x^(3/2): the depth is (5 m v^2/(4 K))^(2/5), and the impact lasts 2.9432 depths over the speed."""
    mass, speed, stiffness = 0.1, 2.0, 1e8
    depth = (1.25 * mass * speed**2 / stiffness) ** 0.4
    lasts = 2.0 * math.sqrt(math.pi) * math.gamma(1.4) / math.gamma(0.9) * depth / speed
    law = {"stiffness": stiffness, "exponent": 1.5, "integration": "implicit"}
    scene = {
        "title": "Impact of Hertz",
        "model": {"type": "points", "dimension": 1, "points": [
            {"mass": mass, "position": [0.3 * depth], "velocity": [-speed]}]},
        "time": {"dt": lasts / 200.0, "end": 2.0 * lasts},
        "interfaces": [{"name": "plate", "law": "penalty", "parameters": law, "nodes": "all",
                        "obstacle": {"type": "plane", "point": [0.0], "normal": [1.0]}}],
        "output": {"every": 1, "watch": [0], "forces": ["plate"]},
    }  # fmt: skip
    return [Case("impact of Hertz", "largest force [N]", "K x^(3/2), x = (5 m v^2/(4 K))^(2/5)", scene,
                 stiffness * depth**1.5, lambda found: float(found["plate.F0"].max()), 1e-3),
            Case("impact of Hertz", "duration [s]", "2.9432 x/v", scene, lasts,
                 lambda found: float(np.count_nonzero(found["n0.r0"])) * found.summary["dt"], 1.5e-2)]  # fmt: skip


def steel_bar() -> list[Case]:
    """Without restitution, with the values of arXiv 2606.01355; the step avoids the critical one."""
    young, density, length, section, speed = 2.1e11, 7847.0, 0.254, 6.45e-4, 5.0
    gap, celerity = 1e-3 * length, math.sqrt(young / density)
    contact = gap / speed, gap / speed + 2.0 * length / celerity
    scene = {
        "title": "A bar of steel meets a wall",
        "model": {"type": "bars", "bars": [{"start": gap, "length": length, "elements": 200, "young": young,
                                            "density": density, "section": section, "velocity": -speed}]},
        "time": {"cfl": 0.9, "end": contact[1] + length / celerity},
        "interfaces": [{"name": "wall", "law": "contact", "nodes": "bar0.left",
                        "obstacle": {"type": "plane", "point": [0.0], "normal": [1.0]}}],
        "output": {"every": 1, "watch": [0], "forces": ["wall"], "balance": True},
    }  # fmt: skip
    source = "S sqrt(rho E) v; energy at impact, a case of Di Stasio et al. 2019 *"

    def middle(found: Found) -> float:
        inside = (found.time > contact[0] + 0.2 * length / celerity) & (found.time < contact[1] - 0.2 * length / celerity)
        return float(found["wall.F0"][inside].mean())

    return [Case("bar of steel on a wall", "force [N]", source, scene, section * math.sqrt(density * young) * speed, middle,
                 5e-3, (1e8, 1e12)),
            Case("bar of steel on a wall", "energy lost over energy", "0: the wave carries all of it", scene, 0.0,
                 lambda found: found.summary["energy"]["dissipated_impact"] / (0.5 * density * section * length * speed**2), 1e-2)]  # fmt: skip


def end_notched() -> Case:
    """Two arms bent together shear along their joint. V is the shear force per width of a half, c = 3 V/(4 h) the
    shear stress of an uncut beam. The slip s obeys s'' = 8 (strength (1 - s/w) - c)/(E h), w = 2 G/strength, so that
    G - c w = 9 V^2 a^2/(4 E h^3) with the end a of the zone, of length t/k, k^2 = 4 strength^2/(E h G). The work of
    rupture counts (1 - c/strength) (t - sin t)/k of that zone, with cos t = -c/(strength - c)."""
    thick, half, wide, toughness, strength, elements = 0.05, 0.5, 0.0125, 5e-8, 7e-4, 40
    size = half / elements
    notch, end, deflection, near = 0.375, 100.0, 0.0041, 1e-6
    start = notch - 0.5 * size  # the first node of the bond stands for half an element before it

    def arm(name: str, height: float, over: float) -> Scene:  # the lower one reaches beyond its support
        return {"name": name, "corner": [-over, 0.0, height], "size": [2.0 * half + over, wide, thick],
                "elements": [2 * elements + round(over / size), 1, 1],
                "material": {"type": "linear", "young": 1.0, "poisson": 0.0, "density": 1.0}}  # fmt: skip

    def row_at(along: float, height: float) -> Scene:
        return {"box": [[along - near, -1.0, height - near], [along + near, 1.0, height + near]]}

    def joint(name: str, law: str, first: float, last: float, parameters: Scene) -> Scene:
        facets = {"surface": "low.z_max", "discretization": "node_to_facet"}  # whole nodal areas, as `start` assumes
        return {"name": name, "law": law, "against": facets, "parameters": parameters,
                "nodes": {"box": [[first - near, -1.0, -near], [last + near, 1.0, near]], "of": "up.z_min"}}  # fmt: skip

    bond = {"strength": 5.0 * strength, "toughness": 25.0 * toughness, "strength_2": strength, "toughness_2": toughness}
    scene = {
        "title": "End-notched flexure",
        "model": {"type": "blocks", "blocks": [arm("low", -thick, 4.0 * size), arm("up", 0.0, 0.0)]},
        "time": {"cfl": 0.9, "end": end},
        "loads": [{"type": "damping", "rate": 0.1},
                  {"type": "motion", "nodes": row_at(0.0, -thick), "axes": [2]},
                  {"type": "motion", "nodes": row_at(2.0 * half, -thick), "axes": [0, 2]},
                  {"type": "motion", "name": "punch", "nodes": row_at(half, thick), "axes": [2],
                   "path": {"rows": [[0.0, 0.0, 0.0, 0.0], [0.4 * end, 0.0, 0.0, -0.85 * deflection],
                                     [end, 0.0, 0.0, -deflection]], "smooth": True}}],
        "interfaces": [joint("bond", "cohesive", notch, 2.0 * half, bond),
                       joint("crack", "contact", 0.0, notch - size, {})],
        "output": {"every": 20, "watch": [], "forces": ["punch"], "balance": True},
    }  # fmt: skip

    def load(crack: float) -> float:
        """The load at which a crack grows whose work of rupture is that of this length."""
        shear = 0.0
        for _ in range(50):
            part = 0.75 * shear / (thick * strength)
            angle = math.acos(-part / (1.0 - part))
            counted = (1.0 - part) * (angle - math.sin(angle)) * math.sqrt(thick * toughness) / (2.0 * strength)
            shear = math.sqrt((1.0 - 2.0 * part) * toughness * 4.0 * thick**3 / 9.0) / (crack - counted)
        return 2.0 * wide * shear

    def part_of_theory(found: Found) -> float:
        cracks = start + found["balance.dissipated_rupture"] / (toughness * wide)
        grows = (cracks > start + 0.03) & (cracks < half - 1.5 * thick)
        return float(-found["punch.F2"][grows].mean() / np.vectorize(load)(cracks[grows]).mean())

    return Case("end-notched flexure", "load of the growing crack over theory's", "beams with a zone that softens", scene,
                1.0, part_of_theory, 2e-2)  # fmt: skip


def turning_spring() -> Case:
    scene = json.loads((ROOT / "docs/results/scenes/rotating_spring.json").read_text(encoding="utf-8"))
    scene["time"]["end"], scene["output"]["every"] = 20.0, 1
    return Case("mass on a spring turns about a disc", "least angular momentum [kg m^2/s]",
                "r x m v, a case of Di Stasio et al. 2019 *", scene, 3.0,
                lambda found: float(found["balance.angular_momentum0"].min()), 1e-12)  # fmt: skip


def rubber(found: Found) -> float:
    """Force of the floor at the stretch that is reached; sideways the stress is 0."""
    mu, bulk = 0.5e6 / 1.3, 1e6 * 0.3 / (1.3 * 0.4)
    along, across = 1.0 + (found.last("n63.u2") - found.last("n0.u2")) / 0.1, 1.0
    for _ in range(50):
        off = mu * (across**2 - 1.0) + bulk * math.log(across**2 * along)
        across -= off / (2.0 * mu * across + 2.0 * bulk / across)
    return -0.01 * (mu * along + (bulk * math.log(across**2 * along) - mu) / along)


def seal(_: Found) -> float:
    young, poisson, squeeze, area, pressure = 5e6, 0.45, 0.1, 1e-4, 2e6
    pushed = (1.0 - squeeze) * pressure * area
    return area * young * squeeze / (1.0 - poisson**2) + poisson / (1.0 - poisson) * pushed


def momentum_left(found: Found) -> float:
    steps = np.diff(found.time, prepend=0.0)
    acted = sum(float((found[f"{name}.F1"] * steps).sum()) for name in ("slope", "weight"))
    return acted - sum(found.last(f"n{k}.v1") for k in range(45))


def peeling(found: Found) -> float:
    """Power of the grip over the speed of the crack: the grip goes at (-c, c), and so does the arm."""
    return found.mean_after(0.044, "grip.F2") - found.mean_after(0.044, "grip.F0")


def peeling_by_hand() -> float:
    """G b, the kinetic energy of what is peeled, and the drag of the air on the arm, of 19 mm in the mean."""
    speed, density, rate, arm = 0.3, 0.01, 10.0, 0.019  # of the tape: kg/m
    return 0.06 + density * speed**2 + rate * density * arm * 2.0 * speed


def fifth_impact() -> float:
    """u = -sin(10 t)/10 meets -0.05; with the speed w it is back after 2 (pi - atan(2 w))/10, and leaves with 0.8 w."""
    instant, speed = math.pi / 60.0, 0.8 * math.cos(math.pi / 6.0)
    for _ in range(4):
        instant += 0.2 * (math.pi - math.atan(2.0 * speed))
        speed *= 0.8
    return instant


def seventh_turn(found: Found) -> float:
    """On the belt it moves with the belt's 0.1."""
    sticks = np.abs(found["n0.v0"] - 0.1) <= 1e-12
    return float(found.time[1 + np.flatnonzero(np.diff(sticks.astype(int)))[6]])


def last_with(found: Found, column: str) -> float:
    return float(found.time[np.flatnonzero(found[column])[-1]])


CASES = [
    Case("bar against a wall", "end of contact [s]", "two runs of the wave: 0.5 + 2 L/c", HOST / "bar_on_wall.json",
         0.5 + 20.0 / 30.0, lambda found: last_with(found, "n0.r0"), 1e-2, (1e3, 1e7)),
    Case("bar against a wall", "mean force [N]", "rho c v S", HOST / "bar_on_wall.json", 300.0,
         lambda found: float(found["n0.r0"].sum()) / (20.0 / 30.0), 1e-2, (1e3, 1e7)),
    Case("two bars collide", "speed of the first after it [m/s]", "wave in the short bar: it stops",
         HOST / "two_bars.json", 0.0, lambda found: found.mean_after(2.5, "n100.v0"), 2e-2, (1e1, 1e5)),
    Case("ball on a turning wheel", "speed along the wheel [m/s]", "mu (1 + e) v", HOST / "spinning_wheel.json", 0.9,
         lambda found: found.last("n0.v0"), 2e-2),
    Case("block that slides", "way [m]", "v^2/(2 mu g)", HOST / "sliding_block_3d.json", 0.5,
         lambda found: math.hypot(found.last("n0.u0"), found.last("n0.u1")), 2e-3, (1e3, 1e7)),
    Case("mass on a strut lands", "largest force of the floor [N]", "damped oscillator", HOST / "landing_gear.json",
         2329.8, lambda found: float(found["floor.F0"][found.time > 0.21].max()), 5e-3, (1e4, 1e8)),
    Case("ball thrown on a floor", "instant at which it stops [s]", "falls, rebounds and Coulomb's friction",
         HOST / "oblique_impact.json", 4.0 / 3.0, lambda found: last_with(found, "n0.v0"), 1e-2),
    Case("mass on a spring and a stop", "instant of the fifth impact [s]", "harmonic between impacts",
         HOST / "impact_oscillator.json", fifth_impact(), lambda found: last_with(found, "n0.r0"), 2e-3),
    Case("stick-slip on a belt", "instant of the seventh turn [s]", "harmonic while it slips", HOST / "stick_slip.json",
         0.5 + 3 * 0.4 + 3 * 0.2 * (math.pi - math.atan(2.0)), seventh_turn, 1e-2),
    *steel_bar(),
    turning_spring(),
    shaken_ball(),
    rope_on_drum(),
    vibrated_friction(),
    *hertz_impacts(),
    Case("wheel with slip", "pull [N]", "brush model (Pacejka 2012, ch. 3)", HOST / "rolling_wheel.json",
         7.0 / 8.0 * 0.5 * 2.0 * 5e5 * 0.03**3 / 1.5, lambda found: -found.mean_after(0.066, "wheel.F0"), 2e-2, (1e3, 1e7)),
    Case("seal in its groove", "force of the lid [N]", "Hooke's law, two strains given", HOST / "seal.json", seal,
         lambda found: -found.mean_after(0.019, "lid.F2"), 1e-3, (1e3, 1e9)),
    Case("rubber block", "force of the floor [N]", "neo-Hooke (Bonet and Wood 2008, eq. 6.28)",
         ANALYST / "rubber_block.json", rubber, lambda found: found.last("floor.F2"), 1e-3, (1e4, 1e8)),
    *(Case("stack of three", f"force of '{name}' [N]", "weight above", ANALYST / "stack.json", weight,
           lambda found, name=name: found.last(f"{name}.F2"), 1e-3, (1e5, 1e9))
      for name, weight in (("floor", 130.0), ("lower", 50.0), ("upper", 10.0))),
    Case("brake pad", "drag [N]", "mu times the pressing force", ANALYST / "brake_pad.json",
         lambda found: 0.4 * found.mean_after(0.007, "disc.F2"), lambda found: found.mean_after(0.007, "disc.F0"), 1e-4,
         (1e5, 1e9)),
    Case("hail on a slope", "impulses less momentum, along y [N s]", "half a step of gravity, of 45 kg",
         ANALYST / "hail.json", lambda found: 45.0 * 10.0 * 0.5 * found.summary["dt"], momentum_left, 1e-9),
    Case("beam peeled from a plane", "length of the crack [m]", "beam theory (Williams 1989)", HOST / "dcb_peel.json",
         (3.0 * 0.05**3 * 0.01**2 / (8.0 * 5e-8)) ** 0.25 - 0.605 * 0.05,
         lambda found: found.summary["energy"]["dissipated_rupture"] / (5e-8 * 0.0125), 2e-2),
    end_notched(),
    Case("bar in mixed mode", "work of rupture [J]", "toughness (Benzeggagh and Kenane 1996)", HOST / "mixed_mode_bar.json",
         0.01 * (2e-6 + 6e-6 / 16.0), lambda found: found.summary["energy"]["dissipated_rupture"], 1e-9),
    Case("tape peeled upright", "upward less forward force [N]", "G b (Rivlin 1944), inertia and drag of the arm",
         ANALYST / "tape_peeled.json", peeling_by_hand(), peeling, 5e-2),
    Case("bars glued end to end", "instant of rupture [s]", "strength times area", ANALYST / "bonded_bars.json", 0.0035,
         lambda found: found.first_event("rupture"), 2e-2),
    Case("lap joint", "work of rupture [J]", "toughness times area", ANALYST / "lap_joint.json", 50.0 * 20e-5,
         lambda found: found.summary["energy"]["dissipated_rupture"], 2e-2),
    Case("bar on glue that heals", "instant of rupture [s]", "L/c + R_Y/(2 F)", HOST / "glued_bar.json", 1.5,
         lambda found: found.first_event("rupture"), 2e-2),
]  # fmt: skip


def law_of(case: Case) -> str:
    return ", ".join(sorted({interface["law"] for interface in case.source()["interfaces"]}))


def scene_of(case: Case) -> str:
    if isinstance(case.scene, dict):
        return "`docs/validation.py`"
    return f"[{case.scene.stem}](../{case.scene.relative_to(ROOT)})"


def at_other_steps(case: Case, factors: Sequence[float] = OTHER_STEPS) -> list[float]:
    return [case.error_of(run(with_step(case.source(), factor))) for factor in factors]


def row(case: Case, found: Found) -> str:
    penalty = best_penalty(case, found) if case.stiffness[1] else "- | -"
    cells = [case.name, law_of(case), case.quantity, case.reference, f"{case.exact_of(found):.6g}",
             f"{case.found(found):.6g}", f"{case.error_of(found):.1e}", f"{max(at_other_steps(case)):.1e}", penalty,
             scene_of(case)]  # fmt: skip
    return "| " + " | ".join(cells) + " |"


def on_the_page() -> dict[tuple[str, str], float]:
    lines = PAGE.read_text(encoding="utf-8").splitlines()
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines[lines.index(HEAD) + 2 :]]
    return {(cells[0], cells[2]): float(cells[5]) for cells in rows[: rows.index([]) if [] in rows else None]}


def complaints(case: Case, found: Found, page: dict[tuple[str, str], float]) -> list[str]:
    where, value, error = f"{case.name}, {case.quantity}", case.found(found), case.error_of(found)
    wrong = [f"{where}: found an error of {error:.2g}, at most {case.bound:g}"] if not error <= case.bound else []
    factors = OTHER_STEPS if "ILAW_TEST_WHOLE" in os.environ else OTHER_STEPS[:1]
    for factor, other in zip(factors, at_other_steps(case, factors)):
        if not other <= case.bound:
            wrong.append(f"{where}: an error of {other:.2g} at {factor:.3g} of the step, at most {case.bound:g}")
    written = page.get((case.name, case.quantity), math.nan)
    if not abs(value - written) <= 1e-5 * abs(value) + 0.01 * case.bound:
        wrong.append(f"{where}: found {value:.6g}, the page has {written:g}")
    return wrong


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help="cases; without any, all")
    parser.add_argument("--check", action="store_true", help="compare with the page")
    given = parser.parse_args()
    os.environ.setdefault("ILAW_PROGRAM", str(ROOT / "build/release/bin/ilaw"))
    cases = [case for case in CASES if not given.names or case.name in given.names]
    if unknown := set(given.names) - {case.name for case in CASES}:
        parser.error(f"found {sorted(unknown)}, expected some of {sorted({case.name for case in CASES})}")
    if given.check:
        page = on_the_page()
        wrong = [line for case in cases for line in complaints(case, run(case.source()), page)]
        print("\n".join(wrong) or f"{len(cases)} quantities are as on the page")
        return 1 if wrong else 0
    print(HEAD + "\n" + "| --- " * (HEAD.count("|") - 1) + "|")
    for case in cases:
        print(row(case, run(case.source())), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
