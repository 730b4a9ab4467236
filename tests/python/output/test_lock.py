"""Two runs into one folder: the second is refused, and names the first; a kill leaves no lock."""

from __future__ import annotations

import os
import subprocess
import sys
import time

import pytest

import perilune
from perilune.cli import main
from perilune.export.check import check_bop
from perilune.export.writers import FolderInUseError, merge_bop
from perilune.export.writers.lock import LOCK_FILE, locked, writing_process

HOLD = """
import sys, time
from pathlib import Path
from perilune.export.writers.lock import locked
scenes = None if sys.argv[2] == "all" else [int(k) for k in sys.argv[2].split(",")]
with locked(Path(sys.argv[1]), scenes):
    print("held", flush=True)
    sys.stdin.read()
"""


@pytest.fixture
def held(tmp_path):
    """Starts processes that hold scenes of a folder until they are killed."""
    started = []

    def hold(scenes):
        process = subprocess.Popen(
            [sys.executable, "-c", HOLD, str(tmp_path), scenes],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        started.append(process)
        assert process.stdout.readline() == "held\n"
        return process

    yield hold
    for process in started:
        process.kill()
        process.communicate()


def test_the_second_run_is_refused_by_name_and_may_go_on_after_a_kill(held, small_scene, tmp_path):
    process = held("all")
    assert writing_process(tmp_path) == process.pid
    sim = perilune.open(small_scene, overrides={"render.samples": 1})
    with pytest.raises(FolderInUseError, match=f"process {process.pid} is writing to it"):
        perilune.write_bop(sim, range(1), tmp_path, threads=1)
    assert [path.name for path in tmp_path.iterdir()] == [LOCK_FILE]
    with pytest.raises(FolderInUseError):
        perilune.write_bop(sim, range(2), tmp_path, chunk_size=1, shard=(0, 2), threads=1)
    process.kill()
    process.wait()
    assert writing_process(tmp_path) is None
    perilune.write_bop(sim, range(1), tmp_path, threads=1)
    assert not (tmp_path / LOCK_FILE).exists()
    assert check_bop(tmp_path, alone=True).findings == []


def test_the_command_says_it_in_one_line(held, small_scene, tmp_path, capsys):
    process = held("all")
    arguments = ["render", str(small_scene), "--frames", "0:1", "--out", str(tmp_path)]
    assert main(arguments) != 0
    told = capsys.readouterr().err
    assert f"process {process.pid} is writing to it" in told
    assert "Traceback" not in told


def test_shards_of_one_folder_hold_their_own_scenes(held, small_scene, tmp_path):
    process = held("2,3,4")
    sim = perilune.open(small_scene, overrides={"render.samples": 1})
    perilune.write_bop(sim, range(4), tmp_path, chunk_size=1, shard=(0, 2), threads=1)
    with pytest.raises(FolderInUseError, match=f"process {process.pid}"):
        perilune.write_bop(sim, range(4), tmp_path, chunk_size=1, shard=(1, 2), threads=1)
    with pytest.raises(FolderInUseError, match=f"process {process.pid}"):
        merge_bop([tmp_path])
    process.kill()
    process.wait()
    perilune.write_bop(sim, range(4), tmp_path, chunk_size=1, shard=(1, 2), threads=1)
    merge_bop([tmp_path])
    assert not (tmp_path / LOCK_FILE).exists()


def test_threads_of_one_process_are_kept_apart(tmp_path):
    refused = pytest.raises(FolderInUseError, match="another thread")
    with locked(tmp_path), refused, locked(tmp_path):
        pass
    with locked(tmp_path):
        assert writing_process(tmp_path) == os.getpid()
    assert not (tmp_path / LOCK_FILE).exists()


def test_locks_keep_many_processes_apart(tmp_path):
    """Each adds 1 to a number in a file, and waits while it does."""
    count = tmp_path / "count"
    count.write_text("0")
    add = """
import sys, time
from pathlib import Path
from perilune.export.writers.lock import FolderInUseError, locked
root = Path(sys.argv[1])
for _ in range(5):
    while True:
        try:
            with locked(root):
                value = int((root / "count").read_text())
                time.sleep(0.001)
                (root / "count").write_text(str(value + 1))
                break
        except FolderInUseError:
            time.sleep(0.002)
"""
    runs = [subprocess.Popen([sys.executable, "-c", add, str(tmp_path)]) for _ in range(3)]
    assert [run.wait(timeout=60) for run in runs] == [0] * 3
    assert count.read_text() == "15"


def test_the_check_tells_of_a_run_that_goes_on(held, small_scene, tmp_path):
    sim = perilune.open(small_scene, overrides={"render.samples": 1})
    perilune.write_bop(sim, range(1), tmp_path, threads=1)
    process = held("0")
    (finding,) = check_bop(tmp_path, alone=True).findings
    assert finding.reason == f"process {process.pid} is writing to the dataset"
    process.kill()
    process.wait()
    time.sleep(0.01)
    (finding,) = check_bop(tmp_path, alone=True).findings
    assert "the same command" in finding.reason
