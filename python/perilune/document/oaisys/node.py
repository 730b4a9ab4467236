"""Reads a section of an OAISYS file key by key, so that unread keys can be reported.

Reading a key marks it; `close` warns of all others by their paths. `ignore` reports a key that is
read but not applied. The origin of our values is recorded for later errors."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from typing import Any, NoReturn

from perilune.config.errors import ConfigError, nearest

REQUIRED: Any = object()
"""As a default: the key is required."""
UNKNOWN = "has no counterpart here; it is not applied"


class OaisysWarning(UserWarning):
    """A key of an OAISYS file that is not applied, or is applied differently."""


class Notes:
    """Warnings about a file, and the origins of values in our configuration."""

    def __init__(self, source: str) -> None:
        self.source = source
        self.origins: dict[str, str] = {}
        """Key path of our configuration -> key path of the file; also of what is below it."""
        self._told: list[str] = []

    def warn(self, path: str, text: str) -> None:
        """Records a warning; `issue` issues all in order."""
        line = f"{self.source}: {path}: {text}"
        if line not in self._told:
            self._told.append(line)

    def issue(self) -> None:
        """Issues the warnings through Python's `warnings`, located at the caller that opens the
        file."""
        for line in self._told:
            warnings.warn(line, OaisysWarning, stacklevel=5)

    def fail(self, path: str, text: str) -> NoReturn:
        """Raises the error of a key."""
        raise ConfigError(f"{self.source}:\n  {path}: {text}")


class Node:
    """A mapping of the file with its path; a missing one reads as empty."""

    def __init__(self, raw: Mapping[str, Any], path: str, notes: Notes) -> None:
        self.raw = raw
        self.path = path
        self.notes = notes
        self._read: set[str] = set()
        self._below: list[Node] = []

    def where(self, key: str = "") -> str:
        """The path of a key, or of the mapping itself."""
        return f"{self.path}.{key}" if self.path and key else self.path or key

    def fail(self, key: str, text: str) -> NoReturn:
        """Raises the error of a key."""
        self.notes.fail(self.where(key), text)

    def ignore(self, key: str, why: str) -> None:
        """Marks a key as read, with a warning if it is there."""
        if key in self.raw:
            self._read.add(key)
            self.notes.warn(self.where(key), why)

    def has(self, key: str) -> bool:
        """Whether a key is there and not null."""
        return self.raw.get(key) is not None

    def comes(self, ours: str, key: str = "") -> None:
        """Records that our key `ours`, with everything below, comes from `key`."""
        self.notes.origins[ours] = self.where(key)

    def close(self) -> None:
        """Warns of all unread keys below."""
        for key in self.raw:
            if key not in self._read:
                self.notes.warn(self.where(key), UNKNOWN)
        for node in self._below:
            node.close()

    def get(self, key: str, default: Any = None) -> Any:
        """The raw value; null counts as missing."""
        self._read.add(key)
        value = self.raw.get(key)
        if value is not None:
            return value
        if default is REQUIRED:
            self.fail(key, "required, but missing")
        return default

    def number(self, key: str, default: Any = REQUIRED) -> float:
        """A finite number, also as [v]."""
        value = self.get(key, default)
        if isinstance(value, list) and len(value) == 1:
            value = value[0]
        return value if value is default else self._number(key, value)

    def whole(self, key: str, default: Any = REQUIRED, smallest: int = 0) -> int:
        """A whole number, not below `smallest`."""
        value = self.get(key, default)
        if value is default:
            return value  # type: ignore[no-any-return]
        if isinstance(value, float) and value.is_integer():
            value = int(value)
        if type(value) is not int or value < smallest:
            self.fail(key, f"must be a whole number, at least {smallest}, not {value!r}")
        return value

    def flag(self, key: str, default: bool) -> bool:
        """true or false."""
        value = self.get(key, default)
        if type(value) is not bool:
            self.fail(key, f"must be true or false, not {value!r}")
        return value

    def text(self, key: str, default: Any = REQUIRED) -> str:
        """A text without the blanks around it that wrapped listings have."""
        value = self.get(key, default)
        if value is default:
            return value  # type: ignore[no-any-return]
        if not isinstance(value, str):
            self.fail(key, f"must be a text, not {value!r}")
        return value.strip()

    def choice(self, key: str, allowed: Any, default: Any = REQUIRED) -> str:
        """One of some names."""
        value = self.text(key, default)
        if value not in allowed:
            self.fail(key, f"no '{value}'{nearest(value, allowed)}")
        return value

    def numbers(self, key: str, count: int, default: Any = REQUIRED) -> list[float]:
        """A list of `count` finite numbers; for count 3 a single number stands for all."""
        value = self.get(key, default)
        if value is default:
            return value  # type: ignore[no-any-return]
        if count == 3 and isinstance(value, (int, float)):
            value = [value] * 3
        if not isinstance(value, list) or len(value) != count:
            self.fail(key, f"must be a list of {count} numbers, not {value!r}")
        return [self._number(f"{key}[{k}]", item) for k, item in enumerate(value)]

    def span(self, key: str, default: Any = REQUIRED) -> tuple[float, float]:
        """A range: v, [v] or [low, high]; also [high, low], which random.uniform accepts."""
        value = self.get(key, default)
        if value is default:
            return value  # type: ignore[no-any-return]
        items = value if isinstance(value, list) else [value]
        if not 1 <= len(items) <= 2:
            self.fail(key, f"must be v, [v] or [low, high], not {value!r}")
        found = [self._number(f"{key}[{k}]", item) for k, item in enumerate(items)]
        return min(found), max(found)

    def child(self, key: str) -> Node:
        """The mapping at a key."""
        value = self.get(key, {})
        if not isinstance(value, Mapping):
            self.fail(key, f"must be a mapping, not {type(value).__name__}")
        return self._add(value, self.where(key))

    def children(self, key: str) -> list[Node]:
        """The mappings of the list at a key."""
        value = self.get(key, [])
        if not isinstance(value, list):
            self.fail(key, f"must be a list, not {type(value).__name__}")
        for k, item in enumerate(value):
            if not isinstance(item, Mapping):
                self.fail(f"{key}[{k}]", f"must be a mapping, not {type(item).__name__}")
        return [self._add(item, f"{self.where(key)}[{k}]") for k, item in enumerate(value)]

    def _add(self, value: Mapping[str, Any], path: str) -> Node:
        node = Node(value, path, self.notes)
        self._below.append(node)
        return node

    def leave(self, why: str) -> None:
        """Marks the whole mapping as read, with one warning."""
        self._read.update(self.raw)
        self.notes.warn(self.path, why)

    def skip(self) -> None:
        """Marks the whole mapping as read without a warning, because its parent has one."""
        self._read.update(self.raw)

    def _number(self, key: str, value: Any) -> float:
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            self.fail(key, f"must be a number, not {value!r}")
        if not math.isfinite(value):
            self.fail(key, f"must be finite, not {value!r}")
        return float(value)


def varying(span: tuple[float, float], interval: int | None = None) -> Any:
    """A number of ours that is drawn uniformly: once a scene, or every `interval` steps."""
    low, high = span
    if low == high:
        return low
    return {"uniform": [low, high]} | ({"interval": interval} if interval is not None else {})
