#!/usr/bin/env python3
"""A small explicit code that hosts an interface law, in Python: blocks.c with numpy, and the same bits.

Usage: blocks.py LIBRARY
SPDX-License-Identifier: BSD-3-Clause
"""
import sys

import numpy as np

import ilaw

STEPS = 3000
h, gravity = 1e-3, np.array([0.0, 0.0, -10.0])
mass = np.array([1.0, 2.5, 0.7, 2.0, 1.5, 1.0, 0.8])
stiffness = np.array([0.0, 0.0, 0.0, 50.0, 20.0, 100.0, 30.0])
floor_nodes = [0, 1, 2, 3, 4, 5]  # the last block hangs in the air
u = np.array([[0, 0, 0], [0, 0, 0], [0, 0, 0.05], [0.4, -0.3, 0], [0.06, 0.08, 0], [-0.24, 0.32, 0], [0, 0, 0.1]])
v = np.array([[0.72, 0.96, 0], [-1.6, 1.2, 0], [1.8, 2.4, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]])
v_previous = np.zeros_like(v)
inverse_mass = 1.0 / mass
friction_work = np.zeros(len(mass))
if len(sys.argv) != 2:
    sys.exit("usage: blocks.py LIBRARY")


def forces():
    return mass[:, None] * gravity - stiffness[:, None] * u


def kick(step):
    v[:] += (step * inverse_mass)[:, None] * forces()


law = ilaw.Interface(sys.argv[1], friction=0.3, activation="predictive")
contact = law.batch(
    index=floor_nodes,  # the arrays below are the solver's own, over all its nodes
    v_free=v,
    delassus=inverse_mass,
    gap=u[:, 2],  # height over the floor: a component of u, in place
    v_previous=v_previous,
    normal=[0, 0, 1],  # the same at every node
    energy=True,
)


def kick_with_law(time, duration):
    """A kick by all forces, then the impulse of the law, which is 0 outside floor_nodes."""
    v_previous[:] = v
    kick(duration)  # v is v_free now
    contact.evaluate(time, velocity_step=duration, position_step=h)
    v[:] += inverse_mass[:, None] * contact.impulse
    friction_work[:] += contact.energy[:, ilaw.Energy.FRICTION]


contact.initialise()
kick_with_law(0.0, 0.5 * h)  # V_1/2

for n in range(STEPS):
    u += h * v
    kick_with_law((n + 1) * h, h)

for i in range(len(mass)):
    print(f"{i:2d} {u[i, 0]:24.16E} {u[i, 1]:24.16E} {u[i, 2]:24.16E} {friction_work[i]:24.16E} {contact.status[i]:2d}")
