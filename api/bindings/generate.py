#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the bindings for Fortran and Python from the headers of the ABI.

    generate.py                 writes the files below in the tree
    generate.py --check         compares them with the headers; exit status 1 and a diff where they differ
    generate.py --into FOLDER   writes them there
    --include FOLDER            reads the headers there, and those of the tree that it lacks

The written files are part of the tree, so that users need neither this script nor pycparser (Debian:
python3-pycparser). A test runs --check. The C preprocessor is $CC, or else cc.
"""
from __future__ import annotations

import argparse
import difflib
import os
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

from pycparser import c_ast, c_parser

API = Path(__file__).resolve().parent.parent

# Enumerations that are classes in Python: first enumerator, class, base, prefix of its members, docstring.
# All other enumerators, and the last of an enumeration where it counts the others, are constants of the module.
CLASSES = [
    ("ILAW_OK", "Code", "IntEnum", "ILAW_", "Codes that functions return."),
    ("ILAW_DELASSUS_SCALAR", "Delassus", "Flags", "ILAW_DELASSUS_", "Form of the inverse mass H at a node."),
    ("ILAW_FRAME_LOCAL", "Frame", "Flags", "ILAW_FRAME_", "Axes in which vectors and H are given."),
    ("ILAW_NUMBERS_DOUBLE", "Numbers", "Flags", "ILAW_NUMBERS_", "Number type of the arrays of a batch."),
    ("ILAW_INPUT_GAP", "Input", "Flags", "ILAW_INPUT_", "Arrays that a law reads besides v_free and delassus."),
    ("ILAW_OUTPUT_VELOCITY", "Output", "Flags", "ILAW_OUTPUT_", "Optional arrays that a law can write."),
    ("ILAW_CAN_ADHERE", "Capability", "Flags", "ILAW_CAN_", "Further abilities of a law."),
    ("ILAW_MAY_SKIP_FRESH", "Permission", "Flags", "ILAW_MAY_", "Nodes out of reach that the host may skip."),
    ("ILAW_KIND_NUMBER", "ParameterKind", "IntEnum", "ILAW_KIND_", "Kind of a parameter."),
    ("ILAW_FLAG_REQUIRED", "ParameterFlag", "Flags", "ILAW_FLAG_", "Flags of a parameter."),
    ("ILAW_KIND_VALUE_NUMBER", "ValueKind", "IntEnum", "ILAW_KIND_VALUE_", "How the value of a parameter is given."),
    ("ILAW_KIND_SCALAR", "StateKind", "IntEnum", "ILAW_KIND_", "Kind of a state variable."),
    ("ILAW_FLAG_INTERNAL", "VariableFlag", "Flags", "ILAW_FLAG_", "Flags of a state variable."),
    ("ILAW_FREE", "Status", "IntEnum", "ILAW_", "State of a node after a step."),
    ("ILAW_METHOD_GAUSS_SEIDEL", "Method", "IntEnum", "ILAW_METHOD_", "Method of the last iteration of a solve."),
    ("ILAW_PLACE_OVER", "Place", "IntEnum", "ILAW_PLACE_", "Where a point is beside the closest facet."),
    ("ILAW_ENERGY_FRICTION", "Energy", "IntEnum", "ILAW_ENERGY_", "Column of the energy output."),
]
# Values of members in a Fortran variable that is merely declared; all others are 0 or null.
FORTRAN_DEFAULTS = {
    ("ilaw_setup", "numbers"): "ILAW_NUMBERS_DOUBLE",
    ("ilaw_batch", "index_base"): "1",
    ("ilaw_report", "first_bad_node"): "-1",
    ("ilaw_plugin", "abi_major"): "ILAW_ABI_MAJOR",
    ("ilaw_plugin", "abi_minor"): "ILAW_ABI_MINOR",
    ("ilaw_coupled_report", "bad_group"): "-1",
    ("ilaw_coupled_report", "bad_contact"): "-1",
    ("ilaw_coupled_report", "worst_group"): "-1",
    ("ilaw_coupled_report", "worst_contact"): "-1",
}
# C type, typedef in front of the parser, size, Fortran kind, ctypes type
SCALARS = {
    name: (base, size, fortran, python)
    for name, base, size, fortran, python in [
        ("int", "", 4, "integer(c_int)", "c_int"),
        ("int8_t", "signed char", 1, "integer(c_int8_t)", "c_int8"),
        ("uint8_t", "unsigned char", 1, "integer(c_int8_t)", "c_uint8"),
        ("uint16_t", "unsigned short", 2, "integer(c_int16_t)", "c_uint16"),
        ("int32_t", "int", 4, "integer(c_int32_t)", "c_int32"),
        ("uint32_t", "unsigned", 4, "integer(c_int32_t)", "c_uint32"),
        ("int64_t", "long", 8, "integer(c_int64_t)", "c_int64"),
        ("uint64_t", "unsigned long", 8, "integer(c_int64_t)", "c_uint64"),
        ("size_t", "unsigned long", 8, "integer(c_size_t)", "c_size_t"),
        ("float", "", 4, "real(c_float)", "c_float"),
        ("double", "", 8, "real(c_double)", "c_double"),
    ]
}


@dataclass
class Function:
    name: str
    result: c_ast.Node
    arguments: list[tuple[str, c_ast.Node]]


@dataclass
class Header:
    """The declarations of one header, in its order."""

    enumerations: list[list[tuple[str, int]]] = field(default_factory=list)
    items: list[tuple[str, object]] = field(default_factory=list)  # ("struct", (name, members)), ("type", Function)
    functions: list[Function] = field(default_factory=list)

    @property
    def structs(self) -> list[tuple[str, list[tuple[str, c_ast.Node]]]]:
        return [item for kind, item in self.items if kind == "struct"]


class Declarations:
    """All headers: what each declares, and what a type is."""

    def __init__(self, include: Path) -> None:
        self.headers: dict[str, Header] = {}
        self.values: dict[str, int] = {}
        self.aliases: dict[str, str] = {}
        self.structs: dict[str, list[tuple[str, c_ast.Node]]] = {}
        self.function_types: set[str] = set()
        for node in parsed(include).ext:
            header = self.headers.setdefault(Path(node.coord.file).name, Header())
            if isinstance(node, c_ast.Decl) and isinstance(node.type, c_ast.Enum):
                self.add_enumeration(header, node.type)
            elif isinstance(node, c_ast.Decl) and isinstance(node.type, c_ast.FuncDecl):
                header.functions.append(function_of(node.name, node.type))
            elif isinstance(node, c_ast.Typedef):
                self.add_type(header, node.name, node.type)

    def add_enumeration(self, header: Header, enumeration: c_ast.Enum) -> None:
        members, next_value = [], 0
        for one in enumeration.values.enumerators:
            value = self.value(one.value) if one.value else next_value
            self.values[one.name], next_value = value, value + 1
            members.append((one.name, value))
        header.enumerations.append(members)

    def add_type(self, header: Header, name: str, kind: c_ast.Node) -> None:
        if isinstance(kind, c_ast.PtrDecl) and isinstance(kind.type, c_ast.FuncDecl):
            self.function_types.add(name)
            header.items.append(("type", function_of(name, kind.type)))
        elif isinstance(kind.type, c_ast.Struct) and kind.type.decls:
            self.structs[name] = [(member.name, member.type) for member in kind.type.decls]
            header.items.append(("struct", (name, self.structs[name])))
        elif isinstance(kind.type, c_ast.IdentifierType) and name not in SCALARS:
            self.aliases[name] = kind.type.names[0]

    def value(self, expression: c_ast.Node) -> int:
        if isinstance(expression, c_ast.Constant):
            return int(expression.value.rstrip("uU"), 0)
        if isinstance(expression, c_ast.ID):
            return self.values[expression.name]
        if isinstance(expression, c_ast.UnaryOp) and expression.op == "-":
            return -self.value(expression.expr)
        left, right = self.value(expression.left), self.value(expression.right)
        return {"<<": left << right, "|": left | right, "+": left + right, "-": left - right}[expression.op]

    def name(self, kind: c_ast.Node) -> str:
        """Name of a type that is no pointer, with aliases resolved: a key of SCALARS, a struct, "void", "char"."""
        while isinstance(kind, (c_ast.TypeDecl, c_ast.ArrayDecl)):
            kind = kind.type
        name = kind.names[0] if isinstance(kind, c_ast.IdentifierType) else kind.name
        while name in self.aliases:
            name = self.aliases[name]
        return name

    def size(self, kind: c_ast.Node) -> tuple[int, int]:
        """Size and alignment on a machine of 64 bits."""
        if isinstance(kind, c_ast.ArrayDecl):
            size, alignment = self.size(kind.type)
            return size * self.value(kind.dim), alignment
        name = None if isinstance(kind, c_ast.PtrDecl) else self.name(kind)
        if name in self.structs:
            end, widest = 0, 1
            for _, member in self.structs[name]:
                size, alignment = self.size(member)
                end = -(-end // alignment) * alignment + size
                widest = max(widest, alignment)
            return -(-end // widest) * widest, widest
        size = SCALARS[name][1] if name in SCALARS else 8
        return size, size

    def struct_size(self, name: str) -> int:
        return self.size(c_ast.TypeDecl(None, [], None, c_ast.IdentifierType([name])))[0]


def function_of(name: str, kind: c_ast.FuncDecl) -> Function:
    given = [] if kind.args is None else kind.args.params
    arguments = [(one.name, one.type) for one in given if not (one.name is None and isinstance(one, c_ast.Typename))]
    return Function(name, kind.type, arguments)


def parsed(include: Path) -> c_ast.FileAST:
    with tempfile.TemporaryDirectory() as folder:
        types = [f"typedef {base} {name};" for name, (base, *_) in SCALARS.items() if base and name != "size_t"]
        Path(folder, "stdint.h").write_text("\n".join(types) + "\n")
        Path(folder, "stddef.h").write_text("typedef unsigned long size_t;\n")
        source = Path(folder, "all.c")
        source.write_text("#include <ilaw/coupled.h>\n#include <ilaw/loader.h>\n#include <ilaw/search.h>\n")
        command = [os.environ.get("CC", "cc"), "-E", "-nostdinc", f"-I{folder}", f"-I{include}", f"-I{API / 'include'}"]
        text = subprocess.run([*command, source], check=True, capture_output=True, text=True).stdout
    return c_parser.CParser().parse(text, "headers")


def is_pointer_to(kind: c_ast.Node, wanted: type) -> bool:
    return isinstance(kind, c_ast.PtrDecl) and isinstance(kind.type, wanted)


def is_const(kind: c_ast.Node) -> bool:
    return "const" in getattr(kind, "quals", [])


# ---- Fortran --------------------------------------------------------------------------------------

FORTRAN_HEAD = """\
! {file} - {what}, for Fortran 2008.
!
! Made by api/bindings/generate.py from <ilaw/{headers}>: do not edit, change the header and
! run the script. The header says what each member means, in which unit and who owns it. Every type is
! interoperable with the C struct of the same name on 64-bit machines. Declared variables have their struct_size,
! null pointers and index_base 1. Texts are pointers to C strings: ilaw_text (module ilaw) reads them.
!
! SPDX-License-Identifier: BSD-3-Clause
"""


class Fortran:
    def __init__(self, all_headers: Declarations) -> None:
        self.all = all_headers

    def module(self, file: str, what: str, headers: list[str], uses: list[str]) -> str:
        chosen = [self.all.headers[name] for name in headers]
        name = file.removesuffix(".f90")
        text = FORTRAN_HEAD.format(file=file, what=what, headers=">, <ilaw/".join(headers))
        lines = [f"module {name}", *(f"  use{use}" for use in uses), "  implicit none", "  public"]
        for header in chosen:
            for members in header.enumerations:
                constants = [f"{member} = {value}" for member, value in members]
                lines += ["", "  integer(c_int32_t), parameter :: &", *wrapped(constants, "    ", " &", 112)]
        for header in chosen:
            for struct, members in header.structs:
                declared = [f"    {self.member(struct, *member)}" for member in members]
                lines += ["", f"  type, bind(c) :: {struct}", *declared, "  end type"]
        types = [item for header in chosen for kind, item in header.items if kind == "type"]
        functions = [item for header in chosen for item in header.functions]
        for block, declared in (("abstract interface", types), ("interface", functions)):
            if declared:
                lines += ["", f"  {block}"]
                for one in declared:
                    lines += self.procedure(one, bound=block == "interface")
                lines.append("  end interface")
        return text + "\n".join([*lines, f"end module {name}"]) + "\n"

    def scalar(self, kind: c_ast.Node) -> str:
        if isinstance(kind, c_ast.PtrDecl):
            return "type(c_funptr)" if isinstance(kind.type, c_ast.FuncDecl) else "type(c_ptr)"
        name = self.all.name(kind)
        if name in self.all.function_types:
            return "type(c_funptr)"
        return f"type({name})" if name in self.all.structs else SCALARS[name][2]

    def member(self, struct: str, name: str, kind: c_ast.Node) -> str:
        scalar = self.scalar(kind)
        if name == "struct_size":
            initial = str(self.all.struct_size(struct))
        else:
            initial = FORTRAN_DEFAULTS.get((struct, name), "0")
        shape = f"(0:{self.all.value(kind.dim) - 1})" if isinstance(kind, c_ast.ArrayDecl) else ""
        initial = {"type(c_ptr)": "c_null_ptr", "type(c_funptr)": "c_null_funptr"}.get(scalar, initial)
        if scalar == f"type({self.all.name(kind) if not isinstance(kind, c_ast.PtrDecl) else ''})":
            return f"{scalar} :: {name}{shape}"  # the members have their own
        return f"{scalar} :: {name}{shape} = {initial}"

    def argument(self, name: str, kind: c_ast.Node) -> str:
        """Structs by reference, arrays of numbers as such, all else that C has a pointer for as type(c_ptr).

        Structs and pointers have the attribute target, because the callee may read and write what they point to. Without
        it gfortran keeps variables of the caller in registers whose addresses are in there alone.
        """
        if not isinstance(kind, c_ast.PtrDecl) or isinstance(kind.type, c_ast.FuncDecl):
            return f"{self.scalar(kind)}, value :: {name}"
        target, intent = kind.type, "in" if is_const(kind.type) else "inout"
        if isinstance(target, c_ast.PtrDecl):
            array = is_const(target)  # `const T* const*`: pointers to read; `T**`: a result
            return f"type(c_ptr), intent(in), target :: {name}(*)" if array else f"type(c_ptr), intent(out) :: {name}"
        if self.all.name(target) in self.all.structs:
            return f"{self.scalar(target)}, intent({intent}), target :: {name}"
        if self.all.name(target) in SCALARS:
            return f"{self.scalar(target)}, intent({intent}) :: {name}(*)"
        return f"type(c_ptr), value :: {name}"

    def procedure(self, function: Function, bound: bool) -> list[str]:
        arguments = [self.argument(*one) for one in function.arguments]
        nothing = not isinstance(function.result, c_ast.PtrDecl) and self.all.name(function.result) == "void"
        kind = "subroutine" if nothing else "function"
        result = "" if nothing else self.scalar(function.result) + " "
        head = f"{result}{kind} {function.name}({', '.join(name for name, _ in function.arguments)})"
        bind = f"bind(c, name='{function.name}')" if bound else "bind(c)"
        used = sorted(set(re.findall(r"\((c_\w+|ilaw_\w+)\)", " ".join([result, *arguments]))))
        used += ["c_ptr"] if "type(c_ptr)" in " ".join([result, *arguments]) and "c_ptr" not in used else []
        fits = len(head) + len(bind) < 106
        lines = [f"    {head} {bind}"] if fits else [f"    {head} &", f"      {bind}"]
        lines += [f"      import :: {', '.join(used)}"] if used else []
        return [*lines, *(f"      {one}" for one in arguments), f"    end {kind}"]


def wrapped(items: list[str], indent: str, mark: str, width: int) -> list[str]:
    """Items separated by commas, in lines of at most `width`; all but the last line end with `mark`."""
    lines, line = [], ""
    for item in items:
        if line and len(indent) + len(line) + len(item) + 2 + len(mark) > width:
            lines.append(line)
            line = ""
        line += (" " if line else "") + item + ","
    lines.append(line.removesuffix(","))
    return [indent + one + mark for one in lines[:-1]] + [indent + lines[-1]]


# ---- Python ---------------------------------------------------------------------------------------

PYTHON_HEAD = '''\
"""{what}, for ctypes.

