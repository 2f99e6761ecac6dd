#!/usr/bin/env python3
"""The cases of docs/results/fault.py, tyre_block.py and calculix.py: figures of the pages, and closed forms."""
# SPDX-License-Identifier: BSD-3-Clause
import importlib.util
import os
import re
import shutil
import sys
import unittest
from pathlib import Path

RESULTS = Path(__file__).resolve().parents[2] / "docs/results"
sys.path.insert(0, str(RESULTS))  # for case_script
PROGRAM = os.environ["ILAW_PROGRAM"]


def load(name):
    spec = importlib.util.spec_from_file_location(name, RESULTS / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def row(page, *first):
    """Numbers of the row of a page's table that begins with these cells; nan where a cell is none."""
    head = "| " + " | ".join(first) + " |"
    line = next(line for line in (RESULTS / f"{page}.md").read_text().splitlines() if line.startswith(head))
    cells = [re.match(r"[-+0-9.e]+", cell.strip()) for cell in line[len(head) :].strip("|").split("|")]
    return [float(cell[0]) if cell and cell[0] != "-" else float("nan") for cell in cells]


class Fault(unittest.TestCase):
    def test_rupture_arrives_as_on_the_page(self):
        fault = load("fault")
        x, found, steps, _ = fault.arrivals(PROGRAM, 600, 0.5)
        expected = row("fault", "600", "0.5")
        self.assertEqual(steps, expected[0])
        for place, arrival in zip(fault.PLACES, expected[1:]):
            at = int(place // 600) if place % 600 == 0 else None
            if at is not None:
                self.assertAlmostEqual(found[at], arrival, delta=6e-4)

    def test_scene_has_the_stress_of_the_benchmark(self):
        fault = load("fault")
        loads = fault.scene(300, 0.5)["loads"]
        upper = [load for load in loads if load["type"] == "force" and load["direction"][0] > 0]
        shear = sum(load["direction"][0] * (1 if load.get("total") else len(load["nodes"])) for load in upper)
        expected = 300 * (fault.SHEAR * fault.LENGTH + (fault.NUCLEATION_SHEAR - fault.SHEAR) * 2 * fault.NUCLEATION)
        self.assertAlmostEqual(shear / expected, 1, places=12)


class TyreBlock(unittest.TestCase):
    def test_block_rubs_heats_and_wears_as_on_the_page(self):
        tyre_block = load("tyre_block")
        for temperature in (313.0, 293.0, 273.0):
            found, summary = tyre_block.run(PROGRAM, temperature, tyre_block.TABLE_SPEED)
            coldest, friction, off, heat, stored, wear = row("tyre_block", f"{temperature:g}")
            self.assertAlmostEqual(found["temperature"][-1].min(), coldest, delta=0.06)
            self.assertAlmostEqual(found["mu"][-1], friction, delta=1e-4)
            self.assertLess(tyre_block.error_of_friction(found), off + 6e-5)
            self.assertAlmostEqual(summary["heat"]["friction"], heat, delta=6e-4)
            self.assertAlmostEqual(summary["heat"]["stored"], stored, delta=6e-4)
            self.assertAlmostEqual(summary["interfaces"][0]["amounts"]["wear"] / 4 * 1e9, wear, delta=0.06)
            self.assertAlmostEqual(summary["heat"]["friction"] / summary["energy"]["dissipated_friction"], 1, places=12)
            self.assertLess(summary["heat"]["balance_error"], 1e-13)
            self.assertLess(summary["energy"]["balance_error"], 1e-13)


class Calculix(unittest.TestCase):
    def test_law_has_the_errors_of_the_page(self):
        calculix = load("calculix")
        for case, elements, length in ((calculix.Impact(), 20, 0.5), (calculix.Stack(), 8, 0.125)):
            t, u, v, _ = calculix.ilaw(PROGRAM, case, elements, float(f"{0.95 * length / calculix.WAVE:.3g}"))
            steps, of_u, of_v, _ = row("calculix", case.name, str(elements), "law contact", "0.95 L/c")
            self.assertEqual(len(t), steps)
            found = calculix.errors(case, t, u, v)
            self.assertLess(abs(100 * found[0] / of_u - 1), 0.05)
            self.assertLess(abs(100 * found[1] / of_v - 1), 0.05)

    @unittest.skipUnless(shutil.which("ccx"), "no CalculiX: `host_mock/setup.sh ci` installs it")
    def test_massless_contact_has_the_errors_of_the_page(self):
        calculix = load("calculix")
        t, u, v, _ = calculix.calculix("MASSLESS", calculix.Impact(), 20, 0.00833)
        steps, of_u, of_v, _ = row("calculix", "impact", "20", "CalculiX, massless", "0.5 L/c")
        self.assertEqual(len(t), steps)
        found = calculix.errors(calculix.Impact(), t, u, v)
        self.assertLess(abs(100 * found[0] / of_u - 1), 0.05)
        self.assertLess(abs(100 * found[1] / of_v - 1), 0.05)


if __name__ == "__main__":
    unittest.main()
