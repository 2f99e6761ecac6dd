"""Contacts that share bodies: closed forms, ties, no copies, ranks as threads, refusals.

Random problems: test_solver_machine.py."""
import copy
import gc
import os
import weakref

import numpy as np
import pytest
from ranks import on_two_ranks

import ilaw
from ilaw import coupled
from ilaw.coupled import Bodies, Contacts, Solver

H, G, UP = 1e-3, 10.0, [0.0, 0.0, 1.0]


def law(name="coulomb", **given):
    if name == "coulomb":
        given = {"friction": 0.3, **given}
    return ilaw.Interface(name, delassus=given.pop("delassus", "scalar"), velocity_step=H, **given)


def stack(count):
    """Weights that stand on each other: the free velocity of a step, and contacts k of grain k with k - 1."""
    v = np.zeros((count, 3))
    v[:, 2] = -G * H
    return v, np.arange(count), np.arange(count) - 1


def test_weights_may_be_matrices():
    """A node with axes of its own, which a contact sees turned and stretched: it slides frictionless and closes its gap."""
    axes = np.array([[0.0, -2.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.5, 3.0]])
    v = np.array([[0.4, -0.3, -0.2]])
    bodies = Bodies(v_free=v, v_previous=np.zeros((1, 3)), inverse_mass=0.5)
    contact = Contacts(law("contact", delassus="full"), body=[0], counterpart=[-1], gap=0.0, normal=UP,
                       body_weight=axes[None, None])  # fmt: skip
    Solver().solve(bodies, [contact], time=H, tolerance=1e-14)
    (r,), along = contact.impulse, axes[2]
    np.testing.assert_allclose(r, [0, 0, -along @ v[0] / (0.5 * along @ along)], atol=1e-15)
    np.testing.assert_allclose(bodies.velocity[0], v[0] + 0.5 * along * r[2], atol=1e-15)


def test_six_values_of_inertia_turn_with_the_host():
    """A body of three moments, hit off its centre: momentum and spin as by hand."""
    inverse = np.array([[2.0, 0.3, -0.2], [0.3, 1.5, 0.4], [-0.2, 0.4, 3.0]])
    six = np.array([[inverse[0, 0], inverse[1, 1], inverse[2, 2], inverse[0, 1], inverse[0, 2], inverse[1, 2]]])
    v, w, arm = np.array([[0.2, -0.1, -1.0]]), np.array([[0.3, 0.1, -0.4]]), np.array([0.3, -0.2, -0.6])
    bodies = Bodies(v_free=v, v_previous=v, spin_free=w, spin_previous=w, inverse_mass=0.5, inverse_inertia=six)
    contact = Contacts(law(delassus="full"), body=[0], counterpart=[-1], gap=0.0, normal=UP, arm=arm, counterpart_arm=arm)
    contact.initialise()
    Solver().solve(bodies, [contact], time=H, tolerance=1e-15)
    r = contact.impulse[0]
    assert r[2] > 0
    np.testing.assert_allclose(bodies.velocity[0], v[0] + 0.5 * r, rtol=1e-13)
    np.testing.assert_allclose(bodies.spin[0], w[0] + inverse @ np.cross(arm, r), rtol=1e-13)
    assert (bodies.velocity[0] + np.cross(bodies.spin[0], arm))[2] == pytest.approx(0.0, abs=1e-14)


