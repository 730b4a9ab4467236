"""JPEG artefacts in the sensor's picture: as Pillow makes them, in no other channel."""

from __future__ import annotations

import copy
import io

import numpy as np
import pytest
from PIL import Image

import perilune
from perilune.config import ConfigError
from perilune.document.loader import read_tree


@pytest.fixture(scope="module")
def tree(request):
    """The small scene."""
    root = request.config.rootpath
    tree = read_tree(root / "tests/python/scene.yaml")
    tree["spacecraft"]["sat"]["model"] = str(root / "assets/models/smallsat.glb")
    return tree


def taken(tree, compression, threads=1, channels=("sensor_rgb", "raw"), **overrides):
    tree = copy.deepcopy(tree)
    tree["camera"]["sensor"] = {"compression": compression, "read_noise_e": 200.0}
    sim = perilune.open(tree, overrides={"render.tolerance_dn": 0.0} | overrides)
    return sim.frame(0, list(channels), threads=threads)


@pytest.mark.parametrize("chroma", ["444", "422", "420"])
@pytest.mark.parametrize("quality", [1, 30, 75, 100])
def test_as_pillow_encodes_and_decodes(tree, quality, chroma):
    clean = taken(tree, None)
    degraded = taken(tree, {"quality": quality, "chroma": chroma})
    assert np.array_equal(clean["raw"], degraded["raw"])
    file = io.BytesIO()
    Image.fromarray(clean["sensor_rgb"]).save(
        file, "jpeg", quality=quality, subsampling={"444": 0, "422": 1, "420": 2}[chroma]
    )
    expected = np.asarray(Image.open(file)).astype(int)
    difference = np.abs(degraded["sensor_rgb"].astype(int) - expected)
    assert difference.max() <= 1  # versions of libjpeg round colours differently
    assert np.mean(difference) < 0.01
    assert np.abs(clean["sensor_rgb"].astype(int) - expected).max() > 2


def test_threads_do_not_matter(tree):
    compression = {"quality": 20, "chroma": "420"}
    images = [taken(tree, compression, threads)["sensor_rgb"] for threads in (1, 2, 3)]
    assert np.array_equal(images[0], images[1])
    assert np.array_equal(images[0], images[2])


def test_only_where_it_shows(tree):
    def row(sample):
        return next(row for row in sample.plan if row["name"] == "compression")

    assert row(taken(tree, None))["reason"] == "the image is not compressed"
    assert row(taken(tree, {"quality": 95}))["value"] == 1
    off = taken(tree, {"quality": 5}, **{"render.force_off": ["compression"]})
    assert np.array_equal(off["sensor_rgb"], taken(tree, None)["sensor_rgb"])


def test_a_driver_on_the_quality(tree):
    quality = {"ideal": 50.0, "jitter_variance": 900.0, "clip_min": 1.0, "clip_max": 100.0}
    degraded = taken(tree, {"quality": quality})
    value = round(degraded.meta["drivers"]["camera.sensor.compression.quality"])
    assert value != 50
    assert np.array_equal(degraded["sensor_rgb"], taken(tree, {"quality": value})["sensor_rgb"])


@pytest.mark.parametrize(
    ("compression", "text"),
    [
        ({"quality": 0}, "quality"),
        ({"quality": 101}, "quality"),
        ({"chroma": 420}, "chroma"),
        ({"chroma": "411"}, "chroma"),
        ({"subsampling": "420"}, "subsampling: unknown key"),
    ],
)
def test_what_is_no_compression_is_refused(tree, compression, text):
    with pytest.raises(ConfigError, match=rf"camera\.sensor\.compression.*{text}"):
        taken(tree, compression)
