"""The pictures of `ilaw plot`: what is drawn against closed forms, names and units, and files that are whole."""
# SPDX-License-Identifier: BSD-3-Clause

import json
import os
import resource
import subprocess
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from page import PROGRAM, RESTING, RUBBER, points, run

from ilaw import plot as ilaw_plot
from ilaw._curves import curves_of, visible
from ilaw._figure import plt
from ilaw._measured import MEASURED
from ilaw._relations import windowed
from ilaw._results import Run

SOURCE = Path(__file__).resolve().parents[2]
FLOOR = {"type": "plane", "point": [0, 0], "normal": [0, 1]}
GRAVITY = {"type": "gravity", "acceleration": [0, -10]}


def plot(*arguments, **options):
    return subprocess.run([PROGRAM, "plot", *arguments], capture_output=True, text=True, **options)


def shipped(name, folder, **changes):
    file = next(f for place in ("plugins/*", "host_mock/scenes") for f in SOURCE.glob(f"{place}/{name}.json"))
    return run({**json.loads(file.read_text()), "expect": [], **changes}, folder)


def sliding(**more):
    interface = {"name": "floor", "law": "coulomb", "parameters": {"friction": 0.5}, "nodes": "all", "obstacle": FLOOR}
    scene = points(2, [{"mass": 2, "position": [0, 0], "velocity": [2, 0]}], [interface], loads=[GRAVITY], **more)
    scene["output"] = {"watch": [0], "forces": ["floor"], "balance": True}
    return scene


def drawn(results, name):
    """The axes of a panel of this name."""
    panels = ilaw_plot.panels_of(ilaw_plot.History(results))
    axes = plt.figure().add_subplot()
    next(panel for panel in panels if panel.name == name).draw(axes)
    return axes


def names_of(results):
    return [panel.name for panel in ilaw_plot.panels_of(ilaw_plot.History(results))]


def test_quantities_units_and_names_of_the_scene_are_on_the_axes(tmp_path):
    scene = sliding(units={"length": "mm", "mass": "t", "time": "s"}, sets={"block": [0]}, title="'A < B' & $C$")
    scene["output"]["watch"] = ["block"]
    results = run(scene, tmp_path)
    done = plot(results)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.splitlines()[-2:] == [str(results / "history.png"), str(results / "history.svg")]
    text = (results / "history.svg").read_text()
    units = ("velocity (mm/s)", "force (N)", "energy (mJ)", "time (s)")
    for label in (*units, "block", "floor", "start + loads", "A &lt; B"):
        assert label in text.replace("\xa0", " "), label
    assert (results / "history.png").read_bytes()[1:4] == b"PNG"


def test_pressure_of_a_point_without_an_area_is_no_mistake(tmp_path):
    scene = sliding()
    scene["model"]["points"][0]["area"], scene["output"] = 0, {"watch": [0], "contact": True}
    results = run(scene, tmp_path)
    assert not np.isfinite(Run(results).history(lambda name: name == "n0.pressure")[1][-1, 0])
    assert plot(results).returncode == 0


def test_rounding_is_left_out_and_said(tmp_path):
    results = run(sliding(), tmp_path)
    read = Run(results)
    names, rows = read.history()
    rows[:, names.index("n0.u1")] = 1e-13 * rows[-1, names.index("n0.u0")]
    shown, rounding = visible(curves_of(read, names), rows)
    assert [c.column for c in rounding] == ["n0.u1", "balance.error"]
    assert {"n0.u0", "floor.F0"} <= {c.column for c in shown}
    assert "n0.v1" not in {c.column for c in shown}  # it is zero
    assert "Not drawn, since below 1e-12 of its scale: balance.error" in plot(results).stdout


def test_pull_of_the_window_breaks_the_bond_where_it_reaches_the_adhesion(tmp_path):
    axes = drawn(shipped("postit_test3", tmp_path), "adhesion")
    R, S = (line.get_xydata() for line in axes.lines)
    # The triangular pull of peak 4 within 0.4 s: its largest sum over 0.08 s; rupture at 1.665 (the scene's doc).
    triangle = S[(S[:, 0] > 0.3) & (S[:, 0] < 0.8)]
    assert triangle[:, 1].max() == pytest.approx(0.288, rel=1e-2)
    assert S[S[:, 0] > 1.5][:, 1].max() == pytest.approx(0.4, rel=0.02)
    assert R[R[:, 0] > 1.67][:, 1].max() == 0.0
    assert [t.get_text() for t in axes.legend().get_texts()] == ["$R_Y$", "pull $S$"]


def test_work_of_separation_is_the_toughness(tmp_path):
    x, y = drawn(shipped("cohesive_pull", tmp_path), "traction over separation").lines[0].get_xydata().T
    pulls = np.clip(y, 0.0, None)
    assert pulls.max() == pytest.approx(10.0, rel=1e-2)  # strength
    assert np.trapz(pulls, x) == pytest.approx(0.5, rel=2e-2)  # toughness


