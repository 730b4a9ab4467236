"""Results that are kept as long as what they were made from is the same object."""

from __future__ import annotations

from collections.abc import Callable
from operator import is_
from typing import Generic, TypeVar

T = TypeVar("T")


class Same(Generic[T]):
    """The last few results by the identity of objects that never change, as sections of a
    configuration: frames share those that no driver changes."""

    def __init__(self, size: int = 4) -> None:
        self._size = size
        self._rows: dict[tuple[int, ...], tuple[tuple[object, ...], T]] = {}

    def of(self, parts: tuple[object, ...], make: Callable[[], T]) -> T:
        """The result for some objects, made when it is not there."""
        key = tuple(map(id, parts))
        found = self._rows.get(key)
        if found is None:
            value = make()
            for old in list(self._rows)[: max(0, len(self._rows) + 1 - self._size)]:
                self._rows.pop(old, None)
            # The row holds the objects, so that no other one can have their identity.
            found = self._rows[key] = parts, value
        return found[1]


class Latest(Generic[T]):
    """The last result of each name, by the identity of objects that never change."""

    def __init__(self) -> None:
        self._rows: dict[str, tuple[tuple[object, ...], T]] = {}

    def of(self, name: str, parts: tuple[object, ...], make: Callable[[], T]) -> T:
        """The result of a name for some objects, made when they are others than before."""
        found = self._rows.get(name)
        if found is None or not all(map(is_, found[0], parts)):
            found = self._rows[name] = parts, make()
        return found[1]
