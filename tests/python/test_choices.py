"""Sections of bodies that drivers choose: frames show what was drawn, in any order."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import perilune
from perilune import _core

FRAMES = 6
RING = {"inner_radius_km": 1200.0, "outer_radius_km": 2000.0}


def scene(**body: Any) -> dict[str, Any]:
    place = {"kind": "fixed", "target": "b", "position_m": [3e6, 1e6, 2e6]}
    plain = {"kind": "ellipsoid", "radii_km": 1000.0, "gm_km3_s2": 1.0, "albedo": 0.3}
    return {
        "version": 1,
        "time": {"epoch": "2026-03-20T12:00:00Z"},
        "root": "b",
        "bodies": {"b": plain | body},
        "camera": {
            "width": 16,
            "height": 12,
            "fov_deg": 60.0,
            "trajectory": place,
            "exposure": {"mode": "fixed", "white_radiance_w_m2_sr": 200.0},
        },
        "render": {"samples": 1, "max_bounces": 0},
    }


def rgb(config: dict[str, Any], base: Path, index: int) -> NDArray[np.uint8]:
    """Of a frame that no other was rendered before."""
    found: NDArray[np.uint8] = perilune.open(config, base=base).frame(index)["rgb"]
    return found


def map_of(path: Path, *colour: int) -> str:
    texels = np.zeros((2, 4, 4), np.uint8)
    texels[:] = colour
    _core.png_write(str(path), texels)
    return path.name


@pytest.mark.parametrize(
    ("key", "sections"),
    [
        ("rings", [RING | {"color_map": "red.png"}, RING | {"color_map": "blue.png"}]),
        ("rings", [RING | {"optical_depth": 0.1, "albedo": 0.9}, {"ringlets": [
            RING | {"optical_depth": 3.0, "albedo": [0.9, 0.2, 0.1]}]}]),
        ("atmosphere", [{"preset": "earth"}, {"preset": "mars"}]),
        ("shape", [{"file": "small.obj"}, {"file": "large.obj"}]),
    ],
)  # fmt: skip
def test_every_frame_shows_its_own(
    key: str, sections: list[dict[str, Any]], tmp_path: Path
) -> None:
    """Of sections, and of single keys within them."""
    map_of(tmp_path / "red.png", 255, 0, 0, 128)
    map_of(tmp_path / "blue.png", 0, 0, 255, 250)
    for name, size in (("small", 500.0), ("large", 1000.0)):
        corners = [f"v {size * x} {size * y} {size * z}" for x, y, z in TETRAHEDRON]
        faces = ["f 1 2 3", "f 1 3 4", "f 1 4 2", "f 2 4 3"]
        (tmp_path / f"{name}.obj").write_text("\n".join([*corners, *faces]))
    chosen = scene(**{key: {"choice": sections}})
    stated = [rgb(scene(**{key: section}), tmp_path, 0) for section in sections]
    assert np.abs(stated[0].astype(float) - stated[1]).max() > 10.0
    sim = perilune.open(chosen, base=tmp_path)
    shown = set()
    for index in range(FRAMES):
        drawn = getattr(sim.config_at(index)[0].bodies["b"], key)
        which = [type(drawn).model_validate(section) for section in sections].index(drawn)
        expected = rgb(scene(**{key: sections[which]}), tmp_path, index)
        np.testing.assert_array_equal(sim.frame(index)["rgb"], expected)
        shown.add(which)
    assert shown == {0, 1}


TETRAHEDRON = [(1, 1, 1), (-1, -1, 1), (-1, 1, -1), (1, -1, -1)]


def test_a_map_of_rings_is_chosen_alone(tmp_path: Path) -> None:
    names = [
        map_of(tmp_path / "red.png", 255, 0, 0, 128), map_of(tmp_path / "blue.png", 0, 0, 255, 250)
    ]  # fmt: skip
    sim = perilune.open(scene(rings=RING | {"color_map": {"choice": names}}), base=tmp_path)
    for index in range(FRAMES):
        rings = sim.config_at(index)[0].bodies["b"].rings
        assert rings is not None
        expected = rgb(scene(rings=RING | {"color_map": rings.color_map}), tmp_path, index)
        np.testing.assert_array_equal(sim.frame(index)["rgb"], expected)


def test_air_is_that_of_the_radii_drawn(tmp_path: Path) -> None:
    """It was that of the first frame rendered."""
    radii = {"choice": [[500.0] * 3, [1500.0] * 3]}
    config = scene(atmosphere={"preset": "earth"}, radii_km=radii)
    sim = perilune.open(config, base=tmp_path)
    for index in range(FRAMES):
        np.testing.assert_array_equal(sim.frame(index)["rgb"], rgb(config, tmp_path, index))


def test_a_broken_map_of_rings_is_named(tmp_path: Path) -> None:
    (tmp_path / "broken.png").write_bytes(b"no image")
    config = scene(rings=RING | {"color_map": "broken.png"})
    where = r"^configuration: bodies\.b\.rings\.color_map: .*broken\.png"
    with pytest.raises(ValueError, match=where):
        perilune.open(config, base=tmp_path).frame(0)
