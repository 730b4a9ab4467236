"""Ghosts in the lens through the Python layer: the sun in and near the frame, out of it, hidden."""

from __future__ import annotations

import numpy as np
import pytest

import perilune
from perilune.base import rotations
from perilune.config import ConfigError

GHOST = {"scale": -0.5, "radius_deg": 2.0, "intensity": 1e-4}
SENSOR = {"read_noise_e": 0.0, "prnu": 0.0, "dark_current_e_s": 0.0, "mosaic": "mono", "bits": 16,
          "gain_e_dn": 1.0, "full_well_e": 1e5, "exposure": {"mode": "fixed"}, "vignetting": 0.0,
          "point_spread": {"core": "point"},
          "lens_flare": {"ghosts": [GHOST], "baffle_deg": [20.0, 30.0]}}  # fmt: skip


def opened(angle_deg, sensor=SENSOR, place=(0.0, 0.0, 5e7), **render):
    """A camera beside the Earth, over its pole, that looks so many degrees off the sun."""
    tree = {
        "version": 1, "time": {"epoch": "2026-03-20T12:00:00Z", "step_s": 60}, "root": "earth",
        "bodies": {"earth": {"kind": "earth"}},
        "camera": {"width": 64, "height": 48, "fov_deg": 30, "exposure_time_s": 1e-3,
                   "sensor": sensor,
                   "trajectory": {"kind": "orbit_object", "target": "earth", "distance_m": 5e7}},
        "render": {"tolerance_dn": 0.0, "samples": 1, "force_off": ["shot_noise"], **render},
    }  # fmt: skip

    def pose(world):
        sun = world.sun_position_m - np.array(place)
        sun /= np.linalg.norm(sun)
        side = np.cross(sun, [0.0, 0.0, 1.0])
        side /= np.linalg.norm(side)
        angle = np.radians(angle_deg)
        z = np.cos(angle) * sun - np.sin(angle) * side  # the sun is on the right
        x = np.cos(angle) * side + np.sin(angle) * sun
        return [*place, *rotations.from_matrix(np.stack([x, np.cross(z, x), z], axis=1))]

    return perilune.open(tree, trajectory=pose)


def electrons(sim):
    return sim.frame(0, ["raw"])["raw"].astype(float) - 64.0


def added(angle_deg, **more):
    return electrons(opened(angle_deg, **more)) - electrons(
        opened(angle_deg, **more | {"force_off": ["shot_noise", "lens_flare"]})
    )


def value(sim):
    row = next(row for row in sim.frame(0, ["raw"]).plan if row["name"] == "lens_flare")
    return row["value"], row["reason"]


@pytest.mark.parametrize("angle_deg", [5.0, 12.0, 17.0])
def test_the_sun_has_a_ghost_where_the_axis_mirrors_it(angle_deg):
    """In the frame and, from 15 degrees on, out of it; its energy is the stated part of the sun's
    irradiance at the sensor, E cos(a) f^2 pixels of a radiance."""
    ghost = added(angle_deg)
    focal = 32.0 / np.tan(np.radians(15.0))
    y, x = np.nonzero(ghost)
    light = ghost[y, x]
    assert np.average(x, weights=light) == pytest.approx(
        31.5 - 0.5 * focal * np.tan(np.radians(angle_deg)), abs=0.1
    )
    assert np.average(y, weights=light) == pytest.approx(23.5, abs=0.1)
    assert len(x) == pytest.approx(np.pi * (focal * np.tan(np.radians(2.0))) ** 2, rel=0.25)
    sim = opened(angle_deg)
    request = sim.request(0)
    sun_m = np.linalg.norm(request["sun_position"] - request["camera_pose"][0, :3])
    irradiance = request["sun_irradiance"] * (149597870700.0 / sun_m) ** 2
    bands = request["sensor"]
    h_c = 6.62607015e-34 * 299792458.0
    rate = sum(share * qe * wavelength / h_c for share, qe, wavelength in zip(
        bands["band_share"], bands["quantum_efficiency"], bands["wavelength_m"], strict=True
    ))  # fmt: skip
    response = 1e-3 * np.pi * 0.9 / (4.0 * 4.0**2) * (5.5e-6) ** 2 * rate
    expected = 1e-4 * irradiance * np.cos(np.radians(angle_deg)) * focal**2 * response
    assert light.sum() == pytest.approx(expected, rel=0.01)


def test_the_baffle_keeps_the_sun_out():
    near, half, far = (added(angle).sum() for angle in (19.0, 25.0, 31.0))
    assert near > 0.0
    # half of it by the baffle; the ghost at -0.5 f tan(25 deg) = -27.8 px is still in the image
    ratio = 0.5 * np.cos(np.radians(25.0)) / np.cos(np.radians(19.0))
    assert half == pytest.approx(ratio * near, rel=0.1)
    assert far == 0.0
    assert value(opened(31.0)) == (
        0,
        "the baffle blocks the sun, and nothing is brighter than white",
    )


def test_a_hidden_sun_has_no_ghost():
    """At midnight over the equator, the Earth before the sun."""
    sim = opened(5.0)
    sun = sim.world(0).sun_position_m
    place = tuple(-2e7 * sun / np.linalg.norm(sun))
    assert added(5.0, place=place).max() == 0.0


def test_no_ghosts_unless_asked_for():
    sensor = {key: entry for key, entry in SENSOR.items() if key != "lens_flare"}
    assert value(opened(5.0, sensor)) == (0, "the lens has no ghosts")
    generic = opened(5.0, {**sensor, "lens_flare": {}})
    assert value(generic)[0] == 1
    assert len(generic.request(0)["sensor"]["lens_flare"]["ghosts"]) == 6


@pytest.mark.parametrize(
    ("flare", "text"),
    [
        ({"ghosts": []}, "ghosts"),
        ({"ghosts": [{**GHOST, "scale": 2.5}]}, r"ghosts\[0\]\.scale"),
        ({"ghosts": [{**GHOST, "intensity": 1.5}]}, r"ghosts\[0\]\.intensity"),
        ({"baffle_deg": [40.0, 30.0]}, "baffle_deg: the second angle"),
        ({"baffle": 30.0}, "did you mean 'baffle_deg'"),
    ],
)
def test_what_is_no_flare_is_refused(flare, text):
    with pytest.raises(ConfigError, match=rf"camera\.sensor\.lens_flare.*{text}"):
        opened(5.0, {**SENSOR, "lens_flare": flare})
