"""Surfaces at their hard cases: patterns far from the origin, maps at the date line and the poles,
pictures of one texel and of odd sides, faces in one place, faces without texture gradients or
tangents, grazing and normal incidence, roughness 0 and 1.
"""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from numpy.typing import NDArray
from PIL import Image
from tests.hard.glb import write_glb

import perilune
from perilune.config.materials import Material
from perilune.materials.graph import build

F64 = NDArray[np.float64]
RADIUS_KM = 1000.0
WIDTH = 65  # odd: a pixel looks along the axis
WORLD: dict[str, Any] = {
    "version": 1,
    "seed": 3,
    "time": {"epoch": "2026-03-20T12:00:00Z", "step_s": 0.0},
    "root": "ball",
    "sun": {"direction": [0.0, 0.0, 1.0]},
    "bodies": {
        "ball": {
            "kind": "ellipsoid",
            "radii_km": [RADIUS_KM] * 3,
            "gm_km3_s2": 1.0,
            "color_map": "map.png",
            "class": "ball",
        }
    },
    "camera": {
        "width": WIDTH,
        "height": WIDTH,
        "fov_deg": 20.0,
        "exposure": {"mode": "fixed", "white_radiance_w_m2_sr": 433.0},
        "trajectory": {"kind": "hover", "target": "ball", "lon_deg": 0.0, "lat_deg": 90.0},
    },
    "render": {"samples": 16, "tolerance_dn": 0.0, "max_bounces": 0, "channels": ["rgb"]},
}


# --- patterns far from the origin ----------------------------------------------------------------

PATTERNS: dict[str, str] = {
    "noise": "value",
    "musgrave": "value",
    "voronoi": "distance",
    "white_noise": "value",
    "checker": "value",
    "wave": "value",
    "brick": "cover",
}


def along_a_line(kind: str, start: float, step: float, count: int, radius: float) -> F64:
    """Values of a pattern (scaled to stay within 0..1) at start, start + step, ... on a line."""
    nodes = {
        "where": {"type": "coordinates"},
        "pattern": {"type": kind, "vector": "where"},
        "scaled": {"type": "math", "function": "multiply_add", "a": f"pattern.{PATTERNS[kind]}"},
        "skin": {"type": "lambert", "base_color": "scaled"},
    }
    nodes["scaled"] |= {"b": 0.25, "c": 0.5} if kind == "musgrave" else {"b": 0.5, "c": 0.0}
    graph = build("m", Material(nodes=nodes), False, None)
    t = start + step * np.arange(count)
    points = np.stack([t, 0.37 * t + 0.2, -0.61 * t + 0.7], axis=1)
    return graph.core.evaluate(points, radius, np.empty((0, 4), dtype=np.float32))[:, 0]


@pytest.mark.parametrize("kind", PATTERNS)
def test_patterns_are_the_same_ten_thousand_cells_away(kind: str) -> None:
    """Coordinates still have a thousand steps a cell: the distribution is that near the origin."""
    near = along_a_line(kind, 0.0, 0.173, 4000, 0.0)
    far = along_a_line(kind, 4096.0, 0.173, 4000, 0.0)
    assert abs(far.mean() - near.mean()) < 0.02
    assert abs(far.std() - near.std()) < 0.02


@pytest.mark.parametrize("kind", PATTERNS)
def test_patterns_at_1e7_fade_where_coordinates_have_no_steps_left(kind: str) -> None:
    """Single precision resolves a metre there: cells of a metre would be blocks of chance. The
    rounding counts as part of the footprint, so what is left is near the mean."""
    near = along_a_line(kind, 0.0, 0.173, 4000, 0.0)
    far = along_a_line(kind, 1e7, 0.173, 4000, 0.0)
    assert np.isfinite(far).all()
    assert ((far >= 0.0) & (far <= 1.0)).all()
    assert abs(far.mean() - near.mean()) < 0.05
    assert far.std() < 0.75 * near.std()
    beyond = along_a_line(kind, 1e12, 1e6, 500, 0.0)
    assert np.isfinite(beyond).all()
    assert beyond.std() < 0.02 + 0.01 * near.std()


