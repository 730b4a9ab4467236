"""Same SHA-256 of every array of frames 0..9, however and wherever they are computed.

The scene is the small one with drivers, a moving shutter, two objects that hide each other, one of
them with moving parts, and full silhouettes; and the repository's demo, which has textures and a
map, in small.
"""

from __future__ import annotations

import hashlib
import itertools
import multiprocessing
import pickle
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import yaml
from PIL import Image

import perilune
from perilune.document.loader import read_tree
from perilune.document.references import channel_names

FRAMES = range(10)
JITTER = {"ideal": 40.0, "jitter_variance": 9.0, "clip_min": 30.0, "clip_max": 50.0}


def crowd(root, maps):
    """The small scene as a tree with absolute paths: two satellites, one behind the other."""
    tree = read_tree(root / "tests/python/scene.yaml")
    sat = tree["spacecraft"]["sat"]
    sat["model"] = str(root / "assets/models/smallsat.glb")
    behind = {**sat, "model": str(root / "assets/models/tango_like.glb"), "size_m": 3.0}
    behind["orbit"] = {**sat["orbit"], "mean_anomaly_deg": 20.00003}
    tree["spacecraft"]["other"] = behind
    sat["keypoints"] = {"nodes": ["panel_left", "high_gain_antenna"]}
    sat["articulation"] = [
        {"node": "panel_left", "axis": [0, 1, 0], "normal": [1, 0, 0], "towards": "sun"},
        {"node": "panel_right_2", "axis": [0, 1, 0], "rate_deg_s": 3.0},
        {"node": "high_gain_antenna", "axis": [1, 0, 1], "angle_deg": JITTER},
    ]
    tree["bodies"]["earth"]["color_map"] = str(maps / "earth_like.png")
    tree["camera"] |= {"fov_deg": JITTER, "exposure_time_s": 0.01, "sensor": {}}
    tree["camera"]["line_time_us"] = 900.0
    tree["render"] |= {"samples": 3, "max_bounces": 2}
    return tree


def demo(root, maps):
    tree = read_tree(root / "configs/demo.yaml")
    tree["camera"] |= {"width": 40, "height": 30, "sensor": {"mosaic": "mono"}}  # several tiles
    tree["render"] |= {"samples": 4, "max_bounces": 2}
    for craft in tree["spacecraft"].values():
        craft["model"] = str((root / "configs" / craft["model"]).resolve())
    planet = tree["bodies"]["planet"]
    planet["annotate"] = True
    planet["landmarks"] = {
        f"{lon}": {"lon_deg": float(lon), "lat_deg": 20.0} for lon in range(0, 360, 30)
    }
    for section, key in ((planet, "color_map"), (planet["clouds"], "map")):
        section[key] = str(maps / Path(section[key]).with_suffix(".png").name)
    for material in tree["materials"].values():
        material["file"] = str((root / "configs" / material["file"]).resolve())
    return tree


SCENES = {"crowd": crowd, "demo": demo}


@pytest.fixture(scope="module")
def small_maps(request, tmp_path_factory):
    """The maps in small: every process and every simulation reads them anew."""
    folder = tmp_path_factory.mktemp("maps")
    for path in (request.config.rootpath / "assets/maps").glob("*.jpg"):
        with Image.open(path) as picture:
            picture.resize((512, 256)).save(folder / f"{path.stem}.png")
    return folder


@pytest.fixture(scope="module", params=list(SCENES))
def tree(request, small_maps):
    return SCENES[request.param](request.config.rootpath, small_maps)


@pytest.fixture(scope="module")
def sim(tree):
    return perilune.open(tree)


def hashes(sample):
    """SHA-256 of every array of a sample, labels and camera too, by name."""
    arrays = dict(sample.items())
    arrays |= {name: getattr(sample, name) for name in ("objects", "keypoints", "hierarchy")}
    arrays |= {name: getattr(sample.camera, name) for name in ("K", "R_w2c", "t_w2c")}
    result = {}
    for name, array in arrays.items():
        head = f"{array.dtype} {array.shape}".encode()
        result[name] = hashlib.sha256(head + np.ascontiguousarray(array).tobytes()).hexdigest()
    return result


def frame_hashes(simulation, index, threads=1):
    return hashes(simulation.frame(index, channels=channel_names(), threads=threads))


@pytest.fixture(scope="module")
def reference(sim):
    rows = [frame_hashes(sim, index) for index in FRAMES]
    assert len({row["rgb"] for row in rows}) == len(FRAMES)  # no two frames alike
    assert len(rows[0]) >= 15
    return rows


def same(found, reference):
    """As an assertion that names what differs."""
    assert len(found) == len(reference)
    for index, (a, b) in enumerate(zip(found, reference, strict=True)):
        assert set(a) == set(b)
        differing = [name for name in a if a[name] != b[name]]
        assert not differing, f"frame {index}: {differing}"


@pytest.mark.parametrize("threads", [2, 5])
def test_threads(sim, reference, threads):
    same([frame_hashes(sim, index, threads) for index in FRAMES], reference)


