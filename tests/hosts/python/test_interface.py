"""Interfaces and batches: values against closed forms, no copies, refusals that say what is wrong. Forms of H against the
coupled solver: test_solver_machine.py."""
import gc
import pickle
import threading
import weakref

import numpy as np
import pytest

import ilaw

UP = [0.0, 0.0, 1.0]


def coulomb(**parameters):
    return ilaw.Interface("coulomb", velocity_step=1e-3, **{"friction": 0.3, **parameters})


def pressed(nodes=5, seed=1):
    """Velocities into the floor and sliding, and masses."""
    random = np.random.default_rng(seed)
    v = random.normal(size=(nodes, 3))
    v[:, 2] = -random.uniform(0.5, 2.0, nodes)
    return v, random.uniform(0.5, 3.0, nodes)


def friction_by_hand(v, m, mu):
    """Closed gap, scalar H: r_N = -m v_N, and |r_T| = min(m |v_T|, mu r_N) against v_T (Coulomb)."""
    r = np.zeros_like(v)
    r[:, 2] = -m * v[:, 2]
    speed = np.hypot(v[:, 0], v[:, 1])
    size = np.minimum(m * speed, mu * r[:, 2])
    r[:, :2] = -(size / speed)[:, None] * v[:, :2]
    return r


def on_a_plane(v, m, **changed):
    return {"v_free": v, "v_previous": v, "delassus": 1 / m, "gap": 0.0, "normal": UP, **changed}


def evaluated(v, m, law=None, **given):
    batch = (law or coulomb()).batch(**on_a_plane(v, m, **given))
    batch.initialise()
    report = batch.evaluate(time=0.1)
    assert report.bad_count == 0 and report.stable_velocity_step == np.inf
    return batch


def test_friction_is_coulombs():
    v, m = pressed(200)
    batch = evaluated(v, m, velocity=True, energy=True)
    np.testing.assert_allclose(batch.impulse, friction_by_hand(v, m, 0.3), rtol=4e-15, atol=1e-15)
    np.testing.assert_allclose(batch.velocity, v + batch.impulse / m[:, None], rtol=1e-15, atol=1e-15)
    work = np.einsum("ij,ij->i", batch.impulse, (v + batch.velocity) / 2)
    np.testing.assert_allclose(batch.energy.sum(axis=1), -work, rtol=1e-13)
    assert set(batch.status) == {ilaw.Status.STICK, ilaw.Status.SLIP}


@pytest.mark.parametrize(
    "layout",
    [
        lambda a: a.copy(),
        np.asfortranarray,
        lambda a: np.repeat(a, 2, axis=0)[::2],
        lambda a: np.hstack([a, a])[:, :3],
        lambda a: a[::-1].copy()[::-1],
        lambda a: a[:, ::-1].copy()[:, ::-1],
    ],
    ids=["rows", "columns", "every second node", "of wider rows", "backwards", "components backwards"],
)
def test_any_strides_give_the_same_bits(layout):
    v, m = pressed(33)
    wanted = evaluated(v, m).impulse
    impulse = layout(np.zeros_like(v))
    batch = evaluated(layout(v), m, impulse=impulse)
    assert batch.impulse is impulse
    assert np.array_equal(impulse, wanted)


def test_arrays_are_read_where_they_are():
    v, m = pressed()
    u = np.ones((5, 3))
    batch = evaluated(v, m, gap=u[:, 2])
    assert not batch.impulse.any()
    u[3, 2] = 0.0
    v[3, 2] = -7.0
    batch.evaluate(time=0.2)
    assert batch.impulse[3, 2] == pytest.approx(7.0 * m[3], rel=1e-15)
    assert not np.delete(batch.impulse, 3, axis=0).any()


def test_arrays_live_as_long_as_the_batch():
    v, m = pressed()
    inverse = 1 / m
    seen = weakref.ref(inverse)
    batch = coulomb().batch(v_free=v, v_previous=v, delassus=inverse, gap=0.0, normal=UP)
    del inverse
    gc.collect()
    assert seen() is not None
    batch.evaluate(time=0.1)
    del batch
    gc.collect()
    assert seen() is None


