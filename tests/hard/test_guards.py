"""The table of guards is true to the code; script/guards takes them away one at a time."""

from __future__ import annotations

import pytest
from tests.hard.cases import TESTS
from tests.hard.guards import ROOT, Guard, guards


@pytest.mark.parametrize("guard", guards(), ids=lambda guard: guard.name)
def test_a_guard_stands_once_in_its_file(guard: Guard) -> None:
    text = (ROOT / "csrc" / guard.file).read_text(encoding="utf-8")
    assert text.count(guard.text) == 1
    assert guard.naive != guard.text
    assert (TESTS / "c" / f"{guard.test}.c").is_file()


def test_there_are_many() -> None:
    assert len({guard.name for guard in guards()}) == len(guards()) >= 25
