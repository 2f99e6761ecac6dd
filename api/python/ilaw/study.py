"""`ilaw study`: laws side by side in a scene, the errors that they reach over steps and over run time."""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import argparse
import dataclasses
import json
import math
import statistics
import sys
from pathlib import Path
from typing import Callable, Iterator, Optional, Sequence

from ._command import (DONE, FAILED, BadInput, HeldFolder, Progress, complain, in_scene, print_rows, printable,
                       remove_pictures, run_command, sweep_parser, text_of, write_csv, write_json)  # fmt: skip
from ._errors import NO_ERRORS, NORMS, errors_against_exact, errors_against_run, scale_of
from ._exact import Scene
from ._variants import (Failed, Probe, Scenes, Sweep, check_mesh, exact_of, expect_watched, key_of, mistake, read_sweep,
                        refined, steps_of)  # fmt: skip

MARGIN = 0.9  # laws run at most at this part of their largest stable step
LEAST_STEP, ACCURACY = 1e-6, 1.01  # of the search for it, in steps of the scene
SEARCH_RUNS = 12  # about as many runs of level 0 it takes, to tell the progress
WANTED_ERRORS = (1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4)
# Powers of the step h in the units of parameters: stiffnesses in m/h^2, the damper in m/h.
SCALED = {"stiffness": 2, "tangential_stiffness": 2, "damping": 1}


@dataclasses.dataclass
class MeasuredRun:
    dt: float
    steps: int
    seconds: float = math.nan
    penetration: float = math.nan
    errors: dict[str, float] = dataclasses.field(default_factory=lambda: NO_ERRORS)
    failure: str = ""  # why it has no errors


@dataclasses.dataclass
class LawRuns:
    name: str
    entry: Scene
    tried: float  # largest step that was tried: that of the scene over 0.9, at most the critical one
    stable: float  # largest of them that is stable
    part: float  # step over that of the scene
    runs: list[MeasuredRun] = dataclasses.field(default_factory=list)


# ---- laws -------------------------------------------------------------------------------------------------------------


def read_law_option(text: str) -> Scene:
    """NAME, NAME:{parameters}, or an entry of study/laws itself."""
    name, colon, parameters = ("", ":", text) if text.startswith("{") else text.partition(":")
    if not name and not text.startswith("{"):
        raise BadInput(f"--law: found '{text}', expected NAME, NAME:{{parameters}}, or an entry of study/laws in JSON")
    try:
        given = json.loads(parameters) if colon else {}
    except ValueError as reason:
        raise BadInput(f"--law {text}: not valid JSON: {reason}") from None
    return given if not name else {"law": name, "parameters": given} if colon else {"law": name}


def damping_of(restitution: float, stiffness: float) -> float:
    """Damper of an explicit penalty, in units of m and h, from which a mass leaves at e times its speed.

    -ln e = 2 zeta arccos(zeta)/sqrt(1 - zeta^2) (Schwager and Poeschel 2007), by bisection.
    """
    low, high = 0.0, 0.999
    for _ in range(50):
        zeta = 0.5 * (low + high)
        loss = 2.0 * zeta * math.acos(zeta) / math.sqrt(1.0 - zeta * zeta)
        low, high = (zeta, high) if math.exp(-loss) > restitution else (low, zeta)
    return 2.0 * low * math.sqrt(stiffness)


def usual_penalty(scene: Scene, integration: str, stiffness: float) -> Scene:
    """With the friction of the scene's own law, and its restitution if no body gives the rebound."""
    own = scene["interfaces"][0].get("parameters", {})
    restitution = own.get("restitution", 0.0)
    parameters: Scene = {"stiffness": stiffness, "integration": integration}
    if "friction" in own:
        parameters["friction"] = own["friction"]
        if integration == "explicit":
            parameters["tangential_stiffness"] = stiffness
    if integration == "implicit":
        parameters["restitution"] = restitution
    elif scene["model"]["type"] not in ("bars", "blocks") and isinstance(restitution, (int, float)) and restitution < 1.0:
        parameters["damping"] = damping_of(restitution, stiffness)
    return {"name": f"{integration} k={stiffness}", "law": "penalty", "scaled": True, "parameters": parameters}


def usual_laws(scene: Scene) -> list[Scene]:
    """For a scene that lists none: its own law and, if that is contact, its activations and penalties."""
    laws = [interface["law"] for interface in scene["interfaces"]]
    if not laws or not set(laws) <= {"contact", "coulomb"}:
        return [{"name": "as in the scene"}]
    own = [{"name": f"{laws[0]} {activation}", "parameters": {"activation": activation}}
           for activation in ("predictive", "moreau")]  # fmt: skip
    springs = [("explicit", 0.1), ("explicit", 1.0), ("explicit", 10.0), ("implicit", 1.0), ("implicit", 100.0)]
    return own + [usual_penalty(scene, *spring) for spring in springs]


