"""Seconds are those of TT and UTC; proper motion goes on; kernels place planets."""

from __future__ import annotations

import json
import math
import multiprocessing

import erfa
import numpy as np
import pytest

import perilune
from perilune.cli import main
from perilune.config import ConfigError
from perilune.orbits import solar_system
from perilune.orbits.dates import seconds_of, tt_of, utc_of
from perilune.orbits.solar_system import Date, date_from_utc
from perilune.sky.skies import directions, years_since
from perilune.sky.star_files import read_stars

spiceypy = pytest.importorskip("spiceypy")

EPOCH = date_from_utc((2026, 1, 3, 12, 0, 0.0))
HOUR = 3600.0


def base():
    return {
        "version": 1,
        "time": {"epoch": "2026-01-03T12:00:00Z", "step_s": HOUR},
        "root": "earth",
        "bodies": {"earth": {"kind": "earth"}},
        "camera": {
            "width": 32, "height": 24, "fov_deg": 30.0,
            "trajectory": {"kind": "fixed", "target": "earth", "position_m": [2e7, 0, 0]},
        },
    }  # fmt: skip


def test_an_hour_is_an_hour_of_utc():
    """By SOFA alone: 3600 s of TDB at perihelion are 1.1 us less, 9 mm in low orbit."""
    for count in (1, 24, 1000):
        later = EPOCH.after(count * HOUR)
        tt = tt_of(EPOCH, np.array([count * HOUR]))
        start = tt_of(EPOCH, np.zeros(1))
        passed = ((tt[0] - start[0]) + (tt[1] - start[1])) * 86400.0
        assert passed[0] == pytest.approx(count * HOUR, abs=1e-9 + 1e-15 * count * HOUR)
        tdb = ((later.day - EPOCH.day) + (later.fraction - EPOCH.fraction)) * 86400.0
        gained = erfa.dtdb(later.day, later.fraction, 0, 0, 0, 0) - erfa.dtdb(
            EPOCH.day, EPOCH.fraction, 0, 0, 0, 0
        )
        assert tdb - count * HOUR == pytest.approx(float(gained), abs=2e-10 * max(1, count / 100))
        if count < 25:
            utc = erfa.dtf2d("UTC", 2026, 1, 3 + count // 24, 12 + count % 24, 0, 0.0)
            mine = utc_of(EPOCH, np.array([count * HOUR]))
            off = ((mine[0][0] - utc[0]) + (mine[1][0] - utc[1])) * 86400.0
            assert abs(off) < 1e-9


def test_dates_of_files_are_whole_seconds_apart():
    texts = ["2026-01-03T12:00:00", "2026-01-03T13:00:00", "2026-01-04T12:00:00"]
    found = seconds_of(texts, "UTC", EPOCH)
    assert np.abs(found - [0.0, HOUR, 24 * HOUR]).max() < 1e-9  # 1.1 us and 27 us before
    assert np.abs(seconds_of(texts, "TAI", EPOCH) + 37.0 - found).max() < 1e-9
    tdb = seconds_of(texts, "TDB", EPOCH)
    assert np.abs(np.diff(tdb - found)).max() > 1e-8


def test_a_leap_second_is_a_second():
    before = date_from_utc((2016, 12, 31, 23, 59, 59.0))
    assert before.after(1.0).utc() == "2016-12-31T23:59:60.000Z"
    assert before.after(2.0).utc() == "2017-01-01T00:00:00.000Z"


def test_an_orbit_goes_through_an_oem_to_a_micrometre(tmp_path, repo_dir):
    """Elements propagated for a day, and the same from the file: 0.2 m apart before."""
    tree = base()
    tree["spacecraft"] = {
        "sat": {
            "model": str(repo_dir / "assets/models/smallsat.glb"), "size_m": 2.0,
            "orbit": {"around": "earth", "altitude_km": 500.0, "inclination_deg": 51.6,
                      "mean_anomaly_deg": 0.0},
        }
    }  # fmt: skip
    tree["time"]["step_s"] = 60.0
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(tree))
    out = tmp_path / "sat.oem"
    words = ["--frames", "0:200", "--out", str(out), "--object", "sat"]
    assert main(["orbit", str(path), *words]) == 0
    times = [line.split()[0] for line in out.read_text().splitlines() if line[:4] == "2026"]
    assert times[60].startswith("2026-01-03T13:00:00.000000")
    direct = perilune.open(tree)
    tree["spacecraft"]["sat"]["orbit"] = {"around": "earth", "kind": "table", "file": str(out)}
    read = perilune.open(tree)
    for step in (60, 180):
        a, b = (sim.world(step).position_m("sat") for sim in (direct, read))
        assert np.linalg.norm(a - b) < 2e-5  # the file's digits


