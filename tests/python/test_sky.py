"""Stars and backgrounds: files, places against ERFA and OpenCV, fluxes against the catalogue."""

from __future__ import annotations

import math

import cv2
import erfa
import numpy as np
import pytest

import perilune
from perilune import _core
from perilune.base import rotations
from perilune.config import ConfigError
from perilune.config.sky import Background
from perilune.config.sun import Sun
from perilune.document.loader import read_tree
from perilune.sky import skies
from perilune.sky.star_files import read_stars, temperature_k

HEADER = "number,ra_deg,dec_deg,vmag,bv,pm_ra_mas_yr,pm_dec_mas_yr\n"
ORION = (83.8, -1.2)


def unit(ra_deg, dec_deg):
    return np.array(erfa.s2c(np.radians(ra_deg), np.radians(dec_deg)))


@pytest.fixture
def tree(repo_dir):
    """A dim exposure, far from the satellite, at one moment."""
    tree = read_tree(repo_dir / "tests/python/scene.yaml")
    tree["time"]["step_s"] = 0
    tree["camera"].update(
        width=96,
        height=64,
        fov_deg=30,
        exposure={"mode": "fixed", "white_radiance_w_m2_sr": 1e-3},
    )
    tree["render"]["channels"] = ["rgb"]
    tree["render"]["tolerance_dn"] = 0
    return tree


@pytest.fixture
def opened(tree, repo_dir, tmp_path):
    def open_(rows, toward=ORION, up=(0.0, 89.0), **stars):
        """A simulation that looks somewhere, away from the Earth."""
        path = tmp_path / "stars.csv"
        path.write_text(HEADER + "".join(",".join(map(str, row)) + "\n" for row in rows))
        tree["sky"] = {"stars": {"catalogue": str(path), **stars}}
        q = rotations.look_at(unit(*toward), unit(*up))
        pose = np.concatenate([3e8 * unit(*toward), q])
        return perilune.open(tree, base=repo_dir / "tests/python", trajectory=lambda _: pose)

    return open_


def solid_angles(K, width, height):
    """(height, width): of a pinhole's pixels at their middles, less than 1e-5 off here."""
    u, v = np.meshgrid(np.arange(width), np.arange(height))
    x, y = (u - K[0, 2]) / K[0, 0], (v - K[1, 2]) / K[1, 1]
    return (1.0 + x * x + y * y) ** -1.5 / (K[0, 0] * K[1, 1])


# --- files


def test_the_bright_star_catalogue(data_dir, caplog):
    table = read_stars(data_dir / "stars/bsc5-short.json")
    assert len(table.vmag) == 9096 - table.skipped
    assert table.skipped == 0
    vega = int(np.flatnonzero(table.number == 7001)[0])
    # 18h 36m 56.3s, +38 47' 01" and V 0.03: bsc5's line of HR 7001
    assert math.degrees(table.ra_rad[vega]) == pytest.approx(279.2346, abs=1e-4)
    assert math.degrees(table.dec_rad[vega]) == pytest.approx(38.7836, abs=1e-4)
    assert table.vmag[vega] == 0.03
    assert table.temperature_k[table.number == 2277] == [5772.0]  # the one without a colour


def test_a_missing_magnitude_is_counted_and_a_missing_colour_is_the_suns(tmp_path, caplog):
    path = tmp_path / "s.csv"
    path.write_text(HEADER + "1,0,0,5,,,\n2,1,1,,0.5,,\n3,359.5,-90,4,0.653,,\n")
    table = read_stars(path)
    assert table.number.tolist() == [1, 3]
    assert table.skipped == 1
    assert "1 stars without a magnitude" in caplog.text
    assert table.temperature_k[0] == 5772.0
    # The Sun's B - V of 0.653 (Ramirez et al. 2012) by Ballesteros' formula: 5.8e3 K
    assert table.temperature_k[1] == pytest.approx(5772.0, rel=0.01)


