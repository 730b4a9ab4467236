"""Memory over many frames: the process does not grow, and the core allocates nothing anew."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest
from tests.python import shape_scenes

import perilune
from perilune import _core

ALL = [channel["name"] for channel in _core.CHANNELS] + ["objects"]

GROWTH = """
import gc, json, os, sys
import perilune
from perilune import _core
from tests.python import shape_scenes

names = [channel["name"] for channel in _core.CHANNELS] + ["objects"]
small = {"camera.width": 24, "camera.height": 16}
sim = perilune.open(sys.argv[1], overrides={"camera.sensor": {}, **small})
sizes = {}
page = os.sysconf("SC_PAGESIZE")
for index in range(1000):
    sample = sim.frame(index, channels=names, threads=2)
    if index + 1 in (100, 250, 500, 750, 1000):
        gc.collect()
        with open("/proc/self/statm") as file:
            sizes[index + 1] = int(file.read().split()[1]) * page
print(json.dumps(sizes))
"""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
@pytest.mark.slow
def test_resident_size_stays(repo_dir):
    """After 1 000 small frames within 1 % of that after 100; in a process of its own."""
    scene = str(repo_dir / "tests/python/scene.yaml")
    result = subprocess.run(
        [sys.executable, "-c", GROWTH, scene], capture_output=True, text=True, timeout=600,
        check=False,
    )  # fmt: skip
    assert result.returncode == 0, result.stderr
    sizes = json.loads(result.stdout)
    assert abs(sizes["1000"] / sizes["100"] - 1.0) < 0.01, sizes


CHANGES = """
import gc, json, os, sys
import perilune
from perilune.frame import handles
from perilune.spacecraft import model_files

handles._FILES = 2
model_files.MODELS.most_bytes = 0
page = os.sysconf("SC_PAGESIZE")
base = perilune.open(sys.argv[1], overrides={"camera.width": 16, "camera.height": 12})
sizes = {}
for count in range(1, 20):
    shape = {"file": sys.argv[2], "metres_per_unit": 6e6 + count}
    change = {"spacecraft.sat.crease_angle_deg": 20.0 + count, "bodies.earth.shape": shape}
    base.with_overrides(change).frame(count, channels=["instance"], threads=1)
    if count in (10, 19):
        gc.collect()
        with open("/proc/self/statm") as file:
            sizes[count] = int(file.read().split()[1]) * page
print(json.dumps(sizes))
"""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
@pytest.mark.slow
def test_models_and_shapes_that_changed_are_freed(repo_dir, tmp_path):
    """Frames of simulations with ever other models and shapes, which share their assets: meshes and
    accelerators of earlier ones are given back. Kept, nine of both are 30 MB."""
    scene = str(repo_dir / "tests/python/scene.yaml")
    mesh = str(shape_scenes.write_obj(tmp_path / "ball.obj", *shape_scenes.ball(60)))
    result = subprocess.run(
        [sys.executable, "-c", CHANGES, scene, mesh], capture_output=True, text=True, timeout=600,
        check=False,
    )  # fmt: skip
    assert result.returncode == 0, result.stderr
    sizes = json.loads(result.stdout)
    assert sizes["19"] - sizes["10"] < 8e6, sizes


def requests(repo_dir, scene, frames):
    """The core's renderer, what it is asked in each frame, and arrays for all it can fill."""
    small = {"camera.width": 80, "camera.height": 60, "render.samples": 2}
    sim = perilune.open(repo_dir / scene, overrides=small | {"camera.sensor": {}})
    first = sim.frame(0, channels=ALL, threads=1)
    out = {**first, "objects": first.objects}
    return sim._mine().renderer, [sim.request(index) for index in frames], out


@pytest.mark.parametrize("threads", [1, 2, 3])
@pytest.mark.parametrize("scene", ["tests/python/scene.yaml", "configs/demo.yaml"])
def test_frames_into_given_arrays_allocate_nothing(repo_dir, scene, threads):
    """From the second frame on; the demo has textures and a map."""
    before = _core.allocations()
    renderer, asked, out = requests(repo_dir, scene, (0, 1, 2, 3, 7))
    assert _core.allocations() > before  # the counter counts
    renderer.render(asked[0], out, threads)
    before = _core.allocations()
    renderer.render(asked[0], out, threads)
    assert _core.allocations() == before
    # Others may need what the first did not (the silhouette of an object that is cut), once.
    for request in asked:
        renderer.render(request, out, threads)
    before = _core.allocations()
    for request in (*asked, *reversed(asked)):
        renderer.render(request, out, threads)
        assert _core.allocations() == before, f"frame {request['index']}"


def test_fewer_or_more_threads_allocate_once(repo_dir):
    """A change of the number of threads may allocate; a second frame with it does not."""
    renderer, asked, out = requests(repo_dir, "tests/python/scene.yaml", (0, 1))
    for threads in (3, 1, 2):
        for request in asked:
            renderer.render(request, out, threads)
        before = _core.allocations()
        renderer.render(asked[1], out, threads)
        assert _core.allocations() == before


def test_frames_of_the_python_layer_allocate_nothing(repo_dir):
    """Through Simulation.frame, the tree of orbits included, from the second time on."""
    sim = perilune.open(repo_dir / "tests/python/scene.yaml", overrides={"camera.sensor": {}})
    first = sim.frame(0, channels=ALL, threads=2)
    out = {**first, "objects": first.objects}
    counts = []
    for index in (*range(1, 6), *range(1, 6)):
        before = _core.allocations()
        sim.frame(index, channels=ALL, threads=2, out=out)
        counts.append(_core.allocations() - before)
    assert counts[5:] == [0] * 5
