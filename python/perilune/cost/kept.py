"""What a study has measured, kept in a folder: a run that was stopped goes on there."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

Progress = Callable[[int, int], object]
_FILE = "measured.jsonl"


class Kept:
    """Measurements by name, those of one study; without a folder they are kept in memory."""

    def __init__(
        self, folder: str | os.PathLike[str] | None, study: str, progress: Progress | None
    ) -> None:
        """study: what measurements depend on; those of other studies in the folder do not count.
        progress: called with measurements done and in all."""
        self._folder = None if folder is None else Path(folder)
        self._stamp = hashlib.sha256(study.encode()).hexdigest()[:16]
        self._progress = progress
        self._rows: dict[str, dict[str, Any]] = {}
        self.done, self.total = 0, 0
        if self._folder is not None:
            self._folder.mkdir(parents=True, exist_ok=True)
            self._read(self._folder / _FILE)

    def _read(self, path: Path) -> None:
        text = path.read_text(encoding="utf-8") if path.is_file() else ""
        if not text.endswith("\n") and text:  # a run was killed as it wrote
            text = text[: text.rfind("\n") + 1]
            path.write_text(text, encoding="utf-8")
        for line in text.splitlines():
            row = json.loads(line)
            if row["stamp"] == self._stamp:
                self._rows[row["name"]] = row["found"]

    def once(self, name: str, work: Callable[[], dict[str, Any]]) -> dict[str, Any]:
        """A measurement, or what an earlier run found."""
        if name not in self._rows:
            self._rows[name] = work()
            if self._folder is not None:
                line = {"stamp": self._stamp, "name": name, "found": self._rows[name]}
                with (self._folder / _FILE).open("a", encoding="utf-8") as file:
                    file.write(json.dumps(line) + "\n")
        self._step()
        return self._rows[name]

    def arrays(self, name: str, work: Callable[[], dict[str, Any]]) -> Mapping[str, Any]:
        """Arrays, or those of an earlier run."""
        path = None if self._folder is None else self._folder / f"{name}-{self._stamp}.npz"
        if path is not None and path.is_file():
            with np.load(path) as found:
                made: Mapping[str, Any] = dict(found)
        else:
            made = work()
            if path is not None:  # whole or not at all
                part = path.with_suffix(".part.npz")
                np.savez(part, **made)
                part.replace(path)
        self._step()
        return made

    def _step(self) -> None:
        self.done += 1
        self.total = max(self.total, self.done)
        if self._progress is not None:
            self._progress(self.done, self.total)
