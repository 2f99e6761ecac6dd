#!/usr/bin/env python3
"""A cylinder is pressed on a plane and pulled along it: p(x) of Hertz, q(x) of Cattaneo (1938) and Mindlin (1949).

    docs/results/partial_slip.py [--points]     ILAW_PATH: the folder lib/ilaw, ILAW_LOADER: libilaw_loader.so.1

The body is an elastic half-plane: strips of uniform traction, whose displacements are known (Johnson 1985, 2.30c).
Its far field moves down, then sideways, slowly beside the relaxation with fictitious masses; the law has the surface.
Loads are sums of what the law returns, so half width, stick zone and tractions follow from the closed form. Errors are
root mean squares over the half width. The best of nine penalties, per direction, is beside the law.
"""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import math
import os
import sys
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "api/python"))
sys.dont_write_bytecode = True

import ilaw  # noqa: E402

FRICTION, RADIUS, DEPTH, SHEAR = 0.3, 100.0, 0.0215, 0.0043  # with half width 1 or so, effective modulus 1
NORMAL_STEPS, TANGENTIAL_STEPS, REST = 2000, 8000, 2000


def stiffness(places: np.ndarray, width: float) -> np.ndarray:
    """Forces over displacements of strips; the displacement is 0 at a distance of ten half widths."""
    near = places[:, None] - places[None, :]

    def part(x: np.ndarray) -> np.ndarray:
        return x * (np.log(np.abs(x)) - 1.0)

    compliance = -2.0 / math.pi * (part(near + 0.5 * width) - part(near - 0.5 * width) - width * math.log(10.0))
    return width * np.linalg.inv(compliance)


def pressed(law: str, elements: int, spring: float = 0.0) -> tuple[np.ndarray, np.ndarray, float]:
    """Places, tractions (normal, along) and width of a strip; spring: of a penalty, over the diagonal of the body."""
    width = 1.0 / elements
    places = width * (np.arange(-1.3 * elements, 1.3 * elements) + 0.5)
    body = stiffness(places, width)
    diagonal = np.abs(body).sum(axis=1)
    mass = np.column_stack([0.5 * diagonal + 0.5 * spring * np.diag(body)] * 2)
    given: dict[str, Any] = {"friction": FRICTION}
    if law == "penalty":
        constant = float(spring * np.diag(body).mean())
        given |= {"stiffness": constant, "tangential_stiffness": constant}
    interface = ilaw.Interface(law, dimension=2, frame="local", velocity_step=1.0, **given)
    moved, velocity, before = (np.zeros((len(places), 2)) for _ in range(3))
    free, gap = np.zeros_like(moved), places**2 / (2.0 * RADIUS)
    damping = 0.02  # implicit, so it adds to the mass that the law feels
    acts = 1.0 / ((1.0 + damping) * mass)
    batch = interface.batch(v_free=free, v_previous=before, gap=gap, delassus=acts[:, :1].copy(), velocity=True)
    batch.initialise()
    for n in range(NORMAL_STEPS + REST + TANGENTIAL_STEPS + REST):
        along = min(1.0, max(0.0, (n - NORMAL_STEPS - REST) / TANGENTIAL_STEPS))
        far = np.array([-DEPTH * min(1.0, n / NORMAL_STEPS), SHEAR * along])
        moved += velocity
        free[:] = (1.0 - damping) / (1.0 + damping) * velocity - acts * (body @ (moved - far))
        gap[:] = places**2 / (2.0 * RADIUS) + moved[:, 0]
        batch.evaluate(time=float(n + 1))
        velocity = free + acts * batch.impulse
        before[:] = velocity
    return places, batch.impulse / width, width


def closed_forms(places: np.ndarray, load: float, pull: float) -> tuple[np.ndarray, np.ndarray, float]:
    half = math.sqrt(4.0 * load * RADIUS / math.pi)
    sticks = half * math.sqrt(max(0.0, 1.0 - pull / (FRICTION * load)))
    top = 2.0 * load / (math.pi * half)

    def arc(of: float) -> np.ndarray:
        return np.sqrt(np.maximum(0.0, of**2 - places**2)) / half

    return top * arc(half), FRICTION * top * (arc(half) - arc(sticks)), sticks / half


def judged(law: str, elements: int, spring: float = 0.0) -> tuple[float, float, float, float, Any]:
    places, traction, width = pressed(law, elements, spring)
    load, pull = width * traction[:, 0].sum(), -width * traction[:, 1].sum()
    normal, along, sticks = closed_forms(places, load, pull)
    errors = [math.sqrt(np.mean((found - exact)[normal > 0.0] ** 2)) / exact.max()
              for found, exact in ((traction[:, 0], normal), (-traction[:, 1], along))]  # fmt: skip
    return errors[0], errors[1], sticks, pull / (FRICTION * load), (places, traction, normal, along)


def main() -> None:
    os.environ.setdefault("ILAW_PATH", str(ROOT / "build/release/lib/ilaw"))
    print("| method | elements | error of p | error of q | stick zone | pull over limit |\n" + "| --- " * 6 + "|")
    for elements in (10, 20, 40):
        runs = {"law coulomb": judged("coulomb", elements)}
        if elements == 20:
            springs = {10 ** (k / 4 - 0.5): judged("penalty", elements, 10 ** (k / 4 - 0.5)) for k in range(9)}
            best = min(springs, key=lambda factor: springs[factor][1])
            runs[f"penalty {best:.2g}, the best of nine"] = springs[best]
        for name, (normal, along, sticks, pull, curves) in runs.items():
            print(f"| {name} | {elements} | {normal:.2%} | {along:.2%} | {sticks:.3f} | {pull:.3f} |", flush=True)
            if "--points" in sys.argv:
                print(np.array2string(np.column_stack([curves[0], *curves[1].T, *curves[2:]]), precision=5))


if __name__ == "__main__":
    main()
