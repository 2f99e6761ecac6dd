"""api/openradioss without OpenRadioss: sync is called as the engine does, and judged by closed forms."""
import importlib
import threading

import numpy as np
import pytest
from engine import Engine, bar, wobble
from hosts import FLOOR, Hook, traced

import ilaw
from ilaw_openradioss import Refused


def weight(time, x):
    return np.array([0.0, 0.0, -20.0])


def contact(law="contact", **given):
    return [dict(law=law, nodes=[1], **({"plane": FLOOR} | given))]


def test_energies_and_forces_of_a_slide_are_in_its_history(tmp_path):
    hook = Hook(tmp_path, contact("coulomb", friction=0.3), history="history.csv")
    t, _, _ = traced(Engine([[0, 0, 0]], v=[2.0, 0, 0], mass=2.0, force=weight), hook, wobble(1e-3, 1.0))
    # The energy of 4 J is friction, and the work of the impulses but for the weight's, which they carry.
    assert hook.run.energy[ilaw.Energy.FRICTION] == pytest.approx(4.0, rel=3e-3)
    assert -hook.run.work == pytest.approx(hook.run.energy[:3].sum(), rel=1e-12)
    table = np.genfromtxt(tmp_path / "history.csv", delimiter=",", names=True)
    assert len(table) == len(t) and table["coulomb0fz"][5:] == pytest.approx(20.0, rel=1e-12)
    assert table["time"][0] == 0.0 and table["friction"][-1] == pytest.approx(4.0, rel=3e-3)


# Deformable bodies; waves, and the toughness of a bond, are those of the decks (test_examples.py).

LENGTH, SPEED, WAVE, LINE = 1.0, 1.0, 5000.0, 3.2  # of steel, 20 mm x 20 mm: rho A = 3.2 kg/m, sound at 5000 m/s


def bar_engine(bodies, cells=50, cross=2, **given):
    """Bars beside each other along x, as [(first x, velocity)]; all springs have the stiffness of the bar."""
    parts = [bar(cells, LENGTH, x0, LINE, cross) for x0, _ in bodies]
    x, mass = np.vstack([p[0] for p in parts]), np.concatenate([p[1] for p in parts])
    v = np.vstack([np.tile([v0, 0.0, 0.0], (len(p[0]), 1)) for p, (_, v0) in zip(parts, bodies)])
    bars = [(a + k * len(parts[0][0]), b + k * len(parts[0][0])) for k, p in enumerate(parts) for a, b in p[2]]
    stiffness = LINE * WAVE**2 * cells / LENGTH / cross**2
    return Engine(x, v=v, mass=mass, bars=bars, stiffness=stiffness, **given)


def face(engine, at):
    """User numbers of the nodes at x."""
    return engine.arrays["ITAB"][np.abs(engine.start[:, 0] - at) < 1e-9].tolist()


QUAD = [0, 1, 3, 2]  # around a face, whose nodes come line by line


@pytest.mark.parametrize("turned", [False, True])
def test_two_bars_exchange_their_velocities(tmp_path, turned):
    """The right bar hits the left one, which takes its velocity; by facets of either of the two."""
    engine = bar_engine([(0.0, -SPEED), (-LENGTH, 0.0)])
    n = len(engine.start) // 2
    right, left = ([int(u) for u in face(engine, 0.0) if (u <= n) == is_right] for is_right in (True, False))
    own, other = (left, right) if turned else (right, left)
    quad = [other[k] for k in QUAD]
    y, z = (engine.start[np.array(quad) - 1][:, 1:] - engine.start[quad[0] - 1][1:])[[1, 3]]
    outward = y[0] * z[1] - y[1] * z[0]  # along x: counterclockwise as the own nodes see it
    facets = [quad if (outward > 0) != turned else quad[::-1]]
    hook = Hook(tmp_path, [dict(law="contact", nodes=own, facets=facets)])
    step = 0.9 * LENGTH / 50 / WAVE
    t, x, v = traced(engine, hook, [step] * int(6e-4 / step))
    m = engine.arrays["MS"]
    momentum = [m[:n] @ v[-1][:n, 0], m[n:] @ v[-1][n:, 0]]
    assert sum(momentum) == pytest.approx(-LINE * LENGTH * SPEED, rel=1e-12)
    assert momentum[1] == pytest.approx(-LINE * LENGTH * SPEED, rel=2e-2)
    assert hook.run.energy[:3].sum() < 0.02 * 0.5 * LINE * LENGTH * SPEED**2


