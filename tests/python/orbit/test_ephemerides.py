"""Readers of two-line elements, OEM files and tables; frames; SPICE kernels made here."""

from __future__ import annotations

import io

import erfa
import numpy as np
import pytest

from perilune.orbits import dates
from perilune.orbits.ephemerides import csv_table, frames, oem, tle
from perilune.orbits.solar_system import date_from_utc

EPOCH = date_from_utc((2026, 3, 20, 12, 0, 0.0))
ISS = (
    "1 25544U 98067A   26162.96453450  .00008067  00000+0  15344-3 0  9993",
    "2 25544  51.6334 325.9414 0004931 175.6343 184.4689 15.49182446570947",
)


# --- dates -------------------------------------------------------------------------------------


def test_scales():
    """TT - UTC is 69.184 s since 2017, TAI - GPS 19 s (IERS Bulletin C); TDB - TT < 2 ms."""
    for text, scale in (
        ("2026-03-20T12:00:00", "UTC"),
        ("2026-079T12:00:00Z", "UTC"),
        ("2026-03-20T12:00:37", "TAI"),
        ("2026-03-20T12:00:18", "GPS"),
        ("2026-03-20T12:01:09.184", "TT"),
    ):
        assert abs(dates.seconds_of([text], scale, EPOCH)[0]) < 2e-5, (text, scale)
    assert 0 < abs(dates.seconds_of(["2026-03-20T12:01:09.184"], "TDB", EPOCH)[0]) < 2e-3


def test_leap_second_is_a_second():
    before = date_from_utc((2016, 12, 31, 23, 59, 59.0))
    texts = ["2016-12-31T23:59:60.5", "2017-01-01T00:00:00", "2016-366T23:59:59"]
    found = dates.seconds_of(texts, "UTC", before)
    assert np.allclose(found, [1.5, 2.0, 0.0], rtol=0, atol=1e-6)


@pytest.mark.parametrize(
    "text",
    ["20 March", "2026-13-01", "2026-01-01T10:00:60", "2026-366", "2026-03-20T12:00:00+01:00"],
)
def test_bad_dates(text):
    with pytest.raises(ValueError, match="date"):
        dates.seconds_of([text], "UTC", EPOCH)


# --- frames ------------------------------------------------------------------------------------


@pytest.mark.parametrize("year", [1980, 2000, 2026, 2050])
def test_teme_by_another_way(year):
    """Through the rotating Earth: GMST of 1982 to it, IAU 2006/2000A back, 0.1 arcsec at most."""
    epoch = date_from_utc((year, 7, 1, 6, 0, 0.0))
    t_s = np.arange(10) * 20 * 86400.0
    tt, utc = dates.tt_of(epoch, t_s), dates.utc_of(epoch, t_s)
    found = frames.teme_to_icrf(epoch, t_s)
    for k in range(len(t_s)):
        spin = erfa.rz(erfa.gmst82(utc[0][k], utc[1][k]), np.eye(3))
        celestial = erfa.c2t06a(tt[0][k], tt[1][k], utc[0][k], utc[1][k], 0.0, 0.0)
        turn = found[k].T @ celestial.T @ spin
        sine = [turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]
        assert np.degrees(np.linalg.norm(sine) / 2) * 3600 < 0.1


def test_frames_by_name():
    t_s = np.zeros(1)
    assert np.array_equal(frames.to_icrf("GCRF", EPOCH, t_s)[0], np.eye(3))
    bias = frames.to_icrf("EME2000", EPOCH, t_s)[0]
    # IERS Conventions 2010, section 5.4.4: 17 and 7 mas of the pole, 15 mas of the origin
    assert 1e-8 < np.abs(bias - np.eye(3)).max() < 1.1e-7
    with pytest.raises(ValueError, match=r"'ITRF2000'.*ICRF, GCRF, EME2000, TEME"):
        frames.to_icrf("ITRF2000", EPOCH, t_s)


# --- two-line elements -------------------------------------------------------------------------


