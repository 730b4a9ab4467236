"""with_overrides, and `set` of datasets and streams: curricula."""

from __future__ import annotations

import itertools
import json
import pickle

import numpy as np
import pytest
from torch.utils import data

import perilune
import perilune.torch as with_torch
from perilune.config import ConfigError
from perilune.document import Document
from perilune.document.overrides import joined
from perilune.export.check import check_bop
from perilune.simulation import Simulation

HALF = {"drivers.strength": 0.5}


@pytest.fixture(scope="module")
def driven(scene_file):
    return perilune.open(
        scene_file,
        overrides={
            "camera.width": 16,
            "camera.height": 12,
            "render.samples": 1,
            "camera.fov_deg": {"ideal": 40, "jitter_variance": 25, "clip_min": 20, "clip_max": 60},
            "drivers.interval": 1,
        },
    )


def fov(sample):
    return sample.meta["drivers"]["camera.fov_deg"]


def same(a, b):
    return all(np.array_equal(a[name], b[name], equal_nan=True) for name in a)


@pytest.mark.parametrize(
    "changes",
    [
        HALF,
        {"camera.fov_deg": perilune.Driver(30, 4, 20, 40)},
        {"camera.fov_deg": 30.0, "camera.height": 8},
        {"spacecraft.sat.size_m": 9.0, "bodies.earth.radii_km": [6400, 6400, 6300]},
        {"spacecraft.sat.part_classes": {"bus": ["bus*"]}},
        {"bodies.earth.atmosphere": {"preset": "earth"}},
        {"seed": 3},
    ],
)
def test_like_one_that_is_opened_so(driven, changes):
    """Whatever is shared: the frames are those of a configuration that says so from the start."""
    before = driven.frame(2, ["rgb", "depth", "semantic"])
    made = driven.with_overrides(changes)
    given = driven.document.given
    fresh = perilune.open(given.tree, overrides={**given.overrides, **changes}, base=given.base)
    for index in (2, 0):
        one, other = (sim.frame(index, ["rgb", "depth", "semantic"]) for sim in (made, fresh))
        assert same(one, other)
        assert one.meta["drivers"] == other.meta["drivers"]
        assert set(one.meta["overrides"]) == set(changes)
        json.dumps(one.meta["overrides"])
    assert same(driven.frame(2, ["rgb", "depth", "semantic"]), before)
    assert before.meta["overrides"] == {}
    again = pickle.loads(pickle.dumps(made))
    assert same(again.frame(2, ["rgb"]), made.frame(2, ["rgb"]))
    assert again.with_overrides(HALF)[0].meta["overrides"] == {**made[0].meta["overrides"], **HALF}


def test_what_is_shared(driven):
    model = driven.models["sat"].model
    made = driven.with_overrides(HALF).with_overrides({"render.samples": 2})
    assert made.models["sat"].model is model
    assert made._mine().renderer_of(made.config) is driven._mine().renderer_of(driven.config)
    assert made.config.drivers.strength == 0.5
    other = driven.with_overrides({"spacecraft.sat.part_classes": {"bus": ["bus*"]}})
    assert other._mine().renderer_of(other.config) is not driven._mine().renderer_of(driven.config)


def test_of_a_document_alone(driven):
    """As the check of a dataset opens one: without the file that it is from."""
    document = driven.document
    again = Simulation(Document(document.tree, document.base, document.source))
    one, other = (sim.with_overrides(HALF).frame(2, ["rgb"]) for sim in (again, driven))
    assert same(one, other)


def test_replay(driven, scene_file):
    """The metadata of a sample say what was changed."""
    sample = driven.with_overrides(HALF).frame(4, ["rgb"])
    given = driven.document.given
    meta = {key: sample.meta[key] for key in ("index", "drivers", "scene_drivers", "overrides")}
    again = perilune.open(scene_file, overrides=given.overrides, replay=meta)
    assert same(again.frame(4, ["rgb"]), sample)
    assert again[4].meta["overrides"] == HALF


def test_in_a_dataset(scene_file, tmp_path):
    """What was changed stands beside the drivers' values, and is taken again."""
    plain = perilune.open(scene_file, overrides={"camera.width": 16, "camera.height": 12})
    changed = plain.with_overrides({"camera.fov_deg": 30.0})
    perilune.write_bop(changed, range(2), tmp_path / "set")
    (file,) = (tmp_path / "set").rglob("scene_camera.json")
    frame = json.loads(file.read_text())["1"]["frame"]
    assert frame == {"index": 1, "drivers": {}, "overrides": {"camera.fov_deg": 30.0}}
    again = perilune.open(
        scene_file, overrides={"camera.width": 16, "camera.height": 12}, replay=frame
    )
    assert same(again.frame(1, ["rgb"]), changed.frame(1, ["rgb"]))
    assert check_bop(tmp_path / "set").findings == []