def test_a_bond_between_bars_is_continued_with_the_same_bits_and_its_history(tmp_path):
    def parts(folder):
        folder.mkdir()
        engine = bar_engine([(0.0, 2.0), (-LENGTH, -2.0)], cells=20)
        n = len(engine.start) // 2
        right, left = ([int(u) for u in face(engine, 0.0) if (u <= n) == is_right] for is_right in (True, False))
        bond = dict(law="cohesive", strength=1e7, toughness=50.0, area=1e-4, nodes=right)
        bond["facets"] = [[left[k] for k in QUAD]]
        return engine, lambda: Hook(folder, [bond], history="history.csv")

    steps = [1e-6, 1.1e-6] * 100
    engine, hook = parts(tmp_path / "whole")
    whole = traced(engine, hook(), steps)
    engine, hook = parts(tmp_path / "parts")
    traced(engine, hook(), steps[:77])
    rest = traced(engine, hook(), steps[77:])
    assert all((a[77:] == b).all() for a, b in zip(whole[1:], rest[1:]))
    tables = [(tmp_path / name / "history.csv").read_text() for name in ("whole", "parts")]
    assert tables[0] == tables[1], "energies of both runs, gaps of the nodes in reach"


def test_nodes_out_of_reach_cost_nothing_and_are_found_in_time(tmp_path):
    x = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.3, 0.4, 0.5]]
    engine = Engine(x, v=[[0, 0, 0]] * 4 + [[0, 0, -1.0]], mass=[1e6] * 4 + [1.0])
    hook = Hook(tmp_path, [dict(law="contact", restitution=1.0, nodes=[5], facets=[[1, 2, 3, 4]])])
    _, x, v = traced(engine, hook, wobble(1e-2, 1.0))
    assert v[-1, 4, 2] == pytest.approx(1.0, rel=1e-5) and x[:, 4, 2].min() > -1e-2


# A corner: one node, two contacts.


def test_contacts_at_one_node_are_solved_together(tmp_path):
    engine = Engine([[0.2, 0, 0.3]], v=[-1.0, 0, -1.0], mass=2.0, force=weight)
    walls = contact() + contact(plane=([0, 0, 0], [1, 0, 0]), name="wall")
    _, x, v = traced(engine, Hook(tmp_path, walls), wobble(1e-3, 1.0))
    assert x[:, 0, [0, 2]].min() > -1e-3 and v[-1, 0] == pytest.approx([0, 0, 0], abs=1e-12)


# Restart, threads, ranks.


@pytest.mark.parametrize("law", [dict(law="postit", memory=0.05, adhesion_limit="inf", friction=0.2, area=1.0),
                                 dict(law="coulomb", friction=0.3, restitution=0.5)])
def test_a_continued_run_has_the_same_bits(tmp_path, law):
    def engine():
        return Engine([[0, 0, 0.02], [0, 0.5, 0.0]], v=[0.5, 0.0, -0.5], mass=2.0, force=weight)

    given = [dict(nodes=[1, 2], plane=FLOOR, **{k: float("inf") if v == "inf" else v for k, v in law.items()})]
    steps = wobble(1e-3, 0.6)
    folders = [tmp_path / name for name in ("whole", "parts")]
    for folder in folders:
        folder.mkdir()
    whole, parts = engine(), engine()
    _, x, v = traced(whole, Hook(folders[0], given), steps)
    traced(parts, Hook(folders[1], given), steps[:201])
    _, x2, v2 = traced(parts, Hook(folders[1], given), steps[201:])
    assert (x2 == x[201:]).all() and (v2 == v[201:]).all()
    with pytest.raises(Refused, match="values at time .*, expected .* at time 0.1"):
        parts.time = 0.1
        traced(parts, Hook(folders[1], given), steps[:1])
    with pytest.raises(Refused, match="found no values"):
        (tmp_path / "empty").mkdir()
        traced(parts, Hook(tmp_path / "empty", given), steps[:1])


def test_two_runs_in_two_threads_have_the_bits_of_one(tmp_path):
    def result(folder, threads, found):
        folder.mkdir()
        engine = bar_engine([(0.0, -SPEED)], cells=20)
        given = [dict(law="coulomb", friction=0.1, nodes=face(engine, 0.0), plane=([0, 0, 0], [1, 0, 0]))]
        found[folder.name] = traced(engine, Hook(folder, given, threads=threads), [1e-6] * 400)[1:]

    found = {}
    result(tmp_path / "alone", 1, found)
    both = [threading.Thread(target=result, args=(tmp_path / name, k, found)) for k, name in ((1, "a"), (2, "b"))]
    for one in both:
        one.start()
    for one in both:
        one.join()
    for name in "ab":
        assert all((a == b).all() for a, b in zip(found[name], found["alone"]))


