"""Bodies whose shape is a glTF file: its materials are their surface if nothing else is given."""

from __future__ import annotations

import contextlib
import copy
import json
import struct
from pathlib import Path

import numpy as np
import pytest
from tests.python import shape_scenes

import perilune
from perilune import _core
from perilune.bodies import shape_files
from perilune.config.errors import ConfigError

RED, BLUE = [0.4, 0.02, 0.02, 1.0], [0.02, 0.02, 0.4, 1.0]
GREEN_BYTES, WHITE_BYTES = (20, 200, 20), (230, 230, 230)


def write_ball(path: Path, materials: list[dict], inwards: bool = False) -> Path:
    """A ball of radius 1 whose upper half has the first material and its lower half the second; a
    picture of two texels, green for x < 0 and white for x > 0, is texture 0."""
    points, faces = shape_scenes.ball(24)
    picture = path.with_suffix(".png")
    _core.png_write(str(picture), np.array([[GREEN_BYTES, WHITE_BYTES]], np.uint8))
    # The reader turns (x, y, z) of a file into (x, -z, y).
    turned = np.ascontiguousarray(points[:, [0, 2, 1]] * [1, 1, -1], np.float32)
    uvs = np.stack([0.25 + 0.5 * (points[:, 0] > 0), np.full(len(points), 0.5)], 1)
    upper = points[faces].mean(axis=1)[:, 2] > 0
    halves = [faces[upper], faces[~upper]] if len(materials) > 1 else [faces]
    blobs = [turned.tobytes(), uvs.astype(np.float32).tobytes()]
    blobs += [(half[:, ::-1] if inwards else half).astype(np.uint32).tobytes() for half in halves]
    blobs.append(picture.read_bytes())
    views, body = [], b""
    for blob in blobs:
        views.append({"buffer": 0, "byteOffset": len(body), "byteLength": len(blob)})
        body += blob + b"\0" * (-len(blob) % 4)
    low, high = turned.min(0).tolist(), turned.max(0).tolist()
    accessors = [
        {"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3",
         "min": low, "max": high},
        {"bufferView": 1, "componentType": 5126, "count": len(points), "type": "VEC2"},
    ]  # fmt: skip
    primitives = []
    for k, half in enumerate(halves):
        accessors.append(
            {"bufferView": 2 + k, "componentType": 5125, "count": half.size, "type": "SCALAR"}
        )
        row = {"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2 + k}
        primitives.append(row | ({"material": k} if k < len(materials) else {}))
    tree = {
        "asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": primitives}], "accessors": accessors, "bufferViews": views,
        "buffers": [{"byteLength": len(body)}], "textures": [{"source": 0, "sampler": 0}],
        "samplers": [{"magFilter": 9728, "minFilter": 9728}],
        "images": [{"bufferView": len(blobs) - 1, "mimeType": "image/png"}],
    }  # fmt: skip
    if materials:
        tree["materials"] = materials
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    chunks += struct.pack("<II", len(body), 0x004E4942) + body
    path.write_bytes(struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks)
    return path


def paint(color, **more):
    row = {"baseColorFactor": color, "metallicFactor": 0.0, "roughnessFactor": 1.0}
    return {"pbrMetallicRoughness": row, **more}


def config(path, albedo=None, **body):
    shape = {"file": str(path), "metres_per_unit": 1000.0}
    tree = shape_scenes.scene({"shape": shape, **body}, (0.0, -4000.0, 0.0))
    if albedo is None:
        del tree["bodies"]["rock"]["albedo"]
    else:
        tree["bodies"]["rock"]["albedo"] = albedo
    tree["render"] |= {"samples": 8, "max_bounces": 0}
    return tree


def seen(tree):
    """Mean radiance of the lit upper and lower half, away from the edge between them."""
    sample = perilune.open(tree).frame(0)
    z = sample["object_coords"][..., 2]
    lit = sample["radiance"].sum(axis=2) > 1.0
    halves = [sample["radiance"][lit & (side * z > 100.0)].mean(axis=0) for side in (1.0, -1.0)]
    return sample, halves


def test_the_materials_of_the_file_are_the_surface(tmp_path):
    """Colours, each on its half; labels stay the body's."""
    ball = write_ball(tmp_path / "ball.glb", [paint(RED), paint(BLUE)])
    sample, (upper, lower) = seen(config(ball))
    assert upper[0] > 5.0 * upper[2]
    assert lower[2] > 5.0 * lower[0]
    assert set(np.unique(sample["instance"])) == {0, 1}
    assert perilune.open(config(ball)).taxonomy.instances["rock"] == 1
    plain = perilune.open(config(ball, [0.4, 0.02, 0.02])).frame(0)
    for name in ("range", "normal", "instance"):
        np.testing.assert_array_equal(sample[name], plain[name])
    # As bright as a body of that albedo, but for the gloss of a rough dielectric.
    z = sample["object_coords"][..., 2]
    here = (z > 100.0) & (plain["radiance"][..., 0] > 5.0)
    ratio = sample["radiance"][here][:, 0] / plain["radiance"][here][:, 0]
    assert 0.9 < np.median(ratio) < 1.2


