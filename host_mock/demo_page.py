#!/usr/bin/env python3
"""Draws the results of the demo, runs some scenes with fields, and makes a page of their moving pictures and curves.

Usage: host_mock/demo_page.py FOLDER    The folder has the results of the demo and gets index.html.
"""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import contextlib
import html
import json
import multiprocessing
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "api/python"))
sys.dont_write_bytecode = True

from ilaw import plot, view  # noqa: E402

# Scene, steps per frame, and what there is to be seen.
MOVING = [
    ("tests/host/analyst_scenes/tread_blocks", 10,
     "Tread blocks of two tires pass the road: one rolls and grips, the other brakes, shears and skids."),
    ("tests/host/analyst_scenes/tape_peeled", 35,
     "An adhesive tape is peeled off at a right angle: its bond softens and tears from one end to the other."),
    ("host_mock/scenes/two_blocks", 1,
     "Two soft blocks, whose meshes do not match, fall on each other and on the floor, stick, slip and part."),
    ("tests/host/analyst_scenes/arch", 10,
     "Two arches of stones without mortar: one is thick enough and stands, the other is too thin and falls."),
    ("tests/host/analyst_scenes/stack", 4,
     "Three blocks fall on each other and come to rest as a stack, held by contact and friction alone."),
    ("tests/host/analyst_scenes/hail", 10,
     "Forty-five stones fall on a slope, bounce with their restitution, and slide until friction stops them."),
    ("host_mock/scenes/postit_3d", 20,
     "A Post-it is pressed on a plane, which makes it stick; then it is peeled and sheared off."),
]  # fmt: skip

STYLE = """
body { font: 16px/1.5 sans-serif; max-width: 1100px; margin: 2em auto; padding: 0 1em; color: #222 }
iframe { width: 100%; height: 640px; border: 1px solid #bbb } img { max-width: 100% }
ul { columns: 3 } summary { cursor: pointer; color: #0072b2 }
"""


def run_moving(path: str, every: int, folder: Path) -> Path:
    """A copy of the scene asks for frames, energies and events; it lies beside its results."""
    scene = ROOT / f"{path}.json"
    source: dict[str, Any] = json.loads(scene.read_text(encoding="utf-8"))
    source["output"] = {**source.get("output", {}), "fields": every, "balance": True, "events": True}
    for mesh in source["model"].get("meshes", []):
        mesh["file"] = str(scene.parent / mesh["file"])
    copy, results = folder / f"{scene.stem}.json", folder / scene.stem
    copy.write_text(json.dumps(source), encoding="utf-8")
    program = ROOT / "build/release/bin/ilaw"
    subprocess.run([program, "run", copy, "--out", results], check=True, stdout=subprocess.DEVNULL)
    view.write(results, results / "view.html", 5.0)
    return results


def draw(results: Path) -> str:
    """Name of the run, for the list; a run without a history has no picture."""
    with plot.plt.rc_context(plot.STYLE), open(os.devnull, "w", encoding="utf-8") as quiet:
        with contextlib.redirect_stdout(quiet):
            plot.draw_run(results, results, [])
    return results.name


def section(results: Path, sentence: str) -> str:
    title = html.escape(plot.Run(results).title)
    return f"""<h2>{title}</h2>
<p>{html.escape(sentence)}</p>
<iframe src="{results.name}/view.html" title="{title}" loading="lazy"></iframe>
<details><summary>Curves</summary>
<img src="{results.name}/history.svg" alt="Curves of: {title}" loading="lazy"></details>
"""


def main() -> int:
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = Path(sys.argv[1])
    moving = [(run_moving(path, every, folder), sentence) for path, every, sentence in MOVING]
    runs = sorted(file.parent for file in folder.glob("*/history.csv"))
    with multiprocessing.Pool() as pool:
        drawn = pool.map(draw, runs)
    others = [f'<li><a href="{name}/history.svg">{name.replace("_", " ")}</a></li>' for name in drawn]
    page = f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>ilaw: the demo</title><style>{STYLE}</style></head><body>
<h1>Interface laws in motion</h1>
<p>Play each picture by the space key or its button; turn it with the mouse. Curves are below it.</p>
{"".join(section(results, sentence) for results, sentence in moving)}<h2>Curves of all scenes</h2>
<ul>{"".join(others)}</ul></body></html>
"""
    (folder / "index.html").write_text(page, encoding="utf-8")
    print(f"To see them move: xdg-open {folder / 'index.html'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
