"""Writes the decks of four cases with closed forms, and judges what came out.

    python3 cases.py write CASE FOLDER     one of slide, impact, two_bars, peel, drop, bond, continued
    python3 cases.py judge CASE FOLDER     after a run: reads history.csv there

run.sh does both around an OpenRadioss. SPDX-License-Identifier: BSD-3-Clause
"""
import csv
import sys
from pathlib import Path

from deck import Deck, block, face, facets

FRICTION, GRAVITY = 0.3, 10.0
LENGTH, SIDE, CELLS, DENSITY, YOUNG, SPEED = 1.0, 0.02, 50, 8000.0, 2e11, 1.0
FORCE = SIDE**2 * SPEED * (DENSITY * YOUNG) ** 0.5  # of the wave of a bar on a wall: 16,000 N
TOUGHNESS = 5.0
MASS, HEIGHT, BOND, STEP, FLOOR = 2.0, 0.5, 0.1, 1e-4, "plane 0 0 0  0 0 1"  # of one node
WALL = dict(plane=([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]))


def steel(deck, corner, first, velocity):
    """A bar along x: its nodes and bricks, in the deck."""
    nodes, bricks = block((CELLS, 1, 1), (LENGTH, SIDE, SIDE), corner, first)
    group = deck.body(nodes, bricks, DENSITY, YOUNG, 0.0)
    if velocity:
        deck.velocity(group, (velocity, 0.0, 0.0))
    return nodes, bricks


def slide(folder):
    """A soft block of 128 solids slides on a plane and stops after v^2/(2 mu g)."""
    deck = Deck("SLIDE")
    nodes, bricks = block((8, 4, 4), (0.4, 0.2, 0.2), (0.0, 0.0, 0.0))
    group = deck.body(nodes, bricks, 1000.0, 1e8, 0.3)
    deck.velocity(group, (2.0, 0.0, 0.0))
    deck.gravity(group, -GRAVITY)
    floor = dict(law="coulomb", friction=FRICTION, nodes=face(nodes, 2, 0.0), plane=([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]))
    deck.write(folder, [floor], stop=0.8)


def impact(folder):
    """A bar hits a rigid wall: its face is pressed by the force of the wave for 2 L/c."""
    deck = Deck("IMPACT")
    nodes, _ = steel(deck, (1e-5, 0.0, 0.0), 1, -SPEED)
    deck.write(folder, [dict(law="contact", nodes=face(nodes, 0, 1e-5), **WALL)], stop=6e-4)


def two_bars(folder):
    """A bar hits an equal one at rest: half of the force, and they exchange their velocities."""
    deck = Deck("TWOBARS")
    right, _ = steel(deck, (1e-5, 0.0, 0.0), 1, -SPEED)
    left, left_bricks = steel(deck, (-LENGTH, 0.0, 0.0), 100001, 0.0)
    main = facets(left_bricks, face(left, 0, 0.0))
    deck.write(folder, [dict(law="contact", nodes=face(right, 0, 1e-5), facets=main)], stop=6e-4)


def peel(folder):
    """A bar that flies off a wall tears its bond, which takes toughness times area."""
    deck = Deck("PEEL")
    nodes, _ = steel(deck, (0.0, 0.0, 0.0), 1, SPEED)
    bond = dict(law="cohesive", strength=1e7, toughness=TOUGHNESS, area=SIDE**2 / 4, nodes=face(nodes, 0, 0.0), **WALL)
    deck.write(folder, [bond], stop=2e-3)


def drop(folder):
    """A node falls from 0.5 m and bounces up to a quarter of it, by the window of the user library."""
    deck = Deck("DROP")
    deck.free_node(MASS, HEIGHT, 0.0, GRAVITY)
    deck.write_window(folder, ["law contact", "restitution 0.5", FLOOR, "nodes 1"], [2.0], STEP)


def bond(folder, stops=(0.1,)):
    """A node flies off and tears its bond, by the window: its kinetic energy falls by toughness times area."""
    deck = Deck("BOND")
    deck.free_node(MASS, 0.0, 2.0)
    lines = ["law cohesive", "strength 10", f"toughness {BOND}", "area 1", FLOOR, "nodes 1"]
    deck.write_window(folder, lines, stops, STEP)


