"""The window of libilaw_openradioss.so, a user library: its state is in the engine's restart file.

    /FUNCT_PYTHON/1
    def sync(context):
        import ilaw_openradioss_window
        ilaw_openradioss_window.sync(context, TIME, DT)

Needs neither numpy nor the package ilaw. SPDX-License-Identifier: BSD-3-Clause
"""
import ctypes

NAMES = {"ITAB": "int", "IKINE": "int", "X": "double", "V": "double", "D": "double", "MS": "double"}
_apply = None


def _function(context):
    parts = [name + part for name in NAMES for part in ("_ptr", "_size", "_type")]
    missing = [name for name in parts if name not in context]
    if missing:
        raise RuntimeError(f"context has no {', '.join(missing)}: this release has other names")
    for name, kind in NAMES.items():
        if context[name + "_type"] != kind:
            raise RuntimeError(f"context: {name}_type is {context[name + '_type']!r}, expected {kind!r}")
    try:
        function = ctypes.CDLL(None).ilaw_openradioss_sync  # of the library that the engine has opened
    except AttributeError:
        raise RuntimeError("found no user library, expected -dylib libilaw_openradioss.so at the engine") from None
    function.argtypes = [*[ctypes.c_double] * 2, ctypes.c_long, *[ctypes.c_void_p] * len(NAMES)]
    function.restype = None
    return function


def sync(context, time, step):
    """Each call of a deck's sync(context). TIME and DT are the engine's."""
    global _apply
    _apply = _apply or _function(context)
    _apply(time, step, context["ITAB_size"], *(context[name + "_ptr"] for name in NAMES))
