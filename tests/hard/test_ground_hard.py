"""Ground where it is hard: poles, the date line, maps of one texel and of 16384, odd sizes."""

from __future__ import annotations

import math
import sys
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from perilune import _core

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "python"))
import ground_worlds
from ground_worlds import globe, lattice, numbers, saved, seen

RADIUS = 1e6


def waves(folder: Path) -> _core.Ground:
    """Relief, water and lights that are smooth functions of the direction, over poles too."""
    d = lattice(256)
    ridge = 0.5 + 0.2 * np.sin(7.0 * d[..., 0] + 2.0 * d[..., 2]) + 0.2 * np.cos(6.0 * d[..., 1])
    smooth = np.repeat(ridge[..., None], 3, axis=-1)
    return {
        "heights": _core.Map(saved(folder, "heights", ridge), srgb=False),
        "ocean": True,
        "water": _core.Map(saved(folder, "water", ridge), srgb=False),
        "lights": _core.Map(saved(folder, "lights", smooth)),
    }


GIVEN = numbers(height_m=3e3, wind_m_s=10.0, water=0.05, lights=30.0)


def turned(asked: dict[str, Any], angle_rad: float) -> dict[str, Any]:
    """The same with the globe turned about its axis."""
    pose = [0.0, 0.0, 0.0, math.cos(0.5 * angle_rad), 0.0, 0.0, math.sin(0.5 * angle_rad)]
    return {**asked, "body_poses": np.array([[pose, pose]])}


@pytest.mark.parametrize(
    "above",
    [(-1.0, 0.0, 0.0), (-1.0, 1e-9, 0.3), (0.0, 0.0, 1.0), (1e-7, 0.0, -1.0), (0.05, 0.02, 1.0)],
)
def test_no_seam_at_the_date_line_and_the_poles(
    tmp_path: Path, above: tuple[float, float, float]
) -> None:
    """With its map's middle at another longitude, and turned back by as much, a globe looks as it
    did: seams and poles of the map are elsewhere in the coordinates, not in the picture. Slopes
    are measured along other directions then, between heights that are rounded to 12 m."""
    ground = waves(tmp_path)
    up = np.array(above) / np.linalg.norm(above)
    sun = [up[0] + 0.4, up[1] + 0.6, up[2] + 0.3]
    frames = []
    for turn in (0.0, 2.0):
        asked, _ = seen(
            globe(ground, center_lon_rad=turn), GIVEN, [[RADIUS] * 3], 2.0 * RADIUS * up, -up, sun,
            up=(0.3, 1.0, 0.2), size=(32, 24), fov_deg=20.0, tolerance_dn=0.0, samples=4,
            force_off=("soft_sun",),
        )  # fmt: skip
        asked = turned(asked, -turn)
        world = globe(ground, center_lon_rad=turn)
        frames.append(ground_worlds.air_worlds.render(world, asked)["radiance"])
    assert frames[0].std() > 1.0
    np.testing.assert_allclose(frames[0], frames[1], rtol=2e-2, atol=0.5)


def test_from_a_metre_over_the_pole(tmp_path: Path) -> None:
    """Bilinear texels at the pole itself: finite, and alike on all sides."""
    ground = waves(tmp_path)
    ground["ocean"] = False  # its glint would change from pixel to pixel
    for height in (1.0, 1e3):
        _, frame = seen(
            globe(ground), GIVEN, [[RADIUS] * 3], [0.0, 0.0, RADIUS + height],
            [0.0, 0.0, -1.0], [0.5, 0.2, 0.8], up=(1.0, 0.0, 0.0), size=(16, 12), fov_deg=80.0,
            tolerance_dn=0.0, samples=2, force_off=("soft_sun",),
        )  # fmt: skip
        assert np.isfinite(frame["radiance"]).all()
        assert frame["radiance"].std() < 0.01 * frame["radiance"].mean()


