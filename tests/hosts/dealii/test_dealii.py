# SPDX-License-Identifier: BSD-3-Clause
"""The block of api/dealii on 1, 2 and 4 ranks: equal ranks, identities of energy, and the same block in ilaw itself."""
import csv
import json
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

RANKS = (1, 2, 4)
STEP = 0.0061  # of the mesh with 6 cells a metre, refined once
CASES = {law: ["--law", law, "--cells", "6", "--refine", "1", "--dt", str(STEP)] for law in ("contact", "coulomb", "rccm")}


def on_ranks(ranks, program, options):
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OMPI_MCA_mpi_yield_when_idle": "1",
                   "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}  # fmt: skip
    command = ["mpirun", "--oversubscribe", "-n", str(ranks), os.environ["ILAW_DEALII_" + program], *options]
    done = subprocess.run(command, env=environment, stdin=subprocess.DEVNULL, text=True, timeout=100,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)  # fmt: skip
    assert done.returncode == 0, done.stdout[-3000:]
    return {name: float(value) for name, value in (line.split() for line in done.stdout.splitlines())}


def sorted_rows(rows):
    return rows[np.lexsort(np.round(rows[:, :3], 9).T)]


def throw(ranks, out, options):
    figures = on_ranks(ranks, "THROW", [*options, "--out", str(out)])
    return figures, sorted_rows(np.loadtxt(out / "nodes.csv", delimiter=",", skiprows=1))


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    out = tmp_path_factory.mktemp("dealii")
    return {(law, ranks): throw(ranks, out / f"{law}{ranks}", options) for law, options in CASES.items() for ranks in RANKS}


@pytest.mark.parametrize("law", CASES)
@pytest.mark.parametrize("ranks", RANKS)
def test_identities_hold(runs, law, ranks):
    figures, rows = runs[law, ranks]
    assert figures["balance"] < 1e-13 and figures["identity"] < 1e-13
    assert np.abs(rows[:, 3:6]).max() > 0.05  # it did move
    assert rows[:, 10].min() > -1e-13  # no node is in the plane


@pytest.mark.parametrize("law", CASES)
@pytest.mark.parametrize("ranks", (2, 4))
def test_ranks_do_not_matter(runs, law, ranks):
    one, more = runs[law, 1][1], runs[law, ranks][1]
    np.testing.assert_allclose(more[:, :6], one[:, :6], rtol=0, atol=1e-13)
    # Velocities are the changes of displacements over the step.
    np.testing.assert_allclose(more[:, 6:9], one[:, 6:9], rtol=0, atol=1e-13 / STEP)
    assert (more[:, 9] == one[:, 9]).all()
    np.testing.assert_allclose(more[:, 10:], one[:, 10:], rtol=0, atol=1e-12)


def test_the_bond_peels_from_the_pulled_side(runs):
    rows = runs["rccm", 1][1]
    plane = rows[rows[:, 2] == 0]
    near, far = plane[plane[:, 0] > 1.9], plane[plane[:, 0] < 0.1]
    assert near[:, 11].max() < 0.05 and far[:, 11].min() > 0.9  # intensity of adhesion


def in_ilaw(law, folder, h, end):
    """Displacements of all nodes at the end, nodes along x first, of the same block without refined cells."""
    bond = {"normal_stiffness": 1000, "tangential_stiffness": 500, "adhesion_energy": 0.01, "viscosity": 2e-4}
    is_bond = law == "rccm"
    scene = {
        "model": {"type": "blocks", "blocks": [{"name": "block", "size": [2, 1, 0.5], "elements": [12, 6, 3],
                  "velocity": [0, 0, 0] if is_bond else [0.5, 0, -1],
                  "material": {"type": "linear", "young": 100, "poisson": 0.3, "density": 1}}]},
        "time": {"dt": h, "end": end},
        "loads": [{"type": "force", "nodes": "block.x_max", "direction": [0, 0, 1], "total": True,
                   "history": [[0, 0], [1, 10 * 0.5]]}] if is_bond else [],
        "interfaces": [{"law": law, "parameters": {"friction": 0.3, **(bond if is_bond else {})}, "nodes": "block.z_min",
                        "obstacle": {"type": "plane", "point": [0, 0, 0 if is_bond else -0.013], "normal": [0, 0, 1]}}],
        "output": {"every": 1000000, "watch": ["block"]},
    }  # fmt: skip
    return last_displacements(scene, folder)


