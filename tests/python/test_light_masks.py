"""The channels `cloud_opacity` and `glare`: what hides a surface, and what outshines it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.python.optics_scenes import at, ball, opened, tree

import perilune
from perilune.config import ConfigError

CLOUDS = Path(__file__).resolve().parents[2] / "configs" / "clouds.yaml"
DEPTH, ALTITUDE_M, THICKNESS_M = 1.5, 2.0, 0.2


def overcast(**keys: Any) -> dict[str, Any]:
    """A ball of 10 m whose shell is even, 30 m before the camera."""
    noise = {"coverage": 1.0, "octaves": 1.0, "depth_spread": 0.0}
    shell = {"altitude_km": 1e-3 * ALTITUDE_M, "thickness_km": 1e-3 * THICKNESS_M,
             "optical_depth": DEPTH, "noise": noise}  # fmt: skip
    return tree((48, 48), 60.0, planet=ball(at(30.0), 10.0, clouds=shell | keys))


def shell_opacity(sample: perilune.Sample, focal_px: float) -> np.ndarray[Any, Any]:
    """(H, W): one minus Beer's law along the path in a curved layer, from the geometry of spheres:
    rays that miss the ground cross the shell twice."""
    rows, columns = np.mgrid[:48, :48] - 23.5
    sine = np.hypot(rows, columns) / np.hypot(np.hypot(rows, columns), focal_px)
    reach = 10.0 + ALTITUDE_M
    off_centre = 30.0 * sine / reach  # sine of the angle to the shell's normal
    bent = 2.0 * THICKNESS_M / reach
    slant = np.minimum(1.0, np.sqrt(np.maximum(1.0 - off_centre**2, 0.0) + bent))
    crossings = np.where(off_centre >= 1.0, 0, np.where(sample["depth"] > 0.0, 1, 2))
    return 1.0 - np.exp(-DEPTH / slant * crossings)


def test_an_even_layer_follows_beers_law(repo_dir: Path) -> None:
    sample = opened(overcast(), repo_dir).frame(0, ["cloud_opacity", "depth"])
    expected = shell_opacity(sample, 60.0)
    assert (sample["depth"] > 0.0).sum() > 500
    assert ((sample["depth"] == 0.0) & (expected > 0.0)).sum() > 100, "the limb of the shell"
    np.testing.assert_allclose(sample["cloud_opacity"], expected, atol=1e-5)


def test_a_spacecraft_before_the_clouds_is_free_of_them(repo_dir: Path) -> None:
    scene = overcast()
    craft = {"model": "assets/models/smallsat.glb", "size_m": 4.0,
             "orbit": {"around": "anchor", "position_km": at(10.0)}}  # fmt: skip
    scene["spacecraft"]["sat"] = craft
    sim = opened(scene, repo_dir)
    sample = sim.frame(0, ["cloud_opacity", "instance"])
    on_craft = sample["instance"] == sim.taxonomy.instances["sat"]
    assert on_craft.sum() > 20
    assert not sample["cloud_opacity"][on_craft].any()
    assert sample["cloud_opacity"][~on_craft].max() > 0.7


def test_clouds_of_a_map_where_the_picture_shows_them() -> None:
    """Whatever the plan leaves out, colour or not, the same bits; and white where it is high."""
    sim = perilune.open(CLOUDS, overrides={"camera.width": 96, "camera.height": 72})
    sample = sim.frame(0, ["rgb", "cloud_opacity", "instance"], threads=1)
    planet = sample["instance"] == next(iter(sim.taxonomy.instances.values()))
    opacity, red = sample["cloud_opacity"][planet], sample["rgb"][planet][:, 0].astype(float)
    assert np.corrcoef(opacity, red)[0, 1] > 0.6  # of the blue ocean under white clouds
    assert red[opacity > 0.6].mean() > red[opacity < 0.05].mean() + 30.0
    bare = sim.with_overrides({"render.force_off": ["clouds"]})
    assert np.array_equal(bare.frame(0, ["cloud_opacity"])["cloud_opacity"],
                          sample["cloud_opacity"])  # fmt: skip


def glaring(tmp_path: Path, kernel: np.ndarray[Any, Any], **sensor: Any) -> dict[str, Any]:
    """A bright ball and a dim one behind a lens with this point-spread function."""
    np.save(tmp_path / "psf.npy", kernel)
    scene = tree((40, 30), 60.0, bright=ball(at(20.0, 1.0), 1.0, emission_w_m2_sr=40.0),
                 dim=ball(at(20.0, -2.5), 1.0, emission_w_m2_sr=0.4))  # fmt: skip
    spread = {"kernel": str(tmp_path / "psf.npy")}
    scene["camera"]["sensor"] = {"point_spread": spread} | sensor
    scene["render"]["force_off"] = ["vignetting"]
    return scene


def test_glare_is_what_the_kernel_adds(repo_dir: Path, tmp_path: Path) -> None:
    """Beside a convolution in NumPy of the radiance of the same frame."""
    kernel = np.zeros((5, 5))
    kernel[2, 2], kernel[0, 2], kernel[2, 4] = 0.7, 0.2, 0.1
    sim = opened(glaring(tmp_path, kernel), repo_dir)
    sample = sim.frame(0, ["radiance", "glare", "raw"])
    light = sample["radiance"].mean(axis=2).astype(float)
    padded = np.pad(light, 2)
    spread = sum(
        kernel[2 + v, 2 + u] * padded[2 - v : 32 - v, 2 - u : 42 - u]
        for v in range(-2, 3) for u in range(-2, 3)
    )  # fmt: skip
    excess = np.maximum(spread - light, 0.0)
    seen = excess > 1e-6 * light.max()
    assert seen.sum() > 20
    full = excess[seen] / sample["glare"][seen]
    np.testing.assert_allclose(full, np.median(full), rtol=1e-4)
    assert not sample["glare"][~seen].max() > 1e-5
    assert float(np.median(full)) > 0.0


def test_a_lens_that_spreads_nothing_has_no_glare(repo_dir: Path, tmp_path: Path) -> None:
    alone = np.zeros((3, 3))
    alone[1, 1] = 1.0
    sample = opened(glaring(tmp_path, alone), repo_dir).frame(0, ["glare", "radiance"])
    assert sample["radiance"].max() > 10.0
    assert sample["glare"].max() == pytest.approx(0.0, abs=1e-6)


def test_ghosts_are_glare(repo_dir: Path, tmp_path: Path) -> None:
    """A ghost of the bright ball is seen on its other side of the axis, and nowhere else."""
    alone = np.zeros((3, 3))
    alone[1, 1] = 1.0
    ghost = {"scale": -1.0, "radius_deg": 2.0, "intensity": 0.01}
    scene = glaring(tmp_path, alone, lens_flare={"ghosts": [ghost]})
    scene["bodies"]["bright"]["emission_w_m2_sr"] = 4e4
    sample = opened(scene, repo_dir).frame(0, ["glare", "radiance"])
    assert sample["glare"].max() > 0.0
    row, column = np.unravel_index(sample["glare"].argmax(), sample["glare"].shape)
    lit = np.argwhere(sample["radiance"][..., 0] > 1e3).mean(axis=0)
    np.testing.assert_allclose([row, column], [29.0 - lit[0], 39.0 - lit[1]], atol=3.0)


def test_glare_without_a_sensor_is_refused(repo_dir: Path) -> None:
    sim = opened(tree((8, 8), 30.0), repo_dir)
    with pytest.raises(ConfigError, match=r"'glare' needs the section camera\.sensor"):
        sim.frame(0, ["glare"])
