"""The numbers in the page of `ilaw view`, against closed forms and against what the run wrote."""
# SPDX-License-Identifier: BSD-3-Clause

import json
from pathlib import Path

import numpy as np
import pytest
from page import RESTING, TWO_BOXES, Page, box, history, points, run, view

from ilaw._results import Run, read_grid

SOURCE = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def boxes(tmp_path_factory):
    folder = tmp_path_factory.mktemp("boxes")
    results = run(TWO_BOXES, folder)
    done = view(results, "-o", folder / "run.html")
    assert (done.returncode, done.stderr) == (0, "")
    return results, Page(folder / "run.html")


def test_frames_and_bodies_are_those_of_the_run(boxes):
    results, page = boxes
    assert page.frames == len(list(results.glob("fields_*.vtu"))) > 20
    # The surface of a box of 4 x 4 x 2 elements has 64 facets, of 3 x 3 x 3 elements 54.
    assert [(b["name"], b["facets"]) for b in page.film["bodies"]] == [("lower", 64), ("upper", 54)]
    triangles = [page.array(b["triangles"]).reshape(-1, 3) for b in page.film["bodies"]]
    assert [len(t) for t in triangles] == [128, 108]
    assert page.film["nodes"] == 75 - 9 + 64 - 8


def test_surface_is_closed(boxes):
    page = boxes[1]
    x = page.array(page.film["points"]).reshape(-1, 3).astype(float)
    for body, volume in zip(page.film["bodies"], (0.1 * 0.1 * 0.05, 0.05**3)):
        a, b, c = x[page.array(body["triangles"]).reshape(-1, 3)].transpose(1, 0, 2)
        assert abs(np.einsum("ij,ij->", a, np.cross(b, c)) / 6) == pytest.approx(volume, rel=1e-6)


