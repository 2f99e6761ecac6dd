# SPDX-License-Identifier: BSD-3-Clause
"""Protocols of ilaw.protocols with a sphere of Yade, to OUT/NAME.out: yade -n -x protocol_yade.py OUT NAME..."""
import sys

from ilaw_yade import Contacts
from yade import *
from yade import utils

from ilaw.protocols import PROTOCOLS


def run(protocol):
    """Position and velocity at the end."""
    global p, contacts  # which the PyRunner calls
    p, radius = protocol, 10 * max(protocol.position[2], 0.05)
    O.reset()
    O.materials.append(FrictMat(density=1.0))
    body = O.bodies[O.bodies.append(utils.sphere((*p.position[:2], p.position[2] + radius), radius))]
    body.state.mass, body.state.vel = p.mass, p.velocity
    body.state.inertia = 3 * [0.4 * p.mass * radius**2]
    wall = O.bodies[O.bodies.append(utils.wall(0, axis=2, sense=1))]
    wall.state.vel = p.wall
    contacts = Contacts(p.law, area=p.area, sweeps=100, tolerance=1e-15, **p.parameters)
    O.engines = [
        ForceResetter(),
        InsertionSortCollider([Bo1_Sphere_Aabb(aabbEnlargeFactor=1.5), Bo1_Wall_Aabb()]),
        PyRunner(command="O.forces.addF(0, p.force); contacts()", iterPeriod=1, initRun=True),
        NewtonIntegrator(damping=0),
    ]
    # Yade kicks and moves: half a kick comes first, and the rest of its motion by hand.
    O.dt = 0.5 * p.step
    O.step()
    for state in (body.state, wall.state):
        state.pos += O.dt * state.vel
    O.dt = p.step
    O.run(p.steps - 1, True)
    moved = body.state.pos
    O.step()
    return moved, body.state.vel


for name in sys.argv[2:]:
    with open(f"{sys.argv[1]}/{name}.out", "w") as out:
        for vector in run(PROTOCOLS[name]):
            print(*(f"{number:.17g}" for number in vector), file=out)
