"""Shapes of bodies where it is hard: very near and very far, concave, in shadows and moving."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from tests.python.shape_scenes import ball, scene, write_obj

import perilune
from perilune.base import rotations
from perilune.bodies import shape_files

SAT = str(Path(__file__).resolve().parents[2] / "assets" / "models" / "smallsat.glb")
CORNERS = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
CUBE = np.array(
    [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6],
     [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
)  # fmt: skip


def cut(path, parts):
    """A cube of half side 1 whose faces are cut into parts x parts squares, as OBJ."""
    vertices, triangles = CORNERS, CUBE
    for _ in range(parts):
        a, b, c = vertices[triangles].transpose(1, 0, 2)
        ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
        quads = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        corners = np.concatenate([np.stack(quad, axis=1) for quad in quads])
        vertices, place = np.unique(corners.reshape(-1, 3).round(12), axis=0, return_inverse=True)
        triangles = place.reshape(-1, 3)
    return write_obj(path, vertices, triangles)


def looking(place, direction):
    q = rotations.look_at(np.asarray(direction, float), np.array([0.0, 0.0, 1.0]))
    return np.concatenate([np.asarray(place, float), q])


def shot(tree, place, direction, **options):
    pose = looking(place, direction)
    return perilune.open(tree, trajectory=lambda _: pose).frame(0, **options)


@pytest.mark.parametrize("height_m", [0.5, 10.0, 1e3])
def test_a_large_body_from_near(tmp_path, height_m):
    """A cube of 10 km seen from 10 m over a face, aslant: ranges against the plane's in double, to
    1e-7 of the body's size, and not a speckle of its own shadow."""
    path = str(cut(tmp_path / "cube.obj", 4))
    body = {"shape": {"file": path, "smooth": False, "metres_per_unit": 5e3}, "radii_km": 5.0}
    place = np.array([5e3 + height_m, 1234.5, -987.6])
    way = np.array([-1.0, 0.4, 0.3]) / math.sqrt(1.25)
    tree = scene(body, (0, 0, 0), sun=[0.9, -0.1, 0.1])
    tree["render"]["force_off"] = ["soft_sun", "limb_darkening"]  # which are sampled
    sample = shot(tree, place, way)
    K, R = sample.camera.K, sample.camera.R_w2c
    v, u = np.mgrid[0:48, 0:48]
    rays = np.stack([(u - K[0, 2]) / K[0, 0], (v - K[1, 2]) / K[1, 1], np.ones_like(u)], axis=-1)
    rays = (rays / np.linalg.norm(rays, axis=-1, keepdims=True)) @ R
    expected = -height_m / rays[..., 0]
    assert (sample["instance"] == 1).all()
    assert np.abs(sample["range"] - expected).max() < 1e-3 + 1e-6 * expected.max()
    day = sample["radiance"][..., 0]
    normal = sample["normal"] @ R
    assert np.allclose(normal, [1.0, 0.0, 0.0], atol=1e-6)
    assert day.max() / day.min() < 1.0001  # Lambert's law: as bright from everywhere


@pytest.mark.parametrize("distance_m", [1e5, 1e7, 1e9])
def test_and_from_far(tmp_path, distance_m):
    """A cube's face is as bright as Lambert's law says, and its light that of its area."""
    path = str(cut(tmp_path / "cube.obj", 2))
    body = {"shape": {"file": path, "smooth": False, "metres_per_unit": 5e3}, "radii_km": 5.0}
    fov_deg = math.degrees(10.0 * 5e3 / distance_m) if distance_m < 1e7 else 2.0
    tree = scene(body, (0, 0, 0), fov_deg, sun=[1.0, 0.0, 0.0])
    tree["render"]["samples"] = 16
    tree["camera"]["exposure"]["white_radiance_w_m2_sr"] = min(130.0, 130.0 * (1e6 / distance_m))
    sample = shot(tree, [distance_m, 0, 0], [-1, 0, 0])
    focal = sample.camera.K[0, 0]
    flux = float(sample["radiance"][..., 0].sum()) / focal**2
    near = distance_m - 5e3  # the face's
    assert flux == pytest.approx(0.3 * 1361.0 / math.pi * (1e4 / near) ** 2, rel=0.02)


