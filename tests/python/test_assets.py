"""The committed assets are what their scripts make, and sound: closed, outward, unit normals."""

from __future__ import annotations

import importlib
import json
import struct
import sys
from pathlib import Path

import numpy as np
import pytest

ASSETS = Path(__file__).resolve().parents[2] / "assets"
MODELS = ("smallsat", "tango_like", "station")
TRIANGLES = {"smallsat": (5_000, 21_000), "tango_like": (2_000, 8_000), "station": (8e4, 1.3e5)}
SIZE_M = {  # longest side: what the scripts' docstrings and assets/README.md promise
    "smallsat": (8.0, 8.4),
    "tango_like": (1.06, 1.10),
    "station": (36.0, 40.0),
}
NAMES = {
    "smallsat": {"bus", "panel_left", "panel_right", "high_gain_antenna", "main_thruster"},
    "tango_like": {"body", "solar_lid", "antenna_1", "antenna_2", "antenna_3"},
    "station": {"ppe", "halo", "ihab", "airlock", "logistics", "robotic_arm", "truss", "cupola"},
}
MATERIALS = {
    "smallsat": {"mli_gold", "solar_cell", "white_paint", "aluminium", "nozzle"},
    "tango_like": {"mli_silver", "solar_cell", "aluminium"},
    "station": {"mli_gold", "solar_cell", "white_paint", "radiator", "beta_cloth"},
}
DTYPES = {5123: np.dtype("<u2"), 5125: np.dtype("<u4"), 5126: np.dtype("<f4")}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}


@pytest.fixture(scope="module")
def scripts():
    """Imports modules of assets/scripts, which is not a package."""
    sys.path.insert(0, str(ASSETS / "scripts"))
    yield importlib.import_module
    sys.path.remove(str(ASSETS / "scripts"))


def parse(data: bytes) -> tuple[dict, bytes]:
    magic, version, total = struct.unpack_from("<4sII", data)
    assert (magic, version, total) == (b"glTF", 2, len(data))
    length, tag = struct.unpack_from("<I4s", data, 12)
    assert tag == b"JSON"
    binary_length, tag = struct.unpack_from("<I4s", data, 20 + length)
    assert tag == b"BIN\0"
    binary = data[28 + length :]
    assert len(binary) == binary_length
    return json.loads(data[20 : 20 + length]), binary


def committed(name: str) -> tuple[dict, bytes]:
    return parse((ASSETS / "models" / f"{name}.glb").read_bytes())


def accessor(content: dict, binary: bytes, index: int) -> np.ndarray:
    entry = content["accessors"][index]
    view = content["bufferViews"][entry["bufferView"]]
    width = WIDTHS[entry["type"]]
    kind = DTYPES[entry["componentType"]]
    assert view["byteLength"] == entry["count"] * width * kind.itemsize
    flat = np.frombuffer(binary, kind, entry["count"] * width, view["byteOffset"])
    return flat.reshape(-1, width)


def primitives(content: dict, binary: bytes, mesh: dict):
    """(positions, normals, triangles) of each primitive, in double."""
    for primitive in mesh["primitives"]:
        names = primitive["attributes"]
        position, normal = (
            accessor(content, binary, names[key]).astype(float) for key in ("POSITION", "NORMAL")
        )
        yield (
            position,
            normal,
            accessor(content, binary, primitive["indices"]).reshape(-1, 3).astype(int),
        )


def placed(content: dict):
    """(node, 4x4 to the scene) of every node."""

    def walk(index: int, above: np.ndarray):
        node = content["nodes"][index]
        x, y, z, w = node.get("rotation", (0.0, 0.0, 0.0, 1.0))
        local = np.eye(4)
        local[:3, :3] = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
        local[:3, 3] = node.get("translation", (0.0, 0.0, 0.0))
        yield node, above @ local
        for child in node.get("children", ()):
            yield from walk(child, above @ local)

    for root in content["scenes"][content["scene"]]["nodes"]:
        yield from walk(root, np.eye(4))


