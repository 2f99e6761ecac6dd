"""The gallery of the shipped scenes, docs/img/gallery.png, which docs/make_pictures.py draws."""
# SPDX-License-Identifier: BSD-3-Clause

import csv
from pathlib import Path

from ilaw._figure import COLORS, plt

DOCS = Path(__file__).resolve().parent

# Scene: abscissa, label of it, label of the ordinate, curves as column or (column, legend).
SCENES = {
    "bouncing_ball": ("time", "time", "height", [("n0.gap", "e = 0"), ("n1.gap", "e = 0.5"), ("n2.gap", "e = 1")]),
    "oblique_impact": ("n0.u0", "distance", "height", ["n0.gap"]),
    "sliding_block": ("time", "time", "speed", ["n0.v0"]),
    "sliding_block_3d": ("n0.u0", "x", "y", ["n0.u1"]),
    "impact_oscillator": ("time", "time", "gap to the stop", ["n0.gap"]),
    "stick_slip": ("time", "time", "position", ["n0.u0"]),
    "spinning_wheel": ("time", "time", "velocity", [("n0.v0", "along"), ("n0.v1", "up")]),
    "rolling_wheel": ("time", "time", "force on the wheel", [("wheel.F0", "pull"), ("wheel.F1", "load")]),
    "landing_gear": ("time", "time", "force of the floor", ["floor.F0"]),
    "rotating_spring": ("n0.u0", "x", "y", ["n0.u1"]),
    "penalty_bounce": ("time", "time", "height", [("n0.gap", "spring"), ("n1.gap", "with damper")]),
    "template_law": ("time", "time", "speed", [("n0.v0", "c = 1"), ("n1.v0", "c = 10"), ("n2.v0", "c = 100")]),
    "postit_test1": ("time", "time", "adhesion", ["n0.adhesion"]),
    "postit_test2": ("time", "time", "adhesion", ["n0.adhesion"]),
    "postit_test3": ("time", "time", "adhesion", ["n0.adhesion"]),
    "tie_rupture": ("time", "time", "gap", ["n0.gap"]),
    "cohesive_pull": ("n0.opening", "opening", "damage", ["n0.damage"]),
    "bar_on_wall": ("time", "time", "gap of the end", ["n0.gap"]),
    "bouncing_bar": ("time", "time", "gap of the end", ["n0.gap"]),
    "held_rod": ("time", "time", "gap of the end", ["n0.gap"]),
    "two_bars": ("time", "time", "velocity of the ends", [("n100.v0", "left"), ("n101.v0", "right")]),
    "glued_bar": ("time", "time", "displacement of the end", ["n0.u0"]),
    "mixed_mode_bar": ("time", "time", "damage", ["n0.damage"]),
    "dcb_peel": ("time", "time", "damage along the bond", [("n80.damage", "first"), ("n60.damage", "later")]),
    "postit_3d": ("time", "time", "gap of the strip", [("n82.gap", "free end"), ("n92.gap", "at the tab")]),
    "block_impact": ("time", "time", "velocity of a corner", [("n0.v0", "x"), ("n0.v2", "z")]),
    "tyre_block": ("time", "time", "temperature of the tread", ["n0.T"]),
    "two_blocks": ("time", "time", "gap of a node", [("n405.gap", "edge"), ("n440.gap", "middle")]),
    "tilting_plane": ("time", "time", "displacement of the block", [("n4.u0", "x"), ("n4.u2", "z")]),
    "patch_test": ("time", "time", "impulse of a node", [("n37.r2", "dual mortar"), ("n193.r2", "node to facet")]),
    "half_model": ("time", "time", "force of the floor", [("floor.F2", "whole"), ("floor_2.F2", "half")]),
    "prestressed_seal": ("time", "time", "force", [("lid.F2", "lid"), ("fluid.F0", "fluid")]),
    "seal": ("time", "time", "displacement of the seal", [("n21.u0", "x"), ("n21.u2", "z")]),
}


def columns_of(file):
    with open(file) as rows:
        table = list(csv.reader(rows))
    return {name: [float(row[k]) if row[k] else float("nan") for row in table[1:]]
            for k, name in enumerate(table[0])}


def thinned(values, most=1500):
    return values[:: max(1, len(values) // most)]


def gallery(folder):
    across = 5
    down = -(-len(SCENES) // across)
    figure, grid = plt.subplots(down, across, figsize=(2.35 * across, 1.75 * down))
    for axes in grid.flat[len(SCENES):]:
        axes.axis("off")
    for axes, (name, (x, x_label, y_label, curves)) in zip(grid.flat, SCENES.items()):
        columns = columns_of(folder / name / "history.csv")
        for color, curve in zip(COLORS, curves):
            column, label = curve if isinstance(curve, tuple) else (curve, None)
            axes.plot(thinned(columns[x]), thinned(columns[column]), color=color, label=label)
        axes.set_title(name, fontsize=9, fontweight="bold")
        axes.set_xlabel(x_label, labelpad=1)
        axes.set_ylabel(y_label, labelpad=2)
        axes.locator_params(nbins=4)
        axes.ticklabel_format(style="sci", scilimits=(-3, 4))
        if any(isinstance(curve, tuple) for curve in curves):
            axes.legend(fontsize=6.5, frameon=False, handlelength=1.2, borderpad=0, labelspacing=0.2)
    figure.tight_layout(h_pad=0.9, w_pad=0.6)
    figure.savefig(DOCS / "img" / "gallery.png", dpi=95, metadata={"Software": None})
