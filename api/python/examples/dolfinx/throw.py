# SPDX-License-Identifier: BSD-3-Clause
"""A block is thrown on a plane and, where the law is a Post-it, peeled off it again.

    mpirun -n 2 python3 throw.py --law postit --out results
"""
from __future__ import annotations

import argparse
import json
import time
from pathlib import Path

import numpy as np
from block import MPI, Block, box, mesh_of
from dolfinx import fem, io

import ilaw

PARAMETERS = {
    "contact": {},
    "coulomb": {"friction": 0.3},
    "postit": {"friction": 0.3, "memory": 0.05, "tangent_influence": 0.8},
}


class Throw:
    """Central differences with a law between the lower side of a block and the plane z = -gap, which moves by `plane`.

    The law sees the owned nodes of that side, in arrays of their own; a rank may have none.
    """

    def __init__(self, block, law, h, gap=0.013, velocity=(0.5, 0.0, -1.0), pull=0.0, after=0.3, parameters=None,
                 plane=(0.0, 0.0, 0.0)):  # fmt: skip
        self.block, self.h, self.pull, self.after, self.plane = block, h, pull, after, np.array(plane)
        self.nodes, area = block.facet(axis=2, end="low")
        self.lift = block.facet(axis=0, end="high")[1]  # [m^2], of the side that is pulled
        count = len(self.nodes)
        self.v_nodes, self.v_before, self.gap = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count)
        self.height = block.x[self.nodes, 2] + gap
        interface = ilaw.Interface(law, position_step=h, **(PARAMETERS[law] if parameters is None else parameters))
        self.contact = interface.batch(
            v_free=self.v_nodes,
            v_previous=self.v_before,
            delassus=1 / block.mass[self.nodes],
            gap=self.gap,
            area=area[self.nodes],
            normal=[0, 0, 1],
        )
        self.contact.initialise()
        self.sides = np.flatnonzero(self.lift)
        block.v[:] = velocity
        self.steps, self.seconds_of_law = 0, 0.0
        self.works = np.zeros(3)  # of internal forces, the pull and the law, on this rank
        self.outside = np.zeros_like(block.v)
        self.start = self.kinetic() or 1.0  # the energy that errors are relative to
        self.balance = self.identity = self.approach = 0.0

    def kinetic(self):
        """Half the square of the half-step velocities, all ranks."""
        return 0.5 * self.block.sum(np.einsum("i,ij,ij->", self.block.mass, self.block.v, self.block.v))[0]

    def step(self):
        block = self.block
        if self.steps == 0:
            self.kick(block.forces(), 0.5 * self.h)  # velocities are those of the half steps from here on
        u_before = block.u.copy()
        block.u += self.h * block.v
        forces = block.forces()
        self.check_energy(u_before, forces)
        self.steps += 1
        self.kick(forces, self.h)

    def loads(self):
        """Forces from outside at the time of the positions."""
        pull = self.pull * max(self.steps * self.h - self.after, 0.0)
        self.outside[self.sides, 2] = pull * self.lift[self.sides]
        return self.outside

    def kick(self, forces, duration):
        v, loads = self.block.v, self.loads()
        before = v.copy()
        v += duration / self.block.mass[:, None] * (loads - forces)

        began = time.process_time()
        self.apply_law(before, duration)
        self.seconds_of_law += time.process_time() - began

        mean = 0.5 * (v + before)
        self.works += [
            -duration * np.vdot(forces, mean),
            duration * np.vdot(loads, mean),
            np.vdot(self.contact.impulse, mean[self.nodes]),
        ]

    def apply_law(self, before, duration):
        """v of the nodes at the plane is the velocity without the interface, then with it."""
        block, nodes = self.block, self.nodes
        now = self.steps * self.h
        np.subtract(block.v[nodes], self.plane, out=self.v_nodes)
        np.subtract(before[nodes], self.plane, out=self.v_before)
        np.add(block.u[nodes, 2], self.height - now * self.plane[2], out=self.gap)
        self.contact.evaluate(time=now, velocity_step=duration)
        block.v[nodes] += self.contact.impulse / block.mass[nodes, None]
        # Promised of nodes that are not free: v_N >= -gap/h where the gap is open, else 0, and no less than the
        # reverse of the speed with which a node was leaving (docs of the law contact).
        promise = -np.maximum(np.maximum(self.gap, 0.0) / self.h, self.v_before[:, 2])
        broken = np.where(self.contact.status, promise + self.plane[2] - block.v[nodes, 2], 0.0)
        self.approach = max(self.approach, broken.max(initial=0.0))

    def check_energy(self, u_before, forces):
        """Largest errors so far, relative to the energy of the throw.

        balance: kinetic energy against the works of all forces, an identity of the scheme for any material.
        identity: the discrete energy v M v/2 + u_n f(u_n+1)/2 against the works from outside, an identity for
        linear materials.
        """
        block = self.block
        kinetic = 0.5 * np.einsum("i,ij,ij->", block.mass, block.v, block.v)
        stored = 0.5 * np.vdot(u_before, forces)
        internal, pull, law = self.works
        errors = block.sum(kinetic - internal - pull - law, kinetic + stored - pull - law)
        errors = np.abs(errors / self.start - 1)
        self.balance, self.identity = max(self.balance, errors[0]), max(self.identity, errors[1])

    def drift(self):
        """Energy v M v/2 + (W(u_n+1) + W(u_n+2))/2 against the works from outside: second order in h."""
        block = self.block
        here, u = block.stored(), block.u.copy()
        block.u += self.h * block.v
        block.forces()
        ahead = block.stored()
        block.u[:] = u
        works = block.sum(self.works[1] + self.works[2])[0]
        return (self.kinetic() + 0.5 * (here + ahead) - works) / self.start - 1