def z_up(points: np.ndarray) -> np.ndarray:
    """What Perilune makes of a file's coordinates."""
    return np.stack([points[..., 0], -points[..., 2], points[..., 1]], axis=-1)


def welded(points: np.ndarray) -> np.ndarray:
    """A number for each point, the same for points within rounding of each other."""
    key = np.round(points, 4)
    return np.unique(key + 0.0, axis=0, return_inverse=True)[1].reshape(-1)


@pytest.mark.parametrize("name", MODELS)
def test_rebuilding_gives_the_committed_model(scripts, name, tmp_path):
    path = tmp_path / f"{name}.glb"
    scripts(name).build().save(path)
    (new, new_binary), (old, old_binary) = parse(path.read_bytes()), committed(name)
    assert {k: v for k, v in new.items() if k != "accessors"} == {
        k: v for k, v in old.items() if k != "accessors"
    }
    for index, (a, b) in enumerate(zip(new["accessors"], old["accessors"], strict=True)):
        assert (a["count"], a["type"]) == (b["count"], b["type"])
        # 2e-4: a coordinate on the edge of its rounding may fall either way on another machine.
        np.testing.assert_allclose(
            accessor(new, new_binary, index), accessor(old, old_binary, index), rtol=0, atol=2e-4
        )


@pytest.mark.parametrize("name", MODELS)
def test_building_twice_gives_the_same_bytes(scripts, name):
    module = scripts(name)
    assert module.build().to_bytes() == module.build().to_bytes()


@pytest.mark.parametrize("name", MODELS)
def test_names_sizes_and_counts(name):
    content, binary = committed(name)
    assert {node["name"] for node in content["nodes"]} >= NAMES[name]
    assert {material["name"] for material in content["materials"]} >= MATERIALS[name]
    names = [node["name"] for node in content["nodes"]]
    assert len(names) == len(set(names))
    count, points = 0, []
    for node, matrix in placed(content):
        if "mesh" not in node:
            continue
        for positions, _, triangles in primitives(content, binary, content["meshes"][node["mesh"]]):
            count += len(triangles)
            points.append(positions @ matrix[:3, :3].T + matrix[:3, 3])
    low, high = TRIANGLES[name]
    assert low < count < high
    size = np.ptp(np.concatenate(points), axis=0).max()
    assert SIZE_M[name][0] < size < SIZE_M[name][1]


@pytest.mark.parametrize("name", MODELS)
def test_normals_are_unit_and_agree_with_the_winding(name):
    content, binary = committed(name)
    for mesh in content["meshes"]:
        for positions, normals, triangles in primitives(content, binary, mesh):
            np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=2e-4)
            corner = positions[triangles]
            face = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
            area = np.linalg.norm(face, axis=1)
            assert area.min() > 1e-12, f"{mesh['name']}: a triangle without area"
            cosine = (face * normals[triangles].mean(axis=1)).sum(axis=1) / area
            assert cosine.min() > 0.0, f"{mesh['name']}: a face seen from behind by its normals"


@pytest.mark.parametrize("name", MODELS)
def test_meshes_are_closed_and_point_outward(name):
    """Every directed edge has its opposite, and the enclosed volume is positive."""
    content, binary = committed(name)
    for mesh in content["meshes"]:
        parts = list(primitives(content, binary, mesh))
        starts = np.cumsum([0] + [len(p) for p, _, _ in parts[:-1]])
        points = np.concatenate([p for p, _, _ in parts])
        triangles = np.concatenate([t + s for (_, _, t), s in zip(parts, starts, strict=True)])
        ids = welded(points)[triangles]
        edges = np.concatenate([ids[:, [0, 1]], ids[:, [1, 2]], ids[:, [2, 0]]])
        edges = edges[edges[:, 0] != edges[:, 1]]
        balance: dict[tuple[int, int], int] = {}
        for a, b in edges.tolist():
            key = (min(a, b), max(a, b))
            balance[key] = balance.get(key, 0) + (1 if a < b else -1)
        assert not any(balance.values()), f"{mesh['name']} has open edges"
        corner = points[triangles]
        volume = np.einsum("ij,ij->", corner[:, 0], np.cross(corner[:, 1], corner[:, 2])) / 6
        assert volume > 0.0, f"{mesh['name']} is inside out"


