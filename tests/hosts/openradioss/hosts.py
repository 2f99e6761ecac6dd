"""Both hosts of api/openradioss: the hook of a deck, in the cycle of engine.py, and the user library, which stub.py
loads and calls as starter and engine do."""
import os
import subprocess
import sys
import typing
from pathlib import Path

import numpy as np
import pytest

from ilaw_openradioss import Refused, Run

MASS, GRAVITY = 2.0, 10.0
FLOOR = ([0, 0, 0], [0, 0, 1])
programs = pytest.mark.skipif("ILAW_RADIOSS_STUB" not in os.environ, reason="no user library is built here")


class Node(typing.NamedTuple):
    user: int
    x: tuple
    v: tuple = (0, 0, 0)
    force: tuple = (0, 0, -MASS * GRAVITY)
    kinematic: int = 0
    mass: float = MASS


class Hook:
    """sync of a deck, with a run of its own."""

    def __init__(self, folder, contacts, **options):
        self.contacts, self.options, self.run = contacts, dict(folder=folder, **options), None

    def __call__(self, context, time, step):
        if self.run is None:
            self.run = Run(context, time, step, self.contacts, **self.options)
        else:
            self.run.step(time, step)


def traced(engine, hook, steps):
    """Time, X and V after each cycle."""
    rows = [(t, engine.arrays["X"].copy(), engine.arrays["V"].copy()) for t in engine.run(hook, steps)]
    return [np.array(column) for column in zip(*rows)]


def call(folder, *words):
    given = os.environ["ILAW_RADIOSS_STUB"], os.environ["ILAW_RADIOSS_LIBRARY"]
    command = [sys.executable, str(Path(__file__).with_name("stub.py")), *given, *map(str, words)]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True)


def start(folder, lines, nodes):
    folder.mkdir(exist_ok=True)
    (folder / "window.txt").write_text("\n".join(lines) + "\n")
    rows = [(n.user, n.kinematic, n.mass, *n.x, *n.v, *n.force) for n in nodes]
    (folder / "model.txt").write_text("".join(" ".join(map(str, row)) + "\n" for row in rows))
    return call(folder, "start")


def run(folder, cycles, h, *more):
    """Time, work that the window booked before the cycle, X and V after each of the cycles."""
    done = call(folder, "run", cycles, h, *more)
    if done.returncode:
        raise Refused(done.stderr)
    table = np.array([[float(word) for word in line.split()] for line in done.stdout.splitlines()])
    count = (table.shape[1] - 2) // 6
    x, v = (part.reshape(cycles, count, 3) for part in np.split(table[:, 2:], 2, axis=1))
    return table[:, 0], table[:, 1], x, v
