#!/usr/bin/env python3
"""Draws the sketches of pages, and plots of tables that stand on pages or in docs/results/tables.

    docs/make_sketches.py            all pictures, into docs/img
    docs/make_sketches.py NAME...    these alone

Needs matplotlib (python3-matplotlib). The same tables give the same bytes.
"""
# SPDX-License-Identifier: BSD-3-Clause

import csv
import io
import math
import re
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.patches import Circle, FancyArrowPatch, FancyBboxPatch, Polygon  # noqa: E402

DOCS = Path(__file__).resolve().parent
TABLES = DOCS / "results" / "tables"
BLUE, ORANGE, GREEN, PINK, GREY, DARK = "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#9a9a9a", "#333333"
PALE_BLUE, PALE_ORANGE, PALE_GREY = "#d6e8f4", "#fbe3d3", "#ececec"

plt.rcParams.update({
    "svg.hashsalt": "ilaw", "svg.fonttype": "path", "font.family": "DejaVu Sans", "font.size": 10,
    "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "grid.color": "#dddddd",
    "grid.linewidth": 0.6, "axes.axisbelow": True, "legend.frameon": False, "figure.facecolor": "white",
})


def save(figure, name):
    """One line a picture: nobody reads the paths, and thousands of lines would hide other changes."""
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None}, bbox_inches="tight", pad_inches=0.08)
    plt.close(figure)
    (DOCS / "img" / f"{name}.svg").write_text(re.sub(r"\s*\n\s*", " ", text.getvalue()).strip() + "\n")


def canvas(width, height):
    """A figure without axes, with one unit an inch."""
    figure = plt.figure(figsize=(width, height))
    axes = figure.add_axes([0, 0, 1, 1])
    axes.set(xlim=(0, width), ylim=(0, height))
    axes.axis("off")
    return figure, axes


def arrow(axes, start, end, color, width=2.2, style="-|>", **more):
    axes.add_patch(FancyArrowPatch(start, end, arrowstyle=style, mutation_scale=16, color=color, linewidth=width,
                                   shrinkA=0, shrinkB=0, **more))


def box(axes, x, y, width, height, text, face=PALE_GREY, edge=GREY, size=10, **more):
    axes.add_patch(FancyBboxPatch((x, y), width, height, boxstyle="round,pad=0,rounding_size=0.08", facecolor=face,
                                  edgecolor=edge, linewidth=1.2))
    axes.text(x + width / 2, y + height / 2, text, ha="center", va="center", fontsize=size, color=DARK, **more)


# ---- sketches

