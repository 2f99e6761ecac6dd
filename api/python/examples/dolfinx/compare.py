# SPDX-License-Identifier: BSD-3-Clause
"""The throw of throw.py with the law coulomb beside the penalty contact that codes have today, at several steps and
stiffnesses on several meshes: how far each is from a fine mesh at fine steps, and what it costs. Writes a table in
Markdown.

    mpirun -n 2 python3 compare.py --cells 4 8 12 --fine 24
"""
from __future__ import annotations

import argparse
import dataclasses
import time
from pathlib import Path

import numpy as np
from block import MPI, Block, box
from throw import PARAMETERS, Throw

FRICTION = PARAMETERS["coulomb"]["friction"]
SAMPLES = 30
VELOCITY = (0.5, 0.0, -1.0)
YOUNG, POISSON = 100.0, 0.3


class Penalty(Throw):
    """A spring at each node of the side, of so much pressure per overlap, and friction of at most what stops it."""

    def __init__(self, block, h, stiffness):
        super().__init__(block, "coulomb", h, velocity=VELOCITY)
        self.springs = stiffness * block.facet(axis=2, end="low")[1]

    def apply_law(self, before):
        block, nodes = self.block, self.nodes
        np.add(block.u[nodes, 2], self.height, out=self.gap)
        normal = self.h * self.springs[nodes] * np.maximum(-self.gap, 0.0)
        stops = -block.mass[nodes, None] * block.v[nodes, :2]
        size = np.maximum(np.linalg.norm(stops, axis=1), 1e-300)
        impulse = self.contact.impulse
        impulse[:, :2] = stops * np.minimum(FRICTION * normal / size, 1.0)[:, None]
        impulse[:, 2] = normal
        block.v[nodes] += impulse / block.mass[nodes, None]


@dataclasses.dataclass
class Result:
    h: float
    seconds: float  # of processor time, of the rank that took most
    samples: np.ndarray  # mean displacements of the lower and the upper side, at SAMPLES times
    overlap: float
    rebound: float  # mean velocity along z at the end
    end: float
    of_interface: float  # processor time of a node at the plane and step
    error: float = float("nan")

    def compare(self, reference):
        """Root mean square over the times, over that of what the plane makes of a free flight."""
        free = np.linspace(0, self.end, SAMPLES + 1)[1:, None] * np.tile(VELOCITY, 2)
        self.error = np.linalg.norm(self.samples - reference.samples) / np.linalg.norm(reference.samples - free)
        return self

    def __str__(self):
        error = "-" if self.error != self.error else f"{100 * self.error:.2f} %"
        columns = f"{1e3 * self.h:.3g}", f"{self.seconds:.2f}", error, f"{1e3 * self.overlap:.2f}"
        return " | ".join((*columns, f"{self.rebound:.3f}", f"{1e6 * self.of_interface:.1f}"))


def run(block, make, most, end):
    """With the largest step not above `most` that ends at all instants of the samples."""
    per_sample = int(np.ceil(end / SAMPLES / most))
    h = end / SAMPLES / per_sample
    block.u[:] = 0.0
    throw = make(block, h)
    sides = [block.facet(axis=2, end=which)[1] for which in ("low", "high")]
    area, mass = block.sum(sides[0].sum(), block.mass.sum())
    samples, overlap, seconds = [], 0.0, 0.0
    for step in range(1, SAMPLES * per_sample + 1):
        began = time.process_time()
        throw.step()
        seconds += time.process_time() - began
        overlap = max(overlap, (-throw.gap).max(initial=0.0))
        if step % per_sample == 0:
            samples.append(block.sum(*np.concatenate([side @ block.u for side in sides])) / area)
    rebound = block.sum(block.mass @ block.v[:, 2])[0] / mass
    each = throw.seconds_of_law / (throw.steps * max(len(throw.nodes), 1))
    seconds, overlap, each = map(block.largest, (seconds, overlap, each))
    return Result(h, seconds, np.array(samples), overlap, rebound, end, each)


class Study:
    """One mesh: `cells` across the width of the block."""

    def __init__(self, given, cells):
        size, cells = [2.0, 1.0, 0.5], [2 * cells, cells, max(cells // 2, 1)]
        self.block = Block(box(size, cells), "elastic", YOUNG, POISSON, cache=given.cache)
        self.end = given.end
        self.unit = YOUNG / (3 * (1 - 2 * POISSON)) / (size[2] / cells[2])  # bulk modulus over height of a cell
        self.area = self.block.facet(axis=2, end="low")[1]
        self.nodes = int(self.block.sum(self.block.owned)[0])
        self.critical = self.block.critical_step()

    def law(self, parts):
        def make(block, h):
            return Throw(block, "coulomb", h, velocity=VELOCITY)

        return run(self.block, make, 0.9 * self.critical / parts, self.end)

    def penalty(self, factor):
        self.block.u[:] = 0.0
        most = 0.9 * self.block.critical_step(springs=factor * self.unit * self.area)
        return run(self.block, lambda block, h: Penalty(block, h, factor * self.unit), most, self.end)


def cheapest(results, bound):
    return min((r for r in results if r.error <= bound), key=lambda r: r.seconds, default=None)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cells", type=int, nargs="+", default=[4, 8, 12], help="across the width")
    parser.add_argument("--end", type=float, default=0.3)
    parser.add_argument("--fine", type=int, default=24, help="cells of the reference")
    parser.add_argument("--stiffness", type=float, nargs="+", default=[0.1, 1.0, 10.0, 100.0],
                        help="of the penalty: pressure per overlap, times cell height over bulk modulus")
    parser.add_argument("--bounds", type=float, nargs="+", default=[0.02, 0.05, 0.1], help="errors at which to compare")
    parser.add_argument("--cache", type=Path, default=Path("compiled"), help="where dolfinx keeps what it compiles")
    given = parser.parse_args()

    def say(line):
        if MPI.COMM_WORLD.rank == 0:
            print(line, flush=True)

    fine = Study(given, given.fine)
    reference = fine.law(2)
    say("| model | nodes | step [1e-3] | CPU [s] | error | largest overlap [1e-3] | rebound | "
        "interface, each node [us] |\n" + "| --- " * 8 + "|")  # fmt: skip
    say(f"| coulomb, the reference | {fine.nodes} | {reference} |")
    say(f"| penalty 10 | {fine.nodes} | {fine.penalty(10.0).compare(reference)} |")
    laws, penalties = [], []
    for cells in given.cells:
        study = Study(given, cells)
        for parts in (1, 2):
            laws.append(study.law(parts).compare(reference))
            say(f"| coulomb | {study.nodes} | {laws[-1]} |")
        for factor in given.stiffness:
            penalties.append(study.penalty(factor).compare(reference))
            say(f"| penalty {factor:g} | {study.nodes} | {penalties[-1]} |")
    say("")
    for bound in given.bounds:
        own, other = (cheapest(results, bound) for results in (laws, penalties))
        found = f"step {other.h / own.h:.2g}, CPU {other.seconds / own.seconds:.2g}" if own and other else "not reached"
        say(f"- error within {100 * bound:g} %, penalty over coulomb: {found}")


if __name__ == "__main__":
    main()
