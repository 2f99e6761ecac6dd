"""The folder that `ilaw run` leaves: summary, history, events, and fields as VTK files, read into arrays of numpy."""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import collections
import csv
import json
import math
from pathlib import Path
from typing import Any, Callable, NamedTuple

import numpy as np

STATUS_NAMES = ["free", "closed", "stick", "slip", "bonded", "broken", "healed", "bad input"]
# Names of derived units in consistent systems of (length, mass, time): force, stress, energy.
NAMED_UNITS = {
    ("m", "kg", "s"): ("N", "Pa", "J"),
    ("mm", "t", "s"): ("N", "MPa", "mJ"),
    ("mm", "g", "ms"): ("N", "MPa", "mJ"),
    ("mm", "kg", "ms"): ("kN", "GPa", "J"),
}


class UnreadableRun(Exception):
    """The folder has no run that can be read; the message says what was found and expected."""


class Body(NamedTuple):
    name: str
    first: int  # of its nodes
    count: int


class Grid(NamedTuple):
    """One VTK file: arrays per node and per cell."""

    points: np.ndarray
    nodes: dict[str, np.ndarray]
    cells: dict[str, np.ndarray]
    data: Any  # vtkUnstructuredGrid


def read_grid(file: Path) -> Grid:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    if not file.is_file():
        raise UnreadableRun(f"{file}: found no such file, expected the fields that the series beside it lists")
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(file))
    reader.Update()
    grid = reader.GetOutput()
    if not grid.GetNumberOfPoints():
        raise UnreadableRun(f"{file}: found no nodes, expected a VTK file that `ilaw run` wrote whole")

    def arrays(attributes: Any) -> dict[str, np.ndarray]:
        count = attributes.GetNumberOfArrays()
        return {attributes.GetArrayName(k): vtk_to_numpy(attributes.GetArray(k)) for k in range(count)}

    points = vtk_to_numpy(grid.GetPoints().GetData())
    return Grid(points, arrays(grid.GetPointData()), arrays(grid.GetCellData()), grid)


def table_at(table: Any, time: float, components: int) -> np.ndarray:
    """Value of a time table of the scene: rows, linear or smooth between them and constant outside, or a sine."""
    if isinstance(table, dict) and "sine" in table:
        sine = table["sine"]
        angle = 2.0 * math.pi * sine["frequency"] * time + sine.get("phase", 0.0)
        mean, amplitude = np.atleast_1d(sine.get("mean", 0.0)), np.atleast_1d(sine["amplitude"])
        return np.broadcast_to(mean + amplitude * math.sin(angle), components).astype(float)
    smooth = isinstance(table, dict) and table.get("smooth", False)
    rows = np.array(table["rows"] if isinstance(table, dict) else table, dtype=float)
    times = rows[:, 0]
    after = int(np.searchsorted(times, time, side="right"))
    if after == 0 or after == len(times):
        return rows[min(after, len(times) - 1), 1:]
    x = (time - times[after - 1]) / (times[after] - times[after - 1])
    x = x**3 * (10.0 - 15.0 * x + 6.0 * x * x) if smooth else x
    return (1.0 - x) * rows[after - 1, 1:] + x * rows[after, 1:]