def test_places_are_within_16_bits_of_the_fields(boxes):
    results, page = boxes
    nodes, x = page.array(page.film["modelNodes"]), page.array(page.film["points"]).reshape(-1, 3)
    u = page.channel(page.film["u"], 3)
    for frame in (0, page.frames // 2, page.frames - 1):
        grid = read_grid(results / f"fields_{frame:06}.vtu")
        displacement = grid.nodes["u"][nodes]
        assert np.abs(x - grid.points[nodes]).max() < 1e-7
        assert np.all(np.abs(u[frame] - displacement) <= np.ptp(displacement, axis=0) / 65534 / 2 * 1.01)


def test_arrows_sum_to_the_force_in_the_history(boxes):
    results, page = boxes
    rows, arrows = history(results), page.channel(page.film["forces"]["values"], 3).sum(axis=1)
    for c in range(3):
        # Both sides of the upper interface have arrows; their sum is the force of the floor alone.
        force = rows[f"floor.F{c}"]
        assert np.abs(arrows[1:, c] - force[: page.frames - 1]).max() < 2e-3 * np.abs(rows["floor.F2"]).max()
    assert rows["floor.F2"].max() > 10 and rows["between.F2"].max() > 10


def test_pressure_over_the_face_is_the_force(boxes):
    results, page = boxes
    # Areas of the nodes of a face of 4 x 4 equal facets.
    share = np.array([0.5, 1, 1, 1, 0.5])
    areas = np.outer(share, share).ravel() * (0.1 / 4) ** 2
    force = np.nan_to_num(page.field("pressure", "floor")) @ areas
    rows = history(results)["floor.F2"]
    assert np.abs(force[1:] - rows[: page.frames - 1]).max() < 1e-3 * rows.max()
    # On a surface the normal is the facets' own, which tilt a little.
    share = np.array([0.5, 1, 1, 0.5])
    areas = np.outer(share, share).ravel() * (0.05 / 3) ** 2
    force, rows = np.nan_to_num(page.field("pressure", "between")) @ areas, history(results)["between.F2"]
    assert np.abs(force[1:] - rows[: page.frames - 1]).max() < 0.05 * rows.max()


def test_pressure_on_the_counterpart_is_the_force(boxes):
    results, page = boxes
    # Of the lower box's upper face: in one plane at the start, 4 x 4 equal facets.
    nodes, x = page.array(page.film["modelNodes"]), page.array(page.film["points"]).reshape(-1, 3)
    face = np.flatnonzero((nodes < 75) & (np.abs(x[:, 2] - 0.051) < 1e-6))
    is_inside = (np.abs(x[face, :2] - 0.05) < 0.049).sum(axis=1)
    areas = (0.1 / 4) ** 2 * np.array([0.25, 0.5, 1.0])[is_inside]
    force = np.nan_to_num(page.field("pressure", "all interfaces")[:, face]) @ areas
    rows = history(results)["between.F2"]
    assert np.abs(force[1:] - rows[: page.frames - 1]).max() < 0.05 * rows.max()


def test_pressure_is_the_same_on_both_sides_of_a_patch(tmp_path):
    scene = json.loads((SOURCE / "host_mock/scenes/patch_test.json").read_text())
    scene["output"]["fields"] = 10**9
    results = run(scene, tmp_path)
    assert view(results).returncode == 0
    page = Page(results / "view.html")
    x = page.array(page.film["points"]).reshape(-1, 3)
    pressed = (np.abs(x[:, 2] - 0.5) < 1e-6) & (x[:, 0] < 1.1)
    assert pressed.sum() == 16 + 36
    assert page.field("pressure", "all interfaces")[-1, pressed] == pytest.approx(1000, rel=1e-3)


def test_events_are_grouped_by_step(boxes):
    results, page = boxes
    rows = (results / "events.csv").read_text().splitlines()[1:]
    assert sum(event["count"] for event in page.run["events"]) == len(rows) > len(page.run["events"]) > 3
    assert page.run["events"][0]["event"] == "contact"


def test_curves_keep_their_peaks(boxes):
    results, page = boxes
    force = next(panel for panel in page.run["curves"] if panel["title"] == "force")
    values = {curve["name"]: page.array(curve["values"]) for curve in force["curves"]}
    assert values["floor z"].max() == pytest.approx(history(results)["floor.F2"].max(), rel=1e-6)
    assert "energy" in [panel["title"] for panel in page.run["curves"]]


def test_peaks_of_long_histories_stay(tmp_path):
    wall = {"type": "plane", "point": [0], "normal": [1]}
    bounce = {"law": "contact", "parameters": {"restitution": 1}, "nodes": "all", "obstacle": wall}
    mass = {"mass": 1, "position": [0.1], "velocity": [-1]}
    scene = points(1, [mass], [bounce], time={"dt": 1e-5, "end": 0.2})
    results = run(scene, tmp_path)
    assert view(results).returncode == 0
    page = Page(results / "view.html")
    impulse = next(panel for panel in page.run["curves"] if panel["title"] == "impulse of a step")
    values = page.array(impulse["curves"][0]["values"])
    assert len(values) < 5000
    assert values.max() == pytest.approx(history(results)["n0.r0"].max()) == pytest.approx(2.0)


def test_pressure_of_a_resting_mass_is_its_weight_over_its_area(tmp_path):
    results = run({**RESTING, "output": {"fields": 50}}, tmp_path)
    assert view(results).returncode == 0
    page = Page(results / "view.html")
    assert page.field("pressure", "floor")[-1] == pytest.approx([2 * 10 / 0.5, 3 * 10 / 0.5])
    assert "all interfaces" not in [field["interface"] for field in page.film["fields"]]  # there is one
    assert page.film["forces"]["most"] == pytest.approx(30)


def test_slip_rate_is_relative_to_the_obstacle(tmp_path):
    scene = {**RESTING, "output": {"fields": 50}}
    scene["interfaces"] = [{**RESTING["interfaces"][0], "parameters": {"friction": 0.1}}]
    scene["interfaces"][0]["obstacle"] = {**RESTING["interfaces"][0]["obstacle"], "velocity": [4, 0]}
    results = run(scene, tmp_path)
    assert view(results).returncode == 0
    page = Page(results / "view.html")
    # Friction drags both with 0.1 times 10.
    times = np.array(page.run["times"][1:])
    assert page.field("slip rate", "floor")[1:] == pytest.approx(np.stack([4 - times] * 2, axis=1), abs=2e-3)


@pytest.mark.parametrize(
    "motion",
    [
        {"velocity": [0.1, -0.2, 0.05]},
        {"path": [[0, 0, 0, 0], [0.005, 0, 0, 0.001], [0.01, 0.002, 0, 0.001]]},
        {"path": {"rows": [[0.002, 0, 0, 0], [0.009, 0.004, 0, 0.001]], "smooth": True}},
        {"path": {"sine": {"amplitude": [0, 0, 0.001], "frequency": 100, "phase": 0.5, "mean": [0, 0, -0.001]}}},
        {"tilt": {"axis": [1, 1, 0], "angles": [[0, 0], [0.01, 0.3]]}},
    ],
    ids=["velocity", "rows", "smooth", "sine", "tilt"],
)
@pytest.mark.parametrize("shape", ["plane", "sphere", "cylinder"])
def test_obstacles_are_where_the_host_has_them(tmp_path, motion, shape):
    if "tilt" in motion and shape != "plane":
        return
    obstacle = {"type": shape, **motion}
    obstacle |= {
        "plane": {"point": [0, 0, -0.1], "normal": [0.1, 0, 1]},
        "sphere": {"center": [0, 0, -0.5], "radius": 0.3},
        "cylinder": {"point": [0, 0, -0.5], "axis": [0.2, 1, 0], "radius": 0.3},
    }[shape]
    scene = {"model": {"type": "blocks", "blocks": [box("b", [0, 0, 0], [0, 0, 0], elements=(1, 1, 1))]},
             "time": {"dt": 1e-4, "end": 0.01}, "output": {"fields": 10},
             "interfaces": [{"name": "o", "law": "contact", "nodes": "b", "obstacle": obstacle}]}  # fmt: skip
    results = run(scene, tmp_path)
    read = Run(results)
    times = np.array([time for time, _ in read.field_files()])
    assert len(times) == 11
    found = read.obstacles(times)[0]
    for frame in range(len(times)):
        arm = read_grid(results / f"obstacles_{frame:06}.vtu").points - found["place"][frame]
        along = arm @ np.array(found["axis"][frame])
        if shape == "plane":
            assert np.abs(along).max() < 1e-12
        else:
            across = arm if shape == "sphere" else arm - np.outer(along, found["axis"][frame])
            assert np.linalg.norm(across, axis=1) == pytest.approx(0.3, rel=1e-12)


def test_without_fields_watched_points_move_and_the_key_is_named(tmp_path):
    results = run(RESTING, tmp_path)
    assert view(results).returncode == 0
    page = Page(results / "view.html")
    assert (page.film["nodes"], page.frames) == (1, 300)
    assert page.run["notes"][0].startswith('1 of 2 points are watched and shown; for all, add "fields": 5 ')
    assert page.channel(page.film["forces"]["values"], 3)[-1, 0] == pytest.approx([0, 20, 0])


def test_without_fields_blocks_stand_still_and_the_key_is_named(tmp_path):
    scene = {**TWO_BOXES, "output": {"forces": ["floor"]}}
    results = run(scene, tmp_path)
    assert view(results).returncode == 0
    page = Page(results / "view.html")
    assert [body["name"] for body in page.film["bodies"]] == ["lower", "upper"]
    assert '"fields": ' in page.run["notes"][0] and "at rest" in page.run["notes"][0]


def test_units_of_the_scene_are_on_all_quantities(boxes):
    read = Run(boxes[0])
    assert read.unit_of("force") == ""
    read.scene["units"] = {"length": "mm", "mass": "t", "time": "s"}
    assert [read.unit_of(q) for q in ("force", "stress", "energy", "velocity")] == ["N", "MPa", "mJ", "mm/s"]
    read.scene["units"] = {"length": "um", "mass": "ng", "time": "us"}
    assert read.unit_of("force") == "ng um/us²"


def test_frames_are_left_out_before_nodes(boxes, tmp_path):
    results, whole = boxes
    sizes = {}
    for megabytes in ("0.08", "0.06"):
        assert view(results, "--megabytes", megabytes, "-o", tmp_path / "less.html").returncode == 0
        page = Page(tmp_path / "less.html")
        sizes[megabytes] = page.frames, page.film["nodes"]
        assert page.run["times"][0] == 0 and page.run["times"][-1] == whole.run["times"][-1]
        assert any("--megabytes" in note for note in page.run["notes"])
    assert 20 <= sizes["0.06"][0] < sizes["0.08"][0] < whole.frames
    assert sizes["0.06"][1] == sizes["0.08"][1] == whole.film["nodes"]


def test_thinned_surface_keeps_its_shape():
    from ilaw._results import Body
    from ilaw._surfaces import Surface, edges_of, thinned

    n = 100
    x = np.array([[i, j, 0.0] for j in range(n + 1) for i in range(n + 1)])
    corner = np.array([i + j * (n + 1) for j in range(n) for i in range(n)])
    quads = np.stack([corner, corner + 1, corner + n + 2, corner + n + 1], axis=1)
    surface = Surface(np.arange(len(x)), [quads], edges_of([quads]), np.zeros_like(x))
    less = thinned(surface, x, [Body("plate", 0, len(x))], 0.1)
    assert 0.05 * len(x) < len(less.nodes) < 0.2 * len(x)
    a, b, c = x[less.nodes][less.triangles].transpose(1, 0, 2)
    assert 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() == pytest.approx(n * n, rel=0.08)


def test_what_is_missing_is_said_in_one_line(boxes, tmp_path):
    results = boxes[0]
    done = view(results, ILAW_THREE="/nowhere")
    assert done.returncode == 1 and "apt-get install libjs-three" in done.stderr and done.stderr.count("\n") == 1
    done = view(tmp_path / "nothing")
    assert done.returncode == 2 and "found no such folder" in done.stderr and done.stderr.count("\n") == 1
    done = view(tmp_path)
    assert done.returncode == 2 and "found no summary.json" in done.stderr and done.stderr.count("\n") == 1
    done = view(results, "-o", tmp_path / "nothing" / "run.html")
    assert done.returncode == 1 and "No such file" in done.stderr and done.stderr.count("\n") == 1


def test_a_second_run_removes_the_page_of_the_first(tmp_path):
    results = run(RESTING, tmp_path)
    assert view(results).returncode == 0 and (results / "view.html").is_file()
    run(RESTING, tmp_path)
    assert not (results / "view.html").exists()
