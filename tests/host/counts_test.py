# Costs that do not depend on the clock: what summary.json counts grows with the number of elements, not faster.
# Two strips of n elements, one on the other; no time of a loaded machine is measured.
import json
import math
import os
import pathlib
import subprocess
import tempfile
import unittest

EDGE, STEPS, CFL = 0.01, 40, 0.5
MOST_GROWTH = 1.15  # exponent of n, from one doubling to the next
SPEED = math.sqrt(1e6 / 1e3)  # of a wave, without the factor of the lateral strain


def strips(n, apart, slip):
    """The upper strip has elements of another length, so that nodes meet facets within, and contacts share nodes."""
    material = {"type": "linear", "young": 1e6, "poisson": 0.0, "density": 1e3}
    wide = {"size": [n * EDGE, 2 * EDGE, 2 * EDGE], "elements": [n, 2, 2], "name": "lower", "material": material}
    upper = {"size": [0.9 * n * EDGE, EDGE, 2 * EDGE], "elements": [n, 1, 2], "name": "upper", "material": material,
             "corner": [0.03 * n * EDGE, 0.4 * EDGE, 2 * EDGE + apart], "velocity": [slip, 0.0, 0.0]}
    dt = CFL * 0.5 * EDGE / SPEED
    return {"model": {"type": "blocks", "blocks": [wide, upper]}, "time": {"dt": dt, "end": STEPS * dt},
            "loads": [{"type": "gravity", "acceleration": [0.0, 0.0, -10.0]}],
            "interfaces": [
                {"name": "floor", "law": "contact", "nodes": "lower.z_min",
                 "obstacle": {"type": "plane", "point": [0.0, 0.0, 0.0], "normal": [0.0, 0.0, 1.0]}},
                {"name": "between", "law": "coulomb", "parameters": {"friction": 0.3}, "nodes": "upper.z_min",
                 "against": {"surface": "lower.z_max", "discretization": "node_to_facet"}}]}


def counts_of(scene):
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "scene.json"
        file.write_text(json.dumps(scene))
        done = subprocess.run([os.environ["ILAW_PROGRAM"], "run", file, "--out", folder], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        summary = json.loads((pathlib.Path(folder) / "summary.json").read_text())
    stored = summary["execution"]["nodes_stored"]
    active = summary["execution"]["node_steps"]["active"]
    return {"active": active, "iterations": summary["coupling"]["sweeps"],
            "evaluations": active * max(summary["coupling"]["sweeps"], STEPS) / STEPS,
            "bytes": sum(count * interface["bytes_per_node"] for count, interface in zip(stored, summary["interfaces"])),
            "between": stored[1]}


class Counts(unittest.TestCase):
    def growth(self, apart, slip):
        """The counts of the largest strip, after the test of how they grew."""
        counts = [counts_of(strips(n, apart, slip)) for n in (20, 40, 80)]
        for smaller, larger in zip(counts, counts[1:]):
            for name in smaller:
                with self.subTest(name=name, smaller=smaller, larger=larger):
                    self.assertLessEqual(larger[name], smaller[name] * 2**MOST_GROWTH)
        return counts[-1]

    def test_of_strips_at_rest_grow_linearly(self):
        self.assertGreater(self.growth(0.0, 0.0)["between"], 100)

    def test_of_strips_that_slide_grow_linearly(self):
        self.assertGreater(self.growth(0.0, 1.0)["iterations"], STEPS)

    def test_of_strips_apart_are_zero_between_them(self):
        self.assertEqual(self.growth(0.5, 0.0)["between"], 0)


if __name__ == "__main__":
    unittest.main()
