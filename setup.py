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


class CMakeBuild(build_ext):
    """Runs CMake for the one extension and puts the module where setuptools expects it."""

    def build_extension(self, ext: Extension) -> None:
        import numpy

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
        subprocess.run(configure, check=True)
        subprocess.run(
            ["cmake", "--build", str(BUILD), "--target", "_core", "--parallel", jobs], check=True
        )
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
