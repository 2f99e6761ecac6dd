"""Contacts that share bodies, solved together: grains in a pile, pieces tied to each other, a node in a corner.

    from ilaw.coupled import Bodies, Contacts, Solver

    law = ilaw.Interface("coulomb", delassus="full", velocity_step=h, friction=0.3)
    solver = Solver()
    for n in range(steps):
        ...                                   # v and w are the velocities and spins without contact now
        bodies = Bodies(v_free=v, spin_free=w, v_previous=v0, spin_previous=w0, inverse_mass=1 / m,
                        inverse_inertia=1 / inertia, velocity=v, spin=w)
        contacts = Contacts(law, body=i, counterpart=j, gap=gap, normal=normal, arm=-r_i * normal,
                            counterpart_arm=r_j * normal, impulse=impulse, state=state)
        solver.solve(bodies, [contacts], time=(n + 1) * h)

What it does, and the method, is in ilaw/coupled.h and docs/hosts/coupled.md.
"""
from __future__ import annotations

import ctypes
import functools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from . import _abi, _coupled_abi, arrays
from ._loader import loader, open_library
from ._objects import Handle, NotCopied, sized, whole
from .errors import BadNodes, InvalidArgument, raise_for
from .interface import Interface

Method = _coupled_abi.Method

__all__ = ["Bodies", "Contacts", "Exchange", "Method", "Report", "Solver"]


@functools.cache
def library() -> ctypes.CDLL:
    """The functions of coupled contacts, with their types. Calls release the interpreter's lock."""
    return open_library("libilaw_coupled.so.1", "ILAW_COUPLED", _coupled_abi.SIGNATURES)


@dataclass(frozen=True)
class Report:
    """Findings of a solve.

    sweeps: iterations. residual: largest change of a contact's velocity by its own impulse in the last iteration,
    relative to first_speed [m/s], the largest velocity that the problem brings. speed [m/s]: largest velocity of a
    contact, before or by an impulse, in the last iteration. work [J]: of all impulses, with the velocities that came
    out. energy (4,) [J]: sums of the columns `Energy`. bad_*: contacts with bad input, -1: none.
    stable_velocity_step [s]: as of `ilaw.Report`, with masses divided among contacts. method: of the last iteration.
    stalled: the residual is above the tolerance and falls no more. worst_*: contact with the largest residual, -1:
    none. opposed: ids of two laws that push against each other without end. energy_error [J]: largest difference
    of work and energies. message: what is not solved, as a sentence; empty: nothing. All of this rank, but sweeps, residual,
    method and stalled.
    """

    sweeps: int
    residual: float
    work: float
    energy: NDArray[np.float64]
    bad_count: int
    bad_group: int
    bad_contact: int
    reason: str
    stable_velocity_step: float
    method: Method
    stalled: bool
    worst_group: int
    worst_contact: int
    opposed: tuple[str, str] | None
    energy_error: float
    message: str
    speed: float
    first_speed: float


class Exchange(Protocol):
    """How ranks agree: arrays come in with what this rank has, and are changed in place. All ranks solve together."""

    def sum_bodies(self, values: NDArray[np.float64]) -> None:
        """(bodies, components): the sums over the contacts of this rank become those over all ranks."""

    def largest(self, values: NDArray[np.float64]) -> None:
        """(count,): each becomes the largest over all ranks."""

    def sum(self, values: NDArray[np.float64]) -> None:
        """(count,): each becomes the sum over all ranks."""


class _Arrays:
    """Arrays in a struct of the ABI, which are kept alive with it."""

    def __init__(self, struct: ctypes.Structure, count: int) -> None:
        self.struct, self.count = struct, count
        self.inputs: dict[str, NDArray[np.float64]] = {}
        self.outputs: dict[str, NDArray[np.float64]] = {}

    def read(self, name: str, value: Any, components: int, struct: ctypes.Structure | None = None) -> None:
        if value is None:
            return
        array = arrays.as_array(name, value)
        setattr(struct or self.struct, name, arrays.read(name, array, self.count, components))
        self.inputs[name] = array

    def write(self, name: str, given: Any, components: int, member: str | None = None) -> NDArray[np.float64] | None:
        if given is False:
            return None
        array = np.zeros((self.count, components)) if given is None or given is True else given
        setattr(self.struct, member or name, arrays.written(name, array, (self.count, components)))
        self.outputs[name] = array
        return array


