"""Two windows side by side: ripple per roll and order, and what else differs between them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

import numpy as np

from aff_runtime.app.report.comparison.implausible import implausible_readings
from aff_runtime.app.report.comparison.site_differences import site_differences
from aff_runtime.app.report.comparison.steady_parts import longest_parts
from aff_runtime.app.report.comparison.turns import (
    FEWEST_SAMPLES,
    FEWEST_TURNS,
    Array,
    Change,
    Estimate,
    Flags,
    change,
    estimate_of_parts,
    order_per_turn,
)
from aff_runtime.app.report.comparison.window import (
    RollAngle,
    Window,
    load_window,
    number,
    orders_of,
    roll_angle,
    speed_channel,
)
from aff_runtime.base.channel_units import unit_of_channel
from aff_runtime.base.printable import printable, text_or
from aff_runtime.base.runs.holes import cycle_s_of, holes_between
from aff_runtime.base.runs.join import PERIODS
from aff_runtime.base.runs.site_in_force import NOTED_WITHIN_S
from aff_runtime.base.runs.window import RunWindow, not_recorded
from aff_runtime.base.signals import State
from aff_runtime.base.yaml_section import Section

LIKE_SPEED, LIKE_RADIUS, LIKE_TENSION = 0.05, 0.02, 0.03
"""Share by which means of two windows may differ without a label."""
TIMES = ("wake_us", "io_us", "tick_us")


@dataclass(frozen=True, slots=True, kw_only=True)
class OrderRow:
    """One order of one roll in one signal, in both windows.

    Attributes
    ----------
    frequency_Hz : before and after; NaN where the roll's angle is not known.
    labels : why the two may not be compared; empty where they may.
    """

    signal: str
    roll: str
    order: int
    frequency_Hz: tuple[float, float]
    before: Estimate
    after: Estimate
    change: Change
    labels: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Facts:
    """What is said of a window beside its ripple; numbers SI, times as their names say.

    Attributes
    ----------
    name : the window.
    seconds : between its first and last row.
    speed_m_s : mean, lowest, highest line speed.
    radius_m : per roll, at start and end.
    mean_N : per tension, its mean.
    corrections : per output, rms and largest size, and that over the limit.
    states : share of the rows per state.
    times_us : per timing, median, 99 %, 99.9 % and largest.
    missed : ticks that never happened. ``rows_lost`` : of ticks that did, but are not recorded.
    labels : sentences: why figures of this window may not be what they seem.
    """

    name: str
    seconds: float
    speed_m_s: tuple[float, float, float]
    radius_m: Mapping[str, tuple[float, float]]
    mean_N: Mapping[str, float]
    corrections: Mapping[str, tuple[float, float, float]]
    states: Mapping[str, float]
    times_us: Mapping[str, tuple[float, float, float, float]]
    missed: int
    rows_lost: int
    labels: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """Everything that the page shows.

    Attributes
    ----------
    line : name of the line of the first window.
    windows : before and after.
    rows : orders, grouped by signal and roll.
    differences : of the site files, one sentence each.
    labels : what keeps the whole from being compared.
    """

    line: str
    windows: tuple[Facts, Facts]
    rows: tuple[OrderRow, ...]
    differences: tuple[str, ...]
    labels: tuple[str, ...]


def compare(before: RunWindow, after: RunWindow) -> Comparison:
    """Return the comparison of two windows, of one run or of two.

    Raises
    ------
    AffError
        One is no run, or holds no rows.
    """
    pair = (load_window(before), load_window(after))
    angles = (dict(_angles(*pair)), dict(_angles(pair[1], pair[0])))
    facts = (_facts(pair[0], angles[0]), _facts(pair[1], angles[1]))
    differences, said = site_differences(*pair)
    return Comparison(
        line=pair[0].line,
        windows=facts,
        rows=tuple(_rows(pair, angles, facts)),
        differences=tuple(differences),
        labels=(*said, *_unlike(pair, facts)),
    )


def _angles(window: Window, other: Window) -> Iterator[tuple[str, RollAngle]]:
    """Yield the angle of every roll that either site file declares: it may turn undeclared."""
    declared = {**dict(other.section("rolls").items()), **dict(window.section("rolls").items())}
    for name, given in declared.items():
        found = roll_angle(window, Section.of(given))
        if found is not None:
            yield str(name), found


def _facts(window: Window, angles: Mapping[str, RollAngle]) -> Facts:
    columns, speed = window.table.columns, window.speed
    time_s = columns["time_s"]
    missed, rows_lost = _missed(columns)
    said = [*not_recorded(window.table.window, float(time_s[0]), float(time_s[-1]))]
    said += [*window.labels, *implausible_readings(window)]
    return Facts(
        name=printable(str(window.table.window)),
        seconds=float(time_s[-1] - time_s[0]),
        speed_m_s=_mean_low_high(speed),
        radius_m={name: a.radius_m for name, a in angles.items()},
        mean_N={n: float(np.nanmean(v)) for n, v in tensions(window)},
        corrections=dict(_corrections(window)),
        states={s.name: share for s in State if (share := window.in_state(s)) > 0.0},
        times_us={n: percentiles(columns[n]) for n in TIMES if n in columns},
        missed=missed,
        rows_lost=rows_lost,
        labels=(*said, *(longest_parts(window.table, speed_channel(window.site)) if said else [])),
    )


def _missed(columns: Mapping[str, Array]) -> tuple[int, int]:
    """Return how many ticks never happened, and how many did that have no row.

    The service counts both: ``missed_count``, in an older record the periods before each row, and
    ``tick``, those that were done.
    """
    by_count = gone_up(columns.get("missed_count"))
    periods = np.nan_to_num(columns.get(PERIODS, np.ones(1)))[1:]
    missed = by_count if by_count is not None else int(np.sum(np.maximum(periods - 1.0, 0.0)))
    done = gone_up(columns.get("tick"))
    return missed, max(0, (done or 0) - columns["time_s"].size + 1)


def gone_up(counts: Array | None) -> int | None:
    """Return by how much a count of the service went up in a window; None where it has none.

    From the first row in which it is a number to the last one.
    """
    finite = counts[np.isfinite(counts)] if counts is not None else np.empty(0)
    return round(float(np.clip(finite[-1] - finite[0], 0.0, 2.0**53))) if finite.size else None


def _mean_low_high(values: Any) -> tuple[float, float, float]:
    if values is None:
        return math.nan, math.nan, math.nan
    return float(np.nanmean(values)), float(np.nanmin(values)), float(np.nanmax(values))


def percentiles(values: Any) -> tuple[float, float, float, float]:
    """Return median, 99 %, 99.9 % and largest of what is a number; NaN where nothing is."""
    finite = values[np.isfinite(values)]
    if not finite.size:
        return math.nan, math.nan, math.nan, math.nan
    a, b, c, d = np.percentile(finite, (50.0, 99.0, 99.9, 100.0))
    return float(a), float(b), float(c), float(d)


def tensions(window: Window) -> Iterator[tuple[str, Any]]:
    """Yield every measured tension; set points are none."""
    references = {
        text_or(actuator.section("error").get("reference"))
        for actuator in window.section("actuators").sections()
    }
    for name, _ in window.section("gateway").section("read").section("channels").items():
        is_tension = unit_of_channel(str(name)) == "N"
        if is_tension and str(name) not in references and "_ref_" not in str(name):
            values = window.readings(str(name))
            if values is not None:
                yield str(name), values


def _corrections(window: Window) -> Iterator[tuple[str, tuple[float, float, float]]]:
    for column, values in window.table.columns.items():
        if not column.startswith("correction_"):
            continue
        output = column.removeprefix("correction_")
        sent = np.nan_to_num(values)
        largest = float(np.max(np.abs(sent)))
        yield output, (float(np.sqrt(np.mean(sent**2))), largest, _of_limit(window, output, sent))


def _of_limit(window: Window, output: str, sent: Array) -> float:
    """Return the largest share of its limit that an output had, NaN where it had none.

    Each row by the limit of its time; near an edit, which is noted late, by the larger of the two.
    """
    time_s = window.table.columns["time_s"]
    begins_s = [site.from_s for site in window.table.sites[1:]]
    limits = [_limit(site, output) for site in window.sites]
    at = np.searchsorted(begins_s, time_s, side="right")
    soon = np.searchsorted(begins_s, time_s + NOTED_WITHIN_S, side="right")
    limit = np.fmax(np.array(limits)[at], np.array(limits)[soon])
    shares = np.abs(sent) / np.where(limit > 0.0, limit, math.nan)
    return float(np.nanmax(shares)) if np.isfinite(shares).any() else math.nan


def _limit(site: Section, output: str) -> float:
    """Return an output's limit by a site file, SI; NaN where it has none."""
    for end, unit in (("_m_s", "m/s"), ("_N_m", "N m")):
        given = site.section("actuators").section(output.removesuffix(end))
        if output.endswith(end) and given:
            return number(given.get(f"limit{end}"), unit)
    return math.nan


