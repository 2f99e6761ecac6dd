# Every mistake of refusals.json is answered with code 2 and the words that stand there: the JSON pointer, what was
# found and what is allowed. A row is what is put into its scene, at JSON pointers ("-": what is taken out), or a
# command, and the answer; then what files beside the scene hold: a text, or what stands for what in the text that the
# "files" of the group give. With ILAW_TEST_ACCEPT=1 the answers of today are written into the table, where a review
# of the change judges them.
import copy
import itertools
import json
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

HERE = pathlib.Path(__file__).parent
TABLE = HERE / "refusals.json"
SHIPPED = {file.stem: file for folder in ("host_mock/scenes", "plugins", "docs/results/scenes")
           for file in (HERE.parents[1] / folder).rglob("*.json")}
ENVIRONMENT = {name: value for name, value in os.environ.items() if name != "ILAW_ISA"}


def found_at(scene, pointer):
    """The container that a pointer ends in, and its last key; - is the place behind the end of a list."""
    keys = [key.replace("~1", "/").replace("~0", "~") for key in pointer.split("/")[1:]]
    for key in keys[:-1]:
        scene = scene[int(key)] if isinstance(scene, list) else scene.setdefault(key, {})
    if isinstance(scene, list):
        return scene, len(scene) if keys[-1] == "-" else int(keys[-1])
    return scene, keys[-1]


def changed(scene, patch):
    scene = copy.deepcopy(scene)
    for pointer in patch.get("-", []):
        part, key = found_at(scene, pointer)
        del part[key]
    for pointer, value in patch.items():
        if pointer == "":
            return value
        if pointer != "-":
            part, key = found_at(scene, pointer)
            if isinstance(part, list) and key == len(part):
                part.append(value)
            else:
                part[key] = value
    return scene


def answer(arguments, folder):
    """The code, and what the program says, without the places that are this run's."""
    done = subprocess.run([os.environ["ILAW_PROGRAM"], *arguments], cwd=folder, capture_output=True, text=True,
                          env=ENVIRONMENT, check=False)
    said = done.stderr.removeprefix("ilaw: ").removeprefix("scene.json: ").rstrip("\n")
    for here, anywhere in [(rf"{folder}/", ""), (r"/\S*/lib/ilaw/", ""), (r"one of: /[^;]*", "one of: ..."),
                           (r"libraries found: [^;\n]*", "libraries found: ..."),
                           (r"[\d.]+ GB that this", "... GB that this")]:
        said = re.sub(here, anywhere, said)
    return done.returncode, said


class Refusals(unittest.TestCase):
    maxDiff = None
    numbers = itertools.count()

    def judge(self, row, arguments, folder):
        number = next(self.numbers)
        with self.subTest(row=row[0]):
            code, said = answer([word.replace("OUT", f"out{number}") for word in arguments], folder)
            self.assertEqual(code, 2, said)
            self.assertFalse((folder / f"out{number}").exists())
            if said != row[1] and os.environ.get("ILAW_TEST_ACCEPT"):
                row[1] = said
            self.assertEqual(said, row[1])

    def test_each_is_said(self):
        table = json.loads(TABLE.read_text())
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            for group in table:
                scene = group.get("scene")
                if isinstance(scene, str):
                    scene = json.loads(SHIPPED[scene].read_text())
                # Of a closed form one for all: view.study judges them in one process.
                exact = [row for row in group["refused"] if row[1].startswith("/exact: ")]
                for row in group["refused"]:
                    if row in exact[1:]:
                        continue
                    files = group.get("files", {})
                    for file, text in {**files, **(row[2] if len(row) > 2 else {})}.items():
                        (folder / file).write_text(text if isinstance(text, str) else files[file].replace(*text, 1))
                    if isinstance(row[0], str):
                        arguments = row[0].split()
                    else:
                        (folder / "scene.json").write_text(json.dumps(changed(scene, row[0])))
                        arguments = [*group.get("command", "run").split(), "scene.json", "--out", "OUT"]
                    self.judge(row, arguments, folder)
        if os.environ.get("ILAW_TEST_ACCEPT"):
            TABLE.write_text(written(table))

    def test_values_nested_too_deep_are_told_where_they_are(self):
        """100000 deep, no reader can go into values by recursion."""
        for depth in (65, 100000):
            nested = {"": depth * "[" + depth * "]", "interfaces": depth * "[" + depth * "]",
                      "model": 65 * '{"a": ' + "1" + 65 * "}"}
            for key, text in nested.items():
                with tempfile.TemporaryDirectory() as name:
                    folder = pathlib.Path(name)
                    (folder / "scene.json").write_text(f'{{"time": {{"dt": 1e-3}}, "{key}": {text}}}' if key else text)
                    row = [key, f"/{key}: values are nested more than 64 deep, expected at most that"]
                    self.judge(row, ["run", "scene.json", "--out", "OUT"], folder)


def written(table):
    """A row a line."""
    groups = []
    for group in table:
        rows = ",\n  ".join(json.dumps(row, ensure_ascii=False) for row in group["refused"])
        head = json.dumps({key: value for key, value in group.items() if key != "refused"}, ensure_ascii=False)[:-1]
        groups.append(head + ', "refused": [\n  ' + rows + "]}")
    return "[" + ",\n".join(groups) + "]\n"


if __name__ == "__main__":
    unittest.main()
