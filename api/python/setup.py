"""Builds a pure wheel, or one of this platform where CMake's component `wheel` has put the libraries into ilaw/lib."""
# SPDX-License-Identifier: BSD-3-Clause

from pathlib import Path

from setuptools import Distribution, setup

try:
    from setuptools.command.bdist_wheel import bdist_wheel
except ImportError:  # setuptools before 70.1
    from wheel.bdist_wheel import bdist_wheel


class WithLibraries(Distribution):
    def has_ext_modules(self):
        return True


class PlatformWheel(bdist_wheel):
    def get_tag(self):
        # The libraries are opened by ctypes: they serve every Python 3 of this platform.
        return "py3", "none", super().get_tag()[2]


if (Path(__file__).parent / "ilaw" / "lib").is_dir():
    setup(distclass=WithLibraries, cmdclass={"bdist_wheel": PlatformWheel})
else:
    setup()
