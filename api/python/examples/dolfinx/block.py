# SPDX-License-Identifier: BSD-3-Clause
"""An elastic block for explicit dynamics in dolfinx: lumped masses and internal forces at the nodes of this rank.

Every rank calls every function together, whatever nodes it has.
"""
from __future__ import annotations

import sys
import traceback

import numpy as np
import ufl
from dolfinx import cpp, fem, io, la, mesh
from mpi4py import MPI


def abort_all_ranks(kind, error, trace):
    """An exception on one rank alone would leave the others in their next collective call, for ever."""
    traceback.print_exception(kind, error, trace)
    sys.stderr.flush()
    MPI.COMM_WORLD.Abort(1)


sys.excepthook = abort_all_ranks


def box(size, cells, shape="tetrahedra", corner=(0.0, 0.0, 0.0), wave=0.15):
    """A box whose inner vertices are out of line, by `wave` of a cell at most, the same whatever rank has them."""
    kind = {"tetrahedra": mesh.CellType.tetrahedron, "hexahedra": mesh.CellType.hexahedron}[shape]
    size, corner = np.array(size, float), np.array(corner, float)
    made = mesh.create_box(MPI.COMM_WORLD, [corner, corner + size], cells, kind, mesh.GhostMode.none)
    x = made.geometry.x
    inside = np.all(np.abs(x - corner - 0.5 * size) < (0.5 - 1e-9) * size, axis=1)
    waves = np.array([[12.9898, 39.3461, 73.156], [78.233, 11.1352, 52.235], [37.719, 83.155, 9.151]])
    x[inside] += wave * size / cells * np.sin(x[inside] @ waves)
    return made


def mesh_of(path):
    """The mesh of an XDMF file, as gmsh with meshio or dolfinx itself write it."""
    with io.XDMFFile(MPI.COMM_WORLD, str(path), "r") as file:
        return file.read_mesh(mesh.GhostMode.none)


def fix_signatures(made):
    """Forms have one name on all ranks, so that what rank 0 compiles is what the others load.

    ffcx 0.5 writes `variant` into the mesh of a form that it compiles, which changes the names of all later forms
    on the rank that compiled, 0, alone: the other ranks then compile for themselves, wait for each other for 10 s,
    and one that gives up leaves the rest in a collective call.
    """
    element = ufl.VectorElement("Lagrange", made.ufl_cell(), 1, variant="equispaced")
    made.ufl_domain()._ufl_coordinate_element = element


def stress(material, u, young, poisson):
    """Stress (first Piola-Kirchhoff) and stored energy, both per reference volume."""
    mu, lame = young / (2 * (1 + poisson)), young * poisson / ((1 + poisson) * (1 - 2 * poisson))
    if material == "elastic":
        strain = ufl.sym(ufl.grad(u))
        sigma = 2 * mu * strain + lame * ufl.tr(strain) * ufl.Identity(3)
        return sigma, 0.5 * ufl.inner(sigma, strain)
    # Compressible neo-Hookean: Bonet and Wood (2008), equations 6.27 and 6.28.
    F = ufl.variable(ufl.Identity(3) + ufl.grad(u))
    log_j = ufl.ln(ufl.det(F))
    energy = 0.5 * mu * (ufl.inner(F, F) - 3) - mu * log_j + 0.5 * lame * log_j**2
    return ufl.diff(energy, F), energy


