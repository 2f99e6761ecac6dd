# SPDX-License-Identifier: BSD-3-Clause
"""A ball of 5 cm rolls out on a wall from 1 m/s, with rolling resistance of 2 mm: yade -n -x roll.py DT.

Prints the distance beside its closed form, (7/5) v^2 R/(2 rho g), less h v/2: velocities lie half a step before places.
"""
import sys

from ilaw_yade import Contacts
from yade import *
from yade import utils

radius, speed, rho, g = 0.05, 1.0, 0.002, 9.81
O.dt = float(sys.argv[1])
O.bodies.append(utils.sphere((0, 0, radius), radius))
O.bodies.append(utils.wall(0, axis=2, sense=1))
ball = O.bodies[0].state
ball.vel, ball.angVel = (speed, 0, 0), (0, speed / radius, 0)
contacts = Contacts("rolling", friction=0.5, rolling_friction=rho)
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb(aabbEnlargeFactor=1.2), Bo1_Wall_Aabb()]),
    PyRunner(command="contacts()", iterPeriod=1, initRun=True),
    NewtonIntegrator(damping=0, gravity=(0, 0, -g)),
]
O.run(round(4 / O.dt), True)
closed = 1.4 * speed**2 * radius / (2 * rho * g) - O.dt * speed / 2
print(f"rolled {ball.pos[0]:.6f} m, closed form {closed:.6f} m, spin left {ball.angVel.norm():.1e} rad/s", flush=True)
