"""Mistakes on the command line are told in one line, by the argument and what is allowed."""

from __future__ import annotations

import pytest
from tests.python.mistakes.commands import COMMANDS
from tests.python.mistakes.rule import message_fault

from perilune import cli


@pytest.fixture
def places(tmp_path, repo_dir):
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "thesis.tex").write_text("")
    (tmp_path / "notes.txt").write_text("")
    (tmp_path / "ship.stl").write_text("solid ship\nendsolid ship\n")
    return {
        "scene": repo_dir / "tests/python/scene.yaml",
        "out": tmp_path / "out",
        "other": tmp_path / "other",
        "text": tmp_path / "notes.txt",
        "model": tmp_path / "ship.stl",
    }


@pytest.mark.parametrize(("line", "code", "needed"), COMMANDS)
def test_it_is_told(places, capsys, monkeypatch, tmp_path, line, code, needed):
    monkeypatch.chdir(tmp_path)
    before = sorted(tmp_path.rglob("*"))
    try:
        found = cli.main(line.format(**places).split())
    except SystemExit as left:
        found = left.code
    out, err = capsys.readouterr()
    assert found == code, err
    assert out == ""
    told = err[err.rindex("perilune") :] if code == 2 else err
    assert not message_fault(told, ["perilune", *needed])
    assert sorted(tmp_path.rglob("*")) == before, "nothing is written"


def test_there_is_a_version(capsys):
    with pytest.raises(SystemExit) as left:
        cli.main(["--version"])
    assert left.value.code == 0
    assert capsys.readouterr().out.startswith("perilune ")


def test_the_mistakes_are_different_ones():
    assert len({line for line, *_ in COMMANDS}) == len(COMMANDS) >= 60
