"""`ilaw converge` and `ilaw study`: norms, orders and costs on motions made by hand, laws, and scenes with known answers."""
# SPDX-License-Identifier: BSD-3-Clause
import copy
import csv
import json
import math
import os
import subprocess
import sys
import threading
import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from ilaw import converge, study
from ilaw._command import BadInput
from ilaw._errors import NO_ERRORS, NORMS, ROUNDING, Trace, errors_against_exact, errors_against_run, order_of
from ilaw._exact import Exact, exact_solution
from ilaw._results import Run
from ilaw._variants import Scenes, exact_of, steps_of
from ilaw._variants import trace_of as trace_of_run
from ilaw.study import MeasuredRun, cost_of, largest_stable_part, with_law

SOURCE = Path(__file__).parents[2]
SCENES = {file.stem: file for place in ("host_mock/scenes", "plugins", "docs/results/scenes")
          for file in (SOURCE / place).rglob("*.json")}  # fmt: skip
NONE = math.nan


def shipped(name):
    return json.loads(SCENES[name].read_text())


# ---- norms, on motions made by hand -----------------------------------------------------------------------------------


def bounce(instant):
    """A point that comes at speed 1, meets something at an instant, and goes back at speed 1."""
    return Exact(lambda t: np.where(t < instant, t, 2 * instant - t)[:, None],
                 lambda t: np.where(t < instant, 1.0, -1.0)[:, None], np.array([[instant, NONE, NONE]]))  # fmt: skip


def trace_of(motion, dt, steps):
    time = dt * np.arange(1, steps + 1)
    u, v = motion.u(time), motion.v(time + 0.5 * dt)
    return Trace(dt, 0.0, 0.0, 1.0, u, v, v - 1.0, np.zeros(steps), motion.instants)


def test_norms_of_a_jump_displaced_by_one_step_are_of_first_order():
    """One velocity of N is wrong, by 2 if the mean is 1, and positions after it by 2 h if the largest is 0.5."""
    counts = [50 * 2**k for k in range(5)]
    found = [errors_against_exact(bounce(0.5), trace_of(bounce(0.5 + 1 / n), 1 / n, n)) for n in counts]
    for n, errors in zip(counts, found):
        h = 1 / n
        assert errors["v_L1"] == pytest.approx(2 * h, abs=1e-12)
        assert errors["u_max"] == pytest.approx(4 * h, abs=1e-12)
        assert errors["instant"] == pytest.approx(h, abs=1e-15)
        # Half of the errors are 2 h; the mean square of the motion is 1/12.
        assert errors["u_L2"] == pytest.approx(math.sqrt(0.5) * 2 * h / math.sqrt(1 / 12), abs=30 * h**2)
        assert math.isnan(errors["impulse"]) and math.isnan(errors["energy"]), "no solution tells them"
    for norm in NORMS[:4]:
        assert order_of([1 / n for n in counts], [errors[norm] for errors in found]) == pytest.approx(1, abs=0.05)


def test_norms_against_a_finer_run_of_the_same_motion():
    """Positions are linear between its instants."""
    h = 1e-2
    same = errors_against_run(trace_of(bounce(0.505), h / 8, 800), trace_of(bounce(0.505), h, 99))
    assert same["u_L2"] <= 1e-14 and same["u_max"] <= 1e-14 and same["instant"] == 0
    assert same["v_L1"] <= 2 / 99 * 1.001, "the jump falls on an instant of the half steps"
    late = errors_against_run(trace_of(bounce(0.505), h / 8, 800), trace_of(bounce(0.515), h, 99))
    assert late["u_max"] == pytest.approx(4 * h, abs=1e-12) and late["instant"] == pytest.approx(h, abs=1e-15)


def test_instant_is_the_farthest_off_of_those_that_both_have():
    trace = trace_of(bounce(0.5), 1e-2, 100)._replace(instants=np.array([[0.51, NONE, 0.7]]))
    for instants, wanted in (([0.5, 0.6, 0.75], 0.05), ([NONE, 0.6, NONE], NONE)):
        exact = bounce(0.5)._replace(instants=np.array([instants]))
        assert errors_against_exact(exact, trace)["instant"] == pytest.approx(wanted, abs=1e-15, nan_ok=True)


