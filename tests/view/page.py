"""Runs of scenes, and the numbers of their pages."""
# SPDX-License-Identifier: BSD-3-Clause

import base64
import csv
import gzip
import json
import os
import re
import subprocess

import numpy as np

PROGRAM = os.environ["ILAW_PROGRAM"]
RUBBER = {"type": "neo_hookean", "young": 1e6, "poisson": 0.3, "density": 1000}


def box(name, corner, velocity, size=(0.1, 0.1, 0.05), elements=(4, 4, 2)):
    shape = {"corner": corner, "size": size, "elements": elements}
    return {"name": name, **shape, "velocity": velocity, "material": RUBBER}


# Two boxes fall on each other and on a floor; rows and frames are of the same steps.
TWO_BOXES = {
    "title": "Two boxes </script><script>fail()</script>",
    "model": {"type": "blocks", "blocks": [
        box("lower", [0, 0, 0.001], [0, 0, -1]),
        box("upper", [0.02, 0.02, 0.0525], [0.3, 0, -2], (0.05, 0.05, 0.05), (3, 3, 3))]},
    "time": {"cfl": 0.7, "end": 0.02},
    "interfaces": [
        {"name": "floor", "law": "coulomb", "parameters": {"friction": 0.3}, "nodes": "lower.z_min",
         "obstacle": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}},
        {"name": "between", "law": "coulomb", "parameters": {"friction": 0.5}, "nodes": "upper.z_min",
         "against": {"surface": "lower.z_max"}}],
    "output": {"every": 1, "fields": 1, "watch": ["upper.z_min"], "forces": ["floor", "between"],
               "balance": True, "events": True},
}  # fmt: skip


def points(dimension, masses, interfaces, **more):
    model = {"type": "points", "dimension": dimension, "points": masses}
    time = {"dt": 1e-3, "end": 0.5}
    scene = {"model": model, "time": time, "interfaces": interfaces, "output": {"watch": [0]}}
    return {**scene, **more}


# Two masses rest on a floor under gravity.
RESTING = points(
    2, [{"mass": 2, "area": 0.5, "position": [0, 0]}, {"mass": 3, "area": 0.5, "position": [1, 0]}],
    [{"name": "floor", "law": "coulomb", "parameters": {"friction": 0.3}, "nodes": "all",
      "obstacle": {"type": "plane", "point": [0, 0], "normal": [0, 1]}}],
    loads=[{"type": "gravity", "acceleration": [0, -10]}],
)  # fmt: skip


def run(scene, folder):
    file = folder / "scene.json"
    file.write_text(json.dumps(scene))
    done = subprocess.run([PROGRAM, "run", file, "--out", folder / "results"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return folder / "results"


def view(results, *options, **environment):
    return subprocess.run(
        [PROGRAM, "view", results, *options], capture_output=True, text=True, env={**os.environ, **environment}
    )


class Page:
    def __init__(self, file):
        self.text = file.read_text()
        self.run = json.loads(re.search(r'<script type="application/json" id="run">(.*?)</script>', self.text)[1])
        self.blocks = re.findall(r'<script type="text/plain" id="block\d+">([^<]*)</script>', self.text)
        self.film, self.frames = self.run["film"], len(self.run["times"])

    def array(self, part):
        return np.frombuffer(gzip.decompress(base64.b64decode(self.blocks[part["block"]])), part["kind"])

    def channel(self, part, components=1):
        """Frames, nodes, components; NaN where there is no value."""
        low, step = (self.array(part[key]).reshape(-1, 1, components) for key in ("low", "step"))
        levels = self.array(part).reshape(len(low), -1, components)
        return np.where(levels == 65535, np.nan, low + step * levels)

    def field(self, name, interface=""):
        found = next(f for f in self.film["fields"] if (f["name"], f["interface"]) == (name, interface))
        return self.channel(found["values"])[:, :, 0]


def history(results):
    with open(results / "history.csv") as file:
        rows = list(csv.DictReader(file))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}
