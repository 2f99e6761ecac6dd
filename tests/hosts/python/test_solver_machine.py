"""One solver of coupled contacts as a state machine: drawn sequences of contacts that come, go and change places, warm
starts, steps that are repeated, refusals, laws that refuse a contact from some call on, other threads, processes, ranks
and problems.

A solver keeps its memory and none of the numbers in it. So each solve must have the bits of a new solver, with the
contacts in another order as well, unless they have the same bodies; and the laws alone, asked at the velocities that
came out, must answer with the impulses. A sequence that fails is shortened. ILAW_SOLVER_SEED draws others,
ILAW_SOLVER_SEQUENCES more of them.
"""
import ctypes
import os
import pathlib
import signal
import sys
import threading
import types
import typing

import numpy as np
from ranks import on_two_ranks

import ilaw
from ilaw import _abi
from ilaw.coupled import Bodies, Contacts, Solver

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from state_machine import Broken, demand, search  # noqa: E402

SEED = int(os.environ.get("ILAW_SOLVER_SEED", "57"))
SEQUENCES = int(os.environ.get("ILAW_SOLVER_SEQUENCES", "100"))
H, G, RADIUS, BODIES, CANDIDATES = 1e-3, 10.0, 0.5, 8, 24
# Laws that take turns among the contacts, and the form of H.
KINDS = {
    "contact": ("scalar", [("contact", {})]), "friction": ("scalar", [("coulomb", {"friction": 0.3})]),
    "bonds": ("scalar", [("coulomb", {"friction": 0.5}), ("tie", {})]),
    "memory": ("scalar", [("postit", {"adhesion_limit": 2.0, "initial_adhesion": 0.5, "memory": 0.01})]),
    "turning": ("full", [("coulomb", {"friction": 0.4})]),
    "spheres": ("transverse", [("coulomb", {"friction": 0.4})]),
    "spins": ("transverse_spin", [("rolling", {"friction": 0.4, "rolling_friction": 0.02})]),
}


class Solve(typing.NamedTuple):
    by: str = ""  # "thread", "child" or "both": two threads at once
    sweeps: int = 1000
    warm: bool = True
    accepts: bool = True  # else the host repeats the step
    bad: float = -1.0  # the contact at this part of the list has no normal, or no arm


class Add(typing.NamedTuple):
    contact: int


class Remove(typing.NamedTuple):
    place: float


class Reorder(typing.NamedTuple):
    seed: int


class Refuse(typing.NamedTuple):
    how: str  # of REFUSALS
    place: float = 0.0


class Rename(typing.NamedTuple):
    """An interface of this kind with a letter more in one of its texts."""
    place: float
    where: float
    letter: str


class Tire(typing.NamedTuple):
    """The law of a contact refuses it from one of the calls on that a solve makes."""
    contact: float
    call: float
    sweeps: int = 1000


class Lattice(typing.NamedTuple):
    """Another problem with so many contacts that threads share them."""
    threads: int
    by: str = ""


class NoNumbers:
    """Ranks whose largest number is none."""

    def sum_bodies(self, values):
        pass

    def sum(self, values):
        pass

    def largest(self, values):
        values[:] = np.nan


# By a word of the reason. The last three are of bodies and groups, the others of a solve.
REFUSALS = {"tolerance": {"tolerance": np.nan}, "rounding": {"rounding": np.inf}, "speed": {"speed": -1.0},
            "exchange": {"exchange": NoNumbers()}, "inverse_mass": {"inverse_mass": np.nan}, "twice": {"twice": True},
            "overlaps itself": {"overlaps": True}}
OUTPUTS = ["impulse", "moment", "state_out", "energy"]


