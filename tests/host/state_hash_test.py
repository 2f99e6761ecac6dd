# Every shipped scene ends in the state of state_hashes.csv, whatever the threads and the level of the laws, and whether
# its steps are audited. It closes its energy balance, its interfaces gain no energy, and nothing is warned of.
# ILAW_TEST_ACCEPT=1 writes the column of this processor anew; `state_hash_test.py --column NAME FILE` the one of
# another processor (tests/platforms/run.sh), and names the scenes that differ there.
#
# The column "differs" says where a scene has another state: "fma", on x86-64 without FMA, for which glibc has another
# variant of log; or the name of a processor.
import csv
import json
import os
import pathlib
import platform
import subprocess
import sys
import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor

SOURCE = pathlib.Path(__file__).resolve().parents[2]
TABLE = pathlib.Path(__file__).with_name("state_hashes.csv")
PROCESSORS = ["x86_64", "aarch64", "ppc64le"]
# A level that the processor lacks only caps the choice.
VARIANTS = [("baseline", 1), ("v4", 2)] + [("v3", 2)] * ("ILAW_TEST_WHOLE" in os.environ)


def shipped():
    return sorted([*SOURCE.glob("host_mock/scenes/*.json"), *SOURCE.glob("plugins/*/*.json")], key=lambda file: file.stem)


def summary_of(scene, level, threads):
    audit = ["--audit"] if (level, threads) == VARIANTS[0] else []
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([os.environ["ILAW_PROGRAM"], "run", str(scene), "--out", folder, "--threads", str(threads),
                               *audit], env={**os.environ, "ILAW_ISA": level}, capture_output=True, text=True)
        if done.returncode != 0:
            raise AssertionError(f"{scene.name}: {done.stderr}")
        summary = json.loads((pathlib.Path(folder) / "summary.json").read_text())
        assert f", state {summary['state_hash']}" in done.stdout, done.stdout
        return summary


def table():
    with TABLE.open() as file:
        return {row["scene"]: row for row in csv.DictReader(file)}


class StateHash(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        runs = [(scene, *variant) for scene in shipped() for variant in VARIANTS]
        with ThreadPoolExecutor(2) as pool:
            summaries = list(pool.map(lambda run: summary_of(*run), runs))
        cls.found, cls.energies, cls.warnings = {}, {}, {}
        for (scene, *variant), summary in zip(runs, summaries):
            cls.found.setdefault(scene.stem, {})[tuple(variant)] = summary["state_hash"]
            cls.energies[scene.stem], cls.warnings[scene.stem] = summary["energy"], summary["warnings"]

    # The bodies lose against obstacles what the laws stored and dissipated, but for the work of reactions on nodes that
    # still move away, which is of the order of the step. A bond that breaks brittly takes nothing.
    def test_closes_the_balance_and_gains_no_energy(self):
        for scene, energy in self.energies.items():
            with self.subTest(scene=scene):
                lost = sum(energy[f"dissipated_{part}"] for part in ("friction", "impact", "rupture"))
                largest = max(energy["kinetic"], abs(energy["external_work"]), lost)
                self.assertLessEqual(energy["balance_error"], 1e-12)
                self.assertGreaterEqual(energy["least_dissipation"], 0)
                self.assertGreaterEqual(energy["reaction_work"], -1e-12 - 1e-10 * largest)
                self.assertLessEqual(energy["reaction_work"], 0.03 * lost + 1e-12 * largest)
                self.assertEqual(lost > 0, scene != "glued_bar")

    # A square bar that is glued to an oblique plane: two of its corners are off it.
    def test_warns_of_nothing(self):
        told = {scene: [one for one in warnings if scene != "mixed_mode_bar" or "open gap" not in one]
                for scene, warnings in self.warnings.items()}
        self.assertEqual({scene: warnings for scene, warnings in told.items() if warnings}, {})

    def test_depends_on_neither_threads_nor_level(self):
        for scene, states in self.found.items():
            with self.subTest(scene=scene):
                self.assertEqual(len(set(states.values())), 1, states)

    def test_is_the_one_of_the_table(self):
        here = {scene: states[VARIANTS[0]] for scene, states in self.found.items()}
        if os.environ.get("ILAW_TEST_ACCEPT"):
            write(platform.machine(), here)
        known = table()
        self.assertEqual(sorted(known), sorted(here))
        for scene, row in known.items():
            if "fma" in row["differs"] and "fma" not in pathlib.Path("/proc/cpuinfo").read_text().split():
                continue
            with self.subTest(scene=scene):
                self.assertEqual(here[scene], row.get(platform.machine()) or here[scene])

    def test_is_the_same_on_all_processors_of_the_table(self):
        for scene, row in table().items():
            names = [name for name in PROCESSORS if row.get(name) and name not in row["differs"].split()]
            with self.subTest(scene=scene):
                self.assertEqual(len({row[name] for name in names}), 1, row)


def write(processor, states):
    rows = table()
    with TABLE.open("w") as file:
        writer = csv.DictWriter(file, ["scene", *PROCESSORS, "differs"], lineterminator="\n")
        writer.writeheader()
        for scene in sorted({*rows, *states} & {file.stem for file in shipped()}):
            row = rows.get(scene, {})
            writer.writerow({**row, "scene": scene, processor: states.get(scene, row.get(processor))})


def write_column(processor, file):
    states = dict(line.split(",") for line in pathlib.Path(file).read_text().split())
    write(processor, states)
    known = table()
    others = [scene for scene, state in states.items() if known[scene]["x86_64"] != state]
    print(f"{len(states)} of {len(known)} scenes ran on {processor}; other states: {', '.join(others) or 'none'}")
    return len(others) > 0 or len(states) < len(known)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--column"]:
        sys.exit(write_column(*sys.argv[2:]))
    unittest.main()
