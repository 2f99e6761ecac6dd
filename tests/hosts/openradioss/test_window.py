"""The user library of api/openradioss without OpenRadioss: stub.cpp loads and calls it as starter and engine do."""
import os
import struct
import subprocess

import ilaw_openradioss_window
import numpy as np
import pytest
from engine import Engine

MASS, GRAVITY = 2.0, 10.0
FLOOR = "plane 0 0 0  0 0 1"
programs = pytest.mark.skipif("ILAW_RADIOSS_STUB" not in os.environ, reason="no user library is built here")


def call(folder, *words):
    command = [os.environ["ILAW_RADIOSS_STUB"], os.environ["ILAW_RADIOSS_LIBRARY"], *map(str, words)]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True)


def start(folder, lines, nodes):
    """nodes: [(user number, position, velocity)], with weight; a third and fourth: force, and (kinematic, mass)."""
    folder.mkdir(exist_ok=True)
    (folder / "window.txt").write_text("\n".join(lines) + "\n")
    rows = []
    for user, x, v, *more in nodes:
        force = more[0] if more else (0, 0, -MASS * GRAVITY)
        kinematic, mass = more[1] if len(more) > 1 else (0, MASS)
        rows.append(" ".join(map(str, (user, kinematic, mass, *x, *v, *force))))
    (folder / "model.txt").write_text("\n".join(rows) + "\n")
    return call(folder, "start")


def run(folder, cycles, h, *more):
    done = call(folder, "run", cycles, h, *more)
    assert done.returncode == 0, done.stderr
    table = np.array([[float(word) for word in line.split()] for line in done.stdout.splitlines()])
    count = (table.shape[1] - 2) // 6
    x, v = (part.reshape(cycles, count, 3) for part in np.split(table[:, 2:], 2, axis=1))
    return table[:, 0], table[:, 1], x, v


def cycles_of(end, h):
    return int(end / (0.9 * h))


@programs
@pytest.mark.parametrize("h", [1e-3, 7e-4, 1.3e-3])
def test_a_node_bounces_and_rests_and_its_work_is_booked(tmp_path, h):
    assert not start(tmp_path, ["law contact", "restitution 0.5", FLOOR, "nodes 7"], [(7, (0, 0, 1), (0, 0, 0))]).stderr
    t, work, x, v = run(tmp_path, cycles_of(2.0, h), h)
    z, w = x[:, 0, 2], v[:, 0, 2]
    touch = np.argmax(w > 0)
    assert t[touch] == pytest.approx(0.2**0.5, abs=2 * h) and w[touch] == pytest.approx(20**0.5 / 2, abs=20 * h)
    assert z[touch:][t[touch:] < 0.9].max() == pytest.approx(0.25, abs=5 * h)
    assert z.min() > -h / 100 and abs(w[-1]) < 1e-12
    # The kinetic energy is the work of the weight and what was booked, which is one cycle behind.
    step = np.diff(t, prepend=0.0)
    weight = -MASS * GRAVITY * 0.5 * (np.r_[0.0, step[:-1]] + step) * 0.5 * (np.r_[0.0, w[:-1]] + w)
    assert 0.5 * MASS * w[:-1] ** 2 == pytest.approx(np.cumsum(weight)[:-1] + work[1:], abs=1e-12)
    assert work[-1] == pytest.approx(-MASS * GRAVITY, rel=2 * h)


@programs
@pytest.mark.parametrize("h", [1e-3, 7e-4, 1.3e-3])
def test_nodes_slide_and_stop(tmp_path, h):
    """Two, of which the model has the second first and another between them."""
    nodes = [(k, (k, 0, 0), (v, 0, 0)) for k, v in ((2, 2.0), (5, 0.0), (1, 1.0))]
    lines = ["# a comment", "law coulomb", "friction 0.3", FLOOR, "nodes 1 to 2"]
    assert not start(tmp_path, lines, nodes).stderr
    t, work, x, v = run(tmp_path, cycles_of(0.8, h), h)
    for row, speed in ((0, 2.0), (2, 1.0)):
        assert t[np.argmax(np.abs(v[:, row, 0]) < 1e-12)] == pytest.approx(speed / 3, abs=2 * h)
    assert v[-1, 1, 2] == pytest.approx(-GRAVITY * t[-1], abs=10 * h)
    assert work[-1] == pytest.approx(-0.5 * MASS * (4 + 1), rel=3 * h)


