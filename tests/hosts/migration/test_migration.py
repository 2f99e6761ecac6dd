"""From penalty to law (docs/migration.md): a code in Fortran is changed in five steps, one in C++ with MPI in two, each is
built and run, and what must come out comes out. References are of neither side: a closed form, the critical steps, the
code before."""
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

HERE, SOURCE = Path(__file__).parent, Path(os.environ["ILAW_SOURCE"])
FLAGS = ["-O1", "-fopenmp", "-ffp-contract=off", "-Wall", "-Wextra", "-Wno-maybe-uninitialized"]
NX, CFL, STIFFNESS, FRICTION, GRAVITY = 16, 0.8, 1e9, 0.3, 10.0


@pytest.fixture(scope="module")
def programs(tmp_path_factory):
    """The code before, and after each of the five steps."""
    folder = tmp_path_factory.mktemp("migration")
    compiler = [os.environ["FC"], *FLAGS, "-J", folder]
    module = [SOURCE / "api/fortran" / name for name in ("ilaw_abi.f90", "ilaw.f90")]
    subprocess.run([*compiler, "-c", *module], check=True, cwd=folder)
    source, made = folder / "solid.f90", []
    source.write_text((HERE / "solid.f90").read_text())
    for step in range(6):
        if step:
            subprocess.run(["patch", "--fuzz=0", "-s", source, HERE / f"{step}.diff"], check=True)
        program = folder / f"solid_{step}"
        ilaw = [folder / "ilaw_abi.o", folder / "ilaw.o", os.environ["ILAW_LOADER_STATIC"], "-lstdc++", "-ldl"]
        built = subprocess.run([*compiler, "-Werror", source, *ilaw, "-o", program], capture_output=True, text=True)
        assert built.returncode == 0, built.stderr
        made.append(program)
    return made


