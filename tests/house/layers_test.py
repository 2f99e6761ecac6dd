#!/usr/bin/env python3
"""Rules of inclusion (docs/architecture.md): a lower layer knows nothing of those above it."""
# SPDX-License-Identifier: BSD-3-Clause
import re
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
KIT = ROOT / "api/include/ilaw/kit"
DEVICE = ROOT / "api/device/kit/ilaw/device"
# The folders of host_mock from the ground up: each may include itself and those before it.
FLOORS = ["host/base", "host/model", "host/surface", "host/contact", "host/step", "host/scene", "host/results",
          "instruments/audit", "instruments/stress", "instruments/bench", "cli"]  # fmt: skip
FLOOR = {Path(floor).name: k for k, floor in enumerate(FLOORS)}  # as includes name it
# The public headers of the kit, from the ground up; those of a room may include each other, not in a circle.
ROOMS = [["pack", "math", "vector", "roots", "table"], ["law", "node"],
         ["local_coulomb", "friction", "changing_friction", "tangential_spring", "rolling", "rigid_bond", "window"],
         ["plugin"]]  # fmt: skip
ROOM = {f"ilaw/kit/{name}.hpp": k for k, names in enumerate(ROOMS) for name in names}
OF_SEARCH = {"ilaw/ilaw.h", "ilaw/search.h", "ilaw/arrays.hpp", "ilaw/sized.hpp"}
OF_LAWS = r"ilaw/(ilaw\.h|kit\.hpp|plain_c\.h|kit/[^/]+\.hpp)"


def of_host(inside, header, quoted):
    if header.startswith("ilaw/kit"):
        return "the kit is for authors of laws, hosts need ilaw.h and the loader"
    if not quoted:
        return ""
    if inside.startswith("minimal/"):
        return "" if header == "minimal.hpp" else "the minimal host has nothing of the reference host"
    here, there = Path(inside).parent.name, header.split("/")[0]
    if header == "check/units.hpp" and here == "stress":
        return ""
    if there == "check":
        return "" if here == "cli" else "only a command knows the checker"
    if there not in FLOOR:
        return "no such floor"
    return f"runs up from {here} to {there}" if FLOOR[there] > FLOOR.get(here, len(FLOORS)) else ""


def of_api(inside, header, quoted):
    there = header.split("/")[0]
    if "host_mock" in header or quoted and there in FLOOR:
        return "the interface knows no host"
    if quoted and there == "check" and not inside.startswith("check/"):
        return "the interface knows no checker"
    if inside.startswith("search/") and header.startswith("ilaw/") and header not in OF_SEARCH:
        return "the search knows neither laws nor their solver"
    is_kit = inside.startswith(("include/ilaw/kit", "device/kit/"))
    return "the loader knows no kit" if header.startswith("ilaw/kit") and not is_kit else ""


def of_law(inside, header, quoted):
    if quoted:  # bond: what cohesive and rccm share
        return "a law stays in its folder" if "/" in header and not header.startswith("../bond/") else ""
    is_allowed = not header.startswith("ilaw/") or re.fullmatch(OF_LAWS, header)
    return "" if is_allowed else "a law includes the kit's public headers alone"


def complaint(file, header, quoted):
    """Empty where a file of the tree may include a header."""
    folder, _, inside = file.partition("/")
    return {"host_mock": of_host, "api": of_api, "plugins": of_law}[folder](inside, header, quoted)


def includes_of(file):
    for number, line in enumerate(file.read_text().splitlines(), 1):
        if found := re.match(r"\s*#\s*include\s*([<\"])([^>\"]+)[>\"]", line):
            yield number, found[2], found[1] == '"'


