# SPDX-License-Identifier: BSD-3-Clause
"""The experiment of docs/results/oblique_sphere.py, at some of its angles, and what a rigid sphere does."""
import importlib.util
import os
import sys
from pathlib import Path

import pytest

pytest.importorskip("matplotlib")
FILE = Path(os.environ["ILAW_SOURCE"]) / "docs/results/oblique_sphere.py"
sys.path.insert(0, str(FILE.parent))  # for case_script
spec = importlib.util.spec_from_file_location("oblique_sphere", FILE)
sphere = importlib.util.module_from_spec(spec)
spec.loader.exec_module(sphere)


@pytest.mark.parametrize("angle", (20, 30, 50, 80))
def test_rebounds_as_measured(angle):
    found = sphere.impact(angle, 53, sphere.damping_of(angle, 53))
    assert found == pytest.approx(sphere.MEASURED[angle], rel=0.015)


def test_slides_to_the_end_as_a_rigid_sphere():
    found = sphere.impact(60, 170, sphere.damping_of(60, 170))
    assert found == pytest.approx(sphere.rigid(60), rel=1e-4)


def test_an_undamped_impact_keeps_the_normal_speed():
    assert sphere.impact(0, 53, 0.0, friction=0.0, is_normal=True) == pytest.approx(1.0, rel=1e-12)