def name_of(entry: Scene) -> str:
    if "name" in entry:
        return entry["name"]
    parameters = sorted(entry.get("parameters", {}).items())
    texts = [f"{key} {value if isinstance(value, str) else json.dumps(value, separators=(',', ':'))}"
             for key, value in parameters]  # fmt: skip
    return " ".join([entry.get("law", "own law"), *texts]).replace(",", ";")  # in a table of comma-separated values


def with_law(scene: Scene, entry: Scene, mass: float, step: float) -> Scene:
    """The scene with the law of an entry at all its interfaces; one that names no law changes parameters alone.

    Scaled parameters are in units of the mass and of the step.
    """
    parameters = dict(entry.get("parameters", {}))
    for name in SCALED.keys() & parameters.keys() if entry.get("scaled") else ():
        if isinstance(parameters[name], (int, float)):
            parameters[name] *= mass / step ** SCALED[name]
    interfaces = []
    for own in scene["interfaces"]:
        if "law" in entry:
            kept = {key: own[key] for key in own if key != "library"}
            interfaces.append({**kept, "law": entry["law"], "parameters": parameters})
        else:
            interfaces.append({**own, "parameters": {**own.get("parameters", {}), **parameters}})
        if "library" in entry:
            interfaces[-1]["library"] = entry["library"]
    return {**scene, "interfaces": interfaces}


# ---- runs -------------------------------------------------------------------------------------------------------------


