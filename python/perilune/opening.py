"""Opens configurations. What that needs is imported by the first call, so that programs that only
name `perilune.open` or `perilune.Dataset` start fast."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from perilune.base import arguments

if TYPE_CHECKING:
    from perilune.base.hooks import Hook
    from perilune.simulation import Simulation
    from perilune.world import World

ConfigSource = str | os.PathLike[str] | Mapping[str, Any]


def open(  # noqa: A001 (perilune.open is the interface)
    config: ConfigSource,
    seed: int | None = None,
    overrides: Mapping[str, Any] | None = None,
    *,
    base: str | os.PathLike[str] | None = None,
    trajectory: Callable[[World], Any] | None = None,
    orbits: Mapping[str, Hook] | None = None,
    replay: Mapping[str, Any] | None = None,
    **dotted: Any,
) -> Simulation:
    """Opens a configuration: a YAML or JSON file, or a mapping of the same structure.

    seed: replaces the file's seed.

    overrides: values by key path, such as {"camera.width": 64}; None removes a key. More can be
    given as keywords, **{"render.samples": 4}. Keys that an override makes meaningless are removed:
    with {"camera.exposure.mode": "fixed"}, the percentile of mode auto.

    base: the folder that relative paths refer to (default: the file's, or the current one).

    trajectory: replaces the configured trajectory by a callable (perilune.world.World) -> camera
    pose (7,) or (2, 7) from camera axes to the root frame, in metres. With `sensors` it is the pose
    of their platform.

    orbits: name of a body or spacecraft -> a function that draws its orbit once a scene, as with
    `kind: hook`.

    replay: the metadata of a sample (Sample.meta, or {index, drivers, scene_drivers} of a dataset).
    In its frame the drivers have the recorded values, whatever they would draw now; other steps
    draw as usual. The seed is that of the metadata, if they have one and no other is given.

    Raises ConfigError for a faulty configuration and FileNotFoundError for a missing file."""
    if not isinstance(config, (str, os.PathLike, Mapping)):
        raise TypeError(f"config: must be a path or a mapping, not {config!r:.60}")
    changes = {**arguments.mapping("overrides", overrides or {}, "{'camera.width': 64}"), **dotted}
    if replay is not None:
        arguments.mapping("replay", replay, "a sample's meta")
    if seed is None and replay is not None and "seed" not in changes:
        seed = replay.get("seed")
    if seed is not None:
        changes["seed"] = seed
    from perilune.document import load
    from perilune.simulation import Simulation

    document = load(config, changes, None if base is None else Path(base), replay)
    return Simulation(document, trajectory, orbits)
