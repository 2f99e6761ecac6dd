#!/usr/bin/env python3
"""Pressure and displacement between two bodies whose meshes do not match: the tables of
docs/theory/non_matching_meshes.md and docs/theory/mortar.md.

Usage: ILAW_PATH=build/release/lib/ilaw docs/results/non_matching.py build/release/bin/ilaw

Bodies are blocks, or quarters of rings, one inside the other. By symmetry pressure and displacement are the same at all
nodes of a face. The table has for both faces least and largest pressure over the mean one, and the largest error of the
displacement over the mean one. Cost: iterations a step, time over that of the first side, and steps that are not solved.
"""
import argparse
import csv
import json
import math
import subprocess
import tempfile
from pathlib import Path

import numpy

PRESSURE, YOUNG, DENSITY, HEIGHT, FRICTION = 1e3, 1e6, 1e3, 0.5, 0.3
INNER, MIDDLE, OUTER, WIDTH = 0.5, 1.0, 1.5, 1.0  # radii of two rings, and their width
SIDES = ("fine", "coarse", "dual fine", "dual coarse")  # whose nodes are secondary
FACES = {"blocks": {"a": "z_max", "b": "z_min"}, "rings": {"a": "outside", "b": "inside"}}


def layers(elements):
    return max(2, elements // 2)


def material(poisson):
    return {"type": "linear", "young": YOUNG, "poisson": poisson, "density": DENSITY}


def block(name, corner, elements, velocity, poisson):
    return {"name": name, "corner": [0, 0, corner], "size": [1, 1, HEIGHT], "velocity": [0, 0, velocity],
            "elements": [elements, elements, layers(elements)], "material": material(poisson)}


def write_mesh(file, points, cells, sets):
    def array(kind, label, values, components=1):
        text = " ".join(map(str, numpy.ravel(values).tolist()))
        return (f'<DataArray type="{kind}" Name="{label}" NumberOfComponents="{components}" format="ascii">'
                f"{text}</DataArray>")
    file.write_text(
        '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian"><UnstructuredGrid>'
        f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(cells)}">'
        f'<Points>{array("Float64", "Points", points, 3)}</Points>'
        f'<Cells>{array("Int64", "connectivity", cells)}'
        f'{array("Int64", "offsets", numpy.arange(8, 8 * len(cells) + 1, 8))}'
        f'{array("UInt8", "types", numpy.full(len(cells), 12))}</Cells>'
        f'<PointData>{"".join(array("Int32", key, flags.astype(int)) for key, flags in sets.items())}</PointData>'
        "</Piece></UnstructuredGrid></VTKFile>\n")


def ring(name, folder, radii, elements):
    """Quarter of a ring about z, in a file with the sets inside and outside."""
    n, m = elements, layers(elements)
    r, z, angle = numpy.meshgrid(numpy.linspace(*radii, m + 1), numpy.linspace(0, WIDTH, n + 1),
                                 numpy.linspace(0, 0.5 * math.pi, n + 1), indexing="ij")
    points = numpy.stack([r * numpy.cos(angle), r * numpy.sin(angle), z], -1).reshape(-1, 3)
    points[numpy.abs(points) < 1e-12] = 0.0  # the planes of symmetry
    node = numpy.arange(len(points)).reshape(m + 1, n + 1, n + 1)
    low = [node[:m, j:n + j, i:n + i] for j, i in ((0, 0), (0, 1), (1, 1), (1, 0))]
    high = [node[1:, j:n + j, i:n + i] for j, i in ((0, 0), (0, 1), (1, 1), (1, 0))]
    cells = numpy.stack(low + high, -1).reshape(-1, 8)
    sets = {"inside": numpy.isin(node, node[0]), "outside": numpy.isin(node, node[m])}

    file = Path(folder) / f"{name}.vtu"
    write_mesh(file, points, cells, sets)
    return {"name": name, "file": str(file), "material": material(0.3)}


