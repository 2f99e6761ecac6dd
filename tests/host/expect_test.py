# A scene that expects a value is held to it. state_hash_test runs the shipped scenes, so here are the other ones.
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

HERE = pathlib.Path(__file__).parent
SOURCE = HERE.parents[1]
BLOCK = json.loads((SOURCE / "plugins/coulomb/sliding_block.json").read_text())


def run(scene, *options):
    """The program's end, and the summary where there is one."""
    with tempfile.TemporaryDirectory() as folder:
        file = scene
        if isinstance(scene, dict):
            file = pathlib.Path(folder) / "scene.json"
            file.write_text(json.dumps(scene))
        out = pathlib.Path(folder) / "out"
        done = subprocess.run([os.environ["ILAW_PROGRAM"], "run", file, "--out", out, *options],
                              capture_output=True, text=True)
        summary = out / "summary.json"
        return done, json.loads(summary.read_text()) if summary.is_file() else None


def expecting(what, value=0.5, tolerance=1e-3):
    return {**BLOCK, "expect": [{"what": what, "value": value, "tolerance": tolerance, "because": "v^2/(2 mu g)"}]}


class Expect(unittest.TestCase):
    def test_holds_in_every_scene_of_the_tests(self):
        scenes = [file for folder in ("analyst_scenes", "expect_scenes") for file in sorted((HERE / folder).glob("*.json"))
                  if "expect" in json.loads(file.read_text())]
        self.assertGreater(len(scenes), 2)
        for scene in scenes:
            with self.subTest(scene=scene.stem):
                done, _ = run(scene)
                self.assertEqual(done.returncode, 0, done.stderr)

    def test_is_printed_and_stored_when_met(self):
        done, summary = run(expecting("n0.u0"))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("n0.u0: expected 0.5 to 0.001, found 0.5", done.stdout)
        judged = summary["expectations"][0]
        self.assertTrue(judged["within"])
        self.assertAlmostEqual(judged["found"], 0.5, delta=1e-3)

    def test_ends_with_its_own_code_and_reason_when_missed(self):
        done, summary = run(expecting("energy.dissipated_friction", 3.9))
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn("missed: energy.dissipated_friction: expected 3.9 to 0.001, found 4; v^2/(2 mu g)", done.stderr)
        self.assertFalse(summary["expectations"][0]["within"])

    def test_may_be_of_what_only_the_start_gives(self):
        scene = json.loads((SOURCE / "host_mock/scenes/prestressed_seal.json").read_text())
        expected = {"what": "prestress.residual", "value": 0, "tolerance": 1e-6, "because": "it is at rest"}
        done, _ = run({**scene, "expect": [expected]})
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_refuses_a_quantity_that_the_run_has_not(self):
        for what, words in [("n1.u0", ["/expect/0/what: found 'n1.u0'", "energy.internal", "n0.u0"]),
                            ("failure", ["/expect/0/what: found 'failure'"]),
                            ("floor.amounts", ["/expect/0/what: found 'floor.amounts'"]),
                            ("n0.u0:first", ["expected one of last, min, max, mean"])]:
            with self.subTest(what=what):
                done, summary = run(expecting(what))
                self.assertEqual((done.returncode, summary), (2, None), done.stderr)
                for word in words:
                    self.assertIn(word, done.stderr)

    def test_leaves_earlier_results_when_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            for name, scene in (("good", BLOCK), ("bad", expecting("n1.u0"))):
                (folder / f"{name}.json").write_text(json.dumps(scene))
            command = [os.environ["ILAW_PROGRAM"], "run", "--out", folder / "out"]
            subprocess.run([*command, folder / "good.json"], check=True, capture_output=True)
            before = {file.name: file.read_bytes() for file in (folder / "out").iterdir()}
            self.assertIn("summary.json", before)
            self.assertEqual(subprocess.run([*command, folder / "bad.json"], capture_output=True).returncode, 2)
            self.assertEqual({file.name: file.read_bytes() for file in (folder / "out").iterdir()}, before)

    def test_names_what_the_summary_has_of_interfaces(self):
        done, summary = run(expecting("floor.first_contact", 0.0))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(summary["expectations"][0]["within"])

    def test_is_not_asked_of_a_sweep(self):
        done, _ = run(expecting("n0.u0"), "--set", "/interfaces/0/parameters/friction=0.2,0.4")
        self.assertEqual(done.returncode, 0, done.stderr)


if __name__ == "__main__":
    unittest.main()