class Study:
    def __init__(self, scenes: Scenes, options: argparse.Namespace) -> None:
        """Refuses a scene that makes no sense, before anything is run."""
        self.scenes, self.source = scenes, scenes.read()
        if options.law:
            listed = {**self.source.get("study", {}), "laws": [read_law_option(text) for text in options.law]}
            self.source["study"] = listed
            scenes.probe(self.source)
        given = self.source.get("study", {})
        self.sweep: Sweep = read_sweep(given, options)
        self.most_steps = given.get("most_steps", 1_000_000)  # of a run but the first of a law
        self.finer = given.get("reference", 4.0)  # the reference beside the finest run
        self.repetitions = options.repetitions or given.get("repetitions", 5)
        self.entries = given["laws"] if "laws" in given else usual_laws(self.source)
        self.key = key_of(self.source["time"])
        self.probes: dict[float, Probe] = {}
        check_mesh(self.source, self.sweep, "/study")
        first, probe = self.own(self.sweep.refinement(0))
        self.interfaces = probe.interfaces
        self.exact = exact_of(first, probe) is not None
        self.reference = "exact solution" if self.exact else "finest run of the first law"
        names: set[str] = set()
        for k, entry in enumerate(self.entries):
            if name_of(entry) in names:
                raise mistake(f"/study/laws/{k}", f"'{name_of(entry)}' twice", "a different name for each")
            names.add(name_of(entry))
            self.check_law(entry)
        self.laws: list[LawRuns] = []
        self.done = 0.0
        each = SEARCH_RUNS + sum(self.weight(k) * (1 + self.repetitions) for k in range(self.sweep.levels))
        self.total = self.finer * self.weight(self.sweep.levels - 1) + len(self.entries) * each

    def own(self, refinement: float) -> tuple[Scene, Probe]:
        """The scene with its own law, and what it says of itself; only a refined mesh says anything new."""
        scene, key = refined(self.source, self.sweep, refinement), refinement if self.sweep.with_mesh else 1.0
        if key not in self.probes:
            self.probes[key] = self.scenes.probe(scene)
            expect_watched(self.probes[key], next(iter(self.probes.values())))
        probe = self.probes[key]
        dt = scene["time"][self.key] * probe.unit
        return scene, probe._replace(dt=dt, steps=steps_of(scene["time"]["end"], dt))

    def with_entry(self, entry: Scene, refinement: float, part: float) -> tuple[Scene, float, int]:
        """The scene with a law and a part of its step, that step, and the number of steps."""
        scene, probe = self.own(refinement)
        # The unit of time is the scene's step in a model without a mesh: the critical one of springs says nothing of it.
        has_mesh = not {"bars", "blocks", "meshes"}.isdisjoint(scene["model"])
        unit = probe.critical_step if has_mesh else self.source["time"][self.key] * probe.unit
        # A step beyond the critical one is refused, or makes no sense.
        given = min(scene["time"][self.key] * part, 1.0 if self.key == "cfl" else probe.critical_step)
        dt = given * probe.unit
        scene["time"][self.key] = given
        return with_law(scene, entry, probe.least_mass, unit), dt, steps_of(scene["time"]["end"], dt)

    def level(self, law: LawRuns, level: int) -> tuple[Scene, float, int]:
        return self.with_entry(law.entry, self.sweep.refinement(level), law.part)

    def check_law(self, entry: Scene) -> None:
        try:
            self.scenes.probe(self.with_entry(entry, self.sweep.refinement(0), 1.0)[0])
        except BadInput as reason:
            raise BadInput(f"with law '{name_of(entry)}': {reason}") from None
        except Failed:
            pass  # a smaller step may do

    def weight(self, level: int) -> float:
        """Work is told in runs of level 0."""
        return self.sweep.refinement(level) / self.sweep.refinement(0)

    def did(self, work: float) -> None:
        self.done += work
        self.progress.set(self.done, self.total)

    def run(self, progress: Progress) -> None:
        self.progress = progress
        for entry in self.entries:
            self.find_step(entry)
        fine = None
        if not self.exact:
            finest = self.sweep.refinement(self.sweep.levels - 1) * self.finer
            scene, _, _ = self.with_entry(self.laws[0].entry, finest, self.laws[0].part)
            fine = self.scenes.trace(scene, self.interfaces)
        self.did(self.finer * self.weight(self.sweep.levels - 1))
        for law in self.laws:
            for level in range(self.sweep.levels):
                scene, dt, steps = self.level(law, level)
                if level > 0 and steps > self.most_steps:
                    break
                measured = MeasuredRun(dt, steps)
                try:
                    trace = self.scenes.trace(scene, self.interfaces, law.name)
                    measured.penetration = trace.penetration
                    measured.errors = (errors_against_run(fine, trace) if fine else errors_against_exact(
                        exact_of(*self.own(self.sweep.refinement(level))), trace))  # fmt: skip
                except Failed as failure:  # is part of what is measured
                    measured.failure = str(failure)
                law.runs.append(measured)
                self.did(self.weight(level))
        self.find_times()
        progress.set(self.total, self.total)

    def find_step(self, entry: Scene) -> None:
        """The largest stable step, by halving and bisection, on the coarsest mesh; on finer ones it follows the mesh."""
        level0 = self.sweep.refinement(0)
        step = self.own(level0)[1].dt
        tried = self.with_entry(entry, level0, 1.0 / MARGIN)[1]

        def is_stable(part: float) -> bool:
            scene, _, steps = self.with_entry(entry, level0, part * (tried / step))
            return self.scenes.is_stable(scene, steps)

        stable = largest_stable_part(is_stable) * tried
        if stable == 0.0:
            raise BadInput(f"law '{name_of(entry)}' has no stable step in this scene")
        self.laws.append(LawRuns(name_of(entry), entry, tried, stable, min(MARGIN * stable / step, 1.0)))
        self.did(SEARCH_RUNS)

    def find_times(self) -> None:
        """All laws in turn, and all over again: what else the machine does hits them alike."""
        for level in range(self.sweep.levels):
            measured = [law for law in self.laws if level < len(law.runs) and not law.runs[level].failure]
            seconds: dict[str, list[float]] = {law.name: [] for law in measured}
            for _ in range(self.repetitions):
                for law in measured:
                    scene, _, steps = self.level(law, level)
                    seconds[law.name].append(self.scenes.seconds(scene, steps))
                    self.did(self.weight(level))
            for law in measured:
                law.runs[level].seconds = statistics.median(seconds[law.name])


def largest_stable_part(is_stable: Callable[[float], bool]) -> float:
    """0 if not even a millionth is stable."""
    low = 1.0
    while not is_stable(low):
        low *= 0.5
        if low < LEAST_STEP:
            return 0.0
    high = 1.0 if low == 1.0 else 2.0 * low
    while high > ACCURACY * low:
        middle = math.sqrt(low * high)
        low, high = (middle, high) if is_stable(middle) else (low, middle)
    return low


def cost_of(runs: Sequence[MeasuredRun], norm: str, error: float) -> tuple[float, float]:
    """Steps and seconds of a law to come below an error and stay there with all smaller steps; nan: it never does.

    Between runs along straight lines in logarithms. Instants are relative to the end of the run.
    """
    errors = [run.errors[norm] / scale_of(norm, run.dt, run.steps) for run in runs]
    first = len(runs)
    while first > 0 and errors[first - 1] <= error:
        first -= 1
    if first == len(runs):
        return math.nan, math.nan
    below = runs[first]
    if first == 0:
        return float(below.steps), below.seconds
    above, upper, lower = runs[first - 1], errors[first - 1], errors[first]
    part = math.log(upper / error) / math.log(upper / lower) if math.isfinite(upper) and lower > 0.0 else 1.0

    def between(coarse: float, fine: float) -> float:
        return coarse * (fine / coarse) ** part

    return between(above.steps, below.steps), between(above.seconds, below.seconds)


