"""Photometric laws of bodies: the Moon against the ROLO model, keys, maps, drivers, errors."""

from __future__ import annotations

import math
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.python import moon

import perilune
from perilune import _core
from perilune.bodies import geotiff, photometry
from perilune.config.errors import ConfigError

# Kieffer and Stone, AJ 129, 2887, 2005, table 4: coefficients a, b and d at two wavelengths, and p.
ROLO = {
    553.8: (
        (-2.12504, -1.65970, 0.38409, -0.20655),
        (0.04052, 0.01009, -0.00388),
        (0.37206, -0.10745, 0.00347),
    ),
    665.1: (
        (-1.88914, -1.58096, 0.30477, -0.17908),
        (0.04415, 0.00983, -0.00389),
        (0.37141, -0.13514, 0.01248),
    ),
}
ROLO_P = (4.06054, 12.8802, -30.5858, 16.7498)


def rolo(wavelength_nm: float, sun_deg: float) -> float:
    """Disc reflectance as seen from above (0, 0) with the Sun at a longitude (equation 10)."""
    a, b, d = ROLO[wavelength_nm]
    g_deg = abs(sun_deg)
    g, sun = math.radians(g_deg), math.radians(sun_deg)
    value = sum(a[i] * g**i for i in range(4)) + sum(b[i] * sun ** (2 * i + 1) for i in range(3))
    value += d[0] * math.exp(-g_deg / ROLO_P[0]) + d[1] * math.exp(-g_deg / ROLO_P[1])
    return math.exp(value + d[2] * math.cos((g_deg - ROLO_P[2]) / ROLO_P[3]))


def rolo_at(wavelength_nm: float, sun_deg: float) -> float:
    """Between the two wavelengths, straight in the logarithm."""
    low, high = sorted(ROLO)
    part = (wavelength_nm - low) / (high - low)
    return rolo(low, sun_deg) ** (1 - part) * rolo(high, sun_deg) ** part


def lunar_maps(data_dir: Path, *bands: int) -> list[Path]:
    return [data_dir / f"reflectance/WAC_HAPKEPARAMMAP_{nm}NM.tif" for nm in bands]


def test_moon_follows_rolo(data_dir: Path) -> None:
    """Within 15 % from 5 to 90 degrees, waxing and waning, in both bands of the maps."""
    scene = moon.scene("hapke", photometry.load_map(lunar_maps(data_dir, 643, 566, 566)))
    assert rolo(553.8, 30.0) == pytest.approx(0.0545186508411, rel=1e-9)
    ratios = []
    for sun_deg in (5, 7, 10, 20, 30, 45, 60, 75, 90, -5, -10, -30, -60, -90):
        asked = moon.request(96, sun_deg)
        light = moon.disc_reflectance(moon.radiance(scene, asked), asked)
        ratios.append([light[0] / rolo_at(643, sun_deg), light[1] / rolo_at(566, sun_deg)])
    assert np.abs(np.array(ratios) - 1.0).max() < 0.15
    # The maria of the west darken the waning Moon: more than a tenth at the quarters.
    waxing = moon.disc_reflectance(moon.radiance(scene, moon.request(96, 90)), asked)
    assert light[1] < 0.9 * waxing[1]


def test_map_is_where_it_should_be(data_dir: Path) -> None:
    """Mare Tranquillitatis (8 N, 31 E) is dark beside Tycho's surroundings (43 S, 11 W)."""
    raster = geotiff.read(lunar_maps(data_dir, 643)[0])
    assert raster.values.shape == (140, 360, 9)
    assert raster.goes_round
    assert raster.north_deg == pytest.approx(70.0)
    assert raster.south_deg == pytest.approx(-70.0)
    w = raster.values[:, :, 0]
    assert w[62, 31] < 0.3 < 0.4 < w[113, 349]
    # Tranquillity base, as printed in the study's table: w 0.222 at 643 nm.
    assert w[69, 23] == pytest.approx(0.222, abs=0.002)