def test_colour_index():
    # Ballesteros 2012, figure 1: Vega (0.0) about 10 100 K, Betelgeuse (1.85) about 3400 K
    assert temperature_k(0.0) == pytest.approx(4600 * (1 / 1.7 + 1 / 0.62))
    assert 3300 < temperature_k(1.85) < 3500


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("s.csv", "ra_deg,dec_deg,mag\n", ["line 1", "'mag' is not known; did you mean 'vmag'?"]),
        ("s.csv", "ra_deg,dec_deg,vmag,b-v\n", ["line 1", "'b-v' is not known", "bv"]),
        ("s.csv", "ra_deg,vmag\n", ["line 1", "no column 'dec_deg'; there is ra_deg, vmag"]),
        ("s.csv", "ra_deg,dec_deg,vmag\n1,2,3\n1,91,3\n", ["line 3", "dec_deg", "'91'"]),
        ("s.csv", "ra_deg,dec_deg,vmag\nx,2,3\n", ["line 2", "ra_deg", "'x'"]),
        ("s.csv", "ra_deg,dec_deg,vmag\n1,2,nan\n", ["line 2", "vmag"]),
        ("s.csv", "ra_deg,dec_deg,vmag\n,2,3\n", ["line 2", "ra_deg"]),
        ("s.csv", "ra_deg,dec_deg,vmag\n1,2,3,4\n", ["line 2", "more fields"]),
        ("s.csv", "number,ra_deg,dec_deg,vmag\n1.5,1,2,3\n", ["line 2", "number"]),
        ("s.csv", "ra_deg,dec_deg,vmag,bv\n1,2,3,-0.7\n", ["line 2", "bv"]),
        ("s.csv", "", ["line 1", "no column"]),
        ("s.json", "{}", ["list of mappings"]),
        ("s.json", "[{", ["s.json"]),
        ("s.json", '[{"RA": "1h", "Dec": "", "V": "1"}]', ["star 1", "RA", "00h 05m"]),
        (
            "s.json",
            '[{"HR": "9", "RA": "01h 00m 00s", "Dec": "+95° 00′ 00″", "V": "1"}]',
            ["star 1 (HR 9)", "Dec"],
        ),
        ("s.txt", "", [".csv, .json"]),
    ],
)
def test_bad_files(tmp_path, name, text, words):
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=name) as caught:
        read_stars(path)
    for word in words:
        assert word in str(caught.value)


# --- places


@pytest.mark.filterwarnings("ignore:ERFA function .pmsafe. yielded")  # no parallax
def test_places_are_erfas_and_opencvs(opened, tree):
    """Proper motion, aberration, projection through a lens, all done by others: 0.1 arcseconds."""
    rng = np.random.default_rng(4)
    rows = []
    for i in range(60):
        ra, dec = ORION[0] + rng.uniform(-14, 14), ORION[1] + rng.uniform(-9, 9)
        rows.append((i, ra, dec, 3.0, 0.6, rng.uniform(-9e3, 9e3), rng.uniform(-9e3, 9e3)))
    tree["camera"].update(width=512, height=256)
    tree["camera"]["lens"] = {"model": "brown_conrady", "k1": -0.1, "p1": 1e-3}
    simulation = opened(rows, catalogue_year=1991.25)
    request = simulation.request(0)
    request.update(sun_irradiance=1.0)
    renderer = simulation._mine().renderer
    out = {"rgb": np.empty((256, 512, 3), np.uint8)}
    stars = skies.seen(renderer.render(request, out, 1)["stars"])
    assert len(stars) > 50
    world = simulation.world(0)
    jd = world.epoch.day + world.epoch.fraction
    velocity = erfa.epv00(world.epoch.day, world.epoch.fraction)[0]["v"] / 86400 * erfa.DAU
    velocity = velocity + world.velocities_m_s["sat"][0]
    beta = velocity / erfa.CMPS
    pose = request["camera_pose"][0]
    R = rotations.to_matrix(pose[3:]).T
    for star in stars:
        _, ra, dec, *_, pm_ra, pm_dec = rows[star["number"]]
        ra, dec, rates = np.radians(ra), np.radians(dec), np.radians([pm_ra, pm_dec]) / 3.6e6
        start = 2451545.0 + (1991.25 - 2000.0) * 365.25
        moved = erfa.pmsafe(ra, dec, rates[0] / np.cos(dec), rates[1], 1e-7, 0, start, 0, jd, 0)
        seen = erfa.ab(erfa.s2c(*moved[:2]), beta, 1e12, math.sqrt(1 - beta @ beta))
        lens = np.array([-0.1, 0, 1e-3, 0, 0])
        pixel = cv2.projectPoints((R @ seen)[None], np.zeros(3), np.zeros(3), request["K"], lens)
        assert np.hypot(*(pixel[0][0, 0] - [star["u"], star["v"]])) < 0.0005
    # The test sees aberration: it moves stars by a hundred times that.
    still = opened(rows, catalogue_year=1991.25, aberration=False).request(0)
    places = skies.seen(renderer.render(still, out, 1)["stars"])
    both = set(places["number"]) & set(stars["number"])
    shift = [
        abs(stars["u"][stars["number"] == n] - places["u"][places["number"] == n])[0] for n in both
    ]
    assert np.median(shift) > 0.005