class Bodies(NotCopied):
    """Bodies that contacts name: grains, or nodes of a mesh. n is their number, d the dimension (that of v_free).

    Inputs, float64, read where they are by every solve:
      v_free (n, d) [m/s]             velocity without contacts
      inverse_mass (n,) or (n, d) [1/kg]      0: immovable, along this axis
      v_previous (n, d) [m/s]         velocity before the step, for laws that read it
      spin_free, spin_previous (n, 3) [1/s]   angular velocities, where bodies rotate (d = 3)
      inverse_inertia (n, 6) [1/(kg m^2)]     xx yy zz xy xz yz in the axes of all arrays, or (n,): spheres
    inverse_mass and inverse_inertia may be one value for all bodies.
      owned                           number of bodies, the first ones, that this rank owns; all without ranks
      id (n,)                         global numbers of the bodies, in whose order contacts are visited
    Outputs, made here or given: velocity (n, d) and spin (n, 3), which may be the arrays of v_free and spin_free;
    impulse (n, d) [N.s] and angular_impulse (n, 3) [N.m.s], sums over contacts: True or an array to have them. The
    moments of contacts are part of angular_impulse.
    """

    def __init__(
        self,
        *,
        v_free: NDArray[np.float64],
        inverse_mass: Any,
        v_previous: NDArray[np.float64] | None = None,
        spin_free: NDArray[np.float64] | None = None,
        spin_previous: NDArray[np.float64] | None = None,
        inverse_inertia: Any = None,
        owned: int | None = None,
        id: Any = None,
        velocity: NDArray[np.float64] | None = None,
        spin: NDArray[np.float64] | None = None,
        impulse: NDArray[np.float64] | bool = False,
        angular_impulse: NDArray[np.float64] | bool = False,
    ) -> None:
        if not isinstance(v_free, np.ndarray) or v_free.ndim != 2:
            raise InvalidArgument(f"v_free: {type(v_free).__name__}, expected an array of shape (bodies, dimension)")
        count, d = v_free.shape
        self._struct = sized(_coupled_abi.bodies)
        self._struct.dimension, self._struct.count = d, count
        self._struct.owned_count = count if owned is None else whole("owned", owned, 0, count)
        self.count, self.dimension = count, d
        made = self._arrays = _Arrays(self._struct, count)
        made.read("v_free", v_free, d)
        per_axis = isinstance(inverse_mass, np.ndarray) and inverse_mass.shape == (count, d) and d > 1
        made.read("inverse_mass", inverse_mass, d if per_axis else 1)
        if not per_axis:
            self._struct.inverse_mass.component_stride = 0
        if id is not None:
            self._id = np.ascontiguousarray(id, np.int64)
            if self._id.shape != (count,):
                raise InvalidArgument(f"id: shape {self._id.shape}, expected ({count},)")
            self._struct.id = self._id.ctypes.data
        made.read("v_previous", v_previous, d)
        self.rotate = inverse_inertia is not None
        if not self.rotate and (spin_free is not None or spin is not None):
            raise InvalidArgument("inverse_inertia: missing, bodies with a spin have one")
        if self.rotate:
            self._read_rotation(inverse_inertia, spin_free, spin_previous)
            self.spin = made.write("spin", spin, 3)
            self.angular_impulse = made.write("angular_impulse", angular_impulse, 3)
        self.velocity = made.write("velocity", velocity, d)
        self.impulse = made.write("impulse", impulse, d)
        self._check_apart()

    def _read_rotation(self, inverse_inertia: Any, spin_free: Any, spin_previous: Any) -> None:
        made = self._arrays
        inertia = arrays.as_array("inverse_inertia", inverse_inertia)
        six = inertia.shape[-1:] == (6,) and inertia.shape != (self.count,)
        made.read("inverse_inertia", inertia, 6 if six else 1)
        if spin_free is None:
            raise InvalidArgument("spin_free: missing, bodies with an inertia have a spin")
        made.read("spin_free", spin_free, 3)
        made.read("spin_previous", spin_previous, 3)

    def _check_apart(self) -> None:
        inputs, outputs = dict(self._arrays.inputs), dict(self._arrays.outputs)
        for result, free in (("velocity", "v_free"), ("spin", "spin_free")):
            if result in outputs and outputs[result] is inputs[free]:
                del inputs[free]  # in place
        arrays.check_apart(outputs, inputs)


