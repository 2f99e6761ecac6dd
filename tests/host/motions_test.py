# Motions that are known in closed form: every row of motions.json runs, for all combinations of the values in "each",
# with each step audited. "expect" has what must come out, a value and a tolerance: a column or a number of the summary
# is written into the scene, where `ilaw run` judges it; an expression of columns is judged here, over all rows of the
# history. Text that begins with "=" is computed from the values of "each" and "let". Without "balance" the energy
# balance must close to 1e-12, without "warns" there must be no warning.
import contextlib
import itertools
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from refusals_test import SHIPPED, changed

TABLE = pathlib.Path(__file__).with_name("motions.json")


def computed(part, names):
    if isinstance(part, str) and part.startswith("="):
        return eval(part[1:], names)
    if isinstance(part, list):
        return [computed(one, names) for one in part]
    if isinstance(part, dict):
        return {computed(key, names): computed(value, names) for key, value in part.items()}
    return part


def add_names(row, names):
    """Those of "let"; some need what a run has, such as its step."""
    for name, value in row.get("let", {}).items():
        with contextlib.suppress(NameError):
            names[name] = computed(f"={value}", names)


def scene_of(row, scenes, names):
    scene = computed(row["scene"], names)
    if isinstance(scene, str) and scene in scenes:
        scene = computed(scenes[scene], names)
    elif isinstance(scene, str):
        file = SHIPPED.get(scene, TABLE.parent / "analyst_scenes" / f"{scene}.json")
        scene = json.loads(file.read_text())
        for mesh in scene["model"].get("meshes", []):
            mesh["file"] = str(file.parent / mesh["file"])
    scene = changed(scene, computed(row.get("set", {}), {**names, "scene": scene}))
    scene.pop("expect", None)
    return scene


def is_column(what):
    return not what.startswith("=")


def number(value, names):
    return computed(f"={value}", names) if isinstance(value, str) else value


def complaints(row, scenes, values):
    """What one run of a row does otherwise than expected."""
    names = {**vars(np), "max": np.maximum, "min": np.minimum, **values}
    add_names(row, names)
    scene = scene_of(row, scenes, names)
    expected = {"energy.balance_error": [0, row.get("balance", 1e-12)], **row["expect"]}
    scene["expect"] = [{"what": what, "value": float(number(value, names)), "tolerance": float(number(tolerance, names)),
                        "because": row["of"]} for what, (value, tolerance) in expected.items() if is_column(what)]
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder)
        (out / "scene.json").write_text(json.dumps(scene, default=float))
        done = subprocess.run([os.environ["ILAW_PROGRAM"], "run", out / "scene.json", "--out", out, "--audit"],
                              capture_output=True, text=True, check=False)
        if "fails" in row:
            return [] if done.returncode == 1 and row["fails"] in done.stderr else [f"{done.returncode} {done.stderr}"]
        if done.returncode:
            return [done.stderr]
        summary = json.loads((out / "summary.json").read_text())
        lines = (out / "history.csv").read_text().splitlines() if (out / "history.csv").is_file() else [""]
        events = [line.split(",") for line in (out / "events.csv").read_text().splitlines()[1:]
                  ] if (out / "events.csv").is_file() else []
    columns = dict(zip(lines[0].split(","), np.array([[float(cell or "nan") for cell in line.split(",")]
                                                      for line in lines[1:]]).T))
    names |= {"c": columns.__getitem__, "columns": columns, "t": columns.get("time"), "summary": summary, "dt": summary["dt"],
              "n": np.arange(1, len(lines)), "warnings": " ".join(summary["warnings"]),
              "events": lambda kind, of="": [float(one[0]) for one in events if one[3] == kind and of in one[2]],
              "peeled": {one[1] for one in events if one[3] == "rupture"}}
    add_names(row, names)
    found = []
    for what, (value, tolerance) in row["expect"].items():
        if not is_column(what):
            off = np.abs(computed(what, names) - number(value, names)) - number(tolerance, names)
            if np.size(off) == 0 or not np.all(off <= 0):
                found.append(f"{what}: {np.size(off)} values, off by {np.max(off, initial=-np.inf):.3g} more than {tolerance}")
    warns = computed(row.get("warns"), names)
    if names["warnings"] if warns is None else warns not in names["warnings"]:
        found.append(f"warnings: {names['warnings']}")
    return found


class Motions(unittest.TestCase):
    def test_have_the_meshes_of_their_scripts(self):
        scenes = TABLE.parent / "analyst_scenes"
        with tempfile.TemporaryDirectory() as folder:
            for script, out in (("arch", folder), ("bracket", f"{folder}/bracket.vtu")):
                subprocess.run([sys.executable, scenes / f"{script}.py", out], check=True, capture_output=True)
            for made in ("arch.vtu", "arch.json", "bracket.vtu"):
                self.assertEqual((pathlib.Path(folder) / made).read_text(), (scenes / made).read_text(), made)

    def test_are_as_known(self):
        table = json.loads(TABLE.read_text())
        runs = [(row, dict(zip(row.get("each", {}), values))) for row in table["motions"]
                for values in itertools.product(*(computed(value, vars(np)) for value in row.get("each", {}).values()))]
        self.assertGreater(len(runs), 100)
        with ThreadPoolExecutor(2) as pool:
            found = list(pool.map(lambda run: complaints(run[0], table["scenes"], run[1]), runs))
        for (row, values), wrong in zip(runs, found):
            with self.subTest(of=row["of"], **values):
                self.assertEqual(wrong, [])


if __name__ == "__main__":
    unittest.main()
