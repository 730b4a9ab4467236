"""What MkDocs calls while it builds the site: fills in the pages that are made from something else.

A page of the table below says in its own text where its content comes from, so that it also reads
well in the repository; the build puts the content behind that text.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

from schema_pages import reference

ROOT = Path(__file__).resolve().parents[2]


def _file(name: str) -> Callable[[], str]:
    def text() -> str:
        """Without its title, with links as they are from docs/."""
        body = (ROOT / name).read_text().split("\n", 1)[1]
        return re.sub(r"\]\(docs/", "](", body)

    return text


CONTENT: dict[str, Callable[[], str]] = {
    "configuration_reference.md": reference,
    "core.md": _file("csrc/README.md"),
    "changelog.md": _file("CHANGELOG.md"),
}
"""Page -> what the build appends to it."""


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """The text of a page, with its generated part."""
    content = CONTENT.get(page.file.src_path)
    return f"{markdown}\n\n{content()}" if content else markdown
