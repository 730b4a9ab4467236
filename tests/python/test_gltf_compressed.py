"""Draco and meshopt streams made by other encoders, of shapes that hypothesis chooses, whole and
spoiled. Real files are in test_gltf_corpus.py, single faults in tests/c/test_gltf_*.c."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import DracoPy
import meshoptimizer
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray
from tests.fuzz.make_corpus import Buffer, as_glb
from tests.python.gltf_reference import meshopt_filter

from perilune._core import Model

SEEDS = st.integers(0, 2**32 - 1)
FLOAT, SHORT = 5126, 5122


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("compressed") / "model.glb"


def file(b: Buffer, attributes: dict[str, int], indices: int, **primitive: Any) -> bytes:
    mesh = {"attributes": attributes, "indices": indices, **primitive}
    return as_glb(b, b.document(meshes=[{"primitives": [mesh]}], nodes=[{"mesh": 0}]))


def corners(path: Path) -> NDArray[np.float64]:
    """(T, 3, 3) in the axes of the file."""
    mesh = Model(str(path)).mesh()
    return mesh["positions"][mesh["indices"]].astype(float)[..., [0, 2, 1]] * [1, 1, -1]


BITS = 10


def random_mesh(rng: np.random.Generator) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
    """Points on the grid of the quantisation, and triangles of three different ones."""
    points = np.unique(rng.integers(0, 2**BITS, (rng.integers(3, 60), 3)), axis=0)
    faces = [rng.permutation(len(points))[:3] for _ in range(rng.integers(1, 90))]
    used, faces_of_used = np.unique(faces, return_inverse=True)
    return points[used].astype(np.float32), faces_of_used.reshape(-1, 3)


def draco_file(points: NDArray[Any], faces: NDArray[Any], level: int) -> bytes:
    data = DracoPy.encode(
        points,
        faces,
        quantization_bits=BITS,
        quantization_range=2**BITS - 1,
        quantization_origin=[0, 0, 0],
        compression_level=level,
    )
    decoded = DracoPy.decode(data)
    b = Buffer()
    view = b.view(data)
    ids = {"POSITION": decoded.attributes[0]["unique_id"]}
    attributes = {"POSITION": b.accessor("VEC3", FLOAT, len(decoded.points))}
    indices = b.accessor("SCALAR", 5125, faces.size)
    extension = {"KHR_draco_mesh_compression": {"bufferView": view, "attributes": ids}}
    return file(b, attributes, indices, extensions=extension)


def in_some_order(triangles: NDArray[np.float64]) -> list[list[tuple[float, ...]]]:
    """Sorted: codecs turn triangles and reorder them."""
    return sorted(sorted(map(tuple, t)) for t in triangles.tolist())


@settings(max_examples=100)
@given(seed=SEEDS, level=st.integers(0, 10))
def test_draco_meshes(path: Path, seed: int, level: int) -> None:
    points, faces = random_mesh(np.random.default_rng(seed))
    path.write_bytes(draco_file(points, faces, level))
    a, b, c = np.moveaxis(points[faces].astype(float), 1, 0)
    kept = faces[np.linalg.norm(np.cross(b - a, c - a), axis=1) > 0]
    found = np.rint(corners(path) * 64) / 64  # what dequantisation rounds
    assert in_some_order(found) == in_some_order(points[kept].astype(float))


MODES = {
    "EXPONENTIAL": (12, FLOAT, False),
    "QUATERNION": (8, SHORT, True),
    "OCTAHEDRAL": (8, SHORT, True),
    "NONE": (12, FLOAT, False),
}


def raw_rows(rng: np.random.Generator, count: int, name: str) -> NDArray[np.uint8]:
    """What encoders of a filter store, (count, stride) bytes."""
    if name == "EXPONENTIAL":
        mantissa = rng.integers(-(2**23), 2**23, (count, 3))
        words = (rng.integers(-30, 10, (count, 3)) & 0xFF) << 24 | mantissa & 0xFFFFFF
        return words.astype(np.uint32).view(np.uint8)
    if name == "NONE":
        return rng.normal(size=(count, 3)).astype(np.float32).view(np.uint8)
    bits = int(rng.integers(6, 17))
    one = 2 ** (bits - 1) - 1
    if name == "QUATERNION":
        rows = rng.integers(-one, one + 1, (count, 4))
        rows[:, 3] = one & ~3 | rng.integers(0, 4, count)
    else:
        x = rng.integers(-one, one + 1, count)
        rows = np.stack([x, rng.integers(-one, one + 1, count), np.full(count, one), x], axis=1)
    return rows.astype(np.int16).view(np.uint8)


@settings(max_examples=100)
@given(
    seed=SEEDS,
    name=st.sampled_from(sorted(MODES)),
    mode=st.sampled_from(["TRIANGLES", "INDICES"]),
    size=st.sampled_from([2, 4]),
)
def test_meshopt_views(path: Path, seed: int, name: str, mode: str, size: int) -> None:
    rng = np.random.default_rng(seed)
    stride, component, normalised = MODES[name]
    count = int(rng.integers(3, 600))
    raw = raw_rows(rng, count, name)
    faces = np.array([rng.permutation(count)[:3] for _ in range(rng.integers(1, 200))])
    meshoptimizer.encode_vertex_version(0)
    meshoptimizer.encode_index_version(1)
    encode = (
        meshoptimizer.encode_index_buffer
        if mode == "TRIANGLES"
        else meshoptimizer.encode_index_sequence
    )
    streams = [
        (meshoptimizer.encode_vertex_buffer(raw), count, stride, "ATTRIBUTES", name),
        (encode(faces.reshape(-1), faces.size, count), faces.size, size, mode, "NONE"),
    ]
    b = Buffer()
    for data, n, width, kind, filtering in streams:
        view = b.view(data)
        extension = {**b.views[view], "byteStride": width, "count": n, "mode": kind}
        extension["filter"] = filtering
        b.views[view] |= {"byteLength": n * width, "byteOffset": 0}
        b.views[view]["extensions"] = {"EXT_meshopt_compression": extension}
    b.views[0]["byteStride"] = stride
    positions = b.accessor("VEC3", component, count, bufferView=0, normalized=normalised)
    indices = b.accessor("SCALAR", 5123 if size == 2 else 5125, faces.size, bufferView=1)
    path.write_bytes(file(b, {"POSITION": positions}, indices))
    decoded = meshopt_filter(raw, name)
    values = decoded.view("<f4" if component == FLOAT else "<i2")[:, :3].astype(float)
    values = np.maximum(values / 32767, -1) if normalised else values
    expected = values[faces]
    same = (expected == np.roll(expected, 1, axis=1)).all(axis=2).any(axis=1)
    expected = expected[~same]  # the reader leaves triangles without an area out
    found = corners(path)
    if mode == "TRIANGLES":  # may be turned, none is reordered
        first = np.argmin(np.linalg.norm(found - expected[:, :1], axis=2), axis=1)
        turn = (np.arange(3) + first[:, None]) % 3
        found = np.take_along_axis(found, turn[..., None], axis=1)
    np.testing.assert_allclose(found, expected, rtol=1e-6, atol=3.2e-5 if normalised else 0)


@settings(max_examples=150)
@given(seed=SEEDS, level=st.integers(0, 10), flips=st.integers(1, 6), cut=st.booleans())
def test_spoiled_draco_streams(path: Path, seed: int, level: int, flips: int, cut: bool) -> None:
    """An error that names the file, or a sound mesh; never a crash."""
    rng = np.random.default_rng(seed)
    data = bytearray(draco_file(*random_mesh(rng), level))
    start = 28 + struct.unpack_from("<I", data, 12)[0]
    for _ in range(flips):
        data[rng.integers(start, len(data))] = rng.integers(0, 256)
    if cut:
        end = int(rng.integers(start, len(data)))
        data[end:] = bytes(len(data) - end)
    path.write_bytes(data)
    try:
        model = Model(str(path))
    except ValueError as error:
        text = str(error)
    else:
        text = str(path)
        mesh = model.mesh()
        assert mesh["indices"].max() < model.vertex_count
        assert np.isfinite(mesh["positions"]).all()
    assert str(path) in text
