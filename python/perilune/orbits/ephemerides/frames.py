"""Rotations of the inertial frames of ephemerides to ICRF axes."""

from __future__ import annotations

from collections.abc import Callable

import erfa
import numpy as np
from numpy.typing import NDArray

from perilune.config.errors import nearest
from perilune.orbits.dates import tt_of
from perilune.orbits.solar_system import Date

F64 = NDArray[np.float64]


def teme_to_icrf(epoch: Date, t_s: F64) -> F64:
    """Matrices (n, 3, 3) from TEME, the true equator and mean equinox of date, in which SGP4 works.

    They combine the equation of the equinoxes (1994 form), the nutation of 1980, the precession of
    1976 and the bias of the mean frame of J2000 (Vallado et al. 2006, appendix C). IERS corrections
    to that nutation are left out; they are below 0.1 arcsec, 3 m in a low orbit, where SGP4 itself
    is good to 1 km."""
    tt = tt_of(epoch, t_s)
    mean_to_true = erfa.pnm80(*tt)
    # The equation of the equinoxes turns from the mean equinox to the true one, along the equator.
    teme_to_true = erfa.rz(-erfa.eqeq94(*tt), np.eye(3))
    to_mean = np.swapaxes(mean_to_true, -1, -2) @ teme_to_true
    return np.asarray(_bias().T @ to_mean)


def _bias() -> F64:
    """Rotation from ICRF axes to the mean equator and equinox of J2000 (IAU 2000)."""
    return np.asarray(erfa.bp06(2451545.0, 0.0)[0])


def _same(epoch: Date, t_s: F64) -> F64:
    return np.broadcast_to(np.eye(3), (len(t_s), 3, 3))


def _mean_j2000(epoch: Date, t_s: F64) -> F64:
    return np.broadcast_to(_bias().T, (len(t_s), 3, 3))


_FRAMES: dict[str, Callable[[Date, F64], F64]] = {
    "ICRF": _same,
    "GCRF": _same,
    "EME2000": _mean_j2000,
    "TEME": teme_to_icrf,
}


def to_icrf(frame: str, epoch: Date, t_s: F64) -> F64:
    """Matrices (n, 3, 3) from a frame by its CCSDS name; ValueError for an unknown one."""
    if frame.upper() not in _FRAMES:
        raise ValueError(f"no reference frame '{frame}'{nearest(frame, _FRAMES)}")
    return _FRAMES[frame.upper()](epoch, t_s)