def test_order_is_the_slope_of_what_is_above_rounding():
    steps = [1.0, 0.5, 0.2, 0.1]
    assert order_of(steps, [3 * h**1.7 for h in steps]) == pytest.approx(1.7, abs=1e-13)
    # Errors 1, 1, 1/4 at steps 1, 1/2, 1/4: slopes 0 and 2, least squares the mean.
    assert order_of([1, 0.5, 0.25], [1, 1, 0.25]) == pytest.approx(1, abs=1e-13)
    h, r = [1, 0.5, 0.25, 0.125, 0.0625], 0.5 * ROUNDING
    assert order_of(h, [0.4, r, 0.1, 0, 0.025]) == pytest.approx(1, abs=1e-13)
    # Relative to the quantity: instants near 1e6 are not known to 1e-9.
    assert order_of(h, [0.4, 0.2, 0.1, 1e-9, 1e-9], 1e6) == pytest.approx(1, abs=1e-13)
    assert order_of(h, [0.4, 0.2, 0.1, 1e-9, 1e-9]) > 5
    for errors in ([0.4, 0.2, r, 0, r], [r] * 5, [0.4, 0.2, 0.1, NONE, 0.025]):  # two make no order
        assert math.isnan(order_of(h, errors)), errors


def test_orders_of_a_table_scale_instants_by_the_run():
    """Instants of a run of 1e6 s are at rounding level below 1e-5 s; other errors are relative."""
    traces = [trace_of(bounce(1.0), 1e3 / 2**k, 1000 * 2**k) for k in range(5)]
    orders = converge.orders_of(traces, [dict.fromkeys(NORMS, e) for e in (0.4, 0.2, 0.1, 1e-9, 1e-9)])
    assert orders.pop("instant") == pytest.approx(1, abs=1e-12)
    assert min(orders.values()) > 5


# ---- closed forms -----------------------------------------------------------------------------------------------------


def test_exact_postit_counts_presses_within_its_memory():
    """A pull has to make up for the presses within the memory of 0.1.

    A press of 0.2 at 0.25, then a pull of 2.01 from 0.3 on: the press leaves the window at 0.35, and 0.2 are passed
    0.2/2.01 after the pull began. A pull of 1.9 never fills the window with more than 0.19.
    """
    scene = shipped("postit_test3")
    scene["interfaces"][0]["parameters"]["memory"] = 0.1
    for pull, breaks in ((2.01, 0.3 + 0.2 / 2.01), (1.9, NONE)):
        scene["loads"] = [{"type": "shock", "nodes": [0], "time": 0.25, "impulse": [-0.2]},
                          {"type": "force", "nodes": [0], "direction": [1.0],
                           "history": [[0.0, 0.0], [0.3, 0.0], [0.3000001, pull]]}]  # fmt: skip
        instants = exact_solution(scene, 1, 1800, 1e-3).instants
        assert instants[0, 2] == pytest.approx(breaks, abs=1e-6, nan_ok=True)


def test_last_impulses_of_balls_and_oscillators():
    """The last bounce before the end, or the end itself for a ball that rests; arcs of the oscillator likewise."""
    fall = math.sqrt(2 / 9.81)
    for restitution, end, last in ((0.8, 5.0, 5.0), (0.8, 1.5, fall * (1 + 2 * 0.8)), (1.0, 5.0, 11 * fall)):
        instants = exact_solution(ball(restitution), 1, round(end / 1e-2), 1e-2).instants[0]
        assert instants[:2] == pytest.approx([fall, last], abs=1e-12), (restitution, end)
    oscillator = shipped("impact_oscillator")
    first, last, _ = exact_solution(oscillator, 1, 4000, 5e-4).instants[0]
    away = [exact_solution(oscillator, 1, 4000, 5e-4).v(np.array([last + s * 1e-9]))[0, 0] for s in (-1, 1)]
    assert first == pytest.approx(math.pi / 60) and away[0] < 0 < away[1] == pytest.approx(-0.8 * away[0])


def test_the_held_end_of_a_rod_is_named_in_any_way():
    for nodes in ("rod.right", [100], 100, {"near": [1.0]}, {"near": [[0.996]]}, {"box": [[0.995], [1.5]]}, "far"):
        scene = shipped("held_rod")
        scene["sets"], scene["loads"][0]["nodes"] = {"far": {"near": [2.0]}}, nodes
        assert exact_solution(scene, 1, 1000, 9e-3), nodes
    for nodes in ("rod.left", [99, 100], {"near": [0.99]}, {"box": [[0.985], [1.0]]}, {"near": [[0.0], [1.0]]}):
        scene["loads"][0]["nodes"] = nodes
        with pytest.raises(BadInput):
            exact_solution(scene, 1, 1000, 9e-3)


@pytest.mark.parametrize("name", ["bouncing_bar", "held_rod"])
def test_bars_converge_to_closed_forms(name):
    """Meshes and steps without a common factor.

    At the critical step waves are exact, and what the end's own mass costs at each impact and release is of first
    order. Below it fronts are smeared over h^(2/3), which is the order of positions; velocities ring, h^(1/2).
    """
    def errors_of(elements, cfl):
        scene = shipped(name)
        scene["model"]["bars"][0]["elements"], scene["time"]["cfl"] = elements, cfl
        with Scenes(SCENES[name], 1) as scenes:
            probe = scenes.probe(scene)
            return errors_against_exact(exact_of(scene, probe), scenes.trace(scene, probe.interfaces))

    for elements in (37, 64, 101):
        assert errors_of(elements, 1.0)["u_L2"] <= 1.2 / elements
    for elements, cfl in ((37, 0.93), (64, 0.77), (101, 0.59)):
        errors = errors_of(elements, cfl)
        assert errors["u_L2"] <= 0.6 * elements ** (-2 / 3) and errors["v_L1"] <= 1.5 * elements**-0.5
    finer = {elements: errors_of(elements, 0.9) for elements in (50, 100, 200, 400)}
    for norm, least in (("u_L2", 0.65), ("v_L1", 0.4)):
        assert order_of([1 / n for n in finer], [errors[norm] for errors in finer.values()]) >= least


