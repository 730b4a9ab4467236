"""Progress bar of the commands that process images."""

from __future__ import annotations

from types import TracebackType
from typing import Any

from tqdm import tqdm


class Bar:
    """A progress bar whose rate counts only images of this run; silent without a terminal."""

    def __init__(self, unit: str = "img") -> None:
        self._unit = unit
        self.done = 0
        self.total = 0
        self._bar: tqdm[Any] | None = None

    def __call__(self, done: int, total: int) -> None:
        self.done, self.total = done, total
        bar = self._bar
        if bar is None:
            # Images of an earlier run are the bar's start, so that they do not count in its rate.
            self._bar = bar = tqdm(
                total=total, initial=done, unit=self._unit, disable=None, dynamic_ncols=True
            )
        bar.total = total  # may have become more
        bar.update(done - bar.n)

    def __enter__(self) -> Bar:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        if self._bar is not None:
            self._bar.close()
