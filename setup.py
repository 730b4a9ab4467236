"""Builds the extension `perilune._core` with CMake; everything else is in pyproject.toml."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).resolve().parent
# Kept between builds, so that only what changed is compiled again.
BUILD = Path(os.environ.get("PERILUNE_BUILD_DIR", ROOT / "build" / "extension"))


def run(command: list[str]) -> None:
    """Runs a command; its failure ends the build without a traceback, which would hide it."""
    status = subprocess.run(command).returncode
    if status != 0:
        sys.exit(f"failed with status {status}: {' '.join(command)}")


class CMakeBuild(build_ext):
    """Runs CMake for the one extension and puts the module where setuptools expects it."""

    def build_extension(self, ext: Extension) -> None:
        import numpy

        if shutil.which("cmake") is None:
            sys.exit("building perilune needs cmake, a C and a C++ compiler; see script/common.sh")
        jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL", str(os.cpu_count() or 1))
        configure = [
            "cmake",
            "-S",
            str(ROOT),
            "-B",
            str(BUILD),
            f"-DPython_EXECUTABLE={sys.executable}",
            f"-DPERILUNE_NUMPY_INCLUDE={numpy.get_include()}",
        ]
        if not (BUILD / "CMakeCache.txt").exists() and shutil.which("ninja"):
            configure += ["-G", "Ninja"]
        run(configure)
        run(["cmake", "--build", str(BUILD), "--target", "_core", "--parallel", jobs])
        target = Path(self.get_ext_fullpath(ext.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        # Replaced by rename: a process that has the old module loaded keeps its own copy.
        fresh = target.with_name(target.name + ".new")
        shutil.copy2(BUILD / "_core.abi3.so", fresh)
        fresh.replace(target)


def extensions() -> list[Extension]:
    """The extension, once it has sources."""
    if not any((ROOT / "csrc" / "pyext").glob("*.c")):
        return []
    return [Extension("perilune._core", sources=[], py_limited_api=True)]


setup(
    ext_modules=extensions(),
    cmdclass={"build_ext": CMakeBuild},
    options={"bdist_wheel": {"py_limited_api": "cp311"}},
)
