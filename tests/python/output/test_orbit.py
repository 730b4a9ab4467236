"""`perilune orbit`: the table against the core's tree, and its velocities against Kepler's."""

from __future__ import annotations

import csv
import subprocess
import sys

import numpy as np
import pytest

import perilune
from perilune import _core, bodies
from perilune.cli.orbit import COLUMNS, states
from perilune.orbits.kinds.elements import two_body
from perilune.orbits.place import Place

STENCIL = np.array([-2.0, -1.0, 0.0, 1.0, 2.0])
WEIGHTS = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / 12.0
"""Five-point difference over seconds (Abramowitz & Stegun, table 25.2): of places, the velocity."""


def command(*words):
    return subprocess.run(
        [sys.executable, "-m", "perilune", "orbit", *map(str, words)],
        capture_output=True,
        text=True,
    )


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
    assert [row[:3] for row in rows] == [
        ["2", "2026-03-20T12:02:00.000Z", "planet"],
        ["2", "2026-03-20T12:02:00.000Z", "probe"],
        ["5", "2026-03-20T12:05:00.000Z", "planet"],
        ["5", "2026-03-20T12:05:00.000Z", "probe"],
    ]
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
        (state,) = (s for s in states(sim, index) if s[1] == "probe")
        around = _core.Propagator(motion, 2451545.0, 0.0).states(731.0 * index + STENCIL)
        np.testing.assert_allclose(state[2], around[2, :3], rtol=0, atol=1e-5)
        np.testing.assert_allclose(state[3], WEIGHTS @ around[:, :3], rtol=0, atol=1e-6)


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
    found = {name: (position, velocity) for _, name, position, velocity, _ in states(sim, 0)}
    assert np.linalg.norm(found["earth"][1]) == 0.0
    assert 960.0 < np.linalg.norm(found["moon"][1]) < 1080.0
    epoch = bodies.date_from_utc(sim.config.time.utc_fields())
    later = bodies.relative_m("moon", "earth", epoch.after(30.0))
    earlier = bodies.relative_m("moon", "earth", epoch.after(-30.0))
    # moon98 differentiates a shorter series than it sums: 3e-6 of the speed
    np.testing.assert_allclose(found["moon"][1], (later - earlier) / 60.0, rtol=0, atol=5e-3)


def test_errors(small_scene, tmp_path):
    done = command(small_scene, "--frames", "0:2", "--out", tmp_path / "no" / "states.csv")
    assert done.returncode == 1
    assert "states.csv: cannot be written" in done.stderr
    done = command(small_scene, "--frames", "0:3000000000", "--out", "x.csv")
    assert done.returncode == 2
    assert "2147483647" in done.stderr
    assert not list(tmp_path.iterdir())
