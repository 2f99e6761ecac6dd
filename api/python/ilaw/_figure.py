"""The style of all pictures, panels on a sheet, and files that are complete under their names."""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import math
import os
import textwrap
from pathlib import Path
from typing import Callable, NamedTuple, Sequence

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.axes import Axes  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, ScalarFormatter  # noqa: E402

MAKER = "ilaw plot"  # by this word in a picture `ilaw run` knows pictures of earlier runs
# Okabe and Ito 2008: readers who are blind to a color tell them apart.
COLORS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"]
DASHES = ["-", "--", ":", "-."]
STYLE = {
    "font.family": "DejaVu Sans", "font.size": 9, "axes.labelsize": 9, "axes.titlesize": 9.5, "xtick.labelsize": 8,
    "ytick.labelsize": 8, "legend.fontsize": 8, "legend.frameon": False, "legend.handlelength": 1.6,
    "axes.spines.top": False, "axes.spines.right": False, "axes.edgecolor": "#808080", "axes.grid": True,
    "grid.color": "#e0e0e0", "grid.linewidth": 0.6, "axes.axisbelow": True, "lines.linewidth": 1.3,
    "axes.prop_cycle": plt.cycler(color=COLORS), "svg.fonttype": "none", "svg.hashsalt": "ilaw",
    "path.simplify_threshold": 0.2, "axes.xmargin": 0.0,
}  # fmt: skip
WIDTH, STRIP, SQUARE, BETWEEN = 7.4, 1.15, 2.2, 0.19  # inches


class Panel(NamedTuple):
    name: str
    draw: Callable[[Axes], None]
    height: float = STRIP  # SQUARE: over an axis of its own, two in a row


def with_unit(quantity: str, unit: str) -> str:
    unit = unit.replace(" ", "\xa0")  # no line ends within it
    return f"{quantity} ({unit})" if unit else quantity


def plain_axes(axes: Axes, over_shared: bool = False) -> None:
    """Powers of ten stand once, at the end of the axis; an abscissa that panels share is the last one's."""
    for axis, limits in ((axes.yaxis, axes.get_ylim()), (axes.xaxis, axes.get_xlim())):
        if axis.get_scale() == "log" and limits[1] < 50.0 * limits[0]:
            axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            axis.set_minor_formatter(NullFormatter())
        is_plain = axis.get_scale() == "linear" and isinstance(axis.get_major_formatter(), ScalarFormatter)
        if not is_plain or (axis is axes.xaxis and over_shared):
            continue
        largest = max(abs(limit) for limit in limits)
        power = math.floor(math.log10(largest)) if 0.0 < largest < math.inf else 0
        power = 0 if -2 <= power <= 4 else power
        axis.set_major_formatter(FuncFormatter(lambda value, _, power=power: f"{value / 10.0**power:.6g}"))
        if power:
            x, y, ha, va = (0.0, 1.01, "left", "bottom") if axis is axes.yaxis else (1.0, -0.14, "right", "top")
            axes.text(x, y, rf"$\times 10^{{{power}}}$", fontsize=7, transform=axes.transAxes, ha=ha, va=va)


def sheet(title: str, panels: Sequence[Panel], x_label: str, notes: Sequence[str]) -> Figure:
    """Panels below each other over one abscissa; then those with an axis of their own."""
    strips, squares = [p for p in panels if p.height != SQUARE], [p for p in panels if p.height == SQUARE]
    heading = textwrap.fill(title, 95)
    above = (0.34 if strips else 0.5) + 0.18 * heading.count("\n")
    height = above + sum(p.height + BETWEEN for p in strips) + (0.45 if strips else 0.0)
    height += (SQUARE + 0.85) * (-(-len(squares) // 2))
    figure = plt.figure(figsize=(WIDTH, height))
    figure.text(0.0, 1.0, heading, fontsize=11, va="top")
    top = height - above

    def axes_at(left: float, width: float, tall: float, shared: Axes | None = None) -> Axes:
        return figure.add_axes((left / WIDTH, (top - tall) / height, width / WIDTH, tall / height), sharex=shared)

    shared = None
    for panel in strips:
        axes = axes_at(0.0, WIDTH, panel.height, shared)
        shared = shared or axes
        panel.draw(axes)
        axes.set_ylabel(textwrap.fill(panel.name if not axes.get_ylabel() else axes.get_ylabel(), 17))
        axes.yaxis.set_label_coords(-0.085, 0.5)
        plain_axes(axes, panel is not strips[-1])
        axes.tick_params(labelbottom=panel is strips[-1])
        if panel is strips[-1]:
            axes.set_xlabel(x_label)
        if axes.get_legend_handles_labels()[1]:
            axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.04), borderaxespad=0.0, labelspacing=0.25)
        top -= panel.height + BETWEEN
    top -= 0.45 if strips else 0.0
    for k, panel in enumerate(squares):
        axes = axes_at((WIDTH * 0.54) * (k % 2), WIDTH * 0.44, SQUARE)
        panel.draw(axes)
        axes.set_title(panel.name, loc="left", pad=11)
        plain_axes(axes)
        if axes.get_legend_handles_labels()[1]:
            axes.legend(loc="best", labelspacing=0.25)
        top -= (SQUARE + 0.85) * (k % 2)
    for k, note in enumerate(notes):
        figure.text(0.0, (-0.12 - 0.17 * k) / height, note, fontsize=7.5, color="#505050", va="top")
    return figure


def save(figure: Figure, picture: Path) -> list[Path]:
    """As PNG and as SVG. A picture stands under its name when it is whole; links are replaced."""
    written = []
    for kind, maker in (("png", {"Software": MAKER}), ("svg", {"Creator": MAKER, "Date": None})):
        output = picture.with_name(f"{picture.name}.{kind}")
        partial = output.with_name(output.name + ".partial")
        try:
            partial.unlink(missing_ok=True)
            figure.savefig(partial, format=kind, dpi=110, bbox_inches="tight", pad_inches=0.1, metadata=maker)
            os.replace(partial, output)
        except BaseException:
            partial.unlink(missing_ok=True)
            raise
        written.append(output)
    plt.close(figure)
    return written