def test_order(sim, reference):
    """Back and forth, and some frames twice in a row."""
    shuffled = random.Random(7).sample(FRAMES, len(FRAMES))
    assert any(a > b for a, b in itertools.pairwise(shuffled))
    for index in [index for k, index in enumerate(shuffled) for _ in range(2 if k % 3 == 0 else 1)]:
        same([frame_hashes(sim, index, 1)], [reference[index]])


def test_frames_by_simulations_of_their_own(tree, reference):
    found = [frame_hashes(perilune.open(tree), index, 2) for index in FRAMES[::3]]
    same(found, reference[::3])


def test_pickled(sim, reference):
    copy = pickle.loads(pickle.dumps(sim))
    same([frame_hashes(copy, index, 2) for index in FRAMES], reference)


def work(simulation, indices, threads, queue):
    queue.put({index: frame_hashes(simulation, index, threads) for index in indices})


@pytest.mark.parametrize("method", ["fork", "spawn", "forkserver"])
@pytest.mark.filterwarnings("ignore:.*multi-threaded.*fork:DeprecationWarning")
def test_worker_processes(sim, reference, method):
    """Three workers, each with every third frame and another number of threads; the parent has
    rendered before it forks, and renders after."""
    frame_hashes(sim, 0, 2)
    context = multiprocessing.get_context(method)
    queue = context.Queue()
    shares = [(sim, FRAMES[k::3], k + 1, queue) for k in range(3)]
    workers = [context.Process(target=work, args=share) for share in shares]
    for worker in workers:
        worker.start()
    found = {}
    for _ in workers:
        found |= queue.get(timeout=120)
    for worker in workers:
        worker.join(timeout=30)
        assert worker.exitcode == 0
    same([found[index] for index in FRAMES], reference)
    same([frame_hashes(sim, index, 2) for index in (7, 2)], [reference[7], reference[2]])


def test_dataset(sim, reference):
    data = perilune.Dataset(sim, len(FRAMES), channels=channel_names(), transform=hashes, threads=2)
    same([data[index] for index in FRAMES], reference)
    late = perilune.Dataset(sim, 4, start=6, channels=channel_names(), transform=hashes, threads=1)
    same([late[index] for index in range(4)], reference[6:])


@pytest.mark.parametrize("shards", [1, 3])
def test_stream_shards(sim, reference, shards):
    found = {}
    for part in range(shards):
        stream = perilune.Stream(
            sim, shard=(part, shards), channels=channel_names(), transform=hashes, threads=2
        )
        mine = FRAMES[part::shards]
        found |= dict(zip(mine, stream, strict=False))
    same([found[index] for index in FRAMES], reference)


def test_resumed_stream(tree, reference):
    """Stopped after one frame, after four and after all, each time continued from its state by a
    new stream."""
    state, found = None, []
    for count in (1, 3, 6):
        stream = perilune.Stream(
            perilune.open(tree), channels=channel_names(), transform=hashes, threads=2
        )
        if state is not None:
            stream.load_state_dict(state)
        frames = iter(stream)
        found += [next(frames) for _ in range(count)]
        state = pickle.loads(pickle.dumps(stream.state_dict()))
    same(found, reference)


# --- written files ------------------------------------------------------------------------------


def file_hashes(folder):
    return {
        path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def words(config, out, *more, frames="0:10"):
    return [
        sys.executable, "-m", "perilune", "render", str(config), "--frames", frames, "--out",
        str(out), "--chunk-size", "4", *map(str, more),
    ]  # fmt: skip


def run(*arguments):
    done = subprocess.run(arguments, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    return done


@pytest.fixture(scope="module")
def config(request, small_maps, tmp_path_factory):
    """The small scene: what a frame shows does not matter to files, and it is quick to open."""
    path = tmp_path_factory.mktemp("config") / "scene.yaml"
    path.write_text(yaml.safe_dump(crowd(request.config.rootpath, small_maps)))
    return path


@pytest.fixture(scope="module")
def written(config, tmp_path_factory):
    out = tmp_path_factory.mktemp("whole") / "set"
    run(*words(config, out, "--threads", 1))
    result = file_hashes(out)
    assert sum(name.endswith(".png") for name in result) >= 3 * len(FRAMES)
    return result


def test_written_by_more_threads(config, written, tmp_path):
    run(*words(config, tmp_path / "set", "--threads", 5))
    assert file_hashes(tmp_path / "set") == written


def test_written_in_shards(config, written, tmp_path):
    out = tmp_path / "set"
    for part in (2, 0, 1):
        run(*words(config, out, "--threads", part + 1, "--shard", f"{part}/3"))
    run(sys.executable, "-m", "perilune", "merge", str(out))
    assert file_hashes(out) == written


@pytest.mark.parametrize(
    "stop", [signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.soak), signal.SIGKILL]
)
def test_written_after_an_end_in_the_middle(config, written, tmp_path, stop):
    out = tmp_path / "set"
    process = subprocess.Popen(
        words(config, out, "--threads", 2), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline and process.poll() is None:
        if len(list(out.rglob("rgb/*.png"))) >= 3:
            break
        time.sleep(0.001)
    process.send_signal(stop)
    process.wait(timeout=60)
    run(*words(config, out, "--threads", 1))
    assert file_hashes(out) == written
