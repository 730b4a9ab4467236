"""The rules and invariants of BOP over 200 random scenes: counts, boxes, masks, depths and files
are those of rays at the written models in the written poses; the truth scores in BOP's metrics."""

from __future__ import annotations

import json
import os

import numpy as np
import pytest
from PIL import Image
from pycocotools import mask as rle

import perilune
from perilune.export.check import check_bop

from .bop_metrics import View, recalls
from .bop_worlds import STEPS, solids, turned, world

WORLDS = int(os.environ.get("PERILUNE_BOP_WORLDS", "20"))
"""Of STEPS scenes each; script/soak takes more."""
CHUNK = 4


class Scenes:
    """A written dataset, read image by image."""

    def __init__(self, out):
        self.out, self.solids = out, solids(out)
        self.files = {}
        for folder in sorted((out / "test").iterdir()):
            names = ("camera", "gt", "gt_info", "gt_coco")
            self.files[folder] = {
                name: json.loads((folder / f"scene_{name}.json").read_text()) for name in names
            }

    def is_body(self, obj_id):
        return self.solids[obj_id].semi_axes is not None

    def images(self):
        for folder, files in self.files.items():
            for key in files["gt"]:
                yield folder, files, int(key)


def picture(path):
    with Image.open(path) as image:
        return np.array(image)


def pose_of(entry):
    return np.reshape(entry["cam_R_m2c"], (3, 3)), np.array(entry["cam_t_m2c"])


def view_of(scenes, folder, files, im_id):
    camera = files["camera"][str(im_id)]
    K = np.reshape(camera["cam_K"], (3, 3))
    stored = picture(folder / f"depth/{im_id:06d}.png")
    assert stored.dtype == np.uint16
    view = View(K, stored.shape, stored * camera["depth_scale"])
    return View(K, stored.shape, view.distance * view.stretch), stored, camera["depth_scale"]


def box(mask):
    rows, columns = np.nonzero(mask)
    x, y = int(columns.min()), int(rows.min())
    return [x, y, int(columns.max()) - x, int(rows.max()) - y]


def check_files(scenes):
    """Layout, keys and types (sections 2 to 7)."""
    assert len(list(scenes.images())) == STEPS
    for k, (folder, files) in enumerate(scenes.files.items()):
        assert folder.name == f"{k:06d}"
        expected = [str(i) for i in range(min(CHUNK, STEPS - k * CHUNK))]
        assert all(list(files[name]) == expected for name in ("camera", "gt", "gt_info"))
        for im_id in map(int, expected):
            rgb = picture(folder / f"rgb/{im_id:06d}.png")
            assert (rgb.dtype, rgb.ndim, rgb.shape[2]) == (np.uint8, 3, 3)
            entries = files["gt"][str(im_id)]
            assert len(files["gt_info"][str(im_id)]) == len(entries)
            for name in ("mask", "mask_visib"):
                found = sorted(p.name for p in (folder / name).glob(f"{im_id:06d}_*.png"))
                assert found == [f"{im_id:06d}_{g:06d}.png" for g in range(len(entries))]


