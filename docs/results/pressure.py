#!/usr/bin/env python3
"""Contact pressure of the law, of kinematic contact and of penalties beside closed forms: figure of docs/comparisons.md.

    docs/results/pressure.py [--draw]    needs scipy; ILAW_PATH: the folder lib/ilaw, ILAW_LOADER: libilaw_loader.so.1

bar    A bar of 100 elements meets a rigid wall: pressure rho c v for the time 2 L/c, then none.
hertz  A parabolic body is pressed on a rigid plane, in plane strain: p(x) of Hertz (1882). The half width of contact has
       12 elements; found at rest by relaxation with fictitious masses.

The three methods take the same elements, masses and steps, written here; only the impulse differs. Kinematic contact
removes the overlap at the end of the step by the mass (Carpenter, Taylor and Katona 1991). A penalty's spring is a
multiple of the stiffness of the element at its node, over its area; the step falls where the spring asks for it.
"""
# SPDX-License-Identifier: BSD-3-Clause
import functools
import math
import sys
from pathlib import Path

import numpy
import scipy.sparse

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "api/python"))
import ilaw  # noqa: E402

FACTORS = [10 ** (k / 4 - 1) for k in range(9)]


class Law:
    name = "law contact"

    def __init__(self, step, inverse_mass):
        n = len(inverse_mass)
        self.free, self.gap, self.previous = numpy.zeros((n, 1)), numpy.zeros(n), numpy.zeros((n, 1))
        law = ilaw.Interface("contact", dimension=1, frame="local", velocity_step=step)
        self.batch = law.batch(v_free=self.free, v_previous=self.previous, gap=self.gap,
                               delassus=inverse_mass[:, None], velocity=True)  # fmt: skip

    def __call__(self, free, gap, step):
        self.free[:, 0], self.gap[:] = free, gap
        self.batch.evaluate(time=0.0)
        self.previous[:] = self.batch.velocity
        return self.batch.impulse[:, 0]


class Kinematic:
    name = "kinematic contact"

    def __init__(self, step, inverse_mass):
        self.inverse_mass = inverse_mass

    def __call__(self, free, gap, step):
        return numpy.maximum(0.0, -(free + gap / step)) / self.inverse_mass


class Penalty:
    def __init__(self, stiffness):
        self.stiffness = stiffness

    def __call__(self, free, gap, step):
        return step * self.stiffness * numpy.maximum(0.0, -gap)


def contact_of(kind, step, inverse_mass, element_stiffness):
    if isinstance(kind, float):
        return Penalty(kind * element_stiffness)
    return kind(step, inverse_mass)


def bar(kind):
    """Density, modulus, area, length and speed of impact are 1, and so is the pressure. Springs may halve the step."""
    if isinstance(kind, float):
        return min((bar_at(kind, part) for part in (0.9, 0.45)), key=lambda found: found[2])
    return bar_at(kind, 0.9)


def bar_at(kind, part):
    n = 100
    edge = 1.0 / n
    mass = numpy.full(n + 1, edge)
    mass[[0, -1]] /= 2
    spring = kind if isinstance(kind, float) else 0.0
    step = part * edge * math.sqrt(2.0 / (2.0 + spring))  # critical by Gershgorin at the wall: 1 without a spring
    contact = contact_of(kind, step, 1.0 / mass[:1], 1.0 / edge)
    start = 0.05
    moved, velocity = numpy.full(n + 1, start), -numpy.ones(n + 1)
    steps = math.ceil(2.5 / step)
    time, pressure, deepest = step * numpy.arange(1, steps + 1) - start, numpy.empty(steps), 0.0
    for k in range(steps):
        moved += step * velocity
        tension = numpy.diff(moved) / edge
        force = numpy.zeros(n + 1)
        force[:-1] += tension
        force[1:] -= tension
        velocity += step * force / mass
        impulse = contact(velocity[:1], moved[:1], step)
        velocity[0] += impulse[0] / mass[0]
        pressure[k] = impulse[0] / step
        deepest = max(deepest, -moved[0])
    inside = (time > 0.1) & (time < 1.9)
    error = math.sqrt(numpy.mean((pressure[inside] - 1.0) ** 2))
    return time, pressure, error, deepest, steps


def graded(first, core, end):
    places, edge = list(numpy.arange(0, core + 1e-9, first)), first
    while places[-1] < end:
        edge *= 1.2
        places.append(places[-1] + edge)
    return numpy.array(places)


def element_matrix(width, height, poisson):
    """Of four nodes, bilinear, plane strain, modulus E = 1, two by two Gauss points."""
    a = 1.0 / ((1 + poisson) * (1 - 2 * poisson))
    elastic = a * numpy.array([[1 - poisson, poisson, 0], [poisson, 1 - poisson, 0], [0, 0, 0.5 - poisson]])
    corners = numpy.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    matrix = numpy.zeros((8, 8))
    for x in (-1 / math.sqrt(3), 1 / math.sqrt(3)):
        for y in (-1 / math.sqrt(3), 1 / math.sqrt(3)):
            dx = corners[:, 0] * (1 + corners[:, 1] * y) / (2 * width)
            dy = corners[:, 1] * (1 + corners[:, 0] * x) / (2 * height)
            strain = numpy.zeros((3, 8))
            strain[0, 0::2] = strain[2, 1::2] = dx
            strain[1, 1::2] = strain[2, 0::2] = dy
            matrix += strain.T @ elastic @ strain * width * height / 4
    return matrix