@programs
@pytest.mark.parametrize("shape", ["sphere 0 0 -1  1", "cylinder 0 0 -1  0 1 0  1"])
def test_a_node_is_reflected_by_a_round_shape(tmp_path, shape):
    lines = ["law contact", "restitution 1", shape, "nodes 1"]
    assert not start(tmp_path, lines, [(1, (0.1, 0, 1), (0, 0, -1), (0, 0, 0))]).stderr
    n = np.array([0.1, 0, (1 - 0.01) ** 0.5])
    assert run(tmp_path, 1400, 1e-3)[3][-1, 0] == pytest.approx([0, 0, -1] + 2 * n[2] * n, abs=1e-3)


MEMORY = ["law cohesive", "strength 10", "toughness 0.1", "area 2", FLOOR, "nodes 1 to 3"]
PULLED = [(k, (0, k, 0), (0.0, 0, 0.1), (0, 0, 2.0 * k)) for k in (1, 2, 3)]


@programs
def test_a_bond_takes_its_toughness(tmp_path):
    """To the order of the step, since the kinetic energy of the engine is that of half steps."""
    assert not start(tmp_path, MEMORY, [(k, x, (0, 0, 2.0), (0, 0, 0)) for k, x, *_ in PULLED]).stderr
    _, work, _, v = run(tmp_path, 4000, 1e-5)
    assert work[-1] == pytest.approx(-3 * 2 * 0.1, rel=1e-3)
    assert work[-1] == pytest.approx(0.5 * MASS * ((v[-1, :, 2] ** 2).sum() - 3 * 2.0**2), rel=1e-12)


@programs
@pytest.mark.parametrize("more", [(), ("threads",)])
def test_a_continued_run_and_calls_from_other_threads_have_the_same_bits(tmp_path, more):
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    for folder in (whole, parts):
        assert not start(folder, MEMORY, PULLED).stderr
    expected = run(whole, 300, 1e-3)
    assert 0 < -expected[1][150] < -expected[1][-1]  # amid the damage
    pieces = [run(parts, cycles, 1e-3, *more) for cycles in (150, 1, 149)]
    for column, found in zip(expected, zip(*pieces)):
        assert (column == np.concatenate(found)).all()


def refusal(folder, lines, nodes=((1, (0, 0, 0), (0, 0, 0)),), more=(), h=1e-3):
    done = start(folder, lines, nodes)
    return done if done.returncode else call(folder, "run", 30, h, *more)


@programs
@pytest.mark.parametrize(
    ("lines", "says"),
    [
        (["law contact", FLOOR], "/USERWI: window: found a law, 0 nodes, 1 shapes, expected a law, nodes, and one"),
        (["law contact", FLOOR, FLOOR, "nodes 1"], "2 shapes, expected a law, nodes, and one plane"),
        ([FLOOR, "nodes 1"], "found no law"),
        (["law contact", FLOOR, "nodes 1 1"], "nodes: found 1 twice, expected each once"),
        (["law contact", FLOOR, "nodes 1.5"], "'nodes 1.5': found '1.5', expected the number of a node"),
        (["law contact", FLOOR, "nodes to 5"], "'nodes to 5': found 'to', expected a node before and after it"),
        (["law contact", "plane 0 0 0 0 0 0", "nodes 1"], "found a direction of length 0"),
        (["law contact", "plane 0 0 0 1", "nodes 1"], "'plane 0 0 0 1': found 4 numbers, expected 6"),
        (["law contact", "sphere 0 0 0 0", "nodes 1"], "found 0, expected a radius above 0"),
        (["law contact", "sphere 0 0 0 1m", "nodes 1"], "found '1m', expected a number"),
        (["law contact", "restitution", FLOOR, "nodes 1"], "'restitution': found 1 words"),
        (["law contact", "friction 0.3", FLOOR, "nodes 1"], "unknown parameter 'friction', expected one of restitution"),
        (["law coulomb", "friction -1", FLOOR, "nodes 1"], "friction"),
        (["law none_such", FLOOR, "nodes 1"], "none_such"),
        (["law cohesive", "strength 1", "toughness 1", FLOOR, "nodes 1"], "no line 'area', expected the tributary area"),
        (["law contact", FLOOR, "nodes 2"], "node 2: found none in the model, expected one"),
        (["law penalty", "stiffness 1e9", "integration explicit", FLOOR, "nodes 1"], "/DTIX bounds it"),
    ],
)  # fmt: skip
def test_a_window_says_what_is_wrong_and_ends_the_run(tmp_path, lines, says):
    done = refusal(tmp_path, lines)
    assert done.returncode == 2 and says in done.stderr, done.stderr


