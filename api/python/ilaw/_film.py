"""What moves in a run: the surfaces of its bodies, fields on them and forces, frame by frame, packed for a page."""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import base64
import zlib
from pathlib import Path
from typing import Any, Optional

import numpy as np

from ._results import Grid, Run, read_grid
from ._surfaces import PushedFacets, Surface, surface_of, thinned

LEAST_FRAMES = 20  # fewer than these look like single pictures: then nodes are left out instead
NO_VALUE = 65535
FREE, IN_CONTACT = 0, (1, 2, 3)  # closed, stick, slip

# The first of these that a run has is shown first.
SHOWN_FIRST = ("damage", "adhesion", "temperature", "von Mises stress", "pressure", "status", "displacement")


class Blocks:
    """Arrays as compressed text, by number."""

    def __init__(self) -> None:
        self.texts: list[str] = []

    def add(self, array: np.ndarray, kind: str) -> dict[str, Any]:
        packer = zlib.compressobj(6, wbits=31)
        packed = packer.compress(np.ascontiguousarray(array).astype(kind).tobytes())
        return self.add_packed(packed + packer.flush(), kind)

    def add_packed(self, packed: bytes, kind: str) -> dict[str, Any]:
        self.texts.append(base64.b64encode(packed).decode("ascii"))
        return {"block": len(self.texts) - 1, "kind": kind}


class Channel:
    """Values per node and component over frames, in 16 bits of the range of each frame; NaN is NO_VALUE."""

    def __init__(self) -> None:
        self.packer, self.bytes = zlib.compressobj(6, wbits=31), b""
        self.low: list[float] = []
        self.step: list[float] = []
        self.least, self.most, self.peaks = np.inf, -np.inf, []

    def add(self, values: np.ndarray) -> None:
        columns = values.reshape(len(values), -1).astype(float)
        known = np.isfinite(columns)
        low = np.where(known, columns, np.inf).min(axis=0, initial=np.inf)
        high = np.where(known, columns, -np.inf).max(axis=0, initial=-np.inf)
        low, high = np.where(np.isfinite(low), low, 0.0), np.where(np.isfinite(high), high, 0.0)
        step = np.where(high > low, (high - low) / (NO_VALUE - 1), 1.0)
        levels = np.where(known, np.rint((np.where(known, columns, low) - low) / step), NO_VALUE)
        self.bytes += self.packer.compress(levels.astype("<u2").tobytes())
        self.low += low.tolist()
        self.step += step.tolist()
        if known.any():
            self.least, self.most = min(self.least, columns[known].min()), max(self.most, columns[known].max())
            self.peaks.append(float(np.abs(columns[known]).max()))

    def size(self) -> int:
        return len(self.bytes) + len(self.packer.copy().flush())

    def finish(self, blocks: Blocks) -> dict[str, Any]:
        low, step = (blocks.add(np.array(values), "<f8") for values in (self.low, self.step))
        return {**blocks.add_packed(self.bytes + self.packer.flush(), "<u2"), "low": low, "step": step}