def test_scenes_without_a_closed_form_are_refused():
    """The rows of tests/host/refusals.json: what is put where so that a shipped scene is no longer covered."""
    sys.path.insert(0, str(SOURCE / "tests/host"))
    from refusals_test import changed

    groups = [group for group in json.loads((SOURCE / "tests/host/refusals.json").read_text())
              if group.get("command", "").startswith("converge")]  # fmt: skip
    rows = [(group["scene"], *row) for group in groups for row in group["refused"] if row[1].startswith("/exact: ")]
    for name, patch, said in rows:
        scene = changed(shipped(name), patch)
        with pytest.raises(BadInput) as refused:
            exact_solution(scene, len(scene["output"]["watch"]), steps_of(scene["time"]["end"], 1e-3), 1e-3)
        assert str(refused.value) == said, (name, patch)
    assert len(rows) > 60 and {name for name, *_ in rows} == {name for name in SCENES if "exact" in shipped(name)} - {
        "mass_on_a_stop", "bouncing_ball_e08", "bouncing_ball_e1"} | {"bouncing_ball"}  # fmt: skip


def test_closed_forms_move_by_their_velocities():
    """Positions are integrals of velocities; an instant at which these jump costs a small step of the integral."""
    steps, jumps = 40000, 20
    for name in SCENES:
        scene = shipped(name)
        if "exact" not in scene or name == "mass_on_a_stop":  # which is impact_oscillator for several laws
            continue
        end = scene["time"]["end"]
        exact = exact_solution(scene, len(scene["output"]["watch"]), steps_of(end, 1e-3), 1e-3)
        time = np.linspace(0.0, end, steps + 1)
        u, v = exact.u(time), exact.v(0.5 * (time[1:] + time[:-1]))
        off = np.abs(u[1:] - u[0] - np.cumsum(v, axis=0) * end / steps).max()
        assert off <= jumps * np.abs(v).max() * end / steps, name


# ---- ilaw converge ----------------------------------------------------------------------------------------------------


def measured(command, scene, folder, *options):
    """Exit code of a command for a scene, with its tables by column and its JSON."""
    (folder / "scene.json").write_text(json.dumps(scene))
    code = command.main(["--out", str(folder / "results"), *options, "--", str(folder / "scene.json")])
    name = command.__name__.removeprefix("ilaw.")
    assert code == 0
    return rows_of(folder / f"results/{name}.csv"), json.loads((folder / f"results/{name}.json").read_text())


def rows_of(file):
    with file.open() as stream:
        return [{key: float(value or "nan") if key not in ("law", "norm") else value for key, value in row.items()}
                for row in csv.DictReader(stream)]  # fmt: skip


def test_two_bars_against_the_exact_solution(tmp_path):
    """Waves with fronts, on linear elements below the critical step.

    Dispersion makes of a front the integral of an Airy function, h^(2/3) wide, with a tail of ringing that falls off as
    x^(-3/4): the mean of its size is h^(2/3) (h^(-2/3))^(1/4) = h^(1/2).
    """
    scene = shipped("two_bars")
    scene["interfaces"][0]["parameters"] = {"activation": "moreau"}
    rows, found = measured(converge, scene, tmp_path, "--levels", "5")
    assert found["reference"] == "exact solution" and found["refined"] == "mesh and time step" and found["levels"] == 5
    for k, row in enumerate(rows):
        assert row["dt"] == pytest.approx(0.009 / 2**k, abs=1e-9)  # cfl 0.9, elements of 0.01
        assert row["steps"] == pytest.approx(4 / row["dt"], abs=1)
        assert row["instant"] <= row["dt"], "found closed a step late at most"
    assert len(rows) == 5 and found["orders"]["u_L2"] >= 0.8 and found["orders"]["v_L1"] >= 0.45


def test_two_bars_at_the_critical_step_are_of_first_order(tmp_path):
    """Waves are exact: what is left is the instant of contact, of first order, or none if it falls on an instant."""
    scene = shipped("two_bars")
    scene["time"]["cfl"] = 1.0
    scene["model"]["bars"][0]["start"] = -1.0 - 0.05 / math.sqrt(2)
    scene["interfaces"][0]["parameters"] = {"activation": "moreau"}
    rows, found = measured(converge, scene, tmp_path, "--levels", "6")
    for norm in ("u_L2", "u_max", "instant"):
        assert found["orders"][norm] >= 0.75
    assert all(row[norm] <= row["dt"] for row in rows for norm in NORMS[:4])


