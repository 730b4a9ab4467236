"""Changes of a configuration by frame index."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from perilune.simulation import Simulation

_KEPT = 4
"""Number of changed simulations to cache; frames are mostly requested in order."""

Change = tuple[int, Mapping[str, Any]]
"""First index that it applies to, and key path -> value."""


class Schedule:
    """Changes of a simulation by frame index.

    A change applies to frames from its index on, on top of changes at smaller indices. At equal
    indices the later change takes precedence."""

    def __init__(self, simulation: Simulation, changes: Iterable[Change] = ()) -> None:
        self._simulation = simulation
        self.changes: list[Change] = sorted(changes, key=lambda change: change[0])
        self._made: dict[int, Simulation] = {}

    def __len__(self) -> int:
        return len(self.changes)

    def _place(self, index: int) -> int:
        """Number of changes that apply to a frame."""
        return bisect_right(self.changes, index, key=lambda change: change[0])

    def _together(self, count: int) -> dict[str, Any]:
        """The first changes, merged."""
        from perilune.document.overrides import joined  # here: the names of perilune load fast

        total: dict[str, Any] = {}
        for _, change in self.changes[:count]:
            total = joined(total, change)
        return total

    def add(self, at: int, change: Mapping[str, Any], known: bool = False) -> None:
        """The schedule with one more change. known: it was checked before. Raises ConfigError if a
        configuration with it is faulty, and then adds nothing."""
        place = self._place(at)
        longer = Schedule(self._simulation, self.changes)
        longer.changes.insert(place, (at, change))
        if not known:
            for count in range(place + 1, len(longer) + 1):
                longer._simulation_of(count, known=False)
        self.changes = longer.changes
        self._made = {count: made for count, made in self._made.items() if count <= place}

    def _simulation_of(self, count: int, known: bool = True) -> Simulation:
        if count == 0:
            return self._simulation
        if count not in self._made:
            made = self._simulation._with(self._together(count), known)
            if len(self._made) >= _KEPT:
                del self._made[next(iter(self._made))]
            self._made[count] = made
        return self._made[count]

    def simulation(self, index: int) -> Simulation:
        """The simulation that makes a frame."""
        return self._simulation_of(self._place(index))

    def from_on(self, index: int) -> list[Change]:
        """The changes that apply from an index on, as few as possible."""
        count = self._place(index)
        past = [(index, self._together(count))] if count else []
        return past + self.changes[count:]
