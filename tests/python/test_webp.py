"""WebP images against a second decoder, Pillow's, which carries a libwebp of its own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from perilune._core import Map


def means(path: Path) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The mean of RGB by both decoders, 0..1."""
    with Image.open(path) as image:
        expected = np.asarray(image.convert("RGB"), float).mean(axis=(0, 1)) / 255
    return Map(str(path), srgb=False).mean[:3], expected


@pytest.mark.parametrize("mode", ["RGB", "RGBA"])
@pytest.mark.parametrize("lossless", [True, False])
@pytest.mark.parametrize("size", [(1, 1), (17, 5), (256, 130)])
def test_means_agree(tmp_path: Path, mode: str, lossless: bool, size: tuple[int, int]) -> None:
    rng = np.random.default_rng([*size, lossless, mode == "RGBA"])
    texels = rng.integers(1, 256, (*size[::-1], len(mode)), dtype=np.uint8)
    path = tmp_path / "map.webp"
    Image.fromarray(texels, mode).save(path, lossless=lossless, exact=True, quality=80)
    found, expected = means(path)
    np.testing.assert_allclose(found, expected, rtol=0, atol=2e-3)
    assert Map(str(path)).size == size


def test_cut_files_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "map.webp"
    Image.effect_noise((64, 64), 80).convert("RGB").save(path, quality=80)
    whole = path.read_bytes()
    for cut in range(0, len(whole), 37):
        path.write_bytes(whole[:cut])
        with pytest.raises(ValueError, match=r"map\.webp"):
            Map(str(path))