def _rows(
    pair: tuple[Window, Window],
    angles: tuple[Mapping[str, RollAngle], ...],
    facts: tuple[Facts, Facts],
) -> Iterator[OrderRow]:
    """Yield every order of every roll in every tension that both windows have."""
    signals = [dict(tensions(window)) for window in pair]
    for roll in angles[0]:
        if roll not in angles[1]:
            continue
        orders = sorted({n for window in pair for n in orders_of(window.site, roll)})
        for signal in signals[0]:
            if signal not in signals[1]:
                continue
            ends = [
                estimates(angles[k][roll], signals[k][signal], pair[k], orders) for k in (0, 1)
            ]
            for order in orders:
                if order in ends[0] and order in ends[1]:
                    (first, f0), (last, f1) = ends[0][order], ends[1][order]
                    yield OrderRow(
                        signal=signal,
                        roll=roll,
                        order=order,
                        frequency_Hz=(f0, f1),
                        before=first,
                        after=last,
                        change=change(first, last),
                        labels=tuple(_row_labels(roll, (first, last), facts, angles)),
                    )


def estimates(
    angle: RollAngle, values: Any, window: Window, orders: Sequence[int]
) -> dict[int, tuple[Estimate, float]]:
    """Return estimate and mean frequency per order; orders with too few samples are left out."""
    cycle_s = cycle_s_of(window.time_s)
    parts = [
        order_per_turn(*_read_alone(window.time_s, values, angle, part, cycle_s), orders)
        for part in angle.parts()
    ]
    samples = np.concatenate([of_part for _, of_part in parts])
    rate = angle.rate_Hz(window.time_s)
    per_turn = float(np.median(samples)) if samples.size else 0.0
    return {
        order: (
            estimate_of_parts([turns[:, k] for turns, _ in parts], encoder=angle.encoder),
            order * rate,
        )
        for k, order in enumerate(orders)
        if not samples.size or per_turn / order >= FEWEST_SAMPLES
    }