def test_reads_a_real_catalogue(data_dir):
    path = data_dir / "orbits/tle/celestrak_active_sample.tle"
    assert sum(1 for _ in tle.sets(path)) == 1740
    by_name, by_number = tle.read(path, "iss (zarya)", None), tle.read(path, None, 25544)
    assert by_name == by_number
    assert by_name.lines == ISS
    with pytest.raises(ValueError, match=r"'ISS \(ZARIA\)'; did you mean 'ISS \(ZARYA\)'"):
        tle.read(path, "ISS (ZARIA)", None)
    with pytest.raises(ValueError, match="no set of catalogue number 3"):
        tle.read(path, None, 3)
    with pytest.raises(ValueError, match="has 1740 sets"):
        tle.read(path, None, None)


def test_alpha5():
    """Space-Track's table: A is 10, I and O are left out, Z is 33."""
    for text, number in (("A0000", 100000), ("E8493", 148493), ("J2931", 182931), ("P4018", 234018),
                         ("Z9999", 339999), ("25544", 25544), ("    5", 5)):  # fmt: skip
        assert tle.catalogue_number(text) == number


def fixed(line):
    return line[:68] + str(tle.checksum(line))


@pytest.mark.parametrize(
    ("line", "change", "text"),
    [
        (0, lambda s: s[:68] + "4", "line 1 of the set, column 69: checksum '4' should be 3"),
        (0, lambda s: s[:60], "has 60 columns"),
        (0, lambda s: fixed(s[:18] + "26x62" + s[23:]), r"columns 19 to 32: '26x62.*no epoch"),
        (0, lambda s: fixed(s[:2] + "I5544" + s[7:]), "no catalogue number"),
        (0, lambda s: fixed(s[:53] + " 15344 3" + s[61:]), "columns 54 to 61.*no drag term"),
        (1, lambda s: fixed(s[:8] + " 51,6334" + s[16:]), "no inclination"),
        (1, lambda s: fixed(s[:2] + "25545" + s[7:]), "two satellites, 25544 and 25545"),
        (1, lambda s: fixed(s[:25] + "1" + s[26:]), "column 26: must be blank"),
        (1, lambda s: "1" + s[1:], "no line number"),
    ],
)
def test_faulty_lines(line, change, text):
    lines = list(ISS)
    lines[line] = change(lines[line])
    with pytest.raises(ValueError, match=text):
        tle.parse(*lines, "here")


def test_line_two_missing(tmp_path):
    path = tmp_path / "a.tle"
    path.write_text("ISS\n" + ISS[0] + "\n")
    with pytest.raises(ValueError, match=r"a\.tle, line 3: must be line 2"):
        tle.read(path, None, None)


# --- OEM ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["GEO_60s", "LEO_60s", "MEO_60s", "ISS.resampled.truncated"])
def test_oem_as_another_reader(data_dir, name):
    """The states of each line as the package `oem` reads them; EME2000 turned by its bias."""
    from astropy.time import Time
    from oem import OrbitEphemerisMessage

    path = next((data_dir / "orbits/oem").glob(name + ".*"))
    (segment,) = oem.parse(path)
    t_s, states = oem.states(segment, EPOCH, path)
    theirs = list(OrbitEphemerisMessage.open(path).states)
    assert len(theirs) == len(t_s) > 20
    turn = frames.to_icrf(segment.meta["REF_FRAME"], EPOCH, t_s)[0]
    for k in (0, 7, len(t_s) - 1):
        expected = np.concatenate([turn @ theirs[k].position, turn @ theirs[k].velocity]) * 1e3
        assert np.allclose(states[k], expected, rtol=1e-14, atol=1e-9)
        start = Time(EPOCH.day, EPOCH.fraction, format="jd", scale="tdb")
        # astropy's own TDB of the epoch, which takes the place on Earth of UT1 otherwise: 2 us
        assert abs(t_s[k] - (theirs[k].epoch.tt - start.tt).sec) < 5e-6
    spacing = np.diff([row.epoch.tt.unix_tai for row in theirs[:3]])
    assert np.abs(np.diff(t_s[:3]) - spacing).max() < 1e-6


