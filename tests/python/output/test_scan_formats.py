"""Measurements in datasets: what each format's readers make of them, and faults of them."""

from __future__ import annotations

import json

import h5py
import numpy as np
import plyfile
import pytest
import webdataset

import perilune
from perilune import _core
from perilune.config import ConfigError
from perilune.export.check import check
from perilune.export.check.scans import scan_faults
from perilune.export.writers import write
from perilune.export.writers.formats import record as records
from perilune.export.writers.formats.pixels import from_npy
from perilune.export.writers.formats.ply import decode_cloud, encode_cloud

SCANS = ["points", "lidar", "time_of_flight", "events"]
TABLES = ["points", "lidar_top", "lidar_side", "time_of_flight", "events"]
LIDAR = {"pattern": {"kind": "raster", "columns": 20, "rows": 15}, "range_noise_m": 0.02}
CHANGES = {
    "camera.width": 24,
    "camera.height": 18,
    "time.step_s": 0.05,
    "spacecraft.probe.attitude": {"spin_rate_deg_s": 90.0},
    "lidars": {"top": LIDAR, "side": {**LIDAR, "divergence_deg": 0.2, "sub_rays": 4}},
    "time_of_flight": {"modulation_hz": [20_000_000], "signal_e": 1e6, "samples": 2},
    "events": {"instants": 2, "max_halvings": 0},
    "render.samples": 1,
    "render.channels": ["rgb", "objects"],
    "render.scans": SCANS,
}


@pytest.fixture(scope="module")
def sim(small_scene):
    return perilune.open(small_scene, overrides=CHANGES)


@pytest.fixture(scope="module")
def out(sim, tmp_path_factory):
    folder = tmp_path_factory.mktemp("scans")
    write("bop,npz,hdf5,webdataset,ply", sim, range(2), folder, threads=1)
    return folder


@pytest.fixture(scope="module")
def truth(sim):
    return {
        "points": sim.points(1, colour=True),
        "lidar_top": sim.lidar(1, "top"),
        "lidar_side": sim.lidar(1, "side"),
        "time_of_flight": sim.time_of_flight(1),
        "events": sim.events(1),
    }


def test_good_ones_have_no_finding(out):
    for report in check(out, rerender=1):
        assert report.findings == [], report.folder


def same(found, expected):
    assert found.dtype.names == expected.dtype.names
    assert found.shape == expected.shape
    assert len(expected) > 0
    for name in expected.dtype.names:
        np.testing.assert_array_equal(found[name], expected[name])


def test_readers_get_the_tables(out, truth):
    with np.load(out / "npz/000001.npz") as archive:
        for name in TABLES:
            same(archive[name], truth[name])
    with h5py.File(out / "hdf5/frames-000000.h5") as file:
        for name in TABLES:
            same(file[f"000001/{name}"][()], truth[name])
    shard = str(out / "webdataset/shard-000000.tar")
    sample = list(webdataset.WebDataset(shard, shardshuffle=False))[1]
    for name in TABLES:
        same(from_npy(sample[f"{name}.npy"]), truth[name])
        same(np.load(out / f"bop/train/000000/{name}/000001.npy"), truth[name])


def test_plyfile_reads_the_clouds(out, truth):
    for name in ("points", "lidar_top", "lidar_side"):
        found = plyfile.PlyData.read(out / f"ply/{name}/000001.ply")["vertex"].data
        table = truth[name]
        assert len(found) == len(table)
        place = np.stack([found[axis] for axis in "xyz"], axis=1)
        if name == "points":
            np.testing.assert_array_equal(place, table["camera_m"].astype(np.float32))
            colour = np.stack([found[c] for c in ("red", "green", "blue")], axis=1)
            np.testing.assert_array_equal(colour, table["rgb"])
            normal = np.stack([found[c] for c in ("nx", "ny", "nz")], axis=1)
            np.testing.assert_array_equal(normal, table["normal"])
        else:
            expected = table["range_m"][:, None] * table["sensor_direction"]
            np.testing.assert_array_equal(place, expected.astype(np.float32))
            for field in ("time_s", "range_m", "intensity", "beam", "return_number", "path"):
                np.testing.assert_array_equal(found[field], table[field])
        np.testing.assert_array_equal(found["semantic_kind"], table["semantic"][:, 0])
        np.testing.assert_array_equal(found["instance"], table["instance"])


def test_an_empty_cloud_is_a_file():
    dtype = [("camera_m", "f8", (3,)), ("range_m", "f4"), ("big", "i8")]
    data = encode_cloud(np.zeros(0, dtype), [], "nothing")
    assert decode_cloud(data).dtype.names == ("x", "y", "z", "range_m", "big")
    with pytest.raises(ValueError, match="is no PLY of points, or cut"):
        decode_cloud(data + b"x")


def test_what_is_not_there_is_named(small_scene, tmp_path):
    with pytest.raises(ConfigError, match=r"render\.scans: 'lidar' needs the section lidars"):
        write("npz", perilune.open(small_scene, overrides={"render.scans": ["lidar"]}),
              range(1), tmp_path / "a")  # fmt: skip
    with pytest.raises(ConfigError, match=r"render\.scans: the format 'png' cannot hold 'points'"):
        write("png", perilune.open(small_scene, overrides={"render.scans": ["points"]}),
              range(1), tmp_path / "b")  # fmt: skip
    with pytest.raises(ConfigError, match=r"'ply' holds clouds of points; name `points`"):
        write("ply", perilune.open(small_scene, overrides={"render.channels": ["objects"]}),
              range(1), tmp_path / "c")  # fmt: skip
    with pytest.raises(ConfigError, match=r"render\.scans"):
        perilune.open(small_scene, overrides={"render.scans": ["radar"]})


