"""Full silhouettes through the Python layer: masks, counts, boxes, and the switch."""

from __future__ import annotations

import numpy as np
import pytest

import perilune
from perilune.config import ConfigError
from perilune.document.loader import read_tree

CHANNELS = ["instance", "depth", "objects", "masks"]
WIDTH, HEIGHT, FRAMES = 48, 32, 12


@pytest.fixture
def base(repo_dir):
    """What the scene's paths refer to."""
    return repo_dir / "tests/python"


@pytest.fixture
def scene(base):
    """Two satellites a few metres apart, near enough to hide each other and to be cut."""
    tree = read_tree(base / "scene.yaml")
    sat = tree["spacecraft"]["sat"]
    orbit = {**sat["orbit"], "mean_anomaly_deg": 20.00003}
    tree["spacecraft"]["other"] = {**sat, "orbit": orbit}
    tree["camera"]["trajectory"]["distance_m"] = [6, 16]
    return tree


def alone(scene, base, name, request):
    """The silhouette of one satellite on the canvas of three times the size, by its pixels."""
    K = np.array(request["K"])
    K[:2, 2] += WIDTH, HEIGHT
    tree = {**scene, "spacecraft": {name: scene["spacecraft"][name]}}
    tree["camera"] = {
        **{key: value for key, value in scene["camera"].items() if key != "fov_deg"},
        "width": 3 * WIDTH,
        "height": 3 * HEIGHT,
        "K": K.ravel().tolist(),
        "trajectory": {"kind": "orbit_object", "target": name, "distance_m": 10},
    }
    sim = perilune.open(tree, base=base, trajectory=lambda world: request["camera_pose"])
    sample = sim.frame(request["index"], channels=["instance"])
    return sample["instance"] == sim.taxonomy.instances[name]


def test_against_each_satellite_alone(scene, base):
    sim = perilune.open(scene, base=base)
    seen = {"hidden": 0, "cut": 0, "whole": 0}
    for index in range(FRAMES):
        sample, request = sim.frame(index, channels=CHANNELS), sim.request(index)
        masks = sample["masks"]
        assert masks.shape == (2, HEIGHT, WIDTH)
        assert masks.dtype == np.uint8
        for name, row, mask in zip(scene["spacecraft"], sample.objects, masks, strict=True):
            canvas = alone(scene, base, name, request)
            visible = sample["instance"] == row["instance_id"]
            inside = canvas[HEIGHT : 2 * HEIGHT, WIDTH : 2 * WIDTH]
            assert np.array_equal(mask, inside)
            assert not np.any(visible & (mask == 0))
            assert row["px_count_visib"] == visible.sum()
            assert row["px_count_valid"] == (inside & (sample["depth"] > 0)).sum()
            assert row["px_count_all"] == canvas.sum()
            assert row["visib_fract"] == (visible.sum() / canvas.sum() if canvas.any() else 0)
            expected = [-1, -1, -1, -1]
            if visible.any():
                v, u = np.nonzero(canvas)
                expected = [u.min() - WIDTH, v.min() - HEIGHT, np.ptp(u), np.ptp(v)]
            assert row["bbox_obj"].tolist() == expected
            seen["hidden"] += visible.sum() < mask.sum()
            seen["cut"] += mask.sum() < canvas.sum()
            seen["whole"] += visible.sum() == canvas.sum()
    assert min(seen.values()) > 0, seen


def test_switched_off(scene, base):
    sims = [perilune.open(scene, 7, {"render.amodal": on}, base=base) for on in (True, False)]
    for index in range(3):
        full, bare = (sim.frame(index, channels=CHANNELS[:-1]) for sim in sims)
        for name in ("R_m2c", "t_m2c", "instance_id", "bbox_visib", "px_count_visib", "in_view"):
            assert np.array_equal(full.objects[name], bare.objects[name])
        assert (full.objects["px_count_all"] >= 0).all()
        assert np.isnan(bare.objects["visib_fract"]).all()
        for name in ("bbox_obj", "px_count_all", "px_count_valid"):
            assert (bare.objects[name] == -1).all()
    masks = [sim.frame(0, channels=["masks"])["masks"] for sim in sims]
    assert np.array_equal(*masks)
    with pytest.raises(ConfigError, match=r"render\.amodal"):
        perilune.open(scene, 7, {"render.amodal": 1}, base=base)


def test_what_is_asked_for(scene, base):
    sim = perilune.open(scene, base=base)
    assert "masks" not in sim[0]
    assert sim[0].has_objects
    out = {"masks": np.full((2, HEIGHT, WIDTH), 7, np.uint8)}
    assert sim.frame(0, channels=["masks"], out=out)["masks"] is out["masks"]
    assert set(np.unique(out["masks"])) == {0, 1}
    with pytest.raises(ValueError, match=r"out\['masks'\]"):
        sim.frame(0, channels=["masks"], out={"masks": np.zeros((1, HEIGHT, WIDTH), np.uint8)})
    renderer, request = sim._mine().renderer, sim.request(0)
    with pytest.raises(TypeError, match="amodal must be True or False"):
        renderer.render({**request, "amodal": 1}, {})


def test_without_spacecraft(scene, base):
    camera = {**scene["camera"], "trajectory": {"kind": "orbit_object", "target": "earth",
                                                "distance_m": 2e7}}  # fmt: skip
    sim = perilune.open({**scene, "spacecraft": {}, "camera": camera}, base=base)
    sample = sim.frame(0, channels=CHANNELS)
    assert sample["masks"].shape == (0, HEIGHT, WIDTH)
    assert len(sample.objects) == 0