def write_message(path, **changes):
    meta = {"OBJECT_NAME": "A", "OBJECT_ID": "1", "CENTER_NAME": "EARTH", "REF_FRAME": "ICRF"}
    file = io.StringIO()
    oem.write_header(file, "2026-01-01T00:00:00", "TEST")
    times = [f"2026-03-20T12:0{k}:00" for k in range(3)]
    states = np.arange(18.0).reshape(3, 6) * 1e6 / 3
    oem.write_segment(file, meta, times, states)
    text = file.getvalue()
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new)
    path.write_text(text)
    return states


def test_oem_round_trip(tmp_path):
    path = tmp_path / "a.oem"
    expected = write_message(path)
    (segment,) = oem.parse(path)
    t_s, states = oem.states(segment, EPOCH, path)
    assert np.array_equal(states / 1e3, expected / 1e3)
    assert np.allclose(t_s, [0.0, 60.0, 120.0], rtol=0, atol=1e-6)


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"TIME_SYSTEM = UTC": "TIME_SYSTEM = SCLK"}, r"a\.oem, line 5: TIME_SYSTEM 'SCLK'"),
        ({"REF_FRAME = ICRF": "REF_FRAME = ITRF97"}, r"line 5: no reference frame 'ITRF97'"),
        ({"REF_FRAME = ICRF\n": ""}, "line 5: the segment has no REF_FRAME"),
        ({"T12:01:00 ": "T12:00:00 "}, r"a\.oem, line 16: its time is not after"),
        ({"T12:01:00 ": "T12:01:00 x"}, r"a\.oem, line 16: not a number"),
        ({"T12:01:00 ": "T12:01:00 1 2 "}, r"line 16: a line has a date and 6 numbers"),
        ({"CCSDS_OEM_VERS = 2.0\n": ""}, r"line 1: an OEM begins with CCSDS_OEM_VERS"),
        ({"T12:02:00 ": "T12:02:61 "}, r"line 5:.*date"),
        ({"META_START\n": ""}, r"a\.oem, line 12: 'META_STOP' is not expected here"),
        ({"META_START\n": "COVARIANCE_STOP\n"}, "'COVARIANCE_STOP' is not expected here"),
        ({"META_START\n": "COVARIANCE_START\nMETA_START\n"}, "'COVARIANCE_START' is not expected"),
    ],
)
def test_faulty_oem(tmp_path, changes, text):
    path = tmp_path / "a.oem"
    write_message(path, **changes)
    with pytest.raises(ValueError, match=text):
        oem.states(oem.parse(path)[0], EPOCH, path)


def test_files_that_are_not_text(tmp_path):
    """Errors name the file, as those of its lines do."""
    path = tmp_path / "a.oem"
    path.write_bytes(b"CCSDS_OEM_VERS = 2.0\nCOMMENT \xff\n")
    for read in (oem.parse, csv_table.read):
        with pytest.raises(ValueError, match=r"a\.oem: not UTF-8 text: .*0xff"):
            read(path)


# --- CSV ---------------------------------------------------------------------------------------


def table(tmp_path, text):
    path = tmp_path / "a.csv"
    path.write_text(text)
    return path


def test_csv_units(tmp_path):
    path = table(tmp_path, "# notes\nt_s,x_km,y_km,z_km,vx_m_s,vy_m_s,vz_m_s\n0,1,2,3,4,5,6\n"
                           "\n10,2,3,4,5,6,7\n")  # fmt: skip
    t_s, states = csv_table.states(path, EPOCH)
    assert t_s.tolist() == [0.0, 10.0]
    assert states.tolist() == [[1e3, 2e3, 3e3, 4.0, 5.0, 6.0], [2e3, 3e3, 4e3, 5.0, 6.0, 7.0]]


