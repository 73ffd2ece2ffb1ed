"""What a store takes of one run folder: its hours, and one steady stretch of each."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from aff_runtime.app.report.comparison.comparing import gone_up, percentiles
from aff_runtime.app.report.comparison.turns import Array
from aff_runtime.app.report.comparison.window import (
    Window,
    said_of_readings,
    speed_channel,
    without_gaps,
)
from aff_runtime.app.report.watching.drive_rows import drive_rows
from aff_runtime.app.report.watching.order_rows import order_rows
from aff_runtime.app.report.watching.response_rows import (
    MeasuredResponse,
    measured_responses,
    response_rows,
)
from aff_runtime.app.report.watching.stretches import SHORTEST_S, is_correcting, steady
from aff_runtime.app.report.watching.tables import DriveRow, HourRow, OrderRow, ResponseRow
from aff_runtime.base.errors import AffError
from aff_runtime.base.order_columns import RESPONSE_RATIO, SIZES, is_part
from aff_runtime.base.printable import printable, text_or
from aff_runtime.base.probe_columns import STAGE
from aff_runtime.base.runs.files import text_of, yaml_values
from aff_runtime.base.runs.join import LONGEST_RUN_S
from aff_runtime.base.runs.segment import RunSegments
from aff_runtime.base.runs.site_in_force import SiteInForce
from aff_runtime.base.runs.table import (
    FirstRow,
    few,
    first_rows,
    other_line,
    read_table,
    run_id,
    run_sites,
)
from aff_runtime.base.runs.window import MARK, RunWindow
from aff_runtime.base.yaml_section import Section

HOUR_S = 3600.0
EARLIEST = datetime(2020, 1, 1, tzinfo=UTC)
"""No run is older than this software: the clock of that machine was not set yet."""
READ_S = 150.0
"""Seconds of an hour that are read at once; a stretch is at most ``stretches.LONGEST_S``."""
PLACES = (0.0, 1.0 / 3.0, 2.0 / 3.0)
"""Where in an hour a stretch is looked for, as a share, until one is ``ENOUGH_S`` long."""
ENOUGH_S = 60.0
OF_A_SEGMENT = "signals-"
MISSED = "missed_count"
NOT_COUNTED = f"{MISSED} is a number in no row of a stretch: missed ticks are not known there"
_LARGEST = 1 << 20  # bytes of a file of the run


def _is_needed(column: str) -> bool:
    return "." not in column or is_part(column, RESPONSE_RATIO, *SIZES) or column == STAGE


@dataclass(frozen=True, slots=True, kw_only=True)
class HourRead:
    """One hour of a run: its row, those of what was measured in it, what is said of its files."""

    hour: HourRow
    orders: tuple[OrderRow, ...]
    drives: tuple[DriveRow, ...] = ()
    responses: tuple[ResponseRow, ...] = ()
    lost: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedHour:
    """An hour of a run's clock that has rows.

    Attributes
    ----------
    hour : its number. ``from_s``, ``to_s`` : time of its first and last row.
    web_to_s : until when its web counts: where the next such hour begins, or the run ends.
    """

    hour: int
    from_s: float
    to_s: float
    web_to_s: float

    @property
    def covered_s(self) -> float:
        """Return how much of it is recorded."""
        return self.to_s - self.from_s


@dataclass(frozen=True, slots=True, kw_only=True)
class RunHours:
    """A run folder at a glance; its hours are read one by one when asked for.

    Attributes
    ----------
    run_id : the same for every copy of the folder.
    line : name of the line. ``start_utc`` : wall time of the row at time ``start_s``.
    hours : that have rows.
    times_s, lengths_m : (points,) times of the run's clock, and the web that ran until each.
    lost : sentences about what the run no longer has, or never had.
    responses : that probes measured during the run.
    segments, sites : when each begins, and what site files ran, by the one look at them all.
    """

    folder: Path
    run_id: str
    config_hash: str
    line: str
    site: Section
    start_utc: datetime
    start_s: float
    hours: tuple[RecordedHour, ...]
    times_s: Array
    lengths_m: Array
    segments: RunSegments
    sites: tuple[SiteInForce, ...]
    responses: tuple[MeasuredResponse, ...] = ()
    lost: tuple[str, ...] = ()

    def utc(self, time_s: float) -> np.datetime64:
        """Return the wall time of a row."""
        at = np.datetime64(self.start_utc.replace(tzinfo=None), "us")
        return at + np.timedelta64(round(1e6 * (time_s - self.start_s)), "us")

    def web_m(self, one: RecordedHour) -> float:
        """Return how much web ran from an hour's first row to that of the next."""
        return self._until_m(one.web_to_s) - self._until_m(one.from_s)

    def _until_m(self, time_s: float) -> float:
        return float(np.interp(time_s, self.times_s, self.lengths_m))

    def read(self, one: RecordedHour) -> HourRead:
        """Return what an hour holds, with the longest stretch that was looked at."""
        best: Window | None = None
        lost: dict[str, None] = {}
        for place in PLACES:
            from_s = one.from_s + place * max(0.0, one.covered_s - READ_S)
            stretch = self._stretch(from_s, min(from_s + READ_S, one.to_s + 1e-6), lost)
            if stretch is not None and (best is None or _seconds(stretch) > _seconds(best)):
                best = stretch
            if (best is not None and _seconds(best) >= ENOUGH_S) or one.covered_s <= READ_S:
                break
        responses = tuple(response_rows(self._nearest(one), self.run_id, one.hour, self.site))
        return replace(self._read(one, best), lost=tuple(lost), responses=responses)

    def _nearest(self, one: RecordedHour) -> Iterator[MeasuredResponse]:
        """Yield the responses to which this hour is the nearest that is still recorded."""
        middles = np.array([0.5 * (hour.from_s + hour.to_s) for hour in self.hours])
        for measured in self.responses:
            time_s = self.start_s + (measured.at - self.start_utc).total_seconds()
            if self.hours[int(np.argmin(np.abs(middles - time_s)))] == one:
                yield measured

    def _stretch(self, from_s: float, to_s: float, lost: dict[str, None]) -> Window | None:
        window = RunWindow(folder=self.folder, from_s=from_s, to_s=to_s)
        try:
            table = read_table(window, keep=_is_needed, segments=self.segments, sites=self.sites)
        except AffError as error:  # a hole in the record, or a segment that cannot be read
            if OF_A_SEGMENT in str(error):
                lost[str(error)] = None
            return None
        lost.update(dict.fromkeys(t for t in table.lost if t.startswith(OF_A_SEGMENT)))
        lost.update(dict.fromkeys(one.said for one in table.sites if one.said))
        stretch = steady(table, speed_channel(self.site))
        if stretch is not None:
            lost.update(dict.fromkeys(said_of_readings(stretch)))
            counts = stretch.table.columns.get(MISSED)
            if counts is not None and gone_up(counts) is None:
                lost[NOT_COUNTED] = None
        return stretch

    def _read(self, one: RecordedHour, window: Window | None) -> HourRead:
        middle_s = 0.5 * (one.from_s + one.to_s)
        if window is not None:
            middle_s = 0.5 * float(window.time_s[0] + window.time_s[-1])
        row = replace(
            _of_stretch(window),
            run_id=self.run_id,
            hour=one.hour,
            time_utc=self.utc(middle_s),
            run=printable(self.folder.name, 100),
            config_hash=self.config_hash,
            covered_s=one.covered_s,
            length_m=self.web_m(one),
            offset_m=self._until_m(middle_s) - self._until_m(one.from_s),
        )
        if window is None:
            return HourRead(hour=row, orders=())
        return HourRead(
            hour=row, orders=tuple(order_rows(window, row)), drives=tuple(drive_rows(window, row))
        )


