"""The shared libraries of this project that the package calls: found once, at the first call."""
from __future__ import annotations

import ctypes
import functools
import os
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from . import _abi
from .errors import NotFound

_WHEEL = Path(__file__).parent / "lib"  # filled in wheels that bring the libraries; the laws are in its ilaw

def _places(name: str, variable: str) -> list[str]:
    """Where a library may be, best first. A bare name is looked up by the system's dynamic linker."""
    named = os.environ.get(variable)
    if named:
        return [named]
    folders = [_WHEEL, *(Path(prefix, "lib") for prefix in (sys.prefix, sys.base_prefix, "/usr/local"))]
    if os.environ.get("ILAW_LOADER"):  # they are installed together
        folders.insert(0, Path(os.environ["ILAW_LOADER"]).parent)
    return [str(file) for folder in dict.fromkeys(folders) if (file := folder / name).is_file()] + [name]


def open_library(name: str, variable: str, signatures: Mapping[str, tuple[Any, list[Any]]]) -> ctypes.CDLL:
    """The library, its functions with their types; the environment variable may name its file."""
    reasons = []
    for place in _places(name, variable):
        try:
            library = ctypes.CDLL(place)
        except OSError as reason:
            reasons.append(str(reason))
            continue
        for function, (result, arguments) in signatures.items():
            getattr(library, function).restype = result
            getattr(library, function).argtypes = arguments
        return library
    raise NotFound(
        f"{name} cannot be loaded ({'; '.join(reasons)}); install it (cmake --install BUILD --prefix "
        f"{sys.prefix}) or name its file in the environment variable {variable}"
    )


@functools.cache
def loader() -> ctypes.CDLL:
    """The loader's functions. Calls release the interpreter's lock."""
    return open_library("libilaw_loader.so.1", "ILAW_LOADER", _abi.SIGNATURES)
