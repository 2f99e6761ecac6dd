"""The user library of api/openradioss without OpenRadioss: stub.py loads and calls it as starter and engine do."""
import ilaw_openradioss_window
import numpy as np
import pytest
from engine import Engine
from hosts import Node, call, programs, run, start

FLOOR = "plane 0 0 0  0 0 1"
MEMORY = ["law cohesive", "strength 10", "toughness 0.1", "area 2", FLOOR, "nodes 1 to 3"]
PULLED = [Node(k, (0, k, 0), (0, 0, 0.1), (0, 0, 2.0 * k)) for k in (1, 2, 3)]


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


def refusal(folder, lines, *more):
    done = start(folder, lines, [Node(1, (0, 0, 0))])
    return done if done.returncode else call(folder, "run", 30, 1e-3, *more)


@programs
@pytest.mark.parametrize(
    ("lines", "says"),
    [
        (["law contact", FLOOR], "/USERWI: window: found a law, 0 nodes, 1 shapes, expected a law, nodes, and one"),
        ([FLOOR, "nodes 1"], "found no law"),
        (["law contact", FLOOR, "nodes 1.5"], "'nodes 1.5': found '1.5', expected the number of a node"),
        (["law contact", FLOOR, "nodes to 5"], "'nodes to 5': found 'to', expected a node before and after it"),
        (["law contact", "plane 0 0 0 1", "nodes 1"], "'plane 0 0 0 1': found 4 numbers, expected 6"),
        (["law contact", "sphere 0 0 0 0", "nodes 1"], "found 0, expected a radius above 0"),
        (["law contact", "sphere 0 0 0 1m", "nodes 1"], "found '1m', expected a number"),
        (["law contact", "restitution", FLOOR, "nodes 1"], "'restitution': found 1 words"),
        (["law contact", "friction 0.3", FLOOR, "nodes 1"], "unknown parameter 'friction', expected one of restitution"),
        (["law contact", "sphere 0 0 0 1", "nodes 1"], "sync: time 0: node 1: "),
        (["law none_such", FLOOR, "nodes 1"], "none_such"),
    ],
)  # fmt: skip
def test_a_window_says_what_is_wrong_and_ends_the_run(tmp_path, lines, says):
    done = refusal(tmp_path, lines)
    assert done.returncode == 2 and says in done.stderr, done.stderr


@programs
def test_what_a_deck_or_a_restart_file_lacks_is_said(tmp_path):
    lacks = {"no_sync": "found no call of sync, expected a def sync(context)", "no_window": "expected a /USERWI"}
    for part, says in lacks.items():
        done = refusal(tmp_path, ["law contact", FLOOR, "nodes 1"], part)
        assert done.returncode == 2 and says in done.stderr, done.stderr


@programs
def test_a_restart_file_of_another_library_is_refused(tmp_path):
    assert not start(tmp_path, MEMORY, PULLED).stderr
    run(tmp_path, 10, 1e-3)
    model = dict(np.load(tmp_path / "restart.npz"))
    memory = model["memory"]
    for other, says in (
        (np.r_[memory, 0.0], f"found {memory.size + 1} numbers, expected {memory.size}"),
        (np.r_[memory[0], memory[1] + 1.0, memory[2:]], "found another version of the state of 'cohesive'"),
    ):
        np.savez(tmp_path / "restart.npz", **model | {"memory": other})
        done = call(tmp_path, "run", 1, 1e-3)
        assert done.returncode == 2 and "restart file: " + says in done.stderr, done.stderr


def test_a_run_without_the_library_says_so():
    with pytest.raises(RuntimeError, match="found no user library, expected -dylib"):
        ilaw_openradioss_window.sync(Engine([[0, 0, 0]]).context, 0.0, 0.0)