def test_glued_bar_at_the_critical_step_has_no_order_in_the_instant(tmp_path, capsys):
    """Rupture falls on an instant of every mesh: its error is at rounding level.

    The end that comes loose is half as heavy as other nodes: it moves in turn at 0 and at twice its mean velocity 2, a
    saw-tooth that nothing disperses at the critical step, so that the mean of the velocity's error is the velocity.
    """
    scene = shipped("glued_bar")
    scene["time"]["cfl"] = 1.0
    rows, found = measured(converge, scene, tmp_path, "--levels", "4")
    assert found["orders"]["instant"] is None and found["orders"]["u_L2"] == pytest.approx(1, abs=0.05)
    for row in rows:
        assert row["instant"] <= 1e-12 and row["v_L1"] == pytest.approx(1, abs=1e-6)
    last = capsys.readouterr().out.strip().splitlines()[-1]
    assert last.split()[0] == "order" and "          -" in last and "-0.00" not in last


def test_glued_bar_breaks_within_a_step_of_its_instant(tmp_path):
    """Rupture is found at the end of the step in which the window passes the limit."""
    rows, found = measured(converge, shipped("glued_bar"), tmp_path, "--levels", "5", "--factor", "2")
    assert all(row["instant"] <= row["dt"] for row in rows)
    assert found["orders"]["instant"] >= 0.9 and found["orders"]["v_L1"] >= 0.45


def ball(restitution=0.8):
    scene = shipped("bouncing_ball_e08")
    scene["interfaces"][0]["parameters"]["restitution"] = restitution
    return scene


@pytest.mark.parametrize("restitution", [0.0, 0.5, 0.8])
def test_bouncing_ball_is_of_first_order(restitution, tmp_path):
    """Steps that have nothing in common with the instants of impact, whose phase in a step makes errors ragged."""
    scene = ball(restitution)
    scene["time"] = {"dt": 1e-2 / math.sqrt(2), "end": 2.5}
    rows, found = measured(converge, scene, tmp_path, "--levels", "12", "--factor", "1.7")
    assert found["refined"] == "time step"
    # Without rebound there is one jump, which half steps see at the right place or one off: no order.
    for norm in ["u_L2"] + ["v_L1"] * (restitution > 0) + ["instant"] * (restitution == 0.8):
        assert 0.8 <= found["orders"][norm] <= 1.3, norm
    # A bounce is up to a step late and up to g h too fast, for a flight that is 2 e h longer. With 0.8 the last one
    # before the end is the fourth; the others rest.
    late = 4 * (1 + 2 * restitution) if restitution == 0.8 else 1.5
    assert all(row["instant"] <= late * row["dt"] for row in rows)


def test_without_exact_solution_compares_with_the_finest_run(tmp_path):
    scene = shipped("postit_test2")
    del scene["exact"]
    rows, found = measured(converge, scene, tmp_path, "--levels", "4")
    assert found["reference"] == "finest run" and found["levels"] == 4
    assert len(rows) == 3 and rows[0]["u_L2"] > rows[2]["u_L2"]
    assert not any(math.isnan(row[norm]) for row in rows for norm in ("impulse", "energy"))


@pytest.mark.parametrize("name", ["postit_test1", "postit_test2", "postit_test3"])
def test_postit_tests_are_of_first_order_in_time(name, tmp_path):
    """As shipped, over a step smaller by 300: shocks enter whole steps, ruptures and impacts are seen a step late."""
    rows, found = measured(converge, shipped(name), tmp_path)
    assert found["reference"] == "exact solution" and len(rows) == 12
    assert all(0.8 <= found["orders"][norm] <= 1.3 for norm in NORMS[:4]), found["orders"]
    assert all(row["instant"] <= 1.01 * row["dt"] for row in rows)


def test_converge_tells_its_reference_and_warnings_of_its_runs(tmp_path, capsys):
    """A spring so soft that the bar's end sinks in by several elements, on each of the meshes."""
    scene = shipped("bar_on_wall")
    del scene["exact"], scene["expect"]
    scene["interfaces"][0].update(law="penalty", parameters={"stiffness": 1.0})
    measured(converge, scene, tmp_path, "--levels", "3")
    told = capsys.readouterr()
    assert told.out.splitlines()[0] == f"{scene['title']}, against the finest run"
    assert told.err.count("warning of 3 runs: nodes penetrate by up to ") == 1 == told.err.count("ilaw: ")


