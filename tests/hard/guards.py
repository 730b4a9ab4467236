"""Takes guards away one at a time, and asks the tests of hard cases whether they notice:

    python -m tests.hard.guards [NAME...]

The table is tests/hard/guards.yaml.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

import yaml
from tests.hard import trial
from tests.hard.cases import cases

TABLE = Path(__file__).with_name("guards.yaml")
_PYTHON = "python/perilune"


@dataclass(frozen=True)
class Guard:
    """One row of the table."""

    name: str
    source: str
    text: str
    naive: str
    tests: list[str]

    @property
    def file(self) -> str:
        """Its file, from the root of the project."""
        folder = _PYTHON if self.source.endswith(".py") else "csrc"
        return f"{folder}/{self.source}"


def guards() -> list[Guard]:
    """All guards of the table."""
    rows = yaml.safe_load(TABLE.read_text(encoding="utf-8"))["guards"]
    return [Guard(name, *row) for name, row in rows.items()]


def without() -> dict[str, str]:
    """Tests whose rows can have no guard, with the reason."""
    return yaml.safe_load(TABLE.read_text(encoding="utf-8"))["none"] or {}


def _noticed(guard: Guard) -> set[str]:
    """Tests that fail without the guard."""
    with trial.changed(guard.file, guard.text, guard.naive):
        trial.build(trial.targets_of(guard.tests))
        return trial.failures(guard.tests)


def _try(guard: Guard) -> set[str]:
    """The same, and prints what was found; empty if a test that should notice does not."""
    try:
        failed = _noticed(guard)
    except trial.TrialError as error:
        print(f"{guard.name}, {guard.file}: CANNOT BE TRIED\n{error}", flush=True)
        return set()
    rows = [case for case in cases() if case.test in failed]
    blind = [test for test in guard.tests if test not in failed]
    print(f"{guard.name}, {guard.file}: {'UNNOTICED' if blind else 'noticed'}")
    for case in rows:
        print(f"    {case.topic}: {case.what} ({case.test})")
    for test in blind:
        print(f"    NOT by {test}")
    sys.stdout.flush()
    return set() if blind else failed


def _report(chosen: list[Guard], noticed: list[set[str]]) -> None:
    """How many rows have a guard that they notice, and which have none."""
    reasons, rows = without(), cases()
    seen = set().union(*noticed)
    guarded = [case for case in rows if case.test in seen]
    print(f"{len(chosen)} guards, {sum(map(bool, noticed))} noticed")
    print(f"{len(guarded)} of {len(rows)} hard cases have a guard that they notice")
    for case in rows:
        if case not in guarded:
            why = reasons.get(case.test, "NO GUARD")
            print(f"    {case.topic}: {case.what} ({case.test}): {why}")


def main(names: list[str]) -> int:
    """Status: 0 if every guard is noticed by the tests that should."""
    table = guards()
    unknown = set(names) - {guard.name for guard in table}
    if unknown:
        print(f"no guard {', '.join(sorted(unknown))}", file=sys.stderr)
        return 2
    chosen = [guard for guard in table if not names or guard.name in names]
    tests = sorted({test for guard in chosen for test in guard.tests})
    trial.prepare(trial.targets_of(tests))
    broken = trial.measure(tests)
    if broken:
        print(f"these fail with all guards: {', '.join(sorted(broken))}", file=sys.stderr)
        return 1
    noticed = [_try(guard) for guard in chosen]
    if not names:
        _report(chosen, noticed)
    return 0 if all(noticed) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
