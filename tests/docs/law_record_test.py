#!/usr/bin/env python3
"""The record of a law: its reference data are the law, by equations written a second time, and replay bit for bit."""
# SPDX-License-Identifier: BSD-3-Clause

import json
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "docs"))

import law_record  # noqa: E402


def coulomb(friction, step, before, free, gap, delassus):
    """Contact that keeps the next gap from being negative, and the cone: for one node and a scalar H."""
    opening = max(gap, 0.0)
    if opening + step * free[0] > 0.0:
        return np.zeros(3)
    excess = max(free[0] + opening / step, free[0] + before[0])
    normal = max(0.0, -excess / delassus)
    sticking = -free[1:] / delassus
    limit = friction * normal
    size = np.linalg.norm(sticking)
    return np.array([normal, *(sticking if size <= limit else limit / size * sticking)])


class LawRecord(unittest.TestCase):
    def test_reference_of_coulomb_is_coulombs_law(self):
        source = law_record.reference("coulomb", {"friction": 0.3})
        compared, turned = 0, 0
        for step in source["steps"]:
            for before, free, gap, delassus, found in zip(
                *(np.array(step[key]) for key in ("v_previous", "v_free", "gap", "delassus", "impulse"))
            ):
                expected = coulomb(0.3, source["velocity_step"], before, free, gap, delassus)
                if expected @ (before + free + delassus * expected) > 0.0:  # friction turns the motion round
                    turned += 1
                    self.assertLessEqual(found @ (before + free + delassus * found), 1e-12)
                    continue
                compared += bool(expected.any())
                np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-14)
        self.assertGreater(compared, 100)
        self.assertLess(turned, compared)

    def test_replays_its_own_law_and_finds_other_parameters(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "coulomb.json"
            source = law_record.reference("coulomb", {"friction": 0.3})
            file.write_text(json.dumps(source))
            self.assertEqual(law_record.differs_at(file, "coulomb"), -1)
            source["parameters"]["friction"] = 0.3 * (1.0 + 1e-12)
            file.write_text(json.dumps(source))
            self.assertGreaterEqual(law_record.differs_at(file, "coulomb"), 0)

    def test_page_has_findings_and_references(self):
        text = law_record.page("contact", {})
        self.assertIn("J.-J. Moreau, 1988", text)
        self.assertRegex(text, r"[0-9]+ not judged, [0-9]+ passed\.")
        self.assertRegex(text, r"`ilaw stress`, seed 1: .*20 scenes")
        self.assertIn("| drop | u.z = -0.0497", text)
        self.assertRegex(text, r"\| `restitution` \| 1 \| 0 \| 0 to 1 \|")


if __name__ == "__main__":
    unittest.main()
