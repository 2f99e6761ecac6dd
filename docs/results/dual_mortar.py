#!/usr/bin/env python3
"""Dual weights against closed forms, beside node to facet: figures of docs/theory/mortar.md.

Usage: ILAW_PATH=build/release/lib/ilaw docs/results/dual_mortar.py build/release/bin/ilaw [--cases ...] [--sides ...]

hertz     Two equal parabolic faces are pressed on each other, in plane strain, then sheared: rms of the errors of p(x)
          (Hertz 1882) and q(x) (Cattaneo 1938, Mindlin 1949) over the largest pressure and traction, for the loads that act,
          and the shear that is left from pressing over the limit of friction. --meshes: elements in half the width of
          contact, in the lower body and the upper one.
sliding   A block slides 1e5 steps over another without friction: change of its energy of motion, path, updates.
bowl      An arc swings in a bowl without friction: against a rigid pendulum.
bonds     Blocks that are glued by a law, in tension and in shear: the largest error of the traction.
corners   A cube falls on an edge or a corner on a plate: how far it sinks in.
impact    Two blocks meet with restitution 0, .5 and 1: the error of the pressure, and the balance of energy.
tilted    A cube falls on a free plate with an edge, a corner, and a corner at the plate's border, with restitution 0 and 1: the
          largest energy after the first contact over the initial one.
stack     Four blocks on a base, each as far out as it can lie, times a factor: tilt of the blocks.
shear     Pressure and shear grow on a face with friction 0 to 10: iterations, processor time.
"""
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import csv
import json
import math
import resource
import subprocess
import tempfile
from pathlib import Path

import non_matching
import numpy
from non_matching import block, interface, layers, material, write_mesh

YOUNG, POISSON, RADIUS, FRICTION = 1e6, 0.3, 100.0, 0.3
MODULUS = YOUNG / (2 * (1 - POISSON**2))  # E* of two equal bodies
LENGTH, DEPTH, WIDTH = 10.0, 10.0, 1 / 12  # of a body: half its length, its depth; contact is a half width of 1
CORE, GROWTH = (1.2, 0.4), 2.5  # half the length and the depth of equal steps; beyond them a step grows by this per path
PRESSED, REST, SHEARED, END = 1.5, 3.0, 5.5, 7.0  # instants: the grips rest after pressing and after shearing
FACES = {"a": "top", "b": "bottom"}


def run(program, scene, *options):
    with tempfile.TemporaryDirectory() as folder:
        scene = scene(Path(folder)) if callable(scene) else scene
        file = Path(folder) / "scene.json"
        file.write_text(json.dumps(scene))
        subprocess.run([program, "run", file, "--out", folder, "--threads", "1", *options], check=True, capture_output=True)
        summary = json.loads((Path(folder) / "summary.json").read_text())
        with (Path(folder) / "history.csv").open() as rows:
            return summary, list(csv.DictReader(rows))


def brick(file, x, depth, height, sets):
    """Elements in x and z, one in y; height: of the points, by x and the depth below the face."""
    points = numpy.array([[px, py, height(px, pz)] for pz in depth for py in (0.0, WIDTH) for px in x])
    node = numpy.arange(len(points)).reshape(len(depth), 2, len(x))
    low = [node[:-1, j, i:len(x) - 1 + i] for j, i in ((0, 0), (0, 1), (1, 1), (1, 0))]
    high = [node[1:, j, i:len(x) - 1 + i] for j, i in ((0, 0), (0, 1), (1, 1), (1, 0))]
    turns = height(0, depth[1]) < height(0, depth[0])  # elements count upward
    cells = numpy.stack(high + low if turns else low + high, -1).reshape(-1, 8)
    write_mesh(file, points, cells, {name: numpy.isin(node, node[k]) for name, k in sets.items()})


def graded(elements, core, end):
    """From 0 to the end: steps of 1/elements up to a core, then geometric ones, of which a finer mesh has more."""
    inner = numpy.arange(int(core * elements + 1e-9) + 1) / elements
    path = math.log1p(GROWTH * (end - inner[-1])) / GROWTH
    outer = numpy.linspace(0, path, round(path * elements) + 1)[1:]
    return numpy.concatenate([inner, inner[-1] + numpy.expm1(GROWTH * outer) / GROWTH])