FAULTS = {
    ("lidar_top", "range_m", 0.1): "lidar_top: position_m is not at the end of its beam",
    ("lidar_top", "sensor_direction", 0.5): "lidar_top: sensor_direction is no unit vector",
    ("lidar_side", "return_number", 100): "return_number is above return_count in 1 rows",
    ("lidar_side", "instance", 77): "lidar_side: instance has ids without a name",
    ("lidar_top", "beam", 1_000_000): "lidar_top: its rows are not in the order of beams",
    ("lidar_top", "intensity", np.nan): "lidar_top: intensity is not finite",
    ("lidar_top", "semantic", 500): "lidar_top: semantic of level",
    ("points", "part", 5000): "points: part has ids without a name in 1 rows",
    ("points", "normal", 0.5): "points: normal is no unit vector in 1 rows",
    ("points", "u", 3): "points: the camera does not see the point at u, v",
    ("points", "range_m", 5.0): "points: range_m is not the distance of the point",
    ("events", "t_us", 1e9): "events: its rows are not in the order of time",
    ("events", "x", 500): "events: x, y lie outside of the picture",
    ("events", "polarity", 1): "events: polarity is neither 1 nor -1",
    ("time_of_flight", "range_m", np.inf): "time_of_flight: range_m is infinite or below 0",
}


@pytest.mark.parametrize("fault", FAULTS, ids=lambda f: f"{f[0]}-{f[1]}")
def test_planted_faults_are_told(out, truth, fault):
    name, field, added = fault
    info = json.loads((out / "npz/dataset_info.json").read_text())
    record = records.read(out / "npz/frames/000001.json")
    table = truth[name].copy()
    assert list(scan_faults(info, record, {name: table})) == []
    at = np.flatnonzero(np.isfinite(table[field].reshape(table.size, -1)[:, 0]))[0]
    row = table[field].reshape(table.size, -1)[at]
    row[0] = row[0] * 2 if field == "polarity" else row[0] + added
    found = list(scan_faults(info, record, {name: table}))
    assert any(FAULTS[fault] in text for text in found), found


def test_planted_faults_of_a_ply_are_told(out):
    info = json.loads((out / "ply/dataset_info.json").read_text())
    record = records.read(out / "ply/frames/000001.json")
    for name in ("points", "lidar_top"):
        table = decode_cloud((out / f"ply/{name}/000001.ply").read_bytes()).copy()
        assert list(scan_faults(info, record, {name: table})) == []
        damaged = table.copy()
        damaged["range_m"][0] *= 1.001
        assert any(f"{name}: " in text for text in scan_faults(info, record, {name: damaged}))
        level = next(field for field in table.dtype.names if field.startswith("semantic_"))
        for field, text in ((level, f"{level} has ids without"), ("part", "part has ids without")):
            damaged = table.copy()
            damaged[field][-1] = 900
            assert any(text in found for found in scan_faults(info, record, {name: damaged}))
        if "nx" in table.dtype.names:
            damaged = table.copy()
            damaged["nx"][0] += 0.5
            found = list(scan_faults(info, record, {name: damaged}))
            assert any("normal is no unit vector" in text for text in found)


ROLLING = {
    "camera.exposure_time_s": 0.002,
    "camera.line_time_us": 20000.0,
    "camera.lens": {"model": "brown_conrady", "k1": -0.2, "k2": 0.05, "labels": "distorted"},
    "lidars": None,
    "time_of_flight": None,
    "events": None,
    "render.scans": ["points"],
}


def test_points_of_a_rolling_shutter_are_those_of_their_own_rows(small_scene):
    """In camera axes where the poses of their row put the object's points, though camera and object
    go 7.5 km/s; and the camera sees them at their pixel."""
    place = {"kind": "fixed", "target": "probe", "position_m": [2.2, -5.0, 1.6], "frame": "lvlh"}
    large = {"camera.width": 240, "camera.height": 180, "camera.line_time_us": 2000.0}
    large["camera.trajectory"] = place  # turns with the orbit
    sim = perilune.open(small_scene, overrides=CHANGES | ROLLING | large)
    sample = sim.frame(1, ["object_coords", "normal", "instance", "objects"])
    points = sim.points(1)
    np.testing.assert_allclose(
        _core.project(sample.camera.K, sample.camera.lens, points["camera_m"]),
        np.stack([points["u"], points["v"]], axis=1),
        atol=1e-9,
    )
    (number,) = sample.objects["instance_id"]
    turns = [np.asarray(row["R_w2c"]) for row in sample.meta["rows"]]
    assert np.abs(turns[0] - turns[-1]).max() > 1e-5  # one for all rows would not do
    compared = 0
    for row in sample.meta["rows"]:
        own = points[(points["v"] == row["row"]) & (points["instance"] == number)]
        pose = row["objects"]["probe"]
        coords = sample["object_coords"][own["v"], own["u"]].astype(float)
        expected = coords @ np.asarray(pose["R_m2c"]).T + pose["t_m2c"]
        np.testing.assert_allclose(own["camera_m"], expected, atol=1e-4)
        turned = sample["normal"][own["v"], own["u"]] @ np.asarray(row["R_w2c"])
        np.testing.assert_allclose(own["normal"], turned, atol=1e-6)
        compared += len(own)
    assert compared > 20


def test_points_of_a_rolling_shutter_pass_the_check(small_scene, tmp_path):
    sim = perilune.open(small_scene, overrides=CHANGES | ROLLING)
    write("npz,ply", sim, range(2), tmp_path, threads=1)
    for name in ("npz", "ply"):
        (report,) = check(tmp_path / name)
        assert report.findings == [], name
