#!/usr/bin/env python3
"""Pressure between two blocks whose meshes do not match, from one side and from both: the table of
docs/theory/non_matching_meshes.md.

Usage: ILAW_PATH=build/release/lib/ilaw docs/results/non_matching.py build/release/bin/ilaw

Least and largest pressure over the nodes of both faces, over the mean one, which is exact; iterations a step, of the
nodes of the fine side and of both.
"""
import argparse
import csv
import json
import subprocess
import tempfile
from pathlib import Path

import numpy

PRESSURE, YOUNG, DENSITY, HEIGHT, FRICTION = 1e3, 1e6, 1e3, 0.5, 0.3
SIDES = ("fine", "coarse", "both")
FACES = {"a.z_max": 0, "b.z_min": 1}


def layers(elements):
    return max(2, elements // 2)


def block(name, corner, elements, velocity, poisson):
    material = {"type": "linear", "young": YOUNG, "poisson": poisson, "density": DENSITY}
    return {"name": name, "corner": [0, 0, corner], "size": [1, 1, HEIGHT], "velocity": [0, 0, velocity],
            "elements": [elements, elements, layers(elements)], "material": material}


def interface(side, law, parameters):
    nodes, surface = ("a.z_max", "b.z_min") if side == "coarse" else ("b.z_min", "a.z_max")
    against = {"surface": surface, "both_sides": True} if side == "both" else {"surface": surface}
    return {"name": "joint", "law": law, "parameters": parameters, "nodes": nodes, "against": against}


def scene(case, coarse, fine, side):
    """Blocks a, below, and b; a wave of uniform pressure, or a load that grows smoothly and is damped."""
    speed = 1.0 if case == "impact" else 0.0
    poisson = 0.3 if case == "at rest" else 0.0
    slides = case == "sliding"
    made = {"model": {"type": "blocks", "blocks": [block("a", 0, coarse, speed, poisson),
                                                   block("b", HEIGHT, fine, -speed, poisson)]},
            "interfaces": [interface(side, "coulomb", {"friction": FRICTION}) if slides else
                           interface(side, "contact", {})],
            "output": {"watch": list(FACES)}}
    if case == "impact":  # until the waves come back
        made["time"] = {"cfl": 0.9, "end": 0.9 * HEIGHT / (YOUNG / DENSITY) ** 0.5}
        return made
    made["time"] = {"cfl": 0.9, "end": 0.8}
    made["output"]["every"] = 1000000
    made["loads"] = [
        {"type": "motion", "nodes": "a.z_min", "axes": [2]},
        {"type": "pressure", "surface": "b.z_max",
         "history": {"rows": [[0, 0], [0.2, PRESSURE]], "smooth": True}},
        {"type": "damping", "rate": 60}]
    if slides:  # b as a whole, on a face that stays where it is
        made["loads"] += [{"type": "motion", "nodes": "a", "axes": [0, 1]},
                          {"type": "motion", "nodes": "b", "axes": [0, 1], "velocity": [1e-3, 0, 0]}]
    return made


def run(ilaw, made):
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "scene.json"
        file.write_text(json.dumps(made))
        subprocess.run([ilaw, "run", file, "--out", folder, "--threads", "1"], check=True, capture_output=True)
        summary = json.loads((Path(folder) / "summary.json").read_text())
        with (Path(folder) / "history.csv").open() as rows:
            return summary, list(csv.DictReader(rows))


def pressures(rows, coarse, fine, axis):
    """Of both faces, over their mean: sums of the impulses over the tributary areas."""
    found = []
    for elements, first in ((coarse, (coarse + 1) ** 2 * layers(coarse)),
                            (fine, (coarse + 1) ** 2 * (layers(coarse) + 1))):
        edge = numpy.full(elements + 1, 1.0 / elements)
        edge[[0, -1]] *= 0.5
        nodes = range(first, first + (elements + 1) ** 2)
        impulse = [sum(float(row[f"n{node}.r{axis}"]) for row in rows) for node in nodes]
        pressure = impulse / numpy.outer(edge, edge).ravel()
        found.append(pressure / numpy.sum(impulse))
    return numpy.concatenate(found)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("ilaw")
    parser.add_argument("--meshes", nargs="+", default=["3:5", "6:10", "12:20"])
    parser.add_argument("--cases", nargs="+", default=["impact", "at rest", "sliding"])
    arguments = parser.parse_args()
    print("| case | elements | nodes of the fine side | of the coarse side | both sides | iterations |")
    print("| --- | --- | --- | --- | --- | --- |")
    for case in arguments.cases:
        for mesh in arguments.meshes:
            coarse, fine = map(int, mesh.split(":"))
            cells, sweeps = [], {}
            for side in SIDES:
                summary, rows = run(arguments.ilaw, scene(case, coarse, fine, side))
                p = pressures(rows if case == "impact" else rows[-1:], coarse, fine, 0 if case == "sliding" else 2)
                off = abs(p - 1).max()
                cells.append(f"{p.min():.3f} to {p.max():.3f}" if off > 1e-3 else f"1, to {off:.0e}")
                sweeps[side] = summary["coupling"]["sweeps"] / summary["steps"]
            print(f"| {case} | {coarse} on {fine} | {' | '.join(cells)} | {sweeps['fine']:.0f}, {sweeps['both']:.0f} |",
                  flush=True)


if __name__ == "__main__":
    main()
