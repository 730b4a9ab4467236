"""Whether a date and a time of day exist in UTC."""

from __future__ import annotations

import warnings
from functools import lru_cache

import erfa


@lru_cache(maxsize=64)
def complaint(fields: tuple[int, int, int, int, int, float]) -> str:
    """Fault of year, month, day, hour, minute, second; empty if that time exists.

    Second 60 exists only at leap seconds."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        try:
            erfa.dtf2d("UTC", *fields)
        except erfa.ErfaError as error:
            part = str(error).rsplit('"bad ', 1)[-1].rstrip('"')
            return f"no such {part}" if part in _PARTS else "no such date"
    # ERFA rolls seconds beyond a minute's last over into the next one, and says so.
    if any("after end of day" in str(row.message) for row in told):
        return "no such second: that minute has none of that number"
    return ""


_PARTS = ("year", "month", "day", "hour", "minute", "second")
