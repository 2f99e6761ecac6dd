"""A law with its parameters, and batches of nodes that it is applied to."""
from __future__ import annotations

import ctypes
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Union

import numpy as np
from numpy.typing import NDArray

from . import _abi, arrays
from ._loader import loader
from .description import Law, Library, StateVariable, law_of, state_variables
from .errors import BadNodes, InvalidArgument, raise_for

# A number, a text (of a choice), pairs (time, value) for a table, an array of shape (nodes,) for one per node.
Value = Union[float, str, Sequence[Sequence[float]], NDArray[np.float64]]


@dataclass(frozen=True)
class Report:
    """What the law said besides its results.

    `stable_velocity_step` [s] is the largest at which the law, as a spring between the masses, is stable at
    every good node: infinity where it needs none, None where the library does not say.
    """

    bad_count: int
    first_bad_node: int
    reason: str
    stable_velocity_step: float | None


class _Arguments:
    """Parameters as the ABI takes them, with all that they point to."""

    def __init__(self, parameters: Mapping[str, Value]) -> None:
        self.per_node: dict[str, NDArray[np.float64]] = {}
        self._kept: list[Any] = []
        made = [self._argument(name, value) for name, value in parameters.items()]
        self.count = len(made)
        self.pointers = (ctypes.POINTER(_abi.argument) * self.count)(*(ctypes.pointer(one) for one in made))

    def _argument(self, name: str, value: Value) -> _abi.argument:
        made = _abi.sized(_abi.argument)
        made.name = name.encode()
        if isinstance(value, str):
            made.kind, made.text = _abi.ValueKind.TEXT, value.encode()
            return made
        array = arrays.as_array(name, value)
        if array.ndim == 0:
            made.kind, made.number = _abi.ValueKind.NUMBER, float(array)
        elif array.ndim == 1 and isinstance(value, np.ndarray):
            made.kind = _abi.ValueKind.PER_NODE
            self.per_node[name] = array
        elif array.ndim == 2 and array.shape[1] == 2:
            table = np.ascontiguousarray(array)
            self._kept.append(table)
            made.kind, made.count = _abi.ValueKind.TABLE, len(table)
            made.values = table.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
        else:
            raise InvalidArgument(
                f"{name}: shape {array.shape}, expected a number, a text, pairs (time, value) or one value per node"
            )
        return made


def _choice(kind: type, name: str, text: str) -> int:
    try:
        return kind[text.upper()]
    except (KeyError, AttributeError):
        allowed = ", ".join(member.name.lower() for member in kind)
        raise InvalidArgument(f"{name}: {text!r}, expected one of: {allowed}") from None


