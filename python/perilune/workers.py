"""Which worker of a DataLoader a process is. No torch here."""

from __future__ import annotations

import sys


def torch_worker() -> tuple[int, int]:
    """(id, count) of the torch DataLoader worker this runs in; (0, 1) outside of any."""
    data = sys.modules.get("torch.utils.data")
    info = data.get_worker_info() if data is not None else None
    return (0, 1) if info is None else (int(info.id), int(info.num_workers))