def _read_alone(
    time_s: Array, values: Array, angle: RollAngle, part: slice, cycle_s: float
) -> tuple[Array, Array, Flags]:
    """Return angle, readings and whether they go on, of a part's rows that have a reading.

    One that lacks is bridged like a missed tick, and a hole where more are together.
    """
    read = part.start + np.flatnonzero(np.isfinite(values[part]))
    broken = np.cumsum(~angle.good[part])[read - part.start]
    goes_on = np.diff(broken, prepend=0) == 0
    goes_on[1:] &= ~holes_between(time_s[read], cycle_s)
    return angle.angle_rad[read], values[read], goes_on


def _row_labels(
    roll: str,
    ends: tuple[Estimate, Estimate],
    facts: tuple[Facts, Facts],
    angles: tuple[Mapping[str, RollAngle], ...],
) -> Iterator[str]:
    if min(end.turns for end in ends) < FEWEST_TURNS:
        yield f"fewer than {FEWEST_TURNS} whole turns: no interval"
    if not all(a[roll].encoder for a in angles):
        yield "no encoder: size only, its phase is not followed"
    if any(len(a[roll].parts()) > 1 for a in angles):
        yield "its count was set anew, or a hole hides how often it started over: joined by size"
    first, last = (float(np.mean(f.radius_m[roll])) for f in facts)
    if _apart(first, last) > LIKE_RADIUS:  # false where it is not known
        yield f"radius {1e3 * first:.1f} and {1e3 * last:.1f} mm"


def _unlike(pair: tuple[Window, Window], facts: tuple[Facts, Facts]) -> Iterator[str]:
    """Yield why the two windows as a whole are not alike."""
    if pair[0].line != pair[1].line:
        yield f"runs of two lines: {pair[0].line} and {pair[1].line}"
    speeds = [f.speed_m_s[0] for f in facts]
    if not _apart(*speeds) <= LIKE_SPEED:
        yield (
            f"line speed {speeds[0]:.4g} and {speeds[1]:.4g} m/s: ripple and response are others"
        )
    for name, first in facts[0].mean_N.items():
        last = facts[1].mean_N.get(name)
        if last is not None and _apart(first, last) > LIKE_TENSION:
            yield f"{name}: {first:.4g} and {last:.4g} N in the mean"
    for name in sorted(set(facts[0].mean_N) ^ set(facts[1].mean_N)):
        yield f"{name} {_lacks(pair[0 if name in facts[1].mean_N else 1], name)}"
    first_run, last_run = (w.table.window for w in pair)
    if pair[0].table.run_id == pair[1].table.run_id and (
        first_run.from_s < last_run.to_s and last_run.from_s < first_run.to_s
    ):
        yield "the two windows overlap: what they share does not count twice"
    if _is_later(*pair):
        yield "the window before is later than the one after: were they swapped?"


def _lacks(window: Window, name: str) -> str:
    """Return why a window has no mean of a tension that the other one has."""
    if name not in window.table.columns:
        return "is recorded in one of them only"
    if window.readings(name) is None:
        return "is recorded in both, but in one of them too few of its readings are numbers"
    return "is a measured tension in the site file of one of them only"


def _is_later(one: Window, other: Window) -> bool:
    """Return whether a window begins after the end of the other, or is of a later run."""
    first, last = one.table.window.folder.resolve(), other.table.window.folder.resolve()
    if first == last:
        return float(one.table.columns["time_s"][0]) > float(other.table.columns["time_s"][-1])
    return _start_s(one) > _start_s(other)  # a folder ends where the next begins


def _start_s(window: Window) -> float:
    """Return when a run's folder was begun, s of wall time; NaN where it does not say."""
    try:
        start = datetime.fromisoformat(text_or(window.table.about.get("start_utc")))
    except ValueError:
        return math.nan
    return (start if start.tzinfo else start.replace(tzinfo=UTC)).timestamp()


def _apart(first: float, last: float) -> float:
    """Return the difference of two numbers as a share of the larger one."""
    return abs(first - last) / max(abs(first), abs(last), 1e-12)
