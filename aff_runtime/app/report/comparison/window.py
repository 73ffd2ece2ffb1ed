"""One window of a run with its own site file: readings, angles, and what may not be compared."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from aff_runtime.app.report.comparison.early_wraps import counts_that_wrap_early
from aff_runtime.app.report.comparison.lacking import (
    NUMBERS_SHARE,
    lacking_readings,
    share_of_numbers,
)
from aff_runtime.app.report.comparison.turns import Array, Flags
from aff_runtime.base.printable import printable, text_or
from aff_runtime.base.probe_columns import EXCITING, STAGE
from aff_runtime.base.runs.counted_angle import Numbers, counted_angle, modulus_rad
from aff_runtime.base.runs.files import yaml_values
from aff_runtime.base.runs.holes import cycle_s_of, holes_between
from aff_runtime.base.runs.join import PERIODS, SAME_CYCLE_SHARE
from aff_runtime.base.runs.roll_changes import roll_changes
from aff_runtime.base.runs.site_in_force import change_words
from aff_runtime.base.runs.table import RunTable, few, other_line, read_table
from aff_runtime.base.runs.window import RunWindow
from aff_runtime.base.signals import Outcome, State, StateBits, Status
from aff_runtime.base.units import UnitError, read_number
from aff_runtime.base.yaml_section import Section

DEFAULT_SPEED_CHANNEL = "line_speed_m_s"
"""Channel of the line speed where the site file names none."""
ROLL_ID = "roll_id"
"""Column: the PLC's counter of splices."""
SPEED_CHANGES_SHARE = 0.02
"""Range of the line speed (1 to 99 %) over its largest, above which a window is labelled."""
LARGEST_WORD = 2.0**32
"""Of a status word, whose bits are 32 at most: a spoiled file may hold any number."""
FEWEST_READINGS = 2
"""Rows of a window, without which there is no step of time and no figure."""
MIXED_SHARE = 0.02
"""Share of the rows by which corrections that were switched in a window make it a mixture."""
END_READINGS = 200
"""Readings at either end of a window, the mean of which is the radius there: 1 s at 5 ms, in which
the noise of the mean falls to a fourteenth and a roll of 0.1 mm paper at 1 m/s loses 0.1 mm."""
HIGHEST_ORDER = 64
"""A spoiled site file may hold any: at 5 ms this one shows on a turn of 2.6 s and longer."""
MOST_PARTS = 200
"""Parts of an angle that are looked at: each costs time, and the shortest hold no turn."""
RISE_RAD = 1e-12
"""Added per reading to an angle made from speeds, so that it rises at standstill as well."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Window:
    """The rows of a window that show readings, and what its site file says of them.

    Attributes
    ----------
    table : all rows.
    site : contents of the site file in force where it begins; empty where it cannot be read.
    rows : which rows show new readings.
    time_s : of these.
    good : per such row, whether the readings go on from the row before without a hole.
    labels : sentences: why figures of this window may not be what they seem.
    """

    table: RunTable
    site: Section
    rows: Flags
    time_s: Array
    good: Flags
    labels: list[str] = field(default_factory=list)

    def readings(self, name: str) -> Array | None:
        """Return a channel (rows that show readings,).

        None where it is not recorded, or ``NUMBERS_SHARE`` or less of its readings are numbers.
        """
        if not self.share_of_numbers(name) > NUMBERS_SHARE:
            return None
        return self.table.columns[name][self.rows]

    def share_of_numbers(self, name: str) -> float:
        """Return the share of a channel's readings that are numbers; NaN where there are none."""
        values = self.table.columns.get(name)
        if values is None or not self.rows.any():
            return math.nan
        return share_of_numbers(values[self.rows])

    @property
    def sites(self) -> list[Section]:
        """Contents of every site file that was in force in it, in order."""
        return [self.site, *(_site(one.text) for one in self.table.sites[1:])]

    @property
    def last_site_text(self) -> str:
        """Text of the site file in force where it ends."""
        sites = self.table.sites
        return sites[-1].text if sites else self.table.site_text

    def section(self, name: str) -> Section:
        """Return a section of the site file, empty where it is none."""
        return self.site.section(name)

    @property
    def line(self) -> str:
        """Name of the line."""
        return printable(
            text_or(self.section("line").get("name")) or text_or(self.table.about.get("name"))
        )

    @property
    def speed(self) -> Array | None:
        """Line speed, m/s."""
        return self.readings(speed_channel(self.site))

    def in_state(self, state: State) -> float:
        """Return the share of all rows in this state."""
        return float(np.mean(_of(self.table.columns, "state", math.nan) == state))


