#!/usr/bin/env python3
"""The record of a law, from the built library: what it is, what the checker judged, its time per node, what to cite.

    docs/law_record.py LAW [--out FOLDER]    LAW: name or path; ILAW_BUILD: the build folder, otherwise build/release
    docs/law_record.py --replay FILE LAW     whether a law gives the impulses of a reference file, bit for bit

Writes FOLDER/LAW.md and FOLDER/LAW.reference.json. The second has, for a motion of some nodes, the inputs and the
impulses of each step in digits that give the same doubles back: a reimplementation can be tested against it.
"""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import argparse
import collections
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
BUILD = Path(os.environ.get("ILAW_BUILD", ROOT / "build/release"))
os.environ.setdefault("ILAW_LOADER", str(BUILD / "lib/libilaw_loader.so.1"))
os.environ.setdefault("ILAW_PATH", str(BUILD / "lib/ilaw"))
sys.path.insert(0, str(ROOT / "api/python"))
sys.dont_write_bytecode = True

import ilaw  # noqa: E402
from ilaw import protocols  # noqa: E402

NODES, STEPS, STEP = 12, 40, 2.0**-10


def told(*words: str) -> Any:
    found = subprocess.run([str(BUILD / "bin/ilaw"), *words, "--json"], capture_output=True, text=True, check=False)
    return json.loads(found.stdout)


def parameters_of(law: str) -> dict[str, Any]:
    """Those with which the tests of the contract begin; a law from elsewhere has its defaults."""
    cases = ROOT / f"tests/laws/{law}/cases.json"
    return json.loads(cases.read_text(encoding="utf-8"))["contract"][0]["parameters"] if cases.exists() else {}


class Motion:
    """Nodes that random forces and a weight move near the plane, in three dimensions, local axes, a scalar H, an area of 1."""

    def __init__(self, law: str, parameters: dict[str, Any]) -> None:
        self.v, self.free = np.zeros((NODES, 3)), np.zeros((NODES, 3))
        self.gap, self.delassus = np.zeros(NODES), np.zeros(NODES)
        self.batch = ilaw.Interface(law, velocity_step=STEP, frame="local", **parameters).batch(
            v_free=self.free, v_previous=self.v, delassus=self.delassus, gap=self.gap, area=1.0)  # fmt: skip

    def impulse(self, step: dict[str, Any]) -> list[list[float]]:
        self.v[:], self.free[:], self.gap[:] = step["v_previous"], step["v_free"], step["gap"]
        self.delassus[:] = step["delassus"]
        if step["time"] == STEP:
            self.batch.initialise()
        self.batch.evaluate(time=step["time"])
        return self.batch.impulse.tolist()


def reference(law: str, parameters: dict[str, Any]) -> dict[str, Any]:
    random = np.random.default_rng(1)
    motion, steps = Motion(law, parameters), []
    mass, v, gap = random.uniform(0.5, 2.0, NODES), random.uniform(-1, 1, (NODES, 3)), np.zeros(NODES)
    for k in range(STEPS):
        gap += STEP * v[:, 0]
        free = v + STEP * (random.uniform(-400, 400, (NODES, 3)) - [200.0, 0.0, 0.0]) / mass[:, None]
        step = {"time": (k + 1) * STEP, "v_previous": v.tolist(), "v_free": free.tolist(), "gap": gap.tolist(),
                "delassus": (1.0 / mass).tolist()}  # fmt: skip
        step["impulse"] = motion.impulse(step)
        v = free + np.array(step["impulse"]) / mass[:, None]
        steps.append(step)
    return {"law": law, "parameters": parameters, "velocity_step": STEP, "position_step": STEP, "area": 1.0,
            "axes": "normal, tangents; scalar H [1/kg]; gap [m] of the step; impulse [N.s]", "steps": steps,
            "protocols": proven(law)}  # fmt: skip


def differs_at(file: Path, law: str) -> int:
    """The first step at which a bit differs, or -1."""
    source = json.loads(file.read_text(encoding="utf-8"))
    motion = Motion(law, source["parameters"])
    return next((k for k, step in enumerate(source["steps"]) if motion.impulse(step) != step["impulse"]), -1)


def proven(law: str) -> dict[str, list[float]]:
    """The nine numbers of each protocol of a law: displacement, velocity, sum of impulses at the end."""
    return {p.name: protocols.Host(p).run().tolist() for p in protocols.PROTOCOLS.values() if p.law == law}


def protocol_rows(law: str) -> list[str]:
    rows = ["", "| protocol | closed form | found | because |", "| --- | --- | --- | --- |"]
    for name, numbers in proven(law).items():
        p = protocols.PROTOCOLS[name]
        for quantity, (value, tolerance) in p.exact.items():
            found = numbers[protocols.NAMES.index(quantity)]
            rows.append(f"| {name} | {quantity} = {value:.17g} to {tolerance:.2g} | {found:.17g} | {p.because} |")
    return rows if len(rows) > 3 else []


def stressed(law: str) -> str:
    """Counts of `ilaw stress` for random scenes of this law alone."""
    words = ["stress", "--law", law, "--scenes", "20", "--steps", "300"]
    found = subprocess.run([str(BUILD / "bin/ilaw"), *words], capture_output=True, text=True, check=False)
    names, counts = (line.split() for line in found.stdout.strip().splitlines()[-2:])
    return ", ".join(f"{count} {name}" for name, count in list(zip(names, counts))[1:5])


def page(law: str, parameters: dict[str, Any]) -> str:
    library = told("describe", law)
    card = library["laws"][0]
    judged = collections.Counter(rule["result"] for rule in told("check", law, "--seed", "1"))
    time = told("bench", law, "--nodes", "1000", "--parameters", json.dumps(parameters))[0]
    lines = [f"# {card['id']}: {card['title']}", "", card["doc"], "",
             f"- Version {library['version']}, by {library['vendor']}, licence {library['licence']}.",
             f"- Judged by `ilaw check`: {', '.join(f'{count} {result}' for result, count in sorted(judged.items()))}.",
             f"- `ilaw stress`, seed 1: {stressed(law)}.",
             f"- Time: {time['ns_per_node']:.3g} ns per node, with {json.dumps(parameters)}, of 1000 nodes.", "",
             "| parameter | unit | default | range | |", "| --- | --- | --- | --- | --- |"]  # fmt: skip
    for p in card["parameters"]:
        span = ", ".join(p["choices"]) or f"{p['minimum']} to {p['maximum']}"
        default = "required" if p["default"] is None else p["default"]
        lines.append(f"| `{p['name']}` | {p['unit']} | {default} | {span} | {p['doc']} |")
    return "\n".join([*lines, *protocol_rows(law), "", "To cite:", "", *(f"- {text}" for text in card["references"]), ""])


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("law", metavar="LAW")
    parser.add_argument("--out", type=Path, default=Path("."), metavar="FOLDER")
    parser.add_argument("--replay", type=Path, metavar="FILE")
    given = parser.parse_args()
    if given.replay:
        step = differs_at(given.replay, given.law)
        print("the same bits in every step" if step < 0 else f"other impulses, first in step {step}")
        return int(step >= 0)
    parameters = parameters_of(given.law)
    given.out.mkdir(parents=True, exist_ok=True)
    stem = Path(given.law).stem
    (given.out / f"{stem}.md").write_text(page(given.law, parameters), encoding="utf-8")
    (given.out / f"{stem}.reference.json").write_text(json.dumps(reference(given.law, parameters)), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