def hapke(w: float, given: dict[str, float], mu0: float, mu: float, g: float) -> float:
    """A smooth surface without porosity, by the textbook: Hapke 2012, in angles."""
    b, c = given["b"], given["c"]

    def lobe(cosine: float) -> float:
        return (1 - b * b) / (1 - 2 * b * cosine + b * b) ** 1.5

    p = (1 + c) / 2 * lobe(math.cos(g)) + (1 - c) / 2 * lobe(-math.cos(g))
    surge = 1 + given["b_s0"] / (1 + math.tan(g / 2) / given["h_s"])
    gamma = math.sqrt(1 - w)
    r0 = (1 - gamma) / (1 + gamma)

    def h(x: float) -> float:
        return 1 / (1 - w * x * (r0 + (1 - 2 * r0 * x) / 2 * math.log((1 + x) / x)))

    return w / (4 * math.pi) * mu0 / (mu0 + mu) * (surge * p + h(mu0) * h(mu) - 1)


def test_rendered_radiance_is_the_models() -> None:
    """At the disc's centre, a point sun at 40 degrees: to 1e-5 in float, mixed bands."""
    given = {"b": 0.25, "c": 0.3, "b_s0": 1.5, "h_s": 0.06}
    row = np.full((1, 27), 0.0)
    for band in range(3):
        row[0, 8 * band : 8 * band + 6] = [0.25, 0.3, 0.0, 0.0, 1.5, 0.06]
    albedo = np.array([[0.1, 0.3, 0.6]])
    quality = moon.request(9, 0)["quality"] | {"samples": 1, "force_off": ["soft_sun"]}
    asked = moon.request(9, 40, body_regolith=row, body_albedo=albedo, quality=quality)
    pixel = moon.radiance(moon.scene("hapke"), asked)[4, 4]
    g = math.radians(40)
    # The surface is nearer to the Sun than the centre by r cos(g), and sees it from r sin(g) aside.
    sun = asked["sun_position"][0] - moon.RADIUS_M, asked["sun_position"][1]
    irradiance = moon.SOLAR * (moon.AU_M / math.hypot(*sun)) ** 2
    g = math.atan2(sun[1], sun[0])
    for band in range(3):
        r = hapke(albedo[0, band], given, math.cos(g), 1.0, g)
        assert pixel[band] == pytest.approx(r * irradiance, rel=1e-5)


def test_pixels_without_samples_are_as_those_with() -> None:
    """Away from opposition one shading stands for a pixel; not under a sun beyond 0.01 rad."""
    row = np.zeros((1, 27))
    row[0, :24] = [0.25, 0.3, 0.0, 0.0, 1.5, 0.06, 0.4, 0.0] * 3
    given: dict[str, Any] = {"body_regolith": row, "body_albedo": np.full((1, 3), 0.4)}
    given["quality"] = moon.request(9, 0)["quality"] | {"samples": 32}
    scene = moon.scene("hapke")
    K = moon.request(240, 0)["K"]  # so many pixels across the disc; its middle alone
    K[:2, 2] = 23.5
    for phase_deg in (10.0, 60.0):
        one, many = (
            moon.radiance(
                scene, moon.request(48, phase_deg, sun_radius=rho * moon.AU_M, K=K, **given)
            )
            for rho in (0.0099, 0.0101)
        )
        ratio = one / many
        assert np.abs(ratio - 1.0).max() > 1e-6  # they did not go the same way
        assert abs(ratio.mean() - 1.0) < 1e-4
        assert np.abs(ratio - 1.0).max() < 0.03  # noise of the samples, by the limb darkening


SCENE = {
    "version": 1,
    "time": {"epoch": "2026-03-20T12:00:00Z", "step_s": 60},
    "root": "rock",
    "bodies": {"rock": {"kind": "ellipsoid", "radii_km": 10.0, "gm_km3_s2": 0.1, "albedo": 0.2}},
    "sun": {"direction": [1.0, 0.0, 0.0]},
    "camera": {
        "width": 24,
        "height": 24,
        "fov_deg": 30.0,
        "trajectory": {"kind": "fixed", "target": "rock", "position_m": [50e3, 20e3, 0.0]},
    },
    "render": {"samples": 2, "max_bounces": 0},
}


def opened(**rock: Any) -> perilune.Simulation:
    return perilune.open(SCENE, overrides={f"bodies.rock.{key}": rock[key] for key in rock})


def mean_radiance(sim: perilune.Simulation, frame: int = 0) -> float:
    return float(sim.frame(frame, channels=["radiance"])["radiance"].mean())


