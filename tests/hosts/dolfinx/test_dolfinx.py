# SPDX-License-Identifier: BSD-3-Clause
"""The block of api/python/examples/dolfinx on 1, 2 and 4 ranks of mpirun: identities, equal ranks, all runs end."""
import json
import os
import re
import subprocess
import sys
import xml.etree.ElementTree as xml
from pathlib import Path

import numpy as np
import pytest

CASES = Path(__file__).with_name("cases.py")
RANKS = (2, 1, 4)  # two ranks first, since forms are compiled in the first run
NAMES = ["coulomb, hexahedra", "coulomb, a file", "postit, tetrahedra", "coulomb, neo-hookean", "postit, tall"]


def on_ranks(ranks, *arguments, script=CASES):
    """A run without a home folder. One that does not end fails."""
    environment = {**os.environ, "HOME": "/nonexistent", "OMP_NUM_THREADS": "1", "OMPI_MCA_mpi_yield_when_idle": "1",
                   "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}  # fmt: skip
    command = ["mpirun", "--oversubscribe", "-n", str(ranks), sys.executable, str(script), *map(str, arguments)]
    return subprocess.run(command, env=environment, stdin=subprocess.DEVNULL, text=True, timeout=200,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)  # fmt: skip


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """By number of ranks: what came out, and which forms were compiled by then."""
    out = tmp_path_factory.mktemp("dolfinx")
    made = {"out": out}
    for ranks in RANKS:
        done = on_ranks(ranks, out)
        assert done.returncode == 0, done.stdout[-3000:]
        said = json.loads((out / f"{ranks}.json").read_text())
        made[ranks] = said, np.load(out / f"{ranks}.npz"), {file.name for file in out.glob("compiled/*.c")}
    return made


@pytest.mark.parametrize("ranks", RANKS)
@pytest.mark.parametrize("name", NAMES)
def test_identities_hold(runs, ranks, name):
    said = runs[ranks][0][name]
    # Kinetic energy against the works of all forces, for any material; for a linear one the discrete energy too.
    assert said["energy"]["balance"] < 1e-12
    assert name == "coulomb, neo-hookean" or said["energy"]["identity"] < 1e-12
    # No closed node approaches faster than the activation of its law allows; the impact speed is 1.
    assert said["approach"] < 1e-12
    assert said["status_counts"]["bad_input"] == 0
    assert said["worst_u"] > 0.02  # it did move


@pytest.mark.parametrize("ranks", (2, 4))
@pytest.mark.parametrize("name", NAMES)
def test_ranks_do_not_matter(runs, ranks, name):
    one, more = runs[1][1][name], runs[ranks][1][name]
    np.testing.assert_allclose(more, one, rtol=0, atol=1e-10)
    assert np.abs(one[:, 6:9]).max() > 0.1
    assert sum(runs[ranks][0][name]["at_plane"]) == sum(runs[1][0][name]["at_plane"])


def test_a_rank_without_interface_nodes_takes_part(runs):
    for ranks in (2, 4):
        assert 0 in runs[ranks][0]["postit, tall"]["at_plane"]


PAIRS = ["pair, tetrahedra", "pair, hexahedra", "pair, tied"]


@pytest.mark.parametrize("ranks", RANKS)
@pytest.mark.parametrize("name", PAIRS)
def test_an_interface_of_two_blocks_does_not_depend_on_ranks(runs, ranks, name):
    said, rows = runs[ranks][0][name], runs[ranks][1][name]
    assert all(sum(count > 0 for count in of_rank) >= min(ranks, 2) for of_rank in said["of_ranks"])  # it is split
    assert said["order"] == runs[1][0][name]["order"]  # of nodes and facets, to the bit
    assert said["identity"] < 1e-13 and said["momentum"] < 1e-14
    assert -0.9 < said["work"] < -0.05 or name == "pair, tied" and abs(said["work"]) < 1e-13
    np.testing.assert_allclose(rows, runs[1][1][name], rtol=0, atol=1e-13)
    assert np.abs(rows[:, 6:9]).max() > 0.1


@pytest.mark.parametrize("ranks", RANKS)
def test_two_tied_blocks_move_as_one(runs, ranks):
    """Of the nodes at z = 0.5 the one block has one, the two blocks have one each."""
    found, one = runs[ranks][1]["pair, tied"], runs[ranks][1]["one block"]
    upper, lower = one[one[:, 2] > 0.5 - 1e-9], one[one[:, 2] < 0.5 + 1e-9]
    np.testing.assert_allclose(found, np.concatenate([upper, lower]), rtol=0, atol=1e-12)


def test_the_post_it_is_peeled_from_one_side(runs):
    said = runs[1][0]["postit, tetrahedra"]
    counts = said["status_counts"]
    assert counts["free"] > 0 and counts["bonded"] + counts["healed"] > 0
    rows = runs[1][1]["postit, tetrahedra"]
    plane = rows[:, 12] >= 0
    free = rows[plane & (rows[:, 12] == 0)]
    assert free[:, 0].mean() > rows[plane & (rows[:, 12] > 0)][:, 0].mean() + 0.5  # pulled at x = 2


def test_stored_energy_drifts_by_the_second_order_of_the_step(runs):
    (h1, e1), (h2, e2), (h3, e3) = runs[1][0]["drifts"]
    for h, e in ((h2, e2), (h3, e3)):
        assert np.log(e1 / e) / np.log(h1 / h) == pytest.approx(2.0, abs=0.1)


def test_the_step_does_not_depend_on_ranks(runs):
    assert len({runs[ranks][0]["critical step"] for ranks in RANKS}) == 1


def test_all_ranks_load_what_the_first_compiled(runs):
    """No form was compiled a second time, under another name: names are numbers in hexadecimal digits."""
    assert runs[1][2] == runs[2][2] == runs[4][2] and len(runs[1][2]) > 5
    texts = [re.sub("[0-9a-f]{8,}", "", file.read_text()) for file in runs["out"].glob("compiled/*.c")]
    assert len(set(texts)) == len(texts)


def test_fields_are_written_for_paraview(runs):
    times = {}
    for grid in xml.parse(runs["out"] / "block.xdmf").iter("Grid"):
        if grid.find("Time") is not None:
            name = grid.find("Attribute").attrib["Name"]
            times.setdefault(name, []).append(float(grid.find("Time").attrib["Value"]))
    assert times.keys() == {"displacement", "status", "adhesion"}
    assert times["status"] == times["adhesion"] and len(times["status"]) == 4
    assert (runs["out"] / "block.h5").stat().st_size > 10_000


def test_the_comparison_with_kinematic_contact_and_penalties_runs(runs):
    """On a plane kinematic contact is the law without restitution; nodes of a penalty sink in, at shorter steps."""
    script = Path(os.environ["ILAW_SOURCE"]) / "api/python/examples/dolfinx/compare.py"
    options = ["--cells", 2, 4, 6, "--seconds", 0, "--stiffness", 1, 100, "--cache", runs["out"] / "compiled"]
    done = on_ranks(1, *options, script=script)
    assert done.returncode == 0, done.stdout[-3000:]
    lines = [line.split("|")[1:-1] for line in done.stdout.splitlines() if line.startswith("| ")]
    rows = [(line[0].strip(), *(float(text.strip("% ") or "nan") for text in line[1:])) for line in lines
            if line[0].startswith((" coulomb", " kinematic", " penalty"))]  # fmt: skip
    laws, kinematic, penalties = ([row for row in rows if row[0].startswith(kind) and len(row) == 9]
                                  for kind in ("coulomb", "kinematic", "penalty"))  # fmt: skip
    assert len(laws) == len(kinematic) == len(penalties) == 3
    for law, same, spring in zip(laws, kinematic, penalties):
        assert law[6] == same[6] == 0 < spring[6]
        assert max(abs(a - b) for a, b in zip(law[4:6], same[4:6])) < 0.2
        assert spring[2] < law[2]
    assert all(fine[4] < coarse[4] for coarse, fine in zip(laws, laws[1:]))
    limits = {row[0]: row[1:3] for row in rows if len(row) == 5}
    assert max(limits["kinematic"]) < 0.2 and limits["penalty 100"][0] < 3.0


def test_an_error_on_one_rank_ends_all(tmp_path):
    done = on_ranks(2, tmp_path, "alone")
    assert done.returncode != 0
    assert "RuntimeError: this rank alone" in done.stdout


def test_the_page_quotes_the_example():
    folder = Path(os.environ["ILAW_SOURCE"]) / "api/python/examples/dolfinx"
    quoted = (folder / "README.md").read_text().split("```python\n")[1].split("```")[0]
    code = [line.strip() for line in (folder / "throw.py").read_text().splitlines()]
    lines = [line.strip() for line in quoted.strip().splitlines()]
    assert any(code[i : i + len(lines)] == lines for i in range(len(code)))