# ---- results ----------------------------------------------------------------------------------------------------------


def needed(laws: Sequence[LawRuns], norm: str, error: float) -> Iterator[tuple[LawRuns, float, float, float, float]]:
    """Per law steps and seconds of an error, and both over those of the first law."""
    first = cost_of(laws[0].runs, norm, error)
    for law in laws:
        cost = cost_of(law.runs, norm, error)
        yield law, *cost, *(own / of_first if of_first else math.nan for own, of_first in zip(cost, first))


def write(study: Study, title: str, folder: Path) -> None:
    write_csv(folder / "study.csv", 6, ("law", "dt", "steps", "seconds", "penetration", *NORMS),
              ((law.name, run.dt, run.steps, run.seconds, run.penetration, *run.errors.values())
               for law in study.laws for run in law.runs))
    columns = ("law", "norm", "error", "steps", "seconds", "steps / first law's", "seconds / first law's")
    write_csv(folder / "study_needed.csv", 6, columns,
              ((law.name, norm, error, float(f"{steps:.0f}"), *others) for norm in NORMS for error in WANTED_ERRORS
               for law, steps, *others in needed(study.laws, norm, error)))
    laws = [{"name": law.name, "entry": law.entry, "largest_step_tried": law.tried, "largest_stable_step": law.stable,
             "failures": [{"dt": run.dt, "failure": run.failure} for run in law.runs if run.failure]}
            for law in study.laws]  # fmt: skip
    write_json(folder / "study.json", {"title": title, "reference": study.reference, "laws": laws})


def print_study(study: Study, title: str) -> None:
    print(f"{printable(title)}, against the {study.reference}")
    rows = [["law", "largest stable step", "steps", "seconds", "penetration", *NORMS]]
    for law in study.laws:
        first = [law.name, (">= " if law.stable == law.tried else "") + text_of(law.stable, ".3g")]
        for run in law.runs:
            rows.append([*first, str(run.steps), text_of(run.seconds, ".2g"), text_of(run.penetration, ".1e"),
                         *(text_of(error, ".2e") for error in run.errors.values()), *filter(None, [run.failure])])
            first = ["", ""]
    print_rows(rows)
    print("\nsteps for an error u_L2 (over the first law's steps, run time over the first law's)")
    table = [["law", *(f"{error:.0e}" for error in WANTED_ERRORS)], *([law.name] for law in study.laws)]
    for error in WANTED_ERRORS:
        for row, (_, steps, _, *over) in zip(table[1:], needed(study.laws, "u_L2", error)):
            ratios = f" ({text_of(over[0], '.2g')}, {text_of(over[1], '.2g')})" if math.isfinite(over[0]) else ""
            row.append(text_of(steps, ".0f") + ratios)
    print_rows(table)


def study_scene(file: Path, folder: Path, options: argparse.Namespace) -> int:
    with Scenes(file, options.threads) as scenes:
        with in_scene(file):
            study = Study(scenes, options)
        title = study.source.get("title", file.stem)
        interrupted = False
        with HeldFolder(folder, "study.json"):
            with in_scene(file), Progress("study", "runs", options.json_lines) as progress:
                try:
                    study.run(progress)
                except KeyboardInterrupt:
                    interrupted = True
            scenes.tell_warnings()
            if not study.laws:
                return complain("interrupted before any run", FAILED)
            remove_pictures(folder)
            write(study, title, folder)
    print_study(study, title)
    return complain("interrupted; the runs so far are written", FAILED) if interrupted else DONE


def study_all(options: argparse.Namespace) -> int:
    if len(options.scenes) == 1:
        return study_scene(options.scenes[0], options.out, options)
    stems = [scene.stem for scene in options.scenes]
    for stem in stems:
        if stems.count(stem) > 1:
            raise BadInput(f"found two scenes called '{stem}', expected a different name for each")
    with HeldFolder(options.out, "study.json"):
        codes = (study_scene(scene, options.out / scene.stem, options) for scene in options.scenes)
        return next((code for code in codes if code != DONE), DONE)


def main(arguments: Optional[Sequence[str]] = None) -> int:
    parser = sweep_parser("study")
    parser.add_argument("--law", action="append")
    parser.add_argument("--repetitions", type=int)
    options = parser.parse_args(arguments)
    return run_command(lambda: study_all(options))


if __name__ == "__main__":
    sys.exit(main())