def test_force_over_displacement_of_what_is_driven(tmp_path):
    scene = sliding()
    scene["model"]["points"][0]["velocity"] = [0, 0]
    scene["interfaces"][0]["obstacle"] = {**FLOOR, "velocity": [20, 0]}
    axes = drawn(run(scene, tmp_path), "force over displacement")
    x, y = axes.lines[0].get_xydata().T
    assert axes.get_xlabel() == "displacement of floor" and x[-1] == pytest.approx(20 * 0.5)
    assert y[1:] == pytest.approx(0.5 * 20 * np.ones(len(y) - 1))  # friction of the weight
    assert "force over displacement" not in names_of(run(sliding(), tmp_path))


def test_friction_over_slip_rate_is_the_curve_of_the_law(tmp_path):
    scene = sliding()
    scene["interfaces"][0]["parameters"] = {"friction": 0.5, "kinetic_friction": 0.2, "decay": 3.0}
    scene["time"]["end"] = 0.7
    axes = drawn(run(scene, tmp_path), "friction over slip rate")
    rate, friction = axes.lines[0].get_xydata().T
    assert axes.get_xscale() == "log" and rate.max() > 3 * rate.min()
    # The coefficient follows the slip speed before the step.
    assert friction[1:] == pytest.approx(0.2 + 0.3 * np.exp(-3.0 * rate[:-1]), abs=1e-9)


def test_pressure_along_a_line_is_the_load(tmp_path):
    body = {"name": "pad", "size": [0.1, 0.1, 0.05], "elements": [4, 4, 2], "material": {**RUBBER, "poisson": 0.0}}
    scene = {
        "model": {"type": "blocks", "blocks": [body]}, "time": {"cfl": 0.7, "end": 0.05},
        "loads": [{"type": "pressure", "surface": "pad.z_max", "history": [[0, 1000.0]]},
                  {"type": "damping", "rate": 400}],
        "interfaces": [{"name": "floor", "law": "contact", "nodes": "pad.z_min",
                        "obstacle": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}],
        "output": {"watch": [0], "fields": 20},
    }  # fmt: skip
    lines = drawn(run(scene, tmp_path), "pressure along a line").lines
    assert lines[-1].get_xdata() == pytest.approx([0, 0.025, 0.05, 0.075, 0.1])
    assert lines[-1].get_ydata() == pytest.approx(1000 * np.ones(5), rel=0.02)


def test_stacked_energies_reach_what_was_put_in(tmp_path):
    axes = drawn(run(sliding(), tmp_path), "energy")
    top = axes.collections[-1].get_paths()[0].vertices[:, 1].max()
    assert [c.get_label() for c in axes.collections] == ["kinetic", "friction"]
    assert top == pytest.approx(4.0, rel=0.01) and axes.lines[-1].get_ydata().max() == pytest.approx(4.0, rel=0.01)


def test_rare_status_lies_on_top_and_ruptures_between_rows_are_drawn(tmp_path):
    results = run(sliding(), tmp_path)
    (results / "history.csv").write_text(
        "time,n0.u0,n0.status\n" + "".join(f"{0.1 * k:.1f},{k},{2 if k == 3 else 3}\n" for k in range(9))
    )
    axes = drawn(results, "status")
    bands = axes.collections[0]
    assert bands.get_segments()[-1][:, 0] == pytest.approx([0.3, 0.4])
    assert plt.matplotlib.colors.to_hex(bands.get_colors()[-1]) == "#0072b2"
    (results / "events.csv").write_text("time,node,interface,event,r0\n0.17,0,floor,rupture,0\n")
    axes = drawn(results, "status")
    assert axes.lines[0].get_xydata().tolist() == [[0.17, 0]]
    assert [line.get_label() for line in axes.lines[1:]] == ["stick", "slip", "broken"]


def test_several_runs_have_a_legend_of_what_differs(tmp_path):
    for friction in (0.1, 0.4):
        scene = sliding()
        scene["interfaces"][0]["parameters"]["friction"] = friction
        (tmp_path / str(friction)).mkdir()
        run(scene, tmp_path / str(friction))
    folders = sorted(tmp_path.glob("*/results"))
    assert f"{folders[0].parent}: found folders of runs, expected one" in plot(folders[0].parent).stderr
    assert plot(*folders).returncode == 0
    text = (folders[0].parent / "comparison.svg").read_text()
    assert "friction=0.1" in text and "friction=0.4" in text
    assert plot(folders[0], "--x", "n0.u0", "--y", "floor.F0").returncode == 0
    text = (folders[0] / "floor.F0_over_n0.u0.svg").read_text()
    assert "force floor x" in text and "displacement node 0 x" in text