def contact_geometry():
    figure, axes = canvas(9.4, 3.3)
    # The obstacle, the body above it, and the node at its lowest point.
    ground = [(0.2, 0.15), (0.2, 0.75), (1.2, 0.92), (2.3, 0.97), (3.4, 0.92), (4.4, 0.75), (4.4, 0.15)]
    axes.add_patch(Polygon(ground, closed=True, facecolor=PALE_GREY, edgecolor=GREY, linewidth=1.4))
    axes.text(0.55, 0.36, "obstacle", color=DARK)
    body = [(0.9, 3.15), (0.85, 2.5), (1.25, 1.95), (2.3, 1.72), (3.35, 1.95), (3.75, 2.5), (3.7, 3.15)]
    axes.add_patch(Polygon(body, closed=True, facecolor=PALE_BLUE, edgecolor=BLUE, linewidth=1.4))
    axes.text(1.15, 2.75, "body", color=BLUE)
    node, foot = (2.3, 1.72), (2.3, 0.97)
    arrow(axes, (2.05, 0.97), (2.05, 1.72), DARK, 1.2, "<|-|>")
    axes.text(1.98, 1.33, "gap $g$", ha="right", va="center", color=DARK)
    arrow(axes, foot, (2.3, 1.5), DARK, 1.8)
    axes.text(2.38, 1.3, "$n$", color=DARK, fontsize=12)
    arrow(axes, node, (3.25, 1.2), ORANGE)
    axes.text(3.3, 1.12, "$v_{free}$", color=ORANGE, fontsize=13, va="center")
    arrow(axes, node, (2.1, 2.5), GREEN)
    axes.text(1.88, 2.55, "$r$", color=GREEN, fontsize=13)
    axes.add_patch(Circle(node, 0.07, facecolor=DARK, zorder=5))
    axes.text(2.42, 2.0, "node, mass $m$", color=DARK, fontsize=9)
    # The step in velocities.
    tail, tip = (5.6, 2.35), (7.1, 1.35)
    end = (6.75, 2.35)
    axes.plot([5.2, 8.4], [2.35, 2.35], color=GREY, linewidth=1, linestyle=(0, (4, 3)))
    axes.text(8.45, 2.35, "$v_N = 0$", va="center", color=GREY)
    arrow(axes, tail, tip, ORANGE)
    axes.text(6.0, 1.72, "$v_{free}$", color=ORANGE, fontsize=13)
    arrow(axes, tip, end, GREEN)
    axes.text(7.05, 1.9, "$H r$", color=GREEN, fontsize=13)
    arrow(axes, tail, end, BLUE)
    axes.text(6.1, 2.5, "$v$", color=BLUE, fontsize=13)
    axes.text(5.2, 0.75, r"$v = v_{free} + H\,r$", fontsize=15, color=DARK)
    axes.text(5.2, 0.32, "the law finds $r$ from $v_{free}$, $H = 1/m$, $g$ and its memory", fontsize=10, color=DARK)
    axes.text(5.2, 2.98, "one step of a node in contact, with friction", fontsize=10, color=DARK)
    save(figure, "contact_geometry")


def one_step():
    figure, axes = canvas(10.2, 2.75)
    steps = [("drift", "$u \\leftarrow u + h\\,v$", PALE_GREY, GREY), ("forces", "$f(u)$, no contact", PALE_GREY, GREY),
             ("kick", "$v_{free} = v + \\frac{h}{m} f$", PALE_GREY, GREY),
             ("law", "$r = \\mathrm{law}(v_{free}, H, g, \\mathrm{state})$", PALE_ORANGE, ORANGE),
             ("impulse", "$v = v_{free} + r/m$", PALE_BLUE, BLUE)]
    widths = [1.35, 1.65, 1.75, 2.55, 1.65]
    x = 0.15
    for k, ((name, formula, face, edge), width) in enumerate(zip(steps, widths)):
        box(axes, x, 1.55, width, 0.95, "", face, edge)
        axes.text(x + width / 2, 2.24, name, ha="center", va="center", fontweight="bold", color=DARK)
        axes.text(x + width / 2, 1.86, formula, ha="center", va="center", color=DARK, fontsize=10.5)
        if k:
            arrow(axes, (x - 0.2, 2.02), (x, 2.02), DARK, 1.4)
        x += width + 0.2
    # Instants: positions at whole steps, velocities at half ones.
    axes.plot([0.4, 9.8], [0.75, 0.75], color=GREY, linewidth=1.2)
    for place, label, color in ((0.9, "$u_n$", DARK), (2.9, "$v_{n+1/2}$", BLUE), (4.9, "$u_{n+1}$", DARK),
                                (6.9, "$v_{n+3/2}$", BLUE), (8.9, "$u_{n+2}$", DARK)):
        axes.plot([place, place], [0.66, 0.84], color=color, linewidth=1.6)
        axes.text(place, 0.42, label, ha="center", va="center", color=color, fontsize=12)
    axes.text(9.85, 0.75, "t", va="center", color=GREY)
    arrow(axes, (4.9, 1.25), (4.9, 0.92), ORANGE, 1.6)
    axes.text(5.02, 1.12, "gap and law at $t_{n+1}$", color=ORANGE, va="center")
    save(figure, "one_step")


