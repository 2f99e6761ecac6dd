"""Pictures of laws: one quantity over another, for what the scene drives, bonds, or lets slide."""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

from typing import Any, Iterator, NamedTuple, Optional

import numpy as np

from ._curves import Curve, peak, thinned
from ._figure import COLORS, SQUARE, Axes, Panel, with_unit
from ._results import Run, table_at

FREE, SLIP, BROKEN = 0, 3, 5
MOST_POINTS, MOST_NODES = 2000, 6


class Contact(NamedTuple):
    """A node in its interface, over the rows of the history."""

    label: str
    interface: dict[str, Any]
    columns: dict[str, Curve]  # by quantity without component
    impulse: np.ndarray
    velocity: np.ndarray


def contacts_of(run: Run, curves: list[Curve], rows: np.ndarray) -> Iterator[Contact]:
    """Nodes of one interface each: the impulse of others is a sum."""
    of_node: dict[int, list[Curve]] = {}
    for curve in curves:
        if curve.node >= 0 and curve.quantity != "mean velocity":
            of_node.setdefault(curve.node, []).append(curve)
    for node, own in of_node.items():
        interface = interface_of(run, node)
        if interface is None or any(c.interface for c in own) or not any(c.quantity == "status" for c in own):
            continue
        vectors = {}
        for quantity in ("impulse", "velocity"):
            vectors[quantity] = np.zeros((len(rows), 3))
            for curve in own:
                if curve.quantity == quantity:
                    vectors[quantity][:, "xyz".index(curve.component)] = rows[:, curve.index]
        yield Contact(own[0].owner, interface, {c.quantity: c for c in own}, vectors["impulse"], vectors["velocity"])


def interface_of(run: Run, node: int) -> Optional[dict[str, Any]]:
    if len(run.interfaces) == 1:
        return run.interfaces[0]
    bodies = {body.name: body for body in run.bodies()}

    def may_have(given: Any) -> bool:
        if isinstance(given, list):
            return node in given
        body = bodies.get(given.partition(".")[0]) if isinstance(given, str) else None
        return body is None or body.first <= node < body.first + body.count

    found = [interface for interface in run.interfaces if may_have(interface["nodes"])]
    return found[0] if len(found) == 1 else None


def normal_of(interface: dict[str, Any]) -> Optional[np.ndarray]:
    """Of a plane that does not tilt."""
    obstacle = interface.get("obstacle", {})
    if obstacle.get("type") != "plane" or "tilt" in obstacle:
        return None
    normal = np.array([*obstacle["normal"], 0.0, 0.0][:3], dtype=float)
    return normal / np.linalg.norm(normal)


