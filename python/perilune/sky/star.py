"""Stars that a frame shows, as rows."""

from __future__ import annotations

import numpy as np

STAR = np.dtype([("number", np.int64), ("u", np.float64), ("v", np.float64), ("magnitude", "f4")])
"""A row of `Sample.stars`."""
