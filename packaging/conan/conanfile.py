# SPDX-License-Identifier: MIT
"""The runtime, all that ships in C++, and the Faust libraries of generated/, of the tree that this recipe is in. Without the
program, which writes the other Faust libraries."""

import os
import re

from conan import ConanFile
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy, load


class ContactSpline(ConanFile):
    name = "contactspline"
    license = "MIT"
    description = "Energy-exact collisions in musical instruments, for Faust and C++"
    package_type = "static-library"
    settings = "os", "compiler", "build_type", "arch"
    options = {"simd": [True, False], "threads": [True, False]}
    default_options = {"simd": True, "threads": False}

    @property
    def _tree(self):
        return os.path.join(self.recipe_folder, "..", "..")

    def set_version(self):
        self.version = re.search(r"^version: (.+)$", load(self, os.path.join(self._tree, "CITATION.cff")), re.M).group(1)

    def export_sources(self):
        copy(self, "*", src=self._tree, dst=self.export_sources_folder, excludes=("build/*", "out/*", ".git/*"))

    def requirements(self):
        if self.options.simd:
            self.requires("highway/[>=1.0]")
        if self.options.threads:
            self.requires("onetbb/[>=2021.4]", transitive_headers=True)

    def layout(self):
        cmake_layout(self)

    def generate(self):
        toolchain = CMakeToolchain(self)
        for part in ("GENERATOR", "FIT", "DATASETS", "TESTS", "EXAMPLES"):
            toolchain.cache_variables[f"CONTACTSPLINE_BUILD_{part}"] = False
        toolchain.cache_variables["CONTACTSPLINE_BUILD_SIMD"] = bool(self.options.simd)
        toolchain.cache_variables["CONTACTSPLINE_BUILD_THREADS"] = bool(self.options.threads)
        toolchain.generate()
        CMakeDeps(self).generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        CMake(self).install()
        copy(self, "LICENSE", src=self.source_folder, dst=os.path.join(self.package_folder, "licenses"))

    def package_info(self):
        # find_package(ContactSpline) finds the package's own files.
        self.cpp_info.set_property("cmake_find_mode", "none")
        self.cpp_info.builddirs = [os.path.join("lib", "cmake", "ContactSpline")]
