"""A law with its parameters, and batches of nodes that it is applied to."""
from __future__ import annotations

import ctypes
import enum
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Union

import numpy as np
from numpy.typing import NDArray

from . import _abi, arrays
from ._loader import loader
from ._objects import Handle, NotCopied, sized, text, whole
from .description import Amount, Law, Library, StateVariable, amounts, law_of, state_variables, texts
from .errors import BadNodes, InvalidArgument, raise_for


class _Given(enum.Enum):
    PER_NODE = "one value per node, given with every batch"


PER_NODE = _Given.PER_NODE

# The value of a parameter; see `Interface`.
Value = Union[float, str, Sequence[Sequence[float]], Mapping[str, Any], NDArray[Any], _Given]


@dataclass(frozen=True)
class Report:
    """Findings of the law besides its results.

    `stable_velocity_step` [s] is the largest at which the law, as a spring between the masses, is stable at
    every good node: infinity where it needs none, None where the library does not say.
    """

    bad_count: int
    first_bad_node: int
    reason: str
    stable_velocity_step: float | None


class _Arguments:
    """Parameters as the ABI takes them, with all that they point to."""

    def __init__(self, parameters: Mapping[str, Value], numbers: np.dtype[Any]) -> None:
        self.per_node: dict[str, NDArray[Any]] = {}
        self._numbers = numbers
        self._kept: list[Any] = []
        made = [self._argument(name, value) for name, value in parameters.items()]
        self.count = len(made)
        self.pointers = (ctypes.POINTER(_abi.argument) * self.count)(*(ctypes.pointer(one) for one in made))

    def _argument(self, name: str, value: Value) -> _abi.argument:
        made = sized(_abi.argument)
        made.name = text(name)
        if isinstance(value, str):
            made.kind, made.text = _abi.ValueKind.TEXT, text(value)
        elif value is PER_NODE:
            made.kind = _abi.ValueKind.PER_NODE
        elif isinstance(value, Mapping):
            if value.keys() != {"axes", "values"} or not isinstance(value["axes"], Mapping):
                raise InvalidArgument(f'{name}: dict, expected {{"axes": {{name: points, ...}}, "values": [...]}}')
            self._set_table(made, name, value["axes"], value["values"])
        elif isinstance(value, np.ndarray) and value.ndim == 1:
            made.kind = _abi.ValueKind.PER_NODE
            self.per_node[name] = arrays.as_array(name, value, self._numbers)
        else:
            self._set_number_or_time_table(made, name, arrays.as_array(name, value))
        return made

    def _set_number_or_time_table(self, made: _abi.argument, name: str, array: NDArray[np.float64]) -> None:
        if array.ndim == 0:
            made.kind, made.number = _abi.ValueKind.NUMBER, float(array)
        elif array.ndim == 2 and array.shape[1] == 2:
            self._set_table(made, name, {"time": array[:, 0]}, array[:, 1])
        else:
            raise InvalidArgument(
                f"{name}: shape {array.shape}, expected a number, a text, pairs (time, value), a table over axes or "
                "one value per node"
            )

    def _set_table(self, made: _abi.argument, name: str, axes: Mapping[str, Any], values: Any) -> None:
        table = self._doubles(name, values)
        points = {axis: self._doubles(f"{name}: axis {axis}", given) for axis, given in axes.items()}
        shape = tuple(len(one) if one.ndim == 1 else -1 for one in points.values())
        if table.shape != shape:
            expected = ", ".join(f"{axis} {one.shape}" for axis, one in points.items()) or "an axis"
            raise InvalidArgument(f"{name}: values of shape {table.shape}, expected one per point of {expected}")
        pointers = (ctypes.POINTER(_abi.axis) * len(points))()
        for k, (axis, one) in enumerate(points.items()):
            read = sized(_abi.axis)
            read.name, read.points, read.count = text(axis), one.ctypes.data, len(one)
            pointers[k] = ctypes.pointer(read)
        self._kept.append(pointers)
        made.kind, made.values = _abi.ValueKind.TABLE, table.ctypes.data
        made.axes, made.axis_count = pointers, len(points)

    def _doubles(self, name: str, value: Any) -> NDArray[np.float64]:
        array = np.ascontiguousarray(arrays.as_array(name, value))
        self._kept.append(array)
        return array


