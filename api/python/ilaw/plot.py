"""`python3 -m ilaw.plot DIR`, and `ilaw plot DIR`: runs, convergence, studies and benchmarks as pictures."""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import argparse
import sys
import warnings
from pathlib import Path
from typing import Optional, Sequence

import numpy as np

from ._command import meant
from ._curves import Curve, curves_of, thinned, visible
from ._figure import COLORS, DASHES, SQUARE, STRIP, STYLE, Axes, Panel, plt, save, sheet, with_unit
from ._measured import MEASURED
from ._relations import relations_of
from ._results import STATUS_NAMES, Run, UnreadableRun
from .table import differences, flat

MOST_ROWS, MOST_NODES, MOST_PANELS = 4000, 6, 12
FIRST = ("gap", "displacement", "velocity", "impulse", "summed impulse")
WITHOUT_ZERO = ("temperature", "theta")
STATUS_COLORS = ["#dcdcdc", "#56B4E9", "#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7", "#000000"]
BROKEN = 5
MOTIONS = ("velocity", "path", "rate", "angles", "tilt")  # of obstacles
# Parts of the energy from the bottom up, and the sign with which what was put in becomes one of them.
ENERGIES = {
    "kinetic": 1, "internal": 1, "stored": 1, "dissipated_friction": 1, "dissipated_impact": 1,
    "dissipated_rupture": 1, "damping_work": -1,
}  # fmt: skip


class BadRequest(Exception):
    """Options that the results cannot serve; the message says what was found and expected."""


class History:
    """The curves of a run with more than rounding in them; many rows are drawn by their range."""

    def __init__(self, folder: Path) -> None:
        self.run = Run(folder)
        self.names, self.rows = self.run.history()
        if len(self.names) < 2 or not len(self.rows):
            if (folder / "history.csv.partial").is_file():
                raise UnreadableRun(f"{folder / 'history.csv'}: found history.csv.partial, of a run that has not ended")
            advice = f"`ilaw run SCENE --out {folder}` writes it if `output` has `watch`, `forces` or `balance`"
            raise UnreadableRun(f"{folder / 'history.csv'}: found no column besides time, expected a history: {advice}")
        self.curves = curves_of(self.run, self.names)
        self.shown, self.rounding = visible(self.curves, self.rows)
        self.few = thinned(self.rows, MOST_ROWS)

    def column(self, name: str) -> Curve:
        for curve in [*self.curves, Curve("time", 0, "time", "time", "", -1, "", "")]:
            if curve.column == name:
                return curve
        found = f"{self.run.folder / 'history.csv'}: found no column '{name}'"
        raise BadRequest(f"{found}, expected one of {', '.join(self.names)}{meant(name, self.names)}")

    def unit(self, curve: Curve) -> str:
        return self.run.unit_of(curve.dimension) if curve.dimension else ""

    def time_label(self) -> str:
        return with_unit("time", self.run.unit_of("time"))

    def notes(self) -> list[str]:
        found = [f"The run failed: {self.run.summary['failure']}"[:150]] if self.run.summary.get("failure") else []
        if self.rounding:
            some = ", ".join(c.column for c in self.rounding[:5]) + (", ..." if len(self.rounding) > 5 else "")
            found.append(f"Not drawn, since below 1e-12 of its scale: {some}")
        return found


# ---- the panels of a run over time -----------------------------------------------------------------------------------


