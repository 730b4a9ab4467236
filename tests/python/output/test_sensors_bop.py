"""Datasets of several sensors: each image says whose it is; the check knows whose turn it is."""

from __future__ import annotations

import hashlib
import json

import numpy as np
import pytest
from PIL import Image

import perilune
from perilune.cli import main
from perilune.config import ConfigError
from perilune.export.check import check_bop
from perilune.export.stats import bop_statistics
from perilune.show import preview

BASELINE_M = 0.5
SENSORS = {
    "sensors": {
        "left": {},
        "right": {"transformation": [BASELINE_M, 0, 0, 1, 0, 0, 0], "focal_px": 140},
        "rare": {"trigger_interval": 2, "transformation": {"rotation_deg": [0, 0, 30]}},
    }
}
ORDER = ["left", "right", "rare", "left", "right"]


@pytest.fixture(scope="module")
def sim(small_scene, pair):
    return perilune.open(small_scene, overrides={**pair, **SENSORS})


@pytest.fixture(scope="module")
def dataset(sim, tmp_path_factory):
    out = tmp_path_factory.mktemp("bop") / "stereo"
    perilune.write_bop(sim, range(8), out, chunk_size=3, threads=1)
    return out


def read(dataset, scene, name):
    return json.loads((dataset / f"train/{scene:06d}" / name).read_text())


