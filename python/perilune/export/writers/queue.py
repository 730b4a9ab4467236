"""A bounded queue of writing tasks on separate threads."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from types import TracebackType

WORKERS = 2
"""Two, so that one frame is compressed while another waits for the disk."""
WAITING = 4
"""Largest number of frames in memory, so that a slow disk slows down rendering instead of filling
memory."""


class WriteQueue:
    """Runs tasks in order of submission on a few threads; the first error stops it.

    As a context it waits at its end for all tasks. After an error, or if the body raises (ctrl-C
    too), tasks that have not begun are dropped."""

    def __init__(self) -> None:
        self._pool = ThreadPoolExecutor(WORKERS, thread_name_prefix="perilune-write")
        self._pending: deque[Future[None]] = deque()

    def put(self, task: Callable[[], None]) -> int:
        """Submits a task; waits while too many are pending. Raises a finished task's error.

        Returns the number of earlier tasks found finished."""
        finished = 0
        while len(self._pending) >= WAITING or (self._pending and self._pending[0].done()):
            self._pending.popleft().result()
            finished += 1
        self._pending.append(self._pool.submit(task))
        return finished

    def drain(self) -> int:
        """Waits for all tasks; raises the first error. Returns the number of tasks waited for."""
        finished = 0
        while self._pending:
            self._pending.popleft().result()
            finished += 1
        return finished

    def __enter__(self) -> WriteQueue:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        try:
            if kind is None:
                self.drain()
        finally:
            self._pool.shutdown(wait=True, cancel_futures=True)
