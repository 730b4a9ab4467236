"""The README and the pages of docs/: their text, and the blocks of code in it."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
DOCS = ROOT / "docs"
PAGES = {"README": ROOT / "README.md", **{p.stem: p for p in sorted(DOCS.glob("*.md"))}}
"""Name of a page -> its file."""

_BLOCK = re.compile(
    r"(?:<!-- not run: (?P<why>[^\n]*) -->\n+)?"
    r'```(?P<language>\w+)(?: title="(?P<title>[^"]*)")?\n(?P<code>.*?)```',
    re.DOTALL,
)


@dataclass(frozen=True)
class Block:
    """A block of code."""

    page: str
    language: str
    code: str
    title: str
    """Of YAML: the key that the fragment stands below, and maybe the file: `FILE: KEY`."""
    not_run: str
    """Why it cannot run, from a comment before the block; empty where it runs."""


def text_of(page: str) -> str:
    return PAGES[page].read_text()


def blocks(page: str) -> list[Block]:
    """The blocks of a page in their order."""
    return [
        Block(page, found["language"], found["code"], found["title"] or "", found["why"] or "")
        for found in _BLOCK.finditer(text_of(page))
    ]


def all_blocks(language: str) -> list[Block]:
    return [b for page in PAGES for b in blocks(page) if b.language == language]
