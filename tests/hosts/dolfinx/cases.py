# SPDX-License-Identifier: BSD-3-Clause
"""Small runs of the example api/python/examples/dolfinx, one after the other, on the ranks of mpirun.

cases.py OUT: writes what came out to OUT/<ranks>.npz, nodes sorted by their place.
cases.py OUT alone: one rank raises while the others wait for it.
"""
import hashlib
import json
import os
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, os.path.join(os.environ["ILAW_SOURCE"], "api/python/examples/dolfinx"))
from block import MPI, Block, box, mesh_of  # noqa: E402
from dolfinx import io, mesh  # noqa: E402
from pair import Pair, make, thrown  # noqa: E402
from throw import Fields, Throw, summary  # noqa: E402

COMM = MPI.COMM_WORLD
FLAT, TALL = ([2.0, 1.0, 0.5], [6, 4, 2]), ([0.5, 0.5, 3.0], [2, 2, 10])


def unstructured(out):
    """A file with a box of tetrahedra of which some edges, more of them at the plane, were cut."""
    path = out / f"mesh{COMM.size}.xdmf"
    if COMM.rank == 0:
        coarse = mesh.create_box(MPI.COMM_SELF, [np.zeros(3), np.array(FLAT[0])], FLAT[1])
        coarse.topology.create_entities(1)
        edges = np.arange(coarse.topology.index_map(1).size_local, dtype=np.int32)
        middles = mesh.compute_midpoints(coarse, 1, edges)
        chosen = edges[middles[:, 2] + 0.2 * np.sin(1e3 * middles @ [1.0, 2.0, 3.0]) < 0.1]
        with io.XDMFFile(MPI.COMM_SELF, str(path), "w") as file:
            file.write_mesh(mesh.refine(coarse, chosen, redistribute=False))
    COMM.barrier()
    return mesh_of(path)


def gathered(throw):
    """Data of all ranks on the first: x, u, v of nodes, and at the plane impulse, status and adhesion."""
    block, at = throw.block, throw.nodes
    status, impulse = np.full(block.owned, -1.0), np.zeros((block.owned, 3))
    status[at], impulse[at] = throw.contact.status, throw.contact.impulse
    return by_place([block.x, block.u, block.v, impulse, status])


def by_place(columns):
    rows = COMM.gather(np.column_stack(columns))
    if COMM.rank:
        return None
    rows = np.concatenate(rows)
    return rows[np.lexsort(np.round(rows[:, :3], 9).T)]


def run_pair(blocks, law, h, end, start):
    """x, u, v of all nodes, those of the upper block first."""
    pair = Pair(*blocks, law, h, start)
    for _ in range(round(end / h)):
        pair.step()
    rows = [by_place([block.x, block.u, block.v]) for block in blocks]
    order = hashlib.sha256(pair.interface.x.tobytes() + pair.interface.facets.tobytes()).hexdigest()
    return (None if COMM.rank else np.concatenate(rows)), {**pair.summary(), "order": order}


def waves(x):
    return np.sin(x @ np.array([[3.1, 1.2, 2.3], [1.7, 4.1, 0.6], [2.2, 1.9, 3.7]]))


def run_glued(out):
    """Two blocks that are tied, and one block of the same elements whose nodes at z = 0.5 both would have."""
    h, end, cells = 0.01, 0.5, [3, 3, 2]
    size, cache = [1.0, 1.0, 0.5], out / "compiled"
    blocks = [Block(box(size, cells, "hexahedra", [0.0, 0.0, z], wave=0.0), cache=cache) for z in (0.5, 0.0)]
    found, said = run_pair(blocks, "tie", h, end, (waves, waves))
    one = Block(box([1.0, 1.0, 1.0], [3, 3, 4], "hexahedra", wave=0.0), cache=cache)
    one.v[:] = waves(one.x)
    for _ in range(round(end / h)):
        one.u += h * one.v
        one.v -= h / one.mass[:, None] * one.forces()
    return found, by_place([one.x, one.u, one.v]), said


def run(law, shape, material, out, h, end, pull=0.0, fields=False, size=FLAT):
    made = unstructured(out) if shape == "file" else box(*size, shape)
    block = Block(made, material, cache=out / "compiled")
    throw = Throw(block, law, h, pull=pull)
    at_plane = COMM.allgather(len(throw.nodes))
    written = Fields(throw, out) if fields else None
    for step in range(round(end / h)):
        throw.step()
        if written and step % 40 == 0:
            written.write()
    if written:
        written.close()
    said = {**summary(throw, 1.0, 1.0), "at_plane": at_plane, "worst_u": block.largest(np.abs(block.u).max(initial=0.0))}
    return gathered(throw), said


def critical_step(shape, material, out):
    return Block(box(*FLAT, shape), material, cache=out / "compiled").critical_step()


CASES = {
    "coulomb, hexahedra": dict(law="coulomb", shape="hexahedra", material="elastic", h=0.008, end=0.4),
    "coulomb, a file": dict(law="coulomb", shape="file", material="elastic", h=0.004, end=0.24),
    "postit, tetrahedra": dict(
        law="postit", shape="tetrahedra", material="elastic", h=0.007, end=1.12, pull=10.0, fields=True
    ),
    "coulomb, neo-hookean": dict(law="coulomb", shape="hexahedra", material="neo-hookean", h=0.004, end=0.3),
    "postit, tall": dict(
        law="postit", shape="hexahedra", material="elastic", h=0.008, end=0.4, pull=0.1, size=TALL
    ),
}


def main(out):
    results, said = {}, {}
    for name, case in CASES.items():
        results[name], said[name] = run(out=out, **case)
    for shape, cells, h in (("tetrahedra", 5, 0.006), ("hexahedra", 4, 0.01)):
        name, blocks = f"pair, {shape}", make(cells, shape, out / "compiled")
        results[name], said[name] = run_pair(blocks, "coulomb", h, 0.24, (thrown, np.zeros_like))
    results["pair, tied"], results["one block"], said["pair, tied"] = run_glued(out)
    if COMM.size == 1:
        # The drift of the stored energy of a material that is not linear is of second order in h.
        case = dict(CASES["coulomb, neo-hookean"], end=0.2, out=out)
        steps = [0.004, 0.0027, 0.0019]
        said["drifts"] = [[h, run(**{**case, "h": h})[1]["energy"]["drift"]] for h in steps]
    said["critical step"] = critical_step("tetrahedra", "elastic", out)
    if COMM.rank == 0:
        np.savez(out / f"{COMM.size}.npz", **results)
        (out / f"{COMM.size}.json").write_text(json.dumps(said, indent=1))


def one_raises():
    if COMM.rank == COMM.size - 1:
        raise RuntimeError("this rank alone")
    COMM.barrier()


if len(sys.argv) > 2:
    one_raises()
else:
    main(Path(sys.argv[1]))
