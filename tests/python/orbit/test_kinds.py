"""Kinds of orbits from the configuration to states in the root frame."""

from __future__ import annotations

import itertools
import math

import erfa
import numpy as np
import pytest
from tests.python.orbit.scenes import equator_m, opened, refused, state

from perilune.orbits import dates
from perilune.orbits.ephemerides import tle

ISS = [
    "1 25544U 98067A   26162.96453450  .00008067  00000+0  15344-3 0  9993",
    "2 25544  51.6334 325.9414 0004931 175.6343 184.4689 15.49182446570947",
]


# --- SGP4 --------------------------------------------------------------------------------------


def verification_sets(folder):
    """(lines, rows of minutes and TEME state) of Vallado's set, rows of errors left out."""
    lines = (folder / "SGP4-VER.TLE").read_text().splitlines()
    sets = {}
    for first, second in itertools.pairwise(lines):
        if first.startswith("1 "):
            # Three of the sets were made for the test, and their checksums were left as they were.
            pair = [text[:68] + str(tle.checksum(text)) for text in (first, second)]
            sets.setdefault(int(first[2:7]), []).append(pair)
    number, rows = 0, {}
    for line in (folder / "tcppver.out").read_text().splitlines():
        fields = line.split()
        if len(fields) == 2:
            number = int(fields[0])
            key = (number, len([k for k in rows if k[0] == number]))
            rows[key] = []
        elif len(fields) >= 7:
            rows[key].append([float(field) for field in fields[:7]])
    return [(sets[number][k], values) for (number, k), values in rows.items()]


def teme_matrix(day, fraction):
    """TEME to GCRS once more, from angles: nutation and obliquity of 1980, precession of 1976."""
    psi, eps = erfa.nut80(day, fraction)
    obliquity = erfa.obl80(day, fraction)
    mean_to_true = erfa.numat(obliquity, psi, eps) @ erfa.pmat76(day, fraction)
    spin = erfa.rz(-erfa.eqeq94(day, fraction), np.eye(3))
    return erfa.bp00(day, fraction)[0].T @ mean_to_true.T @ spin  # the bias has no date


def test_sgp4_verification_set_through_the_whole_chain(data_dir, scene, repo_dir):
    """Configuration -> world pose -> back to TEME: 1e-6 km, and 2e-9 km/s, of tcppver.out.

    Each row is the frame 0 of a configuration with that row's UTC for epoch.
    """
    count = 0
    for lines, rows in verification_sets(data_dir / "orbits/sgp4"):
        record = tle.Sgp4(tle.parse(*lines, "here"))
        if record.elements.number == 33334:
            continue  # made to fail at its epoch: the file's line holds what was there before
        day, fraction = record._record.jdsatepoch, record._record.jdsatepochF
        tai = erfa.utctai(day, fraction)
        for minutes, *teme in rows:
            utc = erfa.taiutc(tai[0], tai[1] + minutes / 1440.0)
            year, month, date, clock = erfa.d2dtf("UTC", 9, *utc)
            epoch = (
                f"{year:04d}-{month:02d}-{date:02d}T"
                f"{clock['h']:02d}:{clock['m']:02d}:{clock['s']:02d}.{clock['f']:09d}Z"
            )
            scene["time"] = {"epoch": epoch}
            sim = opened(scene, repo_dir, {"kind": "tle", "lines": list(lines)})
            pose, velocity = state(sim)
            tt = dates.tt_of(sim.system(0).setting.epoch, np.zeros(1))
            back = teme_matrix(float(tt[0][0]), float(tt[1][0])).T
            place, speed = back @ pose[:3] / 1e3, back @ velocity / 1e3
            assert np.abs(place - teme[:3]).max() < 1e-6, (lines, minutes)
            assert np.abs(speed - teme[3:]).max() < 2e-9, (lines, minutes)
            count += 1
    assert count > 600


