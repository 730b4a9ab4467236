"""The table of guards is true to the code and to the hard cases; script/guards takes guards away
one at a time."""

from __future__ import annotations

from collections import Counter

import pytest
from tests.hard.cases import cases
from tests.hard.guards import Guard, guards, without
from tests.hard.trial import ROOT


@pytest.mark.parametrize("guard", guards(), ids=lambda guard: guard.name)
def test_a_guard_stands_once_in_its_file(guard: Guard) -> None:
    text = (ROOT / guard.file).read_text(encoding="utf-8")
    assert text.count(guard.text) == 1
    assert guard.naive != guard.text


def test_guards_are_noticed_by_tests_of_hard_cases() -> None:
    """Which test_cases.py finds in their files."""
    tests = {case.test for case in cases()}
    wrong = [(guard.name, test) for guard in guards() for test in guard.tests if test not in tests]
    assert wrong == []
    assert all(guard.tests for guard in guards())


def test_hard_cases_have_a_guard_or_say_why_not() -> None:
    guarded, reasons = {test for guard in guards() for test in guard.tests}, without()
    bare = {case.test for case in cases() if not case.missing} - guarded
    assert sorted(bare) == sorted(reasons)
    assert all(len(why) > 20 for why in reasons.values())


def test_no_two_guards_are_alike() -> None:
    found = Counter((guard.file, guard.text, guard.naive) for guard in guards())
    assert max(found.values()) == 1
