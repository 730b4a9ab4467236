"""A small scene made here, so that tests of files and commands need no asset and run in seconds."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import numpy as np
import pytest


def _box(low, high):
    """24 vertices and 12 triangles of a box, flat normals, glTF axes (y up)."""
    low, high = np.asarray(low, float), np.asarray(high, float)
    positions, normals, triangles = [], [], []
    for axis in range(3):
        for side in (0, 1):
            first, second = (axis + 1) % 3, (axis + 2) % 3
            if side == 0:
                first, second = second, first
            normal = np.zeros(3)
            normal[axis] = 2 * side - 1
            start = len(positions)
            for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)):
                corner = np.empty(3)
                corner[axis] = (low, high)[side][axis]
                corner[first] = (low, high)[a][first]
                corner[second] = (low, high)[b][second]
                positions.append(corner)
                normals.append(normal)
            triangles += [[start, start + 1, start + 2], [start, start + 2, start + 3]]
    return np.array(positions), np.array(normals), np.array(triangles)


def write_probe(path: Path, wing: float = 1.0) -> None:
    """A bus and a wing, off the origin and without symmetry, as a GLB of two materials."""
    boxes = [_box((1, 0, 0), (3, 1, 1.5)), _box((3, 0.4, 0.5), (6, 0.5, wing))]
    chunks, views, accessors, primitives = b"", [], [], []

    def add(array, component, kind, target):
        nonlocal chunks
        data = array.tobytes()
        views.append(
            {"buffer": 0, "byteOffset": len(chunks), "byteLength": len(data), "target": target}
        )
        accessor = {
            "bufferView": len(views) - 1,
            "componentType": component,
            "count": len(array) if kind != "SCALAR" else array.size,
            "type": kind,
        }
        if kind == "VEC3":
            accessor["min"] = array.min(axis=0).tolist()
            accessor["max"] = array.max(axis=0).tolist()
        accessors.append(accessor)
        chunks += data + b"\0" * (-len(data) % 4)
        return len(accessors) - 1

    for material, (positions, normals, triangles) in enumerate(boxes):
        primitives.append(
            {
                "attributes": {
                    "POSITION": add(positions.astype("<f4"), 5126, "VEC3", 34962),
                    "NORMAL": add(normals.astype("<f4"), 5126, "VEC3", 34962),
                },
                "indices": add(triangles.astype("<u2").ravel(), 5123, "SCALAR", 34963),
                "material": material,
            }
        )
    colors = {"bus": [0.8, 0.7, 0.3, 1.0], "wing": [0.1, 0.15, 0.6, 1.0]}
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "probe"}],
        "meshes": [{"primitives": primitives}],
        "materials": [
            {
                "name": name,
                "pbrMetallicRoughness": {
                    "baseColorFactor": color,
                    "metallicFactor": 0.0,
                    "roughnessFactor": 0.7,
                },
            }
            for name, color in colors.items()
        ],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(chunks)}],
    }
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    size = 12 + 8 + len(text) + 8 + len(chunks)
    path.write_bytes(
        struct.pack("<4sII", b"glTF", 2, size)
        + struct.pack("<I4s", len(text), b"JSON")
        + text
        + struct.pack("<I4s", len(chunks), b"BIN\0")
        + chunks
    )


def small_configuration():
    """One probe over an Earth-like body, 96x72 pixels, 2 samples."""
    orbit = {
        "around": "planet",
        "altitude_km": 500.0,
        "inclination_deg": 30.0,
        "mean_anomaly_deg": 10.0,
    }
    return {
        "version": 1,
        "seed": 3,
        "time": {"epoch": "2026-03-20T12:00:00Z", "step_s": 60.0},
        "root": "planet",
        "bodies": {
            "planet": {
                "kind": "ellipsoid",
                "radii_km": [6378.0, 6378.0, 6357.0],
                "gm_km3_s2": 398600.0,
                "albedo": [0.2, 0.3, 0.4],
            }
        },
        "spacecraft": {
            "probe": {
                "model": "probe.glb",
                "size_m": 4.0,
                "orbit": orbit,
                "keypoints": {"points": {"nose": [0.9, 0.0, 0.4], "tail": [-0.9, 0.2, -0.4]}},
            }
        },
        "camera": {
            "width": 96,
            "height": 72,
            "fov_deg": 40.0,
            "trajectory": {
                "kind": "orbit_object",
                "target": "probe",
                "distance_m": [9.0, 14.0],
                "sun_angle_deg": [0.0, 100.0],
            },
        },
        "render": {"samples": 2, "max_bounces": 1},
    }


@pytest.fixture(scope="session")
def small_scene(tmp_path_factory):
    """Path of `small_configuration`."""
    folder = tmp_path_factory.mktemp("small_scene")
    write_probe(folder / "probe.glb")
    path = folder / "small.json"
    path.write_text(json.dumps(small_configuration()))
    return path


@pytest.fixture(scope="session")
def pair(small_scene):
    """Overrides that put a second probe some metres ahead of the first, sharing its model."""
    orbit = json.loads(small_scene.read_text())["spacecraft"]["probe"]["orbit"]
    orbit["mean_anomaly_deg"] += 4e-5  # about 4.8 m
    return {
        "spacecraft.probe.obj_id": 5,
        "spacecraft.mate": {"model": "probe.glb", "size_m": 4.0, "obj_id": 5, "orbit": orbit},
    }


@pytest.fixture(scope="session")
def crowd(pair):
    """Overrides for a narrow view of three probes: hidden by another, cut by the image, unseen."""
    near = dict(pair["spacecraft.mate"])
    base = near["orbit"]["mean_anomaly_deg"] - 4e-5
    near["orbit"] = dict(near["orbit"], mean_anomaly_deg=base + 1.5e-5)  # 1.8 m ahead
    far = dict(pair["spacecraft.mate"], obj_id=7, size_m=5.0)
    far["orbit"] = dict(far["orbit"], mean_anomaly_deg=200.0)  # behind the planet or the camera
    return {
        **pair,
        "spacecraft.mate": near,
        "spacecraft.far": far,
        "camera.width": 80,
        "camera.height": 64,
        "camera.fov_deg": 28.0,
        "camera.trajectory.aim_jitter_deg": 8.0,
        "render.samples": 1,
        "render.max_bounces": 0,
    }
