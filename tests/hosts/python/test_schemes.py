"""The three cases with known answers of docs/schemes.md, in each of the schemes that the page tells where to call a law:
what an owner of a solver runs in a code of his own. Vectors are in the axes of the law: normal first."""
import functools
import itertools

import numpy as np
import pytest

import ilaw

MASS, GRAVITY = 2.0, 10.0


class Law:
    def __init__(self, name, **parameters):
        law = ilaw.Interface(name, frame="local", velocity_step=1e-3, **parameters)
        self.arrays = {"v_free": np.zeros((1, 3)), "v_previous": np.zeros((1, 3)), "gap": np.zeros(1)}
        self.batch = law.batch(**self.arrays, delassus=1 / MASS, area=1.0)
        self.batch.initialise()

    def impulse(self, v_free, v, gap, time, velocity_step, position_step):
        """At the end of a step, from the free and the half-step velocity."""
        self.arrays["v_free"][0], self.arrays["v_previous"][0], self.arrays["gap"][0] = v_free, v, gap
        self.batch.evaluate(time, velocity_step=velocity_step, position_step=position_step)
        return self.batch.impulse[0].copy()

    @property
    def status(self):
        return self.batch.status[0]


def force_hook(law, n, time, u, v, f, length):
    """Called when all other forces of step n are summed; v is still the half-step velocity. Adds the law's force."""
    velocity_step = (length(n) + length(n + 1)) / 2  # this and the next half kick
    v_free = v + velocity_step / MASS * f
    r = law.impulse(v_free, v, u[0], time, velocity_step, position_step=length(n + 1))
    return f + r / velocity_step


# Each yields time, u and the velocity of the half step that ends there, with which the next step moves.


def central_differences(law, u, v, force, length):
    time, v = 0.0, v + length(0) / (2 * MASS) * force(0.0, u)
    for n in itertools.count():
        time, u = time + length(n), u + length(n) * v
        velocity_step = (length(n) + length(n + 1)) / 2
        v_free = v + velocity_step / MASS * force(time, u)
        v = v_free + law.impulse(v_free, v, u[0], time, velocity_step, length(n + 1)) / MASS
        yield time, u, v


def velocity_verlet(law, u, v, force, length):
    time, f = 0.0, force(0.0, u)
    for n in itertools.count():
        v = v + length(n) / (2 * MASS) * f
        time, u = time + length(n), u + length(n) * v
        f = force_hook(law, n, time, u, v, force(time, u), length)
        yield time, u, v + (length(n) + length(n + 1)) / (2 * MASS) * f
        v = v + length(n) / (2 * MASS) * f


def predictor_corrector(gamma, law, u, v, force, length):
    """Newmark's scheme with beta = 0 (Newmark 1959; Hughes, The Finite Element Method, 1987, section 9.1)."""
    time, h, a = 0.0, length(0), force(0.0, u) / MASS
    while True:
        u, v = u + h * v + h * h / 2 * a, v + (1 - gamma) * h * a  # the predicted velocity is the half-step velocity
        time += h
        a = force_hook(law, 0, time, u, v, force(time, u), length) / MASS
        yield time, u, v + h * a
        v = v + gamma * h * a


SCHEMES = {"central differences": central_differences, "velocity Verlet": velocity_verlet,
           "predictor-corrector": functools.partial(predictor_corrector, 0.5),
           "predictor-corrector, gamma 0.6": functools.partial(predictor_corrector, 0.6)}  # fmt: skip
each = pytest.mark.parametrize("h", [1e-3, 7e-4, 1.3e-3])
in_each = pytest.mark.parametrize("scheme", SCHEMES)


def run(scheme, law, end, force, length, u=(0, 0, 0), v=(0, 0, 0)):
    """Time, u, velocity and status after each step."""
    steps = SCHEMES[scheme](law, np.array(u, float), np.array(v, float), force, length)
    rows = []
    for time, *motion in steps:
        rows.append((time, *motion, law.status))
        if time >= end:
            return [np.array(column) for column in zip(*rows)]


def weight(time, u):
    return np.array([-MASS * GRAVITY, 0.0, 0.0])


@each
@in_each
def test_a_dropped_ball_rebounds_to_the_square_of_its_restitution(scheme, h):
    t, u, v, _ = run(scheme, Law("contact", restitution=0.5), 2.0, weight, lambda n: h, u=(1, 0, 0))
    turns = np.argmax(v[:, 0] > 0)
    assert t[turns] == pytest.approx(0.2**0.5, abs=2 * h)
    assert v[turns, 0] == pytest.approx(0.5 * 20**0.5, abs=2 * GRAVITY * h)
    assert u[turns:, 0][t[turns:] < 0.9].max() == pytest.approx(0.25, abs=5 * h)
    assert u[:, 0].min() >= -1e-2 * h
    assert abs(v[-1, 0]) <= 1e-12  # at rest since 3 sqrt(0.2) = 1.34


@each
@in_each
def test_a_sliding_block_stops_where_friction_stops_it(scheme, h):
    t, u, v, status = run(scheme, Law("coulomb", friction=0.3), 1.0, weight, lambda n: h, v=(0, 2, 0))
    assert t[np.argmax(status == ilaw.Status.STICK)] == pytest.approx(2 / 3, abs=2 * h)
    assert u[-1, 1] == pytest.approx(2 / 3, abs=3 * h)
    assert abs(v[-1, 1]) <= 1e-15


@each
@in_each
def test_a_weld_under_a_ramp_breaks_by_the_impulse_of_its_memory(scheme, h):
    def ramp(time, u):
        return np.array([10 * time, 0.0, 0.0])

    t, u, _, status = run(scheme, Law("tie", strength=1.0, memory=0.1), 1.25, ramp, lambda n: h)
    breaks = np.argmax(status == ilaw.Status.BROKEN)
    assert t[breaks] == pytest.approx(1.05, abs=2 * h)
    assert np.abs(u[:breaks, 0]).max() <= 1e-15


def test_velocity_verlet_is_the_scheme_itself_at_variable_steps():
    """A code that has nothing but a hook for nodal forces: a block on a spring falls, bounces, slides and is dragged back."""

    def force(time, u):
        return np.array([-MASS * GRAVITY, -40 * u[1], -40 * u[2]])

    expected, found = (
        run(scheme, Law("coulomb", friction=0.3, restitution=0.5), 4.0, force, lambda n: 1e-3 * (1 + 0.4 * np.sin(n)),
            u=(0.2, 0, 0.1), v=(-0.5, 2, -1))[2]
        for scheme in ("central differences", "velocity Verlet"))  # fmt: skip
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)
    assert np.count_nonzero((found[:-1, 0] < 0) & (found[1:, 0] > 0)) >= 4  # bounces
    assert abs(found[-1, 0]) <= 1e-2
    assert expected[-1, 1] == 0.0, "it sticks in the end"