def layers():
    figure, axes = canvas(9.6, 4.6)
    box(axes, 0.2, 2.55, 4.4, 1.85, "", PALE_BLUE, BLUE)
    axes.text(2.4, 4.2, "host_mock: the program ilaw", ha="center", va="center", fontweight="bold", color=DARK)
    rooms = ("cli: a file per command", "instruments: audit, bench, stress",
             "host: results, scene, step, contact, surface, model, base")
    for k, text in enumerate(rooms):
        box(axes, 0.4, 3.58 - 0.46 * k, 4.0, 0.4, text, "white", BLUE, 9.5)
    drawn = set(re.findall(r"\w+", " ".join(rooms)))
    for folder in (DOCS.parent / "host_mock").glob("*/*/"):
        if folder.parent.name in ("host", "instruments"):
            assert folder.name in drawn, f"the picture of the layers leaves out {folder}"
    box(axes, 5.0, 2.55, 4.4, 1.85, "", PALE_BLUE, BLUE)
    axes.text(7.2, 4.2, "your solver", ha="center", va="center", fontweight="bold", color=DARK)
    for k, text in enumerate(("C, C++, Fortran, Python", "LAMMPS, Yade, dolfinx, MuJoCo", "its own forces and time step")):
        box(axes, 5.2, 3.58 - 0.46 * k, 4.0, 0.4, text, "white", BLUE, 9.5)
    libraries = ("api/loader: opens libraries", "api/coupled: shared bodies", "api/check: the contract", "api/device: GPUs")
    for k, text in enumerate(libraries):
        box(axes, 0.2 + 2.34 * k, 1.75, 2.18, 0.5, text, PALE_GREY, GREY, 9.5)
    axes.plot([0.0, 9.6], [1.5, 1.5], color=ORANGE, linewidth=2.5)
    axes.text(4.8, 1.5, " ilaw.h: the ABI, plain C structs and one symbol ", ha="center", va="center", fontsize=10,
              color=ORANGE, fontweight="bold", bbox={"facecolor": "white", "edgecolor": "none", "pad": 1})
    box(axes, 0.2, 0.75, 9.2, 0.5, "plugins: contact.so   coulomb.so   tie.so   postit.so   cohesive.so   penalty.so   "
        "yours.so", PALE_ORANGE, ORANGE, 9.5)
    box(axes, 0.2, 0.1, 9.2, 0.5, "ilaw/kit: the loops, layouts and checks that a law is compiled with", PALE_ORANGE,
        ORANGE, 9.5)
    for x in (2.4, 7.2):
        arrow(axes, (x, 2.55), (x, 2.25), DARK, 1.3)
    save(figure, "layers")


# ---- plots of tables

def page_rows(page, first):
    """Rows of the table of a page whose head begins with the given cells, as dictionaries."""
    lines = (DOCS / page).read_text().splitlines()
    start = next(k for k, line in enumerate(lines) if line.startswith(first))
    split = lambda line: [cell.strip().strip("`") for cell in line.strip("|").split("|")]  # noqa: E731
    head, rows = split(lines[start]), []
    for line in lines[start + 2:]:
        if not line.startswith("|"):
            break
        rows.append(dict(zip(head, split(line))))
    return rows


def table(name):
    with open(TABLES / f"{name}.csv") as file:
        return list(csv.DictReader(file))


def law_times():
    wanted = [("contact", "scalar"), ("coulomb", "friction=0.3"), ("coulomb", "friction=0.3, full"),
              ("penalty", "explicit"), ("penalty", "implicit"), ("tie", "unbreakable"), ("postit", "friction=0.3"),
              ("cohesive", "holding"), ("cohesive", "softening")]
    rows = {(row["law"], row["case"]): row for row in page_rows("benchmarks.md", "| law | case | bytes")}
    figure, axes = plt.subplots(figsize=(8.2, 3.9))
    for k, key in enumerate(wanted):
        row = rows[key]
        beyond, cached = float(row["beyond, ns"]), float(row["in cache, ns"])
        memory = beyond / float(row["ratio"])
        axes.barh(k - 0.18, beyond, 0.34, color=BLUE, label="beyond the cache" if not k else None)
        axes.barh(k + 0.18, cached, 0.34, color="#9ecae1", label="in cache, 2000 nodes" if not k else None)
        axes.plot([memory, memory], [k - 0.36, k + 0.02], color=ORANGE, linewidth=2.4,
                  label="time of its bytes at memory bandwidth" if not k else None)
    names = [law if case == "scalar" else f"{law}: {case.replace('=', ' ').replace('full', 'full H')}"
             for law, case in wanted]
    axes.set(yticks=range(len(wanted)), yticklabels=names, xlabel="ns per node and step, one thread, 3D")
    axes.invert_yaxis()
    axes.grid(axis="y", visible=False)
    axes.legend(loc="lower left", bbox_to_anchor=(0.42, 0.42))
    save(figure, "law_times")


