"""Materials of space hardware shared by our models, and the solar cells' texture.

Colours are linear reflectances in the visible. Foils, bare metals and optical solar reflectors are
metals in glTF's sense; paints, composites and coverglass are not. Values are typical of what
handbooks give for new hardware (Gilmore, "Spacecraft Thermal Control Handbook", 2nd ed., app. A:
solar absorptance 0.44 for 1-mil aluminised Kapton, 0.2 for white paint, 0.95 for black paint,
0.92 for solar cells), spread over red, green and blue to match photographs.
"""

from __future__ import annotations

import numpy as np
from glb import Material, indexed_png

SOLAR_CELL_IMAGE = "solar_cells"
CELLS_A_TILE = (2, 2)  # the texture shows so many cells across and down

ALL = {
    m.name: m
    for m in (
        Material("mli_gold", (0.92, 0.58, 0.20), 1.0, 0.30),
        Material("mli_silver", (0.88, 0.88, 0.86), 1.0, 0.28),
        Material("mli_black", (0.035, 0.035, 0.038), 0.0, 0.45),
        Material("beta_cloth", (0.74, 0.73, 0.70), 0.0, 0.75),
        Material("white_paint", (0.80, 0.80, 0.78), 0.0, 0.55),
        Material("grey_paint", (0.33, 0.34, 0.35), 0.0, 0.6),
        Material("black_paint", (0.03, 0.03, 0.03), 0.0, 0.7),
        Material("aluminium", (0.86, 0.87, 0.88), 1.0, 0.42),
        Material("titanium", (0.54, 0.50, 0.46), 1.0, 0.38),
        Material("nozzle", (0.30, 0.26, 0.24), 1.0, 0.42),
        Material("carbon_fibre", (0.045, 0.047, 0.05), 0.0, 0.38),
        Material("solar_cell", (1.0, 1.0, 1.0), 0.0, 0.14, texture=SOLAR_CELL_IMAGE),
        Material("panel_back", (0.42, 0.41, 0.39), 0.0, 0.6),
        Material("radiator", (0.90, 0.91, 0.92), 1.0, 0.22),
        Material("glass", (0.02, 0.022, 0.03), 0.0, 0.06),
        Material("handrail", (0.72, 0.50, 0.10), 0.0, 0.45),
        Material("copper", (0.93, 0.55, 0.38), 1.0, 0.35),
    )
}


def pick(*names: str) -> list[Material]:
    return [ALL[name] for name in names]


def solar_cell_png() -> bytes:
    """2 x 2 cells with cut corners, grid fingers and bus bars; tiles in both directions.

    The shades differ a little from cell to cell, as those of a real string do.
    """
    size, cells = 128, CELLS_A_TILE[0]
    v, u = (np.mgrid[0:size, 0:size] + 0.5) * cells / size
    column, row = u.astype(int), v.astype(int)
    x, y = np.abs(u - column - 0.5), np.abs(v - row - 0.5)
    gap = (x > 0.478) | (y > 0.478) | (x + y > 0.90)  # cut corners show the substrate
    finger = (np.abs((v - row) * 8 % 1 - 0.5) < 0.06) & ~gap
    bus = (np.abs(x - 0.26) < 0.016) & ~gap
    shade = column + 2 * row  # four shades of blue
    pixels = np.where(gap, 4, np.where(bus, 6, np.where(finger, 5, shade))).astype(np.uint8)
    palette = np.array(
        [
            *[(22, 30, 66), (25, 33, 72), (20, 27, 60), (28, 37, 76)],
            *[(96, 92, 84), (36, 44, 82), (126, 130, 138)],
        ],
        np.uint8,
    )
    return indexed_png(pixels, palette)
