"""Identifies the worker of a DataLoader that a process is, without torch."""

from __future__ import annotations

import sys
from typing import Any


def _info() -> Any:
    data = sys.modules.get("torch.utils.data")
    return data.get_worker_info() if data is not None else None


def torch_worker() -> tuple[int, int]:
    """(id, count) of the torch DataLoader worker that this process is; (0, 1) outside of any."""
    info = _info()
    return (0, 1) if info is None else (int(info.id), int(info.num_workers))


def in_torch_worker() -> bool:
    """Whether this process is a DataLoader worker."""
    return _info() is not None
