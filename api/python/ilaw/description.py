"""Descriptions of libraries and laws."""
from __future__ import annotations

import builtins
import ctypes
import os
from dataclasses import dataclass, field

from . import _abi
from ._loader import loader
from ._objects import Handle, text
from .errors import NotFound, raise_for


@dataclass(frozen=True)
class Parameter:
    """A parameter of a law. `default` is None where the parameter must be given.

    axes: names over which it may be a table; none: never a table. A parameter with ParameterFlag.FIELD is a
    field of the host's model, such as a temperature: give it per node where there is one.
    """

    name: str
    symbol: str
    unit: str
    doc: str
    kind: _abi.ParameterKind
    default: float | str | None
    minimum: float
    maximum: float
    flags: _abi.ParameterFlag
    axes: tuple[str, ...] = ()
    choices: tuple[str, ...] = ()


@dataclass(frozen=True)
class StateVariable:
    """A part of a node's state: `count` numbers from place `start` on."""

    name: str
    unit: str
    doc: str
    kind: int
    start: int
    count: int
    internal: bool


@dataclass(frozen=True)
class Amount:
    """A scalar that a law gives per node and step, such as the heat of friction [J]; 0 where nothing happened."""

    name: str
    unit: str
    doc: str


@dataclass(frozen=True)
class Law:
    """A law as its library describes it. State variables are those of dimension 3 and default parameters."""

    id: str
    title: str
    doc: str
    dimensions: tuple[int, ...]
    delassus: tuple[str, ...]
    frames: tuple[str, ...]
    numbers: tuple[str, ...]
    inputs: _abi.Input
    outputs: _abi.Output
    capabilities: _abi.Capability
    permissions: _abi.Permission
    references: tuple[str, ...]
    parameters: dict[str, Parameter] = field(repr=False)
    state_variables: tuple[StateVariable, ...] = field(repr=False)
    amounts: tuple[Amount, ...] = field(repr=False)


@dataclass(frozen=True)
class Plugin:
    """A library of laws."""

    name: str
    version: str
    vendor: str
    licence: str
    path: str
    abi: tuple[int, int]
    laws: dict[str, Law] = field(repr=False)


class Library:
    """An open library; closed with the object (interfaces made from it keep it loaded)."""

    def __init__(self, name_or_path: str | os.PathLike[str]) -> None:
        handle = ctypes.c_void_p()
        message = ctypes.create_string_buffer(1024)
        code = loader().ilaw_library_open(text(name_or_path), ctypes.byref(handle), message, len(message))
        raise_for(code, message.value.decode(errors="replace"))
        self.handle = Handle(handle, loader().ilaw_library_close)

    def plugin(self) -> Plugin:
        """The library's description."""
        read = loader().ilaw_library_plugin(self.handle).contents
        laws = [law_of(read.laws[i].contents) for i in range(read.law_count)]
        return Plugin(
            name=read.name.decode(),
            version=read.version.decode(),
            vendor=read.vendor.decode(),
            licence=read.licence.decode(),
            path=os.fsdecode(loader().ilaw_library_path(self.handle)),
            abi=(read.abi_major, read.abi_minor),
            laws={law.id: law for law in laws},
        )


def _names(mask: int, kinds: type[_abi.Flags]) -> tuple[str, ...]:
    return tuple(str(one.name).lower() for one in kinds if mask & one)


def texts(read: ctypes._Pointer, count: int) -> tuple[str, ...]:
    """The texts of an array of pointers."""
    return tuple(read[i].decode() for i in range(count))


def _parameter(read: _abi.parameter) -> Parameter:
    choices = texts(read.choices, read.choice_count)
    default: float | str | None = None
    if not read.flags & _abi.ParameterFlag.REQUIRED:
        default = choices[int(read.default_value)] if choices else read.default_value
    return Parameter(
        name=read.name.decode(),
        symbol=read.symbol.decode(),
        unit=read.unit.decode(),
        doc=read.doc.decode(),
        kind=_abi.ParameterKind(read.kind),
        default=default,
        minimum=read.minimum,
        maximum=read.maximum,
        flags=_abi.ParameterFlag(read.flags),
        axes=texts(read.axes, read.axis_count),
        choices=choices,
    )


def state_variables(read: ctypes._Pointer, count: int) -> tuple[StateVariable, ...]:
    """The variables of a law or an instance, with their places in the state."""
    made, start = [], 0
    for i in range(count):
        variable = read[i].contents
        made.append(
            StateVariable(
                name=variable.name.decode(),
                unit=variable.unit.decode(),
                doc=variable.doc.decode(),
                kind=variable.kind,
                start=start,
                count=variable.count,
                internal=bool(variable.flags & _abi.VariableFlag.INTERNAL),
            )
        )
        start += variable.count
    return tuple(made)


def amounts(read: ctypes._Pointer, count: int) -> tuple[Amount, ...]:
    """The amounts of a law or an instance, in its order."""
    found = [read[i].contents for i in range(count)]
    return tuple(Amount(one.name.decode(), one.unit.decode(), one.doc.decode()) for one in found)


def law_of(read: _abi.law) -> Law:
    parameters = [_parameter(read.parameters[i].contents) for i in range(read.parameter_count)]
    return Law(
        id=read.id.decode(),
        title=read.title.decode(),
        doc=read.doc.decode(),
        dimensions=tuple(d for d in (1, 2, 3) if read.dimensions & 1 << d),
        delassus=_names(read.delassus_forms, _abi.Delassus),
        frames=_names(read.frames, _abi.Frame),
        numbers=_names(read.numbers, _abi.Numbers),
        inputs=_abi.Input(read.inputs),
        outputs=_abi.Output(read.outputs),
        capabilities=_abi.Capability(read.capabilities),
        permissions=_abi.Permission(read.permissions),
        references=texts(read.references, read.reference_count),
        parameters={parameter.name: parameter for parameter in parameters},
        state_variables=state_variables(read.state_variables, read.state_variable_count),
        amounts=amounts(read.amounts, read.amount_count),
    )


def search_path() -> list[str]:
    """The folders in which a library's name is looked up, in order."""
    size = loader().ilaw_search_path(None, 0)
    buffer = ctypes.create_string_buffer(size)
    loader().ilaw_search_path(buffer, size)
    return [folder for folder in os.fsdecode(buffer.value).split(":") if folder]


def list() -> list[str]:  # noqa: A001 - `ilaw.list()` is what users look for
    """Paths of the libraries on the search path. None of them is opened."""
    found: builtins.list[str] = []

    @_abi.SIGNATURES["ilaw_search"][1][0]
    def visit(path: bytes, _context: int | None) -> int:
        found.append(os.fsdecode(path))
        return 0

    raise_for(loader().ilaw_search(visit, None), "out of memory")
    return found


def describe(name_or_path: str | os.PathLike[str], law: str | None = None) -> Law:
    """The description of a law: of the library's only one, or of the one called `law`."""
    plugin = Library(name_or_path).plugin()
    if law is None and len(plugin.laws) == 1:
        return next(iter(plugin.laws.values()))
    if law not in plugin.laws:
        raise NotFound(f"{plugin.path}: no law {law!r}, expected one of: {', '.join(plugin.laws)}")
    return plugin.laws[law]
