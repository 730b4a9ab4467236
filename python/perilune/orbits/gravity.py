"""Unnormalised zonal harmonics of the bodies of the table: J_n = -C_n0."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Zonals:
    """Zonal harmonics of a body."""

    radius_m: float
    """Reference radius of the coefficients; not that of the ellipsoid."""
    j: tuple[float, ...]
    """J2, J3, ..."""


# Earth: EGM96 (its C_n0 denormalised). Moon: GRGM1200A (J2; J3 and J4 to about 1 %). Mars: GGM2B.
# Mercury: HgM008. Europa: Anderson et al. 1998.
ZONALS: dict[str, Zonals] = {
    "earth": Zonals(
        6378136.3,
        (
            1.0826266835531513e-3,
            -2.5326564853322355e-6,
            -1.619621591367e-6,
            -2.272960828686982e-7,
            5.406812391070848e-7,
        ),
    ),
    "moon": Zonals(1738000.0, (2.0322e-4, 8.46e-6, -9.70e-6)),
    "mars": Zonals(3397000.0, (1.955454e-3, 3.14498e-5, -1.537740e-5, 5.71855e-6, -4.84884e-6)),
    "mercury": Zonals(2440000.0, (5.03e-5,)),
    "europa": Zonals(1565000.0, (4.355e-4,)),
}
