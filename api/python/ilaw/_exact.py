"""Solutions in closed form of some scenes, to measure errors against. Derivations: the `doc` of each scene."""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import bisect
import math
from typing import Any, Callable, NamedTuple, Optional, Sequence

import numpy as np

from ._command import BadInput

Scene = dict[str, Any]
OfTime = Callable[[np.ndarray], np.ndarray]


class Exact(NamedTuple):
    """Functions of instants: a row for each, and a column per component of the watched nodes."""

    u: OfTime
    v: OfTime
    instants: np.ndarray  # per watched node: first and last impulse, last rupture; nan: none
    # Given and done by the interface so far, if they are known; energy: the largest of the motion.
    impulse: Optional[OfTime] = None
    work: Optional[OfTime] = None
    energy: float = math.nan


class Case(NamedTuple):
    """A scene of one body, and the facts that its solution depends on."""

    scene: Scene
    body: Scene
    interface: Scene
    loads: list[Scene]  # without bulk viscosity, an aid of the mesh, which the body does not have
    end: float  # of the run, by whole steps
    step: float

    @property
    def parameters(self) -> Scene:
        return self.interface.get("parameters", {})

    def obstacle_at(self, component: int = 0) -> float:
        return self.interface["obstacle"]["point"][component]


class Path:
    """A motion by pieces, each with the position, velocity, acceleration and jerk of its start."""

    def __init__(self, pieces: Sequence[Sequence[float]]) -> None:
        table = np.array([[*piece, *[0.0] * (5 - len(piece))] for piece in pieces])
        self.starts, self.begun = table[:, 0], table[:, 1:]

    def at(self, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        piece = np.maximum(np.searchsorted(self.starts, time, side="right") - 1, 0)
        s = time - self.starts[piece]
        x, v, a, j = self.begun[piece].T
        return x + s * (v + s * (a / 2.0 + s * j / 6.0)), v + s * (a + s * j / 2.0)


def constant_between(instants: Sequence[float], velocities: Sequence[float], begins_at: float = 0.0) -> Path:
    pieces = [(0.0, begins_at, velocities[0])]
    for instant, velocity in zip(instants, velocities[1:]):
        start, x, v = pieces[-1]
        pieces.append((instant, x + v * (instant - start), velocity))
    return Path(pieces)


def of_paths(paths: Sequence[Path], instants: Sequence[Sequence[float]], **known: Any) -> Exact:
    return Exact(lambda t: np.column_stack([path.at(t)[0] for path in paths]),
                 lambda t: np.column_stack([path.at(t)[1] for path in paths]), np.array(instants, float), **known)  # fmt: skip


def instants_of(first: float = math.nan, last: float = math.nan, rupture: float = math.nan) -> list[float]:
    return [first, last, rupture]


def pushes(force: float, begins: float, ends: float) -> OfTime:
    """The impulse of a force that is constant for a while."""
    return lambda t: force * (np.clip(t, begins, ends) - begins)[:, None]


def no_work(t: np.ndarray) -> np.ndarray:
    return np.zeros(len(t))


def require(good: bool, expected: str) -> None:
    if not good:
        raise BadInput(f"/exact: expected {expected}")


# ---- points -----------------------------------------------------------------------------------------------------------


def thrown(case: Case, height: float, speed: float, e: float, mu: float, g: float) -> Exact:
    """Thrown along a plane from above it, under gravity.

    First fall t1 = sqrt(2 h0/g); flights of 2 e^k t1, which start with e^k g t1 (Moreau 1988). Every bounce takes
    mu (1 + e) times the speed of arrival from the sliding, as long as there is any; then mu g does.
    """
    mass, fall = case.body["mass"], math.sqrt(2.0 * height / g)
    rest = fall * (1.0 + e) / (1.0 - e) if e < 1.0 else math.inf
    since, x, vx, arrives = fall, speed * fall, speed, g * fall
    along, across = [(0.0, 0.0, speed)], [(0.0, 0.0, 0.0, -g)]
    while arrives > 1e-18 * g * fall and since < case.end + case.step:
        vx = max(vx - mu * (1.0 + e) * arrives, 0.0)
        arrives *= e
        along.append((since, x, vx))
        across.append((since, -height, arrives, -g))
        flight = min(2.0 * arrives / g, rest - since)
        since, x = since + flight, x + vx * flight
    if since < case.end + case.step:
        slides = vx / (mu * g) if vx > 0.0 else 0.0
        along += [(since, x, vx, -mu * g), (since + slides, x + 0.5 * slides * vx, 0.0)]
        across.append((since, -height, 0.0))
    paths = [Path(along), Path(across)] if mu > 0.0 else [Path(across)]
    energy = mass * (g * height + 0.5 * speed**2)

    def impulse(t: np.ndarray) -> np.ndarray:
        """The momentum that gravity alone does not explain."""
        columns = [mass * (paths[0].at(t)[1] - speed)] * (mu > 0.0) + [mass * (paths[-1].at(t)[1] + g * t)]
        return np.column_stack(columns)

    def work(t: np.ndarray) -> np.ndarray:
        moves = sum(path.at(t)[1] ** 2 for path in paths)
        return mass * (0.5 * moves + g * (height + paths[-1].at(t)[0])) - energy

    # Gravity presses it on the plane to the end once it rests there; until then each bounce is an impulse.
    bounces = [start for start, *_ in across[1:] if start <= case.end]
    last = math.nan if not bounces else case.end if since <= case.end else bounces[-1]
    return of_paths(paths, [instants_of(fall, last)], impulse=impulse, work=work, energy=energy)


def bouncing_ball(case: Case, wanted: str) -> Exact:
    require(case.scene["model"]["dimension"] == 1 and [load["type"] for load in case.loads] == ["gravity"]
            and "velocity" not in case.body and len(case.scene["interfaces"]) == 1
            and case.interface["law"] == "contact", wanted)  # fmt: skip
    g, height = -case.loads[0]["acceleration"][0], case.body["position"][0] - case.obstacle_at()
    require(g > 0.0 and height > 0.0, wanted)
    return thrown(case, height, 0.0, case.parameters.get("restitution", 0.0), 0.0, g)


def oblique_impact(case: Case, wanted: str) -> Exact:
    velocity, mu = case.body.get("velocity", [0.0, 0.0]), case.parameters.get("friction", 0.0)
    obstacle, e = case.interface["obstacle"], case.parameters.get("restitution", 0.0)
    require(case.scene["model"]["dimension"] == 2 and case.interface["law"] == "coulomb" and mu > 0.0
            and [load["type"] for load in case.loads] == ["gravity"] and obstacle["type"] == "plane"
            and obstacle["normal"][0] == 0.0 and velocity[1] == 0.0, wanted)  # fmt: skip
    g, height = -case.loads[0]["acceleration"][1], case.body["position"][1] - case.obstacle_at(1)
    require(g > 0.0 and height > 0.0 and e < 1.0 and velocity[0] > 0.0, wanted)
    return thrown(case, height, velocity[0], e, mu, g)


def impact_oscillator(case: Case, wanted: str) -> Exact:
    """On a spring at rest length above a stop: arcs A cos(w t - phi), from stop to stop, left at e times the speed."""
    interface, mass = case.interface, case.body["mass"]
    require(case.scene["model"]["dimension"] == 1 and not case.scene.get("loads") and interface["law"] == "contact"
            and len(case.scene["interfaces"]) == 1 and interface["obstacle"]["type"] == "plane"
            and interface["obstacle"]["normal"][0] > 0.0, wanted)  # fmt: skip
    stiffness, speed = case.body["stiffness"][0], case.body.get("velocity", [0.0])[0]
    gap, e = case.body["position"][0] - case.obstacle_at(), case.parameters.get("restitution", 0.0)
    require(stiffness > 0.0 and gap > 0.0 and speed != 0.0, wanted)
    w = math.sqrt(stiffness / mass)
    arcs, start, u, v, impulse, work = [], 0.0, 0.0, speed, 0.0, 0.0
    while start < case.end + case.step:
        size, phase = math.hypot(u, v / w), math.atan2(v / w, u)
        arcs.append((start, size, phase, impulse, work))
        start += (phase + math.acos(-gap / size)) / w if size > gap else math.inf
        arrives = w * math.sqrt(max((size - gap) * (size + gap), 0.0))
        u, v = -gap, e * arrives
        impulse += mass * (1.0 + e) * arrives
        work -= 0.5 * mass * (1.0 - e * e) * arrives**2
    table = np.array(arcs)

    def at(t: np.ndarray) -> np.ndarray:
        return table[np.maximum(np.searchsorted(table[:, 0], t, side="right") - 1, 0)].T

    def swing(t: np.ndarray, wave: Callable[[np.ndarray], np.ndarray], factor: float) -> np.ndarray:
        start, size, phase = at(t)[:3]
        return (factor * size * wave(w * (t - start) - phase))[:, None]

    stops = [float(start) for start in table[1:, 0] if start <= case.end] or [math.nan]
    return Exact(lambda t: swing(t, np.cos, 1.0), lambda t: swing(t, np.sin, -w), np.array([instants_of(stops[0], stops[-1])]),
                 lambda t: at(t)[3][:, None], lambda t: at(t)[4], 0.5 * mass * speed**2)  # fmt: skip


# ---- a point under the Post-it law ------------------------------------------------------------------------------------


def postit_point(case: Case, wanted: str) -> Exact:
    """A point that rests on a plane, with shocks of any sign and forces that pull."""
    body, interface = case.body, case.interface
    require(case.scene["model"]["dimension"] == 1 and "stiffness" not in body and not any(body.get("velocity", []))
            and len(case.scene["interfaces"]) == 1 and interface["law"] == "postit"
            and interface["obstacle"]["type"] == "plane" and interface["obstacle"]["point"] == body["position"]
            and interface["obstacle"]["normal"][0] > 0.0
            and case.parameters.get("rupture", "brittle") == "brittle", wanted)  # fmt: skip
    values = {"initial_adhesion": 0.0, "adhesion_limit": math.inf, "efficiency_decrease": math.inf, "memory": 0.0}
    for name in values:
        given = case.parameters.get(name, values[name])
        require(isinstance(given, (int, float)) or given == "inf", f"a number for '{name}'")
        values[name] = float(given) * (body.get("area", 1.0) if "adhesion" in name else 1.0)
    require(all(load["type"] in ("force", "shock") for load in case.loads), wanted)
    forces = [load for load in case.loads if load["type"] == "force"]
    times = sorted({0.0, *(row[0] for load in forces for row in load["history"])})
    pull = sum((load["direction"][0] * np.interp(times, *np.transpose(load["history"])) for load in forces),
               np.zeros(len(times)))  # fmt: skip
    require(bool((pull >= 0.0).all()), wanted)
    shocks = [(load["time"], load["impulse"][0]) for load in case.loads if load["type"] == "shock"]
    story = Postit(body["mass"], times, pull.tolist(), **values)
    story.tell(sorted(shocks, key=lambda shock: shock[0]), case.end + case.step)
    return of_paths([Path(story.pieces)], [instants_of(story.first_impulse, rupture=story.last_rupture)])


def sign_change(low: float, high: float, function: Callable[[float], float]) -> float:
    """Where a function that is <= 0 at low and > 0 at high changes its sign, to the last bit."""
    while low < (middle := 0.5 * (low + high)) < high:
        low, high = (low, middle) if function(middle) > 0.0 else (middle, high)
    return high


class Postit:
    """In one dimension, from rest on the plane, moved by a force that never pushes and by shocks of either sign."""

    AT_THE_LIMIT = 1.0 + 1e-9

    def __init__(self, mass: float, times: list[float], pull: list[float], initial_adhesion: float,
                 adhesion_limit: float, efficiency_decrease: float, memory: float) -> None:  # fmt: skip
        self.mass, self.times, self.pull = mass, times, pull
        self.adhesion, self.limit, self.decrease, self.memory = (
            initial_adhesion, adhesion_limit, efficiency_decrease, memory)  # fmt: skip
        self.now = self.x = self.v = self.ruptures = self.holds_since = 0.0
        self.flies = False
        self.window: list[tuple[float, float]] = []  # impulses on the point since the last rupture
        self.pieces: list[tuple[float, ...]] = []
        self.first_impulse = self.last_rupture = math.nan

    def tell(self, shocks: list[tuple[float, float]], end: float) -> None:
        if self.adhesion == 0.0:
            self.take_off()
        for time, impulse in shocks:
            if time > end:
                break
            self.advance(time)
            self.strike(impulse)
        self.advance(end)

    def force(self, time: float) -> float:
        return float(np.interp(time, self.times, self.pull))

    def force_impulse(self, start: float, end: float) -> float:
        inside = self.times[bisect.bisect_right(self.times, start) : bisect.bisect_left(self.times, end)]
        knots = [start, *inside, end] if start < end else []
        return sum(0.5 * (self.force(a) + self.force(b)) * (b - a) for a, b in zip(knots, knots[1:]))

    def advance(self, to: float) -> None:
        """To a time before which no shock falls, from one kink of the force or of the window's sum to the next."""
        while self.now < to:
            until = min(to, self.next_kink())
            if self.flies:
                self.fly(until)
            else:
                self.rest(until)

    def next_kink(self) -> float:
        past = [*self.times, *(time for time, _ in self.window), self.holds_since]
        return min((time for time in [*self.times, *(time + self.memory for time in past)] if time > self.now),
                   default=math.inf)  # fmt: skip

    def pulled(self, time: float) -> float:
        """The impulse that pulled at the bond within its memory, without the one that pressed it.

        That of the force counts since it holds; a shock counts at its own instant, even without memory.
        """
        counted = (impulse for past, impulse in self.window if past > time - self.memory or past == time)
        return self.force_impulse(max(self.holds_since, time - self.memory), time) - sum(counted)

    def rest(self, until: float) -> None:
        self.pieces.append((self.now, self.x, self.v))
        if self.adhesion > 0.0 and self.memory > 0.0:
            if self.force(0.5 * (self.now + until)) > 0.0:
                self.note_impulse()
            breaks = self.rupture_before(until)
            if breaks < until:
                self.now = breaks
                return self.break_bond()
        self.now = until
        if self.adhesion == 0.0:
            self.take_off()

    def rupture_before(self, until: float) -> float:
        """Up to the next kink the sum is quadratic: it passes the adhesion on its way to its top.

        An impulse that leaves the window at a kink counts before it and not after.
        """
        def excess(time: float) -> float:
            return self.pulled(time) - self.adhesion * self.AT_THE_LIMIT

        margin = 1e-12 * (until - self.now)
        first, last = self.now + margin, until - margin
        middle, top = 0.5 * (first + last), last
        curvature, rise = excess(first) + excess(last) - 2.0 * excess(middle), excess(last) - excess(first)
        if curvature < 0.0:
            top = min(max(middle - 0.25 * rise / curvature * (last - first), first), last)
        return sign_change(first, top, excess) if excess(top) > 0.0 else until

    def fly(self, until: float) -> None:
        """Pulled away, the motion is convex: it meets the plane before its velocity turns, or not at all."""
        force = self.force(self.now)
        slope = (self.force(until) - force) / (until - self.now)
        piece = (self.now, self.x, self.v, force / self.mass, slope / self.mass)
        self.pieces.append(piece)

        def at(time: float) -> tuple[float, float]:
            start, x, v, a, j = piece
            s = time - start
            return x + s * (v + s * (a / 2.0 + s * j / 6.0)), v + s * (a + s * j / 2.0)

        low, start = until, self.now
        if self.v < 0.0 < at(until)[1]:
            low = sign_change(start, until, lambda time: at(time)[1])
        if self.v < 0.0 and at(low)[0] <= 0.0:
            self.now = sign_change(start, low, lambda time: -at(time)[0])
            speed = at(self.now)[1]
            self.x, self.v, self.flies = 0.0, 0.0, False
            self.press(-self.mass * speed)
        else:
            self.now = until
            self.x, self.v = at(until)

    def strike(self, impulse: float) -> None:
        if self.flies:
            self.v += impulse / self.mass
        elif impulse < 0.0:
            self.press(-impulse)
        elif self.adhesion > 0.0 and self.pulled(self.now) + impulse <= self.adhesion * self.AT_THE_LIMIT:
            self.window.append((self.now, -impulse))
            self.note_impulse()
        else:
            if self.adhesion > 0.0:
                self.break_bond()
            self.v, self.flies = impulse / self.mass, True

    def press(self, impulse: float) -> None:
        """R_Y = max(R_Y, min(eta S_N, R_Y,max))."""
        self.note_impulse()
        if self.adhesion == 0.0:
            self.holds_since = self.now
        self.window.append((self.now, impulse))
        efficiency = math.exp(-self.ruptures / self.decrease)
        self.adhesion = max(self.adhesion, min(efficiency * max(-self.pulled(self.now), 0.0), self.limit))
        if self.adhesion == 0.0:
            self.take_off()

    def break_bond(self) -> None:
        self.last_rupture, self.adhesion = self.now, 0.0
        self.ruptures += 1.0
        self.window.clear()
        self.take_off()

    def take_off(self) -> None:
        """Nothing holds it against a pull, not even one that is about to grow from zero."""
        self.flies = self.force(self.now) > 0.0 or self.force(self.next_kink()) > 0.0

    def note_impulse(self) -> None:
        if math.isnan(self.first_impulse):
            self.first_impulse = self.now


# ---- elastic bars -----------------------------------------------------------------------------------------------------


class Bar:
    def __init__(self, bar: Scene) -> None:
        self.start, self.length, self.velocity = bar.get("start", 0.0), bar["length"], bar.get("velocity", 0.0)
        section, young, density = bar.get("section", 1.0), bar["young"], bar["density"]
        self.speed = math.sqrt(young / density)  # of waves
        self.impedance = section * math.sqrt(young * density)
        self.mass, self.stiffness, self.section = density * section * self.length, young * section, section
        self.back = 2.0 * self.length / self.speed  # time in which a wave returns


def is_right_end(case: Case, nodes: Any) -> bool:
    """Whether a selection of nodes is the last one of the bar: a name, a number, near, or a box."""
    bar, elements = Bar(case.body), case.body["elements"]
    end, edge = bar.start + bar.length, bar.length / elements
    if isinstance(nodes, str) and nodes in case.scene.get("sets", {}):
        return is_right_end(case, case.scene["sets"][nodes])
    if not isinstance(nodes, dict):
        return nodes in (f"{case.body.get('name', 'bar0')}.right", elements, [elements])
    if "near" in nodes:
        places = np.ravel(nodes["near"])
        return len(places) == 1 and places[0] > end - 0.5 * edge
    (low,), (high,) = nodes["box"]
    return end - edge < low <= end <= high


def bar_on_wall(case: Case, wanted: str) -> Exact:
    """Contact for the return time 2L/c of a wave, at rest, then rebound at the speed of impact (Doyen et al. 2011)."""
    require(not case.loads, wanted)
    bar = Bar(case.body)
    gap = bar.start - case.obstacle_at()
    require(gap >= 0.0 and bar.velocity < 0.0, "a bar that flies towards the plane")
    meets = -gap / bar.velocity
    leaves = meets + bar.back
    return of_paths([constant_between([meets, leaves], [bar.velocity, 0.0, -bar.velocity])],
                    [instants_of(meets, leaves)], impulse=pushes(-bar.impedance * bar.velocity, meets, leaves),
                    work=no_work, energy=0.5 * bar.mass * bar.velocity**2)  # fmt: skip


def two_bars(case: Case, wanted: str) -> Exact:
    """While no wave has come back both ends move at (Z_A v_A + Z_B v_B)/(Z_A + Z_B).

    With equal impedances the shorter bar is then at rest relative to the longer one's initial speed, and so is the
    longer one's end, until its own wave is back.
    """
    a, b = map(Bar, case.scene["model"]["bars"])
    gap = b.start - (a.start + a.length)
    require(gap >= 0.0 and a.velocity > b.velocity, "a left bar that catches up with the right one")
    meets = gap / (a.velocity - b.velocity)
    together = (a.impedance * a.velocity + b.impedance * b.velocity) / (a.impedance + b.impedance)
    first_back = meets + min(a.back, b.back)
    equal = abs(a.impedance - b.impedance) <= 1e-12 * a.impedance and a.back <= b.back
    require(case.end <= first_back or (equal and case.end <= meets + max(a.back, b.back)),
            "an end before the first wave comes back, or a shorter left bar of equal impedance and an end before the "
            "second does")  # fmt: skip
    paths = [constant_between([meets, first_back], [v, together, b.velocity]) for v in (b.velocity, a.velocity)]
    return of_paths(paths, [instants_of(meets)] * 2, work=no_work,
                    impulse=pushes(b.impedance * (together - b.velocity), meets, first_back),
                    energy=0.5 * (a.mass * a.velocity**2 + b.mass * b.velocity**2))  # fmt: skip


def glued_bar(case: Case, wanted: str) -> Exact:
    """The glue feels 2F from L/c on; it breaks R_Y/(2F) later if its window is longer.

    The end then moves at 2F/Z until the next reflection at 3L/c.
    """
    require([load["type"] for load in case.loads] == ["force"] and len(case.loads[0]["history"]) == 1
            and case.interface["law"] == "postit", wanted)  # fmt: skip
    bar, memory = Bar(case.body), case.parameters.get("memory", 0.0)
    force = case.loads[0]["history"][0][1] * case.loads[0]["direction"][0]
    adhesion = case.parameters["initial_adhesion"] * bar.section
    require(isinstance(memory, (int, float)), wanted)
    window = "a window longer than R_Y/(2F), and an end before the next reflection at 3L/c"
    require(force > 0.0, window)
    arrives = bar.length / bar.speed
    breaks = arrives + adhesion / (2.0 * force)
    require(memory > adhesion / (2.0 * force) and breaks < 3.0 * arrives and case.end <= 3.0 * arrives, window)
    return of_paths([constant_between([breaks], [0.0, 2.0 * force / bar.impedance])], [instants_of(rupture=breaks)],
                    impulse=pushes(-2.0 * force, arrives, breaks), work=no_work,
                    energy=2.0 * force**2 * bar.length / bar.stiffness)  # fmt: skip


def bouncing_bar(case: Case, wanted: str) -> Exact:
    """A bar dropped on a plane, which it leaves as a whole after 2L/c.

    It is undeformed before the first impact, compressed by twice its weight after it, and undeformed again after the
    second if the flight between took a whole number of its vibrations, which then bring its end back.
    """
    require([load["type"] for load in case.loads] == ["gravity"] and "nodes" not in case.loads[0], wanted)
    bar = Bar(case.body)
    g, height = -case.loads[0]["acceleration"][0], bar.start - case.obstacle_at()
    require(g > 0.0 and height > 0.0 and bar.velocity == 0.0, wanted)
    fall, stay = math.sqrt(2.0 * height / g), bar.back
    vibrations = 2.0 * fall / stay
    require(abs(vibrations - round(vibrations)) <= 1e-9 * vibrations and vibrations > 1.5,
            "a flight of 2 sqrt(2 h/g) that is a multiple of the vibration's period 2L/c, by 2 at least")  # fmt: skip
    pieces: list[tuple[float, ...]] = []
    start = 0.0
    while start < case.end + case.step:
        up = start + fall + stay
        pieces += [(start, 0.0, 0.0, -g), (start + fall, -height, 0.0)]
        for s in stay * np.arange(round(vibrations)):
            pieces.append((up + s, g * s * (fall - 0.5 * s) - height, g * (fall - s - stay), g))
        second = up + 2.0 * fall
        pieces += [(second, -height, 0.0), (second + stay, -height, g * fall, -g)]
        start = second + stay + fall
    return of_paths([Path(pieces)], [instants_of(fall)])


def held_rod(case: Case, wanted: str) -> Exact:
    """A rod stretched by a over its length, let go, its far end held.

    It falls at c a/L, rests on the plane while the waves cross, and is thrown back to where it was, each for L/c.
    """
    bar, (load,), (initial,) = Bar(case.body), case.loads, case.scene["initial"]
    require(load["type"] == "motion" and is_right_end(case, load["nodes"]) and not {"velocity", "path"} & load.keys(), wanted)
    ends = [initial["displacement"][0] + initial["gradient"][0][0] * x for x in (bar.start, bar.start + bar.length)]
    require("nodes" not in initial and ends[0] > 0.0 and abs(ends[1]) <= 1e-12 * ends[0], wanted)
    require(bar.velocity == 0.0 and case.obstacle_at() == bar.start, wanted)
    third = bar.length / bar.speed
    speed = ends[0] / third
    instants = np.arange(1, math.ceil((case.end + case.step) / third) + 1) * third
    velocities = [(-speed, 0.0, speed)[k % 3] for k in range(len(instants) + 1)]
    return of_paths([constant_between(instants, velocities, ends[0])], [instants_of(third)])


# ---- which solution ---------------------------------------------------------------------------------------------------

# The solution of each name, and the scene that it is of: its kind of model and its bodies, then in words.
ONE_POINT = ("points", 1)
ONE_BAR = ("bars", 1)
SOLUTIONS: dict[str, tuple[Callable[[Case, str], Exact], tuple[str, int], str]] = {
    "bouncing_ball": (bouncing_ball, ONE_POINT, "one point at rest in 1D under gravity, above a plane, with law 'contact'"),
    "impact_oscillator": (impact_oscillator, ONE_POINT,
                          "one point in 1D on a spring, thrown above a plane, without loads, with law 'contact'"),
    "oblique_impact": (oblique_impact, ONE_POINT,
                       "one point in 2D that is thrown along a plane with normal [0, 1], under gravity, with law "
                       "'coulomb', friction and a restitution below 1"),
    "postit_point": (postit_point, ONE_POINT,
                     "one point at rest in 1D on a plane, with law 'postit', brittle rupture, shocks, and forces that pull"),
    "bar_on_wall": (bar_on_wall, ONE_BAR, "one bar that flies against a plane, no loads"),
    "bouncing_bar": (bouncing_bar, ONE_BAR, "one bar at rest, undeformed and under gravity, above a plane"),
    "held_rod": (held_rod, ONE_BAR,
                 "one bar at rest, stretched away from a plane at its left end, its right end held, no other load"),
    "glued_bar": (glued_bar, ONE_BAR, "one bar, glued on the left by law 'postit' with initial_adhesion and memory, "
                  "pulled at its right end by a constant force"),
    "two_bars": (two_bars, ("bars", 2), "two bars, no loads, and both ends watched, that of the right bar first"),
}  # fmt: skip


# Keys that solutions read, or that change no motion.
COVERED = {
    "scene": "title doc units sets model time initial loads interfaces output exact converge study expect",
    "points": "mass position velocity stiffness area",
    "bars": "name start length elements young density section velocity",
    "interface": "name law library parameters nodes obstacle against skip",
    "obstacle": "type point normal", "against": "nodes normal",
    "gravity": "type name acceleration", "force": "type name nodes direction history",
    "shock": "type name nodes time impulse", "motion": "type name nodes", "bulk_viscosity": "type name linear quadratic",
}  # fmt: skip


def check_keys(scene: Scene, name: str, kind: str) -> None:
    """Refuses a key that may change the motion and that no solution knows."""
    parts = [("scene", "", scene)]
    parts += [(kind, f"/model/{kind}/{k}", body) for k, body in enumerate(scene["model"][kind])]
    parts += [(load["type"], f"/loads/{k}", load) for k, load in enumerate(scene.get("loads", []))]
    for k, interface in enumerate(scene["interfaces"]):
        parts += [("interface", f"/interfaces/{k}", interface)]
        parts += [(key, f"/interfaces/{k}/{key}", interface[key]) for key in ("obstacle", "against") if key in interface]
    for what, pointer, part in parts:
        springs = {"stiffness"} if name != "impact_oscillator" else set()
        for key in sorted(part.keys() - (set(COVERED[what].split()) - springs)):
            raise BadInput(f"{pointer}/{key}: found a key that the closed form '{name}' does not know, expected none")


def exact_solution(scene: Scene, watched: int, steps: int, dt: float) -> Optional[Exact]:
    """None if the scene names none; refuses a scene that the named solution does not cover."""
    if "exact" not in scene:
        return None
    name = scene["exact"]["type"]
    solution, (kind, bodies), wanted = SOLUTIONS[name]
    require("springs" not in scene, "a scene without 'springs'")
    require(name == "held_rod" or "initial" not in scene, "a scene without 'initial'")
    turns = any(key in interface.get("obstacle", {}) for interface in scene["interfaces"] for key in ("rate", "angles"))
    require(not turns, "obstacles that do not turn")
    loads = [load for load in scene.get("loads", []) if load["type"] != "bulk_viscosity"]
    if name == "two_bars":
        require(watched == 2 and not scene.get("loads"), wanted)
    else:
        require(watched == 1, "one watched node, the one in contact")
    model = scene["model"]
    require(model["type"] == kind and len(model[kind]) == bodies, wanted)
    try:
        exact = solution(Case(scene, model[kind][0], scene["interfaces"][0], loads, dt * steps, dt), wanted)
        check_keys(scene, name, kind)
        return exact
    except (KeyError, IndexError, TypeError, ValueError):  # a key is missing that the solution needs
        raise BadInput(f"/exact: expected {wanted}") from None
