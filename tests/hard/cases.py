"""The table of hard cases, and docs/hard_cases.md, which is made of it:

python -m tests.hard.cases
"""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import yaml

TESTS = Path(__file__).resolve().parents[1]
PAGE = TESTS.parent / "docs" / "hard_cases.md"
NUMBERED = 84
"""Length of the design's list of hard cases."""
_C_TEST = re.compile(r"^static void (\w+)\(void \*\*state\)", re.M)
_HEAD = """# Hard cases

Inputs at which straightforward code gives NaN, hangs, loses digits or draws artefacts, and what
holds here instead. The table is `tests/hard/cases.yaml`; `python -m tests.hard.cases` writes this
page, and a test checks both: every test that is named exists, and every case of the design's list
is here. `script/guards` replaces the code that makes them hold by naive code, one place at a time,
and lists the cases whose tests notice.
"""


@dataclass(frozen=True)
class Case:
    """One row."""

    topic: str
    number: int
    what: str
    why: str
    expected: str
    tolerance: str
    test: str

    @property
    def missing(self) -> bool:
        """Whether it has no test; `test` then says why."""
        return self.test.startswith("missing: ")


def cases() -> list[Case]:
    """All rows of the table."""
    tree = yaml.safe_load((TESTS / "hard" / "cases.yaml").read_text(encoding="utf-8"))
    return [Case(topic, *row) for topic, rows in tree.items() for row in rows]


@cache
def names_in(file: str) -> frozenset[str]:
    """Names of the tests in a file below tests/, of C or Python."""
    text = (TESTS / file).read_text(encoding="utf-8")
    if file.endswith(".c"):
        return frozenset(_C_TEST.findall(text))
    found = ast.walk(ast.parse(text))
    names = [node.name for node in found if isinstance(node, ast.FunctionDef)]
    return frozenset(name for name in names if name.startswith("test_"))


def function_of(test: str) -> tuple[str, str]:
    """File and function of a test, of which a row may name one instance: FILE::NAME[PARAMETERS]."""
    file, _, name = test.partition("::")
    return file, name.partition("[")[0]


def _row(case: Case) -> str:
    file, _, name = case.test.partition("::")
    where = f"*{case.test}*" if case.missing else f"`{name}`, `tests/{file}`"
    cells = (case.what, case.why, case.expected, case.tolerance, where)
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def page() -> str:
    """The text of docs/hard_cases.md."""
    rows, parts = cases(), [_HEAD]
    tested = sum(not case.missing for case in rows)
    parts.append(f"{len(rows)} cases, {tested} of which have a test.\n")
    for topic in dict.fromkeys(case.topic for case in rows):
        parts.append(f"## {topic}\n")
        parts.append("| what | why naive code fails | what holds | tolerance | test |")
        parts.append("| --- | --- | --- | --- | --- |")
        parts += [_row(case) for case in rows if case.topic == topic]
        parts.append("")
    return "\n".join(parts).rstrip() + "\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
