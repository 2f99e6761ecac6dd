# SPDX-License-Identifier: BSD-3-Clause
"""The engine of api/yade in the system's Yade, headless: closed forms, refusals, runs that go on, the example.
One sphere that does not turn: tests/hosts/protocols. Spheres that turn: tests/hosts/spheres.py."""
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import spheres

YADE = Path(os.environ["ILAW_SOURCE"]) / "api/yade"


def yade(folder, *command):
    """The output of a script. Yade ends with 0 whatever a script raises, so that is looked for."""
    done = subprocess.run(["yade", "-n", "-x", *map(str, command)], cwd=folder, text=True, timeout=300,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)  # fmt: skip
    assert done.returncode == 0 and "Traceback" not in done.stdout, done.stdout[-3000:]
    return done.stdout


@pytest.fixture(scope="module")
def figures(tmp_path_factory):
    folder = tmp_path_factory.mktemp("yade")
    yade(folder, Path(__file__).with_name("cases.py"), folder / "figures.json")
    return json.loads((folder / "figures.json").read_text())


def test_two_spheres_keep_momentum_and_e(figures):
    for e, found in figures["collisions"].items():
        (m1, m2), (v1, v2) = found["m"], found["v"]
        assert m1 * v1 + m2 * v2 == pytest.approx(-m2, rel=1e-13), e
        assert v2 - v1 == pytest.approx(float(e), abs=1e-13), e


def test_bodies_and_engines_may_change(figures):
    (m1, m2), v = figures["changed"]["m"], figures["changed"]["v"]
    assert v == pytest.approx([-m2 / (m1 + m2)] * 2, rel=1e-12)


@pytest.mark.parametrize("name", spheres.CASES)
def test_spheres_turn_as_closed_forms_say(figures, name):
    for dt, found, lost in figures["turning"][name]:
        spheres.judge(spheres.CASES[name], dt, found, lost, starts_late=True)


def test_a_column_stays(figures):
    found = figures["column"]
    assert found["moved"] < 1e-13
    assert found["carried"] == pytest.approx(5.0, rel=1e-10)


@pytest.mark.parametrize("name", ["goes on", "goes on with moments"])
def test_memory_goes_on_to_the_same_bits(figures, name):
    whole, parts = figures[name]
    assert whole == parts and np.abs(whole).max() > 0.01


@pytest.mark.parametrize("k, reason", enumerate([
    "damping=0", "body 1: single spheres and walls", "blockedDOFs 'z'", "body 1: angVel (1.0, 0.0, 0.0)"]))
def test_what_is_not_served_is_refused(figures, k, reason):
    assert reason in figures["refused"][k]


def test_the_example_settles_beside_yades_own_law(tmp_path):
    options = ["--count", "8", "--end", "0.3", "--steps", "2e-3", "3e-3", "--own-steps", "8e-5"]
    done = subprocess.run([sys.executable, YADE / "examples/compare.py", *options], cwd=tmp_path, text=True,
                          timeout=200, stdout=subprocess.PIPE, check=True)  # fmt: skip
    rows = [line.split("|")[1:-1] for line in done.stdout.splitlines() if line.startswith("| ")][2:]
    assert [row[0].strip() for row in rows] == ["coulomb"] * 2 + ["Mindlin"]
    assert [float(row[1]) for row in rows] == [2, 3, 0.08]
    assert 0 < float(rows[1][3].strip(" %")) < 5, rows
    assert all(float(row[5].strip(" %")) < bound for row, bound in zip(rows, (0.1, 0.1, 1))), rows


def test_the_script_of_the_page_runs(tmp_path):
    script = re.search(r"```python\n(.*?)```", (YADE / "README.md").read_text(), re.S)[1]
    (tmp_path / "drop.py").write_text(script)
    height, residual = map(float, yade(tmp_path, "drop.py").strip().splitlines()[-1].split())
    assert height == pytest.approx(0.05, abs=1e-12) and residual < 1e-8


def test_the_example_rolls_out(tmp_path):
    said = yade(tmp_path, YADE / "examples/roll.py", 2e-3)
    found = re.search(r"^rolled (\S+) m, closed form (\S+) m, spin left (\S+)", said, re.M)
    rolled, closed, spin = map(float, found.groups())
    assert rolled == pytest.approx(closed, abs=2e-6) and spin < 1e-12


def test_the_memory_of_a_contact_is_measured(tmp_path):
    said = yade(tmp_path, YADE / "examples/memory.py", "ilaw", 8)
    count, each = map(int, re.search(r"^ilaw: (\d+) contacts, (\d+) bytes each$", said, re.M).groups())
    assert count >= 3 * 8 * 8 * 7 and each < 4000