def test_sgp4_errors_by_name(data_dir, scene, repo_dir):
    """33334 of the verification set fails at its epoch by its perturbed eccentricity."""
    (lines,) = [
        lines for lines, _ in verification_sets(data_dir / "orbits/sgp4") if " 33334" in lines[1]
    ]
    scene["time"]["epoch"] = "2006-06-23T20:36:36Z"
    text = refused(scene, repo_dir, orbit={"kind": "tle", "lines": lines})
    assert "spacecraft.sat: satellite 33334: SGP4 error 3, its perturbed eccentricity" in text


@pytest.mark.parametrize(
    ("code", "text"),
    [(1, "mean eccentricity"), (2, "mean motion"), (3, "perturbed eccentricity"),
     (4, "semi-latus rectum"), (5, "epoch lie below the surface"), (6, "decayed")],
)  # fmt: skip
def test_every_sgp4_error_has_its_name(code, text):
    """The codes of Vallado's sgp4: its header's list."""

    class Record:
        def sgp4_tsince(self, minutes):
            return code, (math.nan,) * 3, (math.nan,) * 3

    sgp4 = tle.Sgp4(tle.parse(*ISS, "here"))
    sgp4._record = Record()
    with pytest.raises(ValueError, match=f"satellite 25544: SGP4 error {code}, .*{text}"):
        sgp4.teme(3.0)


def test_tle_from_a_file(data_dir, scene, repo_dir):
    path = "data:orbits/tle/celestrak_active_sample.tle"
    scene["time"]["epoch"] = "2026-06-12T00:00:00Z"
    by_lines = state(opened(scene, repo_dir, {"kind": "tle", "lines": ISS}))
    by_name = state(opened(scene, repo_dir, {"kind": "tle", "file": path, "name": "ISS (ZARYA)"}))
    assert np.array_equal(by_lines[0], by_name[0])
    assert 6778.0e3 < np.linalg.norm(by_name[0][:3]) < 6808.0e3
    scene["bodies"]["earth"]["kind"] = "mars"
    assert "about the Earth, not mars" in refused(
        scene, repo_dir, orbit={"kind": "tle", "lines": ISS}
    )
    bad = [ISS[0][:-1] + "4", ISS[1]]
    scene["bodies"]["earth"]["kind"] = "earth"
    text = refused(scene, repo_dir, orbit={"kind": "tle", "lines": bad})
    assert "spacecraft.sat: lines, line 1 of the set, column 69: checksum" in text


# --- circles, states, parents -------------------------------------------------------------------


def test_circular_is_the_papers(scene, repo_dir):
    """Listing 4: 1.06396989 radii, turned by (30, 30, 0) deg, 0.01 of a turn a step from 0.3."""
    orbit = {"kind": "circular", "scale": 1.06396989, "rotation_deg": [30.0, 30.0, 0.0],
             "v_step": 0.01, "orbit_start": 0.3}  # fmt: skip
    sim = opened(scene, repo_dir, orbit)
    radius = equator_m(sim)
    for step in (0, 7, 100):
        angle = 2 * math.pi * (0.3 + 0.01 * step)
        flat = np.array([math.cos(angle), math.sin(angle), 0.0]) * radius * 1.06396989
        c, s = math.cos(math.radians(30)), math.sin(math.radians(30))
        about_x = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
        about_y = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
        pose, _ = state(sim, t_s=60.0 * step, index=step)
        assert np.allclose(pose[:3], about_y @ about_x @ flat, rtol=1e-13, atol=1e-6)


def test_state_and_elements_agree(scene, repo_dir):
    """A circular orbit's state, written down, against its elements."""
    gm, r = 398600.4418, 7000.0
    scene["bodies"]["earth"]["gm_km3_s2"] = gm
    v = math.sqrt(gm / r)
    by_state = {"state": {"position_km": [r, 0, 0], "velocity_km_s": [0.0, 0.0, v]}}
    elements = {"semi_major_axis_km": r, "inclination_deg": 90.0, "mean_anomaly_deg": 0.0}
    for t_s in (0.0, 5000.0, 86400.0):
        first = state(opened(scene, repo_dir, by_state), t_s=t_s)
        second = state(opened(scene, repo_dir, elements), t_s=t_s)
        assert np.allclose(first[0][:3], second[0][:3], rtol=0, atol=1e-4)