def stress():
    rows = page_rows("stability.md", "| law | scenes | refused")
    figure, axes = plt.subplots(figsize=(7.6, 3.0))
    for k, row in enumerate(rows):
        axes.plot(float(row["balance"]), k, "o", color=BLUE, markersize=8, label="error of the balance" if not k else None)
        axes.plot(float(row["added"]), k, "D", color=ORANGE, markersize=7,
                  label="added by interfaces" if not k else None)
    axes.set(xscale="log", xlim=(1e-18, 1), yticks=range(len(rows)), yticklabels=[row["law"] for row in rows],
             xlabel="largest error, relative to the largest energy of its scene")
    axes.axvspan(1e-18, 2.2e-16, color=PALE_GREY)
    axes.text(3e-18, -0.55, "rounding of one number", fontsize=8, color=DARK)
    axes.axvline(0.1, color=GREY, linestyle=(0, (4, 3)))
    axes.text(0.08, 5.9, "a run warns", fontsize=8, color=DARK, ha="right")
    axes.invert_yaxis()
    axes.legend(loc="center right", bbox_to_anchor=(0.93, 0.5))
    save(figure, "stress")


def tests():
    mutants = page_rows("reliability.md", "| area | mutants | run | caught")
    coverage = page_rows("reliability.md", "| | lines | branches")
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.6, 2.5), gridspec_kw={"wspace": 0.35})
    for k, row in enumerate(mutants):
        share = 100 * int(row["caught"]) / int(row["run"])
        left.barh(k, share, color=GREEN)
        left.text(share - 1, k, f"{row['caught']} of {row['run']}", ha="right", va="center", color="white",
                  fontsize=9)
    left.set(yticks=range(len(mutants)), yticklabels=[row["area"] for row in mutants], xlim=(0, 100),
             title="faults that the tests notice [%]")
    for k, row in enumerate(coverage):
        for shift, column, color in ((-0.19, "lines", BLUE), (0.19, "branches", "#9ecae1")):
            share = float(row[column].split("%")[0])
            right.barh(k + shift, share, 0.36, color=color, label=column if not k else None)
            right.text(share - 1, k + shift, f"{share:g}", ha="right", va="center", fontsize=8,
                       color="white" if column == "lines" else DARK)
    right.set(yticks=range(len(coverage)), yticklabels=[row[""] for row in coverage], xlim=(0, 100),
              title="reached by the tests [%]")
    right.legend(loc="lower center", bbox_to_anchor=(0.5, -0.42), ncol=2)
    for axes in (left, right):
        axes.invert_yaxis()
        axes.grid(axis="y", visible=False)
    save(figure, "tests")


def dolfinx_error_time():
    """Of the block thrown on a plane; the penalty is the best of nine."""
    runs = {}
    for row in page_rows("comparisons.md", "| model | nodes | step [1e-3]"):
        runs.setdefault(row["model"].split()[0], []).append(row)
    figure, both = plt.subplots(1, 2, figsize=(8.6, 3.6), sharey=True, gridspec_kw={"wspace": 0.08})
    looks = {"penalty": (ORANGE, "s-", 1.6), "coulomb": (BLUE, "o-", 2.6), "kinematic": (DARK, "x", 0.0)}
    for axes, column, title in zip(both, ("error, normal", "along"), ("along the normal", "along the plane")):
        for model, (color, look, width) in looks.items():
            points = [(float(row["CPU [s]"]), float(row[column].rstrip(" %"))) for row in runs[model]]
            axes.plot(*zip(*points), look, color=color, linewidth=width, markersize=6,
                      label="penalty, the best of nine" if model == "penalty" else model)
        axes.set(xscale="log", yscale="log", xlabel="processor time [s]", title=title)
        axes.set_yticks([1, 3, 10, 30], ["1", "3", "10", "30"])
    both[0].set(ylabel="error [%]")
    both[1].legend(loc="upper right")
    save(figure, "dolfinx_error_time")


