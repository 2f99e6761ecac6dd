#!/usr/bin/env python3
"""The table of docs/initial_gaps.md: a mass of 1 that starts with an overlap or a gap of 0.01, for each law."""
# SPDX-License-Identifier: BSD-3-Clause

import csv
import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

START, STEP, END, STIFFNESS = 0.01, 1e-3, 0.5, 1e4
ROUNDING = 1e-4  # of a gap: what the mass may move within a step or two
CONTACT = [("contact", {}), ("contact", {"activation": "moreau"}), ("coulomb", {"friction": 0.3}), ("postit", {})]
BONDS = [("tie", {}), ("cohesive", {"strength": 100, "toughness": 1}),
         ("postit", {"initial_adhesion": 5, "adhesion_limit": 5})]
IMPLICIT = ("penalty", {"stiffness": STIFFNESS, "integration": "implicit"})
EXPLICIT = ("penalty", {"stiffness": STIFFNESS})


class Run:
    """Gaps and energies of a mass that begins at a place, under an acceleration."""

    def __init__(self, law, place, acceleration, path=None, **interface):
        plane = {"type": "plane", "point": [0], "normal": [1], **({"path": path} if path else {})}
        scene = {
            "model": {"type": "points", "dimension": 1, "points": [{"mass": 1, "position": [place]}]},
            "time": {"dt": STEP, "end": END},
            "loads": [{"type": "gravity", "acceleration": [acceleration]}],
            "interfaces": [{"law": law[0], "parameters": law[1], "nodes": "all", "obstacle": plane, **interface}],
            "output": {"watch": [0], "balance": True},
        }
        with tempfile.TemporaryDirectory() as folder:
            file, results = Path(folder) / "scene.json", Path(folder) / "results"
            file.write_text(json.dumps(scene))
            done = subprocess.run([os.environ["ILAW_PROGRAM"], "run", file, "--out", results], capture_output=True,
                                  text=True, check=True)
            with open(results / "history.csv") as rows:
                self.rows = list(csv.DictReader(rows))
        self.warnings = done.stderr
        self.gaps = [float(row["n0.gap"]) for row in self.rows]
        self.kinetic = [float(row["balance.kinetic"]) for row in self.rows]


class InitialGaps(unittest.TestCase):
    def assert_stays(self, run, place):
        self.assertAlmostEqual(min(run.gaps), place, delta=ROUNDING)
        self.assertAlmostEqual(max(run.gaps), place, delta=ROUNDING)

    def test_contact_keeps_an_overlap_and_lets_go(self):
        for law in CONTACT + [IMPLICIT]:
            with self.subTest(law=law):
                rest = Run(law, -START, 0)
                self.assert_stays(rest, -START)
                self.assertIn("start inside", rest.warnings)
                self.assertEqual(max(rest.kinetic), 0)
                pulled = Run(law, -START, 1)
                self.assertAlmostEqual(pulled.gaps[-1], 0.5 * END**2 - START, delta=1e-3)
        for law in CONTACT:
            with self.subTest(law=law):
                self.assert_stays(Run(law, -START, -10), -START)

    def test_bonds_hold_the_distance(self):
        for law in BONDS:
            for place in (-START, START):
                for acceleration in (-10, 0, 1):
                    with self.subTest(law=law, place=place, acceleration=acceleration):
                        self.assert_stays(Run(law, place, acceleration), place)

    def test_gaps_close_under_pressure_and_open_in_pull(self):
        for law in CONTACT + [IMPLICIT, EXPLICIT]:
            with self.subTest(law=law):
                pressed = Run(law, START, -10)
                self.assertLess(min(pressed.gaps), 1e-6)
                deepest = 2 * 10 / STIFFNESS + (2 * START * 10 / STIFFNESS) ** 0.5 if law[0] == "penalty" else 5e-4
                self.assertGreater(min(pressed.gaps), -deepest)
                self.assertGreater(Run(law, START, 1).gaps[-1], 0.12)

    def test_explicit_penalty_releases_the_energy_of_an_overlap(self):
        run = Run(EXPLICIT, -START, 0)
        self.assertAlmostEqual(run.kinetic[-1], 0.5 * STIFFNESS * START**2, delta=0.01)

    def test_offset_makes_an_overlap_a_touch(self):
        run = Run(("contact", {}), -START, -10, gap_offset=-START)
        self.assert_stays(run, 0)
        self.assertNotIn("start inside", run.warnings)

    def test_path_of_the_obstacle_pushes_out(self):
        run = Run(("contact", {}), -START, -10, path=[[0, -START], [0.1, 0]])
        self.assertAlmostEqual(run.gaps[-1], 0, delta=ROUNDING)
        self.assertLess(max(run.kinetic), 0.02)


if __name__ == "__main__":
    unittest.main()
