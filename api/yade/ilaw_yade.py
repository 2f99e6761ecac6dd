# SPDX-License-Identifier: BSD-3-Clause
"""Contact between spheres, and between spheres and walls, by interface laws in Yade; see README.md.

    from ilaw_yade import Contacts
    contacts = Contacts("coulomb", friction=0.3)
    O.engines = [
        ForceResetter(),
        InsertionSortCollider([Bo1_Sphere_Aabb(aabbEnlargeFactor=1.1), Bo1_Wall_Aabb()]),
        PyRunner(command="contacts()", iterPeriod=1, initRun=True),
        NewtonIntegrator(damping=0, gravity=(0, 0, -9.81)),
    ]
"""
from __future__ import annotations

import numpy as np
from yade import NewtonIntegrator, O, Sphere, Wall

import ilaw
from ilaw.coupled import Bodies
from ilaw.coupled import Contacts as Group
from ilaw.coupled import Solver

FIXED = "xyzXYZ"


class Contacts:
    """An engine: the contacts of all spheres of the scene, solved together in every step, by one law.

    law: a name or path of a library; parameters by name. sweeps, tolerance: most sweeps of a step, and the
    residual at which they end. area [m^2]: of a contact, for laws with a strength per area; without it the
    section of the smaller sphere.

    After a step: `residual` and `sweeps` of its solve, `contact_count` (closed, bonded, ...), `overlap` [m], the
    largest, `impulse` (k, 3) [N.s], `moment` (k, 3) [N.m.s] of laws that serve spins, else None, `status` (k,) and
    `pairs` (k, 2) of the candidates; since the start `energy` (4,) [J], the columns `ilaw.Energy`. `memory()` is what
    a run that goes on needs, `recall(memory)` takes it.
    """

    def __init__(self, law="coulomb", *, sweeps=50, tolerance=1e-8, area=None, **parameters):
        has_spins = "transverse_spin" in ilaw.describe(law).delassus
        self.law = ilaw.Interface(law, delassus="transverse_spin" if has_spins else "full", parameters=parameters)
        self.most_sweeps, self.tolerance, self.area = sweeps, tolerance, area
        self.solver = Solver()
        self.pairs = np.zeros((0, 2), np.int64)
        self._widths = {"impulse": 3, "state": self.law.state_size, **({"moment": 3} if has_spins else {})}
        self.moment = None
        self._take({name: np.zeros((0, width)) for name, width in self._widths.items()})
        self.status = np.zeros(0, np.uint8)
        self.residual, self.sweeps, self.contact_count, self.overlap = 0.0, 0, 0, 0.0
        self.energy = np.zeros(4)
        self._known = -1

    def _take(self, arrays):
        for name in self._widths:
            setattr(self, name, arrays[name])

    def memory(self):
        kept = {name: getattr(self, name) for name in self._widths}
        return {"pairs": self.pairs, **kept, "version": self.law.state_version}

    def recall(self, memory):
        if memory["version"] != self.law.state_version or not self._widths.keys() <= memory.keys():
            raise ValueError("the memory is of another law or version")
        self.pairs = memory["pairs"].copy()
        self._take({name: memory[name].copy() for name in self._widths})

    def __call__(self):
        """Adds the forces of the contacts; to be called last before NewtonIntegrator."""
        self._look_at_scene()
        h = O.dt
        free, previous = self._velocities(h)
        places = np.array([state.pos for state in self._states]).reshape(-1, 3)
        geometry = self._geometry(places, previous["v"], h)
        bodies = Bodies(
            v_free=free["v"], spin_free=free["w"], v_previous=previous["v"], spin_previous=previous["w"],
            inverse_mass=self._inverse_mass, inverse_inertia=self._inverse_inertia,
            impulse=True, angular_impulse=True,
        )  # fmt: skip
        group = self._group(geometry)
        report = self.solver.solve(
            bodies, [group], time=O.time, velocity_step=h, most_sweeps=self.most_sweeps, tolerance=self.tolerance
        )
        self._add_forces(bodies, h)
        self._take(vars(group))
        self.status = group.status
        self.residual, self.sweeps = report.residual, report.sweeps
        self.energy += report.energy
        self.contact_count = int(np.count_nonzero(group.status))
        self.overlap = float(np.max(-geometry["gap"], initial=0.0))

    def _look_at_scene(self):
        """Masses and radii, once and whenever the number of bodies changes."""
        if self._known == len(O.bodies):
            return
        if O.periodic:
            raise NotImplementedError("ilaw: a periodic cell is not served")
        self._newton = next((e for e in O.engines if isinstance(e, NewtonIntegrator)), None)
        if self._newton is None or self._newton.damping != 0:
            raise ValueError("ilaw: NewtonIntegrator(damping=0) expected, since damping would change the velocities")
        spheres = [b for b in O.bodies if isinstance(b.shape, Sphere)]
        self._walls = {b.id: b for b in O.bodies if isinstance(b.shape, Wall)}
        for b in O.bodies:
            if b.isClump or b.isClumpMember or not isinstance(b.shape, (Sphere, Wall)):
                raise NotImplementedError(f"ilaw: body {b.id}: single spheres and walls are served alone")
        for b in spheres:
            if b.state.blockedDOFs not in ("", FIXED):
                found = f"blockedDOFs {b.state.blockedDOFs!r}"
                raise NotImplementedError(f"ilaw: body {b.id}: {found}, all or none expected")
        self._ids, self._states = np.array([b.id for b in spheres], np.int64), [b.state for b in spheres]
        self._row = np.full(len(O.bodies), -1)
        self._row[self._ids] = np.arange(len(spheres))
        self._radius = np.array([b.shape.radius for b in spheres])
        moves = np.array([b.state.blockedDOFs == "" for b in spheres], bool)
        mass, inertia = (np.array(values) for values in zip(*((b.state.mass, b.state.inertia[0]) for b in spheres)))
        self._inverse_mass = np.divide(1.0, mass, where=moves, out=np.zeros(len(spheres)))
        self._inverse_inertia = np.divide(1.0, inertia, where=moves, out=np.zeros(len(spheres)))
        self._known = len(O.bodies)

    def _velocities(self, h):
        """Half-step velocities with all forces but those of contact, and those before."""
        rows = [
            (*state.vel, *state.angVel, *O.forces.f(i), *O.forces.t(i))
            for i, state in zip(self._ids.tolist(), self._states)
        ]
        v, w, force, torque = np.split(np.array(rows).reshape(-1, 12), 4, axis=1)
        acts = self._inverse_mass[:, None]
        free = v + h * acts * force + h * (acts > 0) * np.array(self._newton.gravity)
        turned = w + h * self._inverse_inertia[:, None] * torque
        return {"v": free, "w": turned}, {"v": np.ascontiguousarray(v), "w": np.ascontiguousarray(w)}

    def _candidates(self):
        """Pairs (body, counterpart) of ids that the collider has, sorted; one of them can move."""
        found = []
        for i in O.interactions.all(onlyReal=False):
            first, second = (i.id1, i.id2) if i.id1 > i.id2 else (i.id2, i.id1)
            if first in self._walls:
                first, second = second, first
            found.append((first, second))
        pairs = np.array(sorted(found), np.int64).reshape(-1, 2)
        inverse = np.append(self._inverse_mass, 0.0)
        return pairs[(inverse[self._row[pairs]] > 0).any(axis=1)]

    def _geometry(self, places, v, h):
        pairs = self._candidates()
        body, counterpart = self._row[pairs[:, 0]], self._row[pairs[:, 1]]
        other, wall_velocity, wall_previous, wall_spin = np.zeros((4, len(pairs), 3))
        radius = np.where(counterpart < 0, 0.0, self._radius[counterpart])
        other[counterpart >= 0] = places[counterpart[counterpart >= 0]]
        for number, wall in self._walls.items():
            at = np.flatnonzero(pairs[:, 1] == number)
            axis, place = wall.shape.axis, wall.state.pos[wall.shape.axis]
            other[at], radius[at] = places[body[at]], self._radius[body[at]]
            side = np.sign(wall.shape.sense) or np.where(other[at, axis] >= place, 1.0, -1.0)
            # A point behind the wall, so that a centre which has sunk into it still finds its way out.
            other[at, axis] = place - side * radius[at]
            wall_spin[at] = self._spin(wall)
            # In the middle of the step, where the mean of a turning wall's velocity is found to O(h^2).
            from_axis, drift = places[body[at]] - np.array(wall.state.pos), v[body[at]] - np.array(wall.state.vel)
            for velocity, ahead in ((wall_velocity, 0.5 * h), (wall_previous, -0.5 * h)):
                velocity[at] = np.array(wall.state.vel) + np.cross(wall_spin[at], from_axis + ahead * drift)
        apart = places[body] - other
        length = np.linalg.norm(apart, axis=1)
        return {
            "pairs": pairs,
            "body": body.astype(np.int32),
            "counterpart": counterpart.astype(np.int32),
            "normal": apart / length[:, None],
            "gap": length - self._radius[body] - radius,
            "radius": np.column_stack([self._radius[body], radius]),
            "wall_velocity": wall_velocity,
            "wall_previous": wall_previous,
            "wall_spin": wall_spin,
        }

    @staticmethod
    def _spin(wall):
        spin = np.array(wall.state.angVel)
        if np.delete(spin, wall.shape.axis).any():
            found = f"angVel {tuple(spin.tolist())}"
            raise NotImplementedError(f"ilaw: body {wall.id}: {found}, expected a spin about the wall's normal")
        return spin

    def _group(self, geometry):
        """The contacts with what is remembered of them; new ones get the law's first state."""
        pairs, normal, radius = geometry["pairs"], geometry["normal"], geometry["radius"]
        span = len(O.bodies)
        keys, known = pairs @ [span, 1], self.pairs @ [span, 1]
        where = np.searchsorted(known, keys)
        old = np.zeros(len(keys), bool)
        inside = where < len(known)
        old[inside] = known[where[inside]] == keys[inside]
        begin = {name: np.zeros((len(keys), width)) for name, width in self._widths.items()}
        for name, array in begin.items():
            array[old] = getattr(self, name)[where[old]]
        area = np.pi * radius.min(axis=1) ** 2 if self.area is None else self.area
        group = Group(
            self.law, body=geometry["body"], counterpart=geometry["counterpart"], normal=normal, gap=geometry["gap"],
            area=area, arm=-radius[:, :1] * normal, counterpart_arm=radius[:, 1:] * normal,
            **{name: geometry[name] for name in ("wall_velocity", "wall_previous", "wall_spin")}, energy=True, **begin,
        )  # fmt: skip
        group.initialise(~old, time=O.time)
        self.pairs = pairs
        return group

    def _add_forces(self, bodies, h):
        pushed = bodies.impulse.any(axis=1) | bodies.angular_impulse.any(axis=1)
        for k in np.flatnonzero(pushed & (self._inverse_mass > 0)):
            O.forces.addF(int(self._ids[k]), tuple(bodies.impulse[k] / h))
            O.forces.addT(int(self._ids[k]), tuple(bodies.angular_impulse[k] / h))
