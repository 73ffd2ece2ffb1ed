"""What a store takes of one run folder: its hours, and one steady stretch of each."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from hashlib import sha256
from pathlib import Path

import numpy as np

from aff_runtime.app.report.comparison.comparing import percentiles
from aff_runtime.app.report.comparison.turns import Array
from aff_runtime.app.report.comparison.window import DEFAULT_SPEED, Window
from aff_runtime.app.report.watching.order_rows import order_rows
from aff_runtime.app.report.watching.stretches import SHORTEST_S, is_correcting, steady
from aff_runtime.app.report.watching.tables import HourRow, OrderRow
from aff_runtime.base.errors import AffError
from aff_runtime.base.printable import printable, word
from aff_runtime.base.run_files import text_of, yaml_values
from aff_runtime.base.run_table import FirstRow, first_rows, read_table
from aff_runtime.base.run_window import MARK, RunWindow
from aff_runtime.base.yaml_section import Section

HOUR_S = 3600.0
READ_S = 150.0
"""Of an hour read at once; a stretch is at most ``stretches.LONGEST_S`` of it."""
PLACES = (0.0, 1.0 / 3.0, 2.0 / 3.0)
"""Where in an hour a stretch is looked for, until one is long enough."""
ENOUGH_S = 60.0
LAW_COLUMNS = (".shape_mm", ".amplitude_m_s", ".state", ".gain_of_P", "probe.stage")
_LARGEST = 1 << 20


@dataclass(frozen=True, slots=True, kw_only=True)
class HourRead:
    """One hour of a run: its row, and those of its orders."""

    hour: HourRow
    orders: tuple[OrderRow, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class RunHours:
    """A run folder at a glance; its hours are read one by one when asked for.

    Attributes
    ----------
    run_id : the same for every copy of the folder.
    line : name of the line. ``start_utc`` : wall time of the row at time ``start_s``.
    begins_s : of its segments, each at most ``segment_s`` long; 0: not known.
    times_s, lengths_m : (points,) of the run's clock, and how much web ran until there.
    """

    folder: Path
    run_id: str
    config_hash: str
    line: str
    site: Section
    start_utc: datetime
    start_s: float
    begins_s: Array
    segment_s: float
    times_s: Array
    lengths_m: Array

    def hours(self) -> Iterator[tuple[int, float]]:
        """Yield the hours that the folder has rows of, and for how many seconds."""
        first, last = float(self.times_s[0]), float(self.times_s[-1])
        for hour in range(int(first // HOUR_S), int(last // HOUR_S) + 1):
            covered_s = min(last, (hour + 1) * HOUR_S) - max(first, hour * HOUR_S)
            if covered_s > 0.0:
                yield hour, covered_s

    def moment(self, hour: int) -> np.datetime64:
        """Return when an hour of the run's clock began."""
        return self._utc(max(float(self.times_s[0]), hour * HOUR_S))

    def _utc(self, time_s: float) -> np.datetime64:
        at = np.datetime64(self.start_utc.replace(tzinfo=None), "us")
        return at + np.timedelta64(round(1e6 * (time_s - self.start_s)), "us")

    def read(self, hour: int, covered_s: float) -> HourRead:
        """Return what an hour holds, with the longest stretch that was looked at."""
        begin_s = max(float(self.times_s[0]), hour * HOUR_S)
        best: Window | None = None
        for place in PLACES:
            from_s = begin_s + place * max(0.0, covered_s - READ_S)
            found = self._stretch(from_s, min(from_s + READ_S, (hour + 1) * HOUR_S))
            if found is not None and (best is None or _seconds(found) > _seconds(best)):
                best = found
            if (best is not None and _seconds(best) >= ENOUGH_S) or covered_s <= READ_S:
                break
        return self._row(hour, covered_s, begin_s, best)

    def _stretch(self, from_s: float, to_s: float) -> Window | None:
        near = (self.begins_s < to_s) & (self.begins_s >= from_s - self.segment_s)
        if self.segment_s > 0.0 and not np.any(near):  # deleted, to bound the disk
            return None
        window = RunWindow(folder=self.folder, from_s=from_s, to_s=to_s)
        try:
            table = read_table(window, keep=lambda n: "." not in n or n.endswith(LAW_COLUMNS))
        except AffError:  # a hole in the record
            return None
        return steady(table, _speed_name(self.site))

    def _row(self, hour: int, covered_s: float, begin_s: float, window: Window | None) -> HourRead:
        middle_s = (
            begin_s + 0.5 * covered_s
            if window is None
            else 0.5 * float(window.time_s[0] + window.time_s[-1])
        )
        begin_m, middle_m, end_m = (
            float(np.interp(t, self.times_s, self.lengths_m))
            for t in (begin_s, middle_s, begin_s + covered_s)
        )
        hour_row = replace(
            _of_stretch(window),
            run_id=self.run_id,
            hour=hour,
            time_utc=self._utc(middle_s),
            run=printable(self.folder.name, 100),
            config_hash=self.config_hash,
            covered_s=covered_s,
            length_m=end_m - begin_m,
            offset_m=middle_m - begin_m,
        )
        orders = () if window is None else tuple(order_rows(window, hour_row))
        return HourRead(hour=hour_row, orders=orders)