def test_centroid_through_the_point_spread(opened, tree):
    """In digital numbers of a sensor, with its noise: within 0.1 pixels."""
    tree["camera"]["exposure_time_s"] = 1.0
    tree["camera"]["sensor"] = {
        "mosaic": "mono",
        "f_number": 1.4,
        "pixel_um": 100.0,
        "point_spread": {"core": "gauss", "sigma_px": 0.7},
        "exposure": {"mode": "fixed"},
        "full_well_e": 1e6,
        "gain_e_dn": 20.0,
        "bits": 16,
    }
    tree["render"]["channels"] = ["raw", "rgb"]
    rng = np.random.default_rng(2)
    rows = [
        (i, ORION[0] - 12 + 6 * i, ORION[1] + 7 * rng.uniform(-1, 1), 2.0, 0.6, 0, 0)
        for i in range(5)
    ]
    sample = opened(rows)[0]
    raw = sample["raw"].astype(float) - 64.0
    assert len(sample.stars) == 5
    for star in sample.stars:
        x, y = round(star["u"]), round(star["v"])
        window = raw[y - 4 : y + 5, x - 4 : x + 5]
        v, u = np.mgrid[y - 4 : y + 5, x - 4 : x + 5]
        assert window.sum() > 500
        assert abs((window * u).sum() / window.sum() - star["u"]) < 0.1
        assert abs((window * v).sum() / window.sum() - star["v"]) < 0.1


@pytest.mark.parametrize("toward", [(0.0, 0.0), (0.0, 90.0), (180.0, -89.9), (266.4, -28.9)])
def test_no_seam_in_the_sky(opened, toward):
    """About the poles and where right ascension begins anew, stars are where they should be."""
    middle = unit(*toward)
    rng = np.random.default_rng(1)
    rows = []
    for i in range(40):
        d = middle + rng.normal(0, 0.08, 3)
        ra, dec = np.degrees(erfa.c2s(d / np.linalg.norm(d)))
        ra = ra % 360.0 - (360.0 if i % 2 else 0.0)
        rows.append((i, ra, dec, 3.0, 0.6, 0, 0))
    simulation = opened(rows, toward, up=(97.0, 10.0), aberration=False)
    sample = simulation[0]
    places = sample.camera.project(
        sample.camera.position_m + 1e12 * np.array([unit(ra, dec) for _, ra, dec, *_ in rows])
    )
    inside = (places > -0.9).all(axis=1) & (places < [94.9, 62.9]).all(axis=1)
    assert inside.sum() > 10
    found = {star["number"]: (star["u"], star["v"]) for star in sample.stars}
    for i in np.flatnonzero(inside):
        assert np.hypot(*(places[i] - found[i])) < 0.01


# --- fluxes


def test_fluxes_are_the_catalogues(opened):
    """Of bright stars far from each other: Pogson's ratios, and the Sun's magnitude, to 1 %."""
    rows = [(i, ORION[0] - 13 + 2.9 * i, ORION[1], -1.0 + i, 0.653, 0, 0) for i in range(9)]
    simulation = opened(rows)
    radiance = simulation.frame(0, channels=["radiance"])["radiance"].astype(float)
    sample = simulation.frame(0)
    assert len(sample.stars) == 9
    energy = radiance * solid_angles(sample.camera.K, 96, 64)[..., None]
    for star in sample.stars:
        x, y = math.floor(star["u"]), math.floor(star["v"])
        flux = energy[y : y + 2, x : x + 2].sum(axis=(0, 1))
        # The Sun, of 1361 W m-2, has V = -26.76 (Willmer 2018, ApJS 236:47, table 3).
        want = 1361.0 * 10 ** (-0.4 * (rows[star["number"]][3] + 26.76))
        assert flux[1] == pytest.approx(want, rel=0.01)
        assert flux / flux[1] == pytest.approx([1, 1, 1], rel=0.02)  # as white as the Sun


