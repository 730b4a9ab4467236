"""What comes with Perilune is found from any folder, and a file of the user's own wins."""

from __future__ import annotations

import logging
import shutil
import sys
from pathlib import Path

import pytest

import perilune
from perilune.bodies import geotiff
from perilune.camera import measured
from perilune.document import shipped


@pytest.fixture
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_every_configuration_is_listed(repo_dir: Path) -> None:
    found = [*repo_dir.glob("configs/**/*.yaml"), *repo_dir.glob("configs/**/*.json")]
    assert shipped.configurations() == sorted(p.relative_to(repo_dir).as_posix() for p in found)


def test_a_shipped_configuration_opens_in_any_folder(
    elsewhere: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.INFO, "perilune"):
        sim = perilune.open("configs/material.yaml")
    assert sim.config.name == "material"
    assert "configs/material.yaml" in caplog.text


def test_a_file_of_the_users_wins(elsewhere: Path, repo_dir: Path) -> None:
    (elsewhere / "configs").mkdir()
    shutil.copytree(repo_dir / "assets", elsewhere / "assets")
    text = (repo_dir / "configs/material.yaml").read_text()
    (elsewhere / "configs/material.yaml").write_text(text.replace("name: material", "name: mine"))
    assert perilune.open("configs/material.yaml").config.name == "mine"


def test_an_unknown_name_suggests_a_shipped_one(elsewhere: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"configs/dem\.yaml.*configs/demo\.yaml"):
        perilune.open("configs/dem.yaml")


def test_tiff_without_tifffile_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "tifffile", None)
    path = tmp_path / "numbers.tif"
    path.write_bytes(b"II*\0")
    for read in (geotiff.read, measured.read):
        with pytest.raises(ValueError, match=r"numbers\.tif.*perilune\[tiff\]"):
            read(path)
