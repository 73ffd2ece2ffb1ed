"""Where another roll of web is on, by the PLC's counter of splices in a record."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def roll_changes(roll_id: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return per row (rows,) whether its roll is another one than in the row before.

    A row whose number cannot be read tells of no roll: the next that can is compared with the
    last that could.
    """
    known = np.flatnonzero(np.isfinite(roll_id))
    changes = np.zeros(roll_id.shape, dtype=np.bool_)
    changes[known[1:]] = np.diff(roll_id[known]) != 0.0
    return changes
