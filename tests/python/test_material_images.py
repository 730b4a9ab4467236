"""Image nodes from the configuration to the picture: what they read, and errors."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from numpy.typing import NDArray
from PIL import Image as PillowImage

import perilune
from perilune import _core
from perilune.config.errors import ConfigError
from perilune.config.materials import Material
from perilune.materials import ImageFiles, build, images_in

SCENE = Path(__file__).parent / "scene.yaml"
CODES = np.array([[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [188, 188, 188]]], dtype=np.uint8)


def saved(folder: Path, codes: NDArray[np.uint8] = CODES, name: str = "paint.png") -> str:
    path = folder / name
    PillowImage.fromarray(codes).save(path)
    return str(path)


def graph_of(image: dict[str, Any]) -> dict[str, Any]:
    """The image over the object's x and y."""
    return {
        "nodes": {
            "where": {"type": "coordinates"},
            "paint": {"type": "image", "vector": "where", **image},
            "skin": {"type": "lambert", "base_color": "paint"},
        }
    }


def colors(image: dict[str, Any], points: list[tuple[float, float]]) -> NDArray[np.float64]:
    material = Material(**graph_of(image))
    graph = build("m", material, False, ImageFiles(lambda text, key: Path(text)))
    places = np.array([(x, y, 0.0) for x, y in points])
    return graph.core.evaluate(places, 0.0, np.empty((0, 4), dtype=np.float32))[:, :3]


def opened(material: dict[str, Any]) -> perilune.Simulation:
    uses = [{"material": "*", "use": "m"}]
    return perilune.open(
        SCENE, overrides={"materials": {"m": material}, "spacecraft.sat.materials": uses}
    )


def test_y_goes_downwards_and_color_spaces_differ(tmp_path: Path) -> None:
    file = saved(tmp_path)
    centres = [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)]
    srgb = colors({"file": file}, centres)
    linear = colors({"file": file, "color_space": "linear"}, centres)
    np.testing.assert_allclose(srgb[:3], np.eye(3), atol=1e-6)
    np.testing.assert_allclose(srgb[3], 0.502886, atol=1e-5)  # IEC 61966-2-1 of 188/255
    np.testing.assert_allclose(linear[3], 188 / 255, atol=1e-6)


def test_wrap_modes_may_differ_by_axis(tmp_path: Path) -> None:
    file = saved(tmp_path)
    points = [(1.25, 0.25), (0.25, 1.25), (-0.25, 0.25)]
    red, green, blue = np.eye(3)
    for keys, expected in (
        ({}, (red, red, green)),
        ({"wrap": "mirror"}, (green, blue, red)),
        ({"wrap": "clamp"}, (green, blue, red)),
        ({"wrap_v": "clamp"}, (red, blue, green)),
        ({"wrap": "clamp", "wrap_v": "repeat"}, (green, red, red)),
    ):
        np.testing.assert_allclose(colors({"file": file, **keys}, points), expected, atol=1e-6)


@pytest.mark.parametrize("size", [(1, 1), (3, 5), (7, 1), (129, 65)])
def test_images_of_one_color_are_that_everywhere(tmp_path: Path, size: tuple[int, int]) -> None:
    file = saved(tmp_path, np.full((*size, 3), (255, 0, 255), dtype=np.uint8))
    points = [tuple(row) for row in np.random.default_rng(3).normal(0, 30, (64, 2))]
    np.testing.assert_allclose(colors({"file": file}, points), [[1, 0, 1]] * 64, atol=1e-6)


def test_an_image_is_seen_and_read_once(tmp_path: Path) -> None:
    red = saved(tmp_path, np.full((4, 4, 3), (255, 0, 0), dtype=np.uint8))
    sim = opened(graph_of({"file": red}))
    sample = sim[0]
    craft = sample["instance"] == sample["instance"].max()
    assert (sample["rgb"][craft][:, 0] > 40).any()
    assert (sample["rgb"][craft][:, 1:] < 12).all(axis=1).mean() > 0.9  # not where the Earth shines
    image = next(images_in("m", Material(**graph_of({"file": red}))))
    files = ImageFiles(lambda text, key: Path(text))
    assert files(image) is files(image)


def test_paths_are_relative_to_the_file_that_they_stand_in(tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    folder.mkdir()
    saved(folder)
    (folder / "paint.yaml").write_text(yaml.safe_dump(graph_of({"file": "paint.png"})))
    outside = opened({"file": str(folder / "paint.yaml")})
    inside = opened(graph_of({"file": str(folder / "paint.png")}))
    assert np.array_equal(outside[0]["rgb"], inside[0]["rgb"])


@pytest.mark.parametrize(
    ("image", "text"),
    [
        ({}, "materials.m.nodes.paint.file: required, but missing"),
        ({"file": 3}, "materials.m.nodes.paint.file: must be the path of an image, not 3"),
        ({"file": {"choice": ["a.png", "b.png"]}}, "nodes.paint.file: takes no driver"),
        ({"file": "a.png", "wrap": "tile"}, "nodes.paint.wrap: no 'tile'; allowed: repeat, clamp"),
        ({"file": "a.png", "color_space": "rgb"}, "color_space: no 'rgb'; did you mean 'srgb'?"),
    ],
)
def test_errors_name_the_key(image: dict[str, Any], text: str) -> None:
    with pytest.raises(ConfigError) as error:
        opened(graph_of(image))
    assert text in str(error.value)


def test_files_that_are_no_images_are_named_by_their_key(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"materials\.m\.nodes\.paint\.file: no such file"):
        opened(graph_of({"file": "nowhere.png"}))[0]
    broken = tmp_path / "broken.png"
    broken.write_bytes(Path(saved(tmp_path)).read_bytes()[:40])
    with pytest.raises(ConfigError, match=r"materials\.m\.nodes\.paint\.file: .*broken\.png"):
        opened(graph_of({"file": str(broken)}))[0]


def test_wrap_modes_of_maps_are_checked(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="'repeat', 'clamp' or 'mirror'"):
        _core.Map(saved(tmp_path), True, "tile")
