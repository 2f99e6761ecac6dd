"""Closed forms of points that are thrown, bounce, slide and swing."""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import math
from typing import Callable

import numpy as np

from ._motions import Case, Exact, Path, instants_of, of_paths, require


def thrown(case: Case, height: float, speed: float, e: float, mu: float, g: float) -> Exact:
    """Thrown along a plane from above it, under gravity.

    First fall t1 = sqrt(2 h0/g); flights of 2 e^k t1, which start with e^k g t1 (Moreau 1988). Every bounce takes
    mu (1 + e) times the speed of arrival from the sliding, as long as there is any; then mu g does.
    """
    mass, fall = case.body["mass"], math.sqrt(2.0 * height / g)
    rest = fall * (1.0 + e) / (1.0 - e) if e < 1.0 else math.inf
    since, x, vx, arrives = fall, speed * fall, speed, g * fall
    along, across = [(0.0, 0.0, speed)], [(0.0, 0.0, 0.0, -g)]
    while arrives > 1e-18 * g * fall and since < case.end + case.step:
        vx = max(vx - mu * (1.0 + e) * arrives, 0.0)
        arrives *= e
        along.append((since, x, vx))
        across.append((since, -height, arrives, -g))
        flight = min(2.0 * arrives / g, rest - since)
        since, x = since + flight, x + vx * flight
    if since < case.end + case.step:
        slides = vx / (mu * g) if vx > 0.0 else 0.0
        along += [(since, x, vx, -mu * g), (since + slides, x + 0.5 * slides * vx, 0.0)]
        across.append((since, -height, 0.0))
    paths = [Path(along), Path(across)] if mu > 0.0 else [Path(across)]
    energy = mass * (g * height + 0.5 * speed**2)

    def impulse(t: np.ndarray) -> np.ndarray:
        """The momentum that gravity alone does not explain."""
        columns = [mass * (paths[0].at(t)[1] - speed)] * (mu > 0.0) + [mass * (paths[-1].at(t)[1] + g * t)]
        return np.column_stack(columns)

    def work(t: np.ndarray) -> np.ndarray:
        moves = sum(path.at(t)[1] ** 2 for path in paths)
        return mass * (0.5 * moves + g * (height + paths[-1].at(t)[0])) - energy

    # Gravity presses it on the plane to the end once it rests there; until then each bounce is an impulse.
    bounces = [start for start, *_ in across[1:] if start <= case.end]
    last = math.nan if not bounces else case.end if since <= case.end else bounces[-1]
    return of_paths(paths, [instants_of(fall, last)], impulse=impulse, work=work, energy=energy)


def bouncing_ball(case: Case, wanted: str) -> Exact:
    require(case.scene["model"]["dimension"] == 1 and [load["type"] for load in case.loads] == ["gravity"]
            and "velocity" not in case.body and len(case.scene["interfaces"]) == 1
            and case.interface["law"] == "contact", wanted)  # fmt: skip
    g, height = -case.loads[0]["acceleration"][0], case.body["position"][0] - case.obstacle_at()
    require(g > 0.0 and height > 0.0, wanted)
    return thrown(case, height, 0.0, case.parameters.get("restitution", 0.0), 0.0, g)


def oblique_impact(case: Case, wanted: str) -> Exact:
    velocity, mu = case.body.get("velocity", [0.0, 0.0]), case.parameters.get("friction", 0.0)
    obstacle, e = case.interface["obstacle"], case.parameters.get("restitution", 0.0)
    require(case.scene["model"]["dimension"] == 2 and case.interface["law"] == "coulomb" and mu > 0.0
            and [load["type"] for load in case.loads] == ["gravity"] and obstacle["type"] == "plane"
            and obstacle["normal"][0] == 0.0 and velocity[1] == 0.0, wanted)  # fmt: skip
    g, height = -case.loads[0]["acceleration"][1], case.body["position"][1] - case.obstacle_at(1)
    require(g > 0.0 and height > 0.0 and e < 1.0 and velocity[0] > 0.0, wanted)
    return thrown(case, height, velocity[0], e, mu, g)


def impact_oscillator(case: Case, wanted: str) -> Exact:
    """On a spring at rest length above a stop: arcs A cos(w t - phi), from stop to stop, left at e times the speed."""
    interface, mass = case.interface, case.body["mass"]
    require(case.scene["model"]["dimension"] == 1 and not case.scene.get("loads") and interface["law"] == "contact"
            and len(case.scene["interfaces"]) == 1 and interface["obstacle"]["type"] == "plane"
            and interface["obstacle"]["normal"][0] > 0.0, wanted)  # fmt: skip
    stiffness, speed = case.body["stiffness"][0], case.body.get("velocity", [0.0])[0]
    gap, e = case.body["position"][0] - case.obstacle_at(), case.parameters.get("restitution", 0.0)
    require(stiffness > 0.0 and gap > 0.0 and speed != 0.0, wanted)
    w = math.sqrt(stiffness / mass)
    arcs, start, u, v, impulse, work = [], 0.0, 0.0, speed, 0.0, 0.0
    while start < case.end + case.step:
        size, phase = math.hypot(u, v / w), math.atan2(v / w, u)
        arcs.append((start, size, phase, impulse, work))
        start += (phase + math.acos(-gap / size)) / w if size > gap else math.inf
        arrives = w * math.sqrt(max((size - gap) * (size + gap), 0.0))
        u, v = -gap, e * arrives
        impulse += mass * (1.0 + e) * arrives
        work -= 0.5 * mass * (1.0 - e * e) * arrives**2
    table = np.array(arcs)

    def at(t: np.ndarray) -> np.ndarray:
        return table[np.maximum(np.searchsorted(table[:, 0], t, side="right") - 1, 0)].T

    def swing(t: np.ndarray, wave: Callable[[np.ndarray], np.ndarray], factor: float) -> np.ndarray:
        start, size, phase = at(t)[:3]
        return (factor * size * wave(w * (t - start) - phase))[:, None]

    stops = [float(start) for start in table[1:, 0] if start <= case.end] or [math.nan]
    return Exact(lambda t: swing(t, np.cos, 1.0), lambda t: swing(t, np.sin, -w), np.array([instants_of(stops[0], stops[-1])]),
                 lambda t: at(t)[3][:, None], lambda t: at(t)[4], 0.5 * mass * speed**2)  # fmt: skip
