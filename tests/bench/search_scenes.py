#!/usr/bin/env python3
"""What the search of two plates costs a step, beside the internal forces of the plates (docs/theory/non_matching_meshes.md).

    tests/bench/search_scenes.py build/release/bin/ilaw [--sizes 20 40 80 120] [--steps 100] [--cases apart passing ...]
        [--discretization dual_mortar]

Two plates of n x n x 1 elements with edges of 1: 0.4 edges apart and at rest (apart), moving past each other (passing),
pressed on each other (resting), and sliding while pressed (sliding). Meshes are moved against each other by 0.3 edges,
`resting matched` by none. One thread.
"""
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import json
import os
import subprocess
import tempfile
from pathlib import Path

GAP = 0.4  # edges
SPEED = 0.05  # of sound waves
CASES = ("apart", "passing", "resting", "resting matched", "sliding")


def scene(case, n, steps, discretization):
    material = {"type": "linear", "young": 1.0, "poisson": 0.0, "density": 1.0}  # waves of speed 1
    pressed = case.startswith("resting") or case == "sliding"
    aside = 0.0 if case == "resting matched" else 0.3
    upper = {"name": "upper", "corner": [aside, aside, 1.0 if pressed else 1.0 + GAP], "size": [n, n, 1],
             "elements": [n, n, 1], "material": material}  # fmt: skip
    if case in ("passing", "sliding"):
        upper["velocity"] = [SPEED, 0.0, 0.0]
    lower = {"name": "lower", "size": [n, n, 1], "elements": [n, n, 1], "material": material}
    faces = ("upper.z_max", "lower.z_min") if pressed else ()
    loads = [{"type": "pressure", "surface": face, "history": [[0, 1e-4]]} for face in faces]
    return {"model": {"type": "blocks", "blocks": [lower, upper]}, "time": {"cfl": 0.9, "end": 0.45 * steps},
            "loads": loads, "output": {"every": 1000000},
            "interfaces": [{"name": "joint", "law": "coulomb", "parameters": {"friction": 0.2}, "nodes": "upper.z_min",
                            "against": {"surface": "lower.z_max", "discretization": discretization}}]}  # fmt: skip


def run(program, case, n, steps, discretization):
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "scene.json"
        file.write_text(json.dumps(scene(case, n, steps, discretization)))
        done = subprocess.run([program, "run", file, "--out", Path(folder) / "out"], text=True, capture_output=True,
                              env=os.environ | {"OMP_NUM_THREADS": "1"})  # fmt: skip
        if done.returncode:
            raise SystemExit(done.stderr)
        return json.loads((Path(folder) / "out" / "summary.json").read_text())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--sizes", type=int, nargs="+", default=[20, 40, 80, 120])
    parser.add_argument("--cases", nargs="+", choices=CASES, default=CASES)
    parser.add_argument("--steps", type=int, default=100)
    parser.add_argument("--discretization", choices=("node_to_facet", "dual_mortar"), default="node_to_facet")
    options = parser.parse_args()
    print("| case | n | interfaces, ms a step | internal forces, ms a step | ratio | interfaces, us a node |")
    print("| --- | --- | --- | --- | --- | --- |")
    for case in options.cases:
        for n in options.sizes:
            summary = run(options.program, case, n, options.steps, options.discretization)
            seconds, steps = summary["seconds"], summary["steps"]
            interfaces, forces = (1e3 * seconds[part] / steps for part in ("interfaces", "internal_forces"))
            nodes = (n + 1) ** 2
            print(f"| {case} | {n} | {interfaces:.3g} | {forces:.3g} | {interfaces / forces:.3g} | "
                  f"{1e3 * interfaces / nodes:.3g} |", flush=True)  # fmt: skip


if __name__ == "__main__":
    main()
