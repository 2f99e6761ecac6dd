#!/usr/bin/env python3
"""docs/reference/outputs.md names every column and key that a run writes."""
# SPDX-License-Identifier: BSD-3-Clause

import csv
import json
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

PAGE = (Path(__file__).resolve().parents[2] / "docs/reference/outputs.md").read_text()
SCENE = {
    "model": {"type": "points", "dimension": 2, "points": [{"mass": 1, "position": [0, 0.01], "velocity": [1, 0]}]},
    "prestress": {},
    "time": {"dt": 1e-3, "end": 0.2},
    "loads": [{"type": "gravity", "acceleration": [0, -10]}],
    "interfaces": [{"name": "floor", "law": "coulomb", "parameters": {"friction": 0.3}, "nodes": "all",
                    "obstacle": {"type": "plane", "point": [0, 0], "normal": [0, 1]}}],
    "output": {"watch": [0], "balance": True, "events": True, "forces": [{"of": "floor", "about": [0, 0]}]},
}


def named(word):
    return re.search(rf"`{re.escape(word)}`", PAGE) is not None


class Outputs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        file, results = Path(cls.folder.name) / "scene.json", Path(cls.folder.name) / "results"
        file.write_text(json.dumps(SCENE))
        subprocess.run([os.environ["ILAW_PROGRAM"], "run", file, "--out", results], check=True, capture_output=True)
        cls.results = results

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def header(self, name):
        with open(self.results / name) as file:
            return next(csv.reader(file))

    def test_cites_what_its_laws_refer_to(self):
        described = subprocess.run([os.environ["ILAW_PROGRAM"], "describe", "coulomb", "--json"], check=True,
                                   capture_output=True, text=True)  # fmt: skip
        summary = json.loads((self.results / "summary.json").read_text())
        self.assertEqual(summary["citations"], {"coulomb": json.loads(described.stdout)["laws"][0]["references"]})

    def test_names_every_file(self):
        for file in self.results.iterdir():
            with self.subTest(file=file.name):
                self.assertTrue(named(file.name))

    def test_names_every_column(self):
        columns = self.header("history.csv")
        self.assertGreater(len(columns), 15)
        for column in columns:
            name = re.sub(r"^n0\.", "n<i>.", column)
            name = re.sub(r"^floor\.", "<name>.", name)
            name = re.sub(r"(\.[uvrFM]|angular_momentum)[0-9]*$", r"\1*", name)
            with self.subTest(column=column):
                self.assertTrue(named(name), f"outputs.md does not name `{name}`")
        for column in self.header("events.csv"):
            with self.subTest(column=column):
                self.assertTrue(named(re.sub(r"^r[0-9]$", "r*", column)))

    def test_names_every_key_of_the_summary(self):
        summary = json.loads((self.results / "summary.json").read_text())
        own = {"source", "floor", "coulomb", "major", "minor"}  # the scene's, and names of the test
        of_parts = {"program", "scene", "status_counts", "energy"}  # said in words
        for key, value in summary.items():
            with self.subTest(key=key):
                self.assertTrue(named(key), f"outputs.md does not name `{key}`")
            parts = value if isinstance(value, list) else [value]
            for part in parts:
                if isinstance(part, dict) and key not in of_parts:
                    for inner in set(part) - own:
                        with self.subTest(key=key, inner=inner):
                            self.assertTrue(named(inner), f"outputs.md does not name `{inner}` of `{key}`")


if __name__ == "__main__":
    unittest.main()
