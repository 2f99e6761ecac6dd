# SPDX-License-Identifier: BSD-3-Clause
import os

from conan import ConanFile
from conan.errors import ConanInvalidConfiguration
from conan.tools.build import check_min_cppstd
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy

TREE = ["CMakeLists.txt", "LICENSE", "api/*", "plugins/*", "docs/man/*", "docs/template_repository/*"]


class Ilaw(ConanFile):
    name = "ilaw"
    version = "1.0.0"
    description = "Interface laws (contact, friction, adhesion) as shared libraries for explicit dynamics codes"
    license = "BSD-3-Clause"
    homepage = url = "https://example.org/ilaw"
    topics = ("contact-mechanics", "friction", "explicit-dynamics")
    package_type = "shared-library"
    settings = "os", "arch", "compiler", "build_type"

    def export_sources(self):
        root = os.path.join(self.recipe_folder, "..", "..", "..")
        for pattern in TREE:
            copy(self, pattern, root, self.export_sources_folder)

    def validate(self):
        check_min_cppstd(self, 20)
        if self.settings.os != "Linux":
            raise ConanInvalidConfiguration("ilaw is tested on Linux alone")

    def layout(self):
        cmake_layout(self)

    def generate(self):
        CMakeDeps(self).generate()
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables.update({"ILAW_HOST": False, "ILAW_TESTS": False, "ILAW_LAMMPS": False})
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        CMake(self).install()
        copy(self, "LICENSE", self.source_folder, os.path.join(self.package_folder, "licenses"))

    def package_info(self):
        # find_package finds the package's own file.
        self.cpp_info.set_property("cmake_find_mode", "none")
        self.cpp_info.builddirs = [os.path.join("lib", "cmake", "ilaw")]
        self.runenv_info.prepend_path("ILAW_PATH", os.path.join(self.package_folder, "lib", "ilaw"))
