#!/usr/bin/env python3
"""Performance profiles (Dolan, More 2002) of the coupled solver beside the solvers of Siconos, on files of problems.

    contact_problems.py FOLDER --bin build/release/bin --picture profiles.png       (laws: ILAW_PATH)

A file is one that ilaw_bench_coupled_convergence reads (*.dat of Siconos, *.hdf5 of FCLIB). A profile is the part of the
problems that a solver solves within a multiple of the time of the fastest solver on each.
"""
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import subprocess
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")
matplotlib.rcParams.update({"axes.spines.top": False, "axes.spines.right": False})
import matplotlib.pyplot as plt  # noqa: E402

OURS, LEAST = "ilaw coupled", 1e-5  # seconds: shorter times count as this


def number(text):
    return np.inf if text == "-" else max(float(text), LEAST)


def measure(program, limit, files):
    done = subprocess.run([program, "--limit", str(limit), *files], text=True, stdout=subprocess.PIPE, check=True)
    return [line.split() for line in done.stdout.splitlines()]


def times(given, files):
    """{problem: {solver: seconds to 1e-4, to 1e-8}}, and rows of the problems: contacts, asymmetry."""
    found, problems = {}, {}
    for row in measure(given.bin / "ilaw_bench_coupled_convergence", given.limit, files):
        if row[0] == "problem" or int(row[1]) < given.least:
            continue
        problems[row[0]] = row[1:4]
        found[row[0]] = {OURS: (number(row[5]), number(row[7]))}
    named = [file for file in files if Path(file).name in found]
    for name, solver, *seconds in measure(given.bin / "ilaw_bench_siconos_solvers", given.limit, named):
        found[name][solver] = tuple(map(number, seconds))
    return found, problems


def ratios(found, target):
    """{solver: its times over those of the fastest on each problem that any solver solved}."""
    seconds = {name: {solver: pair[target] for solver, pair in of.items()} for name, of in found.items()}
    solved = [of for of in seconds.values() if min(of.values()) < np.inf]
    return {solver: np.array([of[solver] / min(of.values()) for of in solved]) for solver in next(iter(found.values()))}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--bin", type=Path, required=True, help="folder of the two programs")
    parser.add_argument("--limit", type=float, default=1.0, help="seconds for a solver, a problem and a residual")
    parser.add_argument("--least", type=int, default=20, help="contacts of the smallest problem that counts")
    parser.add_argument("--picture", metavar="FILE", type=Path)
    given = parser.parse_args()
    files = sorted(str(file) for file in given.folder.iterdir() if file.suffix in (".dat", ".hdf5"))
    found, problems = times(given, files)
    print("| problem | contacts | W - W' | changed by | ilaw, 1e-4 | fastest other | ilaw, 1e-8 | fastest other |\n" + "| --- " * 8 + "|")
    for name, of in found.items():
        cells = []
        for target in (0, 1):
            best = min((pair[target], solver) for solver, pair in of.items() if solver != OURS)
            cells += [f"{1e3 * of[OURS][target]:.2g} ms", f"{1e3 * best[0]:.2g} ms, {best[1]}" if best[0] < np.inf else "-"]
        print(f"| {name} | {' | '.join(problems[name])} | {' | '.join(cells)} |".replace("inf ms", "-"))
    print("\n| solver | solved to 1e-4 | within twice the fastest | solved to 1e-8 | within twice the fastest |\n" + "| --- " * 5 + "|")
    both = [ratios(found, target) for target in (0, 1)]
    order = sorted(both[0], key=lambda solver: -sum(np.isfinite(each[solver]).sum() for each in both))
    for solver in order:
        cells = [f"{np.isfinite(each[solver]).sum()} | {(each[solver] <= 2).sum()}" for each in both]
        print(f"| {solver} | {' | '.join(cells)} |")
    print(f"\n{len(found)} problems, {given.limit:g} s each")
    if given.picture:
        picture(both, order, len(found), given.picture)


def picture(both, order, count, file):
    figure, axes = plt.subplots(1, 2, figsize=(8.6, 3.4), sharey=True)
    tau = np.logspace(0, 4, 400)
    for plot, each, target in zip(axes, both, ("1e-4", "1e-8")):
        for solver in order[:7]:
            share = [(each[solver] <= t).sum() / count for t in tau]
            plot.semilogx(tau, share, label=solver, lw=2.4 if solver == OURS else 1.1)
        plot.set_xlabel(f"multiple of the fastest time, residual {target}")
    axes[0].set_ylabel("part of the problems")
    axes[1].legend(fontsize=7, frameon=False, loc="lower right")
    figure.tight_layout()
    figure.savefig(file)


if __name__ == "__main__":
    main()
