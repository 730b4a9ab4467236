"""Makes ggx_loss_xy_table.h: the light that anisotropic single-scattering GGX loses, and gains that
give it back.

    python csrc/shade/ggx_loss_xy_table.py

Integrated as in ggx_loss_table.py, with unequal alphas. Both are tabulated over the direction that
visible normals are drawn about, where the ellipsoid of the normals is a sphere (Heitz 2018): there
the narrow ridges of smooth lobes lie still, and few nodes do.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from ggx_loss_table import ALPHA_MIN, COSINE_MIN, GAIN_SCALE, SCALE, broad_part, gains, rows, whole

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


def reflections(ax: float, ay: float, stretched: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Light that comes from directions (..., 3), seen from where `stretched` (unit) is in stretched
    axes, and those directions."""
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
    return seen * weight, out


def place(ax: float, ay: float, w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of directions: the cosine in stretched axes to 2/3, and the squared sine of the azimuth."""
    x2, y2, z = (ax * w[..., 0]) ** 2, (ay * w[..., 1]) ** 2, np.maximum(w[..., 2], 0.0)
    across2 = np.maximum(x2 + y2, 1e-30)
    return (z / np.sqrt(across2 + z**2)) ** (2.0 / 3.0), y2 / across2


def directions() -> list[np.ndarray]:
    """Of the nodes, in stretched axes."""
    out = []
    for c, f in np.ndindex(COSINES, TURNS):
        cosine = max((c / (COSINES - 1)) ** 1.5, COSINE_MIN)
        sine, turn = np.sqrt(1.0 - cosine**2), np.arcsin(np.sqrt(f / (TURNS - 1)))
        out.append(np.array([sine * np.cos(turn), sine * np.sin(turn), cosine]))
    return out


def spread(at: np.ndarray, turn: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Weights of the nodes that directions are interpolated from."""
    c, f = at.ravel() * (COSINES - 1), turn.ravel() * (TURNS - 1)
    i, k = np.minimum(c.astype(int), COSINES - 2), np.minimum(f.astype(int), TURNS - 2)
    c, f, weight = c - i, f - k, weight.ravel()
    out = np.zeros(COSINES * TURNS)
    for across, along in np.ndindex(2, 2):
        share = weight * (c if across else 1.0 - c) * (f if along else 1.0 - f)
        out += np.bincount((i + across) * TURNS + k + along, share, len(out))
    return out


def slice_of(ax: float, ay: float) -> np.ndarray:
    """Losses, their broad parts and gains of the nodes of two alphas, (COSINES, TURNS, 3)."""
    nodes = directions()
    matrix = np.empty((len(nodes), len(nodes)))
    for i, stretched in enumerate(nodes):
        weight, out = reflections(ax, ay, stretched)
        matrix[i] = spread(*place(ax, ay, out), weight)
    loss = np.maximum(1.0 - matrix.sum(axis=1), 0.0)
    tangent2 = 1.0 / np.array([w[2] for w in nodes]) ** 2 - 1.0
    broad = loss * broad_part(tangent2, (ax * ay) ** 0.25, ay / ax)
    return whole(loss, broad, gains(matrix, 1.0 - broad)).reshape(COSINES, TURNS, 3)


def table() -> np.ndarray:
    out = np.empty((ALPHAS, RATIOS, COSINES, TURNS, 3), np.uint16)
    for i, k in np.ndindex(ALPHAS, RATIOS):
        ax = max(i / (ALPHAS - 1), ALPHA_MIN)
        out[i, k] = slice_of(ax, max(ax * k / (RATIOS - 1), ALPHA_MIN))
    return out


def interpolated(values: np.ndarray, at: list[np.ndarray]) -> np.ndarray:
    """Linear in each coordinate, which are 0..1."""
    nodes, parts = [], []
    for x, count in zip(at, values.shape, strict=True):
        along = np.clip(x, 0.0, 1.0) * (count - 1)
        nodes.append(np.minimum(along.astype(int), count - 2))
        parts.append(along - nodes[-1])
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
    sine, ay = np.sqrt(1.0 - cosine**2), max(ax * ratio, ALPHA_MIN)
    w = np.stack([sine * np.cos(turn), sine * np.sin(turn), cosine], axis=-1)
    at, turned = place(ax, ay, w)
    found = interpolated(values, [np.array(ax), np.array(ratio), at, turned])
    return float((found * weight).sum() / weight.sum())


def braced(values: np.ndarray) -> str:
    """A C initialiser, with several of the last coordinates on a line."""
    if values.ndim == 1:
        whole = values.dtype == np.uint16
        return "{" + ", ".join(f"{v}" if whole else f"{v:.6g}f" for v in values) + "}"
    per_line = 3 if values.shape[1:] in ((3,), (TURNS, 3)) else 1
    return "{" + rows([braced(part) for part in values], per_line) + "}"


def main() -> None:
    values = table()
    grid = np.linspace(0.0, 1.0, MEAN_ALPHAS), np.linspace(0.0, 1.0, MEAN_RATIOS)
    loss, broad = (
        np.array([[mean(part, max(ax, ALPHA_MIN), k) for k in grid[1]] for ax in grid[0]])
        for part in (values[..., 0] / SCALE, values[..., 1] / SCALE)
    )
    names = ["ALPHAS", "RATIOS", "COSINES", "TURNS"]
    sizes = ", ".join(f"{n} = {s}" for n, s in zip(names, values.shape[:-1], strict=True))
    text = (
        f"{HEAD}enum {{ {sizes} }};\n"
        f"/* Loss and its broad part, of {SCALE}, and gain, of {GAIN_SCALE}. */\n"
        f"static const uint16_t loss_table[{']['.join(names)}][3] =\n  {braced(values)};\n"
        f"/* Cosine-weighted means of the losses and broad parts as interpolated. */\n"
        f"enum {{ MEAN_ALPHAS = {MEAN_ALPHAS}, MEAN_RATIOS = {MEAN_RATIOS} }};\n"
        f"static const float mean_table[MEAN_ALPHAS][MEAN_RATIOS] =\n  {braced(loss)};\n"
        f"static const float broad_table[MEAN_ALPHAS][MEAN_RATIOS] =\n  {braced(broad)};\n"
    )
    Path(__file__).with_suffix(".h").write_text(text)


if __name__ == "__main__":
    main()
