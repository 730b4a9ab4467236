"""No source file grows past what can be read in one sitting."""

from __future__ import annotations

from pathlib import Path

import pytest

MAX_LINES = 600
FOLDERS = ("csrc", "python", "tests", "benchmarks", "assets", "script")
SUFFIXES = {".c", ".h", ".cpp", ".hpp", ".py", ".pyi", ""}


def too_long(root: Path) -> list[str]:
    """Files of ours over the limit, with their length."""
    found = []
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix not in SUFFIXES or not path.is_file() or "corpus" in path.parts:
                continue
            if path.parent.suffix == ".egg-info":  # written by the installation
                continue
            lines = path.read_bytes().count(b"\n")
            if lines > MAX_LINES:
                found.append(f"{path.relative_to(root)}: {lines} lines")
    return found


def test_no_file_is_too_long(repo_dir: Path) -> None:
    assert too_long(repo_dir) == []


@pytest.mark.parametrize(("lines", "fails"), [(MAX_LINES, False), (MAX_LINES + 1, True)])
def test_the_check_sees_a_long_file(tmp_path: Path, lines: int, fails: bool) -> None:
    (tmp_path / "csrc" / "base").mkdir(parents=True)
    (tmp_path / "csrc" / "base" / "long.c").write_text("\n" * lines)
    assert bool(too_long(tmp_path)) == fails
