# SPDX-License-Identifier: BSD-3-Clause
"""A deformable block meets another one; each is split between the ranks, and so is the interface.

    mpirun -n 4 python3 pair.py --law coulomb

Every rank gathers the surfaces of both blocks and solves the whole interface, with the same bits as all others. Then
each takes the velocities of the nodes that it owns.
"""
from __future__ import annotations

import argparse
import json
import time
from pathlib import Path

import numpy as np
from block import MPI, Block, box

import ilaw
from ilaw.coupled import Bodies, Contacts, Solver
from ilaw.search import Facets, Place

PARAMETERS = {"contact": {}, "coulomb": {"friction": 0.3}, "tie": {}}


class Side:
    """The lower or upper side of a block on every rank, in an order that does not depend on the number of ranks."""

    def __init__(self, block, end):
        self.block = block
        self.nodes, area = block.facet(axis=2, end=end)
        corners, own = block.facet_places(axis=2, end=end)
        corners = np.concatenate(block.comm.allgather(corners))
        self.x, index = np.unique(np.concatenate([corners.reshape(-1, 3), own]), axis=0, return_inverse=True)
        facets, self.own = np.split(index, [corners.size // 3])  # own: places of the nodes of this rank
        self.order = np.argsort(np.concatenate(block.comm.allgather(self.own)))
        self.facets = self._sorted(facets.reshape(corners.shape[:2]), end)
        self.area, self.inverse_mass = self.gather(area[self.nodes]), 1 / self.gather(block.mass[self.nodes])

    def gather(self, rows):
        """Rows of the nodes of this rank -> rows of all nodes."""
        return np.concatenate(self.block.comm.allgather(rows))[self.order]

    def _sorted(self, facets, end):
        """Corners counterclockwise as seen from outside. The search takes the first of equally close facets, so that
        the order of facets and corners counts, too."""
        x = self.x[facets]
        up = np.cross(x[:, 1] - x[:, 0], x[:, -1] - x[:, 0])[:, 2] > 0
        facets = np.where((up == (end == "high"))[:, None], facets, facets[:, ::-1])
        turn = np.argmin(facets, axis=1)[:, None] + np.arange(facets.shape[1])
        facets = np.take_along_axis(facets, turn % facets.shape[1], axis=1)
        return facets[np.lexsort(facets.T[::-1])]


class Interface:
    """A law between the nodes of a block's lower side and the facets of another one's upper side."""

    def __init__(self, upper, lower, law, h):
        self.sides = Side(upper, "low"), Side(lower, "high")
        self.h, self.count = h, len(self.sides[0].x)
        self.x, self.inverse_mass = self.whole("x"), self.whole("inverse_mass")
        self.facets = self.sides[1].facets + self.count
        self.search, self.solver = Facets(self.facets, np.arange(self.count), self.x), Solver()
        self.law = ilaw.Interface(law, velocity_step=h, **PARAMETERS[law])
        self.impulse, self.state = np.zeros((self.count, 3)), np.zeros((self.count, self.law.state_size))
        self.contacts(np.zeros_like(self.x)).initialise()
        self.iterations = 0

    def whole(self, name):
        return np.concatenate([getattr(side, name) for side in self.sides])

    def contacts(self, u):
        self.search.update(self.x, u)
        pairs = self.search.pairs(rim=1e-9)
        far = pairs.place == Place.BEYOND
        self.gap = np.where(far, 1e3, pairs.gap)
        return Contacts(self.law, body=np.arange(self.count), counterpart=self.facets[pairs.facet],
                        counterpart_weight=pairs.weights, gap=self.gap, normal=pairs.normal, area=self.sides[0].area,
                        impulse=self.impulse, state=self.state)  # fmt: skip

    def apply(self, before, time):
        """v of both blocks is the velocity without the interface, then with it. Returns the work of the interface."""
        rows = [side.gather(np.hstack([side.block.u[side.nodes], side.block.v[side.nodes], v[side.nodes]]))
                for side, v in zip(self.sides, before)]  # fmt: skip
        u, v, v_previous = np.split(np.concatenate(rows), 3, axis=1)
        bodies = Bodies(v_free=v, v_previous=v_previous, inverse_mass=self.inverse_mass, impulse=True)
        self.at = self.contacts(u)
        report = self.solver.solve(bodies, [self.at], time=time, tolerance=1e-14)
        self.iterations += report.sweeps
        for side, velocity in zip(self.sides, np.split(bodies.velocity, [self.count])):
            side.block.v[side.nodes] = velocity[side.own]
        return np.vdot(bodies.impulse, 0.5 * (bodies.velocity + v_previous))


class Pair:
    """Central differences of both blocks. start: velocities of both, functions of the places of their nodes."""

    def __init__(self, upper, lower, law, h, start):
        self.blocks, self.h, self.steps, self.seconds = (upper, lower), h, 0, 0.0
        for block, velocity in zip(self.blocks, start):
            block.v[:] = velocity(block.x)
        self.interface = Interface(upper, lower, law, h)
        self.work = self.identity = 0.0
        self.start = self.energy([np.zeros_like(block.u) for block in self.blocks], [0.0, 0.0])
        self.momentum = self.moving()

    def energy(self, u_before, forces):
        """v M v/2 + u_n f(u_n+1)/2 of all: what remains is the work of the interface, to rounding."""
        parts = [0.5 * np.einsum("i,ij,ij", b.mass, b.v, b.v) + 0.5 * np.sum(u * f)
                 for b, u, f in zip(self.blocks, u_before, forces)]  # fmt: skip
        return self.blocks[0].sum(sum(parts))[0]

    def moving(self):
        return self.blocks[0].sum(*sum(b.mass @ b.v for b in self.blocks))

    def step(self):
        u_before = [block.u.copy() for block in self.blocks]
        for block in self.blocks:
            block.u += self.h * block.v
        forces = [block.forces() for block in self.blocks]
        error = self.energy(u_before, forces) - self.start - self.work
        self.identity = max(self.identity, abs(error / self.start))
        before = [block.v.copy() for block in self.blocks]
        for block, force in zip(self.blocks, forces):
            block.v -= self.h / block.mass[:, None] * force
        self.steps += 1
        began = time.process_time()
        self.work += self.interface.apply(before, self.steps * self.h)
        self.seconds += time.process_time() - began

    def summary(self):
        comm, sides = self.blocks[0].comm, self.interface.sides
        scale = sum(self.blocks[0].sum(*(np.abs(b.mass @ np.abs(b.v)).sum() for b in self.blocks)))
        return {
            "ranks": comm.size, "steps": self.steps, "interface_nodes": [len(side.x) for side in sides],
            "of_ranks": [comm.allgather(len(side.nodes)) for side in sides],
            "identity": self.identity, "momentum": float(np.abs(self.moving() - self.momentum).max() / scale),
            "work": self.work / self.start, "iterations": self.interface.iterations / self.steps,
            "milliseconds_of_interface": 1e3 * self.blocks[0].largest(self.seconds) / self.steps,
        }  # fmt: skip


def make(cells, shape, cache=None):
    """A block above a larger one, whose meshes do not match."""
    upper = box([1.0, 1.0, 0.5], [cells, cells, max(cells // 2, 1)], shape, corner=[0.3173, 0.2291, 0.513])
    lower = box([1.7, 1.5, 0.5], [cells + 3, cells + 2, max(cells // 2, 1)], shape)
    return Block(upper, cache=cache), Block(lower, cache=cache)


def thrown(x):
    return np.tile([0.5, 0.2, -1.0], (len(x), 1))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--law", choices=PARAMETERS, default="coulomb")
    parser.add_argument("--mesh", choices=["tetrahedra", "hexahedra"], default="tetrahedra")
    parser.add_argument("--cells", type=int, default=8, help="along an edge of length 1")
    parser.add_argument("--end", type=float, default=0.3)
    parser.add_argument("--cache", type=Path, default=Path("compiled"), help="folder of compiled forms")
    given = parser.parse_args()
    blocks = make(given.cells, given.mesh, given.cache)
    h = 0.9 * min(block.critical_step() for block in blocks)
    pair = Pair(*blocks, given.law, h, (thrown, np.zeros_like))
    for _ in range(round(given.end / h)):
        pair.step()
    said = pair.summary()
    if MPI.COMM_WORLD.rank == 0:
        print(json.dumps(said, indent=2))


if __name__ == "__main__":
    main()
