# SPDX-License-Identifier: BSD-3-Clause
"""The protocols of ilaw.protocols in hosts of several languages, and the table of docs/hosts/promise.md."""
import dataclasses
import functools
import json
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pytest

from ilaw import protocols

ROOT, BUILD = Path(os.environ["ILAW_SOURCE"]), Path(os.environ["ILAW_BUILD"])
PAGE = ROOT / "docs/hosts/promise.md"
CASES = list(protocols.PROTOCOLS.values())
ROLLING = ("slide", "stick_slip", "weaken")  # a sphere that turns ends otherwise


def by_program(program, protocol, folder):
    file = folder / f"{protocol.name}.txt"
    file.write_text(protocol.text())
    done = subprocess.run([program, file], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return np.array([float(word) for word in done.stdout.split()])


def scene_of(protocol):
    p = protocol
    point = {"mass": p.mass, "position": p.position, "velocity": p.velocity, "stiffness": p.stiffness, "area": p.area}
    plane = {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1], "velocity": p.wall}
    loads = [{"type": "force", "nodes": [0], "direction": p.force, "history": [[0, 1], [1e3, 1]]}] if any(p.force) else []
    return {
        "model": {"type": "points", "dimension": 3, "points": [point]}, "time": {"dt": p.step, "end": p.steps * p.step},
        "interfaces": [{"law": p.law, "parameters": p.parameters, "nodes": "all", "obstacle": plane}], "loads": loads,
        "output": {"watch": [0]},
    }  # fmt: skip