Made by api/bindings/generate.py from <ilaw/{headers}>: do not edit, change the header and run
the script. The header says what each member means, in which unit and who owns it. Names lose their `ilaw_` or `ILAW_`.
"""
from __future__ import annotations

import ctypes
from ctypes import CFUNCTYPE, POINTER
from ctypes import {types}
'''

FLAGS = '''\
class Flags(IntFlag):
    """Printed by its names, as `ilaw describe` does."""

    def __str__(self) -> str:
        return ", ".join(str(flag.name).lower() for flag in type(self) if flag in self)
'''


class Python:
    def __init__(self, all_headers: Declarations) -> None:
        self.all = all_headers
        self.own: set[str] = set()  # names that this module defines; others are of _abi
        self.used: set[str] = set()

    def module(self, what: str, headers: list[str], imports: str) -> str:
        chosen = [self.all.headers[name] for name in headers]
        self.own = {item[0] if kind == "struct" else item.name for header in chosen for kind, item in header.items}
        self.used = set()
        body, before = self.enumerations(chosen), ""
        for kind, item in (one for header in chosen for one in header.items):
            body += [] if kind == before == "type" else ["", ""]
            body += self.struct(*item) if kind == "struct" else [self.function_type(item)]
            before = kind
        body += ["", "", "SIGNATURES = {"]
        for function in (one for header in chosen for one in header.functions):
            result, *arguments = self.signature(function)
            line = f'    "{function.name}": ({result}, [{", ".join(arguments)}]),'
            if len(line) > 120:
                parts = wrapped(arguments, 8 * " ", "", 120)
                body += [f'    "{function.name}": ({result}, [', *parts, "    ]),"]
            else:
                body.append(line)
        types = ", ".join(sorted(self.used | {"c_void_p"}))
        head = PYTHON_HEAD.format(what=what, headers=">, <ilaw/".join(headers), types=types)
        return head + imports + "\n".join([*body, "}"]) + "\n"

    def enumerations(self, chosen: list[Header]) -> list[str]:
        constants, classes = [], []
        for members in (one for header in chosen for one in header.enumerations):
            known = next((one for one in CLASSES if one[0] == members[0][0]), None)
            if known is None:
                constants += members
                continue
            _, name, base, prefix, doc = known
            if members[-1][0].endswith("_COUNT"):
                constants.append(members.pop())
            classes += ["", "", f"class {name}({base}):", f'    """{doc}"""', ""]
            classes += [f"    {member.removeprefix(prefix)} = {value}" for member, value in members]
        lines = [f"{name.removeprefix('ILAW_')} = {value}" for name, value in constants]
        if not any("(Flags)" in line for line in classes):
            return [*lines, *classes]
        return ["", *lines, "", "", *FLAGS.splitlines(), *classes]

    def named(self, name: str) -> str:
        return ("" if name in self.own else "_abi.") + name.removeprefix("ilaw_")

    def use(self, name: str) -> str:
        self.used.add(name)
        return name

    def type(self, kind: c_ast.Node, in_struct: bool = False) -> str:
        if isinstance(kind, c_ast.ArrayDecl):
            return f"{self.type(kind.type)} * {self.all.value(kind.dim)}"
        if isinstance(kind, c_ast.PtrDecl):
            return self.pointer(kind, in_struct)
        name = self.all.name(kind)
        if name == "void":
            return "None"
        return self.use(SCALARS[name][3]) if name in SCALARS else self.named(name)

    def pointer(self, kind: c_ast.PtrDecl, in_struct: bool) -> str:
        """Arrays of numbers in structs are addresses, as numpy gives them; opaque types are addresses, too."""
        target = kind.type
        if isinstance(target, c_ast.FuncDecl):
            return f"CFUNCTYPE({', '.join(self.signature(function_of('', target)))})"
        if isinstance(target, c_ast.PtrDecl):
            return f"POINTER({self.pointer(target, in_struct)})"
        name = self.all.name(target)
        if name == "char":
            return self.use("c_char_p")
        if name in self.all.structs or name in SCALARS and not in_struct:
            return f"POINTER({self.type(target)})"
        return self.use("c_void_p")

    def signature(self, function: Function) -> list[str]:
        return [self.type(function.result), *(self.type(kind) for _, kind in function.arguments)]

    def function_type(self, function: Function) -> str:
        return f"{self.named(function.name)} = CFUNCTYPE({', '.join(self.signature(function))})"

    def struct(self, name: str, members: list[tuple[str, c_ast.Node]]) -> list[str]:
        lines = [f"class {self.named(name)}(ctypes.Structure):", "    _fields_ = ["]
        lines += [f'        ("{member}", {self.type(kind, in_struct=True)}),' for member, kind in members]
        return [*lines, "    ]"]


# ---- files ----------------------------------------------------------------------------------------


def bindings(include: Path) -> dict[str, str]:
    """Text of each file, by its path in api/."""
    found = Declarations(include)
    fortran, python = Fortran(found), Python(found)
    intrinsic = ", intrinsic :: iso_c_binding"
    return {
        "fortran/ilaw_abi.f90": fortran.module(
            "ilaw_abi.f90",
            "structs, constants and functions of the ABI and the loader",
            ["ilaw.h", "loader.h"],
            [intrinsic],
        ),
        "fortran/ilaw_coupled_abi.f90": fortran.module(
            "ilaw_coupled_abi.f90", "structs and functions of coupled contacts", ["coupled.h"], [intrinsic, " ilaw_abi"]
        ),
        "python/ilaw/_abi.py": python.module(
            "Structs, constants and functions of the ABI and the loader",
            ["ilaw.h", "loader.h"],
            "from enum import IntEnum, IntFlag\n",
        ),
        "python/ilaw/_coupled_abi.py": python.module(
            "Structs and functions of coupled contacts", ["coupled.h"], "from enum import IntEnum\n\nfrom . import _abi\n"
        ),
        "python/ilaw/_search_abi.py": python.module(
            "Structs and functions of the search for facets", ["search.h"], "from enum import IntEnum\n\nfrom . import _abi\n"
        ),
    }


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="compare the files with the headers, write nothing")
    parser.add_argument("--include", type=Path, default=API / "include", help="folder of ilaw/ilaw.h")
    parser.add_argument("--into", type=Path, default=API, help="folder to write to, api/ of the tree unless given")
    given = parser.parse_args()
    differ = False
    for name, text in bindings(given.include).items():
        path = given.into / name
        if not given.check:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
            continue
        there = path.read_text() if path.is_file() else ""
        both = there.splitlines(), text.splitlines()
        shown = list(difflib.unified_diff(*both, str(path), "from the headers", lineterm=""))
        if shown:
            differ = True
            print("\n".join(shown))
    if differ:
        print("generate.py: the bindings differ from the headers; run api/bindings/generate.py", file=sys.stderr)
    return differ


if __name__ == "__main__":
    sys.exit(main())
