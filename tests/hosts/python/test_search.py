"""The closest facets of points (ilaw/search.h): against all facets one by one, and closed forms. Lists, counts and calls:
hosts/facets_test.cpp."""
import numpy as np
import pytest

from ilaw.errors import InvalidArgument
from ilaw.search import Facets, Place


def face(n, place, has_triangles=False):
    """Positions of a face of n x n facets with edges of 1, seen from above, and the facets, some halved into triangles."""
    nodes = np.array([place(i, j) for j in range(n + 1) for i in range(n + 1)], float)
    facets = []
    for j, i in np.ndindex(n, n):
        a, b = j * (n + 1) + i, j * (n + 1) + i + 1
        c, d = b + n + 1, a + n + 1
        facets += [[a, b, c, c], [a, c, d, d]] if has_triangles and (i + j) % 3 == 0 else [[a, b, c, d]]
    return nodes, np.array(facets)


def searched(nodes, facets, own, **given):
    """The search of points beside the nodes, updated once, and all positions."""
    position, points = np.vstack([nodes, own]), len(nodes) + np.arange(len(own))
    search = Facets(facets, points, position)
    search.update(position)
    return search, position, points


def plate(n):
    return face(n, lambda i, j: (i, j, 0))


def wavy(draw, count, height):
    nodes, facets = face(6, lambda i, j: (
        i + draw.uniform(-0.2, 0.2), j + draw.uniform(-0.2, 0.2),
        0.5 * (np.sin(1.3 * i) * np.cos(j) + draw.uniform(-0.2, 0.2))), has_triangles=True)  # fmt: skip
    return nodes, facets, draw.uniform([-2, -2, -0.5 * height], [8, 8, height], (count, 3))


def foot(position, facets, pairs):
    return np.einsum("kc,kci->ki", pairs.weights, position[facets[pairs.facet]])


def test_pairs_are_the_closest_of_all_facets():
    """A search over one facet looks for nothing. The surface moves now and then, and the points go from one facet to the
    next."""
    draw = np.random.default_rng(31)
    nodes, facets, own = wavy(draw, 40, 3.0)
    search, position, points = searched(nodes, facets, own)
    alone, places, different = [Facets(one[None], points, position) for one in facets], [], 0
    for step in range(60):
        if step % 10 == 9:
            position += draw.uniform(-0.3, 0.3, position.shape)
        position[points, 0 if step < 30 else 1] += 0.15 if step % 20 < 10 else -0.15
        search.update(position)
        pairs, at = search.pairs(), position[points]
        distances, weights = [], []
        for one, corners in zip(alone, facets):
            one.update(position)
            found = one.pairs()
            distances.append(np.linalg.norm(at - foot(position, corners[None], found), axis=1))
            weights.append(found.weights)
        # Of facets that are as close but for 1e-6 edges, the one that a point behind the surface faces most is taken.
        off = np.linalg.norm(at - foot(position, facets, pairs), axis=1) - np.min(distances, axis=0)
        assert off.min() >= -1e-14 and off.max() <= 1e-6
        different += np.count_nonzero(off > 1e-14)
        best, k = np.argmin(distances, axis=0), np.arange(len(points))
        same = pairs.facet == best  # else at an edge, by rounding
        assert np.array_equal(pairs.weights[same], np.array(weights)[best, k][same])
        places += [*pairs.place]
    assert different <= 2
    assert places.count(Place.OVER) > 300 and len(places) - places.count(Place.OVER) > 300


def test_no_point_of_the_surface_is_closer():
    """By points of all facets. Of a facet that is not flat a point far from it may get another one where the distance is
    stationary."""
    nodes, facets, own = wavy(np.random.default_rng(32), 100, 1.0)
    search, position, _ = searched(nodes, facets, own)
    pairs, (a, b) = search.pairs(), np.meshgrid(*[np.linspace(0, 1, 21)] * 2)
    weights = np.stack([(1 - a) * (1 - b), a * (1 - b), a * b, (1 - a) * b], axis=-1).reshape(-1, 4)
    surface = np.einsum("wc,fci->fwi", weights, position[facets]).reshape(-1, 3)
    distance = np.linalg.norm(own - foot(position, facets, pairs), axis=1)
    close = distance <= 0.7
    assert close.sum() > 30
    np.testing.assert_allclose(np.linalg.norm(pairs.normal[close], axis=1), 1, atol=1e-14)
    for x, least in zip(own[close], distance[close]):
        assert np.linalg.norm(surface - x, axis=1).min() >= least * (1 - 1e-9)


