"""Fields, read back with VTK, hold what the rows of the history and closed forms say."""
# SPDX-License-Identifier: BSD-3-Clause

import json
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from page import PROGRAM, points, run
from vtkmodules.util.numpy_support import vtk_to_numpy

from ilaw._results import Run, read_grid

SOURCE = Path(__file__).resolve().parents[2]
VERTEX, LINE, HEXAHEDRON = 1, 3, 12
FLOOR = {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}
LINE_BELOW = {"type": "plane", "point": [0, 0], "normal": [0, 1]}


def shipped(name, **changes):
    file = next(file for place in ("plugins", "host_mock/scenes") for file in (SOURCE / place).rglob(f"{name}.json"))
    scene = json.loads(file.read_text())
    return {**{key: scene[key] for key in ("model", "time", "loads", "interfaces") if key in scene}, **changes}


def drawn_along():
    """A point that is drawn along by 0.002, below its limit of friction: a spring that is a vector of the state."""
    law = {"stiffness": 1e4, "friction": 0.5, "tangential_stiffness": 1e3, "integration": "implicit"}
    return points(2, [{"mass": 1, "position": [0, 0]}], [
        {"law": "penalty", "parameters": law, "nodes": "all", "obstacle": LINE_BELOW}],
        time={"dt": 1e-3, "end": 0.1}, loads=[{"type": "gravity", "acceleration": [1, -10]}])  # fmt: skip


def warmed():
    """Points that friction heats."""
    thermal = {"specific_heat": 5, "initial_temperature": 290}
    masses = [{"mass": 2, "position": [k, 0], "velocity": [4, 0], "thermal": thermal} for k in range(2)]
    law = {"friction": 0.3, "heat_partition": 0.25}
    rubs = {"law": "coulomb", "nodes": "all", "parameters": law, "obstacle": LINE_BELOW}
    return points(2, masses, [rubs], loads=[{"type": "gravity", "acceleration": [0, -10]}])


def peeled():
    scene = shipped("postit_3d")
    scene["model"]["blocks"][0]["elements"] = [20, 2, 2]
    return scene


def lowest(x):
    return np.flatnonzero(x[:, 2] == x[:, 2].min())


# Scene, steps between two files, dimension, cells, and the nodes of each interface.
SCENES = {
    "peeled": (peeled, 20, 3, (80, HEXAHEDRON), {"interface0": lowest}),
    "block_impact": (lambda: shipped("block_impact"), 40, 3, (512, HEXAHEDRON),
                     {"floor": lambda x: np.arange(len(x)),
                      "ball": lambda x: np.flatnonzero(np.isclose(x[:, 0], 0.1))}),
    "two_bars": (lambda: shipped("two_bars"), 100, 1, (300, LINE), {"interface0": lambda x: np.array([101])}),
    "drawn_along": (drawn_along, 10, 2, (1, VERTEX), {"interface0": lambda x: np.array([0])}),
    "warmed": (warmed, 50, 2, (2, VERTEX), {"interface0": lambda x: np.array([0, 1])}),
}  # fmt: skip


@pytest.mark.parametrize("name", SCENES)
def test_fields_are_those_of_the_history(tmp_path, name):
    make, every, d, cells, members = SCENES[name]
    scene = {**make(), "output": {"every": every, "fields": every, "watch": ["all"], "contact": True}}
    read = Run(run(scene, tmp_path))
    names, rows = read.history()
    columns = dict(zip(names, rows.T))
    files = read.field_files()
    assert [time for time, _ in files] == pytest.approx([0, *columns["time"]], abs=1e-15) and len(files) > 5
    x = read_grid(files[0][1]).points
    seen = set()
    for row, (_, file) in enumerate(files[1:]):
        grid = read_grid(file)
        assert (grid.points == x).all()
        assert (grid.data.GetNumberOfCells(), grid.data.GetCellType(0)) == cells
        touched = np.zeros(len(x), bool)
        for interface, nodes in members.items():
            own = nodes(x)
            touched[own] = True
            prefix = f"{interface}." if len(members) > 1 else ""
            outside = np.setdiff1d(np.arange(len(x)), own)
            for quantity in ("gap", "status", "adhesion", "ruptures", "spring"):
                if prefix + quantity not in grid.nodes:
                    assert f"n{own[0]}.{quantity}" not in columns and f"n{own[0]}.{quantity}0" not in columns
                    continue
                values = grid.nodes[prefix + quantity].reshape(len(x), -1)
                assert np.all(values[outside] == -1) if quantity == "status" else np.isnan(values[outside]).all()
                for c in range(1 if values.shape[1] == 1 else d):
                    at = f"{quantity}{c if values.shape[1] > 1 else ''}"
                    none = np.zeros(len(rows)) if c else None  # of a tangential vector in 2D there is one component
                    wanted = [columns.get(f"n{n}.{interface}.{at}", columns.get(f"n{n}.{at}", none))[row] for n in own]
                    assert values[own, c].tolist() == wanted, (file.name, at)
                    seen |= {(quantity, value) for value in wanted} | {quantity}
            traction = grid.nodes[prefix + "traction"]
            assert np.isnan(traction[outside]).all()
            if interface == "interface0" and d == 3:
                assert traction[own, 2] == pytest.approx([columns[f"n{n}.pressure"][row] for n in own], rel=1e-12)
        for field in ("u", "v", "r"):
            # A driven node has the impulse of its holder in the history.
            own = np.flatnonzero(touched) if field == "r" else range(len(x))
            wanted = [[columns[f"n{n}.{field}{c}"][row] for c in range(d)] + [0] * (3 - d) for n in own]
            assert grid.nodes[field][own].tolist() == wanted, (file.name, field)
        if "n0.T" in columns:
            assert grid.nodes["temperature"].tolist() == [columns[f"n{n}.T"][row] for n in range(len(x))]
    expected = {"peeled": {("status", 4), ("status", 5), ("ruptures", 1)}, "drawn_along": {"spring"}}
    assert expected.get(name, set()) <= seen


