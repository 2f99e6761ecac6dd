"""The closest facets of points (ilaw/search.h): against all facets one by one, and closed forms;
lists of points near by, how many facets are looked at, overlaps, and calls by the structs of C. Allocations:
hosts/facets_test.cpp."""
import ctypes
import threading

import numpy as np
import pytest

from ilaw import _abi, _search_abi
from ilaw._objects import sized
from ilaw.errors import InvalidArgument
from ilaw.search import Facets, Place, library


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


def wavy(draw, count, height, wave=0.5):
    nodes, facets = face(6, lambda i, j: (
        i + draw.uniform(-0.2, 0.2), j + draw.uniform(-0.2, 0.2),
        wave * (np.sin(1.3 * i) * np.cos(j) + draw.uniform(-0.2, 0.2))), has_triangles=True)  # fmt: skip
    return nodes, facets, draw.uniform([-2, -2, -0.5 * height], [8, 8, height], (count, 3))


def plates(n, gap, aside):
    """Two plates: the nodes of the upper one above the facets of the lower one."""
    nodes, facets = plate(n)
    return searched(nodes, facets, nodes + [aside, aside, gap])


def near_of(search, reach, forced=0):
    found = sized(_search_abi.facets_nearby)
    found.reach, found.forced = reach, forced
    assert library().ilaw_facets_near(search._handle, ctypes.byref(found)) == 0
    return found


def counts_of(search):
    found = sized(_search_abi.facets_counts)
    assert library().ilaw_facets_count(search._handle, ctypes.byref(found)) == 0
    return found


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


# ---- lists of points near by ----


def test_near_leaves_nobody_out():
    """Motions of all sizes: whoever has come within reach is in the list."""
    draw, left_out, kept = np.random.default_rng(34), 0, 0
    for scene in range(12):
        nodes, facets, own = wavy(draw, 40, 1.0, 0.01)
        above = draw.uniform([2, 2, 1.5], [4, 4, 2.5], (40, 3))
        search, position, points = searched(nodes, facets, np.vstack([own, above]))
        size, reach = 10 ** draw.uniform(-4, -2), 10 ** draw.uniform(-3, -0.5)
        for step in range(60):
            position += draw.uniform(-1, 1, 3)
            if scene % 2 == 0:
                position += size * draw.uniform(-1, 1, position.shape)
            position[points, 2] += -0.05 if step < 45 else 0.04
            search.update(position)
            nearby, far = near_of(search, reach), np.ones(len(points), bool)
            if nearby.count:
                far[np.ctypeslib.as_array((ctypes.c_int32 * nearby.count).from_address(nearby.points))] = False
            gap = search.pairs().gap[far]
            assert (gap > reach).all() and (not nearby.is_new or (gap > nearby.horizon).all())
            left_out, kept = left_out + far.sum(), kept + (not nearby.is_new)
    assert left_out > 100 and kept > 100


def test_a_common_motion_costs_nothing():
    """Two plates that fly and turn together, a thousand edges far: one list serves."""
    search, position, _ = plates(10, 0.4, 0.3)
    search.near(0.01)
    x, y, z = position.T.copy()
    for step in range(1, 101):
        c, s = np.cos(0.05 * step), np.sin(0.05 * step)
        position[:] = np.column_stack([c * x - s * z + 10 * step, y, s * x + c * z - 3 * step])
        search.update(position)
        nearby = near_of(search, 0.01)
        assert nearby.count == 0 and nearby.slack > 0.002  # less than the distance: the plate below could turn its back
    counts = counts_of(search)
    assert (counts.updates, counts.refreshes, counts.refits, counts.facets) == (101, 1, 0, 0)
    assert abs(counts.motion) <= 1e-9 and counts.shortest_edge > 0
    assert near_of(search, 0.01, forced=1).is_new == 1
    assert counts_of(search).refreshes == 2


