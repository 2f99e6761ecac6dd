"""numpy arrays as the ABI takes them: an address and two strides, without a copy."""
from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _abi
from .errors import InvalidArgument

DOUBLE = np.dtype(np.float64)


def _shapes(nodes: int, components: int) -> str:
    return f"({nodes},)" if components == 1 else f"({nodes}, {components})"


def _check_memory(name: str, array: NDArray[Any]) -> None:
    if array.dtype != DOUBLE:
        raise InvalidArgument(f"{name}: array of {array.dtype}, expected float64 (astype makes one, a copy)")
    if not array.flags.aligned or any(stride % 8 for stride in array.strides):
        found = "numbers that are not at multiples of 8 bytes"
        raise InvalidArgument(f"{name}: {found}, expected a plain array of float64")


def as_array(name: str, value: Any) -> NDArray[np.float64]:
    """The array itself, or a new one for a number, a list or a tuple."""
    if isinstance(value, np.ndarray):
        _check_memory(name, value)
        return value
    try:
        return np.array(value, dtype=DOUBLE)
    except (TypeError, ValueError):
        raise InvalidArgument(f"{name}: {type(value).__name__}, expected an array or a number") from None


def read(name: str, array: NDArray[np.float64], nodes: int, components: int) -> _abi.input:
    """An input: one value per node, (nodes,) or (nodes, components), or one for all, () or (components,)."""
    if array.ndim == 2 and array.shape == (nodes, components):
        node, component = (stride // 8 for stride in array.strides)
    elif components == 1 and array.shape == (nodes,):
        node, component = array.strides[0] // 8, 0
    elif array.shape == (components,):
        node, component = 0, array.strides[0] // 8
    elif array.ndim == 0 and components == 1:
        node, component = 0, 0
    else:
        one = "a number" if components == 1 else f"({components},)"
        raise InvalidArgument(
            f"{name}: shape {array.shape}, expected {_shapes(nodes, components)}, or {one} for all nodes"
        )
    return _abi.input(array.ctypes.data, node, component)


def written(name: str, array: NDArray[np.float64], nodes: int, components: int) -> _abi.output:
    """An output: (nodes, components), writeable, each number at a place of its own."""
    if not isinstance(array, np.ndarray) or array.shape != (nodes, components):
        shape = array.shape if isinstance(array, np.ndarray) else type(array).__name__
        raise InvalidArgument(f"{name}: {shape}, expected an array of shape ({nodes}, {components})")
    _check_memory(name, array)
    if not array.flags.writeable:
        raise InvalidArgument(f"{name}: a read-only array, expected one to write to")
    if array.size and any(stride == 0 and extent > 1 for stride, extent in zip(array.strides, array.shape)):
        raise InvalidArgument(f"{name}: several nodes or components at one place, expected one place each")
    return _abi.output(array.ctypes.data, array.strides[0] // 8, array.strides[1] // 8)


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
    index = index.astype(np.int64)
    low, high = index.min(), index.max()
    if low < 0 or high >= nodes:
        wrong = low if low < 0 else high
        raise InvalidArgument(f"index: node {wrong}, expected numbers from 0 to {nodes - 1}")
    if np.bincount(index, minlength=nodes).max() > 1:
        raise InvalidArgument(f"index: node {np.bincount(index).argmax()} twice, expected each once")
    return index
