"""The principled surface against Mitsuba 3's `principled`: balls lit by a sun, by direct light.

Both draw the same mesh with the same smooth normals, and blocks of pixels are compared as in
test_mitsuba.py. The two agree by design in GGX's distribution, in Schlick's formula for metals and,
at index 1, in the diffuse base near normal incidence. By design they differ in this; `theirs` is
brought to ours by a known factor, or the angles where it matters are left out:

- shadowing: theirs is a product of two maskings, ours correlates heights: steep angles count;
- dielectrics: theirs has Fresnel's formula, ours Schlick's: the ratio is known at each half vector;
- the diffuse base: theirs is Disney's, ours is Lambert's under what the surface mirrors: they meet
  to 0.3 % within 45 degrees where the surface mirrors nothing;
- reflection from facet to facet: ours gives back what one reflection loses, theirs does not: lobes
  are smooth enough that little is lost, and only what they make bright is compared;
- the coat: theirs is GTR1 with a quarter of the weight; nothing is compared.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.oracle import test_mitsuba as base

CENTER, RADIUS = np.array([0.0, 0.0, 0.4]), 4.0
SUN = np.array([0.75, -0.65, 0.25]) / np.linalg.norm([0.75, -0.65, 0.25])


@dataclass
class Case:
    pbr: dict[str, Any]
    theirs: dict[str, Any]
    steepest_deg: float  # largest angle from the normal that is compared, of view and sun
    least: float  # of the brightest pixel: darker ones are left out
    extensions: dict[str, Any] = field(default_factory=dict)
    index: float | None = None  # their Fresnel's, where ours is Schlick's


def metal(color: tuple[float, float, float], roughness: float) -> dict[str, Any]:
    return {
        "baseColorFactor": [*color, 1.0],
        "metallicFactor": 1.0,
        "roughnessFactor": roughness,
    }


def plastic(color: tuple[float, float, float], roughness: float) -> dict[str, Any]:
    return metal(color, roughness) | {"metallicFactor": 0.0}


def of(color: tuple[float, float, float], **others: float) -> dict[str, Any]:
    rgb = {"type": "rgb", "value": list(color)}
    return {"type": "principled", "base_color": rgb, **others}


GOLD, BLACK, PAINT = (1.0, 0.75, 0.3), (0.0, 0.0, 0.0), (0.7, 0.5, 0.2)
CASES = {
    "gold": Case(metal(GOLD, 0.3), of(GOLD, metallic=1.0, roughness=0.3), 55, 0.05),
    # Alphas of 0.1719 along the tangent and 0.09 across, by each one's rule; tangents along u. With
    # wider lobes what ours gives back shows: 0.8 % at 0.32 and 0.09.
    "brushed gold": Case(
        metal(GOLD, 0.3),
        of(GOLD, metallic=1.0, roughness=0.3527, anisotropic=0.5294),
        45,
        0.25,
        {"KHR_materials_anisotropy": {"anisotropyStrength": 0.3}},
    ),
    "black plastic": Case(
        plastic(BLACK, 0.3), of(BLACK, roughness=0.3, eta=1.5), 55, 0.05, index=1.5
    ),
    "black diamond": Case(
        plastic(BLACK, 0.3),
        of(BLACK, roughness=0.3, eta=2.4),
        55,
        0.05,
        {"KHR_materials_ior": {"ior": 2.4}},
        index=2.4,
    ),
    "paint of index 1": Case(
        plastic(PAINT, 0.5),
        of(PAINT, roughness=0.5, specular=0.0),
        40,
        0.05,
        {"KHR_materials_ior": {"ior": 1.0}},
    ),
}


def ball(case: Case) -> base.Shape:
    corners = base.ball(CENTER, RADIUS, 64, 128)
    normals = (corners - CENTER) / np.linalg.norm(corners - CENTER, axis=-1, keepdims=True)
    x, y, z = np.moveaxis((corners - CENTER) / RADIUS, -1, 0)
    turn = np.arctan2(y, x)
    turn += 2.0 * np.pi * (turn - turn.mean(1, keepdims=True) < -np.pi)  # across the seam
    uvs = np.stack([turn / (2.0 * np.pi), np.arccos(np.clip(z, -1.0, 1.0)) / np.pi], -1)
    gltf = {"pbrMetallicRoughness": case.pbr, "extensions": case.extensions}
    return base.Shape(corners, BLACK, normals=normals, uvs=uvs, gltf=gltf, bsdf=case.theirs)


def geometry() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(H, W) cosines to the viewer, the sun, and from half between to either; NaN off the ball."""
    x, y = np.meshgrid(np.arange(base.WIDTH), np.arange(base.HEIGHT))
    z = (base.TARGET - base.EYE) / np.linalg.norm(base.TARGET - base.EYE)
    right = np.cross(z, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    down = np.cross(z, right)
    u, v = (x - (base.WIDTH - 1) / 2) / base.FOCAL, (y - (base.HEIGHT - 1) / 2) / base.FOCAL
    ray = z + u[..., None] * right + v[..., None] * down
    ray /= np.linalg.norm(ray, axis=-1, keepdims=True)
    from_center = base.EYE - CENTER
    along = ray @ from_center
    inside = along**2 - from_center @ from_center + RADIUS**2
    distance = -along - np.sqrt(np.where(inside > 0.0, inside, np.nan))
    normal = (from_center + distance[..., None] * ray) / RADIUS
    half = SUN - ray
    half /= np.linalg.norm(half, axis=-1, keepdims=True)
    return -(ray * normal).sum(-1), normal @ SUN, half @ SUN


def fresnel(cosine: np.ndarray, index: float) -> np.ndarray:
    inner = np.sqrt(1.0 - (1.0 - cosine**2) / index**2)
    across = (cosine - index * inner) / (cosine + index * inner)
    along = (index * cosine - inner) / (index * cosine + inner)
    return 0.5 * (across**2 + along**2)


def schlick(cosine: np.ndarray, index: float) -> np.ndarray:
    f0 = ((index - 1.0) / (index + 1.0)) ** 2
    return f0 + (1.0 - f0) * (1.0 - cosine) ** 5


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_same_ball(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    case = CASES[name]
    monkeypatch.setattr(base, "OUR_SAMPLES", 64)
    monkeypatch.setattr(base, "THEIR_SAMPLES", 32)
    shapes = [ball(case)]
    a = base.ours(shapes, base.SOLAR, 1, tmp_path, SUN)
    b = base.theirs(shapes, base.SOLAR, 1, tmp_path, SUN)
    seen, lit, half = geometry()
    if case.index is not None:
        ratio = schlick(half, case.index) / fresnel(half, case.index)
        b *= np.nan_to_num(ratio, nan=1.0)[..., None]
    limit = np.cos(np.radians(case.steepest_deg))
    bright = b.mean((0, 3))
    fit = (np.nan_to_num(seen) > limit) & (np.nan_to_num(lit) > limit)
    fit &= bright > case.least * bright.max()
    blocks = fit.reshape(base.HEIGHT // base.BLOCK, base.BLOCK, -1, base.BLOCK).all((1, 3))
    fit = blocks.repeat(base.BLOCK, 0).repeat(base.BLOCK, 1)
    assert blocks.sum() >= 4
    a, b = a * fit[..., None], b * fit[..., None]
    p = base.worst_p_value(a, b)
    ratio = a.mean() / b.mean()
    print(f"{name}: {blocks.sum()} blocks, p = {p:.3g}, mean ratio {ratio:.5f}")
    assert p > base.FALSE_ALARM
    assert abs(ratio - 1.0) < 5e-3
    # The test is sharp enough to see 3 %.
    assert base.worst_p_value(1.03 * a, b) < base.FALSE_ALARM