@pytest.mark.parametrize("size", [(1, 1), (1, 2), (2, 1), (3, 5)])
def test_maps_of_a_texel(tmp_path: Path, size: tuple[int, int]) -> None:
    """As the colours say where there is one; finite in any case."""
    gray, colors = np.full(size, 0.5), np.full((*size, 3), (0.5, 0.5, 1.0))
    gray.flat[-1] = 0.5 if size == (1, 1) else 1.0
    ground: _core.Ground = {
        "heights": _core.Map(saved(tmp_path, "h", gray), srgb=False),
        "normals": _core.Map(saved(tmp_path, "n", colors), srgb=False),
        "ocean": True,
        "water": _core.Map(saved(tmp_path, "w", 0.0 * gray), srgb=False),
        "lights": _core.Map(saved(tmp_path, "l", colors)),
    }
    view = ([[RADIUS] * 3], [2.5e6, 0.0, 1e5], [-1.0, 0.0, 0.0], [0.5, 0.8, 0.1])
    look = {"size": (24, 18), "tolerance_dn": 0.0, "samples": 2, "force_off": ("soft_sun",)}
    _, frame = seen(globe(ground), numbers(height_m=1e4), *view, **look)
    _, plain = seen(globe(None), numbers(), *view, **look)
    assert np.isfinite(frame["radiance"]).all()
    if size == (1, 1):  # the normal leans by half a code: 0.4 % of a right angle
        np.testing.assert_allclose(frame["radiance"], plain["radiance"], rtol=0.02, atol=2.0)


def chunk(kind: bytes, data: bytes) -> bytes:
    crc = zlib.crc32(kind + data).to_bytes(4, "big")
    return len(data).to_bytes(4, "big") + kind + data + crc


def test_height_map_of_16384_texels(tmp_path: Path) -> None:
    """Terraces: each texel is read, and at most four thirds of the texels are kept."""
    width, height = 16384, 8192
    path = tmp_path / "large.png"
    packer = zlib.compressobj(1)
    rows = [bytes([0]) + bytes([code]) * width for code in (40, 200)]
    data = b"".join(packer.compress(rows[row // 1024 % 2]) for row in range(height))
    header = b"".join(v.to_bytes(4, "big") for v in (width, height)) + bytes([8, 0, 0, 0, 0])
    path.write_bytes(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", data + packer.flush())
        + chunk(b"IEND", b"")
    )  # fmt: skip
    before = resident()
    heights = _core.Map(str(path), srgb=False)
    assert heights.size == (width, height)
    assert heights.mean[0] == pytest.approx(120 / 255, abs=1e-3)
    assert resident() - before < 200e6
    # The step lies on the equator, and falls to the north (row 4096 is the first of a 40).
    _, frame = seen(
        globe({"heights": heights}), numbers(height_m=500.0), [[RADIUS] * 3],
        [RADIUS + 1e4, 0.0, 0.0], [-1.0, 0.0, 0.0], [1.0, 0.0, 1.0], size=(3, 41), fov_deg=1.0,
        tolerance_dn=0.0, samples=1, force_off=("soft_sun",),
    )  # fmt: skip
    column = frame["radiance"][:, 1, 0]
    assert column[0] == pytest.approx(column[-1], rel=0.02)
    assert abs(column[20] / column[0] - 1.0) > 0.3


def resident() -> float:
    """Bytes of this process in memory."""
    return 1024.0 * float(Path("/proc/self/status").read_text().split("VmRSS:")[1].split()[0])


@pytest.mark.parametrize("radius_m", [1.0, 1e8])
def test_scaled_globes_look_the_same(tmp_path: Path, radius_m: float) -> None:
    ground = waves(tmp_path)
    frames = []
    for radius in (RADIUS, radius_m):
        given = GIVEN * [radius / RADIUS, 1, 1, 1, 1, 1, 1, 1, 1, radius / RADIUS]
        _, frame = seen(
            globe(ground), given, [[radius] * 3], [2.5 * radius, 0.0, 0.4 * radius],
            [-1.0, 0.0, -0.16], [0.3, 1.0, 0.2], size=(32, 24), tolerance_dn=0.0, samples=4,
            force_off=("soft_sun",), fov_deg=40.0,
        )  # fmt: skip
        frames.append(frame["radiance"])
    # The sun's distance is the same: from 1e8 m it is seen elsewhere by 7e-4.
    differs = np.abs(frames[0] - frames[1]) > 0.02 * frames[0] + 0.3
    assert differs.mean() < 0.01


def test_same_bits_on_any_threads(tmp_path: Path) -> None:
    ground = waves(tmp_path)
    view = ([[RADIUS] * 3], [2.5e6, 0.0, 4e5], [-1.0, 0.0, -0.16], [0.3, 1.0, 0.2])
    frames = [
        seen(globe(ground), GIVEN, *view, size=(70, 50), threads=threads)[1]["radiance"]
        for threads in (1, 3)
    ]
    assert np.array_equal(frames[0], frames[1])
