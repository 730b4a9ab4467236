"""What the schema's texts say of each key: the strings below the fields of its sections.

pydantic would read the source of every section when it is imported, a fifth of the time that takes.
"""

from __future__ import annotations

import ast
import inspect
import sys
from functools import lru_cache

from pydantic import BaseModel


@lru_cache
def _sections(module: str) -> dict[str, dict[str, str]]:
    """Name of a class of a module -> field -> the text below it."""
    tree = ast.parse(inspect.getsource(sys.modules[module]))
    found: dict[str, dict[str, str]] = {}
    for section in tree.body:
        if isinstance(section, ast.ClassDef):
            texts = found.setdefault(section.name, {})
            for row, below in zip(section.body, section.body[1:], strict=False):
                if isinstance(row, ast.AnnAssign) and isinstance(row.target, ast.Name):
                    text = below.value if isinstance(below, ast.Expr) else None
                    if isinstance(text, ast.Constant) and isinstance(text.value, str):
                        texts[row.target.id] = inspect.cleandoc(text.value)
    return found


def described(section: type[BaseModel]) -> dict[str, str]:
    """Field -> its text, of those that have one; those of base classes too."""
    texts: dict[str, str] = {}
    for base in reversed(section.__mro__):
        if issubclass(base, BaseModel) and base is not BaseModel:
            texts |= _sections(base.__module__).get(base.__name__, {})
    return texts
