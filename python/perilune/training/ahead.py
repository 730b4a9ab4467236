"""Frames that are made ahead of the loop that takes them, on a thread of their own."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from types import TracebackType
from typing import Generic, NamedTuple, TypeVar

T = TypeVar("T")


class _Begun(NamedTuple, Generic[T]):
    position: int
    made: Future[T]


class Ahead(Generic[T]):
    """Results of tasks, taken in order, while up to `count` later ones are made.

    Tasks run one after the other. With a count of 0 each runs in the thread that takes it, when it
    does. On leaving, tasks that have not begun are dropped, and the one that runs is waited for."""

    def __init__(self, count: int) -> None:
        self._count = count
        self._queue: deque[_Begun[T]] = deque()
        self._pool = ThreadPoolExecutor(1, "perilune-ahead") if count > 0 else None

    def __enter__(self) -> Ahead[T]:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._queue.clear()
        if self._pool is not None:
            self._pool.shutdown(wait=True, cancel_futures=True)

    def take(self, position_of: Callable[[int], int], begin: Callable[[int], Callable[[], T]]) -> T:
        """The next result; an error of its task is raised here.

        position_of: number of results that are taken between now and one -> its position. begin:
        position -> task. What was begun for other positions than those of now is made in vain."""
        if self._pool is None:
            return begin(position_of(0))()
        if self._queue and self._queue[0].position != position_of(0):
            self._drop()
        while len(self._queue) <= self._count:
            position = position_of(len(self._queue))
            self._queue.append(_Begun(position, self._pool.submit(begin(position))))
        return self._queue.popleft().made.result()

    def _drop(self) -> None:
        for row in self._queue:
            row.made.cancel()
        self._queue.clear()
