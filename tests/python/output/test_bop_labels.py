"""Masks, scene_gt_info, the COCO file and targets, against definitions and pycocotools."""

from __future__ import annotations

import contextlib
import io
import json

import numpy as np
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra import numpy as npst
from PIL import Image
from pycocotools import mask as coco_mask
from pycocotools.coco import COCO
from tests.python.output.silhouettes import silhouettes

import perilune
from perilune.config import ConfigError
from perilune.export.writers import bop_labels

FRAMES = range(12)
CHUNK = 5


def read_json(path):
    return json.loads(path.read_text())


def read_mask(path):
    with Image.open(path) as image:
        array = np.array(image)
    assert array.dtype == np.uint8
    assert set(np.unique(array)) <= {0, 255}
    return array > 0


def decoded(segmentation):
    """A mask from uncompressed run lengths, by pycocotools."""
    return coco_mask.decode(coco_mask.frPyObjects(segmentation, *segmentation["size"])) > 0


@pytest.fixture(scope="module")
def sim(small_scene, crowd):
    return perilune.open(small_scene, overrides=crowd)


@pytest.fixture(scope="module")
def dataset(sim, tmp_path_factory):
    out = tmp_path_factory.mktemp("labels") / "crowd"
    perilune.write_bop(sim, FRAMES, out, chunk_size=CHUNK, threads=1, split="test")
    return out


def instances(dataset):
    """(frame, scene folder, image id, gt id, scene_gt_info entry, mask, visible mask)."""
    for index in FRAMES:
        folder, image = dataset / "test" / f"{index // CHUNK:06d}", index % CHUNK
        for k, info in enumerate(read_json(folder / "scene_gt_info.json")[str(image)]):
            name = f"{image:06d}_{k:06d}.png"
            masks = [read_mask(folder / part / name) for part in ("mask", "mask_visib")]
            yield index, folder, image, k, info, *masks


def test_the_scene_shows_what_these_tests_are_about(dataset):
    """Instances that are hidden in part, cut by the image, wholly unseen, and several an image."""
    rows = list(instances(dataset))
    assert any(0 < info["visib_fract"] < 1 and (m & ~v).any() for *_, info, m, v in rows)
    assert any(info["px_count_all"] > m.sum() > 0 for *_, info, m, _ in rows)
    assert any(info["px_count_visib"] == 0 for *_, info, _, _ in rows)
    assert any(info["visib_fract"] == 1.0 for *_, info, _, _ in rows)


def bop_box(mask, shift=(0, 0)):
    rows, columns = np.nonzero(mask)
    x, y = int(columns.min()), int(rows.min())
    return [x - shift[0], y - shift[1], int(columns.max()) - x, int(rows.max()) - y]


def test_gt_info_is_that_of_objects_rendered_alone(dataset, sim):
    width, height = sim.config.camera.width, sim.config.camera.height
    for index, folder, image, k, info, mask, visible in instances(dataset):
        canvas = silhouettes(sim, index)[k]
        np.testing.assert_array_equal(mask, canvas[height : 2 * height, width : 2 * width])
        with Image.open(folder / "depth" / f"{image:06d}.png") as file:
            depth = np.array(file)
        seen = int(visible.sum())
        assert not (visible & ~mask).any()
        assert info == {
            "px_count_all": int(canvas.sum()),
            "px_count_valid": int((mask & (depth > 0)).sum()),
            "px_count_visib": seen,
            "visib_fract": pytest.approx(seen / canvas.sum() if canvas.any() else 0.0, abs=1e-12),
            "bbox_obj": bop_box(canvas, (width, height)) if seen else [-1, -1, -1, -1],
            "bbox_visib": bop_box(visible) if seen else [-1, -1, -1, -1],
        }


