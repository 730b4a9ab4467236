"""Models that simulations of a process share: one read, until the file changes; never of several
files."""

from __future__ import annotations

import json
import os
import shutil
import struct
import tracemalloc
from pathlib import Path

import pytest

import perilune
from perilune.config.faces import DEFAULT
from perilune.spacecraft import model_files
from perilune.spacecraft.model_files import shared_model

SMALL = {"camera.width": 16, "camera.height": 12}
PLAIN = (3.14, (1.0, 1.0, 1.0), DEFAULT)


@pytest.fixture
def model(request, tmp_path) -> Path:
    path = tmp_path / "sat.glb"
    shutil.copyfile(request.config.rootpath / "assets/models/smallsat.glb", path)
    return path


def test_a_model_is_read_once_until_it_changes(model):
    first = shared_model(str(model), *PLAIN)
    assert shared_model(str(model), *PLAIN) is first
    assert shared_model(str(model), 1.0, *PLAIN[1:]) is not first
    state = model.stat()
    os.utime(model, ns=(state.st_atime_ns, state.st_mtime_ns + 1))
    assert shared_model(str(model), *PLAIN) is not first
    model.unlink()
    with pytest.raises(OSError, match=r"sat\.glb"):
        shared_model(str(model), *PLAIN)


def with_text(path: Path, change) -> None:
    """Rewrites the JSON of a binary glTF."""
    data = path.read_bytes()
    length = struct.unpack("<I", data[12:16])[0]
    text = json.dumps(change(json.loads(data[20 : 20 + length]))).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + length :]
    size = struct.pack("<I", 20 + len(text) + len(rest))
    path.write_bytes(data[:8] + size + struct.pack("<I", len(text)) + b"JSON" + text + rest)


def test_a_model_that_names_other_files_is_read_each_time(model):
    """They may change while it does not."""
    with_text(model, lambda tree: tree | {"extras": {"uri": "beside.png"}})
    first = shared_model(str(model), *PLAIN)
    assert shared_model(str(model), *PLAIN) is not first


def test_a_header_that_lies_takes_no_memory(tmp_path):
    path = tmp_path / "sat.glb"
    path.write_bytes(b"glTF" + struct.pack("<III", 2, 28, 0xFFFFFFFF) + b"JSON{}      ")
    tracemalloc.start()
    try:
        with pytest.raises(ValueError, match=r"sat\.glb"):
            shared_model(str(path), *PLAIN)
        assert tracemalloc.get_traced_memory()[1] < 1e6
    finally:
        tracemalloc.stop()


def test_memory_is_what_meshes_and_textures_take(model):
    made = shared_model(str(model), *PLAIN)
    mesh = made.mesh()
    least = sum(mesh[name].nbytes for name in ("normals", "indices", "triangle_part"))
    assert least < made.nbytes < 100e6


def test_simulations_share_models(request, model, monkeypatch):
    reads = []
    real = model_files.read_model

    def read(*given):
        reads.append(given[0])
        return real(*given)

    monkeypatch.setattr(model_files, "read_model", read)
    scene = request.config.rootpath / "tests/python/scene.yaml"
    change = SMALL | {"spacecraft.sat.model": str(model)}
    frames = [
        perilune.open(scene, overrides=change | {"seed": seed}).frame(0, ["instance"])["instance"]
        for seed in (1, 1)
    ]
    assert reads == [str(model)]
    assert frames[0].any()
    assert (frames[0] == frames[1]).all()