def cost(n, gap, speed, steps=40, tremor=1e-3):
    """Facets that are looked at per point and step."""
    draw, (search, position, points) = np.random.default_rng(35), plates(n, gap, 0.3)
    for _ in range(steps):
        position[points, 0] += speed
        search.update(position + tremor * draw.uniform(-1, 1, position.shape))
        search.pairs(search.near(2 * (speed + 2 * tremor)))
    return counts_of(search).facets / (steps * len(points))


def test_cost_is_the_same_per_point_on_any_mesh():
    assert cost(20, 0.4, 0.0) == cost(80, 0.4, 0.0) == cost(80, 0.4, 0.03) == 0
    for speed in (0.0, 0.03):
        coarse, finer, fine = (cost(n, 0.0, speed) for n in (20, 40, 80))
        assert max(finer, fine) < 1.15 * coarse and fine < 4 and coarse > 0.9


def test_threads_change_no_bit():
    """The same bits and the same counts, by one thread or four."""
    found = []
    for threads in (1, 4):
        draw = np.random.default_rng(37)
        search, position, points = searched(*wavy(draw, 400, 1.0))
        shares, parts = np.array_split(np.arange(400), threads), [None] * threads
        for _ in range(20):
            position += 0.02 * draw.uniform(-1, 1, position.shape)
            search.update(position)
            team = [threading.Thread(target=lambda t=t: parts.__setitem__(t, search.pairs(shares[t])))
                    for t in range(threads)]  # fmt: skip
            for one in team:
                one.start()
            for one in team:
                one.join()
        columns = [np.concatenate([getattr(part, name) for part in parts]) for name in ("facet", "gap", "normal", "weights")]
        found.append((columns, counts_of(search).facets))
    assert all(map(np.array_equal, found[0][0], found[1][0])) and found[0][1] == found[1][1]


# ---- calls by the structs of C ----


def test_segments_in_numbers_of_fortran_and_floats():
    """An outline of three segments; points to the right of the way along them."""
    position = np.array([[0, 0], [-1, 0], [-2, 0], [-2, -1], [-0.5, 0.25], [-1, 0.5], [-2.25, 0.25], [0.5, 0],
                         [-0.5, -0.125]], np.float32)  # fmt: skip
    facets, points = np.array([[1, 2], [2, 3], [3, 4]], np.int32), np.arange(5, 10, dtype=np.int32)
    setup, given = sized(_search_abi.facets_setup), sized(_search_abi.facets_positions)
    asked, no_rim = sized(_search_abi.facets_pairs_of), np.zeros(1)
    asked.rim = _abi.input(no_rim.ctypes.data, None, 0, 0)
    setup.dimension = setup.corner_count = 2
    setup.index_base, setup.node_count, setup.facet_count, setup.point_count = 1, 9, 3, 5
    setup.facets, setup.points = facets.ctypes.data, points.ctypes.data
    setup.position = given.position = _abi.input(None, position.ctypes.data, 2, 1)
    search = ctypes.c_void_p()
    assert library().ilaw_facets_create(ctypes.byref(setup), ctypes.byref(search)) == 0
    assert library().ilaw_facets_update(search, ctypes.byref(given)) == 0
    (facet, place), (gap, approach), (normal, weights) = np.empty((2, 5), np.int32), np.empty((2, 5)), np.empty((2, 5, 2))
    asked.count, asked.facet, asked.place = 5, facet.ctypes.data, place.ctypes.data
    for name, array, stride in (("gap", gap, 1), ("approach", approach, 1), ("normal", normal, 2), ("weights", weights, 2)):
        setattr(asked, name, _abi.output(array.ctypes.data, None, stride, 1))
    assert library().ilaw_facets_pairs(search, ctypes.byref(asked)) == 0
    library().ilaw_facets_destroy(search)
    assert facet.tolist() == [0, 0, 1, 0, 0]
    assert place.tolist() == [Place.OVER, Place.OVER, Place.BESIDE, Place.BEYOND, Place.OVER]
    assert gap.tolist() == [0.25, 0.5, np.hypot(0.25, 0.25), 0.5, -0.125]
    assert approach == pytest.approx([0.25, 0.5, np.hypot(0.25, 0.25), 0.5, 0.0], abs=2e-6)  # 0: behind
    assert weights.tolist() == [[0.5, 0.5], [0, 1], [0, 1], [1, 0], [0.5, 0.5]]
    assert normal.tolist() == [[0, 1]] * 5


