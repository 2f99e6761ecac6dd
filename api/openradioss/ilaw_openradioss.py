"""Interface laws in OpenRadioss, by the function sync(context) of a deck: no user library, nothing recompiled.

    /FUNCT_PYTHON/1
    def sync(context):
        import ilaw_openradioss
        ilaw_openradioss.sync(context, TIME, DT, [
            dict(law="coulomb", friction=0.3, nodes=range(1, 46), plane=([0, 0, 0], [0, 0, 1]))])

The engine calls sync at the end of each cycle, with V the half-step velocity after all forces and constraints, and X
moved by it: V is v_free, and the gap is that of X - DT V. `sync` below says what a contact may have.
SPDX-License-Identifier: BSD-3-Clause
"""
import ctypes
import os
import sys
from pathlib import Path

import ilaw
import numpy as np
from ilaw import shapes
from ilaw.coupled import Bodies, Contacts, Solver
from ilaw.search import Facets

sys.path.insert(0, os.getcwd())  # files beside the deck, which the engine's Python would not find
NAMES = {"X": 3, "V": 3, "D": 3, "MS": 1, "ITAB": 1, "IKINE": 1, "WEIGHT": 1}
SHAPES = {"plane": shapes.plane, "sphere": shapes.sphere, "cylinder": shapes.cylinder}
OWN = {"law", "nodes", "area", "velocity", "held", "name", "facets", *SHAPES}
MOST_MESSAGES = 10
MOST_PUSHES = 20  # in successive steps that move nothing else; a landing takes two
ROUNDING = 1e-9  # of an impulse, beside the momentum of a node
RIM = 0.01  # of the longest edge: facets go on by it beyond the border of a surface, where nodes face its corners


class Refused(RuntimeError):
    """What a law cannot act on, with the user numbers of the nodes."""


def arrays_of(context):
    """The engine's own arrays, as numpy's."""
    missing = [name + part for name in NAMES for part in ("_ptr", "_size", "_type") if name + part not in context]
    if missing:
        raise Refused(f"context has no {', '.join(missing)}: this release has other names, expected those of "
                      f"{', '.join(NAMES)}")
    arrays = {}
    for name, components in NAMES.items():
        kind = {"double": ctypes.c_double, "int": ctypes.c_int}.get(context[name + "_type"])
        if kind is None:
            raise Refused(f"context: {name}_type is {context[name + '_type']!r}, expected 'double' or 'int'")
        values = np.ctypeslib.as_array((kind * context[name + "_size"]).from_address(context[name + "_ptr"]))
        arrays[name] = values.reshape(-1, components) if components > 1 else values
    return arrays


def listed(numbers):
    """User numbers for a message."""
    shown = ", ".join(str(n) for n in numbers[:10])
    return shown + (f" and {len(numbers) - 10} more" if len(numbers) > 10 else "")


def rank_variable(name, default):
    return os.environ.get("OMPI_COMM_WORLD_" + name, os.environ.get("PMI_" + name, default))


