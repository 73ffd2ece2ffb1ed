"""Trends: seconds of the last hour in memory, minutes and hours in the store."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aff_hmi.layout import Layout
from aff_hmi.see.series import Series, SeriesSet
from aff_hmi.see.store import Store
from aff_hmi.see.trend_rows import (
    HOUR_S,
    MINUTE_S,
    BinnedCurves,
    Bins,
    coarser,
    folded,
    get_bins,
    prune_trend,
    put_hour,
    put_left_hours,
    put_minute,
)
from aff_hmi.view import ripple_of
from aff_hmi.watch import News, Observed

FINE = 3600  # seconds in memory
MOST_POINTS = 300  # of a window, by `BIN_S`
# name of a window: its length, s, and the bins of the store behind the seconds in memory
WINDOWS = {
    "1min": (60, MINUTE_S),
    "10min": (600, MINUTE_S),
    "1h": (3600, MINUTE_S),
    "8h": (8 * 3600, MINUTE_S),
    "7d": (7 * 86_400, MINUTE_S),
    "1y": (366 * 86_400, HOUR_S),
}
# how long a bin of each window is, s
BIN_S = {"1min": 1, "10min": 2, "1h": 12, "8h": 120, "7d": 2400, "1y": 108_000}


@dataclass(frozen=True, slots=True)
class Curves:
    """Bins of a group over a window.

    Attributes
    ----------
    wide_s : how much time each bin is of; a stored minute in a finer window is of its own.
    to_s : wall time at which it ends, now.
    """

    series: tuple[Series, ...]
    binned: BinnedCurves
    wide_s: NDArray[np.int64]
    from_s: float
    to_s: float


class Trends:
    """Keeps the curves of one line.

    Parameters
    ----------
    wall : returns wall time, s since 1970.
    """

    def __init__(self, store: Store, wall: Callable[[], float]) -> None:
        self._store = store
        self._wall = wall
        self._set: SeriesSet | None = None
        self._of: tuple[tuple[str, ...], str] | None = None
        self._rows: list[NDArray[np.float64]] = []
        self._second: int | None = None
        self._t_s = np.zeros(FINE, dtype=np.int64)
        self._fine: Bins = np.empty((FINE, 3, 0), dtype=np.float32)
        self._count = 0
        self._hour: int | None = None
        store.put(put_left_hours)

    @property
    def series(self) -> tuple[Series, ...]:
        """Every curve that is kept now."""
        return self._set.all if self._set is not None else ()

    def listen(self, news: News) -> None:
        """Take the ticks that a poll has brought."""
        if self._set is None or not len(news.records) or self._of is None:
            return
        if news.columns == self._of[0]:
            self._turn()
            self._rows.append(self._set.of_ticks(news.records))

    def look(self, seen: Observed, layout: Layout, columns: tuple[str, ...]) -> None:
        """Take a sample of what is worked out from a tick.

        Parameters
        ----------
        columns : of the ring that is followed.
        """
        site = seen.site
        if site is not None and columns and self._of != (columns, layout.ident):
            self._begin(SeriesSet(columns, layout, site), (columns, layout.ident))
        self._turn()
        is_fresh = seen.writer_lives and seen.tick_age_s is not None and seen.tick_age_s < 1.0
        if self._set is not None and seen.row is not None and is_fresh:
            values = dict(ripple_of(seen, seen.row, layout))
            self._rows.append(self._set.of_sample(seen.row, values))

    def wanted(self, group: str, window: str) -> Callable[[sqlite3.Connection], Curves]:
        """Return what reads a group over a window; call it in the store's thread.

        Raises
        ------
        KeyError
            When there is no such window, or no such group.
        """
        length_s, tier = WINDOWS[window]
        curves = tuple(one for one in self.series if one.group in (group, "state"))
        if group == "state" or group not in {one.group for one in curves}:
            raise KeyError(group)
        now_s = self._wall()
        fine = self._newest(curves, now_s - length_s)
        begins_s = now_s - length_s
        until_s = float(fine.t_s[0]) if len(fine.t_s) else now_s
        bin_s = BIN_S[window]

        def read(connection: sqlite3.Connection) -> Curves:
            begun_s = until_s // tier * tier  # a row from here on is not of what is behind alone
            behind = get_bins(connection, tier, begins_s - tier, begun_s, curves)
            new = coarser(fine, min(bin_s, MINUTE_S))
            if tier > MINUTE_S:  # of the hour in which memory begins the minutes are kept
                last_s = until_s // MINUTE_S * MINUTE_S
                minutes = get_bins(connection, MINUTE_S, begun_s, last_s, curves)
                new = coarser(_one_after_the_other(minutes, new), tier)
            whole = _one_after_the_other(behind, new)
            found = coarser(whole, bin_s)
            wide_s = np.full(len(found.t_s), bin_s, dtype=np.int64)
            if bin_s < tier:
                wide_s[: len(behind.t_s)] = tier
            return Curves(curves, found, wide_s, begins_s, now_s)

        return read

    def seconds(self, curves: Sequence[Series], length_s: int) -> BinnedCurves:
        """Return the seconds in memory of some curves that are kept, up to an hour back."""
        return self._newest(curves, self._wall() - length_s)

    def flush(self) -> None:
        """Keep the minute and the hour that have begun: the screen ends, here as well."""
        if self._second is None:
            return
        self._close_second()
        self._close_minute(self._second // MINUTE_S * MINUTE_S, is_over=False)
        begun = self._second // HOUR_S * HOUR_S
        self._store.put(lambda c: put_hour(c, begun))

    # --- bins -------------------------------------------------------------------------------

    def _begin(self, series: SeriesSet, of: tuple[tuple[str, ...], str]) -> None:
        """Follow another line, or other columns: what is kept of curves that stay, stays."""
        before, old = self.series, self._fine
        self._set, self._of, self._rows = series, of, []
        self._fine = np.full((FINE, 3, len(series.all)), np.nan, dtype=np.float32)
        for at, one in enumerate(series.all):
            if one in before:
                self._fine[:, :, at] = old[:, :, before.index(one)]

    def _turn(self) -> None:
        """Close the second that is over, and with it the minute and the hour."""
        second = int(self._wall())
        before, self._second = self._second, second
        if before is None or second == before:
            self._hour = self._hour if self._hour is not None else second // HOUR_S * HOUR_S
            return
        self._second = before
        self._close_second()
        self._second = second
        if second < before:  # the wall clock was put back: what is in memory has no order any more
            self._count = 0
        if second // MINUTE_S != before // MINUTE_S:
            self._close_minute(before // MINUTE_S * MINUTE_S)

    def _close_second(self) -> None:
        if not self._rows or self._second is None:
            return
        rows = np.concatenate(self._rows)
        self._rows = []
        at = self._count % FINE
        self._fine[at] = folded(rows, rows, rows)
        self._t_s[at] = self._second
        self._count += 1

    def _close_minute(self, begins_s: int, *, is_over: bool = True) -> None:
        minute = self._newest(self.series, begins_s)
        inside = minute.t_s < begins_s + MINUTE_S
        curves, now_s, store = self.series, self._wall(), self._store
        if inside.any():
            seconds = minute.bins[inside]
            store.put(lambda c: put_minute(c, begins_s, curves, seconds, is_over=is_over))
        hour = begins_s // HOUR_S * HOUR_S
        if self._hour is not None and hour != self._hour:
            over, self._hour = self._hour, hour
            store.put(lambda c: put_hour(c, over))
            store.put(lambda c: prune_trend(c, now_s, is_full=store.is_full(c)))

    def _newest(self, curves: Sequence[Series], from_s: float) -> BinnedCurves:
        """Return the seconds in memory from a time on, in their order."""
        kept = min(self._count, FINE)
        order = np.arange(self._count - kept, self._count) % FINE
        order = order[self._t_s[order] >= from_s]
        places = [self.series.index(one) for one in curves]
        return BinnedCurves(self._t_s[order], self._fine[order][:, :, places], 1)


def _one_after_the_other(a: BinnedCurves, b: BinnedCurves) -> BinnedCurves:
    """Return curves of two times as one, as fine as the finer of them."""
    return BinnedCurves(
        np.concatenate([a.t_s, b.t_s]), np.concatenate([a.bins, b.bins]), min(a.bin_s, b.bin_s)
    )
