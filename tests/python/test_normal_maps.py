"""Maps of normals that are none: colour pictures in their place pepper what they are on."""

from __future__ import annotations

import io
import json
import struct
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import perilune
from perilune import _core

SIDE = 64
POSITIONS = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], "<f4")
NORMALS = np.array([[0, 0, 1]] * 4, "<f4")
COORDINATES = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], "<f4")
CORNERS = np.array([0, 1, 2, 0, 2, 3], "<u2")


def smooth(rng, channels):
    """(SIDE, SIDE, channels): noise of a few texels, about 0, of deviation 1."""
    waves = np.hypot(*np.meshgrid(np.fft.fftfreq(SIDE), np.fft.fftfreq(SIDE)))
    spectrum = np.fft.fft2(rng.normal(size=(channels, SIDE, SIDE))) * np.exp(-((8 * waves) ** 2))
    rows = np.fft.ifft2(spectrum).real
    return np.moveaxis(rows / rows.std(axis=(1, 2), keepdims=True), 0, -1)


def picture():
    """Of a blanket: near to white, grey in its folds and noisy, as that of a published Shuttle."""
    rng = np.random.default_rng(3)
    grey = 0.85 + 0.1 * smooth(rng, 1) + 0.06 * smooth(rng, 3)
    return np.round(255 * np.clip(grey, 0, 1)).astype(np.uint8)


def crumpled():
    """Normals of slopes of 0.25, as those of crumpled foil."""
    slopes = 0.25 * smooth(np.random.default_rng(4), 2)
    n = np.concatenate([slopes, np.ones((SIDE, SIDE, 1))], axis=-1)
    n /= np.linalg.norm(n, axis=-1, keepdims=True)
    return np.round(127.5 * (n + 1)).astype(np.uint8)


def plate(path: Path, texels, slot="normalTexture") -> Path:
    """A GLB of a white plate of side 2 with a map, or without where texels is None."""
    png = io.BytesIO()
    Image.fromarray(np.zeros((1, 1, 3), np.uint8) if texels is None else texels).save(png, "PNG")
    parts = [a.tobytes() for a in (POSITIONS, NORMALS, COORDINATES, CORNERS)] + [png.getvalue()]
    starts = np.cumsum([0, *map(len, parts)])
    kinds = [(5126, 4, "VEC3"), (5126, 4, "VEC3"), (5126, 4, "VEC2"), (5123, 6, "SCALAR")]
    material = {"name": "liner", "pbrMetallicRoughness": {"metallicFactor": 0.0}}
    if texels is not None and slot == "normalTexture":
        material[slot] = {"index": 0}
    elif texels is not None:
        coat = {"clearcoatFactor": 1.0, slot: {"index": 0}}
        material["extensions"] = {"KHR_materials_clearcoat": coat}
    attributes = {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}
    tree = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "plate"}],
        "materials": [material],
        "textures": [{"source": 0}],
        "images": [{"bufferView": 4, "mimeType": "image/png"}],
        "meshes": [{"primitives": [{"attributes": attributes, "indices": 3, "material": 0}]}],
        "accessors": [
            {"bufferView": k, "componentType": number, "count": count, "type": kind}
            for k, (number, count, kind) in enumerate(kinds)
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": int(start), "byteLength": len(part)}
            for start, part in zip(starts, parts, strict=False)
        ],
        "buffers": [{"byteLength": int(starts[-1])}],
        "extensionsUsed": ["KHR_materials_clearcoat"],
    }
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    body = b"".join(parts) + b"\0" * (-int(starts[-1]) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    chunks += struct.pack("<II", len(body), 0x004E4942) + body
    path.write_bytes(struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks)
    return path


def radiance(model: Path, samples: int, sun_yaw_deg: float):
    """(48, 48) of the middle of the plate, seen from 35 degrees under the sun alone."""
    scene = {
        "version": 1,
        "time": {"epoch": "2026-03-20T12:40:00Z"},
        "root": "earth",
        "bodies": {"earth": {"kind": "earth", "albedo": 0.0}},
        "spacecraft": {
            "plate": {
                "model": str(model),
                "metres_per_unit": 1.0,
                "orbit": {"around": "earth", "altitude_km": 4e4, "mean_anomaly_deg": 0.0},
                # Its normal is -y in its own axes; 90: towards the sun.
                "attitude": {"pointing": "sun", "rotation_deg": [0.0, 0.0, sun_yaw_deg]},
            }
        },
        "camera": {
            "width": 48,
            "height": 48,
            "fov_deg": 10.0,
            "exposure": {"mode": "fixed", "white_radiance_w_m2_sr": 500.0},
            "trajectory": {
                "kind": "fixed",
                "target": "plate",
                "frame": "target",
                "position_m": [4.0 * np.sin(0.61), -4.0 * np.cos(0.61), 0.0],
                "up": [0.0, 0.0, 1.0],
            },
        },
        "render": {"samples": samples, "max_bounces": 2, "tolerance_dn": 0.0},
    }
    return perilune.open(scene).frame(0, ["radiance"])["radiance"].mean(axis=-1)


def speckle(image):
    """RMS difference of pixels and the mean of their four neighbours, of the mean."""
    near = image[:-2, 1:-1] + image[2:, 1:-1] + image[1:-1, :-2] + image[1:-1, 2:]
    return np.sqrt(np.mean((image[1:-1, 1:-1] - near / 4) ** 2)) / image.mean()


@pytest.mark.filterwarnings("ignore::perilune.config.errors.ModelWarning")
@pytest.mark.parametrize("samples", [16, 256])
def test_a_picture_for_a_map_of_normals_leaves_no_pepper(tmp_path, samples):
    mapped = plate(tmp_path / "mapped.glb", picture())
    plain = plate(tmp_path / "plain.glb", None)
    for yaw in (45.0, 90.0, 135.0):
        seen, wanted = radiance(mapped, samples, yaw), radiance(plain, samples, yaw)
        assert speckle(seen) < 0.01
        assert (seen > 0.05 * seen.mean()).all()
        assert seen.mean() == pytest.approx(wanted.mean(), rel=0.01)


@pytest.mark.parametrize("slot", ["normalTexture", "clearcoatNormalTexture"])
def test_the_reader_names_the_material_whose_map_shows_no_normals(tmp_path, slot):
    (told,) = _core.Model(str(plate(tmp_path / "plate.glb", picture(), slot))).warnings
    assert told.startswith("materials[0]")
    assert slot in told
    assert "a picture, not a map of normals, is left out" in told


def test_crumpled_foil_stays(tmp_path):
    path = plate(tmp_path / "foil.glb", crumpled())
    assert _core.Model(str(path)).warnings == ()
    seen = radiance(path, 16, 45.0)
    assert seen.std() > 0.1 * seen.mean()


def test_of_published_models_only_the_shuttles_bay_has_a_picture_there(data_dir):
    folder = data_dir / "spacecraft/plain"
    lines = {
        path.stem: [line for line in _core.Model(str(path)).warnings if "not a map of" in line]
        for path in (folder / "iss.glb", folder / "space_shuttle_d.glb")
    }
    assert lines["iss"] == []
    assert len(lines["space_shuttle_d"]) == 1