def interface(side, faces, law, parameters):
    nodes, surface = (f"{body}.{faces[body]}" for body in ("ab" if side.endswith("coarse") else "ba"))
    against = {"surface": surface, "discretization": "dual_mortar" if side.startswith("dual") else "node_to_facet"}
    return {"name": "joint", "law": law, "parameters": parameters, "nodes": nodes, "against": against}


def rise():
    return {"rows": [[0, 0], [0.2, PRESSURE]], "smooth": True}


def of_blocks(case, coarse, fine, side):
    """Blocks a, below, and b; a wave of uniform pressure, or a load that grows smoothly and is damped."""
    speed = 1.0 if case == "impact" else 0.0
    poisson = 0.3 if case == "at rest" else 0.0
    slides = case == "sliding"
    law = ("coulomb", {"friction": FRICTION}) if slides else ("contact", {})
    made = {"model": {"type": "blocks", "blocks": [block("a", 0, coarse, speed, poisson),
                                                   block("b", HEIGHT, fine, -speed, poisson)]},
            "interfaces": [interface(side, FACES["blocks"], *law)]}
    if case == "impact":  # until the waves come back
        made["time"] = {"cfl": 0.9, "end": 0.9 * HEIGHT / (YOUNG / DENSITY) ** 0.5}
        return made
    made["time"] = {"cfl": 0.9, "end": 0.8}
    made["loads"] = [
        {"type": "motion", "nodes": "a.z_min", "axes": [2]},
        {"type": "pressure", "surface": "b.z_max", "history": rise()},
        {"type": "damping", "rate": 60}]
    if slides:  # b as a whole, on a face that stays where it is
        made["loads"] += [{"type": "motion", "nodes": "a", "axes": [0, 1]},
                          {"type": "motion", "nodes": "b", "axes": [0, 1], "velocity": [1e-3, 0, 0]}]
    return made


def of_rings(case, coarse, fine, side, folder, keeps_gaps):
    """Ring a inside ring b in plane strain; a pressure inside of a that is sudden, or grows smoothly and is damped."""
    made = {"model": {"type": "solids", "meshes": [ring("a", folder, (INNER, MIDDLE), coarse),
                                                   ring("b", folder, (MIDDLE, OUTER), fine)]},
            "sets": {"x": {"box": [[0, -9, -9], [0, 9, 9]]}, "y": {"box": [[-9, 0, -9], [9, 0, 9]]}},
            "interfaces": [interface(side, FACES["rings"], "contact", {})],
            "loads": [{"type": "motion", "nodes": "all", "axes": [2]},
                      {"type": "motion", "nodes": "x", "axes": [0]},
                      {"type": "motion", "nodes": "y", "axes": [1]},
                      {"type": "pressure", "surface": "a.inside", "history": [[0, PRESSURE]]}]}
    if not keeps_gaps:
        made["interfaces"][0]["gap_offset"] = "initial"
    if case == "ring, wave":  # until it comes back from the outside
        made["time"] = {"cfl": 0.9, "end": 1.4 * (OUTER - INNER) / (1.35 * YOUNG / DENSITY) ** 0.5}
        return made
    made["time"] = {"cfl": 0.9, "end": 0.8}
    made["loads"][-1]["history"] = rise()
    made["loads"].append({"type": "damping", "rate": 60})
    return made


def run(ilaw, case, coarse, fine, side, keeps_gaps):
    with tempfile.TemporaryDirectory() as folder:
        rings = case.startswith("ring")
        made = of_rings(case, coarse, fine, side, folder, keeps_gaps) if rings else of_blocks(case, coarse, fine, side)
        faces = FACES["rings" if rings else "blocks"]
        made["output"] = {"watch": [f"{body}.{face}" for body, face in faces.items()],
                          "every": 1000000 if "damping" in str(made.get("loads")) else 1}
        file = Path(folder) / "scene.json"
        file.write_text(json.dumps(made))
        subprocess.run([ilaw, "run", file, "--out", folder, "--threads", "1"], check=True, capture_output=True)
        summary = json.loads((Path(folder) / "summary.json").read_text())
        with (Path(folder) / "history.csv").open() as rows:
            return summary, list(csv.DictReader(rows))