def test_coco_loads_and_every_code_is_the_mask(dataset, sim):
    checked = 0
    for scene in sorted((dataset / "test").iterdir()):
        with contextlib.redirect_stdout(io.StringIO()):
            coco = COCO(str(scene / "scene_gt_coco.json"))
        assert coco.getCatIds() == [5, 7]
        assert [row["id"] for row in coco.dataset["annotations"]] == list(
            range(1, len(coco.anns) + 1)
        )
        infos = read_json(scene / "scene_gt_info.json")
        poses = read_json(scene / "scene_gt.json")
        assert coco.getImgIds() == [int(key) for key in infos]
        for key, rows in infos.items():
            image = coco.loadImgs(int(key))[0]
            assert (scene / image["file_name"]).is_file()
            assert (image["width"], image["height"]) == (80, 64)
            own = coco.loadAnns(coco.getAnnIds(imgIds=[int(key)]))
            seen = [k for k, row in enumerate(rows) if row["px_count_visib"] > 0]
            assert len(own) == len(seen)
            for k, entry in zip(seen, own, strict=True):
                name = f"{int(key):06d}_{k:06d}.png"
                visible, mask = (read_mask(scene / part / name) for part in ("mask_visib", "mask"))
                np.testing.assert_array_equal(decoded(entry["segmentation"]), visible)
                np.testing.assert_array_equal(coco.annToMask(entry) > 0, visible)
                x, y, w, h = bop_box(mask)
                assert entry["bbox"] == [x, y, w + 1, h + 1]
                assert entry["area"] == visible.sum()
                assert entry["category_id"] == poses[key][k]["obj_id"]
                assert entry["ignore"] is (rows[k]["visib_fract"] < 0.1)
                checked += 1
    assert checked > len(FRAMES)


def test_targets_are_those_of_the_toolkits_rule(dataset):
    """enumerate_test_targets.py: objects of which an instance is at least a tenth visible."""
    expected, images = [], []
    for index in FRAMES:
        scene, image = divmod(index, CHUNK)
        folder = dataset / "test" / f"{scene:06d}"
        images.append({"im_id": image, "scene_id": scene})
        counts = {}
        poses = read_json(folder / "scene_gt.json")[str(image)]
        for gt, info in zip(
            poses, read_json(folder / "scene_gt_info.json")[str(image)], strict=True
        ):
            if info["visib_fract"] >= 0.1:
                counts[gt["obj_id"]] = counts.get(gt["obj_id"], 0) + 1
        for obj_id, count in counts.items():
            row = {"im_id": image, "inst_count": count, "obj_id": obj_id, "scene_id": scene}
            expected.append(row)
    assert read_json(dataset / "test_targets_bop19.json") == expected
    assert read_json(dataset / "test_targets_bop24.json") == images
    assert {row["inst_count"] for row in expected} == {1, 2}


def test_train_split_has_no_targets(sim, tmp_path):
    perilune.write_bop(sim, range(1), tmp_path / "set", threads=1)
    assert not list((tmp_path / "set").glob("test_targets*"))


def test_card_counts_what_is_there(dataset):
    text = (dataset / "dataset_info.md").read_text()
    rows = list(instances(dataset))
    assert f"images: {len(FRAMES)} of 80 x 64 pixels" in text
    visible = [info["visib_fract"] >= 0.1 for *_, k, info, _, _ in rows if k < 2]
    assert f"| 5 | {len(visible)} | {sum(visible)} |" in text


def test_no_amodal_labels_no_dataset(small_scene, tmp_path):
    sim = perilune.open(small_scene, overrides={"render.amodal": False})
    with pytest.raises(ConfigError, match=r"render\.amodal"):
        perilune.write_bop(sim, range(1), tmp_path / "set")
    assert not (tmp_path / "set").exists()


masks = npst.arrays(bool, npst.array_shapes(min_dims=2, max_dims=2, max_side=9))


@given(masks)
def test_run_lengths_are_pycocotools(mask):
    code = bop_labels.run_lengths(mask)
    assert sum(code["counts"]) == mask.size
    assert all(count > 0 for count in code["counts"][1:])
    np.testing.assert_array_equal(decoded(code), mask)
    np.testing.assert_array_equal(bop_labels.decode_runs(code["counts"], mask.shape), mask)


@given(masks.filter(np.any))
def test_boxes_are_pycocotools(mask):
    code = coco_mask.encode(np.asfortranarray(mask.astype(np.uint8)))
    assert bop_labels.coco_box(mask) == coco_mask.toBbox(code).tolist()


@given(st.lists(st.integers(0, 5), max_size=6))
def test_runs_that_do_not_fill_the_image_are_refused(counts):
    if sum(counts) == 12:
        assert bop_labels.decode_runs(counts, (3, 4)).shape == (3, 4)
    else:
        with pytest.raises(ValueError, match="add up"):
            bop_labels.decode_runs(counts, (3, 4))
