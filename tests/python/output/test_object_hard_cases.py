"""Objects in hard places, a frame each, through labels, every format and the check of each: behind
the camera, on the border, of one pixel, filling the frame, split in two, with a hole, coincident
with another, in pixel (0, 0), and there in one frame but not in the next."""

from __future__ import annotations

import json

import numpy as np
import pytest
from pycocotools import mask as rle
from scipy import ndimage
from tests.hard.glb import cube, write_glb
from tests.python.optics_scenes import FORWARD, tree

import perilune
from perilune.base import rotations
from perilune.export.check import check
from perilune.export.writers import write
from perilune.export.writers.formats.tables import FORMATS

WIDTH, HEIGHT, FOCAL = 32, 24, 40.0
EVERY = ("bop", *FORMATS)
CHANNELS = ["rgb", "radiance", "depth", "range", "position", "normal", "semantic", "part",
            "instance", "objects", "masks", "keypoints", "hierarchy", "flow", "flow_backward",
            "flow_occlusion", "flow_occlusion_backward"]  # fmt: skip
AWAY = rotations.multiply(FORWARD, np.array([0.0, 0.0, 1.0, 0.0]))
"""Half a turn about the camera's down."""
PLACES_M = {"ring": 0.0, "wall": 100.0, "bar": 94.0, "speck": 200.0, "twin": 300.0, "twin_2": 300.0}
"""Of objects, along +x; they stand still."""


def boxes(*parts):
    """Points and faces of boxes, by centre and half extents."""
    points, faces = cube(1.0)
    out = [(points * np.float32(half) + np.float32(middle)) for middle, half in parts]
    rows = [faces + k * len(points) for k in range(len(parts))]
    return np.concatenate(out).astype(np.float32), np.concatenate(rows).astype(np.uint32)


SHAPES = {
    "ring": [((0, 1.5, 0), (0.5, 0.5, 2)), ((0, -1.5, 0), (0.5, 0.5, 2)),
             ((0, 0, 1.5), (0.5, 1, 0.5)), ((0, 0, -1.5), (0.5, 1, 0.5))],
    "wall": [((0, 0, 0), (2, 2, 2))],
    "bar": [((0, 0, 0), (0.2, 0.3, 9))],
    "speck": [((0, 0, 0), (0.01, 0.01, 0.01))],
    "twin": [((0, 0, 0), (1, 1, 1))],
    "twin_2": [((0, 0, 0), (1, 1, 1))],
}  # fmt: skip


def before(name, depth_m, right_px=0.0, down_px=0.0, turn=FORWARD):
    """The camera's pose for an object at a depth and a place of the image (from its centre)."""
    right, down = right_px * depth_m / FOCAL, down_px * depth_m / FOCAL
    return [PLACES_M[name] - depth_m, right, down, *turn]


VIEWS = {
    "behind": before("ring", 30.0, turn=AWAY),
    "hole": before("ring", 12.0),
    "border": before("wall", 60.0, right_px=WIDTH / 2, down_px=3.0),
    "split": before("wall", 16.0),
    "filling": before("twin", 1.2),
    "one pixel": before("speck", 1.0, right_px=0.5, down_px=0.5),
    "corner": before("speck", 1.0, right_px=-WIDTH / 2 + 0.5, down_px=-HEIGHT / 2 + 0.5),
    "coincident": before("twin", 9.0),
    "last": before("twin", 9.0),
}


@pytest.fixture(scope="module")
def sim(tmp_path_factory):
    folder = tmp_path_factory.mktemp("objects")
    scene = tree((WIDTH, HEIGHT), FOCAL)
    for name, parts in SHAPES.items():
        write_glb(folder / f"{name}.glb", *boxes(*parts))
        scene["spacecraft"][name] = {
            "model": str(folder / f"{name}.glb"),
            "metres_per_unit": 1.0,
            "orbit": {"around": "anchor", "position_km": [0.5 + 1e-3 * PLACES_M[name], 0.0, 0.0]},
            "attitude": {"rotation_deg": [0.0, 0.0, 0.0]},
            "keypoints": {"points": {"middle": [0.0, 0.0, 0.0]}},
        }
    rows = [",".join(repr(float(x)) for x in (k, *pose)) for k, pose in enumerate(VIEWS.values())]
    (folder / "poses.csv").write_text("\n".join(rows) + "\n")
    scene["time"]["frames_per_scene"] = len(VIEWS)
    scene["camera"]["trajectory"] = {"kind": "deterministic", "file": str(folder / "poses.csv"),
                                     "target": "ring", "after": "hold"}  # fmt: skip
    scene["render"] = {"samples": 1, "max_bounces": 0, "channels": CHANNELS, "scans": ["points"]}
    return perilune.open(scene)


