"""Makes reflectance_table.h: three smooth reflectance spectra, one per primary, that sum to white.

    python csrc/light/reflectance_table.py

The spectra lie between 0 and 1, sum to 1 at every wavelength, and have the colours red, green and
blue (linear sRGB of the CIE 1931 observer, with sunlight as the white point). Under these
constraints they minimise the sum of squared slopes. The method is that of Mallett and Yuksel,
Spectral primary decomposition for rendering with sRGB reflectance, EGSR 2019, who use the
illuminant D65 instead of sunlight. Needs the package (for the observer) and SciPy.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.optimize import minimize

from perilune.base.spectra import srgb_curves

FIRST_NM, LAST_NM, STEP_NM = 380, 730, 10
SUN_K, SUN_BLANKETED = 5850.0, 0.7  # as in spectrum.c
C2_NM_K = 1.4387768775e7  # second radiation constant, CODATA 2018

HEAD = """\
/* Made by reflectance_table.py; included by spectrum.c alone. Columns: red and green; blue is the
 * remainder to 1. */
// clang-format off
"""


def conditions(nodes: np.ndarray) -> np.ndarray:
    """(3, nodes): colour in sunlight of a reflectance that is linear between the nodes."""
    points, weights = np.polynomial.legendre.leggauss(4)
    nm = (np.arange(FIRST_NM, 780)[:, None] + 0.5 + 0.5 * points).ravel()
    sun = np.tile(weights, len(nm) // 4) * np.where(nm < 400.0, SUN_BLANKETED, 1.0)
    sun *= nm**-5.0 / np.expm1(C2_NM_K / (nm * SUN_K))
    seen = np.array([sun * np.interp(nm * 1e-3, *curve.T) for curve in srgb_curves()])
    seen /= seen.sum(axis=1)[:, None]
    hats = np.array([np.interp(nm, nodes, row) for row in np.eye(len(nodes))])
    return np.asarray(seen @ hats.T)


def table() -> tuple[np.ndarray, np.ndarray]:
    """Wavelengths, nm, and the reflectances (nodes, 3)."""
    nodes = np.arange(FIRST_NM, LAST_NM + 1, STEP_NM)
    one, seen = np.eye(3), conditions(nodes)
    looks = np.kron(one, seen)
    adds_up = np.kron(np.ones(3), np.eye(len(nodes)))
    slopes = np.kron(one, np.diff(np.eye(len(nodes)), axis=0))
    # the colour of blue follows from the other two and white
    exact = np.concatenate([looks[:6], adds_up])
    wanted = np.concatenate([one.ravel()[:6], np.ones(len(nodes))])
    start = np.interp(np.tile(nodes, 3), [400, 700], [0.4, 0.3])
    found = minimize(
        lambda x: np.sum((slopes @ x) ** 2),
        start,
        jac=lambda x: 2.0 * slopes.T @ (slopes @ x),
        bounds=[(0.0, 1.0)] * len(start),
        constraints={"type": "eq", "fun": lambda x: exact @ x - wanted, "jac": lambda x: exact},
        method="SLSQP",
        options={"ftol": 1e-13, "maxiter": 500},
    )
    assert found.success
    assert np.abs(exact @ found.x - wanted).max() < 1e-10
    return nodes, found.x.reshape(3, len(nodes)).T


def main() -> None:
    nodes, values = table()
    lines = [f"enum {{ TABLE_ROWS = {len(nodes)} }};"]
    lines += [f"static const double TABLE_FIRST_UM = {FIRST_NM * 1e-3}, "
              f"TABLE_STEP_UM = {STEP_NM * 1e-3};"]  # fmt: skip
    lines += ["static const double reflectance_table[TABLE_ROWS][2] = {"]
    lines += [f"  {{{abs(red):.12f}, {abs(green):.12f}}}," for red, green, _ in values]
    text = HEAD + "\n".join(lines) + "\n};\n"
    Path(__file__).with_suffix(".h").write_text(text)


if __name__ == "__main__":
    main()
