"""Names that users choose: of spacecraft, bodies, materials, sensors, levels."""

from __future__ import annotations

import unicodedata

RULE = "a name is letters of any script, digits, _ and -, no digit first, nor -"


def problem_of(name: str) -> str | None:
    """What is wrong with a name; None: nothing. Names become files, layers and columns: so one has
    no space, slash, dot or control character, and one form of its letters only (NFC of Unicode
    annex 15), since disks and readers differ in what they take for equal."""
    if not name.replace("-", "_").isidentifier() or name.startswith("-"):
        return RULE
    if not unicodedata.is_normalized("NFC", name):
        return f"letters with marks must be composed (NFC): {unicodedata.normalize('NFC', name)}"
    return None
