# SPDX-License-Identifier: BSD-3-Clause
from spack.package import *


class Ilaw(CMakePackage):
    """Interface laws (contact, friction, adhesion) as shared libraries for explicit dynamics codes."""

    homepage = "https://example.org/ilaw"
    git = "https://example.org/ilaw.git"

    license("BSD-3-Clause")

    version("1.0.0", tag="v1.0.0")

    variant("host", default=False, description="Build the program ilaw and the checker of laws")

    depends_on("c", type="build")
    depends_on("cxx", type="build")
    depends_on("cmake@3.22:", type="build")
    with when("+host"):
        depends_on("eigen@3.4:")
        depends_on("nlohmann-json@3.11:")
        depends_on("cli11")
        depends_on("tinyxml2")
        depends_on("vtk@9:~mpi")
        depends_on("zlib-api")

    conflicts("platform=darwin", msg="tested on Linux alone")
    conflicts("platform=windows", msg="tested on Linux alone")

    def cmake_args(self):
        return [
            self.define_from_variant("ILAW_HOST", "host"),
            self.define("ILAW_TESTS", False),
            self.define("ILAW_LAMMPS", False),
        ]

    def setup_run_environment(self, env):
        env.prepend_path("ILAW_PATH", self.prefix.lib.ilaw)