def test_a_trace_takes_no_memory_for_other_columns(tmp_path):
    """History of a point beside 60 columns of a law's memory: 4 of 65 are read."""
    steps, others = 20_000, [f"n0.window{k}" for k in range(60)]
    columns = ["time", "n0.u0", "n0.v0", "n0.r0", "n0.gap", "n0.status", *others, "floor.F0", "balance.interface_work"]
    row = ",".join(["0.12345678901234567"] * len(columns)) + "\n"
    (tmp_path / "history.csv").write_text(",".join(columns) + "\n" + row * steps)
    summary = {"scene": {"source": ball()}, "interfaces": [{"name": "floor", "law": "contact"}], "dt": 1.0,
               "seconds": {"steps": 0.0}, "penetration_max": 0.0, "energy": {"largest": 1.0},
               "forces": {"floor": {"impulse": [1.0]}}}  # fmt: skip
    (tmp_path / "summary.json").write_text(json.dumps(summary))
    tracemalloc.start()
    trace = trace_of_run(Run(tmp_path), ["floor"])
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(trace.u) == steps and peak < 25 * 8 * steps


def test_results_of_two_commands_are_kept_apart(tmp_path):
    scene = str(SCENES["bouncing_ball_e08"])
    commands = {"summary.json": ["run", scene], "sweep.csv": ["run", scene, "--set", "/time/dt=0.01,0.02"],
                "converge.json": ["converge", scene, "--levels", "3"], "study.json": ["study", scene, *OWN_LAW],
                "bench.csv": ["bench", "contact", "--nodes", "20", "--repetitions", "1"]}  # fmt: skip
    for own, command in commands.items():
        assert program(*command, "--out", tmp_path / own).returncode == 0
        assert (tmp_path / own / own).is_file()
        for other, again in commands.items():
            before = sorted(tmp_path.rglob("*"))
            done = program(*again, "--out", tmp_path / own)
            if other == own:
                assert done.returncode == 0, done.stderr
            else:
                found = f"{tmp_path / own}: found {own}, a result of another command, expected a folder of its own"
                assert done.returncode == 2 and found in done.stderr
                assert sorted(tmp_path.rglob("*")) == before


def test_refines_mesh_and_step_together(tmp_path):
    """A block twice as fine along all three axes takes twice the steps at the same cfl."""
    scene = shipped("block_impact")
    scene["model"]["blocks"][0]["elements"] = [2, 2, 2]
    rows, _ = measured(converge, scene, tmp_path, "--levels", "3", "--refine", "mesh")
    assert rows[0]["dt"] / rows[1]["dt"] == pytest.approx(2, abs=0.1)
    assert rows[1]["steps"] / rows[0]["steps"] == pytest.approx(2, abs=0.1)


def test_impulse_is_that_of_each_interface(tmp_path):
    """A ball of 2 kg falls for 0.2 s onto the first of two floors, without rebound: m g t when it stands, all on one."""
    scene = ball(0.0)
    scene["model"]["points"][0] = {"mass": 2.0, "position": [0.0]}
    scene["time"] = {"dt": 0.01, "end": 0.5}
    scene["loads"][0]["acceleration"] = [-10.0]
    low = copy.deepcopy(scene["interfaces"][0])
    low["obstacle"]["point"] = [-1.0]
    scene["interfaces"].append(low)
    with Scenes(SCENES["bouncing_ball"], 1) as scenes:
        probe = scenes.probe(scene)
        trace = scenes.trace(scene, probe.interfaces)
    # It rests from the start: what acts in the half step before the first velocity is counted.
    assert trace.impulse[-1].tolist() == pytest.approx([2 * 10 * 0.505, 0.0])
    assert (probe.least_mass, probe.watched, probe.steps, probe.critical_step) == (2.0, 1, 50, math.inf)


def test_one_energy_alone_is_that_of_the_balance(tmp_path):
    """The work takes no question to the laws, and the energy that they add needs their answers; both can be drawn."""
    scene = ball()
    found = {}
    for energy in ("interface_work", "reaction_work", True):
        scene["output"] = {"watch": [0], "balance": energy}
        (tmp_path / "scene.json").write_text(json.dumps(scene))
        assert program("run", tmp_path / "scene.json", "--out", tmp_path / f"{energy}").returncode == 0
        found[energy] = rows_of(tmp_path / f"{energy}/history.csv")
    assert program("plot", tmp_path / "interface_work").returncode == 0
    whole = found[True]
    assert [row["balance.interface_work"] for row in found["interface_work"]] == [
        row["balance.interface_work"] for row in whole]  # fmt: skip
    assert "balance.kinetic" not in found["interface_work"][0]
    for row, full in zip(found["reaction_work"], whole):
        parts = ("interface_work", "dissipated_friction", "dissipated_impact", "dissipated_rupture", "stored")
        assert row["balance.reaction_work"] == pytest.approx(sum(full[f"balance.{part}"] for part in parts), abs=1e-12)
    largest = [row["balance.largest"] for row in found["reaction_work"]]
    assert largest[-1] == json.loads((tmp_path / "True/summary.json").read_text())["energy"]["largest"] > 0
    assert largest[-1] >= max(row["balance.kinetic"] for row in whole)