class Kind:
    """The contacts that may come, by their numbers, and the velocities with which all begins."""

    def __init__(self, name):
        self.name, (self.form, laws) = name, KINDS[name]
        self.laws = [ilaw.Interface(law, delassus=self.form, velocity_step=H, **given) for law, given in laws]
        draw = np.random.default_rng(sum(name.encode()))
        self.rotates = self.form != "scalar"
        self.mass = draw.uniform(0.5, 4.0, BODIES)
        self.inertia = 0.4 * self.mass * RADIUS**2
        self.v, self.w = draw.uniform(-1, 1, (BODIES, 3)), draw.uniform(-1, 1, (BODIES, 3)) * self.rotates
        self.body = draw.integers(0, BODIES, CANDIDATES).astype(np.int32)
        other = draw.integers(0, BODIES, CANDIDATES)
        self.counterpart = np.where((other == self.body) | (draw.random(CANDIDATES) < 0.3), -1, other).astype(np.int32)
        normal = draw.normal(size=(CANDIDATES, 3)) + [0, 0, 2]
        self.normal = normal / np.linalg.norm(normal, axis=1)[:, None]
        self.gap = draw.choice([0.0, 1e-5, 1e-4], CANDIDATES)
        self.state = [self.contacts(law, np.arange(CANDIDATES)).state for law in range(len(self.laws))]

    def law_of(self, contact):
        return contact % len(self.laws)

    def contacts(self, law, chosen, impulse=None, moment=None, state=None, bad=None, first=0):
        normal, arm = self.normal[chosen].copy(), -RADIUS * self.normal[chosen]
        (arm if self.form == "full" else normal)[chosen == bad] = np.nan
        turns = {"arm": arm, "counterpart_arm": -arm}
        other = self.counterpart[chosen]
        made = Contacts(self.laws[law], body=(self.body[chosen] - first) % BODIES,
                        counterpart=np.where(other < 0, -1, (other - first) % BODIES),
                        normal=normal, gap=self.gap[chosen], area=1.0,
                        energy=True, impulse=impulse, moment=moment, state=state, **(turns if self.rotates else {}))
        if state is None:
            made.initialise()
        return made


class Found(typing.NamedTuple):
    """What a solve wrote, contact by contact and body by body."""
    contacts: dict  # impulse, moment, state, energy, status
    v: np.ndarray
    w: np.ndarray
    report: tuple

    def __eq__(self, other):
        return all(np.array_equal(a, b, equal_nan=True) for a, b in zip(self.arrays(), other.arrays()))

    def arrays(self):
        return [self.v, self.w, *(array for _, arrays in sorted(self.contacts.items()) for array in arrays)]


class Grains:
    """Grains on a lattice, one group for all: what one thread of a new solver finds, which any must find."""
    SIDE = 22

    def __init__(self):
        self.law = ilaw.Interface("coulomb", delassus="transverse", velocity_step=H, friction=0.3)
        place = np.indices([self.SIDE] * 3).reshape(3, -1)
        draw = np.random.default_rng(5)
        self.v, self.w = 0.01 * draw.uniform(-1, 1, (2, self.SIDE**3, 3))
        self.v[:, 2] -= H * G
        number, body, counterpart, normal = np.arange(self.SIDE**3), [], [], []
        for axis in range(3):
            below = number - self.SIDE ** (2 - axis)
            body.append(number)
            counterpart.append(np.where(place[axis] == 0, -1, below))
            normal.append(np.tile(np.eye(3)[axis], (self.SIDE**3, 1)))
        self.body, self.counterpart, self.normal = map(np.concatenate, (body, counterpart, normal))
        self.gap = 1e-5 * draw.random(len(self.body))
        self.expected = self.solve(Solver(), 1)

    def solve(self, solver, threads):
        bodies = Bodies(v_free=self.v, v_previous=self.v, spin_free=self.w, spin_previous=self.w, inverse_mass=0.5,
                        inverse_inertia=5.0)
        contacts = Contacts(self.law, body=self.body, counterpart=self.counterpart, gap=self.gap, normal=self.normal,
                            arm=-RADIUS * self.normal, counterpart_arm=RADIUS * self.normal)
        solver.solve(bodies, [contacts], time=H, most_sweeps=5, threads=threads)
        return contacts.impulse


def relative(kind, chosen, v, w):
    """Velocities at contacts of the bodies without walls' own."""
    n, a, b = kind.normal[chosen], kind.body[chosen], kind.counterpart[chosen]
    at = v[a] + np.cross(w[a], -RADIUS * n)
    return at - np.where(b[:, None] < 0, 0.0, v[b] + np.cross(w[b], RADIUS * n))


def delassus(kind, chosen):
    """H of each contact alone, three by three."""
    found = np.zeros((len(chosen), 3, 3))
    for k, contact in enumerate(chosen):
        n = kind.normal[contact]
        for body in (kind.body[contact], kind.counterpart[contact]):
            if body >= 0:
                lever = RADIUS**2 / kind.inertia[body] if kind.rotates else 0.0
                found[k] += np.eye(3) / kind.mass[body] + lever * (np.eye(3) - np.outer(n, n))
    return found