def test_one_value_serves_all_nodes():
    v, _ = pressed()
    one = evaluated(v, np.float64(2.0))
    each = evaluated(v, np.full(5, 2.0), gap=np.zeros(5), normal=np.tile(UP, (5, 1)))
    assert np.array_equal(one.impulse, each.impulse)


def test_offset_is_taken_from_the_gap():
    v, m = pressed()
    floor = np.array([0.0, 1.0, 0.0, 1.0, 0.0])
    batch = evaluated(v, m, gap=np.full(5, 0.9), gap_offset=floor)
    assert (batch.impulse[:, 2] > 0).tolist() == [False, True, False, True, False]


@pytest.mark.parametrize("index", [[4, 1], np.array([4, 1], np.int32), [False, True, False, False, True]])
def test_only_nodes_of_the_index_are_touched(index):
    v, m = pressed()
    impulse = np.full((5, 3), 9.0)
    batch = evaluated(v, m, impulse=impulse, index=index)
    wanted = friction_by_hand(v, m, 0.3)
    np.testing.assert_allclose(impulse[[1, 4]], wanted[[1, 4]], rtol=4e-15, atol=1e-15)
    assert (impulse[[0, 2, 3]] == 9.0).all()
    batch.index = [0]
    batch.evaluate(time=0.2)
    np.testing.assert_allclose(impulse[0], wanted[0], rtol=4e-15, atol=1e-15)
    batch.index = []
    assert batch.evaluate(time=0.3).bad_count == 0


def test_parameters_per_node_and_by_table():
    v, m = pressed()
    friction = np.array([0.0, 0.1, 0.2, 0.3, 5.0])
    per_node = evaluated(v, m, coulomb(friction=friction))
    np.testing.assert_allclose(per_node.impulse, friction_by_hand(v, m, friction), rtol=4e-15, atol=1e-15)
    table = coulomb(friction=[(0.0, 0.0), (0.2, 0.4)])
    np.testing.assert_allclose(evaluated(v, m, table).impulse, friction_by_hand(v, m, 0.2), rtol=1e-14, atol=1e-15)


def test_spins_and_moments():
    # At rest on the plane z = 0 but for its spin, a solid ball of M = R = 1 keeps what resistance leaves.
    form = dict(delassus="transverse_spin", velocity_step=1e-3)
    law = ilaw.Interface("rolling", friction=0.5, rolling_friction=0.1, twisting_friction=0.2, **form)
    v, w = np.array([[0.0, 0.0, -1.0]] * 2), np.array([[0.0, 0.0, 9.0], [0.0, 0.0, 0.25]])
    batch = law.batch(
        v_free=v, v_previous=v, spin_free=w, spin_previous=w, delassus=[1.0, 3.5, 2.5, 2.5, 2.5], gap=0.0,
        normal=[0.0, 0.0, 1.0], velocity=True, spin=True, energy=True,
    )
    batch.evaluate(time=0.0)
    np.testing.assert_allclose(batch.impulse, [[0, 0, 1], [0, 0, 1]], atol=1e-15)
    np.testing.assert_allclose(batch.moment, [[0, 0, -0.2], [0, 0, -0.1]], atol=1e-15)
    np.testing.assert_allclose(batch.spin, [[0, 0, 8.5], [0, 0, 0]], atol=1e-14)
    np.testing.assert_allclose(batch.energy[:, 0], [0.2 * 8.75, 0.1 * 0.125], rtol=1e-14)
    assert law.delassus_components == 5
    with pytest.raises(ilaw.InvalidArgument, match="spin_free is null"):
        law.batch(v_free=v, v_previous=v, delassus=[1.0, 3.5, 2.5, 2.5, 2.5], gap=0.0, normal=[0.0, 0.0, 1.0]).evaluate(0.0)
    with pytest.raises(ilaw.InvalidParameter, match="'rolling_friction' needs spins"):
        ilaw.Interface("rolling", friction=0.5, rolling_friction=0.1)