@pytest.mark.parametrize("inwards", [False, True])
@pytest.mark.parametrize("smooth", [False, True])
def test_textures_are_where_the_file_has_them(tmp_path, inwards, smooth):
    """Wound outwards or inwards, which is repaired; with facets or smooth."""
    picture = paint([1.0] * 4)
    picture["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
    ball = write_ball(tmp_path / "ball.glb", [picture, paint(BLUE)], inwards)
    tree = config(ball)
    tree["bodies"]["rock"]["shape"]["smooth"] = smooth
    tree["sun"] = {"direction": [0.0, -1.0, 0.3]}
    with pytest.warns(UserWarning, match="inwards") if inwards else contextlib.nullcontext():
        sample = perilune.open(tree).frame(0)
    x, z = sample["object_coords"][..., 0], sample["object_coords"][..., 2]
    light = sample["radiance"]
    for side, grey in ((-1.0, False), (1.0, True)):
        here = (z > 100.0) & (side * x > 200.0) & (light.sum(axis=2) > 5.0)
        assert here.sum() > 50
        red, green, _ = light[here].mean(axis=0)
        assert (red > 0.9 * green) == grey
        assert (red < 0.2 * green) != grey
    assert light[(z < -100.0) & (light.sum(axis=2) > 1.0)][:, 2].min() > 1.0


@pytest.mark.parametrize(
    "given",
    [
        {"albedo": [0.05, 0.4, 0.05]},
        {"color_map": "map.png"},
        {"reflectance": "lommel_seeliger", "albedo": [0.05, 0.4, 0.05]},
        {"material": "paint"},
    ],
)
def test_what_the_configuration_gives_wins(tmp_path, given):
    _core.png_write(str(tmp_path / "map.png"), np.full((2, 4, 3), (20, 200, 20), np.uint8))
    given = copy.deepcopy(given)
    if "color_map" in given:
        given["color_map"] = str(tmp_path / "map.png")
    tree = config(write_ball(tmp_path / "ball.glb", [paint(RED), paint(BLUE)]), **given)
    nodes = {"skin": {"type": "lambert", "base_color": [0.05, 0.4, 0.05]}}
    tree["materials"] = {"paint": {"nodes": nodes}} if "material" in given else {}
    _, halves = seen(tree)
    for red, green, blue in halves:
        assert green > 3.0 * red
        assert green > 3.0 * blue


def test_graphs_wrap_the_materials_of_the_file(tmp_path):
    """mode wrap: a graph without a colour keeps the file's."""
    ball = write_ball(tmp_path / "ball.glb", [paint(RED), paint(BLUE)])
    tree = config(ball, material="gloss", material_mode="wrap")
    nodes = {"skin": {"type": "metallic_roughness", "roughness": 0.4}}
    tree["materials"] = {"gloss": {"nodes": nodes}}
    _, (upper, lower) = seen(tree)
    assert upper[0] > 2.0 * upper[2]
    assert lower[2] > 2.0 * lower[0]


def test_bodies_stay_opaque_and_dark(tmp_path):
    """Opacity, transmission and emission of the file are not used, nor single-sidedness."""
    odd = paint([0.4, 0.02, 0.02, 0.1], alphaMode="BLEND", emissiveFactor=[1.0, 1.0, 1.0])
    odd["extensions"] = {"KHR_materials_transmission": {"transmissionFactor": 1.0}}
    plain = seen(config(write_ball(tmp_path / "a.glb", [paint(RED), paint(BLUE)])))[0]
    strange = seen(config(write_ball(tmp_path / "b.glb", [odd, paint(BLUE)])))[0]
    np.testing.assert_array_equal(strange["instance"], plain["instance"])
    np.testing.assert_allclose(strange["radiance"], plain["radiance"], rtol=0.02, atol=0.05)


def test_files_without_materials(tmp_path):
    """A body of the table keeps its albedo; an ellipsoid needs one."""
    ball = write_ball(tmp_path / "ball.glb", [])
    with pytest.raises(ConfigError, match=r"rock\.albedo: required .* has no materials"):
        perilune.open(config(ball)).frame(0)
    sample = perilune.open(config(ball, [0.3, 0.3, 0.3])).frame(0)
    assert sample["radiance"].max() > 10.0


def test_mean_colour_is_by_area(tmp_path):
    """What planetshine counts with."""
    ball = write_ball(tmp_path / "ball.glb", [paint(RED), paint(BLUE)])
    _, skin = shape_files.read_dressed(ball)
    np.testing.assert_allclose(skin.color, [0.21, 0.02, 0.21], atol=0.005)


def test_tables_of_corners_are_checked(tmp_path):
    ball = write_ball(tmp_path / "ball.glb", [paint(RED), paint(BLUE)])
    (vertices, triangles), skin = shape_files.read_dressed(ball)
    given = ("ball", vertices.astype(np.float32), triangles.astype(np.uint32), False, skin.model)
    for corners, faces in [
        (skin.corners[:-1], skin.faces),
        (skin.corners + 100_000, skin.faces),
        (skin.corners, skin.faces + 100_000),
    ]:
        with pytest.raises(ValueError, match=r"corners|made of none"):
            _core.Model.of_mesh(*given, corners, faces)
    del skin
    assert _core.Model.of_mesh(*given[:3]).materials == ("ball",)
