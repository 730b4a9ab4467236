"""scene_frames.json and scene_keypoints.json: what BOP has no place for, beside its own files."""

from __future__ import annotations

import json
import shutil

import numpy as np
import pytest

import perilune
from perilune.export.check import check
from perilune.export.writers import write
from perilune.export.writers.formats import record as records

from .faults import edit

S0 = "train/000000"
FRAMES, KEYPOINTS = f"{S0}/scene_frames.json", f"{S0}/scene_keypoints.json"


@pytest.fixture(scope="module")
def sim(small_scene):
    changes = {
        "camera.width": 40,
        "camera.height": 30,
        "camera.lens": {"model": "brown_conrady", "k1": -0.1, "labels": "undistorted"},
        "camera.sensor": {},
        "camera.exposure_time_s": 0.01,
        "bodies.planet.landmarks": {"pole": {"lon_deg": 0.0, "lat_deg": 90.0}},
        "render.samples": 1,
        "render.channels": ["rgb", "sensor_rgb", "keypoints"],
    }
    return perilune.open(small_scene, overrides=changes)


@pytest.fixture(scope="module")
def good(sim, tmp_path_factory):
    out = tmp_path_factory.mktemp("frames")
    write("bop,npz", sim, range(3), out, chunk_size=2, threads=1)
    for report in check(out):
        assert report.findings == [], report.folder
    return out


def load(path):
    return json.loads(path.read_text())


def test_metadata_is_that_of_the_other_formats(good):
    for index in range(3):
        scene, image = divmod(index, 2)
        entry = load(good / f"bop/train/{scene:06d}/scene_frames.json")[str(image)]
        record = records.read(good / f"npz/frames/{index:06d}.json")
        assert entry == {key: record[key] for key in ("index", "camera", "meta")}
        meta = entry["meta"]
        assert set(meta) >= {"time_utc", "jd_tdb", "sun", "states", "effects", "gain_e_dn"}
        assert meta["shutter"] == {"exposure_s": 0.01, "line_time_s": 0.0}
        assert meta["exposure_s"] > 0.0
        assert meta["lens"]["model"] == "brown_conrady"
        assert -0.1 in meta["lens"]["coefficients"]
        assert entry["camera"]["lens"] is None


def test_keypoints_are_the_samples(good, sim):
    table = sim.frame(2, ["keypoints"]).keypoints
    (rows,) = load(good / "bop/train/000001/scene_keypoints.json").values()
    assert [row["name"] for row in rows] == ["nose", "tail", "pole"]
    for row, truth in zip(rows, table, strict=True):
        for name in table.dtype.names:
            value = [np.nan if v is None else v for v in row[name]] if name == "xy" else row[name]
            np.testing.assert_array_equal(value, truth[name])


def of_frame(change):
    return FRAMES, lambda value: change(value["1"])


def of_point(change):
    return KEYPOINTS, lambda value: change(value["1"][0])


def set_in(*path, value):
    def change(entry):
        for key in path[:-1]:
            entry = entry[key]
        entry[path[-1]] = value

    return change


FAULTS = {
    "other frame": (of_frame(set_in("index", value=0)), "image 1: index is 0, must be 1"),
    "no date": (of_frame(lambda e: e["meta"].pop("time_utc") and None), "meta lacks time_utc"),
    "other K": (of_frame(set_in("camera", "K", 0, 0, value=1.0)), "camera.K is not that of"),
    "other place": (of_frame(set_in("camera", "t_w2c", 0, value=1.0)), "camera.t_w2c is not"),
    "other size": (of_frame(set_in("camera", "width", value=41)), "camera has 41 x 30 pixels"),
    "a long direction": (
        of_frame(lambda e: e["meta"]["sun"].update(direction=[1.0, 1.0, 0.0])),
        "meta.sun.direction is no unit vector",
    ),
    "no camera": (of_frame(lambda e: e["camera"].pop("K") and None), "is no record of a frame"),
    "an unknown key": (of_frame(set_in("more", value=1)), "1.more: Extra inputs"),
    "no image": ((FRAMES, lambda v: v.pop("1") and None), "has not the images of"),
    "a moved keypoint": (
        of_point(lambda row: row["xy"].__setitem__(0, row["xy"][0] + 0.01)),
        "image 1: object 'probe': keypoint 'nose': xy is",
    ),
    "a keypoint elsewhere": (
        of_point(lambda row: row["position_m"].__setitem__(1, row["position_m"][1] + 0.1)),
        "keypoint 'nose': xy is",
    ),
    "outside in the picture": (of_point(set_in("visible", value=0)), "lies inside of the picture"),
    "seen but hidden": (
        of_point(lambda row: row.update(visible=2, occluded_by=2)),
        "is seen, but occluded_by is 2",
    ),
    "visible 3": (of_point(set_in("visible", value=3)), "visible is 3, must be 0, 1 or 2"),
    "another name": (of_point(set_in("name", value="x")), "are not those that dataset_info.json"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_faults_are_told(good, tmp_path, name):
    (file, change), words = FAULTS[name]
    root = shutil.copytree(good / "bop", tmp_path / "bop")
    edit(root / file, change)
    (report,) = check(root, alone=True)
    assert any(f.file == file and words in f.reason for f in report.findings), report.findings


@pytest.mark.parametrize("file", [FRAMES, KEYPOINTS])
def test_what_only_the_configuration_tells(good, tmp_path, file):
    root = shutil.copytree(good / "bop", tmp_path / "bop")
    if file == FRAMES:
        edit(root / file, lambda v: v["0"]["meta"]["states"]["probe"]["velocity_m_s"].reverse())
    else:
        edit(root / file, lambda v: v["0"][0].update(instance_id=1))
    (report,) = check(root, rerender=0)
    assert any(f.file == file and "image 0: " in f.reason for f in report.findings)


@pytest.mark.parametrize("file", [FRAMES, KEYPOINTS])
def test_a_file_that_is_missing_is_made_again(good, sim, tmp_path, file):
    root = shutil.copytree(good / "bop", tmp_path / "bop")
    text = (root / file).read_bytes()
    (root / file).unlink()
    write("bop", sim, range(3), root, chunk_size=2, threads=1)
    assert (root / file).read_bytes() == text
