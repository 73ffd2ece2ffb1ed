"""Numbers on their way to JSON, which has neither NaN nor infinity."""

from __future__ import annotations

import math


def finite_or_none(value: float, digits: int | None = None) -> float | None:
    """Return a number that JSON can hold, None (null) where it is none.

    ``digits`` : the significant ones that are kept; None: all.
    """
    if not math.isfinite(value):
        return None
    return value if digits is None else float(f"{value:.{digits}g}")