def _entries(bodies: Any) -> int:
    """Bodies on a side of each contact."""
    shape = np.shape(bodies)
    return shape[1] if len(shape) == 2 else 1


class Contacts(NotCopied):
    """The contacts that have one law. k is their number, d the dimension.

    law: an `Interface` for the global frame, with delassus "full" where bodies rotate, "transverse" for spheres whose
                                    arms are along the normal, "transverse_spin" for these with moments, else "scalar"
    body (k,), counterpart (k,)     numbers of bodies: the normal points from the counterpart into the body; a
                                    counterpart -1 is a wall. int32 is taken where it is
    gap (k,) [m], normal (k, d), gap_offset, area, tangent: as of `ilaw.Batch`
    arm, counterpart_arm (k, 3) [m] from the centre of each of the two to the contact, where bodies rotate
    wall_velocity, wall_previous (k, d) [m/s]   subtracted from the contact's velocity: of walls and belts, the mean
                                    over this step and the one before
    wall_spin, wall_spin_previous (k, 3) [1/s]  where H has spins: subtracted from the contact's spin, which is that
                                    of the body less that of the counterpart
    body (k, b), counterpart (k, c) with body_weight (k, b), counterpart_weight (k, c): weighted sets of bodies, such
                                    as facets; -1: no body. Weights (k, b, d, d) are matrices, of nodes with axes
                                    of their own
    Outputs, made here or given: impulse (k, d) [N.s], which the sweeps also begin with: leave there what the last
    step left, and zero at new contacts; moment (k, 3) [N.m.s] likewise, where H has spins: it acts on the body, its
    opposite on the counterpart; state (k, state_size); energy (k, 4) [J]: True or an array to have it; status (k,),
    uint8.
    """

    def __init__(
        self,
        law: Interface,
        *,
        body: Any,
        counterpart: Any,
        normal: Any = None,
        gap: Any = None,
        gap_offset: Any = None,
        area: Any = None,
        tangent: Any = None,
        arm: Any = None,
        counterpart_arm: Any = None,
        wall_velocity: Any = None,
        wall_previous: Any = None,
        wall_spin: Any = None,
        wall_spin_previous: Any = None,
        body_weight: Any = None,
        counterpart_weight: Any = None,
        impulse: NDArray[np.float64] | None = None,
        moment: NDArray[np.float64] | None = None,
        state: NDArray[np.float64] | None = None,
        energy: NDArray[np.float64] | bool = False,
    ) -> None:
        if law.frame != "global":
            raise InvalidArgument(f"frame: {law.frame!r}, coupled contacts expect an interface for the global frame")
        if law.numbers != "double":
            raise InvalidArgument(f"numbers: {law.numbers!r}, coupled contacts expect an interface of doubles")
        if law.per_node_parameters:
            raise InvalidArgument(f"{next(iter(law.per_node_parameters))}: one value per node, expected one for all")
        d, count = law.dimension, len(body)
        self.law, self.count = law, count
        self._sides = [_entries(body), _entries(counterpart)]
        self.body = arrays.as_bodies("body", np.ravel(body), count * self._sides[0]) if self._sides[0] > 1 else (
            arrays.as_bodies("body", body, count))
        self.counterpart = arrays.as_bodies("counterpart", np.ravel(counterpart), count * self._sides[1]) if (
            self._sides[1] > 1) else arrays.as_bodies("counterpart", counterpart, count)
        self._batch = sized(_abi.batch)
        self._batch.node_count = count
        made = self._arrays = _Arrays(self._batch, count)
        for name, value in {"normal": normal, "tangent": tangent}.items():
            made.read(name, value, d)
        for name, value in {"gap": gap, "gap_offset": gap_offset, "area": area}.items():
            made.read(name, value, 1)
        self._check_complete(law.inputs | (law.balance_inputs if energy is not False else 0))
        self._struct = self._describe()
        for name, value in {"arm": arm, "counterpart_arm": counterpart_arm}.items():
            made.read(name, value, 3, self._struct)
        weights = {"body_weight": body_weight, "counterpart_weight": counterpart_weight}
        for (name, value), entries in zip(weights.items(), self._sides):
            if np.ndim(value) == 4:
                self._struct.weight_size = d * d
                value, entries = np.reshape(value, (count, -1)), entries * d * d
            made.read(name, value, entries, self._struct)
        for name, value in {"wall_velocity": wall_velocity, "wall_previous": wall_previous}.items():
            made.read(name, value, d, self._struct)
        for name, value in {"wall_spin": wall_spin, "wall_spin_previous": wall_spin_previous}.items():
            made.read(name, value, 3, self._struct)
        self.impulse = made.write("impulse", impulse, d)
        has_spins = law.delassus.lower() == "transverse_spin"
        self.moment = made.write("moment", moment, 3) if has_spins else None
        self.state = made.write("state", state, law.state_size, "state_out")
        self._batch.state_in = arrays.read("state", self.state, count, law.state_size)
        self.energy = made.write("energy", energy, _abi.ENERGY_COUNT)
        self.status = np.zeros(count, np.uint8)
        self._batch.status, self._batch.status_stride = self.status.ctypes.data, 1
        arrays.check_apart(made.outputs, made.inputs)

    def _describe(self) -> _coupled_abi.contacts:
        made, law = sized(_coupled_abi.contacts), self.law
        made.delassus_form = _abi.Delassus[law.delassus.upper()]
        made.law = loader().ilaw_interface_law(law.handle)
        made.instance = loader().ilaw_interface_instance(law.handle)
        made.batch = ctypes.pointer(self._batch)
        made.body, made.counterpart = self.body.ctypes.data, self.counterpart.ctypes.data
        made.body_count, made.counterpart_count = self._sides
        return made

    def _check_complete(self, needed: int) -> None:
        for member in (_abi.Input.GAP, _abi.Input.AREA, _abi.Input.NORMAL, _abi.Input.TANGENT):
            name = member.name.lower()
            if needed & member and name not in self._arrays.inputs:
                raise InvalidArgument(f"{self.law.law.id} reads {name}: give it to Contacts()")

    def initialise(self, index: Any = None, time: float = 0.0) -> None:
        """Writes the first state of contacts: of those in `index` (numbers or a mask), or of all."""
        chosen = np.arange(self.count) if index is None else arrays.as_index(index, self.count)
        part = _abi.batch.from_buffer_copy(self._batch)
        part.time, part.node_count, part.index64 = time, len(chosen), chosen.ctypes.data
        report = sized(_abi.report)
        code = loader().ilaw_interface_initialise(self.law.handle, ctypes.byref(part), ctypes.byref(report))
        raise_for(code, f"{self.law.law.id}: {(report.reason or b'').decode(errors='replace')}")


