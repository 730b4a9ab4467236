"""A configuration as loaded: its tree, the folder its paths refer to, its drivers, its values."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from perilune import drivers
from perilune.config import oaisys
from perilune.config.errors import ConfigError, from_validation, origin
from perilune.config.loader import plain_tree, read_tree
from perilune.config.overrides import apply_overrides
from perilune.config.schema import Config

DATA_VARIABLE = "PERILUNE_DATA"
_DATA_PREFIX = "data:"


class Document:
    """The configuration of a simulation; pickles as its tree and validates again when loaded."""

    def __init__(
        self,
        tree: Mapping[str, Any],
        base: Path,
        source: str,
        origins: Mapping[str, str] | None = None,
    ) -> None:
        """origins: key path -> key path in the file, of a file that was translated; for errors."""
        self.tree = plain_tree(tree, source)
        self.base = base
        self.source = source
        self.origins = dict(origins or {})
        try:
            self.drivers = tuple(drivers.find(self.tree))
        except drivers.DriverError as error:
            raise ConfigError(f"{source}: {error}") from None
        self.config = self._validate({driver.path: driver.ideal for driver in self.drivers})
        self._check_clips()

    def __reduce__(self) -> tuple[Any, ...]:
        return Document, (self.tree, self.base, self.source, self.origins)

    def at(self, frame: int) -> tuple[Config, dict[str, float]]:
        """The configuration of a frame, and the values its drivers have there, by key path.

        All frames of one step have the same.
        """
        if not self.drivers:
            return self.config, {}
        seed, strength = self.config.seed, self.config.drivers.strength
        interval = self.config.drivers.interval or self.config.time.frames_per_scene
        step = self.config.timeline.at(frame).step
        values = {
            driver.path: driver.draw(seed, step, strength, interval) for driver in self.drivers
        }
        drawn = {driver.name: values[driver.path] for driver in self.drivers}
        return self._validate(values), drawn

    def path(self, text: str, key: str) -> Path:
        """The file that a path of the configuration means; `key` names it in errors."""
        key = origin(key, self.origins)
        if not text.startswith(_DATA_PREFIX):
            path = self.base / text
            if not path.is_file():
                raise FileNotFoundError(f"{self.source}: {key}: no such file: {path}")
            return path
        root = os.environ.get(DATA_VARIABLE)
        how = (
            f"set the environment variable {DATA_VARIABLE} to the folder of the sample data, "
            f"for instance: export {DATA_VARIABLE}=/path/to/data"
        )
        if not root:
            raise FileNotFoundError(f"{self.source}: {key}: '{text}' needs the sample data; {how}")
        path = Path(root) / text.removeprefix(_DATA_PREFIX).lstrip("/")
        if not path.is_file():
            raise FileNotFoundError(
                f"{self.source}: {key}: '{text}': no such file: {path} "
                f"({DATA_VARIABLE} is {root}); {how}"
            )
        return path

    def _validate(self, values: Mapping[tuple[str | int, ...], float]) -> Config:
        tree = drivers.substitute(self.tree, values)
        try:
            return Config.model_validate(tree, context={"path": self.path})
        except ValidationError as error:
            driven = {driver.name: values[driver.path] for driver in self.drivers}
            raise from_validation(error, tree, self.source, driven, self.origins) from None

    def _check_clips(self) -> None:
        """Each driver's limits must be valid values, so that no later frame fails on them."""
        ideal = {driver.path: driver.ideal for driver in self.drivers}
        for driver in self.drivers:
            for limit in {driver.clip_min, driver.clip_max} - {driver.ideal}:
                self._validate({**ideal, driver.path: limit})


def load(
    config: str | os.PathLike[str] | Mapping[str, Any],
    overrides: Mapping[str, Any] | None = None,
    base: Path | None = None,
) -> Document:
    """Loads a YAML or JSON file, or takes a mapping (paths relative to `base`, default: here).

    One with the sections of an OAISYS file is translated first; overrides are of our keys.
    """
    if isinstance(config, Mapping):
        source = "configuration"
        tree = plain_tree(config, source)
        base = base or Path.cwd()
    else:
        path = Path(config)
        source = str(config)
        tree = read_tree(path)
        base = base or path.resolve().parent
        tree.setdefault("name", path.stem)
    origins: Mapping[str, str] = {}
    if oaisys.is_oaisys(tree):
        translation = oaisys.translate(tree, base, source)
        tree, origins = translation.tree, translation.origins
    apply_overrides(tree, plain_tree(overrides or {}, "overrides"))
    return Document(tree, base, source, origins)
