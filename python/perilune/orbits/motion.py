"""Trees of moving objects: propagators and trees of the core, cached by their numbers.

A node is {'name', 'parent': index or -1, 'motion', 'rotation'} as for `_core.Tree`, with two
extensions for what Python computes. Its motion may also be the specification of a propagator, or a
function t_s (n,) -> (n, 6) states relative to the parent (m, m/s, ICRF axes). The frame of its
rotation may be a function t_s (n,) -> (n, 4) from its axes to ICRF."""

from __future__ import annotations

import hashlib
import os
import threading
import weakref
from collections import OrderedDict
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.orbits.solar_system import Date

F64 = NDArray[np.float64]
Node = Mapping[str, Any]
Path = Callable[[F64], F64]
T = TypeVar("T")

_CLOSED = frozenset(("kepler", "circular", "j2"))
"""Kinds of propagators in closed form."""
_KINDS = frozenset(str(row["name"]) for row in _core.PROPAGATORS)


@dataclass(frozen=True)
class States:
    """States at n times, in the root frame (ICRF axes)."""

    poses: Mapping[str, F64]
    """Name -> (n, 7): x, y, z in metres, qw, qx, qy, qz to root axes."""
    velocities_m_s: Mapping[str, F64]
    """Name -> (n, 3)."""


_all_kept: weakref.WeakSet[Kept[Any]] = weakref.WeakSet()
_orphans: list[Any] = []
"""Objects cached by a parent process. A fork may have caught a lock while it was held, or a
propagator while it was integrating, so a child neither uses nor destroys them."""


def _leave_to_parent() -> None:
    _orphans.extend(kept.leave() for kept in _all_kept)


os.register_at_fork(after_in_child=_leave_to_parent)


class Kept(Generic[T]):
    """A cache of the last `size` objects, by their inputs."""

    def __init__(self, size: int) -> None:
        self._size = size
        self._values: OrderedDict[Hashable, T] = OrderedDict()
        self._lock = threading.Lock()
        _all_kept.add(self)

    def leave(self) -> OrderedDict[Hashable, T]:
        """Empties the cache and returns its former contents."""
        left, self._values, self._lock = self._values, OrderedDict(), threading.Lock()
        return left

    def get(self, key: Hashable, make: Callable[[], T]) -> T:
        """The object of a key, made if it is not cached."""
        with self._lock:
            if key in self._values:
                self._values.move_to_end(key)
                return self._values[key]
        value = make()
        with self._lock:
            value = self._values.setdefault(key, value)
            while len(self._values) > self._size:
                self._values.popitem(last=False)
        return value


class _Digests:
    """Digests of immutable arrays, so that large tables are hashed once."""

    def __init__(self) -> None:
        self._known: dict[int, tuple[weakref.ref[NDArray[Any]], bytes]] = {}

    def of(self, array: NDArray[Any]) -> bytes:
        """SHA-256 of the numbers of a read-only array that owns its memory."""
        place = id(array)
        found = self._known.get(place)
        if found is not None and found[0]() is array:
            return found[1]
        digest = hashlib.sha256(array.tobytes()).digest()
        forget = weakref.ref(array, lambda _: self._known.pop(place, None))
        self._known[place] = (forget, digest)
        return digest


_LARGE = 1024  # bytes, from which on a digest is worth its bookkeeping
_digests = _Digests()
_propagators: Kept[_core.Propagator] = Kept(512)


def _key(value: Any) -> Hashable:
    """A hashable form of a specification; equal only for equal numbers."""
    if type(value) is float:
        return value.hex()  # 0.0 is not -0.0, and nan equals itself
    if isinstance(value, Mapping):
        return tuple((name, _key(value[name])) for name in sorted(value))
    if isinstance(value, np.ndarray):
        if value.nbytes >= _LARGE and value.base is None and not value.flags.writeable:
            return (value.shape, value.dtype.str, _digests.of(value))
        return (value.shape, value.dtype.str, value.tobytes())
    if isinstance(value, (list, tuple)):
        return tuple(_key(item) for item in value)
    if isinstance(value, float):
        return value.hex()
    hash(value)  # a TypeError here is a mistake in what was specified
    return (type(value), value)


def propagator(spec: Mapping[str, Any], epoch: Date) -> _core.Propagator:
    """The propagator of a specification; the same object for equal numbers."""
    key = (_key(spec), epoch)
    return _propagators.get(key, lambda: _propagator(spec, epoch))


def _propagator(spec: Mapping[str, Any], epoch: Date) -> _core.Propagator:
    return _core.Propagator(spec, epoch.day, epoch.fraction)


@dataclass
class _Given:
    """Functions whose results are passed to the core, with their nodes."""

    paths: list[tuple[str, Path]]
    axes: list[tuple[str, Path]]


def _prepared(node: Node, epoch: Date, given: _Given) -> Node:
    """A node in the core's form; its functions are collected in `given`."""
    name, motion, rotation = str(node["name"]), node["motion"], node["rotation"]
    if isinstance(motion, Mapping) and motion["kind"] in _KINDS:
        try:
            # What needs no preparation is made sooner than it is looked up.
            known = _propagator if motion["kind"] in _CLOSED else propagator
            motion = known(motion, epoch)
        except ValueError as error:
            raise ValueError(f"{name}: {error}") from None
    elif callable(motion):
        given.paths.append((name, motion))
        motion = {"kind": "given", "slot": len(given.paths) - 1}
    if callable(rotation["frame"]):
        given.axes.append((name, rotation["frame"]))
        rotation = {**rotation, "frame": "given", "slot": len(given.axes) - 1}
    return {**node, "motion": motion, "rotation": rotation}


class _Tree:
    """A tree of the core, and the functions that it asks for."""

    def __init__(self, nodes: Sequence[Node], epoch: Date) -> None:
        self.nodes = nodes
        """Held, so that no other list can have its identity while this tree is kept."""
        self.given = _Given([], [])
        ready = [_prepared(node, epoch, self.given) for node in nodes]
        self.core = _core.Tree(ready, epoch.day, epoch.fraction)


def _answers(functions: Sequence[tuple[str, Path]], t_s: F64) -> F64 | None:
    """Results (n, slots, ...) of all functions; ValueError names the node."""
    answers = []
    for name, function in functions:
        try:
            answers.append(function(t_s))
        except ValueError as error:
            raise ValueError(f"{name}: {error}") from None
    return np.stack(answers, axis=1) if answers else None


_trees: Kept[_Tree] = Kept(32)


def evaluate(nodes: Sequence[Node], epoch: Date, t_s: F64) -> States:
    """States of all nodes at seconds t_s (n,) after the epoch. The list must not change later.

    Errors of the core (ValueError) name the node."""
    made = _trees.get((id(nodes), epoch), lambda: _Tree(nodes, epoch))
    states, axes = _answers(made.given.paths, t_s), _answers(made.given.axes, t_s)
    poses, velocities = made.core.states(t_s, given=states, given_q=axes)
    names = [str(node["name"]) for node in nodes]
    return States(
        {name: poses[:, k] for k, name in enumerate(names)},
        {name: velocities[:, k] for k, name in enumerate(names)},
    )
