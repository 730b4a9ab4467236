"""The nearest of the allowed names, for errors."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

_SHOWN_NAMES = 40


def nearest(name: object, allowed: Iterable[str]) -> str:
    """`; did you mean 'x'? allowed: a, b` for a name that is not one of `allowed`."""
    names = list(allowed)
    close = difflib.get_close_matches(str(name), names, n=1, cutoff=0.5)
    hint = f"; did you mean '{close[0]}'?" if close else ";"
    shown = ", ".join(names[:_SHOWN_NAMES]) + (", ..." if len(names) > _SHOWN_NAMES else "")
    return f"{hint} allowed: {shown or '(none)'}"