def test_any_parent_in_any_order(scene, repo_dir):
    """A satellite of an asteroid mesh around a moonlet around the Earth: places add up."""
    sat = scene["spacecraft"]["sat"]
    around = {"inclination_deg": 20.0, "mean_anomaly_deg": 30.0}
    scene["bodies"]["moonlet"] = {
        "kind": "ellipsoid", "radii_km": [30.0, 20.0, 10.0], "gm_km3_s2": 1e-3, "albedo": 0.3,
        "orbit": {"around": "earth", "semi_major_axis_km": 20000.0, **around},
    }  # fmt: skip
    rock = {**sat, "size_m": 500.0, "gm_km3_s2": 1e-9, "orbit": {
        "around": "moonlet", "semi_major_axis_km": 60.0, **around}}  # fmt: skip
    near = {**sat, "orbit": {"around": "rock", "altitude_km": 0.2, **around}}
    scene["spacecraft"] = {"sat": near, "rock": rock}
    found = opened(scene, repo_dir).system(0).states(np.array([0.0, 1000.0]))
    places = {name: pose[:, :3] for name, pose in found.poses.items()}
    assert np.allclose(np.linalg.norm(places["moonlet"], axis=1), 2e7)
    assert np.allclose(np.linalg.norm(places["rock"] - places["moonlet"], axis=1), 6e4)
    radius = opened(scene, repo_dir).models["rock"].radius_m
    gaps = np.linalg.norm(places["sat"] - places["rock"], axis=1)
    assert np.allclose(gaps, radius + 200.0, rtol=0, atol=1e-3)


def test_below_the_surface_names_the_orbit(scene, repo_dir):
    """Hard case: an ellipse that dips into the ground between its ends, and a place inside."""
    orbit = {"periapsis_km": 6370.0, "eccentricity": 0.02, "mean_anomaly_deg": 180.0}
    sim = opened(scene, repo_dir, orbit)  # above the poles' radius, below the equator's
    half = math.pi * math.sqrt((6370e3 / 0.98) ** 3 / 3.986e14)
    with pytest.raises(ValueError, match=r"spacecraft\.sat\.orbit: at 2026-.* below the surface"):
        sim.system(0).states(np.array([half]))
    text = refused(scene, repo_dir, orbit={"position_km": [100.0, 0.0, 0.0]})
    assert "spacecraft.sat.orbit: at 2026-03-20T12:00:00.000Z it is 6278." in text
    text = refused(scene, repo_dir, orbit={"kind": "circular", "scale": 0.9, "v_step": 0.0})
    assert "below the surface of earth" in text


# --- j2 and tables ------------------------------------------------------------------------------


def test_j2_turns_the_node(scene, repo_dir):
    """Science sheet, section 2.2: a = 7078.137 km, e = 0.001, i = 98.19 deg: 0.98589 deg a day.

    That table takes R = 6378.137 km and the pole of the elements; ours is EGM96's radius and the
    pole of date, 0.15 deg away: 0.2 % of the rate.
    """
    orbit = {"kind": "j2", "semi_major_axis_km": 7078.137, "eccentricity": 0.001,
             "inclination_deg": 98.19, "mean_anomaly_deg": 0.0}  # fmt: skip
    sim = opened(scene, repo_dir, orbit)

    def node(t_s):
        pose, velocity = state(sim, t_s=t_s)
        normal = np.cross(pose[:3], velocity)
        return math.degrees(math.atan2(normal[0], -normal[1]))

    assert (node(10 * 86400.0) - node(0.0)) / 10 == pytest.approx(0.98589, rel=0.02)
    scene["bodies"]["earth"]["kind"] = "venus"
    assert "oblateness of earth is not known" in refused(scene, repo_dir, orbit=orbit)
    assert opened(scene, repo_dir, {**orbit, "j2": 4.4e-6})


