"""The columns of a history as curves: their quantity and unit, and the names that the scene gives to their owners."""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import json
import re
from pathlib import Path
from typing import NamedTuple, Sequence

import numpy as np

from ._results import Run

ROUNDING = 1e-12  # of the largest value of a dimension: what is below is not drawn
NODE = re.compile(r"n(\d+)\.(?:(.+)\.)?([^.]+)$")
VECTORS = {
    "u": ("displacement", "length"), "v": ("velocity", "velocity"), "vm": ("mean velocity", "velocity"),
    "r": ("impulse", "impulse"), "F": ("force", "force"), "M": ("moment", "moment"),
}  # fmt: skip
SCALARS = {"gap": ("gap", "length"), "T": ("temperature", "temperature"), "status": ("status", "")}
# Units of state variables, as laws write them.
DIMENSIONS = {
    "m": "length", "s": "time", "m/s": "velocity", "N": "force", "N.s": "impulse", "Pa": "stress", "N/m^2": "stress",
    "J": "energy", "K": "temperature",
}  # fmt: skip


class Curve(NamedTuple):
    column: str  # as history.csv names it
    index: int
    quantity: str  # "displacement": curves of one quantity share a panel
    dimension: str  # "length", or "" without one
    owner: str  # "node 3", "node 3 floor", "floor", "kinetic"
    node: int  # -1: not of a node
    interface: str  # of a node with several interfaces
    component: str  # "x", or "" of a scalar

    @property
    def label(self) -> str:
        return f"{self.owner} {self.component}".rstrip()


def curves_of(run: Run, names: Sequence[str]) -> list[Curve]:
    """All columns but the time."""
    matches = {name: NODE.match(name) for name in names}
    nodes = list(dict.fromkeys(int(match[1]) for match in matches.values() if match))
    labels, dimensions = node_labels(run, nodes), state_dimensions(run)
    found = []
    for index, name in enumerate(names):
        match = matches[name]
        if match:
            node, interface = int(match[1]), match[2] or ""
            owner = f"{labels[node]} {interface}".rstrip()
            quantity = quantity_of(match[3], dimensions)
            found.append(Curve(name, index, *quantity, owner, node, interface, axis_of(match[3])))
        elif name != "time":
            found.append(curve_of_whole(name, index))
    return found


def quantity_of(name: str, dimensions: dict[str, str]) -> tuple[str, str]:
    stem = name.rstrip("0123456789")
    if name in SCALARS:
        return SCALARS[name]
    if stem != name and stem in VECTORS:
        return VECTORS[stem]
    stem = stem if stem in dimensions else name
    return stem.replace("_", " "), dimensions.get(stem, "")


def axis_of(name: str) -> str:
    digits = re.search(r"\d$", name)
    return "xyz"[int(digits[0])] if digits and digits[0] in "012" and not name[:-1].endswith("_") else ""


def curve_of_whole(name: str, index: int) -> Curve:
    """Resultants, and the balances of energy and of heat."""
    owner, _, last = name.rpartition(".")
    if owner not in ("balance", "heat"):
        quantity = VECTORS.get(last.rstrip("0123456789"), (name, ""))
        return Curve(name, index, *quantity, owner, -1, "", axis_of(last))
    if last == "error":
        return Curve(name, index, "balance error" if owner == "balance" else "heat balance error", "", "", -1, "", "")
    if last.startswith("angular_momentum"):
        return Curve(name, index, "angular momentum", "angular momentum", "axis", -1, "", axis_of(last))
    quantity = "energy" if owner == "balance" else "heat"
    return Curve(name, index, quantity, "energy", last.replace("_", " "), -1, "", "")


def node_labels(run: Run, nodes: list[int]) -> dict[int, str]:
    """The names under which the scene watches nodes, if each entry is one node; otherwise numbers and bodies."""
    watch = run.scene.get("output", {}).get("watch", [])
    entries = zip(nodes, watch if len(watch) == len(nodes) else [])
    named = {node: entry for node, entry in entries if isinstance(entry, str)}
    bodies = run.bodies()
    of_body = {n: b.name for b in bodies for n in nodes if len(bodies) > 1 and b.first <= n < b.first + b.count}
    return {n: named.get(n) or f"node {n}" + (f" ({of_body[n]})" if n in of_body else "") for n in nodes}


def state_dimensions(run: Run) -> dict[str, str]:
    """Dimensions of the state variables of the laws, from the descriptions beside their libraries."""
    found: dict[str, str] = {}
    for interface in run.summary["interfaces"]:
        try:
            laws = json.loads(Path(interface["library"]).with_suffix(".json").read_text(encoding="utf-8"))["laws"]
            variables = next(law for law in laws if law["id"] == interface["law"])["state_variables"]
            found |= {variable["name"]: DIMENSIONS.get(variable["unit"], "") for variable in variables}
        except (OSError, ValueError, KeyError, TypeError, StopIteration):
            continue  # the library has moved: its variables have names all the same
    return found


def peak(values: np.ndarray) -> float:
    finite = values[np.isfinite(values)]
    return float(np.abs(finite).max(initial=0.0))


def visible(curves: list[Curve], rows: np.ndarray) -> tuple[list[Curve], list[Curve]]:
    """Those that are not zero, and those that are nothing but rounding beside others of their dimension."""
    peaks = {curve: peak(rows[:, curve.index]) for curve in curves}
    scales: dict[str, float] = {"balance error": 1.0, "heat balance error": 1.0}  # these are relative
    for curve in curves:
        kind = curve.dimension or curve.quantity
        scales[kind] = max(scales.get(kind, 0.0), peaks[curve])
    is_rounding = {c: peaks[c] <= ROUNDING * scales[c.dimension or c.quantity] for c in curves}
    return [c for c in curves if not is_rounding[c]], [c for c in curves if is_rounding[c] and peaks[c] > 0.0]


def thinned(rows: np.ndarray, most: int) -> np.ndarray:
    """Least and largest value of each stretch of time, so that peaks stay; the first column is the time."""
    stretch = -(-len(rows) // (most // 2)) if len(rows) > most else 1
    if stretch == 1:
        return rows
    whole = len(rows) // stretch * stretch
    parts = rows[:whole].reshape(-1, stretch, rows.shape[1])
    found = np.empty((2 * len(parts), rows.shape[1]))
    found[0::2], found[1::2] = np.fmin.reduce(parts, axis=1), np.fmax.reduce(parts, axis=1)
    found[0::2, 0], found[1::2, 0] = parts[:, 0, 0], parts[:, stretch // 2, 0]
    return np.concatenate([found, rows[whole:][-1:]])
