"""{choice: [a, b, ...], weights: [...]}: one of several values.

Values are of any type that the key takes: numbers, colours, names, files, whole sections (without
drivers of their own). The first is the ideal. With a strength below 1 the ideal is taken with
probability 1 - strength, otherwise one by the weights (default: equal)."""

from __future__ import annotations

import copy
import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from perilune.drivers.common import DriverError, Kind, Need, Source, number


@dataclass(frozen=True)
class Choice:
    """`ends` are the cumulative probabilities of the values; the last is 1."""

    values: tuple[Any, ...]
    ends: tuple[float, ...]

    @property
    def ideal(self) -> Any:
        """The first value."""
        return copy.deepcopy(self.values[0])

    @property
    def limits(self) -> Mapping[str, Any]:
        """All possible values."""
        begins = (0.0, *self.ends)
        rows = enumerate(zip(self.values, begins, self.ends, strict=False))
        return {f".choice[{k}]": value for k, (value, begin, end) in rows if end > begin}

    @property
    def ideal_key(self) -> str:
        """See Distribution."""
        return ".choice[0]"

    def needs(self, strength: float) -> Need | None:
        """See Distribution."""
        return Need(False, 1) if min(strength, 1.0) != 0.0 and len(self.values) > 1 else None

    def draw(self, source: Source, strength: float) -> Any:
        """One of the values, copied."""
        share = min(strength, 1.0)
        if share == 0.0 or len(self.values) == 1:
            return self.ideal
        # [0, 1 - share) stands for the ideal, the rest is divided by the weights. The same order
        # as that of the values, so that correlated choices go along with correlated numbers.
        place = (source.uniforms(1)[0] - (1.0 - share)) / share
        if place < 0.0:
            return self.ideal
        # `place` is 1 at most, so the value found has a weight above 0.
        found = next((k for k, end in enumerate(self.ends) if place < end), None)
        if found is None:
            found = self.ends.index(1.0)
        return copy.deepcopy(self.values[found])


def _weights(name: str, raw: Any, count: int) -> tuple[float, ...]:
    if raw is None:
        return (1.0,) * count
    if not isinstance(raw, (list, tuple)) or len(raw) != count:
        raise DriverError(name, f"must be {count} numbers, one a value, not {raw!r}")
    weights = tuple(number(f"{name}[{k}]", value) for k, value in enumerate(raw))
    for k, weight in enumerate(weights):
        if weight < 0.0:
            raise DriverError(f"{name}[{k}]", f"must not be negative: {weight:g}")
    if not 0.0 < sum(weights) < float("inf"):
        raise DriverError(name, "must have a finite sum above 0")
    return weights


def parse(name: str, raw: Mapping[str, Any]) -> Choice:
    """Parses its mapping; `name` is the key path."""
    if "choice" not in raw:
        raise DriverError(name, "weights belong to a choice; the key choice is missing")
    values = raw["choice"]
    if not isinstance(values, (list, tuple)) or not values:
        raise DriverError(f"{name}.choice", f"must be a list of one value or more, not {values!r}")
    weights = _weights(f"{name}.weights", raw.get("weights"), len(values))
    total = sum(weights)
    ends = [end / total for end in itertools.accumulate(weights)]
    last = max(k for k, weight in enumerate(weights) if weight > 0.0)
    ends[last:] = [1.0] * (len(ends) - last)
    return Choice(tuple(values), tuple(ends))


KIND = Kind(
    "choice",
    ("choice",),
    ("choice", "weights"),
    parse,
    marks=lambda value: not isinstance(value, Mapping),
)
