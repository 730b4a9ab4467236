"""Maps that were read last, for all simulations of a process."""

from __future__ import annotations

from perilune import _core
from perilune.base.file_cache import FileCache

Read = tuple[_core.Map, tuple[str, ...]]
"""A map, and the remarks of its reader."""

MAPS: FileCache[Read] = FileCache(lambda read: read[0].nbytes)
"""That of this process."""
