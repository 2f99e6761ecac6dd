"""Runs of a scene with other steps, meshes and laws, each a process of `ilaw run`, and what they leave as arrays."""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import copy
import json
import math
import os
import re
import signal
import subprocess
import tempfile
from pathlib import Path
from typing import Any, Iterator, NamedTuple, Optional

import numpy as np

from ._command import DONE, BadInput, complain
from ._errors import Trace
from ._exact import Exact, Scene, exact_solution
from ._results import Run
from .runs import program

BROKEN = 5
MISSED = 3  # exit code of a run that is complete, but not as the scene expects
MOST_ENERGY_PUT_IN = 0.1  # of the largest so far by the interfaces of a stable run; the run itself warns of more


class Failed(RuntimeError):
    """A run that failed, and why."""


def mistake(pointer: str, found: Any, expected: str) -> BadInput:
    shown = found if isinstance(found, str) else json.dumps(found, separators=(",", ":"))
    return BadInput(f"{pointer}: found {shown}, expected {expected}")


class Sweep(NamedTuple):
    levels: int
    factor: float
    first: float  # step (and element size) of level 0 over the scene's
    with_mesh: bool

    def refinement(self, level: int) -> float:
        """How many times smaller than the scene's."""
        return self.factor**level / self.first


def read_sweep(given: Scene, options: Any) -> Sweep:
    """The keys of "converge" or "study" in a scene, unless options of the command line replace them."""
    read = {key: getattr(options, key, None) or given.get(key, usual)
            for key, usual in (("levels", 5), ("factor", 2.0), ("first", 1.0), ("refine", "time"))}  # fmt: skip
    return Sweep(read["levels"], read["factor"], read["first"], read["refine"] == "mesh")


def check_mesh(scene: Scene, sweep: Sweep, pointer: str) -> None:
    """Refuses to refine a model without mesh, or a scene that names nodes by number: they change on a refined mesh."""
    if not sweep.with_mesh:
        return
    if "meshes" in scene["model"]:
        raise mistake(f"{pointer}/refine", '"mesh"', '"time": a mesh from a file cannot be refined')
    if not {"bars", "blocks"} & scene["model"].keys():
        raise mistake(f"{pointer}/refine", '"mesh"', '"time": the model has no mesh')
    for place, key, value in parts_of(scene, ""):
        names = key in ("nodes", "watch", "to") or place.startswith("/sets/") and place.count("/") == 2
        numbers = [(f"{place}/{k}", one) for k, one in enumerate(value) if isinstance(one, (int, float))] \
            if names and isinstance(value, list) else []  # fmt: skip
        for found in [(place, value)] if key == "per_node" else numbers[:1]:
            raise mistake(*found, "a set, a box or near: on a refined mesh a number is another node")


def key_of(time: Scene) -> str:
    return "dt" if "dt" in time else "cfl"


def steps_of(end: float, dt: float) -> int:
    steps = end / dt
    return round(steps) if abs(steps - round(steps)) <= 1e-9 * round(steps) else math.ceil(steps)


def parts_of(part: Any, pointer: str) -> Iterator[tuple[str, str, Any]]:
    """All entries of a scene in the order of their keys: pointer, key, value."""
    entries = sorted(part.items()) if isinstance(part, dict) else enumerate(part) if isinstance(part, list) else ()
    for key, value in entries:
        yield f"{pointer}/{key}", str(key), value
        yield from parts_of(value, f"{pointer}/{key}")


def refined(scene: Scene, sweep: Sweep, by: float) -> Scene:
    """The scene with smaller steps, and elements if the mesh goes with them."""
    scene = copy.deepcopy(scene)
    time, model = scene["time"], scene["model"]
    for body in [*model.get("bars", []), *model.get("blocks", [])] if sweep.with_mesh else []:
        counts = body["elements"]
        finer = [math.floor(n * by + 0.5) for n in np.atleast_1d(counts).tolist()]
        body["elements"] = finer if isinstance(counts, list) else finer[0]
    if not (sweep.with_mesh and "cfl" in time):  # with cfl the time step follows the mesh
        time[key_of(time)] /= by
    return scene