def test_a_wall_that_spins_takes_the_ball_with_it():
    """The plate spins about the normal: the ball's spin is tau M g t/I."""
    m, radius, tau, gravity = 0.3, 0.05, 0.001, 9.81
    inverse_inertia = 2.5 / (m * radius**2)
    v, w = np.array([[0.0, 0.0, -gravity * H]]), np.zeros((1, 3))
    bodies = Bodies(v_free=v, v_previous=np.zeros((1, 3)), spin_free=w, spin_previous=w.copy(), inverse_mass=1 / m,
                    inverse_inertia=inverse_inertia, angular_impulse=True)  # fmt: skip
    twists = ilaw.Interface("rolling", delassus="transverse_spin", velocity_step=H, friction=0.5, twisting_friction=tau)
    plate = Contacts(twists, body=[0], counterpart=[-1], gap=0.0, normal=UP, arm=[0, 0, -radius], energy=True,
                     counterpart_arm=[0, 0, 0], wall_spin=[0, 0, 20.0], wall_spin_previous=[0, 0, 10.0])  # fmt: skip
    report = Solver().solve(bodies, [plate], time=H)
    moment = tau * m * gravity * H
    np.testing.assert_allclose(plate.moment, [[0, 0, moment]], rtol=1e-13)
    np.testing.assert_allclose(bodies.angular_impulse, plate.moment, rtol=1e-13)
    np.testing.assert_allclose(bodies.spin, [[0, 0, inverse_inertia * moment]], rtol=1e-13)
    mean_slip = 15.0 - 0.5 * inverse_inertia * moment
    assert report.energy[0] == pytest.approx(moment * mean_slip, rel=1e-12)


def test_arrays_are_used_where_they_are():
    """Columns and sections go in as they are, results come out in place, and arrays live as long as they are used."""
    room = np.zeros((5, 8))
    room[:, 2] = -G * H
    v, before = room[:, :3], room[:, 3:6]
    body, counterpart = np.arange(5, dtype=np.int32), np.arange(-1, 4, dtype=np.int32)
    state, impulse = np.zeros((5, 0)), np.asfortranarray(np.zeros((5, 3)))
    bodies = Bodies(v_free=v, inverse_mass=1.0, v_previous=before, velocity=v)
    contacts = Contacts(law("contact"), body=body, counterpart=counterpart, gap=room[:, 7], normal=UP,
                        impulse=impulse, state=state)  # fmt: skip
    assert bodies.velocity is v and contacts.body is body and contacts.impulse is impulse
    Solver().solve(bodies, [contacts], time=H, tolerance=1e-13, most_sweeps=20000)
    np.testing.assert_allclose(impulse[:, 2], G * H * np.arange(5, 0, -1), rtol=1e-9)
    assert np.abs(room[:, 2]).max() < 1e-11 and not room[:, 3:].any()
    gone = weakref.ref(impulse)
    del impulse, contacts, bodies
    gc.collect()
    assert gone() is None


def test_arrays_live_as_long_as_they_are_needed():
    bodies = Bodies(v_free=np.full((3, 3), -1.0), inverse_mass=np.ones(3), v_previous=np.zeros((3, 3)))
    contacts = Contacts(law("contact"), body=np.arange(3), counterpart=[-1] * 3, gap=np.zeros(3), normal=np.array(UP))
    gc.collect()
    junk = [np.full((3, 3), np.nan) for _ in range(200)]
    Solver().solve(bodies, [contacts], time=H)
    np.testing.assert_allclose(bodies.velocity, [[-1, -1, 0]] * 3, atol=1e-15)
    assert len(junk) == 200


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("width", [3, 5])
def test_ranks_with_different_kinds_of_contacts_take_one_step(seed, width):
    """Nodes on a floor, one rank's, carry nodes that lie on nine each, the other rank's. If each rank chose directions
    by its own contacts, copies of a body would move apart, and iterations would be 179 to 318
    instead of 37 to 48."""
    random, count = np.random.default_rng(seed), width * width
    v = 1e-3 * random.normal(size=(2 * count, 3)) - [0, 0, G * H]
    inverse_mass = 10 ** random.uniform(-0.5, 0.5, 2 * count)
    i, j = np.divmod(np.arange(count), width)
    below = [(i + a) % width * width + (j + b) % width for a in (-1, 0, 1) for b in (-1, 0, 1)]
    weights = random.uniform(0.2, 1, (count, 9))
    weights /= weights.sum(1)[:, None]

    def solve(rank, exchange=None):
        floor = Contacts(law(), body=np.arange(count), counterpart=np.full(count, -1), gap=0.0, normal=UP)
        above = Contacts(law(), body=count + np.arange(count), counterpart=np.stack(below, 1), counterpart_weight=weights,
                         gap=0.0, normal=UP)  # fmt: skip
        groups = [[above], [floor], [above, floor]][rank]
        for contacts in groups:
            contacts.initialise()
        bodies = Bodies(v_free=v, inverse_mass=inverse_mass, v_previous=np.zeros_like(v),
                        owned=0 if rank == 1 else 2 * count)  # fmt: skip
        report = Solver().solve(bodies, groups, time=H, tolerance=1e-10, exchange=exchange)
        return report.sweeps, bodies.velocity

    alone = solve(2)[1]
    for sweeps, velocity in on_two_ranks(2 * count, solve):
        assert sweeps <= 60
        np.testing.assert_allclose(velocity, alone, atol=1e-11)


