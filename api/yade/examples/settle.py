# SPDX-License-Identifier: BSD-3-Clause
"""Spheres fall into a box, by an interface law or by Yade's own: yade -n -x settle.py ilaw|own COUNT DT END.

Prints what a run cost and how good it was, as JSON. DT 0 takes half of Yade's critical step.
"""
import json
import sys
import time

import numpy as np
from ilaw_yade import Contacts
from yade import *
from yade import utils

which, count, dt, end = sys.argv[1], int(sys.argv[2]), float(sys.argv[3]), float(sys.argv[4])
radius, friction, box = 0.05, 0.3, 0.5
young = 2.5e8  # of Yade's law, so that overlaps stay near 1 % of a diameter

O.materials.append(FrictMat(density=2600, young=young, poisson=0.3, frictionAngle=np.arctan(friction)))
random = np.random.default_rng(1)
for k in range(count):
    layer, row, column = k // 16, k // 4 % 4, k % 4
    place = 0.07 + 0.115 * np.array([column, row, layer]) + random.uniform(-0.005, 0.005, 3)
    O.bodies.append(utils.sphere(tuple(place), radius))
for axis, at, sense in ((0, 0, 1), (0, box, -1), (1, 0, 1), (1, box, -1), (2, 0, 1)):
    O.bodies.append(utils.wall(at, axis=axis, sense=sense))

newton = NewtonIntegrator(damping=0, gravity=(0, 0, -9.81))
if which == "ilaw":
    contacts = Contacts("coulomb", friction=friction, sweeps=50, tolerance=1e-6)
    O.engines = [
        ForceResetter(),
        InsertionSortCollider([Bo1_Sphere_Aabb(aabbEnlargeFactor=1.2), Bo1_Wall_Aabb()]),
        PyRunner(command="contacts()", iterPeriod=1, initRun=True),
        newton,
    ]
else:
    O.engines = [
        ForceResetter(),
        InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb()]),
        InteractionLoop(
            [Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()],
            # Restitution 0 of the law above, as near as its damper comes.
            [Ip2_FrictMat_FrictMat_MindlinPhys(en=0.05, es=0.05)],
            [Law2_ScGeom_MindlinPhys_Mindlin()],
        ),
        newton,
    ]
O.dt = dt or 0.5 * utils.PWaveTimeStep()


def overlap():
    if which == "ilaw":
        return contacts.overlap
    return max([i.geom.penetrationDepth for i in O.interactions], default=0.0)


def touching():
    """Contacts that carry something."""
    if which == "ilaw":
        return contacts.pairs[contacts.impulse.any(axis=1)]
    return np.array([(i.id1, i.id2) for i in O.interactions if i.phys.normalForce.norm() > 0]).reshape(-1, 2)


def mean_height():
    return float(np.mean([O.bodies[k].state.pos[2] for k in range(count)]))


worst, sweeps, seconds, looked_at, heights = 0.0, [], 0.0, 0, []
steps = round(end / O.dt)
for begun in range(0, steps, 10):
    began = time.process_time()
    for _ in range(10):
        O.step()  # O.run sleeps until it looks again whether the steps are done
    seconds += time.process_time() - began
    worst = max(worst, overlap())
    heights.append((O.time, mean_height()))
    looked_at += 10 * (len(contacts.pairs) if which == "ilaw" else O.interactions.countReal())
    if which == "ilaw":
        sweeps.append(contacts.sweeps)
spheres = [b for b in O.bodies if isinstance(b.shape, Sphere)]
kinetic = sum(
    0.5 * b.state.mass * b.state.vel.squaredNorm() + 0.5 * b.state.inertia[0] * b.state.angVel.squaredNorm()
    for b in spheres
)
pairs = touching()
said = {
    "dt": O.dt,
    "steps": steps,
    "seconds": seconds,
    "overlap_over_diameter": worst / (2 * radius),
    "kinetic": kinetic,
    "coordination": float(np.count_nonzero(pairs < count) / count),
    "height": mean_height(),
    "heights": heights[:: max(1, len(heights) // 100)],
    "microseconds_per_contact": 1e6 * seconds / looked_at,
    "sweeps": float(np.mean(sweeps)) if sweeps else None,
}
print("settled " + json.dumps(said), flush=True)