def test_csv_of_objects(tmp_path):
    rows = "time_utc,object,x_m,y_m,z_m\n"
    for k, time in enumerate(("2026-03-20T12:00:00Z", "2026-03-20T12:01:00.5Z")):
        rows += f"{time},moon,{100 + k},0,0\n{time},sat,{103 + k},{k},0\n"
    path = table(tmp_path, rows)
    t_s, places = csv_table.states(path, EPOCH, "sat", "moon")
    assert np.allclose(t_s, [0.0, 60.5], rtol=0, atol=1e-6)
    assert places.tolist() == [[3.0, 0.0, 0.0], [3.0, 1.0, 0.0]]
    with pytest.raises(ValueError, match="say which by the key `object`"):
        csv_table.states(path, EPOCH)
    with pytest.raises(ValueError, match=r"no object 'mon'; did you mean 'moon'"):
        csv_table.states(path, EPOCH, "sat", "mon")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "empty"),
        ("t_s,x_km,y_km,z_km\n0,1,2,3\n", "at least two lines"),
        ("t_s,x_km,y_km,z_km\n0,1,2,3\n1,2,3\n", r"a\.csv, line 3: has 3 fields"),
        ("t_s,x_km,y_km,z_km\n0,1,2,3\n1,2,3,y\n", r"line 3, column z_km: 'y' is not a number"),
        ("t_s,x_km,y_km,z_km\n0,1,2,3\n1,2,3,nan\n", r"line 3, column z_km: not finite"),
        ("t_s,x_km,y_km,z_km\n0,1,2,3\n0,1,2,3\n", r"line 3: its time is not after"),
        ("x_km,y_km,z_km\n1,2,3\n1,2,3\n", "t_s or time_utc"),
        ("t_s,x_km,z_km\n0,1,2\n1,1,2\n", "has x_km but no y_km"),
        ("t_s,a,b\n0,1,2\n1,1,2\n", "needs columns x_km"),
        ("t_s,x_km,y_km,x_km\n0,1,2,3\n1,1,2,3\n", "column 'x_km' occurs twice"),
    ],
)
def test_faulty_csv(tmp_path, text, message):
    with pytest.raises(ValueError, match=message):
        csv_table.states(table(tmp_path, text), EPOCH)


def test_csv_attitudes(tmp_path):
    path = table(tmp_path, "t_s,qw,qx,qy,qz\n0,2,0,0,0\n1,0,0,3,0\n")
    t_s, q = csv_table.attitudes(path, EPOCH)
    assert t_s.tolist() == [0.0, 1.0]
    assert q.tolist() == [[1, 0, 0, 0], [0, 0, 1, 0]]
    with pytest.raises(ValueError, match="line 3: a quaternion is zero"):
        csv_table.attitudes(table(tmp_path, "t_s,qw,qx,qy,qz\n0,2,0,0,0\n1,0,0,0,0\n"), EPOCH)


# --- SPICE -------------------------------------------------------------------------------------


@pytest.fixture
def kernel(tmp_path):
    """An SPK of type 9 made here: a helix of body -999 about the Earth, degree 3."""
    spice = pytest.importorskip("spiceypy")
    path = tmp_path / "probe.bsp"
    start = (EPOCH.day - 2451545.0) * 86400.0 + EPOCH.fraction * 86400.0
    times = start + np.arange(-2, 20) * 60.0
    since = times - start
    states = np.stack([7000 + 0.01 * since, 3 - 0.02 * since, 0.001 * since**2, 0.01 + 0 * since,
                       -0.02 + 0 * since, 0.002 * since], axis=1)  # fmt: skip
    handle = spice.spkopn(str(path), "test", 0)
    spice.spkw09(handle, -999, 399, "J2000", times[0], times[-1], "probe", 3, len(times), states,
                 times)  # fmt: skip
    spice.spkcls(handle)
    return path


def test_spice(kernel):
    from perilune.orbits.ephemerides.spice import Spice

    t_s = np.array([0.0, 100.0, 333.0])
    states = Spice((kernel,), "-999", "EARTH").states(EPOCH, t_s)
    expected = np.stack([7000 + 0.01 * t_s, 3 - 0.02 * t_s, 0.001 * t_s**2], axis=1) * 1e3
    # SPICE's time is one double: 1e-7 s of 20 m/s
    assert np.allclose(states[:, :3], expected, rtol=0, atol=1e-3)
    assert np.allclose(states[:, 5], 2.0 * t_s, rtol=0, atol=1e-5)
    with pytest.raises(ValueError, match=r"SPICE: .*SPKINSUFFDATA.*probe\.bsp"):
        Spice((kernel,), "-999", "EARTH").states(EPOCH, np.array([1e6]))
    assert np.allclose(Spice((kernel,), "-999", "399").states(EPOCH, t_s), states, atol=0)