@pytest.mark.skipif(os.environ.get("ILAW_HOSTILE") == "1", reason="Newton's method comes first where there is one rank")
def test_a_rank_without_contacts_takes_the_same_iterations():
    """Anderson's corrections of this problem are too large 33 times. If each rank judged its own, the rank without
    contacts would go on with another one than the rank that goes back."""
    random, count = np.random.default_rng(0), 6
    mass = 10 ** random.uniform(-1, 1, count)
    v = 1e-2 * random.normal(size=(count, 3)) - [0, 0, G * H]
    body, counterpart = random.integers(0, count, (2, 2 * count)).astype(np.int32)
    counterpart[(counterpart == body) | (random.random(2 * count) < 0.2)] = -1
    normal = random.normal(size=(2 * count, 3)) + [0, 0, 2]
    normal /= np.linalg.norm(normal, axis=1)[:, None]

    def solve(rank, exchange=None):
        mine = slice(0 if rank == 1 else None)
        contacts = Contacts(law(friction=0.5), body=body[mine], counterpart=counterpart[mine], gap=np.zeros(len(body[mine])),
                            normal=normal[mine])  # fmt: skip
        bodies = Bodies(v_free=v, inverse_mass=1 / mass, v_previous=np.zeros_like(v), owned=0 if rank == 1 else count)
        report = Solver().solve(bodies, [contacts], time=H, tolerance=1e-10, most_sweeps=1000, exchange=exchange)
        return report.sweeps, report.method, bodies.velocity

    sweeps, method, alone = solve(2)
    assert method == coupled.Method.ANDERSON
    for found in on_two_ranks(count, solve):
        assert found[:2] == (sweeps, method)
        np.testing.assert_allclose(found[2], alone, atol=1e-12)


def test_what_an_exchange_raises_comes_out():
    class Broken:
        def sum_bodies(self, values):
            raise ConnectionError("the other rank is gone")

        largest = sum = sum_bodies

    v, body, counterpart = stack(3)
    bodies = Bodies(v_free=v, inverse_mass=1.0, v_previous=v)
    contacts = Contacts(law(), body=body, counterpart=counterpart, gap=0.0, normal=UP)
    with pytest.raises(ConnectionError, match="the other rank is gone"):
        Solver().solve(bodies, [contacts], time=H, most_sweeps=5, exchange=Broken())


def test_bad_contacts_are_named():
    v, body, counterpart = stack(4)
    gap = np.array([0.0, 0.0, np.nan, 0.0])
    bodies = Bodies(v_free=v, inverse_mass=1.0, v_previous=v)
    contacts = Contacts(law(), body=body, counterpart=counterpart, gap=gap, normal=UP)
    with pytest.raises(ilaw.BadNodes, match="node 2: group 0: .*gap"):
        Solver().solve(bodies, [contacts], time=H)
    report = Solver().solve(bodies, [contacts], time=H, bad_nodes="report")
    assert (report.bad_count, report.bad_group, report.bad_contact) == (1, 0, 2)
    assert contacts.status[2] == ilaw.Status.BAD_INPUT and not contacts.impulse[2].any()


