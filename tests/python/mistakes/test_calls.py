"""Mistakes in calls from Python are told by the argument, its value and what is allowed."""

from __future__ import annotations

import datetime
import warnings
from functools import partial

import numpy as np
import pytest
from tests.python.mistakes.rule import fault

import perilune
from perilune.document.loader import read_tree

opened = perilune.open
META = {"index": 0, "drivers": {}}

# (name, what is called with (scene, sim, folder), what the message must hold)
CALLS = [
    ("open number", lambda p, s, f: opened(3), ["config", "3"]),
    ("open none", lambda p, s, f: opened(None), ["config", "None"]),
    ("open list", lambda p, s, f: opened([p]), ["config", "path or a mapping"]),
    ("open bytes", lambda p, s, f: opened(b"a.yaml"), ["config", "a.yaml"]),
    ("open nowhere", lambda p, s, f: opened("nowhere.yaml"), ["nowhere.yaml", "no such"]),
    ("open folder", lambda p, s, f: opened(f), ["is a folder"]),
    ("open empty", lambda p, s, f: opened({}), ["version: required"]),
    ("open number keys", lambda p, s, f: opened({1: 2}), ["a key must be a text", "1"]),
    ("open object", lambda p, s, f: opened({"a": object()}), ["a:", "type object"]),
    ("seed text", lambda p, s, f: opened(p, seed="x"), ["seed = 'x'", "whole number"]),
    ("seed float", lambda p, s, f: opened(p, seed=1.5), ["seed = 1.5", "whole number"]),
    ("seed below 0", lambda p, s, f: opened(p, seed=-1), ["seed = -1", "0"]),
    ("overrides list", lambda p, s, f: opened(p, overrides=["a=1"]), ["overrides", "camera.width"]),
    ("overrides text", lambda p, s, f: opened(p, overrides="a=1"), ["overrides", "a=1"]),
    ("overrides keys", lambda p, s, f: opened(p, overrides={3: 4}), ["overrides", "3"]),
    (
        "overrides twice",
        lambda p, s, f: opened(p, overrides={"camera.K.4": 1, "camera.K[4]": 2}),
        ["camera.K[4]", "another name of camera.K.4"],
    ),
    (
        "overrides index",
        lambda p, s, f: opened(p, overrides={"camera.trajectory.distance_m.7": 1}),
        ["camera.trajectory.distance_m.7", "list of 2"],
    ),
    (
        "section lost",
        lambda p, s, f: opened(p, overrides={"camera": {"width": 64}}),
        ["camera.height: required", "camera.trajectory: required"],
    ),
    (
        "remove nothing",
        lambda p, s, f: opened(p, overrides={"camera.lense": None}),
        ["camera.lense", "nothing to remove", "did you mean 'lens'"],
    ),
    ("keyword", lambda p, s, f: opened(p, camera_width=3), ["camera_width", "unknown key"]),
    ("orbits list", lambda p, s, f: opened(p, orbits=["sat"]), ["orbits", "{'sat': function}"]),
    ("orbits name", lambda p, s, f: opened(p, orbits={"satt": len}), ["did you mean 'sat'"]),
    ("orbits dots", lambda p, s, f: opened(p, orbits={"sat": ...}), ["orbits['sat']", "Ellipsis"]),
    ("orbits none", lambda p, s, f: opened(p, orbits={"sat": None}), ["orbits['sat']", "None"]),
    (
        "orbits mapping",
        lambda p, s, f: opened(p, orbits={"sat": {"kind": "kepler"}}),
        ["orbits['sat']", "function", "overrides"],
    ),
    ("orbits path", lambda p, s, f: opened(p, orbits={"sat": "m:f"}), ["orbits['sat']", "m:f"]),
    ("trajectory", lambda p, s, f: opened(p, trajectory="m:f"), ["trajectory", "m:f", "World"]),
    ("trajectory pose", lambda p, s, f: opened(p, trajectory=[0] * 7), ["trajectory", "function"]),
    ("replay number", lambda p, s, f: opened(p, replay=3), ["replay", "3"]),
    ("replay empty", lambda p, s, f: opened(p, replay={"seed": 1}), ["replay", "index"]),
    (
        "replay drivers",
        lambda p, s, f: opened(p, replay={"index": 0, "drivers": 3}),
        ["replay: drivers", "3"],
    ),
    (
        "replay other driver",
        lambda p, s, f: opened(p, replay={"index": 0, "drivers": {"camera.fov": 3}}),
        ["replay", "camera.fov"],
    ),
    (
        "replay index",
        lambda p, s, f: opened(p, replay={"index": -1, "drivers": {}}),
        ["replay: index", "-1"],
    ),
    ("index float", lambda p, s, f: s[1.5], ["integer", "1.5"]),
    ("index text", lambda p, s, f: s["rgb"], ["integer", "rgb"]),
    ("index below 0", lambda p, s, f: s[-1], ["-1"]),
    ("index slice", lambda p, s, f: s[0:3], ["integer", "slice"]),
    ("index large", lambda p, s, f: s[2**31], ["2147483648"]),
    ("channels text", lambda p, s, f: s.frame(0, channels="rgb"), ["channels", "['rgb']"]),
    ("channels number", lambda p, s, f: s.frame(0, channels=3), ["channels", "3"]),
    ("channels wrong", lambda p, s, f: s.frame(0, channels=["rbg"]), ["did you mean 'rgb'"]),
    ("channels sensor", lambda p, s, f: s.frame(0, channels=["raw"]), ["camera.sensor"]),
    ("threads text", lambda p, s, f: s.frame(0, threads="all"), ["threads", "'all'"]),
    ("threads zero", lambda p, s, f: s.frame(0, threads=0), ["threads = 0"]),
    ("out number", lambda p, s, f: s.frame(0, out={"rgb": 3}), ["out['rgb']", "NumPy"]),
    ("out name", lambda p, s, f: s.frame(0, out={"rbg": np.zeros(3)}), ["did you mean 'rgb'"]),
    (
        "out shape",
        lambda p, s, f: s.frame(0, out={"rgb": np.zeros((2, 2, 3), np.uint8)}),
        ["out['rgb']", "(32, 48, 3)", "(2, 2, 3)"],
    ),
    (
        "out type",
        lambda p, s, f: s.frame(0, out={"rgb": np.zeros((32, 48, 3))}),
        ["out['rgb']", "uint8", "float64"],
    ),
    ("sample key", lambda p, s, f: s.frame(0, channels=["rgb"])["depth"], ["depth", "holds rgb"]),
    ("bop path", lambda p, s, f: perilune.write_bop(str(p), range(1), f), ["sim", "scene.yaml"]),
    ("bop none", lambda p, s, f: perilune.write_bop(None, range(1), f), ["sim", "Simulation"]),
    ("bop number", lambda p, s, f: perilune.write_bop(s, 3, f), ["frames", "range", "3"]),
    (
        "bop generator",
        lambda p, s, f: perilune.write_bop(s, (k for k in range(3)), f),
        ["frames", "range", "generator"],
    ),
    ("bop text", lambda p, s, f: perilune.write_bop(s, "0:3", f), ["frames", "range", "str"]),
    (
        "bop floats",
        lambda p, s, f: perilune.write_bop(s, np.array([0.0, 1.0]), f),
        ["frames[0] = 0.0", "whole number"],
    ),
    ("bop uneven", lambda p, s, f: perilune.write_bop(s, [0, 1, 3], f), ["frames[2] = 3"]),
    ("bop twice", lambda p, s, f: perilune.write_bop(s, [1, 1], f), ["frames[1] = 1", "rise"]),
    ("bop falling", lambda p, s, f: perilune.write_bop(s, [2, 1], f), ["rise"]),
    ("bop none of them", lambda p, s, f: perilune.write_bop(s, [], f), ["frames", "at least one"]),
    ("bop negative", lambda p, s, f: perilune.write_bop(s, range(-1, 2), f), ["frames", "below 0"]),
    ("bop out", lambda p, s, f: perilune.write_bop(s, range(1), 3), ["out", "3"]),
    ("bop foreign", lambda p, s, f: perilune.write_bop(s, range(1), f), ["mine.txt", "no dataset"]),
    (
        "bop chunk",
        lambda p, s, f: perilune.write_bop(s, range(1), f, chunk_size=0),
        ["chunk_size", "0"],
    ),
    (
        "bop split",
        lambda p, s, f: perilune.write_bop(s, range(1), f, split="Test"),
        ["split", "Test"],
    ),
    (
        "bop shard",
        lambda p, s, f: perilune.write_bop(s, range(1), f, shard=(2, 2)),
        ["shard", "2/2"],
    ),
    ("dataset length", lambda p, s, f: perilune.Dataset(s, "5"), ["length", "'5'"]),
    ("dataset below 0", lambda p, s, f: perilune.Dataset(s, -5), ["length = -5"]),
    ("dataset start", lambda p, s, f: perilune.Dataset(s, 5, start=1.5), ["start = 1.5"]),
    ("dataset index", lambda p, s, f: perilune.Dataset(s, 5)[5], ["5"]),
    ("dataset seed", lambda p, s, f: perilune.Dataset(s, 5, seed=9), ["seed"]),
    ("stream shard", lambda p, s, f: perilune.Stream(s, shard=3), ["shard = 3", "(k, n)"]),
    ("stream shard out", lambda p, s, f: perilune.Stream(s, shard=(2, 2)), ["shard = (2, 2)"]),
    ("stream start", lambda p, s, f: perilune.Stream(s, start=-1), ["start = -1"]),
    ("collate none", lambda p, s, f: perilune.collate([]), ["no samples"]),
    ("collate numbers", lambda p, s, f: perilune.collate([3]), ["samples[0]", "3"]),
    ("driver variance", lambda p, s, f: perilune.Driver(1, -1, 0, 2), ["jitter_variance", "-1"]),
    ("driver outside", lambda p, s, f: perilune.Driver(5, 1, 0, 2), ["ideal", "5"]),
    ("driver text", lambda p, s, f: perilune.Driver("1", 1, 0, 2), ["ideal", "'1'"]),
    ("driver setting", lambda p, s, f: perilune.Driver(1, 1, 0, 2, every=3), ["every", "unknown"]),
    ("choice none", lambda p, s, f: perilune.Driver.choice([]), ["choice", "one value or more"]),
    ("uniform", lambda p, s, f: perilune.Driver.uniform(2, 1), ["uniform", "[2, 1]"]),
    ("graph", lambda p, s, f: s.graph("gold"), ["gold", "allowed"]),
    ("taxonomy", lambda p, s, f: s.taxonomy.names("parts"), ["parts", "did you mean 'part'"]),
    ("plan", lambda p, s, f: s.plan(-1), ["-1"]),
    ("light curve", lambda p, s, f: s.light_curve("satt", range(2)), ["did you mean 'sat'"]),
    (
        "time of day",
        lambda p, s, f: opened({**read_tree(p), "time": {"epoch": datetime.time(1)}}),
        ["time.epoch", "type time"],
    ),
]


