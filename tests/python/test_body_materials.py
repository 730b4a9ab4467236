"""Graphs on bodies: as plain bodies where they should be, coordinates, no seams, errors."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import erfa
import numpy as np
import pytest
from numpy.typing import NDArray

import perilune
from perilune.base import rotations
from perilune.config.errors import ConfigError

SCENE = Path(__file__).parent / "scene.yaml"
MAP = "../../assets/maps/earth_like.jpg"
LAMBERT: dict[str, Any] = {"skin": {"type": "lambert"}}
DRIVER = {"ideal": 0.5, "jitter_variance": 0.1, "clip_min": 0.0, "clip_max": 1.0}
F64 = NDArray[np.float64]


def glowing(**nodes: Any) -> dict[str, Any]:
    """A surface whose radiance is the output of the node `c`, and that reflects nothing."""
    skin = {"type": "lambert", "base_color": 0, "emission_color": "c", "emission_strength": 1}
    return {**nodes, "skin": skin}


def opened(
    nodes: dict[str, Any] | None,
    body: dict[str, Any] | None = None,
    above: tuple[float, float, float] = (1.0, 0.3, 0.2),
    height_m: float = 2.2e7,
    **more: Any,
) -> perilune.Simulation:
    """The Earth alone, seen from above a point of it (body axes); with no nodes without a graph."""
    direction = np.array(above) / np.linalg.norm(above)

    def trajectory(world: Any) -> F64:
        up = rotations.rotate(world.poses["earth"][0, 3:], direction)
        return np.concatenate([up * height_m, rotations.look_at(-up, np.array([0.3, 0.5, 0.8]))])

    earth = {"kind": "earth", **({} if nodes is None else {"material": "m"}), **(body or {})}
    size = {"camera.width": 48, "camera.height": 48, "camera.fov_deg": 38}
    tree = {
        **size,
        "spacecraft": {},
        "camera.trajectory": {"kind": "orbit_object", "target": "earth", "distance_m": 9e6},
        "bodies.earth": earth,
        "render.samples": 8,
        **({} if nodes is None else {"materials": {"m": {"nodes": nodes}}}),
    }
    return perilune.open(SCENE, trajectory=trajectory, overrides={**tree, **more})


def lon_lat_deg(sim: perilune.Simulation, position: F64) -> tuple[F64, F64]:
    """Geodetic, of points in the root frame on the Earth."""
    turn = rotations.conjugate(sim.world(0).poses["earth"][0, 3:])
    p = np.array([rotations.rotate(turn, row) for row in position.reshape(-1, 3)])
    equator, _, pole = sim.world(0).body_radii_m["earth"]
    lon, lat, _ = erfa.gc2gde(equator, 1.0 - pole / equator, p)
    return np.degrees(lon), np.degrees(lat)


def test_a_graph_of_one_colour_is_a_body_of_that_albedo() -> None:
    plain = opened(None, {"albedo": [0.5, 0.4, 0.3]})
    skin = {"skin": {"type": "lambert", "base_color": [0.5, 0.4, 0.3]}}
    for name in ("rgb", "semantic", "instance", "depth"):
        assert np.array_equal(plain[0][name], opened(skin)[0][name])


def test_wrapping_without_inputs_changes_no_bit() -> None:
    for own in ({"color_map": MAP}, {"albedo": [0.2, 0.4, 0.3]}):
        wrapped = opened(LAMBERT, {**own, "material_mode": "wrap"})
        assert np.array_equal(opened(None, own)[0]["rgb"], wrapped[0]["rgb"])


def test_a_wrapped_input_is_the_graphs_and_the_rest_the_bodys() -> None:
    glow = {"skin": {"type": "lambert", "emission_color": [1, 0, 0], "emission_strength": 50}}
    own = {"color_map": MAP}
    fixed = {"camera.exposure": {"mode": "fixed", "white_radiance_w_m2_sr": 400}}
    plain = opened(None, own, **fixed, **{"render.channels": ["radiance"]})[0]["radiance"]
    wrapped = opened(glow, {**own, "material_mode": "wrap"}, **fixed)
    light = wrapped.frame(0, ["radiance", "depth"])
    inside = light["depth"] > 0
    more = (light["radiance"] - plain)[inside]
    assert np.allclose(np.median(more, axis=0), [50, 0, 0], atol=1e-3)


def test_longitude_and_latitude_are_those_of_the_position() -> None:
    """The position channel is made from the hit alone; the axes are the ephemeris's."""
    nodes = glowing(
        at={"type": "coordinates", "space": "lon_lat_deg"},
        c={"type": "vector_math", "function": "add", "a": "at", "b": [200, 200, 200]},
    )
    for above in ((1.0, 0.3, 0.2), (-1.0, 0.05, 0.1), (0.0, 0.1, -1.0)):
        sim = opened(nodes, above=above, **{"render.samples": 1})
        sample = sim.frame(0, ["radiance", "position"])
        hit = np.isfinite(sample["position"]).all(axis=2) & (sample["radiance"][..., 2] > 0)
        lon, lat = lon_lat_deg(sim, sample["position"][hit])
        got = sample["radiance"][hit].astype(np.float64) - 200.0
        turn = (got[:, 0] - lon + 180.0) % 360.0 - 180.0
        assert hit.sum() > 500
        assert np.abs(got[:, 1] - lat).max() < 2e-4
        assert np.abs(turn * np.cos(np.radians(lat))).max() < 2e-4


