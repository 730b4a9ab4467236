"""Files of image nodes, each read once."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

from perilune import _core
from perilune.bodies import maps
from perilune.config.materials import Material

_KIND = "image"


@dataclass(frozen=True)
class Image:
    """A use of an image file."""

    key: str
    """Key path in the configuration."""
    file: str
    srgb: bool
    wrap_u: str
    wrap_v: str


Images: TypeAlias = Callable[[Image], _core.Map]
"""Returns the texture of a use; ValueError or FileNotFoundError that names its key."""


def image_of(where: str, raw: Mapping[str, Any]) -> Image:
    """The use by a node of kind `image`, whose keys were checked."""
    rows = {row["name"]: row for row in _core.NODES[_KIND]["constants"]}

    def choice(name: str) -> str:
        return str(raw.get(name, rows[name]["choices"][int(rows[name]["default"])]))

    wrap, wrap_v = choice("wrap"), choice("wrap_v")
    srgb = choice("color_space") == "srgb"
    return Image(f"{where}.file", raw["file"], srgb, wrap, wrap if wrap_v == "same" else wrap_v)


def images_in(name: str, material: Material) -> Iterator[Image]:
    """All uses of an entry of `materials`."""
    for node, raw in material.nodes.items():
        if raw.get("type") == _KIND:
            yield image_of(f"materials.{name}.nodes.{node}", raw)


class ImageFiles:
    """Reads each file once for each set of options."""

    def __init__(self, path: Callable[[str, str], Path]) -> None:
        """path: (path in the configuration, its key) -> file."""
        self._path = path
        self._maps: dict[tuple[str, bool, str, str], _core.Map] = {}

    def __call__(self, image: Image) -> _core.Map:
        """The texture; ValueError or FileNotFoundError naming the key."""
        how = (image.srgb, image.wrap_u, image.wrap_v)
        at = (str(self._path(image.file, image.key)), *how)
        if at not in self._maps:
            try:
                self._maps[at] = _core.Map(maps.told_picture(Path(at[0]), image.key), *how)
            except (OSError, ValueError) as error:
                raise ValueError(f"{image.key}: {error}") from None
        return self._maps[at]