def test_traction_is_over_an_overlap_that_has_changed(tmp_path):
    elastic = {"type": "linear", "young": 1e6, "poisson": 0, "density": 1000}
    low = {"name": "a", "size": [1.1, 1, 0.5], "elements": [3, 3, 1], "material": elastic}
    high = {"name": "b", "corner": [0.25, 0, 0.5], "size": [1, 1, 0.5], "elements": [4, 4, 1], "velocity": [5, 0, -1]}
    scene = {"model": {"type": "blocks", "blocks": [low, {**high, "material": elastic}]}, "time": {"cfl": 0.9, "end": 0.03},
             "loads": [{"type": "motion", "nodes": "a"}],
             "interfaces": [{"law": "contact", "nodes": "b.z_min", "against": {"surface": "a.z_max"}}],
             "output": {"watch": ["b.z_min"], "every": 5, "fields": 5, "contact": True}}  # fmt: skip
    read = Run(run(scene, tmp_path))
    names, rows = read.history()
    own = range(32, 57)
    pressure = np.array([rows[:, names.index(f"n{n}.pressure")] for n in own]).T
    found = [read_grid(file).nodes["traction"][own, 2] for _, file in read.field_files()[1:]]
    assert np.array(found) == pytest.approx(pressure, rel=1e-12) and (pressure > 0).any()


def test_mesh_and_obstacles_are_those_of_the_scene(tmp_path):
    read = Run(run({**shipped("block_impact"), "output": {"fields": 50}}, tmp_path))
    grid = read_grid(read.field_files()[0][1])
    place = np.linspace(0, 0.1, 9)
    lattice = np.array([[x, y, z + 0.02] for z in place for y in place for x in place])
    assert np.abs(grid.points - lattice).max() < 1e-15
    # VTK's order: 0 1 3 4 are a corner and its neighbors along the three axes.
    corners = grid.points[vtk_to_numpy(grid.data.GetCells().GetConnectivityArray()).reshape(-1, 8)]
    x, y, z = (corners[:, k] - corners[:, 0] for k in (1, 3, 4))
    assert np.abs(corners[:, 6] - corners[:, 0] - x - y - z).max() < 1e-15
    assert np.abs(corners[:, 2] - corners[:, 0] - x - y).max() < 1e-15
    assert np.einsum("ij,ij->", np.cross(x, y), z) == pytest.approx(1e-3, rel=1e-12)
    # Center (0.215, 0.05, 0.08), radius 0.1, from the corner (0.1, 0, 0.02).
    assert grid.nodes["ball.gap"][8] == pytest.approx(np.hypot(np.hypot(0.115, 0.05), 0.06) - 0.1, abs=1e-15)
    # Obstacles that stand still are written once, as facets on their surfaces.
    series = json.loads((read.folder / "obstacles.vtu.series").read_text())["files"]
    obstacles = read_grid(read.folder / series[0]["name"])
    facets = obstacles.points[vtk_to_numpy(obstacles.data.GetCells().GetConnectivityArray()).reshape(-1, 4)]
    of_ball = obstacles.cells["interface"] == 1
    assert len(series) == 1 and (~of_ball).sum() == 1 and of_ball.sum() > 100
    assert (facets[~of_ball][..., 2] == 0).all()
    assert np.linalg.norm(facets[of_ball] - [0.215, 0.05, 0.08], axis=-1) == pytest.approx(0.1, abs=1e-12)


