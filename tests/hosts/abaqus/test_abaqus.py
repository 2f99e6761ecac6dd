"""vfric.f of api/abaqus, called by a stub of Abaqus/Explicit as its manual says, against closed forms."""
# SPDX-License-Identifier: BSD-3-Clause
import ctypes
import os

import numpy as np
import pytest

STUB = ctypes.CDLL(os.environ["ILAW_ABAQUS"])
ROUNDING = float(os.environ["ILAW_ABAQUS_ROUNDING"])  # of the numbers of Abaqus
# The block of the manual's verification of VFRIC [in, lbf, s]: of it a column of section 1 over 1 node.
MASS, PRESSURE, SPEED, MU = 7.3e-4, 2000.0, 200.0, 0.15
LIMIT = MU * PRESSURE
BRAKE = LIMIT / MASS


class Points:
    """Four points on a plane, all alike. A law is created once for each interaction, as in Abaqus."""

    def __init__(self, interaction, *constants, v=(0, 0, 0), load=(0, 0, 0), normal=(0, 0, 1), dt=1e-6, states=8):
        self.interaction, self.dt, self.time = interaction.encode(), dt, 0.0
        self.constants, self.normal = np.array(constants or (MU,), float), np.array(normal, float)
        self.v, self.load = np.tile(np.array(v, float), (4, 1)), np.tile(np.array(load, float), (4, 1))
        self.f, self.state = np.zeros_like(self.v), np.zeros((4, states))

    def call(self):
        """A step; what VFRIC reported as an error."""
        self.time += self.dt
        numbers, whole = ctypes.c_double, ctypes.c_int
        arrays = {name: ctypes.c_void_p(array.ctypes.data) for name, array in vars(self).items()
                  if isinstance(array, np.ndarray)}  # fmt: skip
        mass, pressing = np.full(4, MASS), np.full(4, PRESSURE)
        STUB.stub_increment(
            self.interaction, whole(len(self.interaction)), whole(self.v.shape[1]), whole(4), numbers(self.time),
            numbers(self.dt), ctypes.c_void_p(mass.ctypes.data), arrays["load"], ctypes.c_void_p(pressing.ctypes.data),
            arrays["normal"], arrays["v"], whole(len(self.constants)), arrays["constants"], whole(self.state.shape[1]),
            arrays["state"], arrays["f"])  # fmt: skip
        text = ctypes.create_string_buffer(513)
        STUB.stub_error(text)
        return text.value.decode()

    def step(self, times=1):
        for _ in range(times):
            assert self.call() == ""

    def speed(self):
        return np.linalg.norm(self.v, axis=1)

    def slide(self):
        """Runs until the first point stops: time and distance."""
        distance = 0.0
        while self.speed()[0] > 1e-5 * SPEED and self.time < 1e-2:
            self.step()
            distance += self.dt * self.speed()[0]
        return self.time, distance


@pytest.mark.parametrize("dt", [1e-6, 0.7e-6, 1.3e-6])
def test_a_block_stops_as_in_the_manual(dt):
    """v0/a and v0^2/(2a) with a = mu p/m: 4.866e-4 s, 4.866e-2 in. Then it rests."""
    block = Points("COULOMB", v=(SPEED, 0, 0), dt=dt)
    time, distance = block.slide()
    assert time == pytest.approx(SPEED / BRAKE, abs=2 * dt)
    assert distance == pytest.approx(SPEED**2 / (2 * BRAKE), abs=2 * SPEED * dt)
    block.step(10)
    assert block.speed().max() <= ROUNDING * SPEED


@pytest.mark.parametrize("dt", [2e-6, 1e-6])
def test_friction_falls_with_speed(dt):
    """The coefficient mu_k + (mu_s - mu_k) exp(-c v). With y = exp(c v), y' = -c A (mu_k y + mu_s - mu_k), A = p/m."""
    mu_k, c = 0.05, 0.01
    ratio = (MU - mu_k) / mu_k
    stops = np.log((np.exp(c * SPEED) + ratio) / (1 + ratio)) / (c * PRESSURE / MASS * mu_k)
    assert Points("RATE", MU, mu_k, c, v=(SPEED, 0, 0), dt=dt).slide()[0] == pytest.approx(stops, abs=3 * dt)


