"""`python3 -m ilaw.view DIR`, and `ilaw view DIR`: a run as one page that moves, for any browser, without network."""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import argparse
import html
import json
import math
import os
import re
import sys
from pathlib import Path
from typing import Any, Optional, Sequence

import numpy as np

from ._curves import Curve, thinned, visible
from ._curves import curves_of as columns_of
from ._film import Blocks, film_of_fields
from ._results import STATUS_NAMES, Run, UnreadableRun
from ._no_fields import film_of_boxes, film_of_points

THREE = Path(os.environ.get("ILAW_THREE", "/usr/share/javascript/three"))
MOST_ROWS, MOST_CURVES, MOST_EVENTS = 4000, 8, 2000


def panels_of(run: Run, names: list[str]) -> dict[str, list[Curve]]:
    """Curves beside the bodies: energies, forces, then the motion and the interface of watched nodes."""
    found: dict[str, list[Curve]] = {"energy": [], "force": []}
    for curve in columns_of(run, names):
        if not re.search("status|mean velocity|error|angular momentum|moment", curve.quantity):
            found.setdefault(curve.quantity, []).append(curve)
    return found


def curves_of(run: Run, blocks: Blocks, names: list[str], rows: np.ndarray) -> list[dict[str, Any]]:
    rows = thinned(rows, MOST_ROWS)
    if not len(rows):
        return []
    time, shown = blocks.add(rows[:, 0], "<f8"), []
    for quantity, of_panel in panels_of(run, names).items():
        curves = [c for c in visible(of_panel, rows)[0] if np.isfinite(rows[:, c.index]).all()]
        kept = set(sorted(curves, key=lambda c: -float(np.ptp(rows[:, c.index])))[:MOST_CURVES])
        if curves:
            drawn = [{"name": c.label, "values": blocks.add(rows[:, c.index], "<f4")} for c in curves if c in kept]
            title = "impulse of a step" if quantity == "impulse" else quantity
            shown.append({"title": title, "unit": run.unit_of(curves[0].dimension), "time": time,
                          "leftOut": len(curves) - len(kept), "curves": drawn})  # fmt: skip
    return shown


def events_of(run: Run, notes: list[str]) -> list[dict[str, Any]]:
    events = run.events()
    if events or (run.folder / "events.csv").is_file():
        if len(events) > MOST_EVENTS:
            notes.append(f"{MOST_EVENTS} of {len(events)} events are listed: those of most nodes.")
            most = sorted(range(len(events)), key=lambda k: -events[k]["count"])[:MOST_EVENTS]
            events = [events[k] for k in sorted(most)]
        return events
    notes.append('For all events, add "events": true to "output" of the scene.')
    touched = [i for i in run.summary["interfaces"] if i.get("first_contact") is not None]
    return [
        {"time": i["first_contact"], "interface": i["name"], "event": "first contact", "count": 0, "nodes": []}
        for i in sorted(touched, key=lambda i: i["first_contact"])
    ]


