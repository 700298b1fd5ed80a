# SPDX-License-Identifier: MIT
"""What pip calls to build the package (PEP 517): CMake builds and installs it into a folder, which becomes a wheel.

It needs no network and no package of Python.
"""

import base64
import hashlib
import pathlib
import re
import subprocess
import sys
import sysconfig
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    """Writes what pip reads before the package is built. Returns the name of its folder."""
    version = re.search(r"^version: (\S+)$", (ROOT / "CITATION.cff").read_text(), re.MULTILINE)[1]
    info = pathlib.Path(metadata_directory) / f"contactspline-{version}.dist-info"
    info.mkdir()
    (info / "METADATA").write_bytes(_metadata(version))
    return info.name


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Builds the wheel in build/wheel, or in the folder of the setting build-dir, which may have built it already. Returns its name."""
    settings = config_settings or {}
    unknown = sorted(set(settings) - {"build-dir"})
    if unknown:
        raise ValueError(f"config setting {unknown[0]}: is unknown; allowed: build-dir, such as build-dir=build/wheel")
    build = pathlib.Path(settings.get("build-dir", ROOT / "build" / "wheel")).absolute()
    if not _is_configured(build):
        subprocess.run(["cmake", "--preset", "program", "-B", build, "-DCONTACTSPLINE_BUILD_PYTHON=ON",
                        f"-DPython_EXECUTABLE={sys.executable}"], cwd=ROOT, check=True)
    subprocess.run(["cmake", "--build", build, "--target", "contactspline_python"], check=True)
    with tempfile.TemporaryDirectory() as stage:
        subprocess.run(["cmake", "--install", build, "--component", "python", "--prefix", stage], check=True)
        version = (pathlib.Path(stage) / "contactspline" / "VERSION").read_text().strip()
        abi = f"cp{sys.version_info.major}{sys.version_info.minor}"
        platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
        tag = f"{abi}-{abi}-{platform}"
        return _write(pathlib.Path(wheel_directory), pathlib.Path(stage), version, tag)


def _is_configured(build):
    """Whether a folder builds the package for this Python."""
    cache = build / "CMakeCache.txt"
    settings = cache.read_text().splitlines() if cache.exists() else []
    return "CONTACTSPLINE_BUILD_PYTHON:BOOL=ON" in settings and any(
        re.fullmatch(f"Python_EXECUTABLE:[A-Z]+={re.escape(sys.executable)}", line) for line in settings)


def _write(directory, stage, version, tag):
    info = f"contactspline-{version}.dist-info"
    files = {str(path.relative_to(stage)): path.read_bytes() for path in sorted(stage.rglob("*")) if path.is_file()}
    files[f"{info}/METADATA"] = _metadata(version)
    files[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: contactspline\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
    rows = [f"{name},sha256={_digest(content)},{len(content)}" for name, content in files.items()]
    files[f"{info}/RECORD"] = "\n".join([*rows, f"{info}/RECORD,,", ""]).encode()
    name = f"contactspline-{version}-{tag}.whl"
    with zipfile.ZipFile(directory / name, "w") as wheel:
        for path, content in files.items():
            wheel.writestr(zipfile.ZipInfo(path), content, zipfile.ZIP_DEFLATED)
    return name


def _metadata(version):
    return (f"Metadata-Version: 2.1\nName: contactspline\nVersion: {version}\n"
            "Summary: Collisions of musical instruments, solved in closed form\nLicense: MIT\n"
            "Requires-Python: >=3.9\nRequires-Dist: numpy\n").encode()


def _digest(content):
    return base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
