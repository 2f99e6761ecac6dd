"""What both hosts of api/openradioss are asked, in closed forms: the hook of a deck and the user library."""
import ilaw_openradioss_window
import numpy as np
import pytest
from engine import Engine, wobble
from hosts import FLOOR, GRAVITY, MASS, Hook, Node, programs, run, start, traced

import ilaw
from ilaw_openradioss import NAMES, Refused, Run

# The same of both: one contact, {"law": name, parameters, "plane" or the like, "nodes": numbers}, at variable steps.


def by_hook(folder, given, nodes, steps):
    forces = np.array([n.force for n in nodes], float)
    engine = Engine([n.x for n in nodes], v=[n.v for n in nodes], mass=[n.mass for n in nodes], force=lambda t, x: forces,
                    users=[n.user for n in nodes], bound=[k for k, n in enumerate(nodes) if n.kinematic])  # fmt: skip
    hook, booked = Hook(folder, [{"held": ""} | given]), []

    def sync(*cycle):
        booked.append(hook.run.work[0] if hook.run else 0.0)
        hook(*cycle)

    t, x, v = traced(engine, sync, steps)
    return t, np.array(booked[1:]), x, v


def by_window(folder, given, nodes, steps):
    words = {key: np.hstack(value if isinstance(value, (list, tuple)) else [value]) for key, value in given.items()}
    done = start(folder, [" ".join([key, *map(str, values)]) for key, values in words.items()], nodes)
    if done.returncode:
        raise Refused(done.stderr)
    return run(folder, len(steps), steps[0])


@pytest.fixture(params=[by_hook, pytest.param(by_window, marks=programs)], ids=["hook", "window"])
def moved(request, tmp_path):
    """(contact, nodes, end, first step) -> time, work booked before, X and V after each cycle, whose steps vary."""
    return lambda given, nodes, end, h: request.param(tmp_path, given, nodes, wobble(h, end))


sizes = pytest.mark.parametrize("h", [1e-3, 7e-4, 1.3e-3])


@sizes
def test_a_node_bounces_and_rests_and_its_work_is_booked(moved, h):
    t, work, x, v = moved(dict(law="contact", restitution=0.5, plane=FLOOR, nodes=[7]), [Node(7, (0, 0, 1))], 2.0, h)
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


@sizes
def test_a_gap_is_closed_in_the_position_step(moved, h):
    """By a law that predicts, to rounding: the velocity step, here shorter or longer by a twentieth, would leave a part
    of the gap."""
    nodes = [Node(k, (k, 0, 0.01 + 1.3 * k * h), (0, 0, -1.0), (0, 0, 0)) for k in (1, 2, 3)]
    given = dict(law="contact", activation="predictive", plane=FLOOR, nodes=[1, 2, 3])
    _, _, x, v = moved(given, nodes, 30 * h, h)
    meets = np.argmax(v[..., 2] > -1.0, axis=0)
    assert (meets > 0).all() and np.abs(x[meets, range(3), 2]).max() < 1e-17, x[meets, range(3), 2]
    assert len(set(meets % 4)) > 1


@sizes
def test_nodes_slide_and_stop(moved, h):
    """Two, of which the model has the second first and another between them."""
    nodes = [Node(k, (k, 0, 0), (v, 0, 0)) for k, v in ((2, 2.0), (5, 0.0), (1, 1.0))]
    t, work, x, v = moved(dict(law="coulomb", friction=0.3, plane=FLOOR, nodes=[1, 2]), nodes, 0.8, h)
    for row, speed in ((0, 2.0), (2, 1.0)):
        assert t[np.argmax(np.abs(v[:, row, 0]) < 1e-12)] == pytest.approx(speed / 3, abs=2 * h)
        assert x[-1, row, 0] - x[0, row, 0] == pytest.approx(speed**2 / 6, abs=3 * h)
    assert v[-1, 1, 2] == pytest.approx(-GRAVITY * t[-1], abs=10 * h)
    assert work[-1] == pytest.approx(-0.5 * MASS * (4 + 1), rel=3 * h)


@pytest.mark.parametrize("shape", [dict(sphere=([0, 0, -1], 1.0)), dict(cylinder=([0, 0, -1], [0, 1, 0], 1.0))])
def test_a_node_is_reflected_by_a_round_shape(moved, shape):
    node = Node(1, (0.1, 0, 1), (0, 0, -1), (0, 0, 0))
    n = np.array([0.1, 0, (1 - 0.01) ** 0.5])
    _, _, _, v = moved(dict(law="contact", restitution=1.0, nodes=[1]) | shape, [node], 1.3, 1e-3)
    assert v[-1, 0] == pytest.approx([0, 0, -1] + 2 * n[2] * n, abs=1e-3)


def test_bonds_take_their_toughness(moved):
    """To the order of the step, since the kinetic energy of the engine is that of half steps."""
    nodes = [Node(k, (0, k, 0), (0, 0, 2.0), (0, 0, 0)) for k in (1, 2, 3)]
    given = dict(law="cohesive", strength=10.0, toughness=0.1, area=2.0, plane=FLOOR, nodes=[1, 2, 3])
    _, work, _, v = moved(given, nodes, 0.036, 1e-5)
    assert work[-1] == pytest.approx(-3 * 2 * 0.1, rel=1e-3)
    assert work[-1] == pytest.approx(0.5 * MASS * ((v[-1, :, 2] ** 2).sum() - 3 * 2.0**2), rel=1e-12)


@pytest.mark.parametrize(
    ("change", "of_node", "says"),
    [
        ({}, dict(kinematic=1), "node 1: (has|found) a kinematic condition"),
        ({}, dict(mass=0.0), "node 1: (has|found) no mass"),
        (dict(nodes=[2]), {}, "node 2: .*in the model"),
        (dict(nodes=[1, 1]), {}, "1 twice"),
        (dict(sphere=([0, 0, 0], 1)), {}, "expected (a )?law, nodes, and one"),
        (dict(plane=([0, 0, 0], [0, 0, 0])), {}, r"direction of length 0|normal: \[0, 0, 0\]"),
        (dict(law="coulomb", friction=-0.1), {}, "friction.*-0.1"),
        (dict(law="coulomb", fricton=0.1), {}, "fricton"),
        (dict(law="cohesive", strength=1.0, toughness=1.0), {}, "area"),
        (dict(law="penalty", stiffness=1e9, integration="explicit"), {}, "expected at most .*/DTIX"),
    ],
)
def test_what_a_law_cannot_act_on_is_refused(moved, change, of_node, says):
    with pytest.raises((Refused, ilaw.Error), match=says):
        moved(dict(law="contact", plane=FLOOR, nodes=[1]) | change, [Node(1, (0, 0, 0))._replace(**of_node)], 0.03, 1e-3)


def of_hook(context):
    Run(context, 0.0, 0.0, [dict(law="contact", plane=FLOOR, nodes=[1])])


def of_window(context):
    ilaw_openradioss_window.sync(context, 0.0, 0.0)


@pytest.mark.parametrize(("call", "names"), [(of_hook, NAMES), (of_window, ilaw_openradioss_window.NAMES)])
def test_a_release_that_renames_context_is_told_what_is_missing(call, names):
    context = Engine([[0, 0, 0]]).context
    for name in names:
        less = {key: value for key, value in context.items() if key != name + "_ptr"}
        with pytest.raises(RuntimeError, match=f"context has no {name}_ptr"):
            call(less)
    with pytest.raises(RuntimeError, match="MS_type is 'float'"):
        call(context | {"MS_type": "float"})
