"""`perilune orbit`: the table against the core's tree, and its velocities against Kepler's."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest
from tests.python import command_line

import perilune
from perilune import _core
from perilune.cli.orbit import COLUMNS, SUNLIGHT_COLUMNS, states
from perilune.orbits import dates, solar_system
from perilune.orbits.ephemerides import oem
from perilune.orbits.kinds.elements import two_body
from perilune.orbits.place import Place

STENCIL = np.array([-2.0, -1.0, 0.0, 1.0, 2.0])
WEIGHTS = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / 12.0
"""Five-point difference over seconds (Abramowitz & Stegun, table 25.2): of places, the velocity."""


def command(*words):
    return command_line.command("orbit", *words)


def test_table_is_the_tree(small_scene, pair, tmp_path):
    out = tmp_path / "states.csv"
    raan = {"ideal": 20.0, "jitter_variance": 100.0, "clip_min": 0.0, "clip_max": 40.0}
    words = ["--set", f"spacecraft.probe.orbit.raan_deg={raan}".replace("'", '"')]
    done = command(small_scene, "--frames", "2:8:3", "--out", out, *words)
    assert done.returncode == 0, done.stderr
    assert done.stdout == f"{out}: 4 states of 2 frames\n"
    with open(out, newline="") as file:
        head, *rows = csv.reader(file)
    assert tuple(head) == COLUMNS
    sim = perilune.open(small_scene, overrides={"spacecraft.probe.orbit.raan_deg": raan})
    assert [[row[0], row[2]] for row in rows] == [[k, n] for k in "25" for n in ("planet", "probe")]
    epoch = solar_system.date_from_utc(sim.config.time.utc_fields())
    # Steps count TDB: its drift against UTC shows in the last digits, and is kept.
    times = dates.seconds_of([row[1] for row in rows], "UTC", epoch)
    np.testing.assert_allclose(times, [120.0, 120.0, 300.0, 300.0], rtol=0, atol=1e-9)
    for row in rows:
        world = sim.world(int(row[0]))
        pose = [float(value) for value in (*row[3:6], *row[9:13])]
        np.testing.assert_array_equal(pose, world.poses[row[2]][0])
        # As a system of its own gives it, in another order of times.
        found = sim.system(int(row[0])).states(world.t_s + np.array([60.0, 0.0]))
        np.testing.assert_array_equal(pose, found.poses[row[2]][1])
        speeds = [float(value) for value in row[6:9]]
        np.testing.assert_array_equal(speeds, found.velocities_m_s[row[2]][1])
        np.testing.assert_array_equal(speeds, world.velocities_m_s[row[2]][0])


def test_columns_of_sunlight(small_scene, tmp_path):
    """As the light curve at the opening of the shutter; an OEM has no place for them."""
    out = tmp_path / "states.csv"
    done = command(small_scene, "--frames", "0:40:4", "--out", out, "--sunlight")
    assert done.returncode == 0, done.stderr
    with open(out, newline="") as file:
        head, *rows = csv.reader(file)
    assert tuple(head) == COLUMNS + SUNLIGHT_COLUMNS
    sim = perilune.open(small_scene)
    for name in ("planet", "probe"):
        curve = sim.light_curve(name, range(0, 40, 4), at=0.0)
        cells = [row[len(COLUMNS) :] for row in rows if row[2] == name]
        numbers = np.array([row[:6] for row in cells], dtype=float)
        np.testing.assert_array_equal(numbers[:, :3], curve.fraction)
        np.testing.assert_array_equal(numbers[:, 3:], curve.irradiance_w_m2)
        hidden = ["planet" if row.any() else "" for row in curve.hides]
        assert [row[6] for row in cells] == hidden
    done = command(small_scene, "--frames", "0:4", "--out", tmp_path / "a.oem", "--sunlight")
    assert done.returncode == 1
    assert "--sunlight: an OEM has no place for it" in done.stderr


@pytest.mark.parametrize("eccentricity", [0.0, 0.7])
def test_velocity_is_keplers(small_scene, eccentricity):
    sim = perilune.open(
        small_scene,
        overrides={"spacecraft.probe.orbit.eccentricity": eccentricity, "time.step_s": 731.0},
    )
    craft = sim.config.spacecraft["probe"]
    motion = two_body(craft.orbit, Place(sim.system(0).setting, "probe", "probe.orbit", "planet"))
    assert motion["frame"] == "icrf"  # so that the elements' axes are those of the root frame
    for index in range(0, 20, 4):
        (state,) = (s for s in states(sim, index) if s.name == "probe")
        around = _core.Propagator(motion, 2451545.0, 0.0).states(731.0 * index + STENCIL)
        np.testing.assert_allclose(state.pose[:3], around[2, :3], rtol=0, atol=1e-5)
        np.testing.assert_allclose(state.velocity_m_s, WEIGHTS @ around[:, :3], rtol=0, atol=1e-6)


def test_velocity_of_a_planet_by_the_ephemeris(repo_dir):
    """The Moon about the Earth: 1.022 km/s on average, 0.97 to 1.08 (NASA fact sheet)."""
    config = {
        "version": 1,
        "time": {"epoch": "2026-03-20T12:00:00Z"},
        "root": "earth",
        "bodies": {"earth": {"kind": "earth"}, "moon": {"kind": "moon"}},
        "camera": {
            "width": 8,
            "height": 8,
            "fov_deg": 40.0,
            "trajectory": {"kind": "fixed", "target": "moon", "position_m": [1e7, 0.0, 0.0]},
        },
    }
    sim = perilune.open(config)
    found = {s.name: (s.pose[:3], s.velocity_m_s) for s in states(sim, 0)}
    assert np.linalg.norm(found["earth"][1]) == 0.0
    assert 960.0 < np.linalg.norm(found["moon"][1]) < 1080.0
    epoch = solar_system.date_from_utc(sim.config.time.utc_fields())
    later = solar_system.relative_m("moon", "earth", epoch.after(30.0))
    earlier = solar_system.relative_m("moon", "earth", epoch.after(-30.0))
    # moon98 differentiates a shorter series than it sums: 3e-6 of the speed
    np.testing.assert_allclose(found["moon"][1], (later - earlier) / 60.0, rtol=0, atol=5e-3)


def test_oem_as_another_reader(small_scene, pair, tmp_path):
    """What the package `oem` reads is what the tree says, about the parent, to rounding."""
    from oem import OrbitEphemerisMessage

    out = tmp_path / "states.oem"
    overrides = {**pair, "spacecraft.mate.orbit.frame": "icrf"}
    words = [w for k, v in overrides.items() for w in ("--set", f"{k}={json.dumps(v)}")]
    done = command(small_scene, "--frames", "0:8", "--out", out, "--object", "mate", *words)
    assert done.returncode == 0, done.stderr
    assert done.stdout == f"{out}: 8 states of 8 frames\n"
    message = OrbitEphemerisMessage.open(out)
    (segment,) = message.segments
    assert segment.metadata["OBJECT_NAME"] == "mate"
    assert segment.metadata["CENTER_NAME"] == "PLANET"
    sim = perilune.open(small_scene, overrides=overrides)
    for index, found in enumerate(segment.states):
        world = sim.world(index)
        place, velocity = world.poses["mate"][0, :3], world.velocities_m_s["mate"][0]
        np.testing.assert_allclose(found.position * 1e3, place, rtol=1e-15, atol=1e-8)
        np.testing.assert_allclose(found.velocity * 1e3, velocity, rtol=1e-15, atol=1e-11)
    assert abs((found.epoch - next(iter(segment.states)).epoch).sec - 420.0) < 1e-6


@pytest.mark.parametrize("suffix", ["csv", "oem"])
def test_what_is_written_can_be_flown(small_scene, tmp_path, suffix):
    """A table of every step gives the same places at the steps, and 1 cm between them."""
    out = tmp_path / f"states.{suffix}"
    done = command(small_scene, "--frames", "0:12", "--out", out)
    assert done.returncode == 0, done.stderr
    orbit = {"kind": "table", "around": "planet", "file": str(out), "object": "probe"}
    flown = perilune.open(small_scene, overrides={"spacecraft.probe.orbit": orbit}).system(0)
    system = perilune.open(small_scene).system(0)
    t_s = np.arange(0.0, 661.0, 30.0)
    expected, found = (s.states(t_s).poses["probe"][:, :3] for s in (system, flown))
    away = np.linalg.norm(found - expected, axis=1)
    assert away[::2].max() < 1e-5  # the last digit of a second of 7.6 km/s
    assert away.max() < 1e-2
    if suffix == "csv":
        attitude = {"pointing": "table", "file": str(out), "object": "probe"}
        perilune.open(small_scene, overrides={"spacecraft.probe.attitude": attitude})


@pytest.mark.parametrize("suffix", ["csv", "oem"])
def test_sensors_of_a_step_share_its_states(small_scene, tmp_path, suffix):
    """Three frames in even steps, two in odd ones: each step is written once, and can be flown."""
    out = tmp_path / f"states.{suffix}"
    sensors = {"left": {}, "right": {}, "wide": {"trigger_interval": 2}}
    words = ["--set", f"sensors={json.dumps(sensors)}", "--object", "probe"]
    done = command(small_scene, "--frames", "0:25", "--out", out, *words)
    assert done.returncode == 0, done.stderr
    assert done.stdout == f"{out}: 10 states of 25 frames\n"
    if suffix == "csv":
        with open(out, newline="") as file:
            frames = [int(row["frame"]) for row in csv.DictReader(file)]
        assert frames == [0, 3, 5, 8, 10, 13, 15, 18, 20, 23]
    orbit = {"kind": "table", "around": "planet", "file": str(out), "object": "probe"}
    flown = perilune.open(small_scene, overrides={"spacecraft.probe.orbit": orbit}).system(0)
    t_s = np.arange(10) * 60.0
    expected = perilune.open(small_scene).system(0).states(t_s).poses["probe"][:, :3]
    found = flown.states(t_s).poses["probe"][:, :3]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-5)


def test_a_scene_is_a_segment(small_scene, tmp_path):
    out = tmp_path / "states.oem"
    orbit = '{"kind": "database", "class": "LEO", "around": "planet"}'
    words = ["--set", f"spacecraft.probe.orbit={orbit}", "--set", "time.frames_per_scene=3"]
    done = command(small_scene, "--frames", "0:8", "--out", out, "--object", "probe", *words)
    assert done.returncode == 0, done.stderr
    assert [len(s.times) for s in oem.parse(out)[:2]] == [3, 3]


def test_errors(small_scene, tmp_path):
    done = command(small_scene, "--frames", "0:2", "--out", tmp_path / "no" / "states.csv")
    assert done.returncode == 1
    assert "states.csv: cannot be written" in done.stderr
    done = command(small_scene, "--frames", "0:3000000000", "--out", "x.csv")
    assert done.returncode == 2
    assert "2147483647" in done.stderr
    done = command(small_scene, "--frames", "0:2", "--out", "x.csv", "--object", "prob")
    assert done.returncode == 1
    assert "--object prob: no such entry; did you mean 'probe'?" in done.stderr
    done = command(small_scene, "--frames", "0:2", "--out", "x.oem", "--set", "time.step_s=0")
    assert done.returncode == 1
    assert "time.step_s must be positive" in done.stderr
    assert not list(tmp_path.iterdir())
