"""From the forces of a configuration to those of the core's numerical propagator."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import erfa
import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base import rotations
from perilune.base.files import Stamp, stamp
from perilune.config.errors import nearest
from perilune.config.orbit import Forces, Harmonics
from perilune.orbits import gravity_field, solar_system
from perilune.orbits.almanac import Almanac
from perilune.orbits.dates import tt_of, utc_of
from perilune.orbits.gravity import ZONALS
from perilune.orbits.solar_system import Date

F64 = NDArray[np.float64]

_DAY_S = 86400.0
_EARTH_RATE = 2.0 * math.pi * 1.00273781191135448 / _DAY_S
"""rad/s: rate of the Earth rotation angle (Capitaine et al. 2000)."""
_AIR: dict[str, list[tuple[float, float, float]] | None] = {
    "earth": None,  # the core's table
    "mars": [(0.0, 0.0157, 10.8e3)],
}
"""Layers of (height m, density kg/m3, scale height m). Mars: the mean of its lowest 80 km, a rough
estimate; above them its air is thinner."""
_CELL_S = {"europa": 3.0 * 3600.0, "phobos": 1200.0}
"""Spacing of tabulated positions for fast bodies; a day for all others. A polynomial of degree 7
through positions and velocities interpolates to 2e-7 of the distance, because ERFA's velocities are
not exactly the derivatives of its positions. The positions are good to 3e-5."""
_REACH_S = 1100.0 * _DAY_S
_CELLS_MOST = 1200
_TABLE_DEGREE = 7


@dataclass(frozen=True)
class Centre:
    """The central body."""

    name: str
    """Name in the configuration, for errors."""
    table: str | None
    """Name in the core's table of bodies."""
    gm_m3_s2: float
    radii_m: F64
    """Semi-axes (3,)."""
    turning: dict[str, Any] | None
    """Rotation in the form of the core's forces: {"body"} or {"q", "rate_rad_s"}; see
    turning_of."""
    places: Almanac = Almanac()  # noqa: RUF009 (immutable)
    """Positions of the perturbing bodies and of the Sun."""


def turning_of(table: str, epoch: Date) -> dict[str, Any]:
    """Rotation of a body of the table.

    The Earth rotates uniformly about its pole at the epoch, from ERFA's precession-nutation and
    rotation angle: good to 0.01 deg for a year either way (its pole precesses by 20 arcsec a year;
    UT1 is taken as UTC, which is off by at most 0.9 s). Other bodies follow their IAU model."""
    if table != "earth":
        return {"body": table}
    zero = np.zeros(1)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", erfa.ErfaWarning)  # leap seconds of the future: none
        to_fixed = erfa.c2t06a(*tt_of(epoch, zero), *utc_of(epoch, zero), 0.0, 0.0)[0]
    return {"q": rotations.from_matrix(np.asarray(to_fixed).T), "rate_rad_s": _EARTH_RATE}


@lru_cache(maxsize=32)
def _table(
    places: Almanac, stamps: tuple[Stamp, ...], name: str, origin: str, epoch: Date, reach_s: float
) -> dict[str, Any]:
    """Positions of a body relative to another, on a grid fixed by the epoch alone, so that
    interpolated values do not depend on the table's extent."""
    cell = min(_CELL_S.get(name, _DAY_S), _CELL_S.get(origin, _DAY_S))
    half = min(math.ceil(reach_s / cell), _CELLS_MOST) + _TABLE_DEGREE
    times = np.arange(-half, half + 1) * cell
    states = np.stack([places.relative_state(name, origin, epoch.after(t)) for t in times])
    times.flags.writeable = states.flags.writeable = False
    return {"kind": "table", "t_s": times, "states": states, "degree": _TABLE_DEGREE}


def _motion(name: str, centre: Centre, epoch: Date, reach_s: float) -> dict[str, Any]:
    if centre.table is None or not solar_system.has_ephemeris(centre.table):
        raise ValueError(
            f"where {name} is from {centre.name} is not known: {centre.name} has no ephemeris"
        )
    if not solar_system.has_ephemeris(name):
        names = [*_core.BODIES]
        raise ValueError(f"third_bodies: no ephemeris of '{name}'{nearest(name, names)}")
    if name == centre.table:
        raise ValueError(f"third_bodies: {name} is what is orbited")
    stamps = tuple(stamp(path) for path in centre.places.kernels)
    return _table(centre.places, stamps, name, centre.table, epoch, reach_s)


