"""Photometry at the ends of its parameters, through the renderer: light from in front, from behind
and along the surface, no roughness and all of it, black and white grains, surges without width."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.python import moon

from perilune.base import rotations

F64 = NDArray[np.float64]

SIZE = 33  # odd: a pixel is seen under i = e = phase / 2 exactly
LAWS = ("hapke", "hapke_smooth", "lommel_seeliger", "lunar_lambert", "minnaert", "lambert")
PHASES = (0.0, 1e-9, 1e-4, 0.3, 5.0, 90.0, 150.0, 179.0, 179.9999, 180.0)
ORDINARY = {
    "b": 0.25, "c": 0.3, "b_c0": 0.4, "h_c": 0.05, "b_s0": 1.5, "h_s": 0.06,
    "roughness": math.radians(20.0), "filling": 0.1,
}  # fmt: skip
ENDS: dict[str, tuple[float, ...]] = {
    "b": (0.0, 0.95),
    "c": (-2.0, -1.0, 1.0, 2.0),
    "b_c0": (0.0, 10.0),
    "h_c": (0.0, 1e-12, 1e-6, 10.0),
    "b_s0": (0.0, 10.0),
    "h_s": (0.0, 1e-12, 1e-6, 10.0),
    "roughness": (0.0, 1e-9, 1e-4, math.radians(60.0)),
    "filling": (0.0, 0.75),
}
ALBEDOS = (0.0, 1e-12, 0.3, 1.0 - 1e-9, 1.0)


def seen(
    phase_deg: float, albedo: float = 0.3, law: str = "hapke", **changes: Any
) -> NDArray[np.float32]:
    """(SIZE, SIZE) radiance of a ball with parameters changed."""
    row = np.zeros((1, 27))
    row[0, :24] = list((ORDINARY | changes).values()) * 3
    row[0, 24] = 0.6  # Minnaert's exponent
    asked = moon.request(SIZE, phase_deg, body_regolith=row, body_albedo=np.full((1, 3), albedo))
    return moon.radiance(moon.scene(law), asked)[:, :, 1]


def angles(phase_deg: float) -> tuple[F64, F64]:
    """Cosines of incidence and emission at the middles of pixels; NaN off the ball."""
    asked = moon.request(SIZE, phase_deg)
    focal = asked["K"][0, 0]
    rows, columns = np.indices((SIZE, SIZE)) - 0.5 * (SIZE - 1)
    d = np.stack([columns / focal, rows / focal, np.ones(rows.shape)], axis=-1)
    d = d / np.linalg.norm(d, axis=-1, keepdims=True) @ rotations.to_matrix(moon.LOOK_DOWN_X).T
    eye = np.array([moon.DISTANCE_M, 0.0, 0.0])
    b = d @ eye
    inside = b * b - moon.DISTANCE_M**2 + moon.RADIUS_M**2
    with np.errstate(invalid="ignore"):
        normal = (eye + (-b - np.sqrt(inside))[..., None] * d) / moon.RADIUS_M
    sun = asked["sun_position"] / np.linalg.norm(asked["sun_position"])
    return normal @ sun, -(normal * d).sum(axis=-1)


FROM_CENTRE = np.hypot(*(np.indices((SIZE, SIZE)) - SIZE // 2))
"""In pixels; the ball's limb is at 15.8, and behind it, near g = 180, is the Sun."""


def check(image: NDArray[np.float32], brightest: float) -> None:
    assert np.isfinite(image).all()
    assert (image >= 0.0).all()
    assert image[FROM_CENTRE < 15.0].max() <= brightest


@pytest.mark.parametrize("key", ENDS)
def test_ends_of_every_parameter_at_every_phase(key: str) -> None:
    """Nothing infinite, negative or brighter than the phase function and its surges allow."""
    lobe = 2.0 * 1.5 * (1 + 0.95) / (1 - 0.95) ** 2  # of both lobes, |c| to 2
    most = moon.SOLAR / math.pi * 4.0 * lobe * 11.0 * 11.0
    for value, albedo, phase in itertools.product(ENDS[key], (0.0, 0.3, 1.0), PHASES):
        check(seen(phase, albedo, **{key: value}), most)