def hertz_places(elements):
    half = graded(elements, CORE[0], LENGTH)
    return numpy.concatenate([-half[:0:-1], half]), graded(elements, CORE[1], DEPTH)


def hertz_scene(folder, side, upper, lower):
    """Bodies of one shape, whose grips move alike: without friction no point of one face slips on the other."""
    meshes, loads = [], [{"type": "motion", "nodes": "all", "axes": [1]}, {"type": "damping", "rate": 7}]
    down, aside = 0.0075, 0.00125
    for name, n, up in (("a", lower, -1), ("b", upper, 1)):
        x, depth = hertz_places(n)
        file = folder / f"{name}.vtu"
        brick(file, x, depth, lambda px, pz: up * (pz + px * px / (4 * RADIUS) * max(0, 1 - pz / 5)),
              {FACES[name]: 0, "grip": len(depth) - 1})
        meshes.append({"name": name, "file": str(file), "material": material(POISSON)})
        path = [[0, 0, 0, 0], [PRESSED, 0, 0, -up * down], [REST, 0, 0, -up * down], [SHEARED, up * aside, 0, -up * down]]
        loads.append({"type": "motion", "nodes": f"{name}.grip", "axes": [0, 2], "path": {"rows": path, "smooth": True}})
    joint = interface(side, FACES, "coulomb", {"friction": FRICTION})
    return {"model": {"type": "solids", "meshes": meshes}, "interfaces": [joint], "time": {"cfl": 0.9, "end": END},
            "loads": loads, "output": {"watch": ["a.top", "b.bottom"], "every": 50}}


def of_hats(x, values):
    """Means over the shape functions of nodes."""
    found = []
    for k in range(1, len(x) - 1):
        s = numpy.linspace(x[k - 1], x[k + 1], 2001)
        hat = numpy.interp(s, [x[k - 1], x[k], x[k + 1]], [0, 1, 0])
        found.append((values(s) * hat).sum() / hat.sum())
    return numpy.array(found)


def tractions(row, first, x, dt):
    """Pressure and shear at the inner nodes of a face, positive along their sums, and the lengths that belong to them."""
    count = len(x)
    impulse = numpy.array([[sum(float(row[f"n{first + j * count + k}.r{c}"]) for j in (0, 1)) for c in (0, 2)]
                           for k in range(count)])[1:-1]
    lengths = 0.5 * (x[2:] - x[:-2])
    shear, pressure = (impulse * numpy.sign(impulse.sum(0))).T / (lengths * WIDTH * dt)
    return pressure, shear, lengths


def closed_forms(x, force, shear):
    """Half width of contact, stick zone over it, largest pressure, p(x) and q(x): of the loads that act."""
    half = math.sqrt(4 * force * RADIUS / (math.pi * MODULUS))
    sticks = math.sqrt(max(0.0, 1 - shear / (FRICTION * force)))
    top = 2 * force / (math.pi * half)

    def arc(width):
        return top * of_hats(x, lambda s: numpy.sqrt(numpy.maximum(0, width**2 - (s / half)**2)))
    return half, sticks, top, arc(1), FRICTION * (arc(1) - arc(sticks))


def rms(values):
    return math.sqrt((values**2).mean())


def hertz(program, side, mesh="12:20", profile=None):
    lower, upper = map(int, mesh.split(":"))
    summary, rows = run(program, lambda folder: hertz_scene(folder, side, upper, lower))
    first = 0
    for name, n in (("a", lower), ("b", upper)):
        x, depth = hertz_places(n)
        inside = numpy.abs(x[1:-1]) < CORE[0]
        pressed = max((row for row in rows if float(row["time"]) <= REST), key=lambda row: float(row["time"]))
        p, q, lengths = tractions(pressed, first, x, summary["dt"])
        half, _, top, exact_p, _ = closed_forms(x, p @ lengths, 0)
        errors = [rms((p - exact_p)[inside]) / top, rms(q[inside]) / (FRICTION * top)]
        if profile is not None:
            profile[name] = (x[1:-1][inside] / half, p[inside] / top)
        p, q, lengths = tractions(rows[-1], first, x, summary["dt"])
        force, shear = p @ lengths, q @ lengths
        half, sticks, _, _, exact_q = closed_forms(x, force, shear)
        errors.append(rms((q - exact_q)[inside]) / exact_q.max())
        print(f"| hertz | {side} | {mesh} | body {name} | p rms {errors[0]:.1e} | q rms {errors[2]:.1e} | q from pressing "
              f"{errors[1]:.1e} | a {half:.3f} | c/a {sticks:.3f} | Q/(mu F) {shear / (FRICTION * force):.3f} | iterations "
              f"{summary['coupling']['sweeps'] / summary['steps']:.0f} | unsolved {summary['coupling']['steps_unconverged']} of "
              f"{summary['steps']} |", flush=True)
        first += 2 * len(x) * len(depth)