class InterfaceFields:
    """Pressure, shear and slip of one interface, from its traction and the normal of its surface."""

    def __init__(self, run: Run, grid: Grid, number: int, surface: Surface) -> None:
        self.interface, self.number = run.interfaces[number], number
        several = len(run.interfaces) > 1
        self.prefix = self.interface["name"] + "." if several else ""
        self.nodes = np.flatnonzero(grid.nodes[self.prefix + "status"] >= 0)
        names = set(grid.nodes) - {"u", "v", "r", "temperature"}
        self.names = sorted(name for name in names if name.startswith(self.prefix))
        own = np.zeros(len(grid.points), bool)
        own[self.nodes] = True
        corners = surface.nodes[surface.triangles]
        self.facets = corners[own[corners].all(axis=1)]

    def normals(self, x: np.ndarray, obstacle: Optional[dict[str, Any]], frame: int) -> np.ndarray:
        """Into the body, at the interface's nodes: of the obstacle, otherwise of the interface's own facets."""
        if obstacle:
            axis, arm = np.array(obstacle["axis"][frame]), x[self.nodes] - obstacle["place"][frame]
            if obstacle["type"] == "plane":
                return np.broadcast_to(axis, arm.shape)
            arm = arm - np.outer(arm @ axis, axis) if obstacle["type"] == "cylinder" else arm
        else:
            a, b, c = (x[self.facets[:, k]] for k in range(3))
            arm = np.zeros_like(x)
            for k in range(3):
                np.subtract.at(arm, self.facets[:, k], np.cross(b - a, c - a))
            arm = arm[self.nodes]
        length = np.linalg.norm(arm, axis=1, keepdims=True)
        return np.divide(arm, length, out=np.full_like(arm, np.nan), where=length > 0)

    def values(
        self, grid: Grid, obstacle: Optional[dict[str, Any]], frame: int, speed: np.ndarray
    ) -> dict[str, np.ndarray]:
        """speed: velocity of the obstacle without its turning."""
        found = {}
        for name in self.names:
            short, array = name[len(self.prefix) :], grid.nodes[name][self.nodes].astype(float)
            if short != "traction":
                found[short] = array if array.ndim == 1 else np.linalg.norm(array, axis=1)
        normal = self.normals(grid.points + grid.nodes["u"], obstacle, frame)
        free = found["status"] == FREE
        traction = np.where(free[:, None], np.nan, grid.nodes[self.prefix + "traction"][self.nodes])
        pressure = (traction * normal).sum(axis=1)
        found["pressure"] = pressure  # in every frame, also if nothing touches
        found["shear traction"] = np.linalg.norm(traction - pressure[:, None] * normal, axis=1)
        if obstacle and not obstacle["turns"]:
            v = grid.nodes["v"][self.nodes] - speed
            slip = np.linalg.norm(v - (v * normal).sum(axis=1)[:, None] * normal, axis=1)
            found["slip rate"] = np.where(np.isin(found["status"], IN_CONTACT), slip, np.nan)
        return found


def frames_to_show(count: int, most: int) -> list[int]:
    """First, last, and others evenly between."""
    return sorted(set(np.linspace(0, count - 1, min(count, most)).round().astype(int).tolist())) if count else []


