"""The decks of the examples: their Python text runs beside springs in the place of solids, and the judges tell right
from wrong. run.sh runs them in an OpenRadioss, where one is at hand."""
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from engine import Engine

EXAMPLES = Path(os.environ["ILAW_SOURCE"]) / "api/openradioss/examples"
sys.path.insert(0, str(EXAMPLES))
import cases  # noqa: E402
import deck as decks  # noqa: E402


def blocks(text):
    """The cards of a starter file: {keyword: [lines, ...]}."""
    found = {}
    for part in ("\n" + text).split("\n/")[1:]:
        keyword, *lines = part.splitlines()
        found.setdefault("/".join(keyword.split("/")[:2]), []).append(lines)
    return found


def engine_of(folder, gravity=0.0):
    """Nodes, velocities and masses of a deck. Bars have springs along x; of a block under gravity the columns are
    rigid, with their masses at the foot."""
    text = next(Path(folder).glob("*_0000.rad")).read_text()
    cards = blocks(text)
    nodes = [line.split() for lines in cards["NODE"] for line in lines]
    users, x = [int(n[0]) for n in nodes], np.array([[float(c) for c in n[1:]] for n in nodes])
    row = {n: k for k, n in enumerate(users)}
    mass, bars = np.zeros(len(x)), []
    for lines in (one for keyword, many in cards.items() if keyword.startswith("BRICK") for one in many):
        for corners in ([row[int(n)] for n in line.split()[1:]] for line in lines):
            mass[corners] += np.ptp(x[corners], axis=0).prod() / 8
            bars += [(corners[a], corners[b]) for a, b in ((0, 1), (3, 2), (4, 5), (7, 6))]
    if gravity:
        foot = {(a, b): k for k, (a, b, c) in enumerate(x.round(9)) if c == 0.0}
        for k, (a, b, c) in enumerate(x.round(9)):
            if c > 0.0:
                mass[foot[a, b]], mass[k] = mass[foot[a, b]] + mass[k], 1e-12
    density = float(cards["MAT/ELAST"][0][1].split()[0])
    groups = {
        lines[0].split()[1]: [row[int(n)] for line in lines[1:] for n in line.split()] for lines in cards["GRNOD/NODE"]
    }
    v = np.zeros_like(x)
    for lines in cards.get("INIVEL/TRA", []):
        *components, group, _ = lines[1].split()
        v[groups[group]] = [float(c) for c in components]
    spring = cases.YOUNG * cases.SIDE**2 / 4 * cases.CELLS / cases.LENGTH
    force = (lambda t, x: np.outer(density * mass, [0, 0, -gravity])) if gravity else None
    python = [lines for keyword, many in cards.items() if keyword.startswith("FUNCT_PYTHON") for lines in many][0]
    made = Engine(x, v=v, mass=density * mass, force=force, users=users, bars=[] if gravity else bars, stiffness=spring)
    return made, "\n".join(python)


def run(folder, gravity, step, end, monkeypatch):
    """The Python text of the deck, with TIME and DT as the engine sets them."""
    monkeypatch.chdir(folder)
    monkeypatch.syspath_prepend(str(folder))
    for module in ("ilaw_contacts", "ilaw_openradioss"):
        sys.modules.pop(module, None)
    engine, text = engine_of(folder, gravity)
    names = {}
    exec(text, names)

    def sync(context, time, dt):
        names.update(TIME=time, DT=dt)
        names["sync"](context)

    for _ in engine.run(sync, [step] * round(end / step)):
        pass


@pytest.mark.parametrize(
    ("case", "gravity", "step", "end"),
    [
        ("slide", 10.0, 1e-3, 0.8),
        ("impact", 0.0, 3.6e-6, 6e-4),
        ("two_bars", 0.0, 3.6e-6, 6e-4),
        ("peel", 0.0, 3.6e-6, 2e-3),
    ],
)
def test_a_deck_gives_its_closed_form(case, gravity, step, end, tmp_path, monkeypatch):
    cases.CASES[case](tmp_path)
    run(tmp_path, gravity, step, end, monkeypatch)
    for what, found, exact, allowed in cases.judge(case, tmp_path):
        assert abs(found - exact) <= allowed * (abs(exact) or 1.0), (what, found, exact)


