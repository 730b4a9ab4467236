"""Rays of craters in frames: the row, craters that are known to be fresh, distances, kept tiles."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import perilune
from perilune.bodies.craters import crater_field
from perilune.config.craters import Craters
from perilune.config.errors import ConfigError

MOON_M = 1737.4e3
KEYS: dict[str, Any] = {"law": "power", "coefficient": 0.01, "exponent": -2.0, "seed": 5,
                        "min_diameter_m": 40.0, "max_diameter_m": 4e3}  # fmt: skip
RAYS = {"brightness": 0.6, "fade_ga": 1.0, "reach": 8.0}


def fresh() -> np.void:
    """The freshest of craters of 1 to 4 km in a region."""
    field = crater_field(Craters.model_validate(KEYS), MOON_M)
    found = field.list(np.array([1.0, 0.0, 0.0]), 2e5, 1e3, 4e3)
    return found[np.argmin(found["age_ga"])]


def over(crater: np.void, height_m: float, craters: dict[str, Any], **more: Any) -> Any:
    """A camera straight over a crater; the ground is smooth but for craters, and Lambert's."""
    x, y, z = crater["direction"]
    place = {
        "lon_deg": float(np.degrees(np.arctan2(y, x))),
        "lat_deg": float(np.degrees(np.arcsin(z))),
    }
    tree = {
        "version": 1,
        "time": {"epoch": "2026-03-03T06:00:00Z"},
        "root": "moon",
        "sun": {"at": place | {"azimuth_deg": 90.0, "elevation_deg": 60.0}},
        "bodies": {"moon": {"kind": "moon", "albedo": 0.3,
                            "terrain": {"detail": None, "craters": KEYS | craters}}},
        "camera": {"width": 48, "height": 48, "fov_deg": 40.0, "exposure": {"mode": "auto"},
                   "trajectory": {"kind": "hover", "target": "moon", "height_m": height_m} | place},
        "render": {"samples": 2, "max_bounces": 0, "tolerance_dn": 0.0, "force_off": ["soft_sun"]},
    } | more  # fmt: skip
    return perilune.open(tree)


def radiance(sim: perilune.Simulation, **options: Any) -> np.ndarray:
    return np.asarray(sim.frame(0, ["radiance"], **options)["radiance"], dtype=float)


def test_a_fresh_crater_is_bright_and_old_ground_dark():
    """The ratio to ground without rays is 1 + 0.6 times the excess: at the crater's middle that of
    its age, elsewhere between that of old ground and of the freshest."""
    crater = fresh()
    height_m = 8.0 * float(crater["diameter_m"])
    bright, plain = over(crater, height_m, {"rays": RAYS}), over(crater, height_m, {})
    ratio = (radiance(bright) / radiance(plain)).mean(axis=-1)
    light = (1.0 - float(crater["age_ga"]) / min(1.0, float(crater["diameter_m"]) / 3e3)) ** 2
    assert light > 0.8
    middle = ratio[22:26, 22:26].mean()
    assert middle - ratio.min() == pytest.approx(0.6 * light, abs=0.04)
    assert 1.4 < ratio.max() < 1.6
    assert 0.8 < ratio.min() < 0.999
    off = bright.with_overrides({"render.force_off": ["soft_sun", "crater_rays"]})
    np.testing.assert_array_equal(radiance(off), radiance(plain))


def test_brightness_does_not_depend_on_the_distance():
    """The same ground, of which ever fewer craters are drawn: its mean over that without rays. At
    first craters of 40 m have a tenth of a cell, at last half a cell has those of 1.2 km."""
    crater, means = fresh(), []
    for height_m, half in ((2e4, 24), (8e4, 6), (1.6e5, 3)):
        ratio = radiance(over(crater, height_m, {"rays": RAYS})) / radiance(
            over(crater, height_m, {})
        )
        inner = slice(24 - half, 24 + half)
        means.append(float(ratio[inner, inner].mean()))
    assert means == pytest.approx([means[0]] * 3, rel=0.02)


def test_the_same_bits_for_tiles_that_are_kept():
    """Tiles that labels made first get their rays later, whatever the threads."""
    crater = fresh()
    first = over(crater, 3e4, {"rays": RAYS})
    first.frame(0, ["depth"])
    np.testing.assert_array_equal(
        radiance(first, threads=2), radiance(over(crater, 3e4, {"rays": RAYS}), threads=1)
    )


@pytest.mark.parametrize(
    ("rays", "text"),
    [
        (
            {"brightness": 0.0},
            r"moon\.terrain\.craters\.rays\.brightness = 0\.0: must be greater",
        ),
        ({"fade_ga": 5.0}, r"craters\.rays\.fade_ga = 5\.0: .*4\.5"),
        ({"reach": 1.0}, r"craters\.rays\.reach = 1\.0: .*3"),
    ],
)
def test_errors(rays, text):
    with pytest.raises(ConfigError, match=text):
        over(fresh(), 2e4, {"rays": rays})