def test_ranks_share_a_node_and_count_it_once(tmp_path, monkeypatch):
    total = 0.0
    for rank, owner in (("0", [1, 1]), ("1", [0, 1])):
        monkeypatch.setenv("PMI_RANK", rank)
        monkeypatch.setenv("PMI_SIZE", "2")
        users = [1, 2] if rank == "0" else [1, 3]
        engine = Engine([[0, 0, 0.0], [0, 1, 0.0]], v=[2.0, 0, 0], mass=2.0, force=weight, users=users, ranks=owner)
        hook = Hook(tmp_path, [dict(law="coulomb", friction=0.3, nodes=[1, 2, 3], plane=FLOOR)])
        _, x, v = traced(engine, hook, wobble(1e-3, 1.0))
        total += hook.run.energy[ilaw.Energy.FRICTION]
    assert total == pytest.approx(3 * 4.0, rel=3e-3)  # of three nodes, one of which is on both ranks
    assert sorted(p.name for p in tmp_path.iterdir()) == ["ilaw_state_0.bin", "ilaw_state_1.bin"]


# The hook that this is not (docs/schemes.md): forces of the step before, stable below h^2 K/m = 1.


@pytest.mark.parametrize(("part", "grows"), [(0.6, False), (0.72, True)])
def test_a_hook_with_forces_of_the_step_before_has_a_limit_of_its_own(part, grows):
    """A chain bonded to a wall. At its end K/m is half of the largest frequency squared: 0.707 of the critical step."""
    n, k, m = 40, 1.0, np.r_[0.5, np.ones(39)]
    h, u, v, before, largest = part * 1.0, np.zeros(40), np.full(40, -1.0), 0.0, 0.0
    law = ilaw.Interface("tie", dimension=1, frame="local", velocity_step=h)
    arrays = dict(v_free=np.zeros((1, 1)), v_previous=np.zeros((1, 1)), gap=np.zeros(1), impulse=np.zeros((1, 1)))
    node = law.batch(delassus=1 / m[:1], area=1.0, **arrays)
    node.initialise()
    for step in range(60):  # before the wave is back
        u += h * v
        pull = k * np.diff(u)
        force = np.r_[pull, 0.0] - np.r_[0.0, pull]
        arrays["v_previous"][0], arrays["v_free"][0], arrays["gap"][0] = v[0], v[0] + h / m[0] * before, u[0]
        node.evaluate(time=step * h)
        before = force[0]
        v += h * force / m
        v[0] += arrays["impulse"][0, 0] / m[0]
        largest = max(largest, 0.5 * m @ v**2 / (0.5 * m.sum()))
    assert (largest > 1.5) == grows, largest


# What is refused, by number and name.


def refusal(tmp_path, given, match, **engine):
    made = Engine(**({"x": [[0, 0, 0], [1, 0, 0]], "mass": 2.0, "force": weight} | engine))
    with pytest.raises((Refused, ilaw.Error), match=match):
        traced(made, Hook(tmp_path, given), [1e-3] * 30)


def test_a_contact_has_one_shape(tmp_path):
    refusal(tmp_path, [dict(law="contact", nodes=[1])], "expected law, nodes, and one of facets, plane, sphere, cylinder")


def test_two_sides_on_two_ranks_are_refused(tmp_path, monkeypatch):
    monkeypatch.setenv("PMI_SIZE", "2")
    refusal(tmp_path, [dict(law="contact", nodes=[1], facets=[[2, 3, 4, 5]])], "node 3, 4, 5 is on another rank")


def test_a_held_component_against_the_normal_is_named(tmp_path):
    slope = ([0, 0, 0], [0.6, 0, 0.8])
    held = [dict(law="contact", nodes=[1], plane=slope)]
    refusal(tmp_path, held, "node 1: .* pushes along X, .* held='X'", bcs=[(0, 0)])
    # Told of it, the node is carried by the slope along the free component alone.
    engine = Engine([[0, 0, 0]], mass=2.0, force=weight, bcs=[(0, 0)])
    _, x, v = traced(engine, Hook(tmp_path, [held[0] | dict(held="X")]), wobble(1e-3, 0.2))
    assert np.abs(x).max() < 1e-12
    # A free one slides down: x'' = g sin cos.
    engine = Engine([[0, 0, 0]], mass=2.0, force=weight)
    t, x, v = traced(engine, Hook(tmp_path, [held[0] | dict(held="")]), wobble(1e-3, 0.2))
    assert v[-1, 0, 0] == pytest.approx(10.0 * 0.48 * t[-1], rel=1e-2)


def test_sync_keeps_its_run(tmp_path):
    host = importlib.reload(importlib.import_module("ilaw_openradioss"))
    engine = Engine([[0, 0, 0]], mass=2.0, force=weight)
    for _ in engine.run(lambda *call: host.sync(*call, contact(), folder=tmp_path), [1e-3] * 5):
        pass
    assert host._run.energy.shape == (4,) and abs(engine.arrays["X"]).max() < 1e-15
