"""Findings of a check: a file and its fault."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

SHOWN = 3
"""Number of findings of one kind that are listed."""
_NUMBER = re.compile(r"[-+]?\d[\d.]*(e[-+]?\d+)?|\bnan\b|\binf\b")


@dataclass(frozen=True)
class Finding:
    """One fault of a dataset."""

    file: str
    """Path relative to the dataset's folder."""
    reason: str

    @property
    def kind(self) -> tuple[str, str]:
        """Key of the kind: equal for findings that differ only in numbers, such as one cause in
        many images."""
        return _NUMBER.sub("#", self.file), _NUMBER.sub("#", self.reason)


@dataclass
class Report:
    """Result of a check; a good dataset has no findings."""

    folder: Path
    scenes: int = 0
    images: int = 0
    instances: int = 0
    findings: list[Finding] = field(default_factory=list)
    """The first few findings of each kind."""
    counts: dict[tuple[str, str], int] = field(default_factory=dict)
    """Kind -> number of all findings of it."""
    notes: list[str] = field(default_factory=list)
    """What was checked and how; what was not checked, and why."""

    def add(self, path: Path, reason: str) -> None:
        """Records a fault of a file of the dataset."""
        finding = Finding(path.relative_to(self.folder).as_posix(), reason)
        count = self.counts.get(finding.kind, 0) + 1
        self.counts[finding.kind] = count
        if count <= SHOWN:
            self.findings.append(finding)

    def join(self, other: Report) -> None:
        """Adds the content of another report of the same folder."""
        for finding in other.findings:
            self.add(self.folder / finding.file, finding.reason)
        for kind, count in other.counts.items():
            told = sum(finding.kind == kind for finding in other.findings)
            self.counts[kind] += count - told
        for text in other.notes:
            self.note(text)

    def need(self, holds: bool, path: Path, reason: str) -> bool:
        """Records the fault unless the condition holds; returns the condition."""
        if not holds:
            self.add(path, reason)
        return bool(holds)

    def note(self, text: str) -> None:
        """Adds a note once."""
        if text not in self.notes:
            self.notes.append(text)

    @property
    def total(self) -> int:
        """Number of all findings, including those not listed."""
        return sum(self.counts.values())

    def more(self, finding: Finding) -> int:
        """Number of further findings of a kind, for the last one that is listed."""
        kind = finding.kind
        told = [other for other in self.findings if other.kind == kind]
        return self.counts[kind] - len(told) if told[-1] is finding else 0
