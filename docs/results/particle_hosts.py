"""The hosts of particle_impacts.py: each runs a test with a law, and returns the largest force and the velocities
afterwards, by impact. The law `own` is the host's own model: Hertz, Mindlin, and a damper for the restitution."""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import contextlib
import io
import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, Dict, List, Tuple

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "api/python"))

import ilaw  # noqa: E402
from ilaw import runs  # noqa: E402

if TYPE_CHECKING:
    from particle_impacts import Test

Found = Dict[str, np.ndarray]
Body = Tuple[Any, List[float], List[float], List[float]]  # a Sphere, its place, velocity and spin


def in_program(test: Test, law: str, resolution: int) -> Found | None:
    """Points in 1D: they do not rotate."""
    if test.friction:
        return None
    step, steps = test.steps_of(resolution)
    gap, speed = 1.3 * step * float(test.approach[0]), float(test.speed[0])
    points = [{"mass": test.sphere.mass, "position": [gap], "velocity": [-speed]}]
    against = {"obstacle": {"type": "plane", "point": [0.0], "normal": [1.0]}}
    if test.other:
        points.append({"mass": test.other.mass, "position": [0.0], "velocity": [speed if test.is_mirrored else 0.0]})
        against = {"against": {"nodes": [1], "normal": [1.0]}}
    scene = {"model": {"type": "points", "dimension": 1, "points": points}, "time": {"dt": step, "end": step * steps},
             "interfaces": [{"name": "contact", "law": law, "parameters": test.parameters_of(law), "nodes": [0],
                             **against}],
             "output": {"every": 1, "watch": [0], "forces": ["contact"]}}  # fmt: skip
    with tempfile.TemporaryDirectory(prefix="ilaw_") as folder:
        with contextlib.redirect_stdout(io.StringIO()):
            history = runs.run(scene, Path(folder)).history
    return {"largest force": history["contact.F0"].max(keepdims=True), "normal velocity": history["n0.v0"][-1:]}


def in_python(test: Test, law: str, resolution: int) -> Found:
    """The relative motion at the contact, whose inverse mass is 7/(2 m) along the plane."""
    step, steps = test.steps_of(resolution)
    count = len(test.speed)
    acts = np.array([1.0 / test.mass, 3.5 / test.mass])
    interface = ilaw.Interface(law, velocity_step=step, delassus="transverse", **test.parameters_of(law))
    v = np.column_stack([test.slip, np.zeros(count), -test.approach])
    before, gap, total, force = np.zeros((count, 3)), 1.3 * step * test.approach, np.zeros((count, 3)), np.zeros(count)
    batch = interface.batch(v_free=v, v_previous=before, delassus=acts, gap=gap, normal=[0, 0, 1])
    batch.initialise()
    for n in range(steps):
        gap += step * v[:, 2]
        before[:] = v
        batch.evaluate(time=(n + 1) * step)
        v += batch.impulse * acts[[1, 1, 0]]
        total += batch.impulse
        force = np.maximum(force, batch.impulse[:, 2] / step)
    mass = test.sphere.mass
    return {"largest force": force, "normal velocity": -test.speed + total[:, 2] / mass,
            "tangential velocity": test.along + total[:, 0] / mass,
            "spin times radius": test.spin * test.sphere.radius - 2.5 * total[:, 0] / mass}  # fmt: skip


def bodies_of(test: Test, step: float) -> list[Body]:
    """Spheres beside each other: places, velocities and spins, the other ones after the first."""
    largest = max(test.sphere.radius, test.other.radius if test.other else 0.0)
    places = (4.0 * largest * (1.0 + np.arange(len(test.speed)))).tolist()
    height = (test.sphere.radius + 1.3 * step * test.approach).tolist()
    motion = list(zip(test.speed.tolist(), test.along.tolist(), test.spin.tolist()))
    found = [(test.sphere, [x, 0.0, z], [along, 0.0, -speed], [0.0, spin, 0.0])
             for x, z, (speed, along, spin) in zip(places, height, motion)]  # fmt: skip
    sign = 1.0 if test.is_mirrored else 0.0
    if test.other:
        found += [(test.other, [x, 0.0, -test.other.radius], [0.0, 0.0, sign * speed], [0.0, -sign * spin, 0.0])
                  for x, (speed, _, spin) in zip(places, motion)]  # fmt: skip
    return found


def words(given: dict[str, Any]) -> str:
    return " ".join(f"{name} {value}" for name, value in given.items())


def lammps_data(bodies: list[Body]) -> str:
    """A file for read_data; the box has room around the row of spheres."""
    largest = max(body.radius for body, *_ in bodies)
    room = 4.0 * largest
    ends = {"x": max(place[0] for _, place, *_ in bodies) + room, "y": room, "z": room}
    box = "\n".join(f"{-room} {end} {axis}lo {axis}hi" for axis, end in ends.items())
    lines = [f"spheres\n\n{len(bodies)} atoms\n1 atom types\n{box}\n\nAtoms # sphere\n"]
    lines += [f"{k} 1 {2 * b.radius} {b.density} {p[0]} {p[1]} {p[2]}" for k, (b, p, *_) in enumerate(bodies, 1)]
    lines += ["\nVelocities\n"] + [" ".join(map(str, (k, *v, *w))) for k, (_, _, v, w) in enumerate(bodies, 1)]
    return "\n".join(lines) + "\n"