def load_window(window: RunWindow) -> Window:
    """Return a window of a run; what is odd about it becomes labels, nothing is refused for it.

    Raises
    ------
    AffError
        The folder is no run, or holds no rows there.
    """
    # columns of one order or one block have a dot in their names: many, and nothing here asks them
    loaded = window_of(read_table(window, keep=lambda name: "." not in name or name == STAGE))
    loaded.labels.extend([*loaded.table.lost, *_odd(loaded)])
    return loaded


def window_of(table: RunTable) -> Window:
    """Return rows of a run with their site file; without labels."""
    columns = table.columns
    shows = (_of(columns, "outcome", Outcome.OK) == Outcome.OK) & (_of(columns, "fresh", 1.0) > 0)
    time_s = columns["time_s"][shows]
    return Window(
        table=table,
        site=_site(table.site_text),
        rows=shows,
        time_s=time_s,
        good=_goes_on(columns, shows, time_s),
    )


def speed_channel(site: Section) -> str:
    """Return the name of the channel with the line speed."""
    return text_or(site.section("line").get("speed"), DEFAULT_SPEED_CHANNEL)


def number(value: object, unit: str) -> float:
    """Return a number of a site file in ``unit``, NaN where it is none."""
    try:
        return read_number(value, unit) if value is not None else math.nan
    except UnitError:
        return math.nan


def _of(columns: Mapping[str, Array], name: str, absent: float) -> Array:
    values = columns.get(name)
    return np.full(columns["time_s"].shape, float(absent)) if values is None else values


def _site(text: str) -> Section:
    try:
        return Section.of(yaml_values(text))
    except ValueError:
        return Section()


def _goes_on(columns: Mapping[str, Array], shows: Flags, time_s: Array) -> Flags:
    """Return per reading whether no hole, splice or other roll lies between it and the last."""
    good = np.ones(time_s.shape, dtype=np.bool_)
    if time_s.size < 2:
        return good
    good[1:] = ~holes_between(time_s, cycle_s_of(time_s))
    good &= ~roll_changes(_of(columns, ROLL_ID, 0.0)[shows])
    good &= (_bits(columns, "status", shows) & int(Status.SPLICE_ACTIVE)) == 0
    return good


def _bits(columns: Mapping[str, Array], name: str, shows: Flags) -> Any:
    words = np.nan_to_num(_of(columns, name, 0.0)[shows])
    return np.clip(words, 0.0, LARGEST_WORD).astype(np.int64)