def test_object_coordinates_turn_with_the_body() -> None:
    nodes = glowing(
        at={"type": "coordinates"},
        scaled={"type": "mapping", "vector": "at", "scale": 1e-6, "location": [10, 10, 10]},
        c={"type": "vector_math", "function": "add", "a": "scaled", "b": 0},
    )
    for hours in (0, 5):
        epoch = f"2026-03-20T{12 + hours}:00:00Z"
        sim = opened(nodes, **{"render.samples": 1, "time.epoch": epoch})
        sample = sim.frame(0, ["radiance", "position"])
        hit = np.isfinite(sample["position"]).all(axis=2) & (sample["radiance"][..., 2] > 0)
        turn = rotations.conjugate(sim.world(0).poses["earth"][0, 3:])
        p = np.array([rotations.rotate(turn, row) for row in sample["position"][hit]])
        assert np.abs(sample["radiance"][hit] - 10.0 - 1e-6 * p).max() < 1e-5


@pytest.mark.parametrize("space", ["lon_lat_deg", "uv"])
def test_the_date_line_is_no_seam(space: str) -> None:
    """A pattern that repeats every 30 degrees looks the same half a turn on. A footprint that took
    the jump of a turn would be all of the map, and the pattern grey."""
    degrees = space == "lon_lat_deg"
    nodes = glowing(
        at={"type": "coordinates", "space": space},
        cells={"type": "mapping", "vector": "at", "scale": 1 / 15 if degrees else [24, 12, 1]},
        c={"type": "checker", "vector": "cells"},
    )
    exposure = {"camera.exposure": {"mode": "fixed", "white_radiance_w_m2_sr": 1}}
    views = []
    for side in (1.0, -1.0):
        sim = opened(nodes, above=(side, 0.0, 0.0), **exposure)
        # The camera's up is not the body's: compare by place, not by pixel.
        sample = sim.frame(0, ["radiance", "position"])
        hit = np.isfinite(sample["position"]).all(axis=2)
        lon, lat = lon_lat_deg(sim, sample["position"][hit])
        near = (np.abs(lon) < 20 if side > 0 else np.abs(lon) > 160) & (np.abs(lat) < 20)
        views.append((lon[near], lat[near], sample["radiance"][hit][near, 0]))
    for lon, lat, got in views:
        # From the north the rows are the other way round, five cells and one on.
        even = (np.floor(lon / 15) + np.floor(lat / 15)) % 2 == (0 if degrees else 1)
        off = np.abs(lon / 15 - np.round(lon / 15)), np.abs(lat / 15 - np.round(lat / 15))
        inside = np.minimum(*off) > 0.25  # whole pixels of one colour
        assert inside.sum() > 20
        expected = np.where(even, 0.8, 0.2)[inside]
        assert np.abs(got[inside] - expected).max() < 1e-3