def _choice(kind: type[_abi.Flags], name: str, text: str) -> int:
    try:
        return kind[text.upper()]
    except (KeyError, AttributeError):
        allowed = ", ".join(str(member.name).lower() for member in kind)
        raise InvalidArgument(f"{name}: {text!r}, expected one of: {allowed}") from None


class Interface:
    """An instance of a law: its parameters, checked by the law and fixed from here on.

    library: a name along the search path ("coulomb"), the path of a library, or an open `Library`.
    law: which of the library's laws; not needed where it has one.
    dimension: 1, 2 or 3. frame: "local" (component 0 is normal) or "global" (batches give normals).
    delassus: form of the inverse mass H [1/kg]: "scalar", "diagonal", "full", "transverse" or "transverse_spin".
    numbers: "double" or "float", the type of the arrays of its batches (states are float64 always).
    velocity_step [s]: what evaluate takes unless it is told otherwise; an impulse is a force times it.
    position_step [s]: what predicted gaps take; the velocity step unless given.
    tangent: batches will give a tangent beside the normal (global frame).
    parameters: those whose names are taken by the arguments above; all others are given by name, as
      0.3                          a number, for all nodes and times
      "moreau"                     a text, for a choice
      [(0.0, 0.5), (1.0, 0.1)]     a time table: pairs (time, value)
      {"axes": {"slip_speed": [0, 1, 5], "temperature": [293, 593]}, "values": [[...], [...], [...]]}
                                   a table over one to three axes: values[i][j] at point i of the first axis and
                                   point j of the second; `Parameter.axes` names those allowed
      ilaw.PER_NODE                one value per node, given to `batch` by name (fields, such as a temperature)
      np.array([...])              the same, with the array for batches that give no other

    Raises InvalidParameter with the law's reason, Unsupported, NotFound or BadLibrary. May be used from any
    number of threads. A copy shares the instance.
    """

    def __init__(
        self,
        library: str | os.PathLike[str] | Library,
        law: str | None = None,
        *,
        dimension: int = 3,
        frame: str = "global",
        delassus: str = "scalar",
        numbers: str = "double",
        velocity_step: float | None = None,
        position_step: float | None = None,
        tangent: bool = False,
        parameters: Mapping[str, Value] | None = None,
        **named: Value,
    ) -> None:
        if not isinstance(library, Library):
            library = Library(library)
        self.dimension = whole("dimension", dimension, 0, 2**32 - 1)
        self.frame = frame
        self.delassus = delassus
        self.numbers = numbers
        self.velocity_step = velocity_step
        self.position_step = position_step
        self.tangent = tangent
        setup = sized(_abi.setup)
        setup.dimension = self.dimension
        setup.delassus_form = _choice(_abi.Delassus, "delassus", delassus)
        setup.frame = _choice(_abi.Frame, "frame", frame)
        setup.numbers = _choice(_abi.Numbers, "numbers", numbers)
        setup.has_tangent = bool(tangent)
        arguments = _Arguments({**(parameters or {}), **named}, self.dtype)
        setup.arguments, setup.argument_count = arguments.pointers, arguments.count
        handle = ctypes.c_void_p()
        message = ctypes.create_string_buffer(1024)
        law_id = text(law) if law else None
        code = loader().ilaw_interface_create(
            library.handle, law_id, ctypes.byref(setup), ctypes.byref(handle), message, len(message)
        )
        raise_for(code, message.value.decode(errors="replace"))
        self.handle = Handle(handle, loader().ilaw_interface_destroy)
        self.law: Law = law_of(loader().ilaw_interface_law(handle).contents)
        info = sized(_abi.instance_info)
        raise_for(loader().ilaw_interface_info(handle, ctypes.byref(info)), f"{self.law.id}: refuses its own instance")
        self.inputs = _abi.Input(info.inputs)
        self.balance_inputs = _abi.Input(info.balance_inputs)
        self.capabilities = _abi.Capability(info.capabilities)
        self.permissions = _abi.Permission(info.permissions)
        self.state_size = int(info.state_size)
        self.state_version = int(info.state_version)
        variables = state_variables(info.state_variables, info.state_variable_count)
        self.state_variables: tuple[StateVariable, ...] = variables
        self.amounts: tuple[Amount, ...] = amounts(info.amounts, info.amount_count)
        names = texts(info.per_node_parameters, info.per_node_parameter_count)
        # The arrays for batches that give none; None: every batch has to.
        defaults: dict[str, NDArray[Any] | None] = {name: arguments.per_node.get(name) for name in names}
        self.per_node_parameters = defaults

    def __repr__(self) -> str:
        return f"<ilaw.Interface {self.law.id}, dimension {self.dimension}, {self.frame} frame, {self.delassus} H>"

    @property
    def dtype(self) -> np.dtype[Any]:
        """Type of the arrays of batches, but the state."""
        return arrays.FLOAT if self.numbers.lower() == "float" else arrays.DOUBLE

    @property
    def delassus_components(self) -> int:
        """Numbers per node of H, in the order of ilaw.h (full, 3D: 00, 11, 22, 01, 02, 12)."""
        d = self.dimension
        full = d * (d + 1) // 2
        numbers = {"scalar": 1, "diagonal": d, "full": full, "transverse": 2, "transverse_spin": 5}
        return numbers[self.delassus.lower()]

    def batch(self, **given: Any) -> Batch:
        """Nodes that this law is applied to; see `Batch`."""
        return Batch(self, **given)


