"""Interface laws (contact, friction, impact, adhesion, cohesion) for explicit codes in Python.

    import ilaw

    law = ilaw.Interface("coulomb", velocity_step=h, friction=0.3)
    contact = law.batch(index=floor, v_free=v, delassus=1 / m, gap=u[:, 2], v_previous=v_before, normal=[0, 0, 1])
    contact.initialise()
    for n in range(steps):
        ...                                            # v is the velocity without the interface now
        contact.evaluate(time=(n + 1) * h)
        v[floor] += contact.impulse[floor] / m[floor, None]

`list()` gives the libraries that are found, `describe(name)` a law's parameters and inputs.
"""
from ._abi import ABI_MAJOR, ABI_MINOR, Capability, Energy, Input, Output, ParameterFlag, ParameterKind, Permission
from ._abi import StateKind, Status
from .description import Amount, Law, Library, Parameter, Plugin, StateVariable, describe, list, search_path
from .errors import BadLibrary, BadNodes, Error, InvalidArgument, InvalidParameter, NotFound, Unsupported
from .interface import PER_NODE, Batch, Interface, Report

__version__ = "1.0.0"
__all__ = [
    "ABI_MAJOR", "ABI_MINOR", "Amount", "BadLibrary", "BadNodes", "Batch", "Capability", "Energy", "Error", "Input",
    "Interface", "InvalidArgument", "InvalidParameter", "Law", "Library", "NotFound", "Output", "PER_NODE", "Parameter",
    "ParameterFlag", "ParameterKind", "Permission", "Plugin", "Report", "StateKind", "StateVariable", "Status",
    "Unsupported", "describe", "list", "search_path",
]  # fmt: skip