def check_image(scenes, folder, files, im_id):
    """Poses, masks, counts, boxes and depth of an image beside rays; returns what is unsure."""
    view, stored, scale = view_of(scenes, folder, files, im_id)
    height, width = view.shape
    centre = slice(height, 2 * height), slice(width, 2 * width)
    entries, infos = files["gt"][str(im_id)], files["gt_info"][str(im_id)]
    whole, unsure, masks, seen = [], [], [], []
    for g, entry in enumerate(entries):
        R, t = pose_of(entry)
        assert np.abs(R @ R.T - np.eye(3)).max() < 1e-9
        assert np.linalg.det(R) == pytest.approx(1.0, abs=1e-9)
        depth, doubt = scenes.solids[entry["obj_id"]].depth(view.K, R, t, view.shape, 1)
        whole.append(depth)
        unsure.append(doubt)
        for name, to in (("mask", masks), ("mask_visib", seen)):
            to.append(picture(folder / f"{name}/{im_id:06d}_{g:06d}.png"))
            assert set(np.unique(to[-1])) <= {0, 255}
            assert to[-1].dtype == np.uint8
    masks, seen, whole = np.array(masks) > 0, np.array(seen) > 0, np.array(whole)
    assert (seen <= masks).all()
    assert (seen.sum(axis=0) <= 1).all()
    nearest = whole[(slice(None), *centre)]
    # two surfaces at one depth, or an outline at a pixel's centre
    order = np.sort(nearest, axis=0)
    close = np.zeros(view.shape, dtype=bool)
    if len(order) > 1:
        with np.errstate(invalid="ignore"):
            close = order[1] - order[0] < 1e-5 * order[0]
    doubt = np.any(unsure, axis=0)[centre] | close
    first = np.where(np.isfinite(nearest.min(axis=0)), nearest.argmin(axis=0), -1)
    for g, info in enumerate(infos):
        sure = ~unsure[g]
        there = np.isfinite(whole[g])
        np.testing.assert_array_equal(masks[g][sure[centre]], there[centre][sure[centre]])
        np.testing.assert_array_equal(seen[g][~doubt], (first == g)[~doubt])
        check_info(info, masks[g], seen[g], there, unsure[g], stored > 0)
    z = nearest.min(axis=0)
    certain = ~doubt & (first >= 0)
    held = certain & (z < 65534.4 * scale)
    off = np.abs(stored * scale - z)[held]
    assert (off <= 0.5 * scale * (1 + 1e-9) + 1e-6 * z[held]).all()
    assert (stored[~doubt & ((first < 0) | (z > 65535.1 * scale))] == 0).all()
    crafts = np.array([not scenes.is_body(entry["obj_id"]) for entry in entries])
    of_scale = seen[crafts] if seen[crafts].any() else seen
    if not (doubt & of_scale.any(axis=0)).any():
        check_scale(scale, z[of_scale.any(axis=0)])
    return int(doubt.sum())


def check_info(info, mask, visible, there, unsure, has_depth):
    """Of scene_gt_info, on a canvas three times the image (section 7)."""
    height, width = mask.shape
    assert info["px_count_visib"] == visible.sum()
    assert info["px_count_valid"] == (mask & has_depth).sum()
    low, high = (there & ~unsure).sum(), (there | unsure).sum()
    assert low <= info["px_count_all"] <= high
    part = info["px_count_visib"] / info["px_count_all"] if info["px_count_all"] else 0.0
    assert info["visib_fract"] == pytest.approx(part, abs=1e-12)
    if not visible.any():
        assert info["bbox_obj"] == info["bbox_visib"] == [-1, -1, -1, -1]
        return
    assert info["bbox_visib"] == box(visible)
    if not unsure.any():
        x, y, w, h = box(there)
        assert info["bbox_obj"] == [x - width, y - height, w, h]


def check_scale(scale, z):
    """The smallest of 1, 2, 5 times a power of ten that holds the farthest (section 13), of
    spacecraft if any is seen."""
    finer = [d * 10.0**k for k in range(-3, 9) for d in (1, 2, 5) if d * 10.0**k < 0.99 * scale]
    assert min(abs(scale / (d * 10.0**k) - 1.0) for k in range(-3, 9) for d in (1, 2, 5)) < 1e-12
    if len(z):
        assert z.max() <= 65534.5 * scale * (1 + 1e-6)
        assert all(z.max() > 65533.5 * other for other in finer)


def check_coco(folder, files):
    """Of scene_gt_coco (section 8)."""
    coco = files["gt_coco"]
    assert [row["id"] for row in coco["annotations"]] == list(
        range(1, 1 + len(coco["annotations"]))
    )
    rows = iter(coco["annotations"])
    for key, infos in files["gt_info"].items():
        for g, info in enumerate(infos):
            if info["px_count_visib"] == 0:
                continue
            row, im_id = next(rows), int(key)
            visible = picture(folder / f"mask_visib/{im_id:06d}_{g:06d}.png") > 0
            mask = picture(folder / f"mask/{im_id:06d}_{g:06d}.png") > 0
            assert row["image_id"] == im_id
            assert row["category_id"] == files["gt"][key][g]["obj_id"]
            assert row["area"] == visible.sum()
            assert row["iscrowd"] == 0
            assert row["ignore"] == (info["visib_fract"] < 0.1)
            x, y, w, h = box(mask)
            assert row["bbox"] == [x, y, w + 1, h + 1]
            code = rle.frPyObjects(row["segmentation"], *mask.shape)
            np.testing.assert_array_equal(rle.decode([code])[:, :, 0] != 0, visible)
    assert next(rows, None) is None


