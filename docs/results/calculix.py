#!/usr/bin/env python3
"""CalculiX' explicit massless contact beside the law contact: an impact of two bars, and a stack under sudden gravity.

    docs/results/calculix.py build/release/bin/ilaw --picture docs/img/calculix.svg     (ccx: Debian's calculix-ccx)

Both codes have the same hexahedra, one across, and nu = 0: the closed forms are those of bars.
"""
# SPDX-License-Identifier: BSD-3-Clause
import csv
import json
import resource
import subprocess
import tempfile
from functools import partial
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from case_script import parser_of, save

# Strains of 0.2 % at most: small displacements, in ccx (without NLGEOM) as in ilaw.
YOUNG, DENSITY, GRAVITY, SPEED, GAP = 900.0, 1.0, 0.1, 0.1, 0.005
WAVE = (YOUNG / DENSITY) ** 0.5
SECONDS = 20
CORNERS = ((0, 0), (1, 0), (1, 1), (0, 1))


class Impact:
    """A bar at rest is hit by an equal one: both ends move with half the speed until the wave is back (d'Alembert)."""

    name, bodies, length, gap, end = "impact", 2, 10.0, GAP, 0.9

    def exact(self, t):
        """Displacements of the two faces that meet: lower, upper."""
        first, last = self.gap / SPEED, self.gap / SPEED + 2 * self.length / WAVE
        together = 0.5 * SPEED * (np.clip(t, first, last) - first)
        lower = -together - SPEED * np.maximum(t - last, 0)
        return np.column_stack([lower, -SPEED * np.minimum(t, first) - together])

    columns, length_scale, speed_scale = [0, 1], 0.5 * SPEED * 0.9, SPEED  # both faces


class Stack:
    """Three blocks on a held face under a sudden gravity oscillate as one bar, always pressed (separation of variables)."""

    name, bodies, length, gap, end = "stack", 3, 1.0, 0.0, 0.8

    def exact(self, t):
        """Displacements of the lower face of the topmost block, and of its upper face."""
        height, n = self.bodies * self.length, np.arange(1, 400, 2)
        k = n * np.pi / (2 * height)
        amplitude = 16 * DENSITY * GRAVITY * height**2 / (YOUNG * np.pi**3 * n**3)
        at = [height - self.length, height]
        static = [-DENSITY * GRAVITY / YOUNG * (height * z - z * z / 2) for z in at]
        moving = [(amplitude * np.sin(k * z) * np.cos(np.outer(t, k) * WAVE)).sum(axis=1) for z in at]
        return np.column_stack(static) + np.column_stack(moving)

    # The top: the amplitude of its displacement, and of its velocity.
    columns, length_scale, speed_scale = [1], DENSITY * GRAVITY * 3.0**2 / (2 * YOUNG), GRAVITY * 3.0 / WAVE


def velocity(case, t):
    return (case.exact(t + 1e-5) - case.exact(t - 1e-5)) / 2e-5


def errors(case, t, u, v):
    """Root mean square of the displacements, mean of the velocities, over the time and relative to their sizes."""
    of_u, of_v = (u - case.exact(t))[:, case.columns], (v - velocity(case, t))[:, case.columns]
    return np.sqrt((of_u**2).mean()) / case.length_scale, np.abs(of_v).mean() / case.speed_scale


def deck(case, elements, h, contact):
    """The input of ccx. A contact pair is a set of nodes and a face: neither may have held nodes."""
    size, per_body = case.length / elements, 4 * (elements + 1)
    lines = ["*NODE,NSET=ALL"]
    for body in range(case.bodies):
        for k in range(elements + 1):
            z = body * (case.length + case.gap) + k * size
            lines += [f"{body * per_body + 4 * k + c + 1},{x},{y},{z:.15g}" for c, (x, y) in enumerate(CORNERS)]
    lines.append("*ELEMENT,TYPE=C3D8,ELSET=BODIES")
    for body in range(case.bodies):
        for k in range(elements):
            first = body * per_body + 4 * k + 1
            lines.append(",".join(map(str, [body * elements + k + 1, *range(first, first + 8)])))
    lines += ["*MATERIAL,NAME=M", "*ELASTIC", f"{YOUNG},0.", "*DENSITY", f"{DENSITY}", "*SOLID SECTION,ELSET=BODIES,MATERIAL=M",
              "*SURFACE INTERACTION,NAME=I", "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR", "1e5"]  # fmt: skip
    for body in range(1, case.bodies):
        first = body * per_body + 1
        lines += [f"*SURFACE,NAME=NODES{body},TYPE=NODE", *map(str, range(first, first + 4)), f"*SURFACE,NAME=FACE{body}",
                  f"{body * elements},S2", f"*CONTACT PAIR,INTERACTION=I,TYPE={contact}", f"NODES{body},FACE{body}"]  # fmt: skip
    top = (case.bodies - 1) * per_body
    if case.name == "impact":
        lines += [f"*NSET,NSET=THROWN,GENERATE\n{top + 1},{top + per_body}", f"*INITIAL CONDITIONS,TYPE=VELOCITY\nTHROWN,3,{-SPEED}"]
    else:
        lines += ["*BOUNDARY", *(f"{node},1,3" for node in range(1, 5))]
    watched = (top - 3, top + 1) if case.name == "impact" else (top + 1, top + per_body)
    lines += ["*NSET,NSET=WATCHED", f"{watched[0]},{watched[1]}", "*STEP,INC=100000000", "*DYNAMIC,EXPLICIT,DIRECT,ALPHA=0.",
              f"{h},{case.end},{h},{h}"]  # fmt: skip
    if case.name == "stack":
        lines += ["*DLOAD", f"BODIES,GRAV,{GRAVITY},0.,0.,-1."]
    return "\n".join([*lines, "*NODE PRINT,NSET=WATCHED,FREQUENCY=1", "U,V", "*END STEP", ""])


