"""What users get wrong: every fault is one clear error or a defined result, nothing half written.

Faults of glTF files one by one are in tests/c/test_gltf*.c, of images in test_image_file.c, of keys
in tests/python/test_config.py, numbers in test_bad_numbers.py; here they come through the whole
program.
"""

from __future__ import annotations

import json
import math
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from tests.hard.glb import cube, write_glb
from tests.python.command_line import command

import perilune
from perilune import _core
from perilune.document.loader import read_tree

LABELS = ["depth", "range", "normal", "semantic", "part", "instance", "rgb", "objects"]


@pytest.fixture
def tree(repo_dir):
    return read_tree(repo_dir / "tests/python/scene.yaml")


@pytest.fixture
def base(repo_dir):
    return repo_dir / "tests/python"


def write_scene(tree, base, folder, **changes):
    """The small scene as a JSON file in `folder`, with absolute paths."""
    tree["spacecraft"]["sat"]["model"] = str((base / tree["spacecraft"]["sat"]["model"]).resolve())
    for key, value in changes.items():
        node = tree
        *path, last = key.split("__")
        for part in path:
            node = node.setdefault(part, {})
        node[last] = str(value) if isinstance(value, Path) else value
    path = folder / "scene.json"
    path.write_text(json.dumps(tree))
    return path


def process(*words, **options):
    return subprocess.run(
        [sys.executable, "-m", "perilune", *map(str, words)],
        capture_output=True, text=True, timeout=120, check=False, **options,
    )  # fmt: skip


def refused(result, *texts):
    """One message on stderr, code 1, no traceback; holds every text."""
    assert result.returncode == 1, (result.returncode, result.stderr)
    assert "Traceback" not in result.stderr
    for text in texts:
        assert str(text) in result.stderr, result.stderr
    return result


def render(scene, out, *more, run=command, **options):
    words = ("render", scene, "--frames", "0:3", "--out", out, "--threads", 1, *more)
    return run(*words, **options)


# --- files --------------------------------------------------------------------------------------