def sliding(program, side):
    speed, end, weight = 0.004665, 428.7, 5e-4
    made = {"model": {"type": "blocks", "blocks": [
        dict(block("a", 0, 1, 0, 0.3), size=[3, 1, 0.3], elements=[10, 3, 1]),
        dict(block("b", 0, 1, 0, 0.3), corner=[0.1, 0.2, 0.3], size=[0.7, 0.6, 0.3], elements=[3, 2, 1], velocity=[speed, 0, 0])]},
        "interfaces": [interface(side, {"a": "z_max", "b": "z_min"}, "contact", {})], "time": {"cfl": 0.8, "end": end},
        "loads": [{"type": "motion", "nodes": "a.z_min"}, {"type": "gravity", "nodes": "b", "acceleration": [0, 0, -weight]}],
        "output": {"watch": ["b.z_max"], "every": 500, "balance": True}}
    summary, rows = run(program, made)
    speeds = [numpy.mean([float(row[key]) for key in row if key.endswith(".v0")]) for row in rows]
    moves = [numpy.mean([float(row[key]) for key in row if key.endswith(".u0")]) for row in rows]
    energy = summary["energy"]
    print(f"| sliding | {side} | {summary['steps']} steps | path {moves[-1] / 0.3:.1f} edges | speed {min(speeds) / speed:.6f} to "
          f"{max(speeds) / speed:.6f} | work of the interface {energy['interface_work']:.1e} of {energy['kinetic']:.1e} | "
          f"balance {energy['balance_error']:.0e} | unsolved {summary['coupling']['steps_unconverged']} |", flush=True)


def arc(file, radii, angles, n, m, width, sets):
    r, z, angle = numpy.meshgrid(numpy.linspace(*radii, m + 1), [0.0, width], numpy.linspace(*angles, n + 1), indexing="ij")
    points = numpy.stack([r * numpy.cos(angle), r * numpy.sin(angle), z], -1).reshape(-1, 3)
    node = numpy.arange(len(points)).reshape(m + 1, 2, n + 1)
    low = [node[:m, j, i:n + i] for j, i in ((0, 0), (0, 1), (1, 1), (1, 0))]
    high = [node[1:, j, i:n + i] for j, i in ((0, 0), (0, 1), (1, 1), (1, 0))]
    write_mesh(file, points, numpy.stack(low + high, -1).reshape(-1, 8),
               {name: numpy.isin(node, node[k]) for name, k in sets.items()})