def test_state_goes_through_a_restart():
    def bond():
        law = ilaw.Interface("postit", dimension=1, frame="local", velocity_step=1e-3, adhesion_limit=1.0)
        return law.batch(v_free=v, v_previous=v, delassus=1.0, gap=gap, area=1.0)

    v, gap = np.array([[-1.0], [-2.0]]), np.zeros(2)
    first = bond()
    first.initialise()
    first.evaluate(time=1e-3)
    kept = pickle.loads(pickle.dumps((first.interface.state_version, first.state)))
    v[:], gap[:] = 0.5, 1e-4
    first.evaluate(time=2e-3)
    second = bond()
    assert kept[0] == second.interface.state_version
    second.state[:] = kept[1]
    second.evaluate(time=2e-3)
    assert np.array_equal(first.state, second.state) and np.array_equal(first.impulse, second.impulse)
    assert first.impulse[0, 0] < 0  # the bond holds
    assert np.shares_memory(first.variable("adhesion"), first.state)


def test_bad_nodes_are_named_and_the_others_evaluated():
    v, m = pressed()
    batch = evaluated(v, m)
    wanted = batch.impulse.copy()
    v[[1, 3]] = np.nan
    batch.impulse[:] = 0
    with pytest.raises(ilaw.BadNodes, match=r"node 1: .* \(and 1 more bad nodes\)") as refused:
        batch.evaluate(time=0.2)
    assert (refused.value.first, refused.value.count) == (1, 2)
    assert np.array_equal(np.delete(batch.impulse, [1, 3], 0), np.delete(wanted, [1, 3], 0))
    report = batch.evaluate(time=0.2, bad_nodes="report")
    assert (report.bad_count, report.first_bad_node) == (2, 1)
    assert (batch.status == ilaw.Status.BAD_INPUT).tolist() == [False, True, False, True, False]


def given(**changed):
    return on_a_plane(*pressed(), **changed)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"v_free": np.zeros((5, 2))}, r"expected \(5, 3\), or \(3,\) for all nodes: the interface has dimension 3"),
        ({"v_free": 1.0}, r"v_free: float, expected an array of shape \(nodes, 3\)"),
        ({"gap": np.zeros(4)}, r"gap: shape \(4,\), expected \(5,\), or a number for all nodes"),
        ({"gap": np.zeros(5, np.float32)}, "gap: array of float32, expected float64"),
        ({"gap": np.zeros(5, ">f8")}, "gap: array of >f8, expected float64"),
        ({"gap": "closed"}, "gap: str, expected an array or a number"),
        ({"gap": None}, "coulomb reads gap"),
        ({"normal": None}, "coulomb reads normal"),
        ({"v_previous": None}, "coulomb reads v_previous"),
        ({"impulse": np.zeros((5, 2))}, r"impulse: \(5, 2\), expected an array of shape \(5, 3\)"),
        ({"impulse": np.broadcast_to(np.zeros(3), (5, 3))}, "impulse: a read-only array"),
        ({"index": [5]}, "index: node 5, expected numbers from 0 to 4"),
        ({"index": [-1]}, "index: node -1, expected numbers from 0 to 4"),
        ({"index": [2, 1, 2]}, "index: node 2 twice"),
        ({"index": [0.5]}, "index: float64 of shape"),
    ],
)
def test_arrays_that_do_not_fit_are_refused(changed, message):
    with pytest.raises(ilaw.InvalidArgument, match=message):
        coulomb().batch(**given(**changed))


def test_outputs_do_not_overlap():
    v, m = pressed()
    with pytest.raises(ilaw.InvalidArgument, match="impulse and v_free share memory"):
        coulomb().batch(**given(v_free=v, impulse=v))
    both = np.zeros((5, 6))
    coulomb().batch(**given(impulse=both[:, ::2], velocity=both[:, 1::2]))  # interleaved, yet apart
    with pytest.raises(ilaw.InvalidArgument, match="velocity and impulse share memory"):
        coulomb().batch(**given(impulse=both[:, :3], velocity=both[:, 2:5]))