V = np.zeros((2, 3))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Bodies(v_free=[[0, 0, 0]], inverse_mass=1.0), "v_free: list, expected an array"),
        (lambda: Bodies(v_free=V, inverse_mass=np.ones(3)), r"inverse_mass: shape \(3,\)"),
        (lambda: Bodies(v_free=V, inverse_mass=1.0, spin_free=V), "inverse_inertia: missing"),
        (lambda: Bodies(v_free=V, inverse_mass=1.0, inverse_inertia=1.0), "spin_free: missing"),
        (lambda: Bodies(v_free=V, inverse_mass=1.0, v_previous=V, velocity=V), None),
        (lambda: Contacts(law(), body=[0], counterpart=[-1], gap=0.0), "coulomb reads normal: give it to Contacts"),
        (lambda: Contacts(law(), body=[0.5], counterpart=[-1], gap=0.0, normal=UP), "body: float64 of shape"),
        (lambda: Contacts(law(), body=[0], counterpart=[1, 2], gap=0.0, normal=UP), "counterpart: int64 of shape"),
        (lambda: Contacts(law(frame="local"), body=[0], counterpart=[1], gap=0.0), "expect an interface for the global"),
        (lambda: solve(body=[2**32]), "body: body 4294967296, expected numbers up to 2147483647"),
        (lambda: solve(counterpart=[-(2**31) - 1]), "counterpart: body -2147483649, expected"),
        (lambda: solve(body=np.array([2**64 - 1], np.uint64)), "body: body 18446744073709551615, expected"),
        (lambda: Bodies(v_free=V, inverse_mass=1.0, owned=3), "owned: 3, expected a whole number from 0 to 2"),
        (lambda: Bodies(v_free=V, inverse_mass=1.0, owned=2**64), "owned: 18446744073709551616, expected"),
        (lambda: solve(most_sweeps=2**32 + 1), "most_sweeps: 4294967297, expected a whole number from 0 to 4294967295"),
        (lambda: solve(most_sweeps=-1), "most_sweeps: -1, expected"),
        (lambda: solve(most_sweeps=1.5), "most_sweeps: float, expected a whole number"),
        (lambda: Contacts(law(numbers="float"), body=[0], counterpart=[1], normal=UP), "an interface of doubles"),
        (lambda: solve(body=[0], counterpart=[5]), "a contact names a body that is not there"),
        (lambda: solve(body=[1], counterpart=[1]), "a contact of a body with itself"),
        (lambda: solve(bodies=Bodies(v_free=V, inverse_mass=1.0)), "the law reads v_previous"),
    ],
)
def test_calls_are_refused_with_the_reason(call, message):
    if message is None:  # v_previous in the place of v_free and of the result
        message = "velocity and v_previous share memory"
    with pytest.raises(ilaw.InvalidArgument, match=message):
        call()


def solve(body=(0,), counterpart=(-1,), bodies=None, **given):
    bodies = bodies or Bodies(v_free=V, inverse_mass=1.0, v_previous=V.copy())
    contacts = Contacts(law(), body=body, counterpart=counterpart, gap=0.0, normal=UP)
    Solver().solve(bodies, [contacts], time=H, **given)


def test_structs_of_c_are_not_copied():
    contacts = Contacts(law(), body=[0], counterpart=[1], gap=0.0, normal=UP)
    for made in (Bodies(v_free=V, inverse_mass=1.0), contacts, Solver()):
        for copied in (copy.copy, copy.deepcopy):
            with pytest.raises(TypeError, match="cannot be copied"):
                copied(made)


def test_a_missing_library_is_named(monkeypatch):
    monkeypatch.setenv("ILAW_COUPLED", "/none.so")
    with pytest.raises(ilaw.NotFound, match="libilaw_coupled.so.1 cannot be loaded.*ILAW_COUPLED"):
        coupled.library.__wrapped__()