def run(program, end, *more, threads=1):
    """{name: numbers} of the lines that the code prints."""
    words = [program, NX, CFL, end, *more]
    environment = os.environ | {"OMP_NUM_THREADS": str(threads)}
    done = subprocess.run(list(map(str, words)), capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stdout + done.stderr
    found = re.findall(r"([a-z][a-z ]*?) +(-?\d[\d.E+-]*(?: +-?\d[\d.E+-]*)*)", done.stdout)
    return {name: [float(number) for number in numbers.split()] for name, numbers in found}


def missed_impulse(found):
    """While all nodes slide, the floor takes mu times the vertical impulse: v_x = 2 - mu (g t + v_y)."""
    (v_x, v_y), (time,) = found["velocity"], found["at time"]
    return abs(v_x - (2.0 - FRICTION * (GRAVITY * time + v_y)))


def test_step_1_only_moves_the_call(programs):
    before, after = run(programs[0], 0.2, STIFFNESS), run(programs[1], 0.2, STIFFNESS)
    assert after["steps"] == before["steps"] == [1415]
    assert after["velocity"] == pytest.approx(before["velocity"], rel=1e-8)
    # It sinks by its weight over the stiffness, and four times that where it swings.
    sunk = 1000 * GRAVITY * 0.5 / STIFFNESS
    assert sunk < before["floor penetration"][0] < 8 * sunk


def test_step_2_changes_no_bit(programs):
    assert run(programs[2], 0.2, STIFFNESS, "coulomb") == run(programs[1], 0.2, STIFFNESS)


def test_step_3_ends_the_penetration_of_the_floor(programs):
    before, after = run(programs[2], 0.04, STIFFNESS, "coulomb"), run(programs[3], 0.04, STIFFNESS, "coulomb")
    assert after["steps"] == before["steps"]  # the cylinder still has its spring
    assert before["floor penetration"][0] > 1e-6 and after["floor penetration"][0] < 1e-15
    assert missed_impulse(after) < 1e-13


def test_step_4_gives_the_step_back(programs):
    before, after = run(programs[3], 0.2, STIFFNESS, "coulomb"), run(programs[4], 0.2, "coulomb")
    assert after["steps"][0] * 3 <= before["steps"][0] and after["steps"] == [471]
    assert max(after["floor penetration"] + after["cylinder"]) < 1e-15
    assert after["dissipated"] == pytest.approx([-w for w in after["work of contact"]], rel=1e-12)
    assert missed_impulse(run(programs[4], 0.04, "coulomb")) < 1e-13


def test_step_5_resumes_and_threads_with_the_same_bits(programs, tmp_path):
    whole = run(programs[4], 0.2, "coulomb")
    assert run(programs[5], 0.2, "coulomb", "save", tmp_path / "state", 100, threads=2) == whole
    assert run(programs[5], 0.2, "coulomb", "resume", tmp_path / "state") == whole
    # A law with a memory, too; parameters that it does not have are refused by name.
    other = subprocess.run([programs[5], "4", "0.8", "0.01", "tie"], capture_output=True, text=True)
    assert other.returncode == 1 and "friction" in other.stdout


@pytest.fixture(scope="module")
def blocks(tmp_path_factory):
    """The code of two blocks before, and after steps 6 and 7."""
    compiler = shutil.which("mpicxx")
    if not compiler:
        pytest.skip("no MPI")
    folder = tmp_path_factory.mktemp("two_blocks")
    source, made = folder / "two_blocks.cpp", []
    source.write_text((HERE / "two_blocks.cpp").read_text())
    flags = ["-std=c++20", "-O1", "-ffp-contract=off", "-Wall", "-Wextra", "-DOMPI_SKIP_MPICXX", "-DMPICH_SKIP_MPICXX"]
    parts = [os.environ[f"ILAW_{part}_STATIC"] for part in ("COUPLED", "SEARCH", "LOADER")]
    for step in (0, 6, 7):
        if step:
            subprocess.run(["patch", "--fuzz=0", "-s", source, HERE / f"{step}.diff"], check=True)
        program = folder / f"two_blocks_{step}"
        command = [compiler, *flags, "-Werror", "-isystem", SOURCE / "api/include", source, *parts, "-ldl", "-o", program]
        built = subprocess.run(command, capture_output=True, text=True)
        assert built.returncode == 0, built.stderr
        made.append(program)
    return made


def run_blocks(program, ranks, *more):
    """{name: numbers}; slides at 1 m/s."""
    root = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    start = ["mpirun", "--oversubscribe", "-n", str(ranks)] if ranks > 1 else []
    done = subprocess.run([*start, program, "1", *more], capture_output=True, text=True, env=os.environ | root)
    assert done.returncode == 0, done.stdout + done.stderr
    found = re.findall(r"([a-z]+) +(-?\d[\d.E+-e]*(?: +-?\d[\d.E+-e]*)*)", done.stdout)
    return {name: [float(number) for number in numbers.split()] for name, numbers in found}


def keeps_momentum(found):
    """The blocks weigh the same: their mean velocities keep their sum."""
    return all(abs(a + b - whole) < 1e-12 for a, b, whole in zip(found["below"], found["above"], (1.0, -1.0)))


def test_step_6_solves_the_contacts_of_two_blocks(blocks):
    before, after = run_blocks(blocks[0], 1, "1e8"), run_blocks(blocks[1], 1)
    assert keeps_momentum(before) and keeps_momentum(after)
    assert before["steps"] == [495] and after["steps"] == [111]  # the step of the mesh
    assert before["penetration"][0] > 1e-4 and after["penetration"][0] < 1e-6
    # No more friction than its coefficient, and the lower block has taken up the fall of the upper one.
    assert after["below"][0] <= FRICTION * -after["below"][1] and after["below"][1] == pytest.approx(-1.0, abs=0.05)


def test_step_7_divides_contacts_among_ranks(blocks):
    alone = run_blocks(blocks[1], 1)
    assert run_blocks(blocks[2], 1) == alone
    for ranks in (2, 3):
        found = run_blocks(blocks[2], ranks)
        assert keeps_momentum(found) and found["steps"] == alone["steps"]
        for name in ("below", "above", "dissipated"):
            assert found[name] == pytest.approx(alone[name], abs=1e-9)


def test_the_page_quotes_the_steps():
    page = (SOURCE / "docs/migration.md").read_text()
    quotes = re.findall(r"```diff\n(.*?)```", page, re.S)
    steps = "".join((HERE / f"{step}.diff").read_text() for step in range(1, 8))
    assert len(quotes) >= 7
    for quote in quotes:
        assert quote in steps, quote
