"""What the core shows: `pl_` names to the linker, one entry point outside; no function without a
user in headers."""

from __future__ import annotations

import os
import re
import subprocess
from collections import Counter
from pathlib import Path

import pytest

# nm -A: "library:member:address type name"
LINE = re.compile(r"^.*?:(?P<member>[^:]+):\s*[0-9a-f]*\s+(?P<type>\S)\s+(?P<name>\S+)")


def nm(*arguments: str) -> list[str]:
    """Output lines of nm."""
    run = subprocess.run(["nm", *arguments], check=True, capture_output=True, text=True)
    return run.stdout.splitlines()


def foreign_symbols(library: Path) -> list[str]:
    """External symbols of the library without our prefix: all of C objects, the C ones of C++."""
    found = []
    for line in nm("-A", "--defined-only", "--extern-only", str(library)):
        match = LINE.match(line)
        if match is None:
            continue
        member, name = match["member"], match["name"]
        mangled = name.startswith(("_Z", "DW.ref."))
        if (member.endswith(".c.o") or not mangled) and not name.startswith("pl_"):
            found.append(f"{member}: {name}")
    return found


@pytest.fixture(scope="module")
def build_dir(repo_dir: Path) -> Path:
    """Where setup.py builds."""
    return Path(os.environ.get("PERILUNE_BUILD_DIR", repo_dir / "build" / "extension"))


def test_external_symbols_carry_the_prefix(build_dir: Path) -> None:
    library = build_dir / "libperilune_core.a"
    assert library.exists(), f"{library}: not built yet (script/test builds it)"
    members = {match["member"] for line in nm("-A", str(library)) if (match := LINE.match(line))}
    assert "memory.c.o" in members
    assert foreign_symbols(library) == []


def test_the_extension_exports_its_entry_point_alone(repo_dir: Path) -> None:
    module = repo_dir / "python" / "perilune" / "_core.abi3.so"
    names = [line.split()[-1] for line in nm("-D", "--defined-only", str(module))]
    assert names == ["PyInit__core"]


def test_the_check_sees_a_foreign_symbol(tmp_path: Path) -> None:
    (tmp_path / "a.c").write_text(
        "int helper(void);\nint pl_good(void);\nstatic int hidden;\n"
        "int helper(void) { return hidden; }\nint pl_good(void) { return 1; }\n"
    )
    (tmp_path / "b.cpp").write_text(
        'namespace x { int mangled() { return 1; } }\nextern "C" int plain() { return 2; }\n'
    )
    for source in ("a.c", "b.cpp"):
        subprocess.run(["gcc", "-c", source, "-o", f"{source}.o"], cwd=tmp_path, check=True)
    subprocess.run(["ar", "qc", "lib.a", "a.c.o", "b.cpp.o"], cwd=tmp_path, check=True)
    assert foreign_symbols(tmp_path / "lib.a") == ["a.c.o: helper", "b.cpp.o: plain"]


COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*", re.DOTALL)
DECLARED = re.compile(r"^(?!typedef|static|\s)[\w ]+?[ *]+(pl_\w+)\([^{};]*\);", re.MULTILINE)
WORD = re.compile(r"\bpl_\w+")
# What tests alone call, and why.
FOR_TESTS = {"pl_memory_hook": "lets allocations fail"}


def idle_functions(csrc: Path) -> list[str]:
    """Functions that headers declare and no file of the core calls."""
    sources = [path for path in sorted(csrc.rglob("*")) if path.suffix in {".c", ".h", ".cpp"}]
    texts = {path: COMMENT.sub("", path.read_text()) for path in sources}
    uses = Counter(word for text in texts.values() for word in WORD.findall(text))
    return [
        f"{header.name}: {name} is used by nothing but tests"
        for header in sources
        if header.suffix == ".h"
        for name in DECLARED.findall(texts[header])
        if uses[name] <= 2 and name not in FOR_TESTS  # its declaration and its definition
    ]


def test_the_core_calls_what_headers_declare(repo_dir: Path) -> None:
    assert idle_functions(repo_dir / "csrc") == []


def test_the_check_sees_functions_without_users(tmp_path: Path) -> None:
    (tmp_path / "a.h").write_text("int pl_used(void);\nint pl_tested(void);\n")
    (tmp_path / "a.c").write_text(
        "int pl_used(void) { return 1; }\nint pl_tested(void) { return 2; }\n"
    )
    (tmp_path / "b.c").write_text("int b(void) { return pl_used(); } /* pl_tested */\n")
    assert idle_functions(tmp_path) == ["a.h: pl_tested is used by nothing but tests"]
