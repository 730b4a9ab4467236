"""Changes of a configuration by the index of frames: which one a frame is made with."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from perilune.document.overrides import joined

if TYPE_CHECKING:
    from perilune.simulation import Simulation

_KEPT = 4
"""Changed simulations that are kept; frames are asked for more or less in order."""

Change = tuple[int, Mapping[str, Any]]
"""First index that it holds for, and key path -> value."""


class Schedule:
    """Frames from the index of a change on have it, on top of those of smaller indices; of two at
    one index the one that was made later comes on top."""

    def __init__(self, simulation: Simulation, changes: Iterable[Change] = ()) -> None:
        self._simulation = simulation
        self.changes: list[Change] = sorted(changes, key=lambda change: change[0])
        self._made: dict[int, Simulation] = {}

    def __len__(self) -> int:
        return len(self.changes)

    def _place(self, index: int) -> int:
        """How many changes hold for a frame."""
        return bisect_right(self.changes, index, key=lambda change: change[0])

    def _together(self, count: int) -> dict[str, Any]:
        """What the first changes are, all in one."""
        total: dict[str, Any] = {}
        for _, change in self.changes[:count]:
            total = joined(total, change)
        return total

    def add(self, at: int, change: Mapping[str, Any], known: bool = False) -> None:
        """With one more; known: it was checked before. ConfigError, and nothing added, where a
        configuration with it is faulty."""
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
        """What makes a frame."""
        return self._simulation_of(self._place(index))

    def from_on(self, index: int) -> list[Change]:
        """The changes that frames from an index on need, as few as can be."""
        count = self._place(index)
        past = [(index, self._together(count))] if count else []
        return past + self.changes[count:]
