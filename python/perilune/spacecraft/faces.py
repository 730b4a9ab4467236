"""Visible sides of a model's faces, by the names of its materials."""

from __future__ import annotations

import fnmatch
from collections.abc import Callable, Iterator, Sequence

from perilune.config.errors import nearest
from perilune.config.faces import DEFAULT, Faces, Sides


def _matches(pattern: str, name: str) -> bool:
    return fnmatch.fnmatchcase(name.lower(), pattern.lower())


def _sides_of(faces: Faces, name: str) -> Sides:
    """Sides of the first pattern that matches, or the default."""
    if isinstance(faces, str):
        return faces
    return next((sides for pattern, sides in faces.items() if _matches(pattern, name)), DEFAULT)


def sides(faces: Faces) -> Callable[[str, bool], bool]:
    """For _core.Model: (a material's name, whether the file has it double-sided) -> whether rays
    hit the backs of its faces."""

    def answer(name: str, double_sided: bool) -> bool:
        chosen = _sides_of(faces, name)
        return double_sided if chosen == "as_stated" else chosen == "double_sided"

    return answer


def unmatched(faces: Faces, materials: Sequence[str]) -> Iterator[tuple[str, str]]:
    """(pattern, message) for patterns that match no material, or only ones that earlier patterns
    match."""
    if isinstance(faces, str):
        return
    first = {name: next((p for p in faces if _matches(p, name)), None) for name in materials}
    for pattern in faces:
        fits = [name for name in materials if _matches(pattern, name)]
        if not fits:
            near = nearest(pattern, dict.fromkeys(materials))
            yield pattern, f"no material fits '{pattern}'{near}"
        elif pattern not in first.values():
            yield pattern, f"does nothing: patterns before it fit all of '{pattern}'"