class Group:
    """Nodes that one law acts on, against a rigid shape or facets of a deformable body."""

    def __init__(self, number, given):
        against = [name for name in ("facets", *SHAPES) if name in given]
        self.name = given.get("name", f"{given.get('law', 'contact')}{number}")
        if len(against) != 1 or "law" not in given or "nodes" not in given:
            raise Refused(f"contact '{self.name}': found {sorted(given)}, expected law, nodes, and one of "
                          f"facets, {', '.join(SHAPES)}")
        self.shape, self.given = against[0], given
        self.nodes = [int(n) for n in given["nodes"]]
        numbers, counts = np.unique(self.nodes, return_counts=True)
        twice = numbers[counts > 1].tolist()
        if twice:
            raise Refused(f"contact '{self.name}': node {listed(twice)} twice, expected each once")
        self.facets = [[int(n) for n in facet] for facet in given.get("facets", [])]
        self.search = None
        self.held, self.velocity = given.get("held"), np.asarray(given.get("velocity", (0.0, 0.0, 0.0)), float)
        parameters = {name: value for name, value in given.items() if name not in OWN}
        self.law = ilaw.Interface(given["law"], velocity_step=1.0, delassus="full" if self.held else "scalar",
                                  parameters=parameters)  # fmt: skip

    def users(self):
        return [*self.nodes, *(n for facet in self.facets for n in facet)]

    def place(self, body_of, x):
        """Numbers of the bodies, and the law's first state. Nodes of other ranks are left to these."""
        self.nodes = [n for n in self.nodes if n in body_of]
        count = len(self.nodes)
        self.body = np.array([body_of[n] for n in self.nodes], np.int32)
        self.corner = np.array([[body_of[n] for n in facet] for facet in self.facets], np.int32)
        self.impulse, self.state = np.zeros((count, 3)), np.zeros((count, self.law.state_size))
        self.gap, self.normal, self.pushes = np.zeros(count), np.zeros((count, 3)), np.zeros((count, 3), int)
        area = self.given.get("area")
        self.area = None if area is None else np.broadcast_to(np.asarray(area, float), count).copy()
        self.chosen = np.arange(count)
        if self.shape == "facets":
            edges = x[self.corner] - x[np.roll(self.corner, 1, axis=1)]
            self.rim = RIM * np.linalg.norm(edges, axis=2).max(initial=0.0)
            self.search = Facets(self.corner, self.body, x)
            self.search.update(x)
            self.meet(np.inf)
        else:
            self.meet_shape(x, 0.0)
            self.contacts = self.describe(
                counterpart=np.full(count, -1, np.int32), wall_velocity=np.tile(self.velocity, (count, 1))
            )
        self.contacts.initialise()
        if self.search:
            self.state[self.chosen] = self.contacts.state
        self.first = self.state.copy()

    def describe(self, **side):
        """The chosen contacts as the solver takes them; where all are chosen, in the arrays of the group."""
        part = (lambda array: array) if self.search is None else (lambda array: array[self.chosen])
        extra = {} if self.area is None else {"area": part(self.area)}
        return Contacts(self.law, body=part(self.body), gap=part(self.gap), normal=part(self.normal), energy=True,
                        impulse=part(self.impulse), state=part(self.state), **side, **extra)  # fmt: skip

    def begin(self, x, time, impulse_scale, reach):
        """Gaps and normals of a step at positions x. Iterations begin with the forces of the last one."""
        self.impulse *= impulse_scale
        if self.search is None:
            return self.meet_shape(x, time)
        self.search.update(x)
        self.meet(reach)

    def meet_shape(self, x, time):
        self.gap[:], self.normal[:] = SHAPES[self.shape](x[self.body] - time * self.velocity, *self.given[self.shape])

    def meet(self, reach):
        """The nodes within reach of the facets, and those with a memory or an impulse."""
        if reach < np.inf and self.law.permissions & ilaw.Permission.SKIP_FRESH:
            awake = (self.state != self.first).any(axis=1) | self.impulse.any(axis=1)
            awake[self.search.near(reach)] = True
            self.chosen = np.flatnonzero(awake)
        pairs = self.search.pairs(self.chosen, self.rim)
        self.gap[self.chosen], self.normal[self.chosen] = pairs.gap, pairs.normal
        self.contacts = self.describe(counterpart=self.corner[pairs.facet], counterpart_weight=pairs.weights)

    def refuse_held(self, still, momentum):
        """A node that is pushed along an axis step after step, and that nothing else moves along it in between.

        The engine does not say which components a /BCS holds. It clears their accelerations but not the velocities
        that a law adds, so that a node against an inclined surface would run away.
        """
        normal = self.normal[self.chosen]
        along = np.einsum("ki,ki->k", self.contacts.impulse, normal)[:, None] * normal
        pushed = np.abs(along) > ROUNDING * momentum[self.body[self.chosen], None]
        steps = np.where(pushed & still[self.body[self.chosen]], self.pushes[self.chosen] + 1, 0)
        if (steps > MOST_PUSHES).any():
            row, axis = np.argwhere(steps > MOST_PUSHES)[0]
            node, along = self.nodes[self.chosen[row]], "XYZ"[axis]
            raise Refused(f"node {node}: the law of contact '{self.name}' pushes along {along}, where nothing else moves it, "
                          f"as if a /BCS holds it; say held='{along}', or held='' if it is free")
        self.pushes[:] = 0
        self.pushes[self.chosen] = steps

    def accept(self):
        if self.search is None:
            return
        self.impulse[:] = 0.0
        self.impulse[self.chosen], self.state[self.chosen] = self.contacts.impulse, self.contacts.state


