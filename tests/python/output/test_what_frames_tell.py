"""A frame tells all that it knows, in Sample.meta and in every format."""

from __future__ import annotations

import io
import json
import tarfile

import h5py
import numpy as np
import OpenEXR
import pytest

import perilune
from perilune.export.writers import write
from perilune.export.writers.formats.record import plain
from perilune.export.writers.formats.tables import FORMATS

EVERY = ("bop", *FORMATS)
CHANGES = {
    "camera.width": 24,
    "camera.height": 18,
    "camera.exposure_time_s": 0.02,
    "camera.line_time_us": 100.0,
    "camera.sensor": {"gain_e_dn": 2.5, "f_number": 4.0, "pixel_um": 5.0},
    "camera.lens": {"model": "brown_conrady", "k1": -0.1, "labels": "undistorted"},
    "time.frames_per_scene": 2,
    "bodies.moon": {
        "kind": "moon",
        "orbit": {"around": "planet", "semi_major_axis_km": 384400.0, "mean_anomaly_deg": 40.0},
    },
    "spacecraft.probe.articulation": [
        {"node": "probe", "axis": [0, 0, 1], "angle_deg": {"uniform": [10.0, 90.0]}}
    ],
    "render.channels": ["sensor_rgb", "depth", "instance", "objects", "masks", "keypoints", "flow",
                        "flow_occlusion", "part", "semantic"],
    "render.scans": ["points"],
}  # fmt: skip
SELF_TOLD = ("npz", "exr", "exr-half", "hdf5", "webdataset")
"""Formats whose files of a frame hold its record too."""


@pytest.fixture(scope="module")
def sim(small_scene):
    return perilune.open(small_scene, overrides=CHANGES)


@pytest.fixture(scope="module")
def sample(sim):
    return sim.frame(1, ["sensor_rgb", "objects"])


@pytest.fixture(scope="module")
def out(sim, tmp_path_factory):
    folder = tmp_path_factory.mktemp("told")
    write(",".join(EVERY), sim, range(2), folder, threads=1)
    return folder


def test_the_sample_knows_everything(sim, sample):
    """Every datum that the design names, beside where it comes from."""
    meta, camera = sample.meta, sample.camera
    assert set(meta["states"]) == {"planet", "moon", "probe"}
    for state in meta["states"].values():
        assert {key: np.size(value) for key, value in state.items()} == {
            "position_m": 3, "velocity_m_s": 3, "q_wxyz": 4}  # fmt: skip
    (motion,) = meta["articulation"]["probe"].values()
    assert np.shape(motion["motion"]) == (4, 4)
    assert meta["time_utc"].startswith("2026-03-20T12:01")
    assert sum(meta["jd_tdb"]) == pytest.approx(2461120.0 + (60 + 69.2) / 86400, abs=1e-6)
    toward = np.array(meta["sun"]["position_m"]) - camera.position_m
    # direction of the Sun in camera axes
    np.testing.assert_allclose(
        camera.R_w2c @ (toward / np.linalg.norm(toward)), meta["sun"]["direction"], atol=1e-6
    )
    assert meta["shutter"] == pytest.approx({"exposure_s": 0.02, "line_time_s": 1e-4})
    assert meta["exposure_s"] > 0.0  # as metered
    assert meta["gain_e_dn"] == 2.5
    assert meta["lens"]["model"] == "brown_conrady"
    assert meta["lens"]["coefficients"][0] == -0.1
    on = [row["name"] for row in sample.plan if row["on"]]
    assert list(meta["effects"]) == on
    assert camera.K.shape == (3, 3)


def record_of(out, name):
    if name == "bop":
        return json.loads((out / "bop/train/000000/scene_frames.json").read_text())["1"]
    return json.loads((out / name / "frames/000001.json").read_text())


@pytest.mark.parametrize("name", EVERY)
def test_every_format_tells_it(out, sample, name):
    record = record_of(out, name)
    meta = {key: value for key, value in sample.meta.items() if key != "timings_s"}
    # effects are those of the channels that are drawn
    told = {key: value for key, value in record["meta"].items() if key != "effects"}
    assert told == json.loads(json.dumps(plain({k: v for k, v in meta.items() if k != "effects"})))
    assert set(meta["effects"]) <= set(record["meta"]["effects"])
    camera = record["camera"]
    np.testing.assert_array_equal(camera["K"], sample.camera.K)
    np.testing.assert_array_equal(camera["R_w2c"], sample.camera.R_w2c)
    np.testing.assert_array_equal(camera["t_w2c"], sample.camera.t_w2c)
    assert (camera["width"], camera["height"]) == (24, 18)
    assert camera["lens"] is None  # labels are undistorted; meta.lens is the picture's


def own_record(out, name):
    """From the files of the frame alone."""
    if name == "npz":
        with np.load(out / "npz/000001.npz") as archive:
            return json.loads(archive["meta.json"])
    if name.startswith("exr"):
        with OpenEXR.File(str(out / name / "000001.exr")) as file:
            return json.loads(file.header()["perilune"])
    if name == "hdf5":
        with h5py.File(out / "hdf5/frames-000000.h5") as file:
            return json.loads(file["000001/record"][()].tobytes())
    with tarfile.open(out / "webdataset/shard-000000.tar") as tar:
        member = tar.extractfile("000001.json")
        assert member is not None
        return json.load(io.TextIOWrapper(member, "utf-8"))


@pytest.mark.parametrize("name", SELF_TOLD)
def test_files_of_a_frame_tell_it_alone(out, name):
    own, record = own_record(out, name), record_of(out, name)
    for key in ("index", "camera", "meta"):
        assert own[key] == record[key]