def test_sun_synchronous_node_follows_the_sun(scene, repo_dir):
    """360 deg in a year within 0.5 %: the database's inclination with the propagator j2."""
    orbit = {"kind": "database", "class": "SSO", "propagator": "j2", "altitude_km": 700.0}
    sim = opened(scene, repo_dir, orbit)
    turned, before = 0.0, None
    for day in range(0, 366, 5):
        pose, velocity = state(sim, t_s=day * 86400.0)
        normal = np.cross(pose[:3], velocity)
        angle = math.atan2(normal[0], -normal[1])
        if before is not None:
            turned += math.remainder(angle - before, 2 * math.pi)
        before = angle
    assert math.degrees(turned) * 365.242189 / 365 == pytest.approx(360.0, rel=5e-3)


@pytest.mark.parametrize("name", ["GEO_60s", "LEO_60s", "MEO_60s"])
def test_oem_between_its_lines(data_dir, scene, repo_dir, tmp_path, name):
    """Every second line left out and asked for: to 1 mm, and velocities to 1e-5 m/s; degree 9."""
    from perilune.orbits.ephemerides import oem

    path = data_dir / f"orbits/oem/{name}.oem"
    (segment,) = oem.parse(path)
    texts, count = [], 0
    for line in path.read_text().splitlines():
        if line[:4].isdigit():
            count += 1
            if count % 2 == 0 and count < len(segment.times):
                continue
        texts.append(line)
    thinned = tmp_path / "thinned.oem"
    thinned.write_text("\n".join(texts))
    scene["time"]["epoch"] = segment.times[0][:19] + "Z"
    sim = opened(scene, repo_dir, {"kind": "table", "file": str(thinned), "degree": 9})
    setting = sim.system(0).setting
    t_s, states = oem.states(segment, setting.epoch, path)
    found = sim.system(0).states(t_s)
    worst = np.linalg.norm(found.poses["sat"][:, :3] - states[:, :3], axis=1)
    # at the ends, where the polynomials are one-sided, the low orbit is good to 2 cm
    assert worst[10:-10].max() < 1e-3
    assert worst.max() < 2e-2
    # the files' velocities are not quite their places' derivatives (up to 0.05 m/s)
    assert np.abs(found.velocities_m_s["sat"] - states[:, 3:]).max() < 0.06


def test_table_errors(scene, repo_dir, tmp_path):
    path = tmp_path / "a.csv"
    rows = [f"{60 * k},{7000 + k},0,0" for k in range(20)]
    path.write_text("\n".join(["t_s,x_km,y_km,z_km", *rows]))
    sim = opened(scene, repo_dir, {"kind": "table", "file": str(path)})
    assert state(sim, t_s=90.0)[0][0] == pytest.approx(7001.5e3)
    assert state(sim, t_s=90.0)[1][0] == pytest.approx(1000 / 60)
    with pytest.raises(ValueError, match=r"a\.csv: covers 2026-03-20T12:00:00"):
        sim.system(0).states(np.array([5000.0]))
    path.write_text("\n".join(["t_s,x_km,y_km,z_km", *rows, "x,1,2,3"]))
    text = refused(scene, repo_dir, orbit={"kind": "table", "file": str(path)})
    assert "spacecraft.sat: " in text
    assert "a.csv, line 22, column t_s: 'x' is not a number" in text
    with pytest.raises(FileNotFoundError, match=r"spacecraft\.sat\.orbit\.file: no such file"):
        opened(scene, repo_dir, {"kind": "table", "file": "no.csv"})


def test_oem_of_another_centre(data_dir, scene, repo_dir):
    scene["bodies"]["earth"]["kind"] = "mars"
    orbit = {"kind": "table", "file": "data:orbits/oem/GEO_60s.oem"}
    assert "CENTER_NAME is Earth, but the orbit is around earth" in refused(
        scene, repo_dir, orbit=orbit
    )


# --- numerical ----------------------------------------------------------------------------------