@pytest.mark.parametrize("law", LAWS)
def test_all_laws_at_every_phase(law: str) -> None:
    """Dark where the Sun is below the horizon by more than its radius, lit where it is well up:
    at g = 180 nothing, at g = 0 all."""
    for phase in PHASES:
        image = seen(phase, law=law)
        check(image, moon.SOLAR)
        mu0, mu = angles(phase)
        pixel = 2.2 / SIZE  # of the radius: what the samples of a pixel on the ball may be off by
        with np.errstate(invalid="ignore"):
            reach = pixel / np.maximum(mu, 0.05) + 0.01
            dark = mu0 < -reach
            if phase >= 179.9999:  # pixels at the limb see a ring of the Sun beside the ball
                dark &= FROM_CENTRE < 14.0
            assert (image[dark] == 0.0).all()
            assert (image[(mu0 > reach) & (mu > 0.2)] > 0.0).all()
        if phase >= 179.9999:
            # The whole night side; the Sun's disc is up at the limb for 0.27 degrees.
            assert image[FROM_CENTRE < 14.0].max() == 0.0


@pytest.mark.parametrize("roughness", [0.0, 1e-6, math.radians(60.0)])
def test_both_sides_of_the_plane_of_light_are_the_same(roughness: float) -> None:
    """Azimuths psi and -psi: north and south of the Sun's plane; through 0 and 180 at i = e."""
    for phase in (0.0, 30.0, 90.0, 120.0):
        image = seen(phase, roughness=roughness).astype(float)
        scale = image.max()
        assert scale > 0.0
        inner = (FROM_CENTRE < 13.0) & (angles(phase)[0] > 0.15)
        off = np.abs(image - image[::-1])[inner & inner[::-1]]
        assert off.max() < 0.02 * scale  # four samples a pixel, not mirrored themselves
        assert off.mean() < 6e-3 * scale


STEPS = {
    "roughness": [(0.0, 1e-9), (0.0, 1e-5), (math.radians(60.0) - 1e-5, math.radians(60.0))],
    "h_s": [(0.0, 1e-12), (1e-3, 1.001e-3)],
    "h_c": [(0.0, 1e-12), (1e-3, 1.001e-3)],
    "filling": [(0.0, 1e-6), (0.75 - 1e-6, 0.75)],
    "b": [(0.0, 1e-6), (0.95 - 1e-7, 0.95)],
    "c": [(1.0 - 1e-6, 1.0), (1.0, 1.0 + 1e-6)],
}


@pytest.mark.parametrize("key", STEPS)
@pytest.mark.parametrize("phase", [0.3, 5.0, 60.0, 120.0])
def test_continuous_in_every_parameter(key: str, phase: float) -> None:
    """A small step of a parameter is a small step of the image, to its ends too. Not at g = 0,
    where a surge of no width is a point."""
    for low, high in STEPS[key]:
        a, b = (seen(phase, **{key: value}).astype(float) for value in (low, high))
        assert np.abs(a - b).max() <= 2e-3 * a.max()


def test_continuous_in_albedo_and_phase() -> None:
    for low, high in ((0.0, 1e-7), (1.0 - 1e-7, 1.0)):
        for phase in (0.0, 60.0, 170.0):
            a, b = (seen(phase, albedo).astype(float) for albedo in (low, high))
            assert np.abs(a - b).max() <= 2e-3 * max(b.max(), 1e-3 * moon.SOLAR)
    for phase in (0.0, 10.0, 90.0, 170.0):
        for roughness in (0.0, 0.35, math.radians(60.0)):
            a, b = (seen(g, roughness=roughness).astype(float) for g in (phase, phase + 1e-5))
            assert abs(a.sum() / b.sum() - 1.0) < 1e-3


def test_black_is_black_and_white_is_brighter_than_grey() -> None:
    for phase in (0.0, 30.0, 120.0):
        assert (seen(phase, 0.0) == 0.0).all()
        light = [float(seen(phase, albedo).sum()) for albedo in ALBEDOS]
        assert light == sorted(light)


def test_rougher_is_darker_at_the_terminator_and_limb() -> None:
    """Shadows: at 90 degrees the ball loses light with every step of roughness."""
    light = [float(seen(90.0, roughness=math.radians(t)).sum()) for t in (0, 10, 20, 40, 60)]
    assert light == sorted(light, reverse=True)
    assert light[-1] > 0.0


def test_a_surge_of_no_width_is_none() -> None:
    """At opposition too: the Sun's disc blurs a point away."""
    for phase in (0.0, 1.0, 30.0):
        none = seen(phase, b_s0=0.0, b_c0=0.0).astype(float)
        point = seen(phase, h_s=0.0, h_c=0.0).astype(float)
        np.testing.assert_allclose(point, none, rtol=1e-5, atol=1e-6)
