"""Rows of trends: least, mean and largest of every curve, a minute and an hour each."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aff_hmi.see.series import Series

SCHEMA = (
    "CREATE TABLE IF NOT EXISTS trend_series (id INTEGER PRIMARY KEY, names TEXT UNIQUE NOT NULL)",
    "CREATE TABLE IF NOT EXISTS trend (tier INTEGER NOT NULL, t INTEGER NOT NULL, "
    "series INTEGER NOT NULL, data BLOB NOT NULL, PRIMARY KEY (tier, t)) WITHOUT ROWID",
    # seconds per curve of a minute that was kept before it was over; one row at most
    "CREATE TABLE IF NOT EXISTS trend_begun (t INTEGER PRIMARY KEY, curves TEXT NOT NULL, "
    "seconds BLOB NOT NULL)",
)
MINUTE_S, HOUR_S = 60, 3600
KEPT_S = {MINUTE_S: 30 * 86_400, HOUR_S: 5 * 366 * 86_400}
LEAST, MEAN, LARGEST = 0, 1, 2
Bins = NDArray[np.float32]  # (bins, 3, curves)


@dataclass(frozen=True, slots=True)
class BinnedCurves:
    """Bins of curves in the order of time: ``t_s`` is where each begins, ``bin_s`` its length."""

    t_s: NDArray[np.int64]
    bins: Bins
    bin_s: int


def put_bins(
    connection: sqlite3.Connection, tier: int, t_s: int, curves: Sequence[Series], bins: Bins
) -> None:
    """Keep one bin (3, curves); one of the same time is replaced."""
    names = _names(curves)
    connection.execute("INSERT OR IGNORE INTO trend_series (names) VALUES (?)", (names,))
    (number,) = connection.execute(
        "SELECT id FROM trend_series WHERE names = ?", (names,)
    ).fetchone()
    connection.execute(
        "INSERT OR REPLACE INTO trend VALUES (?, ?, ?, ?)",
        (tier, t_s, number, np.ascontiguousarray(bins, dtype=np.float32).tobytes()),
    )


def put_minute(
    connection: sqlite3.Connection,
    t_s: int,
    curves: Sequence[Series],
    seconds: Bins,
    *,
    is_over: bool,
) -> None:
    """Keep the minute that begins at ``t_s``, with what is kept of it already.

    Parameters
    ----------
    seconds : (seconds, 3, curves), those that no row has yet.
    is_over : False where the screen ends in it: the next start may go on with it.
    """
    counts = np.isfinite(seconds[:, MEAN]).sum(axis=0).astype(np.float64)
    new = joined(seconds)
    old = get_bins(connection, MINUTE_S, t_s, t_s + 1, curves)
    if len(old.t_s):
        (kept,) = old.bins
        before = _seconds_of(connection, t_s, curves, kept)
        new = _both(kept, before, new, counts)
        counts = counts + before
    put_bins(connection, MINUTE_S, t_s, curves, new)
    connection.execute("DELETE FROM trend_begun")
    if not is_over:
        row = (t_s, _names(curves), counts.tobytes())
        connection.execute("INSERT INTO trend_begun VALUES (?, ?, ?)", row)


def _seconds_of(
    connection: sqlite3.Connection, t_s: int, curves: Sequence[Series], kept: Bins
) -> NDArray[np.float64]:
    """Return how many seconds of each curve a kept minute holds; all, where it was over."""
    found = connection.execute(
        "SELECT seconds FROM trend_begun WHERE t = ? AND curves = ?", (t_s, _names(curves))
    ).fetchone()
    if found is not None:
        return np.frombuffer(found[0], dtype=np.float64)
    return np.where(np.isfinite(kept[MEAN]), float(MINUTE_S), 0.0)


def _both(a: Bins, a_count: NDArray[np.float64], b: Bins, b_count: NDArray[np.float64]) -> Bins:
    """Return two bins (3, curves) as one, means by how many seconds are in them."""
    total = np.nansum([a[MEAN] * a_count, b[MEAN] * b_count], axis=0)
    with np.errstate(invalid="ignore"):
        mean = total / (a_count + b_count)
    return np.stack([np.fmin(a[LEAST], b[LEAST]), mean, np.fmax(a[LARGEST], b[LARGEST])]).astype(
        np.float32
    )


def put_left_hours(connection: sqlite3.Connection) -> None:
    """Keep the hours that have minutes and no row, and the newest anew: it may have gone on.

    The screen ended in them, or was ended.
    """
    (newest,) = connection.execute(
        "SELECT max(t) FROM trend WHERE tier = ?", (MINUTE_S,)
    ).fetchone()
    begins_s = 0
    while True:
        (minute,) = connection.execute(
            "SELECT min(t) FROM trend WHERE tier = ? AND t >= ?", (MINUTE_S, begins_s)
        ).fetchone()
        if minute is None:
            return
        hour = minute // HOUR_S * HOUR_S
        begins_s = hour + HOUR_S
        found = connection.execute("SELECT 1 FROM trend WHERE tier = ? AND t = ?", (HOUR_S, hour))
        if found.fetchone() is None or newest < begins_s:
            put_hour(connection, hour)


def _curves_in(connection: sqlite3.Connection, hour: int) -> list[Series]:
    """Return every curve that the minutes of an hour have."""
    names = connection.execute(
        "SELECT DISTINCT names FROM trend_series JOIN trend ON trend.series = trend_series.id "
        "WHERE tier = ? AND t >= ? AND t < ?",
        (MINUTE_S, hour, hour + HOUR_S),
    )
    return list(dict.fromkeys(Series(*one) for (text,) in names for one in json.loads(text)))


def put_hour(connection: sqlite3.Connection, t_s: int) -> None:
    """Keep the hour that begins at ``t_s``, from its minutes and with every curve of theirs."""
    curves = _curves_in(connection, t_s)
    minutes = get_bins(connection, MINUTE_S, t_s, t_s + HOUR_S, curves)
    if len(minutes.t_s):
        put_bins(connection, HOUR_S, t_s, curves, joined(minutes.bins))


def get_bins(
    connection: sqlite3.Connection, tier: int, from_s: float, to_s: float, curves: Sequence[Series]
) -> BinnedCurves:
    """Return the bins of some curves; NaN where a curve was not kept."""
    places: dict[int, list[int]] = {}
    sizes: dict[int, int] = {}
    for number, names in connection.execute("SELECT id, names FROM trend_series"):
        kept = [Series(*one) for one in json.loads(names)]
        places[number] = [kept.index(c) if c in kept else -1 for c in curves]
        sizes[number] = len(kept)
    rows = connection.execute(
        "SELECT t, series, data FROM trend WHERE tier = ? AND t >= ? AND t < ? ORDER BY t",
        (tier, from_s, to_s),
    ).fetchall()
    bins = np.full((len(rows), 3, len(curves)), np.nan, dtype=np.float32)
    for n, (_, number, data) in enumerate(rows):
        whole = np.frombuffer(data, dtype=np.float32).reshape(3, sizes[number])
        at = np.array(places[number], dtype=np.int64)
        bins[n][:, at >= 0] = whole[:, at[at >= 0]]
    return BinnedCurves(np.array([t for t, _, _ in rows], dtype=np.int64), bins, tier)


def prune_trend(connection: sqlite3.Connection, now_s: float, *, is_full: bool) -> None:
    """Delete what is too old, and the oldest tenth of the minutes when the disk is full."""
    for tier, kept_s in KEPT_S.items():
        connection.execute("DELETE FROM trend WHERE tier = ? AND t < ?", (tier, now_s - kept_s))
    if is_full:
        connection.execute(
            "DELETE FROM trend WHERE tier = ?1 AND t IN (SELECT t FROM trend WHERE tier = ?1 "
            "ORDER BY t LIMIT (SELECT 1 + count(*) / 10 FROM trend WHERE tier = ?1))",
            (MINUTE_S,),
        )
    connection.execute(
        "DELETE FROM trend_series WHERE id NOT IN (SELECT DISTINCT series FROM trend)"
    )


def joined(bins: Bins) -> Bins:
    """Return several bins (bins, 3, curves) as one (3, curves)."""
    return folded(bins[:, LEAST], bins[:, MEAN], bins[:, LARGEST])


def folded(
    least: NDArray[np.floating], mean: NDArray[np.floating], largest: NDArray[np.floating]
) -> Bins:
    """Return one bin (3, curves) of rows (rows, curves); NaN for a curve that has nothing."""
    with np.errstate(invalid="ignore"):
        count = np.isfinite(mean).sum(axis=0)
        return np.stack(
            [np.fmin.reduce(least), np.nansum(mean, axis=0) / count, np.fmax.reduce(largest)]
        ).astype(np.float32)


def _names(curves: Sequence[Series]) -> str:
    return json.dumps([[c.group, c.label, c.role, c.unit] for c in curves])


def coarser(binned: BinnedCurves, bin_s: int) -> BinnedCurves:
    """Return the same in longer bins."""
    if not len(binned.t_s) or bin_s <= binned.bin_s:
        return binned
    begins = binned.t_s // bin_s * bin_s
    starts = np.flatnonzero(np.diff(begins, prepend=begins[0] - 1))
    parts = np.split(binned.bins, starts[1:])
    return BinnedCurves(begins[starts], np.stack([joined(part) for part in parts]), bin_s)
