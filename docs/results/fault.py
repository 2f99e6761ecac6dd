#!/usr/bin/env python3
"""A fault that ruptures by slip_weakening: arrival of the rupture on three meshes and with four steps, in plane strain.

    docs/results/fault.py build/release/bin/ilaw --picture docs/img/fault.svg      (laws: ILAW_PATH)

The values are those of the benchmark SCEC TPV3 (Harris et al. 2009), two-dimensional (mode II): split nodes of two
blocks, initial tractions as forces on them, so that displacements are those since the start of the rupture.
"""
# SPDX-License-Identifier: BSD-3-Clause
import csv
import json
import subprocess
import tempfile
import time
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from case_script import parser_of, save

# Pa, m, kg/m^3, m/s.
PRESSURE, SHEAR, NUCLEATION_SHEAR, NUCLEATION = 120e6, 70e6, 81.6e6, 1500.0
STATIC, DYNAMIC, CRITICAL_SLIP = 0.677, 0.525, 0.4
DENSITY, P_WAVE, S_WAVE = 2670.0, 6000.0, 3464.0
LENGTH, HEIGHT, END = 48e3, 15e3, 5.0  # of each block; no reflection is back at |x| < 9 km before END
PLACES = (3e3, 4.5e3, 6e3, 7.5e3, 9e3)
SLIP_RATE = 1e-3  # of a node that the rupture has reached, as in the benchmark


def scene(size, cfl):
    across, up, shear = round(LENGTH / size), round(HEIGHT / size), DENSITY * S_WAVE**2
    ratio = (P_WAVE / S_WAVE) ** 2
    poisson = (ratio - 2) / (2 * (ratio - 1))
    material = {"type": "linear", "young": 2 * shear * (1 + poisson), "poisson": poisson, "density": DENSITY}
    blocks = [{"name": name, "corner": [-LENGTH / 2, 0, z], "size": [LENGTH, size, HEIGHT], "elements": [across, 1, up],
               "material": material} for name, z in (("lower", -HEIGHT), ("upper", 0.0))]  # fmt: skip
    loads = [{"type": "motion", "nodes": "all", "axes": [1]}]
    # Nodes of blocks are numbered along x first, those of the lower one before those of the upper one.
    row = across + 1
    first = 2 * row * (up + 1)
    upper, lower = range(first, first + 2 * row), range(first - 2 * row, first)
    x = np.abs(np.arange(row) * size - LENGTH / 2)
    inside = np.clip((NUCLEATION - x) / size + 0.5, 0, 1)  # part of a node's length that is in the patch
    for nodes, side in ((upper, 1), (lower, -1)):
        total = [side * SHEAR * LENGTH * size, 0, -side * PRESSURE * LENGTH * size]
        loads.append({"type": "force", "nodes": list(nodes), "direction": total, "history": [[0, 1]], "total": True})
        for part in set(inside) - {0}:
            patch = [nodes[k + i] for k in (0, row) for i in np.flatnonzero(inside == part)]
            more = side * part * (NUCLEATION_SHEAR - SHEAR) * size * size / 2  # each of the two rows has half the area
            loads.append({"type": "force", "nodes": patch, "direction": [more, 0, 0], "history": [[0, 1]]})
    law = {"friction": STATIC, "dynamic_friction": DYNAMIC, "critical_slip": CRITICAL_SLIP}
    return {
        "model": {"type": "blocks", "blocks": blocks}, "time": {"cfl": cfl, "end": END}, "loads": loads,
        "interfaces": [{"law": "slip_weakening", "parameters": law, "nodes": list(upper),
                        "against": {"nodes": list(lower), "normal": [0, 0, 1]}}],
        "output": {"watch": [first + i for i in range(across // 2, across // 2 + round(9e3 / size) + 1)]},
    }  # fmt: skip


def arrivals(program, size, cfl):
    """x of the nodes from the middle on, the times at which the slip rate first exceeds SLIP_RATE, steps and seconds."""
    with tempfile.TemporaryDirectory() as folder:
        made = scene(size, cfl)
        (Path(folder) / "scene.json").write_text(json.dumps(made))
        began = time.perf_counter()
        done = subprocess.run([program, "run", "scene.json", "--out", "out"], cwd=folder, text=True, capture_output=True)
        seconds = time.perf_counter() - began
        if done.returncode:
            raise SystemExit(done.stderr)
        with open(Path(folder) / "out" / "history.csv") as file:
            rows = list(csv.reader(file))
    table = np.array(rows[1:], float)
    t, h = table[:, 0], table[1, 0] - table[0, 0]
    found = []
    for node in made["output"]["watch"]:
        rate = 2 * np.abs(table[:, rows[0].index(f"n{node}.v0")])  # the lower node moves the other way
        reached = int(np.argmax(rate > SLIP_RATE))
        before = rate[reached - 1] if reached else 0.0
        part = (SLIP_RATE - before) / (rate[reached] - before)
        found.append(t[reached] + h / 2 - h * (1 - part) if rate.max() > SLIP_RATE else np.nan)
    return size * np.arange(len(found)), np.array(found), len(t), seconds


def main():
    parser = parser_of(__doc__)
    parser.add_argument("--sizes", type=float, nargs="+", default=[600, 300, 150])
    parser.add_argument("--steps", type=float, nargs="+", default=[0.9, 0.5, 0.23, 0.11], help="fractions of the critical step")
    given = parser.parse_args()
    print("| element [m] | step / critical | steps | " + " | ".join(f"{x / 1e3:g} km" for x in PLACES) + " | time |")
    print("| --- " * (4 + len(PLACES)) + "|")
    curves = {}
    for size in given.sizes:
        for cfl in given.steps:
            x, found, steps, seconds = arrivals(given.program, size, cfl)
            curves[size, cfl] = x, found
            at = np.interp(PLACES, x, found)
            print(f"| {size:g} | {cfl:g} | {steps} | " + " | ".join(f"{a:.3f}" for a in at) + f" | {seconds:.0f} s |", flush=True)
    if given.picture:
        picture(curves, given)


def picture(curves, given):
    figure, plot = plt.subplots(figsize=(6.2, 3.6))
    for size, color in zip(given.sizes, ("tab:blue", "tab:orange", "tab:green", "tab:red")):
        for cfl, style in ((given.steps[0], ":"), (given.steps[-1], "-")):
            x, found = curves[size, cfl]
            plot.plot(x / 1e3, found, style, color=color, lw=1.2, label=f"{size:g} m, {cfl:g} of the critical step")
    x = np.array([3.0, 6.0])
    plot.plot(x, 0.9 + (x - 3) / (S_WAVE / 1e3), "k--", lw=0.8, label="speed of S waves")
    plot.set_xlabel("distance along the fault [km]")
    plot.set_ylabel("arrival of the rupture [s]")
    plot.legend(fontsize=8, frameon=False)
    save(figure, given.picture)


if __name__ == "__main__":
    main()
