"""Shapes and rigid bodies by closed forms; ilaw/shapes.hpp has the same in C++."""
import numpy as np
import pytest

from ilaw import InvalidArgument, shapes


def test_gaps_and_normals():
    x = np.array([[5.0, 3.0, -4.0]])
    for made, gap, normal in (
        (shapes.plane(x, [0, 0, 1], [0.6, 0, 0.8]), -1.0, [0.6, 0, 0.8]),
        (shapes.sphere(x, [5, 0, 0], 2.0), 3.0, [0, 0.6, -0.8]),
        (shapes.cylinder(x, [-2, 0, 0], [3, 0, 0], 6.0), -1.0, [0, 0.6, -0.8]),
    ):
        assert made[0][0] == pytest.approx(gap) and made[1][0] == pytest.approx(normal)
    with pytest.raises(InvalidArgument, match="radius: 0.0, expected a number above 0"):
        shapes.sphere(x, [0, 0, 0], 0.0)


def test_the_end_of_a_rod_and_the_foot_of_a_sphere():
    """1/m along the rod, 1/m + l^2/4J = 4/m across it; 7/2m for a sphere along the ground."""
    mass, length, along = 2.0, 0.5, np.array([0.6, 0.8, 0.0])
    rod = 12 / (mass * length**2) * (np.eye(3) - np.outer(along, along))
    sphere = np.eye(3) * 2.5 / (mass * 0.2**2)
    h = shapes.delassus(1 / mass, np.array([rod, sphere]), np.array([length / 2 * along, [0, 0, -0.2]]))
    assert mass * h[0] == pytest.approx([0.36 + 4 * 0.64, 0.64 + 4 * 0.36, 4, -3 * 0.48, 0, 0])
    assert mass * h[1] == pytest.approx([3.5, 3.5, 1, 0, 0, 0])