def test_every_key_changes_the_picture() -> None:
    given = {"b": 0.3, "c": 0.1, "b_s0": 1.0, "h_s": 0.1, "b_c0": 0.5, "h_c": 0.05}
    given |= {"filling": 0.1, "roughness_deg": 20.0}
    base = mean_radiance(opened(reflectance="hapke", photometry=given))
    changes = {"b": 0.2, "c": 0.5, "b_s0": 0.5, "h_s": 0.2, "b_c0": 0.1, "h_c": 0.2}
    changes |= {"filling": 0.3, "roughness_deg": 30.0, "h_function": "simple"}
    changes |= {"coherent_surge": "2012"}
    for key, value in changes.items():
        changed = mean_radiance(opened(reflectance="hapke", photometry=given | {key: value}))
        assert abs(changed / base - 1.0) > 1e-4, key
    k = [opened(reflectance="minnaert", photometry={"k": value}) for value in (0.5, 0.9)]
    assert abs(mean_radiance(k[0]) / mean_radiance(k[1]) - 1.0) > 1e-3


def test_every_law_renders_and_is_the_moons_by_default() -> None:
    laws = [row["name"] for row in _core.REFLECTANCES if photometry.reads(row["name"])]
    assert laws == ["lommel_seeliger", "lunar_lambert", "minnaert", "hapke_smooth", "hapke"]
    for law in laws:
        defaults = {key: list(value) for key, value in photometry.reads(law).items()}
        for key in ("filling", "roughness_deg", "k"):
            if key in defaults:
                defaults[key] = defaults[key][0]
        light = mean_radiance(opened(reflectance=law))
        assert light > 0.0
        assert light == mean_radiance(opened(reflectance=law, photometry=defaults))


def test_drivers_on_parameters() -> None:
    angle = {"ideal": 20.0, "jitter_variance": 100.0, "clip_min": 0.0, "clip_max": 60.0}
    sim = opened(reflectance="hapke", photometry={"roughness_deg": angle, "b": [0.1, 0.2, 0.3]})
    values = [sim.frame(i, channels=["radiance"]) for i in range(3)]
    assert len({float(sample["radiance"].mean()) for sample in values}) == 3
    assert "bodies.rock.photometry.roughness_deg" in values[0].meta["drivers"]


@pytest.mark.parametrize(
    ("rock", "text"),
    [
        ({"photometry": {"b": 0.1}}, "only for reflectance lommel_seeliger"),
        (
            {"reflectance": "lommel_seeliger", "photometry": {"roughness_deg": 10.0}},
            "photometry.roughness_deg: not read by reflectance lommel_seeliger",
        ),
        ({"reflectance": "hapke", "photometry": {"k": 0.5}}, "photometry.k: not read"),
        ({"reflectance": "hapke", "photometry": {"roughness_deg": 61.0}}, "roughness_deg"),
        ({"reflectance": "hapke", "photometry": {"b": 1.0}}, "photometry.b"),
        ({"reflectance": "hapke", "photometry": {"maps": ["a", "b"]}}, "give one file"),
        ({"reflectance": "hapke", "photometry": {"hs": 0.1}}, "unknown key"),
    ],
)
def test_errors_name_the_key(rock: dict[str, Any], text: str) -> None:
    with pytest.raises(ConfigError, match=text):
        opened(**rock)


def write_map(path: Path, values: np.ndarray, compression: int = 1, longitudes: int = 360) -> Path:
    """A small GeoTIFF in degrees, as the reader should find it; one strip."""
    height, width, bands = values.shape
    step = longitudes / width
    raw = values.astype("<f4").tobytes()
    tags = [
        (256, "I", [width]), (257, "I", [height]), (258, "H", [32] * bands),
        (259, "H", [compression]), (273, "I", [8]), (277, "H", [bands]), (279, "I", [len(raw)]),
        (339, "H", [3] * bands), (33550, "d", [step, step, 0.0]),
        (33922, "d", [0.0, 0.0, 0.0, -180.0, 0.5 * step * height, 0.0]),
        (34735, "H", [1, 1, 0, 1, 1024, 0, 1, 2]),
    ]  # fmt: skip
    kinds = {"H": 3, "I": 4, "d": 12}
    where = 8 + len(raw)
    table, extra = b"", b""
    end = where + 2 + 12 * len(tags) + 4
    for tag, form, items in tags:
        packed = struct.pack(f"<{len(items)}{form}", *items)
        field = packed.ljust(4, b"\0") if len(packed) <= 4 else struct.pack("<I", end + len(extra))
        extra += packed if len(packed) > 4 else b""
        table += struct.pack("<HHI", tag, kinds[form], len(items)) + field
    head = b"II*\0" + struct.pack("<I", where)
    path.write_bytes(head + raw + struct.pack("<H", len(tags)) + table + b"\0" * 4 + extra)
    return path


