"""Which worker of a DataLoader a process is. No torch here."""

from __future__ import annotations

import sys
from typing import Any


def _info() -> Any:
    data = sys.modules.get("torch.utils.data")
    return data.get_worker_info() if data is not None else None


def torch_worker() -> tuple[int, int]:
    """(id, count) of the torch DataLoader worker this runs in; (0, 1) outside of any."""
    info = _info()
    return (0, 1) if info is None else (int(info.id), int(info.num_workers))


def in_torch_worker() -> bool:
    """Whether this runs in one."""
    return _info() is not None