# ---- ilaw study -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("mass, stiffness, tried", [(1.0, 1e4, 0.05), (2.7, 3.1e4, 0.31), (0.13, 777.0, 0.0271)])
def test_stable_step_of_a_mass_on_a_spring(mass, stiffness, tried):
    """A force presses it on the floor, little by little: its spring stays closed, and is stable up to 2/omega."""
    critical = 2 / math.sqrt(stiffness / mass)
    floor = {"type": "plane", "point": [0.0], "normal": [1.0]}
    scene = {"model": {"type": "points", "dimension": 1, "points": [{"mass": mass, "position": [0.0]}]},
             "loads": [{"type": "force", "nodes": [0], "direction": [-1.0], "history": [[0.0, 0.0], [0.2, 10.0]]}],
             "interfaces": [{"law": "penalty", "parameters": {"stiffness": stiffness}, "nodes": [0], "obstacle": floor}]}
    with Scenes(Path("scene.json"), 1) as scenes:
        def is_stable(part, largest=tried):
            dt = part * largest
            return scenes.is_stable({**scene, "time": {"dt": dt, "end": 3.0}}, math.ceil(3.0 / dt))

        assert largest_stable_part(is_stable) * tried == pytest.approx(critical, rel=0.02)
        assert largest_stable_part(lambda part: is_stable(part, 0.95 * critical)) == 1, "all that is tried"


def runs_of_order(order, count):
    """Runs with an error of 3 h^p: below an error from (3/error)^(1/p) steps on."""
    return [MeasuredRun(1 / n, n, 1e-6 * n, 0.0, {**NO_ERRORS, "u_L2": 3 * n**-order, "instant": 3 * n**-order})
            for n in (10 * 2**k for k in range(count))]  # fmt: skip


def test_cost_lies_on_the_line_between_runs():
    for order in (0.5, 1.0, 2.0):
        for steps in (13.0, 177.0, 9999.0):
            found = cost_of(runs_of_order(order, 16), "u_L2", 3 * steps**-order)
            assert found == pytest.approx((steps, 1e-6 * steps), rel=1e-12)
    assert cost_of(runs_of_order(1.0, 6), "u_L2", 0.31)[0] == 10, "the first run is good enough"
    assert all(map(math.isnan, cost_of(runs_of_order(1.0, 6), "u_L2", 1e-3))), "none is"


def test_cost_counts_from_the_run_after_which_errors_stay_below():
    """An error that is small by chance, or that is there again with smaller steps, does not count."""
    runs = runs_of_order(1.0, 8)
    for k, error, wanted in ((1, 1e-9, 150.0), (6, NONE, 1280.0), (7, 0.5, NONE)):  # nan: a run that failed
        runs[k].errors["u_L2"] = error
        assert cost_of(runs, "u_L2", 0.02)[0] == pytest.approx(wanted, abs=1e-9, nan_ok=True)


def test_scaled_parameters_are_in_units_of_the_mass_and_the_step():
    given = {"stiffness": 3.0, "tangential_stiffness": 5.0, "damping": 7.0, "friction": 0.25}
    entry = {"law": "penalty", "scaled": True, "parameters": given}
    found = with_law(ball(), entry, 2.0, 0.01)["interfaces"][0]["parameters"]
    assert found == pytest.approx({"stiffness": 6e4, "tangential_stiffness": 1e5, "damping": 1400.0, "friction": 0.25})
    # The end node of a bar: half an element, m/h^2 = (rho S l/2) (c/l)^2 = E S/(2 l), on every mesh.
    for elements in (10, 35):
        bar = shipped("bar_on_wall")
        bar["model"]["bars"][0]["elements"] = elements
        with Scenes(SCENES["bar_on_wall"], 1) as scenes:
            probe = scenes.probe(bar)
        assert probe.least_mass / probe.critical_step**2 == pytest.approx(900.0 * elements / (2.0 * 10.0))


def test_an_entry_without_a_law_changes_the_scenes_own():
    own = with_law(ball(), {"parameters": {"activation": "predictive"}}, 1.0, 1.0)["interfaces"][0]
    assert own["law"] == "contact" and own["parameters"] == {"restitution": 0.8, "activation": "predictive"}
    other = with_law(ball(), {"law": "penalty", "parameters": {"stiffness": 1.0}}, 1.0, 1.0)
    assert other["interfaces"][0]["parameters"] == {"stiffness": 1.0}


