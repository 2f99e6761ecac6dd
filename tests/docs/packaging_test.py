#!/usr/bin/env python3
"""Recipes and metadata can be read, have the version and the license of the project, and name options that exist."""
# SPDX-License-Identifier: BSD-3-Clause

import ast
import json
import re
import unittest
from pathlib import Path

import yaml

ROOT = Path(__file__).resolve().parents[2]
RECIPES = ROOT / "docs" / "packaging"
BUILD = (ROOT / "CMakeLists.txt").read_text()
VERSION = re.search(r"project\(ilaw VERSION ([0-9.]+)", BUILD)[1]
LICENSE = "BSD-3-Clause"


def recipes():
    return [file for file in sorted(RECIPES.rglob("*")) if file.is_file()]


def members(file):
    """Constants of the first class of a recipe in Python, and its calls with the text of their first argument."""
    body = next(node for node in ast.parse(file.read_text()).body if isinstance(node, ast.ClassDef)).body
    found = {}
    for node in body:
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant):
            found.update((target.id, node.value.value) for target in node.targets)
        elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
            found.setdefault(node.value.func.id, ast.literal_eval(node.value.args[0]))
    return found


def conda():
    text = re.sub(r"\{\{.*?\}\}", "expression", (RECIPES / "conda" / "meta.yaml").read_text())
    return yaml.safe_load(text)


def claims():
    """Version and license by the file that states them."""
    for name in ("spack/package.py", "conan/conanfile.py"):
        recipe = members(RECIPES / name)
        yield name, recipe["version"], recipe["license"]
    recipe = conda()
    yield "conda/meta.yaml", recipe["package"]["version"], recipe["about"]["license"]
    recipe = json.loads((RECIPES / "vcpkg" / "ilaw" / "vcpkg.json").read_text())
    yield "vcpkg.json", recipe["version"], recipe["license"]
    labels = dict(re.findall(r"^ +(Version|License) (\S+)$", (RECIPES / "apptainer" / "ilaw.def").read_text(), re.M))
    yield "ilaw.def", labels["Version"], labels["License"]
    metadata = json.loads((ROOT / "docs" / "codemeta.json").read_text())
    yield "codemeta.json", metadata["version"], metadata["license"].rpartition("/")[2]
    citation = yaml.safe_load((ROOT / "docs" / "CITATION.cff").read_text())
    yield "CITATION.cff", citation["version"], citation["license"]


class Packaging(unittest.TestCase):
    def test_has_version_and_license_of_the_project(self):
        for name, version, license_name in claims():
            self.assertEqual((version, license_name), (VERSION, LICENSE), name)

    def test_python_package_has_the_version_of_the_project(self):
        module = (ROOT / "api" / "python" / "ilaw" / "__init__.py").read_text()
        self.assertEqual(re.search(r'^__version__ = "([^"]+)"', module, flags=re.M)[1], VERSION)

    def test_options_exist(self):
        known = set(re.findall(r"^option\((ILAW_\w+)", BUILD, flags=re.M))
        named = {(file.name, option) for file in recipes()
                 for option in re.findall(r"(?:\b|-D)(ILAW_(?!PATH\b)[A-Z]+)\b", file.read_text())}
        self.assertGreaterEqual(len(named), 15)
        for name, option in named:
            self.assertIn(option, known, name)

    def test_files_of_the_tree_exist(self):
        copied = re.findall(r"^    (\S+) /ilaw/\S+$", (RECIPES / "apptainer" / "ilaw.def").read_text(), re.M)
        exported = re.search(r"^TREE = (\[.*\])$", (RECIPES / "conan" / "conanfile.py").read_text(), re.M)[1]
        for path in copied + [pattern.rstrip("*") for pattern in ast.literal_eval(exported)]:
            self.assertTrue((ROOT / path).exists(), path)

    def test_recipes_that_stand_in_the_tree_find_it(self):
        source = RECIPES / "conda" / conda()["source"]["path"]
        self.assertEqual(source.resolve(), ROOT)
        port = RECIPES / "vcpkg" / "ilaw"
        up = re.search(r"CURRENT_PORT_DIR\}/([./]+)", (port / "portfile.cmake").read_text())[1]
        self.assertEqual((port / up).resolve(), ROOT)

    def test_citation_has_the_keys_that_its_format_asks_for(self):
        citation = yaml.safe_load((ROOT / "docs" / "CITATION.cff").read_text())
        self.assertLessEqual({"cff-version", "message", "title", "authors"}, set(citation))


if __name__ == "__main__":
    unittest.main()
