"""Scenes as dicts: `run(scene)` gives the results as arrays, and a notebook shows them in motion."""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import functools
import html
import json
import os
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any, Optional

import numpy as np

from ._results import Run


class RunFailed(RuntimeError):
    """The program refused the scene, or the run failed; the message is the program's."""


class Results:
    """A folder that `ilaw run` wrote. As the last value of a notebook's cell it is shown as a page that moves."""

    def __init__(self, folder: Path) -> None:
        self.folder = Path(folder)
        self.summary: dict[str, Any] = Run(self.folder).summary

    @functools.cached_property
    def history(self) -> dict[str, np.ndarray]:
        """The columns of history.csv by name."""
        names, rows = Run(self.folder).history()
        return dict(zip(names, rows.T))

    def page(self, megabytes: float = 10.0) -> str:
        """The page of `ilaw view`, which needs VTK and three.js."""
        from .view import page_of

        return page_of(Run(self.folder), megabytes)

    def _repr_html_(self) -> str:
        return f'<iframe srcdoc="{html.escape(self.page())}" style="width: 100%; height: 600px; border: 0"></iframe>'


def program() -> str:
    """The program ilaw: of ILAW_PROGRAM, of the folder where this package is installed, or of the path."""
    beside = Path(__file__).absolute().parents[4] / "bin/ilaw"
    found = os.environ.get("ILAW_PROGRAM") or (str(beside) if beside.is_file() else shutil.which("ilaw"))
    if not found:
        raise RunFailed("found no program ilaw, expected it on the path or in ILAW_PROGRAM")
    return found


def run(scene: dict[str, Any], folder: Optional[Path] = None, *options: str) -> Results:
    """Runs a scene into a folder, or a temporary one, with further options of `ilaw run`."""
    folder = Path(folder or tempfile.mkdtemp(prefix="ilaw_"))
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / "scene.json"
    file.write_text(json.dumps(scene), encoding="utf-8")
    done = subprocess.run([program(), "run", file, "--out", folder, *options], capture_output=True, text=True)
    if done.returncode != 0:
        raise RunFailed(done.stderr.strip())
    print(done.stderr + done.stdout, end="")
    return Results(folder)
