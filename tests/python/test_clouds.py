"""Clouds: the light of a layer, pictures against brute force, maps and noise, keys and drivers."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given as hypothesis_given, settings as hypothesis_settings, strategies as st
from pydantic import ValidationError

import perilune
from perilune import Simulation, _core, document as cfg
from perilune.bodies import atmospheres, clouds
from perilune.config.atmosphere import Atmosphere
from perilune.config.clouds import CloudNoise, Clouds

sys.path.insert(0, str(Path(__file__).resolve().parent))
import air_worlds
import cloud_worlds

EARTH_M = 6371e3
SOLAR = air_worlds.SOLAR


@pytest.mark.parametrize("depth", [0.5, 3.0, 15.0, 60.0])
@pytest.mark.parametrize("mu", [1.0, 0.5, 0.2])
def test_albedo_of_a_layer_is_that_of_photons(depth: float, mu: float) -> None:
    """The delta-Eddington approximation against a Monte Carlo that knows no streams."""
    back, straight = cloud_worlds.photons(depth, mu, 20000, 3)
    assert cloud_worlds.reflected(depth, mu) == pytest.approx(back, abs=0.05 if mu > 0.3 else 0.09)
    assert math.exp(-depth / mu) == pytest.approx(straight, abs=0.01)


def wavy(count: int = 512) -> np.ndarray:
    """A cover that changes slowly."""
    lat = np.linspace(90.0, -90.0, count + 1)[:-1, None] - 90.0 / count
    lon = np.linspace(-180.0, 180.0, 2 * count + 1)[None, :-1] + 90.0 / count
    waves = np.cos(np.radians(3.0 * lon + 20.0)) * np.cos(np.radians(2.0 * lat))
    return np.asarray(0.5 + 0.45 * waves)


def cover_of(points: np.ndarray, turn_deg: float) -> np.ndarray:
    """The same at points."""
    unit = points / np.linalg.norm(points, axis=-1, keepdims=True)
    lon = np.degrees(np.arctan2(unit[..., 1], unit[..., 0])) - turn_deg
    lat = np.degrees(np.arcsin(unit[..., 2]))
    waves = np.cos(np.radians(3.0 * lon + 20.0)) * np.cos(np.radians(2.0 * lat))
    return np.asarray(0.5 + 0.45 * waves)


def expected(asked, given: Clouds, turn_deg: float) -> np.ndarray:
    """By hand on a sphere: (H, W), nan beside it; albedo 0.3."""
    d = air_worlds.directions(asked)
    camera = asked["camera_pose"][0, :3]
    sun = asked["sun_position"] / np.linalg.norm(asked["sun_position"])
    shell_m, bent = EARTH_M + 1e3 * given.altitude_km, 0.0
    bent = 2e3 * given.thickness_km / shell_m

    def through(at: np.ndarray, way: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        normal = at / np.linalg.norm(at, axis=-1, keepdims=True)
        height = (normal * way).sum(axis=-1)
        mu = np.minimum(1.0, np.sqrt(height**2 + bent))
        cover = given.opacity * cover_of(at, turn_deg)
        part = cloud_worlds.reflected(given.optical_depth, mu)
        return 1.0 - cover * part, cover * part, height

    top = camera + cloud_worlds.hit(camera, d, shell_m)[..., None] * d
    ground = camera + cloud_worlds.hit(camera, d, EARTH_M)[..., None] * d
    seen, _, _ = through(top, d)
    _, sent, height = through(top, np.broadcast_to(sun, d.shape))
    light = np.maximum(height, 0.0) * sent / math.pi
    sunward = np.broadcast_to(sun, d.shape)
    above = ground + cloud_worlds.hit(ground, sunward, shell_m, far=True)[..., None] * sunward
    lit, _, _ = through(above, sunward)
    cosine = np.maximum(0.0, (ground / EARTH_M * sun).sum(axis=-1))
    return np.asarray(SOLAR * (light + seen * lit * 0.3 * cosine / math.pi))


@pytest.mark.parametrize("sun", [(1.0, 0.2, 0.3), (1.0, 1.5, 0.3), (1.0, -1.8, -0.9)])
@pytest.mark.parametrize("altitude_km", [8.0, 300.0])
def test_picture_is_that_of_brute_force(tmp_path, sun, altitude_km: float) -> None:
    """Clouds, the ground through them and their shadows on it, at their own longitude. High clouds'
    shadows are far from them, and move with the sun."""
    path = cloud_worlds.write_map(tmp_path / "cover.png", wavy())
    given = Clouds(map=path, altitude_km=altitude_km, longitude_deg=30.0, rotation_deg_h=0.5)
    asked = air_worlds.request(
        [[EARTH_M] * 3], [4.0 * EARTH_M, 0, 0], [-1, 0, 0], sun, fov_deg=24.0, tolerance_dn=0.0,
        force_off=["soft_sun"], samples=4,
    )  # fmt: skip
    found = cloud_worlds.render(given, asked, t_s=7200.0)["radiance"][..., 0]
    right = expected(asked, given, 31.0)
    # Not the limb, the terminator or the ground's edge behind the shell.
    middle = np.isfinite(right) & (right > 20.0)
    assert middle.sum() > 200
    off = np.abs(found - right)[middle] / right[middle]
    assert np.quantile(off, 0.95) < 0.01
    assert np.median(off) < 0.004


def test_light_is_never_more_than_what_comes_in() -> None:
    """A white ground under clouds of any depth: no more than a white ball."""
    for depth in (0.0, 1.0, 20.0, 1e5):
        for sun in ((1, 0, 0), (1, 1, 0)):
            asked = air_worlds.request(
                [[EARTH_M] * 3], [3.0 * EARTH_M, 0, 0], [-1, 0, 0], sun, albedo=1.0,
                tolerance_dn=0.0, samples=4, fov_deg=40.0, force_off=["soft_sun"],
            )  # fmt: skip
            picture = cloud_worlds.render(Clouds(optical_depth=depth), asked)["radiance"]
            white = cloud_worlds.render(None, asked)["radiance"]
            # The shell is larger than the ball by 2.5 parts in a thousand.
            assert picture.sum() <= white.sum() * 1.003
            assert picture.max() <= 1.001 * SOLAR / math.pi


def test_a_break_in_the_clouds_is_where_the_map_says(tmp_path) -> None:
    """Also across the date line and over both poles, which are no seams."""
    cover = np.ones((64, 128))
    cover[28:36, :2] = cover[28:36, -2:] = 0.0  # about longitude 180, the equator
    cover[:3] = cover[-3:] = 0.0
    given = Clouds(map=cloud_worlds.write_map(tmp_path / "hole.png", cover), optical_depth=500.0)
    for place in ((-1, 0, 0), (0.01, 0, 1), (0, 0.01, -1)):
        at = np.array(place) / np.linalg.norm(place)
        asked = air_worlds.request(
            [[EARTH_M] * 3], 1.5 * EARTH_M * at, -at, at, size=(33, 33), fov_deg=60.0,
            tolerance_dn=0.0, samples=4, albedo=0.05, up=(0.3, 1, 0.2),
        )  # fmt: skip
        picture = cloud_worlds.render(given, asked)["radiance"][..., 0]
        assert picture[16, 16] < 0.25 * picture[0, 0]
        # No step within the hole or the clouds about it.
        ring = picture[[0, 0, -1, -1, 0, -1], [0, -1, 0, -1, 16, 16]]
        assert ring.max() < 1.15 * ring.min()
        assert np.ptp(picture[15:18, 15:18]) < 0.05 * picture[0, 0]


@pytest.mark.parametrize(("fov_deg", "far"), [(50.0, 2.0), (0.6, 150.0)], ids=["near", "far"])
@hypothesis_settings(max_examples=6)
@hypothesis_given(
    coverage=st.floats(0.2, 0.8), size_km=st.floats(200.0, 800.0), seed=st.integers(0, 2**31)
)
def test_noise_covers_what_is_asked(
    fov_deg: float, far: float, coverage: float, size_km: float, seed: int
) -> None:
    """A black ground under clouds that send back a known part: the mean of 16 patterns."""
    asked = air_worlds.request(
        [[EARTH_M] * 3], [far * EARTH_M, 0, 0], [-1, 0, 0], [1, 0, 0], albedo=0.0,
        tolerance_dn=0.0, samples=4, size=(24, 24), fov_deg=fov_deg,
    )  # fmt: skip
    full = cloud_worlds.render(Clouds(), asked)["radiance"].sum()
    parts = []
    for pattern in range(16):
        noise = CloudNoise(coverage=coverage, size_km=size_km, seed=seed + pattern, softness=0.2)
        parts.append(cloud_worlds.render(Clouds(noise=noise), asked)["radiance"].sum() / full)
    error = float(np.std(parts, ddof=1)) / 4.0
    assert error < 0.012  # or the next line asks for little
    # Five standard errors, and 0.005 for noise that is not quite normally distributed.
    assert np.mean(parts) == pytest.approx(coverage, abs=5.0 * error + 0.005)


@pytest.mark.parametrize("mean", [0.1, 0.4, 0.9])
def test_uneven_clouds_are_as_bright_as_even_ones(mean: float, tmp_path) -> None:
    """Depths and slopes that vary change no mean, whether a pixel shows them or hides them."""
    path = cloud_worlds.write_map(tmp_path / "even.png", np.full((8, 16), mean))
    for fov_deg, away in ((60.0, 1.5), (30.0, 1.05)):
        asked = air_worlds.request(
            [[EARTH_M] * 3], [away * EARTH_M, 0, 0], [-1, 0, 0], [1, 0.6, 0], albedo=0.0,
            tolerance_dn=0.0, samples=4, size=(64, 48), fov_deg=fov_deg,
        )  # fmt: skip
        pictures = []
        for depth_spread, relief_km in ((0.0, 0.0), (0.7, 0.0), (0.0, 0.5), (0.7, 0.5)):
            noise = CloudNoise(
                size_km=20.0, softness=0.3, depth_spread=depth_spread, relief_km=relief_km
            )
            given = Clouds(map=path, noise=noise)
            pictures.append(cloud_worlds.render(given, asked)["radiance"][..., 0])
        for uneven in pictures[1:]:
            assert uneven.mean() == pytest.approx(pictures[0].mean(), rel=0.03)
    for uneven in pictures[1:]:  # and seen from near they are not the same
        assert np.abs(uneven - pictures[0]).mean() > 0.03 * pictures[0].mean()


def test_pixels_under_clouds_that_are_worked_out_at_once() -> None:
    """One lookup a pixel over the middle of a body, against sixty-four: the same mean, and what is
    off is what patterns as fine as a pixel are."""
    noise = CloudNoise(size_km=300.0, octaves=8.0, roughness=0.7, softness=0.5)
    sun = [1.0, 0.5, 0.3]
    air = _core.Air(atmospheres.settings(Atmosphere(preset="earth"), (0.61, 0.55, 0.46)), EARTH_M)
    pictures = []
    for samples, tolerance_dn in ((8, 1.0), (64, 0.0)):
        asked = air_worlds.request(
            [[EARTH_M] * 3], [1.3 * EARTH_M, 0, 0], [-1, 0, 0], sun, albedo=0.3,
            tolerance_dn=tolerance_dn, samples=samples, size=(48, 48), fov_deg=30.0,
        )  # fmt: skip
        pictures.append(cloud_worlds.render(Clouds(noise=noise), asked, air=air)["radiance"])
    quick, fine = (picture.astype(float) for picture in pictures)
    assert quick.mean() == pytest.approx(fine.mean(), rel=0.01)
    assert np.sqrt(np.mean((quick - fine) ** 2)) < 0.06 * fine.mean()


def test_noise_breaks_a_map_and_keeps_its_mean(tmp_path) -> None:
    path = cloud_worlds.write_map(tmp_path / "even.png", np.full((8, 16), 0.3))
    plain = Clouds(map=path)
    broken = Clouds(map=path, noise=CloudNoise(size_km=150.0, softness=0.1))
    asked = air_worlds.request(
        [[EARTH_M] * 3], [1.5 * EARTH_M, 0, 0], [-1, 0, 0], [1, 0.3, 0], albedo=0.0,
        tolerance_dn=0.0, samples=4, size=(64, 48), fov_deg=60.0,
    )  # fmt: skip
    smooth = cloud_worlds.render(plain, asked)["radiance"][..., 0]
    rough = cloud_worlds.render(broken, asked)["radiance"][..., 0]
    assert rough.mean() == pytest.approx(smooth.mean(), rel=0.06)
    assert rough.std() > 3.0 * smooth.std()
    mist = Clouds(map=path, noise=CloudNoise(size_km=150.0, softness=100.0))
    np.testing.assert_allclose(
        cloud_worlds.render(mist, asked)["radiance"][..., 0], smooth, rtol=0.05
    )


def test_pictures_of_fewer_samples_are_within_the_tolerance() -> None:
    """What spares samples knows of clouds."""
    given = Clouds(noise=CloudNoise(size_km=900.0))
    air = _core.Air(atmospheres.settings(Atmosphere(preset="earth"), (0.61, 0.55, 0.46)), EARTH_M)
    pictures = []
    for tolerance_dn, samples in ((1.0, 16), (0.0, 64)):
        asked = air_worlds.request(
            [[EARTH_M] * 3], [1.6 * EARTH_M, 0, 0], [-1, 0.2, 0], [0.7, 0.8, 0.2], size=(64, 48),
            tolerance_dn=tolerance_dn, samples=samples,
        )  # fmt: skip
        pictures.append(cloud_worlds.render(given, asked, air=air)["rgb"].astype(np.float64))
    off = np.abs(pictures[0] - pictures[1])
    assert np.quantile(off, 0.98) <= 5.0
    assert off.mean() < 1.0


def test_a_map_as_fine_as_pixels_has_its_mean_in_them(repo_dir: Path) -> None:
    """Pixels are shaded at once, with a mean of the map over each; but where a craft hides a part
    of one, the mean of the rest is asked for."""
    scene = {
        "camera.width": 20,
        "camera.height": 15,
        "camera.exposure": {"mode": "fixed", "white_radiance_w_m2_sr": 320.0},
        "bodies.planet.ocean": None,
        "bodies.planet.atmosphere": None,
        "bodies.planet.clouds.noise": None,
        "render.samples": 64,
    }
    channels = ["rgb", "coverage", "coverage_instance"]
    planned, exact = (
        perilune.open(
            repo_dir / "configs/demo.yaml", overrides={**scene, "render.tolerance_dn": tolerance}
        ).frame(0, channels, threads=1)
        for tolerance in (1.0, 0.0)
    )
    off = np.abs(planned["rgb"].astype(float) - exact["rgb"]).mean(axis=-1)
    share = np.where(exact["coverage_instance"] == 1, exact["coverage"], 0.0).sum(axis=-1)
    whole, part = off[share > 0.99], off[(share > 0.4) & (share <= 0.99)]
    assert len(whole) > 150
    assert np.sqrt(np.mean(whole**2)) < 2.2  # 3.4 with a wider filter of the map
    assert len(part) > 20
    assert part.max() < 6.0  # 14.7 with the mean of the whole pixel


def test_same_bits_for_any_threads() -> None:
    given = Clouds(noise=CloudNoise(warp=0.3))
    asked = air_worlds.request(
        [[EARTH_M] * 3], [1.1 * EARTH_M, 0, 0], [-0.5, 1, 0], [1, 1, 0], size=(96, 72)
    )
    one = cloud_worlds.render(given, asked, threads=1)
    three = cloud_worlds.render(given, asked, threads=3)
    assert all(np.array_equal(one[name], three[name]) for name in one)


def test_bodies_shade_clouds() -> None:
    """A moon's umbra and penumbra on an overcast, against the exact outline of an even disc."""
    far = EARTH_M + 3.8e8
    height_m, pictures = 8e3, []
    for moon in ([far, 0.0, 0.0], [-far, 0.0, 0.0]):
        asked = air_worlds.request(
            [[EARTH_M] * 3, [1737e3] * 3], [2.0 * EARTH_M, 0, 0], [-1, 0, 0], [1, 0, 0],
            centers_m=[[0, 0, 0], moon], size=(65, 3), fov_deg=30.0, tolerance_dn=0.0,
            albedo=0.0, samples=1,
        )  # fmt: skip
        pictures.append(cloud_worlds.render(Clouds(), asked)["radiance"][1, :, 1])
    d = air_worlds.directions(asked)[1]
    camera = asked["camera_pose"][0, :3]
    points = camera + cloud_worlds.hit(camera, d, EARTH_M + height_m)[:, None] * d
    count = len(points)
    pose = np.array([far, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
    left, _ = _core.sunlight(
        points, np.tile(asked["sun_position"], (count, 1)), asked["sun_radius"],
        np.tile(pose, (count, 1, 1)), np.array([[1737e3] * 3]), np.zeros(1),
    )  # fmt: skip
    assert left.min() < 0.05
    assert left.max() > 0.5
    np.testing.assert_allclose(pictures[0] / pictures[1], left[:, 0], atol=2e-3)


def test_skylight_comes_through_clouds() -> None:
    """The ground under an overcast that lets nothing through is dark, with air too."""
    air = _core.Air(atmospheres.settings(Atmosphere(preset="earth"), (0.61, 0.55, 0.46)), EARTH_M)
    asked = air_worlds.request(
        [[EARTH_M] * 3], [EARTH_M + 10.0, 0, 0], [-1, 0, 0], [1, 0.4, 0], size=(3, 3),
        fov_deg=1.0, tolerance_dn=0.0, samples=4, albedo=0.5, force_off=["soft_sun"],
    )  # fmt: skip
    bare = cloud_worlds.render(None, asked, air=air)["radiance"][1, 1]
    for depth in (5.0, 1e6):
        under = cloud_worlds.render(Clouds(optical_depth=depth), asked, air=air)["radiance"][1, 1]
        part = 1.0 - cloud_worlds.reflected(depth, 1.0 / math.hypot(1.0, 0.4))
        zenith = 1.0 - cloud_worlds.reflected(depth, 1.0)
        assert (under >= 0.999 * part * bare - 0.1).all()  # 0.1: air on the way to the camera
        assert (under <= 1.001 * zenith * bare + 0.1).all()


CONFIG = """
version: 1
seed: 3
time: {{epoch: 2026-03-20T12:00:00Z, step_s: 3600, frames_per_scene: 1}}
root: earth
bodies:
  earth:
    kind: earth
    clouds: {clouds}
spacecraft:
  sat:
    model: {model}
    size_m: 4.0
    orbit: {{around: earth, altitude_km: 700, inclination_deg: 20.0, mean_anomaly_deg: 0.0}}
camera:
  width: 48
  height: 36
  fov_deg: 60.0
  trajectory: {{kind: orbit_object, target: sat, distance_m: 20.0}}
"""


def simulation(tmp_path, root, text: str) -> Simulation:
    path = tmp_path / "clouds.yaml"
    path.write_text(CONFIG.format(clouds=text, model=root / "assets/models/smallsat.glb"))
    return Simulation(cfg.load(path))


def test_drivers_shape_clouds(tmp_path, request) -> None:
    """Figure 12 of the OAISYS paper: a driver changes the clouds from frame to frame."""
    text = "{noise: {coverage: {uniform: [0.2, 0.9]}, warp: {uniform: [0, 1]}}}"
    sim = simulation(tmp_path, request.config.rootpath, text)
    first, second = (clouds.rows(sim.config_at(i)[0], 0.0)[0] for i in (0, 1))
    assert first is not None
    assert second is not None
    assert first["coverage"] != second["coverage"]
    assert first["warp"] != second["warp"]
    assert not np.array_equal(sim[0]["rgb"], sim[1]["rgb"])


def test_shell_turns_with_time() -> None:
    given = Clouds(map="x.png", map_center_lon_deg=10.0, longitude_deg=20.0, rotation_deg_h=1.5)
    assert clouds.settings(given, 7200.0)["turn_rad"] == pytest.approx(math.radians(33.0))


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ({"altitude_km": 0.0}, "altitude_km"),
        ({"altitude_km": 1e13}, "altitude_km"),
        ({"thickness_km": 1e-12}, "thickness_km"),
        ({"optical_depth": 1e7}, "optical_depth"),
        ({"noise": {"size_km": 1e-12}}, "size_km"),
        ({"opacity": 1.5}, "opacity"),
        ({"noise": {"octaves": 17}}, "octaves"),
        ({"noise": {"cover": 0.3}}, "unknown key"),
    ],
)
def test_errors_name_the_key(entry, message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        Clouds.model_validate(entry)


@pytest.mark.parametrize("key", ["altitude_km", "thickness_km", "size_km", "optical_depth"])
@pytest.mark.parametrize("end", [1e-9, 1e12])
def test_the_core_takes_what_the_schema_takes(key: str, end: float) -> None:
    entry = {key: min(end, 1e6) if key == "optical_depth" else end}
    given = {"noise": entry} if key == "size_km" else entry
    asked = air_worlds.request([[EARTH_M] * 3], [2 * EARTH_M, 0, 0], [-1, 0, 0], [1, 0, 0])
    row = clouds.settings(Clouds.model_validate(given), 0.0)
    found = air_worlds.render(air_worlds.scene([None]), {**asked, "body_clouds": [row]})
    assert np.isfinite(found["radiance"]).all()


def test_the_core_refuses_what_is_not_a_number() -> None:
    asked = air_worlds.request([[EARTH_M] * 3], [2 * EARTH_M, 0, 0], [-1, 0, 0], [1, 0, 0])
    row = clouds.settings(Clouds(), 0.0)
    scene = air_worlds.scene([None])
    with pytest.raises(ValueError, match="clouds out of range"):
        air_worlds.render(scene, {**asked, "body_clouds": [{**row, "depth": math.nan}]})
    with pytest.raises(ValueError, match="2 entries for 1 bodies"):
        air_worlds.render(scene, {**asked, "body_clouds": [None, None]})
