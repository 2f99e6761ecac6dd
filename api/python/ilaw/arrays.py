"""numpy arrays as the ABI takes them: an address and two strides, without a copy."""
from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _abi
from .errors import InvalidArgument

DOUBLE = np.dtype(np.float64)
FLOAT = np.dtype(np.float32)


def _shapes(nodes: int, components: int) -> str:
    return f"({nodes},)" if components == 1 else f"({nodes}, {components})"


def _check_memory(name: str, array: NDArray[Any], numbers: np.dtype[Any]) -> None:
    if array.dtype != numbers:
        raise InvalidArgument(f"{name}: array of {array.dtype}, expected {numbers} (astype makes one, a copy)")
    if not array.flags.aligned or any(stride % numbers.itemsize for stride in array.strides):
        found = f"numbers that are not at multiples of {numbers.itemsize} bytes"
        raise InvalidArgument(f"{name}: {found}, expected a plain array of {numbers}")


def as_array(name: str, value: Any, numbers: np.dtype[Any] = DOUBLE) -> NDArray[Any]:
    """The array itself, or a new one for a number, a list or a tuple."""
    if isinstance(value, np.ndarray):
        _check_memory(name, value, numbers)
        return value
    try:
        return np.array(value, dtype=numbers)
    except (TypeError, ValueError):
        raise InvalidArgument(f"{name}: {type(value).__name__}, expected an array or a number") from None


def _at(struct: type[Any], array: NDArray[Any], node_stride: int, component_stride: int) -> Any:
    """An input or output of the array: `values` of doubles, or `floats`. Strides in bytes."""
    pointer = "values" if array.dtype == DOUBLE else "floats"
    size = array.itemsize
    strides = {"node_stride": node_stride // size, "component_stride": component_stride // size}
    return struct(**{pointer: array.ctypes.data}, **strides)


def read(name: str, array: NDArray[Any], nodes: int, components: int) -> _abi.input:
    """An input: one value per node, (nodes,) or (nodes, components), or one for all, () or (components,)."""
    if array.ndim == 2 and array.shape == (nodes, components):
        node, component = array.strides
    elif components == 1 and array.shape == (nodes,):
        node, component = array.strides[0], 0
    elif array.shape == (components,):
        node, component = 0, array.strides[0]
    elif array.ndim == 0 and components == 1:
        node, component = 0, 0
    else:
        one = "a number" if components == 1 else f"({components},)"
        raise InvalidArgument(
            f"{name}: shape {array.shape}, expected {_shapes(nodes, components)}, or {one} for all nodes"
        )
    return _at(_abi.input, array, node, component)


def written(name: str, array: Any, shape: tuple[int, ...], numbers: np.dtype[Any] = DOUBLE) -> _abi.output:
    """An output: of shape (nodes, components) or (nodes,), writeable, each number at a place of its own."""
    if not isinstance(array, np.ndarray) or array.shape != shape:
        found = array.shape if isinstance(array, np.ndarray) else type(array).__name__
        raise InvalidArgument(f"{name}: {found}, expected an array of shape {shape}")
    _check_memory(name, array, numbers)
    if not array.flags.writeable:
        raise InvalidArgument(f"{name}: a read-only array, expected one to write to")
    if array.size and any(stride == 0 and extent > 1 for stride, extent in zip(array.strides, array.shape)):
        raise InvalidArgument(f"{name}: several nodes or components at one place, expected one place each")
    return _at(_abi.output, array, array.strides[0], array.strides[1] if len(shape) == 2 else 0)


def check_apart(outputs: dict[str, NDArray[Any]], inputs: dict[str, NDArray[Any]]) -> None:
    """Outputs may overlap neither inputs nor each other."""
    earlier = dict(inputs)
    for name, array in outputs.items():
        for other, read_too in earlier.items():
            try:
                overlap = np.shares_memory(array, read_too, max_work=10_000)
            except np.TooHardError:
                overlap = True
            if overlap:
                raise InvalidArgument(f"{name} and {other} share memory, expected arrays of their own")
        earlier[name] = array


def as_index(value: Any, nodes: int) -> NDArray[np.int64]:
    """A checked copy of a list of nodes: numbers below `nodes`, each once."""
    index = np.array(value)
    if index.dtype == bool and index.shape == (nodes,):
        index = np.flatnonzero(index)
    if index.size == 0:
        return np.empty(0, np.int64)
    if index.ndim != 1 or not np.issubdtype(index.dtype, np.integer):
        raise InvalidArgument(f"index: {index.dtype} of shape {index.shape}, expected a list of node numbers")
    low, high = int(index.min()), int(index.max())
    if low < 0 or high >= nodes:
        wrong = low if low < 0 else high
        raise InvalidArgument(f"index: node {wrong}, expected numbers from 0 to {nodes - 1}")
    index = index.astype(np.int64)
    if np.bincount(index, minlength=nodes).max() > 1:
        raise InvalidArgument(f"index: node {np.bincount(index).argmax()} twice, expected each once")
    return index


def as_bodies(name: str, value: Any, count: int) -> NDArray[np.int32]:
    """Numbers of bodies, int32 and contiguous: the array itself where it is that, else a checked copy."""
    array = np.ascontiguousarray(value)
    if array.shape != (count,) or (count and not np.issubdtype(array.dtype, np.integer)):
        raise InvalidArgument(f"{name}: {array.dtype} of shape {array.shape}, expected {count} numbers of bodies")
    limits = np.iinfo(np.int32)
    for number in (int(array.min()), int(array.max())) if count else ():
        if not limits.min <= number <= limits.max:
            raise InvalidArgument(f"{name}: body {number}, expected numbers up to {limits.max}")
    return array.astype(np.int32, copy=False)
