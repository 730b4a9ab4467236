"""Builds the extension `perilune._core` with CMake, and puts what comes with Perilune into wheels;
everything else is in pyproject.toml."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext
from setuptools.command.build_py import build_py

ROOT = Path(__file__).resolve().parent
# Kept between builds, so that only what changed is compiled again.
BUILD = Path(os.environ.get("PERILUNE_BUILD_DIR", ROOT / "build" / "extension"))
# A wheel holds these below perilune/shipped (python/perilune/document/shipped.py looks there).
SHIPPED = ("configs", "assets")


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
            f"-DPERILUNE_WERROR={os.environ.get('PERILUNE_WERROR', 'OFF')}",
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


class BuildWithShipped(build_py):
    """Copies configurations and assets beside the modules, without the scripts that make them."""

    def run(self) -> None:
        super().run()
        if self.editable_mode:  # modules are read from the source tree, and so are these
            return
        for name in SHIPPED:
            for path in sorted((ROOT / name).rglob("*")):
                if path.is_file() and path.suffix not in (".py", ".pyc"):
                    target = Path(self.build_lib) / "perilune" / "shipped" / path.relative_to(ROOT)
                    target.parent.mkdir(parents=True, exist_ok=True)
                    shutil.copy2(path, target)


def check_source_tree() -> None:
    """A package without its core is no package: whatever is built needs the whole tree."""
    needed = ["CMakeLists.txt", "csrc/pyext/module.c", *(f"{name}/" for name in SHIPPED)]
    missing = [name for name in needed if not (ROOT / name).exists()]
    if missing:
        sys.exit(f"perilune cannot be built from {ROOT}: {', '.join(missing)} is missing")


check_source_tree()
setup(
    ext_modules=[Extension("perilune._core", sources=[], py_limited_api=True)],
    cmdclass={"build_ext": CMakeBuild, "build_py": BuildWithShipped},
    options={"bdist_wheel": {"py_limited_api": "cp311"}},
)
