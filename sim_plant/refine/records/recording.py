"""A measured record: what was read, from where, with every oddity found on the way."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim_plant.base.arrays import Array


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Record:
    """Columns of one record on an even time grid, SI.

    Attributes
    ----------
    path : the file.
    sha256 : of its bytes.
    sample_time_s : of the grid.
    columns : channel -> values (samples,), without the time.
    findings : sentences about what was odd and what was done.
    """

    path: Path
    sha256: str
    sample_time_s: float
    columns: Mapping[str, Array]
    findings: tuple[str, ...] = ()

    @property
    def samples(self) -> int:
        """Number of rows."""
        return int(next(iter(self.columns.values())).size)

    @property
    def duration_s(self) -> float:
        """Length, s."""
        return self.samples * self.sample_time_s

    @property
    def time_s(self) -> Array:
        """Time of every row from 0, s."""
        return np.arange(self.samples, dtype=np.float64) * self.sample_time_s
