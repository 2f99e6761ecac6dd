#!/usr/bin/env python3
"""The whole scenes on docs/scenes.md run, and give the forces and distances that the page derives."""
# SPDX-License-Identifier: BSD-3-Clause

import csv
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

PAGE = Path(__file__).parents[2] / "docs/scenes.md"
THROWN, PRESSED = re.findall(r"```json\n(.*?)```", PAGE.read_text(), re.S)


def history_of(scene):
    with tempfile.TemporaryDirectory() as folder:
        file, results = Path(folder) / "scene.json", Path(folder) / "results"
        file.write_text(scene)
        done = subprocess.run([os.environ["ILAW_PROGRAM"], "run", file, "--out", results], capture_output=True,
                              text=True, check=True)
        with open(results / "history.csv") as rows:
            return done.stderr, [{key: float(row[key]) for key in row} for row in csv.DictReader(rows)]


class ScenesPage(unittest.TestCase):
    def test_thrown_mass_stops_where_friction_leaves_it(self):
        warnings, rows = history_of(THROWN)
        self.assertEqual(warnings, "")
        lands = next(row for row in rows if row["n0.u1"] <= -0.45 + 1e-9)
        self.assertAlmostEqual(lands["time"], 0.3, delta=2e-3)
        self.assertAlmostEqual(next(row for row in rows if row["time"] > 0.301)["n0.v0"], 3.1, delta=0.02)
        stands = next(row for row in rows if abs(row["n0.v0"]) <= 1e-12)
        self.assertAlmostEqual(stands["time"], 1.333, delta=5e-3)
        self.assertAlmostEqual(stands["n0.u0"], 2.80, delta=5e-3)
        self.assertEqual(rows[-1]["n0.v0"], 0)

    def test_pressed_pad_has_the_friction_of_its_pressure(self):
        warnings, rows = history_of(PRESSED)
        self.assertEqual(warnings, "")
        sliding = [row for row in rows if 0.01 < row["time"] < 0.025]
        for row in sliding:
            lifts = row["time"] > 0.018  # the trailing edge, now and then
            self.assertAlmostEqual(row["joint.F2"], 40, delta=3 if lifts else 0.5)
            self.assertAlmostEqual(row["joint.F0"], -12, delta=1.2 if lifts else 0.15)
        self.assertAlmostEqual(sum(row["joint.F2"] for row in sliding) / len(sliding), 40, delta=0.02)


if __name__ == "__main__":
    unittest.main()