@pytest.mark.filterwarnings("ignore:ERFA function .pmsafe. yielded")  # no parallax
def test_proper_motion_goes_on(tmp_path):
    """Barnard's star in the frames of ten years, to 0.01 arcseconds."""
    stars = tmp_path / "stars.csv"
    head = "ra_deg,dec_deg,vmag,pm_ra_mas_yr,pm_dec_mas_yr"
    stars.write_text(f"{head}\n269.45,4.69,-8.0,-802.8,10362.5\n")
    tree = base()
    tree["time"]["step_s"] = 86400.0 * 91.3125
    tree["sky"] = {"stars": {"catalogue": str(stars), "aberration": False}}
    sim = perilune.open(tree)
    ra, dec = math.radians(269.45), math.radians(4.69)
    table = read_stars(stars)
    for index in (0, 1, 40):
        years = (EPOCH.day + EPOCH.fraction - 2451545.0) / 365.25 + index * 0.25
        since = years_since(table, index * 0.25)
        assert abs(since - index * 0.25) * 10.4 < 0.011  # arcseconds
        moved = directions(table, years - index * 0.25 + since)[0]
        # SOFA's own, for a star so far away that perspective does not count.
        r, d, *_ = erfa.pmsafe(
            ra, dec, math.radians(-802.8 / 3.6e6) / math.cos(dec), math.radians(10362.5 / 3.6e6),
            1e-7, 0.0, 2451545.0, 0.0, 2451545.0, years * 365.25,
        )  # fmt: skip
        expected = erfa.s2c(r, d)
        off = math.degrees(float(np.linalg.norm(moved - expected))) * 3600.0
        assert off < 0.02
    assert sim.request(0)["sky"]["stars"] is sim.request(0)["sky"]["stars"]
    assert sim.request(0)["sky"]["stars"] is not sim.request(1)["sky"]["stars"]


def write_spk(path, bodies_m, centre=0, days=40.0, start=EPOCH):
    """A kernel (type 9) of straight lines: number -> (position, velocity) about `centre`."""
    handle = spiceypy.spkopn(str(path), "test", 0)
    et = (start.day - 2451545.0 + start.fraction) * 86400.0
    epochs = et + np.linspace(-days, days, 81) * 86400.0
    for number, (place, velocity) in bodies_m.items():
        rows = np.concatenate(
            [place + np.outer(epochs - et, velocity), np.tile(velocity, (len(epochs), 1))], axis=1
        )
        spiceypy.spkw09(
            handle, number, centre, "J2000", epochs[0], epochs[-1], str(number), 3, len(epochs),
            (rows / 1e3).tolist(), epochs.tolist(),
        )  # fmt: skip
    spiceypy.spkcls(handle)


PLACES = {
    10: (np.array([1e8, -5e8, 2e7]), np.array([3.0, 12.0, 0.1])),
    399: (np.array([1.0e11, -1.1e11, 2e9]), np.array([2.1e4, 2.0e4, 10.0])),
    5: (np.array([-3e11, 7e11, 1e10]), np.array([-1.2e4, -4e3, 50.0])),
    301: (np.array([1.0e11 + 3.8e8, -1.1e11, 2e9]), np.array([2.1e4, 2.1e4, 10.0])),
}


@pytest.fixture
def kernel(tmp_path):
    path = tmp_path / "small.bsp"
    write_spk(path, PLACES)
    return path


def of_kernel(tree, kernel):
    tree["ephemeris"] = {"kernels": [str(kernel)]}
    tree["bodies"] |= {"jupiter": {"kind": "jupiter"}, "moon": {"kind": "moon"}}
    return tree