def curve_panel(history: History, curves: list[Curve], name: str, rows: np.ndarray) -> Panel:
    owners, axes_of = list(dict.fromkeys(c.owner for c in curves)), sorted({c.component for c in curves})
    many = len({c.node for c in curves if c.node >= 0}) > MOST_NODES
    if many:  # the range is that of all, also of nodes at rest
        curves = [c for c in history.curves if c.quantity == curves[0].quantity and c.component in axes_of]
    steps = {"velocity": "steps-post", "impulse": "steps-pre", "force": "steps-pre", "moment": "steps-pre"}
    is_split = len(owners) > 1 and len(axes_of) > 1  # a color per owner and a dash per axis, each told once
    lines_of_legend = len(owners) + len(axes_of) if is_split else len(curves)
    style = steps.get(name, "default") if len(rows) <= 1000 else "default"
    time, values = rows[:, 0], {c: rows[:, c.index] for c in curves}

    def envelope(axes: Axes) -> None:
        for k, component in enumerate(axes_of):
            own = np.array([values[c] for c in curves if c.component == component])
            axes.fill_between(time, np.fmin.reduce(own), np.fmax.reduce(own), color=COLORS[k], alpha=0.2, linewidth=0)
            label = f"median {component}".rstrip() + (f" of {len(own)}" if k == 0 else "")
            axes.plot(time, np.nanmedian(own, axis=0), color=COLORS[k], label=label)

    def lines(axes: Axes) -> None:
        for curve in curves:
            k, within = owners.index(curve.owner), axes_of.index(curve.component)
            color, dash = (k, within) if len(owners) > 1 else (within, 0)
            axes.plot(time, values[curve], color=COLORS[color % len(COLORS)], linestyle=DASHES[dash % len(DASHES)],
                      drawstyle=style, label=None if is_split else legend_of(curve))  # fmt: skip
        for k, owner in enumerate(owners if is_split else []):
            axes.plot([], [], color=COLORS[k % len(COLORS)], label=owner)
        for k, component in enumerate(axes_of if is_split else []):
            axes.plot([], [], color="#808080", linestyle=DASHES[k], label=component)

    def legend_of(curve: Curve) -> Optional[str]:
        """Without the node if there is one, and without an axis if the model has one."""
        if curve.node >= 0 and len(owners) == 1:
            return curve.component if history.run.dimension > 1 and curve.component else None
        return curve.owner if history.run.dimension == 1 else curve.label

    def draw(axes: Axes) -> None:
        (envelope if many else lines)(axes)
        axes.set_ylabel(with_unit("impulse of a step" if name == "impulse" else name, history.unit(curves[0])))
        if name not in WITHOUT_ZERO:
            low, high = axes.get_ylim()
            axes.set_ylim(min(low, 0.0), max(high, 0.0))

    return Panel(name, draw, max(STRIP, 0.0 if many else 0.155 * lines_of_legend))


def energy_panel(history: History, curves: list[Curve]) -> Panel:
    """Parts upon each other reach what was put in; lines if one of them is negative."""
    def of(name: str, rows: np.ndarray = history.few) -> np.ndarray:
        return rows[:, history.column(f"balance.{name}").index]

    shown = {c.column.removeprefix("balance.") for c in curves}
    parts = {name: sign * of(name) for name, sign in ENERGIES.items() if name in shown}
    works = sum(of(name, history.rows[:1]) for name in ("external_work", "damping_work", "interface_work"))
    put_in = of("kinetic", history.rows[:1]) + of("internal", history.rows[:1]) - works + of("external_work")
    moving = any(key in i.get("obstacle", {}) for i in history.run.interfaces for key in MOTIONS)
    if moving:  # their work is what interfaces gave and took
        losses = [of(name) for name in ENERGIES if name.startswith(("dissipated", "stored"))]
        put_in = put_in + of("interface_work") + sum(losses)
    scale = max(np.abs(values).max() for values in [*parts.values(), put_in])
    stacks = all(values.min() > -1e-6 * scale for values in parts.values())
    labels = [name.replace("dissipated_", "").replace("_work", "").replace("stored", "in interfaces") for name in parts]

    def draw(axes: Axes) -> None:
        if stacks:
            axes.stackplot(history.few[:, 0], *parts.values(), labels=labels, colors=COLORS, alpha=0.75, linewidth=0)
        else:
            for label, values in zip(labels, parts.values()):
                axes.plot(history.few[:, 0], values, label=label)
        axes.plot(history.few[:, 0], put_in, color="black", linestyle="--", linewidth=1.0, 
                  label="start + loads" + (" + obstacles" if moving else ""))
        axes.set_ylabel(with_unit("energy", history.run.unit_of("energy")))

    return Panel("energy", draw, max(1.3, 0.155 * (len(parts) + 1)))


