"""Labels drawn over pictures: where they must be, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from tests.python.optics_scenes import opened
from tests.python.test_keypoints import scene

from perilune.cli import main
from perilune.show import preview
from perilune.show.preview import overlay, overlays


def test_each_changes_the_picture_where_it_is(repo_dir: Path) -> None:
    made = scene(lens={"model": "brown_conrady", "k1": -0.2})
    made["time"] |= {"step_s": 1.0, "frames_per_scene": 9}
    sim = opened(made, repo_dir)
    sample = sim.frame(1, ["rgb", "instance", "keypoints", "flow", "objects"])
    for name in ("axes", "boxes", "masks", "keypoints", "flow"):
        drawn = preview.render_overlay(sim, 1, [name])
        changed = (drawn != sample["rgb"]).any(axis=2)
        assert changed.any(), name
        if name == "masks":
            assert not changed[sample["instance"] == 0].any()
        if name == "keypoints":
            rows = sample.keypoints[sample.keypoints["visible"] == 2]
            ys, xs = np.nonzero(changed)
            near = [np.hypot(xs - x, ys - y).min() < 6.0 for x, y in rows["xy"]]
            assert near
            assert all(near)


VIEWS = {
    "pinhole": {},
    "brown": {"lens": {"model": "brown_conrady", "k1": -0.2, "p1": 0.01}},
    "fisheye": {"lens": {"model": "fisheye", "k1": 0.02}},
    "rolling": {"exposure_time_s": 0.001, "line_time_us": 20000.0},
    "both": {
        "lens": {"model": "brown_conrady", "k1": -0.2},
        "exposure_time_s": 0.001,
        "line_time_us": 20000.0,
    },
}


@pytest.mark.parametrize("name", VIEWS)
def test_lines_lie_where_lens_and_shutter_put_them(repo_dir: Path, name: str) -> None:
    """Axes begin at the image of the origin and go towards those of points on them, which the core
    finds row by row; boxes hold the pixels of what they are of, and no less."""
    made = scene(**VIEWS[name])
    points = {"o": [0, 0, 0], "x": [0.5, 0, 0], "y": [0, 0.5, 0], "z": [0, 0, 0.5]}
    made["spacecraft"]["sat"]["keypoints"] = {"points": points}
    made["render"]["force_on"] = ["rolling_shutter"] if "line_time_us" in VIEWS[name] else []
    sim = opened(made, repo_dir)
    sample = sim.frame(0, ["instance", "objects", "keypoints"])
    (row,) = sample.objects
    axes = overlays._axes_at(sample, "sat", row)
    found = {str(k["name"]): k["xy"] for k in sample.keypoints}
    for axis, point in zip(axes, "xyz", strict=True):
        assert np.hypot(*(axis[0] - found["o"])) < 0.1
        # The nearest place of the line: segments are short, so that a chord is near enough.
        steps = np.linspace(axis[:-1], axis[1:], 50).reshape(-1, 2)
        assert np.hypot(*(steps - found[point]).T).min() < 0.1, point
    line = overlay.box_line(row, np.asarray, np.array([96.0, 72.0]))
    ys, xs = np.nonzero(sample["instance"] == row["instance_id"])
    low, high = line.points.min(axis=0), line.points.max(axis=0)
    assert np.abs(low - [xs.min() - 0.5, ys.min() - 0.5]).max() <= 1.0
    assert np.abs(high - [xs.max() + 0.5, ys.max() + 0.5]).max() <= 2.0


def test_larger_and_by_command(small_scene: Path, tmp_path: Path) -> None:
    out = tmp_path / "o.png"
    arguments = ["preview", str(small_scene), "--overlay", "boxes,axes", "--out", str(out)]
    assert main(arguments) == 0
    with Image.open(out) as image:
        assert image.size == (96, 72)


def test_what_is_not_there_is_named(repo_dir: Path) -> None:
    sim = opened(scene(), repo_dir)
    with pytest.raises(ValueError, match=r"no 'axis'.*axes"):
        preview.render_overlay(sim, 0, ["axis"])
