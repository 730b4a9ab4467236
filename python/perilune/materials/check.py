"""What is wrong with the graphs of a configuration."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from perilune.config.errors import nearest
from perilune.config.schema import Config
from perilune.drivers import KeyPath, path_text
from perilune.materials.graph import build


def check(config: Config, driven: Iterable[KeyPath]) -> Iterator[str]:
    """What is wrong with the graphs of a configuration, whether they are used or not.

    driven: where drivers stand.
    """
    varies: set[KeyPath] = set()
    for name, material in config.materials.items():
        try:
            for node, key in build(name, material, False).parameters:
                varies.add(("materials", name, "nodes", node, key))
        except ValueError as error:
            yield str(error)
    for path in driven:
        fixed = path[0] == "materials" and path[:5] not in varies
        if fixed or (path[0] == "spacecraft" and path[2:3] == ("materials",)):
            text = "takes no driver: in a graph numbers of inputs alone vary from frame to frame"
            yield f"{path_text(path)}: {text}"
    for craft_name, craft in config.spacecraft.items():
        for k, use in enumerate(craft.materials):
            if use.use not in config.materials:
                where = f"spacecraft.{craft_name}.materials[{k}].use"
                yield f"{where}: no entry named '{use.use}'{nearest(use.use, config.materials)}"