def bad_models(folder, repo_dir):
    good = (repo_dir / "assets/models/smallsat.glb").read_bytes()
    corners, faces = cube(0.5)
    flat = np.repeat(faces[:, :1], 3, axis=1)
    return {
        "missing": (folder / "nothing.glb", "no such file"),
        "text": (write(folder / "text.glb", b"hello"), "broken JSON"),
        "empty file": (write(folder / "empty.glb", b""), ""),
        "half": (write(folder / "half.glb", good[: len(good) // 2]), "truncated"),
        "folder": (folder, "no such file"),
        "only zero-area triangles": (
            write_glb(folder / "flat.glb", corners, flat), "no triangle to render"
        ),
        "an index too large": (
            write_glb(folder / "index.glb", corners, faces + 3), "but there are 8 vertices"
        ),
        "a mesh of one point": (
            write_glb(folder / "point.glb", corners * 0, faces), "no triangle to render"
        ),
    }  # fmt: skip


def write(path, content):
    path.write_bytes(content)
    return path


MODELS = ("missing", "text", "empty file", "half", "folder", "only zero-area triangles",
          "an index too large", "a mesh of one point")  # fmt: skip


@pytest.mark.parametrize("fault", MODELS)
def test_models(tree, base, tmp_path, repo_dir, fault):
    path, text = bad_models(tmp_path, repo_dir)[fault]
    scene = write_scene(tree, base, tmp_path, spacecraft__sat__model=path)
    out = tmp_path / "set"
    refused(render(scene, out), path, text)
    assert not list(out.rglob("*.png"))
    assert not list(out.rglob("scene_gt.json"))


MAPS = ("missing", "text", "empty file", "half")


@pytest.mark.parametrize("fault", MAPS)
def test_maps(tree, base, tmp_path, repo_dir, fault):
    good = (repo_dir / "assets/maps/earth_like.jpg").read_bytes()
    path, text = {
        "missing": (tmp_path / "nothing.png", "no such file"),
        "text": (write(tmp_path / "text.png", b"hello"), "not a PNG, JPEG or WebP image"),
        "empty file": (write(tmp_path / "empty.jpg", b""), "empty"),
        "half": (write(tmp_path / "half.jpg", good[: len(good) // 2]), "JPEG"),
    }[fault]
    scene = write_scene(tree, base, tmp_path, bodies__earth__color_map=path)
    out = tmp_path / "set"
    refused(render(scene, out), path, text)
    assert not list(out.rglob("*.png"))


def test_zero_area_triangles_among_others_are_left_out_with_a_warning(tmp_path):
    corners, faces = cube(0.5)
    more = np.array([[0, 0, 7], [3, 3, 3]], np.uint32)
    model = _core.Model(str(write_glb(tmp_path / "a.glb", corners, np.concatenate([faces, more]))))
    assert model.triangle_count == 12
    assert model.warnings == ("2 zero-area triangles are left out",)


# --- cameras ------------------------------------------------------------------------------------


def pose(position, q=(1.0, 0.0, 0.0, 0.0)):
    return np.array([*position, *q], dtype=np.float64)


def test_camera_inside_a_body(tree, base):
    radius = _core.BODIES["earth"]["radii_m"][0]
    for place in (0.0, 0.5 * radius, radius * (1 - 1e-6)):
        sim = perilune.open(tree, base=base, trajectory=lambda _, x=place: pose((x, 0.0, 0.0)))
        with pytest.raises(ValueError, match="inside earth"):
            _ = sim[0]
    _ = perilune.open(tree, base=base, trajectory=lambda _: pose((radius + 1.0, 0.0, 0.0)))[0]


def test_camera_inside_a_body_of_the_core(tree, base):
    """The core itself refuses too, naming the body."""
    sim = perilune.open(tree, base=base)
    request = sim.request(0)
    request["camera_pose"] = np.stack([pose((1e6, 0.0, 0.0))] * 2)
    with pytest.raises(ValueError, match="inside body 'earth'"):
        sim._mine().renderer.render(request, {"depth": np.empty((32, 48), np.float32)})


@pytest.mark.parametrize("double_sided", [True, False])
def test_camera_inside_a_mesh(tree, base, tmp_path, double_sided):
    """Defined: from inside, double-sided walls are seen at their true distance, and single-sided
    ones are not there, as from behind everywhere else."""
    path = write_glb(tmp_path / "cube.glb", *cube(0.5))
    if not double_sided:
        path.write_bytes(path.read_bytes().replace(b'"doubleSided": true', b'"doubleSided":false'))
    tree["spacecraft"]["sat"] |= {"model": str(path), "size_m": 2.0, "faces": "as_stated"}
    sim = perilune.open(tree, base=base, trajectory=lambda w: pose(w.poses["sat"].mean(axis=0)[:3]))
    sample = sim.frame(0, channels=LABELS)
    inside = sample["instance"] == sim.taxonomy.instances["sat"]
    if double_sided:
        assert inside.all()
        far = np.sqrt(3.0)
        assert (sample["range"] >= 1.0 - 1e-6).all()
        assert (sample["range"] <= far + 1e-6).all()
    else:
        assert not inside.any()
    assert np.isfinite(sample["normal"]).all()
    assert np.isfinite(sample.objects["t_m2c"]).all()


@pytest.mark.parametrize(
    "answer",
    [
        np.full(7, math.nan), np.zeros(7), np.zeros(3), "x", None, [1, 2, 3, 4, 5, 6, math.inf],
        [1e300, 0, 0, 1, 0, 0, 0], {"pose": 1},
    ],
)  # fmt: skip
def test_hooks_that_answer_nonsense(tree, base, answer):
    def camera(world):
        return answer

    with pytest.raises((ValueError, TypeError), match="camera"):
        _ = perilune.open(tree, base=base, trajectory=camera)[0]


# --- objects that are never seen ----------------------------------------------------------------


def test_object_that_is_never_seen(tree, base, tmp_path):
    """Its labels are defined, and the dataset is written and valid."""
    tree["spacecraft"]["far"] = json.loads(json.dumps(tree["spacecraft"]["sat"]))
    tree["spacecraft"]["far"]["orbit"]["mean_anomaly_deg"] = 200.0  # behind the Earth
    sim = perilune.open(tree, base=base)
    for index in range(3):
        (_, row) = sim.frame(index, channels=LABELS).objects
        assert row["px_count_visib"] == 0
        assert row["visib_fract"] == 0.0
        assert (row["bbox_visib"] == -1).all()
        assert np.isfinite(row["R_m2c"]).all()
        assert np.isfinite(row["t_m2c"]).all()
    scene, out = write_scene(tree, base, tmp_path), tmp_path / "set"
    tree["spacecraft"]["far"]["model"] = tree["spacecraft"]["sat"]["model"]
    scene.write_text(json.dumps(tree))
    result = render(scene, out)
    assert result.returncode == 0, result.stderr
    assert command("check", out).returncode == 0


# --- output folders -----------------------------------------------------------------------------


def files(folder):
    return sorted(p for p in folder.rglob("*") if p.is_file())


def whole(folder):
    """Every file can be read to its end and none is a temporary one."""
    for path in files(folder):
        assert ".tmp" not in path.name
        if path.suffix == ".png":
            Image.open(path).load()
        elif path.suffix == ".json":
            json.loads(path.read_text())


def test_output_that_cannot_be_a_folder(tree, base, tmp_path):
    scene = write_scene(tree, base, tmp_path)
    a_file = write(tmp_path / "file", b"mine")
    refused(render(scene, a_file), a_file)
    refused(render(scene, a_file / "below"), a_file)
    refused(command("preview", scene, "--out", tmp_path / "no" / "sheet.png"), tmp_path / "no")
    assert a_file.read_bytes() == b"mine"


@pytest.mark.skipif(not Path("/proc/self").is_dir(), reason="needs a file system nobody may write")
def test_output_that_is_not_writable(tree, base, tmp_path):
    scene = write_scene(tree, base, tmp_path)
    refused(render(scene, "/proc/perilune_out"), "/proc/perilune_out")
    if os.geteuid() != 0:
        locked = tmp_path / "locked"
        locked.mkdir(mode=0o500)
        refused(render(scene, locked / "set"), locked)
        assert not files(locked)


@pytest.mark.parametrize("limit", [200, 3000, pytest.param(20000, marks=pytest.mark.soak), 200000])
def test_full_disk(tree, base, tmp_path, limit):
    """A limit on the size of files stands for it: writes fail in a model, an image or a table. What
    is there is whole, and the same command finishes the set when there is room again."""
    scene = write_scene(tree, base, tmp_path, camera__width=200, camera__height=150)
    out, fresh = tmp_path / "set", tmp_path / "fresh"

    def limited():
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    # Python would write its compiled modules cut short, and later processes would read them.
    environment = os.environ | {"PYTHONDONTWRITEBYTECODE": "1"}
    result = render(scene, out, run=process, preexec_fn=limited, env=environment)
    refused(result, out)
    whole(out)
    assert not list(out.rglob("scene_gt.json"))
    assert render(scene, out).returncode == 0
    whole(out)
    assert render(scene, fresh).returncode == 0
    assert same_files(out, fresh)


def same_files(a, b):
    """The same names with the same content, but for times and paths that a card may hold."""
    names = [p.relative_to(a) for p in files(a)]
    assert names == [p.relative_to(b) for p in files(b)]
    for name in names:
        if name.suffix in (".png", ".ply") or name.name.startswith("scene_"):
            assert (a / name).read_bytes() == (b / name).read_bytes(), name
    return True


@pytest.mark.parametrize("delay_s", [0.0, pytest.param(0.2, marks=pytest.mark.soak), 0.5])
def test_ctrl_c(tree, base, tmp_path, delay_s):
    """At any time: code 130, one message, whole files; the same command goes on."""
    scene, out = write_scene(tree, base, tmp_path), tmp_path / "set"
    words = ["render", str(scene), "--frames", "0:100000", "--out", str(out), "--threads", "2"]
    running = subprocess.Popen(
        [sys.executable, "-m", "perilune", *words], stdout=subprocess.PIPE,
        stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    try:
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline and not list(out.rglob("*.png")):
            assert running.poll() is None, running.communicate()
            time.sleep(0.005)
        time.sleep(delay_s)
        running.send_signal(signal.SIGINT)
        _, err = running.communicate(timeout=60)
    finally:
        running.kill()
    assert running.returncode == 130, err
    assert "Traceback" not in err
    assert "interrupted" in err
    whole(out)
    assert render(scene, out).returncode == 0
    whole(out)
    report = json.loads(command("check", out, "--json").stdout)
    assert report["findings"] == []
    # What was written before and after the stop are the frames that an undisturbed run writes.
    count = len(list(out.rglob("rgb/*.png")))
    fresh = tmp_path / "fresh"
    assert render(scene, fresh, "--frames", f"0:{count}").returncode == 0
    assert same_files(out, fresh)