def test_a_legend_names_up_to_three_differences():
    def legends(keys):
        runs = [SimpleNamespace(scene=dict.fromkeys(keys, value), folder=Path(f"run{value}")) for value in (1, 2)]
        return ilaw_plot.legends_of([SimpleNamespace(run=one) for one in runs])

    assert legends("abc") == ["a=1 b=1 c=1", "a=2 b=2 c=2"]
    assert legends("abcd") == legends("") == ["run1", "run2"]


@pytest.mark.parametrize(
    "arguments, said",
    [
        (["nowhere"], "nowhere: found no such folder, expected a folder that `ilaw run SCENE --out DIR` wrote"),
        (["results", "--panels", "velocty"], "--panels: found 'velocty', expected some of displacement, velocity"),
        (["results", "--panels", "velocty"], "(did you mean 'velocity'?)"),
        (["results", "--y", "floor.F2"], "found no column 'floor.F2', expected one of time, n0.u0, "),
        (["results", "results", "--panels", "velocity"], "--panels: found with several folders or --x"),
        (["results", "--out", "nowhere"], "--out nowhere: found no such folder"),
        (["scene.json", "scene.json"], "found files alone"),
    ],
)
def test_mistakes_are_told(tmp_path, arguments, said):
    run(sliding(), tmp_path)
    done = plot(*arguments, cwd=tmp_path)
    assert done.returncode == 2 and said in done.stderr, done.stderr
    assert not list(tmp_path.glob("**/*.png"))


def test_a_run_that_was_killed_is_named(tmp_path):
    history = run(sliding(), tmp_path) / "history.csv"
    history.rename(history.with_name("history.csv.partial"))
    done = plot(history.parent)
    assert done.returncode == 2 and "of a run that has not ended" in done.stderr, done.stderr


def test_pictures_are_whole_and_replace_links(tmp_path):
    results = run(sliding(), tmp_path)
    (tmp_path / "precious").write_text("precious")
    (results / "history.png").symlink_to(tmp_path / "precious")
    limit = ["bash", "-c", 'ulimit -f 8; exec "$0" plot "$1"', PROGRAM, results]  # 8 KiB
    full = subprocess.run(limit, capture_output=True, text=True)
    assert full.returncode == 1 and "File too large" in full.stderr
    assert sorted(f.name for f in results.iterdir()) == ["history.csv", "history.png", "summary.json"]
    assert plot(results).returncode == 0
    assert (tmp_path / "precious").read_text() == "precious"
    assert (results / "history.png").read_bytes()[1:4] == b"PNG" and not (results / "history.png").is_symlink()


def test_long_histories_are_drawn_in_seconds(tmp_path):
    results = shipped("postit_test3", tmp_path, time={"dt": 1.8 / 120000, "end": 1.8})
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert plot(results).returncode == 0
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime < 5.0
    assert (results / "history.svg").stat().st_size < 2e6


def test_measured_errors_and_times_are_drawn(tmp_path):
    ball = SOURCE / "plugins/contact/bouncing_ball.json"
    bench = ["bench", "contact", "--nodes", "20,30", "--repetitions", "1"]
    for command in (["converge", ball, "--levels", "3"], bench):
        folder = tmp_path / "all" / command[0]
        done = subprocess.run([PROGRAM, *command, "--out", folder], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        assert not list(folder.glob("*.png")), "measuring needs no matplotlib"
        assert plot(folder).returncode == 0
        assert (folder / f"{command[0]}.png").is_file() and (folder / f"{command[0]}.svg").is_file()
    for asked in ([tmp_path / "all"], sorted((tmp_path / "all").iterdir())):
        for picture in tmp_path.glob("all/*/*.png"):
            picture.unlink()
        assert plot(*asked).returncode == 0
        assert len(list(tmp_path.glob("all/*/*.png"))) == 2
    several = plot(tmp_path / "all", "--out", tmp_path)
    assert several.returncode == 2 and "--out: found with 2 folders" in several.stderr
    bars = MEASURED["bench"](tmp_path / "all/bench")
    assert [axes.get_title() for axes in bars.axes] == ["20 nodes", "30 nodes"]
    assert [len(axes.patches) for axes in bars.axes] == [1, 1]
    errors = MEASURED["converge"](tmp_path / "all/converge").axes[0]
    assert errors.get_xscale() == errors.get_yscale() == "log"
    (tmp_path / "study.csv").write_text(
        "law,dt,steps,seconds,penetration,u_L2,u_max,v_L1,instant,impulse,energy\n"
        "contact,0.1,10,1,0,0.1,0.1,0.1,0.1,,0\ncontact,0.05,20,2,0,0.05,0.1,0.1,0.1,,0\n"
        "penalty,0.1,10,1,0,0.4,0.1,0.1,0.1,,0\n"
    )
    study = MEASURED["study"](tmp_path)
    assert [axes.get_title(loc="left") for axes in study.axes] == [
        "error of the displacement", "error of the displacement over run time"]  # fmt: skip
    assert study.axes[1].lines[0].get_xdata().tolist() == [0.5, 1.0]
