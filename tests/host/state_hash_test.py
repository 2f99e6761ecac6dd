# Every shipped scene ends in the state of state_hashes.csv, whatever the threads and the level of the laws.
# ILAW_TEST_ACCEPT=1 writes the column of this processor anew; `state_hash_test.py --column NAME FILE` the one of
# another processor (tests/platforms/run.sh), and names the scenes that differ there.
#
# The column "differs" says where a scene has another state: "fma", on x86-64 without FMA, for which glibc has another
# variant of log; "aarch64" and "ppc64le", where the host's solid elements round otherwise.
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
VARIANTS = [("baseline", 1), ("v3", 2), ("v4", 2)]


def shipped():
    return sorted([*SOURCE.glob("host_mock/scenes/*.json"), *SOURCE.glob("plugins/*/*.json")], key=lambda file: file.stem)


def state_of(scene, level, threads):
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([os.environ["ILAW_PROGRAM"], "run", str(scene), "--out", folder, "--threads", str(threads)],
                              env={**os.environ, "ILAW_ISA": level}, capture_output=True, text=True)
        if done.returncode != 0:
            raise AssertionError(f"{scene.name}: {done.stderr}")
        state = json.loads((pathlib.Path(folder) / "summary.json").read_text())["state_hash"]
        assert f", state {state}" in done.stdout, done.stdout
        return state


def table():
    with TABLE.open() as file:
        return {row["scene"]: row for row in csv.DictReader(file)}


class StateHash(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        runs = [(scene, *variant) for scene in shipped() for variant in VARIANTS]
        with ThreadPoolExecutor(2) as pool:
            states = list(pool.map(lambda run: state_of(*run), runs))
        cls.found = {}
        for (scene, *variant), state in zip(runs, states):
            cls.found.setdefault(scene.stem, {})[tuple(variant)] = state

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