def timed(command, folder):
    """The finished process, and its processor time; it is killed after SECONDS of that."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(list(map(str, command)), cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS)))  # fmt: skip
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return done, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def calculix(contact, case, elements, h):
    """Times, displacements and velocities of the two watched nodes along z, and seconds; or why there are none."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "case.inp").write_text(deck(case, elements, h, contact))
        done, seconds = timed(["ccx", "case"], folder)
        text = (Path(folder) / "case.dat").read_text()
    if "+1" in text:  # numbers of 1e100 and more have no E
        return "diverges"
    if done.returncode:
        return f"ends with {done.returncode}"
    times, values = [], {"displacements": [], "velocities": []}
    for line in text.splitlines():
        words = line.split()
        if words and words[0] in values:
            rows = values[words[0]]
            if words[0] == "displacements":
                times.append(float(words[-1]))
        elif len(words) == 4:
            rows.append(float(words[3]))
    return np.array(times), *(np.reshape(rows, (-1, 2)) for rows in values.values()), seconds


def ilaw(program, case, elements, h):
    blocks = [{"name": f"b{k}", "corner": [0, 0, k * (case.length + case.gap)], "size": [1, 1, case.length],
               "elements": [1, 1, elements], "material": {"type": "linear", "young": YOUNG, "poisson": 0.0, "density": DENSITY}}
              for k in range(case.bodies)]  # fmt: skip
    if case.name == "impact":
        blocks[-1]["velocity"] = [0, 0, -SPEED]
    loads = [{"type": "motion", "nodes": "b0.z_min"}, {"type": "gravity", "acceleration": [0, 0, -GRAVITY]}]
    first = lambda body: 4 * (elements + 1) * body  # noqa: E731
    top = first(case.bodies - 1)
    watched = [top - 4, top] if case.name == "impact" else [top, top + 4 * elements]
    scene = {
        "model": {"type": "blocks", "blocks": blocks}, "time": {"dt": h, "end": case.end},
        "loads": loads if case.name == "stack" else [],
        "interfaces": [{"law": "contact", "nodes": list(range(first(k), first(k) + 4)),
                        "against": {"nodes": list(range(first(k) - 4, first(k))), "normal": [0, 0, 1]}}
                       for k in range(1, case.bodies)],
        "output": {"watch": watched},
    }  # fmt: skip
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "scene.json").write_text(json.dumps(scene))
        done, seconds = timed([program, "run", "scene.json", "--out", "out"], folder)
        if done.returncode:
            raise SystemExit(done.stdout)
        with open(Path(folder) / "out" / "history.csv") as file:
            rows = list(csv.DictReader(file))
    t, *found = (np.array([float(row[name]) for row in rows]) for name in
                 ("time", *(f"n{node}.{kind}2" for kind in "uv" for node in watched)))  # fmt: skip
    return t, np.column_stack(found[:2]), np.column_stack(found[2:]), seconds


def main():
    given = parser_of(__doc__).parse_args()
    print("| case | elements a body | contact | step | steps | error of displacement | error of velocity | CPU |\n" + "| --- " * 8 + "|")
    shown = {}
    for case, meshes in ((Impact(), (20, 80)), (Stack(), (8, 32))):
        for elements in meshes:
            crossing = case.length / elements / WAVE  # the critical step of lumped masses
            runs = {"CalculiX, massless": (partial(calculix, "MASSLESS"), (0.55, 0.5, 0.25)),
                    "CalculiX, penalty": (partial(calculix, "NODE TO SURFACE"), (0.5,)),
                    "law contact": (partial(ilaw, given.program), (0.95, 0.5))}  # fmt: skip
            for name, (run, fractions) in runs.items():
                for fraction in fractions:
                    h = float(f"{fraction * crossing:.3g}")
                    found = run(case, elements, h)
                    head = f"| {case.name} | {elements} | {name} | {fraction} L/c |"
                    if isinstance(found, str):
                        print(f"{head} - | {found} | - | - |", flush=True)
                        continue
                    t, u, v, seconds = found
                    of_u, of_v = errors(case, t, u, v)
                    print(f"{head} {len(t)} | {100 * of_u:.2g} % | {100 * of_v:.2g} % | {seconds:.2f} s |", flush=True)
                    shown.setdefault((case.name, elements), {})[name] = (case, t, u, v)
    if given.picture:
        picture(shown, given.picture)


def picture(shown, file):
    figure, axes = plt.subplots(1, 2, figsize=(8.4, 3.2))
    for (key, end), plot in zip(((("impact", 80), 0.9), (("stack", 32), 0.8)), axes):
        for name, color in (("law contact", "tab:orange"), ("CalculiX, massless", "tab:blue")):
            case, t, _, v = shown[key][name]
            plot.plot(t[t < end], v[t < end, 1], color=color, lw=0.8, label=name)
        t = np.linspace(1e-4, end, 2000)
        plot.plot(t, velocity(case, t)[:, 1], "k--", lw=0.8, label="exact")
        plot.set_xlabel("time [s]")
        plot.set_title({"impact": "two bars: the face of the moving one", "stack": "stack: its top"}[key[0]], fontsize=9)
    axes[0].set_ylabel("velocity [m/s]")
    axes[0].legend(fontsize=8, frameon=False)
    save(figure, file)


if __name__ == "__main__":
    main()