class Interface:
    """An instance of a law: its parameters, checked by the law and fixed from here on.

    library: a name along the search path ("coulomb"), the path of a library, or an open `Library`.
    law: which of the library's laws; not needed where it has one.
    dimension: 1, 2 or 3. frame: "local" (component 0 is normal) or "global" (batches give normals).
    delassus: form of the inverse mass H [1/kg]: "scalar", "diagonal", "full" or "transverse".
    velocity_step [s]: what evaluate takes unless it is told otherwise; an impulse is a force times it.
    position_step [s]: what predicted gaps take; the velocity step unless given.
    tangent: batches will give a tangent beside the normal (global frame).
    parameters: those whose names are taken by the arguments above; all others are given by name.

    Raises InvalidParameter with the law's reason, Unsupported, NotFound or BadLibrary. May be used from any
    number of threads.
    """

    def __init__(
        self,
        library: str | os.PathLike[str] | Library,
        law: str | None = None,
        *,
        dimension: int = 3,
        frame: str = "global",
        delassus: str = "scalar",
        velocity_step: float | None = None,
        position_step: float | None = None,
        tangent: bool = False,
        parameters: Mapping[str, Value] | None = None,
        **named: Value,
    ) -> None:
        if not isinstance(library, Library):
            library = Library(library)
        self.dimension = dimension
        self.frame = frame
        self.delassus = delassus
        self.velocity_step = velocity_step
        self.position_step = position_step
        self.tangent = tangent
        self._arguments = _Arguments({**(parameters or {}), **named})
        setup = _abi.sized(_abi.setup)
        setup.dimension = dimension
        setup.delassus_form = _choice(_abi.Delassus, "delassus", delassus)
        setup.frame = _choice(_abi.Frame, "frame", frame)
        setup.tangent_given = tangent
        setup.arguments, setup.argument_count = self._arguments.pointers, self._arguments.count
        handle = ctypes.c_void_p()
        message = ctypes.create_string_buffer(1024)
        law_id = law.encode() if law else None
        code = loader().ilaw_interface_create(
            library.handle, law_id, ctypes.byref(setup), ctypes.byref(handle), message, len(message)
        )
        raise_for(code, message.value.decode(errors="replace"))
        self.handle = handle
        self.law: Law = law_of(loader().ilaw_interface_law(handle).contents)
        info = _abi.sized(_abi.instance_info)
        raise_for(loader().ilaw_interface_info(handle, ctypes.byref(info)), f"{self.law.id}: refuses its own instance")
        self.inputs = _abi.Input(info.inputs)
        self.energy_inputs = _abi.Input(info.energy_inputs)
        self.capabilities = _abi.Capability(info.capabilities)
        self.state_size = int(info.state_size)
        self.state_version = int(info.state_version)
        variables = state_variables(info.state_variables, info.state_variable_count)
        self.state_variables: tuple[StateVariable, ...] = variables
        names = [info.per_node_parameters[i].decode() for i in range(info.per_node_parameter_count)]
        self.per_node_parameters = {name: self._arguments.per_node[name] for name in names}

    def __del__(self) -> None:
        if getattr(self, "handle", None):
            loader().ilaw_interface_destroy(self.handle)

    def __repr__(self) -> str:
        return f"<ilaw.Interface {self.law.id}, dimension {self.dimension}, {self.frame} frame, {self.delassus} H>"

    @property
    def delassus_components(self) -> int:
        """Numbers per node of H, in the order of ilaw.h (full, 3D: 00, 11, 22, 01, 02, 12)."""
        d = self.dimension
        return {"scalar": 1, "diagonal": d, "full": d * (d + 1) // 2, "transverse": 2}[self.delassus]

    def batch(self, **given: Any) -> Batch:
        """Nodes that this law is applied to; see `Batch`."""
        return Batch(self, **given)


class Batch:
    """The arrays of a set of nodes. n is the number of nodes in them, d the dimension.

    Inputs, float64, read where they are at every call (so change them in place: `v[:] = ...`, `v += ...`):
      v_free (n, d) [m/s]      velocity without the interface, relative to the obstacle
      delassus (n, k) [1/kg]   H: k = 1 (scalar), d, d(d+1)/2 (full) or 2 (transverse)
      gap (n,) [m]             signed distance at the time of the step; positive is open
      gap_offset (n,) [m]      subtracted from the gap
      v_previous (n, d) [m/s]  velocity before the step, relative to the obstacle
      area (n,) [m^2]          tributary area
      normal (n, d)            unit vector from the obstacle into the body; global frame
      tangent (n, d)           unit vector, orthogonal to the normal; global frame
    Each may be one value for all nodes instead: a number, or a vector (d,). `Interface.inputs` says which the
    law needs. Numbers and lists are copied, arrays are not.
      index                    nodes to evaluate, a list of numbers or a mask (n,); all without. Copied; assign
                               `batch.index` to change it.
    Outputs, float64 as (n, components), made here or given:
      impulse (n, d) [N.s]
      state (n, state_size)    the memory of the interface: all that a restart needs
      velocity (n, d) [m/s]    v_free + H impulse; True or an array to have it
      energy (n, 4) [J]        columns `Energy`; True or an array to have it
    and status (n,), uint8, of `Status`.

    Raises InvalidArgument where an array is missing or does not fit. Calls on different batches may run in
    different threads: they release the interpreter's lock.
    """

    def __init__(
        self,
        interface: Interface,
        *,
        v_free: NDArray[np.float64],
        delassus: Any,
        gap: Any = None,
        gap_offset: Any = None,
        v_previous: Any = None,
        area: Any = None,
        normal: Any = None,
        tangent: Any = None,
        index: Any = None,
        impulse: NDArray[np.float64] | None = None,
        state: NDArray[np.float64] | None = None,
        velocity: NDArray[np.float64] | bool = False,
        energy: NDArray[np.float64] | bool = False,
    ) -> None:
        d = interface.dimension
        self.interface = interface
        self._batch = _abi.sized(_abi.batch)
        if not isinstance(v_free, np.ndarray) or v_free.ndim not in (1, 2):
            raise InvalidArgument(f"v_free: {type(v_free).__name__}, expected an array of shape (nodes, {d})")
        self.node_count = len(v_free)
        self._inputs: dict[str, NDArray[np.float64]] = {}
        vectors = {"v_free": v_free, "v_previous": v_previous, "normal": normal, "tangent": tangent}
        for name, value in vectors.items():
            self._read(name, value, d)
        for name, value in {"gap": gap, "gap_offset": gap_offset, "area": area}.items():
            self._read(name, value, 1)
        self._read("delassus", delassus, interface.delassus_components)
        self._read_per_node_parameters()
        self._check_complete(interface.inputs | (interface.energy_inputs if energy is not False else 0))

        self._outputs: dict[str, NDArray[np.float64]] = {}
        self.impulse = self._write("impulse", impulse, d)
        self.state = self._write("state", state, interface.state_size)
        self._batch.state_in = arrays.read("state", self.state, self.node_count, interface.state_size)
        self.velocity = None if velocity is False else self._write("velocity", velocity, d)
        self.energy = None if energy is False else self._write("energy", energy, _abi.ENERGY_COUNT)
        self.status = np.zeros(self.node_count, np.uint8)
        self._batch.status, self._batch.status_stride = self.status.ctypes.data, 1
        arrays.check_apart(self._outputs, self._inputs)
        self.index = index

    def _read(self, name: str, value: Any, components: int) -> None:
        if value is None:
            return
        array = arrays.as_array(name, value)
        setattr(self._batch, name, arrays.read(name, array, self.node_count, components))
        self._inputs[name] = array

    def _write(self, name: str, given: Any, components: int) -> NDArray[np.float64]:
        array = np.zeros((self.node_count, components)) if given is None or given is True else given
        member = "state_out" if name == "state" else name
        setattr(self._batch, member, arrays.written(name, array, self.node_count, components))
        self._outputs[name] = array
        return array

    def _read_per_node_parameters(self) -> None:
        values = self.interface.per_node_parameters
        made = [arrays.read(name, array, self.node_count, 1) for name, array in values.items()]
        if made:
            self._batch.per_node_parameters = (_abi.input * len(made))(*made)
        self._inputs.update(values)

    def _check_complete(self, needed: int) -> None:
        for member in _abi.Input:
            name = member.name.lower()
            if needed & member and name not in self._inputs:
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
        report = _abi.sized(_abi.report)
        code = function(self.interface.handle, ctypes.byref(self._batch), ctypes.byref(report))
        reason = report.reason.decode(errors="replace") if report.reason else ""
        if code == _abi.Code.BAD_NODES:
            if bad_nodes == "raise":
                raise BadNodes(report.first_bad_node, report.bad_count, reason)
        else:
            raise_for(code, f"{self.interface.law.id}: {reason}")
        return Report(report.bad_count, report.first_bad_node, reason, report.stable_velocity_step or None)
