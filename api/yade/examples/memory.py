# SPDX-License-Identifier: BSD-3-Clause
"""Memory that a contact takes: yade -n -x memory.py ilaw|own COUNT. COUNT**3 spheres that touch, one step."""
import resource
import sys

from ilaw_yade import Contacts
from yade import *
from yade import utils

which, across = sys.argv[1], int(sys.argv[2])
O.materials.append(FrictMat(density=2600, young=1e7, poisson=0.3, frictionAngle=0.3))
for k in range(across**3):
    O.bodies.append(utils.sphere((k % across, k // across % across, k // across**2), 0.5))
collider = InsertionSortCollider([Bo1_Sphere_Aabb(aabbEnlargeFactor=1.01)])
if which == "ilaw":
    contacts = Contacts("coulomb", friction=0.3, sweeps=2)
    law = [PyRunner(command="contacts()", iterPeriod=1, initRun=True)]
else:
    law = [InteractionLoop([Ig2_Sphere_Sphere_ScGeom(interactionDetectionFactor=1.01)],
                           [Ip2_FrictMat_FrictMat_MindlinPhys()], [Law2_ScGeom_MindlinPhys_Mindlin()])]
O.dt = 1e-6


def kilobytes():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


# The collider's pairs are the same in both: what follows is the contacts'.
O.engines = [ForceResetter(), collider, NewtonIntegrator(damping=0)]
O.run(1, True)
before = kilobytes()
O.engines = [ForceResetter(), collider, *law, NewtonIntegrator(damping=0)]
O.run(2, True)
count = len(contacts.pairs) if which == "ilaw" else O.interactions.countReal()
print(f"{which}: {count} contacts, {1024 * (kilobytes() - before) / count:.0f} bytes each")
