"""Running statistics of a recording: per state and column, and the timing of the ticks."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aff_runtime.base.numbers import finite_or_none

_BINS_US = np.geomspace(1.0, 1e6, 361)  # upper edges, each 3.9 % above the one before


@dataclass(frozen=True, slots=True, kw_only=True)
class RunStatistics:
    """What the rows of a run say.

    Attributes
    ----------
    rows_by_state : number of rows by name of the guard's state.
    timing_us : p50, p99, p99.9 and max by timing column, us.
    columns_by_state : mean, sd, min, max and last by state and column.
    """

    rows: int
    rows_by_state: Mapping[str, int]
    timing_us: Mapping[str, Mapping[str, float | None]]
    columns_by_state: Mapping[str, Mapping[str, Mapping[str, float | None]]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Summary:
    """The contents of ``summary.json``: statistics, and what was kept and lost.

    Attributes
    ----------
    from_s : of rows after that time; 0 unless the recorder took over from one that died.
    """

    statistics: RunStatistics
    rows_written: int
    rows_lost_to_disk: int
    files_lost_to_disk: int
    segments_deleted: int
    ring_overruns: int
    from_s: float = 0.0

    def encode(self) -> str:
        """Return the text of ``summary.json``."""
        said = asdict(self)
        return json.dumps({**said.pop("statistics"), **said}, indent=1) + "\n"

    @classmethod
    def decode(cls, text: str) -> Summary:
        """Read ``encode``'s text back.

        Raises
        ------
        KeyError, TypeError, ValueError
            When it is no summary.
        """
        said: Any = json.loads(text)
        return cls(
            statistics=RunStatistics(
                rows=said["rows"],
                rows_by_state=said["rows_by_state"],
                timing_us=said["timing_us"],
                columns_by_state=said["columns_by_state"],
            ),
            rows_written=said["rows_written"],
            rows_lost_to_disk=said["rows_lost_to_disk"],
            files_lost_to_disk=said["files_lost_to_disk"],
            segments_deleted=said["segments_deleted"],
            ring_overruns=said["ring_overruns"],
            from_s=said.get("from_s", 0.0),
        )


class ColumnStatistics:
    """Count, mean, standard deviation, minimum, maximum and last value of each column.

    NaN values do not count, but the last value may be one. Sums are taken about each column's
    first value, so that angles and nanoseconds keep their digits.
    """

    def __init__(self, n_columns: int) -> None:
        self._origin = np.full(n_columns, np.nan)
        self._count = np.zeros(n_columns)
        self._sum = np.zeros(n_columns)
        self._sum2 = np.zeros(n_columns)
        self._min = np.full(n_columns, np.inf)
        self._max = np.full(n_columns, -np.inf)
        self._last = np.full(n_columns, np.nan)

    def add(self, rows: NDArray[np.float64]) -> None:
        """Add ``rows``, shape (n, n_columns)."""
        valid = np.isfinite(rows)
        first = np.where(valid.any(axis=0), rows[valid.argmax(axis=0), range(rows.shape[1])], 0.0)
        self._origin = np.where(np.isnan(self._origin) & valid.any(axis=0), first, self._origin)
        shifted = np.where(valid, rows - np.nan_to_num(self._origin), 0.0)
        self._count += valid.sum(axis=0)
        self._sum += shifted.sum(axis=0)
        self._sum2 += (shifted**2).sum(axis=0)
        self._min = np.minimum(self._min, np.where(valid, rows, np.inf).min(axis=0))
        self._max = np.maximum(self._max, np.where(valid, rows, -np.inf).max(axis=0))
        self._last = rows[-1]

    def result(self, columns: Sequence[str]) -> dict[str, dict[str, float | None]]:
        """Return the statistics by column name; columns never finite are left out."""
        table: dict[str, dict[str, float | None]] = {}
        for i, name in enumerate(columns):
            if self._count[i] == 0:
                continue
            mean = self._sum[i] / self._count[i]
            variance = max(0.0, self._sum2[i] / self._count[i] - mean**2)
            table[name] = {
                "mean": finite_or_none(mean + self._origin[i], 7),
                "sd": finite_or_none(variance**0.5, 7),
                "min": finite_or_none(self._min[i], 7),
                "max": finite_or_none(self._max[i], 7),
                "last": finite_or_none(self._last[i], 7),
            }
        return table


class RunSummary:
    """What ``summary.json`` says about a run.

    Parameters
    ----------
    columns : column names; ``state`` groups the statistics, ``*_us`` columns get percentiles.
    state_names : name per value of the ``state`` column.
    """

    def __init__(self, columns: Sequence[str], state_names: Sequence[str]) -> None:
        self._columns = tuple(columns)
        self._state_names = tuple(state_names)
        self._state_index = self._columns.index("state") if "state" in self._columns else None
        self._by_state: dict[int, ColumnStatistics] = {}
        self._rows_in_state: dict[int, int] = {}
        self._timing = {
            i: np.zeros(len(_BINS_US) + 1, dtype=np.int64)
            for i, name in enumerate(self._columns)
            if name.endswith("_us")
        }
        self._timing_max: dict[int, float] = dict.fromkeys(self._timing, 0.0)

    def add(self, records: Sequence[Sequence[float]]) -> None:
        """Add records in the order of the columns."""
        rows = np.asarray(records, dtype=np.float64)
        if rows.size == 0:
            return
        index = self._state_index
        states = (
            np.full(len(rows), -1.0) if index is None else np.nan_to_num(rows[:, index], nan=-1)
        )
        for state in np.unique(states):
            chosen = rows[states == state]
            key = int(state)
            if key not in self._by_state:
                self._by_state[key] = ColumnStatistics(rows.shape[1])
            self._by_state[key].add(chosen)
            self._rows_in_state[key] = self._rows_in_state.get(key, 0) + len(chosen)
        for i, histogram in self._timing.items():
            values = rows[np.isfinite(rows[:, i]), i]
            if values.size:
                np.add.at(histogram, np.searchsorted(_BINS_US, values), 1)
                self._timing_max[i] = max(self._timing_max[i], float(values.max()))

    def result(self) -> RunStatistics:
        """Return the statistics."""
        return RunStatistics(
            rows=sum(self._rows_in_state.values()),
            rows_by_state={self._name(k): n for k, n in self._rows_in_state.items()},
            timing_us={self._columns[i]: self._percentiles(i) for i in self._timing},
            columns_by_state={
                self._name(k): s.result(self._columns) for k, s in self._by_state.items()
            },
        )

    def _name(self, state: int) -> str:
        """Return the name of a state value; ``ALL`` where the columns hold no state."""
        return self._state_names[state] if 0 <= state < len(self._state_names) else "ALL"

    def _percentiles(self, i: int) -> dict[str, float | None]:
        """Return p50, p99, p99.9 (upper bin edges) and the maximum of a timing column, us."""
        histogram = self._timing[i]
        total = int(histogram.sum())
        if total == 0:
            return {}
        cumulative = np.cumsum(histogram)
        result: dict[str, float | None] = {}
        for name, share in (("p50", 0.5), ("p99", 0.99), ("p99.9", 0.999)):
            at = int(np.searchsorted(cumulative, share * total))
            result[name] = finite_or_none(
                min(_BINS_US[min(at, len(_BINS_US) - 1)], self._timing_max[i]), 7
            )
        result["max"] = finite_or_none(self._timing_max[i], 7)
        return result
