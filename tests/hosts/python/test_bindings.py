"""The files that api/bindings/generate.py writes: as the headers say, and laid out as the C compiler does."""
import ctypes
import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from ilaw import _abi, _coupled_abi, _search_abi

pytest.importorskip("pycparser")
API = Path(os.environ["ILAW_SOURCE"]) / "api"
SCRIPT = API / "bindings/generate.py"


def check(*arguments):
    return subprocess.run([sys.executable, SCRIPT, "--check", *arguments], capture_output=True, text=True)


def test_the_files_of_the_tree_are_those_of_the_headers():
    done = check()
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize(
    ("header", "text", "changed", "shown"),
    [
        ("ilaw.h", "ILAW_SLIP = 3", "ILAW_SLIP = 9", ["+    SLIP = 9", "ILAW_SLIP = 9"]),
        ("ilaw.h", "int64_t bad_count;", "int32_t bad_count;", ['+        ("bad_count", c_int32),', "bad_count = 0"]),
        ("coupled.h", "  double work;", "  double work, more;", ['+        ("more", c_double),', ":: more = 0"]),
        ("loader.h", "ilaw_search_path(char* buffer, size_t", "ilaw_search_path(char* buffer, int64_t", ["c_int64"]),
    ],
)
def test_a_change_of_a_header_is_found(tmp_path, header, text, changed, shown):
    shutil.copytree(API / "include/ilaw", tmp_path / "ilaw")
    file = tmp_path / "ilaw" / header
    assert file.read_text().count(text) == 1
    file.write_text(file.read_text().replace(text, changed))
    done = check("--include", tmp_path)
    assert done.returncode == 1 and "run api/bindings/generate.py" in done.stderr
    assert all(one in done.stdout for one in shown), done.stdout


@pytest.fixture(scope="module")
def declarations():
    spec = importlib.util.spec_from_file_location("generate", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    sys.modules["generate"] = module  # its dataclasses look there
    spec.loader.exec_module(module)
    return module.Declarations(API / "include")


def output_of(command, program):
    subprocess.run([*command, "-o", program], check=True, cwd=program.parent)
    return subprocess.run([program], check=True, capture_output=True, text=True).stdout.split()


@pytest.fixture(scope="module")
def in_c(declarations, tmp_path_factory):
    """Values of enumerators, sizes and offsets, as the C compiler has them, by their names."""
    names = [f"(int){name}" for name in declarations.values]
    for struct, members in declarations.structs.items():
        names += [f"(int)sizeof({struct})", *(f"(int)offsetof({struct}, {member})" for member, _ in members)]
    source = tmp_path_factory.mktemp("c") / "probe.c"
    lines = "".join(f'  printf("%d\\n", {name});\n' for name in names)
    head = "".join(f"#include <{name}.h>\n" for name in ("ilaw/coupled", "ilaw/loader", "ilaw/search", "stdio"))
    source.write_text(f"{head}int main(void) {{\n{lines}  return 0;\n}}\n")
    command = [os.environ.get("CC", "cc"), f"-I{API / 'include'}", source]
    return dict(zip(names, map(int, output_of(command, source.with_suffix("")))))


def test_python_has_the_layout_of_c(declarations, in_c):
    found = {}
    for name in declarations.structs:
        own = name.removeprefix("ilaw_")
        struct = next(getattr(module, own) for module in (_coupled_abi, _search_abi, _abi) if hasattr(module, own))
        found[f"(int)sizeof({name})"] = ctypes.sizeof(struct)
        for member, *_ in struct._fields_:
            found[f"(int)offsetof({name}, {member})"] = getattr(struct, member).offset
    assert len(found) > 150
    assert found == {name: value for name, value in in_c.items() if "of(" in name}


def test_fortran_has_the_values_and_the_layout_of_c(declarations, in_c, tmp_path):
    if not os.environ.get("FC"):
        pytest.skip("no Fortran compiler")
    search = declarations.headers["search.h"]  # Python alone has it
    structs = [one for one in declarations.structs.items() if one not in search.structs]
    values = [name for name in declarations.values if all((name, k) not in e for e in search.enumerations for k in range(9))]
    lines = ["program probe", "use ilaw_coupled_abi", "use ilaw_abi", "use iso_c_binding", "implicit none"]
    lines += [f"type({struct}), target :: s{k}" for k, (struct, _) in enumerate(structs)]
    lines += [f"print '(i0)', {name}" for name in values]
    for k, (struct, members) in enumerate(structs):
        lines.append(f"print '(i0)', c_sizeof(s{k})")
        if members[0][0] == "struct_size":
            lines.append(f"if (s{k}%struct_size /= c_sizeof(s{k})) print '(a)', 'struct_size of {struct}'")
        lines += [f"call offset(c_loc(s{k}), c_loc(s{k}%{member}))" for member, _ in members]
    lines += [
        "contains", "subroutine offset(a, b)", "type(c_ptr), intent(in) :: a, b",
        "print '(i0)', transfer(b, 0_c_intptr_t) - transfer(a, 0_c_intptr_t)", "end subroutine", "end program",
    ]  # fmt: skip
    (tmp_path / "probe.f90").write_text("\n".join(lines) + "\n")
    modules = [API / "fortran/ilaw_abi.f90", API / "fortran/ilaw_coupled_abi.f90"]
    found = output_of([os.environ["FC"], *modules, tmp_path / "probe.f90"], tmp_path / "probe")
    fortran = [f"(int){name}" for name in values]
    for struct, members in structs:
        fortran += [f"(int)sizeof({struct})", *(f"(int)offsetof({struct}, {member})" for member, _ in members)]
    assert found == [str(in_c[name]) for name in fortran]