def test_kernels_place_bodies_and_the_sun(kernel):
    sim = perilune.open(of_kernel(base(), kernel))
    world = sim.world(5)
    later = solar_system.tdb_s(EPOCH, np.array([5 * HOUR]))[0]
    at = {number: place + later * velocity for number, (place, velocity) in PLACES.items()}
    assert np.abs(world.position_m("jupiter") - (at[5] - at[399])).max() < 1.0
    assert np.abs(world.position_m("moon") - (at[301] - at[399])).max() < 0.01
    assert np.abs(world.sun_position_m - (at[10] - at[399])).max() < 1.0
    series = perilune.open({**base(), "bodies": {"earth": {"kind": "earth"}}}).world(5)
    assert np.linalg.norm(series.sun_position_m - world.sun_position_m) > 1e9


def test_what_no_kernel_has_is_an_error(kernel, tmp_path):
    tree = of_kernel(base(), kernel)
    tree["bodies"]["mars"] = {"kind": "mars"}
    with pytest.raises(ConfigError, match=r"no mars \(SPICE's 499 or 4\) in .*small\.bsp"):
        perilune.open(tree)
    tree = of_kernel(base(), kernel)
    tree["time"]["epoch"] = "2030-01-03T12:00:00Z"
    with pytest.raises(ConfigError, match=r"SPICE: .*small\.bsp"):
        perilune.open(tree)
    (tmp_path / "text.bsp").write_text("KPL/PCK\n")
    with pytest.raises(ConfigError, match=r"text\.bsp: no SPICE kernel of places"):
        perilune.open(of_kernel(base(), tmp_path / "text.bsp"))
    with pytest.raises(ConfigError, match=r"ephemeris\.kernels.*nowhere\.bsp"):
        perilune.open(of_kernel(base(), tmp_path / "nowhere.bsp"))


def test_a_moon_without_a_kernel_keeps_its_series(kernel):
    tree = of_kernel(base(), kernel)
    tree["bodies"]["europa"] = {"kind": "europa"}
    world = perilune.open(tree).world(0)
    from_planet = world.position_m("europa") - world.position_m("jupiter")
    expected = solar_system.relative_m("europa", "jupiter", EPOCH)
    assert np.abs(from_planet - expected).max() < 1.0


def _place(sim, index, queue):
    queue.put(sim.world(index).position_m("jupiter").tolist())


@pytest.mark.parametrize("method", ["fork", "spawn"])
@pytest.mark.filterwarnings("ignore:.*multi-threaded.*fork:DeprecationWarning")
def test_workers_open_kernels_of_their_own(kernel, method):
    sim = perilune.open(of_kernel(base(), kernel))
    expected = sim.world(3).position_m("jupiter").tolist()
    context = multiprocessing.get_context(method)
    queue = context.Queue()
    workers = [context.Process(target=_place, args=(sim, 3, queue)) for _ in range(2)]
    for worker in workers:
        worker.start()
    assert [queue.get(timeout=120) for _ in workers] == [expected, expected]
    for worker in workers:
        worker.join()


def test_info_and_plan_say_where_places_come_from(kernel, tmp_path, capsys):
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(of_kernel(base(), kernel)))
    assert main(["info", str(path)]) == 0
    out = capsys.readouterr().out
    assert f"bodies.jupiter: its place is from {kernel}" in out
    tree = base()
    tree["bodies"]["jupiter"] = {"kind": "jupiter"}
    path.write_text(json.dumps(tree))
    assert main(["info", str(path), "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["places"]
    assert rows["bodies.jupiter"].startswith("series, within 310 000 km")
    assert main(["plan", str(path)]) == 0
    assert "bodies.jupiter: its place is from series, within 310 000 km" in capsys.readouterr().out


def test_the_date_of_a_frame_is_whole(repo_dir):
    sim = perilune.open(base())
    assert [sim.world(k).date.utc(9) for k in (1, 24)] == [
        "2026-01-03T13:00:00.000000000Z", "2026-01-04T12:00:00.000000000Z",
    ]  # fmt: skip
    assert isinstance(sim.world(1).date, Date)