class _Calls:
    """An Exchange as three functions of C. What it raises is kept until the solve is over."""

    def __init__(self, exchange: Exchange, bodies: int) -> None:
        self.raised: BaseException | None = None
        self.struct = sized(_coupled_abi.exchange)
        sum_bodies, reduce = _coupled_abi.sum_bodies_function, _coupled_abi.reduce_function
        self.struct.sum_bodies = self._call(sum_bodies, exchange.sum_bodies, lambda components: (bodies, components))
        self.struct.largest = self._call(reduce, exchange.largest, lambda count: (count,))
        self.struct.sum = self._call(reduce, exchange.sum, lambda count: (count,))

    def _call(self, kind: Any, function: Any, shape: Any) -> Any:
        def call(_context: Any, values: Any, count: int) -> None:
            try:
                if self.raised is None:
                    extent = shape(count)
                    size = int(np.prod(extent))
                    function(np.ctypeslib.as_array(values, (size,)).reshape(extent) if size else np.zeros(extent))
            except BaseException as raised:  # C cannot pass it on
                self.raised = raised

        return kind(call)


class Solver(NotCopied):
    """Solves steps; keeps work arrays from one to the next. One solve at a time, different solvers are independent."""

    def __init__(self) -> None:
        handle = library().ilaw_coupled_create()
        if not handle:
            raise MemoryError
        self._handle = Handle(ctypes.c_void_p(handle), library().ilaw_coupled_destroy)

    def solve(
        self,
        bodies: Bodies,
        groups: Sequence[Contacts],
        time: float,
        velocity_step: float | None = None,
        position_step: float | None = None,
        *,
        most_sweeps: int = 1000,
        tolerance: float = 1e-10,
        speed: float = 0.0,
        rounding: float = 0.0,
        threads: int = 1,
        exchange: Exchange | None = None,
        bad_nodes: str = "raise",
    ) -> Report:
        """One step: impulses, states and status of all contacts, velocities of the bodies.

        groups: contacts of one law each, all at the same bodies. time [s]: of the configuration that gaps belong
        to. Steps [s]: those of each interface unless given. tolerance: of the residual; reaching most_sweeps is
        no error, look at the residual. speed [m/s]: the residual is relative to no smaller velocity. rounding
        [m/s]: a residual below it that iterations no longer lower counts as solved. threads: for some thousands
        of contacts and more; the same bits for any number. bad_nodes: "raise" raises BadNodes (after all others
        were solved), "report" says so in the report and the status alone.
        """
        if bad_nodes not in ("raise", "report"):
            raise InvalidArgument(f"bad_nodes: {bad_nodes!r}, expected 'raise' or 'report'")
        for group in groups:
            step = velocity_step if velocity_step is not None else group.law.velocity_step
            if step is None:
                raise InvalidArgument("velocity_step: missing, give it to solve() or to the interface")
            ahead = position_step if position_step is not None or velocity_step is not None else group.law.position_step
            group._batch.time, group._batch.velocity_step = time, step
            group._batch.position_step = step if ahead is None else ahead
            if group.law.dimension != bodies.dimension:
                raise InvalidArgument(f"dimension: {group.law.dimension} of contacts, {bodies.dimension} of bodies")
        pointers = (ctypes.POINTER(_coupled_abi.contacts) * len(groups))(*(ctypes.pointer(g._struct) for g in groups))
        options = sized(_coupled_abi.coupled_options)
        options.most_sweeps, options.tolerance = whole("most_sweeps", most_sweeps, 0, 2**32 - 1), tolerance
        options.speed, options.rounding = speed, rounding
        options.threads = whole("threads", threads, 0, 256)
        calls = None
        if exchange is not None:
            calls = _Calls(exchange, bodies.count)
            options.exchange = ctypes.pointer(calls.struct)
        report = sized(_coupled_abi.coupled_report)
        code = library().ilaw_coupled_solve(
            self._handle,
            ctypes.byref(bodies._struct),
            pointers,
            len(groups),
            ctypes.byref(options),
            ctypes.byref(report),
        )
        if calls is not None and calls.raised is not None:
            raise calls.raised
        return self._report(code, report, bad_nodes)

    @staticmethod
    def _report(code: int, report: _coupled_abi.coupled_report, bad_nodes: str) -> Report:
        reason = report.reason.decode(errors="replace") if report.reason else ""
        if code == _abi.Code.BAD_NODES:
            if bad_nodes == "raise":
                raise BadNodes(report.bad_contact, report.bad_count, f"group {report.bad_group}: {reason}")
        else:
            raise_for(code, f"coupled contacts: {reason}")
        return Report(
            report.sweeps,
            report.residual,
            report.work,
            np.array(report.energy),
            report.bad_count,
            report.bad_group,
            report.bad_contact,
            reason,
            report.stable_velocity_step,
            Method(report.method),
            bool(report.stalled),
            report.worst_group,
            report.worst_contact,
            (report.law.decode(), report.other_law.decode()) if report.law and report.other_law else None,
            report.energy_error,
            report.message.decode(errors="replace") if report.message else "",
            report.speed,
            report.first_speed,
        )
