"""What is wrong with the graphs of a configuration."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from perilune.config.errors import nearest
from perilune.config.materials import Material
from perilune.config.schema import Config
from perilune.drivers import KeyPath, path_text
from perilune.materials import drivers
from perilune.materials.graph import build, surface_of

_PLACES = (
    ("materials", None, "drivers", "drivers", None),
    ("materials", None, "instances", None, "drivers", None),
    ("spacecraft", None, "material_drivers", "drivers", None),
    ("material_drivers", "drivers", None),
)
"""Key paths of the values of sections of drivers; None is any name."""


def _is_in_section(path: KeyPath) -> bool:
    return any(
        len(path) >= len(place)
        and all(key is None or key == part for key, part in zip(place, path, strict=False))
        for place in _PLACES
    )


def _is_of_materials(path: KeyPath) -> bool:
    key = path[2:3] if path[0] in ("spacecraft", "bodies") else path[:1]
    return key in (("materials",), ("material_drivers",), ("material",))


def _has_alpha(material: Material) -> bool:
    try:
        return "alpha" in material.nodes[surface_of("", material)]
    except ValueError:
        return False  # told of elsewhere


def check(config: Config, driven: Iterable[KeyPath]) -> Iterator[str]:
    """What is wrong with the graphs of a configuration, whether they are used or not.

    driven: where drivers stand.
    """
    varies: set[KeyPath] = set()
    for name, material in config.materials.items():
        try:
            for node, key in build(name, material, False, None).parameters:
                varies.add(("materials", name, "nodes", node, key))
        except ValueError as error:
            yield str(error)
    yield from drivers.check(config)
    for path in driven:
        if _is_of_materials(path) and path[:5] not in varies and not _is_in_section(path):
            text = "takes no driver: in a graph numbers of inputs alone vary from frame to frame"
            yield f"{path_text(path)}: {text}"
    for body_name, body in config.bodies.items():
        if body.material is not None and body.material not in config.materials:
            near = nearest(body.material, config.materials)
            yield f"bodies.{body_name}.material: no entry named '{body.material}'{near}"
        elif body.material is not None and _has_alpha(config.materials[body.material]):
            text = f"'{body.material}' has an alpha, but there are no holes in bodies"
            yield f"bodies.{body_name}.material: {text}"
    for craft_name, craft in config.spacecraft.items():
        for k, use in enumerate(craft.materials):
            if use.use not in config.materials:
                where = f"spacecraft.{craft_name}.materials[{k}].use"
                yield f"{where}: no entry named '{use.use}'{nearest(use.use, config.materials)}"