def _odd(window: Window) -> list[str]:
    """Return sentences about what happened in the window."""
    columns, said = window.table.columns, []
    if not window.site:
        said.append("its site file cannot be read: rolls and orders are not known")
    if other := other_line(window.table.about, text_or(window.section("line").get("name"))):
        said.append(other)
    said += _other_cycle(window)
    channels = window.section("gateway").section("read").section("channels")
    mapped = [str(name) for name, _ in channels.items()]
    missing = [name for name in mapped if name not in columns]
    if missing:
        named = printable(", ".join(missing), 200)
        said.append(
            f"its site.yaml maps {named}, the run has no such column: is it of another run?"
        )
    said += said_of_readings(window)
    if window.share_of_numbers(ROLL_ID) < 1.0:
        said.append("roll_id is no number in some of its rows: another roll is not told there")
    if window.time_s.size < FEWEST_READINGS:
        said.append(f"{window.time_s.size} rows show readings: nothing can be told")
    if np.any(np.diff(columns["time_s"]) <= 0.0):
        said.append("its clock goes back: turns across that are left out")
    stage = columns.get(STAGE)
    if stage is not None and np.any(stage == EXCITING):
        share = float(np.mean(stage == EXCITING))
        said.append(f"the probe's excitation goes out in {100 * share:.0f} % of it")
    if np.any(_bits(columns, "status", window.rows) & int(Status.SPLICE_ACTIVE)):
        said.append("a splice is in it")
    saturated = _bits(columns, "state_bits", window.rows) & int(StateBits.SATURATED)
    if np.any(saturated):
        share = float(np.mean(saturated != 0))
        said.append(f"AFF was at a limit in {100 * share:.1f} % of it")
    going = float(np.mean(any_correction(columns)))
    if MIXED_SHARE < going < 1.0 - MIXED_SHARE:
        said.append(
            f"corrections went out in {100 * going:.0f} % of it: its figures are a mixture"
        )
    speed = window.speed
    if speed is not None and _spread(speed) > SPEED_CHANGES_SHARE:
        said.append(
            f"its line speed changes by {100 * _spread(speed):.0f} %: a mean of different ripple"
        )
    changes = window.table.site_changes
    return said + few(
        [f"{change_words(r)} at {r.get('time_s')} s: {r.get('text')}" for r in changes]
    )


def said_of_readings(window: Window) -> list[str]:
    """Return sentences about readings that lack, and about counts that start over early."""
    channels = window.section("gateway").section("read").section("channels")
    readings = {
        str(name): window.table.columns[str(name)][window.rows]
        for name, _ in channels.items()
        if str(name) in window.table.columns
    }
    early_wraps = counts_that_wrap_early(window.time_s, readings, channels)
    return [*lacking_readings(window.time_s, readings), *few([*early_wraps])]


def _other_cycle(window: Window) -> list[str]:
    """Return a sentence where rows come at another cycle than the site file's."""
    columns = window.table.columns
    cycle_s = number(window.section("line").get("cycle_ms"), "ms") * 1e-3
    elapsed_s, periods = np.diff(columns["time_s"]), _of(columns, PERIODS, 1.0)[1:]
    usable = (elapsed_s > 0.0) & (periods > 0.0)
    if not cycle_s > 0.0 or not usable.any():
        return []
    tick_s = float(np.median(elapsed_s[usable] / periods[usable]))
    if abs(tick_s / cycle_s - 1.0) <= SAME_CYCLE_SHARE:
        return []
    return [
        f"a tick takes {1e3 * tick_s:.4g} ms, its site.yaml says {1e3 * cycle_s:.4g} ms: is it of "
        "another run?"
    ]


def _spread(values: Array) -> float:
    low, high = np.nanpercentile(values, (1.0, 99.0))
    return float((high - low) / max(abs(high), abs(low), 1e-12))


def any_correction(columns: Mapping[str, Array]) -> Flags:
    """Return per row whether any correction is another number than zero."""
    found = np.zeros(columns["time_s"].shape, dtype=np.bool_)
    for name, values in columns.items():
        if name.startswith("correction_"):
            found |= np.nan_to_num(values) != 0.0
    return found


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RollAngle:
    """The angle of a roll over the readings of a window.

    Attributes
    ----------
    angle_rad : rising.
    encoder : it was counted; else it is made from speeds, and its zero drifts.
    good : readings between which it can be followed.
    radius_m : at the start and end of the window.
    part : (readings,) number of the part: between the readings of one part no turn is lost.
    """

    angle_rad: Array
    encoder: bool
    good: Flags
    radius_m: tuple[float, float]
    part: Numbers

    def parts(self) -> list[slice]:
        """Return the readings of each part, of the longest ``MOST_PARTS`` parts alone."""
        starts = np.flatnonzero(np.diff(self.part, prepend=self.part[:1] - 1))
        ends = np.append(starts[1:], self.part.size)
        longest = np.argsort(starts - ends, kind="stable")[:MOST_PARTS]
        return [slice(int(starts[k]), int(ends[k])) for k in np.sort(longest)]

    def rate_Hz(self, time_s: Array) -> float:
        """Return turns per second where the angle is followed: over a hole nobody counted them."""
        steps_s = np.diff(time_s)
        followed = self.good[1:] & (steps_s > 0.0)
        seconds = float(np.sum(steps_s[followed]))
        return float(np.sum(np.diff(self.angle_rad)[followed])) / math.tau / max(seconds, 1e-9)


