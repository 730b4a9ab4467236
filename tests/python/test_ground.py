"""Relief, glint and lights of the night: radiances by formulas, keys, errors, the same bits."""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import perilune
from perilune import _core
from perilune.config.errors import ConfigError
from perilune.document.loader import read_tree

sys.path.insert(0, str(Path(__file__).resolve().parent))
import air_worlds
import ground_worlds
from ground_worlds import globe, numbers, points, saved, seen

RADIUS = 1e6
SOLAR = air_worlds.SOLAR
MAP = Path(__file__).resolve().parents[2] / "assets/maps/earth_like.jpg"
SCENE = Path(__file__).parent / "scene.yaml"


def glint(normal: Any, view: Any, sun: Any, wind_m_s: float) -> Any:
    """Radiance over irradiance by Cox and Munk (1954), with Fresnel's equations in angles and
    without shadowing."""
    half = view + sun
    half = half / np.linalg.norm(half, axis=-1, keepdims=True)
    into = np.arccos(np.clip(np.sum(half * view, axis=-1), -1.0, 1.0))
    out = np.arcsin(np.sin(into) / 1.34)
    across = (np.sin(into - out) / np.sin(into + out)) ** 2
    along = (np.tan(into - out) / np.tan(into + out)) ** 2
    cosine = np.sum(half * normal, axis=-1)
    variance = 0.003 + 0.00512 * wind_m_s
    slopes = np.exp(-(1.0 / cosine**2 - 1.0) / variance) / (math.pi * variance)
    mu = np.sum(normal * view, axis=-1)
    return 0.5 * (across + along) * slopes / (4.0 * mu * cosine**4)


@pytest.mark.parametrize("wind_m_s", [1.0, 7.0, 14.0])
@pytest.mark.parametrize("tolerance_dn", [0.0, 1.0])
def test_glint_is_that_of_cox_and_munk(wind_m_s: float, tolerance_dn: float) -> None:
    """Black water, from 400 km: sampled in full, and shaded by one value a pixel."""
    # The sun is mirrored beside the point that the view's middle meets.
    camera, toward_ground = np.array([RADIUS + 4e5, 0.0, 0.0]), np.array([-1.0, 0.5, 0.2])
    view = toward_ground / np.linalg.norm(toward_ground)
    along = -camera @ view
    meets = camera + (along - math.sqrt(along**2 - camera @ camera + RADIUS**2)) * view
    sun = view - 2.0 * (view @ meets) * meets / RADIUS**2 + np.array([0.02, 0.03, -0.04])
    asked, frame = seen(
        globe({"ocean": True}), numbers(wind_m_s=wind_m_s), [[RADIUS] * 3], camera,
        toward_ground, sun, size=(16, 12), fov_deg=6.0, white=1000.0, tolerance_dn=tolerance_dn,
        samples=16, force_off=("soft_sun",),
    )  # fmt: skip
    normal, hit = points(asked, frame)
    toward = sun / np.linalg.norm(sun)
    expected = SOLAR * glint(normal, -air_worlds.directions(asked), toward, wind_m_s)
    assert hit.all()
    assert expected.max() > 1.0
    # Within a pixel the glint bends, and a wave hides another: less than 1 % of its brightest.
    off = np.abs(frame["radiance"] - expected[..., None])
    assert off.max() < 0.01 * expected.max()


def test_ground_and_water_share_a_mask(tmp_path: Path) -> None:
    """Where the mask is half, half of the water's light."""
    frames = []
    for part in (0.0, 0.5, 1.0):
        mask = _core.Map(saved(tmp_path, f"mask{part}", np.full((2, 4), part)), srgb=False)
        _, frame = seen(
            globe({"ocean": True, "water": mask}), numbers(water=0.2), [[RADIUS] * 3],
            [RADIUS + 4e5, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.9, 0.3, 0.1], size=(8, 6),
            albedo=0.2, tolerance_dn=0.0, samples=4,
        )  # fmt: skip
        frames.append(frame["radiance"])
    mean = frames[0] + (frames[2] - frames[0]) * 128 / 255
    np.testing.assert_allclose(frames[1], mean, rtol=1e-4)
    assert frames[2].max() > 1.2 * frames[0].max()


def test_water_is_where_the_map_is_blue() -> None:
    """The same through a mask of one's own making."""
    texels = np.asarray(ground_worlds.Image.open(MAP).convert("RGB"))[::4] / 255.0
    linear = np.where(texels <= 0.04045, texels / 12.92, ((texels + 0.055) / 1.055) ** 2.4)
    red, blue = linear[..., 0], linear[..., 2]
    share = np.clip((blue - 1.5 * red) / np.maximum(red, 1e-6), 0.0, 1.0)
    assert _core.Map(str(MAP), water=True).mean[0] == pytest.approx(share.mean(), abs=2e-3)
    assert 0.3 < share.mean() < 0.6