def by_scene(program, options, protocol, folder):
    """A host that reads scenes: its history has the impulse of each step but the start's, which the momentum gives."""
    file, out = folder / "scene.json", folder / "out"
    file.write_text(json.dumps(scene_of(protocol)))
    if protocol.restart:
        pytest.skip("other test")
    done = subprocess.run([program, *(word.format(scene=file, out=out) for word in options)], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    rows = np.genfromtxt(out / "history.csv", delimiter=",", names=True)
    last = [[rows[f"n0{q}{c}"][-1] for c in range(3)] for q in "uv"]
    summed = [rows[f"n0r{c}"].sum() for c in range(3)]
    u1, p = np.array([rows[f"n0u{c}"][0] for c in range(3)]), protocol
    first = p.mass * (u1 / p.step - p.velocity) - 0.5 * p.step * np.array(p.force)
    return np.concatenate([*last, summed + first])


def ilaw_run(protocol, folder):
    return by_scene(BUILD / "bin/ilaw", ["run", "{scene}", "--out", "{out}"], protocol, folder)


def minimal(protocol, folder):
    return by_scene(BUILD / "bin/ilaw-minimal", ["{scene}", "{out}"], protocol, folder)


def in_c(protocol, folder):
    return by_program(BUILD / "bin/protocol_c", protocol, folder)


def in_fortran(protocol, folder):
    program = BUILD / "bin/protocol_fortran"
    if not program.exists():
        pytest.skip("not installed")
    return by_program(program, protocol, folder)


def in_python(protocol, folder):
    return protocols.Host(protocol).run()


def openradioss(protocol, folder):
    """The cycle of OpenRadioss, where a contact is solved with all others."""
    import ilaw_openradioss
    from engine import Engine

    p = protocol
    if p.restart:
        pytest.skip("other test")

    def force(time, x):
        return np.array(p.force) - np.array(p.stiffness) * (x - p.position)

    engine = Engine([p.position], np.array(p.velocity), p.mass, force)
    given = dict(law=p.law, nodes=[1], plane=([0, 0, 0], [0, 0, 1]), velocity=p.wall, area=p.area, held="", **p.parameters)
    run, sums = ilaw_openradioss.Run(engine.context, 0.0, 0.0, [given], folder=folder), []

    def sync(context, time, step):
        if step > 0.0:
            run.step(time, step)
            sums.append(run.groups[0].impulse[0].copy())

    moved = None
    for _ in engine.run(sync, [p.step] * (p.steps + 1)):
        moved = engine.arrays["D"][0].copy() if len(sums) == p.steps else moved
    return np.concatenate([moved, engine.arrays["V"][0], np.sum(sums, axis=0)])


def skip_rolling(protocol, program):
    if not shutil.which(program):
        pytest.skip("not installed")
    if protocol.restart:
        pytest.skip("other test")
    if protocol.name in ROLLING:
        pytest.skip("rolls")


def lammps(protocol, folder):
    """A sphere, which turns: what it does without friction, or while it slips, is what a point does."""
    p, styles, radius = protocol, BUILD / "api/lammps/ilaw.lmp", 10 * max(protocol.position[2], 0.05)
    skip_rolling(p, "lmp")
    words = " ".join(f"{name} {value!r}" for name, value in p.parameters.items())
    x, v, f, wall = (" ".join(map(repr, vector)) for vector in (
        (*p.position[:2], p.position[2] + radius), p.velocity, p.force, p.wall))
    (folder / "in.protocol").write_text(f"""
include {styles}
units si
atom_style sphere
newton off
boundary f f f
pair_style zero {2.2 * radius}
neighbor {0.1 * radius} bin
timestep {p.step!r}
region box block {3 * f"-{40 * radius} {40 * radius} "}
create_box 1 box
create_atoms 1 single {x}
set type 1 diameter {2 * radius!r} density {p.mass / (4 / 3 * math.pi * radius**3)!r}
velocity all set {v}
pair_coeff * *
fix nve all nve/sphere
fix force all addforce {f}
fix law all ilaw/wall {p.law} {words} area {p.area!r} sweeps 100 tol 1e-15 plane 0 0 0 0 0 1 velocity {wall}
run {p.steps}
write_dump all custom dump x y z vx vy vz fx fy fz modify format float %.17g
""")
    done = subprocess.run(["lmp", "-in", "in.protocol", "-log", "none", "-nocite"], cwd=folder, text=True,
                          capture_output=True)  # fmt: skip
    assert done.returncode == 0 and "ERROR" not in done.stdout, done.stdout[-2000:]
    x, v, f = np.array((folder / "dump").read_text().split()[-9:], float).reshape(3, 3)
    v += 0.5 * p.step / p.mass * f
    return np.concatenate([x - (0, 0, radius) - p.position, v, impulses(p, v)])


@functools.cache
def yade_runs():
    """All in one Yade, which takes seconds to start."""
    folder = tempfile.mkdtemp()
    names = [case.name for case in CASES if not case.restart and case.name not in ROLLING]
    done = subprocess.run(["yade", "-n", "-x", Path(__file__).with_name("protocol_yade.py"), folder, *names],
                          text=True, stdin=subprocess.DEVNULL, capture_output=True)  # fmt: skip
    assert "Traceback" not in done.stdout, done.stdout
    return {name: np.loadtxt(f"{folder}/{name}.out") for name in names}


def yade(protocol, folder):
    """A sphere, as in LAMMPS."""
    p, radius = protocol, 10 * max(protocol.position[2], 0.05)
    skip_rolling(p, "yade")
    x, v = yade_runs()[p.name]
    return np.concatenate([x - (0, 0, radius) - p.position, v, impulses(p, v)])


def impulses(protocol, v):
    """Their sum by momentum, where nothing else but the constant force acts."""
    p = protocol
    return p.mass * (v - p.velocity) - p.step * (p.steps + 0.5) * np.array(p.force)


def mujoco(protocol, folder):
    """A sphere on three slide joints, which does not turn."""
    program = BUILD / "bin/protocol_mujoco"
    if not program.exists():
        pytest.skip("not installed")
    if any(protocol.wall):
        pytest.skip("fixed walls")
    if protocol.law == "grain":
        pytest.skip("full H")
    return by_program(program, protocol, folder)


@functools.cache
def dolfinx_block():
    """A cube whose nodes at the plane have the area 1 each; without any stiffness UFL would find no integral."""
    try:
        from block import Block, box
    except ImportError:
        return None
    return Block(box([2.0, 2.0, 2.0], [1, 1, 1], "hexahedra"), young=1e-30, cache=tempfile.mkdtemp())


def dolfinx(protocol, folder):
    """The block of the example, whose nodes move as points do."""
    p, block = protocol, dolfinx_block()
    if block is None:
        pytest.skip("not installed")
    if p.restart:
        pytest.skip("no restart")
    from throw import Throw

    class Points(Throw):
        sum = np.zeros(3)

        def loads(self):
            return np.array(p.force) - np.array(p.stiffness) * self.block.u

        def kick(self, forces, duration):
            super().kick(forces, duration)
            self.sum = self.sum + self.contact.impulse[0]

    block.u[:], block.mass[:] = 0.0, p.mass
    throw = Points(block, p.law, p.step, p.position[2], p.velocity, parameters=p.parameters, plane=p.wall)
    for _ in range(p.steps):
        throw.step()
    node, *others = throw.nodes
    assert len(others) == 3 and np.ptp(block.u[throw.nodes], axis=0).max() <= protocols.SAME * np.abs(block.u).max()
    return np.concatenate([block.u[node], block.v[node], throw.sum])


HOSTS = {"ilaw run": ilaw_run, "minimal": minimal, "C": in_c, "Fortran": in_fortran, "Python": in_python,
         "OpenRadioss (its cycle)": openradioss, "LAMMPS": lammps, "Yade": yade, "MuJoCo": mujoco,
         "dolfinx": dolfinx}  # fmt: skip


@pytest.mark.parametrize("protocol", CASES, ids=lambda case: case.name)
@pytest.mark.parametrize("host", HOSTS)
def test_a_host_keeps_the_promise(host, protocol, tmp_path):
    assert protocols.judge(protocol, HOSTS[host](protocol, tmp_path)) == []


def entry(host, protocol, folder):
    try:
        found, reference = HOSTS[host](protocol, folder), protocols.Host(protocol).run()
    except pytest.skip.Exception as why:
        return why.msg
    apart = protocols.difference(found, reference)
    return "same bits" if np.array_equal(found, reference) else "1e-12" if apart > 1e-14 else "1e-14"


# Hosts whose cells are the same have one column.
COLUMNS = [["ilaw run", "minimal"], ["C", "Fortran", "Python"], ["OpenRadioss (its cycle)"], ["LAMMPS", "Yade"],
           ["MuJoCo"], ["dolfinx"]]  # fmt: skip


def cell(hosts, case, folder):
    found = {entry(host, case, folder) for host in hosts}
    return " and ".join(sorted(found - {"not installed"} or found))


def row(cells):
    return "| " + " | ".join(cells) + " |"


def table(folder):
    heads = ["protocol", *(", ".join(hosts) for hosts in COLUMNS)]
    return [row(heads), row(["---"] * len(heads))] + [
        row([case.name.replace("_", " "), *(cell(hosts, case, folder) for hosts in COLUMNS)]) for case in CASES
    ]


def test_the_page_has_this_table(tmp_path):
    found = "\n".join(table(tmp_path))
    if os.environ.get("ILAW_TEST_ACCEPT"):
        text = re.sub(r"\| protocol \| ilaw run.*?\n\n", lambda _: found + "\n\n", PAGE.read_text(), count=1, flags=re.S)
        PAGE.write_text(text)
    expected = re.escape(found).replace(r"not\ installed", "[^|]*")
    assert re.search(expected, PAGE.read_text()), found


@pytest.mark.parametrize("protocol", CASES, ids=lambda case: case.name)
def test_three_steps_keep_the_answer(protocol):
    """Those whose answer does not depend on the step to more than its tolerance."""
    for factor in (10 / 11, 10 / 13):
        other = dataclasses.replace(protocol, step=protocol.step * factor, steps=round(protocol.steps / factor))
        found = protocols.Host(other).run()
        for name in ("v.x", "v.z", "u.x"):
            if name in protocol.exact and protocol.name != "stick_slip":
                value, tolerance = protocol.exact[name]
                assert found[protocols.NAMES.index(name)] == pytest.approx(value, abs=max(tolerance, 1e-11 * abs(value)))


def judged(folder, changes):
    """The judge's exit code and output for a host that is wrong in one respect."""
    assert protocols.main(["write", str(folder)]) == 0
    for case in CASES:
        numbers = protocols.Host(case).run()
        changes(case, numbers)
        (folder / f"{case.name}.out").write_text(" ".join(f"{number:.17g}" for number in numbers))
    done = subprocess.run([sys.executable, "-m", "ilaw.protocols", "judge", folder], capture_output=True, text=True)
    return done.returncode, done.stdout


def test_a_right_host_is_accepted(tmp_path):
    code, text = judged(tmp_path, lambda case, numbers: None)
    assert code == 0 and text.count("the same bits") == len(CASES)


def test_a_host_that_sinks_at_the_start_is_refused(tmp_path):
    def sinks(case, numbers):
        if case.name == "slide":
            numbers[2] -= 5e-6

    code, text = judged(tmp_path, sinks)
    assert code == 1 and "slide: u.z: found -5" in text and text.count("the same bits") == len(CASES) - 1


def test_a_missing_result_is_named(tmp_path):
    assert protocols.judge_folder(tmp_path) == 1
