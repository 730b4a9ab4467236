"""docs/data.md names the origin of every published file, docs/credits.md that of every picture."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FILES = (ROOT / "docs" / "data.md").read_text()
CREDITS = (ROOT / "docs" / "credits.md").read_text()


def rows(text: str) -> list[list[str]]:
    """The cells of every row of a section's tables."""
    found = [line for line in text.splitlines() if line.startswith("| `")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in found]


def listed_files() -> set[str]:
    paths = set()
    for cells in rows(FILES):
        first, *others = re.findall(r"`([^`]+)`", cells[0])
        paths |= {first, *(name if "/" in name else first + name for name in others)}
    return paths


def named_files() -> set[str]:
    """What configurations, documents and benchmarks name after `data:`, whole or in part."""
    sources = [p for f in ("configs", "docs", "benchmarks") for p in (ROOT / f).rglob("*")]
    texts = [p.read_text() for p in sources if p.suffix in (".yaml", ".json", ".py")]
    found = {
        name
        for text in texts
        for name in re.findall(r"data:(?!application/)([\w./-]+/[\w.-]*)", text)
    }
    return {name.rstrip(".") for name in found}


def test_every_file_has_a_publisher() -> None:
    known = listed_files()
    assert len(named_files()) > 15
    assert [name for name in named_files() if not any(k.startswith(name) for k in known)] == []
    assert [cells[0] for cells in rows(FILES) if len(cells) != 4 or not all(cells)] == []


def test_every_picture_is_credited_once() -> None:
    pictures = sorted(p.name for p in (ROOT / "docs" / "images").iterdir())
    cells = [row[0] for row in rows(CREDITS)]
    credited = sorted(name for cell in cells for name in re.findall(r"`([^`]+)`", cell))
    assert credited == pictures


def test_the_files_are_as_listed(data_dir: Path) -> None:
    assert [name for name in sorted(listed_files()) if not (data_dir / name).exists()] == []