def nodal_mean(grid: Grid, name: str) -> np.ndarray:
    """Mean over the elements at each node."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    connectivity = vtk_to_numpy(grid.data.GetCells().GetConnectivityArray())
    sizes = np.diff(vtk_to_numpy(grid.data.GetCells().GetOffsetsArray()))
    weights = np.repeat(grid.cells[name], sizes)
    count = np.bincount(connectivity, minlength=len(grid.points))
    return np.bincount(connectivity, weights=weights, minlength=len(grid.points)) / np.maximum(count, 1)


LABELS = {  # label, quantity of its unit
    "gap": ("gap", "length"), "opening": ("opening", "length"), "pressure": ("pressure", "stress"),
    "shear traction": ("shear traction", "stress"), "slip rate": ("slip rate", "velocity"),
    "von Mises stress": ("von Mises stress", "stress"), "temperature": ("temperature", "temperature"),
    "displacement": ("displacement", "length"), "speed": ("speed", "velocity"),
}  # fmt: skip


def field_entry(
    run: Run, blocks: Blocks, key: tuple[str, str], channel: Channel, nodes: Optional[dict[str, Any]]
) -> dict[str, Any]:
    """A field as the page has it; its key is its name and that of its interface."""
    label, quantity = LABELS.get(key[0], (key[0].replace("_", " "), ""))
    return {
        "name": key[0],
        "label": label,
        "interface": key[1],
        "unit": run.unit_of(quantity) if quantity else "",
        "least": float(channel.least),
        "most": float(channel.most),
        "peaks": float(np.percentile(channel.peaks, 90)),
        "nodes": nodes,
        "values": channel.finish(blocks),
    }


def forces_entry(run: Run, blocks: Blocks, drawn: np.ndarray, frames: np.ndarray) -> Optional[dict[str, Any]]:
    """Arrows at the nodes that are pushed in any frame; frames has a vector per frame and node."""
    used = np.flatnonzero(np.abs(frames).max(axis=(0, 2), initial=0.0) > 0.0) if frames.size else []
    if not len(used):
        return None
    channel = Channel()
    for frame in frames[:, used]:
        channel.add(frame)
    sizes = np.linalg.norm(frames[:, used], axis=2)
    return {
        "nodes": blocks.add(drawn[used], "<i4"),
        "count": len(used),
        "values": channel.finish(blocks),
        "most": float(sizes.max()),
        "typical": float(np.percentile(sizes.max(axis=1), 75)) or float(sizes.max()),
        "unit": run.unit_of("force"),
    }


class Film:
    """Frames of all fields, added one by one."""

    def __init__(self, run: Run, first: Grid, whole: Surface, surface: Surface, times: list[float]) -> None:
        """whole: the surface before nodes of it were left out."""
        self.run, self.surface, self.times = run, surface, times
        self.obstacles = {o["interface"]: o for o in run.obstacles(np.array(times))}
        self.u, self.fields, self.forces = Channel(), {}, Channel()
        self.interfaces = [InterfaceFields(run, first, k, whole) for k in range(len(run.interfaces))]
        of_interfaces = np.unique(np.concatenate([[], *(i.nodes for i in self.interfaces)]).astype(int))
        self.drawn = np.full(len(first.points), -1)
        self.drawn[surface.nodes[::-1]] = np.arange(len(surface.nodes))[::-1]
        counterparts = any("obstacle" not in i for i in run.interfaces)  # these also push on other nodes
        has_faces = counterparts and run.dimension == 3 and whole.polygons
        self.facets = PushedFacets(first.points, whole) if has_faces else None
        self.pushed = surface.nodes if counterparts else of_interfaces[self.drawn[of_interfaces] >= 0]
        self.pushed = np.unique(self.pushed)
        self.is_both_sided = np.zeros(len(first.points), bool)  # nodes that push, and are pushed by those they meet
        for fields in self.interfaces:
            of_surface = "against" in fields.interface
            self.is_both_sided[fields.nodes] |= of_surface and fields.interface.get("area_factor", 1) != 1
        self.force_frames: list[np.ndarray] = []

    def add_field(self, name: str, nodes: Optional[np.ndarray], values: np.ndarray, interface: str = "") -> None:
        key = (name, interface)
        if key not in self.fields:
            drawn = None if nodes is None else self.drawn[nodes]
            self.fields[key] = (Channel(), drawn)
        channel, drawn = self.fields[key]
        channel.add(values[self.surface.nodes] if drawn is None else values[drawn >= 0])

    def add(self, grid: Grid, frame: int) -> None:
        on_surface = self.surface.nodes
        self.u.add(grid.nodes["u"][on_surface])
        self.add_field("displacement", None, np.linalg.norm(grid.nodes["u"], axis=1))
        self.add_field("speed", None, np.linalg.norm(grid.nodes["v"], axis=1))
        if "von_mises" in grid.cells:
            self.add_field("von Mises stress", None, nodal_mean(grid, "von_mises"))
        if "temperature" in grid.nodes:
            self.add_field("temperature", None, grid.nodes["temperature"])
        self.force_frames.append((grid.nodes["r"][self.pushed] / self.run.summary["dt"]).astype(np.float32))
        together: dict[str, np.ndarray] = {}
        several = len(self.interfaces) > 1 or self.facets is not None
        for fields in self.interfaces:
            name = fields.interface["name"]
            obstacle, speed = self.obstacles.get(name), self.speed_of(name, frame)
            for key, values in fields.values(grid, obstacle, frame, speed).items():
                self.add_field(key, fields.nodes, values, name)
                if several and key in ("pressure", "status"):
                    whole = together.setdefault(key, np.full(len(grid.points), np.nan))
                    whole[fields.nodes] = np.fmax(whole[fields.nodes], values)
        if self.facets:
            on_both = self.facets.pressure(grid.points + grid.nodes["u"], grid.nodes["r"] / self.run.summary["dt"])
            own = together["pressure"]
            own[:] = np.where(np.isnan(own) | self.is_both_sided, on_both, own)
        for key, whole in together.items():
            self.add_field(key, None, whole, "all interfaces")

    def speed_of(self, interface: str, frame: int) -> np.ndarray:
        """Velocity of an obstacle over the last step; it is 0 without one."""
        step, time = self.run.summary["dt"], self.times[frame]
        for obstacle in self.run.obstacles(np.array([time - step, time])):
            if obstacle["interface"] == interface:
                return (np.array(obstacle["place"][1]) - obstacle["place"][0]) / step
        return np.zeros(3)

    def size(self) -> int:
        """Bytes so far, before they are written as text."""
        return sum(channel.size() for channel in (self.u, *(c for c, _ in self.fields.values())))

    def finish(self, blocks: Blocks, points: np.ndarray) -> dict[str, Any]:
        fields = []
        for (name, interface), (channel, drawn) in self.fields.items():
            is_zero = channel.least == channel.most == 0.0 and name not in ("status", "pressure")
            if channel.least <= channel.most and not is_zero:
                shown_on = None if drawn is None else blocks.add(drawn[drawn >= 0], "<i4")
                fields.append(field_entry(self.run, blocks, (name, interface), channel, shown_on))
        first = ("status", *SHOWN_FIRST) if self.surface.is_points else SHOWN_FIRST
        order = {name: k for k, name in reversed(list(enumerate(first)))}
        fields.sort(key=lambda f: (order.get(f["name"], len(order) - 1.5), f["interface"] != "all interfaces"))
        return {
            "nodes": len(self.surface.nodes),
            "points": blocks.add(points[self.surface.nodes] + self.surface.offset, "<f4"),
            "modelNodes": blocks.add(self.surface.nodes, "<i4"),
            "isPoints": self.surface.is_points,
            "u": self.u.finish(blocks),
            "bodies": self.bodies(blocks),
            "fields": fields,
            "forces": forces_entry(self.run, blocks, self.drawn[self.pushed], np.array(self.force_frames)),
            "lift": -float(self.surface.offset[:, 1].min(initial=0.0)),
        }

    def bodies(self, blocks: Blocks) -> list[dict[str, Any]]:
        found, surface = [], self.surface
        for body in self.run.bodies():
            mine = (surface.nodes >= body.first) & (surface.nodes < body.first + body.count)
            if not mine.any():
                continue
            part = {"name": body.name, "nodes": int(body.count)}
            if surface.is_points:
                part["drawn"] = blocks.add(np.flatnonzero(mine), "<i4")
            else:
                part["triangles"] = blocks.add(surface.triangles[mine[surface.triangles[:, 0]]], "<i4")
                part["edges"] = blocks.add(surface.edges[mine[surface.edges[:, 0]]], "<i4")
                part["facets"] = int(mine[surface.facets].sum())
            found.append(part)
        return found


def film_of_fields(run: Run, blocks: Blocks, megabytes: float, notes: list[str]) -> tuple[dict[str, Any], list[float]]:
    """The frames that fit: fewer in time first, then, below LEAST_FRAMES, fewer in space."""
    files: list[tuple[float, Path]] = run.field_files()
    first = read_grid(files[0][1])
    surface = surface_of(first)

    def film(chosen: list[int], with_surface: Surface) -> Film:
        times = [files[k][0] for k in chosen]
        made = Film(run, first, surface, with_surface, times)
        for frame, k in enumerate(chosen):
            made.add(read_grid(files[k][1]), frame)
        return made

    drawn = surface
    allowed = megabytes * 1e6 * 3 / 4  # base64 writes 3 bytes as 4 letters
    if len(surface.nodes) * len(files) * 20 > allowed:
        per_frame = max(film([k], surface).size() for k in (len(files) // 2, len(files) - 1)) or 1
        chosen = frames_to_show(len(files), max(LEAST_FRAMES, int(allowed / per_frame)))
        if per_frame * len(chosen) > allowed and len(surface.nodes) > 1000:
            share = allowed / (per_frame * len(chosen))
            drawn = thinned(surface, first.points, run.bodies(), share)
            left = f"{len(drawn.nodes)} of {len(surface.nodes)} surface nodes are drawn"
            notes.append(f"{left}: a larger --megabytes draws more.")
        if len(chosen) < len(files):
            notes.append(f"{len(chosen)} of {len(files)} frames are shown: a larger --megabytes shows more.")
    else:
        chosen = list(range(len(files)))
    made = film(chosen, drawn)
    return made.finish(blocks, first.points), made.times