def tango_extras() -> dict:
    content, _ = committed("tango_like")
    return content["scenes"][0]["extras"]["key_points"]


def test_tango_key_points_lie_on_the_model():
    content, binary = committed("tango_like")
    points = [
        z_up(positions @ matrix[:3, :3].T + matrix[:3, 3])
        for node, matrix in placed(content)
        if "mesh" in node
        for positions, _, _ in primitives(content, binary, content["meshes"][node["mesh"]])
    ]
    cloud = np.concatenate(points)
    extras = tango_extras()
    for name, key_point in zip(extras["names"], extras["points_m"], strict=True):
        gap = np.linalg.norm(cloud - key_point, axis=1).min()
        # Corners are bevelled by half a millimetre; an antenna's tip is the centre of its 5 mm end.
        assert gap < (0.0051 if name.startswith("antenna") else 0.001), name


def test_tango_key_points_are_the_published_ones(data_dir):
    from scipy.io import loadmat

    published = loadmat(data_dir / "pose/speedplus/tangoPoints.mat")["tango3Dpoints"].T
    np.testing.assert_allclose(tango_extras()["points_m"], published, rtol=0, atol=1e-3)


def test_map_is_what_its_script_makes(scripts):
    """A sample of pixels, recomputed; the JPEG's own error is a few steps."""
    image = pytest.importorskip("PIL.Image")
    earth = scripts("earth_like")
    path = ASSETS / "maps" / "earth_like.jpg"
    assert path.stat().st_size < 1_800_000
    pixels = np.asarray(image.open(path).convert("RGB")).astype(float)
    assert pixels.shape == (earth.HEIGHT, earth.WIDTH, 3)
    for row in (100, 512, 700):
        made = earth.colors(earth.directions(earth.WIDTH, earth.HEIGHT, row, row + 1))
        assert np.abs(made - pixels[row]).mean() < 4.0


def test_clouds_are_what_their_script_makes(scripts):
    image = pytest.importorskip("PIL.Image")
    earth = scripts("earth_like")
    path = ASSETS / "maps" / "earth_like_clouds.jpg"
    assert path.stat().st_size < 1_300_000
    pixels = np.asarray(image.open(path)).astype(float)
    assert pixels.shape == (earth.CLOUD_HEIGHT, earth.CLOUD_WIDTH)
    weights = np.cos(np.pi * ((np.arange(earth.CLOUD_HEIGHT) + 0.5) / earth.CLOUD_HEIGHT - 0.5))
    assert 0.3 < np.average(pixels.mean(axis=1) / 255, weights=weights) < 0.6
    d = earth.directions(earth.CLOUD_WIDTH, earth.CLOUD_HEIGHT, 800, 801)
    assert np.abs(255 * earth.cover(d) - pixels[800]).mean() < 8.0


@pytest.mark.parametrize(("name", "uneven"), [("earth_like", 6.0), ("earth_like_clouds", 20.0)])
def test_map_has_no_seam_and_even_poles(name, uneven):
    image = pytest.importorskip("PIL.Image")
    pixels = np.asarray(image.open(ASSETS / "maps" / f"{name}.jpg").convert("RGB"), float)
    across = np.abs(pixels[:, 0] - pixels[:, -1]).mean()
    inside = np.abs(np.diff(pixels, axis=1)).mean()
    assert across < 2.0 * inside + 1.0
    assert pixels[[0, -1]].std(axis=1).max() < uneven