def check_targets(scenes):
    """Section 10."""
    counts = {}
    for folder, files, im_id in scenes.images():
        pairs = zip(files["gt"][str(im_id)], files["gt_info"][str(im_id)], strict=True)
        for entry, info in pairs:
            if info["visib_fract"] >= 0.1:
                key = (int(folder.name), im_id, entry["obj_id"])
                counts[key] = counts.get(key, 0) + 1
    told = json.loads((scenes.out / "test_targets_bop19.json").read_text())
    found = {(row["scene_id"], row["im_id"], row["obj_id"]): row["inst_count"] for row in told}
    assert found == counts


def targets(scenes):
    """Views, models and poses of what is a target."""
    for folder, files, im_id in scenes.images():
        view, _, _ = view_of(scenes, folder, files, im_id)
        pairs = zip(files["gt"][str(im_id)], files["gt_info"][str(im_id)], strict=True)
        for entry, info in pairs:
            if info["visib_fract"] >= 0.1:
                yield view, scenes.solids[entry["obj_id"]], pose_of(entry)


@pytest.mark.parametrize("seed", range(WORLDS))
def test_rules_hold_and_the_truth_is_right(tmp_path, seed):
    sim = world(seed, tmp_path)
    perilune.write_bop(sim, range(STEPS), tmp_path / "out", chunk_size=CHUNK, threads=1,
                       split="test")  # fmt: skip
    scenes = Scenes(tmp_path / "out")
    check_files(scenes)
    doubtful = sum(check_image(scenes, *image) for image in scenes.images())
    assert doubtful < 0.02 * STEPS * sim.config.camera.width * sim.config.camera.height
    for folder, files in scenes.files.items():
        check_coco(folder, files)
    check_targets(scenes)
    for view, solid, pose in targets(scenes):
        np.testing.assert_array_equal(recalls(view, solid, pose, pose), 1.0)


def test_recalls_fall_smoothly(tmp_path):
    """With poses that are off by more and more of the diameter and the angle."""
    steps = (0.0, 0.02, 0.05, 0.1, 0.2, 0.4, 0.8)
    found = [[] for _ in steps]
    for seed in range(3):
        folder = tmp_path / str(seed)
        folder.mkdir()
        perilune.write_bop(world(seed, folder), range(STEPS), folder / "out", threads=1,
                           chunk_size=CHUNK, split="test")  # fmt: skip
        random = np.random.default_rng(seed)
        for view, solid, (R, t) in targets(Scenes(folder / "out")):
            way = random.normal(size=3)
            way /= np.linalg.norm(way)
            for k, part in enumerate(steps):
                guess = (
                    turned(R, part, np.random.default_rng(seed)),
                    t + part * solid.diameter * way,
                )
                found[k].append(recalls(view, solid, (R, t), guess))
    means = np.array([np.mean(rows, axis=0) for rows in found])
    assert len(found[0]) > 30
    np.testing.assert_array_equal(means[0], 1.0)
    assert (np.diff(means, axis=0) <= 0.0).all()
    assert (np.diff(means.mean(axis=1)) < 0.0).all()
    assert (means[-1] < 0.1).all()
    assert (np.diff(means, axis=0) > -0.6).all()


def test_a_world_has_no_finding(tmp_path):
    """Bodies, lenses and all, by `perilune check` too."""
    perilune.write_bop(world(7, tmp_path), range(4), tmp_path / "out", threads=1)
    assert check_bop(tmp_path / "out", rerender=1).findings == []
