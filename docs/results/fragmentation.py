#!/usr/bin/env python3
"""A bar that is drawn apart at a uniform rate breaks into pieces: sizes beside published formulas, energy to rounding.

    docs/results/fragmentation.py [--rates 0.01,0.1,1,10]    ILAW_PROGRAM: the program, otherwise build/release/bin/ilaw

Every joint of two elements has the law cohesive, rigid to its strength and linear to 0 (Camacho and Ortiz 1996).
Modulus and density are 1, the strength S is 1e-3 and the toughness S^2, so that the formulas' unit of size E G/s^2 is 1
and their unit of rate, s^3 c/(E^2 G), is S.
"""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import argparse
import contextlib
import io
import math
import os
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "api/python"))
sys.dont_write_bytecode = True

from ilaw import runs  # noqa: E402

S = 1e-3
SCATTER = 0.05  # of the strengths, uniform from 1 on
STRAIN = 0.98 * S  # at the start
STEPS = (1.0, 10.0 / 11.0, 10.0 / 13.0)  # no factor in common


def glenn_chudnovsky(rate: float) -> float:
    """Energy balance of a piece (Glenn and Chudnovsky 1986)."""
    return 4.0 / rate * math.sinh(math.asinh(1.5 * rate) / 3.0)


def zhou_molinari_ramesh(rate: float) -> float:
    """Fit to computed pieces (Zhou, Molinari and Ramesh 2006)."""
    return 4.5 / (1.0 + 0.77 * rate**0.25 + 5.4 * rate**0.75)


def scene(rate: float, refinement: float, factor: float, seed: int) -> dict[str, Any]:
    size = zhou_molinari_ramesh(rate)
    edge = size / 40.0 / refinement
    elements = round(200.0 * size / edge)
    places = edge * (np.arange(elements + 1) - 0.5 * elements)
    ends = np.column_stack([places[:-1], places[1:]])  # of the elements: their own points, so that joints can open
    points = [{"mass": 0.5 * edge, "position": [x], "velocity": [S * rate * x]} for x in ends.ravel().tolist()]
    strength = S * (1.0 + SCATTER * np.random.default_rng(seed).random(elements - 1))
    left, right = list(range(0, 2 * elements, 2)), list(range(1, 2 * elements, 2))
    end = (SCATTER + 0.02) / rate + 2.5 * (2.0 + 2.0 / (rate * size))
    return {
        "model": {"type": "points", "dimension": 1, "points": points},
        "springs": [{"name": "elements", "nodes": left, "to": right, "stiffness": 1.0 / edge}],
        "initial": [{"displacement": [0.0], "gradient": [[STRAIN]]}],
        "time": {"cfl": 0.9 * factor, "end": end},
        "loads": [{"type": "motion", "nodes": [k], "velocity": [S * rate * x]}
                  for k, x in ((0, float(places[0])), (2 * elements - 1, float(places[-1])))],
        "interfaces": [{"name": "joints", "law": "cohesive", "nodes": left[1:],
                        "against": {"nodes": right[:-1], "normal": [1.0]},
                        "parameters": {"shape": "camacho_ortiz", "strength": {"per_node": strength.tolist()},
                                       "toughness": S**2}}],
        "output": {"every": 1000000, "events": True},
    }  # fmt: skip


def pieces(rate: float, refinement: float, factor: float, seed: int) -> tuple[float, dict[str, Any]]:
    """Mean size of the pieces, and the summary."""
    with tempfile.TemporaryDirectory(prefix="ilaw_") as folder, contextlib.redirect_stdout(io.StringIO()):
        results = runs.run(scene(rate, refinement, factor, seed), Path(folder))
        broken = (results.folder / "events.csv").read_text(encoding="utf-8").count("rupture")
        return 200.0 * zhou_molinari_ramesh(rate) / (broken + 1), results.summary


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rates", default="0.01,0.1,1,10")
    given = parser.parse_args()
    os.environ.setdefault("ILAW_PROGRAM", str(ROOT / "build/release/bin/ilaw"))
    print("| rate | size at three steps | on half the mesh | other strengths | Zhou et al. | Glenn and Chudnovsky"
          " | error of energy |")  # fmt: skip
    print("| --- " * 7 + "|")
    for rate in (float(word) for word in given.rates.split(",")):
        found = [pieces(rate, *run) for run in [(1, step, 1) for step in STEPS] + [(2, 1.0, 1), (1, 1.0, 2)]]
        sizes = [f"{size:.3f}" for size, _ in found]
        worst = max(summary["energy"]["balance_error"] for _, summary in found)
        print(f"| {rate:g} | {' '.join(sizes[:3])} | {sizes[3]} | {sizes[4]} | {zhou_molinari_ramesh(rate):.3f}"
              f" | {glenn_chudnovsky(rate):.3f} | {worst:.0e} |", flush=True)  # fmt: skip


if __name__ == "__main__":
    main()
