"""Makes ggx_loss_table.h: the light that single-scattering GGX loses, by roughness and angle, and
what its lobe is to be multiplied by to give most of that back.

    python csrc/shade/ggx_loss_table.py

The directional albedo of a white GGX surface with height-correlated Smith shadowing (Heitz 2014,
eq. 99) is the mean of G2/G1 over visible normals (Heitz 2018). It is integrated on a grid over the
disc that visible normals are drawn from; cells narrow towards the rim, where the lobe's tail lies.

`broad_part` of the loss returns as a broad lobe. The gains g are such that the lobe times
g(wo) g(wi), which is reciprocal, has the rest of an even sky's light: a diagonal scaling of the
symmetric matrix of the lobe (Sinkhorn 1964), found by iteration.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

ROUGHNESSES, COSINES = 32, 64  # nodes
GRID = 384  # integration cells in each direction
ALPHA_MIN = 1e-3  # as in metallic_roughness.c
COSINE_MIN = 1e-4
SCALE = 65535
GAIN_SCALE = 16384
# Fitted to random walks between microfacets (tests/c/test_microfacets.c).
BROAD_SLOPE, BROAD_TANGENT = 1.15, 0.06

HEAD = """\
/* Made by ggx_loss_table.py; included by ggx_loss.c alone. Rows: roughness, columns: square root of
 * the cosine, both evenly spaced over 0..1. */
#include <stdint.h>

// clang-format off
"""


def smith_lambda(alpha: float, cosine: np.ndarray) -> np.ndarray:
    tan2 = alpha**2 * (1.0 / np.maximum(cosine, 1e-9) ** 2 - 1.0)
    return 0.5 * (np.sqrt(1.0 + tan2) - 1.0)


def reflections(
    cosine: float, alpha: float, grid: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of the visible normals: cosines to the view, shares of the light that single-scattering GGX
    would reflect towards the view if it were white, and cosines of where that comes from."""
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
    return half, seen * weight / weight.sum(), out


def broad_part(tangent2: np.ndarray, roughness: float, ratio: float = 1.0) -> np.ndarray:
    """Part of the loss that returns broadly: of the squared tangent of the angle to the normal in
    stretched axes, the square root of the alphas' geometric mean, and their ratio."""
    least = min(BROAD_SLOPE * roughness, 1.0)
    return least + (1.0 - least) * ratio / (1.0 + tangent2 / BROAD_TANGENT**2)


def gains(matrix: np.ndarray, albedo: np.ndarray) -> np.ndarray:
    """g with g_i sum_k matrix_ik g_k = albedo_i."""
    g = np.sqrt(albedo / matrix.sum(axis=1))
    for _ in range(60):
        g = np.sqrt(g * albedo / (matrix @ g))
    return g


def row_of(alpha: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Losses, their broad parts and gains at the nodes. What comes from between nodes has their
    interpolated gain."""
    roots = np.linspace(0.0, 1.0, COSINES)
    cosines = np.maximum(roots**2, COSINE_MIN)
    matrix = np.zeros((COSINES, COSINES))
    for i, cosine in enumerate(cosines):
        _, share, out = reflections(cosine, alpha, GRID)
        place = np.sqrt(np.clip(out, 0.0, 1.0)).ravel() * (COSINES - 1)
        node = np.minimum(place.astype(int), COSINES - 2)
        above, weight = place - node, share.ravel()
        matrix[i] += np.bincount(node, (1.0 - above) * weight, COSINES)
        matrix[i] += np.bincount(node + 1, above * weight, COSINES)
    loss = np.maximum(1.0 - matrix.sum(axis=1), 0.0)
    broad = loss * broad_part(tangent2(alpha, cosines), alpha**0.5)
    return loss, broad, gains(matrix, 1.0 - broad)


def tangent2(alpha: float, cosine: np.ndarray) -> np.ndarray:
    return alpha**2 * (1.0 / np.maximum(cosine, COSINE_MIN) ** 2 - 1.0)


def whole(loss: np.ndarray, broad: np.ndarray, gain: np.ndarray) -> np.ndarray:
    """As they are stored, along a last axis."""
    scales = np.array([SCALE, SCALE, GAIN_SCALE])
    values = np.rint(np.stack([loss, broad, gain], axis=-1) * scales)
    return np.clip(values, 0, SCALE).astype(np.uint16)


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
    found = [row_of(max(r * r, ALPHA_MIN)) for r in np.linspace(0.0, 1.0, ROUGHNESSES)]
    values = whole(*(np.array(part) for part in zip(*found, strict=True)))
    body = ",\n".join(
        "  {" + rows(["{" + ", ".join(map(str, node)) + "}" for node in row], 8) + "}"
        for row in values
    )
    loss, broad = (
        rows([f"{v:.8g}f" for v in cosine_mean(values[..., k] / SCALE)], 6) for k in range(2)
    )
    text = (
        f"{HEAD}enum {{ ROUGHNESSES = {ROUGHNESSES}, COSINES = {COSINES} }};\n"
        f"/* Loss and its broad part, of {SCALE}, and gain, of {GAIN_SCALE}. */\n"
        f"static const uint16_t loss_table[ROUGHNESSES][COSINES][3] = {{\n{body}}};\n"
        f"/* Cosine-weighted means of each row's losses and broad parts as interpolated. */\n"
        f"static const float mean_table[ROUGHNESSES] = {{\n  {loss}}};\n"
        f"static const float broad_table[ROUGHNESSES] = {{\n  {broad}}};\n"
    )
    Path(__file__).with_suffix(".h").write_text(text)


if __name__ == "__main__":
    main()