@pytest.mark.parametrize(("east", "north"), [(0.2, 0.0), (0.0, 0.2), (-0.15, 0.1)])
@pytest.mark.parametrize("green", ["north", "south"])
def test_a_slope_turns_light_as_a_plane_does(
    tmp_path: Path, east: float, north: float, green: str
) -> None:
    """A normal map of one colour: ground that leans to one side at every place."""
    y = north if green == "north" else -north
    lean = np.array([east, y, math.sqrt(1.0 - east**2 - north**2)])
    codes = np.rint(255.0 * (0.5 + 0.5 * lean)) / 255.0
    normals = _core.Map(saved(tmp_path, "lean", np.full((4, 8, 3), codes)), srgb=False)
    sun = np.array([0.8, 0.4, 0.45])
    asked, frame = seen(
        globe({"normals": normals, "south": green == "south"}), numbers(steepness=0.5),
        [[RADIUS] * 3], [RADIUS + 3e5, 0.0, 1e5], [-1.0, 0.0, -0.1], sun, size=(12, 9),
        albedo=0.3, tolerance_dn=0.0, samples=4, fov_deg=40.0, force_off=("soft_sun",),
    )  # fmt: skip
    up, hit = points(asked, frame)
    eastward = np.cross([0.0, 0.0, 1.0], up)
    eastward /= np.linalg.norm(eastward, axis=-1, keepdims=True)
    x, y, z = 2.0 * codes - 1.0
    y *= 1.0 if green == "north" else -1.0
    normal = up + 0.5 * (x * eastward + y * np.cross(up, eastward)) / z
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    expected = 0.3 / math.pi * SOLAR * (normal @ (sun / np.linalg.norm(sun)))
    assert hit.all()
    np.testing.assert_allclose(frame["radiance"], expected[..., None].repeat(3, -1), rtol=2e-3)


@pytest.mark.parametrize("sun", [(0.8, 0.5, 0.3), (0.35, 0.9, 0.3)])
def test_analytic_ground_is_as_sampled_ground(sun: tuple[float, float, float]) -> None:
    """A globe with relief and sea by day: one value a pixel, and 256 samples, which a lens that is
    in focus everywhere asks for."""
    ground: _core.Ground = {
        "heights": _core.Map(str(MAP), srgb=False),
        "ocean": True,
        "water": _core.Map(str(MAP), water=True),
    }
    world = globe(ground, center_lon_rad=0.19, map_path=str(MAP))
    asked = air_worlds.request(
        [[6.4e6] * 3], [1e7, 0.0, 0.0], [-1.0, 0.0, 0.0], sun, size=(48, 36), fov_deg=10.0,
        albedo=0.8, tolerance_dn=1e-3, samples=256, force_off=("soft_sun",),
    )  # fmt: skip
    asked["body_ground"] = numbers(height_m=2e4, water=0.02)
    analytic = air_worlds.render(world, asked)["rgb"].astype(float)
    asked["focus"] = (1e-7, math.inf)
    asked["quality"]["force_on"] = ["depth_of_field"]
    sampled = air_worlds.render(world, asked)["rgb"].astype(float)
    assert sampled.std() > 7.0
    assert 0.0 < np.mean(np.abs(analytic - sampled)) < 1.0
    # At coasts land and water of a texel are told apart by the mask's mean.
    assert abs(np.mean(analytic - sampled)) < 0.3


@pytest.mark.parametrize("elevation_deg", [20.0, 1.0, -1.0, -3.0, -5.0, -6.5, -40.0])
def test_lights_come_on_in_twilight(tmp_path: Path, elevation_deg: float) -> None:
    lights = _core.Map(saved(tmp_path, "white", np.ones((1, 1))))
    sun = [math.sin(math.radians(elevation_deg)), math.cos(math.radians(elevation_deg)), 0.0]
    _, frame = seen(
        globe({"lights": lights}), numbers(lights=0.02), [[RADIUS] * 3], [RADIUS + 1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0], sun, size=(3, 3), fov_deg=5.0, albedo=0.0, white=0.05,
    )  # fmt: skip
    x = min(max(math.sin(math.radians(-elevation_deg)) / math.sin(math.radians(6.0)), 0.0), 1.0)
    expected = 0.02 * x * x * (3.0 - 2.0 * x)
    np.testing.assert_allclose(frame["radiance"], expected, rtol=1e-3, atol=1e-7)