class Fields:
    """Displacement, status and adhesion for ParaView: OUT/block.xdmf."""

    def __init__(self, throw, folder):
        self.throw, block = throw, throw.block
        scalars, of_vectors = block.space.sub(0).collapse()
        self.node_of = np.array(of_vectors[: block.owned]) // 3
        self.status, self.adhesion = fem.Function(scalars), fem.Function(scalars)
        self.status.name, self.adhesion.name = "status", "adhesion"
        self.file = io.XDMFFile(block.comm, str(folder / "block.xdmf"), "w")
        self.file.write_mesh(block.mesh)

    def write(self):
        throw = self.throw
        values = {self.status: throw.contact.status}
        if any(variable.name == "adhesion" for variable in throw.contact.interface.state_variables):
            values[self.adhesion] = throw.contact.variable("adhesion")[:, 0]
        for function, at_nodes in values.items():
            at_all = np.zeros(throw.block.owned)
            at_all[throw.nodes] = at_nodes
            function.x.array[: throw.block.owned] = at_all[self.node_of]
            function.x.scatter_forward()
        throw.block.displacement.x.scatter_forward()
        for function in (throw.block.displacement, *values):
            self.file.write_function(function, throw.steps * throw.h)

    def close(self):
        self.file.close()


def summary(throw, seconds, processor_seconds):
    """The results of the run, the same on all ranks."""
    block = throw.block
    processor_seconds = block.largest(processor_seconds)
    counts = np.bincount(throw.contact.status, minlength=len(ilaw.Status))
    energy = {"balance": throw.balance, "drift": throw.drift()}
    if block.material == "elastic":
        energy["identity"] = throw.identity
    return {
        "ranks": block.comm.size,
        "nodes": int(block.sum(block.owned)[0]),
        "interface_nodes": int(block.sum(len(throw.nodes))[0]),
        "dt": throw.h,
        "steps": throw.steps,
        "energy": energy,
        "approach": block.largest(throw.approach),
        "status_counts": dict(zip((s.name.lower() for s in ilaw.Status), map(int, block.sum(*counts)))),
        "milliseconds_per_step": 1e3 * seconds / throw.steps,
        "processor_milliseconds_per_step": 1e3 * processor_seconds / throw.steps,
        "share_of_law": block.largest(throw.seconds_of_law) / processor_seconds,
    }


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--law", choices=PARAMETERS, default="postit")
    parser.add_argument("--material", choices=["elastic", "neo-hookean"], default="elastic")
    parser.add_argument("--mesh", default="tetrahedra", help="of a box: tetrahedra or hexahedra; or an XDMF file")
    parser.add_argument("--cells", type=int, default=8, help="cells across the width")
    parser.add_argument("--gap", type=float, default=0.013, help="at the start")
    parser.add_argument("--end", type=float, default=1.2)
    parser.add_argument("--dt", type=float, help="default: 0.9 of the critical step")
    parser.add_argument("--steps", type=int, help="end after so many, whatever --end says")
    parser.add_argument("--pull", type=float, default=10.0, help="rate of the traction on one side, from t = 0.3 on")
    parser.add_argument("--every", type=int, default=20, help="steps between fields")
    parser.add_argument("--out", type=Path, default=Path("results"))
    return parser.parse_args()


def main():
    given = arguments()
    if MPI.COMM_WORLD.rank == 0:
        given.out.mkdir(parents=True, exist_ok=True)
    MPI.COMM_WORLD.barrier()
    n = given.cells
    of_box = given.mesh in ("tetrahedra", "hexahedra")
    mesh = box([2.0, 1.0, 0.5], [2 * n, n, max(n // 2, 1)], given.mesh) if of_box else mesh_of(given.mesh)
    block = Block(mesh, given.material, cache=given.out / "compiled")
    h = given.dt or float(f"{0.9 * block.critical_step():.2g}")
    throw = Throw(block, given.law, h, given.gap, pull=given.pull if given.law == "postit" else 0.0)
    fields = Fields(throw, given.out)
    seconds = processor_seconds = 0.0
    for step in range(given.steps or round(given.end / h)):
        began = time.perf_counter(), time.process_time()
        throw.step()
        seconds += time.perf_counter() - began[0]
        processor_seconds += time.process_time() - began[1]
        if (step + 1) % given.every == 0:
            fields.write()
    fields.close()
    said = json.dumps(summary(throw, seconds, processor_seconds), indent=2)
    if MPI.COMM_WORLD.rank == 0:
        print(said)
        (given.out / "summary.json").write_text(said + "\n")


if __name__ == "__main__":
    main()
