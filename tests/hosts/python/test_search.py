"""The closest facets of points from Python, against the geometry of a plate and of a fold."""
import numpy as np
import pytest

from ilaw.errors import InvalidArgument
from ilaw.search import Facets, Place


def plate(n, size=1.0):
    """Positions of a grid of n x n facets at z = 0, and the facets, seen from above."""
    line = np.linspace(0.0, size, n + 1)
    x, y = np.meshgrid(line, line)
    k = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    facets = np.stack([k[:-1, :-1], k[:-1, 1:], k[1:, 1:], k[1:, :-1]], axis=-1).reshape(-1, 4)
    return np.stack([x.ravel(), y.ravel(), 0.0 * x.ravel()], axis=1), facets


def above(n, heights, seed=1):
    """A plate, points at random places above it, the search."""
    nodes, facets = plate(n)
    own = np.random.default_rng(seed).uniform(0.05, 0.95, (len(heights), 3))
    own[:, 2] = heights
    points = np.arange(len(nodes), len(nodes) + len(own))
    position = np.vstack([nodes, own])
    return Facets(facets, points, position), position, facets, own


def test_a_plate_gives_height_normal_and_weights_of_each_point():
    search, position, facets, own = above(7, [0.2, 0.0, -0.01, 0.001])
    search.update(position)
    pairs = search.pairs()
    np.testing.assert_allclose(pairs.gap, own[:, 2], atol=1e-15)
    np.testing.assert_allclose(pairs.normal, np.tile([0, 0, 1], (4, 1)), atol=1e-15)
    assert set(pairs.place) == {Place.OVER}
    foot = np.einsum("kc,kci->ki", pairs.weights, position[facets[pairs.facet]])
    np.testing.assert_allclose(foot[:, :2], own[:, :2], atol=1e-14)
    np.testing.assert_allclose(pairs.weights.sum(axis=1), 1.0, atol=1e-14)


def test_near_names_the_points_within_reach():
    heights = np.full(2000, 50.0)
    heights[[7, 900]] = 0.01, 0.02
    search, position, _, _ = above(40, heights)
    search.update(position)
    near = search.near(0.02, forced=True)
    assert {7, 900} <= set(near) and list(near) == sorted(near) and len(near) < 200  # with their neighbors
    displacement = np.zeros_like(position)
    displacement[-2000, 2] = -49.99
    search.update(position, displacement)
    assert 0 in search.near(0.02)
    np.testing.assert_allclose(search.pairs([0]).gap, 0.01, atol=1e-13)


def test_a_point_beyond_the_border_is_told():
    nodes, facets = plate(3)
    position = np.vstack([nodes, [[1.1, 0.5, 0.01]]])
    search = Facets(facets, [len(nodes)], position)
    search.update(position)
    assert search.pairs().place[0] == Place.BEYOND
    assert search.pairs(rim=0.2).place[0] == Place.OVER


def test_the_plane_has_facets_of_two_nodes():
    position = np.array([[0.0, 0.0], [1.0, 0.0], [0.25, -0.1]])  # the points are to the right of the way
    search = Facets([[0, 1]], [2], position)
    search.update(position)
    pairs = search.pairs()
    assert pairs.gap[0] == pytest.approx(0.1) and pairs.normal[0] == pytest.approx([0, -1])
    assert pairs.weights[0] == pytest.approx([0.75, 0.25])


@pytest.mark.parametrize(
    ("facets", "points", "position", "reason"),
    [
        ([[0, 1, 2, 9]], [3], np.zeros((4, 3)), "facets: 9, expected 0 to 3"),
        ([[0, 1, 2, 3]], [-1], np.zeros((4, 3)), "points: -1, expected 0 to 3"),
        ([[0, 1]], [3], np.zeros((4, 3)), r"facets: shape \(1, 2\), expected \(facets, 3\) or \(facets, 4\)"),
        ([[0, 1, 2]], [3], np.zeros((4, 1)), r"position: shape \(4, 1\)"),
        ([[0.5, 1, 2]], [3], np.zeros((4, 3)), "facets: float64, expected whole numbers"),
    ],
)
def test_what_is_refused_is_named(facets, points, position, reason):
    with pytest.raises(InvalidArgument, match=reason):
        Facets(facets, points, position)
