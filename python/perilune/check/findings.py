"""What a check finds: a file, and what is wrong with it."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path


@dataclass(frozen=True)
class Finding:
    """One fault of a dataset."""

    file: str
    """Relative to the dataset's folder."""
    reason: str


@dataclass
class Report:
    """What was looked at, and what was found; no finding means a good dataset."""

    folder: Path
    scenes: int = 0
    images: int = 0
    instances: int = 0
    findings: list[Finding] = field(default_factory=list)

    def add(self, path: Path, reason: str) -> None:
        """Notes a fault of a file of the dataset."""
        self.findings.append(Finding(path.relative_to(self.folder).as_posix(), reason))

    def need(self, holds: bool, path: Path, reason: str) -> bool:
        """Notes the fault unless the condition holds; returns the condition."""
        if not holds:
            self.add(path, reason)
        return bool(holds)