def run_hours(folder: Path) -> RunHours:
    """Return what a run folder holds.

    Raises
    ------
    AffError
        It is no run, has no rows, or does not say when it began.
    """
    about, begins = first_rows(folder)
    shown = printable(str(folder))
    if not begins:
        raise AffError(f"{shown}: no segment of the run holds a row")
    site = _site(folder)
    name = _speed_name(site)
    times, speeds = _speeds(folder, begins, name)
    segment_s = about.get("segment_s")
    length = float(segment_s) if isinstance(segment_s, int | float) else 0.0
    text = text_of(folder / MARK, _LARGEST)
    return RunHours(
        folder=folder,
        run_id=sha256(text.encode()).hexdigest()[:16],
        config_hash=printable(word(about.get("config_hash")), 64),
        line=printable(word(site.section("line").get("name")) or word(about.get("name")), 100),
        site=site,
        start_utc=_start(shown, about),
        begins_s=np.array([one.values["time_s"] for one in begins]),
        segment_s=length,
        start_s=max(0.0, begins[0].values["time_s"] - (begins[0].number - 1) * length),
        times_s=times,
        lengths_m=_lengths(times, speeds),
    )


def _site(folder: Path) -> Section:
    try:
        return Section.of(yaml_values(text_of(folder / "site.yaml", _LARGEST)))
    except ValueError:
        return Section()


def _speed_name(site: Section) -> str:
    return word(site.section("line").get("speed"), DEFAULT_SPEED)


def _start(shown: str, about: Section) -> datetime:
    said = word(about.get("start_utc"))
    try:
        found = datetime.fromisoformat(said)
    except ValueError:
        raise AffError(
            f"{shown}: start_utc says {printable(said, 40)!r}, expected a time such as "
            "2026-01-02T03:04:05+00:00; without it nobody knows when the run was"
        ) from None
    return found.astimezone(UTC) if found.tzinfo else found.replace(tzinfo=UTC)


def _speeds(folder: Path, begins: tuple[FirstRow, ...], name: str) -> tuple[Array, Array]:
    """Return times that rise, and the line speed there: where segments begin, and in the last."""
    points = [(one.values["time_s"], one.values.get(name, 0.0)) for one in begins]
    window = RunWindow(folder=folder, from_s=points[-1][0])
    keep: Callable[[str], bool] = name.__eq__
    last = read_table(window, keep=keep).columns
    every = max(1, last["time_s"].size // 100)
    tail = last.get(name, np.zeros_like(last["time_s"]))
    points += list(zip(last["time_s"][::every], tail[::every], strict=True))
    points.append((last["time_s"][-1], tail[-1]))
    time_s, speed = np.array(points).T
    rising = time_s > np.maximum.accumulate(np.concatenate([[-math.inf], time_s[:-1]]))
    return time_s[rising], np.abs(np.nan_to_num(speed[rising]))


def _lengths(times_s: Array, speeds_m_s: Array) -> Array:
    steps = 0.5 * (speeds_m_s[1:] + speeds_m_s[:-1]) * np.diff(times_s)
    return np.concatenate([[0.0], np.cumsum(steps)])


def _seconds(window: Window) -> float:
    return float(window.time_s[-1] - window.time_s[0]) if window.time_s.size else 0.0


def _of_stretch(window: Window | None) -> HourRow:
    """Return a row with what a stretch says; the rest of it is to be filled in."""
    nobody = HourRow(run_id="", hour=0, time_utc=np.datetime64(0, "us"), run="", config_hash="")
    if window is None:
        lacks = f"no {SHORTEST_S:.0f} s at one speed without splice, probe or limit"
        return replace(nobody, lacks=lacks)
    columns = window.table.columns
    none = np.full(1, math.nan)
    wake, io, tick = (percentiles(columns.get(f"{n}_us", none)) for n in ("wake", "io", "tick"))
    missed = columns.get("missed_count", none)
    speed = window.speed
    return replace(
        nobody,
        stretch_s=_seconds(window),
        speed_m_s=math.nan if speed is None else float(np.nanmean(np.abs(speed))),
        correcting=is_correcting(window),
        missed_count=int(np.nan_to_num(missed[-1] - missed[0])),
        wake_p99_us=wake[1],
        io_p99_us=io[1],
        tick_p50_us=tick[0],
        tick_p99_us=tick[1],
        tick_max_us=tick[3],
    )
