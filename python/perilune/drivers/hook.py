"""{hook: module:function, ideal, clip_min, clip_max, params}: a distribution of the user's own.

The function receives those of its arguments that are named rng, seed, step, ideal, strength and
params, and the entries of `params` by their names. It returns a value like `ideal`. Numbers are
clipped; if `ideal` is a text or a section, there are no limits. It is called once per draw, that is
every `interval` steps; `step` is the first of them. It is not called at a strength of 0."""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from perilune.base import hooks
from perilune.drivers.clipped import check_ideal, need
from perilune.drivers.common import DriverError, Kind, Source, clip, numbers, shaped, size

_KEPT = 16
"""Number of a hook's results to cache."""


@dataclass(frozen=True)
class Hooked:
    """`low` and `high` are None unless the ideal is a number."""

    name: str
    function: str
    ideal: Any
    count: int | None
    low: tuple[float, ...] | None
    high: tuple[float, ...] | None
    params: Mapping[str, Any]
    loaded: hooks.Hook | None = None
    answers: dict[tuple[int, int, float], Any] = field(default_factory=dict, compare=False)
    """Values of the last draws, by seed, draw and strength: frames ask for them several times."""

    @property
    def limits(self) -> Mapping[str, Any]:
        """Both clips, for numbers."""
        if self.low is None or self.high is None:
            return {}
        low, high = shaped(self.low, self.count), shaped(self.high, self.count)
        return {".clip_min": low, ".clip_max": high}

    @property
    def ideal_key(self) -> str:
        """See Distribution."""
        return ".ideal"

    def load(self, find: Callable[[str, str], Path] | None) -> Hooked:
        """The driver with its function loaded; see hooks.load."""
        key = f"{self.name}.hook"
        function = hooks.load(self.function, key, find)
        return Hooked(**{**self.__dict__, "loaded": function})

    def needs(self, strength: float) -> None:
        """None: the function has its own generator."""

    def draw(self, source: Source, strength: float) -> Any:
        """The function's result, clipped; DriverError if it is not like the ideal."""
        if strength == 0.0:
            return self.ideal
        draw = (source.seed, source.epoch, strength)
        if draw not in self.answers:
            answer = self._answer(source, strength)
            while len(self.answers) >= _KEPT:
                self.answers.pop(next(iter(self.answers)), None)
            self.answers[draw] = answer
            return copy.deepcopy(answer)
        return copy.deepcopy(self.answers[draw])

    def _answer(self, source: Source, strength: float) -> Any:
        key = f"{self.name}.hook"
        function = self.loaded or hooks.load(self.function, key)
        value = hooks.call(
            function,
            key,
            seed=source.seed,
            index=source.epoch,
            offers={
                "seed": lambda: source.seed,
                "step": lambda: source.step,
                "ideal": lambda: self.ideal,
                "strength": lambda: strength,
            },
            params=self.params,
        )
        value = _plain(value)
        if isinstance(self.ideal, Mapping) and not isinstance(value, Mapping):
            raise DriverError(key, f"'{self.function}' must return a section, not {value!r}")
        if self.low is None or self.high is None:
            return value
        if (self.count is not None) != isinstance(value, (list, tuple)):
            like = "one number" if self.count is None else f"{self.count} numbers"
            raise DriverError(key, f"'{self.function}' must return {like}, not {value!r}")
        returned = numbers(f"{key} ('{self.function}' returned)", value, self.count)
        return shaped(clip(returned, self.low, self.high), self.count)


def _plain(value: Any) -> Any:
    """A value without NumPy's types, as in files."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return value.tolist() if hasattr(value, "tolist") else value


def parse(name: str, raw: Mapping[str, Any]) -> Hooked:
    """Parses its mapping; `name` is the key path."""
    need(name, raw, ("hook", "ideal"))
    function, ideal, params = raw["hook"], raw["ideal"], raw.get("params", {})
    module, _, path = function.partition(":") if isinstance(function, str) else ("", "", "")
    if not module or not all(part.isidentifier() for part in path.split(".")):
        raise DriverError(f"{name}.hook", f"must be module:function, not {function!r}")
    if not isinstance(params, Mapping):
        raise DriverError(f"{name}.params", f"must be a mapping, not {params!r}")
    if ideal is None or isinstance(ideal, (str, bool, Mapping)):
        for key in ("clip_min", "clip_max"):
            if key in raw:
                raise DriverError(f"{name}.{key}", "only for numbers, and the ideal is none")
        return Hooked(name, function, ideal, None, None, None, params)
    need(name, raw, ("hook", "ideal", "clip_min", "clip_max"))
    count = size(f"{name}.ideal", ideal)
    middle, low, high = (
        numbers(f"{name}.{key}", raw[key], count) for key in ("ideal", "clip_min", "clip_max")
    )
    check_ideal(name, middle, low, high)
    return Hooked(name, function, shaped(middle, count), count, low, high, params)


KIND = Kind(
    "hook",
    ("hook",),
    ("hook", "ideal", "clip_min", "clip_max", "params"),
    parse,
    correlates=False,
    # What has the name `hook` may be a section, or a point.
    marks=lambda value: not isinstance(value, (Mapping, list, tuple)),
)