def bowl(program, side):
    """The lower half of a ring, and an arc of 40 degrees in it that starts 20 degrees beside the lowest point."""
    gravity, end, n = 10.0, 6.0, 48
    inner, start = (0.8, 1.0), math.radians(20)

    def scene(folder):
        arc(folder / "a.vtu", (1.0, 1.2), (math.radians(200), math.radians(340)), n, 2, 0.1, {"inside": 0, "outside": 2})
        arc(folder / "b.vtu", inner, (math.radians(270) + start - math.radians(20), math.radians(270) + start + math.radians(20)),
            8, 3, 0.1, {"outside": 3})
        meshes = [{"name": name, "file": str(folder / f"{name}.vtu"), "material": material(0.3)} for name in "ab"]
        return {"model": {"type": "solids", "meshes": meshes},
                "interfaces": [interface(side, {"a": "inside", "b": "outside"}, "contact", {})],
                "time": {"cfl": 0.8, "end": end},
                "loads": [{"type": "motion", "nodes": "a.outside"}, {"type": "motion", "nodes": "all", "axes": [2]},
                          {"type": "gravity", "nodes": "b", "acceleration": [0, -gravity, 0]},
                          {"type": "damping", "nodes": "a", "rate": 60}],
                "output": {"watch": ["b.outside"], "every": 20}}
    summary, rows = run(program, scene)
    # rigid: theta'' = -g sin(theta) d/(I/m) about the center of the bowl
    half = math.radians(20)
    mean = 2 / 3 * (inner[1]**3 - inner[0]**3) / (inner[1]**2 - inner[0]**2) * math.sin(half) / half
    ratio = 0.5 * (inner[1]**2 + inner[0]**2)
    times, angle, rate, rigid, dt = [float(row["time"]) for row in rows], start, 0.0, [], 1e-4
    t = 0.0
    for time in times:
        while t < time - 0.5 * dt:
            rate -= dt * gravity * mean / ratio * math.sin(angle)
            angle += dt * rate
            t += dt
        rigid.append(angle)
    keys = [key[:-3] for key in rows[0] if key.endswith(".u0")]
    first = int(keys[0][1:])
    corner = 270 + math.degrees(start) - 20
    turned = []
    for row in rows:
        sums = 0.0
        for k, key in enumerate(keys):
            phi = math.radians(corner + 40 / 8 * (k % 9))
            x, y = math.cos(phi) + float(row[key + ".u0"]), math.sin(phi) + float(row[key + ".u1"])
            sums += math.atan2(x, -y)
        turned.append(sums / len(keys))
    error = max(abs(a - b) for a, b in zip(turned, rigid))
    energy = summary["energy"]
    print(f"| bowl | {side} | first node {first} | turned from {min(turned):.3f} to {max(turned):.3f} | error {error:.1e} of "
          f"{start:.2f} | balance {energy['balance_error']:.0e} | work of the interface {energy['interface_work']:.1e} of "
          f"{energy['external_work']:.1e} | sinks {summary['penetration_max']:.1e} | unsolved "
          f"{summary['coupling']['steps_unconverged']} of {summary['steps']} |", flush=True)


BONDS = {"tie": {}, "cohesive": {"strength": 1e5, "toughness": 100, "stiffness": 1e9},
         "rccm": {"normal_stiffness": 1e9, "tangential_stiffness": 1e9, "adhesion_energy": 100, "initial_intensity": 1},
         "postit": {"adhesion_limit": 1e5, "initial_adhesion": 1e5, "memory": 0}}


def bonds(program, side):
    for law, parameters in BONDS.items():
        for axis in (2, 0):
            made = {"model": {"type": "blocks", "blocks": [block("a", 0, 3, 0, 0.3), block("b", 0.5, 5, 0, 0.3)]},
                    "interfaces": [interface(side, {"a": "z_max", "b": "z_min"}, law, parameters)],
                    "time": {"cfl": 0.9, "end": 0.8}, "loads": [{"type": "damping", "rate": 60}],
                    "output": {"watch": ["a.z_max", "b.z_min"], "every": 1000000}}
            grow = {"rows": [[0, 0], [0.2, 1e3]], "smooth": True}
            if axis == 2:
                made["loads"] += [{"type": "motion", "nodes": "a.z_min", "axes": [2]},
                                  {"type": "pressure", "surface": "b.z_max",
                                   "history": {"rows": [[0, 0], [0.2, -1e3]], "smooth": True}}]
            else:
                made["loads"] += [{"type": "motion", "nodes": "all", "axes": [1, 2]}, {"type": "motion", "nodes": "a.z_min", "axes": [0]},
                                  {"type": "force", "nodes": "b.z_max", "direction": [1, 0, 0], "total": True, "history": grow}]
            try:
                summary, rows = run(program, made)
            except subprocess.CalledProcessError as failed:
                print(f"| bonds | {side} | {law} | refused: {failed.stderr.decode()[-200:]}", flush=True)
                continue
            errors = []
            for elements, first in ((3, 16 * layers(3)), (5, 16 * (layers(3) + 1))):
                edge = numpy.full(elements + 1, 1.0 / elements)
                edge[[0, -1]] *= 0.5
                force = numpy.array([float(rows[-1][f"n{k}.r{axis}"]) for k in range(first, first + (elements + 1)**2)])
                errors.append(abs(force / (force.sum() * numpy.outer(edge, edge).ravel()) - 1).max())
            print(f"| bonds | {side} | {law} | {'tension' if axis == 2 else 'shear'} | {max(errors):.0e} | unsolved "
                  f"{summary['coupling']['steps_unconverged']} |", flush=True)


