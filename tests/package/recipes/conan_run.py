# SPDX-License-Identifier: MIT
"""conan_run.py RECIPE FOLDER: calls the methods of a conanfile.py in the order of `conan create`, with the part of Conan's
interface that it uses, by the same commands of CMake. A name that is not part of it is an error."""
import fnmatch
import importlib.util
import pathlib
import shutil
import subprocess
import sys
import types

recipe, work = map(pathlib.Path, sys.argv[1:])


class CppInfo:
    def set_property(self, name, value):
        assert (name, value) == ("cmake_find_mode", "none")


class ConanFile:
    def __init__(self):
        self.recipe_folder = str(recipe.resolve().parent)
        self.export_sources_folder = str(work / "sources")
        self.source_folder = str(work / "sources")
        self.package_folder = str(work / "package")
        self.options = types.SimpleNamespace(**{**self.default_options, "simd": False})
        self.cpp_info = CppInfo()
        self.required = []

    def requires(self, reference, transitive_headers=False):
        self.required.append(reference)


class CMakeToolchain:
    def __init__(self, conanfile):
        self.conanfile, self.cache_variables = conanfile, {}

    def generate(self):
        self.conanfile.cache_variables = self.cache_variables


class CMakeDeps:
    def __init__(self, conanfile):
        pass

    def generate(self):
        pass


class CMake:
    def __init__(self, conanfile):
        self.conanfile = conanfile

    def configure(self):
        options = [f"-D{name}={'ON' if value else 'OFF'}" for name, value in self.conanfile.cache_variables.items()]
        subprocess.run(["cmake", "-S", self.conanfile.source_folder, "-B", work / "build", "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                        f"-DCMAKE_INSTALL_PREFIX={self.conanfile.package_folder}", "-DCMAKE_INSTALL_LIBDIR=lib", *options], check=True)

    def build(self):
        subprocess.run(["cmake", "--build", work / "build"], check=True)

    def install(self):
        subprocess.run(["cmake", "--install", work / "build"], check=True)


def copy(conanfile, pattern, src, dst, excludes=()):
    names = subprocess.run(["git", "-C", src, "ls-files"], stdout=subprocess.PIPE, text=True).stdout.split("\n") if pattern == "*" else [pattern]
    kept = [n for n in names if n and not any(fnmatch.fnmatch(n, e) for e in excludes) and (pathlib.Path(src) / n).is_file()]
    assert kept, f"{pattern}: no file in {src}"
    for name in kept:
        (pathlib.Path(dst) / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(pathlib.Path(src) / name, pathlib.Path(dst) / name)


modules = {
    "conan": {"ConanFile": ConanFile},
    "conan.tools": {},
    "conan.tools.cmake": {"CMake": CMake, "CMakeDeps": CMakeDeps, "CMakeToolchain": CMakeToolchain, "cmake_layout": lambda conanfile: None},
    "conan.tools.files": {"copy": copy, "load": lambda conanfile, path: pathlib.Path(path).read_text()},
}
for name, members in modules.items():
    sys.modules[name] = types.ModuleType(name)
    vars(sys.modules[name]).update(members)

sys.dont_write_bytecode = True
spec = importlib.util.spec_from_file_location("conanfile", recipe)
module = importlib.util.module_from_spec(spec)
spec.loader.exec_module(module)
conanfile = module.ContactSpline()
for step in ("set_version", "export_sources", "requirements", "layout", "generate", "build", "package", "package_info"):
    getattr(conanfile, step)()
assert (pathlib.Path(conanfile.package_folder) / conanfile.cpp_info.builddirs[0] / "ContactSplineConfig.cmake").exists()
print(f"{conanfile.name}/{conanfile.version}")