def sparse(rows: np.ndarray) -> np.ndarray:
    return np.arange(0, len(rows), max(1, len(rows) // MOST_POINTS))


def path_of(given: dict[str, Any], times: np.ndarray, dimension: int) -> np.ndarray:
    """Displacement of what has a path or a velocity."""
    found = np.zeros((len(times), 3))
    if "path" in given:
        found[:, :dimension] = [table_at(given["path"], time, dimension) for time in times]
    elif "velocity" in given:
        found[:, :dimension] = np.outer(times, given["velocity"])
    return found


def force_over_displacement(run: Run, curves: list[Curve], rows: np.ndarray) -> Iterator[Panel]:
    chosen = sparse(rows)
    forces = [c for c in curves if c.quantity == "force"]
    motions = [load for load in run.scene.get("loads", []) if load["type"] == "motion"]
    driven = [(load.get("name") or load["nodes"], load) for load in motions]
    driven += [(i["name"], i["obstacle"]) for i in run.interfaces if "obstacle" in i]
    for name, given in driven:
        path = path_of(given, rows[chosen, 0], run.dimension)
        axis = int(np.ptp(path, axis=0).argmax())
        along = [c for c in forces if c.component == "xyz"[axis]]
        own = [c for c in along if c.owner == name] or along
        if not own or np.ptp(path[:, axis]) == 0.0:
            continue

        def draw(axes: Axes, x: np.ndarray = path[:, axis], own: list[Curve] = own, name: Any = name) -> None:
            for curve in own:
                axes.plot(x, rows[chosen, curve.index], label=curve.label)
            axes.set_xlabel(with_unit(f"displacement of {name}" if isinstance(name, str) else "driven displacement",
                                      run.unit_of("length")))  # fmt: skip
            axes.set_ylabel(with_unit("force", run.unit_of("force")))

        yield Panel("force over displacement", draw, SQUARE)


def area_of(run: Run, node: int) -> Optional[float]:
    points = run.model.get("points")
    return points[node].get("area", 1.0) if isinstance(points, list) and run.model["type"] == "points" else None


def traction_over_separation(run: Run, contacts: list[Contact], rows: np.ndarray) -> Iterator[Panel]:
    bonds = [c for c in contacts if {"damage", "intensity"} & set(c.columns) and "gap" in c.columns][:MOST_NODES]
    bonds = [c for c in bonds if normal_of(c.interface) is not None]
    if not bonds:
        return
    areas = [area_of(run, c.columns["gap"].node) for c in bonds]
    is_stress = None not in areas

    def draw(axes: Axes) -> None:
        for bond, area in zip(bonds, areas):
            force = -bond.impulse @ normal_of(bond.interface) / run.summary["dt"]
            held = rows[:, bond.columns["status"].index] != FREE
            last = int(np.flatnonzero(held)[-1]) + 1 if held.any() else 0
            chosen = sparse(rows[:last])
            gap = rows[:, bond.columns["gap"].index]
            axes.plot(gap[chosen], force[chosen] / (area or 1.0), label=bond.label if len(bonds) > 1 else None)
        axes.set_xlabel(with_unit("separation", run.unit_of("length")))
        quantity = ("traction", "stress") if is_stress else ("force of the node, pull > 0", "force")
        axes.set_ylabel(with_unit(quantity[0], run.unit_of(quantity[1])))

    yield Panel("traction over separation", draw, SQUARE)


def windowed(pull: np.ndarray, steps: int, restarts: np.ndarray) -> np.ndarray:
    """Sum over the last steps, anew behind each restart."""
    total = np.concatenate([[0.0], np.cumsum(pull)])
    index = np.arange(1, len(total))
    begin = np.zeros(len(pull), int)
    begin[1:] = np.where(restarts[:-1], index[:-1], 0)
    return total[index] - total[np.maximum(np.maximum.accumulate(begin), index - steps)]


def adhesion_and_window(run: Run, contacts: list[Contact], rows: np.ndarray) -> Iterator[Panel]:
    """R_Y, and the pull S in the window that breaks it; S needs every step."""
    glued = [c for c in contacts if "adhesion" in c.columns][:MOST_NODES]
    every_step = run.scene.get("output", {}).get("every", 1) == 1
    if not glued:
        return

    def draw(axes: Axes) -> None:
        for k, node in enumerate(glued):
            color, of_node = COLORS[k % len(COLORS)], f" {node.label}" if len(glued) > 1 else ""
            table = [rows[:, 0], rows[:, node.columns["adhesion"].index]]
            memory, normal = node.interface.get("parameters", {}).get("memory", 0.0), normal_of(node.interface)
            if every_step and normal is not None and isinstance(memory, (int, float)):
                broken = rows[:, node.columns["status"].index] == BROKEN
                table.append(windowed(-node.impulse @ normal, max(1, round(memory / run.summary["dt"])), broken))
            time, R, *S = thinned(np.column_stack(table), 2 * MOST_POINTS).T
            axes.plot(time, R, color=color, label="$R_Y$" + of_node)
            if S:
                axes.plot(time, S[0], color="#000000" if len(glued) == 1 else color, linestyle="--", linewidth=0.9,
                          label="pull $S$" + of_node)  # fmt: skip
        axes.set_ylabel(with_unit("$S$ and $R_Y$" if every_step else "$R_Y$", run.unit_of("impulse")))

    yield Panel("adhesion", draw, 1.6)


def friction_over_slip_rate(run: Run, contacts: list[Contact], rows: np.ndarray) -> Iterator[Panel]:
    """Nodes that slide on planes, if the rates differ by a factor of two and the friction by a hundredth."""
    found = []
    for contact in contacts[:MOST_NODES]:
        normal, obstacle = normal_of(contact.interface), contact.interface.get("obstacle", {})
        if normal is None or obstacle.get("rate") or obstacle.get("angles") or run.dimension == 1:
            continue
        slides = rows[:, contact.columns["status"].index] == SLIP
        chosen = np.flatnonzero(slides)[sparse(rows[slides])]
        push = contact.impulse[chosen] @ normal
        shear = contact.impulse[chosen] - np.outer(push, normal)
        moved = path_of(obstacle, rows[:, 0], run.dimension)
        slip = contact.velocity - np.gradient(moved, rows[:, 0], axis=0) if len(rows) > 2 else contact.velocity
        slip = slip[chosen] - np.outer(slip[chosen] @ normal, normal)
        rate, push = np.linalg.norm(slip, axis=1), np.where(push > 0.0, push, np.nan)
        friction = np.linalg.norm(shear, axis=1) / push
        usable = np.isfinite(friction) & (rate > 1e-9 * rate.max(initial=0.0))
        rate, friction = rate[usable], friction[usable]
        if len(rate) > 10 and rate.max() > 2.0 * rate.min() and np.ptp(friction) > 0.01 * friction.max():
            found.append((contact.label, rate, friction))
    if not found:
        return

    def draw(axes: Axes) -> None:
        for label, rate, friction in found:
            axes.plot(rate, friction, ".", markersize=2.5, label=label if len(found) > 1 else None)
        axes.set_xscale("log")
        axes.set_xlabel(with_unit("slip rate", run.unit_of("velocity")))
        axes.set_ylabel("friction coefficient")

    yield Panel("friction over slip rate", draw, SQUARE)


def pressure_along_a_line(run: Run) -> Iterator[Panel]:
    """Of nodes in the middle of each interface, at five instants, from the fields."""
    files = run.field_files()
    if not files:
        return
    from ._film import InterfaceFields
    from ._results import read_grid
    from ._surfaces import surface_of

    first = read_grid(files[0][1])
    surface = surface_of(first)
    if surface.is_points or not len(surface.triangles):
        return
    every = max(1, len(files) // 40)
    obstacles = {o["interface"]: o for o in run.obstacles(np.array([time for time, _ in files]))}
    for number, interface in enumerate(run.interfaces):
        fields = InterfaceFields(run, first, number, surface)
        line, axis = line_through(first.points[fields.nodes])
        if len(line) < 4:
            continue
        curves = []
        for frame in range(0, len(files), every):
            values = fields.values(read_grid(files[frame][1]), obstacles.get(interface["name"]), frame, np.zeros(3))
            if "pressure" in values:
                curves.append((files[frame][0], np.nan_to_num(values["pressure"][line])))  # free: none
        largest = max((peak(pressure) for _, pressure in curves), default=0.0)
        curves = [(time, pressure) for time, pressure in curves if peak(pressure) > 1e-3 * largest]
        curves = [curves[k] for k in np.unique(np.linspace(0, len(curves) - 1, 5).astype(int))] if curves else []
        if not curves:
            continue

        def draw(axes: Axes, x: np.ndarray = first.points[fields.nodes[line], axis], curves: list = curves,
                 axis: int = axis) -> None:  # fmt: skip
            for time, pressure in curves:
                axes.plot(x, pressure, ".-", markersize=3, label=f"time {time:.3g}")
            axes.set_xlabel(with_unit("xyz"[axis], run.unit_of("length")))
            axes.set_ylabel(with_unit("pressure", run.unit_of("stress")))

        name = "" if len(run.interfaces) == 1 else f" of {interface['name']}"
        yield Panel(f"pressure{name} along a line", draw, SQUARE)


def line_through(places: np.ndarray) -> tuple[np.ndarray, int]:
    """The nodes along the longest extent that lie nearest to the middle of the next one, in order."""
    extent = np.ptp(places, axis=0)
    axis, across = np.argsort(-extent, kind="stable")[:2]
    off = np.abs(places[:, across] - places[:, across].mean())
    line = np.flatnonzero(off <= off.min() + 1e-6 * extent.max())
    side = places[line, across] <= places[line, across].mean()  # one of two lines at the same distance
    line = line[side]
    return line[np.argsort(places[line, axis])], int(axis)


def relations_of(run: Run, curves: list[Curve], rows: np.ndarray) -> list[Panel]:
    contacts = list(contacts_of(run, curves, rows))
    return [
        *adhesion_and_window(run, contacts, rows), *force_over_displacement(run, curves, rows),
        *traction_over_separation(run, contacts, rows), *friction_over_slip_rate(run, contacts, rows),
        *pressure_along_a_line(run),
    ]  # fmt: skip