@pytest.fixture(scope="module")
def scene(repo_dir):
    return repo_dir / "tests/python/scene.yaml"


@pytest.fixture(scope="module")
def sim(scene):
    return perilune.open(scene)


@pytest.mark.parametrize(("call", "needed"), [row[1:] for row in CALLS], ids=[r[0] for r in CALLS])
def test_it_is_told_by_its_argument(scene, sim, tmp_path, call, needed):
    (tmp_path / "mine.txt").write_text("")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert not fault(partial(call, scene, sim, tmp_path), needed)
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"], "nothing is written"


def test_a_section_that_is_replaced_is_told(scene):
    replaced = r"override render: replaces .* 'render\.samples' changes"
    with pytest.warns(UserWarning, match=replaced) as told:
        perilune.open(scene, overrides={"render": {"samples": 4}})
    assert told[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        perilune.open(scene, overrides={"spacecraft": {}, "camera.trajectory.target": "earth"})


def test_a_key_has_one_name_in_metadata(sim):
    """However it was written; as the metadata of drivers have it."""
    driver = {"uniform": [19.0, 20.0]}
    key = "camera.trajectory.distance_m[1]"
    for name in ("camera.trajectory.distance_m.1", key):
        meta = sim.with_overrides({name: driver}).frame(0, channels=["depth"]).meta
        assert list(meta["overrides"]) == list(meta["drivers"]) == [key]


def test_dates_without_quotes_are_dates(scene):
    """As yaml.safe_load reads them."""
    tree = read_tree(scene)
    utc = datetime.UTC
    for epoch in (
        datetime.datetime(2026, 3, 20, 12),
        datetime.datetime(2026, 3, 20, 12, tzinfo=utc),
        datetime.datetime(2026, 3, 20, 14, tzinfo=datetime.timezone(datetime.timedelta(hours=2))),
    ):
        tree["time"]["epoch"] = epoch
        assert perilune.open(tree, base=scene.parent).config.time.epoch == "2026-03-20T12:00:00Z"
    tree["time"]["epoch"] = datetime.date(2026, 3, 20)
    assert perilune.open(tree, base=scene.parent).config.time.epoch == "2026-03-20"


def test_frames_of_a_list_or_an_array(sim, tmp_path):
    lists = ([0, 2], np.array([0, 2]), range(0, 3, 2))
    found = [perilune.write_bop(sim, frames, tmp_path / f"d{k}") for k, frames in enumerate(lists)]
    assert [report.written for report in found] == [2, 2, 2]


def test_a_changed_key_is_named(scene, tmp_path):
    perilune.write_bop(perilune.open(scene), range(1), tmp_path / "d")
    other = perilune.open(scene, overrides={"camera.fov_deg": 41, "labels.other_part": "rest"})
    with pytest.raises(ValueError, match=r"camera\.fov_deg was 40, here 41") as error:
        perilune.write_bop(other, range(1), tmp_path / "d")
    assert 'labels.other_part was not given, here "rest"' in str(error.value)


def test_the_mistakes_are_different_ones():
    assert len({row[0] for row in CALLS}) == len(CALLS) >= 80
