"""The wheel with the libraries: built from an installation of its component, installed without an index, used alone."""
import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

TREE, BUILD = Path(os.environ["ILAW_SOURCE"]), Path(os.environ["ILAW_BUILD"])
VERSION = re.search(r"project\(ilaw VERSION (\S+)", (TREE / "CMakeLists.txt").read_text())[1]
# A wheel brings its own: nothing in the environment may name libraries of the tree.
ALONE = {name: value for name, value in os.environ.items() if name != "PYTHONPATH" and not name.startswith("ILAW_")}
ALONE["PYTHONDONTWRITEBYTECODE"] = "1"

# A block slides until friction stops it, after v0^2/(2 mu g); five weights on each other press with the weight above.
# Then the files of the program that are libraries or belong to the package.
PROBLEM = """
import numpy as np
import ilaw
from ilaw.coupled import Bodies, Contacts, Solver

h, gravity, v0 = 1e-3, np.array([0.0, 0.0, -10.0]), 1.2
u, v, v_before = np.zeros((1, 3)), np.array([[v0, 0.0, 0.0]]), np.zeros((1, 3))
law = ilaw.Interface("coulomb", velocity_step=h, friction=0.3)
floor = law.batch(v_free=v, v_previous=v_before, delassus=1.0, gap=u[:, 2], normal=[0, 0, 1])
floor.initialise()
v += 0.5 * h * gravity
for n in range(1000):
    u += h * v
    v_before[:] = v
    v += h * gravity
    floor.evaluate(time=(n + 1) * h)
    v += floor.impulse
assert abs(u[0, 0] - v0**2 / (2 * 0.3 * 10.0)) < h * v0, u

v, v_before = np.zeros((5, 3)), np.zeros((5, 3))
bodies = Bodies(v_free=v, v_previous=v_before, inverse_mass=0.5, velocity=v)
contacts = Contacts(law, body=np.arange(5), counterpart=np.arange(5) - 1, gap=0.0, normal=[0, 0, 1])
contacts.initialise()
v += h * gravity
Solver().solve(bodies, [contacts], time=h, tolerance=1e-14)
np.testing.assert_allclose(contacts.impulse[:, 2], 2 * h * 10.0 * np.arange(5, 0, -1), rtol=1e-9)

print(ilaw.__file__)
print(*ilaw.list(), sep="\\n")
print(*{line.split()[-1] for line in open("/proc/self/maps") if "ilaw" in line.split()[-1]}, sep="\\n")
"""


def run(*command, **options):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, env=ALONE, **options)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    work = tmp_path_factory.mktemp("wheel")
    run("cmake", "--install", BUILD, "--component", "wheel", "--prefix", work / "project", "--strip")
    run(sys.executable, "-m", "pip", "wheel", "--quiet", "--no-index", "--no-deps", "--no-build-isolation",
        "--wheel-dir", work, work / "project")  # fmt: skip
    return next(work.glob("*.whl"))


def test_the_name_says_platform_and_any_python_3(wheel):
    machine = os.uname().machine
    assert wheel.name == f"ilaw-{VERSION}-py3-none-linux_{machine}.whl"
    with zipfile.ZipFile(wheel) as archive:
        described = archive.read(f"ilaw-{VERSION}.dist-info/WHEEL").decode()
    assert "Root-Is-Purelib: false" in described


def test_all_laws_and_libraries_are_in_it(wheel):
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
    laws = {source.stem for source in TREE.glob("plugins/*/*.c*") if source.stem == source.parent.name}
    laws = {law for law in laws if not law.startswith("template_")}
    assert len(laws) >= 12
    wanted = {f"ilaw/lib/ilaw/{law}.{ending}" for law in laws for ending in ("so", "json")}
    wanted |= {"ilaw/lib/libilaw_loader.so.1", "ilaw/lib/libilaw_coupled.so.1", "ilaw/lib/libilaw_search.so.1"}
    assert {name for name in names if name.startswith("ilaw/lib/")} == wanted
    assert {"ilaw/py.typed", f"ilaw-{VERSION}.dist-info/LICENSE"} <= names


def test_runs_alone_with_its_own_laws(wheel, tmp_path):
    home = tmp_path / "environment"
    # numpy is the system's, as no index is there to bring it.
    run(sys.executable, "-m", "venv", "--system-site-packages", "--without-pip", home)
    python = home / "bin/python"
    run(python, "-m", "pip", "install", "--quiet", "--no-index", wheel)
    files = run(python, "-c", PROBLEM, cwd=tmp_path).split()
    assert sum(file.endswith("/ilaw/lib/ilaw/coulomb.so") for file in files) == 2  # listed, and loaded
    assert any(file.endswith("libilaw_coupled.so.1") for file in files)
    for file in files:
        assert Path(file).is_relative_to(home), file
