"""Objects and structs of C: their sizes, their life, their copies."""
from __future__ import annotations

import ctypes
import operator
import os
from collections.abc import Callable
from typing import Any, TypeVar

from .errors import InvalidArgument

Struct = TypeVar("Struct", bound=ctypes.Structure)


def sized(struct: type[Struct]) -> Struct:
    """A zeroed struct with its size set."""
    made = struct()
    made.struct_size = ctypes.sizeof(struct)
    return made


def whole(name: str, value: Any, low: int, high: int) -> int:
    """A whole number within limits. ctypes alone would cut off the high bits of larger ones."""
    try:
        number = operator.index(value)
    except TypeError:
        raise InvalidArgument(f"{name}: {type(value).__name__}, expected a whole number") from None
    if not low <= number <= high:
        raise InvalidArgument(f"{name}: {number}, expected a whole number from {low} to {high}")
    return number


def text(value: str | os.PathLike[str]) -> bytes:
    """A name or path for C, which would end it at a NUL."""
    encoded = os.fsencode(value)
    if b"\0" in encoded:
        raise InvalidArgument(f"{value!r}: has a NUL, expected a text without")
    return encoded


class NotCopied:
    """Base of objects whose struct of C points into their own arrays: copy, deepcopy and pickle are refused."""

    def __reduce_ex__(self, protocol: Any) -> Any:
        raise TypeError(f"{type(self).__name__}: cannot be copied or pickled, make a new one")


class Handle(NotCopied):
    """An object of C, destroyed with the last Python object that refers to it. Copies and deep copies of its owners share it."""

    def __init__(self, pointer: ctypes.c_void_p, destroy: Callable[[Any], None]) -> None:
        # The function is kept: modules are empty when the interpreter ends.
        self._as_parameter_, self._destroy = pointer, destroy

    def __del__(self) -> None:
        self._destroy(self._as_parameter_)

    def __deepcopy__(self, _memo: Any) -> Handle:
        return self
