"""Poses, depth, silhouettes and flow agree in every kind of view, whatever lens and shutter."""

from __future__ import annotations

import json

import numpy as np
import pytest

import perilune
from perilune.export.check import check
from perilune.export.check.geometry import geometry_faults
from perilune.export.writers import write
from perilune.export.writers.formats import record as records
from perilune.export.writers.formats.npz import Npz

CHANNELS = ["depth", "instance", "objects", "masks", "range", "position", "flow", "flow_backward"]
BASE = {
    "camera.width": 48,
    "camera.height": 36,
    "time.frames_per_scene": 3,
    "time.step_s": 1.0,
    "spacecraft.probe.attitude": {"spin_rate_deg_s": 2.0},
    "render.channels": [*CHANNELS, "keypoints"],
}
SENSORS = {"left": {}, "right": {"transformation": [0.5, 0, 0, 1, 0, 0, 0], "focal_px": 60}}
VIEWS = {
    "plain": {},
    "pair": "pair",
    "brown": {"camera.lens": {"model": "brown_conrady", "k1": -0.3, "k2": 0.1, "p1": 0.01}},
    "fisheye": {"camera.lens": {"model": "fisheye", "k1": 0.02}},
    "wide fisheye": {
        "camera.lens": {"model": "fisheye", "k1": 0.01},
        "camera.fov_deg": None,
        "camera.focal_px": 24.0,
    },
    "undistorted": {"camera.lens": {"model": "brown_conrady", "k1": -0.3, "labels": "undistorted"}},
    "exposure": {"camera.exposure_time_s": 0.5},
    "rolling": {"camera.exposure_time_s": 0.1, "camera.line_time_us": 5000.0},
    "sensors": {"sensors": SENSORS, "time.frames_per_scene": 3},
    "a moving part": {
        "spacecraft.probe.articulation": [
            {"node": "probe", "axis": [0, 0, 1], "angle_deg": {"uniform": [0.0, 90.0]}}
        ]
    },
    "a driven size": {"spacecraft.probe.size_m": {"uniform": [2.0, 6.0]}},
    "near": {"camera.trajectory.distance_m": [2.5, 3.0]},
    "far": {"camera.trajectory.distance_m": [900.0, 1000.0], "camera.fov_deg": 0.3},
}


@pytest.mark.parametrize("name", VIEWS)
def test_untouched_frames_have_no_finding(small_scene, pair, tmp_path, name):
    changes = VIEWS[name]
    sim = perilune.open(small_scene, overrides=BASE | (pair if changes == "pair" else changes))
    write("npz,exr,exr-half,png" if name == "plain" else "npz", sim, range(3), tmp_path, threads=1)
    for report in check(tmp_path, alone=True):
        assert report.findings == [], report.folder


def test_ranges_beyond_half_precision_are_no_fault():
    """A depth of 60 km at 60 degrees is 120 km away, which a half cannot hold."""
    camera = {
        "width": 3,
        "height": 1,
        "K": [[0.5773502691896258, 0.0, 1.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        "lens": None,
        "R_w2c": np.eye(3).tolist(),
        "t_w2c": [0.0, 0.0, 0.0],
    }
    record = {"camera": camera, "meta": {}, "objects": []}
    most = np.finfo(np.float16).max
    depth = np.array([[60000.0, 60000.0, 60000.0]], np.float16)
    good = {"depth": depth, "range": np.array([[most, 60000.0, most]], np.float16)}
    info = {"taxonomy": {"instances": [], "parts": [], "classes": {}}}
    assert list(geometry_faults(info, record, good, lambda steps: None)) == []
    bad = good | {"range": np.array([[most, 50000.0, most]], np.float16)}
    (text,) = geometry_faults(info, record, bad, lambda steps: None)
    assert "range is not the distance" in text
    assert "1 pixels, the first at column 1" in text


@pytest.mark.parametrize("name", ["plain", "brown", "fisheye", "exposure"])
def test_another_motion_is_found_in_the_flow(small_scene, tmp_path, name):
    """Where the next frame's record has another pose; the flow is then wrong of that object."""
    sim = perilune.open(small_scene, overrides=BASE | VIEWS[name])
    write("npz", sim, range(2), tmp_path, threads=1)
    info = json.loads((tmp_path / "dataset_info.json").read_text())
    first, second = (records.read(records.path_of(tmp_path, k)) for k in range(2))
    arrays = Npz().decode(info, first, lambda n: (tmp_path / n).read_bytes())
    pixels = {k: v for k, v in arrays.items() if v.ndim > 1}
    assert list(geometry_faults(info, first, pixels, {1: second}.get)) == []
    second["meta"]["states"]["probe"]["position_m"][0] += 0.05
    (text,) = geometry_faults(info, first, pixels, {1: second}.get)
    assert "object 'probe': flow is up to" in text