def test_patterns_at_a_pole_and_from_afar_are_their_mean() -> None:
    exposure = {"camera.exposure": {"mode": "fixed", "white_radiance_w_m2_sr": 1}}
    nodes = glowing(
        at={"type": "coordinates", "space": "lon_lat_deg"},
        c={"type": "checker", "vector": "at", "scale": 0.2},
    )
    pole = opened(nodes, above=(0, 0, 1), **{"camera.width": 49, "camera.height": 49}, **exposure)
    at_pole = pole.frame(0, ["radiance"])["radiance"][24, 24]
    assert np.abs(at_pole - 0.5).max() < 0.03
    nodes = glowing(
        at={"type": "coordinates"}, c={"type": "checker", "vector": "at", "scale": 1e-4}
    )
    light = opened(nodes, **exposure).frame(0, ["radiance", "depth"])
    assert np.abs(light["radiance"][light["depth"] > 0] - 0.5).max() < 0.52  # limbs hold some sky
    assert np.abs(np.median(light["radiance"][light["depth"] > 0]) - 0.5) < 1e-3


def test_a_graph_that_varies_is_sampled_as_without_shortcuts() -> None:
    """At a tolerance of 0 no closed form is used. Sunlight is sampled: means agree."""
    nodes = {
        "at": {"type": "coordinates"},
        "c": {"type": "noise", "vector": "at", "scale": 1e-6, "octaves": 4},
        "skin": {"type": "lambert", "base_color": "c.value"},
    }
    light = {"camera.exposure": {"mode": "fixed", "white_radiance_w_m2_sr": 500}}
    images = [
        opened(nodes, above=(0.2, -0.1, 1.0), **light, **{"render.tolerance_dn": t}).frame(
            0, ["radiance"]
        )["radiance"]
        for t in (0.0, 1.0)
    ]
    assert images[0].max() > 10.0
    assert abs(images[1].mean() / images[0].mean() - 1.0) < 0.01


def test_the_plan_knows_what_a_graph_makes_of_a_body() -> None:
    def bound(sim: perilune.Simulation, name: str) -> float:
        return next(row["bound_dn"] for row in sim.plan(0) if row["name"] == name)

    black = {"skin": {"type": "lambert", "base_color": 0.0}}
    lamp = {"skin": {"type": "lambert", "base_color": 0.0, "emission_strength": 100}}
    varied = {"at": {"type": "coordinates"}, "skin": {"type": "lambert", "base_color": "at"}}
    exposure = {"camera.exposure": {"mode": "fixed", "white_radiance_w_m2_sr": 500}}
    assert bound(opened(black, **exposure), "surface_maps") == 0.0
    assert bound(opened(varied, **exposure), "surface_maps") > 100.0
    changes = {"bodies.earth.material": "m", **exposure}
    dark, bright = (
        perilune.open(SCENE, overrides={**changes, "materials": {"m": {"nodes": nodes}}})
        for nodes in (black, lamp)
    )
    assert bound(dark, "emitters") == 0.0
    assert bound(bright, "emitters") > 50.0


def test_a_driver_in_a_bodys_graph_is_drawn_for_each_frame() -> None:
    nodes = {"skin": {"type": "lambert", "base_color": [DRIVER, 0.3, 0.3]}}
    sim = opened(nodes)
    drawn = [sim.config_at(i)[1]["materials.m.nodes.skin.base_color[0]"] for i in range(2)]
    assert drawn[0] != drawn[1]
    for index, value in enumerate(drawn):
        still = opened({"skin": {"type": "lambert", "base_color": [value, 0.3, 0.3]}})
        assert np.array_equal(sim[index]["rgb"], still[index]["rgb"])


@pytest.mark.parametrize(
    ("body", "text"),
    [
        ({"material": "mm"}, "bodies.earth.material: no entry named 'mm'; did you mean 'm'?"),
        ({"color_map": MAP}, "bodies.earth.color_map: the material 'm' replaces it"),
        ({"albedo": [0.3, 0.3, 0.3]}, "bodies.earth.albedo: the material 'm' repl"),
        ({"reflectance": "lambert"}, "bodies.earth.reflectance: the material 'm' repl"),
        ({"material": {"choice": ["m", "mm"]}}, "bodies.earth.material: no entry named 'mm'; did"),
        ({"material": None, "material_mode": "wrap"}, "material_mode: only for a body with a mat"),
    ],
)
def test_errors_name_the_key(body: dict[str, Any], text: str) -> None:
    with pytest.raises(ConfigError) as error:
        opened(LAMBERT, body)
    assert text in str(error.value)
