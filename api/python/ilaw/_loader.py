"""The shared library of the loader: found once, at the first call."""
from __future__ import annotations

import ctypes
import functools
import os
import sys
from pathlib import Path

from . import _abi
from .errors import NotFound

NAME = "libilaw_loader.so.1"


def _places() -> list[str]:
    """Where the loader may be, best first. A bare name is looked up by the system's dynamic linker."""
    named = os.environ.get("ILAW_LOADER")
    if named:
        return [named]
    prefixes = dict.fromkeys([sys.prefix, sys.base_prefix, "/usr/local"])
    return [str(file) for prefix in prefixes if (file := Path(prefix, "lib", NAME)).is_file()] + [NAME]


@functools.cache
def loader() -> ctypes.CDLL:
    """The loader's functions, with their types. Calls release the interpreter's lock."""
    reasons = []
    for place in _places():
        try:
            library = ctypes.CDLL(place)
        except OSError as reason:
            reasons.append(str(reason))
            continue
        for name, (result, arguments) in _abi.SIGNATURES.items():
            function = getattr(library, name)
            function.restype, function.argtypes = result, arguments
        return library
    raise NotFound(
        f"{NAME} cannot be loaded ({'; '.join(reasons)}); install it (cmake --install BUILD --prefix "
        f"{sys.prefix}) or name its file in the environment variable ILAW_LOADER"
    )
