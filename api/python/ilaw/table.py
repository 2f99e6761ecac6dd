"""`ilaw table`: several runs side by side, in numbers: what differs between their scenes, and what came of it."""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import argparse
import json
import os
import sys
from pathlib import Path
from typing import Any, Optional, Sequence

import numpy as np

from ._command import DONE, BadInput, meant, print_rows, run_command
from ._results import Run, UnreadableRun

# Parts of a summary whose numbers a column can name, as results/quantities.cpp has them.
PARTS = ("steps", "dt", "time", "failure", "interrupted", "penetration_max", "stable_step", "energy", "status_counts",
         "forces", "coupling", "heat", "prestress", "seconds")  # fmt: skip
KINDS = {"last": lambda column: column[-1], "min": np.min, "max": np.max, "mean": np.mean}


def flat(value: Any, pointer: str = "") -> dict[str, Any]:
    """Numbers and words by JSON pointer."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else None
    if items is None:
        return {pointer: value}
    return {key: leaf for name, part in items for key, leaf in flat(part, f"{pointer}/{name}").items()}


def differences(scenes: Sequence[dict[str, Any]]) -> list[str]:
    """JSON pointers of the numbers and words that are not the same in all scenes."""
    leaves = [flat({key: part for key, part in scene.items() if key not in ("title", "doc")}) for scene in scenes]
    pointers = dict.fromkeys(sorted(pointer for own in leaves for pointer in own))
    return [p for p in pointers if len({json.dumps(own[p]) if p in own else None for own in leaves}) > 1]


def numbers_of(summary: dict[str, Any]) -> dict[str, Any]:
    numbers = flat({part: summary[part] for part in PARTS if part in summary})
    for interface in summary["interfaces"]:
        numbers |= flat({interface["name"]: {part: interface[part] for part in ("first_contact", "amounts")}})
    numbers["/warnings"] = len(summary.get("warnings", []))
    return dict(sorted((pointer[1:].replace("/", "."), value) for pointer, value in numbers.items()))


def text_of(value: Any) -> str:
    text = value if isinstance(value, str) else "" if value is None else json.dumps(value)
    return text.replace(",", ";").replace("\n", ";")


def cell_of(run: Run, numbers: dict[str, Any], column: str) -> Optional[str]:
    """None if the run has no such column."""
    if column in numbers:
        return text_of(numbers[column])
    name, colon, kind = column.rpartition(":")
    name, kind = (name, kind) if colon else (column, "last")
    if kind not in KINDS:
        raise BadInput(f"{column}: found '{kind}', expected one of {', '.join(KINDS)}")
    names, rows = run.history(lambda found: found == name)
    values = rows[np.isfinite(rows[:, 0]), 0] if names else []
    return None if not names else text_of(float(KINDS[kind](values))) if len(values) else ""


def table_of(runs: Sequence[Run], columns: Sequence[str]) -> list[list[str]]:
    """A row per run: its name, what differs, then the columns; without columns all numbers of the summaries."""
    pointers, numbers = differences([run.scene for run in runs]), [numbers_of(run.summary) for run in runs]
    known = list(dict.fromkeys(name for own in numbers for name in own))
    rows = [["run", *pointers, *(columns or known)]]
    for run in runs:
        scene = flat(run.scene)
        rows.append([run.folder.resolve().name, *(text_of(scene.get(pointer, "-")) for pointer in pointers)])
    for column in columns or known:
        if not columns:
            cells = [text_of(own.get(column)) for own in numbers]
        else:
            cells = [cell_of(run, own, column) for run, own in zip(runs, numbers)]
        if all(cell is None for cell in cells):
            names = runs[0].history(lambda name: True)[0]
            found = f"{column}: found in no run, expected a number of summary.json, one of {', '.join(known)}"
            found += f"; or a column of history.csv, one of {', '.join(names)}"
            raise BadInput(found + meant(column.rpartition(":")[0] or column, [*known, *names]))
        for row, cell in zip(rows[1:], cells):
            row.append(cell or "")
    return rows


def open_runs(folders: Sequence[Path]) -> list[Run]:
    """Files among several folders, as a sweep and its pictures leave beside its runs, are passed over."""
    try:
        runs = [Run(folder) for folder in folders if len(folders) == 1 or not folder.is_file()]
    except UnreadableRun as reason:
        raise BadInput(str(reason)) from None
    if not runs:
        raise BadInput("found files alone, expected folders that `ilaw run` wrote")
    return runs


def main(arguments: Optional[Sequence[str]] = None) -> int:
    parser = argparse.ArgumentParser(prog="ilaw table")
    parser.add_argument("folders", type=Path, nargs="+")
    parser.add_argument("--columns", type=lambda text: text.split(","), default=[])
    parser.add_argument("--csv", action="store_true")
    options = parser.parse_args(arguments)

    def table() -> int:
        rows = table_of(open_runs(options.folders), options.columns)
        if options.csv:
            print(*(",".join(row) for row in rows), sep=os.linesep)
        else:  # many columns are read more easily below each other
            print_rows(rows if options.columns else list(zip(*rows)))
        return DONE

    return run_command(table)


if __name__ == "__main__":
    sys.exit(main())