def _turning(centre: Centre, what: str) -> dict[str, Any]:
    if centre.turning is None:
        raise ValueError(f"{what}: how {centre.name} turns is not known; give it an ephemeris")
    return centre.turning


@lru_cache(maxsize=8)
def _field(path: Path, stamp: Stamp, degree: int, order: int | None) -> gravity_field.GravityField:
    """A gravity field, cached until its file changes."""
    field = gravity_field.read(path, degree, order)
    field.c.flags.writeable = field.s.flags.writeable = False
    return field


def _harmonics(
    harmonics: Harmonics, centre: Centre, file: Callable[[str, str], Path]
) -> dict[str, Any]:
    turning = _turning(centre, "harmonics")
    if harmonics.file is None:
        zonals = ZONALS.get(centre.table or "")
        if zonals is None:
            known = ", ".join(ZONALS)
            raise ValueError(f"harmonics: none known of {centre.name} (only {known}); give a file")
        if harmonics.degree > len(zonals.j) + 1:
            raise ValueError(
                f"harmonics.degree: {harmonics.degree}: of {centre.table} they are known to "
                f"{len(zonals.j) + 1}; higher ones need a file"
            )
        j = zonals.j[: harmonics.degree - 1]
        return {"kind": "zonal", **turning, "radius_m": zonals.radius_m, "j": j}
    path = file(harmonics.file, "harmonics.file")
    field = _field(path, stamp(path), harmonics.degree, harmonics.order)
    if field.body is not None and centre.table is not None and field.body != centre.table:
        raise ValueError(f"harmonics.file: {path} is a field of {field.body}, not {centre.table}")
    return {
        "kind": "harmonics",
        **turning,
        "gm": field.gm_m3_s2,
        "radius_m": field.radius_m,
        "c": field.c,
        "s": field.s,
        "order": field.order,
    }


def _drag(area: float, cd: float, centre: Centre) -> dict[str, Any]:
    if centre.table not in _AIR:
        raise ValueError(f"drag: no air is known of {centre.name}; only of {', '.join(_AIR)}")
    air = _AIR[centre.table]
    return {
        "kind": "drag",
        **_turning(centre, "drag"),
        "area_to_mass_m2_kg": area,
        "cd": cd,
        "radii_m": (float(np.mean(centre.radii_m[:2])), float(centre.radii_m[2])),
        **({} if air is None else {"air": air}),
    }


def specification(
    forces: Forces,
    centre: Centre,
    epoch: Date,
    file: Callable[[str, str], Path],
    reach_s: float = _REACH_S,
) -> dict[str, Any]:
    """The keys "forces" and "motions" of the core's numerical propagator.

    file(text, key): resolves a path of the configuration. reach_s: time either side of the epoch,
    s, for which other bodies are tabulated (default: three years; 150 days with Europa, 17 with
    Phobos). The propagator refuses times beyond it; its results do not depend on it. ValueError
    that names the key."""
    rows: list[dict[str, Any]] = []
    motions: dict[str, Any] = {}
    if forces.harmonics is not None:
        rows.append(_harmonics(forces.harmonics, centre, file))
    for name in forces.third_bodies:
        motions[name] = _motion(name, centre, epoch, reach_s)
        gm = float(_core.BODIES[name]["gm_m3_s2"])
        rows.append({"kind": "third_body", "gm": gm, "motion": name})
    if forces.drag is not None:
        rows.append(_drag(forces.drag.area_to_mass_m2_kg, forces.drag.cd, centre))
    if (pressure := forces.radiation_pressure) is not None:
        motions["sun"] = _motion("sun", centre, epoch, reach_s)
        rows.append(
            {
                "kind": "radiation_pressure",
                "area_to_mass_m2_kg": pressure.area_to_mass_m2_kg,
                "cr": pressure.cr,
                "radius_m": float(np.mean(centre.radii_m[:2])),
                "motion": "sun",
            }
        )
    return {"forces": rows, "motions": motions}