class Block:
    """Arrays (n, 3) of the n nodes that this rank owns: x, v, mass (n,); u and forces are views.

    material: "elastic" (small strains) or "neo-hookean". cache: folder of the code that dolfinx compiles; it
    has to be one that all ranks see. Without it dolfinx takes ~/.cache.
    """

    def __init__(self, made, material="elastic", young=100.0, poisson=0.3, density=1.0, cache=None):
        self.mesh, self.comm, self.material = made, made.comm, material
        fix_signatures(made)
        self._jit = {"timeout": 60} if cache is None else {"timeout": 60, "cache_dir": str(cache)}
        cell = made.ufl_cell()
        self.space = fem.FunctionSpace(made, ufl.VectorElement("Lagrange", cell, 1), jit_params=self._jit)
        self.displacement = fem.Function(self.space)
        self.displacement.name = "displacement"
        places = self.space.dofmap.index_map
        self.owned = places.size_local
        self.u = self.displacement.x.array.reshape(-1, 3)[: self.owned]
        self.x = self.space.tabulate_dof_coordinates()[: self.owned]
        self.v = np.zeros((self.owned, 3))

        self._sum = la.vector(places, 3)
        test = ufl.TestFunction(self.space)
        sigma, energy = stress(material, self.displacement, young, poisson)
        # Exact for gradients of tetrahedra, and the usual eight points of hexahedra.
        points = ufl.dx(metadata={"quadrature_degree": 1 if str(cell) == "tetrahedron" else 2})
        self._internal = self._form(ufl.inner(sigma, ufl.grad(test)) * points)
        self._energy = self._form(energy * points)
        ones = ufl.as_vector([1.0, 1.0, 1.0])
        self.mass = self._assembled(self._form(density * ufl.dot(ones, test) * ufl.dx))[:, 0].copy()

    def _form(self, form):
        return fem.form(form, jit_params=self._jit)

    def _assembled(self, form):
        """The vector of a form at owned nodes, complete: with what cells of other ranks add."""
        self._sum.array[:] = 0.0
        fem.assemble_vector(self._sum.array, form)
        self._sum.scatter_reverse(la.ScatterMode.add)
        return self._sum.array.reshape(-1, 3)[: self.owned]

    def forces(self):
        """Internal forces of the displacements u. The array is the same in every call."""
        self.displacement.x.scatter_forward()
        return self._assembled(self._internal)

    def stored(self):
        """Elastic energy, all ranks."""
        return self.sum(fem.assemble_scalar(self._energy))[0]

    def sum(self, *values):
        """The sums over all ranks."""
        return self.comm.allreduce(np.array(values, float))

    def largest(self, value):
        return self.comm.allreduce(value, MPI.MAX)

    def _facets(self, axis, end):
        """The facets of a side that this rank has: each is on one rank."""
        place = (self.x[:, axis].min() if end == "low" else -self.x[:, axis].max()) if self.owned else np.inf
        place = self.comm.allreduce(place, MPI.MIN) * (1 if end == "low" else -1)
        return mesh.locate_entities_boundary(self.mesh, 2, lambda x: np.isclose(x[axis], place))

    def facet_places(self, axis, end):
        """Places of the corners around each facet of a side on this rank, and of its owned nodes as in `facet`.

        As the mesh has them, so that they have the same bits on all ranks, which x has not.
        """
        vertices = cpp.mesh.entities_to_geometry(self.mesh._mesh, 2, self._facets(axis, end), False)
        if vertices.shape[1] == 4:
            vertices = vertices[:, [0, 1, 3, 2]]  # around the facet, not by rows
        of_nodes = np.empty((self._sum.array.size // 3, 3))
        of_nodes[self.space.dofmap.list.array] = self.mesh.geometry.x[self.mesh.geometry.dofmap.array]
        return self.mesh.geometry.x[vertices], of_nodes[self.facet(axis, end)[0]]

    def facet(self, axis, end):
        """A side of the box: its owned nodes, and the area [m^2] that belongs to each (0 elsewhere)."""
        facets = self._facets(axis, end)
        tags = mesh.meshtags(self.mesh, 2, np.sort(facets), np.ones(len(facets), np.int32))
        side = ufl.Measure("ds", domain=self.mesh, subdomain_data=tags)(1)
        test = ufl.TestFunction(self.space)
        area = self._assembled(self._form(ufl.dot(ufl.as_vector([1.0, 1.0, 1.0]), test) * side))[:, 0].copy()
        return np.flatnonzero(area > 0), area

    def critical_step(self, springs=0.0):
        """2/omega of the fastest oscillation at rest, by the power method; the same on any number of ranks.

        springs: stiffness [N/m] of a spring along z at each owned node, if there are any.
        """
        tiny = 1e-7
        w = np.sin(1e3 * self.x + [0.0, 1.0, 2.0])
        for _ in range(60):
            self.u[:] = tiny * w
            w = self.forces() / (tiny * self.mass[:, None])
            w[:, 2] += springs * self.u[:, 2] / (tiny * self.mass)
            square = np.sqrt(self.sum(np.vdot(w, w))[0])
            w /= square
        self.u[:] = 0.0
        # The last growth is below the eigenvalue, by less than what the digits that are dropped take away.
        return float(f"{1.96 / np.sqrt(square):.1e}")