def status_panel(history: History) -> Optional[Panel]:
    curves = [c for c in history.curves if c.quantity == "status"]
    if not curves:
        return None
    stretch = -(-len(history.rows) // MOST_ROWS)
    rows = history.rows[: len(history.rows) // stretch * stretch]
    time = np.append(rows[::stretch, 0], history.rows[-1, 0])
    every = rows[:, [c.index for c in curves]].astype(int)
    counts = np.bincount(every[every >= 0].ravel(), minlength=len(STATUS_NAMES))
    rarity = np.argsort(np.argsort(-counts, kind="stable"), kind="stable")
    parts = every.reshape(-1, stretch, len(curves))
    status = np.take_along_axis(parts, rarity[parts].argmax(axis=1)[:, None], axis=1)[:, 0]  # the rarest of a stretch
    present = [k for k in range(len(STATUS_NAMES)) if counts[k]]
    ruptures = [(e["time"], n) for e in history.run.events() if e["event"] == "rupture" for n in e["nodes"]]
    of_node = {c.node: k for k, c in enumerate(curves)}
    ruptures = [(t, of_node[n]) for t, n in ruptures if n in of_node]

    def bands(axes: Axes) -> None:
        for k, _ in enumerate(curves):
            changes = np.flatnonzero(np.diff(status[:, k])) + 1
            first, last = np.concatenate([[0], changes]), np.append(changes, len(status))
            order = np.argsort(rarity[status[first, k]], kind="stable")  # the rarest lies on top
            colors = [STATUS_COLORS[s] for s in status[first[order], k]]
            begin, end = time[first[order]], time[last[order]]
            end = np.maximum(end, begin + 2e-3 * np.ptp(time))  # a status of one row is a dot, thanks to round caps
            axes.hlines(np.full(len(first), k), begin, end, colors, linewidth=6, capstyle="round")
        if ruptures:
            axes.plot(*zip(*ruptures), "o", color=STATUS_COLORS[BROKEN], markersize=5)
        axes.set_ylim(len(curves) - 0.4, -0.6)
        axes.set_yticks(range(len(curves)), [c.owner for c in curves])
        axes.set_ylabel(" ")  # they need its room

    def shares(axes: Axes) -> None:
        axes.stackplot(time[:-1], *[(status == k).sum(axis=1) for k in present], linewidth=0, step="post",
                       colors=[STATUS_COLORS[k] for k in present])  # fmt: skip
        axes.set_ylabel(f"status of {len(curves)}")

    def draw(axes: Axes) -> None:
        (shares if len(curves) > MOST_NODES else bands)(axes)
        for k in present if not ruptures else sorted({*present, BROKEN}):
            axes.plot([], [], color=STATUS_COLORS[k], linewidth=5, label=STATUS_NAMES[k])

    height = STRIP if len(curves) > MOST_NODES else 0.3 * len(curves)
    return Panel("status", draw, max(height, 0.155 * len(present) + 0.1))


def panels_of(history: History) -> list[Panel]:
    by_quantity: dict[str, list[Curve]] = {name: [] for name in FIRST}
    for curve in history.shown:
        by_quantity.setdefault(curve.quantity, []).append(curve)
    by_quantity.pop("status", None)
    # A force is hardly seen beside a shock, but its sum is. A sum needs every step.
    if history.run.scene.get("output", {}).get("every", 1) == 1:
        by_quantity["summed impulse"] = by_quantity["impulse"]
    relations = relations_of(history.run, history.shown, history.rows)
    strips = {panel.name: panel for panel in relations if panel.height != SQUARE}
    found = []
    for name, curves in by_quantity.items():
        if name == "energy" and "balance.kinetic" in {curve.column for curve in history.curves}:
            found.append(energy_panel(history, curves))
        elif name in strips:
            found.append(strips[name])
        elif curves:
            rows = history.few
            if name == "summed impulse":
                sums = history.rows.copy()
                sums[:, 1:] = np.nancumsum(sums[:, 1:], axis=0)
                rows = thinned(sums, MOST_ROWS)
            found.append(curve_panel(history, curves, name, rows))
    found += [panel for panel in [status_panel(history)] if panel]
    return found + [panel for panel in relations if panel.name not in strips]


def draw_run(folder: Path, output: Path, wanted: Sequence[str]) -> list[Path]:
    history = History(folder)
    panels = panels_of(history)
    names = [panel.name for panel in panels]
    for name in wanted:
        if name not in names:
            raise BadRequest(f"--panels: found '{name}', expected some of {', '.join(names)}{meant(name, names)}")
    chosen = [panel for name in wanted for panel in panels if panel.name == name] if wanted else panels
    notes = history.notes()
    for note in notes:
        print(note)
    return save(sheet(history.run.title, chosen, history.time_label(), notes), output / "history")


# ---- several runs, or columns over each other ------------------------------------------------------------------------


def legends_of(histories: list[History]) -> list[str]:
    """What differs between the scenes, if it is little; otherwise the folder."""
    differ = differences([h.run.scene for h in histories])
    if not 0 < len(differ) <= 3:
        return [h.run.folder.resolve().name for h in histories]
    scenes = [flat(h.run.scene) for h in histories]
    return [" ".join(f"{key.rpartition('/')[2]}={scene.get(key, '-')}" for key in differ) for scene in scenes]


def columns_of(histories: list[History]) -> list[str]:
    """Resultants, balances, then nodes: what varies in any run and is in all."""
    curves = {c.column: c for history in histories for c in history.shown if c.quantity != "status"}
    common = [name for name in curves if all(name in history.names for history in histories)]
    if not common:
        raise BadRequest("found no columns that all runs have")
    order = sorted(common, key=lambda name: (curves[name].node >= 0, name.startswith(("balance.", "heat."))))
    if len(order) > MOST_PANELS:
        print(f"ilaw: {len(order) - MOST_PANELS} columns are left out; --y chooses", file=sys.stderr)
    return order[:MOST_PANELS]


def draw_columns(folders: list[Path], output: Path, x: str, y: Sequence[str]) -> list[Path]:
    histories = [History(folder) for folder in folders]
    columns = list(y) or columns_of(histories)
    name = f"{'_'.join(y)}_over_{x}" if y else "comparison"
    legends = legends_of(histories) if len(histories) > 1 else [None]
    for history in histories:
        for column in [x, *columns]:
            history.column(column)

    def panel_of(column: str) -> Panel:
        def draw(axes: Axes) -> None:
            for k, history in enumerate(histories):
                rows = history.few if x == "time" else history.rows[:: max(1, len(history.rows) // MOST_ROWS)]
                label = legends[k] if column == columns[0] else None
                axes.plot(rows[:, history.column(x).index], rows[:, history.column(column).index], label=label,
                          color=COLORS[k % len(COLORS)], linestyle=DASHES[k // len(COLORS) % len(DASHES)])  # fmt: skip
            axes.set_ylabel(label_of(histories[0], column))

        tall = 0.155 * len(histories) if column == columns[0] and len(histories) > 1 else 0.0
        return Panel(column, draw, max(2.4 if len(columns) == 1 else STRIP, tall))

    panels = [panel_of(column) for column in columns]
    return save(sheet(histories[0].run.title, panels, label_of(histories[0], x), []), output / name)


def label_of(history: History, column: str) -> str:
    curve = history.column(column)
    name = "time" if column == "time" else f"{curve.quantity} {curve.label}" if curve.owner else curve.quantity
    return with_unit(name, history.unit(curve))


def measured_in(folder: Path) -> list[str]:
    """What a folder has of converge, study or bench."""
    return [name for name in MEASURED if (folder / f"{name}.csv").is_file()]


def draw_measured(folder: Path, output: Path) -> list[Path]:
    return [file for name in measured_in(folder) for file in save(MEASURED[name](folder), output / name)]


# ---- the command -----------------------------------------------------------------------------------------------------


def draw(options: argparse.Namespace) -> list[Path]:
    if options.out and not options.out.is_dir():
        raise BadRequest(f"--out {options.out}: found no such folder, expected one that exists")
    # A sweep and its pictures leave files beside its runs.
    folders = [f for f in options.folders if len(options.folders) == 1 or not f.is_file()]
    if not folders:
        raise BadRequest("found files alone, expected folders that `ilaw run` wrote")
    columns = options.y or options.x != "time"
    if not columns and not any((f / "summary.json").is_file() for f in folders):
        inner = [f for folder in folders for f in ([folder] if measured_in(folder) else sorted(folder.glob("*/")))]
        measured = [folder for folder in inner if measured_in(folder)]
        if measured:  # each for itself, as a study of several scenes leaves them
            if options.out and len(measured) > 1:
                raise BadRequest(f"--out: found with {len(measured)} folders, expected none: each keeps its own picture")
            return [file for folder in measured for file in draw_measured(folder, options.out or folder)]
    first = folders[0]
    if len(folders) == 1 and not (first / "summary.json").is_file() and any(first.glob("*/summary.json")):
        raise BadRequest(f"{first}: found folders of runs, expected one of them, or several: {first}/*")
    if len(folders) > 1 or columns:
        if options.panels:
            expected = "expected one folder; --y chooses columns there"
            raise BadRequest(f"--panels: found with several folders or --x, {expected}")
        output = options.out or (first.resolve().parent if len(folders) > 1 else first)
        return draw_columns(folders, output, options.x, options.y)
    return draw_run(first, options.out or first, options.panels)


def main(arguments: Optional[Sequence[str]] = None) -> int:
    about = "Draw runs, and what converge, study and bench measured."
    parser = argparse.ArgumentParser(prog="ilaw plot", description=about)
    words = {"type": lambda text: text.split(","), "default": []}
    parser.add_argument("folders", type=Path, nargs="+", help="folders that `ilaw run`, converge, study or bench wrote")
    parser.add_argument("--panels", help="panels of one run, by name: gap,velocity,status", **words)
    parser.add_argument("--y", help="columns of history.csv, a panel each", **words)
    parser.add_argument("--x", default="time", help="column of the abscissa (default: %(default)s)")
    parser.add_argument("--out", type=Path, help="existing folder for the pictures")
    options = parser.parse_args(arguments)
    try:
        with plt.rc_context(STYLE), warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # rows without any value
            written = draw(options)
    except (UnreadableRun, BadRequest) as reason:
        print(f"ilaw: {reason}", file=sys.stderr)
        return 2
    except OSError as reason:
        print(f"ilaw: {reason.filename or options.out or options.folders[0]}: {reason.strerror}", file=sys.stderr)
        return 1
    print(*written, sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