def test_unaligned_numbers_are_refused():
    packed = np.zeros(5, dtype=np.dtype([("tag", np.uint8), ("gap", np.float64)]))
    with pytest.raises(ilaw.InvalidArgument, match="gap: numbers that are not at multiples of 8 bytes"):
        coulomb().batch(**given(gap=packed["gap"]))


@pytest.mark.parametrize(
    ("parameters", "kind", "message"),
    [
        ({"friction": -1}, ilaw.InvalidParameter, r"'friction' = -1 is not allowed: expected a number in \[0, inf\]"),
        ({"frction": 1}, ilaw.InvalidParameter, "unknown parameter 'frction'"),
        ({"activation": "late"}, ilaw.InvalidParameter, "'activation'"),
        ({"friction": {}}, ilaw.InvalidArgument, "friction: dict, expected"),
        ({"friction": np.zeros((2, 3))}, ilaw.InvalidArgument, r"friction: shape \(2, 3\)"),
        ({"frame": "inertial"}, ilaw.InvalidArgument, "frame: 'inertial', expected one of: local, global"),
        ({"delassus": "dense"}, ilaw.InvalidArgument, "expected one of: scalar, diagonal, full, transverse"),
        ({"friction\0": 1}, ilaw.InvalidArgument, "has a NUL"),
        ({"dimension": 4}, ilaw.Unsupported, "4"),
        ({"dimension": 2**32 + 3}, ilaw.InvalidArgument, "dimension: 4294967299, expected a whole number"),
    ],
)
def test_parameters_are_refused_with_the_reason(parameters, kind, message):
    with pytest.raises(kind, match=message):
        coulomb(**parameters)


def test_a_step_is_needed():
    v, m = pressed()
    batch = ilaw.Interface("coulomb", friction=0.3).batch(**given())
    with pytest.raises(ilaw.InvalidArgument, match="velocity_step: missing"):
        batch.evaluate(time=0.1)
    batch.evaluate(time=0.1, velocity_step=1e-3)
    with pytest.raises(ilaw.InvalidArgument, match="velocity_step is not a finite number > 0"):
        batch.evaluate(time=0.1, velocity_step=0.0)


def test_libraries_describe_themselves():
    assert [path for path in ilaw.list() if path.endswith("/coulomb.so")]
    assert ilaw.search_path()
    law = ilaw.describe("coulomb")
    assert law.id == "coulomb" and law.dimensions == (1, 2, 3)
    assert str(law.inputs) == "gap, v_previous, area, normal, tangent, v_smooth"
    assert not law.capabilities and ilaw.describe("impact").capabilities == ilaw.Capability.STORE_ENERGY
    assert law.parameters["friction"].default is None
    assert law.parameters["activation"].default in law.parameters["activation"].choices
    plugin = ilaw.Library("coulomb").plugin()
    assert plugin.path.endswith("/coulomb.so") and plugin.laws.keys() == {"coulomb"}
    with pytest.raises(ilaw.NotFound, match="no law 'cohesive', expected one of: coulomb"):
        ilaw.describe("coulomb", "cohesive")
    with pytest.raises(ilaw.NotFound, match="no nothing.so found"):
        ilaw.Interface("nothing")
    with pytest.raises(ilaw.BadLibrary, match=__file__):
        ilaw.Interface(__file__)


def test_threads_evaluate_batches_of_one_interface():
    law = coulomb()
    v, m = pressed(1000)
    batches = [law.batch(**on_a_plane(v, m)) for _ in range(4)]
    threads = [threading.Thread(target=lambda b=b: [b.evaluate(time=t * 1e-3) for t in range(50)]) for b in batches]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(np.array_equal(batch.impulse, batches[0].impulse) for batch in batches)
    assert batches[0].impulse.any()


def test_an_empty_rank_may_call():
    empty = np.zeros((0, 3))
    batch = coulomb().batch(v_free=empty, v_previous=empty, delassus=1.0, gap=np.zeros(0), normal=UP)
    batch.initialise()
    assert batch.evaluate(time=0.1).bad_count == 0
