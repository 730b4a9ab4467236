"""The table of hard cases: whole, true to the tests that are there, and shown in the docs."""

from __future__ import annotations

from tests.hard.cases import NUMBERED, PAGE, TESTS, cases, function_of, names_in, page


def test_every_test_that_is_named_exists() -> None:
    wrong = []
    for case in cases():
        if case.missing:
            continue
        file, name = function_of(case.test)
        if not (TESTS / file).is_file() or name not in names_in(file):
            wrong.append(case.test)
    assert wrong == []


def test_every_numbered_case_is_covered_or_said_to_be_missing() -> None:
    assert {case.number for case in cases()} - {0} == set(range(1, NUMBERED + 1))


def test_there_are_many_and_no_two_alike() -> None:
    found = [(case.topic, case.what) for case in cases()]
    assert len(found) == len(set(found)) >= 150
    assert all(all((case.what, case.why, case.expected, case.tolerance)) for case in cases())


def test_the_page_is_up_to_date() -> None:
    assert PAGE.read_text(encoding="utf-8") == page(), "run: python -m tests.hard.cases"


def test_a_case_without_a_test_says_why() -> None:
    missing = [case.test for case in cases() if case.missing]
    assert all(len(text) > len("missing: ") for text in missing)
    assert len(missing) <= 5
