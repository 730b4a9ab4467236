"""Whenever a run or a merge is stopped, the same call finishes it, to the byte."""

from __future__ import annotations

import importlib
import os
import shutil

import pytest

import perilune
from perilune.export.check import check_bop
from perilune.export.writers import merge_bop
from perilune.export.writers.bop import LABELS

from .stops import Canned, run_until, tree_bytes

FRAMES = range(3)
CHUNK = 2


@pytest.fixture(scope="module")
def sim(small_scene):
    changes = {
        "camera.width": 24,
        "camera.height": 18,
        "render.samples": 1,
        "render.channels": ["instance", "range"],
        "spacecraft.probe.articulation": [{"node": "probe", "axis": [0, 0, 1], "angle_deg": 5.0}],
    }
    opened = perilune.open(small_scene, overrides=changes)
    return Canned(opened, FRAMES, ("rgb", "range", *LABELS))


@pytest.fixture(autouse=True)
def no_disk(monkeypatch):
    """What is written need not reach the disk: some take 10 ms for each file."""
    monkeypatch.setattr(os, "fsync", lambda descriptor: None)


def write(sim, out, **options):
    perilune.write_bop(sim, FRAMES, out, chunk_size=CHUNK, threads=1, **options)


@pytest.fixture(scope="module")
def truth(sim, tmp_path_factory):
    out = tmp_path_factory.mktemp("truth") / "out"
    write(sim, out)
    assert check_bop(out, alone=True).findings == []
    return tree_bytes(out)


STEP = int(os.environ.get("PERILUNE_STOP_STEP", "0"))
"""Operations from one stop to the next, in place of each test's own; 1 for all."""


def every_stop(root, step, kill, begin, task, end):
    """Stops `task` at operations on files below `root`; `begin` goes before each, `end` after."""
    at, stops = 1, 0
    while True:
        begin()
        if run_until(root, at, kill, task) is not None:
            return stops
        end(f"stopped at operation {at}")
        at, stops = at + (STEP or step), stops + 1


@pytest.mark.parametrize(("kill", "step"), [(True, 7), (False, 11)], ids=["kill", "ctrl-C"])
def test_a_run_goes_on_from_any_operation(sim, truth, tmp_path, kill, step):
    out = tmp_path / "out"

    def end(where):
        write(sim, out)
        assert tree_bytes(out) == truth, where

    stops = every_stop(
        out, step, kill, lambda: shutil.rmtree(out, True), lambda: write(sim, out), end
    )
    assert stops > 250 // (STEP or step)


@pytest.mark.parametrize(("kill", "step"), [(True, 3), (False, 5)], ids=["kill", "ctrl-C"])
@pytest.mark.parametrize("place", ["in place", "elsewhere", "copied"])
def test_a_merge_goes_on_from_any_operation(sim, truth, tmp_path, monkeypatch, kill, step, place):
    folders = [tmp_path / "one", tmp_path / ("one" if place == "in place" else "two")]
    for k, folder in enumerate(folders):
        write(sim, folder, shard=(k, 2))
    target, out = folders[0], None
    kept = tmp_path / "kept"
    shutil.copytree(target, kept)
    if place != "in place":
        target = out = tmp_path / "out"
    if place == "copied":
        monkeypatch.setattr(os, "link", None)  # as on a disk without hard links

        def copy(source, copied):
            shutil.copyfile(source, copied)

        # The package has a function of the module's name.
        merging = importlib.import_module("perilune.export.writers.merge")
        monkeypatch.setattr(merging, "_copy", copy)

    def begin():
        shutil.rmtree(target, ignore_errors=True)
        if out is None:
            shutil.copytree(kept, target)

    def task():
        merge_bop(dict.fromkeys(folders), out)

    def end(where):
        task()
        assert tree_bytes(target) == truth, where

    assert every_stop(target, step, kill, begin, task, end) > 5


def test_the_mark_of_an_unfinished_scene_on_a_finished_one(sim, truth, tmp_path):
    out = tmp_path / "out"
    write(sim, out)
    (out / "train/000000/.partial").mkdir()
    assert check_bop(out, alone=True).findings
    sim.rendered.clear()
    write(sim, out)
    assert sim.rendered == []
    assert tree_bytes(out) == truth


@pytest.mark.parametrize("name", ["", "models", "models_parts", "train/000000", "train/000001/rgb"])
def test_what_a_killed_run_left_half_written_goes(sim, truth, tmp_path, name):
    out = tmp_path / "out"
    write(sim, out)
    (out / name / "x.json.123.tmp").write_bytes(b"half")
    write(sim, out)
    assert tree_bytes(out) == truth


@pytest.mark.parametrize("cut", [lambda data: b"", lambda data: data[: len(data) // 2], None])
@pytest.mark.parametrize(
    "name",
    [
        "train/000000/rgb/000001.png",
        "train/000000/mask/000001_000000.png",
        "train/000000/instance/000001.png",
        "train/000000/range/000001.npy",
        "models/obj_000001.ply",
        "models/models_info.json",
        "models_parts/obj_000001.ply",
    ],
)
def test_damaged_files_are_made_again(sim, truth, tmp_path, name, cut):
    """Emptied, cut, or a byte changed where the format has a checksum."""
    out = tmp_path / "out"
    write(sim, out)
    path = out / name
    data = path.read_bytes()
    if cut is not None:
        path.write_bytes(cut(data))
    elif name.endswith(".png"):
        middle = len(data) // 2
        path.write_bytes(data[:middle] + bytes([data[middle] ^ 1]) + data[middle + 1 :])
    else:
        path.write_bytes(data + b"\0")
    sim.rendered.clear()
    # Frame 0 alone is asked for, but the scene's other image is found damaged.
    perilune.write_bop(sim, range(1), out, chunk_size=CHUNK, threads=1)
    assert sim.rendered == ([1] if "train" in name else [])
    assert tree_bytes(out) == truth


def test_another_model_is_refused(sim, tmp_path):
    out = tmp_path / "out"
    write(sim, out)
    path = out / "models/obj_000001.ply"
    data = bytearray(path.read_bytes())
    data[-60] ^= 1
    path.write_bytes(data)
    with pytest.raises(ValueError, match="is not the model of this configuration"):
        write(sim, out)


def test_files_are_on_the_disk_before_what_names_them(sim, tmp_path, monkeypatch):
    """At every rename to a scene's note or JSON file, all images that it names have been synced."""
    synced, order = set(), []
    replace = os.replace

    def fsync(descriptor):
        synced.add(os.readlink(f"/proc/self/fd/{descriptor}"))

    def replaced(source, target):
        order.append((str(target), set(synced)))
        if str(source) in synced:
            synced.add(str(target))
        replace(source, target)

    monkeypatch.setattr(os, "fsync", fsync)
    monkeypatch.setattr(os, "replace", replaced)
    out = tmp_path / "out"
    write(sim, out)
    for target, done in order:
        if "/.partial/" in target:
            scene, name = target.split("/.partial/")
            images = [path for path in done if path.startswith(f"{scene}/")]
            wanted = ("rgb", "depth", "mask", "mask_visib", "instance", "range")
            for folder in wanted:
                assert any(f"/{folder}/{name[:6]}" in path for path in images), (target, folder)
    assert {str(path) for path in out.rglob("*.ply")} <= synced
    assert {str(path) for path in out.rglob("*.json")} <= synced