def roll_angle(window: Window, given: Section) -> RollAngle | None:
    """Return the angle of a roll as its section of the site file says, None without a source."""
    radius = _radius(window, given)
    ends = (_mean(radius[:END_READINGS]), _mean(radius[-END_READINGS:]))
    name = text_or(given.get("angle"))
    counted = window.readings(name)
    if counted is not None:
        return _counted(window, name, counted, ends)
    speed = window.readings(text_or(given.get("speed")))
    if speed is not None and text_or(given.get("speed")).endswith("_m_s"):
        speed = speed / radius
    if speed is None:
        along_m_s = window.readings(text_or(given.get("line_speed"))) if given else None
        along_m_s = window.speed if along_m_s is None else along_m_s
        speed = None if along_m_s is None else along_m_s / radius
    if speed is None or not np.isfinite(ends[0]):
        return None
    speed_rad_s = without_gaps(window.time_s, np.abs(speed))
    steps_s = np.diff(window.time_s, prepend=window.time_s[0])
    angle = np.cumsum(speed_rad_s * np.clip(steps_s, 0.0, None))
    angle += RISE_RAD * np.arange(angle.size)
    return RollAngle(
        angle_rad=angle,
        encoder=False,
        good=window.good,
        radius_m=ends,
        part=np.zeros(angle.shape, dtype=np.int64),
    )


def without_gaps(time_s: Array, values: Array) -> Array:
    """Return a series (rows,) in which what is no number lies on a line between its neighbours.

    0 throughout where nothing is a number.
    """
    known = np.isfinite(values) & np.isfinite(time_s)
    if not known.any():
        return np.zeros(values.shape)
    return np.where(known, values, np.interp(time_s, time_s[known], values[known]))


def _mean(values: Array) -> float:
    """Return the mean of what is a number, NaN where nothing is."""
    finite = values[np.isfinite(values)]
    return float(finite.mean()) if finite.size else math.nan


def _radius(window: Window, given: Section) -> Array:
    measured = window.readings(text_or(given.get("radius")))
    if measured is not None:
        return measured
    return np.full(window.time_s.shape, number(given.get("radius_m"), "m"))


def _counted(window: Window, name: str, values: Array, radius_m: tuple[float, float]) -> RollAngle:
    """Return a counted angle, unfolded as its channel in the site file says."""
    channel = window.section("gateway").section("read").section("channels").section(name)
    found = counted_angle(window.time_s, values, modulus_rad(channel))
    return RollAngle(
        angle_rad=found.angle_rad,
        encoder=True,
        good=window.good & found.good,
        radius_m=radius_m,
        part=found.part,
    )


def orders_of(site: Section, roll: str) -> Sequence[int]:
    """Return the orders that any block of a site file has for ``roll``, 1 at least."""
    orders = {1}
    for actuator in site.section("actuators").sections():
        for block in _listed(actuator.get("blocks")):
            if isinstance(block, dict) and block.get("roll") == roll:
                orders |= {n for n in _listed(block.get("orders")) if isinstance(n, int) and n > 0}
    return sorted(n for n in orders if n <= HIGHEST_ORDER)


def _listed(given: object) -> list[Any]:
    return given if isinstance(given, list) else []
