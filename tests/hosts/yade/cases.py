# SPDX-License-Identifier: BSD-3-Clause
"""Cases with closed forms in Yade, one after the other: yade -n -x cases.py OUT. Figures go to OUT, as JSON."""
import json
import sys

import numpy as np
import spheres
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


def turning(case, dt):
    """x, v and w of the spheres of a case at its ends, and the energy that contacts took."""
    placed = [(one.x, spheres.RADIUS, one.v) for one in case.spheres]
    scene(case.law, placed, [(2, 1)] if case.floor else [], dt=dt, tolerance=1e-12, sweeps=100, **case.parameters)
    for k, one in enumerate(case.spheres):
        state = O.bodies[k].state
        state.mass, state.inertia, state.angVel = spheres.MASS, 3 * [spheres.INERTIA], one.w
        O.forces.setPermF(k, one.force)
    if case.floor:
        O.bodies[len(placed)].state.angVel = (0, 0, case.spin)
    found, done = [], 0
    for steps in spheres.steps_of(case, dt):
        O.run(steps - done, True)
        states, done = [O.bodies[k].state for k in range(len(placed))], steps
        found.append([[*state.pos, *state.vel, *state.angVel] for state in states])
    return found, float(contacts.energy.sum())


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
    "turning": {name: [(dt, *turning(case, dt)) for dt in STEPS] for name, case in spheres.CASES.items()},
    "goes on with moments": goes_on_with_moments(),
    "changed": changed(),
    "collisions": {str(e): collision(e) for e in (0.0, 0.5, 1.0)},
    "column": column(),
    "goes on": goes_on(),
    "refused": refused(),
}
with open(sys.argv[1], "w") as file:
    json.dump(figures, file, indent=1)
