"""perilune.Driver: a driver as an object, for use in a configuration's mapping."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from perilune.drivers.tree import find

Number = float | Sequence[float]


class Driver(Mapping[str, Any]):
    """A random variable in place of a value of the configuration.

    Driver(40.0, 4.0, 30.0, 50.0) is {ideal, jitter_variance, clip_min, clip_max}: normal about the
    ideal, clipped. Lists instead of numbers are colours or vectors. The class methods make the
    other distributions.

    Keywords of all: `interval` (steps between draws), `strength` (factor on the variance), `group`
    (a name of `drivers.groups`). Of numeric ones: `jointly` (one draw for all numbers of a list).
    Of those with clips: `truncated` (draws within the limits, instead of moving what lies beyond
    onto them). Raises perilune.drivers.DriverError for a faulty driver."""

    def __init__(
        self,
        ideal: Number,
        jitter_variance: Number,
        clip_min: Number,
        clip_max: Number,
        **settings: Any,
    ) -> None:
        self._set(
            {
                "ideal": ideal,
                "jitter_variance": jitter_variance,
                "clip_min": clip_min,
                "clip_max": clip_max,
                **settings,
            }
        )

    def _set(self, raw: Mapping[str, Any]) -> None:
        self._raw = {key: value for key, value in raw.items() if value is not None}
        list(find(_plain(self._raw), ("driver",)))

    @classmethod
    def _of(cls, raw: Mapping[str, Any]) -> Driver:
        driver = cls.__new__(cls)
        driver._set(raw)
        return driver

    @classmethod
    def uniform(cls, low: Number, high: Number, **settings: Any) -> Driver:
        """Uniform between two limits; the middle is the ideal."""
        return cls._of({"uniform": [low, high], **settings})

    @classmethod
    def log_normal(
        cls,
        median: Number,
        log_variance: Number,
        clip_min: Number,
        clip_max: Number,
        **settings: Any,
    ) -> Driver:
        """median * exp(N(0, log_variance)), clipped."""
        limits = {"clip_min": clip_min, "clip_max": clip_max}
        return cls._of({"median": median, "log_variance": log_variance, **limits, **settings})

    @classmethod
    def choice(
        cls, values: Sequence[Any], weights: Sequence[float] | None = None, **settings: Any
    ) -> Driver:
        """One of several values; the first is the ideal one."""
        return cls._of({"choice": values, "weights": weights, **settings})

    @classmethod
    def hook(
        cls,
        function: str | Callable[..., Any],
        ideal: Any,
        clip_min: Number | None = None,
        clip_max: Number | None = None,
        params: Mapping[str, Any] | None = None,
        **settings: Any,
    ) -> Driver:
        """A value that a function draws: `module:function`, or a function that a module has by its
        name."""
        if callable(function):
            function = f"{function.__module__}:{function.__qualname__}"
        limits = {"clip_min": clip_min, "clip_max": clip_max, "params": params}
        return cls._of({"hook": function, "ideal": ideal, **limits, **settings})

    def __getitem__(self, key: str) -> Any:
        return self._raw[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._raw)

    def __len__(self) -> int:
        return len(self._raw)

    def __repr__(self) -> str:
        return f"Driver({self._raw})"


def _plain(value: Any) -> Any:
    """NumPy numbers and arrays as Python's, as in a configuration."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return value