def body(first, size=12.0, poisson=0.3):
    x, y = graded(first, 1.25, size), graded(first, 1.25, size)
    node = numpy.arange(len(x) * len(y)).reshape(len(y), len(x))
    rows, columns, values = [], [], []
    for j in range(len(y) - 1):
        for i in range(len(x) - 1):
            nodes = [node[j, i], node[j, i + 1], node[j + 1, i + 1], node[j + 1, i]]
            places = numpy.array([[2 * k, 2 * k + 1] for k in nodes]).ravel()
            rows.append(numpy.repeat(places, 8))
            columns.append(numpy.tile(places, 8))
            values.append(element_matrix(x[i + 1] - x[i], y[j + 1] - y[j], poisson).ravel())
    size = 2 * node.size
    at = (numpy.concatenate(values), (numpy.concatenate(rows), numpy.concatenate(columns)))
    return x, y, node, scipy.sparse.csr_matrix(at, shape=(size, size))


def hertz(kind, elements=12, half_width=1.0, radius=100.0, poisson=0.3):
    modulus = 1.0 / (1 - poisson**2)
    load = math.pi * modulus * half_width**2 / (4 * radius)  # of the whole width
    top = 2 * load / (math.pi * half_width)
    x, y, node, stiffness = body(1 / elements, poisson=poisson)
    area = numpy.gradient(x)
    area[0], area[-1] = (x[1] - x[0]) / 2, (x[-1] - x[-2]) / 2
    force = numpy.zeros(stiffness.shape[0])
    top_area = area / area.sum()
    force[2 * node[-1] + 1] = -0.5 * load * top_area
    free = numpy.ones_like(force)
    free[2 * node[:, 0]] = 0.0  # symmetry
    foot = 2 * node[0] + 1
    spring = kind if isinstance(kind, float) else 0.0
    first = x[1] - x[0]
    element = modulus * area / first
    mass = 0.5 * numpy.asarray(abs(stiffness).sum(axis=1)).ravel()  # Gershgorin: 0.7 of the critical step is 1
    mass[foot] += 0.5 * spring * element
    damping = 0.01  # implicit, so it adds to the mass that the contact feels
    acts = 1.0 / ((1 + damping) * mass)
    contact = contact_of(kind, 1.0, acts[foot], element)
    initial = x**2 / (2 * radius)
    moved, velocity = numpy.zeros_like(force), numpy.zeros_like(force)
    before = numpy.full(len(x), math.inf)
    for k in range(100000):
        moved += velocity
        velocity = free * ((1 - damping) / (1 + damping) * velocity + acts * (force - stiffness @ moved))
        impulse = contact(velocity[foot], initial + moved[foot], 1.0)
        velocity[foot] += acts[foot] * impulse
        pressure = impulse / area / top
        if k % 200 == 0:
            if abs(pressure - before).max() < 1e-6:
                break
            before = pressure
    exact = numpy.sqrt(numpy.maximum(0.0, 1 - (x / half_width) ** 2))
    inside = x < 1.25
    error = math.sqrt(numpy.average((pressure - exact)[inside] ** 2, weights=area[inside]))
    deepest = -min(0.0, (initial + moved[foot]).min()) / (half_width**2 / (2 * radius))
    return x[inside], pressure[inside], error, deepest, k


def methods(case):
    found = {Law.name: case(Law), Kinematic.name: case(Kinematic)}
    penalties = {factor: case(float(factor)) for factor in FACTORS}
    best = min(penalties, key=lambda factor: penalties[factor][2])
    for factor in sorted({FACTORS[0], 1.0, best}):
        found[f"penalty {factor:.2g}" + (", the best of nine" if factor == best else "")] = penalties[factor]
    return found


def draw(bars, faces):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    plt.rcParams.update({"svg.hashsalt": "ilaw", "font.size": 9})
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    left.plot([0, 0, 2, 2, 2.5], [0, 1, 1, 0, 0], "k--", lw=1, label="exact")
    x = numpy.linspace(0, 1, 400)
    right.plot(x, numpy.sqrt(1 - x * x), "k--", lw=1, label="exact")
    for axes, found in ((left, bars), (right, faces)):
        for k, name in enumerate(found):
            style = "o-" if axes is right and k == 0 else "-"
            axes.plot(*found[name][:2], style, color=f"C{k}", lw=2.5 if k == 0 else 1, ms=4, zorder=9 - k, label=name)
    left.set(xlabel="time [L/c]", ylabel="pressure [rho c v]", title="a bar meets a wall", ylim=(-0.1, 2.4))
    right.set(xlabel="x [half width]", ylabel="pressure [largest]", title="a round body is pressed on a plane")
    left.legend(loc="upper right", fontsize=7)
    right.legend(loc="lower left", fontsize=7)
    figure.savefig(ROOT / "docs/img/pressure.svg", metadata={"Date": None})


def main():
    tables = {}
    for name, case in (("bar", bar), ("hertz", hertz), ("hertz, 24 elements", functools.partial(hertz, elements=24))):
        tables[name] = methods(case)
        for method, (_, pressure, error, deepest, steps) in tables[name].items():
            print(f"| {name} | {method} | {error:.2%} | {max(pressure):.3f} | {deepest:.1e} | {steps} |", flush=True)
    if "--draw" in sys.argv:
        draw(tables["bar"], tables["hertz"])


if __name__ == "__main__":
    main()
