#!/usr/bin/env python3
"""Writes bracket.vtu beside itself: an angle bracket of tetrahedra, as a mesh generator would. Lengths are in metres.

Usage: bracket.py [FILE]
"""

import sys
from pathlib import Path

WIDTH, THICKNESS, FOOT, WALL = 0.03, 0.006, 0.06, 0.04  # the wall stands on the foot at x = 0

# Kuhn's six tetrahedra of a cell; their faces fit those of the next cell.
SPLIT = [(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)]


def steps(start, end, count):
    return [start + (end - start) * k / count for k in range(1, count + 1)]


def make():
    xs = [0.0] + steps(0.0, THICKNESS, 2) + steps(THICKNESS, FOOT, 11)
    ys = [0.0] + steps(0.0, WIDTH, 6)
    zs = [0.0] + steps(0.0, THICKNESS, 2) + steps(THICKNESS, WALL, 7)
    number, points, cells = {}, [], []

    def node(i, j, k):
        if (i, j, k) not in number:
            number[i, j, k] = len(points)
            points.append((xs[i], ys[j], zs[k]))
        return number[i, j, k]

    for i in range(len(xs) - 1):
        for j in range(len(ys) - 1):
            for k in range(len(zs) - 1):
                if i >= 2 and k >= 2:
                    continue
                corners = [node(i + a, j + b, k + c) for c in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
                cells += [[corners[a] for a in tetrahedron] for tetrahedron in SPLIT]
    return points, cells


def array(kind, name, components, values):
    return (f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" format="ascii">\n'
            + " ".join(values) + "\n</DataArray>\n")


def text_of(points, cells):
    """An array of integers names a set: the nodes where it is 1."""
    sets = {"foot": [z == 0.0 for _, _, z in points], "top": [abs(z - WALL) < 1e-9 for _, _, z in points]}
    coordinates = [f"{value:.6g}" for point in points for value in point]
    return ('<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian">\n<UnstructuredGrid>\n'
            f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(cells)}">\n'
            "<Points>\n" + array("Float64", "Points", 3, coordinates) + "</Points>\n<Cells>\n"
            + array("Int64", "connectivity", 1, [str(node) for cell in cells for node in cell])
            + array("Int64", "offsets", 1, [str(4 * (k + 1)) for k in range(len(cells))])
            + array("UInt8", "types", 1, ["10"] * len(cells)) + "</Cells>\n<PointData>\n"
            + "".join(array("Int32", name, 1, [str(int(is_in)) for is_in in members]) for name, members in sets.items())
            + "</PointData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n")


if __name__ == "__main__":
    file = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).with_name("bracket.vtu")
    file.write_text(text_of(*make()))