def lammps_contact(test: Test, law: str, cutoff: float) -> list[str]:
    """Styles and fixes. LAMMPS' walls have another modulus than its grains, so its stiffness is given as a number."""
    zero = [f"pair_style zero {cutoff}", "pair_coeff * *", "fix move all nve/sphere"]
    if law != "own":
        fix = "fix contact all ilaw/{} " + law + " " + words({"sweeps": 100, "tol": 1e-13, **test.parameters_of(law)})
        return zero + [fix.format("pair") if test.other else fix.format("wall") + " plane 0 0 0 0 0 1"]
    shears = f"mindlin {8.0 * test.shear} 1.0 {test.friction}" if test.friction else "linear_nohistory 0 0"
    model = f"hertz {4.0 / 3.0 * test.modulus} {test.restitution} tangential {shears} damping tsuji"
    if test.other:
        return ["pair_style granular", f"pair_coeff * * {model}", "fix move all nve/sphere"]
    return zero + [f"fix wall all wall/gran granular {model} zplane 0.0 NULL"]


def in_lammps(test: Test, law: str, resolution: int) -> Found:
    step, steps = test.steps_of(resolution)
    bodies = bodies_of(test, step)
    largest = max(body.radius for body, *_ in bodies)
    lines = [] if law == "own" else [f"include {lammps_styles()}"]
    lines += ["units si", "atom_style sphere", "newton off", "atom_modify map array", "boundary f f f",
              "comm_modify vel yes", f"neighbor {0.2 * largest} bin", "read_data spheres", *lammps_contact(test, law, 2.1 * largest),
              f"timestep {step}", "thermo 100000", "dump all all custom 1 out id vx vz omegay fz",
              "dump_modify all sort id format float %.16g", f"run {steps}"]  # fmt: skip
    with tempfile.TemporaryDirectory(prefix="ilaw_") as name:
        folder = Path(name)
        (folder / "spheres").write_text(lammps_data(bodies), encoding="utf-8")
        (folder / "in").write_text("\n".join(lines) + "\n", encoding="utf-8")
        command = ["lmp", "-in", "in", "-log", "none", "-nocite"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
        if done.returncode or "ERROR" in done.stdout:
            raise RuntimeError(done.stdout[-1500:] + done.stderr[-1500:])
        frames = (folder / "out").read_text(encoding="utf-8").split("fz")[1:]
    count = len(test.speed)
    rows = [[line.split()[1:] for line in frame.strip().splitlines()[:count]] for frame in frames]
    return afterwards(test, np.array(rows, float))


def lammps_styles() -> Path:
    """Of the build or of an installation."""
    above = Path(os.environ["ILAW_PATH"]).parents[1]
    return next(file for folder in ("api", "share/ilaw") if (file := above / folder / "lammps/ilaw.lmp").is_file())


def afterwards(test: Test, rows: np.ndarray) -> Found:
    """rows: vx, vz, spin and force along z by step and impact."""
    return {"largest force": rows[:, :, 3].max(axis=0), "normal velocity": rows[-1, :, 1],
            "tangential velocity": rows[-1, :, 0],
            "spin times radius": rows[-1, :, 2] * test.sphere.radius}  # fmt: skip


def for_yade(test: Test, law: str, resolution: int) -> dict[str, Any]:
    step, steps = test.steps_of(resolution)
    bodies = [{"radius": b.radius, "density": b.density, "young": b.young, "poisson": b.poisson, "place": p,
               "velocity": v, "spin": w} for b, p, v, w in bodies_of(test, step)]  # fmt: skip
    return {"bodies": bodies, "is_on_plane": not test.other, "angle": math.atan(test.friction), "law": law,
            "stiffness": test.stiffness, "shear": 8.0 * test.shear * math.sqrt(test.radius),
            "parameters": {} if law == "own" else test.parameters_of(law), "restitution": test.restitution,
            "step": step, "steps": steps, "count": len(test.speed)}  # fmt: skip


def in_yade(asked: list[tuple[Test, str, int]]) -> list[Found]:
    """All in one process."""
    with tempfile.TemporaryDirectory(prefix="ilaw_") as folder:
        given, out = Path(folder) / "in.json", Path(folder) / "out.json"
        given.write_text(json.dumps([for_yade(*one) for one in asked]), encoding="utf-8")
        paths = os.pathsep.join([str(ROOT / "api/python"), str(ROOT / "api/yade"), os.environ.get("PYTHONPATH", "")])
        command = ["yade", "-n", "-x", Path(__file__).with_name("particle_yade.py"), given, out]
        around = dict(os.environ, PYTHONPATH=paths, OMP_NUM_THREADS="1")
        done = subprocess.run(command, env=around, cwd=folder, capture_output=True, text=True)
        if not out.is_file():
            raise RuntimeError(done.stdout[-1500:] + done.stderr[-1500:])
        found = json.loads(out.read_text(encoding="utf-8"))
    return [afterwards(test, np.array(rows)) for (test, *_), rows in zip(asked, found)]


HOSTS = {"run": in_program, "python": in_python, "lammps": in_lammps}
