"""The ctypes structs and constants against the C compiler's reading of ilaw.h and loader.h."""
import ctypes
import os
import re
import subprocess
from enum import EnumMeta
from pathlib import Path

import pytest

from ilaw import _abi

INCLUDE = Path(os.environ["ILAW_INCLUDE"])
HEADER = (INCLUDE / "ilaw/ilaw.h").read_text()
STRUCTS = {
    name: kind
    for name, kind in vars(_abi).items()
    if isinstance(kind, type) and issubclass(kind, ctypes.Structure) and kind is not ctypes.Structure
}
# ILAW_... with this beginning is a member of that class.
PREFIXES = {
    "DIMENSION": _abi.Dimension,
    "DELASSUS": _abi.Delassus,
    "FRAME": _abi.Frame,
    "INPUT": _abi.Input,
    "OUTPUT": _abi.Output,
    "CAN": _abi.Capability,
    "PARAMETER": _abi.ParameterKind,
    "VALUE": _abi.ValueKind,
    "MAY_BE": _abi.MayBe,
    "STATE": _abi.StateKind,
    "VARIABLE": _abi.VariableFlag,
    "ENERGY": _abi.Energy,
}


def run_c(folder, lines):
    """Numbers that a C program prints, one a line."""
    source = folder / "probe.c"
    source.write_text(
        "#include <ilaw/coupled.h>\n#include <ilaw/loader.h>\n#include <stdio.h>\nint main(void) {\n"
        + "".join(f'  printf("%lld\\n", (long long)({line}));\n' for line in lines)
        + "  return 0;\n}\n"
    )
    program = folder / "probe"
    subprocess.run([os.environ.get("CC", "cc"), f"-I{INCLUDE}", source, "-o", program], check=True)
    printed = subprocess.run([program], check=True, capture_output=True, text=True).stdout
    return [int(line) for line in printed.split()]


def enumerators():
    return re.findall(r"\bILAW_([A-Z0-9_]+) = [-(0-9]", HEADER)


def python_member(name):
    """The value of ILAW_<name> in Python, None where it has none."""
    for prefix, kind in PREFIXES.items():
        rest = name.removeprefix(prefix + "_")
        if rest != name:
            spelt = {"1": "ONE", "2": "TWO", "3": "THREE"}.get(rest, rest)
            if spelt in kind.__members__:
                return int(kind[spelt])
    for kind in (_abi.Code, _abi.Status):
        if name in kind.__members__:
            return int(kind[name])
    return getattr(_abi, name, None)


def test_every_struct_has_the_layout_of_c(tmp_path):
    wanted, found = [], []
    for name, kind in STRUCTS.items():
        wanted.append(f"sizeof(ilaw_{name})")
        found.append(ctypes.sizeof(kind))
        for member, *_ in kind._fields_:
            wanted.append(f"offsetof(ilaw_{name}, {member})")
            found.append(getattr(kind, member).offset)
            wanted.append(f"sizeof(((ilaw_{name}*)0)->{member})")
            found.append(getattr(kind, member).size)
    assert dict(zip(wanted, found)) == dict(zip(wanted, run_c(tmp_path, wanted)))


def test_every_struct_of_the_header_is_there():
    assert set(re.findall(r"^\} ilaw_(\w+);", HEADER, re.M)) == set(STRUCTS)


def test_every_enumerator_has_the_value_of_c(tmp_path):
    names = enumerators()
    values = run_c(tmp_path, [f"ILAW_{name}" for name in names])
    assert {name: python_member(name) for name in names} == dict(zip(names, values))


def test_nothing_is_invented():
    kinds = [kind for kind in vars(_abi).values() if isinstance(kind, EnumMeta) and kind.__module__ == _abi.__name__]
    members = sum(len(kind.__members__) for kind in kinds)
    counts = ("STATUS_COUNT", "ENERGY_COUNT")
    assert members + len(counts) == len(enumerators())


@pytest.mark.parametrize("name", _abi.SIGNATURES)
def test_every_function_is_declared_in_loader_h(name):
    declaration = re.search(rf"\b{name}\(([^;]*)\);", (INCLUDE / "ilaw/loader.h").read_text())
    assert declaration, name
    parameters = re.sub(r"\([^()]*\)", "", declaration[1])  # those of a function pointer are its own
    assert len(parameters.split(",")) == len(_abi.SIGNATURES[name][1])
