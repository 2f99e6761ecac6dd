"""Tables over axes, fields, amounts and floats, with the law in plain C: friction mu(slip speed, temperature)."""
import copy
import gc
import pickle

import numpy as np
import pytest

import ilaw

SPEED, HOT = np.array([0.0, 1.0, 4.0]), np.array([293.0, 593.0])
MU = np.array([[0.6, 0.3], [0.5, 0.25], [0.4, 0.2]])  # [speed, temperature]
TABLE = {"axes": {"slip_speed": SPEED, "temperature": HOT}, "values": MU}


def law(**given):
    given = {"friction": TABLE, "temperature": ilaw.PER_NODE, **given}
    return ilaw.Interface("template_c", dimension=2, frame="local", velocity_step=1.0, **given)


def mu_at(speed, temperature):
    """Linear along each axis, constant beyond its ends."""
    at_points = [np.interp(temperature, HOT, row) for row in MU]
    return np.array([np.interp(v, SPEED, column) for v, column in zip(speed, np.transpose(at_points))])


def sliding(nodes=50, numbers=np.float64):
    random = np.random.default_rng(5)
    v = np.column_stack([-random.uniform(0.1, 2, nodes), random.uniform(3, 9, nodes)]).astype(numbers)
    return v, random.uniform(0.5, 2, nodes).astype(numbers), random.uniform(200, 800, nodes).astype(numbers)


def evaluated(interface, v, h, temperature, **given):
    fields = {} if temperature is None else {"temperature": temperature}
    batch = interface.batch(v_free=v, v_previous=v, delassus=h, gap=0.0, **fields, **given)
    batch.initialise()
    batch.evaluate(time=0.0)
    return batch


def test_friction_is_that_of_the_table():
    v, h, temperature = sliding()
    batch = evaluated(law(), v, h, temperature, velocity=True)
    r_N, slip = -v[:, 0] / h, batch.velocity[:, 1]
    np.testing.assert_allclose(batch.impulse[:, 0], r_N, rtol=1e-14)
    np.testing.assert_allclose(batch.impulse[:, 1], -mu_at(slip, temperature) * r_N, rtol=1e-12)
    assert (slip > 0).all() and np.ptp(slip) > 4


def test_axes_may_stand_in_any_order():
    v, h, temperature = sliding()
    swapped = {"axes": {"temperature": HOT.tolist(), "slip_speed": SPEED.tolist()}, "values": MU.T.tolist()}
    found = evaluated(law(friction=swapped), v, h, temperature).impulse
    np.testing.assert_allclose(found, evaluated(law(), v, h, temperature).impulse, rtol=1e-14)


def test_a_field_may_be_one_number_or_a_table_in_time():
    v, h, _ = sliding()
    wanted = evaluated(law(), v, h, np.full(len(v), 443.0)).impulse
    for value in (443.0, [(-1.0, 293.0), (1.0, 593.0)]):
        assert np.array_equal(evaluated(law(temperature=value), v, h, None).impulse, wanted)
    assert np.array_equal(evaluated(law(), v, h, 443.0).impulse, wanted)


def test_a_field_is_read_where_it_is():
    v, h, temperature = sliding()
    wanted = evaluated(law(), v, h, temperature).impulse
    columns = np.zeros((len(v), 3))
    batch = evaluated(law(), v, h, columns[:, 1])
    columns[:, 1] = temperature
    batch.evaluate(time=0.0)
    assert np.array_equal(batch.impulse, wanted)


def test_an_array_at_the_interface_serves_batches_without_one():
    v, h, temperature = sliding()
    interface = law(temperature=temperature)
    assert np.array_equal(evaluated(interface, v, h, None).impulse, evaluated(law(), v, h, temperature).impulse)
    cold = evaluated(interface, v, h, np.full(len(v), 293.0))
    assert np.array_equal(cold.impulse, evaluated(law(temperature=293.0), v, h, None).impulse)


def test_amounts_are_asked_for_by_name():
    v, h, temperature = sliding()
    interface = law(partition=0.25)
    assert [one.name for one in interface.amounts] == ["heat", "counterpart_heat"]
    batch = evaluated(interface, v, h, temperature, amounts=True, energy=True, velocity=True)
    loss = -batch.impulse[:, 1] * (v[:, 1] + batch.velocity[:, 1]) / 2
    np.testing.assert_allclose(batch.amounts["heat"], 0.25 * loss, rtol=1e-12)
    np.testing.assert_allclose(batch.amounts["counterpart_heat"], 0.75 * loss, rtol=1e-12)
    np.testing.assert_allclose(sum(batch.amounts.values()), batch.energy[:, ilaw.Energy.FRICTION], rtol=1e-14)
    own = np.zeros((len(v), 2))
    for given in ({"counterpart_heat": own[:, 1]}, ["counterpart_heat"], "counterpart_heat"):
        found = evaluated(interface, v, h, temperature, amounts=given).amounts
        assert np.array_equal(found["counterpart_heat"], batch.amounts["counterpart_heat"]) and len(found) == 1
    assert np.array_equal(own[:, 1], batch.amounts["counterpart_heat"]) and not own[:, 0].any()
    assert evaluated(interface, v, h, temperature).amounts == {}