def test_it_sticks_below_the_limit():
    """Below mu p the force is the load, to the digits that Abaqus has, and nothing moves; above it what is left accelerates."""
    load = 0.9 * LIMIT
    block = Points("COULOMB", load=(0.6 * load, 0.8 * load, 0))
    for _ in range(100):
        block.step()
        np.testing.assert_allclose(block.f, -block.load, rtol=0, atol=4 * ROUNDING * load)
    assert block.speed()[0] <= ROUNDING * load / MASS * block.dt * 100
    block.load *= 1.5
    block.step(50)
    assert block.speed()[0] == pytest.approx(50 * block.dt * (0.9 * 1.5 - 1) * BRAKE, abs=1e-4 * SPEED)


def test_rest_has_the_static_coefficient():
    """Though the slip predicted without friction is none of rest."""
    block = Points("REST", MU, 0.05, 1e30)
    for part in np.linspace(0, 0.9, 100):
        block.load[:, 0] = part * LIMIT
        block.step()
    assert block.speed()[0] <= ROUNDING * SPEED


@pytest.mark.parametrize("decay", [1e9, 1.0])
@pytest.mark.parametrize("before", ["nothing", "a slide and a rest", "a slide and a flight"])
def test_a_node_rests_whatever_it_did_before(decay, before):
    """It has no velocity before if it begins to touch, has rested, or comes back after it was open; the predicted slip of a
    load below the limit is none."""
    block, load = Points(f"AGAIN{decay}", MU, 0.05, decay), 0.9 * LIMIT
    if before != "nothing":
        block.v[:, 0] = SPEED
        block.step(3)
        block.v[:, 0] = 0.0
        if before == "a slide and a rest":
            block.step()
        else:
            block.time += 10 * block.dt
    block.load[:, 0] = load
    for _ in range(5):
        block.step()
        assert block.f[0, 0] == pytest.approx(-load, abs=4 * ROUNDING * load)


def test_a_law_without_status_is_predicted(monkeypatch):
    """What holds without saying so slides at the predicted speed, with the kinetic coefficient."""
    monkeypatch.setenv("ILAW_PATH", os.environ["ILAW_SILENT"])
    block = Points("SILENT", MU, 0.05, 1e9, load=(0.9 * LIMIT, 0, 0))
    block.step()
    assert block.f[0, 0] == pytest.approx(-0.05 * PRESSURE, abs=4 * ROUNDING * PRESSURE)


def test_any_axes_and_dimensions():
    """On a plane that lies askew a slide keeps its direction; in two dimensions it stops like that in three."""
    askew, initial = Points("COULOMB", v=(SPEED / 3, 2 * SPEED / 3, 0), normal=(2 / 3, -1 / 3, 2 / 3)), SPEED * 5**0.5 / 3
    askew.step(100)
    assert askew.speed()[0] == pytest.approx(initial - BRAKE * 100 * askew.dt, abs=100 * ROUNDING * initial)
    assert askew.v[0, 1] == pytest.approx(2 * askew.v[0, 0], abs=100 * ROUNDING * initial)
    plane = Points("PLANE", v=(SPEED, 0), load=(0, 0), normal=(0, 1))
    assert plane.slide()[0] == pytest.approx(SPEED / BRAKE, abs=2 * plane.dt)


@pytest.mark.parametrize("dt", [2e-6, 1e-6, 0.5e-6])
def test_slip_weakening_keeps_its_state(dt):
    """Friction p (mu_s - (mu_s - mu_d) s/D) brakes by s'' = k^2 s - a, so s = a/k^2 (1 - cosh k t) + v/k sinh k t. The slip is
    in the state of the node; each has its own speed."""
    mu_d, critical, end = 0.05, 0.1, 2e-4
    k = np.sqrt((MU - mu_d) * PRESSURE / (MASS * critical))
    points = Points("WEAKENING", MU, mu_d, critical, v=(SPEED, 0, 0), dt=dt)
    points.v[:, 0] *= 1 + 0.1 * np.arange(4)
    v = points.v[:, 0].copy()
    points.step(round(end / dt))
    slip = BRAKE / k**2 * (1 - np.cosh(k * end)) + v / k * np.sinh(k * end)
    np.testing.assert_allclose(points.state[:, 4], slip, rtol=0, atol=0.6 * BRAKE * end * dt)


def test_it_says_why_it_stops():
    few = Points("COULOMB", v=(SPEED, 0, 0), states=3)
    assert few.call() == "VFRIC, law of ilaw: the law needs 4 state variables per node (*DEPVAR)"
    assert "'friction'" in Points("OTHER", -0.1, v=(SPEED, 0, 0)).call()