def test_coarse_patterns_at_1e7_stay() -> None:
    """Cells of 100 km on a body of 10 000 km have their detail."""
    nodes = {
        "where": {"type": "coordinates"},
        "pattern": {"type": "noise", "vector": "where", "scale": 1e-5},
        "skin": {"type": "lambert", "base_color": "pattern"},
    }
    core = build("m", Material(nodes=nodes), False, None).core
    t = 1e7 + 1e4 * np.arange(3000.0)
    points = np.stack([t, 0.4 * t, 0.1 * t], axis=1)
    values = core.evaluate(points, 10.0, np.empty((0, 4), dtype=np.float32))[:, 0]
    assert values.std() > 0.05
    assert np.abs(np.diff(values)).max() < 0.25  # a tenth of a cell a step


# --- maps on bodies ------------------------------------------------------------------------------


def seen(folder: Path, texels: NDArray[np.uint8], lon: float, lat: float, **changes: Any) -> F64:
    """Colour over that of a white body, of a hover over a place; NaN off the body."""
    Image.fromarray(texels).save(folder / "map.png")
    tree = copy.deepcopy(WORLD)
    lon_rad, lat_rad = np.radians([lon, lat])
    toward = [
        np.cos(lat_rad) * np.cos(lon_rad), np.cos(lat_rad) * np.sin(lon_rad), np.sin(lat_rad)
    ]  # fmt: skip
    tree["sun"]["direction"] = [float(x) for x in toward]
    hover = tree["camera"]["trajectory"]
    hover |= {"lon_deg": lon, "lat_deg": lat, "height_m": 4e5}
    hover |= changes
    bare = copy.deepcopy(tree)
    del bare["bodies"]["ball"]["color_map"]
    bare["bodies"]["ball"]["albedo"] = 1.0
    images = []
    for name, each in (("mapped", tree), ("bare", bare)):
        path = folder / f"{name}.yaml"
        path.write_text(yaml.safe_dump(each))
        images.append(perilune.open(path).frame(0, channels=["radiance"])["radiance"][..., 0])
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(images[1] > 0, images[0].astype(float) / images[1], np.nan)


def linear(code: F64) -> F64:
    """IEC 61966-2-1."""
    x = np.asarray(code, dtype=float) / 255.0
    return np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)


