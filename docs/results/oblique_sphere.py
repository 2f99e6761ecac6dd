#!/usr/bin/env python3
"""A sphere that meets a plate at thirteen angles: the law penalty (Hertz, implicit) beside the measured rebound.

    docs/results/oblique_sphere.py --picture docs/img/oblique_sphere.svg

With the package ilaw in PYTHONPATH, the laws in ILAW_PATH and the loader in ILAW_LOADER. Experiment: Kharaz, Gorham and
Salman (2001), Powder Technology 120, an alumina sphere on glass; data of the sphere from Chung and Ooi (2011), Granular
Matter 13, test 4.
"""
# SPDX-License-Identifier: BSD-3-Clause
import math

import matplotlib.pyplot as plt
import numpy as np
from case_script import parser_of, save

import ilaw

MEASURED = {5.17: 0.948, 10.2: 0.687, 15: 0.624, 20: 0.616, 25: 0.634, 30: 0.684, 35: 0.737, 40: 0.781, 50: 0.845,
            60: 0.893, 70: 0.932, 80: 0.966, 85: 0.983}  # fmt: skip
SPEED, RADIUS, DENSITY, FRICTION, RESTITUTION = 3.9, 2.5e-3, 4000.0, 0.092, 0.98
YOUNG, POISSON = 3.8e11, 0.23
MASS = DENSITY * 4 / 3 * math.pi * RADIUS**3
STIFFNESS = 4 / 3 * YOUNG / (1 - POISSON**2) * math.sqrt(RADIUS)  # Hertz, on a rigid plate: F = k x^1.5
RATIO = 2 * (1 - POISSON) / (2 - POISSON)  # of Mindlin's tangential stiffness to the normal one, dF/dx


def largest_indentation(speed):
    return (1.25 * MASS * speed**2 / STIFFNESS) ** 0.4


def tangential_stiffness(speed):
    """Mindlin's 8 G a / (2 - nu), which is RATIO dF/dx, at the largest indentation: the law has a constant one."""
    return RATIO * 1.5 * STIFFNESS * math.sqrt(largest_indentation(speed))


def impact(angle, steps, damping, friction=FRICTION, is_normal=False):
    """Rebound over impact velocity of the center along the plate (or the normal); `steps` of them in the impact."""
    normal, tangential = SPEED * math.cos(math.radians(angle)), SPEED * math.sin(math.radians(angle))
    h = 2.94 * largest_indentation(normal) / normal / steps  # duration of Hertz' impact
    law = ilaw.Interface("penalty", velocity_step=h, integration="implicit", exponent=1.5, stiffness=STIFFNESS,
                         damping=damping, friction=friction, tangential_stiffness=tangential_stiffness(normal),
                         delassus="transverse")  # fmt: skip
    v, before, gap = np.array([[tangential, 0, -normal]]), np.zeros((1, 3)), np.array([0.3 * h * normal])
    # A solid sphere: the point of contact moves by r (1/m + R^2/I) = 3.5 r/m along the plate.
    contact = law.batch(v_free=v, v_previous=before, delassus=[1 / MASS, 3.5 / MASS], gap=gap, normal=[0, 0, 1])
    contact.initialise()
    center = tangential
    for n in range(3 * steps):
        gap += h * v[:, 2]
        before[:] = v
        contact.evaluate(time=(n + 1) * h)
        v += contact.impulse * [3.5 / MASS, 3.5 / MASS, 1 / MASS]
        center += contact.impulse[0, 0] / MASS
        if n > 3 and not contact.impulse.any():
            break
    return v[0, 2] / normal if is_normal else center / tangential


def damping_of(angle, steps):
    """Damping with which the sphere leaves at RESTITUTION times its normal speed, by bisection."""
    low, high = 0.0, 0.1 * math.sqrt(MASS * STIFFNESS * math.sqrt(largest_indentation(SPEED)))
    for _ in range(40):
        middle = 0.5 * (low + high)
        is_too_fast = impact(angle, steps, middle, friction=0.0, is_normal=True) > RESTITUTION
        low, high = (middle, high) if is_too_fast else (low, middle)
    return low


def rigid(angle):
    """Rigid Coulomb: it slides to the end, or rolls."""
    return max(1 - FRICTION * (1 + RESTITUTION) / math.tan(math.radians(angle)), 5 / 7)


def main():
    given = parser_of(__doc__, runs_scenes=False).parse_args()
    resolutions = (17, 53, 170)
    print("| angle | measured | penalty, " + " | ".join(f"{n} steps" for n in resolutions) + " | error | rigid Coulomb | its error |")
    print("| --- " * (5 + len(resolutions)) + "|")
    found = {}
    for angle, measured in MEASURED.items():
        found[angle] = [impact(angle, steps, damping_of(angle, steps)) for steps in resolutions]
        error, of_rigid = found[angle][-1] / measured - 1, rigid(angle) / measured - 1
        print(f"| {angle:g} | {measured} | " + " | ".join(f"{e:.4f}" for e in found[angle])
              + f" | {100 * error:.1f} % | {rigid(angle):.3f} | {100 * of_rigid:.1f} % |")  # fmt: skip
    if given.picture:
        picture(given.picture)


def picture(file):
    angles = np.concatenate([np.linspace(3, 40, 60), np.linspace(41, 88, 24)])
    figure, plot = plt.subplots(figsize=(6.2, 3.6))
    damping = damping_of(0, 53)
    plot.plot(angles, [impact(angle, 53, damping) for angle in angles], color="tab:orange", label="penalty, Hertz and Mindlin")
    plot.plot(angles, [rigid(angle) for angle in angles], "--", color="gray", lw=1, label="rigid, Coulomb")
    plot.plot(list(MEASURED), list(MEASURED.values()), "ko", ms=4, label="measured (Kharaz et al. 2001)")
    plot.set_xlabel("angle of impact to the normal [degrees]")
    plot.set_ylabel("rebound / impact velocity\nalong the plate")
    plot.set_ylim(0.5, 1.02)
    plot.legend(fontsize=8, frameon=False, loc="lower right")
    save(figure, file)


if __name__ == "__main__":
    main()
