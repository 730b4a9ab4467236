"""All formats in folders alike: bytes, stops, damage, disks that are full, channels that do not
fit."""

from __future__ import annotations

import errno
import json
import os
import re
import resource
import shutil
import signal
import sys
from pathlib import Path

import numpy as np
import pytest

import perilune
from perilune.export.writers import WRITERS, FolderInUseError, merge, write
from perilune.export.writers.formats.channels import TABLE, Channel
from perilune.export.writers.formats.tables import FORMATS

from .stops import Canned, run_until, tree_bytes

FRAMES = range(3)
CHUNK = 2
CHANNELS = ["rgb", "depth", "semantic", "part", "instance", "objects", "masks", "normal"]
CHANNELS += ["flow", "flow_occlusion"]
STOPS = int(os.environ.get("PERILUNE_FORMAT_STOPS", "3"))
"""Number of stops of each format at random operations; script/soak takes 20."""


def small(small_scene, **more):
    changes = {
        "camera.width": 24,
        "camera.height": 18,
        "render.samples": 1,
        "camera.trajectory.target": "probe",
        **more,
    }
    return perilune.open(small_scene, overrides=changes)


def held(fmt):
    """Those of CHANNELS that a format can hold."""
    from perilune.export.writers.formats.channels import described

    def names(sim):
        known = described(sim, CHANNELS)
        return [name for name, row in known.items() if not fmt.problem(row)]

    return names


@pytest.fixture(scope="module")
def source(small_scene):
    return small(small_scene)


@pytest.fixture(scope="module")
def canned(source):
    """Format -> a simulation that asks for what it can hold; frames are rendered once for all."""
    every = [*CHANNELS, "keypoints", "range", "position"]
    samples = Canned(source, range(4), every)

    def of(name):
        fmt = FORMATS[name]
        scans = ["points"] if fmt.holds(Channel("points", TABLE, "table")) else []
        changes = {"render.channels": held(fmt)(source), "render.scans": scans}
        sim = source.with_overrides(changes)
        made = Canned(sim, (), ())
        made._samples = samples._samples
        return made

    return of


@pytest.fixture(autouse=True)
def no_disk(monkeypatch):
    """What is written need not reach the disk: some take 10 ms for each file."""
    monkeypatch.setattr(os, "fsync", lambda descriptor: None)


def put(sim, name, out, frames=FRAMES, **options):
    write(name, sim, frames, out, chunk_size=CHUNK, threads=1, **options)


@pytest.fixture(scope="module")
def truths(canned, tmp_path_factory):
    """Format -> files of an undisturbed run."""
    found = {}

    def of(name):
        if name not in found:
            out = tmp_path_factory.mktemp("truth") / "out"
            put(canned(name), name, out)
            found[name] = tree_bytes(out)
        return found[name]

    return of


every_format = pytest.mark.parametrize("name", list(FORMATS))


@every_format
def test_a_killed_run_goes_on(canned, truths, tmp_path, name):
    """At random operations on files, by a kill that nothing survives."""
    out, sim = tmp_path / "out", canned(name)
    count = run_until(out, 1 << 40, True, lambda: put(sim, name, out))
    assert tree_bytes(out) == truths(name)
    random = np.random.default_rng(20)
    for at in sorted(random.choice(np.arange(1, count), STOPS, replace=False).tolist()):
        shutil.rmtree(out, ignore_errors=True)
        assert run_until(out, at, True, lambda: put(sim, name, out)) is None
        put(sim, name, out)
        assert tree_bytes(out) == truths(name), f"killed at operation {at} of {count}"


@every_format
def test_threads_of_writing_and_order_change_nothing(canned, truths, tmp_path, monkeypatch, name):
    monkeypatch.setattr("perilune.export.writers.queue.WORKERS", 1)
    out, sim = tmp_path / "out", canned(name)
    put(sim, name, out, range(2, 3))
    put(sim, name, out, range(1))
    put(sim, name, out)
    assert tree_bytes(out) == truths(name)


@every_format
def test_a_finished_dataset_stays(canned, tmp_path, name):
    out, sim = tmp_path / "out", canned(name)
    put(sim, name, out)
    sim.rendered.clear()
    put(sim, name, out)
    assert sim.rendered == []


