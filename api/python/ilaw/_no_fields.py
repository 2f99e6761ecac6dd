"""What is known of the motion without fields: watched points from the history, boxes at the start."""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

from typing import Any, Optional

import numpy as np

from ._film import Blocks, Channel, field_entry, forces_entry, frames_to_show
from ._results import Run
from ._surfaces import edges_of, triangles_of

MOST_FRAMES = 300
QUADS = np.array([[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])
BOX = triangles_of([QUADS])
BOX_EDGES = edges_of([QUADS])
Motion = tuple[Optional[dict[str, Any]], list[float]]  # what moves, and the times of its frames


def places_of(run: Run) -> Optional[np.ndarray]:
    """Positions of points, if the summary still has them: long lists of points are left out of it."""
    if run.model["type"] == "rotating_spring":
        return np.array([[*run.model["position"], 0.0]])
    points = run.model.get("points")
    if not isinstance(points, list) or not points or "position" not in points[0]:
        return None
    return np.array([[*point["position"], 0.0, 0.0][:3] for point in points], dtype=float)


def lanes(places: np.ndarray, dimension: int) -> np.ndarray:
    """Points of a 1D model are drawn side by side."""
    offset = np.zeros_like(places)
    if dimension == 1 and len(places) > 1:
        offset[:, 1] = -np.arange(len(places)) * 0.1 * float(np.ptp(places[:, 0]) or np.abs(places).max() or 1.0)
    return offset


def film_of_points(run: Run, blocks: Blocks, names: list[str], rows: np.ndarray) -> Motion:
    places = places_of(run)
    watched = [] if places is None else [k for k in range(len(places)) if f"n{k}.u0" in names]
    if not watched or not len(rows):
        return None, []
    column = {name: k for k, name in enumerate(names)}
    chosen = frames_to_show(len(rows), MOST_FRAMES)

    def vectors(quantity: str) -> np.ndarray:
        found = np.zeros((len(chosen), len(watched), 3))
        for n, node in enumerate(watched):
            for c in range(run.dimension):
                found[:, n, c] = rows[chosen, column[f"n{node}.{quantity}{c}"]]
        return found

    u, v, r = vectors("u"), vectors("v"), vectors("r")
    values = {("displacement", ""): np.linalg.norm(u, axis=2), ("speed", ""): np.linalg.norm(v, axis=2)}
    for n, node in enumerate(watched):
        for name, k in column.items():
            prefix, _, quantity = name.rpartition(".")
            if prefix.split(".")[0] != f"n{node}" or name[len(f"n{node}.") :] in _vector_names(run.dimension):
                continue
            key = ("temperature" if quantity == "T" else quantity, prefix.partition(".")[2])
            values.setdefault(key, np.full((len(chosen), len(watched)), np.nan))[:, n] = rows[chosen, k]
    fields = []
    for (name, interface), array in values.items():
        channel = Channel()
        for frame in array:
            channel.add(frame)
        if channel.least < channel.most or name == "status":
            fields.append(field_entry(run, blocks, (name, interface), channel, None))
    first = {"status": 0, "displacement": 1, "speed": 2}
    fields.sort(key=lambda field: first.get(field["name"], 3))
    motion, everyone = Channel(), np.arange(len(watched))
    for displacement in u:
        motion.add(displacement)
    offset = lanes(places, run.dimension)
    others = np.setdiff1d(np.arange(len(places)), watched)
    return {
        "nodes": len(watched),
        "points": blocks.add((places + offset)[watched], "<f4"),
        "modelNodes": blocks.add(np.array(watched), "<i4"),
        "isPoints": True,
        "u": motion.finish(blocks),
        "bodies": [{"name": "points", "nodes": len(watched), "drawn": blocks.add(everyone, "<i4")}],
        "fields": fields,
        "forces": forces_entry(run, blocks, everyone, r / run.summary["dt"]),
        "springs": _springs(run, watched),
        "others": blocks.add((places + offset)[others], "<f4") if len(others) else None,
    }, rows[chosen, 0].tolist()


def _vector_names(dimension: int) -> set[str]:
    return {f"{quantity}{c}" for quantity in ("u", "v", "vm", "r") for c in range(dimension)}


def _springs(run: Run, watched: list[int]) -> Optional[dict[str, Any]]:
    """Pairs of drawn nodes; those to a fixed point have its place. Nodes given by name are not resolved here."""
    index = {node: k for k, node in enumerate(watched)}
    pairs, anchors = [], []
    for spring in run.scene.get("springs", []):
        nodes, partners = spring["nodes"], spring.get("to")
        if not isinstance(nodes, list):
            continue
        if isinstance(partners, list):
            pairs += [(index[a], index[b]) for a, b in zip(nodes, partners) if a in index and b in index]
        elif "anchor" in spring:
            anchors += [[index[a], *[*spring["anchor"], 0.0, 0.0][:3]] for a in nodes if a in index]
    if run.model["type"] == "rotating_spring":
        anchors.append([0, 0.0, 0.0, 0.0])
    if not pairs and not anchors:
        return None
    return {"pairs": pairs, "anchors": anchors}


def film_of_boxes(run: Run, blocks: Blocks) -> Motion:
    """Blocks and bars at their places in the scene, at rest."""
    corners, names = [], []
    for k, block in enumerate(run.model.get("blocks", [])):
        low, size = np.array(block.get("corner", [0.0] * 3), float), np.array(block["size"], float)
        corners.append([low + size * [i & 1, i >> 1 & 1, i >> 2] for i in range(8)])
        names.append(block.get("name", f"block{k}"))
    bars = run.model.get("bars", [])
    height = 0.04 * sum(bar["length"] for bar in bars)
    for k, bar in enumerate(bars):
        start, size = np.array([bar.get("start", 0.0), -height, 0.0]), np.array([bar["length"], 2 * height, 0.0])
        corners.append([start + size * [i & 1, i >> 1 & 1, i >> 2] for i in range(8)])
        names.append(bar.get("name", f"bar{k}"))
    if not corners:
        return None, []
    x = np.array(corners).reshape(-1, 3)
    still = Channel()
    still.add(np.zeros_like(x))
    bodies = []
    for k, name in enumerate(names):
        triangles, edges = (blocks.add(part + 8 * k, "<i4") for part in (BOX, BOX_EDGES))
        bodies.append({"name": name, "nodes": 8, "triangles": triangles, "edges": edges})
    return {
        "nodes": len(x),
        "points": blocks.add(x, "<f4"),
        "modelNodes": blocks.add(np.full(len(x), -1), "<i4"),
        "isPoints": False,
        "u": still.finish(blocks),
        "bodies": bodies,
        "fields": [],
        "forces": None,
    }, [0.0]
