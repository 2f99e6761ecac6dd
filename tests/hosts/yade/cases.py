# SPDX-License-Identifier: BSD-3-Clause
"""Cases with closed forms in Yade, one after the other: yade -n -x cases.py OUT. Figures go to OUT, as JSON."""
import json
import sys

import numpy as np
from ilaw_yade import Contacts
from yade import *
from yade import utils


def scene(law, spheres, walls=(), gravity=(0, 0, 0), dt=1e-3, **parameters):
    """Spheres (place, radius, velocity) of density 1; walls (axis, sense) at 0. `contacts` is the engine."""
    global contacts  # which the PyRunner calls
    O.reset()
    O.materials.append(FrictMat(density=1.0))
    for place, radius, velocity in spheres:
        body = O.bodies[O.bodies.append(utils.sphere(place, radius))]
        body.state.vel = velocity
    for axis, sense in walls:
        O.bodies.append(utils.wall(0, axis=axis, sense=sense))
    contacts = Contacts(law, **parameters)
    O.engines = [
        ForceResetter(),
        InsertionSortCollider([Bo1_Sphere_Aabb(aabbEnlargeFactor=1.3), Bo1_Wall_Aabb()]),
        PyRunner(command="contacts()", iterPeriod=1, initRun=True),
        NewtonIntegrator(damping=0, gravity=gravity),
    ]
    O.dt = dt


def velocity(i=0):
    return list(O.bodies[i].state.vel)


def bounce(e, dt):
    """Thrown at a wall with velocity 1 and nothing else: leaves with e."""
    scene("contact", [((0, 0, 0.6), 0.5, (0.3, 0, -1))], [(2, 1)], dt=dt, restitution=e)
    lowest = []
    for _ in range(round(0.15 / dt)):
        O.step()
        lowest.append(O.bodies[0].state.pos[2] - 0.5)
    return {"v": velocity(), "lowest": min(lowest), "lost": float(contacts.energy.sum()), "mass": O.bodies[0].state.mass}


def collision(e):
    """Two unequal spheres, head on, one in flight and one at rest."""
    spheres = [((0, 0, 0), 0.5, (0, 0, 0)), ((0.95, 0, 0), 0.4, (-1, 0, 0))]
    scene("contact", spheres, dt=7e-4, restitution=e)
    O.run(120, True)
    return {"v": [velocity(0)[0], velocity(1)[0]], "m": [O.bodies[i].state.mass for i in (0, 1)]}


def roll(dt):
    """Slides on a wall with velocity 2, friction 0.1, gravity 10: rolls from 2 u/(7 mu g) on, with 5/7 of it."""
    scene("coulomb", [((0, 0, 0.5), 0.5, (2, 0, 0))], [(2, 1)], (0, 0, -10), dt, friction=0.1, tolerance=1e-10)
    rows = []
    for _ in range(round(0.62 / dt)):
        O.step()
        state = O.bodies[0].state
        rows.append([O.time, state.vel[0], state.angVel[1]])
    rows = np.array(rows)
    rolls = np.abs(rows[:, 1] - 0.5 * rows[:, 2]) < 1e-7
    return {"from": rows[rolls][0, 0], "v": rows[-1, 1], "height": O.bodies[0].state.pos[2]}


def incline(tangent, mu):
    """A slope of this tangent: rolls with 5/7 g sin, or slides with g (sin - mu cos). Its acceleration."""
    g, angle = 10.0, np.arctan(tangent)
    gravity = (g * np.sin(angle), 0, -g * np.cos(angle))
    scene("coulomb", [((0, 0, 0.5), 0.5, (0, 0, 0))], [(2, 1)], gravity, 1e-3, friction=mu)
    O.run(20, True)
    before = velocity()[0]
    O.run(80, True)
    return {"a": (velocity()[0] - before) / 0.08, "g": g, "angle": angle}


def column():
    """Five spheres on each other stay."""
    spheres = [((0, 0, 0.5 + k), 0.5, (0, 0, 0)) for k in range(5)]
    scene("coulomb", spheres, [(2, 1)], (0, 0, -10), friction=0.3, sweeps=5000, tolerance=1e-13)
    O.run(50, True)
    top = [O.bodies[k].state.pos[2] - 0.5 - k for k in range(5)]
    weight = O.bodies[0].state.mass * 10 * O.dt
    floor = contacts.impulse[(contacts.pairs[:, 1] == 5)]
    return {"moved": float(np.abs(top).max()), "carried": float(floor[0, 2] / weight), "overlap": contacts.overlap}


def goes_on():
    """A glued pair that is pulled: 60 steps, and 30 with its memory handed to another engine for 30 more."""
    global contacts
    ends = []
    for parts in (1, 2):
        spheres = [((0, 0, 0.5), 0.5, (0, 0, -1)), ((0, 0.02, 1.49), 0.5, (0.2, 0, -1))]
        scene("postit", spheres, [(2, 1)], (0, 0, -10), friction=0.3, memory=0.01)
        for part in range(parts):
            if part:
                kept = contacts.memory()
                contacts = Contacts("postit", friction=0.3, memory=0.01)
                contacts.recall(kept)
            O.run(60 // parts, True)
        ends.append(velocity(0) + velocity(1) + list(contacts.state.ravel()[:3]))
    return ends


def refused():
    """What is not served, with the reason."""
    said = []
    for change in ("damping", "facet", "blocked"):
        scene("contact", [((0, 0, 0.6), 0.5, (0, 0, -1))])
        if change == "damping":
            O.engines[-1].damping = 0.2
        elif change == "facet":
            O.bodies.append(utils.facet([(0, 0, 0), (1, 0, 0), (0, 1, 0)]))
        else:
            O.bodies[0].state.blockedDOFs = "z"
        try:
            contacts()
            said.append("")
        except (ValueError, NotImplementedError) as reason:
            said.append(str(reason))
    return said


figures = {
    "bounces": {f"{e} {dt}": bounce(e, dt) for e, dt in ((0.0, 1e-3), (0.4, 7e-4), (1.0, 1.3e-3))},
    "collisions": {str(e): collision(e) for e in (0.0, 0.5, 1.0)},
    "rolls": {str(dt): roll(dt) for dt in (2e-3, 1.3e-3, 1.7e-3)},
    "rolling slope": incline(0.3, 0.1),
    "sliding slope": incline(0.7, 0.1),
    "column": column(),
    "goes on": goes_on(),
    "refused": refused(),
}
with open(sys.argv[1], "w") as file:
    json.dump(figures, file, indent=1)
