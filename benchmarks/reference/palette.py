"""Palettes: textures of which each triangle reads one texel are materials without textures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .scene import Array, Image, Material

MOST = 64
"""Colours of a palette: what has more is a picture."""


def _texels(image: Image, corners: Array) -> Array | None:
    """(T, channels): what each triangle reads, by uv of its corners (T, 3, 2); None where one reads
    several texels."""
    height, width = image.pixels.shape[:2]
    at = np.floor(np.mod(corners, 1.0) * [width, height]).astype(int)
    at = np.minimum(at, [width - 1, height - 1])
    one_texel = image.nearest and (at == at[:, :1]).all()
    if not one_texel and (corners != corners[:, :1]).any():
        return None
    values = image.linear()
    return np.asarray(values[height - 1 - at[:, 0, 1], at[:, 0, 0]])


def split(material: Material, corners: Array | None, count: int) -> list[tuple[Material, Array]]:
    """Materials and which triangles (T,) have them; one with all where it is no palette.

    corners: (T, 3, 2), uv, v upwards; count: T."""
    whole = [(material, np.ones(count, dtype=bool))]
    inputs = {key: value for key, value in vars(material).items() if isinstance(value, Image)}
    if corners is None or not inputs or "normal" in inputs:
        return whole
    read = {key: _texels(image, corners) for key, image in inputs.items()}
    if any(values is None for values in read.values()):
        return whole
    rows = np.hstack([values for values in read.values() if values is not None])
    kinds, which = np.unique(rows, axis=0, return_inverse=True)
    if len(kinds) > MOST:
        return whole
    out = []
    for index, row in enumerate(kinds):
        values, start = {}, 0
        for key, texels in read.items():
            assert texels is not None
            values[key] = tuple(float(v) for v in row[start : start + texels.shape[1]])
            start += texels.shape[1]
        skin = replace(material, name=f"{material.name}.{index}", **values)
        out.append((skin, which.reshape(-1) == index))
    return out