def impacts():
    """Run time against error through impacts, of the study of docs/results/impacts.py."""
    titles = {"ball_e08": "ball, e = 0.8", "oscillator_e08": "mass on a spring against a stop",
              "oblique_e05": "thrown along a rough floor"}
    looks = {"impact": (BLUE, "o-"), "predictive": (GREEN, "s-"), "moreau": (PINK, "^-"),
             "explicit k=1e+06": (ORANGE, "v-"), "implicit k=1e+06": (GREY, "D-")}
    figure, all_axes = plt.subplots(1, 3, figsize=(11.4, 3.7), sharey=True, gridspec_kw={"wspace": 0.08})
    for axes, (scene, title) in zip(all_axes, titles.items()):
        for law, (color, look) in looks.items():
            rows = [row for row in table("impacts_runs") if row["scene"] == scene and row["law"] == law]
            name = law.replace("explicit", "explicit penalty").replace("implicit", "implicit penalty")
            axes.plot([float(row["time"]) for row in rows], [float(row["u_L2"]) for row in rows], look, color=color,
                      linewidth=1.6, markersize=4, label=name.replace("1e+06", "1e6"))
        axes.set(xscale="log", yscale="log", xlabel="run time", title=title)
    all_axes[0].set_ylabel("error of u")
    all_axes[-1].legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    save(figure, "impacts")


def orders():
    groups = [("points", ["postit_test1", "postit_test2", "postit_test3", "bouncing_ball_e08"]),
              ("bars and the peeled strip", ["bar_on_wall", "two_bars", "glued_bar", "postit_3d"])]
    colors = [BLUE, ORANGE, GREEN, PINK]
    figure, both = plt.subplots(1, 2, figsize=(9.6, 3.6), sharey=True, gridspec_kw={"wspace": 0.08})
    slopes = {row["case"]: row["order u_L2"] for row in table("orders")}
    for axes, (title, cases) in zip(both, groups):
        for case, color in zip(cases, colors):
            rows = table(case)
            h = [float(row["h" if "h" in row else "dt"]) for row in rows]
            finest = min(h)
            axes.plot([x / finest for x in h], [float(row["u_L2"]) for row in rows], "o-", color=color, markersize=4,
                      label=f"{case}, order {slopes[case]}")
        axes.plot([1, 30], [4e-4, 4e-4 * 30], color=GREY, linestyle=(0, (4, 3)), label="slope 1")
        axes.set(xscale="log", yscale="log", xlabel="step over the smallest step", title=title)
        axes.legend(fontsize=8.5, loc="upper center", bbox_to_anchor=(0.5, -0.18), ncol=2)
    both[0].set_ylabel("error of positions (u_L2)")
    save(figure, "orders")


def mujoco_slip():
    """Rates of slip at a step of 2 ms, on the page of the stepper for MuJoCo."""
    rates = {}
    for row in page_rows("../api/mujoco/README.md", "| case | contacts | step [ms]"):
        if row["step [ms]"] == "2":
            rates.setdefault(row["contacts"], []).append((row["case"], float(row["slip [um/s]"])))
    colors = [ORANGE, "#e58a4e", "#f0b090", GREY, BLUE]
    figure, axes = plt.subplots(figsize=(8.6, 3.2))
    for k, ((contacts, runs), color) in enumerate(zip(rates.items(), colors)):
        places = [case + 0.16 * (k - 2) for case in range(len(runs))]
        axes.barh(places, [rate for _, rate in runs], 0.14, left=1e-12, color=color, label=contacts)
        for place, (_, rate) in zip(places, runs):
            axes.text(1.4 * rate, place, f"{rate:g}", va="center", fontsize=8, color=DARK)
    axes.set(xscale="log", xlim=(1e-12, 1e6), xlabel="slip [um/s]")
    axes.set_yticks(range(len(runs)), [case for case, _ in runs])
    axes.invert_yaxis()
    axes.grid(axis="y", visible=False)
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=8.5)
    save(figure, "mujoco_slip")


