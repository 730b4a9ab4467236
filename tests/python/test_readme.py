"""The README's claims that can be run: its Python, its YAML, its commands, files and table."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from perilune import _core
from perilune.camera.trajectories import TRAJECTORIES

ROOT = Path(__file__).resolve().parents[2]
TEXT = (ROOT / "README.md").read_text()


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", TEXT, flags=re.DOTALL)


@pytest.mark.parametrize("code", blocks("python"))
def test_python_blocks_run(code: str) -> None:
    """As a reader would run them, from the root of the repository."""
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("code", blocks("yaml"))
def test_yaml_blocks_parse(code: str) -> None:
    assert yaml.safe_load(code)


@pytest.mark.parametrize("command", sorted(set(re.findall(r"^    perilune +(\w+)", TEXT, re.M))))
def test_commands_exist(command: str) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "perilune", command, "--help"], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr


def test_named_files_exist() -> None:
    """Paths in backquotes and pictures."""
    named = re.findall(r"`((?:configs|benchmarks|csrc|script)/[\w./]+)`", TEXT)
    named += re.findall(r"\]\(([\w./]+)\)", TEXT)
    assert len(named) > 5
    assert [name for name in named if not (ROOT / name).exists()] == []


def test_table_of_effects_is_complete() -> None:
    section = TEXT.split("## What is simulated")[1]
    rows = re.findall(r"^\| `(\w+)` \|", section, re.M)
    assert rows == [row["name"] for row in _core.EFFECTS]


def test_table_of_trajectories_is_complete() -> None:
    section = TEXT.split("| kind | the camera |")[1].split("\n\n")[0]
    names = [name for row in section.splitlines() for name in re.findall(r"`(\w+)`", row)]
    assert names == list(TRAJECTORIES)
