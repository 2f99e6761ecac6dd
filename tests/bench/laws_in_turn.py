#!/usr/bin/env python3
"""Sets two runs of `ilaw bench` side by side, case by case: libraries of two builds, or two sets of options.

    tests/bench/laws_in_turn.py build/release/bin/ilaw --libraries BEFORE AFTER -- coulomb --nodes 2000 10000000
    tests/bench/laws_in_turn.py build/release/bin/ilaw --libraries build/release/lib/ilaw --second=--float -- contact

BEFORE and AFTER are folders of libraries. Medians of runs in turn: a machine that is busy with other work disturbs
both alike.
"""
import argparse
import json
import os
import shlex
import statistics
import subprocess
import sys


def measured(program, libraries, options):
    done = subprocess.run([program, "bench", *options, "--json"], env={**os.environ, "ILAW_PATH": libraries},
                          stdout=subprocess.PIPE, text=True, check=True)
    return json.loads(done.stdout)


def folder(path):
    """Absolute: `ilaw` passes over others on its search path, and would take its own laws."""
    if not os.path.isdir(path):
        raise argparse.ArgumentTypeError(f"'{path}' is no folder")
    return os.path.abspath(path)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="ilaw")
    parser.add_argument("--libraries", nargs="+", type=folder, required=True,
                        help="one folder, or two: the first, the second")
    parser.add_argument("--second", default="", help="options of the second run alone")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("options", nargs="+", help="after --: what both runs of `ilaw bench` are given")
    given = parser.parse_args()
    if len(given.libraries) > 2:
        parser.error(f"--libraries: {len(given.libraries)} folders, expected one or two")
    sides = [(given.libraries[0], given.options), (given.libraries[-1], given.options + shlex.split(given.second))]
    runs = [[measured(given.program, *side) for side in sides] for _ in range(given.runs)]
    if len({len(run) for pair in runs for run in pair}) != 1:
        parser.error("--second: as many cases are needed as in the first run")
    print("| law | case | nodes | first, ns | second, ns | second / first | by ratios |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for k, case in enumerate(runs[0][0]):
        first, second = ([pair[side][k] for pair in runs] for side in (0, 1))
        times = [statistics.median(run["ns_per_node"] for run in side) for side in (first, second)]
        ratios = [statistics.median(run["ratio"] for run in side) for side in (first, second)]
        print(f"| {case['law']} | {case['case']} | {case['nodes']:g} | {times[0]:.2f} | {times[1]:.2f} | "
              f"{times[1] / times[0]:.2f} | {ratios[0]:.2f} -> {ratios[1]:.2f} |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
