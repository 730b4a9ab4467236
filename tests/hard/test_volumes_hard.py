"""Volumes where it is hard: the camera in them, edges in the eye, sizes of all sorts, moving ones,
parents that are spacecraft, worlds with air, and a body that fills one."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from tests.python.volume_worlds import AWAY_M, config, mist

import perilune

FOG = {"fog": {"nodes": {"medium": {"type": "lambert", "base_color": 1.0, "alpha": 0.5}}}}
NOISE = {
    "fog": {
        "nodes": {
            "place": {"type": "coordinates"},
            "holes": {"type": "noise", "vector": "place", "scale": 2.0, "octaves": 3.0},
            "medium": {"type": "lambert", "base_color": 1.0, "alpha": "holes"},
        }
    }
}


def picture(tree: dict[str, Any], channel: str = "radiance", **options: Any) -> Any:
    return perilune.open(tree).frame(0, channels=[channel], **options)[channel]


@pytest.mark.parametrize("material", [None, "fog"])
def test_camera_inside(material: str | None) -> None:
    """Whatever the camera is in, and wherever it is in it, each pixel is finite, and what is seen
    changes evenly as the camera goes in."""
    means = []
    for y in (-1.5, -1.001, -1.0, -0.999, -0.5, 0.0):
        tree = config({"mist": mist(material=material)}, materials=FOG)
        tree["camera"]["trajectory"]["position_m"] = [0.0, y, AWAY_M]
        tree["camera"]["trajectory"]["aim_offset_m"] = [0.0, 1.0, AWAY_M]
        found = picture(tree)
        assert np.isfinite(found).all()
        means.append(float(found[..., 0].mean()))
    assert means[1] == pytest.approx(means[2], rel=2e-2)
    assert means[2] == pytest.approx(means[3], rel=2e-2)
    assert means[3] > means[4] > means[5] > 0.0


@pytest.mark.parametrize("scale", [1e-3, 1e3, 1e7])
def test_scaled_scenes_look_the_same(scale: float) -> None:
    """A millimetre to ten thousand kilometres: lengths and extinctions in proportion, as far as the
    sun is away from it all. The volume is on a rock, in its middle, which is small."""
    pictures = []
    for k in (1.0, scale):
        ball = mist(radii_m=k, position_m=[0.0, 0.0, 0.0], material="fog")
        ball["extinction_per_m"] = [x / k for x in ball["extinction_per_m"]]
        noise = {"fog": {"nodes": {**NOISE["fog"]["nodes"]}}}
        noise["fog"]["nodes"]["holes"] = {**noise["fog"]["nodes"]["holes"], "scale": 2.0 / k}
        tree = config({"mist": ball}, materials=noise)
        tree["bodies"]["rock"]["radii_km"] = 1e-5 * k
        tree["camera"]["trajectory"] |= {
            "position_m": [0.0, -20.0 * k, 0.0],
            "aim_offset_m": [0.0, 0.0, 0.0],
        }
        tree["render"]["force_on"] = ["volumes"]
        pictures.append(picture(tree))
    assert pictures[0].max() > 5.0
    assert np.allclose(pictures[0], pictures[1], rtol=5e-3, atol=0.02)


def test_thin_and_edge_on() -> None:
    """A sheet of a tenth of a millimetre in the eye's plane, and a cone to a point: no pixel is
    other than finite, and from the side the sheet is seen."""
    sheet = mist(shape="box", size_m=[4.0, 4.0, 1e-4], extinction_per_m=1e4)
    del sheet["radii_m"]
    for up in (0.0, 1e-9, 0.01):
        tree = config({"sheet": sheet})
        tree["camera"]["trajectory"]["position_m"] = [0.0, -20.0, AWAY_M + up]
        assert np.isfinite(picture(tree)).all()
    tree["sun"]["direction"] = [1.0, 0.0, 1.0]  # or no light would come through the sheet's length
    tree["camera"]["trajectory"]["position_m"] = [0.0, -14.0, AWAY_M + 14.0]
    found = picture(tree)
    assert np.isfinite(found).all()
    assert found[9, 12].min() > 1.0
    cone = mist(shape="cone", end_radius_m=1.0, length_m=2.0)
    del cone["radii_m"]
    assert np.isfinite(picture(config({"cone": cone}))).all()


@pytest.mark.parametrize("material", [None, "fog"])
@pytest.mark.parametrize("extinction", [0.0, 1e-30, 1e30])
@pytest.mark.parametrize("emission", [0.0, 1e30])
def test_extremes(material: str | None, extinction: float, emission: float) -> None:
    """The most and the least that the schema takes: no pixel is other than finite."""
    ball = mist(
        material=material, extinction_per_m=extinction, emission_w_m3_sr=emission, radii_m=1e6
    )
    tree = config({"mist": ball}, materials=FOG)
    tree["render"]["force_on"] = ["volumes"]
    found = picture(tree)
    assert np.isfinite(found).all()
    assert np.all(found >= 0.0)
    # The camera is inside, where the densest mist is black.
    assert bool(found.any()) == (emission > 0.0 or extinction == 1e-30)


def test_body_in_its_dust() -> None:
    """A body within its own dust hides what is behind it, shades it, and is shaded: between camera
    and ground there is what a shell of it scatters."""
    dust = mist(position_m=[0.0, 0.0, 0.0], radii_m=30.0, extinction_per_m=0.02, albedo=1.0)
    tree = config({"dust": dust})
    tree["camera"]["trajectory"] |= {
        "position_m": [0.0, -60.0, 0.0],
        "aim_offset_m": [0.0, 0.0, 0.0],
    }
    tree["bodies"]["rock"] |= {"radii_km": 5e-3, "albedo": 0.0}
    found = picture(tree)
    lit, shaded = found[9, -1, 0], found[9, 0, 0]  # the sun is on the right
    assert np.isfinite(found).all()
    assert 0.0 < shaded < lit or 0.0 < lit < shaded
    ground = found[9, 12, 0]  # dust of 25 m before a black ground, not of 60 m
    assert 0.2 * lit < ground < 0.75 * lit


def test_in_shadow_and_out() -> None:
    """Behind a body of its size a volume is dark but for what it emits."""
    ball = mist(emission_w_m3_sr=[0.0, 0.7, 0.0], extinction_per_m=0.1)
    tree = config({"mist": ball})
    tree["bodies"]["wall"] = {
        "kind": "ellipsoid",
        "radii_km": 3e-3,
        "gm_km3_s2": 1e-15,
        "albedo": 0.1,
        "rotation": {"spin_rate_deg_s": 0.0},
        "orbit": {"around": "rock", "position_km": [0.02, 0.0, 1e-3 * AWAY_M]},
    }
    found = picture(tree)
    assert found[9, 12, 0] == 0.0
    assert found[9, 12, 1] == pytest.approx(0.7 * -np.expm1(-0.2) / 0.1, rel=0.02)


def test_labels_see_through() -> None:
    tree = config({"dust": mist(radii_m=30.0, position_m=[0.0, 0.0, 0.0])})
    tree["camera"]["trajectory"] |= {
        "position_m": [0.0, -20.0, 0.0],
        "aim_offset_m": [0.0, 0.0, 0.0],
    }
    bare = {**tree, "volumes": {}}
    for channel in ("depth", "instance", "normal"):
        assert np.array_equal(picture(tree, channel), picture(bare, channel), equal_nan=True)


def test_moving_camera_blurs_a_volume() -> None:
    """A volume alone in the frame is blurred by a camera that moves: its light is spread, not lost,
    and bits are the same for any threads."""
    tree = config({"mist": mist(material="fog")}, materials=NOISE)
    tree["camera"] |= {"exposure_time_s": 1.0, "fov_deg": 30.0}
    tree["camera"]["trajectory"] = {
        "kind": "linear",
        "target": "rock",
        "start": {"position_m": [0.0, -20.0, AWAY_M], "rotation_deg": [-90.0, 0.0, 0.0]},
        "end": {"position_m": [4.0, -20.0, AWAY_M], "rotation_deg": [-90.0, 0.0, 0.0]},
        "duration_s": 3.0,
    }
    tree["time"]["step_s"] = 1.0
    tree["render"] |= {"samples": 8, "tolerance_dn": 1.0}
    sim = perilune.open(tree)
    blurred = sim.frame(1, channels=["radiance"], threads=1)
    assert next(row for row in blurred.plan if row["name"] == "motion_blur")["value"] > 1
    again = sim.frame(1, channels=["radiance"], threads=2)
    assert np.array_equal(blurred["radiance"], again["radiance"])
    tree["camera"]["exposure_time_s"] = 0.0
    sharp = perilune.open(tree).frame(1, channels=["radiance"])["radiance"]
    wide = [(found[..., 0].max(axis=0) > 0.1).sum() for found in (sharp, blurred["radiance"])]
    assert wide[1] > wide[0]
    assert blurred["radiance"].sum() == pytest.approx(sharp.sum(), rel=0.1)


def test_on_a_spacecraft(repo_dir: Any) -> None:
    """A plume follows the attitude of what it is on."""
    columns = []
    for yaw in (0.0, 180.0):
        plume = mist(
            shape="cone", parent="craft", position_m=[0.0, 0.0, 0.5], end_radius_m=0.5, length_m=3.0
        )
        del plume["radii_m"]
        tree = config({"plume": plume})
        tree["spacecraft"] = {
            "craft": {
                "model": str(repo_dir / "assets/models/smallsat.glb"),
                "size_m": 1.0,
                "orbit": {"around": "rock", "position_km": [0.0, 0.0, 1e-3 * AWAY_M]},
                "attitude": {"rotation_deg": [0.0, 90.0 + yaw, 0.0]},
            }
        }
        tree["camera"]["fov_deg"] = 25.0
        bare = {**tree, "volumes": {}}
        light = np.abs(picture(tree) - picture(bare))[..., 0].sum(axis=0)
        columns.append(float((light * np.arange(24)).sum() / light.sum()))
    assert abs(columns[0] - columns[1]) > 6.0
    assert sum(columns) == pytest.approx(23.0, abs=1.5)


def test_in_air() -> None:
    """A volume on the ground of a world with air is redder for the sun's way through it, and bluer
    for the air before it: finite, and darker than without in the red."""
    lights = []
    for air in (None, {"preset": "earth"}):
        ball = mist(radii_m=2000.0, position_m=[6.4e6, 0.0, 0.0], extinction_per_m=5e-4, albedo=1.0)
        tree = config({"smoke": ball})
        tree["bodies"]["rock"] |= {"radii_km": 6371.0, "gm_km3_s2": 398600.0, "atmosphere": air}
        tree["camera"]["trajectory"] |= {
            "position_m": [6.4e6, -3e4, 1e4],
            "aim_offset_m": [6.4e6, 0.0, 0.0],
        }
        found = picture(tree)
        assert np.isfinite(found).all()
        lights.append(found[9, 12])
    assert 0.3 * lights[0][0] < lights[1][0] < lights[0][0] * 1.05
