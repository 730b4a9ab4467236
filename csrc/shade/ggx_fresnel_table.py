"""Makes ggx_fresnel_table.h: what a rough dielectric reflects beyond normal incidence.

    python csrc/shade/ggx_fresnel_table.py

Fresnel's reflectance is written F = F0 + (1 - F0) rise(angle), so that tinted and weighted surfaces
need no tables of their own. Tabulated is the directional albedo of a GGX surface that reflects
`rise`, integrated as in ggx_loss_table.py. With the loss of that table it gives the directional
albedo of every dielectric: F0 (1 - loss) + (F90 - F0) rise. The commonest, of index 1.5, has a
table of its own.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from ggx_loss_table import ALPHA_MIN, COSINE_MIN, cosine_mean, reflections, rows

# Nodes: the root of F0, (n - 1) / (n + 1) of the relative index n; roughness; square root of the
# cosine.
INDICES, ROUGHNESSES, COSINES = 12, 31, 32
ROOT_LEAST, ROOT_MOST = 0.05, 0.6
GRID = 192  # integration cells in each direction
SCALE, GLASS_SCALE = 32767, 65535
GLASS_ROOT = 0.2  # of index 1.5

HEAD = """\
/* Made by ggx_fresnel_table.py; included by ggx_fresnel.c alone. Evenly spaced: (n - 1) / (n + 1)
 * of the relative index n from ROOT_LEAST to ROOT_MOST; roughness and square root of the cosine
 * over 0..1. */
#include <stdint.h>

// clang-format off
"""


def rise(cosine: np.ndarray, root: float) -> np.ndarray:
    """(F - F0) / (1 - F0) of the relative index (1 + root) / (1 - root)."""
    index = (1.0 + root) / (1.0 - root)
    inner = np.sqrt(1.0 - (1.0 - cosine**2) / index**2)
    across = (cosine - index * inner) / (cosine + index * inner)
    along = (index * cosine - inner) / (index * cosine + inner)
    return (0.5 * (across**2 + along**2) - root**2) / (1.0 - root**2)


def tables() -> tuple[np.ndarray, np.ndarray]:
    """(indices, roughnesses, cosines) of `rise`, (roughnesses, cosines) of glass."""
    out = np.empty((INDICES, ROUGHNESSES, COSINES))
    glass = np.empty((ROUGHNESSES, COSINES))
    f0 = GLASS_ROOT**2
    roots = np.linspace(ROOT_LEAST, ROOT_MOST, INDICES)
    for r, roughness in enumerate(np.linspace(0.0, 1.0, ROUGHNESSES)):
        for c, s in enumerate(np.linspace(0.0, 1.0, COSINES)):
            cosine, alpha = max(s * s, COSINE_MIN), max(roughness**2, ALPHA_MIN)
            half, share, _ = reflections(cosine, alpha, GRID)
            out[:, r, c] = [(rise(half, root) * share).sum() for root in roots]
            glass[r, c] = ((f0 + (1.0 - f0) * rise(half, GLASS_ROOT)) * share).sum()
    whole = np.rint(glass * GLASS_SCALE).astype(np.uint16)
    return np.rint(out * SCALE).astype(np.int16), whole


def deviation(values: np.ndarray) -> np.ndarray:
    """Standard deviation over the hemisphere by the cosine, of rows as interpolated."""
    fine = np.linspace(0.0, 1.0, 100 * (COSINES - 1) + 1)
    within = 0.5 * (fine[1:] + fine[:-1])
    weight = fine[1:] ** 4 - fine[:-1] ** 4
    nodes = np.linspace(0.0, 1.0, COSINES)
    curves = np.array([np.interp(within, nodes, row) for row in values])
    mean = curves @ weight
    return np.sqrt(((curves - mean[:, None]) ** 2) @ weight)


def integers(values: np.ndarray) -> str:
    return ",\n".join("  {" + rows([str(v) for v in row], 32) + "}" for row in values)


def floats(values: np.ndarray) -> str:
    return ",\n".join("  {" + rows([f"{v:#.6g}f" for v in row], 8) + "}" for row in values)


def main() -> None:
    values, glass = tables()
    flat = values.reshape(-1, COSINES) / SCALE
    mean = cosine_mean(flat).reshape(INDICES, ROUGHNESSES)
    scatter = deviation(flat).reshape(INDICES, ROUGHNESSES)
    blocks = ",\n".join(" {\n" + integers(block) + "}" for block in values)
    even = glass / GLASS_SCALE
    text = (
        f"{HEAD}enum {{ INDICES = {INDICES}, ROUGHNESSES = {ROUGHNESSES}, COSINES = {COSINES} }};\n"
        f"#define ROOT_LEAST {ROOT_LEAST}f\n"
        f"#define ROOT_MOST {ROOT_MOST}f\n"
        f"/* Of {SCALE}. */\n"
        f"static const int16_t rise_table[INDICES][ROUGHNESSES][COSINES] = {{\n{blocks}}};\n"
        f"/* Cosine-weighted mean of each row as interpolated. */\n"
        f"static const float mean_table[INDICES][ROUGHNESSES] = {{\n{floats(mean)}}};\n"
        f"/* Standard deviation of each over the hemisphere. */\n"
        f"static const float deviation_table[INDICES][ROUGHNESSES] = {{\n{floats(scatter)}}};\n"
        f"/* Albedo for an index of 1.5, of {GLASS_SCALE}; its means and deviations. */\n"
        f"static const uint16_t glass_table[ROUGHNESSES][COSINES] = {{\n{integers(glass)}}};\n"
        f"static const float glass_mean[] =\n{floats(cosine_mean(even)[None])};\n"
        f"static const float glass_deviation[] =\n{floats(deviation(even)[None])};\n"
    )
    Path(__file__).with_suffix(".h").write_text(text)


if __name__ == "__main__":
    main()