class Batch(NotCopied):
    """The arrays of a set of nodes. n is the number of nodes in them, d the dimension.

    Inputs, of the type `Interface.dtype`, read where they are at every call (so change them in place:
    `v[:] = ...`, `v += ...`):
      v_free (n, d) [m/s]      velocity without the interface, relative to the obstacle
      v_smooth (n, d) [m/s]    optional, where contacts share bodies: velocity without any impulse of the step
      delassus (n, k) [1/kg]   H: k = 1 (scalar), d, d(d+1)/2 (full), 2 (transverse) or 5 (transverse_spin)
      gap (n,) [m]             signed distance at the time of the step; positive is open
      gap_offset (n,) [m]      subtracted from the gap
      v_previous (n, d) [m/s]  velocity before the step, relative to the obstacle
      area (n,) [m^2]          tributary area
      spin_free (n, 3) [rad/s] where H has spins: spin without the interface, relative to the obstacle's
      spin_previous (n, 3)     where v_previous is read
      normal (n, d)            unit vector from the obstacle into the body; global frame
      tangent (n, d)           unit vector, orthogonal to the normal; global frame
      fields (n,)              parameters that the interface has per node, by name: temperature=T; in the mapping
                               per_node where the name is taken by another argument
    Each may be one value for all nodes instead: a number, or a vector (d,). `Interface.inputs` says which the
    law needs, `Interface.balance_inputs` which besides for energy and amounts. Numbers and lists are copied,
    arrays are not.
      index                    nodes to evaluate, a list of numbers or a mask (n,); all without. Copied; assign
                               `batch.index` to change it.
    Outputs, of the same type as (n, components), made here or given:
      impulse (n, d) [N.s]
      state (n, state_size)    float64, the memory of the interface: all that a restart needs
      velocity (n, d) [m/s]    v_free + H impulse; True or an array to have it
      moment (n, 3) [N.m.s]    where H has spins
      spin (n, 3) [rad/s]      True or an array to have it
      energy (n, 4) [J]        columns `Energy`; True or an array to have it
      amounts                  names of those to have, {name: array} of shape (n,), or True for all in
                               `Interface.amounts`; `batch.amounts["heat"]` is the array
    and status (n,), uint8, of `Status`.

    Raises InvalidArgument where an array is missing or does not fit. Calls on different batches may run in
    different threads: they release the interpreter's lock. A batch cannot be copied.
    """

    def __init__(
        self,
        interface: Interface,
        *,
        v_free: NDArray[Any],
        delassus: Any,
        v_smooth: Any = None,
        gap: Any = None,
        gap_offset: Any = None,
        v_previous: Any = None,
        area: Any = None,
        normal: Any = None,
        tangent: Any = None,
        spin_free: Any = None,
        spin_previous: Any = None,
        index: Any = None,
        impulse: NDArray[Any] | None = None,
        state: NDArray[np.float64] | None = None,
        velocity: NDArray[Any] | bool = False,
        moment: NDArray[Any] | None = None,
        spin: NDArray[Any] | bool = False,
        energy: NDArray[Any] | bool = False,
        amounts: Iterable[str] | Mapping[str, NDArray[Any]] | bool = False,
        per_node: Mapping[str, Any] | None = None,
        **fields: Any,
    ) -> None:
        d = interface.dimension
        self.interface = interface
        self._batch = sized(_abi.batch)
        if not isinstance(v_free, np.ndarray) or v_free.ndim not in (1, 2):
            raise InvalidArgument(f"v_free: {type(v_free).__name__}, expected an array of shape (nodes, {d})")
        self.node_count = len(v_free)
        self._check_dimension(v_free)
        self._inputs: dict[str, NDArray[Any]] = {}
        vectors = {"v_free": v_free, "v_smooth": v_smooth, "v_previous": v_previous}
        for name, value in {**vectors, "normal": normal, "tangent": tangent}.items():
            self._read(name, value, d)
        for name, value in {"spin_free": spin_free, "spin_previous": spin_previous}.items():
            self._read(name, value, 3)
        for name, value in {"gap": gap, "gap_offset": gap_offset, "area": area}.items():
            self._read(name, value, 1)
        self._read("delassus", delassus, interface.delassus_components)
        self._read_per_node({**(per_node or {}), **fields})
        balance = energy is not False or amounts is not False
        self._check_complete(interface.inputs | (interface.balance_inputs if balance else 0))

        self._outputs: dict[str, NDArray[Any]] = {}
        self.impulse = self._write("impulse", impulse, d)
        self.state = self._write("state", state, interface.state_size)
        self._batch.state_in = arrays.read("state", self.state, self.node_count, interface.state_size)
        self.velocity = None if velocity is False else self._write("velocity", velocity, d)
        has_spins = interface.delassus.lower() == "transverse_spin"
        self.moment = self._write("moment", moment, 3) if has_spins else None
        self.spin = self._write("spin", spin, 3) if has_spins and spin is not False else None
        self.energy = None if energy is False else self._write("energy", energy, _abi.ENERGY_COUNT)
        self.amounts = self._write_amounts(amounts)
        self.status = np.zeros(self.node_count, np.uint8)
        self._batch.status, self._batch.status_stride = self.status.ctypes.data, 1
        arrays.check_apart(self._outputs, self._inputs)
        self.index = index

    def _check_dimension(self, v_free: NDArray[Any]) -> None:
        d, columns = self.interface.dimension, v_free.shape[-1]
        if v_free.ndim == 2 and columns != d and columns in (1, 2, 3):
            raise InvalidArgument(
                f"v_free: shape {v_free.shape}, expected {(self.node_count, d)}, or {(d,)} for all nodes: "
                f"the interface has dimension {d}, see its argument dimension"
            )

    def _read(self, name: str, value: Any, components: int) -> None:
        if value is None:
            return
        array = arrays.as_array(name, value, self.interface.dtype)
        setattr(self._batch, name, arrays.read(name, array, self.node_count, components))
        self._inputs[name] = array

    def _write(self, name: str, given: Any, components: int) -> NDArray[Any]:
        numbers, shape = arrays.DOUBLE if name == "state" else self.interface.dtype, (self.node_count, components)
        array = np.zeros(shape, numbers) if given is None or given is True else given
        member = "state_out" if name == "state" else name
        setattr(self._batch, member, arrays.written(name, array, shape, numbers))
        self._outputs[name] = array
        return array

    def _write_amounts(self, wanted: Any) -> dict[str, NDArray[Any]]:
        names = [one.name for one in self.interface.amounts]
        if wanted is True:
            wanted = names
        elif wanted is False:
            wanted = ()
        elif isinstance(wanted, str):
            wanted = [wanted]
        shape, numbers = (self.node_count,), self.interface.dtype
        made: dict[str, NDArray[Any]] = {}
        pointers = (_abi.output * len(names))()
        for name in wanted:
            if name not in names:
                allowed = ", ".join(names) or "none"
                raise InvalidArgument(f"amounts: {self.interface.law.id} gives no {name!r}, expected one of: {allowed}")
            made[name] = wanted[name] if isinstance(wanted, Mapping) else np.zeros(shape, numbers)
            pointers[names.index(name)] = arrays.written(name, made[name], shape, numbers)
        if made:
            self._batch.amounts = pointers
            self._outputs.update(made)
        return made

    def _read_per_node(self, given: dict[str, Any]) -> None:
        expected, law = self.interface.per_node_parameters, self.interface.law.id
        for name in given.keys() - expected.keys():
            reason = f"{name}: {law} reads no such array, expected one of: {', '.join(expected) or 'none'}"
            if name in self.interface.law.parameters:
                reason += f"; create the interface with {name}=ilaw.PER_NODE"
            raise InvalidArgument(reason)
        made = []
        for name, default in expected.items():
            value = given.get(name, default)
            if value is None:
                raise InvalidArgument(f"{law} reads {name} per node: give it to batch()")
            array = arrays.as_array(name, value, self.interface.dtype)
            made.append(arrays.read(name, array, self.node_count, 1))
            self._inputs[name] = array
        if made:
            self._batch.per_node_parameters = (_abi.input * len(made))(*made)

    def _check_complete(self, needed: int) -> None:
        for member in _abi.Input:
            name = member.name.lower()
            if needed & member & ~_abi.Input.V_SMOOTH and name not in self._inputs:
                raise InvalidArgument(f"{self.interface.law.id} reads {name}: give it to batch()")

    @property
    def index(self) -> NDArray[np.int64] | None:
        """Nodes that initialise and evaluate work on; None: all."""
        return self._index

    @index.setter
    def index(self, value: Any) -> None:
        self._index = None if value is None else arrays.as_index(value, self.node_count)
        self._batch.index64 = None if value is None else self._index.ctypes.data
        self._batch.node_count = self.node_count if value is None else len(self._index)

    def variable(self, name: str) -> NDArray[np.float64]:
        """A variable of the state, (n, count): a view into `state`."""
        for variable in self.interface.state_variables:
            if variable.name == name:
                return self.state[:, variable.start : variable.start + variable.count]
        names = ", ".join(variable.name for variable in self.interface.state_variables) or "none"
        raise InvalidArgument(f"{self.interface.law.id} has no state variable {name!r}, expected one of: {names}")

    def initialise(self, time: float = 0.0) -> None:
        """Writes the first state of the nodes. Not to be called on restart."""
        self._batch.time = time
        self._call(loader().ilaw_interface_initialise, bad_nodes="raise")

    def evaluate(
        self,
        time: float,
        velocity_step: float | None = None,
        position_step: float | None = None,
        bad_nodes: str = "raise",
    ) -> Report:
        """One step: reads the inputs, writes impulse, state, status and what else was asked for.

        time [s]: of the configuration that the gaps belong to. Steps [s]: those of the interface unless given.
        bad_nodes: "raise" raises BadNodes where a node has bad input (after all others were evaluated),
        "report" says so in the report and in the status alone.
        """
        if bad_nodes not in ("raise", "report"):
            raise InvalidArgument(f"bad_nodes: {bad_nodes!r}, expected 'raise' or 'report'")
        step = velocity_step if velocity_step is not None else self.interface.velocity_step
        if step is None:
            raise InvalidArgument("velocity_step: missing, give it to evaluate() or to the interface")
        if position_step is None:
            position_step = self.interface.position_step if velocity_step is None else None
        self._batch.time = time
        self._batch.velocity_step = step
        self._batch.position_step = step if position_step is None else position_step
        return self._call(loader().ilaw_interface_evaluate, bad_nodes)

    def _call(self, function: Any, bad_nodes: str) -> Report:
        report = sized(_abi.report)
        code = function(self.interface.handle, ctypes.byref(self._batch), ctypes.byref(report))
        reason = report.reason.decode(errors="replace") if report.reason else ""
        if code == _abi.Code.BAD_NODES:
            if bad_nodes == "raise":
                raise BadNodes(report.first_bad_node, report.bad_count, reason)
        else:
            raise_for(code, f"{self.interface.law.id}: {reason}")
        return Report(report.bad_count, report.first_bad_node, reason, report.stable_velocity_step or None)