def test_numerical_without_forces_is_kepler(scene, repo_dir):
    elements = {"altitude_km": 600.0, "eccentricity": 0.1, "inclination_deg": 40.0,
                "mean_anomaly_deg": 10.0}  # fmt: skip
    t_s = np.array([0.0, 5e4, -5e4])
    first = opened(scene, repo_dir, {"kind": "numerical", "rtol": 1e-13, **elements}).system(0)
    second = opened(scene, repo_dir, elements).system(0)
    away = first.states(t_s).poses["sat"][:, :3] - second.states(t_s).poses["sat"][:, :3]
    assert np.linalg.norm(away, axis=1).max() < 1e-2


def test_numerical_with_every_force(data_dir, scene, repo_dir):
    """J2's nodal drift appears, and each further force moves the satellite, by sizes of the science
    sheet's ladder (section 2.5): kilometres, then metres."""
    elements = {"altitude_km": 500.0, "inclination_deg": 51.6, "mean_anomaly_deg": 0.0}
    zonal = {"harmonics": {"degree": 6}}
    field = {"harmonics": {"file": "data:orbits/gravity/EGM96-truncated-21x21", "degree": 8}}
    more = {**field, "third_bodies": ["sun", "moon"], "drag": {"area_to_mass_m2_kg": 0.01},
            "radiation_pressure": {"area_to_mass_m2_kg": 0.02}}  # fmt: skip
    places = []
    for forces in ({}, zonal, field, more):
        orbit = {"kind": "numerical", "forces": forces, **elements}
        places.append(state(opened(scene, repo_dir, orbit), t_s=6 * 3600.0)[0][:3])
    steps = [float(np.linalg.norm(b - a)) for a, b in itertools.pairwise(places)]
    assert 5e4 < steps[0] < 1e6
    assert 1e2 < steps[1] < 2e4
    assert 1.0 < steps[2] < 5e3
    missing = {"harmonics": {"file": "no.gfc", "degree": 4}}
    with pytest.raises(FileNotFoundError, match=r"sat\.orbit\.forces\.harmonics\.file"):
        opened(scene, repo_dir, {"kind": "numerical", "forces": missing, **elements})


def test_a_fall_is_refused(scene, repo_dir):
    falls = {"position_km": [7000.0, 0.0, 0.0], "velocity_km_s": [0.0, 1.0, 0.0]}
    for kind in ("kepler", "j2", "numerical"):
        text = refused(scene, repo_dir, orbit={"kind": kind, "state": falls})
        assert "spacecraft.sat: the periapsis, 62.0" in text


def test_spice_through_the_configuration(scene, repo_dir, tmp_path):
    """A kernel made here, of a probe that stands still 7000 km from the Earth."""
    spice = pytest.importorskip("spiceypy")
    epoch = opened(scene, repo_dir).system(0).setting.epoch
    times = (epoch.day - 2451545.0 + epoch.fraction) * 86400.0 + np.arange(-2, 9) * 60.0
    states = np.tile([7000.0, 10.0, -20.0, 0.0, 0.0, 0.0], (len(times), 1))
    handle = spice.spkopn(str(tmp_path / "a.bsp"), "test", 0)
    span = (times[0], times[-1], "probe", 3, len(times))
    spice.spkw09(handle, -999, 399, "J2000", *span, states, times)
    spice.spkcls(handle)
    orbit = {"kind": "spice", "kernels": [str(tmp_path / "a.bsp")], "target": "-999"}
    sim = opened(scene, repo_dir, orbit)
    assert np.allclose(state(sim, t_s=100.0)[0][:3], [7e6, 1e4, -2e4], rtol=0, atol=1e-6)
    with pytest.raises(ValueError, match=r"spacecraft\.sat: SPICE: .*a\.bsp"):
        sim.system(0).states(np.array([1e6]))
    missing = {**orbit, "kernels": ["no.bsp"]}
    with pytest.raises(FileNotFoundError, match=r"sat\.orbit\.kernels\[0\]: no such file"):
        opened(scene, repo_dir, missing)
