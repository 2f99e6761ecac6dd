"""Exceptions. Each carries the one-line message of the loader or of the law."""
from __future__ import annotations

from ._abi import Code


class Error(Exception):
    """Base of all that this package raises on purpose; `code` is an ILAW_* code of ilaw.h."""

    code: int = Code.INVALID_ARGUMENT


class InvalidArgument(Error, ValueError):
    """A call that is wrong in itself: an array missing, of another shape or type."""


class InvalidParameter(Error, ValueError):
    """A parameter is unknown, missing, out of range or wrongly combined."""

    code = Code.INVALID_PARAMETER


class Unsupported(Error, ValueError):
    """A dimension, form of H or input that the law does not serve."""

    code = Code.UNSUPPORTED


class NotFound(Error, LookupError):
    """No such library or law, or no loader."""

    code = Code.NOT_FOUND


class BadLibrary(Error, ImportError):
    """The file is no law library, or one with a broken description."""

    code = Code.BAD_LIBRARY


class BadNodes(Error, ArithmeticError):
    """Some nodes of a batch have bad input; all others were evaluated.

    `first` is the number of the first bad node (counted from 0), `count` how many there are.
    """

    code = Code.BAD_NODES

    def __init__(self, first: int, count: int, reason: str) -> None:
        super().__init__(f"node {first}: {reason}" + (f" (and {count - 1} more bad nodes)" if count > 1 else ""))
        self.first = first
        self.count = count
        self.reason = reason


_CLASSES = {cls.code: cls for cls in (InvalidArgument, InvalidParameter, Unsupported, NotFound, BadLibrary)}


def raise_for(code: int, message: str) -> None:
    """Raises what `code` stands for; does nothing for OK."""
    if code == Code.OK:
        return
    if code == Code.OUT_OF_MEMORY:
        raise MemoryError(message)
    made = _CLASSES.get(code, Error)(message)
    made.code = code
    raise made