def test_electrons_of_a_star(opened, tree):
    """m = 0, 50 mm aperture, 88 nm, 0.1 s, QE 0.5, T 0.9: 781 480 electrons at 550 nm."""
    focal_px = 3000.0
    del tree["camera"]["fov_deg"]
    tree["camera"].update(focal_px=focal_px, exposure_time_s=0.1)
    tree["camera"]["sensor"] = {
        "mosaic": "mono",
        "f_number": focal_px * 5.5e-6 / 0.05 if focal_px * 5.5e-6 / 0.05 > 0.5 else 0.5,
        "transmission": 0.9,
        "quantum_efficiency": [0.0, 0.5, 0.0],
        "bands_nm": [[600, 700], [506, 594], [400, 500]],
        "point_spread": {"core": "gauss", "sigma_px": 1.5},
        "exposure": {"mode": "fixed"},
        "full_well_e": 1e7,
        "gain_e_dn": 100.0,
        "bits": 16,
        "prnu": 0.0,
        "dark_current_e_s": 0.0,
        "black_level_dn": 100.0,
    }
    # f/0.5 is the fastest: the aperture is then 33 mm.
    aperture = focal_px * 5.5e-6 / tree["camera"]["sensor"]["f_number"]
    tree["render"]["channels"] = ["raw"]
    rows = [(1, *ORION, 0.0, 0.653, 0, 0)]
    raw = opened(rows, aberration=False)[0]["raw"].astype(float) - 100.0
    assert raw.sum() * 100.0 == pytest.approx(781480.0 * (aperture / 0.05) ** 2, rel=0.01)


def test_colours():
    """Cool stars are red, hot ones blue, by Planck's ratios; V is what it was."""
    light = skies.irradiance(np.zeros(3), np.array([3500.0, 5772.0, 20000.0]), Sun())
    ratio = light / light[1]
    c2, um = 14387.76877, np.array([0.612, 0.549, 0.465])
    black = np.expm1(c2 / (um * 5772.0)) / np.expm1(c2 / (um * 3500.0))
    assert ratio[0] / ratio[0, 1] == pytest.approx(black / black[1], rel=1e-9)
    assert ratio[:, 1] == pytest.approx(np.ones(3), rel=0.01)
    assert ratio[0, 0] > 1.1 > 0.7 > ratio[0, 2]
    assert ratio[2, 2] > 1.3
    assert ratio[2, 0] < 0.85


def test_zero_exposure_and_daylight_show_no_stars(opened, tree):
    rows = [(1, *ORION, -1.4, 0.0, 0, 0)]
    tree["render"]["tolerance_dn"] = 1.0
    tree["camera"]["exposure"]["white_radiance_w_m2_sr"] = 433.0
    sample = opened(rows)[0]
    row = next(row for row in sample.plan if row["name"] == "stars")
    assert not row["on"]
    assert len(sample.stars) == 0
    assert not sample["rgb"].any()
    tree["camera"]["exposure_time_s"] = 0.0
    tree["camera"]["sensor"] = {"exposure": {"mode": "fixed"}, "read_noise_e": 0.0}
    tree["render"]["channels"] = ["raw"]
    sample = opened(rows)[0]
    assert not next(row for row in sample.plan if row["name"] == "stars")["on"]
    assert (sample["raw"] == 64).all()


def test_the_sensor_sees_what_the_display_does_not(opened, tree):
    """The limit follows from the more sensitive of the two; the point-spread's row knows stars."""
    tree["render"]["tolerance_dn"] = 1.0
    tree["camera"]["exposure"]["white_radiance_w_m2_sr"] = 433.0
    tree["camera"]["exposure_time_s"] = 10.0
    tree["camera"]["sensor"] = {"exposure": {"mode": "fixed"}, "pixel_um": 50.0}
    tree["render"]["channels"] = ["raw"]
    sample = opened([(1, *ORION, 2.0, 0.0, 0, 0)])[0]
    on = {row["name"]: row["on"] for row in sample.plan}
    assert on["stars"]
    assert on["point_spread"]
    assert len(sample.stars) == 1
    assert sample["raw"].max() > 500


# --- sections


@pytest.mark.parametrize(
    ("section", "words"),
    [
        ({"stars": {}}, ["sky.stars.catalogue"]),
        ({"background": {}}, ["exactly one of map, image"]),
        ({"background": {"map": "a.png", "image": "b.png"}}, ["only one of map, image"]),
        ({"background": {"map": "a.png", "fit": "cover"}}, ["sky.background.fit", "`image`"]),
        ({"background": {"image": "a.png", "frame": "icrf"}}, ["sky.background.frame", "`map`"]),
        ({"background": {"map": "a.png", "frame": "galatic"}}, ["sky.background.frame"]),
        ({"star": {}}, ["sky.star", "stars"]),
    ],
)
def test_bad_sections(tree, section, words):
    tree["sky"] = section
    with pytest.raises(ConfigError) as caught:
        perilune.open(tree)
    for word in words:
        assert word in str(caught.value)


