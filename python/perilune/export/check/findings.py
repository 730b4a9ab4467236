"""What a check finds: a file, and what is wrong with it."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

SHOWN = 3
"""Findings of one kind that are told one by one."""
_NUMBER = re.compile(r"[-+]?\d[\d.]*(e[-+]?\d+)?|\bnan\b|\binf\b")


@dataclass(frozen=True)
class Finding:
    """One fault of a dataset."""

    file: str
    """Relative to the dataset's folder."""
    reason: str

    @property
    def kind(self) -> tuple[str, str]:
        """The same for findings that differ in numbers alone, as of one cause in many images."""
        return _NUMBER.sub("#", self.file), _NUMBER.sub("#", self.reason)


@dataclass
class Report:
    """What was looked at, and what was found; no finding means a good dataset."""

    folder: Path
    scenes: int = 0
    images: int = 0
    instances: int = 0
    findings: list[Finding] = field(default_factory=list)
    """Of each kind, the first few."""
    counts: dict[tuple[str, str], int] = field(default_factory=dict)
    """Kind -> all findings of it."""
    notes: list[str] = field(default_factory=list)
    """What was checked how, and what was not checked and why."""

    def add(self, path: Path, reason: str) -> None:
        """Notes a fault of a file of the dataset."""
        finding = Finding(path.relative_to(self.folder).as_posix(), reason)
        count = self.counts.get(finding.kind, 0) + 1
        self.counts[finding.kind] = count
        if count <= SHOWN:
            self.findings.append(finding)

    def join(self, other: Report) -> None:
        """Takes over what another report of the same folder holds."""
        for finding in other.findings:
            self.add(self.folder / finding.file, finding.reason)
        for kind, count in other.counts.items():
            told = sum(finding.kind == kind for finding in other.findings)
            self.counts[kind] += count - told
        for text in other.notes:
            self.note(text)

    def need(self, holds: bool, path: Path, reason: str) -> bool:
        """Notes the fault unless the condition holds; returns the condition."""
        if not holds:
            self.add(path, reason)
        return bool(holds)

    def note(self, text: str) -> None:
        """Says once what the findings do not."""
        if text not in self.notes:
            self.notes.append(text)

    @property
    def total(self) -> int:
        """All findings, those too that are not told one by one."""
        return sum(self.counts.values())

    def more(self, finding: Finding) -> int:
        """How many further findings of its kind there are, asked of the last one that is told."""
        kind = finding.kind
        told = [other for other in self.findings if other.kind == kind]
        return self.counts[kind] - len(told) if told[-1] is finding else 0