def impact(program, side):
    for restitution in (0, 0.5, 1):
        made = non_matching.of_blocks("impact", 3, 5, side)
        made["interfaces"][0]["parameters"] = {"restitution": restitution}
        made["output"] = {"watch": ["a.z_max", "b.z_min"], "every": 1}
        summary, rows = run(program, made)
        p, _ = non_matching.fields("impact", rows, 3, 5)
        print(f"| impact | {side} | e {restitution} | pressure off by {abs(p - 1).max():.0e} | balance "
              f"{summary['energy']['balance_error']:.0e} | unsolved {summary['coupling']['steps_unconverged']} |", flush=True)


def grid(file, x, y, z, place, sets):
    """Elements in three directions; place: of an array of points. Sets: of layers in z, or of a mask of points."""
    points = numpy.array([[a, b, c] for c in z for b in y for a in x])
    node = numpy.arange(len(points)).reshape(len(z), len(y), len(x))
    n, m = len(x) - 1, len(y) - 1
    low = [node[:-1, j:m + j, i:n + i] for j, i in ((0, 0), (0, 1), (1, 1), (1, 0))]
    high = [node[1:, j:m + j, i:n + i] for j, i in ((0, 0), (0, 1), (1, 1), (1, 0))]
    points = place(points)
    masks = {name: numpy.isin(node, node[k]) for name, k in sets.items()}
    masks["foot"] = points[:, 2].reshape(node.shape) < points[:, 2].min() + 1e-9
    write_mesh(file, points, numpy.stack(low + high, -1).reshape(-1, 8), masks)
    return points


def corners(program, side):
    """A cube with edges of 4 elements falls on a plate with edges of as long, on an edge or a corner. Roles of its face: main;
    main with its lowest nodes in a second interface; secondary."""
    a = 0.3
    about_y = numpy.array([[math.cos(a), 0, math.sin(a)], [0, 1, 0], [-math.sin(a), 0, math.cos(a)]])
    about_x = numpy.array([[1, 0, 0], [0, math.cos(a), -math.sin(a)], [0, math.sin(a), math.cos(a)]])
    foot = {"name": "foot", "law": "contact", "nodes": "b.foot", "against": {"surface": "a.top"}}
    for lowest, turn in (("edge", about_y), ("corner", about_y @ about_x)):
        for role in ("main", "main, with its nodes", "secondary"):
            kept = {}

            def scene(folder):
                x = numpy.linspace(-1.5, 1.5, 13)
                kept["a"] = grid(folder / "a.vtu", x, x, numpy.linspace(-0.6, 0, 4), lambda points: points,
                                 {"top": 3, "floor": 0})
                x = numpy.linspace(-0.5, 0.5, 5)

                def turned(points):
                    points = points @ turn.T
                    return points + [0.03, 0.04, 0.02 - points[:, 2].min()]
                kept["b"] = grid(folder / "b.vtu", x, x, x, turned, {"bottom": 0})
                meshes = [{"name": name, "file": str(folder / f"{name}.vtu"), "velocity": [0, 0, speed],
                           "material": dict(material(0.3), type="neo_hookean")} for name, speed in (("a", 0), ("b", -1))]
                # interface() takes the nodes of a for "coarse"
                joint = interface(side if role == "secondary" else "dual coarse", {"a": "top", "b": "bottom"}, "contact", {})
                return {"model": {"type": "solids", "meshes": meshes},
                        "interfaces": [joint, foot] if "nodes" in role else [joint], "time": {"cfl": 0.7, "end": 0.12},
                        "loads": [{"type": "motion", "nodes": "a.floor"}],
                        "output": {"watch": ["a.top", "b.foot"], "every": 1, "balance": True}}
            summary, rows = run(program, scene)
            count, deepest = len(kept["a"]), 0.0
            top = [k for k in range(count) if f"n{k}.u2" in rows[0]]
            feet = [k for k in range(count, count + len(kept["b"])) if f"n{k}.u2" in rows[0]]
            for row in rows:
                plate = numpy.array([kept["a"][k, 2] + float(row[f"n{k}.u2"]) for k in top]).reshape(13, 13)
                for k in feet:
                    x, y, z = kept["b"][k - count] + [float(row[f"n{k}.u{c}"]) for c in range(3)]
                    u, v = (x + 1.5) / 0.25, (y + 1.5) / 0.25
                    i, j = int(u), int(v)
                    below = numpy.array([1 - v + j, v - j]) @ plate[j:j + 2, i:i + 2] @ numpy.array([1 - u + i, u - i])
                    deepest = max(deepest, below - z)
            print(f"| corners | {lowest}, {role} | sinks {deepest / 0.25:.3f} edges | work of the interface "
                  f"{summary['energy']['interface_work']:.1f} of 500 | iterations "
                  f"{summary['coupling']['sweeps'] / summary['steps']:.0f} | unsolved "
                  f"{summary['coupling']['steps_unconverged']} of {summary['steps']} |", flush=True)


