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
