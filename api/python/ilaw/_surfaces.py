"""The surfaces of bodies: facets that are drawn, fewer of them, and the pressure of forces on them."""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

from typing import Iterable, NamedTuple

import numpy as np

from ._results import Body, Grid


class Surface(NamedTuple):
    """Facets that are drawn, over nodes that are drawn; nodes are numbers of the model."""

    nodes: np.ndarray
    polygons: list[np.ndarray]  # of three corners, of four
    edges: np.ndarray
    offset: np.ndarray  # of the drawn node from the model's: bars have a height
    is_points: bool = False

    @property
    def triangles(self) -> np.ndarray:
        return triangles_of(self.polygons)

    @property
    def facets(self) -> np.ndarray:
        """A node of each."""
        return np.concatenate([p[:, 0] for p in self.polygons]) if self.polygons else np.empty(0, int)


def edges_of(polygons: Iterable[np.ndarray]) -> np.ndarray:
    pairs = [np.stack([p, np.roll(p, -1, axis=1)], axis=-1).reshape(-1, 2) for p in polygons if len(p)]
    return np.unique(np.sort(np.concatenate(pairs), axis=1), axis=0) if pairs else np.empty((0, 2), int)


def triangles_of(polygons: Iterable[np.ndarray]) -> np.ndarray:
    parts = [p[:, [0, k, k + 1]] for p in polygons for k in range(1, p.shape[1] - 1)]
    return np.concatenate(parts) if parts else np.empty((0, 3), int)


def compact(polygons: list[np.ndarray]) -> tuple[np.ndarray, list[np.ndarray]]:
    """The nodes that polygons use, and the polygons over them."""
    nodes = np.unique(np.concatenate([p.ravel() for p in polygons]))
    return nodes, [np.searchsorted(nodes, p) for p in polygons]


def surface_of(grid: Grid) -> Surface:
    """The boundary of the elements; lines become ribbons, and nodes alone stay points."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkFiltersGeometry import vtkDataSetSurfaceFilter

    kinds = set(np.unique(vtk_to_numpy(grid.data.GetCellTypesArray())).tolist())
    if kinds <= {1}:
        nodes = np.arange(len(grid.points))
        return Surface(nodes, [], np.empty((0, 2), int), np.zeros((len(nodes), 3)), True)
    if kinds == {3}:
        return ribbons(grid.points, vtk_to_numpy(grid.data.GetCells().GetConnectivityArray()).reshape(-1, 2))
    extractor = vtkDataSetSurfaceFilter()
    extractor.SetInputData(grid.data)
    extractor.PassThroughPointIdsOn()
    extractor.Update()
    found = extractor.GetOutput()
    ids = vtk_to_numpy(found.GetPointData().GetArray("vtkOriginalPointIds"))
    starts = vtk_to_numpy(found.GetPolys().GetOffsetsArray())
    corners = vtk_to_numpy(found.GetPolys().GetConnectivityArray())
    sizes = np.diff(starts)
    polygons = [ids[corners[starts[:-1][sizes == n][:, None] + np.arange(n)]] for n in (3, 4)]
    nodes, polygons = compact(polygons)
    return Surface(nodes, polygons, edges_of(polygons), np.zeros((len(nodes), 3)))


def ribbons(points: np.ndarray, lines: np.ndarray) -> Surface:
    count, height = len(points), 0.04 * float(np.ptp(points[:, 0]) or 1.0)
    quads = np.stack([lines[:, 0], lines[:, 1], lines[:, 1] + count, lines[:, 0] + count], axis=1)
    offset = np.zeros((2 * count, 3))
    offset[:count, 1], offset[count:, 1] = -height, height
    nodes = np.concatenate([np.arange(count)] * 2)
    return Surface(nodes, [quads], edges_of([quads]), offset)


def thinned(surface: Surface, points: np.ndarray, bodies: list[Body], share: float) -> Surface:
    """Nodes in the same cell of a raster become one; about this share of the nodes remains."""
    x = points[surface.nodes]
    body = np.searchsorted([b.first for b in bodies], surface.nodes, side="right")
    # A surface has (length of its edges)^-2 nodes per area.
    a = x[surface.edges] if len(surface.edges) else np.zeros((1, 2, 3))
    edge = float(np.median(np.linalg.norm(a[:, 0] - a[:, 1], axis=1)))
    size = (edge or float(np.ptp(x, axis=0).max()) / len(x) ** 0.5 or 1.0) / share**0.5
    cells = np.column_stack([body, np.floor((x - x.min(axis=0)) / size).astype(np.int64)])
    _, kept, member = np.unique(cells, axis=0, return_index=True, return_inverse=True)
    triangles = member.reshape(-1)[surface.triangles]
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    _, first = np.unique(np.sort(triangles, axis=1), axis=0, return_index=True)
    triangles = triangles[np.sort(first)]
    edges = np.empty((0, 2), int)
    return Surface(surface.nodes[kept], [triangles], edges, surface.offset[kept], surface.is_points)


class PushedFacets:
    """Pressure of the forces on nodes, on facets that may be of either side: a surface has no traction of its own."""

    def __init__(self, points: np.ndarray, surface: Surface) -> None:
        self.corners = [surface.nodes[p] for p in surface.polygons]
        first = np.cumsum([0, *(len(p) for p in self.corners)])
        # Of each corner: its node, its facet, and its share of the undeformed facet.
        self.node = np.concatenate([p.ravel() for p in self.corners])
        self.facet = np.concatenate([np.repeat(k + np.arange(len(p)), p.shape[1]) for k, p in zip(first, self.corners)])
        self.share = np.linalg.norm(self.vectors(points), axis=1)[self.facet] / np.bincount(self.facet)[self.facet]

    def vectors(self, x: np.ndarray) -> np.ndarray:
        """Area times outer normal of each facet: half the cross product of diagonals, or of two edges."""
        found = []
        for p in self.corners:
            a, b, c, d = (x[p[:, k]] for k in ((0, 2, 1, 3) if p.shape[1] == 4 else (0, 1, 0, 2)))
            found.append(0.5 * np.cross(b - a, d - c))
        return np.concatenate(found)

    def pressure(self, x: np.ndarray, force: np.ndarray) -> np.ndarray:
        """Of all nodes: over those of their facets that the force pushes within 60 degrees of the normal."""
        normal = self.vectors(x)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        size = np.linalg.norm(force, axis=1)
        along = -(normal[self.facet] * force[self.node]).sum(axis=1)
        is_pushed = along > 0.5 * size[self.node]
        node, share = self.node[is_pushed], self.share[is_pushed]
        area = np.bincount(node, weights=share, minlength=len(x))
        pushed = np.bincount(node, weights=share * along[is_pushed], minlength=len(x))
        return np.divide(pushed, area * area, out=np.full(len(x), np.nan), where=area > 0)
