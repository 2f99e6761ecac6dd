# SPDX-License-Identifier: BSD-3-Clause
"""The tests of Chung and Ooi in Python, and partial slip: errors of the pages, at coarse steps and meshes."""
import os
import sys
from pathlib import Path

import pytest

RESULTS = Path(os.environ["ILAW_SOURCE"]) / "docs/results"
sys.path.insert(0, str(RESULTS))
import partial_slip  # noqa: E402
import particle_hosts  # noqa: E402
import particle_impacts  # noqa: E402

LAWS = dict(zip(particle_impacts.LAWS, (3, 4, 5)))  # and their columns on the page
PAGE = (RESULTS / "particle_impacts.md").read_text().splitlines()
ROWS = [[cell.strip() for cell in line.split("|")[1:-1]] for line in PAGE]


@pytest.mark.parametrize("test", particle_impacts.tests(), ids=lambda test: f"{test.name}, {test.judge}")
def test_errors_are_those_of_the_page(test):
    for law, column in LAWS.items():
        found = particle_hosts.in_python(test, law, 53)
        for quantity in test.exact(test, law):
            row = next(row for row in ROWS if row[:3] == [test.name, test.judge, quantity])
            if row[column] != "-":
                error = particle_impacts.error_of(test, law, quantity, found)
                assert error < 1e-12 or f"{error:.0e}" == row[column].split()[1], (law, quantity)


def test_tractions_of_partial_slip():
    normal, along, sticks, *_ = partial_slip.judged("coulomb", 10)
    assert normal < 0.005 and along < 0.0102 and sticks == pytest.approx(0.53, abs=1e-3)