def parameter_map() -> np.ndarray:
    """West half dark, east half bright."""
    values = np.empty((18, 36, 9))
    values[:] = [0.2, 0.25, 0.3, 0.0, 0.0, 1.5, 0.06, 20.0, 0.0]
    values[:, 18:, 0] = 0.4
    return values


def test_map_gives_the_parameters(tmp_path: Path) -> None:
    """Each half of the map is as a body with its numbers; keys go over the map."""
    path = str(write_map(tmp_path / "map.tif", parameter_map()))
    numbers = {"b": 0.25, "c": 0.3, "b_c0": 0.0, "h_c": 0.0, "b_s0": 1.5, "h_s": 0.06}
    numbers |= {"filling": 0.0, "roughness_deg": 20.0}
    for sun, w in ((1.0, 0.4), (-1.0, 0.2)):
        # From above 90 degrees east, or west, where the map is one value all over the disc.
        place: dict[str, Any] = {"sun.direction": [0.0, sun, 0.0]}
        place |= {"camera.trajectory.position_m": [0.0, sun * 50e3, 0.0]}

        def mean(place: dict[str, Any] = place, **rock: Any) -> float:
            keys = {f"bodies.rock.{key}": value for key, value in rock.items()}
            return mean_radiance(perilune.open(SCENE, overrides=place | keys))

        mapped = mean(reflectance="hapke", photometry={"maps": [path]}, albedo=1.0)
        stated = mean(reflectance="hapke", photometry=numbers, albedo=w)
        assert mapped == pytest.approx(stated, rel=1e-5)
        over = mean(reflectance="hapke", photometry={"maps": [path], "b": 0.1}, albedo=1.0)
        assert over == pytest.approx(
            mean(reflectance="hapke", photometry=numbers | {"b": 0.1}, albedo=w), rel=1e-5
        )


def test_bad_maps(tmp_path: Path) -> None:
    good = parameter_map()
    with pytest.raises(ValueError, match="9"):
        photometry.load_map([write_map(tmp_path / "a.tif", good[:, :, :8])])
    with pytest.raises(ValueError, match=r"b\.tif: not a GeoTIFF"):
        photometry.load_map([write_map(tmp_path / "b.tif", good, compression=34925)])
    with pytest.raises(ValueError, match="longitudes"):
        photometry.load_map([write_map(tmp_path / "c.tif", good, longitudes=180)])
    good[3, 4, 1] = 0.99
    with pytest.raises(ValueError, match=r"band 2 \(b\)"):
        photometry.load_map([write_map(tmp_path / "d.tif", good)])
    good[3, 4, 1] = np.nan
    with pytest.raises(ValueError, match=r"band 2 \(b\)"):
        photometry.load_map([write_map(tmp_path / "e.tif", good)])
    coarse = parameter_map()[:9, :18]
    pair = [write_map(tmp_path / f"{k}.tif", parameter_map()) for k in range(2)]
    with pytest.raises(ValueError, match="not on the grid"):
        photometry.load_map([*pair, write_map(tmp_path / "f.tif", coarse)])
    for cut in (0, 3, 7, 100, 2000):
        path = tmp_path / "cut.tif"
        path.write_bytes(pair[0].read_bytes()[:cut])
        with pytest.raises(ValueError, match="not a GeoTIFF"):
            geotiff.read(path)


