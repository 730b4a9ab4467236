"""A copy of the whole project in build/guards, in which one file at a time is changed, built and
tried: what script/guards stands on. The code that users get has no switch."""

from __future__ import annotations

import contextlib
import importlib.util
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TREE = ROOT / "build" / "guards" / "tree"
BUILD = TREE / "build" / "c"
"""As deep below its root as script/test's: seen from there, all paths are equal, and ccache has
what the package and the C tests have compiled."""
LONGEST_S = 60.0
"""What takes longer hangs, which is noticed, unless it took a tenth of that with all guards."""
_MOST_BYTES = 12 << 30
"""Address space of what is tried: naive code may ask for all memory."""
_COPIED = ("csrc", "tests/c", "tests/fuzz", "python")
_LINKED = ("assets", "configs", "docs", "CMakeLists.txt", "pyproject.toml")
# Naive code may leave something unused; the flags stay, so that ccache has all other files.
_NO_WARNINGS = "".join(
    f'#pragma GCC diagnostic ignored "-W{name}"\n'
    for name in (
        "unused-variable",
        "unused-but-set-variable",
        "unused-const-variable",
        "unused-function",
        "unused-parameter",
        "conversion",
        "sign-compare",
        "maybe-uninitialized",
    )
)
_C_LINE = re.compile(r"^\[ +(RUN|OK|SKIPPED) +\] (\w+)", re.M)
_PY_LINE = re.compile(r"^tests/(\S+?\.py::\w+)(\[.*?\])?(?: ([A-Z]+)\b.*)?\s*$", re.M)


class TrialError(Exception):
    """The words of the compiler, or of pytest where it found nothing to run."""


_limits_s: dict[str, float] = {}
"""By file of tests."""


def _run(
    command: Sequence[str | Path], limit_s: float = 3600.0, **environment: str
) -> tuple[int | None, str]:
    """Status and output; the status is None for a program that hangs."""
    with subprocess.Popen(
        [str(word) for word in command],
        cwd=ROOT,
        env=os.environ | environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        start_new_session=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (_MOST_BYTES, _MOST_BYTES)),
    ) as process:
        try:
            said = process.communicate(timeout=limit_s)[0]
            return process.returncode, said
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            return None, process.communicate()[0]


def _copy_what_changed(name: str) -> None:
    """Files that are equal keep their times, and are not built again."""
    before = {path for path in (TREE / name).rglob("*") if path.is_file()}
    for path in sorted((ROOT / name).rglob("*")):
        target = TREE / path.relative_to(ROOT)
        before.discard(target)
        if not path.is_file() or path.suffix in (".pyc", ".so"):
            continue
        if not target.is_file() or target.read_bytes() != path.read_bytes():
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, target)
    for path in before:
        if path.suffix != ".pyc":
            path.unlink()


def prepare(targets: Sequence[str]) -> None:
    """Brings the copy and its builds up to date."""
    for name in _COPIED:
        _copy_what_changed(name)
    for name in _LINKED:
        with contextlib.suppress(FileExistsError):
            (TREE / name).symlink_to(ROOT / name)
    options = ("-DPERILUNE_TESTS=ON", "-DPERILUNE_EXTENSION=ON", "-DPERILUNE_WERROR=ON")
    python = f"-DPython_EXECUTABLE={sys.executable}"
    command = ["cmake", "-S", TREE, "-B", BUILD, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release"]
    subprocess.run([*command, *options, python], check=True, stdout=subprocess.DEVNULL)
    environment = os.environ | {"CCACHE_BASEDIR": str(TREE), "CCACHE_NOHASHDIR": "1"}
    build = ["cmake", "--build", str(BUILD), "--target", *targets]
    subprocess.run(build, check=True, env=environment, stdout=subprocess.DEVNULL)
    module = TREE / "python" / "perilune" / "_core.abi3.so"
    with contextlib.suppress(FileExistsError):
        module.symlink_to(BUILD / "_core.abi3.so")


def build(targets: Sequence[str]) -> None:
    """Builds programs of C tests, and `_core` for Python's."""
    command = ["cmake", "--build", BUILD, "--target", *targets]
    status, said = _run(command, CCACHE_BASEDIR=str(TREE), CCACHE_NOHASHDIR="1")
    if status != 0:
        raise TrialError(said[-3000:])


@contextlib.contextmanager
def changed(file: str, text: str, naive: str) -> Iterator[None]:
    """The copy with a piece of a file replaced."""
    path = TREE / file
    whole = path.read_text(encoding="utf-8")
    pragmas = "" if path.suffix == ".py" else f"{_NO_WARNINGS}#line 1\n"
    try:
        _write(path, pragmas + whole.replace(text, naive))
        yield
    finally:
        _write(path, whole)


def _write(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8")
    if path.suffix == ".py":  # its time may be that of the compiled one, to the second
        Path(importlib.util.cache_from_source(str(path))).unlink(missing_ok=True)


def targets_of(tests: Sequence[str]) -> list[str]:
    """What to build for tests, FILE::NAME below tests/."""
    programs = {Path(test.partition("::")[0]).stem for test in tests if test.startswith("c/")}
    python = any(not test.startswith("c/") for test in tests)
    return sorted(programs) + ["_core"] * python


def failures(tests: Sequence[str]) -> set[str]:
    """Tests that fail, crash or hang: of the asked ones of Python, and of all C tests in the same
    programs."""
    found: set[str] = set()
    for file in sorted({test.partition("::")[0] for test in tests}):
        if file.startswith("c/"):
            found |= {f"{file}::{name}" for name in _failures_of_c(file)}
        else:
            own = [test for test in tests if test.startswith(f"{file}::")]
            found |= _failures_of_python(file, own)
    return found


def measure(tests: Sequence[str]) -> set[str]:
    """The same with all guards, however long it takes; ten times as long is a hang from then on."""
    found: set[str] = set()
    for file in sorted({test.partition("::")[0] for test in tests}):
        began = time.monotonic()
        _limits_s[file] = 3600.0
        found |= failures([test for test in tests if test.startswith(f"{file}::")])
        _limits_s[file] = max(LONGEST_S, 10.0 * (time.monotonic() - began))
    return found


def _failures_of_c(file: str) -> set[str]:
    """Names that began and did not end well. By lines, so that those before a crash are seen."""
    limit_s = _limits_s.get(file, LONGEST_S)
    said = _run(["stdbuf", "-oL", BUILD / Path(file).stem], limit_s)[1]
    began, ended = set(), set()
    for what, name in _C_LINE.findall(said):
        (began if what == "RUN" else ended).add(name)
    if not began:
        raise TrialError(said[-3000:])
    return began - ended


def _failures_of_python(file: str, tests: Sequence[str]) -> set[str]:
    options = ("-v", "--tb=no", "-p", "no:cacheprovider", "-p", "no:xdist", "--no-header")
    nodes = [f"tests/{test}" for test in tests]
    limit_s = _limits_s.get(file, LONGEST_S)
    command = [sys.executable, "-m", "pytest", *options, *nodes]
    status, said = _run(command, limit_s, PYTHONPATH=str(TREE / "python"), PERILUNE_SOAK="1")
    seen = _PY_LINE.findall(said)
    if not seen or status not in (0, 1, None, -11, -6, -8, 139, 134):
        raise TrialError(said[-3000:])
    good = ("PASSED", "SKIPPED", "XFAIL")
    failed = [(name, instance) for name, instance, verdict in seen if verdict not in good]
    return {name for name, _ in failed} | {name + instance for name, instance in failed}
