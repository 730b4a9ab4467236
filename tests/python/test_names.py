"""Names of entries and levels: letters of any script, in one form; no spaces, dots or slashes."""

import unicodedata

import pytest

import perilune
from perilune.config.errors import ConfigError
from perilune.config.names import problem_of


@pytest.mark.parametrize("name", ["sat", "_a-1", "зонд-é", "探査機", "größe_µ", "मङ्गल"])
def test_letters_of_any_script_make_a_name(name):
    assert problem_of(unicodedata.normalize("NFC", name)) is None


@pytest.mark.parametrize(
    "name",
    ["", "1a", "-a", ".a", "a.b", "a/b", "a\\b", "a b", "a\n", "a\x00", "a\x7f", "a\u202e", "🛰"],
)
def test_what_is_no_name_is_refused(name):
    assert "letters of any script" in str(problem_of(name))


def test_marks_are_composed():
    """Two texts that look alike would be two files on some disks and one on others."""
    assert problem_of("e\u0301") == "letters with marks must be composed (NFC): é"


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"labels.levels": ["kind", "a/b"]}, r"labels\.levels\[1\] .*a name is letters"),
        ({"labels.levels": ["kind", "e\u0301"]}, r"labels\.levels\[1\] .*composed"),
        ({"sensors": {"a b": {}}}, r"sensors\.a b: a name is letters"),
    ],
)
def test_the_key_is_named(repo_dir, changes, text):
    with pytest.raises(ConfigError, match=text):
        perilune.open(repo_dir / "tests/python/scene.yaml", overrides=changes)