def fields(case, rows, coarse, fine):
    """Pressure and displacement at the nodes of each face, over their mean."""
    found = []
    for elements, first in ((coarse, (coarse + 1) ** 2 * layers(coarse)),
                            (fine, (coarse + 1) ** 2 * (layers(coarse) + 1))):
        edge = numpy.full(elements + 1, 1.0 / elements)
        edge[[0, -1]] *= 0.5
        nodes = range(first, first + (elements + 1) ** 2)
        impulse = numpy.array([[sum(float(row[f"n{k}.r{c}"]) for row in rows) for c in range(3)] for k in nodes])
        moved = numpy.array([[float(rows[-1][f"n{k}.u{c}"]) for c in range(3)] for k in nodes])
        if case.startswith("ring"):
            angle = numpy.tile(numpy.linspace(0, 0.5 * math.pi, elements + 1), elements + 1)
            normal = numpy.stack([numpy.cos(angle), numpy.sin(angle), 0 * angle], -1)
            impulse, moved = (impulse * normal).sum(1), (moved * normal).sum(1)
        else:
            impulse, moved = impulse[:, 0 if case == "sliding" else 2], moved[:, 2]
        pressure = impulse / numpy.outer(edge, edge).ravel()
        path = float(rows[-1]["time"]) if case == "impact" else abs(moved.mean())
        found.append((pressure / impulse.sum(), (moved - moved.mean()) / path))
    return (numpy.concatenate(values) for values in zip(*found))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("ilaw")
    parser.add_argument("--meshes", nargs="+", default=["3:5", "6:10", "12:20"])
    parser.add_argument("--cases", nargs="+", default=["impact", "at rest", "sliding", "ring, wave", "ring, at rest"])
    parser.add_argument("--sides", nargs="+", default=SIDES, choices=SIDES)
    parser.add_argument("--keep-gaps", action="store_true", help="of the facets of rings, at the start")
    arguments = parser.parse_args()
    pressure_rows, error_rows = [], []
    for case in arguments.cases:
        for mesh in arguments.meshes:
            coarse, fine = map(int, mesh.split(":"))
            pressures, errors, sweeps, seconds, unsolved = [], [], {}, {}, {}
            for side in arguments.sides:
                summary, rows = run(arguments.ilaw, case, coarse, fine, side, arguments.keep_gaps)
                p, u = fields(case, rows, coarse, fine)
                off = abs(p - 1).max()
                pressures.append(f"{p.min():.3f} to {p.max():.3f}" if off > 1e-3 else f"1, to {off:.0e}")
                errors.append(f"{abs(u).max():.1e}")
                sweeps[side] = summary["coupling"]["sweeps"] / summary["steps"]
                seconds[side] = summary["seconds"]["total"]
                unsolved[side] = summary["coupling"]["steps_unconverged"]
            name = f"{case} | {coarse} on {fine}"
            pressure_rows.append(f"| {name} | {' | '.join(pressures)} |")
            error_rows.append(f"| {name} | {' | '.join(errors)} | "
                              f"{', '.join(f'{sweeps[side]:.0f}' for side in arguments.sides)} | "
                              f"{', '.join(f'{seconds[side] / seconds[arguments.sides[0]]:.1f}' for side in arguments.sides[1:])} | "
                              f"{', '.join(str(unsolved[side]) for side in arguments.sides)} of {summary['steps']} |")
            print(pressure_rows[-1], error_rows[-1], flush=True)
    names = " | ".join(arguments.sides)
    print(f"\n| case | elements | {names} |", *pressure_rows, sep="\n")
    print(f"\n| case | elements | {names} | iterations | time over the first | unsolved |", *error_rows, sep="\n")


if __name__ == "__main__":
    main()
