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
from yade import InsertionSortCollider, NewtonIntegrator, O, Sphere, Wall

import ilaw
from ilaw.coupled import Bodies
from ilaw.coupled import Contacts as Group
from ilaw.coupled import Solver

FIXED = "xyzXYZ"


def _numbers(vector):
    """Iterating over a vector of Yade is 15 times slower, because an exception ends it."""
    return [vector[0], vector[1], vector[2]]


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
        self._bodies, self._engines, self._collided = None, None, None

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
        places, free, previous = self._motion(h)
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
        self.pairs, self.status = self._pairs, group.status
        self.residual, self.sweeps = report.residual, report.sweeps
        self.energy += report.energy
        self.contact_count = int(np.count_nonzero(group.status))
        self.overlap = float(np.max(-geometry["gap"], initial=0.0))

    def _look_at_scene(self):
        """Masses and radii, once and whenever bodies or engines are others."""
        bodies, engines = list(O.bodies), O.engines
        if bodies == self._bodies and engines == self._engines:
            return
        if O.periodic:
            raise NotImplementedError("ilaw: a periodic cell is not served")
        self._newton = next((e for e in engines if isinstance(e, NewtonIntegrator)), None)
        if self._newton is None or self._newton.damping != 0:
            raise ValueError("ilaw: NewtonIntegrator(damping=0) expected, since damping would change the velocities")
        self._collider = next((e for e in engines if isinstance(e, InsertionSortCollider)), None)
        self._collided = None
        spheres = [b for b in bodies if isinstance(b.shape, Sphere)]
        self._walls = {b.id: b for b in bodies if isinstance(b.shape, Wall)}
        for b in bodies:
            if b.isClump or b.isClumpMember or not isinstance(b.shape, (Sphere, Wall)):
                raise NotImplementedError(f"ilaw: body {b.id}: single spheres and walls are served alone")
        for b in spheres:
            if b.state.blockedDOFs not in ("", FIXED):
                found = f"blockedDOFs {b.state.blockedDOFs!r}"
                raise NotImplementedError(f"ilaw: body {b.id}: {found}, all or none expected")
        self._ids, self._states = np.array([b.id for b in spheres], np.int64), [b.state for b in spheres]
        self._row, self._is_known = np.full(len(O.bodies), -1), np.zeros(len(O.bodies), bool)
        self._is_known[[b.id for b in bodies]] = True
        self._row[self._ids] = np.arange(len(spheres))
        self._radius = np.array([b.shape.radius for b in spheres])
        moves = np.array([b.state.blockedDOFs == "" for b in spheres], bool)
        mass, inertia = np.array([(b.state.mass, b.state.inertia[0]) for b in spheres]).reshape(-1, 2).T
        self._inverse_mass = np.divide(1.0, mass, where=moves, out=np.zeros(len(spheres)))
        self._inverse_inertia = np.divide(1.0, inertia, where=moves, out=np.zeros(len(spheres)))
        self._forget({b.id: b for b in self._bodies or ()}, bodies)
        self._bodies, self._engines = bodies, engines

    def _forget(self, before, bodies):
        """What is remembered of ids that other bodies have now."""
        others = [b.id for b in bodies if b.id in before and before[b.id] != b]
        if not others:
            return
        kept = ~np.isin(self.pairs, others).any(axis=1)
        self.pairs = self.pairs[kept]
        self._take({name: getattr(self, name)[kept] for name in self._widths})

    def _motion(self, h):
        """Places, half-step velocities with all forces but those of contact, and those before."""
        force_of, torque_of = O.forces.f, O.forces.t
        numbers = []
        for i, state in zip(self._ids.tolist(), self._states):
            for a in (state.pos, state.vel, state.angVel, force_of(i), torque_of(i)):
                numbers += a[0], a[1], a[2]  # as _numbers, without its call
        places, v, w, force, torque = np.array(numbers).reshape(-1, 5, 3).transpose(1, 0, 2)
        acts = self._inverse_mass[:, None]
        free = v + h * acts * force + h * (acts > 0) * np.array(_numbers(self._newton.gravity))
        turned = w + h * self._inverse_inertia[:, None] * torque
        return places, {"v": free, "w": turned}, {"v": np.ascontiguousarray(v), "w": np.ascontiguousarray(w)}

    def _look_at_collider(self):
        """The candidates, whenever the collider has run: pairs (body, counterpart) of ids, sorted, of which one can
        move, their rows, walls and radii."""
        key = self._collider and (self._collider.numAction, len(O.interactions))
        if key and key == self._collided:
            return
        found = np.array([(i.id1, i.id2) for i in O.interactions.all(onlyReal=False)], np.int64).reshape(-1, 2)
        found = found[self._is_known[found].all(axis=1)]  # the collider removes those of erased bodies later
        is_counterpart = self._row[found] < 0  # a wall
        turned = is_counterpart[:, 0] | ((found[:, 0] < found[:, 1]) & ~is_counterpart[:, 1])
        found[turned] = found[turned, ::-1]
        found = found[np.lexsort(found.T[::-1])]
        inverse = np.append(self._inverse_mass, 0.0)
        self._pairs = found[(inverse[self._row[found]] > 0).any(axis=1)]
        self._body, self._counterpart = self._row[self._pairs].astype(np.int32).T.copy()
        other = np.where(self._counterpart < 0, self._body, self._counterpart)
        self._radii = self._radius[np.column_stack([self._body, other])]
        wall_of = {number: k for k, number in enumerate(self._walls)}
        self._wall = np.array([wall_of[i] for i in self._pairs[self._counterpart < 0, 1].tolist()], np.int64)
        self._collided = key

    def _geometry(self, places, v, h):
        spins = np.array([self._spin(wall) for wall in self._walls.values()])
        self._look_at_collider()
        body, counterpart, radius = self._body, self._counterpart, self._radii
        at = counterpart < 0
        other, (wall_velocity, wall_previous, wall_spin) = places[counterpart], np.zeros((3, len(body), 3))
        if at.any():
            other[at], wall_velocity[at], wall_previous[at], wall_spin[at] = self._at_walls(
                spins, places[body[at]], v[body[at]], radius[at, 0], h
            )
        apart = places[body] - other
        length = np.linalg.norm(apart, axis=1)
        return {
            "normal": apart / length[:, None],
            "gap": length - radius[:, 0] - radius[:, 1],
            "wall_velocity": wall_velocity,
            "wall_previous": wall_previous,
            "wall_spin": wall_spin,
        }

    def _at_walls(self, spins, centre, v, radius, h):
        """For spheres at walls: the centres of as large ones behind them, velocities after and before, spins."""
        walls, which = self._walls.values(), self._wall
        place, velocity = (
            np.array([_numbers(getattr(w.state, name)) for w in walls])[which] for name in ("pos", "vel")
        )
        spin = spins[which]
        axis, sense = (np.array([getattr(w.shape, name) for w in walls])[which] for name in ("axis", "sense"))
        rows = np.arange(len(which))
        plane = place[rows, axis]
        side = np.where(sense != 0, np.sign(sense), np.where(centre[rows, axis] >= plane, 1.0, -1.0))
        # A point behind the wall, so that a centre which has sunk into it still finds its way out.
        other = centre.copy()
        other[rows, axis] = plane - side * radius
        # In the middle of the step, where the mean of a turning wall's velocity is found to O(h^2).
        from_axis, drift = centre - place, v - velocity
        after, before = (velocity + np.cross(spin, from_axis + ahead * drift) for ahead in (0.5 * h, -0.5 * h))
        return other, after, before, spin

    @staticmethod
    def _spin(wall):
        spin = _numbers(wall.state.angVel)
        if any(spin[:wall.shape.axis] + spin[wall.shape.axis + 1:]):
            found = f"angVel {tuple(spin)}"
            raise NotImplementedError(f"ilaw: body {wall.id}: {found}, expected a spin about the wall's normal")
        return spin

    def _group(self, geometry):
        """The contacts with what is remembered of them; new ones get the law's first state."""
        radius, normal = self._radii, geometry["normal"]
        old, begin = self._remembered()
        area = np.pi * radius.min(axis=1) ** 2 if self.area is None else self.area
        group = Group(
            self.law, body=self._body, counterpart=self._counterpart, area=area, arm=-radius[:, :1] * normal,
            counterpart_arm=radius[:, 1:] * normal, **geometry, energy=True, **begin,
        )  # fmt: skip
        group.initialise(~old, time=O.time)
        return group

    def _remembered(self):
        """Which of the candidates were there in the step before, and impulses and states of these."""
        if self.pairs is self._pairs:
            return np.ones(len(self.pairs), bool), {name: getattr(self, name).copy() for name in self._widths}
        span = len(O.bodies)
        keys, known = self._pairs @ [span, 1], self.pairs @ [span, 1]
        where = np.searchsorted(known, keys)
        old = np.zeros(len(keys), bool)
        inside = where < len(known)
        old[inside] = known[where[inside]] == keys[inside]
        begin = {name: np.zeros((len(keys), width)) for name, width in self._widths.items()}
        for name, array in begin.items():
            array[old] = getattr(self, name)[where[old]]
        return old, begin

    def _add_forces(self, bodies, h):
        pushed = bodies.impulse.any(axis=1) | bodies.angular_impulse.any(axis=1)
        pushed &= self._inverse_mass > 0
        force, torque = (array[pushed] / h for array in (bodies.impulse, bodies.angular_impulse))
        add_force, add_torque = O.forces.addF, O.forces.addT
        for i, f, t in zip(self._ids[pushed].tolist(), force.tolist(), torque.tolist()):
            add_force(i, f)
            add_torque(i, t)