def continued(folder):
    """The same in three runs, from one restart file of the engine to the next, amid the damage."""
    bond(folder, (0.004, 0.007, 0.1))


def history(folder):
    with open(Path(folder, "history.csv")) as table:
        return [{name: float(value) for name, value in row.items()} for row in csv.DictReader(table)]


def trace(folder):
    """Lines of the window's node, of which the first of a continued run is the last of the run before."""
    return list(dict.fromkeys(Path(folder, "history.csv").read_text().splitlines()))


def judge_window(case, folder):
    lines = trace(folder)
    rows = [[float(value) for value in line.split(",")] for line in lines]
    if case == "drop":
        touch = next(k for k, (_, _, v) in enumerate(rows) if v > 0.0)
        impact = (2 * GRAVITY * HEIGHT) ** 0.5
        return [
            ("touches [s]", rows[touch][0], impact / GRAVITY, 0.01),
            ("leaves with [m/s]", rows[touch][2], impact / 2, 0.01),
            ("rises to [m]", max(z for t, z, _ in rows[touch:] if t < 0.6), HEIGHT / 4, 0.01),
            ("deepest [m]", min(z for _, z, _ in rows), 0.0, 1e-9),
            ("rests, speed [m/s]", rows[-1][2], 0.0, 1e-12),
        ]
    checks = [("leaves with [m/s]", rows[-1][2], (4.0 - 2 * BOND / MASS) ** 0.5, 1e-3)]
    if case == "continued":
        whole = trace(Path(folder, "../bond"))
        different = sum(a != b for a, b in zip(lines, whole)) + abs(len(lines) - len(whole))
        checks.append(("cycles with other bits than in one run", different, 0.0, 0.0))
    return checks


def column(rows, end):
    return next(name for name in rows[0] if name.endswith(end))


def judge(case, folder):
    """[(what, found, exact, allowed relative error)]"""
    if case in WINDOWS:
        return judge_window(case, folder)
    rows = history(folder)
    if case == "slide":
        weight = 1000.0 * 0.4 * 0.2 * 0.2 * GRAVITY
        slides = [r for r in rows if 0.1 < r["time"] < 0.6]
        mean = sum(r[column(rows, ".fx")] for r in slides) / len(slides)
        kinetic = 0.5 * weight / GRAVITY * 2.0**2
        return [
            ("friction force [N]", -mean, FRICTION * weight, 0.01),
            ("dissipated [J]", rows[-1]["friction"], kinetic, 0.01),
        ]
    if case == "peel":
        return [("dissipated [J]", rows[-1]["rupture"], TOUGHNESS * SIDE**2, 1e-6)]
    exact = FORCE if case == "impact" else 0.5 * FORCE
    plateau = [r[column(rows, ".fx")] for r in rows if 1e-4 < r["time"] < 3e-4]
    deepest = min(r[column(rows, ".gap")] for r in rows)
    return [("force [N]", sum(plateau) / len(plateau), exact, 0.005), ("deepest [m]", deepest, 0.0, 1e-9)]


WINDOWS = {"drop": drop, "bond": bond, "continued": continued}  # of the user library
CASES = {"slide": slide, "impact": impact, "two_bars": two_bars, "peel": peel, **WINDOWS}

if __name__ == "__main__":
    if len(sys.argv) != 4 or sys.argv[1] not in ("write", "judge") or sys.argv[2] not in CASES:
        found = " ".join(sys.argv[1:]) or "no arguments"
        sys.exit(f"found {found}, expected write or judge, one of {', '.join(CASES)}, FOLDER")
    _, action, name, where = sys.argv
    if action == "write":
        CASES[name](where)
    else:
        wrong = 0
        for what, found, exact, allowed in judge(name, where):
            error = abs(found - exact) / (abs(exact) or 1.0)
            wrong += error > allowed
            verdict = "off by" if error > allowed else "within"
            print(f"{name}: {what} {found:.6g}, exact {exact:.6g}: {verdict} {error:.1e}")
        sys.exit(wrong > 0)