class Run:
    def __init__(self, folder: Path) -> None:
        self.folder = folder
        file = folder / "summary.json"
        if not file.is_file():
            found = "no summary.json" if folder.is_dir() else "a file" if folder.exists() else "no such folder"
            raise UnreadableRun(f"{folder}: found {found}, expected a folder that `ilaw run SCENE --out DIR` wrote")
        try:
            self.summary = json.loads(file.read_text(encoding="utf-8"))
            self.scene: dict[str, Any] = self.summary["scene"]["source"]
        except (ValueError, KeyError, TypeError) as reason:
            raise UnreadableRun(f"{file}: found no summary of a run ({reason!r}), expected that file whole") from None
        self.model: dict[str, Any] = self.scene["model"]
        types = {"points": self.model.get("dimension"), "rotating_spring": 2, "bars": 1}
        self.dimension: int = types.get(self.model["type"]) or 3
        self.interfaces: list[dict[str, Any]] = [
            {**given, "name": done["name"], "law": done["law"]}
            for given, done in zip(self.scene["interfaces"], self.summary["interfaces"])
        ]

    @property
    def title(self) -> str:
        return self.summary["scene"].get("title") or Path(self.summary["scene"]["file"]).stem or self.folder.name

    def field_files(self) -> list[tuple[float, Path]]:
        """Times and files of the fields, in order; empty without fields."""
        series = self.folder / "fields.vtu.series"
        if not series.is_file():
            return []
        return [(entry["time"], self.folder / entry["name"]) for entry in json.loads(series.read_text())["files"]]

    def history(self, is_wanted: Callable[[str], bool] = lambda name: True) -> tuple[list[str], np.ndarray]:
        """Names of the wanted columns, and their rows."""
        file = self.folder / "history.csv"
        if not file.is_file():
            return [], np.empty((0, 0))
        with file.open(encoding="utf-8") as stream:
            names = next(csv.reader([stream.readline()]), [])
            columns = [k for k, name in enumerate(names) if is_wanted(name)]
            has_rows = bool(columns) and stream.tell() < file.stat().st_size
            rows = (np.loadtxt(stream, delimiter=",", ndmin=2, usecols=columns, comments=None) if has_rows
                    else np.empty((0, len(columns))))  # fmt: skip
        return [names[k] for k in columns], rows

    def events(self) -> list[dict[str, Any]]:
        """Nodes that had the same event in the same step are one entry."""
        file = self.folder / "events.csv"
        if not file.is_file():
            return []
        nodes: dict[tuple[float, str, str], list[int]] = collections.defaultdict(list)
        with file.open(encoding="utf-8") as stream:
            for row in csv.DictReader(stream):
                nodes[float(row["time"]), row["interface"], row["event"]].append(int(row["node"]))
        return [
            {"time": time, "interface": interface, "event": event, "count": len(found), "nodes": found[:100]}
            for (time, interface, event), found in sorted(nodes.items(), key=lambda entry: entry[0][0])
        ]

    def bodies(self) -> list[Body]:
        """Bodies are numbered one after the other: bars or blocks, then meshes; points are one body together."""
        sizes: list[tuple[str, int]] = []
        for k, bar in enumerate(self.model.get("bars", [])):
            sizes.append((bar.get("name", f"bar{k}"), bar["elements"] + 1))
        for k, block in enumerate(self.model.get("blocks", [])):
            sizes.append((block.get("name", f"block{k}"), math.prod(n + 1 for n in block["elements"])))
        for mesh in self.summary.get("meshes", []):
            sizes.append((mesh["name"], mesh["nodes"]))
        sizes = sizes or [("points", self.summary["nodes"])]
        firsts = np.cumsum([0, *(count for _, count in sizes)])
        return [Body(name, int(first), count) for (name, count), first in zip(sizes, firsts)]

    def unit_of(self, quantity: str) -> str:
        """Unit of a quantity in the units that the scene names; empty if it names none."""
        units = self.scene.get("units") or {}
        if not all(isinstance(units.get(key), str) for key in ("length", "mass", "time")):
            return ""
        length, mass, time = units["length"], units["mass"], units["time"]
        composed = f"{mass} {length}/{time}²", f"{mass}/({length} {time}²)", f"{mass} {length}²/{time}²"
        force, stress, energy = NAMED_UNITS.get((length, mass, time), composed)
        names = {"length": length, "time": time, "velocity": f"{length}/{time}", "force": force, "stress": stress}
        names |= {"energy": energy, "impulse": f"{force} {time}", "moment": f"{force} {length}"}
        names["temperature"] = units.get("temperature", "")
        return names.get(quantity, "")

    def obstacles(self, times: np.ndarray) -> list[dict[str, Any]]:
        """Shape of each obstacle with its place, axis and angle of turning at the times."""
        found = []
        for interface in self.interfaces:
            given = interface.get("obstacle")
            if not given:
                continue
            start = _in_3d(given.get("center", given.get("point")))
            axis = _in_3d(given.get("normal") or given.get("axis") or [0.0, 0.0, 1.0])
            axis /= np.linalg.norm(axis)
            states = [self._obstacle_at(given, axis, start, float(time)) for time in times]
            found.append(
                {"interface": interface["name"], "type": given["type"], "radius": given.get("radius", 0.0),
                 "place": [state[0].tolist() for state in states], "axis": [state[1].tolist() for state in states],
                 "angle": [state[2] for state in states], "turns": bool(given.get("rate") or given.get("angles"))}
            )  # fmt: skip
        return found

    def _obstacle_at(self, given: dict[str, Any], axis: np.ndarray, start: np.ndarray, time: float) -> tuple:
        moved = _in_3d(given.get("velocity", [0.0])) * time
        if "path" in given:
            moved = _in_3d(table_at(given["path"], time, self.dimension))
        angle = given.get("rate", 0.0) * time
        if "angles" in given:
            angle = float(table_at(given["angles"], time, 1)[0])
        if "tilt" in given:
            about = _in_3d(given["tilt"].get("axis") or [0.0, 0.0, 1.0])
            tilt = float(table_at(given["tilt"]["angles"], time, 1)[0])
            axis = _rotated(axis, about / np.linalg.norm(about), tilt)
        return start + moved, axis, angle


def _in_3d(vector: Any) -> np.ndarray:
    return np.array([*vector, 0.0, 0.0][:3], dtype=float)


def _rotated(vector: np.ndarray, axis: np.ndarray, angle: float) -> np.ndarray:
    """Rodrigues' formula."""
    across = np.cross(axis, vector)
    return vector * math.cos(angle) + across * math.sin(angle) + axis * (axis @ vector) * (1.0 - math.cos(angle))
