"""Bodies whose surface is a mesh: as the ellipsoid that it is finely cut of, and as published."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from tests.python.shape_scenes import ball, scene, write_obj

import perilune
from perilune import _core
from perilune.bodies import shape_files, shapes
from perilune.config.errors import ConfigError
from perilune.config.shape import Shape


@pytest.fixture(scope="module")
def fine(tmp_path_factory):
    """A ball of 1 km, within 0.6 m of the sphere."""
    return str(write_obj(tmp_path_factory.mktemp("shapes") / "ball.obj", *ball(64)))


def frame(tree, **options):
    return perilune.open(tree, **options)[0]


def lit(a, b):
    """Pixels that show the body in both, away from the outline."""
    both = (a["instance"] > 0) & (b["instance"] > 0)
    edge = np.pad(both, 1)
    return both & edge[:-2, 1:-1] & edge[2:, 1:-1] & edge[1:-1, :-2] & edge[1:-1, 2:]


# --- as the ellipsoid ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    "surface",
    [{}, {"reflectance": "hapke"}, {"reflectance": "lommel_seeliger"}, {"map": True}],
    ids=["lambert", "hapke", "lommel_seeliger", "map"],
)
def test_a_fine_ball_is_as_its_ellipsoid(fine, tmp_path, surface):
    if surface.pop("map", False):
        from PIL import Image

        lon, lat = np.meshgrid(np.linspace(-np.pi, np.pi, 128), np.linspace(1.57, -1.57, 64))
        value = 128 + 60 * np.sin(2 * lon) * np.cos(lat) + 50 * np.sin(3 * lat)
        Image.fromarray(value.astype(np.uint8)).save(tmp_path / "map.png")
        surface = {"color_map": str(tmp_path / "map.png"), "map_center_lon_deg": 30.0}
    place = (2600.0, -1900.0, 900.0)
    mesh = frame(scene({**surface, "shape": fine}, place))
    smooth = frame(scene(surface, place))
    inside = lit(mesh, smooth)
    assert inside.sum() > 400
    assert (mesh["instance"] != smooth["instance"]).sum() <= 4
    assert np.abs(mesh["range"] - smooth["range"])[inside].max() < 2.0
    assert np.abs(mesh["normal"] - smooth["normal"])[inside].max() < 0.03
    assert np.abs(mesh["object_coords"] - smooth["object_coords"])[inside].max() < 2.0
    day = inside & (smooth["radiance"][..., 1] > 5.0)
    ratio = mesh["radiance"][day] / smooth["radiance"][day]
    assert abs(ratio.mean() - 1.0) < 3e-3
    assert np.quantile(np.abs(ratio - 1.0), 0.98) < 0.08  # the noise of four samples of the sun


def test_any_threads_the_same_bits(fine):
    tree = scene({"shape": fine, "reflectance": "hapke"}, (1500.0, -1900.0, 900.0))
    a, b = (perilune.open(tree).frame(0, threads=threads) for threads in (1, 3))
    for key in a:
        assert np.array_equal(a[key], b[key], equal_nan=True), key


def test_labels_are_those_of_a_body(fine):
    """No row of its own among the objects, ids and classes as of the ellipsoid."""
    tree = scene({"shape": fine}, (2600.0, -1900.0, 900.0))
    tree["render"]["channels"] = ["semantic", "part", "instance", "objects"]
    mesh = frame(tree)
    del tree["bodies"]["rock"]["shape"]
    smooth = frame(tree)
    assert len(mesh.objects) == 0
    for key in ("semantic", "part", "instance"):
        assert set(np.unique(mesh[key])) == set(np.unique(smooth[key])), key
        assert (mesh[key] != smooth[key]).sum() <= 4 * mesh[key].size // 48**2


def test_facets_are_flat_where_asked(tmp_path):
    path = str(write_obj(tmp_path / "ball.obj", *ball(6)))
    flat = frame(scene({"shape": {"file": path, "smooth": False}}, (2600.0, -1900.0, 900.0)))
    soft = frame(scene({"shape": path}, (2600.0, -1900.0, 900.0)))
    kinds = [len(np.unique(f["normal"][f["instance"] > 0].round(4), axis=0)) for f in (flat, soft)]
    assert kinds[0] < 45 < 300 < kinds[1]  # half of the 132 facets are turned away


# --- shadows, eclipses, light -------------------------------------------------------------------


def test_two_lobes_shade_each_other(tmp_path):
    """One body of two balls, apart: the far one lies in the near one's shadow, half of the near one
    by itself; a convex body has no shadow on itself."""
    v, f = ball(40)
    v = np.concatenate([0.3 * v + (0.5, 0, 0), 0.3 * v - (0.5, 0, 0)])
    path = str(write_obj(tmp_path / "two.obj", v, np.concatenate([f, f + len(v) // 2])))
    seen = {}
    for name, sun in (("along", [1.0, 0.0, 0.0]), ("across", [0.0, -1.0, 0.0])):
        seen[name] = frame(scene({"shape": path}, (0.0, -3000.0, 0.0), sun=sun))
    x = seen["along"]["object_coords"][..., 0]
    near, far = (x > 0.52e3), (x < -0.2e3)
    bright = seen["along"]["radiance"][..., 0]
    assert near.sum() > 10
    assert far.sum() > 30
    assert bright[near].min() > 5.0
    # Sunlight that the near lobe sends on is at most its albedo times what it fills of the sky.
    sent = 0.3 * 0.3 * 1361.0 / math.pi * (0.3 / 0.7) ** 2
    assert bright[far].mean() < sent
    assert bright[far].max() < 2.0 * sent  # of few samples
    x = seen["across"]["object_coords"][..., 0]
    both = seen["across"]["radiance"][..., 0]
    assert abs(both[x > 0].mean() / both[x < 0].mean() - 1.0) < 0.02


def test_a_glowing_shape_lights_as_its_ellipsoid(fine):
    """Drawn by triangles here and by the cone about a ball there, and met by chance in both."""
    mean, lamp = [], {"kind": "ellipsoid", "gm_km3_s2": 1e-9, "radii_km": 0.5, "albedo": 0.0}
    lamp["emission_w_m2_sr"] = [100.0, 60.0, 20.0]
    lamp["orbit"] = {"around": "rock", "position_km": [1.9, -1.2, 0.3]}
    for keys in ({}, {"shape": {"file": fine, "metres_per_unit": 500.0}}):
        tree = scene({}, (0.0, -3000.0, 0.0))
        tree["sun"]["irradiance_w_m2"] = 0.0
        tree["bodies"]["lamp"] = {**lamp, **keys}
        tree["render"].update(samples=64, max_bounces=1, tolerance_dn=0.0)
        sample = frame(tree)
        mean.append(sample["radiance"][sample["instance"] == 1].mean(axis=0))
    assert mean[0].min() > 0.01
    assert np.allclose(mean[1], mean[0], rtol=0.02)


@pytest.mark.parametrize("sun", [[1.0, 0.05, 0.3], [0.3, -1.0, 0.7], [0.7, 0.7, -0.2]])
def test_a_coarse_ball_has_no_teeth(tmp_path, sun):
    """A convex body does not shade itself: with shadows and without it is the same, although facets
    beyond the terminator of the smooth normals stand before their neighbours."""
    path = str(write_obj(tmp_path / "ball.obj", *ball(8)))
    tree = scene({"shape": path}, (0.0, -3000.0, 0.0), sun=sun, render={"max_bounces": 0})
    tree["render"]["force_off"] = ["soft_sun", "limb_darkening"]
    shaded = frame(tree)["radiance"]
    tree["render"]["force_off"] += ["cast_shadows"]
    bare = frame(tree)["radiance"]
    assert (bare[..., 0] > 1.0).sum() > 100
    assert np.abs(shaded - bare).max() <= 1e-3 * bare.max()
    # As many as there are: the smooth terminator goes through facets that are turned away.
    tree["bodies"]["rock"]["shape"] = {"file": path, "smooth": False}
    flat = frame(tree)["radiance"]
    assert ((flat[..., 0] == 0.0) & (bare[..., 0] > 0.0)).sum() > 5


@pytest.mark.parametrize("seed", [1, 2])
def test_a_coarse_waist_has_no_dark_facets(tmp_path, seed):
    """A body of revolution with the Sun over its equator: no point shades another, however thin the
    waist, as both would be on one disc across the axis. Of uneven facets many turn away where the
    smooth normals do not, in hollows too: what they lose was 8 to 12 in ten thousand."""
    vertices, faces = ball(12)
    vertices += np.random.default_rng(seed).normal(0.0, 0.03, vertices.shape)
    vertices /= np.linalg.norm(vertices, axis=1)[:, None]
    vertices[:, :2] *= 0.35 + 0.65 * vertices[:, 2:] ** 2
    path = str(write_obj(tmp_path / "waist.obj", vertices, faces))
    tree = scene({"shape": path}, (0.0, -3000.0, 0.0), sun=[1.0, -0.4, 0.0])
    tree["render"].update(max_bounces=0, force_off=["soft_sun", "limb_darkening"])
    shaded = frame(tree)["radiance"]
    tree["render"]["force_off"].append("cast_shadows")
    bare = frame(tree)["radiance"]
    assert (bare[..., 0] > 1.0).sum() > 500
    assert (bare - shaded).sum() < 5e-5 * bare.sum()


# --- sizes --------------------------------------------------------------------------------------


@pytest.mark.parametrize("radius_m", [1.0, 1e3, 1e8])
@pytest.mark.parametrize("radii", [1.5, 3.0])
def test_any_size_looks_the_same(fine, radius_m, radii):
    """From 1 m to 1e8 m: the same picture, to the rounding of single precision."""
    body = {"radii_km": radius_m / 1e3, "gm_km3_s2": 1e-9}
    shape = {"file": fine, "metres_per_unit": radius_m}
    direction = np.array([2.6, -1.9, 0.9]) / math.hypot(2.6, 1.9, 0.9)
    mesh = frame(scene({**body, "shape": shape}, tuple(radii * radius_m * direction), 60.0))
    smooth = frame(scene(body, tuple(radii * radius_m * direction), 60.0))
    inside = lit(mesh, smooth)
    assert inside.sum() > 500
    assert np.abs(mesh["range"][inside] / smooth["range"][inside] - 1.0).max() < 2e-3
    day = inside & (smooth["radiance"][..., 1] > 5.0)
    assert abs((mesh["radiance"][day] / smooth["radiance"][day]).mean() - 1.0) < 3e-3


@pytest.mark.parametrize("distance_m", [6e5, 1e6, 1e7])
def test_a_dot_keeps_its_light(fine, distance_m):
    """Of a Lambert sphere far away (Russell 1916): 2/3 A E (R/d)^2 times the phase law; 1 % for the
    lattice of samples and the facets."""
    tree = scene({"shape": fine}, (0.0, -distance_m, 0.0), 3.0, sun=[0.6, -0.8, 0.0])
    sample = frame(tree)
    x = (np.arange(48) - 23.5) / sample.camera.K[0, 0]
    solid = (1.0 + x[:, None] ** 2 + x**2) ** -1.5 / sample.camera.K[0, 0] ** 2
    flux = (sample["radiance"][..., 0] * solid).sum()
    phase = math.acos(0.8)
    law = (math.sin(phase) + (math.pi - phase) * math.cos(phase)) / math.pi
    expected = 2.0 / 3.0 * 0.3 * 1361.0 * (1e3 / distance_m) ** 2 * law
    assert flux == pytest.approx(expected, rel=0.01)


# --- where the surface is -----------------------------------------------------------------------


def test_distances_against_the_sphere(fine):
    shape = shapes.load("ball", Shape(file=fine), Path(fine))
    rng = np.random.default_rng(9)
    assert shape.radius_m == pytest.approx(1000.0, abs=1e-3)
    for _ in range(30):
        point = rng.normal(size=3) * 1200.0
        r = float(np.linalg.norm(point))
        direction = rng.normal(size=3)
        direction /= np.linalg.norm(direction)
        assert shape.holds(point) == (r < 1000.0) or abs(r - 1000.0) < 0.7
        assert shape.distance_m(point) == pytest.approx(abs(r - 1000.0), abs=0.7)
        along = float(point @ direction)
        root = along**2 - r**2 + 1e6
        hit = shape.hit_m(point, direction)
        ways = [] if root < 0 else [t for t in (-along - root**0.5, -along + root**0.5) if t >= 0]
        if root > 1e4 or root < -1e4:
            assert (hit is None) == (not ways)
        if hit is not None and root > 1e4:
            assert hit == pytest.approx(ways[0], abs=2.0)


def test_hover_counts_from_the_shape(tmp_path):
    """Over a ball half as large as its ellipsoid, and 10 m of clearance that it has."""
    path = str(write_obj(tmp_path / "ball.obj", 0.5 * ball(60)[0], ball(60)[1]))
    tree = scene({"shape": path}, (0, 0, 0))
    tree["camera"]["trajectory"] = {
        "kind": "hover",
        "target": "rock",
        "lon_deg": 40.0,
        "lat_deg": -20.0,
        "height_m": 25.0,
        "clearance_m": 10.0,
    }
    sample = frame(tree)
    assert np.median(sample["range"]) == pytest.approx(25.0, rel=0.1)


def test_a_camera_inside_is_refused(tmp_path):
    path = str(write_obj(tmp_path / "ball.obj", *ball(12)))
    with pytest.raises(ValueError, match="inside rock"):
        frame(scene({"shape": path}, (100.0, 200.0, 300.0)))
    tree = scene({"shape": path}, (0, 0, 0))
    pose = np.array([100.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
    with pytest.raises(ValueError, match="inside rock"):
        frame(tree, trajectory=lambda _: pose)


# --- files --------------------------------------------------------------------------------------

TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
ZERO_BASED = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 0 2 1\nf 0 1 3\nf 1 2 3\nf 0 3 2\n"
BACKWARDS = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf -4 -2 -3\nf -4 -3 -1\nf -3 -2 -1\nf -4 -1 -2\n"
TABLE = "4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n4\n1 1 3 2\n2 1 2 4\n3 2 3 4\n4 1 4 3\n"
QUADS = (
    "o pyramid\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nv 0 0 1\nf 4/4/4 3//3 2/2 1\n"
    "f 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n"
)


@pytest.mark.parametrize(
    ("suffix", "text", "volume"),
    [
        ("obj", TETRAHEDRON, 1 / 6),
        ("tab", ZERO_BASED, 1 / 6),
        ("obj", BACKWARDS, 1 / 6),
        ("tab", TABLE, 1 / 6),
        ("obj", QUADS, 4 / 3),
        ("obj", TETRAHEDRON.replace("f 1 3 2", "f 1 2 3"), None),
    ],
    ids=["obj", "from 0", "backwards", "table", "polygons", "one face turned"],
)
def test_ways_of_writing(tmp_path, suffix, text, volume):
    path = tmp_path / f"rock.{suffix}"
    path.write_text(text)
    if volume is None:
        with pytest.raises(ValueError, match=r"rock.obj: .*run through twice"):
            shape_files.read(path)
        return
    vertices, triangles = shape_files.read(path)
    a, b, c = vertices[triangles].transpose(1, 0, 2)
    assert np.einsum("ij,ij->", a, np.cross(b, c)) / 6 == pytest.approx(volume)


def test_inside_out_is_turned(tmp_path):
    vertices, faces = ball(10)
    path = write_obj(tmp_path / "ball.obj", vertices, faces[:, ::-1])
    vertices, faces = shape_files.read(path)
    a, b, c = vertices[faces].transpose(1, 0, 2)
    assert np.einsum("ij,ij->", a, np.cross(b, c)) / 6 == pytest.approx(4.1, abs=0.1)


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("a.obj", "", "has no faces"),
        ("a.obj", "v 0 0 0\nv 1 0\nf 1 2 3\n", "line 2: neither"),
        ("a.obj", "v 0 0 0\nv 1 0 x\n", "line 2: neither"),
        ("a.obj", "v 0 0 0\nfacet 1\n", "line 2: neither"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "line 4: there is no vertex 4 of 3"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -9\n", "line 4: there is no vertex"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n", "line 4: neither"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "not closed: 3 edges"),
        ("a.obj", TETRAHEDRON.replace("v 1 0 0", "v nan 0 0"), "vertex 2 is not finite"),
        ("a.obj", TETRAHEDRON.replace("v 1 0 0", "v 1e999 0 0"), "vertex 2 is not finite"),
        ("a.obj", "v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n", "has no extent"),
        ("a.tab", TABLE.replace("4\n1 0 0 0", "5\n1 0 0 0", 1), "vertices are not numbered"),
        ("a.tab", "9 1 2", "a count of vertices"),
        ("a.tab", TABLE[:-9], "a count of plates"),
        ("a.tab", TABLE.replace("\n2 1 0 0", "\n7 1 0 0"), "not numbered"),
        ("a.tab", TABLE.replace("1 1 3 2", "1 1 3.5 2"), "whole numbers"),
        ("a.tab", TABLE.replace("1 1 3 2", "1 1 9 2"), "vertices 1 to 4"),
        ("a.tab", TABLE.replace("1 1 3 2", "1 1 x 2"), "number"),
        ("a.glb", "glTF?", ""),
        ("a.stl", "solid", "allowed: .obj, .tab"),
    ],
)
def test_broken_files_are_refused_by_name(tmp_path, name, text, said):
    path = tmp_path / name
    path.write_text(text)
    with pytest.raises(ConfigError, match=name) as error:
        frame(scene({"shape": str(path)}, (5e3, 0, 0)))
    assert "bodies.rock.shape.file" in str(error.value)
    assert said in str(error.value)


def test_the_configuration(tmp_path):
    with pytest.raises(ConfigError, match=r"shape\.metres_per_unit"):
        perilune.open(scene({"shape": {"file": "a.obj", "metres_per_unit": 0}}, (5e3, 0, 0)))
    with pytest.raises(ConfigError, match="metres_per_unit"):
        perilune.open(scene({"shape": {"file": "a.obj", "metres_per_uint": 1}}, (5e3, 0, 0)))
    air = {"shape": "a.obj", "atmosphere": {"preset": "mars"}}
    with pytest.raises(ConfigError, match="a body with a shape has none"):
        perilune.open(scene(air, (5e3, 0, 0)))
    clouds = {"shape": "a.obj", "clouds": {"altitude_km": 1.0, "noise": {}}}
    with pytest.raises(ConfigError, match=r"clouds.*a body with a shape has none"):
        perilune.open(scene(clouds, (5e3, 0, 0)))
    with pytest.raises((ConfigError, FileNotFoundError), match=r"nowhere\.obj"):
        frame(scene({"shape": str(tmp_path / "nowhere.obj")}, (5e3, 0, 0)))


@pytest.mark.parametrize("unit", [1e30, 1e-15])
def test_absurd_units_are_refused_by_name(fine, unit):
    tree = scene({"shape": {"file": fine, "metres_per_unit": unit}}, (2600.0, 0.0, 0.0))
    text = r"bodies\.\w+\.shape\.metres_per_unit: .*allowed: 1e-09 to 1e\+18 m"
    with pytest.raises(ConfigError, match=text):
        perilune.open(tree).world(0)


def test_the_core_refuses(tmp_path):
    corners = np.zeros((3, 3), np.float32)
    with pytest.raises(ValueError, match="shape 'rock': triangle 0 has vertex 3 of 3"):
        _core.Model.of_mesh("rock", corners, np.array([[0, 1, 3]], np.uint32))
    with pytest.raises(ValueError, match="positions"):
        _core.Model.of_mesh("rock", corners[:, :2].copy(), np.array([[0, 1, 2]], np.uint32))


# --- published shapes ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("file", "triangles", "volume_km3", "rel"),
    [
        # Eros: Yeomans et al. 2000, 2503 km3; Itokawa: Fujiwara et al. 2006, 0.0184 km3;
        # Phobos: Thomas 1989, 5680 km3 (+-250); Castalia: Hudson and Ostro 1994, 0.667 km3
        # (diameter of a sphere as large 1.08 km).
        ("eros007790.tab", 7790, 2503.0, 0.015),
        ("itokawa_16.obj", 3072, 0.0184, 0.06),
        ("phobos.obj", 32040, 5680.0, 0.02),
        ("castalia.obj", 4092, math.pi / 6 * 1.08**3, 0.02),
        ("pds/4769castalia.tab", 4092, math.pi / 6 * 1.08**3, 0.02),
    ],
)
def test_published_shapes(data_dir, file, triangles, volume_km3, rel):
    vertices, faces = shape_files.read(data_dir / "small_bodies" / file)
    a, b, c = vertices[faces].transpose(1, 0, 2)
    assert np.einsum("ij,ij->", a, np.cross(b, c)) / 6 == pytest.approx(volume_km3, rel=rel)
    assert len(faces) == triangles


def test_stickney_is_where_it_is(data_dir):
    """The largest bowl of Phobos is Stickney, 9 km across at 1 N, 49.7 W (IAU Gazetteer): on a ring
    of its rim the ground is some hundred metres higher than in its middle."""
    shape = shapes.load(
        "phobos", Shape(file="phobos.obj"), data_dir / "small_bodies" / "phobos.obj"
    )

    def ground(lon_deg, lat_deg):
        lon, lat = math.radians(lon_deg), math.radians(lat_deg)
        d = np.array([math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat)])
        return shape.surface_m(d) * np.linalg.norm(d / np.array([13.0, 11.4, 9.1]))

    turns = np.linspace(0.0, 2.0 * math.pi, 12, endpoint=False)
    rim = np.mean([ground(-49.7 + 21 * math.cos(t), 1.0 + 21 * math.sin(t)) for t in turns])
    assert rim - ground(-49.7, 1.0) > 40.0  # m, over the radius in km of the ellipsoid there