def test_missing_files_are_named(tree, repo_dir):
    tree["sky"] = {"stars": {"catalogue": "nowhere.csv"}}
    with pytest.raises(FileNotFoundError, match=r"sky\.stars\.catalogue"):
        perilune.open(tree, base=repo_dir / "tests/python")[0]


def test_axes_of_maps():
    """Galactic centre and pole (Hipparcos catalogue, volume 1, section 1.5.3), obliquity."""
    galactic = skies.map_axes(Background(map="m", frame="galactic", east="right"))
    assert galactic @ unit(266.40499, -28.93617) == pytest.approx([1, 0, 0], abs=1e-6)
    assert galactic @ unit(192.85948, 27.12825) == pytest.approx([0, 0, 1], abs=1e-6)
    assert np.linalg.det(galactic) == pytest.approx(1.0)
    ecliptic = skies.map_axes(Background(map="m", frame="ecliptic", east="left"))
    tilt = math.radians(23.4392911)
    assert ecliptic @ [0, -math.sin(tilt), math.cos(tilt)] == pytest.approx([0, 0, 1], abs=1e-6)
    assert np.linalg.det(ecliptic) == pytest.approx(-1.0)
    turned = skies.map_axes(Background(map="m", center_lon_deg=90.0))
    assert turned @ unit(90.0, 0.0) == pytest.approx([1, 0, 0], abs=1e-12)
    assert turned @ unit(100.0, 0.0) == pytest.approx(  # to the left of the centre
        [math.cos(math.radians(10)), -math.sin(math.radians(10)), 0], abs=1e-12
    )


def test_the_map_in_the_data_lies_on_the_catalogue(data_dir, tree, repo_dir):
    """Bright stars of NASA's map and of the catalogue coincide: orientation and scale of both."""
    tree["sky"] = {"background": {"map": "data:planets/nasa/starmap_deep_2020.jpg"}}
    table = read_stars(data_dir / "stars/bsc5-short.json")
    tree["camera"].update(width=512, height=512, fov_deg=40)
    pose = np.concatenate([[0, 0, 3e8], rotations.look_at(unit(*ORION), unit(0.0, 89.0))])
    simulation = perilune.open(tree, base=repo_dir / "tests/python", trajectory=lambda _: pose)
    sample = simulation.frame(0, channels=["rgb", "radiance"])
    bright = np.argsort(table.vmag)[:60]
    stars = np.array(erfa.s2c(table.ra_rad[bright], table.dec_rad[bright]))
    places = sample.camera.project(sample.camera.position_m + 1e12 * stars)
    image = sample["radiance"].sum(axis=2)
    seen = [p for p in places if np.isfinite(p).all() and (p > 4).all() and (p < 507).all()]
    assert len(seen) >= 6
    for u, v in seen:
        x, y = round(u), round(v)
        assert image[y - 2 : y + 3, x - 2 : x + 3].max() > 20 * np.median(image)
    # The dark sky between the stars of Orion: 20 to 24 magnitudes a square arcsecond.
    dark = skies.irradiance(np.array([20.0, 24.0]), 5772.0, Sun())[:, 1] / skies._ARCSEC2_SR
    assert dark[1] < np.median(sample["radiance"][..., 1]) < dark[0]


def test_a_choice_of_images(tree, repo_dir, tmp_path):
    for name, value in (("dark", 10), ("light", 200)):
        _core.png_write(str(tmp_path / f"{name}.png"), np.full((4, 6, 3), value, np.uint8))
    paths = [str(tmp_path / "dark.png"), str(tmp_path / "light.png")]
    tree["sky"] = {"background": {"image": {"choice": paths}}}
    pose = np.concatenate([[0, 0, 3e8], rotations.look_at(unit(*ORION), unit(0.0, 89.0))])
    simulation = perilune.open(tree, base=repo_dir / "tests/python", trajectory=lambda _: pose)
    found = {int(np.median(simulation[i]["rgb"])) for i in range(8)}
    assert found == {10, 200}


def test_no_section_is_a_black_sky_to_the_last_bit(tree, repo_dir):
    plain = perilune.open(tree, base=repo_dir / "tests/python")[0]
    tree["sky"] = {}
    empty = perilune.open(tree, base=repo_dir / "tests/python")[0]
    np.testing.assert_array_equal(plain["rgb"], empty["rgb"])
    assert len(empty.stars) == 0