def tilted(program, side):
    """Roles by side. The plate is free and has edges of 1/5, the cube of 1/4."""
    a = 0.2
    about_y = numpy.array([[math.cos(a), 0, math.sin(a)], [0, 1, 0], [-math.sin(a), 0, math.cos(a)]])
    about_x = numpy.array([[1, 0, 0], [0, math.cos(a), -math.sin(a)], [0, math.sin(a), math.cos(a)]])
    for place, turn, x in (("edge", about_y, 0.03), ("corner", about_y @ about_x, 0.03), ("corner at the border", about_y @ about_x, 1.4)):
        for restitution in (0, 1):
            def scene(folder):
                at = numpy.linspace(-1.5, 1.5, 16)
                grid(folder / "a.vtu", at, at, numpy.linspace(-0.4, 0, 3), lambda points: points, {"top": 2})
                at = numpy.linspace(-0.5, 0.5, 5)

                def turned(points):
                    points = points @ turn.T
                    return points + [x, 0.04, 0.02 - points[:, 2].min()]
                grid(folder / "b.vtu", at, at, at, turned, {"bottom": 0})
                meshes = [{"name": name, "file": str(folder / f"{name}.vtu"), "velocity": [0, 0, speed],
                           "material": dict(material(0.3), type="neo_hookean")} for name, speed in (("a", 0), ("b", -1))]
                return {"model": {"type": "solids", "meshes": meshes},
                        "interfaces": [interface(side, {"a": "top", "b": "bottom"}, "contact", {"restitution": restitution})],
                        "time": {"cfl": 0.7, "end": 0.2}, "output": {"watch": ["b.foot"], "every": 1, "balance": True}}
            summary, rows = run(program, scene)
            energy = [float(row["balance.kinetic"]) + float(row["balance.internal"]) for row in rows]
            print(f"| tilted | {side} | {place} | e {restitution} | energy at most {max(energy) / energy[0]:.7f}, at the end "
                  f"{energy[-1] / energy[0]:.6f} | unsolved {summary['coupling']['steps_unconverged']} of {summary['steps']} |", flush=True)