def test_core_checks_its_numbers() -> None:
    row = np.zeros((1, 27))
    row[0, 0] = 1.0  # b = 1 has an infinite lobe
    with pytest.raises(ValueError, match="regolith out of range"):
        moon.radiance(moon.scene("hapke"), moon.request(4, 10, body_regolith=row))
    with pytest.raises(ValueError, match=r"27|shape"):
        moon.radiance(moon.scene("hapke"), moon.request(4, 10, body_regolith=row[:, 1:]))
    with pytest.raises(ValueError, match="3 bands"):
        moon.scene("hapke", _core.Grid(np.zeros((2, 2, 5), np.float32), 0.0, 1.0, -1.0))


def display(radiance: np.ndarray, white: float) -> np.ndarray:
    """Display values of 255, sRGB (IEC 61966-2-1), not rounded."""
    x = np.clip(radiance.astype(float) / white, 0.0, 1.0)
    curved = 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055
    return 255 * np.where(x < 0.0031308, 12.92 * x, curved)


def close_up(phase_deg: float, height_m: float, focal_px: float, **changes: Any) -> dict[str, Any]:
    """Straight down at a few kilometres of the Moon, Hapke's law with a soil of one kind."""
    row = np.zeros((1, 27))
    row[0, :24] = [0.25, 0.3, 0.0, 0.0, 1.5, 0.06, 0.4, 0.0] * 3
    pose = np.concatenate([[moon.RADIUS_M + height_m, 0.0, 0.0], moon.LOOK_DOWN_X])
    K = np.array([[focal_px, 0.0, 23.5], [0.0, focal_px, 23.5], [0.0, 0.0, 1.0]])
    given = {"body_regolith": row, "body_albedo": np.full((1, 3), 0.4), "K": K}
    return moon.request(48, phase_deg, camera_pose=np.stack([pose, pose]), **given | changes)


def test_cheap_laws_stay_within_their_bounds() -> None:
    """At every step of the ladder that some tolerance chooses, near and far, at several phases."""
    scene = moon.scene("hapke")
    renderer = _core.Renderer(scene)
    chosen = set()
    views = [close_up(g, h, f) for g in (2, 40) for h, f in ((5e3, 3e3), (5e4, 300), (4e5, 60))]
    views += [moon.request(48, g, **{k: views[0][k] for k in ("body_regolith", "body_albedo")})
              for g in (10, 100)]  # fmt: skip
    for asked in views:
        white = asked["exposure"]["white_radiance"]
        images = {}
        for tolerance in (0.01, 0.3, 2.0, 10.0, 40.0, 200.0):
            quality = asked["quality"] | {"tolerance_dn": tolerance}
            quality["force_on"] = ["antialiasing", "soft_sun"]
            for forced in ([], ["regolith"]):
                images[bool(forced)] = out = np.empty((48, 48, 3), np.float32)
                request = asked | {"quality": quality | {"force_on": quality["force_on"] + forced}}
                plan = renderer.render(request, {"radiance": out})["plan"]
                row = next(row for row in plan if row["name"] == "regolith")
                if not forced:
                    chosen.add(row["value"])
                    bound = row["residual_dn"]
                    assert bound <= tolerance
                else:
                    assert row["value"] == 5
            off = np.abs(display(images[False], white) - display(images[True], white)).max()
            assert off <= bound + 1e-3
    assert chosen >= {0, 2, 4, 5}


def test_ladder_is_only_for_hapke() -> None:
    plan = _core.Renderer(moon.scene("minnaert")).plan(moon.request(16, 30))["plan"]
    row = next(row for row in plan if row["name"] == "regolith")
    assert row["value"] == 0
    assert "no body with Hapke's reflectance" in row["reason"]


def test_slivers_keep_their_law() -> None:
    """A crescent between the rays that compare laws is as Hapke has it, at any tolerance."""
    renderer = _core.Renderer(moon.scene("hapke"))
    given = {key: close_up(0, 5e3, 3e3)[key] for key in ("body_regolith", "body_albedo")}
    for phase_deg in (165.0, 175.0):
        images = []
        for force_on in ([], ["regolith"]):
            asked = moon.request(48, phase_deg, **given)
            asked["quality"] |= {"tolerance_dn": 200.0, "force_on": ["antialiasing", *force_on]}
            images.append(np.empty((48, 48, 3), np.float32))
            renderer.render(asked, {"radiance": images[-1]})
        assert images[1].max() > 0.0
        assert np.array_equal(images[0], images[1])
