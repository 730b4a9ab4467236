"""Spectra: response curves from files and of simple bands, and what bands gather of sunlight."""

from __future__ import annotations

import math
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base import files

F64 = NDArray[np.float64]

STEP_UM = 0.01
"""Longest step of an integration; tests/python/test_bands.py has its error."""

# XYZ to linear sRGB (IEC 61966-2-1).
_TO_SRGB = np.array(
    [[3.2404542, -1.5371385, -0.4985314],
     [-0.9692660, 1.8760108, 0.0415560],
     [0.0556434, -0.2040259, 1.0572252]]
)  # fmt: skip


def _lobe(nm: F64, peak: float, below: float, above: float) -> F64:
    return np.asarray(np.exp(-0.5 * ((nm - peak) / np.where(nm < peak, below, above)) ** 2))


def srgb_response(um: F64) -> F64:
    """(3, n): contribution of light of wavelengths (n,), um, to linear red, green and blue of sRGB.

    The CIE 1931 observer as fitted by Wyman, Sloan and Shirley, Simple analytic approximations to
    the CIE XYZ color matching functions, JCGT 2 (2013), 2. Some values are negative; the peaks are
    1."""
    nm = np.asarray(um) * 1e3
    x = (
        1.056 * _lobe(nm, 599.8, 37.9, 31.0)
        + 0.362 * _lobe(nm, 442.0, 16.0, 26.7)
        - 0.065 * _lobe(nm, 501.1, 20.4, 26.2)
    )
    y = 0.821 * _lobe(nm, 568.8, 46.9, 40.5) + 0.286 * _lobe(nm, 530.9, 16.3, 31.1)
    z = 1.217 * _lobe(nm, 437.0, 11.8, 36.0) + 0.681 * _lobe(nm, 459.0, 26.0, 13.8)
    return np.asarray(_TO_SRGB @ np.stack([x, y, z]) / _SRGB_PEAKS[:, None])


_SRGB_PEAKS = np.ones(3)
_SRGB_PEAKS = srgb_response(np.linspace(0.38, 0.78, 4001)).max(axis=1)


def box(low_um: float, high_um: float, value: float = 1.0) -> F64:
    """A curve, (n, 2) of um and value, that is `value` between two wavelengths."""
    return np.array([[low_um, value], [high_um, value]])


def gaussian(center_um: float, width_um: float) -> F64:
    """A curve of peak 1 with this full width at half maximum, cut off at 1e-6 of the peak."""
    sigma = width_um / math.sqrt(8.0 * math.log(2.0))
    reach = math.sqrt(2.0 * math.log(1e6))
    t = np.linspace(-reach, reach, 401)
    um = center_um + sigma * t
    return np.stack([um, np.exp(-0.5 * t * t)], axis=1)[um >= _SHORTEST_UM]


@lru_cache(maxsize=1)
def srgb_curves() -> tuple[F64, F64, F64]:
    """Curves of srgb_response at every nanometre."""
    um = np.linspace(0.38, 0.78, 401)
    red, green, blue = (np.stack([um, row], axis=1) for row in srgb_response(um))
    return red, green, blue


def read(path: Path, um_per_unit: float) -> F64:
    """(n, 1 + columns) of a text file: ascending wavelengths in um, and values, which are not
    negative.

    Columns are separated by commas, semicolons or blanks. A first line without numbers and lines
    that begin with # are skipped. ValueError with file and line for invalid content."""
    table = _read(path, files.stamp(path)).copy()
    table[:, 0] *= um_per_unit
    for line, um in zip(_lines(path, files.stamp(path)), table[:, 0], strict=True):
        if not _SHORTEST_UM <= um <= _LONGEST_UM:
            raise ValueError(
                f"{path}, line {line}: a wavelength of {um:g} um is not in {_SHORTEST_UM:g} to "
                f"{_LONGEST_UM:g} um; check its unit"
            )
    return table


_SHORTEST_UM, _LONGEST_UM = 0.01, 1000.0


@lru_cache(maxsize=64)
def _read(path: Path, stamp: files.Stamp) -> F64:
    return _parse(path)[0]


@lru_cache(maxsize=64)
def _lines(path: Path, stamp: files.Stamp) -> tuple[int, ...]:
    return _parse(path)[1]


def _parse(path: Path) -> tuple[F64, tuple[int, ...]]:
    """The numbers of a file, and the line number of each row."""
    rows: list[list[float]] = []
    lines: list[int] = []
    titled = False
    for number, line in enumerate(files.text(path).splitlines(), 1):
        fields = line.replace(",", " ").replace(";", " ").split()
        if not fields or line.lstrip().startswith("#"):
            continue
        try:
            row = [float(field) for field in fields]
        except ValueError:
            if not rows and not titled:
                titled = True
                continue
            text = f"{path}, line {number}: '{line.strip()}' is no row of numbers"
            raise ValueError(text) from None
        _check_row(row, rows, f"{path}, line {number}")
        rows.append(row)
        lines.append(number)
    if len(rows) < 2:
        text = f"a curve needs at least two rows of numbers, this has {len(rows)}"
        raise ValueError(f"{path}: {text}")
    return np.array(rows), tuple(lines)


def _check_row(row: list[float], before: list[list[float]], where: str) -> None:
    if len(row) < 2 or (before and len(row) != len(before[0])):
        expected = f"{len(before[0])}" if before else "2 or more"
        raise ValueError(f"{where}: {len(row)} numbers; expected {expected}")
    if not all(math.isfinite(value) for value in row):
        raise ValueError(f"{where}: not finite")
    if min(row[1:]) < 0.0:
        raise ValueError(f"{where}: {min(row[1:]):g} is negative")
    if before and not row[0] > before[-1][0]:
        raise ValueError(
            f"{where}: the wavelength {row[0]:g} does not rise above that of the row before, "
            f"{before[-1][0]:g}"
        )


def integral(curve: F64) -> float:
    """Integral of a curve over its wavelengths, um."""
    return float(np.trapezoid(curve[:, 1], curve[:, 0]))


def gather(sun: F64 | None, *responses: F64, step_um: float = STEP_UM) -> _core.BandLight:
    """Sunlight gathered by a band, the product of curves (n, 2); see _core.band_gather.

    sun: a curve in any scale; None: the default, whose error its documentation states."""
    return _core.band_gather(sun, responses, step_um)