def film_of(
    run: Run, blocks: Blocks, megabytes: float, history: tuple[list[str], np.ndarray], notes: list[str]
) -> tuple[Optional[dict[str, Any]], list[float]]:
    if run.field_files():
        return film_of_fields(run, blocks, megabytes, notes)
    every = max(1, round(run.summary["steps"] / 100))
    advice = f'add "fields": {every} to "output" of the scene (100 frames)'
    film, times = film_of_points(run, blocks, *history)
    if film:
        if film["nodes"] < run.summary["nodes"]:
            watched = f"{film['nodes']} of {run.summary['nodes']} points are watched and shown"
            notes.insert(0, f"{watched}; for all, {advice}.")
        return film, times
    film, times = film_of_boxes(run, blocks)
    still = "The bodies are shown at rest, as the scene has them, because" if film else "No bodies are shown because"
    notes.insert(0, f"{still} the run wrote no fields: for their motion, {advice}.")
    rows = history[1]
    return film, rows[:: max(1, len(rows) // 200), 0].tolist() if len(rows) else times


def data_of(run: Run, megabytes: float) -> tuple[dict[str, Any], Blocks]:
    blocks, notes = Blocks(), []
    history = run.history()
    film, times = film_of(run, blocks, megabytes, history, notes)
    if run.summary.get("failure"):
        notes.insert(0, f"The run failed: {run.summary['failure']}")
    if not any(name.startswith("balance.") for name in history[0]):
        notes.append('For energies, add "balance": true to "output" of the scene.')
    if not run.scene.get("output", {}).get("forces") and run.interfaces:
        named = json.dumps([i["name"] for i in run.interfaces])
        notes.append(f'For curves of forces, add "forces": {named} to "output" of the scene.')
    return {
        "title": run.title,
        "dimension": run.dimension,
        "timeUnit": run.unit_of("time"),
        "lengthUnit": run.unit_of("length"),
        "times": times,
        "film": film,
        "statusNames": STATUS_NAMES,
        "obstacles": run.obstacles(np.array(times)),
        "interfaces": [{"name": i["name"], "law": i["law"]} for i in run.interfaces],
        "curves": curves_of(run, blocks, *history),
        "events": events_of(run, notes),
        "notes": notes,
        "steps": run.summary["steps"],
        "dt": run.summary["dt"],
        "end": run.summary["time"],
    }, blocks


def page_of(run: Run, megabytes: float) -> str:
    data, blocks = data_of(run, megabytes)
    here = Path(__file__).parent
    library = [read_library(THREE / name) for name in ("three.min.js", "examples/js/controls/OrbitControls.js")]
    scripts = [f"<script>{text}</script>" for text in library]
    scripts += [f'<script type="text/plain" id="block{k}">{text}</script>' for k, text in enumerate(blocks.texts)]
    # "<" of a name must not end or begin a script.
    header = json.dumps(finite(data), separators=(",", ":")).replace("<", "\\u003c")
    scripts.append(f'<script type="application/json" id="run">{header}</script>')
    scripts.append(f"<script>{(here / 'view.js').read_text(encoding='utf-8')}</script>")
    start, end = (here / "view.html").read_text(encoding="utf-8").split("@SCRIPTS@")
    return start.replace("@TITLE@", html.escape(run.title)) + "\n".join(scripts) + end


def finite(value: Any) -> Any:
    """JSON has no NaN: null instead."""
    if isinstance(value, dict):
        return {key: finite(part) for key, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(part) for part in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def read_library(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8").replace("</script", "<\\/script")
    except OSError:
        advice = "install it with `apt-get install libjs-three`, or name its folder in ILAW_THREE"
        raise MissingPackage(f"{file}: found no three.js; {advice}") from None


class MissingPackage(Exception):
    """Something that is installed apart from this package."""


def write(folder: Path, output: Path, megabytes: float = 50.0) -> None:
    """Writes the page of a run; a page under its final name is complete."""
    text = page_of(Run(folder), megabytes)
    partial = output.with_name(output.name + ".partial")
    partial.write_text(text, encoding="utf-8")
    partial.replace(output)


def main(arguments: Optional[Sequence[str]] = None) -> int:
    parser = argparse.ArgumentParser(
        prog="ilaw view",
        description="Write a run as one HTML file: bodies in motion, fields, forces, curves, events.",
        epilog="Example: ilaw view results -o run.html",
    )
    parser.add_argument("folder", type=Path, help="folder that `ilaw run` wrote")
    parser.add_argument("-o", "--out", type=Path, help="the file (default: view.html in the folder)")
    most = "about the most that the data take (default: %(default)g)"
    parser.add_argument("--megabytes", type=float, default=50.0, help=most)
    options = parser.parse_args(arguments)
    output = options.out or options.folder / "view.html"
    try:
        write(options.folder, output, options.megabytes)
    except UnreadableRun as reason:
        return complain(str(reason), 2)
    except MissingPackage as reason:
        return complain(str(reason), 1)
    except ModuleNotFoundError as reason:
        return complain(f"Python's package {reason.name} is missing; install it with `apt-get install python3-vtk9`", 1)
    except OSError as reason:
        return complain(f"{output}: {reason.strerror}", 1)
    print(output)
    return 0


def complain(text: str, code: int) -> int:
    print(f"ilaw: {text}", file=sys.stderr)
    return code


if __name__ == "__main__":
    sys.exit(main())