@pytest.fixture(scope="module")
def samples(sim):
    return {name: sim.frame(k, CHANNELS) for k, name in enumerate(VIEWS)}


@pytest.fixture(scope="module")
def out(sim, tmp_path_factory):
    folder = tmp_path_factory.mktemp("written")
    write(",".join(EVERY), sim, range(len(VIEWS)), folder, threads=1)
    return folder


def row(sample, sim, name):
    return sample.objects[list(sim.config.spacecraft).index(name)]


def mask(sample, sim, name):
    return sample["masks"][list(sim.config.spacecraft).index(name)] != 0


def seen(sample, sim, name):
    return sample["instance"] == sim.taxonomy.instances[name]


def test_labels(sim, samples):
    nothing = samples["behind"]
    assert not nothing["instance"].any()
    assert not nothing["masks"].any()
    assert not nothing["depth"].any()
    for own in nothing.objects:
        assert (own["px_count_visib"], own["visib_fract"]) == (0, 0.0)
        assert own["bbox_visib"].tolist() == own["bbox_obj"].tolist() == [-1] * 4
    hole = seen(samples["hole"], sim, "ring")
    _, count = ndimage.label(~hole)
    assert count == 2  # around it, and within
    assert not hole[HEIGHT // 2, WIDTH // 2]
    border = row(samples["border"], sim, "wall")
    assert border["px_count_all"] > seen(samples["border"], sim, "wall").sum() > 0
    assert sum(border["bbox_obj"][[0, 2]]) >= WIDTH
    _, count = ndimage.label(seen(samples["split"], sim, "wall"))
    assert count == 2
    assert (
        mask(samples["split"], sim, "wall").sum()
        == row(samples["split"], sim, "wall")["px_count_valid"]
    )
    assert seen(samples["filling"], sim, "twin_2").all()
    one = row(samples["one pixel"], sim, "speck")
    assert (one["px_count_all"], one["px_count_visib"]) == (1, 1)
    assert one["bbox_obj"].tolist() == [WIDTH // 2, HEIGHT // 2, 0, 0]
    corner = row(samples["corner"], sim, "speck")
    assert corner["bbox_visib"].tolist() == [0, 0, 0, 0]
    assert seen(samples["corner"], sim, "speck")[0, 0]
    first, second = (row(samples["coincident"], sim, name) for name in ("twin", "twin_2"))
    assert (first["px_count_visib"], second["visib_fract"]) == (0, 1.0)
    assert first["px_count_all"] == second["px_count_all"] > 50


def test_flow_of_what_appears_and_goes(sim, samples):
    """Between views that share nothing all is hidden; the first of a scene has no flow to the
    frame before it, the last none to the next."""
    for name in ("behind", "last"):
        assert samples[name]["flow_occlusion"].all()
        assert np.isnan(samples[name]["flow"]).all()
    assert np.isnan(samples["behind"]["flow_backward"]).all()
    ring = seen(samples["hole"], sim, "ring")
    for way in ("", "_backward"):  # it was behind the camera, and is behind the next one
        assert samples["hole"]["flow_occlusion" + way][ring].all()
        assert np.isnan(samples["hole"]["flow" + way][ring]).all()
    still = seen(samples["coincident"], sim, "twin_2")
    np.testing.assert_allclose(samples["coincident"]["flow"][still], 0.0, atol=1e-6)
    assert not samples["coincident"]["flow_occlusion"][still].any()


def test_every_format_has_no_finding(out):
    reports = {report.folder.name: report for report in check(out, rerender=1)}
    assert set(reports) == set(EVERY)
    for name, report in reports.items():
        assert report.findings == [], name


def test_masks_of_coco_are_those_of_the_labels(out, sim, samples):
    """Pixel (0, 0), a single pixel, the whole picture, pieces and holes, by pycocotools."""
    file = json.loads((out / "coco/annotations/instances_train.json").read_text())
    expected = {
        (k, sim.taxonomy.instances[name]): seen(sample, sim, name)
        for k, sample in enumerate(samples.values())
        for name in SHAPES
        if seen(sample, sim, name).any()
    }
    found = {(own["image_id"], own["instance_id"]): own for own in file["annotations"]}
    assert set(found) == set(expected)
    for key, own in found.items():
        code = rle.frPyObjects(own["segmentation"], HEIGHT, WIDTH)
        np.testing.assert_array_equal(rle.decode(code) != 0, expected[key])