def test_faulty_changes(driven):
    with pytest.raises(ConfigError, match=r"drivers\.strenght: unknown key; did you mean"):
        driven.with_overrides({"drivers.strenght": 1})
    stream = perilune.Stream(driven, channels=["depth"])
    for faulty in ({"drivers.strength": -1}, {"camera.fov": 3}):
        with pytest.raises(ConfigError, match=next(iter(faulty)).replace(".", r"\.")):
            stream.set(faulty)
    with pytest.raises(ValueError, match="set: no change"):
        stream.set({})
    assert stream.changes == []
    assert next(iter(stream)).meta["overrides"] == {}


def test_joined():
    first = {"a.b": 1, "a": {"c": 2}, "d": None, "e[0]": 1}
    assert joined(first, {"a": None}) == {"d": None, "e[0]": 1, "a": None}
    assert list(joined(first, {"a.b": 3})) == ["a", "d", "e[0]", "a.b"]
    assert joined(first, {"e.0": 5}) == {"a.b": 1, "a": {"c": 2}, "d": None, "e[0]": 5}


def test_set_of_a_stream(driven):
    """From a frame on; the frames are those of with_overrides."""
    stream = perilune.Stream(driven, channels=["depth"])
    frames = iter(stream)
    next(frames)
    assert stream.set(HALF) == 1
    assert stream.set({"drivers.strength": 0.0}, at=3) == 3
    with pytest.raises(ValueError, match="at = 0: frames before 1 are made"):
        stream.set(HALF, at=0)
    found = list(itertools.islice(frames, 3))
    assert [s.meta["overrides"].get("drivers.strength") for s in found] == [0.5, 0.5, 0.0]
    assert fov(found[2]) == 40.0
    assert same(found[0], driven.with_overrides(HALF).frame(1, ["depth"]))
    state = json.loads(json.dumps(stream.state_dict()))
    assert state["changes"] == [[4, {"drivers.strength": 0.0}]]
    again = perilune.Stream(driven, channels=["depth"])
    again.load_state_dict(state)
    assert same(next(iter(again)), next(frames))
    assert pickle.loads(pickle.dumps(stream)).changes == stream.changes


def strengths(batch):
    return dict(zip(batch["index"], batch["strength"], strict=True))


def told(sample):
    """A transform: what a frame was made with."""
    strength = sample.meta["overrides"].get("drivers.strength", 1.0)
    return {"index": sample.meta["index"], "strength": strength, "fov": fov(sample)}


WAYS = [
    {"num_workers": 2},
    {"num_workers": 2, "persistent_workers": True},
    {"num_workers": 1, "multiprocessing_context": "spawn", "persistent_workers": True},
]


@pytest.mark.parametrize("way", WAYS, ids=lambda way: "-".join(map(str, way.values())))
def test_set_reaches_workers(driven, way):
    """In the middle of a loop, and between loops: exactly the frames from the index on."""
    stream = perilune.Stream(driven, transform=told, channels=["depth"])
    loader = with_torch.StreamLoader(stream, 2, collate_fn=list, **way)
    expected, found, fovs = {}, {}, {}
    for loop in range(2):
        for step, batch in enumerate(loader):
            found |= {item["index"]: item["strength"] for item in batch}
            fovs |= {item["index"]: item["fov"] for item in batch}
            if step == 1:
                at = stream.set({"drivers.strength": 0.25 * loop})
                assert at > max(found)
                expected[at] = 0.25 * loop
            if step == 8:
                break
        at = stream.set({"drivers.strength": 0.5 + loop})
        assert at == max(found) + 1  # nothing is under way between loops
        expected[at] = 0.5 + loop
    assert sorted(found) == list(range(36))
    for index, strength in found.items():
        before = [value for at, value in sorted(expected.items()) if at <= index]
        assert strength == ([1.0, *before])[-1]
        config, _ = driven.with_overrides({"drivers.strength": strength}).config_at(index)
        assert fovs[index] == config.camera.fov_deg
    state = loader.state_dict()
    again = perilune.Stream(driven, channels=["depth"])
    again.load_state_dict(state)
    assert fov(next(iter(again))) == fov(driven.with_overrides({"drivers.strength": 1.5})[36])


@pytest.mark.parametrize("way", [{"num_workers": 0}, *WAYS[:2]], ids=str)
def test_set_of_a_dataset(driven, way):
    """Between epochs all of the next one has it, by index where it is asked for."""
    frames = perilune.Dataset(driven, 6, channels=["depth"], transform=told)
    loader = data.DataLoader(frames, batch_size=2, collate_fn=list, **way)

    def epoch():
        return [item["strength"] for batch in loader for item in batch]

    assert epoch() == [1.0] * 6
    frames.set(HALF)
    assert epoch() == [0.5] * 6
    frames.set({"drivers.strength": 0.0}, at=4)
    assert epoch() == [0.5] * 4 + [0.0] * 2
    state = json.loads(json.dumps(frames.state_dict()))
    again = perilune.Dataset(driven, 6, channels=["depth"], transform=told)
    again.load_state_dict(state)
    assert [item["strength"] for item in again] == [0.5] * 4 + [0.0] * 2
