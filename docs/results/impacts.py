#!/usr/bin/env python3
"""Run time against error through impacts: the law impact beside predictive, moreau and penalties.

    docs/results/impacts.py build/release/bin/ilaw        (docs/results/make.sh BUILD impacts calls it)

Runs `ilaw study` on points with closed forms and writes to tables/: impacts.csv (steps and time for errors of 1e-3,
1e-6 and 1e-9), impacts_runs.csv (every run), impacts_published.csv (errors at four steps beside those of schemes in
print), impacts_bodies.csv (what it brings to bodies). The laws come from the folder lib/ilaw beside the program, or
from ILAW_PATH.
"""
# SPDX-License-Identifier: BSD-3-Clause

import csv
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TABLES = ROOT / "docs/results/tables"
SCENES = {
    "ball_e1": ROOT / "docs/results/scenes/bouncing_ball_e1.json",
    "ball_e08": ROOT / "docs/results/scenes/bouncing_ball_e08.json",
    "oscillator_e08": ROOT / "host_mock/scenes/impact_oscillator.json",
    "oblique_e05": ROOT / "host_mock/scenes/oblique_impact.json",
}
ERRORS = (1e-3, 1e-6, 1e-9)
MOST_STEPS = 1_000_000


def read(file):
    with open(file, newline="") as stream:
        return list(csv.DictReader(stream))


