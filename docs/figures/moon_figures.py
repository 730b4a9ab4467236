"""The Moon by Hapke's law: `python docs/figures/make_figures.py moon`. Needs the sample data.

Above, the Moon at five phase angles by Hapke's law and, at the same exposures, as a Lambert sphere
of the same full brightness; below, straight down from 100 km with the Sun behind the camera: the
opposition surge, with the parameters of the maps and without the surge; and the light of the disc
against the model of Kieffer and Stone (2005).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

import perilune

MAPS = [f"data:reflectance/WAC_HAPKEPARAMMAP_{nm}NM.tif" for nm in (643, 566, 566)]
HAPKE = {"reflectance": "hapke", "photometry": {"maps": MAPS}, "albedo": [1.0, 1.0, 0.85]}
PHASES_DEG = (5.0, 30.0, 60.0, 90.0, 120.0)
RADIUS_M, DISTANCE_M, SOLAR = 1737.4e3, 384400e3, 1361.0
SIZE = 200

# Kieffer and Stone, AJ 129, 2887, 2005, table 4, 553.8 nm; Sun and observer over the equator.
ROLO = (-2.12504, -1.65970, 0.38409, -0.20655), (0.04052, 0.01009, -0.00388)
ROLO_D, ROLO_P = (0.37206, -0.10745, 0.00347), (4.06054, 12.8802, -30.5858, 16.7498)


def rolo(g_deg: float) -> float:
    """Disc reflectance of the waxing Moon."""
    g = math.radians(g_deg)
    value = sum(a * g**i for i, a in enumerate(ROLO[0]))
    value += sum(b * g ** (2 * i + 1) for i, b in enumerate(ROLO[1]))
    value += ROLO_D[0] * math.exp(-g_deg / ROLO_P[0]) + ROLO_D[1] * math.exp(-g_deg / ROLO_P[1])
    return math.exp(value + ROLO_D[2] * math.cos((g_deg - ROLO_P[2]) / ROLO_P[3]))


def scene(moon: dict[str, Any], sun_deg: float, height_m: float, fov_deg: float) -> dict[str, Any]:
    """Seen from above longitude and latitude 0, the Sun at an eastern longitude."""
    g = math.radians(sun_deg)
    return {
        "version": 1,
        "time": {"epoch": "2026-03-03T06:00:00Z", "step_s": 0.0},
        "root": "moon",
        # An ellipsoid, so that its axes are the root's.
        "bodies": {
            "moon": {"kind": "ellipsoid", "radii_km": RADIUS_M / 1e3, "gm_km3_s2": 4902.8} | moon
        },
        "sun": {"direction": [math.cos(g), math.sin(g), 0.0]},
        "camera": {
            "width": SIZE,
            "height": SIZE,
            "fov_deg": fov_deg,
            "trajectory": {
                "kind": "fixed",
                "target": "moon",
                "position_m": [RADIUS_M + height_m, 0.0, 0.0],
            },
        },
        "render": {"samples": 16, "max_bounces": 0},
    }


def radiance(moon: dict[str, Any], sun_deg: float, height_m: float, fov_deg: float) -> NDArray[Any]:
    sim = perilune.open(scene(moon, sun_deg, height_m, fov_deg))
    return sim.frame(0, channels=["radiance"])["radiance"]


def disc(moon: dict[str, Any], sun_deg: float) -> NDArray[Any]:
    return radiance(moon, sun_deg, DISTANCE_M - RADIUS_M, 0.56)


def disc_reflectance(image: NDArray[Any]) -> float:
    """Green light over that of a white Lambert disc that faces the Sun."""
    pixel = 2.0 * math.tan(math.radians(0.28)) / SIZE
    return float(image[:, :, 1].sum()) * pixel**2 / (SOLAR * (RADIUS_M / DISTANCE_M) ** 2)


def show(axes: Axes, image: NDArray[Any], white: float, title: str) -> None:
    axes.imshow(np.clip(image / white, 0.0, 1.0) ** (1 / 2.2))
    axes.set_title(title, fontsize=9)
    axes.set_axis_off()


def figure_moon() -> Figure:
    figure = Figure(figsize=(11.0, 7.6), layout="constrained")
    grid = figure.add_gridspec(3, 5, height_ratios=[1.0, 1.0, 1.25])
    hapke = [disc(HAPKE, g) for g in PHASES_DEG]
    full = disc_reflectance(hapke[0])
    # The light of a Lambert sphere at g = 5 degrees is 0.665 of its albedo.
    lambert = [disc({"albedo": full / 0.665}, g) for g in PHASES_DEG]
    for column, g in enumerate(PHASES_DEG):
        white = float(np.percentile(hapke[column][hapke[column] > 0.0], 99.5))
        show(figure.add_subplot(grid[0, column]), hapke[column], white, f"Hapke, {g:g} deg")
        show(figure.add_subplot(grid[1, column]), lambert[column], white, f"Lambert, {g:g} deg")
    close = [radiance(HAPKE, 0.0, 100e3, 40.0)]
    no_surge = {"photometry": {"maps": MAPS, "b_s0": 0.0}}
    close.append(radiance(HAPKE | no_surge, 0.0, 100e3, 40.0))
    white = float(close[0].max())
    show(figure.add_subplot(grid[2, 0]), close[0], white, "100 km, Sun behind: surge")
    show(figure.add_subplot(grid[2, 1]), close[1], white, "without B_S")
    axes = figure.add_subplot(grid[2, 2:])
    angles = np.array([3, 5, 7, 10, 15, 20, 30, 45, 60, 75, 90, 105, 120])
    fine = np.linspace(3.0, 120.0, 200)
    axes.semilogy(fine, [rolo(g) for g in fine], "k-", label="ROLO, 554 nm")
    rows = ("o", "Hapke, 566 nm", HAPKE), ("x", "Lambert", {"albedo": full / 0.665})
    for mark, label, moon in rows:
        light = [disc_reflectance(disc(moon, g)) for g in angles]
        axes.semilogy(angles, light, mark, label=label)
    axes.set_xlabel("phase angle, deg")
    axes.set_title("disc reflectance", fontsize=9)
    axes.yaxis.tick_right()
    axes.legend()
    return figure
