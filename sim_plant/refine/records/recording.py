"""A measured record: what was read, from where, with every oddity found on the way."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.records.run_activity import Activity
from sim_plant.refine.records.run_site import RunSite


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RunFacts:
    """What is known of a record beside its columns when it is a part of a service's run.

    Attributes
    ----------
    site : what the run's own site file says.
    activity : what line and service did in it.
    delivery_known : per actuator ``Delivered.known``: whether the PLC itself says what it applied,
        or which command it took.
    scan_s : period of the PLC's scans.
    from_s, to_s : the piece that is taken, s of the run's ``time_s``; NaN where not known.
    run_id : the same for every copy of the run's folder; empty where not known.
    roll_id : the PLC's number of the roll of web at its beginning; NaN where not known.
    """

    site: RunSite
    activity: Activity
    delivery_known: Mapping[str, bool]
    scan_s: float
    from_s: float = math.nan
    to_s: float = math.nan
    run_id: str = ""
    roll_id: float = math.nan


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Recording:
    """Columns of one record on an even time grid, SI.

    Attributes
    ----------
    path : the file, or the run folder with its times.
    sha256 : of its bytes; of a run, of the values taken.
    sample_time_s : of the grid.
    columns : channel -> values (samples,), without the time.
    findings : sentences about what was odd and what was done.
    zeros_rad : per angle channel, what was taken off it so that it begins at zero.
    run : set where the record is a part of a run.
    """

    path: Path
    sha256: str
    sample_time_s: float
    columns: Mapping[str, Array]
    findings: tuple[str, ...] = ()
    zeros_rad: Mapping[str, float] = field(default_factory=dict)
    run: RunFacts | None = None

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