def test_floats_are_the_doubles_rounded_once():
    v, h, temperature = sliding(numbers=np.float32)
    asked = {"velocity": True, "energy": True, "amounts": True}
    floats = evaluated(law(numbers="float"), v, h, temperature, **asked)
    doubles = evaluated(law(), *(a.astype(float) for a in (v, h, temperature)), **asked)
    for name in ("impulse", "velocity", "energy"):
        assert getattr(floats, name).dtype == np.float32
        assert np.array_equal(getattr(floats, name), getattr(doubles, name).astype(np.float32)), name
    assert np.array_equal(floats.amounts["heat"], doubles.amounts["heat"].astype(np.float32))
    assert floats.state.dtype == np.float64


@pytest.mark.parametrize(
    ("call", "kind", "message"),
    [
        (lambda *a: law(friction={"axes": {}}), ilaw.InvalidArgument, "friction: dict, expected"),
        (lambda *a: law(friction={**TABLE, "values": MU.T}), ilaw.InvalidArgument,
         r"friction: values of shape \(2, 3\), expected one per point of slip_speed \(3,\), temperature \(2,\)"),
        (lambda *a: law(friction={"axes": {"speed": SPEED}, "values": SPEED}), ilaw.InvalidParameter, "'friction'"),
        (lambda *a: law(friction={"axes": {"slip_speed": -SPEED}, "values": SPEED}), ilaw.InvalidParameter,
         "'friction'"),
        (lambda *a: ilaw.Interface("template_c", friction=TABLE), ilaw.InvalidParameter, "'friction'"),
        (lambda *a: law(numbers="half"), ilaw.InvalidArgument, "numbers: 'half', expected one of: double, float"),
        (lambda *a: evaluated(law(), *a, None), ilaw.InvalidArgument, "template_c reads temperature per node"),
        (lambda *a: evaluated(law(), *a, np.ones(3)), ilaw.InvalidArgument, r"temperature: shape \(3,\)"),
        (lambda *a: evaluated(law(), *a, np.ones(50, "f")), ilaw.InvalidArgument, "temperature: array of float32"),
        (lambda *a: evaluated(law(numbers="float"), *a, 1.0), ilaw.InvalidArgument,
         "v_free: array of float64, expected float32"),
        (lambda *a: evaluated(law(temperature=300.0), *a, 1.0), ilaw.InvalidArgument, "temperature=ilaw.PER_NODE"),
        (lambda *a: evaluated(law(), *a, 1.0, humidity=1.0), ilaw.InvalidArgument, "humidity: .* one of: temperature"),
        (lambda *a: evaluated(law(), *a, 1.0, amounts="wear"), ilaw.InvalidArgument,
         "no 'wear', expected one of: heat, counterpart_heat"),
        (lambda v, h: evaluated(law(), v, h, 1.0, amounts={"heat": h}), ilaw.InvalidArgument, "heat and delassus share"),
        (lambda *a: evaluated(law(), *a, 1.0, amounts={"heat": np.ones(3)}), ilaw.InvalidArgument, "heat:"),
    ],
)  # fmt: skip
def test_calls_are_refused_with_the_reason(call, kind, message):
    v, h, _ = sliding()
    with pytest.raises(kind, match=message):
        call(v, h)


def test_the_description_names_fields_axes_and_amounts():
    described = ilaw.describe("template_c")
    assert ilaw.ParameterFlag.FIELD in described.parameters["temperature"].flags
    assert ilaw.ParameterFlag.REQUIRED in described.parameters["friction"].flags
    assert described.parameters["friction"].axes == ("slip_speed", "temperature", "time")
    assert described.parameters["partition"].axes == ()
    assert described.frames == ("local", "global") and described.numbers == ("double", "float")
    assert [(one.name, one.unit) for one in described.amounts] == [("heat", "J"), ("counterpart_heat", "J")]
    assert str(law().permissions) == str(described.permissions) == "skip_fresh, skip_free"


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy])
def test_a_copy_shares_the_instance(copied):
    """The instance lives until its last copy goes; a second destroy of it crashed."""
    v, h, temperature = sliding()
    wanted = evaluated(law(), v, h, temperature).impulse
    first = law()
    second = copied(first)
    second.velocity_step = 2.0
    assert first.velocity_step == 1.0
    del first
    gc.collect()
    assert np.array_equal(evaluated(second, v, h, temperature).impulse, wanted)
    copied(ilaw.Library("template_c")).plugin()


def test_arrays_and_instances_are_not_duplicated():
    v, h, temperature = sliding()
    interface = law()
    for duplicate in (copy.copy, copy.deepcopy, pickle.dumps):
        with pytest.raises(TypeError, match="Batch: cannot be copied or pickled"):
            duplicate(evaluated(interface, v, h, temperature))
    with pytest.raises(TypeError, match="cannot be copied or pickled"):
        pickle.dumps(interface)
