"""Light of other bodies on terrain: eclipses and earthshine as on the ellipsoid."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import perilune

FLAT = {"detail": {"strength": 0.0}}


def moon(time: str, terrain: dict[str, Any] | None, samples: int) -> NDArray[np.float32]:
    """Luminance of the near side, as the Earth and the Sun light it at a time."""
    hover = {"kind": "hover", "target": "moon", "lon_deg": 0.0, "lat_deg": 0.0, "height_m": 2e6}
    ground = {} if terrain is None else {"terrain": terrain}
    config = {
        "version": 1,
        "time": {"epoch": time},
        "root": "earth",
        "bodies": {
            "earth": {"kind": "earth", "albedo": 0.3},
            "moon": {"kind": "moon", "albedo": 0.3} | ground,
        },
        "camera": {"width": 20, "height": 20, "fov_deg": 40.0, "trajectory": hover},
        "render": {"samples": samples, "tolerance_dn": 0.0, "max_bounces": 1},
    }
    found: NDArray[np.float32] = perilune.open(config).frame(0, ["radiance"])["radiance"][..., 1]
    return found


@pytest.mark.parametrize(
    ("time", "least", "most"),
    [
        ("2026-03-03T09:20:00Z", 0.05, 0.98),  # the penumbra is over a part
        ("2026-03-03T10:30:00Z", 0.0, 0.1),  # the umbra is over most
        ("2026-03-03T11:33:00Z", 0.0, 0.0),  # total; the Earth has no air here
    ],
)
def test_an_eclipse_is_that_of_the_ellipsoid(time: str, least: float, most: float) -> None:
    full = moon("2026-03-03T07:00:00Z", None, 4).mean()
    smooth, flat = moon(time, None, 16), moon(time, FLAT, 16)
    assert least <= smooth.mean() / full <= most
    assert flat.mean() == pytest.approx(smooth.mean(), rel=2e-3)
    np.testing.assert_allclose(flat, smooth, atol=0.02 * max(smooth.max(), 1e-9))


def test_earthshine_is_that_of_the_ellipsoid() -> None:
    """At new moon, by light that the Earth throws; each pixel to the noise of 64 samples."""
    smooth, flat = (moon("2026-02-17T16:00:00Z", terrain, 64) for terrain in (None, FLAT))
    assert smooth.mean() > 0.0
    assert flat.mean() == pytest.approx(smooth.mean(), rel=5e-3)
    lit = smooth > 0.0
    assert lit.all()
    assert np.median(np.abs(flat / smooth - 1.0)) < 0.02