def of_form(kind, h, chosen):
    if kind.form == "scalar":
        return h[:, 0, 0]
    if kind.form == "full":
        return np.stack([h[:, i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))], axis=1)
    n = kind.normal[chosen]
    along = np.einsum("ki,kij,kj->k", n, h, n)
    return np.stack([along, (np.trace(h, axis1=1, axis2=2) - along) / 2], axis=1)


class Machine:
    def __init__(self, kind, grains, seen):
        self.kind, self.grains, self.seen = kind, grains, seen
        self.solver, self.steps = Solver(), 0
        self.order = []  # the contacts that are there
        self.kept = {}  # impulse, moment, state of each
        self.v, self.w = kind.v.copy(), kind.w.copy()

    def do(self, action):
        getattr(self, type(action).__name__.lower())(action)

    def add(self, action):
        if action.contact not in self.order:
            self.order.append(action.contact)
            state = self.kind.state[self.kind.law_of(action.contact)][action.contact]
            self.kept[action.contact] = np.zeros(3), np.zeros(3), state.copy()

    def remove(self, action):
        if self.order:
            self.order.pop(int(action.place * len(self.order)))

    def reorder(self, action):
        np.random.default_rng(action.seed).shuffle(self.order)

    def rename(self, action):
        """Whatever a text is for, another one is not taken for it."""
        law, given = KINDS[self.kind.name][1][-1]
        texts = [law, self.kind.form, "global", *given]
        at = int(action.place * len(texts))
        letter = int(action.where * (len(texts[at]) + 1))
        texts[at] = texts[at][:letter] + action.letter + texts[at][letter:]
        law, form, frame, *names = texts
        try:
            ilaw.Interface(law, delassus=form, frame=frame, velocity_step=H, **dict(zip(names, given.values())))
        except ilaw.Error:
            return
        demand(False, "takes", texts)

    def tire(self, action):
        if not self.order:
            return
        solve = Solve(sweeps=action.sweeps, bad=action.contact)
        chosen = self.order[int(action.contact * len(self.order))]
        healthy = Tired(self.kind, chosen, None)
        self.call(Solver(), self.order, solve._replace(bad=-1.0), law=healthy)
        tired = Tired(self.kind, chosen, 1 + int(action.call * healthy.calls))
        found, report = self.call(Solver(), self.order, solve._replace(bad=-1.0), law=tired)
        if tired.has_refused:
            demand(report.reason == "too tired", "the reason is", report.reason)
            self.judge(solve, found, report)
            self.seen["tired"] = self.seen.get("tired", 0) + 1

    def lattice(self, action):
        def solve():
            found = self.grains.solve(self.solver, action.threads)
            demand(np.array_equal(found, self.grains.expected), "threads give other bits")
        self.beside(action.by, solve)

    @staticmethod
    def beside(by, *calls):
        """What calls give: here, in threads, or, without what they give, in a child of this process."""
        given = []

        def caught(call):
            try:
                given.append(call())
            except Exception as error:  # noqa: BLE001
                given.append(error)
        if by == "child":
            child = os.fork()
            if child == 0:
                signal.alarm(60)  # instead of waiting for threads that are not there
                for call in calls:
                    caught(call)
                os._exit(any(isinstance(one, Exception) for one in given))
            demand(os.waitpid(child, 0)[1] == 0, "fails in a child")
        threads = [threading.Thread(target=caught, args=(call,)) for call in calls if by in ("thread", "both")]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for call in calls if by in ("", "child") else []:
            caught(call)
        for one in given:
            if isinstance(one, Exception):
                raise one
        return given

    # ---- a step

    def call(self, solver, order, action, first=0, **options):
        """first: the body that comes first, the others behind it in turn."""
        kind = self.kind
        v, v_previous, w, w_previous, mass, inertia = (
            np.roll(array, -first, axis=0)
            for array in (self.v + [0, 0, -G * H], self.v, self.w, self.w, kind.mass, kind.inertia))
        turns = {"spin_free": w, "spin_previous": w_previous, "inverse_inertia": 1 / inertia} if kind.rotates else {}
        owned = {"owned": BODIES // 2} if "exchange" in options else {}
        inverse_mass = 1 / mass
        inverse_mass[-1] = options.pop("inverse_mass", inverse_mass[-1])
        bodies = Bodies(v_free=v, v_previous=v_previous, inverse_mass=inverse_mass, **turns, **owned)
        bad = self.order[int(action.bad * len(self.order))] if action.bad >= 0 and self.order else None
        groups, chosen = [], []
        for law in range(len(kind.laws)):
            mine = np.array([contact for contact in order if kind.law_of(contact) == law], int)
            impulse, moment = (np.array([self.kept[c][i] * action.warm for c in mine]).reshape(-1, 3) for i in (0, 1))
            state = np.array([self.kept[c][2] for c in mine]).reshape(len(mine), kind.laws[law].state_size)
            moment = moment if kind.form == "transverse_spin" else None
            groups.append(kind.contacts(law, mine, impulse, moment, state, bad, first))
            chosen.append(mine)
            if law := options.get("law"):
                groups[-1]._struct.law = law.instead_of(groups[-1]._struct.law)
        options.pop("law", None)
        groups += groups[:1] * options.pop("twice", False)
        if name := options.pop("overlaps", None):
            getattr(groups[0]._batch, name).node_stride = 0
        before = [[array.copy() for array in outputs(bodies, group)] for group in groups]
        try:
            report = solver.solve(bodies, groups, time=(self.steps + 1) * H, bad_nodes="report",
                                  **{"most_sweeps": action.sweeps, **options})
        except ilaw.Error as error:
            for group, arrays in zip(groups, before):
                demand(all(map(np.array_equal, arrays, outputs(bodies, group))), "a refusal writes")
            return None, error
        contacts = {contact: [group.impulse[k], moment_of(group, k), group.state[k], group.energy[k], group.status[k]]
                    for group, mine in zip(groups, chosen) for k, contact in enumerate(mine)}
        said = tuple(np.asarray(value).tobytes() if not isinstance(value, (str, tuple, type(None))) else value
                     for value in vars(report).values())
        v, w = (np.roll(array, first, axis=0) for array in (bodies.velocity, bodies.spin if kind.rotates else w))
        return Found(contacts, v, w, said), report

    def bodies_of(self, contact):
        return self.kind.body[contact], self.kind.counterpart[contact]

    def solve(self, action):
        new, report = self.call(Solver(), self.order, action)
        # Contacts of the same bodies keep their order: it decides which of several solutions is found.
        other, _ = self.call(Solver(), sorted(self.order, key=self.bodies_of), action)
        demand(new == other, "the order of contacts changes bits")
        self.judge(action, *self.call(Solver(), self.order[::-1], action))
        solves = [lambda: self.call(self.solver, self.order, action)] * (2 if action.by == "both" else 1)
        if action.by == "child":
            solves.append(lambda: self.same(new, self.call(self.solver, self.order, action)))
        given = [one for one in self.beside(action.by, *solves) if one]
        found = [one for one in given if one[0] is not None]
        demand(found, "two solves refuse each other")
        for one, said in given:
            demand(one is not None or "another thread" in str(said), said)
        for one in found:
            self.same(new, one)
        self.judge(action, new, report)
        if action.by == "" and action.bad < 0:
            self.ranks(action)
        if action.accepts:
            self.v, self.w = new.v, new.w
            self.kept.update({contact: arrays[:3] for contact, arrays in new.contacts.items()})
            self.steps += 1

    def ranks(self, action):
        """The step on two ranks, each with its own half of the bodies first, and their contacts."""
        first = 0, BODIES // 2

        def solve(rank, exchange):
            mine = [contact for contact in self.order if (self.kind.body[contact] < BODIES // 2) == (rank == 0)]
            return self.call(Solver(), mine, action, first[rank], exchange=exchange)
        (one, report), (other, same) = on_two_ranks(BODIES, solve, first)
        demand(one is not None and other is not None, "refused on ranks:", report, same)
        demand(np.array_equal(one.v, other.v) and np.array_equal(one.w, other.w), "copies are not as their owners have them")
        demand((report.sweeps, report.residual) == (same.sweeps, same.residual), "ranks say other things")
        both = types.SimpleNamespace(message=report.message or same.message, bad_count=0, work=report.work + same.work)
        self.judge(action, one._replace(contacts=one.contacts | other.contacts), both)
        self.seen["on ranks"] = self.seen.get("on ranks", 0) + (not both.message and len(self.order) > 0)

    @staticmethod
    def same(new, found):
        demand(found[0] is not None, "refused:", found[1])
        demand(new == found[0], "other bits than a new solver's")
        demand(new.report == found[0].report, "another report than a new solver's")

    def judge(self, action, found, report):
        """Without the solver: momentum, work, and each law alone at the velocities that came out."""
        kind, chosen = self.kind, np.array(self.order, int)
        free = self.v + [0, 0, -G * H]
        r = np.array([found.contacts[c][0] for c in chosen]).reshape(-1, 3)
        moment = np.array([found.contacts[c][1] for c in chosen]).reshape(-1, 3)
        v, w = free.copy(), self.w.copy()
        for k, c in enumerate(chosen):
            for body, sign in ((kind.body[c], 1), (kind.counterpart[c], -1)):
                if body >= 0:
                    v[body] += sign * r[k] / kind.mass[body]
                    arm = -sign * RADIUS * kind.normal[c]
                    w[body] += kind.rotates * sign * (np.cross(arm, r[k]) + moment[k]) / kind.inertia[body]
        scale = max(1.0, np.abs(r).max(initial=0.0) / kind.mass.min())
        demand(np.abs(v - found.v).max() < 1e-12 * scale, "momentum is not kept")
        demand(np.abs(w - found.w).max() < 1e-11 * scale, "angular momentum is not kept")
        if action.bad >= 0 and self.order:
            bad = self.order[int(action.bad * len(self.order))]
            demand(report.bad_count == 1 and found.contacts[bad][4] == ilaw.Status.BAD_INPUT, "a bad contact is lost")
            demand(not found.contacts[bad][0].any(), "a bad contact has an impulse")
        if report.message or report.bad_count or not self.order:
            return
        now, before = relative(kind, chosen, found.v, found.w), relative(kind, chosen, self.v, self.w)
        if kind.form != "transverse_spin":
            demand(abs(report.work - 0.5 * np.sum(r * (now + before))) < 1e-11 * scale, "work is not of the impulses")
            # A bond that broke in an iteration stays broken, whatever the law says of the velocities in the end.
            holds = np.array([found.contacts[c][4] != ilaw.Status.BROKEN for c in chosen])
            self.judge_laws(chosen[holds], r[holds], now[holds], before[holds], free)
        self.seen["judged"] = self.seen.get("judged", 0) + 1

    def judge_laws(self, chosen, r, now, before, free):
        kind = self.kind
        h, smooth = delassus(kind, chosen), relative(kind, chosen, free, self.w)
        own = now - np.einsum("kij,kj->ki", h, r)
        for law, interface in enumerate(kind.laws):
            mine = np.array([k for k, c in enumerate(chosen) if kind.law_of(c) == law], int)
            contacts = chosen[mine]
            state = np.array([self.kept[c][2] for c in contacts]).reshape(len(mine), interface.state_size)
            alone = interface.batch(
                v_free=own[mine], v_smooth=smooth[mine], v_previous=before[mine], gap=kind.gap[contacts], area=1.0,
                normal=kind.normal[contacts], delassus=of_form(kind, h[mine], contacts), state=state)
            alone.evaluate(time=(self.steps + 1) * H)
            off = np.abs(np.einsum("kij,kj->ki", h[mine], alone.impulse - r[mine])).max(initial=0.0)
            demand(off < 1e-8, "a law alone answers otherwise, by", off)

    def refuse(self, action):
        if action.how == "exchange" and not self.order:
            return  # ranks without contacts have nothing to agree on
        options = REFUSALS[action.how]
        if action.how == "overlaps itself":
            law = self.kind.laws[0]
            outputs = [name for name in OUTPUTS if (name != "moment" or self.kind.form == "transverse_spin")
                       and (name != "state_out" or law.state_size > 0)]
            options = {"overlaps": outputs[int(action.place * len(outputs))]}
            if sum(self.kind.law_of(contact) == 0 for contact in self.order) < 2:
                return  # nothing to overlap
        found, error = self.call(self.solver, self.order, Solve(), **options)
        demand(found is None, "not refused:", action.how)
        demand(action.how in str(error), "refused with", error)


class Tired:
    """Laws that count their calls, and refuse a contact from the n-th one on."""

    def __init__(self, kind, contact, n):
        self.normal, self.n, self.calls, self.has_refused = kind.normal[contact], n, 0, False
        law = ilaw.describe(KINDS[kind.name][1][kind.law_of(contact)][0])
        self.holds_bonds = ilaw.Capability.HOLD_BONDS in law.capabilities
        self.iterates = False  # else all is solved, and is asked for energies or for bonds that break
        self.kept, self.reason = [], ctypes.c_char_p(b"too tired")

    def instead_of(self, pointer):
        law = _abi.law.from_buffer_copy(pointer[0])
        usual = type(law.evaluate)(ctypes.cast(law.evaluate, ctypes.c_void_p).value)  # a member that is read is a reference

        def evaluate(instance, batch, report):
            code, batch = usual(instance, batch, report), batch[0]
            self.calls += 1
            index = ctypes.cast(batch.index, ctypes.POINTER(ctypes.c_int32))
            nodes = index[:batch.node_count] if index else range(batch.node_count)
            if not index:  # those with an index ask for the broken ones among the last nodes
                self.iterates = not batch.energy.values and bool(batch.flags or not self.holds_bonds)
            for node in nodes if self.n is not None and self.calls >= self.n else []:
                if any(at(batch.normal, node, c) != self.normal[c] for c in range(3)):
                    continue
                for output in (batch.impulse, batch.moment):
                    for c in range(3 if output.values else 0):
                        put(output, node, c, 0.0)
                ctypes.cast(batch.status, ctypes.POINTER(ctypes.c_uint8))[node * batch.status_stride] = ilaw.Status.BAD_INPUT
                report[0].bad_count, report[0].first_bad_node, report[0].reason = 1, node, self.reason
                code, self.has_refused = _abi.Code.BAD_NODES, self.has_refused or self.iterates
            return code

        law.evaluate = type(usual)(evaluate)
        self.kept.append(law)
        return ctypes.pointer(law)


def place_of(array, node, component):
    number = node * array.node_stride + component * array.component_stride
    return ctypes.cast(array.values, ctypes.POINTER(ctypes.c_double)), number


def at(array, node, component):
    values, k = place_of(array, node, component)
    return values[k]


def put(array, node, component, value):
    values, k = place_of(array, node, component)
    values[k] = value


def moment_of(group, k):
    return np.zeros(3) if group.moment is None else group.moment[k]


def outputs(bodies, group):
    return [bodies.velocity, group.impulse, group.state, group.energy, group.status]


# ---- sequences -------------------------------------------------------------------------------------------


def drawn_action(draw):
    kind = draw.choices(["solve", "add", "remove", "reorder", "refuse", "rename", "tire", "lattice"],
                        [10, 8, 3, 2, 1, 1, 2, 1])[0]
    if kind == "solve":
        return Solve(draw.choices(["", "thread", "child", "both"], [6, 2, 1, 2])[0], draw.choice([1000, 1000, 3, 40]),
                     draw.random() < 0.7, draw.random() < 0.7, draw.random() if draw.random() < 0.1 else -1.0)
    if kind == "lattice":
        return Lattice(draw.choice([1, 2, 3, 5]), draw.choice(["", "", "thread", "child"]))
    return {"add": lambda: Add(draw.randrange(CANDIDATES)), "remove": lambda: Remove(draw.random()),
            "reorder": lambda: Reorder(draw.randrange(1000)),
            "rename": lambda: Rename(draw.random(), draw.choice([0.0, draw.random(), 0.999]), draw.choice("\0\0 /.x")),
            "tire": lambda: Tire(draw.random(), draw.random(), draw.choice([1000, 40, 12])),
            "refuse": lambda: Refuse(draw.choice(sorted(REFUSALS)), draw.random())}[kind]()


def plainer(action):
    if isinstance(action, Solve):
        for plain in ({"by": ""}, {"bad": -1.0}, {"warm": False}, {"accepts": True}, {"sweeps": 1000}):
            yield action._replace(**plain)
    elif isinstance(action, Lattice):
        yield Lattice(1)


def failure_of(sequence, grains, seen):
    """The first action names the kind of contacts."""
    if not sequence or not isinstance(sequence[0], str):
        return ""
    machine = Machine(Kind(sequence[0]), grains, seen)
    try:
        for action in sequence[1:]:
            machine.do(action)
    except Broken as broken:
        return str(broken)
    return ""


def drawn_sequence(draw):
    return [draw.choice(sorted(KINDS)), *(drawn_action(draw) for _ in range(draw.randint(5, 25)))]


def test_a_solver_gives_what_a_new_one_gives():
    grains, seen = Grains(), {}
    sequence, why = search(SEED, SEQUENCES, drawn_sequence, lambda drawn: failure_of(drawn, grains, seen), plainer)
    assert not sequence, f"seed {SEED}: {why}\n" + "\n".join(map(str, sequence))
    assert seen["judged"] > SEQUENCES and seen["on ranks"] > SEQUENCES / 2 and seen["tired"] > SEQUENCES / 4
