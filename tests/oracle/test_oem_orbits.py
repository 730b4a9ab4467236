"""Numerical orbits against published ephemerides (CCSDS OEM files of the data).

What the files follow was found by fitting start states under one model of force after another:

* The ISS's (NASA, 24 h) is a full model: with EGM96 to 21x21, Sun, Moon and drag by the file's own
  area, mass and coefficient all that is free is the density of the air, which the table of
  exponential layers gives to a factor of 2 to 10.
* LEO, MEO and GEO (an hour each) say that they were computed by an algorithm. Their velocities are
  not the derivatives of their places (by 1, 1 and 5 cm/s), and gravity that depends on longitude
  makes the low one ten times worse: an analytic theory with zonal terms, not an integration. They
  are met as well as such a theory meets its own equations of motion, by a start adjusted by metres.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import least_squares

from perilune import _core
from perilune.config.orbit import Forces
from perilune.orbits import forces
from perilune.orbits.ephemerides import oem
from perilune.orbits.solar_system import Date, date_from_utc

EARTH = _core.BODIES["earth"]


def read(path: Path, epoch: Date) -> tuple[np.ndarray, np.ndarray]:
    (segment,) = oem.parse(path)
    return oem.states(segment, epoch, path)


def acting(data_dir: Path, epoch: Date, order: int, **more: Any) -> dict[str, Any]:
    file = str(data_dir / "orbits" / "gravity" / "EGM96-truncated-21x21")
    degree = max(order, 4)
    section = {"harmonics": {"file": file, "degree": degree, "order": order}, **more}
    turning = forces.turning_of("earth", epoch)
    radii = np.array(EARTH["radii_m"])
    centre = forces.Centre("earth", "earth", float(EARTH["gm_m3_s2"]), radii, turning)
    model = Forces.model_validate(section)
    return forces.specification(model, centre, epoch, lambda text, key: Path(text))


def places(start: np.ndarray, epoch: Date, t_s: np.ndarray, spec: dict[str, Any]) -> np.ndarray:
    full = {"kind": "numerical", "gm": 398600.4415e9, "state": start, "rtol": 1e-12, **spec}
    return _core.Propagator(full, epoch.day, epoch.fraction).states(t_s)[:, :3]


def test_iss_for_a_day(data_dir: Path) -> None:
    """From the file's first state, nothing adjusted but the air's density (0.39 of its table): 66 m
    after 660 000 km of path. Each part of the model is needed for it."""
    epoch = date_from_utc((2022, 1, 17, 12, 0, 0.0))
    t_s, rows = read(data_dir / "orbits" / "oem" / "ISS.resampled.truncated.txt", epoch)
    assert t_s[-1] == pytest.approx(86400.0, abs=1e-3)
    bodies = ["sun", "moon"]

    def error(order: int, density: float, third: list[str]) -> float:
        area = 1606.80 / 458943.00 * density  # DRAG_AREA over MASS, by the comments of the file
        more: dict[str, Any] = {"third_bodies": third}
        if density:
            more["drag"] = {"area_to_mass_m2_kg": area, "cd": 2.5}
        spec = acting(data_dir, epoch, order, **more)
        return float(np.linalg.norm(places(rows[0], epoch, t_s, spec) - rows[:, :3], axis=1).max())

    assert error(21, 0.39, bodies) < 80.0
    assert error(21, 1.0, bodies) < 5000.0  # the table's density, untouched
    assert error(21, 0.0, bodies) > 1000.0  # no air
    assert error(8, 0.39, bodies) > 150.0  # less gravity
    assert error(0, 0.39, bodies) > 2000.0  # none that depends on longitude


@pytest.mark.parametrize(
    ("name", "accuracy_m", "moved_m", "moved_m_s"),
    [("LEO", 10.0, 10.0, 0.03), ("MEO", 5.0, 5.0, 0.03), ("GEO", 10.0, 10.0, 0.07)],
)
def test_an_hour_of_an_analytic_theory(
    data_dir: Path, name: str, accuracy_m: float, moved_m: float, moved_m_s: float
) -> None:
    epoch = date_from_utc((2020, 6, 1, 12, 0, 0.0))
    t_s, rows = read(data_dir / "orbits" / "oem" / f"{name}_60s.oem", epoch)

    def residual(order: int) -> tuple[float, np.ndarray]:
        spec = acting(data_dir, epoch, order)
        unit = np.array([1e6] * 3 + [1e3] * 3)  # difference quotients well above rounding

        def off(x: np.ndarray) -> np.ndarray:
            return (places(rows[0] + x * unit, epoch, t_s, spec) - rows[:, :3]).ravel()

        found = least_squares(off, np.zeros(6), x_scale=1e-5)
        return float(np.abs(found.fun.reshape(-1, 3)).max()), found.x * unit

    worst, moved = residual(0)
    assert worst < accuracy_m
    assert np.linalg.norm(moved[:3]) < moved_m
    assert np.linalg.norm(moved[3:]) < moved_m_s
    if name == "LEO":
        assert residual(21)[0] > 5.0 * worst


@pytest.mark.parametrize("name", ["LEO", "MEO", "GEO"])
def test_velocities_of_the_files(data_dir: Path, name: str) -> None:
    """The derivative of a file's places (Chebyshev's series through all rows) is not its velocity:
    no integration gives that."""
    epoch = date_from_utc((2020, 6, 1, 12, 0, 0.0))
    t_s, rows = read(data_dir / "orbits" / "oem" / f"{name}_60s.oem", epoch)
    series = np.polynomial.Chebyshev.fit
    for axis in range(3):
        fit = series(t_s, rows[:, axis], 34)
        assert np.abs(fit(t_s) - rows[:, axis]).max() < 1e-3
    fits = [series(t_s, rows[:, axis], 34) for axis in range(3)]
    inner = t_s[8:-8]
    rate = np.stack([fit.deriv()(inner) for fit in fits], axis=1)
    apart = np.linalg.norm(rate - rows[8:-8, 3:], axis=1)
    assert apart.min() > 5e-3