def run_hours(folder: Path) -> RunHours:
    """Return what a run folder holds.

    Raises
    ------
    AffError
        It is no run, has no rows, or does not say when it began.
    """
    about, rows = first_rows(folder)
    begins = _rising(rows)
    shown = printable(str(folder))
    if not begins:
        raise AffError(f"{shown}: no segment of the run holds a row")
    site = _site(folder)
    segments = RunSegments.known(folder, {one.number: one.values["time_s"] for one in rows})
    sites = run_sites(folder)
    times, speeds, lost = _speeds(folder, segments, sites, begins, speed_channel(site))
    segment_s = _segment_s(about)
    responses, no_responses = measured_responses(folder)
    if other := other_line(about, text_or(site.section("line").get("name"))):
        raise AffError(f"{shown}: {other}")
    return RunHours(
        folder=folder,
        run_id=run_id(folder),
        config_hash=printable(text_or(about.get("config_hash")), 64),
        line=printable(
            text_or(site.section("line").get("name")) or text_or(about.get("name")), 100
        ),
        site=site,
        start_utc=_start(shown, about),
        start_s=max(0.0, begins[0].values["time_s"] - (begins[0].number - 1) * segment_s),
        hours=_hours([one.values["time_s"] for one in begins], segment_s, float(times[-1])),
        times_s=times,
        lengths_m=_lengths(times, speeds),
        segments=segments,
        sites=sites,
        responses=responses,
        lost=(
            *lost,
            *few(list(no_responses)),
            *few(list(_odd(rows, begins))),
            *_unmapped(site, begins[0]),
        ),
    )


def _odd(rows: tuple[FirstRow, ...], begins: list[FirstRow]) -> Iterator[str]:
    """Yield segments whose time does not go on."""
    taken = {one.number for one in begins}
    for one in rows:
        if one.number not in taken:
            at_s = one.values["time_s"]
            yield f"segment {one.number}: its clock goes back, to {at_s:.4g} s; left out"


def _unmapped(site: Section, row: FirstRow) -> Iterator[str]:
    """Yield why a run's rolls or channels are not known."""
    if not site:
        yield "its site.yaml cannot be read: no roller of it is known"
    mapped = [
        str(n) for n, _ in site.section("gateway").section("read").section("channels").items()
    ]
    missing = [name for name in mapped if name not in row.values]
    if missing:
        named = printable(", ".join(missing), 200)
        yield f"its site.yaml maps {named}, the run has no such column: is it of another run?"


