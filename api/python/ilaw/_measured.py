"""Pictures of what `ilaw converge`, `study` and `bench` measured, from the tables that they write."""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import csv
import json
import textwrap
from pathlib import Path
from typing import Optional, Sequence

from ._figure import COLORS, SQUARE, Axes, Figure, Panel, plt, sheet

NORMS = {"u_L2": "displacement, mean square", "u_max": "displacement, largest", "v_L1": "velocity, mean"}
Rows = list[dict[str, str]]


def read(file: Path) -> Rows:
    with file.open(encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def number(text: Optional[str]) -> float:
    return float(text) if text else float("nan")


def title_of(folder: Path, name: str) -> str:
    file = folder / f"{name}.json"
    return json.loads(file.read_text(encoding="utf-8"))["title"] if file.is_file() else folder.name


def errors_over(axes: Axes, x: Sequence[float], y: Sequence[float], x_label: str, **style: object) -> None:
    axes.loglog(x, y, marker="o", markersize=3.5, **style)
    axes.set_xlabel(x_label)
    axes.set_ylabel("relative error")


def draw_converge(folder: Path) -> Figure:
    return converge_figure(title_of(folder, "converge"), folder / "converge.csv")


def converge_figure(title: str, table: Path) -> Figure:
    """Errors over the time step and, if it was measured, over the run time."""
    rows = read(table)
    steps = [number(row["dt"]) for row in rows]

    def over_step(axes: Axes) -> None:
        for norm in NORMS:
            errors_over(axes, steps, [number(row[norm]) for row in rows], "time step", label=NORMS[norm])
        top = number(rows[0]["u_L2"])
        axes.loglog(steps, [top * h / steps[0] for h in steps], "--", color="#808080", linewidth=1.0, label="order 1")

    def over_time(axes: Axes) -> None:
        seconds = [number(row["seconds"]) for row in rows]
        for norm in NORMS:
            errors_over(axes, [s / seconds[-1] for s in seconds], [number(row[norm]) for row in rows],
                        "run time / that of the finest run")  # fmt: skip

    panels = [Panel("over the step", over_step, SQUARE)]
    panels += [Panel("over the run time", over_time, SQUARE)] if "seconds" in rows[0] else []
    return key_beside(sheet(title, panels, "", []))


def key_beside(figure: Figure) -> Figure:
    """The key stands on the right of all panels, because curves fill them."""
    right = 0.99 if len(figure.axes) > 1 else 0.46
    for axes in figure.axes:
        if axes.get_legend():
            axes.get_legend().remove()
            figure.legend(*axes.get_legend_handles_labels(), loc="upper left", bbox_to_anchor=(right, 0.85))
    return figure


def draw_study(folder: Path) -> Figure:
    """Errors of laws over the number of steps and over the run time."""
    rows = read(folder / "study.csv")
    laws = list(dict.fromkeys(row["law"] for row in rows))
    seconds = [number(row["seconds"]) for row in rows if row["law"] == laws[0]]
    asked = (("u_L2", "displacement", "steps"), ("u_L2", "displacement over run time", "seconds"),
             ("impulse", "history of the impulse", "steps"), ("energy", "work of the interfaces", "steps"))  # fmt: skip
    panels = []
    for norm, name, column in asked:
        unit = seconds[-1] if column == "seconds" else 1.0
        # Logarithmic axes show what is larger than zero; an exact solution may tell no impulse or work.
        if not any(number(row[norm]) > 0.0 for row in rows):
            continue

        def draw(axes: Axes, norm: str = norm, column: str = column, unit: float = unit) -> None:
            for k, law in enumerate(laws):
                own = [row for row in rows if row["law"] == law]
                label = "steps" if column == "steps" else "run time / that of the first law's finest run"
                errors_over(axes, [number(r[column]) / unit for r in own], [number(r[norm]) for r in own], label,
                            color=COLORS[k % len(COLORS)], linestyle="-" if k < len(COLORS) else "--",
                            linewidth=2.2 if k == 0 else 1.1, label=law if column == "seconds" else None)  # fmt: skip

        panels.append(Panel(f"error of the {name}", draw, SQUARE))
    return key_beside(sheet(title_of(folder, "study"), panels, "", []))


def draw_bench(folder: Path) -> Figure:
    """Times over those of the bytes at the bandwidth of a triad, a column of bars per number of nodes."""
    rows = read(folder / "bench.csv")
    sizes = list(dict.fromkeys(row["nodes"] for row in rows))
    first = [row for row in rows if row["nodes"] == sizes[0]]
    labels = [textwrap.shorten(f"{row['law']}: {row['case']}", 110, placeholder=" ...") for row in first]
    size = (3.6 * len(sizes), 1.0 + 0.24 * len(first))
    figure, grid = plt.subplots(1, len(sizes), sharey=True, squeeze=False, figsize=size)
    for axes, size in zip(grid[0], sizes):
        ratios = [number(row["ratio"]) for row in rows if row["nodes"] == size]
        axes.barh(range(len(ratios)), ratios, color=COLORS[0])
        axes.margins(x=0.05)
        axes.axvline(1.0, color="black", linestyle="--", linewidth=1.0)
        axes.set_title(f"{size} nodes")
        axes.set_xlabel("time / that of the bytes at the triad's bandwidth", fontsize=7.5)
        axes.set_yticks(range(len(first)), labels)
        axes.grid(axis="y", visible=False)
    grid[0][0].invert_yaxis()
    return figure


MEASURED = {"converge": draw_converge, "study": draw_study, "bench": draw_bench}
