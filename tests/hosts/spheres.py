# SPDX-License-Identifier: BSD-3-Clause
"""Solid spheres that turn, in closed forms: what hosts of particles are asked, each in its own words. One sphere that
does not turn: ilaw.protocols. Radius, mass and gravity are the same for all; the floor z = 0 may spin about z."""
import math
import typing

import numpy as np

RADIUS, MASS, GRAVITY = 0.05, 0.3, 9.81
RHO, TAU = 0.002, 0.001  # rolling and twisting friction
INERTIA = 0.4 * MASS * RADIUS**2
LIES, WEIGHT = RADIUS, (0.0, 0.0, -MASS * GRAVITY)
RESISTING = {"friction": 0.5, "rolling_friction": RHO, "twisting_friction": TAU}
NEVER = math.nan


class Sphere(typing.NamedTuple):
    x: tuple
    v: tuple = (0.0, 0.0, 0.0)
    w: tuple = (0.0, 0.0, 0.0)
    force: tuple = WEIGHT


class Case(typing.NamedTuple):
    name: str
    because: str
    law: str
    parameters: dict
    spheres: list
    # Times, and for the time of the last step by then and its length: x, v and w of each sphere (NaN: not said), and
    # how far they may be off.
    ends: list
    floor: bool = True
    spin: float = 0.0  # of the floor
    lost: float = NEVER  # energy, at the last end


def row(*numbers):
    return np.reshape(numbers, (1, 9))


def cases():
    still, slope = (0.0,) * 3, RHO * GRAVITY / (1.4 * RADIUS)
    found = [Case(
        "rolls out", "while it rolls, 7/5 a = -rho g/R; velocities of middles of steps make the way off by a h^2/8",
        "rolling", RESISTING, [Sphere((0, 0, LIES), (1, 0, 0), (0, 1 / RADIUS, 0))],
        [(4.0, lambda t, h: (row(0.5 / slope, 0, LIES, *still, *still), slope * h**2 / 8 + 1e-10))], lost=0.7 * MASS)]
    mu, u = 0.1, 2.0
    rolls = 2 * u / (7 * mu * GRAVITY)
    found.append(Case(
        "slides, then rolls", "friction brakes it and turns it until it rolls, from 2 u/(7 mu g) on with 5/7 u",
        "coulomb", {"friction": mu}, [Sphere((0, 0, LIES), (u, 0, 0))],
        [(0.9 * rolls, lambda t, h: (
            row(NEVER, 0, LIES, u - mu * GRAVITY * t, 0, 0, 0, 2.5 * mu * GRAVITY * t / RADIUS, 0), 1e-9)),
         (1.1 * rolls, lambda t, h: (row(NEVER, 0, LIES, 5 / 7 * u, 0, 0, 0, 5 / 7 * u / RADIUS, 0), 1e-7))]))
    stops = INERTIA * 15 / (TAU * MASS * GRAVITY)
    found.append(Case(
        "top", "twisting friction, I dw/dt = -tau m g, until it has the spin of a floor that spins the other way",
        "rolling", RESISTING, [Sphere((0, 0, LIES), w=(0, 0, 10))],
        [(0.7 * stops, lambda t, h: (row(0, 0, LIES, *still, 0, 0, 10 - 15 * t / stops), 1e-9)),
         (stops + 0.02, lambda t, h: (row(0, 0, LIES, *still, 0, 0, -5), 1e-11))], spin=-5.0))
    # One pair turns like two gears, the other one about the line of its centres.
    press, spin = 2.0, 10.0
    pair = [Sphere((sign * RADIUS, y, 0), w=tuple(sign * spin * np.array(axis)), force=(-sign * press, 0, 0))
            for y, axis in ((-0.5, (0, 0, -1)), (0.5, (-1, 0, 0))) for sign in (-1, 1)]
    half, end = 0.5 * INERTIA * spin / (RHO * press), INERTIA * spin / (TAU * press) + 0.01

    def pressed(t, h):
        left = [max(0.0, spin - moment * press * t / INERTIA) for moment in (RHO, TAU)]
        return np.array([[*one.x, *still, *(np.array(one.w) / spin * left[k // 2])] for k, one in enumerate(pair)]), 1e-9

    found.append(Case(
        "pressed pairs", "a moment of rho F or tau F acts on both spheres of a pair, and takes all of their energy",
        "rolling", RESISTING, pair, [(half, pressed), (end, pressed)], floor=False, lost=4 * 0.5 * INERTIA * spin**2))
    turns, out = 7.0, 0.5

    def circle(t, h):
        angle = 2 / 7 * turns * t
        return row(-out * math.sin(angle), out * math.cos(angle), LIES, *(NEVER,) * 6), np.maximum(20 * h**2, h * out * turns / 7)

    speed = -2 / 7 * turns * out
    found.append(Case(
        "turntable", "a ball that rolls moves on a circle at 2/7 of the floor's angular velocity (Burns 1981)", "rolling",
        {"friction": 0.5}, [Sphere((0, out, LIES), (speed, 0, 0), (0, (speed + turns * out) / RADIUS, 0))],
        [(math.pi / (2 / 7 * turns), circle)], spin=turns))
    return {case.name: case for case in found}


CASES = cases()


def steps_of(case, h):
    """Steps to each end."""
    return [round(time / h) for time, _ in case.ends]


def judge(case, h, found, lost, starts_late=False):
    """found: x, v and w of each sphere at each end, (ends, spheres, 9). starts_late: the first kick is a whole one, as
    if velocities were those of half a step before, so places are off by half of a step's way."""
    assert np.shape(found) == (len(case.ends), len(case.spheres), 9), np.shape(found)
    for steps, (_, exact), rows in zip(steps_of(case, h), case.ends, found):
        expected, tolerance = exact(steps * h, h)
        off = np.where(np.isnan(expected), 0.0, np.abs(np.array(rows) - expected))
        if starts_late:
            off[:, :3] -= 0.51 * h * max(np.linalg.norm(one.v) for one in case.spheres)
        assert (off <= tolerance).all(), f"{case.name}, step {h}: off by\n{off}\n{case.because}"
    if not math.isnan(case.lost):
        assert abs(lost / case.lost - 1) < 1e-9, f"{case.name}, step {h}: lost {lost}, expected {case.lost}"