class Layers(unittest.TestCase):
    def test_no_include_runs_up(self):
        files = [file for folder in ("host_mock", "api", "plugins") for file in (ROOT / folder).rglob("*")
                 if file.suffix in (".cpp", ".hpp", ".h", ".c")]  # fmt: skip
        self.assertGreater(len(files), 90)
        said = [f"{name}:{number}: {header}: {what}" for file in files for name in [str(file.relative_to(ROOT))]
                for number, header, quoted in includes_of(file) if (what := complaint(name, header, quoted))]  # fmt: skip
        self.assertEqual(said, [])

    def test_every_folder_of_the_host_is_a_floor(self):
        folders = {f"{room}/{folder.name}" for room in ("host", "instruments")
                   for folder in (ROOT / "host_mock" / room).iterdir()}  # fmt: skip
        self.assertEqual(folders - set(FLOORS), set())

    def test_rooms_of_the_kit_are_built_on_each_other(self):
        """Numbers know nothing of laws, laws nothing of mechanics; the machinery is included by the entry alone, but for packs
        in memory, where windows are."""
        for file in KIT.glob("*.*"):
            name = f"ilaw/kit/{file.name}"
            self.assertIn(name, ROOM)
            for _, header, quoted in includes_of(file):
                if quoted or not header.startswith(("ilaw/kit/", "ilaw/device/")):
                    continue
                with self.subTest(file=name, header=header):
                    if header.startswith(("ilaw/kit/detail/", "ilaw/device/")):
                        self.assertTrue(file.name == "plugin.hpp" or header.endswith("/load_store.hpp"))
                    else:
                        self.assertLessEqual(ROOM[header], ROOM[name])

    def test_machinery_of_the_kit_has_a_namespace_of_its_own(self):
        """`using namespace ilaw::kit` brings in nothing of it."""
        lines = [line for room in (KIT / "detail", DEVICE) for file in room.iterdir()
                 for line in file.read_text().splitlines() if line.startswith("namespace ")]  # fmt: skip
        self.assertGreater(len(lines), 10)
        self.assertEqual(set(lines), {"namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {"})

    def test_the_page_names_every_header_of_the_kit(self):
        page = (ROOT / "docs/architecture.md").read_text()
        named = set(re.findall(r"[a-z_0-9]+", page[page.index("kit.hpp, plugin") :].split("```")[0]))
        headers = {file.stem for folder in (KIT, DEVICE) for file in folder.rglob("*.*")}
        self.assertGreater(len(headers), 25)
        self.assertEqual(headers - named, set())

    def test_sees_includes_that_run_up(self):
        """The test itself: what it must refuse, and what not."""
        for file, header, quoted, is_allowed in (
            ("host_mock/host/step/integrator.cpp", "scene/scene.hpp", True, False),
            ("host_mock/host/scene/scene.cpp", "step/energy.hpp", True, True),
            ("host_mock/host/base/files.cpp", "cli/commands.hpp", True, False),
            ("host_mock/cli/run.cpp", "base/files.hpp", True, True),
            ("host_mock/host/model/bars.cpp", "attic/bars.hpp", True, False),
            ("host_mock/host/contact/law.cpp", "ilaw/kit/node.hpp", False, False),
            ("host_mock/host/contact/law.cpp", "ilaw/loader.hpp", False, True),
            ("host_mock/host/results/history.cpp", "stress/stress.hpp", True, False),
            ("host_mock/instruments/stress/stress.cpp", "check/check.hpp", True, False),
            ("host_mock/cli/check.cpp", "check/check.hpp", True, True),
            ("api/check/report.cpp", "check/check.hpp", True, True),
            ("api/check/report.cpp", "base/files.hpp", True, False),
            ("api/loader/library.cpp", "check/check.hpp", True, False),
            ("api/loader/library.cpp", "ilaw/kit.hpp", False, False),
            ("api/search/search.cpp", "ilaw/search.h", False, True),
            ("api/search/search.cpp", "ilaw/coupled.h", False, False),
            ("host_mock/host/surface/mortar_surface.cpp", "model/model.hpp", True, True),
            ("host_mock/host/surface/mesh_surface.cpp", "contact/interface.hpp", True, False),
            ("api/include/ilaw/kit/plugin.hpp", "ilaw/kit/detail/instance.hpp", False, True),
            ("plugins/tie/tie.cpp", "ilaw/kit/detail/gather.hpp", False, False),
            ("plugins/tie/tie.cpp", "ilaw/kit/window.hpp", False, True),
            ("plugins/tie/tie.cpp", "../cohesive/root.hpp", True, False), ("plugins/tie/tie.cpp", "cmath", False, True),
        ):  # fmt: skip
            with self.subTest(file=file, header=header):
                self.assertEqual(complaint(file, header, quoted) == "", is_allowed)


if __name__ == "__main__":
    unittest.main()
