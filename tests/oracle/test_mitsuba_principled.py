"""The principled surface against Mitsuba 3's `principled`: balls lit by a sun, by direct light.

Both draw the same mesh with the same smooth normals, and blocks of pixels are compared as in
test_mitsuba.py. The two agree by design in GGX's distribution, in Schlick's formula for metals, in
Fresnel's for dielectrics and, at index 1, in the diffuse base near normal incidence; and below a
smooth surface with the base of their `plastic`, but for a fit of theirs that is known. By design
they differ in this; the angles where it matters are left out:

- shadowing: theirs is a product of two maskings, ours correlates heights: steep angles count;
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
    glint_deg: float = 0.0  # half vectors closer to the normal are left out
    index: float | None = None  # of a smooth boundary over a base
    given_back: float = 1.0  # what goes from facet to facet and stays in the lobe


def metal(color: tuple[float, float, float], roughness: float) -> dict[str, Any]:
    return {
        "baseColorFactor": [*color, 1.0],
        "metallicFactor": 1.0,
        "roughnessFactor": roughness,
    }


def plastic(color: tuple[float, float, float], roughness: float) -> dict[str, Any]:
    return metal(color, roughness) | {"metallicFactor": 0.0}


def rgb(color: tuple[float, float, float]) -> dict[str, Any]:
    return {"type": "rgb", "value": list(color)}


def of(color: tuple[float, float, float], **others: float) -> dict[str, Any]:
    return {"type": "principled", "base_color": rgb(color), **others}


GOLD, BLACK, PAINT = (1.0, 0.75, 0.3), (0.0, 0.0, 0.0), (0.7, 0.5, 0.2)
CASES = {
    "gold": Case(metal(GOLD, 0.3), of(GOLD, metallic=1.0, roughness=0.3), 55, 0.05),
    # Alphas of 0.1719 along the tangent and 0.09 across, by each one's rule; tangents along u. What
    # ours gives back about the mirror's direction is 0.9 % there; 0.2 % by random walks.
    "brushed gold": Case(
        metal(GOLD, 0.3),
        of(GOLD, metallic=1.0, roughness=0.3527, anisotropic=0.5294),
        45,
        0.25,
        {"KHR_materials_anisotropy": {"anisotropyStrength": 0.3}},
        given_back=1.009,
    ),
    "black plastic": Case(plastic(BLACK, 0.3), of(BLACK, roughness=0.3, eta=1.5), 55, 0.05),
    "black diamond": Case(
        plastic(BLACK, 0.3),
        of(BLACK, roughness=0.3, eta=2.4),
        55,
        0.05,
        {"KHR_materials_ior": {"ior": 2.4}},
    ),
    # What a smooth boundary throws back to the base leaves uncoloured (`nonlinear` off).
    "lacquer": Case(
        plastic(PAINT, 0.0),
        {"type": "plastic", "int_ior": 1.5, "nonlinear": False, "diffuse_reflectance": rgb(PAINT)},
        78,
        0.0,
        glint_deg=12.0,
        index=1.5,
    ),
    "diamond over paint": Case(
        plastic(PAINT, 0.0),
        {"type": "plastic", "int_ior": 2.4, "nonlinear": False, "diffuse_reflectance": rgb(PAINT)},
        78,
        0.0,
        {"KHR_materials_ior": {"ior": 2.4}},
        glint_deg=12.0,
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
    """(H, W) cosines of the normal to the viewer, the sun, and half between; NaN off the ball."""
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
    return -(ray * normal).sum(-1), normal @ SUN, (normal * half).sum(-1)


def entering(index: float) -> float:
    """Mean over the hemisphere of the light that enters, by Fresnel's formula."""
    cosine = (np.arange(20000) + 0.5) / 20000
    inner = np.sqrt(1.0 - (1.0 - cosine**2) / index**2)
    across = (cosine - index * inner) / (cosine + index * inner)
    along = (index * cosine - inner) / (index * cosine + inner)
    return float(np.mean(2.0 * cosine * (1.0 - 0.5 * (across**2 + along**2))))


def their_entering(index: float) -> float:
    """As Mitsuba has it, by Egan and Hilgeman's fit (1973): 0.1 % less at 1.5, 2.7 % at 2.4."""
    r = 1.0 / index
    inside = -1.4399 * r**2 + 0.7099 * r + 0.6681 + 0.0636 / r
    return index**2 * (1.0 - inside)


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_same_ball(name: str, tmp_path: Path):
    case = CASES[name]
    shapes = [ball(case)]
    a = base.ours(shapes, base.SOLAR, 1, tmp_path, SUN, samples=16)
    b = case.given_back * base.theirs(shapes, base.SOLAR, 1, tmp_path, SUN, samples=16)
    if case.index is not None:
        b *= their_entering(case.index) / entering(case.index)
    seen, lit, half = geometry()
    limit = np.cos(np.radians(case.steepest_deg))
    bright = b.mean((0, 3))
    fit = (np.nan_to_num(seen) > limit) & (np.nan_to_num(lit) > limit)
    fit &= bright > case.least * bright.max()
    if case.glint_deg > 0.0:
        fit &= np.nan_to_num(half, nan=1.0) < np.cos(np.radians(case.glint_deg))
    blocks = fit.reshape(base.HEIGHT // base.BLOCK, base.BLOCK, -1, base.BLOCK).all((1, 3))
    fit = blocks.repeat(base.BLOCK, 0).repeat(base.BLOCK, 1)
    assert blocks.sum() >= 4
    if case.index is not None:
        # Too little noise for a test of chance: tables and a mesh's normals have errors of 0.1 %.
        off = np.abs((a.mean(0) / np.maximum(b.mean(0), 1e-9))[fit] - 1.0)
        print(f"{name}: {blocks.sum()} blocks, largest difference {off.max():.4f}")
        assert off.max() < 6e-3
        assert off.mean() < 1.5e-3
        return
    a, b = a * fit[..., None], b * fit[..., None]
    p = base.worst_p_value(a, b)
    ratio = a.mean() / b.mean()
    print(f"{name}: {blocks.sum()} blocks, p = {p:.3g}, mean ratio {ratio:.5f}")
    assert p > base.FALSE_ALARM
    assert abs(ratio - 1.0) < 5e-3
    # The test is sharp enough to see 3 %.
    assert base.worst_p_value(1.03 * a, b) < base.FALSE_ALARM
