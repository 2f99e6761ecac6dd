#!/usr/bin/env python3
"""What an interface adds to a step of `ilaw run`, beside its law alone: processor time per point and step, in ns.

    ILAW_PATH=$PWD/build/release/lib/ilaw tests/bench/host_cost.py build/release/bin/ilaw [--points 1000] [--runs 5]

Points under gravity in flight, half of them on a plane, all of them on it; the same points without the plane; and
`ilaw bench` of the law with all outputs. Medians of runs in turn, because a busy machine disturbs all of them alike.
"""
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import json
import statistics
import subprocess
import tempfile
from pathlib import Path

LAWS = {"contact": {}, "coulomb": {"friction": 0.3}, "postit": {"friction": 0.3, "memory": 0.01, "buckets": 4}}
PART = {"flight": 0, "half": 0.5, "all": 1}  # of the points touch the plane


def step(program, law, part, count, folder):
    """Of a run with the law, or without interface."""
    steps = max(3, 200000 // count)
    masses = [{"mass": 1, "area": 1, "position": [k, 0, 0 if (k * 2654435761 >> 7) % 1000 < 1000 * part else 1e3]}
              for k in range(count)]  # fmt: skip
    plane = {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}
    scene = {"model": {"type": "points", "dimension": 3, "points": masses}, "time": {"dt": 1e-3, "end": 1e-3 * steps},
             "loads": [{"type": "gravity", "acceleration": [1, 0, -10]}], "output": {"every": steps},
             "interfaces": [{"law": law, "parameters": LAWS[law], "nodes": "all", "obstacle": plane}] if law else []}
    (folder / "scene.json").write_text(json.dumps(scene))
    subprocess.run([program, "run", folder / "scene.json", "--out", folder], check=True, stdout=subprocess.DEVNULL)
    return 1e9 * json.loads((folder / "summary.json").read_text())["seconds"]["steps"] / (steps * count)


def alone(program, law, part, count):
    command = [program, "bench", law, "--parameters", json.dumps(LAWS[law]), "--nodes", str(count), "--outputs", "all",
               "--frame", "global", "--repetitions", "1", "--json"]  # fmt: skip
    return part * json.loads(subprocess.check_output(command, text=True))[0]["ns_per_node"]


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("program")
    options.add_argument("--points", type=int, nargs="+", default=[1000, 100000])
    options.add_argument("--runs", type=int, default=5)
    given = options.parse_args()
    print("| law | points | situation | law, ns | interface, ns | step, ns |\n| --- | --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as name:
        for count in given.points:
            for law in LAWS:
                for situation, part in PART.items():
                    runs = [(alone(given.program, law, part, count), step(given.program, law, part, count, Path(name)),
                             step(given.program, None, part, count, Path(name))) for _ in range(given.runs)]
                    cells = [statistics.median(column) for column in zip(*((a, b - c, b) for a, b, c in runs))]
                    row = " | ".join([law, str(count), situation, *(f"{cell:.1f}" for cell in cells)])
                    print(f"| {row} |", flush=True)


if __name__ == "__main__":
    main()