def test_inside_a_hollow_but_not_in_the_shape(tmp_path):
    """Between the lobes of one body: its ellipsoid holds the place, the shape does not."""
    v, f = ball(24)
    v = np.concatenate([0.4 * v + (0.6, 0, 0), 0.4 * v - (0.6, 0, 0)])
    path = str(write_obj(tmp_path / "two.obj", v, np.concatenate([f, f + len(v) // 2])))
    sample = shot(scene({"shape": path}, (0, 0, 0)), [0, 0, 0], [1, 0, 0])
    assert sample["range"][24, 24] == pytest.approx(200.0, rel=0.02)
    pose = looking([500.0, 0, 0], [1, 0, 0])
    with pytest.raises(ValueError, match="inside"):
        perilune.open(scene({"shape": path}, (0, 0, 0)), trajectory=lambda _: pose)[0]


def craft(place_km):
    return {
        "sat": {
            "model": SAT,
            "size_m": 40.0,
            "orbit": {"around": "rock", "position_km": place_km},
            "attitude": {"pointing": "inertial"},
        }
    }


@pytest.mark.parametrize(("off_m", "lit"), [(0.0, False), (700.0, False), (1200.0, True)])
def test_a_spacecraft_in_the_shadow_of_a_shape(tmp_path, off_m, lit):
    """Behind a cube of 2 km: dark over its square, where its ellipsoid of 500 m would leave light.
    Behind the shape nothing of it is in the frame."""
    path = str(cut(tmp_path / "cube.obj", 0))
    body = {"shape": {"file": path, "smooth": False}, "radii_km": 0.5}
    there = craft([-3.0, off_m / 1e3, 0])
    tree = scene(body, (0, 0, 0), 5.0, sun=[1.0, 0.0, 0.0], spacecraft=there)
    sample = shot(tree, [-3000.0, off_m, 800.0], [0, 0, -1])
    seen = sample["instance"] == sample["instance"].max()
    assert seen.sum() > 50
    light = sample["radiance"][seen].mean()
    assert light > 5.0 if lit else light < 0.1


def test_labels_of_what_a_shape_hides(tmp_path):
    """A satellite half behind an edge of a cube: the silhouette is whole, half of it is seen; the
    shape has no row of its own."""
    path = str(cut(tmp_path / "cube.obj", 1))
    body = {"shape": {"file": path, "smooth": False}, "radii_km": 1.0}
    tree = scene(body, (0, 0, 0), 2.0, spacecraft=craft([-2.0, 1.0, 0]))
    tree["render"]["channels"] = ["instance", "objects", "masks"]
    # By the edge at y = 1000 m, beyond which the satellite's centre lies on the line of sight.
    hidden = shot(tree, [3000.0, 1000.0, 0.0], [-1, 0, 0])
    del tree["bodies"]["rock"]["shape"]
    tree["bodies"]["rock"]["radii_km"] = 1e-3
    free = shot(tree, [3000.0, 1000.0, 0.0], [-1, 0, 0])
    assert len(hidden.objects) == 1
    row, whole = hidden.objects[0], free.objects[0]
    assert row["px_count_all"] == whole["px_count_all"]
    assert 0.3 < row["px_count_visib"] / row["px_count_all"] < 0.7
    assert np.array_equal(hidden["masks"], free["masks"])


def test_shapes_and_ellipsoids_eclipse_each_other(fine_ball):
    """A shape wholly in the umbra of a planet is black, and so is one behind another shape."""
    for keys in ({}, {"shape": {"file": fine_ball, "metres_per_unit": 2e4}}):
        planet = {
            "kind": "ellipsoid",
            "gm_km3_s2": 1e-6,
            "albedo": 0.2,
            "radii_km": 20.0,
            "orbit": {"around": "rock", "position_km": [60.0, 0.0, 0.0]},
            **keys,
        }
        tree = scene({"shape": fine_ball}, (0, -3000.0, 0), sun=[1.0, 0.0, 0.0])
        tree["bodies"]["planet"] = planet
        tree["render"]["max_bounces"] = 0
        seen = shot(tree, [0, -3000.0, 0], [0, 1, 0])
        assert (seen["instance"] == 1).sum() > 200
        assert seen["radiance"][seen["instance"] == 1].max() == 0.0
        tree["bodies"]["planet"]["orbit"]["position_km"] = [60.0, 0.0, 25.0]
        free = shot(tree, [0, -3000.0, 0], [0, 1, 0])
        assert free["radiance"][free["instance"] == 1].max() > 20.0


@pytest.fixture(scope="module")
def fine_ball(tmp_path_factory):
    return str(write_obj(tmp_path_factory.mktemp("hard") / "ball.obj", *ball(32)))


def test_a_turning_shape_blurs(tmp_path):
    """A bar that turns by a right angle in the exposure: the light is spread over the quarter that
    it sweeps, labels are those of the middle."""
    path = str(write_obj(tmp_path / "bar.obj", CORNERS * (1.0, 0.1, 0.1), CUBE))
    spin = {"spin_axis": [0, 0, 1], "spin_rate_deg_s": 90.0}
    tree = scene({"shape": {"file": path, "smooth": False}, "rotation": spin}, (0, 0, 3000.0))
    tree["camera"]["trajectory"] = {"kind": "fixed", "target": "rock", "position_m": [0, 1.0, 3e3]}
    tree["camera"]["exposure_time_s"] = 1.0
    blurred = perilune.open(tree)[0]
    tree["camera"]["exposure_time_s"] = 0.0
    still = perilune.open(tree)[0]
    wide = [(f["radiance"][..., 0] > 0.5).sum() for f in (blurred, still)]
    assert wide[0] > 2 * wide[1]  # four samples a pixel do not see the ends of the bar everywhere
    x, y = blurred["object_coords"][..., 0], blurred["object_coords"][..., 1]
    assert np.nanmax(np.abs(x)) > 900.0
    assert np.nanmax(np.abs(y)) < 110.0
    assert (blurred["instance"] > 0).sum() == pytest.approx((still["instance"] > 0).sum(), rel=0.3)


def test_poles_and_date_line_of_a_map(fine_ball, tmp_path):
    """A map of one column of white at the date line and white poles: seen on the shape as on the
    ellipsoid, without a seam."""
    from PIL import Image

    map_ = np.full((64, 128), 40, np.uint8)
    map_[:, :2] = map_[:, -2:] = 255
    map_[:2] = map_[-2:] = 255
    Image.fromarray(map_).save(tmp_path / "map.png")
    for place in ([-3000.0, 0.0, 0.0], [0.0, 1.0, 3000.0], [0.0, 1.0, -3000.0]):
        look = -np.array(place) / np.linalg.norm(place)
        pictures = []
        for keys in ({"shape": fine_ball}, {}):
            body = {"color_map": str(tmp_path / "map.png"), **keys}
            sun = (np.array(place) / 3000.0).tolist()
            pictures.append(shot(scene(body, (0, 0, 0), sun=sun), place, look)["radiance"])
        a, b = (p[12:-12, 12:-12, 0] for p in pictures)
        assert b.max() > 3.0 * np.median(b)
        assert np.abs(a / b - 1.0).max() < 0.25  # a facet's corner is half a degree off
        assert abs(a.mean() / b.mean() - 1.0) < 5e-3


def test_eros_counts_from_nought(data_dir):
    """The published file numbers its vertices from 0, Castalia's from 1; both are closed."""
    _, eros = shape_files.read(data_dir / "small_bodies" / "eros007790.tab")
    assert (eros.min(), eros.max()) == (0, 3896)
