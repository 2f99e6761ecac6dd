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


def collision(e):
    """Two unequal spheres, head on, one in flight and one at rest; the collider has no pair of them at first."""
    spheres = [((0, 0, 0), 0.5, (0, 0, 0)), ((1.6, 0, 0), 0.4, (-1, 0, 0))]
    scene("contact", spheres, dt=7e-4, restitution=e)
    O.step()
    assert len(contacts.pairs) == 0
    O.run(1100, True)
    return {"v": [velocity(0)[0], velocity(1)[0]], "m": [O.bodies[i].state.mass for i in (0, 1)]}


def changed():
    """A collider that takes the place of another while two spheres come near, and an erased sphere in the way."""
    spheres = [((0, 0, 0), 0.5, (0, 0, 0)), ((2, 0, 0), 0.4, (-1, 0, 0)), ((1.48, 0, 0), 0.1, (0, 0, 0))]
    scene("contact", spheres, dt=1e-3, restitution=0.0)
    O.run(2, True)
    O.bodies.erase(2)
    collider = InsertionSortCollider([Bo1_Sphere_Aabb(aabbEnlargeFactor=1.3), Bo1_Wall_Aabb()])
    O.engines = [O.engines[0], collider, *O.engines[2:]]
    O.run(1500, True)
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


# Of balls of 5 cm. That a ball rolls out is tested by examples/roll.py.
RESISTANCE = {"friction": 0.5, "rolling_friction": 0.002, "twisting_friction": 0.001}


def top(dt):
    """Spins on a wall that spins the other way: its spin at 0.7 of the time in which it takes the wall's, and then."""
    stops = 0.4 * 0.05**2 * 15 / (0.001 * 9.81)
    scene("rolling", [((0, 0, 0.05), 0.05, (0, 0, 0))], [(2, 1)], (0, 0, -9.81), dt, **RESISTANCE)
    state, early = O.bodies[0].state, round(0.7 * stops / dt)
    state.angVel = (0, 0, 10)
    O.bodies[1].state.angVel = (0, 0, -5)
    O.run(early, True)
    spin = state.angVel[2]
    O.run(round(stops / dt) + 1 - early, True)
    return {"spin": spin, "expected": 10 - 15 * early * dt / stops, "end": [*state.vel, *(0.05 * state.angVel)]}


def gears(dt):
    """Two spheres, pressed together, turn like gears: each loses rho F of its spin's moment."""
    scene("rolling", [((-0.05, 0, 0), 0.05, (0, 0, 0)), ((0.05, 0, 0), 0.05, (0, 0, 0))], dt=dt, **RESISTANCE)
    force, inertia = 1e-3, O.bodies[0].state.inertia[0]
    for number, sense in ((0, 1), (1, -1)):
        O.bodies[number].state.angVel = (0, 0, 5.0 * sense)
        O.forces.setPermF(number, (sense * force, 0, 0))
    steps = round(0.5 * inertia * 5.0 / (0.002 * force) / dt)
    O.run(steps, True)
    spins = [list(O.bodies[i].state.angVel) for i in (0, 1)]
    lost = 0.5 * inertia * sum(25.0 - spin[2] ** 2 for spin in spins)
    expected = 5.0 - 0.002 * force * steps * dt / inertia
    return {"spins": spins, "expected": expected, "v": velocity(0), "lost": float(contacts.energy.sum()) / lost}


def turntable(dt):
    """A wall that spins at 7 rad/s: a ball that rolls on it from 0.5 m off its axis, half a circle later."""
    scene("rolling", [((0, 0.5, 0.05), 0.05, (-1, 0, 0))], [(2, 1)], (0, 0, -9.81), dt, friction=0.5)
    state = O.bodies[0].state
    state.angVel = (0, (7 * 0.5 - 1) / 0.05, 0)
    O.bodies[1].state.angVel = (0, 0, 7)
    steps = round(np.pi / 2 / dt)
    O.run(steps, True)
    return {"place": list(state.pos)[:2], "angle": 2 * steps * dt}


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


def goes_on_with_moments():
    """The same of a pile whose moments the few sweeps of a step do not find anew."""
    global contacts
    ends = []
    law = {"friction": 0.3, "rolling_friction": 0.05, "twisting_friction": 0.02, "sweeps": 2}
    for parts in (1, 2):
        spheres = [((0.02 * k, 0, 0.5 + 0.99 * k), 0.5, (0.2 * k, 0, 0)) for k in range(4)]
        scene("rolling", spheres, [(2, 1)], (0, 0, -10), **law)
        for part in range(parts):
            if part:
                kept = contacts.memory()
                contacts = Contacts("rolling", **law)
                contacts.recall(kept)
            O.run(60 // parts, True)
        spins = [spin for k in range(4) for spin in O.bodies[k].state.angVel]
        ends.append(velocity(3) + spins + list(contacts.moment.ravel()))
    return ends


def refused():
    """The cases that are not served, with the reason."""
    said = []
    for change in ("damping", "facet", "blocked", "tumbling"):
        scene("contact", [((0, 0, 0.6), 0.5, (0, 0, -1))])
        if change == "damping":
            O.engines[-1].damping = 0.2
        elif change == "facet":
            O.bodies.append(utils.facet([(0, 0, 0), (1, 0, 0), (0, 1, 0)]))
        elif change == "tumbling":
            O.bodies[O.bodies.append(utils.wall(0, axis=2))].state.angVel = (1, 0, 0)
        else:
            O.bodies[0].state.blockedDOFs = "z"
        try:
            contacts()
            said.append("")
        except (ValueError, NotImplementedError) as reason:
            said.append(str(reason))
    return said


STEPS = (2e-3, 1.3e-3, 1.7e-3)
figures = {
    "tops": {str(dt): top(dt) for dt in STEPS},
    "gears": {str(dt): gears(dt) for dt in STEPS},
    "turntables": {str(dt): turntable(dt) for dt in STEPS},
    "goes on with moments": goes_on_with_moments(),
    "changed": changed(),
    "collisions": {str(e): collision(e) for e in (0.0, 0.5, 1.0)},
    "rolls": {str(dt): roll(dt) for dt in (2e-3, 1.3e-3, 1.7e-3)},
    "column": column(),
    "goes on": goes_on(),
    "refused": refused(),
}
with open(sys.argv[1], "w") as file:
    json.dump(figures, file, indent=1)