def test_air_dims_stars_and_the_sky_alike(tree, repo_dir, tmp_path):
    """Over the limb what is left of stars is what is left of a background there."""
    tree["bodies"]["earth"]["atmosphere"] = {"preset": "earth"}
    tree["render"]["samples"] = 1
    path, distance = tmp_path / "stars.csv", 1e7
    heights = [5e3, 10e3, 20e3, 40e3, 80e3, 1e6]  # the last is out of the air
    angles = np.degrees(np.arcsin((6.378137e6 + np.array(heights)) / distance))
    rows = [f"{i},0,{angle - 90},-1,0.653,,\n" for i, angle in enumerate(angles)]
    path.write_text(HEADER + "".join(rows))
    _core.png_write(str(tmp_path / "white.png"), np.full((2, 2, 3), 255, np.uint8))
    tree["camera"].update(width=16, height=1024, fov_deg=0.2)
    tree["camera"]["exposure"]["white_radiance_w_m2_sr"] = 1.0
    tree["sun"] = {"irradiance_w_m2": 0.0}
    q = rotations.look_at(unit(0, angles[3:5].mean() - 90 + 3.5), unit(0, 89))
    pose = np.concatenate([[0, 0, distance], q])

    def seen(section):
        tree["sky"] = section
        simulation = perilune.open(tree, base=repo_dir / "tests/python", trajectory=lambda _: pose)
        sample = simulation.frame(0, channels=["radiance"])
        return sample, sample["radiance"].astype(float)

    sample, stars = seen({"stars": {"catalogue": str(path), "aberration": False}})
    _, white = seen({"background": {"image": str(tmp_path / "white.png")}})
    energy = stars * solid_angles(sample.camera.K, 16, 1024)[..., None]
    places = {star["number"]: (star["u"], star["v"]) for star in sample.stars}
    assert sorted(places) == [0, 1, 2, 3, 4, 5]
    sums = {
        n: energy[math.floor(v) : math.floor(v) + 2].sum(axis=(0, 1))
        for n, (_, v) in places.items()
    }
    for n in range(5):
        passed, y = sums[n] / sums[5], round(places[n][1])
        around = white[y - 1 : y + 2, 6:10].reshape(-1, 3)
        assert (passed > around.min(axis=0) - 1e-3).all()
        assert (passed < around.max(axis=0) + 1e-3).all()
    assert (sums[0] < 0.2 * sums[5]).all()


@pytest.mark.parametrize("kind", ["stars", "map"])
def test_the_sky_trails_where_nothing_else_is_seen(tree, repo_dir, tmp_path, kind):
    """A turn of 2 degrees in the exposure: stars become lines of the same light."""
    path = tmp_path / "stars.csv"
    path.write_text(HEADER + f"1,{ORION[0]},{ORION[1]},-1,0.6,,\n")
    picture = np.zeros((180, 360, 3), np.uint8)
    picture[88:94, 93:99] = 255  # a patch about Orion
    _core.png_write(str(tmp_path / "map.png"), picture)
    stars = {"stars": {"catalogue": str(path), "aberration": False}}
    sky_map = {"background": {"map": str(tmp_path / "map.png")}}
    tree["sky"] = stars if kind == "stars" else sky_map
    tree["camera"]["exposure_time_s"] = 1.0
    tree["camera"]["exposure"]["white_radiance_w_m2_sr"] = 1e-5
    tree["render"].update(tolerance_dn=1.0, samples=64)
    q = rotations.look_at(unit(*ORION), unit(0.0, 89.0))
    turns = [rotations.axis_angle([0.0, 0.0, 1.0], math.radians(a)) for a in (-1.0, 1.0)]
    place = 3e8 * unit(*ORION)
    still = np.concatenate([place, q])
    moving = np.stack([np.concatenate([place, rotations.multiply(turn, q)]) for turn in turns])
    frames = [
        perilune.open(tree, base=repo_dir / "tests/python", trajectory=lambda _, p=pose: p).frame(
            0, channels=["radiance"]
        )
        for pose in (still, moving)
    ]
    sums = [f["radiance"][..., 1].sum(dtype=float) for f in frames]
    widths = [(f["radiance"][..., 1].max(axis=0) > 0).sum() for f in frames]
    assert sums[1] == pytest.approx(sums[0], rel=0.02)
    # 2 degrees of right ascension are 6.25 pixels of 0.32 degrees here
    assert widths[1] - widths[0] == pytest.approx(6.25, abs=1.5)