def implicit_spring(stiffness, restitution, loads, height=0.3, speed=-1.0):
    """A node on an implicit spring by the equations of docs/theory/springs.md, solved by bisection, with p, H, h and
    l all 1: height at half steps, indentation and withheld work after each step."""
    lost = -math.log(restitution)
    ratio = lost / math.pi * (((0.0081 * lost + 0.022) * lost + 0.2088) * lost + 1)
    frequency, lead = math.sqrt(stiffness), 1 / (1 + restitution) - 0.5
    damping = 2 * ratio * frequency / (1 + (1 + 2 * ratio) * frequency / 4)
    indentation = withheld = 0.0
    for load in loads:
        free, is_closed = speed + load, indentation > 0 or height + speed / 2 <= 0

        def step(impulse):
            mean, ahead = free + (impulse - load) / 2, lead * (load + impulse)
            left = max(indentation - mean - max(ahead, 0), 0)
            for _ in range(60 if ahead < 0 < withheld else 0):
                force = stiffness * (indentation + left) / 2
                left = max(indentation - mean + min(-ahead, withheld / max(force, 1e-300)), 0)
            if ahead < 0:
                ahead = indentation - left - mean if withheld > 0 else 0.0
            way = mean + ahead
            part = min(1, indentation / way) if way > 0 else 1
            force = part * stiffness * (indentation + left) / 2
            return max(force - damping * part * mean, 0), left, force * ahead

        low, high = 0.0, 100.0
        for _ in range(80):
            middle = (low + high) / 2
            low, high = (middle, high) if step(middle)[0] > middle else (low, middle)
        impulse, left, banked = step(low) if is_closed else (0.0, 0.0, 0.0)
        zero = height + (free + impulse) / 2 + left
        withheld = max(min(withheld + banked, stiffness * left * max(-zero, 0)), 0)
        indentation, speed = left, free + impulse
        yield height + speed / 2, indentation, withheld
        height += speed


def lead():
    """How the zero of an implicit spring with restitution moves, and the work that is withheld for it."""
    loads = [-0.15 * (1 + 0.8 * math.sin(2 * math.pi * step / 9)) for step in range(34)]
    heights, indentations, withheld = zip(*implicit_spring(4.0, 0.3, loads))
    zeros = [height + indentation if indentation > 0 else None for height, indentation in zip(heights, indentations)]
    steps = range(1, len(loads) + 1)
    figure, (above, below) = plt.subplots(2, 1, figsize=(7.4, 4.6), sharex=True, height_ratios=[2, 1])
    above.axhline(0, color=DARK, linewidth=1)
    above.plot(steps, heights, "o-", color=BLUE, markersize=4, label="height of the node")
    above.plot(steps, [math.nan if z is None else z for z in zeros], "s-", color=ORANGE, markersize=4,
               label="zero of the spring, where it lets go")
    above.set(ylabel="height over h v")
    above.legend(loc="upper right")
    below.bar(steps, withheld, color=PALE_ORANGE, edgecolor=ORANGE)
    below.set(xlabel="step", ylabel="withheld W")
    save(figure, "lead")


# ---- the equations of laws

def curves(name, x_label, y_label, lines, **more):
    """A small picture of a law: its equation as curves over one quantity."""
    figure, axes = plt.subplots(figsize=(4.6, 2.6))
    for (x, y, label), color in zip(lines, (BLUE, ORANGE, GREEN)):
        axes.plot(x, y, color=color, linewidth=2, label=label)
    axes.set(xlabel=x_label, ylabel=y_label, **more)
    axes.legend(fontsize=8.5)
    save(figure, name)


