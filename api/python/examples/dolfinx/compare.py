# SPDX-License-Identifier: BSD-3-Clause
"""The throw of throw.py by the law coulomb, by kinematic contact and by penalty contact, as codes have them, on
several meshes: errors along the normal and along the plane, overlap, rebound and cost. Writes a table in Markdown.

Errors are relative to the limit of the law: the samples of the two finest meshes, extrapolated to cells of size 0 by
an error of first order. The same from the mesh before says how well a limit is known. The limits of the other methods
are in a table of their own.

    mpirun -n 2 python3 compare.py --cells 4 8 12 24 48
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
NORMAL, ALONG = [2, 5], [0, 3]  # columns of the samples: mean displacements of the lower and the upper side


class Rival(Throw):
    """Contact without a law: impulses of nodes that lie below the plane or would, and friction that stops them."""

    def __init__(self, block, h):
        super().__init__(block, "coulomb", h, velocity=VELOCITY)

    def apply_law(self, before, duration):
        block, nodes = self.block, self.nodes
        mass = block.mass[nodes]
        np.add(block.u[nodes, 2], self.height, out=self.gap)
        normal = self.push(mass)
        stops = -mass[:, None] * block.v[nodes, :2]
        size = np.maximum(np.linalg.norm(stops, axis=1), 1e-300)
        impulse = self.contact.impulse
        impulse[:, :2] = stops * np.minimum(FRICTION * normal / size, 1.0)[:, None]
        impulse[:, 2] = normal
        block.v[nodes] += impulse / mass[:, None]


class Kinematic(Rival):
    """What a node would lie below the plane at the end of the step is removed by its mass and the step: predictor and
    corrector, as forward-increment Lagrange multipliers do (Carpenter, Taylor, Katona 1991)."""

    def push(self, mass):
        overlap = -(self.gap + self.h * self.block.v[self.nodes, 2])
        return mass * np.maximum(overlap, 0.0) / self.h


class Penalty(Rival):
    """A spring at each node of the side, of so much pressure per overlap."""

    def __init__(self, block, h, stiffness):
        super().__init__(block, h)
        self.springs = stiffness * block.facet(axis=2, end="low")[1][self.nodes]

    def push(self, mass):
        return self.h * self.springs * np.maximum(-self.gap, 0.0)


@dataclasses.dataclass
class Result:
    h: float
    seconds: float  # of processor time, of the rank that took most
    samples: np.ndarray  # mean displacements of the lower and the upper side, at SAMPLES times
    overlap: float
    rebound: float  # mean velocity along z at the end
    of_interface: float  # processor time of a node at the plane and step
    factor: float = float("nan")  # stiffness of a penalty


def difference(samples, reference, columns, end):
    """Root mean square over the times, over that of what the plane makes of a free flight."""
    free = np.linspace(0, end, SAMPLES + 1)[1:, None] * np.tile(VELOCITY, 2)
    return np.linalg.norm((samples - reference)[:, columns]) / np.linalg.norm((reference - free)[:, columns])


def run(block, make, most, end, least_seconds=0.0):
    """With the largest step not above `most` that ends at all instants of the samples. Repeated until that has taken
    so much processor time, of which the mean is given."""
    per_sample = int(np.ceil(end / SAMPLES / most))
    h = end / SAMPLES / per_sample
    sides = [block.facet(axis=2, end=which)[1] for which in ("low", "high")]
    area, mass = block.sum(sides[0].sum(), block.mass.sum())
    seconds, of_interface, runs = 0.0, 0.0, 0
    while not runs or block.largest(seconds) < least_seconds:
        block.u[:] = 0.0
        throw = make(block, h)
        samples, overlap = [], 0.0
        for step in range(1, SAMPLES * per_sample + 1):
            began = time.process_time()
            throw.step()
            seconds += time.process_time() - began
            overlap = max(overlap, (-throw.gap).max(initial=0.0))
            if step % per_sample == 0:
                samples.append(block.sum(*np.concatenate([side @ block.u for side in sides])) / area)
        of_interface += throw.seconds_of_law / (throw.steps * max(len(throw.nodes), 1))
        runs += 1
    rebound = block.sum(block.mass @ block.v[:, 2])[0] / mass
    seconds, overlap, each = map(block.largest, (seconds / runs, overlap, of_interface / runs))
    return Result(h, seconds, np.array(samples), overlap, rebound, each)


class Study:
    """One mesh: `cells` across the width of the block."""

    def __init__(self, given, cells):
        size, self.cells = [2.0, 1.0, 0.5], cells
        counts = [2 * cells, cells, max(cells // 2, 1)]
        self.block = Block(box(size, counts), "elastic", YOUNG, POISSON, cache=given.cache)
        self.given, self.unit = given, YOUNG / (3 * (1 - 2 * POISSON)) / (size[2] / counts[2])
        self.area = self.block.facet(axis=2, end="low")[1]
        self.nodes = int(self.block.sum(self.block.owned)[0])
        self.critical = self.block.critical_step()

    def run(self, make, most):
        return run(self.block, make, most, self.given.end, self.given.seconds)

    def law(self):
        return self.run(lambda block, h: Throw(block, "coulomb", h, velocity=VELOCITY), 0.9 * self.critical)

    def kinematic(self):
        return self.run(Kinematic, 0.9 * self.critical)

    def penalty(self, factor):
        """Of `factor` times the bulk modulus over the height of a cell."""
        self.block.u[:] = 0.0
        most = 0.9 * self.block.critical_step(springs=factor * self.unit * self.area)
        found = self.run(lambda block, h: Penalty(block, h, factor * self.unit), most)
        return dataclasses.replace(found, factor=factor)


def limit_of(results):
    """Extrapolated from the two finest meshes, and from the two before them."""
    cells = sorted(results)

    def extrapolated(coarse, fine):
        return results[fine].samples + (results[fine].samples - results[coarse].samples) / (fine / coarse - 1.0)

    return extrapolated(*cells[-2:]), extrapolated(*cells[-3:-1])


def percent(errors):
    return " | ".join(f"{100 * error:.1f} %" for error in errors)


def row(kind, study, result, limit, end):
    errors = [difference(result.samples, limit, columns, end) for columns in (NORMAL, ALONG)]
    numbers = f"{1e3 * result.h:.3g} | {result.seconds:.2f} | {percent(errors)}"
    own = f"{1e3 * result.overlap:.2f} | {result.rebound:.3f} | {1e6 * result.of_interface:.1f}"
    return f"| {kind} | {study.nodes} | {numbers} | {own} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cells", type=int, nargs="+", default=[4, 8, 12, 24, 48], help="across the width, at least three")
    parser.add_argument("--end", type=float, default=0.3)
    parser.add_argument("--seconds", type=float, default=1.0, help="of processor time, that each run is repeated for")
    parser.add_argument("--stiffness", type=float, nargs="+", default=[float(f"{x:.2g}") for x in np.geomspace(1, 100, 9)],
                        help="of the penalty: pressure per overlap, times cell height over bulk modulus")  # fmt: skip
    parser.add_argument("--cache", type=Path, default=Path("compiled"), help="where dolfinx keeps what it compiles")
    given = parser.parse_args()
    if len(given.cells) < 3 or sorted(set(given.cells)) != given.cells:
        parser.error("--cells: expected at least three, each larger than the one before")

    def say(line):
        if MPI.COMM_WORLD.rank == 0:
            print(line, flush=True)

    studies = [Study(given, cells) for cells in given.cells]
    law = {study.cells: study.law() for study in studies}
    kinematic = {study.cells: study.kinematic() for study in studies}
    limit, doubtful = limit_of(law)

    def error(result):
        return difference(result.samples, limit, NORMAL + ALONG, given.end)

    # The penalty of each mesh is the best of all; on the finest, the one that was best on the mesh before.
    tried = [[study.penalty(factor) for factor in given.stiffness] for study in studies[:-1]]
    penalties = [min(results, key=error) for results in tried]
    factor = penalties[-1].factor
    penalties.append(studies[-1].penalty(factor))
    same = [next(r for r in results if r.factor == factor) for results in tried] + penalties[-1:]
    penalty = dict(zip(given.cells, same))
    limits = {"coulomb": (limit, doubtful), "kinematic": limit_of(kinematic), f"penalty {factor:g}": limit_of(penalty)}

    say("| model | nodes | step [1e-3] | CPU [s] | error, normal | along | largest overlap [1e-3] | rebound | "
        "interface, each node [us] |\n" + "| --- " * 9 + "|")  # fmt: skip
    for study, best in zip(studies, penalties):
        for name, result in ("coulomb", law[study.cells]), ("kinematic", kinematic[study.cells]), (None, best):
            say(row(name or f"penalty {best.factor:g}", study, result, limit, given.end))
    say("\n| limit | from coulomb's, normal | along | its doubt, normal | along |\n" + "| --- " * 5 + "|")
    for name, (own, before) in limits.items():
        distances = [difference(*pair, columns, given.end) for pair in ((own, limit), (before, own))
                     for columns in (NORMAL, ALONG)]  # fmt: skip
        say(f"| {name} | {percent(distances)} |")
    say("\n| stiffness | " + " | ".join(f"{study.nodes} nodes" for study in studies[:-1]) + " |\n"
        + "| --- " * len(studies) + "|")  # fmt: skip
    for row_of in zip(*tried):
        say(f"| {row_of[0].factor:g} | " + " | ".join(f"{100 * error(r):.1f} %, {r.seconds:.2g} s" for r in row_of) + " |")


if __name__ == "__main__":
    main()
