"""BOP's pose errors and recalls (Hodan et al., BOP Challenge 2020 on 6D Object Localization),
written from their definitions, without symmetries. Lengths in mm."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .bop_worlds import F64, Mask, Solid

DELTA_MM = 15.0
PARTS = np.linspace(0.05, 0.5, 10)
"""Thresholds: of MSSD and VSD parts of the diameter; of MSPD times 100 pixels in an image 640
pixels wide."""
CORRECT = np.linspace(0.05, 0.5, 10)
"""Thresholds of VSD itself."""


@dataclass(frozen=True)
class View:
    """An image: intrinsics, size, and distances of the depth image along rays, 0 where it has
    none."""

    K: F64
    shape: tuple[int, int]
    distance: F64

    @property
    def stretch(self) -> F64:
        """Distance along a pixel's ray over its depth."""
        v, u = np.mgrid[: self.shape[0], : self.shape[1]]
        rays = np.stack([u, v, np.ones_like(u)], axis=-1) @ np.linalg.inv(self.K).T
        out: F64 = np.linalg.norm(rays, axis=-1)
        return out

    def of(self, solid: Solid, R: F64, t: F64) -> F64:
        """Distances of a model alone, 0 beside it."""
        depth, _ = solid.depth(self.K, R, t, self.shape)
        return np.where(np.isfinite(depth), depth, 0.0) * self.stretch


def _visible(scene: F64, model: F64) -> Mask:
    near = (model - scene <= DELTA_MM) | (scene == 0.0)
    return near & (model > 0.0)


def vsd(view: View, solid: Solid, truth: tuple[F64, F64], guess: tuple[F64, F64]) -> F64:
    """Visible surface discrepancy for each tolerance of PARTS."""
    real, found = view.of(solid, *truth), view.of(solid, *guess)
    seen = _visible(view.distance, real)
    claimed = _visible(view.distance, found) | (seen & (found > 0.0))
    both, any_of = seen & claimed, (seen | claimed).sum()
    if any_of == 0:
        return np.ones(len(PARTS))
    off = np.abs(real - found)[both] / solid.diameter
    wrong = (off[None] >= PARTS[:, None]).sum(axis=1)
    out: F64 = (wrong + any_of - both.sum()) / any_of
    return out


def mssd(solid: Solid, truth: tuple[F64, F64], guess: tuple[F64, F64]) -> float:
    """Largest distance of a vertex, mm."""
    apart = solid.points @ truth[0].T + truth[1] - solid.points @ guess[0].T - guess[1]
    return float(np.linalg.norm(apart, axis=1).max())


def mspd(view: View, solid: Solid, truth: tuple[F64, F64], guess: tuple[F64, F64]) -> float:
    """Largest distance of the image of a vertex, px."""
    pixels = []
    for R, t in (truth, guess):
        at = (solid.points @ R.T + t) @ view.K.T
        pixels.append(at[:, :2] / at[:, 2:])
    return float(np.linalg.norm(pixels[0] - pixels[1], axis=1).max())


def recalls(view: View, solid: Solid, truth: tuple[F64, F64], guess: tuple[F64, F64]) -> F64:
    """Shares of thresholds at which the guess is right: VSD, MSSD, MSPD."""
    surface = (vsd(view, solid, truth, guess)[:, None] < CORRECT).mean()
    space = (mssd(solid, truth, guess) < PARTS * solid.diameter).mean()
    image = mspd(view, solid, truth, guess) < 100.0 * PARTS * view.shape[1] / 640.0
    return np.array([surface, space, image.mean()])