def test_facets_that_a_face_overlaps_are_found():
    """Faces of four points each, while the points sink through the facets and slide over them: no facet whose corners come
    close is missing, and few others are there."""
    search, position, points = plates(12, 0.3, 0.0)
    faces = np.ascontiguousarray(plate(12)[1], np.int32)
    first, found, asked = np.zeros(len(faces) + 1, np.int64), np.zeros(1, np.int32), sized(_search_abi.facets_overlaps_of)
    asked.corner_count, asked.count, asked.points, asked.distance = 4, len(faces), faces.ctypes.data, 0.05
    asked.first = first.ctypes.data

    def ask():
        asked.capacity, asked.facets = len(found), found.ctypes.data
        return library().ilaw_facets_overlaps(search._handle, ctypes.byref(asked))

    for _ in range(20):
        position[points] += [0.013, 0.007, -0.03]
        search.update(position)
        assert ask() == 0
        found = np.zeros(max(len(found), first[-1]), np.int32)
        assert ask() == 0 and first[-1] <= len(found)
        upper, lower = position[points[faces]], position[plate(12)[1]]
        apart = np.maximum(0, np.maximum(upper.min(1)[:, None] - lower.max(1), lower.min(1) - upper.max(1)[:, None]))
        close = (apart**2).sum(-1) <= 0.05**2
        for k, near in enumerate(close):
            assert set(np.flatnonzero(near)) <= set(found[first[k] : first[k + 1]])
        assert first[-1] <= 3 * close.sum() + 20  # boxes lie along the axes of the surface
    asked.capacity = -1
    assert library().ilaw_facets_overlaps(search._handle, ctypes.byref(asked)) == _abi.Code.INVALID_ARGUMENT
    faces[0, 0] = len(points)
    assert ask() == _abi.Code.INVALID_ARGUMENT


@pytest.mark.parametrize("wrong", [
    dict(struct_size=8), dict(dimension=1), dict(dimension=2), dict(corner_count=5), dict(facet_count=0), dict(facets=None),
    dict(index_base=1), dict(node_count=17), dict(point_count=-1), dict(position=_abi.input())])  # fmt: skip
def test_a_wrong_setup_is_refused(wrong):
    nodes, facets = plate(2)
    position, facets, points = np.vstack([nodes, nodes]), facets.astype(np.int32), np.arange(9, 18, dtype=np.int32)

    def create(**changed):
        setup, made = sized(_search_abi.facets_setup), ctypes.c_void_p(1)
        given = dict(dimension=3, corner_count=4, node_count=18, facet_count=4, facets=facets.ctypes.data, point_count=9,
                     points=points.ctypes.data, position=_abi.input(position.ctypes.data, None, 3, 1))  # fmt: skip
        for name, value in (given | changed).items():
            setattr(setup, name, value)
        code = library().ilaw_facets_create(ctypes.byref(setup), ctypes.byref(made))
        if code == 0:
            library().ilaw_facets_destroy(made)
        return code, made.value

    assert create()[0] == 0
    assert create(**wrong) == (_abi.Code.INVALID_ARGUMENT, None)


def test_wrong_calls_of_a_search_are_refused():
    search, _, points = plates(2, 0.0, 0.0)
    nearby, asked = sized(_search_abi.facets_nearby), sized(_search_abi.facets_pairs_of)
    outside = np.array([len(points)], np.int32)
    nearby.reach, asked.count, asked.points = np.nan, 1, outside.ctypes.data
    invalid = _abi.Code.INVALID_ARGUMENT
    assert library().ilaw_facets_create(ctypes.byref(sized(_search_abi.facets_setup)), None) == invalid
    assert library().ilaw_facets_update(search._handle, None) == invalid
    assert library().ilaw_facets_near(search._handle, ctypes.byref(nearby)) == invalid
    assert library().ilaw_facets_pairs(search._handle, ctypes.byref(asked)) == invalid
