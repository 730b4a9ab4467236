"""What a message must be: it names what is wrong, and shows nothing of the inside."""

from __future__ import annotations

import re
import traceback
from collections.abc import Callable, Iterable

INSIDE = re.compile(
    r"pydantic|https?://|object at 0x|<class|<function|NoneType|Traceback|recursion depth|"
    r"ERFA function|has no attribute|not subscriptable|not callable|not iterable|has no len|"
    r"unsupported operand|unexpected keyword|positional argument|\[Errno|unhashable|"
    r"not supported between|not a mapping$|cannot unpack|NotImplemented|numpy\.|Errno"
)
"""Words of an error that nobody wrote."""
EXPECTED = (ValueError, TypeError, OSError, IndexError, KeyError)


def fault(make: Callable[[], object], needed: Iterable[str]) -> str:
    """What is wrong with how a mistake is told; empty if nothing is."""
    try:
        found = make()
    except EXPECTED as error:
        return message_fault(str(error), needed)
    except Exception as error:
        where = traceback.extract_tb(error.__traceback__)[-1]
        return f"{type(error).__name__}: {error} ({where.filename}:{where.lineno})"
    return f"taken without a word: {found!r:.80}"


def message_fault(text: str, needed: Iterable[str]) -> str:
    """The same of a message."""
    lacks = [part for part in needed if part not in text]
    if lacks:
        return f"lacks {lacks}: {text}"
    inside = INSIDE.search(text)
    return f"shows '{inside[0]}': {text}" if inside else ""