@programs
def test_nodes_that_a_law_cannot_act_on_are_named(tmp_path):
    lines = ["law contact", FLOOR, "nodes 7"]
    for values, says in (((1, 2.0), "node 7: found a kinematic condition"), ((0, 0.0), "node 7: found no mass")):
        done = refusal(tmp_path, lines, [(7, (0, 0, 0), (0, 0, 0), (0, 0, 0), values)])
        assert done.returncode == 2 and says in done.stderr, done.stderr
    done = refusal(tmp_path, ["law contact", "sphere 0 0 0 1", "nodes 7"], [(7, (0, 0, 0), (0, 0, 0), (0, 0, 0))])
    assert done.returncode == 2 and "sync: time 0: node 7: " in done.stderr, done.stderr


@programs
def test_what_a_deck_or_a_restart_file_lacks_is_said(tmp_path):
    lacks = {"no_sync": "found no call of sync, expected a def sync(context)", "no_window": "expected a /USERWI"}
    for part, says in lacks.items():
        done = refusal(tmp_path, ["law contact", FLOOR, "nodes 1"], more=(part,))
        assert done.returncode == 2 and says in done.stderr, done.stderr


@programs
def test_a_restart_file_of_another_library_is_refused(tmp_path):
    assert not start(tmp_path, MEMORY, PULLED).stderr
    run(tmp_path, 10, 1e-3)
    data = (tmp_path / "restart").read_bytes()  # ends with the number of doubles of the window, and these
    size = next(k for k in range(5, 99) if data[-8 * k - 8 : -8 * k] == struct.pack("Q", k))
    head = data[: -8 * size - 8]
    memory = np.frombuffer(data[-8 * size :])
    for other, says in (
        (np.r_[memory, 0.0], f"found {size + 1} numbers, expected {size}"),
        (np.r_[memory[0], memory[1] + 1.0, memory[2:]], "found another version of the state of 'cohesive'"),
    ):
        (tmp_path / "restart").write_bytes(head + struct.pack("Q", other.size) + other.tobytes())
        done = call(tmp_path, "run", 1, 1e-3)
        assert done.returncode == 2 and "restart file: " + says in done.stderr, done.stderr


def test_names_of_context_and_the_library_are_checked():
    context = Engine([[0, 0, 0]]).context
    for name in ilaw_openradioss_window.NAMES:
        less = {key: value for key, value in context.items() if key != name + "_ptr"}
        with pytest.raises(RuntimeError, match=f"context has no {name}_ptr"):
            ilaw_openradioss_window.sync(less, 0.0, 0.0)
    with pytest.raises(RuntimeError, match="MS_type is 'float', expected 'double'"):
        ilaw_openradioss_window.sync(context | {"MS_type": "float"}, 0.0, 0.0)
    with pytest.raises(RuntimeError, match="found no user library, expected -dylib"):
        ilaw_openradioss_window.sync(context, 0.0, 0.0)