@pytest.mark.parametrize("row", ["night_lights", "emitted_light"])
def test_lights_go_out_with_their_rows(tmp_path: Path, row: str) -> None:
    lights = _core.Map(saved(tmp_path, "white", np.ones((1, 1))))
    _, frame = seen(
        globe({"lights": lights}), numbers(lights=0.02), [[RADIUS] * 3], [RADIUS + 1e5, 0.0, 0.0],
        [-1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], size=(3, 3), white=0.05, force_off=(row,),
    )  # fmt: skip
    assert frame["radiance"].max() == 0.0


def town_view(towns_m: float, height_m: float, threads: int = 1) -> Any:
    """Radiance straight down on a globe that is white by night."""
    _, frame = seen(
        globe({"lights": _core.Map(str(MAP))}), numbers(lights=0.02, towns_m=towns_m),
        [[RADIUS] * 3], [RADIUS + height_m, 0.0, 0.0], [-1.0, 0.0, 0.0], [-1.0, 0.0, 0.0],
        size=(96, 96), fov_deg=10.0, albedo=0.0, white=0.05, threads=threads,
    )  # fmt: skip
    return frame["radiance"].astype(float)


@pytest.mark.parametrize("towns_m", [1e4, math.nan])
def test_lights_have_towns_below_a_texel(towns_m: float) -> None:
    """A texel of the map is 12 km, a pixel 0.2 km: between pixels a texel hardly changes."""
    plain, towns = town_view(0.0, 1e5), town_view(towns_m, 1e5)
    steps = [np.abs(np.diff(a[..., 0], axis=1)).mean() / a[..., 0].mean() for a in (plain, towns)]
    assert steps[0] < 0.05
    assert steps[1] > 0.15
    assert np.median(towns) < 0.5 * towns.mean()
    assert np.array_equal(towns, town_view(towns_m, 1e5, threads=3))


def test_towns_keep_the_light_of_far_views() -> None:
    """Pixels of 5 km: where they hide the towns, the same bits as of the map; where they show them,
    the light of 500 km is within 1 % of the map's."""
    plain, towns = town_view(0.0, 3e6), town_view(1.5e3, 3e6)
    assert np.array_equal(plain, towns)
    plain, towns = town_view(0.0, 3e6), town_view(5e3, 3e6)
    assert not np.array_equal(plain, towns)
    assert towns.mean() == pytest.approx(plain.mean(), rel=0.01)


def test_black_takes_dim_ground_from_lights(tmp_path: Path) -> None:
    """Linear 0.02 of the map is dark, white stays white, between them it is a line."""
    encoded = np.array([[0.01, 0.02, 0.3, 1.0]])
    path = saved(tmp_path, "dim", np.where(encoded < 0.0031308, 12.92 * encoded,
                                          1.055 * encoded ** (1 / 2.4) - 0.055))  # fmt: skip
    expected = np.mean([0.0, 0.0, 0.28 / 0.98, 1.0])
    assert _core.Map(path, black=0.02).mean[0] == pytest.approx(expected, abs=2e-3)
    with pytest.raises(ValueError, match="black"):
        _core.Map(path, black=1.0)


def test_dim_ground_is_found(tmp_path: Path) -> None:
    """A map of dark blue with a town of a fiftieth of its area: the ground is black, the town warm.
    Of one that is lit all over, no more than 0.02 is taken."""
    texels = np.full((50, 50, 3), (4, 6, 21), np.uint8)
    texels[25] = (120, 90, 60)
    before, after = (_core.Map(texels, black=black).mean[:3] for black in (0.0, None))
    town = _core.Map(texels[25:26], black=0.0).mean[:3] / 50.0
    assert np.all(after < 1.001 * town)
    assert np.all(after > 0.8 * (town - 0.02 / 50.0))
    assert before[2] > 2.0 * after[2]
    lit = np.full((8, 8, 3), 128, np.uint8)
    plain, dimmed = (_core.Map(lit, black=black).mean[0] for black in (0.0, None))
    assert dimmed == pytest.approx((plain - 0.02) / 0.98, abs=4e-3)