def last_displacements(scene, folder):
    (folder / "scene.json").write_text(json.dumps(scene))
    done = subprocess.run([os.environ["ILAW_PROGRAM"], "run", folder / "scene.json", "--out", folder / "ilaw"],
                          text=True, capture_output=True)  # fmt: skip
    assert done.returncode == 0, done.stderr
    with open(folder / "ilaw" / "history.csv") as file:
        last = list(csv.DictReader(file))[-1]
    watched = sum(name.endswith(".u0") for name in last)
    return np.array([[float(last[f"n{i}.u{c}"]) for c in range(3)] for i in range(watched)])


@pytest.mark.parametrize("law", ("coulomb", "rccm"))
def test_it_moves_as_the_same_block_in_ilaw(tmp_path, law):
    h, steps = 0.011, 36
    _, rows = throw(2, tmp_path / "dealii", ["--law", law, "--cells", "6", "--dt", str(h), "--end", str(h * steps)])
    expected = in_ilaw(law, tmp_path, h, h * steps)
    np.testing.assert_allclose(rows[:, 3:6], expected, rtol=0, atol=1e-12)
    assert np.abs(expected).max() > 0.05


def test_a_refused_node_on_one_rank_ends_all(tmp_path):
    """Above the critical step the run diverges, until the law of some rank finds velocities that are not finite."""
    with pytest.raises(AssertionError, match="dealii_throw: .*finite"):
        throw(2, tmp_path, ["--law", "coulomb", "--cells", "2", "--dt", "0.2", "--end", "400"])


def test_the_page_quotes_the_code():
    folder = Path(os.environ["ILAW_SOURCE"]) / "api/dealii"
    quoted = (folder / "README.md").read_text().split("```cpp\n")[1].split("```")[0]
    code = [line.strip() for line in (folder / "plane_contact.hpp").read_text().splitlines()]
    lines = [line.strip() for line in quoted.strip().splitlines()]
    assert any(code[i : i + len(lines)] == lines for i in range(len(code)))


PAIR = {"cells": 5, "step": 0.008, "steps": 44}
UPPER, LOWER = ([0.3173, 0.2291, 0.513], [1.0, 1.0, 0.5], [5, 5, 3]), ([0, 0, 0], [1.7, 1.5, 0.5], [10, 9, 3])


@pytest.fixture(scope="module")
def pairs(tmp_path_factory):
    out, found = tmp_path_factory.mktemp("pairs"), {}
    for ranks in RANKS:
        options = ["--cells", str(PAIR["cells"]), "--dt", str(PAIR["step"]), "--end", str(PAIR["step"] * PAIR["steps"])]
        figures = on_ranks(ranks, "PAIR", [*options, "--out", str(out / f"{ranks}.csv")])
        rows = np.loadtxt(out / f"{ranks}.csv", delimiter=",", skiprows=1)
        upper = rows[:, 2] > 0.51
        found[ranks] = figures, np.concatenate([sorted_rows(rows[~upper]), sorted_rows(rows[upper])])
    return found


@pytest.mark.parametrize("ranks", RANKS)
def test_an_interface_of_two_blocks_does_not_depend_on_ranks(pairs, ranks):
    figures, rows = pairs[ranks]
    assert figures["ranks_of_upper"] >= min(ranks, 2) and figures["ranks_of_lower"] >= min(ranks, 2)  # it is split
    assert figures["identity"] < 1e-14 and figures["momentum"] < 1e-14 and -0.5 < figures["work"] < -0.05
    np.testing.assert_allclose(rows[:, :6], pairs[1][1][:, :6], rtol=0, atol=1e-13)
    np.testing.assert_allclose(rows[:, 6:], pairs[1][1][:, 6:], rtol=0, atol=1e-13 / PAIR["step"])


def test_two_blocks_move_as_in_ilaw(pairs, tmp_path):
    def block(name, where, velocity):
        return {"name": name, "corner": where[0], "size": where[1], "elements": where[2], "velocity": velocity,
                "material": {"type": "linear", "young": 100, "poisson": 0.3, "density": 1}}  # fmt: skip

    scene = {
        "model": {"type": "blocks", "blocks": [block("lower", LOWER, [0, 0, 0]), block("upper", UPPER, [0.5, 0.2, -1])]},
        "time": {"dt": PAIR["step"], "end": PAIR["step"] * PAIR["steps"]},
        "interfaces": [{"law": "coulomb", "parameters": {"friction": 0.3}, "nodes": "upper.z_min",
                        "against": {"surface": "lower.z_max", "discretization": "node_to_facet"}}],
        "output": {"every": 1000000, "watch": ["lower", "upper"]},
    }  # fmt: skip
    expected = last_displacements(scene, tmp_path)
    np.testing.assert_allclose(pairs[1][1][:, 3:6], expected, rtol=0, atol=1e-12)
    assert np.abs(expected).max() > 0.05
