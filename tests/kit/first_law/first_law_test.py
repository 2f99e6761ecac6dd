"""docs/first_law.md and memory_law.md: what the pages show builds and works, from their own text."""
# SPDX-License-Identifier: BSD-3-Clause
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

import ilaw

ROOT, BUILD, CXX = (Path(os.environ[name]) for name in ("ILAW_SOURCE", "ILAW_BUILD", "CXX"))
PAGE, VISCOUS_C = ROOT / "docs/first_law.md", Path(os.environ["ILAW_VISCOUS_C"])


def block(language, page=PAGE):
    """The first code block of a page in a language."""
    return re.search(rf"```{language}\n(.*?)```", page.read_text(), re.S)[1]


def run(*command, **changes):
    done = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          env=os.environ | changes)  # fmt: skip
    if done.returncode:
        raise AssertionError(f"{command}\n{done.stdout}")


def configure(folder, ilaw_dir):
    """The page's project, to be built against an ilaw. Release would make all instruction sets."""
    folder.mkdir()
    (folder / "viscous.cpp").write_text(block("cpp"))
    (folder / "CMakeLists.txt").write_text(block("cmake"))
    run("cmake", "-S", folder, "-B", folder / "build", "-DCMAKE_BUILD_TYPE=Debug", "-DCMAKE_CXX_FLAGS_DEBUG=-O0",
        f"-DCMAKE_CXX_COMPILER={CXX}", "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON", f"-Dilaw_DIR={ilaw_dir}")  # fmt: skip


def expect_works(file):
    """r = -h c A/(1 + h c A H) v_free where the gap is closed; of a node that came with -0.9 v_free the tenth of -v_free/H,
    with which it leaves as fast."""
    v = np.tile([-1.0, 2.0, -3.0], (3, 1))
    law = ilaw.Interface(str(file), law="viscous", frame="local", velocity_step=0.01, viscosity=40.0)
    nodes = law.batch(v_free=v, v_previous=np.array([[0, 0, 0], [0, 0, 0], [0.9, -1.8, 2.7]]), delassus=0.5, area=2.0,
                      gap=np.array([-0.1, 0.1, -0.1]))  # fmt: skip
    nodes.initialise()
    nodes.evaluate(time=0.0)
    np.testing.assert_allclose(nodes.impulse, np.array([-0.8 / 1.4, 0, -0.2])[:, None] * v, rtol=0, atol=1e-15)


class FirstLaw(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.temporary.name)
        run("cmake", "--install", BUILD, "--prefix", cls.folder / "ilaw")
        configure(cls.folder / "law", cls.folder / "ilaw/lib/cmake/ilaw")

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def test_builds_against_an_installed_tree(self):
        for file in ("bin/ilaw", "lib/ilaw/contact.so", "include/ilaw/ilaw.h", "share/ilaw/fortran/ilaw.f90"):
            self.assertTrue((self.folder / "ilaw" / file).exists(), file)
        build = self.folder / "law/build"
        run("cmake", "--build", build)
        run("ctest", "--test-dir", build, "--no-tests=error", "--output-on-failure")
        expect_works(build / "lib/ilaw/viscous.so")
        # Random scenes, of which none may gain energy (docs/stability.md).
        run(BUILD / "bin/ilaw", "stress", "--scenes", 60, "--steps", 2000, "--law", "viscous", ILAW_PATH=f"{build}/lib/ilaw")

    def test_is_the_same_against_the_build_tree(self):
        """The same commands on the same headers: it need not be compiled once more."""
        configure(self.folder / "own", BUILD)
        installed = self.folder / "ilaw/include"
        for file in ("compile_commands.json", "CMakeFiles/viscous.dir/link.txt"):
            own, other = ((self.folder / name / "build" / file).read_text() for name in ("own", "law"))
            self.assertEqual(own.replace(str(self.folder / "own"), str(self.folder / "law")),
                             other.replace(str(installed), str(ROOT / "api/include")))  # fmt: skip
        run("diff", "-r", ROOT / "api/include", installed)
        self.assertIn(f"{BUILD}/bin/ilaw", (self.folder / "own/build/CTestTestfile.cmake").read_text())


class FirstLawPage(unittest.TestCase):
    def test_lists_all_names(self):
        """Every name that law_checks.hpp knows, on the page and at the top of law.hpp."""
        kit, page = ROOT / "api/include/ilaw/kit", PAGE.read_text()
        known = (kit / "detail/law_checks.hpp").read_text().split("// Names that the kit would pass over")[0]
        names = re.findall(r"ILAW_KIT_NAME\((\w+)\);", known)
        top = set(re.findall(r"\w+", (kit / "law.hpp").read_text().split("#pragma once")[0]))
        self.assertGreater(len(names), 20)
        self.assertEqual([name for name in names if f"`{name}`" not in page or name not in top], [])
        self.assertLessEqual(page.count("\n"), 150)


class ViscousLaw(unittest.TestCase):
    def test_in_plain_c_gives_the_same(self):
        expect_works(VISCOUS_C)
        for given, words in (({}, "parameter 'viscosity' is missing"), ({"viscosity": 1.0, "delassus": "full"}, "form 4 of H"),
                             ({"viscosity": -1.0}, "'viscosity' = -1 is not allowed: expected a number in [0, 1e+300]")):
            with self.assertRaisesRegex(ilaw.Error, re.escape(words)):
                ilaw.Interface(str(VISCOUS_C), law="viscous", frame="local", **given)

    def test_in_plain_c_keeps_every_rule(self):
        run(BUILD / "bin/ilaw", "check", VISCOUS_C)


class MemoryLawPage(unittest.TestCase):
    def test_builds_in_one_call_and_keeps_every_rule(self):
        """The command of the page, with this compiler; the check judges the balance of what is stored."""
        page = ROOT / "docs/memory_law.md"
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "glue.cpp").write_text(block("cpp", page))
            commands = block("sh", page).replace("PREFIX/include", f"{ROOT}/api/include").replace("g++", str(CXX))
            run("sh", "-ec", f"cd {folder}\n{commands}", PATH=f"{BUILD}/bin:{os.environ['PATH']}")


if __name__ == "__main__":
    unittest.main()