def test_images_are_frames_of_their_sensors(sim, dataset):
    for index in range(8):
        entry = read(dataset, index // 3, "scene_camera.json")[str(index % 3)]
        assert entry["sensor"] == ORDER[index % 5]
        K = np.reshape(entry["cam_K"], (3, 3))
        assert (sim.request(index)["K"] == K).all()
    left, right = (read(dataset, 0, "scene_camera.json")[k] for k in "01")
    assert left["cam_K"] != right["cam_K"]
    moved = np.subtract(right["cam_t_w2c"], left["cam_t_w2c"])
    # t = -R c: the right camera sits on the left one's x axis. Places of 7e9 mm in doubles.
    assert np.abs(moved - [-1000 * BASELINE_M, 0, 0]).max() < 1e-5
    gt = [read(dataset, 0, "scene_gt.json")[k] for k in "01"]
    for a, b in zip(*gt, strict=True):
        shift = np.subtract(b["cam_t_m2c"], a["cam_t_m2c"])
        assert np.abs(shift - [-1000 * BASELINE_M, 0, 0]).max() < 1e-5
    with Image.open(dataset / "train/000000/rgb/000001.png") as image:
        assert image.size == (96, 72)


def test_the_check_passes_and_knows_whose_turn_it_is(dataset):
    assert check_bop(dataset).findings == []
    path = dataset / "train/000001/scene_camera.json"
    good = path.read_text()
    for bad, text in (
        (good.replace('"sensor": "left"', '"sensor": "right"', 1), "sensor is 'right', must be"),
        (good.replace(', "sensor": "left"', "", 1), "sensor is None, must be 'left'"),
    ):
        assert bad != good
        path.write_text(bad)
        assert any(text in str(finding) for finding in check_bop(dataset).findings)
    path.write_text(good)


def test_card_and_statistics_name_the_sensors(dataset, capsys):
    card = (dataset / "dataset_info.md").read_text()
    assert "in every step: left, right, rare (every 2 steps)" in card
    assert bop_statistics(dataset)["sensors"] == {"left": 3, "right": 3, "rare": 2}
    assert main(["stats", str(dataset)]) == 0
    assert "left: 3 images, right: 3 images, rare: 2 images" in capsys.readouterr().out


def test_shards_of_sensors_merge(sim, dataset, tmp_path):
    for k in range(2):
        folder = tmp_path / f"part{k}"
        perilune.write_bop(sim, range(8), folder, chunk_size=3, threads=1, shard=(k, 2))
    perilune.export.writers.merge_bop([tmp_path / "part0", tmp_path / "part1"], tmp_path / "whole")
    for path in dataset.rglob("*"):
        if path.is_file():
            assert (tmp_path / "whole" / path.relative_to(dataset)).read_bytes() == (
                path.read_bytes()
            )


def test_several_sizes_are_refused(small_scene, tmp_path):
    sensors = {"sensors": {"a": {}, "b": {"width": 40, "height": 30}}}
    sim = perilune.open(small_scene, overrides=sensors)
    with pytest.raises(ConfigError, match=r"there are a 96 x 72, b 40 x 30; write each size"):
        perilune.write_bop(sim, range(2), tmp_path / "out")
    assert not (tmp_path / "out").exists()
    # As the message says: without `a`, `b` is alone and sees the same world.
    alone = perilune.open(small_scene, overrides={**sensors, "sensors.a": None})
    report = perilune.write_bop(alone, range(2), tmp_path / "b", threads=1)
    assert report.written == 2
    assert check_bop(tmp_path / "b").findings == []
    assert (alone.request(1)["camera_pose"] == sim.request(3)["camera_pose"]).all()


def test_a_table_of_poses_is_a_file_of_the_dataset(small_scene, tmp_path):
    way = tmp_path / "way.csv"
    way.write_text("0,12,0,0,0.5,-0.5,0.5,-0.5\n")
    trajectory = {"kind": "deterministic", "file": str(way), "target": "probe"}
    sim = perilune.open(small_scene, overrides={"camera.trajectory": trajectory})
    perilune.write_bop(sim, range(1), tmp_path / "out", threads=1)
    info = json.loads((tmp_path / "out/dataset_info.json").read_text())
    digest = hashlib.sha256(way.read_bytes()).hexdigest()
    assert info["files_sha256"]["camera.trajectory.file"] == digest


def test_preview_names_the_sensor(sim, small_scene, tmp_path):
    sample = sim.frame(1, channels=["rgb"])
    assert preview.frame_title(sample).startswith("frame 1 right | ")
    overrides = ["--set", "sensors={left: {}, right: {fov_deg: 20}}"]
    args = ["preview", str(small_scene), "--frame", "1", "--out", str(tmp_path / "s.png")]
    assert main([*args, *overrides]) == 0
    assert main(["plan", str(small_scene), "--frame", "1", *overrides]) == 0


@pytest.mark.parametrize(
    ("channels", "pictures"),
    [
        (["rgb", "depth"], {"rgb": "rgb"}),
        (["sensor_rgb", "depth"], {"rgb": "sensor_rgb"}),
        (["rgb", "sensor_rgb"], {"rgb": "rgb", "sensor_rgb": "sensor_rgb"}),
        (["sensor_rgb", "raw"], {"rgb": "sensor_rgb", "raw": "raw"}),
        (["rgb", "sensor_rgb", "raw"], {k: k for k in ("rgb", "sensor_rgb", "raw")}),
    ],
)
def test_images_are_those_that_are_asked_for(small_scene, tmp_path, channels, pictures):
    asked = {"camera.sensor": {}, "render.channels": channels}
    sim = perilune.open(small_scene, overrides=asked)
    perilune.write_bop(sim, range(2), tmp_path, threads=1)
    assert check_bop(tmp_path).findings == []
    scene = tmp_path / "train" / "000000"
    labels = {"depth", "mask", "mask_visib"}
    assert {path.name for path in scene.iterdir() if path.is_dir()} == labels | set(pictures)
    sample = sim.frame(1, channels=list(pictures.values()))
    for folder, channel in pictures.items():
        with Image.open(scene / folder / "000001.png") as image:
            np.testing.assert_array_equal(np.array(image), sample[channel])
    assert perilune.write_bop(sim, range(2), tmp_path, threads=1).kept == 2
    away = tmp_path.parent / f"{tmp_path.name}.png"
    for folder in pictures:  # each of them is missed
        path = scene / folder / "000001.png"
        path.rename(away)
        named = {finding.file for finding in check_bop(tmp_path).findings}
        assert f"train/000000/{folder}/000001.png" in named
        away.rename(path)


def test_planes_are_arrays(small_scene, tmp_path):
    planes = {"camera.sensor": {"mosaic": "planes", "quantum_efficiency": [0.5, 0.5, 0.5]}}
    changes = {"camera.bands": [{"center_um": 0.6, "width_um": 0.1}], "render.channels": ["raw"]}
    sim = perilune.open(small_scene, overrides=planes | changes)
    perilune.write_bop(sim, range(1), tmp_path / "out")
    raw = np.load(tmp_path / "out" / "train" / "000000" / "raw" / "000000.npy")
    np.testing.assert_array_equal(raw, sim.frame(0)["raw"])
    assert raw.shape == (72, 96, 1)
    assert check_bop(tmp_path / "out").findings == []
