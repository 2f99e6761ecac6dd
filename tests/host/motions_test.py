# Motions that are known in closed form, or from another run: every row of motions.json runs, for all combinations of
# the values in "each", with each step audited. "expect" has what must come out, a value and a tolerance: a column or a
# number of the summary is written into the scene, where `ilaw run` judges it; an expression of columns is judged here,
# over all rows of the history. Text that begins with "=" is computed from the values of "each" and "let". Without
# "balance" the energy balance must close to 1e-12, without "warns" there must be no warning. "fails" has what is told
# of a run that ends with code 1, "unaudited" is for what an audit would end before. "twin" is a second run, with other
# keys ("set"), another scene or other options: it has the bits of the first if "bits" is true, and expressions see it
# as `twin`. "files" stand beside the scene. "way": true if what is asked depends on the way to the solution,
# which a hostile build takes otherwise: iterations, a rounding, or which of several solutions is found; or what is
# asked beside "expect" for that reason.
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
        file = SHIPPED.get(scene) or next(TABLE.parent.glob(f"*_scenes/{scene}.json"))
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


class Ran:
    """What a run leaves."""

    def __init__(self, scene, folder, options):
        (folder / "scene.json").write_text(json.dumps(scene, default=float))
        command = [os.environ["ILAW_PROGRAM"], "run", folder / "scene.json", "--out", folder, *options]
        self.done = subprocess.run(command, capture_output=True, text=True, check=False)
        self.files = {name: (folder / name).read_text() if (folder / name).is_file() else ""
                      for name in ("summary.json", "history.csv", "events.csv")}
        if self.done.returncode:
            return
        self.summary = json.loads(self.files["summary.json"])
        names, *rows = self.files["history.csv"].splitlines() or [""]
        self.columns = dict(zip(names.split(","), np.array([[float(cell or "nan") for cell in row.split(",")]
                                                            for row in rows]).T))
        self.c, self.rows = self.columns.__getitem__, len(rows)
        self.events = [line.split(",") for line in self.files["events.csv"].splitlines()[1:]]

    def bits(self):
        """What is the same to the bit in runs that must not differ."""
        kept = ("state_hash", "steps", "energy", "forces", "status_counts", "penetration_max")
        return [*self.files["history.csv"].splitlines(), *self.files["events.csv"].splitlines(),
                *(f"{key}: {self.summary[key]}" for key in kept)]

    def breaches(self):
        """Of what every summary fulfils."""
        summary, seconds = self.summary, self.summary["seconds"]
        execution, stepping = summary["execution"], seconds["interfaces"] + seconds["internal_forces"]
        share = execution["interface_share"] * stepping
        node_steps = summary["steps"] * sum(one["nodes"] for one in summary["interfaces"])
        holds = {
            "contacts of all steps are active or skipped": sum(execution["node_steps"].values()) == node_steps,
            "contacts of all steps have a status": sum(summary["status_counts"].values()) == node_steps,
            "the share of the interfaces": abs(share - seconds["interfaces"]) <= 1e-12 * stepping,
            "the time of the parts": stepping <= seconds["total"],
            "the state and some vectors beside it": all(
                0 <= one["bytes_per_node"] - 8 * one["state_size"] <= 300 for one in summary["interfaces"])}
        return [what for what, is_so in holds.items() if not is_so]


def asked(row):
    """What is asked of a row in this build; None: nothing."""
    way, is_hostile = row.get("way", {}), os.environ.get("ILAW_HOSTILE") == "1"
    if way is True:
        return None if is_hostile else row
    return row if is_hostile else {**row, "expect": {**row["expect"], **way}}


def complaints(row, scenes, values):
    """What one run of a row does otherwise than expected."""
    names = {**vars(np), "max": np.maximum, "min": np.minimum, **values}
    add_names(row, names)
    scene = scene_of(row, scenes, names)
    expected = {"energy.balance_error": [0, row.get("balance", 1e-12)], **row["expect"]}
    judged = [{"what": what, "value": float(number(value, names)), "tolerance": float(number(tolerance, names)),
               "because": row["of"]} for what, (value, tolerance) in expected.items() if is_column(what)]
    with tempfile.TemporaryDirectory() as folder:
        for name, text in row.get("files", {}).items():
            (pathlib.Path(folder) / name).write_text(computed(text, names))
        audit = [] if row.get("unaudited") else ["--audit"]
        ran = Ran({**scene, "expect": judged}, pathlib.Path(folder), [*audit, *row.get("options", [])])
        if "fails" in row:
            fails = computed(row["fails"], names)
            is_told = all(part in ran.done.stderr for part in ([fails] if isinstance(fails, str) else fails))
            return [] if ran.done.returncode == 1 and is_told else [f"{ran.done.returncode} {ran.done.stderr}"]
        if ran.done.returncode:
            return [ran.done.stderr]
        names |= {"ran": ran, "c": ran.c, "columns": ran.columns, "t": ran.columns.get("time"), "summary": ran.summary,
                  "dt": ran.summary["dt"], "n": np.arange(1, ran.rows + 1),
                  "warnings": " ".join(ran.summary["warnings"]),
                  "events": lambda kind, of="": [float(time) for time, _, interface, what, *_ in ran.events
                                                 if what == kind and of in interface],
                  "peeled": {one[1] for one in ran.events if one[3] == "rupture"}}
        if "twin" in row:
            changes = row["twin"].get("set", {})
            other = row["twin"] if "scene" in row["twin"] else {**row, "set": {**row.get("set", {}), **changes}}
            options = ["--audit", *row["twin"].get("options", [])]
            twin = names["twin"] = Ran(scene_of(other, scenes, names), pathlib.Path(folder), options)
            if twin.done.returncode:
                return [f"twin: {twin.done.stderr}"]
    found = ran.breaches()
    if row.get("twin", {}).get("bits"):
        pairs = itertools.zip_longest(ran.bits(), twin.bits())
        found += [f"{mine} and {other}" for mine, other in pairs if mine != other][:5]
    add_names(row, names)
    for what, (value, tolerance) in row["expect"].items():
        if not is_column(what):
            off = np.abs(computed(what, names) - number(value, names)) - 1.0*number(tolerance, names)
            if np.size(off) == 0 or not np.all(off <= 0):
                worst = np.max(off, initial=-np.inf)
                found.append(f"{what}: {np.size(off)} values, off by {worst:.3g} more than {tolerance}")
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
        rows = [row for row in map(asked, table["motions"]) if row]
        runs = [(row, dict(zip(row.get("each", {}), values))) for row in rows
                for values in itertools.product(*(computed(value, vars(np)) for value in row.get("each", {}).values()))]
        self.assertGreater(len(runs), 100)
        with ThreadPoolExecutor(2) as pool:
            found = pool.map(lambda run: complaints(run[0], table["scenes"], run[1]), runs)
            for (row, values), wrong in zip(runs, found):
                with self.subTest(row["of"], **values):
                    self.assertEqual(wrong, [])
                if wrong and "ILAW_MUTANT" in os.environ:  # which is caught
                    return pool.shutdown(cancel_futures=True)


if __name__ == "__main__":
    unittest.main()