def test_study_of_the_ball_tells_order_and_cost(tmp_path):
    """Positions of contact are of first order, whatever the activation; an explicit spring has an error of its own.

    A tenth of an error costs ten times the steps, within what the phase of impacts scatters.
    """
    scene = ball()
    scene["study"] = {"first": 3.0, "factor": 1.7, "levels": 10}
    second = "contact activation predictive restitution 0.8"
    laws = ['{"name": "contact"}', 'contact:{"restitution": 0.8, "activation": "predictive"}',
            '{"name": "spring", "law": "penalty", "parameters": {"stiffness": 1e4}}']  # fmt: skip
    rows, found = measured(study, scene, tmp_path, "--repetitions", "1", *(f"--law={law}" for law in laws))
    of = {law: [row for row in rows if row["law"] == law] for law in ("contact", second, "spring")}
    assert [law["name"] for law in found["laws"]] == list(of) and sum(map(len, of.values())) == len(rows)
    for row in rows:
        assert not any(math.isnan(row[column]) for column in ("seconds", *NORMS))
        assert row["dt"] * row["steps"] == pytest.approx(5.0, abs=row["dt"])
    for law in ("contact", second):
        assert order_of([r["dt"] for r in of[law]], [r["u_L2"] for r in of[law]]) == pytest.approx(1, abs=0.25)
        assert of[law][0]["dt"] == pytest.approx(0.0309, abs=1e-9)
    # Stable below 2/omega = 0.02 at most, and run at 0.9 of that at most.
    assert of["spring"][0]["dt"] <= 0.018 and found["laws"][2]["largest_stable_step"] <= 0.02 * 1.01
    assert of["spring"][-1]["u_L2"] > 0.1, "elastic, but the ball loses: never right"
    needed = [row for row in rows_of(tmp_path / "results/study_needed.csv") if row["norm"] == "u_L2"]
    cost = {(row["law"], row["error"]): row["steps"] for row in needed}
    assert set(needed[0]) == {"law", "norm", "error", "steps", "seconds", "steps / first law's", "seconds / first law's"}
    assert all(row["steps / first law's"] == 1 == row["seconds / first law's"] for row in needed
               if row["law"] == "contact" and not math.isnan(row["steps"]))  # fmt: skip
    assert all(math.isnan(steps) for (law, _), steps in cost.items() if law == "spring")
    assert 4 < cost["contact", 0.001] / cost["contact", 0.01] < 25
    assert found["reference"] == "exact solution"
    assert found["laws"][0]["largest_stable_step"] == found["laws"][0]["largest_step_tried"]


def test_study_takes_the_usual_laws_if_the_scene_lists_none(tmp_path, capsys):
    scene = ball()
    del scene["study"], scene["exact"]
    _, found = measured(study, scene, tmp_path, "--levels", "3", "--repetitions", "1")
    assert found["reference"] == "finest run of the first law"
    names = [law["name"] for law in found["laws"]]
    assert len(names) == 7 and names[0] == "contact predictive" and names[2] == "explicit k=0.1"
    assert "implicit k=100.0" in capsys.readouterr().out


def test_usual_penalties_are_stiffer_than_the_spring_of_a_point(tmp_path):
    """In units of the step that contact needs, not of the critical step of the spring, which is as soft as it."""
    rows, _ = measured(study, {**shipped("impact_oscillator"), "time": {"dt": 5e-3, "end": 0.5}}, tmp_path,
                       "--levels", "2", "--repetitions", "1")  # fmt: skip
    soft = [row for row in rows if row["law"] == "explicit k=0.1"]
    assert soft and all(row["penetration"] < 0.02 for row in soft), "of an amplitude of 0.1"


def test_a_law_without_a_name_is_refused(tmp_path):
    for law in ("", ":{}"):
        done = program("study", SCENES["bouncing_ball_e08"], "--law", law, "--out", tmp_path / "out")
        assert done.returncode == 2 and f"--law: found '{law}', expected NAME" in done.stderr


def test_study_compares_with_a_run_as_fine_as_asked(tmp_path):
    """The same run has other errors beside a reference that is finer by 1.5 and by 8."""
    errors = set()
    for finer in (1.5, 8.0):
        scene = ball()
        del scene["exact"]
        scene["study"] = {"reference": finer}
        rows, _ = measured(study, scene, tmp_path, "--law=contact", "--levels", "2", "--repetitions", "1")
        errors.add(rows[-1]["u_L2"])
    assert len(errors) == 2


def test_study_takes_laws_that_suit_the_scene(tmp_path):
    """A scene with friction is compared with several laws; a scene with another law only with itself."""
    rubs, holds = shipped("oblique_impact"), shipped("postit_test2")
    rubs["time"]["end"] = 0.35  # past the first impact
    for scene, count in ((rubs, 7), (holds, 1)):
        scene.pop("study", None)
        _, found = measured(study, scene, tmp_path, "--levels", "2", "--repetitions", "1")
        assert len(found["laws"]) == count
    assert found["laws"][0]["name"] == "as in the scene"