class Run:
    """The contacts of a deck, from the call before the first cycle on."""

    def __init__(self, context, time, step, contacts, threads=1, folder=".", history=None):
        self.arrays = arrays_of(context)
        self.groups = [Group(k, given) for k, given in enumerate(contacts)]
        row_of = {int(user): row for row, user in enumerate(self.arrays["ITAB"])}
        self.users = sorted({n for group in self.groups for n in group.users() if n in row_of})
        self.rows = np.array([row_of[n] for n in self.users], int)
        self.refuse_nodes(row_of)
        body_of = {n: k for k, n in enumerate(self.users)}
        self.weight = self.arrays["WEIGHT"][self.rows].astype(float)  # 1 on one rank for each node
        self.last_step, self.velocity_step, self.messages = step, 0.0, 0
        self.energy, self.work, self.threads, self.solver = np.zeros(4), np.zeros(1), threads, Solver()
        x, count = self.arrays["X"][self.rows], len(self.users)
        self.free = np.ones((count, 3))
        self.groups = [group for group in self.groups if any(n in body_of for n in group.nodes)]
        for group in self.groups:
            group.place(body_of, x)
            for axis in (group.held or "").upper():
                self.free[group.body, "XYZ".index(axis)] = 0.0
        per_axis = not self.free.all()
        self.v_free, self.v_previous = np.empty((count, 3)), self.arrays["V"][self.rows]
        self.inverse_mass = np.empty((count, 3) if per_axis else count)
        self.bodies = Bodies(v_free=self.v_free, v_previous=self.v_previous, inverse_mass=self.inverse_mass)
        self.open_state(time, Path(folder))
        suffix = "" if rank_variable("SIZE", "1") == "1" else "." + rank_variable("RANK", "0")
        self.history = open(Path(folder, history + suffix), "a" if time > 0.0 else "w") if history else None
        if self.history and not self.history.tell():
            own = [f"{group.name}.{c}" for group in self.groups for c in ("fx", "fy", "fz", "gap", "touching")]
            whole = ["friction", "impact", "rupture", "stored", "work", "iterations"]
            self.history.write(",".join(["time", *own, *whole]) + "\n")

    def refuse_nodes(self, row_of):
        missing = sorted({n for group in self.groups for n in group.users()} - row_of.keys())
        if missing and rank_variable("SIZE", "1") == "1":  # with ranks they may be on another one
            raise Refused(f"node {listed(missing)}: not in the model")
        for group in self.groups:
            elsewhere = sorted(set(group.users()) - row_of.keys())
            if elsewhere and group.facets and any(n in row_of for n in group.nodes):
                raise Refused(f"contact '{group.name}': node {listed(elsewhere)} is on another rank, expected both sides on "
                              "one (nodes that the Python text of a deck names are on all)")
        bound = [n for n, k in zip(self.users, self.arrays["IKINE"][self.rows]) if k]
        if bound:
            raise Refused(f"node {listed(bound)}: has a kinematic condition (rigid body, rigid wall, imposed velocity, "
                          "tie); the engine would undo the impulse of the law")
        light = [n for n, m in zip(self.users, self.arrays["MS"][self.rows]) if not m > 0.0]
        if light:
            raise Refused(f"node {listed(light)}: has no mass, expected a mass above 0")

    def kept(self):
        """What a continued run needs beside the last step."""
        return [self.energy, self.work, *(a for g in self.groups for a in (g.state, g.first, g.impulse))]

    def open_state(self, time, folder):
        """`kept` after the last step, in a file that fits the last restart file of the engine."""
        path = folder / f"ilaw_state_{rank_variable('RANK', '0')}.bin"
        count = 2 + sum(array.size for array in self.kept())
        if time > 0.0:
            saved = np.fromfile(path) if path.is_file() else np.empty(0)
            if saved.size != count or saved[0] != time:
                found = f"{saved.size} values at time {saved[0]:.17g}" if saved.size else "no values"
                raise Refused(f"{path}: found {found}, expected {count} at time {time:.17g}: a continued run needs the "
                              "file of the run before, which ended with the restart file")
            self.velocity_step, at = saved[1], 2
            for array in self.kept():
                array[:] = saved[at:at + array.size].reshape(array.shape)
                at += array.size
        # Mapped, since the engine ends without ending Python.
        self.memory = np.memmap(path, float, "r+" if time > 0.0 else "w+", shape=count)

    def step(self, time, step):
        x_all, v_all, d_all, mass_all = (self.arrays[name] for name in ("X", "V", "D", "MS"))
        v, bodies = v_all[self.rows], self.bodies
        mass, at, velocity_step = mass_all[self.rows], time - step, 0.5 * (self.last_step + step)
        self.v_free[:] = v
        self.inverse_mass[:] = 1.0 / mass if self.inverse_mass.ndim == 1 else self.free / mass[:, None]
        x = x_all[self.rows] - step * v  # before the engine moved them: at the time of the gaps
        speed = float(np.sqrt((v * v).sum(axis=1).max(initial=0.0)))
        reach = 4.0 * step * speed  # of both sides, and twice as fast afterwards
        for group in self.groups:
            group.begin(x, at, velocity_step / self.velocity_step if self.velocity_step else 0.0, reach)
        report = self.solver.solve(bodies, [group.contacts for group in self.groups], time=at, tolerance=1e-12,
                                   velocity_step=velocity_step, position_step=step, threads=self.threads)  # fmt: skip
        self.check(report, velocity_step, at)
        for group in self.groups:
            if group.held is None:
                group.refuse_held(v == self.v_previous, mass * speed)
            group.accept()
        change = bodies.velocity - v
        v_all[self.rows] = bodies.velocity
        x_all[self.rows] += step * change
        d_all[self.rows] += step * change
        self.work += 0.5 * np.sum((self.weight * mass)[:, None] * change * (bodies.velocity + self.v_previous))
        self.v_previous[:], self.last_step, self.velocity_step = bodies.velocity, step, velocity_step
        self.energy[3] = 0.0  # stored: of this step
        for group in self.groups:
            self.energy += self.weight[group.body[group.chosen]] @ group.contacts.energy
        self.memory[:] = np.concatenate([[time, velocity_step], *(array.ravel() for array in self.kept())])
        if self.history:
            self.write_history(at, report)

    def check(self, report, velocity_step, at):
        if velocity_step > report.stable_velocity_step:
            raise Refused(f"time {at:g}: found the step {velocity_step:g}, expected at most "
                          f"{report.stable_velocity_step:g}, which the spring of a law needs: /DTIX bounds it")
        if report.message and self.messages < MOST_MESSAGES:
            self.messages += 1
            print(f"ilaw: time {at:g}: {report.message}", file=sys.stderr)

    def write_history(self, at, report):
        row = [at]
        for group in self.groups:
            own, one = self.weight[group.body[group.chosen]], group.contacts
            row += [*(own @ one.impulse / self.velocity_step), group.gap[group.chosen].min(initial=np.inf),
                    own @ (one.status != ilaw.Status.FREE)]  # fmt: skip
        row += [*self.energy, *self.work, report.sweeps]
        self.history.write(",".join(f"{value:.12g}" for value in row) + "\n")
        self.history.flush()


_run = None


def sync(context, time, step, contacts, **options):
    """Each call of a deck's sync(context). TIME and DT are the engine's.

    contacts: for each a dict of
      law, nodes              name of a law; user numbers of the nodes that it acts on
      plane=(point, normal), sphere=(center, radius), cylinder=(point, axis, radius): a rigid shape, or
      facets                  user numbers, four (or three) per facet, seen counterclockwise from the nodes
      area                    tributary, a number or one per node, for laws that read it
      velocity                of the shape
      held                    components that a /BCS holds, as "X" or "XY"; "": none, without a check
      name                    in messages and history
      and the parameters of the law by name.
    options: threads of the solver, history (name of a CSV file), folder of the files.
    Returns the `Run`.
    """
    global _run
    if _run is None:  # the call before the first cycle
        _run = Run(context, time, step, contacts, **options)
    else:
        _run.step(time, step)
    return _run
