#!/usr/bin/env python3
"""Writes the table of the page, and a picture of the bond that peels off: the same run on 1, 2 and 4 ranks of MPI.

    compare.py THROW --picture peel.svg       THROW is the program that is built of throw.cpp
"""
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import subprocess
import tempfile
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")
matplotlib.rcParams.update({"svg.hashsalt": "ilaw", "axes.spines.top": False, "axes.spines.right": False})
import matplotlib.pyplot as plt  # noqa: E402

OPTIONS = ["--cells", "12", "--refine", "1"]


def throw(program, ranks, *options):
    with tempfile.TemporaryDirectory() as out:
        command = ["mpirun", "--oversubscribe", "-n", str(ranks), program, *OPTIONS, *options, "--out", out]
        done = subprocess.run(list(map(str, command)), check=True, text=True, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE)  # fmt: skip
        rows = np.loadtxt(Path(out) / "nodes.csv", delimiter=",", skiprows=1)
    figures = dict(line.split() for line in done.stdout.splitlines())
    return figures, rows[np.lexsort(np.round(rows[:, :3], 9).T)]


def table(program):
    print("| law | ranks | nodes | at the plane | steps | difference of displacements | `balance` | `identity` |")
    print("| --- " * 8 + "|")
    for law in ("coulomb", "rccm"):
        first = None
        for ranks in (1, 2, 4):
            figures, rows = throw(program, ranks, "--law", law)
            first = rows if first is None else first
            difference = "-" if ranks == 1 else f"{np.abs(rows - first)[:, 3:6].max():.0e}"
            print(f"| {law} | {ranks} | {figures['nodes']} | {figures['interface_nodes']} | {figures['steps']} "
                  f"| {difference} | {float(figures['balance']):.0e} | {float(figures['identity']):.0e} |", flush=True)  # fmt: skip


def picture(program, file):
    figure, (above, below) = plt.subplots(2, 1, sharex=True, figsize=(6.4, 4.6))
    for time, color in ((0.2, "tab:blue"), (0.25, "tab:orange"), (0.3, "tab:green")):
        for ranks, style in ((1, "-"), (4, "o")):
            _, rows = throw(program, ranks, "--law", "rccm", "--end", str(time))
            line = rows[(rows[:, 2] == 0) & (np.abs(rows[:, 1] - 0.5) < 1e-9)]
            line = line[np.argsort(line[:, 0])][:: 1 if ranks == 1 else 3]
            label = f"t = {time:g}, {ranks} rank" + "s" * (ranks > 1)
            above.plot(line[:, 0], 1e3 * line[:, 5], style, color=color, ms=3, lw=1, label=label)
            below.plot(line[:, 0], line[:, 11], style, color=color, ms=3, lw=1)
    above.set_ylabel("opening [mm]")
    below.set_ylabel("intensity of adhesion")
    below.set_xlabel("x [m], middle of the lower side; pulled at x = 2")
    above.legend(fontsize=8, frameon=False)
    figure.tight_layout()
    figure.savefig(file, metadata={"Date": None} if file.suffix == ".svg" else None)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", metavar="THROW", type=Path)
    parser.add_argument("--picture", metavar="FILE", type=Path)
    given = parser.parse_args()
    program = given.program.resolve()
    table(program)
    if given.picture:
        picture(program, given.picture)


if __name__ == "__main__":
    main()