OWN_LAW = ["--law", '{"name": "own"}', "--levels", "2", "--repetitions", "1"]


def program(*arguments, **options):
    return subprocess.run([os.environ["ILAW_PROGRAM"], *map(str, arguments)], capture_output=True, text=True, **options)


def test_study_of_several_scenes_has_a_folder_for_each_and_ends_with_one_that_fails(tmp_path):
    (tmp_path / "second.json").write_text('{"title": "no scene"}')
    scenes = [SCENES["bouncing_ball_e1"], SCENES["postit_test2"], tmp_path / "second.json", SCENES["bouncing_ball_e08"]]
    done = program("study", *scenes, *OWN_LAW, "--out", tmp_path / "out")
    assert done.returncode == 2 and "second.json: " in done.stderr
    assert sorted(file.parent.name for file in (tmp_path / "out").glob("*/study.csv")) == ["bouncing_ball_e1", "postit_test2"]
    assert not (tmp_path / "out/bouncing_ball_e08").exists()


def test_files_beside_the_scene_are_found(tmp_path):
    """Names in a scene are relative to its folder, and runs take place elsewhere."""
    (tmp_path / "points.csv").write_text("mass,area,x0,v0\n1,1,1,0\n")
    (tmp_path / "law.so").symlink_to(Path(os.environ["ILAW_PATH"]) / "contact.so")
    scene = ball()
    del scene["exact"], scene["study"]
    scene["model"]["points"], scene["interfaces"][0]["library"] = "points.csv", "./law.so"
    rows, _ = measured(converge, scene, tmp_path, "--levels", "3")
    assert len(rows) == 2


def test_a_run_that_fails_is_told_in_a_sentence(tmp_path):
    scene = ball()
    scene["model"]["points"][0]["velocity"], scene["time"] = [1e308], {"dt": 10, "end": 100}
    (tmp_path / "scene.json").write_text(json.dumps(scene))
    for command in ("converge", "study"):
        done = program(command, tmp_path / "scene.json", "--out", tmp_path / "out")
        assert done.returncode == 1 and done.stderr.startswith("ilaw: ") and "Traceback" not in done.stderr


def test_other_nodes_on_a_finer_mesh_are_refused(tmp_path):
    """A box with a quarter of the bar holds more nodes of each finer mesh."""
    scene = shipped("held_rod")
    del scene["exact"]
    scene["output"]["watch"] = [{"box": [[0.0], [0.25 * scene["model"]["bars"][0]["length"]]]}]
    (tmp_path / "scene.json").write_text(json.dumps(scene))
    done = program("converge", tmp_path / "scene.json", "--refine", "mesh", "--levels", "3", "--out", tmp_path / "out")
    assert done.returncode == 2 and "scene.json: /output/watch: found " in done.stderr and "on two meshes" in done.stderr
    assert not (tmp_path / "out/converge.csv").exists()


def test_expectations_of_a_scene_are_read(tmp_path):
    scene = ball()
    scene["expect"] = [{"what": "no.such.thing", "value": 0, "tolerance": 1, "because": "unknown"}]
    (tmp_path / "scene.json").write_text("\ufeff" + json.dumps(scene), encoding="utf-8")
    done = program("converge", tmp_path / "scene.json", "--out", tmp_path / "out")
    assert done.returncode == 2 and "/expect/0/what: " in done.stderr
    scene["expect"][0] = {"what": "n0.u0", "value": 1e9, "tolerance": 0, "because": "a motion that is compared may miss it"}
    (tmp_path / "scene.json").write_text("\ufeff" + json.dumps(scene), encoding="utf-8")
    assert program("converge", tmp_path / "scene.json", "--levels", "3", "--out", tmp_path / "out").returncode == 0


def test_an_interrupt_leaves_what_is_complete(tmp_path):
    """SIGINT as from a terminal, to all processes of the command, once the third of 12 runs has begun."""
    scene = ball()
    scene["time"]["dt"] = 1e-4
    (tmp_path / "scene.json").write_text(json.dumps(scene))
    command = [os.environ["ILAW_PROGRAM"], "converge", tmp_path / "scene.json", "--levels", "12", "--factor", "3",
               "--json-lines", "--out", tmp_path / "out"]  # fmt: skip
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, start_new_session=True) as running:
        limit = threading.Timer(120, running.kill)
        limit.start()
        for line in running.stderr:
            if line.startswith("{") and json.loads(line)["done"] > 2e5:
                break
        os.killpg(running.pid, 2)
        said = running.stderr.read()
        limit.cancel()
    assert running.returncode == 1 and "ilaw: interrupted after " in said and "Traceback" not in said
    rows = rows_of(tmp_path / "out/converge.csv")
    assert 2 <= len(rows) < 12 and not any(math.isnan(row["u_L2"]) for row in rows)
    assert not (tmp_path / "out/ilaw.lock").exists()
