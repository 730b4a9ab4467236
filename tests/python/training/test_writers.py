"""Writers of others: registered, installed, or named as module:function."""

from __future__ import annotations

import json
import subprocess
import sys
from importlib.metadata import EntryPoint

import pytest
from tests.python.command_line import command

from perilune.export import writers
from perilune.export.writers import WriteReport, plugins

MODULE = '''
import json
from pathlib import Path
from perilune.writers import WriteReport

class Lines:
    """One line of JSON a frame."""

    def __call__(self, sim, frames, out, *, threads=None, progress=None):
        out = Path(out)
        out.mkdir(parents=True, exist_ok=True)
        with open(out / "frames.jsonl", "w") as file:
            for count, index in enumerate(frames, start=1):
                sample = sim.frame(index, ["objects"], threads)
                row = {"index": index, "seen": int(sample.objects["px_count_visib"][0])}
                file.write(json.dumps(row) + chr(10))
                progress(count, len(frames))
        return WriteReport(out, len(frames), 0)

def forgets(sim, frames, out):
    return None

THING = 3
'''.replace("\\\\\\\\n", "\\\\n")


def words(scene_file, *arguments):
    size = ["--set", "camera.width=16", "--set", "camera.height=12"]
    return ["render", str(scene_file), "--frames", "0:2", "--out", "set", *size, *arguments]


def render(folder, scene_file, *arguments):
    """In a process of its own, which finds modules in its folder."""
    line = [sys.executable, "-m", "perilune", *words(scene_file, *arguments)]
    return subprocess.run(line, cwd=folder, capture_output=True, text=True)


def test_on_the_command_line(scene_file, tmp_path, monkeypatch):
    (tmp_path / "lines.py").write_text(MODULE)
    done = render(tmp_path, scene_file, "--format", "lines:Lines")
    assert done.returncode == 0, done.stderr
    assert "2 frames written" in done.stdout
    rows = [json.loads(row) for row in (tmp_path / "set/frames.jsonl").read_text().splitlines()]
    assert [row["index"] for row in rows] == [0, 1]
    monkeypatch.syspath_prepend(tmp_path)
    for arguments, text in (
        (["--format", "lines:Lines", "--shard", "0/2"], "--shard: the format 'lines:Lines' does"),
        (["--format", "lines:Line"], "no function 'Line' in lines; did you mean 'Lines'?"),
        (["--format", "lines:THING"], "not a function"),
        (["--format", "lines:forgets"], "must return a perilune.writers.WriteReport, not None"),
        (["--format", "bob"], "no format 'bob'; did you mean 'bop'?"),
    ):
        done = command(*words(scene_file, *arguments), cwd=tmp_path)
        assert done.returncode != 0
        assert text in done.stderr
        assert "Traceback" not in done.stderr


def test_registered(monkeypatch):
    monkeypatch.setattr(writers, "WRITERS", dict(writers.WRITERS))

    def mine(sim, frames, out):
        """Nothing at all."""
        return WriteReport(out, 0, 0)

    writers.register("mine", mine)
    assert writers.find("mine").doc == "Nothing at all."
    for name, text in (("mine", "already"), ("bop", "already"), ("a:b", "no name")):
        with pytest.raises(ValueError, match=text):
            writers.register(name, mine)
    with pytest.raises(TypeError, match="no function"):
        writers.register("three", 3)


def test_installed(monkeypatch):
    """An entry point is loaded when it is asked for, and told of by name when that fails."""
    points = [
        EntryPoint("same", "perilune.writers:write_bop", plugins.GROUP),
        EntryPoint("gone", "no_such_module:f", plugins.GROUP),
    ]
    monkeypatch.setattr(plugins, "entry_points", lambda group: points)
    assert writers.find("same").write is writers.write_bop
    with pytest.raises(ValueError, match="format 'gone', installed as no_such_module:f"):
        writers.find("gone")
    with pytest.raises(ValueError, match="no format 'sane'; did you mean 'same'"):
        writers.find("sane")
