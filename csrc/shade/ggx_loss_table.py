"""Makes ggx_loss_table.h: the light that single-scattering GGX loses, by roughness and angle.

    python csrc/shade/ggx_loss_table.py

The directional albedo of a white GGX surface with height-correlated Smith shadowing (Heitz 2014,
eq. 99) is the mean of G2/G1 over visible normals (Heitz 2018). It is integrated on a grid over the
disc that visible normals are drawn from; cells narrow towards the rim, where the lobe's tail lies.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

SIDE = 32  # nodes in each direction
GRID = 384  # integration cells in each direction
ALPHA_MIN = 1e-3  # as in metallic_roughness.c
COSINE_MIN = 1e-4
SCALE = 65535

HEAD = """\
/* Made by ggx_loss_table.py; included by ggx_loss.c alone. Rows: roughness, columns: square root of
 * the cosine, both evenly spaced over 0..1. */
#include <stdint.h>

// clang-format off
"""


def smith_lambda(alpha: float, cosine: np.ndarray) -> np.ndarray:
    tan2 = alpha**2 * (1.0 / np.maximum(cosine, 1e-9) ** 2 - 1.0)
    return 0.5 * (np.sqrt(1.0 + tan2) - 1.0)


def reflections(cosine: float, alpha: float, grid: int) -> tuple[np.ndarray, np.ndarray]:
    """Of the visible normals: cosines to the view, and shares of the light that single-scattering
    GGX would reflect towards the view if it were white."""
    step = (np.arange(grid) + 0.5) / grid
    rim, turn = np.meshgrid(1.0 - step, step)
    radius = np.sqrt(1.0 - rim**3)
    weight = 3.0 * rim**2
    x, y = radius * np.cos(2.0 * np.pi * turn), radius * np.sin(2.0 * np.pi * turn)
    view = np.array([np.sqrt(1.0 - cosine**2), 0.0, cosine])
    stretched = view * [alpha, alpha, 1.0]
    stretched /= np.linalg.norm(stretched)
    across = np.array([0.0, 1.0, 0.0])
    along = np.cross(stretched, across)
    share = 0.5 * (1.0 + stretched[2])
    y = (1.0 - share) * np.sqrt(1.0 - x**2) + share * y
    z = np.sqrt(np.maximum(0.0, 1.0 - x**2 - y**2))
    normal = x[..., None] * across + y[..., None] * along + z[..., None] * stretched
    normal *= [alpha, alpha, 1.0]
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    half = normal @ view
    out = 2.0 * half * normal[..., 2] - view[2]
    here, there = smith_lambda(alpha, np.array(cosine)), smith_lambda(alpha, out)
    seen = np.where(out > 0.0, (1.0 + here) / (1.0 + here + there), 0.0)
    return half, seen * weight / weight.sum()


def directional_albedo(cosine: float, alpha: float) -> float:
    """Light reflected by white single-scattering GGX towards a direction, of a white sky's."""
    return float(reflections(cosine, alpha, GRID)[1].sum())


def table() -> np.ndarray:
    nodes = np.linspace(0.0, 1.0, SIDE)
    loss = [
        [1.0 - directional_albedo(max(s * s, COSINE_MIN), max(r * r, ALPHA_MIN)) for s in nodes]
        for r in nodes
    ]
    return np.clip(np.rint(np.array(loss) * SCALE), 0, SCALE).astype(np.uint16)


def cosine_mean(loss: np.ndarray) -> np.ndarray:
    """Cosine-weighted mean over the hemisphere: the integral of 4 s^3 loss(s), piecewise linear."""
    s = np.linspace(0.0, 1.0, loss.shape[1])
    a, b = s[:-1], s[1:]
    slope = (loss[:, 1:] - loss[:, :-1]) / (b - a)
    offset = loss[:, :-1] - slope * a
    return (offset * (b**4 - a**4) + slope * 0.8 * (b**5 - a**5)).sum(axis=1)


def rows(values: list[str], per_line: int) -> str:
    lines = [", ".join(values[i : i + per_line]) for i in range(0, len(values), per_line)]
    return ",\n  ".join(lines)


def main() -> None:
    loss = table()
    mean = cosine_mean(loss / SCALE)
    body = ",\n".join("  {" + rows([str(v) for v in row], 16) + "}" for row in loss)
    means = rows([f"{v:.8g}f" for v in mean], 6)
    text = (
        f"{HEAD}enum {{ TABLE_SIDE = {SIDE} }};\n"
        f"/* Of {SCALE}. */\n"
        f"static const uint16_t loss_table[TABLE_SIDE][TABLE_SIDE] = {{\n{body}}};\n"
        f"/* Cosine-weighted mean of each row as interpolated. */\n"
        f"static const float mean_table[TABLE_SIDE] = {{\n  {means}}};\n"
    )
    Path(__file__).with_suffix(".h").write_text(text)


if __name__ == "__main__":
    main()