@every_format
def test_damaged_files_are_made_again(canned, truths, tmp_path, name):
    """A byte changed in the middle of any file of a frame, and one cut at its end."""
    out, sim = tmp_path / "out", canned(name)
    put(sim, name, out)
    record = json.loads((out / "frames/000001.json").read_text())
    pack = FORMATS[name].pack_name
    first = next(iter(record["files"]))
    victim = out / (first if pack is None else pack.format(chunk=0))
    for spoil in (lambda data: data[: len(data) // 2], lambda data: b""):
        data = victim.read_bytes()
        victim.write_bytes(spoil(data))
        put(sim, name, out, range(1))
        assert tree_bytes(out) == truths(name)
    data = bytearray(victim.read_bytes())
    data[len(data) // 2] ^= 1
    victim.write_bytes(bytes(data))
    put(sim, name, out, range(1))
    assert tree_bytes(out) == truths(name)


@every_format
def test_damaged_records_are_made_again(canned, truths, tmp_path, name):
    out, sim = tmp_path / "out", canned(name)
    put(sim, name, out)
    path = out / "frames/000002.json"
    path.write_text(path.read_text().replace('"seed": 3', '"seed": 4'))
    put(sim, name, out)
    assert tree_bytes(out) == truths(name)


@every_format
def test_a_full_disk_is_one_error_and_the_run_goes_on(canned, truths, tmp_path, name):
    """A limit of the size of files stands for a disk that is full."""
    out, sim = tmp_path / "out", canned(name)
    put(sim, name, out)
    largest = max(path.stat().st_size for path in out.rglob("*") if path.is_file())
    shutil.rmtree(out)
    read, end = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            sys.dont_write_bytecode = True  # modules would be cut short, too
            resource.setrlimit(resource.RLIMIT_FSIZE, (largest - 1, largest - 1))
            put(sim, name, out)
        except OSError as error:
            os.write(end, f"{error.errno} {error}".encode())
        finally:
            os._exit(0)
    os.close(end)
    with os.fdopen(read, "rb") as pipe:
        told = pipe.read().decode()
    os.waitpid(child, 0)
    assert told.startswith(f"{errno.EFBIG} "), told
    assert "cannot be written" in told
    assert str(out) in told
    put(sim, name, out)
    assert tree_bytes(out) == truths(name)


@every_format
@pytest.mark.parametrize("place", ["one folder", "two folders"])
def test_shards_merge_to_the_bytes_of_one_run(canned, truths, tmp_path, name, place):
    folders = [tmp_path / "0", tmp_path / ("0" if place == "one folder" else "1")]
    for k, folder in enumerate(folders):
        put(canned(name), name, folder, shard=(k, 2))
    out = None if place == "one folder" else tmp_path / "out"
    merge(list(dict.fromkeys(folders)), out)
    assert tree_bytes(out or folders[0]) == truths(name)


@every_format
def test_a_killed_merge_goes_on(canned, truths, tmp_path, name):
    folders, out = [tmp_path / "0", tmp_path / "1"], tmp_path / "out"
    for k, folder in enumerate(folders):
        put(canned(name), name, folder, shard=(k, 2))
    count = run_until(out, 1 << 40, True, lambda: merge(folders, out))
    for at in range(1, count, max(count // STOPS, 1)):
        shutil.rmtree(out, ignore_errors=True)
        assert run_until(out, at, True, lambda: merge(folders, out)) is None
        merge(folders, out)
        assert tree_bytes(out) == truths(name), f"killed at operation {at} of {count}"


@every_format
def test_a_missing_shard_is_named(canned, tmp_path, name):
    put(canned(name), name, tmp_path / "0", shard=(0, 2))
    with pytest.raises(ValueError, match=r"shards of frames 0:3, 1/2 is missing"):
        merge([tmp_path / "0"])


@every_format
def test_two_runs_at_once_are_refused(canned, tmp_path, name):
    from perilune.export.writers.lock import locked

    out, sim = tmp_path / "out", canned(name)
    out.mkdir()
    with locked(out), pytest.raises(FolderInUseError):
        put(sim, name, out)


@every_format
def test_another_configuration_is_refused(canned, tmp_path, name):
    out, sim = tmp_path / "out", canned(name)
    put(sim, name, out, range(1))
    other = sim.with_overrides({"camera.fov_deg": 31.0})
    with pytest.raises(ValueError, match=r"camera\.fov_deg was"):
        put(other, name, out, range(1))


def test_several_formats_are_what_each_is_alone(canned, tmp_path):
    names = ["npz", "exr", "exr-half"]
    sim = canned("exr")  # without scans
    write(["bop", *names], sim, FRAMES, tmp_path / "all", chunk_size=CHUNK, threads=1)
    assert sim.rendered == list(FRAMES)
    for name in ("bop", *names):
        write(name, sim, FRAMES, tmp_path / name, chunk_size=CHUNK, threads=1)
        assert tree_bytes(tmp_path / "all" / name) == tree_bytes(tmp_path / name), name


def test_one_of_several_is_made_again_alone(canned, tmp_path):
    sim = canned("npz")
    write("npz,exr", sim, FRAMES, tmp_path, chunk_size=CHUNK, threads=1)
    shutil.rmtree(tmp_path / "exr")
    (tmp_path / "npz/000001.npz").unlink()
    before = tree_bytes(tmp_path / "npz")
    sim.rendered.clear()
    write("npz,exr", sim, FRAMES, tmp_path, chunk_size=CHUNK, threads=1)
    assert sim.rendered == list(FRAMES)
    assert set(tree_bytes(tmp_path / "npz")) == {*before, "000001.npz"}


def test_a_channel_that_no_format_holds_is_an_error(small_scene, tmp_path):
    sim = small(small_scene, **{"render.channels": ["rgb", "position"]})
    with pytest.raises(ValueError, match=r"'png' cannot hold 'position'; these can: .*npz"):
        write("png", sim, range(1), tmp_path / "out")
    assert not (tmp_path / "out").exists()
    write("png,npz", sim, range(1), tmp_path / "out")
    assert (tmp_path / "out/npz/000000.npz").is_file()


@pytest.mark.parametrize("names", ["npz,bop", "png,npz,bop"])
def test_what_one_of_several_refuses_leaves_no_folder(small_scene, tmp_path, names):
    """BOP needs full silhouettes: without them nothing is begun."""
    sim = small(small_scene, **{"render.amodal": False})
    with pytest.raises(ValueError, match=r"render\.amodal"):
        write(names, sim, range(1), tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_the_folder_of_another_dataset_stops_all_of_several(small_scene, tmp_path):
    sim = small(small_scene)
    write("npz,png", sim, range(1), tmp_path)
    shutil.rmtree(tmp_path / "npz")
    before = tree_bytes(tmp_path)
    with pytest.raises(ValueError, match=r"png: holds a dataset of another .*fov_deg was"):
        write("npz,png", sim.with_overrides({"camera.fov_deg": 31.0}), range(1), tmp_path)
    assert tree_bytes(tmp_path) == before


def test_the_default_channels_are_no_error(small_scene, tmp_path):
    sim = perilune.open(small_scene, overrides={"camera.width": 24, "camera.height": 18})
    if "channels" in sim.config.render.model_fields_set:
        sim = sim.with_overrides({"render.channels": None})
    write("png", sim, range(1), tmp_path / "out")


def test_every_frame_tells_all_that_it_knows(canned, tmp_path):
    put(canned("npz"), "npz", tmp_path / "out")
    record = json.loads((tmp_path / "out/frames/000001.json").read_text())
    assert set(record["meta"]) >= {"time_utc", "jd_tdb", "sun", "states", "effects", "seed"}
    assert {"K", "R_w2c", "t_w2c", "lens"} <= set(record["camera"])
    (row,) = record["objects"]
    place = np.array(record["meta"]["states"][row["name"]]["position_m"])
    seen = np.array(record["camera"]["R_w2c"]) @ place + record["camera"]["t_w2c"]
    np.testing.assert_allclose(seen, row["t_m2c"], rtol=0, atol=1e-6)
    assert "timings_s" not in record["meta"]


def test_the_help_names_every_format(capsys):
    from perilune.cli import main

    with pytest.raises(SystemExit):
        main(["render", "--help"])
    told = "".join(capsys.readouterr().out.split())
    for row in WRITERS.values():
        assert "".join(f"{row.name}: {row.doc}".split()) in told


def test_the_page_has_a_row_for_every_format():
    page = (Path(__file__).parents[3] / "docs/formats.md").read_text()
    page = page.split("## In every dataset")[0]
    assert re.findall(r"^\| `([a-z0-9-]+)` \|", page, re.MULTILINE) == list(WRITERS)