def write(name, rows):
    with open(TABLES / f"{name}.csv", "w", newline="") as stream:
        writer = csv.DictWriter(stream, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def call(ilaw, command, scene, folder, *options):
    file = Path(folder) / "scene.json"
    file.write_text(json.dumps(scene))
    subprocess.run([ilaw, command, file, "--out", folder, *options], check=True, capture_output=True)


def penalties(restitution, friction):
    """Springs with the damper of the same restitution, -ln e = 2 zeta acos(zeta)/sqrt(1 - zeta^2), and implicit."""
    low, high = 0.0, 0.999
    for _ in range(60):
        zeta = 0.5 * (low + high)
        smaller = 2 * zeta * math.acos(zeta) / math.sqrt(1 - zeta * zeta) < -math.log(restitution)
        low, high = (zeta, high) if smaller else (low, zeta)
    rub = {"friction": friction} if friction else {}
    for k in (1e4, 1e6, 1e8):
        spring = {"stiffness": k, "damping": 2 * low * math.sqrt(k) if restitution < 1 else 0.0, **rub}
        if friction:
            spring["tangential_stiffness"] = k
        yield {"name": f"explicit k={k:.0e}", "law": "penalty", "parameters": spring}
    yield {"name": "implicit k=1e+06", "law": "penalty",
           "parameters": {"stiffness": 1e6, "integration": "implicit", "restitution": restitution, **rub}}


def laws_beside(own):
    """`impact`, and both activations of the scene's law, whose parameters are `own`."""
    impact = {name: own[name] for name in ("restitution", "friction", "kinetic_friction") if name in own}
    return [{"name": "impact", "law": "impact", "parameters": impact},
            *({"name": activation, "parameters": {"activation": activation}} for activation in ("predictive", "moreau"))]


def studied(file):
    scene = json.loads(file.read_text())
    own = scene["interfaces"][0]["parameters"]
    laws = [*laws_beside(own), *penalties(own["restitution"], own.get("friction"))]
    first = scene["time"]["end"] / 60 / scene["time"]["dt"]  # 60 steps
    scene["study"] = {"first": first, "factor": 2.17, "levels": 13, "most_steps": MOST_STEPS, "repetitions": 3,
                      "laws": laws}
    return scene


def needed(runs, error):
    """Steps and seconds from which on all errors are below this one; between two runs along their line."""
    first = len(runs)
    while first and float(runs[first - 1]["u_L2"] or "inf") <= error:
        first -= 1
    if first == len(runs):
        return None
    below = runs[first]
    if first == 0:
        return float(below["steps"]), float(below["seconds"])
    above = runs[first - 1]
    upper, lower = float(above["u_L2"] or "inf"), float(below["u_L2"])
    part = math.log(upper / error) / math.log(upper / lower) if math.isfinite(upper) else 1.0
    return tuple(float(above[key]) * (float(below[key]) / float(above[key])) ** part for key in ("steps", "seconds"))


def measure_costs(ilaw, folder):
    table, every = [], []
    for name, file in SCENES.items():
        print("study:", name, flush=True)
        call(ilaw, "study", studied(file), folder)
        runs = read(Path(folder) / "study.csv")
        by_law = {law: [run for run in runs if run["law"] == law] for law in dict.fromkeys(run["law"] for run in runs)}
        kinds = {}  # all explicit springs are one row: the best of them
        for law in by_law:
            kinds.setdefault("best explicit penalty" if law.startswith("explicit") else law, []).append(law)
        unit = None
        for kind, laws in kinds.items():
            row = {"scene": name, "law": kind}
            for error in ERRORS:
                costs = [cost for cost in (needed(by_law[law], error) for law in laws) if cost]
                cost = min(costs, default=None)
                unit = unit or cost
                row[f"{error:.0e}"] = "-" if cost is None else f"{cost[0]:.0f} ({cost[1] / unit[1]:.2g})"
            table.append(row)
        for law, own in by_law.items():
            every += [{"scene": name, "law": law, "steps": run["steps"], "time": f"{float(run['seconds']) / unit[1]:.3g}",
                       "u_L2": f"{float(run['u_L2']):.3g}"} for run in own if run["u_L2"]]
    write("impacts", table)
    write("impacts_runs", every)


# Computed anew from the schemes of arXiv 2606.01355: sums of |u - exact| over sums of |exact| at these steps.
PUBLISHED_STEPS = (1e-2, 1e-3, 1e-4, 1e-5)
PUBLISHED = {("CD-Lagrange", 1.0): (1.5e-1, 8.8e-3, 1.4e-3, 1.2e-4),
             ("Moreau-Jean and non-smooth Newmark", 1.0): (6.2e-2, 4.4e-4, 4.9e-4, 2.5e-5),
             ("CD-Lagrange", 0.8): (7.9e-2, 7.2e-3, 7.8e-4, 9.0e-5)}


def ball(time, restitution, gravity=9.81):
    """Height of the ball that falls from 1."""
    fall = math.sqrt(2 / gravity)
    if time < fall:
        return 1 - 0.5 * gravity * time * time
    time, speed = time - fall, restitution * gravity * fall
    while speed > 1e-12:
        if time < 2 * speed / gravity:
            return time * (speed - 0.5 * gravity * time)
        time -= 2 * speed / gravity
        speed *= restitution
    return 0.0


def error_of_ball(ilaw, folder, restitution, law, step):
    scene = json.loads(SCENES["ball_e1"].read_text())
    for key in ("exact", "converge", "expect"):
        scene.pop(key, None)
    scene["time"]["dt"] = step
    own = {"law": "impact"} if law == "impact" else {"law": "contact", "parameters": {"activation": law}}
    own.setdefault("parameters", {})["restitution"] = restitution
    scene["interfaces"][0].update(own)
    call(ilaw, "run", scene, folder)
    error = size = 0.0
    for row in read(Path(folder) / "history.csv"):
        exact = ball(float(row["time"]), restitution)
        error += abs(float(row["n0.gap"]) - exact)
        size += abs(exact)
    return error / size


def compare_with_print(ilaw, folder):
    rows = []
    for restitution in (1.0, 0.8):
        found = {name: errors for (name, e), errors in PUBLISHED.items() if e == restitution}
        for law in ("predictive", "moreau", "impact"):
            print("ball:", restitution, law, flush=True)
            found[law] = [error_of_ball(ilaw, folder, restitution, law, h) for h in PUBLISHED_STEPS]
        rows += [{"e": restitution, "scheme": name, **{f"h = {h:.0e}": f"{x:.2g}" for h, x in zip(PUBLISHED_STEPS, errors)}}
                 for name, errors in found.items()]
    write("impacts_published", rows)


BODIES = {
    "bar_on_wall": {},
    "held_rod": {},
    "bouncing_bar": {"first": 12.5, "factor": 1.5, "levels": 10, "refine": "mesh"},
    "rotating_spring": {"factor": 3.3, "levels": 4, "reference": 8},
    "block_impact": {"factor": 2.3, "levels": 3, "reference": 4},
}


def measure_bodies(ilaw, folder):
    """Errors of u, and of v in brackets, of the finest runs; without a closed form against the finest of impact."""
    rows = []
    for name, sizes in BODIES.items():
        for restitution in (0.0, 1.0):
            print("bodies:", name, restitution, flush=True)
            scene = json.loads((ROOT / f"host_mock/scenes/{name}.json").read_text())
            for interface in scene["interfaces"]:
                interface.setdefault("parameters", {})["restitution"] = restitution
            scene["study"] = {**scene.get("study", {}), **sizes, "repetitions": 1}
            scene["study"]["laws"] = laws_beside(scene["interfaces"][0]["parameters"])
            call(ilaw, "study", scene, folder)
            finest = {run["law"]: run for run in read(Path(folder) / "study.csv")}
            rows.append({"scene": name, "e": f"{restitution:g}", "steps": finest["impact"]["steps"], **{
                law: f"{float(finest[law]['u_L2']):.2g} ({float(finest[law]['v_L1']):.2g})"
                for law in ("predictive", "moreau", "impact")}})
    write("impacts_bodies", rows)


def main():
    ilaw = str(Path(sys.argv[1]).resolve())
    with tempfile.TemporaryDirectory() as folder:
        measure_costs(ilaw, folder)
        compare_with_print(ilaw, folder)
        measure_bodies(ilaw, folder)


if __name__ == "__main__":
    main()
