"""Calls of ilaw/coupled.h that are wrong, empty, or of unusual layouts, by the structs of C."""
import copy
import ctypes

import numpy as np
import pytest

import ilaw
from ilaw import _abi, _coupled_abi, coupled
from ilaw._objects import sized
from ilaw.coupled import Bodies, Contacts, Solver

H, G, RADIUS = 1e-3, 10.0, 0.5
INVALID = _abi.Code.INVALID_ARGUMENT
FORM = _abi.Delassus


def cube(law="tie", form="full", **parameters):
    """27 spheres in a cube, one against the next along the axes, with any velocities and spins."""
    number, draw = np.arange(27), np.random.default_rng(1)
    pairs = [(k, k - step, axis) for axis, step in enumerate((1, 3, 9)) for k in number if k // step % 3]
    body, counterpart, axis = np.array(pairs).T
    normal = np.eye(3)[axis]
    v, w = draw.uniform(-1, 1, (2, 27, 3))
    inertia = np.array([5.0, 5.0, 5.0, 0, 0, 0]) if form == "full" else 5.0
    bodies = Bodies(v_free=v, v_previous=0 * v, spin_free=w, spin_previous=0 * w, inverse_mass=0.5, inverse_inertia=inertia,
                    velocity=v, spin=w, impulse=True, angular_impulse=True)  # fmt: skip
    interface = ilaw.Interface(law, delassus=form, velocity_step=H, **parameters)
    contacts = Contacts(interface, body=body, counterpart=counterpart, gap=0.0, normal=normal, area=1.0, arm=-RADIUS * normal,
                        counterpart_arm=RADIUS * normal, energy=True)  # fmt: skip
    contacts.initialise()
    contacts._batch.time = contacts._batch.velocity_step = contacts._batch.position_step = H
    return bodies, contacts


class Call:
    """Copies of the structs of a call, to be spoilt."""

    def __init__(self, bodies, contacts):
        self.bodies, self.contacts = copied(bodies._struct), copied(contacts._struct)
        self.batch, self.options = copied(contacts._batch), sized(_coupled_abi.coupled_options)
        self.law = copied(self.contacts.law[0])
        self.contacts.batch, self.options.most_sweeps = ctypes.pointer(self.batch), 1000
        self.groups, self.report = [self.contacts], sized(_coupled_abi.coupled_report)

    def solve(self):
        pointer = ctypes.POINTER(_coupled_abi.contacts)
        groups = (pointer * len(self.groups))(*(ctypes.pointer(group) if group else pointer() for group in self.groups))
        solver = ctypes.c_void_p(coupled.library().ilaw_coupled_create())
        code = coupled.library().ilaw_coupled_solve(
            solver, ctypes.byref(self.bodies), groups, len(self.groups), ctypes.byref(self.options), ctypes.byref(self.report))
        coupled.library().ilaw_coupled_destroy(solver)
        return code

    def set(self, path, value):
        """A member by its path, and None for an array that is missing."""
        *parts, name = path.split(".")
        struct = self
        for part in parts:
            struct = getattr(struct, part)
        if value is None:
            value = type(getattr(struct, name))()
        setattr(struct, name, value)


def copied(struct):
    return type(struct).from_buffer_copy(struct)


def expect_refused(call, group, reason, outputs, code=INVALID):
    """Nothing is written. group: 0 where the group is refused, -1 where bodies or options are."""
    before = copy.deepcopy(outputs)
    assert (call.solve(), call.report.reason.decode(), call.report.bad_group) == (code, reason, group)
    assert code != INVALID or all(map(np.array_equal, outputs, before))


def outputs_of(bodies, contacts):
    return [bodies.velocity, bodies.spin, bodies.impulse, contacts.impulse, contacts.state, contacts.energy]


NUMBERS = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
BAD = np.array([np.nan, np.inf, -1.0])
FLOATS = np.zeros(9, np.float32)
INDEX = np.zeros(1, np.int32)


def at(array, node=0, component=0, first=0):
    return _abi.input(array[first:].ctypes.data, None, node, component)


STRETCHED = "has one component per {} (component stride 0), expected a ({},n) array"
OF_BODIES = [
    ("bodies are missing, or their struct_size is wrong", {"bodies.struct_size": 8}),
    ("dimension is not 1, 2 or 3", {"bodies.dimension": 0}),
    ("dimension is not 1, 2 or 3", {"bodies.dimension": 4}),
    ("counts of bodies are wrong", {"bodies.owned_count": -1}),
    ("counts of bodies are wrong", {"bodies.count": 26}),
    ("count is above 2^31 - 2", {"bodies.count": 1 << 60}),
    ("an output of bodies overlaps itself", {"bodies.velocity.node_stride": 0}),
    ("inverse_mass or v_free is missing", {"bodies.inverse_mass": None}),
    ("inverse_mass or v_free is missing", {"bodies.v_free": None}),
    ("v_free or v_previous " + STRETCHED.format("body", "d"), {"bodies.v_free.component_stride": 0}),
    ("v_free or v_previous " + STRETCHED.format("body", "d"), {"bodies.v_previous.component_stride": 0}),
    ("spin_free or spin_previous " + STRETCHED.format("body", "3"), {"bodies.spin_free.component_stride": 0}),
    ("bodies rotate in dimension 3 alone", {"bodies.dimension": 2}),
    ("spin_free is missing", {"bodies.spin_free": None}),
    ("spin_previous is missing", {"bodies.spin_previous": None}),
    ("threads is above 256", {"options.threads": 4294967295}),
    *((f"{path[8:]} is below 0 or not finite", {path: x})
      for path in ("options.tolerance", "options.speed", "options.rounding") for x in BAD),
    *((f"an {name} of bodies is below 0 or not finite", {f"bodies.{name}": at(BAD, first=k)})
      for name in ("inverse_mass", "inverse_inertia") for k in range(3)),
]  # fmt: skip
ARM, BATCH = "bodies rotate, and an arm is missing", "a batch is missing, or its struct_size is wrong"
PASSES, BODY = "node_count is above 2^31 - 2", "body or counterpart is missing"
LAW, STATE = "law or instance is null", "state_in or state_out is missing"
OF_CONTACTS = [
    ("the struct_size of contacts is not that of any version", {"contacts.struct_size": 8}),
    (BATCH, {"contacts.batch": ctypes.POINTER(_abi.batch)()}),
    (LAW, {"contacts.law": ctypes.POINTER(_abi.law)()}), (LAW, {"contacts.instance": 0}),
    ("delassus_form is neither scalar, transverse, transverse_spin nor full", {"contacts.delassus_form": FORM.DIAGONAL}),
    ("node_count is negative", {"batch.node_count": -1}), (PASSES, {"batch.node_count": 1 << 60}),
    ("impulse overlaps itself", {"batch.impulse.node_stride": 0}),
    ("energy overlaps itself", {"batch.energy.component_stride": 0}),
    ("status_stride is 0", {"batch.status_stride": 0}),
    ("contacts have no list of nodes", {"batch.index": INDEX.ctypes.data}),
    (BODY, {"contacts.body": 0}), (BODY, {"contacts.counterpart": 0}), ("impulse is missing", {"batch.impulse": None}),
    ("normal or tangent " + STRETCHED.format("contact", "d"), {"batch.normal.component_stride": 0}),
    ("the law reads v_previous, which the bodies do not have", {"bodies.v_previous": None}),
    ("bodies rotate, so delassus_form has to be transverse or full", {"contacts.delassus_form": FORM.SCALAR}),
    (ARM, {"contacts.arm": None}), (ARM, {"contacts.counterpart_arm": None}),
    ("delassus_form is transverse, and bodies are no spheres", {"contacts.delassus_form": FORM.TRANSVERSE}),
    ("delassus_form is transverse, and the normal is missing",
     {"contacts.delassus_form": FORM.TRANSVERSE, "bodies.inverse_inertia.component_stride": 0, "batch.normal": None}),
    ("delassus_form has spins, which the law does not serve",
     {"contacts.delassus_form": FORM.TRANSVERSE_SPIN, "batch.moment": 1}),
    *(("a weight is not finite", {"contacts.body_weight": at(BAD, first=k)}) for k in range(2)),
]  # fmt: skip
SPINS = "delassus_form has spins"
OF_SPINS = [
    (SPINS + ", and moment is missing", {"batch.moment": None}), ("moment overlaps itself", {"batch.moment.node_stride": 0}),
    (SPINS + "; expected one body on either side, without weights", {"contacts.body_weight": at(NUMBERS)}),
    (SPINS + ", and bodies do not rotate: inverse_inertia is missing", {"bodies.inverse_inertia": None}),
    ("delassus_form is transverse, and bodies are no spheres", {"bodies.inverse_inertia": at(NUMBERS, 0, 1)}),
    ("delassus_form is transverse, and bodies have masses per axis", {"bodies.inverse_mass": at(NUMBERS, 0, 1)}),
]  # fmt: skip
MEMBERS = {"bodies": "inverse_mass inverse_inertia v_free spin_free v_previous spin_previous velocity spin impulse "
                     "angular_impulse",
           "contacts": "arm counterpart_arm wall_velocity wall_previous body_weight counterpart_weight wall_spin "
                       "wall_spin_previous",
           "batch": "gap gap_offset area normal tangent state_in state_out impulse moment energy"}  # fmt: skip


@pytest.mark.parametrize(("group", "reason", "wrong"), [
    *((-1, *row) for row in OF_BODIES), *((0, *row) for row in OF_CONTACTS)])  # fmt: skip
def test_a_wrong_member_is_named(group, reason, wrong):
    scene = cube()
    call = Call(*scene)
    for path, value in wrong.items():
        call.set(path, call.batch.impulse if path == "batch.moment" and value == 1 else value)
    expect_refused(call, group, reason, outputs_of(*scene))


@pytest.mark.parametrize(("reason", "wrong"), OF_SPINS)
def test_a_wrong_member_of_spins_is_named(reason, wrong):
    scene = cube("rolling", "transverse_spin", friction=0.4, rolling_friction=0.025, twisting_friction=0.01)
    call = Call(*scene)
    for path, value in wrong.items():
        call.set(path, value)
    expect_refused(call, 0, reason, outputs_of(*scene))


def test_an_arm_aside_of_the_normal_is_refused():
    bodies, contacts = cube("coulomb", "transverse", friction=0.3)
    contacts._arrays.inputs["arm"][0, 1] += 1e-3
    reason = "delassus_form is transverse, and an arm is not along the normal"
    expect_refused(Call(bodies, contacts), 0, reason, outputs_of(bodies, contacts))


@pytest.mark.parametrize("path", [f"{part}.{name}" for part, names in MEMBERS.items() for name in names.split()])
def test_floats_are_refused(path):
    """In place of an array of doubles one of floats, which has no values."""
    scene = cube()
    call, (part, name) = Call(*scene), path.split(".")
    array = getattr(getattr(call, part), name)
    array.values, array.floats = None, FLOATS.ctypes.data
    of, group = (" of bodies", -1) if part == "bodies" else ("", 0)
    expect_refused(call, group, f"{name}{of} has floats; expected doubles", outputs_of(*scene))


def test_lists_of_a_batch_are_checked():
    """Their lengths are what the instance says."""
    scene = cube("coulomb", friction=0.3)
    varying = ilaw.Interface("coulomb", delassus="full", velocity_step=H, friction=0.3, kinetic_friction=ilaw.PER_NODE)
    floats, shared = _abi.input(None, FLOATS.ctypes.data, 1, 0), _abi.output(NUMBERS.ctypes.data, None, 0, 0)
    for name, instance, value, reason in (
        ("per_node_parameters", varying, floats, "an array of per_node_parameters has floats; expected doubles"),
        ("amounts", None, _abi.output(None, FLOATS.ctypes.data, 1, 0), "an array of amounts has floats; expected doubles"),
        ("amounts", None, shared, "an array of amounts overlaps itself"),
    ):
        call = Call(*scene)
        if instance:
            call.contacts.instance = ilaw._loader.loader().ilaw_interface_instance(instance.handle)
        listed = (type(value) * 8)(*[value if instance else type(value)(), value])
        setattr(call.batch, name, listed)
        expect_refused(call, 0, reason, outputs_of(*scene))


def test_bodies_that_cannot_meet_are_refused():
    bodies, contacts = cube()
    for other, reason in ((27, "a contact names a body that is not there"),
                          (contacts.body[-1], "a contact of a body with itself")):  # fmt: skip
        call, counterpart = Call(bodies, contacts), contacts.counterpart.copy()
        counterpart[-1] = other
        call.contacts.counterpart = counterpart.ctypes.data
        expect_refused(call, 0, reason, outputs_of(bodies, contacts))


def test_arrays_that_share_memory_are_refused():
    scene = cube()
    impulse = scene[1].impulse
    for path, value, reason in (
        ("bodies.velocity", _abi.output(impulse.ctypes.data, None, 3, 1), "two outputs are one array"),
        ("bodies.v_free", at(impulse.ravel(), 3, 1), "an output of contacts is an input of bodies"),
        ("bodies.impulse", _abi.output(impulse.ctypes.data + 8, None, 1, 1), "an output of bodies overlaps itself"),
    ):
        call = Call(*scene)
        call.set(path, value)
        expect_refused(call, -1, reason, outputs_of(*scene))


def test_a_second_group_is_checked_before_the_first_is_written():
    scene, other = cube(), cube()
    second = Call(*other)
    second.law.outputs &= ~_abi.Output.ENERGY
    second.contacts.law = ctypes.pointer(second.law)
    for group, reason in ((second.contacts, "energies are asked for, which the law does not give"),
                          ("same", "a group is given twice"), (None, "a group is null")):  # fmt: skip
        call = Call(*scene)
        call.groups.append(call.contacts if group == "same" else group)
        expect_refused(call, 1, reason, outputs_of(*scene))


@pytest.mark.parametrize("step", [np.nan, -1.0])
def test_a_stable_step_that_makes_no_sense_is_refused(step):
    """It would pass for none at all."""
    scene = cube()
    call = Call(*scene)

    def evaluate(_instance, _batch, report):
        report[0].stable_velocity_step = step
        return 0

    call.law.evaluate = type(call.law.evaluate)(evaluate)
    call.contacts.law = ctypes.pointer(call.law)
    reason = "a law reported a stable step that is below 0 or not a number"
    expect_refused(call, 0, reason, outputs_of(*scene), _abi.Code.BAD_LIBRARY)


def test_an_exchange_that_makes_no_sense_is_refused():
    scene = cube()
    call, given = Call(*scene), sized(_coupled_abi.exchange)
    given.sum_bodies = _coupled_abi.sum_bodies_function(lambda *_: None)  # the others are missing
    call.options.exchange = ctypes.pointer(given)
    expect_refused(call, -1, "a function of the exchange is null", outputs_of(*scene))

    class NoNumber:
        def sum_bodies(self, values):
            pass

        sum = sum_bodies

        def largest(self, values):
            if len(values) == 4:
                values[0] = np.nan

    with pytest.raises(ilaw.Error, match="a function of the exchange returned a value that is not a number"):
        Solver().solve(scene[0], [scene[1]], time=H, exchange=NoNumber())


def test_calls_of_nothing():
    bodies, contacts = cube()
    solve, call = coupled.library().ilaw_coupled_solve, Call(bodies, contacts)
    solver, report = ctypes.c_void_p(coupled.library().ilaw_coupled_create()), _coupled_abi.coupled_report()
    empty = call.options
    empty.struct_size = 0
    here = ctypes.byref(call.bodies)
    assert solve(None, here, None, 0, None, None) == INVALID
    assert solve(solver, here, None, 0, None, ctypes.byref(report)) == INVALID  # without its size
    assert solve(solver, here, None, 0, ctypes.byref(empty), None) == INVALID
    report.struct_size = ctypes.sizeof(report)
    assert solve(solver, here, None, 1, None, ctypes.byref(report)) == INVALID and report.reason == b"groups are missing"
    before = bodies.velocity.copy()
    assert solve(solver, here, None, 0, None, ctypes.byref(report)) == 0
    assert np.array_equal(bodies.velocity, before)  # bodies that touch nothing
    coupled.library().ilaw_coupled_destroy(solver)


def test_a_history_has_any_layout():
    """Four variables, read by component and written by contact, backwards with places left between."""
    found = []
    for by_component in (False, True):
        bodies, contacts = cube("penalty", stiffness=1e4, tangential_stiffness=3e3, friction=0.3)
        gap = np.full(contacts.count, 0.0)
        contacts._arrays.read("gap", gap, 1)
        for _ in range(3):
            Solver().solve(bodies, [contacts], time=H)
            gap -= 1e-3
        count, size = contacts.state.shape
        assert size >= 3
        state, apart = np.asfortranarray(contacts.state), np.full((count, 2 * size + 1), 7.0)
        if by_component:
            contacts._batch.state_in = at(state.T.ravel(), 1, count)
            contacts._batch.state_out = _abi.output(apart.ctypes.data + 16 * size, None, 2 * size + 1, -2)
        Solver().solve(bodies, [contacts], time=H)
        found.append((bodies.velocity, contacts.impulse, apart[:, :0:-2] if by_component else contacts.state))
        assert (apart[:, 1::2] == 7.0).all() and (apart[:, 0] == 7.0).all()
    assert all(map(np.array_equal, *found))


def test_a_velocity_that_is_no_number_is_bad_input():
    bodies, contacts = cube()
    bodies.velocity[0, 0] = np.nan
    report = Solver().solve(bodies, [contacts], time=H, bad_nodes="report")
    assert report.bad_count > 0 and np.isfinite(report.work)


@pytest.mark.parametrize("dimension", [1, 2])
@pytest.mark.parametrize("form", ["scalar", "full"])
def test_points_that_are_tied_move_as_one(dimension, form):
    """In the plane and on a line, with the velocity of their centre of mass."""
    v = np.array([[1.0, -0.5], [-2.0, 0.25]])[:, :dimension].copy()
    bodies = Bodies(v_free=v, v_previous=0 * v, inverse_mass=np.array([1 / 2, 1 / 3]))
    tie = ilaw.Interface("tie", dimension=dimension, delassus=form, velocity_step=H)
    contact = Contacts(tie, body=[0], counterpart=[1], gap=0.0, area=1.0, normal=np.eye(dimension)[0])
    contact.initialise()
    Solver().solve(bodies, [contact], time=H)
    np.testing.assert_allclose(bodies.velocity, [[-0.8, -0.05][:dimension]] * 2, atol=1e-12)