def test_the_judge_tells_a_wrong_run(tmp_path):
    (tmp_path / "history.csv").write_text("time,bond.fx,bond.gap,friction,rupture\n0.002,0,0,0,0.0021\n")
    judge = [sys.executable, EXAMPLES / "cases.py", "judge"]
    done = subprocess.run([*judge, "peel", tmp_path], capture_output=True, text=True)
    assert done.returncode == 1 and "dissipated [J] 0.0021, exact 0.002: off by 5.0e-02" in done.stdout, done.stderr
    done = subprocess.run([*judge, "fall", tmp_path], capture_output=True, text=True)
    assert done.returncode == 1 and "found judge fall" in done.stderr and "slide, impact, two_bars, peel" in done.stderr


def test_the_judge_tells_a_continued_run_with_other_bits(tmp_path):
    for case, last in (("bond", 1.9748417658131499), ("continued", 1.9748417658131497)):
        (tmp_path / case).mkdir()
        (tmp_path / case / "history.csv").write_text(f"0.0,0.0,2.0\n0.0,0.0,2.0\n0.1,0.2,{last!r}\n")
    checks = cases.judge("continued", tmp_path / "continued")
    assert [found for _, found, *_ in checks] == [1.9748417658131497, 1] and checks[1][3] == 0.0


def test_facets_of_a_block_are_seen_from_outside():
    nodes, bricks = decks.block((2, 3, 1), (2.0, 3.0, 1.0), (0.0, 0.0, 0.0))
    x = dict(nodes)
    for axis, value, outward in ((0, 0.0, -1.0), (0, 2.0, 1.0), (1, 3.0, 1.0), (2, 0.0, -1.0)):
        found = decks.facets(bricks, decks.face(nodes, axis, value))
        assert found
        for facet in found:
            a, b, c = (np.array(x[n]) for n in facet[:3])
            assert np.cross(b - a, c - b)[axis] * outward == pytest.approx(1.0)


def test_run_says_what_it_needs():
    environment = {k: v for k, v in os.environ.items() if k != "OPENRADIOSS"}
    done = subprocess.run([EXAMPLES / "run.sh"], env=environment, capture_output=True, text=True)
    assert done.returncode and "found no OPENRADIOSS" in done.stderr
    environment["OPENRADIOSS"] = "/none"
    done = subprocess.run([EXAMPLES / "run.sh"], env=environment, capture_output=True, text=True)
    assert done.returncode == 2 and "expected OPENRADIOSS/exec/starter_" in done.stderr


def test_run_leads_openradioss_to_one_python(tmp_path):
    """It reads RAD_PYTHON_PATH, and then takes the first libpython3.12.so, 3.11, ... that loads, or none."""
    programs = tmp_path / "exec"
    programs.mkdir()
    for name in ("starter", "engine"):
        stub = programs / f"{name}_stub"
        stub.write_text('#!/bin/sh\nreadlink "${LD_LIBRARY_PATH%%:*}/libpython3.12.so" >>../found\n')
        stub.chmod(0o755)
    environment = os.environ | dict(OPENRADIOSS=str(tmp_path), RAD_PYTHON_PATH="/of/libpython3.x.so")
    environment["ILAW_RADIOSS_LIBRARY"] = "/none"
    subprocess.run([EXAMPLES / "run.sh", "runs"], cwd=tmp_path, env=environment, capture_output=True)
    assert (tmp_path / "runs/found").read_text() == 8 * "/of/libpython3.x.so\n"


@pytest.mark.skipif("OPENRADIOSS" not in os.environ, reason="no OpenRadioss: OPENRADIOSS names its folder")
def test_the_cases_run_in_openradioss(tmp_path):
    done = subprocess.run([EXAMPLES / "run.sh", tmp_path], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