def test_of_equal_facets_the_first_is_found():
    """Above an edge or a corner, whatever was found before."""
    nodes, facets = plate(4)
    search, position, points = searched(nodes, facets, nodes + [0, 0, 0.25])
    for dx in (0.3, -0.3, 0.0):
        position[points, 0] = nodes[:, 0] + dx
        search.update(position)
        pairs = search.pairs()
    assert pairs.facet.tolist() == [4 * max(k // 5 - 1, 0) + max(k % 5 - 1, 0) for k in range(25)]
    assert (pairs.gap == 0.25).all()


@pytest.mark.parametrize("wave", [1e-3, 0.1, 0.5, 1.0])
def test_the_side_of_a_point_is_told(wave):
    """Over a grid the height of the surface is bilinear, which says on which side of it a point is: also behind a fold, where
    a whole wedge of points has the edge for its closest place, and over sharp ridges."""
    draw, n, count = np.random.default_rng(35), 6, 3000
    height = wave * draw.uniform(-1, 1, (n + 1, n + 1))
    nodes, facets = face(n, lambda i, j: (i, j, height[i, j]))
    (i, j), (x, y), above = draw.integers(1, n - 1, (2, count)), draw.random((2, count)), draw.uniform(-0.3, 0.3, count)
    x[::3], y[::2] = 0, 0
    z = ((1 - x) * (1 - y) * height[i, j] + x * (1 - y) * height[i + 1, j] + x * y * height[i + 1, j + 1]
         + (1 - x) * y * height[i, j + 1])  # fmt: skip
    search, _, _ = searched(nodes, facets, np.column_stack([i + x, j + y, z + above]))
    pairs = search.pairs()
    inside = pairs.place != Place.BEYOND
    assert np.array_equal(pairs.gap[inside] < 0, above[inside] < 0)
    assert (inside & (above < 0) & (pairs.weights.min(axis=1) == 0)).sum() > 100  # behind edges


@pytest.mark.parametrize("far", 10.0 ** np.arange(11))
def test_points_are_met_far_from_the_origin(far):
    """A tilted plate, whose coordinates are rounded wherever it is; points below it must be seen below it."""
    draw, origin = np.random.default_rng(33), far * np.array([1, -0.7, 0.4])
    a, b, normal = np.array([[0.8, 0.36, 0.48], [0, 0.8, -0.6], [-0.6, 0.48, 0.64]])
    nodes, facets = face(5, lambda i, j: origin + i * a + j * b)
    depth = draw.uniform(-0.2, 0.2, 200)
    search, _, _ = searched(nodes, facets, origin + draw.uniform(0.1, 4.9, (200, 2)) @ [a, b] + depth[:, None] * normal)
    pairs = search.pairs()
    assert set(pairs.place) == {Place.OVER}
    np.testing.assert_allclose(pairs.gap, depth, rtol=0, atol=1e-14 + 8e-16 * far)


def test_a_plate_gives_height_normal_and_weights_of_each_point():
    nodes, facets = plate(7)
    own = np.random.default_rng(1).uniform(0.5, 6.5, (4, 3))
    own[:, 2] = [0.2, 0.0, -0.01, 0.001]
    search, position, _ = searched(nodes, facets, own)
    pairs = search.pairs()
    np.testing.assert_allclose(pairs.gap, own[:, 2], atol=1e-15)
    np.testing.assert_allclose(pairs.normal, np.tile([0, 0, 1], (4, 1)), atol=1e-15)
    np.testing.assert_allclose(foot(position, facets, pairs)[:, :2], own[:, :2], atol=1e-14)
    np.testing.assert_allclose(pairs.weights.sum(axis=1), 1.0, atol=1e-14)


def test_near_names_the_points_within_reach():
    nodes, facets = plate(40)
    own = np.random.default_rng(1).uniform(1, 39, (2000, 3))
    own[:, 2] = 50.0
    own[[7, 900], 2] = 0.4, 0.8
    search, position, _ = searched(nodes, facets, own)
    near = search.near(0.8, forced=True)
    assert {7, 900} <= set(near) and list(near) == sorted(near) and len(near) < 200  # with their neighbors
    displacement = np.zeros_like(position)
    displacement[-2000, 2] = -49.6
    search.update(position, displacement)
    assert 0 in search.near(0.8)
    np.testing.assert_allclose(search.pairs([0]).gap, 0.4, atol=1e-13)


def test_facets_go_on_by_the_rim():
    nodes, facets = plate(3)
    search, _, _ = searched(nodes, facets, [[3.0, 1.5, -0.05], [3.05, 1.5, -0.05], [3.2, 1.5, -0.05]])
    assert search.pairs().place[2] == Place.BEYOND
    pairs = search.pairs(rim=0.1)
    assert pairs.place.tolist() == [Place.OVER, Place.OVER, Place.BEYOND]
    assert pairs.gap[1] == -0.05 and pairs.gap[2] == pytest.approx(np.hypot(0.2, 0.05), abs=1e-15)


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