def test_stress_is_that_of_the_strain(tmp_path):
    """Hooke's law at the start, in ParaView's order; a bar has its tension alone."""
    gradient = 1e-3 * np.array([[1, 2, 3], [0.5, -2, 4], [0.25, 0.125, 3]])
    body = {"size": [0.2, 0.1, 0.3], "elements": [2, 1, 3],
            "material": {"type": "linear", "young": 2e6, "poisson": 0.3, "density": 1000}}  # fmt: skip
    block = {"model": {"type": "blocks", "blocks": [body]}, "initial": [{"gradient": gradient.tolist()}]}
    mu, lame = 2e6 / 2.6, 2e6 * 0.3 / (1.3 * 0.4)
    s = mu * (gradient + gradient.T) + lame * np.trace(gradient) * np.eye(3)
    rod = {"length": 2, "elements": 4, "young": 3e6, "density": 1, "section": 0.5}
    bar = {"model": {"type": "bars", "bars": [rod]}, "initial": [{"gradient": [[0.005]]}]}
    for scene, wanted in ((block, s), (bar, np.diag([15000, 0, 0]))):
        scene |= {"time": {"cfl": 0.5, "end": 1e-3}, "interfaces": [], "output": {"fields": 1}}
        grid = read_grid(run(scene, tmp_path) / "fields_000000.vtu")
        order = [wanted[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))]
        assert grid.cells["stress"] == pytest.approx(np.tile(order, (grid.data.GetNumberOfCells(), 1)), abs=1e-8)
        a, b, c, *shears = order  # von Mises 1913
        mises = np.sqrt(0.5 * ((a - b) ** 2 + (b - c) ** 2 + (c - a) ** 2) + 3 * np.sum(np.square(shears)))
        assert grid.cells["von_mises"] == pytest.approx(mises, rel=1e-12)


@pytest.mark.parametrize("law, height, more, status", [
    ({"law": "tie"}, 0, {}, 4), ({"law": "contact"}, 0.1, {}, 0),
    ({"law": "cohesive", "parameters": {"strength": 1, "toughness": 1}}, 0, {}, 4),
    ({"law": "cohesive", "parameters": {"strength": 1, "toughness": 1}}, 0, {"birth": 0.05}, 0),
    ({"law": "penalty", "parameters": {"stiffness": 10}}, -0.1, {}, 1),
    ({"law": "postit", "parameters": {"initial_adhesion": 2, "memory": 0.01}}, 0, {}, 4)])  # fmt: skip
def test_status_at_the_start_is_what_the_law_says_of_it(tmp_path, law, height, more, status):
    scene = points(3, [{"mass": 1, "position": [0, 0, height]}], [{**law, **more, "nodes": "all", "obstacle": FLOOR}])
    scene["output"] = {"fields": 10**6}
    assert read_grid(run(scene, tmp_path) / "fields_000000.vtu").nodes["status"].tolist() == [status]


def test_state_of_a_run_that_diverged_is_written_and_named(tmp_path):
    """A rubber block that is thrown too hard for its step is turned inside out; the next run removes that file."""
    body = {"name": "b", "size": [0.1, 0.1, 0.1], "elements": [2, 2, 2],
            "material": {"type": "neo_hookean", "young": 1e6, "poisson": 0.3, "density": 1000}}  # fmt: skip
    scene = {"model": {"type": "blocks", "blocks": [body]}, "time": {"cfl": 0.9, "end": 0.1},
             "interfaces": [{"law": "contact", "nodes": "b.z_min", "obstacle": FLOOR}]}  # fmt: skip
    body["velocity"] = [0, 0, -60]
    (tmp_path / "scene.json").write_text(json.dumps(scene))
    command = [PROGRAM, "run", tmp_path / "scene.json", "--out", tmp_path / "results"]
    done = subprocess.run(command, capture_output=True, text=True)
    file = tmp_path / "results/diverged.vtu"
    said = re.search(r"; element (\d+).* of the undeformed body, is turned inside out; half the step is \"cfl\": 0.45",
                     done.stderr)
    assert done.returncode == 1 and said and f"; that state is in {file}" in done.stderr, done.stderr
    assert read_grid(file).cells["inverted"][int(said[1])] == 1
    body["velocity"], scene["time"]["end"] = [0, 0, -1], 1e-3
    run(scene, tmp_path)
    assert not file.exists()
