"""Makes ggx_loss_xy_table.h: the light that anisotropic single-scattering GGX loses.

    python csrc/shade/ggx_loss_xy_table.py

Integrated as in ggx_loss_table.py, with unequal alphas. The loss is tabulated over the direction
that visible normals are drawn about, where the ellipsoid of the normals is a sphere (Heitz 2018):
there the narrow ridges of smooth lobes lie still, and few nodes do.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from ggx_loss_table import ALPHA_MIN, COSINE_MIN, SCALE, rows

# Nodes: larger alpha, ratio of the alphas, cosine of the stretched direction, its azimuth.
ALPHAS, RATIOS, COSINES, TURNS = 9, 5, 33, 3
MEAN_ALPHAS, MEAN_RATIOS = 17, 9
GRID = 192  # integration cells in each direction
MEAN_GRID = 128

HEAD = """\
/* Made by ggx_loss_xy_table.py; included by ggx_loss_xy.c alone. Evenly spaced over 0..1: the
 * larger alpha, the smaller by the larger, the stretched direction's cosine to 2/3, the squared
 * sine of its azimuth from the wide axis. */
#include <stdint.h>

// clang-format off
"""


def smith_lambda(ax: float, ay: float, w: np.ndarray) -> np.ndarray:
    across = (ax * w[..., 0]) ** 2 + (ay * w[..., 1]) ** 2
    return 0.5 * (np.sqrt(1.0 + across / np.maximum(w[..., 2], 1e-9) ** 2) - 1.0)


def disc() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points of the unit disc, closer towards the rim, and their weights."""
    step = (np.arange(GRID) + 0.5) / GRID
    rim, turn = np.meshgrid(1.0 - step, step)
    radius, weight = np.sqrt(1.0 - rim**3), rim**2
    x, y = radius * np.cos(2.0 * np.pi * turn), radius * np.sin(2.0 * np.pi * turn)
    return x, y, weight / weight.sum()


DISC = disc()


def loss(ax: float, ay: float, stretched: np.ndarray) -> float:
    """1 - directional albedo, seen from where `stretched` (unit) is in stretched axes."""
    x, y, weight = DISC
    view = stretched / [ax, ay, 1.0]
    view /= np.linalg.norm(view)
    across = np.array([-stretched[1], stretched[0], 0.0])
    length = np.linalg.norm(across)
    across = across / length if length > 0.0 else np.array([1.0, 0.0, 0.0])
    along = np.cross(stretched, across)
    share = 0.5 * (1.0 + stretched[2])
    y = (1.0 - share) * np.sqrt(1.0 - x**2) + share * y
    z = np.sqrt(np.maximum(0.0, 1.0 - x**2 - y**2))
    normal = x[..., None] * across + y[..., None] * along + z[..., None] * stretched
    normal *= [ax, ay, 1.0]
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    out = 2.0 * (normal @ view)[..., None] * normal - view
    here, there = smith_lambda(ax, ay, view), smith_lambda(ax, ay, out)
    seen = np.where(out[..., 2] > 0.0, (1.0 + here) / (1.0 + here + there), 0.0)
    return 1.0 - float((seen * weight).sum())


def table() -> np.ndarray:
    out = np.empty((ALPHAS, RATIOS, COSINES, TURNS))
    for i, k, c, f in np.ndindex(out.shape):
        ax = max(i / (ALPHAS - 1), ALPHA_MIN)
        ay = max(ax * k / (RATIOS - 1), ALPHA_MIN)
        cosine = max((c / (COSINES - 1)) ** 1.5, COSINE_MIN)
        sine, turn = np.sqrt(1.0 - cosine**2), np.arcsin(np.sqrt(f / (TURNS - 1)))
        stretched = np.array([sine * np.cos(turn), sine * np.sin(turn), cosine])
        out[i, k, c, f] = loss(ax, ay, stretched)
    return np.clip(np.rint(out * SCALE), 0, SCALE).astype(np.uint16)


def interpolated(values: np.ndarray, at: list[np.ndarray]) -> np.ndarray:
    """Linear in each coordinate, which are 0..1."""
    nodes, parts = [], []
    for x, count in zip(at, values.shape, strict=True):
        place = np.clip(x, 0.0, 1.0) * (count - 1)
        nodes.append(np.minimum(place.astype(int), count - 2))
        parts.append(place - nodes[-1])
    out = np.zeros(np.broadcast(*at).shape)
    for corner in np.ndindex((2,) * len(at)):
        weight = np.ones_like(out)
        for bit, part in zip(corner, parts, strict=True):
            weight = weight * (part if bit else 1.0 - part)
        out += weight * values[tuple(n + b for n, b in zip(nodes, corner, strict=True))]
    return out


def mean(values: np.ndarray, ax: float, ratio: float) -> float:
    """Cosine-weighted mean over the hemisphere, with more points towards grazing."""
    step = (np.arange(MEAN_GRID) + 0.5) / MEAN_GRID
    root, turn = np.meshgrid(step, 0.5 * np.pi * step)
    cosine, weight = root**2, root**3
    x, y = np.sqrt(1.0 - cosine**2) * np.array([np.cos(turn), np.sin(turn)])
    x2, y2 = (ax * x) ** 2, (max(ax * ratio, ALPHA_MIN) * y) ** 2
    stretched = cosine / np.sqrt(x2 + y2 + cosine**2)
    at = [np.array(ax), np.array(ratio), stretched ** (2.0 / 3.0), y2 / (x2 + y2)]
    return float((interpolated(values, at) * weight).sum() / weight.sum())


def braced(values: np.ndarray) -> str:
    """A C initialiser with the last coordinates of a slice on one line."""
    if values.ndim == 1:
        whole = values.dtype == np.uint16
        return "{" + ", ".join(f"{v}" if whole else f"{v:.6g}f" for v in values) + "}"
    per_line = 4 if values.ndim == 2 and values.shape[1] < 8 else 1
    return "{" + rows([braced(part) for part in values], per_line) + "}"


def main() -> None:
    values = table()
    means = [
        [
            mean(values / SCALE, max(i / (MEAN_ALPHAS - 1), ALPHA_MIN), k / (MEAN_RATIOS - 1))
            for k in range(MEAN_RATIOS)
        ]
        for i in range(MEAN_ALPHAS)
    ]
    names = ["ALPHAS", "RATIOS", "COSINES", "TURNS"]
    sizes = ", ".join(f"{n} = {s}" for n, s in zip(names, values.shape, strict=True))
    text = (
        f"{HEAD}enum {{ {sizes} }};\n/* Of {SCALE}. */\n"
        f"static const uint16_t loss_table[{']['.join(names)}] =\n  {braced(values)};\n"
        f"/* Cosine-weighted means of the table as interpolated. */\n"
        f"enum {{ MEAN_ALPHAS = {MEAN_ALPHAS}, MEAN_RATIOS = {MEAN_RATIOS} }};\n"
        f"static const float mean_table[MEAN_ALPHAS][MEAN_RATIOS] =\n"
        f"  {braced(np.array(means))};\n"
    )
    Path(__file__).with_suffix(".h").write_text(text)


if __name__ == "__main__":
    main()
