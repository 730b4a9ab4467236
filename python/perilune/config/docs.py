"""Descriptions of keys for the schema: the strings below the fields of its sections.

They are read on demand. pydantic would read the source of every section at import, which takes a
fifth of the import time."""

from __future__ import annotations

import ast
import inspect
import sys
from functools import lru_cache

from pydantic import BaseModel


@lru_cache
def _sections(module: str) -> dict[str, dict[str, str]]:
    """Class of a module -> field -> the string below it."""
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
    """Field -> description, including the fields of base classes."""
    texts: dict[str, str] = {}
    for base in reversed(section.__mro__):
        if issubclass(base, BaseModel) and base is not BaseModel:
            texts |= _sections(base.__module__).get(base.__name__, {})
    return texts