def stack(program, side):
    """Blocks have 4 and 6 elements in turn; side: whose faces are secondary, dual fine: the finer."""
    high, count = 0.25, 4
    for factor in (0.90, 0.97, 1.03):
        at = numpy.cumsum([0] + [factor / (2 * (count + 1 - k)) for k in range(1, count + 1)])
        blocks = [{"name": f"b{k}", "corner": [x, 0, k * high], "size": [1, 0.25, high], "elements": [6 - 2 * (k % 2), 1, 2],
                   "material": {"type": "neo_hookean", "young": 1e8, "poisson": 0.3, "density": 1e3}} for k, x in enumerate(at)]
        joints = []
        for k in range(count):
            finer = 6 - 2 * (k % 2) == 6  # the lower one
            faces = {"a": f"b{k}.z_max", "b": f"b{k + 1}.z_min"}
            own, other = ("a", "b") if finer != side.endswith("coarse") else ("b", "a")
            joints.append({"name": f"j{k}", "law": "coulomb", "parameters": {"friction": 0.5}, "nodes": faces[own],
                           "against": {"surface": faces[other]}
                           | ({} if side.startswith("dual") else {"discretization": "node_to_facet"})})
        summary, rows = run(program, {
            "model": {"type": "blocks", "blocks": blocks}, "interfaces": joints, "time": {"cfl": 0.8, "end": 3.0},
            "loads": [{"type": "motion", "nodes": "b0.z_min"}, {"type": "damping", "rate": 1},
                      {"type": "gravity", "acceleration": [0, 0, -10], "history": {"rows": [[0, 0], [0.3, 1]], "smooth": True}}],
            "output": {"watch": [f"b{k}.z_max" for k in range(1, count + 1)], "every": 100}})
        last = numpy.array([float(rows[-1][key]) for key in rows[-1] if key.endswith(".u2")])
        print(f"| stack | {side} | {factor} of the limit | moved down by {-last.min():.4f}: "
              f"{'falls' if last.min() < -0.05 else 'stands'} | iterations {summary['coupling']['sweeps'] / summary['steps']:.0f}, "
              f"{summary['coupling']['sweeps_max']} at most | unsolved {summary['coupling']['steps_unconverged']} of "
              f"{summary['steps']} |", flush=True)


def shear(program, side):
    for friction in (0, 0.1, 0.3, 1, 10):
        grow = {"rows": [[0, 0], [0.2, 1e3]], "smooth": True}
        made = {"model": {"type": "blocks", "blocks": [block("a", 0, 6, 0, 0.3), block("b", 0.5, 10, 0, 0.3)]},
                "interfaces": [interface(side, {"a": "z_max", "b": "z_min"}, "coulomb", {"friction": friction})],
                "time": {"cfl": 0.9, "end": 0.1}, "output": {"every": 1000000},
                "loads": [{"type": "motion", "nodes": "a.z_min"}, {"type": "damping", "rate": 60},
                          {"type": "pressure", "surface": "b.z_max", "history": grow},
                          {"type": "force", "nodes": "b.z_max", "direction": [0.2, 0, 0], "total": True, "history": grow}]}
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        summary, _ = run(program, made)
        seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        coupling = summary["coupling"]
        print(f"| shear | {side} | friction {friction} | iterations {coupling['sweeps'] / summary['steps']:.0f}, "
              f"{coupling['sweeps_max']} at most | unsolved {coupling['steps_unconverged']} of {summary['steps']} | "
              f"{seconds:.2f} s, interfaces {summary['seconds']['interfaces']:.2f} s |", flush=True)


def picture(program, file):
    from case_script import save
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(6.5, 3.4))
    s = numpy.linspace(-1, 1, 400)
    axes.plot(s, numpy.sqrt(1 - s**2), "k", lw=1, label="exact")
    for side, marker, color, text in (("fine", "x", "C3", "node to facet"), ("dual coarse", "o", "C0", "dual weights")):
        profile = {}
        hertz(program, side, profile=profile)
        for body, values in profile.items():
            axes.plot(*values, marker, ms=4, color=color, fillstyle="none", label=text if body == "a" else None)
    axes.set_xlabel("x over half the width of contact")
    axes.set_ylabel("pressure over the largest")
    axes.legend(frameon=False)
    save(figure, file)


CASES = {"hertz": hertz, "sliding": sliding, "bowl": bowl, "bonds": bonds, "impact": impact, "corners": corners,
         "tilted": tilted, "stack": stack, "shear": shear}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--cases", nargs="+", default=list(CASES), choices=CASES)
    parser.add_argument("--sides", nargs="+", default=["dual fine", "dual coarse", "fine"], choices=non_matching.SIDES)
    parser.add_argument("--meshes", nargs="+", default=["12:20"], help="of hertz")
    parser.add_argument("--picture", type=Path)
    options = parser.parse_args()
    if options.picture:
        return picture(options.program, options.picture)
    for case in options.cases:
        for side in options.sides:
            for mesh in options.meshes if case == "hertz" else [None]:
                CASES[case](options.program, side, *([mesh] if mesh else []))


if __name__ == "__main__":
    main()