def test_the_date_line_has_no_seam(tmp_path: Path) -> None:
    """A map that is continuous around the body looks the same across its edge as half a turn
    away."""
    lon = (np.arange(512) + 0.5) / 512.0 * 2.0 * np.pi
    row = np.round(127.5 + 100.0 * np.cos(64.0 * lon)).astype(np.uint8)
    texels = np.repeat(row[None, :], 256, axis=0)
    edge = seen(tmp_path, texels, 180.0, 0.0)
    middle = seen(tmp_path, texels, 0.0, 0.0)
    assert np.isfinite(edge).all()
    np.testing.assert_allclose(edge, middle, atol=4e-3)
    assert np.ptp(edge[WIDTH // 2]) > 0.1


@pytest.mark.parametrize("pole", [90.0, -90.0])
@pytest.mark.parametrize("height_m", [4e5, 4e3])
def test_rays_of_a_star_meet_at_the_pole_in_their_mean(
    tmp_path: Path, pole: float, height_m: float
) -> None:
    """Sectors of black and white: about the pole, where a pixel holds many, neither shows."""
    texels = np.zeros((256, 1024), dtype=np.uint8)
    texels[:, (np.arange(1024) // 8) % 2 == 0] = 255
    image = seen(tmp_path, texels, 0.0, pole, height_m=height_m)
    middle = WIDTH // 2
    centre = image[middle - 2 : middle + 3, middle - 2 : middle + 3]
    assert np.isfinite(centre).all()
    assert np.abs(centre - 0.5).max() < 0.12
    assert abs(centre[2, 2] - 0.5) < 0.05


@pytest.mark.parametrize("pole", [90.0, -90.0])
def test_a_cap_on_the_pole_stays_a_cap(tmp_path: Path, pole: float) -> None:
    """The last rows of the map, 5 degrees, are white, all else black: the pixels on the pole see
    white alone, not the mean of the map."""
    texels = np.zeros((180, 360), dtype=np.uint8)
    texels[:5] = texels[-5:] = 255
    image = seen(tmp_path, texels, 0.0, pole, height_m=4e5)
    middle = WIDTH // 2
    assert image[middle - 5 : middle + 6, middle - 5 : middle + 6].min() > 0.98
    # Half the field of 20 degrees at 400 km over a radius of 1000 km: 4.1 degrees of latitude, in
    # the corners 5.8.
    assert image[middle].min() > 0.98
    assert image[0, 0] < 0.02


def test_pictures_of_one_texel_and_of_odd_sides(tmp_path: Path) -> None:
    for code in (1, 127, 255):
        image = seen(tmp_path, np.full((1, 1), code, dtype=np.uint8), 30.0, 40.0)
        np.testing.assert_allclose(image, linear(code), rtol=1e-4)
    for height, width in ((1, 3), (3, 1), (7, 5), (1, 257), (255, 1)):
        constant = np.full((height, width), 90, dtype=np.uint8)
        image = seen(tmp_path, constant, 179.9, 89.0)
        np.testing.assert_allclose(image, linear(90), rtol=1e-4)
        rng = np.random.default_rng(height * 1000 + width)
        texels = rng.integers(0, 256, size=(height, width)).astype(np.uint8)
        image = seen(tmp_path, texels, 179.9, 20.0)
        low, high = linear(texels.min()), linear(texels.max())
        assert (image >= low - 1e-4).all()
        assert (image <= high + 1e-4).all()


# --- meshes --------------------------------------------------------------------------------------


def before_the_ball(
    folder: Path, models: dict[str, Path], position_m: list[float], **sections: Any
) -> perilune.Simulation:
    """Models at one place over the lit side of the ball, seen from a place relative to them."""
    tree = copy.deepcopy(WORLD)
    del tree["bodies"]["ball"]["color_map"]
    tree["bodies"]["ball"]["albedo"] = 0.3
    tree["sun"]["direction"] = [0.3, 0.2, 1.0]
    tree["spacecraft"] = {
        name: {
            "model": str(model),
            "metres_per_unit": 1.0,
            "centre": "origin",
            "orbit": {"around": "ball", "kind": "kepler", "position_km": [0.0, 0.0, 2000.0]},
            "attitude": {"pointing": "inertial"},
        }
        for name, model in models.items()
    }
    tree["camera"]["trajectory"] = {
        "kind": "fixed",
        "target": next(iter(models)),
        "position_m": position_m,
    }
    path = folder / "mesh.yaml"
    path.write_text(yaml.safe_dump(tree))
    return perilune.open(path, overrides=sections)


SQUARE = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], dtype=np.float32)
HALVES = (
    np.array([[0, 1, 2], [0, 2, 3]], dtype=np.uint32),
    np.array([[0, 1, 3], [1, 2, 3]], dtype=np.uint32),
)


def leaning(points: NDArray[np.float32], angle: float) -> NDArray[np.float32]:
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    return (points @ turn.T).astype(np.float32)


def grid(cells: int) -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """The square in cells^2 squares, each cut along its other diagonal."""
    x = np.linspace(-1.0, 1.0, cells + 1)
    points = np.array([[a, b, 0.0] for a in x for b in x], dtype=np.float32)
    first = [i * (cells + 1) + j for i in range(cells) for j in range(cells)]
    triangles = [
        t for a in first for t in ([a, a + cells + 1, a + 1], [a + 1, a + cells + 1, a + cells + 2])
    ]
    return points, np.array(triangles, dtype=np.uint32)


@pytest.mark.parametrize("angle", [0.0, 0.4, 1.0])
@pytest.mark.parametrize("decal", ["same triangles", "other diagonal", "finer"])
@pytest.mark.parametrize("position", [[0.0, 0.0, 12.0], [3.0, 1.0, 6.0], [1.0, 5.0, 4.0]])
def test_of_faces_in_one_place_the_later_objects_are_seen(
    tmp_path: Path, decal: str, angle: float, position: list[float]
) -> None:
    """A decal, whatever triangles it is made of: at every pixel, by every sample, on one thread or
    two. Where both are in sight is where the one below is alone."""
    above = {
        "same triangles": (SQUARE, HALVES[0]),
        "other diagonal": (SQUARE, HALVES[1]),
        "finer": grid(7),
    }[decal]
    models = {
        name: write_glb(tmp_path / f"{name}.glb", leaning(points, angle), triangles)
        for name, (points, triangles) in (("base", (SQUARE, HALVES[0])), ("decal", above))
    }
    paint = {
        name: {"nodes": {"skin": {"type": "lambert", "base_color": color}}}
        for name, color in (("red", [0.8, 0.0, 0.0]), ("blue", [0.0, 0.0, 0.8]))
    }
    places = {
        "materials": paint,
        "spacecraft.base.materials": [{"material": "*", "use": "red"}],
        "render.channels": ["instance"],
    }
    alone = before_the_ball(tmp_path, {"base": models["base"]}, position, **places)
    expected = alone.frame(0)["instance"] == 2
    places["spacecraft.decal.materials"] = [{"material": "*", "use": "blue"}]
    sim = before_the_ball(tmp_path, models, position, **places)
    one = sim.frame(0, channels=["instance", "radiance"], threads=1)
    two = sim.frame(0, channels=["instance", "radiance"], threads=2)
    assert np.array_equal(one["radiance"], two["radiance"])
    assert expected.sum() > 100
    assert np.array_equal(one["instance"] == 3, expected)
    assert not (one["instance"] == 2).any()
    inner = np.zeros_like(expected)
    inner[1:-1, 1:-1] = expected[1:-1, 1:-1]
    for shift in ((0, 1), (0, -1), (1, 0), (-1, 0), (1, 1), (-1, -1), (1, -1), (-1, 1)):
        inner &= np.roll(expected, shift, axis=(0, 1))
    assert (one["radiance"][inner][:, 0] == 0.0).all()


LOBES: dict[str, dict[str, Any]] = {
    "mirror": {"roughness": 0.0, "metallic": 1.0},
    "chalk": {"roughness": 1.0},
    "black metal": {"base_color": [0.0, 0.0, 0.0], "metallic": 1.0, "roughness": 0.3},
    "index 1": {"ior": 1.0, "roughness": 0.0},
    "brushed": {"roughness": 0.3, "metallic": 1.0, "anisotropy": 1.0},
    "coated": {"coat": 1.0, "coat_roughness": 0.0},
}


@pytest.mark.parametrize("lobe", LOBES)
@pytest.mark.parametrize("tangents", ["none", "zero", "along the normal"])
def test_faces_without_tangents_at_all_angles(tmp_path: Path, lobe: str, tangents: str) -> None:
    """Texture coordinates without a gradient, tangents of no length or along the normal; normal
    maps, bumps and stretched lobes on them; seen face on, aslant and from within the plane. Nothing
    is infinite, negative or brighter than the sun's mirror image."""
    attributes = {"TEXCOORD_0": np.full((4, 2), 0.25, dtype=np.float32)}
    if tangents != "none":
        # Of the file's axes, in which the model's z is y.
        row = [0.0, 0.0 if tangents == "zero" else 1.0, 0.0, 1.0]
        attributes["TANGENT"] = np.tile(np.array(row, dtype=np.float32), (4, 1))
    model = write_glb(tmp_path / "face.glb", SQUARE, HALVES[0], attributes)
    nodes: dict[str, Any] = {
        "where": {"type": "coordinates"},
        "noise": {"type": "noise", "vector": "where", "scale": 5.0},
        "bumps": {"type": "bump", "height": "noise", "distance_m": 0.05},
        "tilted": {"type": "normal_map", "color": [0.7, 0.4, 0.9]},
    }
    for normal in ("bumps", "tilted"):
        skin = {"type": "principled", "normal": normal} | LOBES[lobe]
        for position in ([0.0, 0.0, 6.0], [4.0, 0.0, 0.02], [4.0, 1.0, 0.0]):
            sim = before_the_ball(
                tmp_path,
                {"face": model},
                position,
                **{
                    "materials": {"m": {"nodes": {**nodes, "skin": skin}}},
                    "spacecraft.face.materials": [{"material": "*", "use": "m"}],
                    "render.max_bounces": 2,
                    "render.samples": 4,
                    "camera.width": 24,
                    "camera.height": 24,
                },
            )
            radiance = sim.frame(0, channels=["radiance"])["radiance"]
            assert np.isfinite(radiance).all()
            assert (radiance >= 0.0).all()
            assert radiance.max() < 2.5e7  # the sun's disc: 1361 W m-2 over 6.8e-5 sr
