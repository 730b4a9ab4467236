"""Keypoints in COCO and YOLO, as their users read them."""

from __future__ import annotations

import contextlib
import io
import json

import numpy as np
import pytest
import yaml
from pycocotools.coco import COCO
from pycocotools.cocoeval import COCOeval

import perilune
from perilune.config import ConfigError
from perilune.export.writers import write

POINTS = {
    "nose": [1.0, 0.0, 0.5],
    "tail": [-1.0, 0.2, -0.5],
    "far": [90.0, 0.0, 0.0],
    "inside": [0.0, 0.0, 0.0],
}
FRAMES = range(3)


@pytest.fixture(scope="module")
def sim(small_scene):
    twin = json.loads(small_scene.read_text())["spacecraft"]["probe"]
    twin["model"] = str(small_scene.parent / "probe.glb")
    twin["orbit"]["mean_anomaly_deg"] = 10.00002
    changes = {
        "spacecraft.probe.keypoints": {"points": POINTS},
        "spacecraft.twin": {**twin, "keypoints": {"points": {"grip": [0.0, 1.0, 0.0]}}},
        "render.channels": ["rgb", "instance", "objects", "keypoints"],
        "render.samples": 1,
    }
    return perilune.open(small_scene, overrides=changes)


@pytest.fixture(scope="module")
def out(sim, tmp_path_factory):
    folder = tmp_path_factory.mktemp("keypoints")
    write(["coco", "yolo-pose", "npz"], sim, FRAMES, folder)
    return folder


def quiet(task, *arguments):
    with contextlib.redirect_stdout(io.StringIO()):
        return task(*arguments)


def rows_of(sim, index, owner):
    table = sim.frame(index, ["keypoints"]).keypoints
    return [row for row in table if row["object"] == owner]


def test_coco_holds_what_the_sample_tells(out, sim):
    truth = quiet(COCO, out / "coco/annotations/instances_train.json")
    named = {row["name"]: row for row in truth.dataset["categories"]}
    assert named["probe"]["keypoints"] == list(POINTS)
    assert named["twin"]["keypoints"] == ["grip"]
    assert {row["object"] for row in truth.anns.values()} == {"probe", "twin"}
    for entry in truth.anns.values():
        rows = rows_of(sim, entry["image_id"], entry["object"])
        found = np.array(entry["keypoints"]).reshape(-1, 3)
        expected = [[*row["xy"], row["visible"]] if row["visible"] else [0, 0, 0] for row in rows]
        np.testing.assert_allclose(found, expected, atol=1e-9)
        assert entry["num_keypoints"] == np.count_nonzero(found[:, 2])
    seen = {v for row in truth.anns.values() for v in row["keypoints"][2::3]}
    assert seen == {0, 1, 2}


def test_coco_truth_has_a_precision_of_one_and_what_is_moved_less(out):
    truth = quiet(COCO, out / "coco/annotations/instances_train.json")
    (category,) = truth.getCatIds("probe")
    rows = truth.loadAnns(truth.getAnnIds(catIds=[category]))

    def precision(by):
        results = []
        for row in rows:
            points = np.array(row["keypoints"], dtype=float).reshape(-1, 3)
            points[:, 0] += by * row["area"] ** 0.5
            results.append(
                {key: row[key] for key in ("image_id", "category_id")}
                | {"keypoints": points.ravel().tolist(), "score": 1.0}
            )
        found = quiet(truth.loadRes, results)
        evaluation = COCOeval(truth, found, "keypoints")
        evaluation.params.catIds = [category]
        evaluation.params.kpt_oks_sigmas = np.full(len(POINTS), 0.05)
        quiet(evaluation.evaluate)
        quiet(evaluation.accumulate)
        quiet(evaluation.summarize)
        return evaluation.stats[0]

    exact, near, far = (precision(by) for by in (0.0, 0.04, 2.0))
    assert exact == pytest.approx(1.0)
    assert far < near < exact


def test_yolo_has_one_number_of_keypoints(out, sim):
    data = yaml.safe_load((out / "yolo-pose/data.yaml").read_text())
    assert data["kpt_shape"] == [len(POINTS), 3]
    numbers = {name: int(number) for number, name in data["names"].items()}
    assert data["kpt_names"] == {
        str(numbers["probe"]): list(POINTS), str(numbers["twin"]): ["grip"]
    }  # fmt: skip
    for index in FRAMES:
        lines = (out / f"yolo-pose/labels/train/{index:06d}.txt").read_text().splitlines()
        boxes = (out / "coco/annotations/instances_train.json").read_text()
        assert len(lines) == sum(
            row["image_id"] == index for row in json.loads(boxes)["annotations"]
        )
        for line in lines:
            words = [float(word) for word in line.split()]
            owner = "probe" if words[0] == numbers["probe"] else "twin"
            found = np.array(words[5:]).reshape(len(POINTS), 3)
            rows = rows_of(sim, index, owner)
            for row, (x, y, v) in zip(rows, found, strict=False):
                assert v == row["visible"]
                place = (row["xy"] + 0.5) / (96, 72) if v else (0.0, 0.0)
                np.testing.assert_allclose((x, y), place, atol=1e-7)
            assert not found[len(rows) :].any()


def test_names_belong_to_a_class(sim, tmp_path):
    other = sim.with_overrides({"spacecraft.twin.class": "probe"})
    with pytest.raises(ConfigError, match=r"spacecraft\.twin have the class 'probe' but other key"):
        write(["coco"], other, FRAMES, tmp_path / "a")
    bare = {"spacecraft.probe.keypoints": {}, "spacecraft.twin.keypoints": {}}
    bare["render.channels"] = ["rgb"]
    with pytest.raises(ConfigError, match=r"format 'yolo-pose': no spacecraft has `keypoints`"):
        write(["yolo-pose"], sim.with_overrides(bare), FRAMES, tmp_path / "b")
    assert not (tmp_path / "a").exists()
    assert not (tmp_path / "b").exists()