def _rising(rows: tuple[FirstRow, ...]) -> list[FirstRow]:
    """Return the segments whose time goes on; where a clock goes back it does not."""
    rising: list[FirstRow] = []
    for row in rows:
        time_s = row.values["time_s"]
        if 0.0 <= time_s < LONGEST_RUN_S and (not rising or time_s > rising[-1].values["time_s"]):
            rising.append(row)
    return rising


def _segment_s(about: Section) -> float:
    given = about.get("segment_s")
    return float(given) if isinstance(given, int | float) and 0.0 < given < HOUR_S else HOUR_S


def _hours(begins_s: list[float], segment_s: float, last_s: float) -> tuple[RecordedHour, ...]:
    """Return the hours in which segments lie; those between are deleted, to bound the disk."""
    spans: dict[int, tuple[float, float]] = {}
    ends = [*begins_s[1:], max(last_s, begins_s[-1])]
    for begin, end in zip(begins_s, ends, strict=True):
        stop = min(end, begin + segment_s)
        for hour in range(int(begin // HOUR_S), int(stop // HOUR_S) + 1):
            first, last = max(begin, hour * HOUR_S), min(stop, (hour + 1) * HOUR_S)
            spans[hour] = (min(first, spans.get(hour, (first, last))[0]), last)
    starts = [first for first, _ in spans.values()]
    return tuple(
        RecordedHour(hour=hour, from_s=first, to_s=last, web_to_s=web_to_s)
        for (hour, (first, last)), web_to_s in zip(
            spans.items(), [*starts[1:], last_s], strict=True
        )
        if last > first
    )


def _site(folder: Path) -> Section:
    try:
        return Section.of(yaml_values(text_of(folder / "site.yaml", _LARGEST)))
    except ValueError:
        return Section()


def _start(shown: str, about: Section) -> datetime:
    said = text_or(about.get("start_utc"))
    try:
        found = datetime.fromisoformat(said)
        start = found.astimezone(UTC) if found.tzinfo else found.replace(tzinfo=UTC)
    except (ValueError, OverflowError):
        raise AffError(
            f"{shown}: start_utc says {printable(said, 40)!r}, expected a time such as "
            "2026-01-02T03:04:05+00:00; without it nobody knows when the run was"
        ) from None
    if start < EARLIEST:
        raise AffError(
            f"{shown}: began on {start:%Y-%m-%d} by a clock that was not set yet; once somebody "
            f"knows when it was, write that as start_utc into its {MARK}"
        )
    return start


def _speeds(
    folder: Path,
    segments: RunSegments,
    sites: Sequence[SiteInForce],
    begins: list[FirstRow],
    name: str,
) -> tuple[Array, Array, tuple[str, ...]]:
    """Return times that rise, the line speed there (segments' begins, the last), what is lost."""
    points = [(one.values["time_s"], one.values.get(name, 0.0)) for one in begins]
    window = RunWindow(folder=folder, from_s=points[-1][0])
    keep: Callable[[str], bool] = name.__eq__
    table = read_table(window, keep=keep, segments=segments, sites=sites)
    last = table.columns
    every = max(1, last["time_s"].size // 100)
    tail = last.get(name, np.zeros_like(last["time_s"]))
    points += list(zip(last["time_s"][::every], tail[::every], strict=True))
    points.append((last["time_s"][-1], tail[-1]))
    time_s, speed = np.array(points).T
    rising = time_s > np.maximum.accumulate(np.concatenate([[-math.inf], time_s[:-1]]))
    return time_s[rising], without_gaps(time_s[rising], np.abs(speed[rising])), table.lost


def _lengths(times_s: Array, speeds_m_s: Array) -> Array:
    steps = 0.5 * (speeds_m_s[1:] + speeds_m_s[:-1]) * np.diff(times_s)
    return np.concatenate([[0.0], np.cumsum(steps)])


def _seconds(window: Window) -> float:
    return float(window.time_s[-1] - window.time_s[0]) if window.time_s.size else 0.0


def _of_stretch(window: Window | None) -> HourRow:
    """Return a row with the figures of a stretch; the caller fills in the rest."""
    blank = HourRow(run_id="", hour=0, time_utc=np.datetime64(0, "us"), run="", config_hash="")
    if window is None:
        lacks = f"no {SHORTEST_S:.0f} s at one speed without splice, probe or limit"
        return replace(blank, lacks=lacks)
    columns = window.table.columns
    none = np.full(1, math.nan)
    wake, io, tick = (percentiles(columns.get(f"{n}_us", none)) for n in ("wake", "io", "tick"))
    missed = gone_up(columns.get(MISSED))  # since the process began to tick
    speed = window.speed
    return replace(
        blank,
        stretch_s=_seconds(window),
        speed_m_s=math.nan if speed is None else float(np.nanmean(np.abs(speed))),
        correcting=is_correcting(window),
        missed_count=math.nan if missed is None else float(missed),
        wake_p99_us=wake[1],
        io_p99_us=io[1],
        tick_p50_us=tick[0],
        tick_p99_us=tick[1],
        tick_max_us=tick[3],
    )
