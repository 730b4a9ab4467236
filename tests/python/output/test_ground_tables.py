"""Datasets of the ground on disk: ids of rocks and craters with their tables, and the paper's
masks."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from tests.python.test_terrain_frames import moon, over

import perilune
from perilune.config import ConfigError
from perilune.export.check import check_bop

SMALL = {"camera.width": 48, "camera.height": 48, "render.samples": 1, "render.max_bounces": 0}


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> tuple[perilune.Simulation, Path]:
    rocks = {"law": "haworth", "min_diameter_m": 0.4, "density": 3.0}
    sim = moon(
        {"detail": {"seed": 3}, "craters": {"min_diameter_m": 2.0}, "rocks": rocks},
        {"trajectory": over(30.0)},
        render={"samples": 1, "max_bounces": 0, "channels": ["crater_id", "rock_id"]},
        labels={"craters": {"least_px": 5.0}},
    )
    out = tmp_path_factory.mktemp("ground") / "out"
    perilune.write_bop(sim, range(1), out, threads=1)
    return sim, out


def test_tables_are_on_disk_as_they_are(dataset: tuple[perilune.Simulation, Path]) -> None:
    sim, out = dataset
    channels = json.loads((out / "dataset_info.json").read_text())["channels"]
    table = {"components": 0, "dtype": "table", "file": "npy"}
    assert channels["craters"] == channels["rocks"] == table
    truth = {"craters": sim.craters(0, least_px=5.0), "rocks": sim.rocks(0)}
    folder = out / "train/000000"
    for name, column in (("craters", "crater_id"), ("rocks", "rock_id")):
        rows = np.load(folder / name / "000000.npy", allow_pickle=False)
        np.testing.assert_array_equal(rows, truth[name])
        assert (rows["instance_id"] == sim.taxonomy.instances["moon"]).all()
        ids = np.load(folder / column / "000000.npy", allow_pickle=False)
        assert ids.dtype == np.int64
        assert set(np.unique(ids).tolist()) - {0} <= set(rows["id"].tolist())
        assert ids.any()


def test_the_check_passes_and_tells_faults(
    dataset: tuple[perilune.Simulation, Path], tmp_path: Path
) -> None:
    _, out = dataset
    assert check_bop(out).findings == []
    path = out / "train/000000/rocks/000000.npy"
    kept = path.read_bytes()
    np.save(path, np.zeros((48, 64), np.int64))
    told = check_bop(out).findings
    assert any("is no table" in row.reason for row in told if row.file.endswith(path.name))
    path.write_bytes(kept)


def test_the_segmentation_of_the_paper(repo_dir: Path, tmp_path: Path) -> None:
    """Three classes: sky, terrain and rock, and each rock's own mask."""
    sim = perilune.open(repo_dir / "configs/paper2_segmentation.yaml", overrides=SMALL)
    perilune.write_bop(sim, range(1), tmp_path / "out", threads=1)
    folder = tmp_path / "out/train/000000"
    with Image.open(folder / "semantic/000000.png") as image:
        kinds = np.array(image)
    assert set(np.unique(kinds).tolist()) == {0, 1, 3}
    np.testing.assert_array_equal(kinds == 3, np.load(folder / "rock_id/000000.npy") != 0)
    assert ((kinds == 0).mean() > 0.1) & ((kinds == 1).mean() > 0.5)
    assert not (folder / "craters").exists()
    info = json.loads((tmp_path / "out/dataset_info.json").read_text())
    assert info["labels"]["semantic"][0]["names"]["3"] == "rock"
    assert len(sim.craters(0)) > 0  # the table does not need the labels
    with pytest.raises(ConfigError, match=r"'crater_id': labels\.craters is null"):
        sim.frame(0, ["crater_id"])
