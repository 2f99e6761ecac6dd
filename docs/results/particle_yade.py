# SPDX-License-Identifier: BSD-3-Clause
"""Impacts of spheres in Yade: yade -n -x particle_yade.py IN OUT; particle_impacts.py writes IN and reads OUT."""
import json
import sys

from ilaw_yade import Contacts
from yade import *
from yade import utils


def scene(case):
    """With a law, its engine; without one, Yade's Hertz and Mindlin with the damping of its `en`."""
    global contacts  # which the PyRunner calls
    O.reset()
    for body in case["bodies"]:
        given = {name: body[name] for name in ("density", "young", "poisson")}
        material = O.materials.append(FrictMat(frictionAngle=case["angle"], **given))
        number = O.bodies.append(utils.sphere(body["place"], body["radius"], material=material))
        O.bodies[number].state.vel, O.bodies[number].state.angVel = body["velocity"], body["spin"]
    if case["is_on_plane"]:
        O.bodies.append(utils.wall(0, axis=2, sense=1, material=material))
    collider = InsertionSortCollider([Bo1_Sphere_Aabb(aabbEnlargeFactor=1.05), Bo1_Wall_Aabb()])
    if case["law"] == "own":
        loses = {"en": case["restitution"], "es": 1.0} if case["restitution"] < 1.0 else {}
        contact = [
            InteractionLoop(
                [Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()],
                [Ip2_FrictMat_FrictMat_MindlinPhys(**loses)],
                [Law2_ScGeom_MindlinPhys_Mindlin(preventGranularRatcheting=False)],
            )
        ]
    else:
        contacts = Contacts(case["law"], sweeps=100, tolerance=1e-13, **case["parameters"])
        contact = [PyRunner(command="contacts()", iterPeriod=1, initRun=True)]
    O.engines = [ForceResetter(), collider, *contact, NewtonIntegrator(damping=0, gravity=(0, 0, 0))]
    O.dt = case["step"]


def rows(case):
    """Velocity along x and z, spin and force along z, by step and sphere."""
    scene(case)
    found = []
    for _ in range(case["steps"]):
        before = [O.bodies[i].state.vel[2] for i in range(case["count"])]
        O.step()
        for contact in O.interactions if case["law"] == "own" else ():  # Yade takes half the radius at a wall
            contact.phys.kno, contact.phys.kso = case["stiffness"], case["shear"]
        states = [O.bodies[i].state for i in range(case["count"])]
        force = [(s.vel[2] - b) * s.mass / O.dt for s, b in zip(states, before)]
        found.append([(s.vel[0], s.vel[2], s.angVel[1], f) for s, f in zip(states, force)])
    return found


with open(sys.argv[1]) as given:
    cases = json.load(given)
with open(sys.argv[2], "w") as out:
    json.dump([rows(case) for case in cases], out)
