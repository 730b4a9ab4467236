"""The scenes of docs/figures/gallery.py: each opens, is by day, and has its spacecraft in front."""

from __future__ import annotations

import importlib
import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import perilune
from perilune.base import rotations

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def gallery() -> Any:
    """The script, whose own modules lie beside it."""
    sys.path.insert(0, str(ROOT / "docs" / "figures"))
    try:
        yield importlib.import_module("gallery")
    finally:
        sys.path.remove(str(ROOT / "docs" / "figures"))


BODIES = ("earth", "mars", "mercury", "moon", "europa", "phobos")
CRAFT = ("iss", "station", "lro", "mro", "shuttle", "tango", "voyager")


def test_the_bodies_and_spacecraft_are_those_of_the_paper(gallery: Any) -> None:
    assert (tuple(gallery.GROUNDS), tuple(gallery.CRAFT)) == (BODIES, CRAFT)


@pytest.mark.needs_data
@pytest.mark.parametrize("row", range(6))
def test_a_row_of_the_gallery(gallery: Any, row: int) -> None:
    """Two cells of each row, in all of them every spacecraft."""
    body = BODIES[row]
    for craft in (CRAFT[row], CRAFT[(row + 4) % 7]):
        sim = perilune.open(gallery.scene(body, craft), base=ROOT / "configs")
        world = sim.world(0)
        up = world.position_m(craft) - world.position_m(body)
        to_sun = world.sun_position_m - world.position_m(craft)
        zenith_deg = math.degrees(rotations.angle_rad(up, to_sun))
        assert zenith_deg == pytest.approx(gallery.GROUNDS[body].sun_zenith_deg, abs=0.1)
        camera = sim.camera_poses(0)[0]
        forward = rotations.rotate(camera[3:], np.array([0.0, 0.0, 1.0]))
        to_craft = world.position_m(craft) - camera[:3]
        assert math.degrees(rotations.angle_rad(forward, to_craft)) < 12.0  # of 21 to the edge
        assert world.hit_m(body, camera[:3], to_craft / np.linalg.norm(to_craft)) is not None


@pytest.mark.needs_data
@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("craft", ["lro", "tango"])
def test_a_cell_shows_the_body_the_spacecraft_and_the_sky(
    gallery: Any, body: str, craft: str
) -> None:
    """Exposed well: neither dim nor burnt out, the sky of worlds without air black."""
    sim = perilune.open(gallery.scene(body, craft, 48, 4), base=ROOT / "configs")
    sample = sim.frame(0, channels=["rgb", "instance", "part", "objects"])
    ids, size = sample["instance"], sample["instance"].size
    mine = ids == sample.objects["instance_id"][0]
    sky = ids == 0
    ground = ~mine & ~sky
    assert 0.08 < mine.sum() / size < 0.25
    assert 0.2 < ground.sum() / size < 0.7
    assert 0.2 < sky.sum() / size < 0.7
    assert len(np.unique(sample["part"][ground])) == 1  # one world, no other
    assert 70.0 < sample["rgb"][~sky].mean() < 170.0
    assert (sample["rgb"][~sky].min(axis=1) == 255).mean() < 0.1
    if body not in ("earth", "mars"):
        assert np.median(sample["rgb"][sky].max(axis=1)) == 0


@pytest.mark.needs_data
def test_the_worlds_show_what_they_are_for(gallery: Any) -> None:
    """Lights on the night side, a Moon whose night is grey, rings beside Saturn."""
    stills = gallery.gallery_stills
    shown = {name: gallery.rendered(stills.WORLDS[name](), 48, 4) for name in stills.WORLDS}
    night = shown["night"][16:].max(axis=-1)
    assert (night > 60).sum() > 25
    assert np.median(night) < 40
    assert 20 < np.median(shown["earthshine"][12:20, 20:28]) < 200
    assert (shown["saturn"].max(axis=-1) > 20).mean() > 0.15
    assert (shown["earth"].min(axis=-1) > 90).sum() > 50  # clouds
    for rgb in shown.values():
        assert rgb.std() > 15.0
    bent = [gallery.rendered(stills.clouds(much), 48, 4).astype(int) for much in (0.0, 2.0)]
    assert np.abs(bent[0] - bent[1]).mean() > 3.0