def test_deep_night_is_dark(data_dir: Path) -> None:
    """An ocean by night under automatic exposure: it was a blue day, of 102, 118 and 179 DN."""
    night = {"map": str(data_dir / "planets/solarsystemscope/2k_earth_nightmap.jpg")}
    tree = read_tree(SCENE)
    tree["spacecraft"] = {}
    tree["bodies"] = {"earth": {"kind": "earth", "albedo": 0.3, "night_lights": night}}
    tree["sun"] = {"direction": [1.0, 0.0, 0.0]}
    tree["camera"] |= {"exposure": {"mode": "auto"}, "trajectory": {
        "kind": "orbit_object", "target": "earth", "distance_m": 7e6,
        "sun_angle_deg": [160.0, 179.0],
    }}  # fmt: skip
    frames = {}
    for black in (0.0, None):
        for least in (0.0, 1e-4):
            tree["bodies"]["earth"]["night_lights"]["black"] = black
            tree["camera"]["exposure"]["min_white_radiance_w_m2_sr"] = least
            sample = perilune.open(tree).frame(0, ["rgb"])
            frames[black, least] = np.median(sample["rgb"].reshape(-1, 3), axis=0)
            assert sample.meta["white_radiance"] >= least
    assert frames[None, 1e-4].max() <= 2
    assert frames[None, 0.0].max() <= 2


EARTH: dict[str, Any] = {
    "bodies.earth.color_map": str(MAP),
    "bodies.earth.ocean": {"wind_m_s": 5.0},
    "bodies.earth.relief": {"height_map": str(MAP), "height_m": 3e4},
    "bodies.earth.night_lights": {"map": str(MAP), "black": 0.1},
}


def test_ground_by_configuration() -> None:
    sim = perilune.open(SCENE, overrides=EARTH)
    plan = {row["name"]: row for row in sim.plan(0)}
    assert {plan[name]["value"] for name in ("relief", "glint")} == {1}
    assert plan["night_lights"]["value"] == 0
    assert plan["night_lights"]["bound_dn"] > 0.0
    with_all = sim.frame(0, channels=["rgb"], threads=1)["rgb"]
    again = sim.frame(0, channels=["rgb"], threads=3)["rgb"]
    plain = perilune.open(SCENE, overrides={"bodies.earth.color_map": str(MAP)})
    assert np.array_equal(with_all, again)
    assert not np.array_equal(with_all, plain.frame(0, channels=["rgb"])["rgb"])
    bare = {row["name"]: row["reason"] for row in plain.plan(0)}
    for name in ("relief", "glint", "night_lights"):
        assert "no body" in bare[name]


def test_wind_may_be_driven() -> None:
    wind = {"uniform": [0.5, 30.0]}
    sim = perilune.open(SCENE, overrides={**EARTH, "bodies.earth.ocean": {"wind_m_s": wind}})
    drawn = {sim.world(index).config.bodies["earth"].ocean.wind_m_s for index in range(3)}
    assert len(drawn) > 1


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("relief", {}, "height_map: give height_map, normal_map or both"),
        ("relief", {"height_map": "a.png"}, "relief.height_m: height_map needs height_m (white"),
        (
            "relief",
            {"height_map": "a.png", "height_m": 1.0, "height_unit_m": 1.0},
            "relief: give only one of height_m, height_unit_m",
        ),
        ("relief", {"normal_map": "a.png", "height_m": 1.0}, "height_m: does nothing without"),
        ("relief", {"normal_map": "a.png", "height_unit_m": 1.0}, "height_unit_m: does nothing"),
        ("relief", {"normal_map": "a.png", "normal_gren": "south"}, "normal_green"),
        ("relief", {"normal_map": "missing.png"}, "bodies.earth.relief.normal_map"),
        ("ocean", {"wind_m_s": -1.0}, "bodies.earth.ocean.wind_m_s"),
        ("ocean", {"albedo": 1.5}, "bodies.earth.ocean.albedo"),
        ("ocean", {}, "bodies.earth.ocean.map: required without a color_map"),
        ("night_lights", {}, "bodies.earth.night_lights.map"),
        ("night_lights", {"map": "a.png", "black": 1.0}, "bodies.earth.night_lights.black"),
    ],
)
def test_errors_name_the_key(key: str, value: dict[str, Any], said: str) -> None:
    with pytest.raises((ConfigError, OSError, ValueError)) as error:
        perilune.open(SCENE, overrides={f"bodies.earth.{key}": value}).frame(0)
    assert said in str(error.value)


def test_no_sea_on_the_moon_of_hapke_and_no_ground_with_a_graph() -> None:
    with pytest.raises(ConfigError, match=r"earth\.ocean: only with reflectance: lambert"):
        perilune.open(SCENE, overrides={**EARTH, "bodies.earth.reflectance": "hapke"})
    graph = {"materials": {"m": {"nodes": {"skin": {"type": "lambert"}}}}}
    with pytest.raises(ConfigError, match=r"earth\.relief: not for a body with a material"):
        perilune.open(SCENE, overrides={**EARTH, **graph, "bodies.earth.material": "m"})
