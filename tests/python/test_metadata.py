"""Metadata of samples, which are made when they are first read: always those of their own frame."""

from __future__ import annotations

import copy
import gc
import pickle
import weakref

import numpy as np
import pytest

import perilune
from perilune.document import Document
from perilune.document.loader import read_tree
from perilune.frame.metadata import Metadata

STILL = {"bodies.earth.rotation": {"spin_rate_deg_s": 0.0}, "sun.direction": [1.0, 0.0, 0.0]}
SIZE = {"camera.width": 12, "camera.height": 8, "render.channels": ["depth", "objects"]}


@pytest.fixture(scope="module")
def sim(request):
    """A scene with drivers, a moving camera and steps that share what is drawn once a scene."""
    path = request.config.rootpath / "tests/python/scene.yaml"
    drawn = {"ideal": 40.0, "jitter_variance": 9.0, "clip_min": 30.0, "clip_max": 50.0}
    drawn["interval"] = 1
    more = {"camera.fov_deg": drawn, "camera.exposure_time_s": 0.01, "time.frames_per_scene": 4}
    return perilune.open(path, overrides={**SIZE, **more})


def untimed(sample) -> bytes:
    """All metadata to the bit, but the times of rendering, which differ from run to run."""
    meta = {key: value for key, value in sample.meta.items() if key != "timings_s"}
    camera = sample.camera
    return pickle.dumps([meta, camera.K, camera.R_w2c, camera.t_w2c, camera.lens])


def test_samples_that_are_read_late_tell_of_their_own_frame(sim):
    early = [untimed(sim[k]) for k in range(6)]
    kept = [sim[k] for k in range(6)]
    for k in range(6, 20):  # more steps than any cache of drawn values has
        sim[k]
    assert [untimed(sample) for sample in kept] == early
    assert len(set(early)) == 6
    assert kept[3].meta["scene_drivers"] != {}


def test_metadata_are_the_readers_own(sim):
    sample = sim[2]
    assert sample.meta is sample.meta
    sample.meta["note"] = "mine"
    sample.meta["drivers"].clear()
    assert sample.meta["note"] == "mine"
    assert "note" not in sim[2].meta
    assert sim[2].meta["drivers"]


@pytest.mark.parametrize("copied", [copy.copy, lambda sample: pickle.loads(pickle.dumps(sample))])
@pytest.mark.parametrize("read", [False, True])
def test_copies_have_the_same_metadata(sim, copied, read):
    sample = sim[5]
    if read:
        sample.meta["note"] = "mine"
    other = copied(sample)
    assert untimed(other) == untimed(sample)
    assert list(other) == list(sample)
    for name in sample:
        assert np.array_equal(other[name], sample[name], equal_nan=True)
    assert np.array_equal(other.objects, sample.objects)
    assert other.plan == sample.plan


def test_a_kept_sample_keeps_no_simulation(request):
    tree = read_tree(request.config.rootpath / "tests/python/scene.yaml")
    sim = perilune.open(tree, overrides=SIZE, base=request.config.rootpath / "tests/python")
    sample = sim[0]
    sims = weakref.ref(sim._mine())
    del sim
    gc.collect()
    assert sims() is None
    assert sample.meta["index"] == 0


def test_labels_alone_make_no_metadata(sim, monkeypatch):
    """What training does not read costs it nothing."""
    sample = sim[1]
    expected = untimed(sample)

    def unread(*_):
        raise AssertionError("nobody asked")

    with monkeypatch.context() as patch:
        patch.setattr(Metadata, "meta", unread)
        patch.setattr(Document, "scene_values", unread)
        sample = sim[1]
        assert sample["depth"].shape == (8, 12)
    assert untimed(sample) == expected


def test_a_date_of_no_calendar_is_refused_with_the_frame(request):
    """Before metadata are read."""
    path = request.config.rootpath / "tests/python/scene.yaml"
    sim = perilune.open(path, overrides={**SIZE, "time.step_s": -1e12, **STILL})
    with pytest.raises(ValueError, match="no date of the calendar"):
        sim[1]