def spaced(first, last, count=200):
    return [first + (last - first) * k / (count - 1) for k in range(count)]


def slip_weakening():
    """The fault of docs/results/fault.md."""
    curves("slip_weakening", "slip [m]", "friction coefficient",
           [([0, 0.4, 0.8], [0.677, 0.525, 0.525], "0.677 to 0.525 over 0.4 m")], ylim=(0.5, 0.7))


def rate_and_state():
    """The slip rate jumps to ten times its value, with f0 = 0.6, a = 0.01, b = 0.015."""
    slips = spaced(0, 6)
    of_theta = lambda theta: 0.01 * math.asinh(5 * math.exp((0.6 + 0.015 * math.log(theta)) / 0.01))  # noqa: E731
    aging = [of_theta(math.exp(-x) + 0.1 * (1 - math.exp(-x))) for x in slips]
    slip = [of_theta(0.1 * math.exp(math.exp(-x) * math.log(10))) for x in slips]
    before = ([-1, 0], [0.6, 0.6])
    curves("rate_and_state", "slip over $D_c$, after the slip rate rose tenfold", "friction coefficient",
           [(before[0] + slips, before[1] + mu, label) for mu, label in ((aging, "aging"), (slip, "slip"))])


def rubber():
    """0.4 to 1.2 at 0.1 m/s and 293 K, width 0.5."""
    decades = spaced(-5, 3)
    lines = []
    for kelvin in (273, 293, 313):
        shift = -8.86 * (kelvin - 293) / (101.5 + kelvin - 293)
        lines.append(([10**x for x in decades],
                      [0.4 + 0.8 * math.exp(-0.25 * (x + shift + 1)**2) for x in decades], f"{kelvin} K"))
    curves("rubber", "slip rate [m/s]", "friction coefficient", lines, xscale="log")


def table_friction():
    """Linear between the points of a table over slip rate and temperature, constant beyond."""
    curves("table_friction", "slip rate [m/s]", "friction coefficient",
           [([0, 1, 5, 7], [0.6, 0.5, 0.4, 0.4], "293 K"), ([0, 1, 5, 7], [0.45, 0.375, 0.3, 0.3], "443 K"),
            ([0, 1, 5, 7], [0.3, 0.25, 0.2, 0.2], "593 K")], ylim=(0, 0.7))


def rolling():
    spins = spaced(-3, 3, 7)
    held = [max(-1, min(1, w)) for w in spins]
    curves("rolling", "free spin over the largest spin that is stopped", "over its limit",
           [(spins, [-m for m in held], "moment"), (spins, [w - m for w, m in zip(spins, held)], "spin after")])


def conductance():
    steps = spaced(0, 4)
    curves("conductance", "x: conductance, area and step over the capacities", "heat over that to equilibrium",
           [(steps, [1 - math.exp(-x) for x in steps], "conductance"), ([0, 1.6], [0, 1.6], "explicit exchange")])


def rccm():
    """Opened at a constant rate, in units of the opening and the traction at which adhesion begins to fall."""
    openings, lines = spaced(0, 4, 2001), []
    for viscosity, label in ((1e-3, "slow"), (1.0, "fast")):
        intensity, tractions = 1.0, []
        for u in openings:
            fall = max(0.0, intensity * u * u - 1) * 0.002
            intensity -= fall / (viscosity + 0.002 * u * u)
            tractions.append(intensity**2 * u)
        lines.append((openings, tractions, label))
    curves("rccm", "opening", "traction", lines)


PICTURES = [contact_geometry, one_step, layers, law_times, stress, tests, dolfinx_error_time, impacts, orders,
            mujoco_slip, lead, slip_weakening, rate_and_state, rubber, table_friction, rolling, conductance,
            rccm]


def main():
    names = sys.argv[1:]
    unknown = set(names) - {picture.__name__ for picture in PICTURES}
    if unknown:
        sys.exit(f"no picture is called {', '.join(sorted(unknown))}\n{__doc__}")
    for picture in PICTURES:
        if not names or picture.__name__ in names:
            picture()


if __name__ == "__main__":
    main()
