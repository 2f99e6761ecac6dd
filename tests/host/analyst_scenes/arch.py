#!/usr/bin/env python3
"""Writes arch.vtu and arch.json beside itself, or into FOLDER: two semicircular arches of stones without mortar.

Usage: arch.py [FOLDER]    The limit of the thickness is 0.1075 of the mean radius (Milankovitch 1907): one stands.
"""

import json
import math
import sys
from pathlib import Path

STONES, ACROSS, ALONG, DEPTH = 11, 1, 1, 0.35  # stones of an arch, and elements of a stone
ARCHES = {"thick": (0.15, 0.0), "thin": (0.08, 2.9)}  # thickness over mean radius 1, place
FRICTION = 0.8


def stone_nodes(name, stone):
    """Places of a stone's nodes and the joints that they are on, from the right springing to the left one."""
    thickness, center = ARCHES[name]
    for along in range(ALONG + 1):
        angle = math.pi * (stone + along / ALONG) / STONES
        for across in range(ACROSS + 1):
            radius = 1.0 + thickness * (across / ACROSS - 0.5)
            for deep in (0.0, DEPTH):
                height = 0.0 if abs(math.sin(angle)) < 1e-12 else radius * math.sin(angle)
                joint = {0: f"{name}_{stone}_first", ALONG: f"{name}_{stone}_last"}.get(along, "")
                yield (center + radius * math.cos(angle), deep, height), joint


def make():
    points, cells, sets = [], [], {}
    for name in ARCHES:
        sets[name] = []
        for stone in range(STONES):
            first = len(points)
            for place, joint in stone_nodes(name, stone):
                sets[name].append(len(points))
                sets.setdefault(joint, []).append(len(points))
                points.append(place)
            row = 2 * (ACROSS + 1)
            for along in range(ALONG):
                for across in range(ACROSS):
                    a = first + row * along + 2 * across
                    cells.append([a, a + row, a + row + 2, a + 2, a + 1, a + row + 1, a + row + 3, a + 3])
    return points, cells, {name: nodes for name, nodes in sets.items() if name}


def array(kind, name, components, values):
    return (f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" format="ascii">\n'
            + " ".join(values) + "\n</DataArray>\n")


def mesh_text(points, cells, sets):
    """An array of integers names a set: the nodes where it is 1."""
    arrays = []
    for name, nodes in sets.items():
        members = set(nodes)
        arrays.append(array("Int32", name, 1, [str(int(node in members)) for node in range(len(points))]))
    return ('<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian">\n<UnstructuredGrid>\n'
            f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(cells)}">\n<Points>\n'
            + array("Float64", "Points", 3, [f"{value:.9g}" for point in points for value in point])
            + "</Points>\n<Cells>\n" + array("Int64", "connectivity", 1, [str(node) for cell in cells for node in cell])
            + array("Int64", "offsets", 1, [str(8 * (k + 1)) for k in range(len(cells))])
            + array("UInt8", "types", 1, ["12"] * len(cells)) + "</Cells>\n<PointData>\n" + "".join(arrays)
            + "</PointData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n")


def joint(name, stone):
    return {"name": f"{name}_joint_{stone}", "law": "coulomb", "parameters": {"friction": FRICTION},
            "nodes": f"stones.{name}_{stone}_first",
            "against": {"surface": f"stones.{name}_{stone - 1}_last"}}


def scene():
    ground = {"name": "ground", "law": "coulomb", "parameters": {"friction": FRICTION}, "nodes": "all",
              "obstacle": {"type": "plane", "point": [0.0, 0.0, 0.0], "normal": [0.0, 0.0, 1.0]}}
    crowns = [{"near": [center, 0.0, 1.0], "of": f"stones.{name}_{STONES // 2 - 1}_last"}
              for name, (_, center) in ARCHES.items()]
    return {
        "title": "Two arches of stones without mortar: thick enough, it stands; too thin, it falls",
        "doc": "Made by arch.py. A semicircular arch needs 0.1075 of its mean radius (Milankovitch 1907): these have "
               "0.15 and 0.08.",
        "units": {"length": "m", "mass": "kg", "time": "s"},
        "model": {"type": "solids", "meshes": [{
            "name": "stones", "file": "arch.vtu",
            "material": {"type": "neo_hookean", "young": 1e7, "poisson": 0.2, "density": 2000.0}}]},
        "time": {"cfl": 0.7, "end": 0.5},
        "loads": [{"type": "gravity", "name": "weight", "acceleration": [0.0, 0.0, -9.81]}],
        "interfaces": [ground] + [joint(name, stone) for name in ARCHES for stone in range(1, STONES)],
        "output": {"every": 5, "watch": crowns, "forces": ["ground"], "fields": 20},
        "expect": [
            {"what": "n36.u2", "value": 0.0, "tolerance": 0.02,
             "because": "Milankovitch 1907: it needs 0.1075, so the arch of 0.15 stands; its crown gives way elastically"},
            {"what": "n124.u2", "value": -1.2, "tolerance": 0.8, "because": "the arch of 0.08 falls"}],
    }


if __name__ == "__main__":
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent
    (folder / "arch.vtu").write_text(mesh_text(*make()))
    (folder / "arch.json").write_text(json.dumps(scene(), indent=1) + "\n")