class Probe(NamedTuple):
    """What a scene says of itself in its first step."""

    dt: float
    steps: int
    unit: float  # dt over the "dt" or "cfl" of the scene
    critical_step: float
    least_mass: float  # of its interface nodes
    watched: int
    interfaces: list[str]


class Scenes:
    """A scene file, and runs of scenes that differ from it."""

    def __init__(self, file: Path, threads: int) -> None:
        self.file, self.threads = file, threads
        self.said: list[str] = []  # warnings of the last run
        self.warnings: dict[tuple[str, str], list[str]] = {}
        self.room = tempfile.TemporaryDirectory(prefix="ilaw_")
        # Small files of the many short runs need not wait for the disk.
        memory = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None
        self.quick_room = tempfile.TemporaryDirectory(prefix="ilaw_", dir=memory)

    def __enter__(self) -> "Scenes":
        return self

    def __exit__(self, *_: Any) -> None:
        self.room.cleanup()
        self.quick_room.cleanup()

    def read(self) -> Scene:
        scene = self.parse()
        self.probe(scene, "expect")
        return scene

    def parse(self) -> Scene:
        """Refuses what is no JSON object as `ilaw run` does."""
        def once(pairs: list[tuple[str, Any]]) -> Scene:
            if len(dict(pairs)) < len(pairs):
                raise ValueError("a key twice")
            return dict(pairs)

        try:
            scene = json.loads(self.file.read_text(encoding="utf-8-sig"), object_pairs_hook=once)
            if isinstance(scene, dict):
                return scene
        except (OSError, ValueError, RecursionError):
            pass
        self._run("--out", Path(self.quick_room.name) / "refused")
        raise BadInput("found no scene that Python reads, expected a JSON object")

    def probe(self, scene: Scene, *kept: str) -> Probe:
        """Refuses what `ilaw run` refuses, and finds what it works out."""
        time = scene.get("time")
        if isinstance(time, dict) and isinstance(time.get("end"), (int, float)) and time["end"] > 0:
            time = {**time, "end": 1e-300}  # one step
        run = self._run_scene({**scene, "time": time}, self.quick_room, *kept)
        names, _ = run.history()
        dt, time = run.summary["dt"], scene["time"]
        interfaces = [one for one in run.summary["interfaces"] if "edges_of" not in one]  # those count in their interface
        masses = [float(interface["least_mass"]) for interface in interfaces]
        return Probe(dt, steps_of(time["end"], dt), dt / time[key_of(time)], float(run.summary["critical_step"]),
                     min(masses, default=math.inf), sum(name.endswith(".u0") for name in names),
                     [interface["name"] for interface in interfaces])  # fmt: skip

    def trace(self, scene: Scene, names: list[str], law: str = "") -> Trace:
        """names: of the interfaces."""
        output = {"watch": scene["output"]["watch"], "every": 1, "balance": "interface_work", "forces": names}
        run = self._run_scene({**scene, "output": output}, self.room)
        for text in self.said:  # alike but for their numbers
            self.warnings.setdefault((law, re.sub(r"[\d.]+(e[+-]?\d+)?", "#", text)), []).append(text)
        return trace_of(run, names)

    def tell_warnings(self) -> None:
        """What the runs of trace() warned of: each warning once, as its first run gave it."""
        for (law, _), texts in self.warnings.items():
            of_law = f" with law '{law}'" if law else ""
            runs = "1 run" if len(texts) == 1 else f"{len(texts)} runs"
            complain(f"{self.file}: warning of {runs}{of_law}: {texts[0]}", DONE)

    def seconds(self, scene: Scene, steps: int) -> float:
        """Of the processor, for the steps alone."""
        run = self._run_scene({**scene, "output": {"every": steps, "balance": "interface_work"}}, self.quick_room)
        return run.summary["seconds"]["steps"]

    def is_stable(self, scene: Scene, steps: int) -> bool:
        """A run is stable if it does not fail and its interfaces put in little energy at any time."""
        output = {"every": max(steps // 500, 1), "balance": "reaction_work"}
        try:
            names, rows = self._run_scene({**scene, "output": output}, self.quick_room).history()
        except Failed:
            return False
        columns = dict(zip(names, rows.T))
        return bool((columns["balance.reaction_work"] <= MOST_ENERGY_PUT_IN * columns["balance.largest"]).all())

    def _run_scene(self, scene: Scene, room: Any, *kept: str) -> Run:
        """What the scene expects names columns that runs with other output lack; `kept` has "expect" if it is to be read."""
        folder, file = Path(room.name) / "out", Path(room.name) / "scene.json"
        (folder / "summary.json").unlink(missing_ok=True)
        file.write_text(json.dumps({key: scene[key] for key in scene if key != "expect" or key in kept}))
        self._run("--read-from", file, "--out", folder, "--threads", str(self.threads))
        return Run(folder)

    def _run(self, *options: Any) -> None:
        done = subprocess.run([program(), "run", self.file, *options], capture_output=True, text=True, errors="replace")
        self.said = re.findall(r"^ilaw: .*?: warning: (.*(?:\n  .*)*)", done.stderr, re.MULTILINE)
        if done.returncode in (0, MISSED):
            return
        said = ("\n" + done.stderr.strip()).rpartition("\nilaw: ")[2].removeprefix(f"{self.file}: ")
        if done.returncode == 2:
            raise BadInput(said)
        if done.returncode < 0:
            raise Failed(f"its process crashed: {signal.strsignal(-done.returncode)}")
        raise Failed(re.sub(r"^failed after step \d+, time \S+: |; that state is in .*", "", said))


def trace_of(run: Run, interfaces: list[str]) -> Trace:
    read = re.compile(r"time$|n\d+\.(u|v|r)\d$|n\d+\.(\S+\.)?status$|balance\.interface_work$|(%s)\.F\d$"
                      % "|".join(map(re.escape, interfaces)))  # fmt: skip
    names, rows = run.history(lambda name: read.match(name) is not None)
    columns = dict(zip(names, rows.T))
    summary = run.summary
    nodes = [name[:-3] for name in names if re.fullmatch(r"n\d+\.u0", name)]
    components = range(run.dimension)

    def of_nodes(quantity: str) -> np.ndarray:
        return np.column_stack([columns[f"{node}.{quantity}{c}"] for node in nodes for c in components])

    forces = np.column_stack([columns[f"{name}.F{c}"] for name in interfaces for c in components] or
                             [np.empty((len(rows), 0))])  # fmt: skip
    impulse = summary["dt"] * np.cumsum(forces, axis=0)
    if interfaces:  # that of the start is no row
        impulse += np.concatenate([summary["forces"][name]["impulse"] for name in interfaces]) - impulse[-1]
    instants = np.full((len(nodes), 3), math.nan)
    for k, node in enumerate(nodes):
        contacts = [columns[name] for name in names if re.fullmatch(rf"{node}\.(\S+\.)?status", name)]
        given = np.any([columns[f"{node}.r{c}"] for c in components if contacts] or [False], axis=0)
        broken = np.any([status == BROKEN for status in contacts] or [False], axis=0)
        for place, found, which in ((0, given, 0), (1, given, -1), (2, broken, -1)):
            if found.any():
                instants[k, place] = rows[np.flatnonzero(found)[which], 0]
    return Trace(summary["dt"], summary["seconds"]["steps"], summary["penetration_max"],
                 summary["energy"]["largest"], of_nodes("u"), of_nodes("v"), impulse,
                 columns["balance.interface_work"], instants)  # fmt: skip


def exact_of(scene: Scene, probe: Probe) -> Optional[Exact]:
    return exact_solution(scene, probe.watched, probe.steps, probe.dt)


def expect_watched(probe: Probe, first: Optional[Probe] = None) -> None:
    """Nodes to compare, as many as on the first mesh."""
    if not probe.watched:
        raise mistake("/output/watch", "no node", "those to compare")
    if first and probe.watched != first.watched:
        raise mistake("/output/watch", f"{first.watched} and {probe.watched} nodes on two meshes", "the same places on all")
