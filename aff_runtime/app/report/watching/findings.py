"""What a store says of each roller and order: its trend, a jump, and when it reaches a limit."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from datetime import datetime

import numpy as np
from numpy.typing import NDArray

from aff_runtime.app.report.comparison.comparing import LIKE_SPEED
from aff_runtime.app.report.parquet import Columns
from aff_runtime.app.report.watching.store import Store
from aff_runtime.app.report.watching.trend import Array, Jump, Slope, at_least_small, jump, slope

DAY = np.timedelta64(86_400_000_000, "us")
PLACE_DIGITS = 3
"""Decimals of a speed, m/s or rad/s, that readings may gather around."""
Limits = Mapping[tuple[str, str], float]
"""Largest size of a roller's orders by (roller, SI unit)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Quantity:
    """A column of the store's table ``orders`` (``OrderRow``) that is followed over weeks.

    Attributes
    ----------
    name, error : of the columns. ``unit`` : SI.
    correcting : only hours with a correction count, or only those without; None: all.
    word : what it is called in a sentence. ``of_roller`` : the roller's own, not the drive's.
    alike : column in which hours that count are alike within ``LIKE_SPEED``. ``alike_too`` :
        another one, in which they have to be alike as well; empty: none.
    frequency_Hz : at which it is read; NaN where it is none of a frequency.
    """

    name: str
    error: str
    unit: str
    word: str
    correcting: bool | None = None
    of_roller: bool = True
    alike: str = "speed_m_s"
    alike_too: str = ""
    frequency_Hz: float = math.nan


QUANTITIES = (
    Quantity(name="shape_m", error="shape_error_m", unit="m", word="shape"),
    Quantity(name="stroke_m", error="stroke_error_m", unit="m", word="stroke", correcting=True),
    Quantity(name="ripple_N", error="ripple_error_N", unit="N", word="ripple", correcting=False),
    Quantity(
        name="response_ratio",
        error="response_ratio_error",
        unit="",
        word="response ratio",
        correcting=True,
        of_roller=False,
    ),
)

FRICTION = Quantity(
    name="friction_N_m",
    error="friction_error_N_m",
    unit="N m",
    word="friction",
    of_roller=False,
    alike="speed_rad_s",
)
"""Of the table ``drives``: at a like speed of the roll, so that its radius is alike too."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Readings:
    """One quantity of one order in the present life of a roller, one reading per run and day.

    Attributes
    ----------
    order : 0 of what is the roll's as a whole.
    life : the present one. ``at_m_s`` : line speed of the readings.
    limit : in the quantity's unit, NaN without one.
    times, days, travelled_km, size, error : (readings,): UTC, days since the first, web that had
        run, the quantity and its standard error in its unit.
    left_out : hours at another speed.
    """

    signal: str
    roll: str
    order: int
    life: int
    quantity: Quantity
    at_m_s: float
    limit: float
    times: NDArray[np.datetime64]
    days: Array
    travelled_km: Array
    size: Array
    error: Array
    left_out: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """What the readings say.

    Attributes
    ----------
    per_km, per_day : lines through them; None of too few.
    jump : a step that no growth explains: perhaps an exchange that nobody reported.
    weeks : from the last reading until the limit, with its interval; None where the slope does
        not stand out, leads away from the limit, or there is none.
    """

    readings: Readings
    per_km: Slope | None
    per_day: Slope | None
    jump: Jump | None
    weeks: tuple[float, float, float] | None

    @property
    def stands_out(self) -> bool:
        """Return whether there is a trend beyond 4 sigma, by web and by day, and no jump."""
        lines = (self.per_km, self.per_day)
        return self.jump is None and all(line is not None and line.stands_out for line in lines)


def findings(
    store: Store, limits: Limits | None = None, *, now: datetime | None = None
) -> list[Finding]:
    """Return what the store says of every roller and drive.

    Rolls of web have no life and are left out, not so the friction of their drives.

    Parameters
    ----------
    limits : sizes by roller and SI unit; else what the site file lets the law use.
    now : UTC; an exchange of a later day has not been. None: every exchange was.

    Raises
    ------
    ConfigError
        A limit is of a roller that the store, which knows some, does not follow.
    """
    limits = limits or {}
    if store.orders["roll"].size:
        for roll, _ in limits:
            store.check_roller(roll)
    found = [_finding(one) for one in _all_readings(store, limits, now)]
    found += [_finding(one) for one in _drives(store, now)]
    return found + [_finding(one) for one in _responses(store, now)]


@dataclass(frozen=True, slots=True, kw_only=True)
class Unread:
    """A roller, or a place of wound rolls, of which nothing was ever told in its present life.

    Attributes
    ----------
    turns : of the stretch with the most. ``turn_s`` : one turn in it, NaN where not known.
    """

    roll: str
    turns: int
    turn_s: float


def unread(store: Store, *, now: datetime | None = None) -> list[Unread]:
    """Return what turned too little in every stretch; of a wound roll the newest one counts."""
    orders, found = store.orders, []
    for roll in sorted(set(orders["roll"])):
        mine = orders["roll"] == roll
        if orders["is_roll"][mine][-1]:
            mine &= orders["roll_id"] == orders["roll_id"][mine][-1]
        else:
            mine &= orders["life"] == store.present_life(roll, now)
        sizes = [orders[one.name][mine] for one in QUANTITIES]
        if not mine.any() or np.isfinite(sizes).any():
            continue
        most = np.flatnonzero(mine)[int(np.argmax(orders["turns"][mine]))]
        rate_Hz = float(orders["frequency_Hz"][most]) / int(orders["order"][most])
        turn_s = 1.0 / rate_Hz if rate_Hz > 0.0 else math.nan
        found.append(Unread(roll=roll, turns=int(orders["turns"][most]), turn_s=turn_s))
    return found


def _finding(readings: Readings) -> Finding:
    per_km = slope(readings.travelled_km, readings.size, readings.error)
    per_day = slope(readings.days, readings.size, readings.error)
    stands_out = all(line is not None and line.stands_out for line in (per_km, per_day))
    finding = Finding(
        readings=readings,
        per_km=per_km,
        per_day=per_day,
        jump=jump(readings.days, readings.size, readings.error),
        weeks=None,
    )
    if not stands_out or finding.jump is not None or per_day is None:
        return finding
    return Finding(
        readings=readings,
        per_km=per_km,
        per_day=per_day,
        jump=None,
        weeks=_weeks(per_day, readings.limit, float(readings.days[-1])),
    )


def _weeks(line: Slope, limit: float, today: float) -> tuple[float, float, float] | None:
    if not math.isfinite(limit) or (limit - line.at(today)) * line.value <= 0.0:
        return None
    value, low, high = line.reaches(limit)
    return (value - today) / 7.0, max(0.0, (low - today) / 7.0), (high - today) / 7.0


def _all_readings(store: Store, limits: Limits, now: datetime | None) -> Iterator[Readings]:
    orders = store.orders
    rollers = ~orders["is_roll"]
    keys = sorted(
        set(
            zip(
                orders["roll"][rollers],
                orders["order"][rollers].tolist(),
                orders["signal"][rollers],
                strict=True,
            )
        )
    )
    for roll, order, signal in keys:
        mine = (orders["roll"] == roll) & (orders["order"] == order)
        mine &= orders["signal"] == signal
        life = store.present_life(roll, now)
        mine &= orders["life"] == life
        part = {name: values[mine] for name, values in orders.items()}
        for quantity in QUANTITIES:
            at, limit = (signal, roll, order, life), limits.get((roll, quantity.unit))
            found = _readings(part, quantity, at, limit)
            if found is not None:
                yield found


def _drives(store: Store, now: datetime | None) -> Iterator[Readings]:
    drives = store.drives
    for roll, signal in sorted(set(zip(drives["roll"], drives["signal"], strict=True))):
        life = store.present_life(roll, now)
        mine = (drives["roll"] == roll) & (drives["signal"] == signal) & (drives["life"] == life)
        part = {name: values[mine] for name, values in drives.items()}
        found = _readings(part, FRICTION, (signal, roll, 0, life), None)
        if found is not None:
            yield found


def _responses(store: Store, now: datetime | None) -> Iterator[Readings]:
    """Yield gain and phase of each actuator at each fixed frequency, as measured by probes."""
    rows = store.responses
    names = ("actuator", "signal", "gain_unit", "frequency_Hz", "roll")
    for key in sorted(set(zip(*(rows[name].tolist() for name in names), strict=True))):
        mine = np.all([rows[n] == k for n, k in zip(names, key, strict=True)], axis=0)
        actuator, signal, gain_unit, at_Hz, roll = key
        life = store.present_life(roll, now)
        mine &= rows["life"] == life
        part = {name: values[mine] for name, values in rows.items()}
        if not part["phase_rad"].size:
            continue
        # a phase is known within a turn: near the last one, so that it does not leap
        last = part["phase_rad"][-1]
        off = part["phase_rad"] - last
        part["phase_rad"] = last + off - math.tau * np.round(off / math.tau)
        for quantity in _of_a_response(at_Hz, gain_unit):
            found = _readings(part, quantity, (signal, actuator, 0, life), math.nan)
            if found is not None:
                yield found


def _of_a_response(at_Hz: float, gain_unit: str) -> tuple[Quantity, Quantity]:
    """Return gain and phase at a frequency: at like speed and radius, by which they differ."""
    gain = Quantity(
        name="gain",
        error="gain_error",
        unit=gain_unit,
        word=f"gain at {at_Hz:g} Hz",
        of_roller=False,
        alike_too="radius_m",
        frequency_Hz=at_Hz,
    )
    word = f"phase at {at_Hz:g} Hz"
    phase = replace(gain, name="phase_rad", error="phase_error_rad", unit="rad", word=word)
    return gain, phase


def _readings(
    part: Columns, quantity: Quantity, at: tuple[str, str, int, int], limit: float | None
) -> Readings | None:
    """Return one quantity of one order at like speed, None where it never was read."""
    needed: tuple[str, ...] = (
        quantity.name,
        quantity.error,
        quantity.alike,
        "speed_m_s",
        "travelled_km",
    )
    needed += (quantity.alike_too,) if quantity.alike_too else ()
    known = np.all([np.isfinite(part[name]) for name in needed], axis=0)
    if quantity.correcting is not None:
        known &= part["correcting"] == quantity.correcting
    speed = part["speed_m_s"][known]
    if not speed.size:
        return None
    like = _like(part[quantity.alike][known])
    if quantity.alike_too:
        like[like] = _like(part[quantity.alike_too][known][like])
    chosen = {name: values[known][like] for name, values in part.items()}
    groups = _by_run_and_day(chosen)
    weight = 1.0 / at_least_small(chosen[quantity.error], chosen[quantity.name]) ** 2
    means = {
        name: np.array([np.average(values[g], weights=weight[g]) for g in groups])
        for name, values in {
            "days": (chosen["time_utc"] - chosen["time_utc"][0]) / DAY,
            "km": chosen["travelled_km"],
            "size": chosen[quantity.name],
        }.items()
    }
    if limit is None:
        limit = chosen["limit_m"][-1] if quantity.unit == "m" else math.nan
    return Readings(
        signal=at[0],
        roll=at[1],
        order=at[2],
        life=at[3],
        quantity=quantity,
        at_m_s=float(np.median(speed[like])),
        limit=float(limit),
        times=np.array([chosen["time_utc"][g[-1]] for g in groups]),
        days=means["days"],
        travelled_km=means["km"],
        size=means["size"],
        error=np.array([1.0 / math.sqrt(float(weight[g].sum())) for g in groups]),
        left_out=int(np.sum(~like)),
    )


def _like(speed: Array) -> NDArray[np.bool_]:
    """Return the readings within half of ``LIKE_SPEED`` of one speed: of that with the most."""
    places = np.unique(np.round(speed, PLACE_DIGITS))
    rounded = 0.5 * 10.0**-PLACE_DIGITS
    near = [
        np.abs(speed - place) <= max(0.5 * LIKE_SPEED * abs(place), rounded) for place in places
    ]
    return max(near, key=np.count_nonzero)


def _by_run_and_day(chosen: Columns) -> list[NDArray[np.intp]]:
    """Return the rows of each run and day: what differs between days is shared within one."""
    days = chosen["time_utc"].astype("datetime64[D]").astype(np.int64)
    keys: dict[tuple[str, int], list[int]] = {}
    for index, key in enumerate(zip(chosen["run_id"], days.tolist(), strict=True)):
        keys.setdefault(key, []).append(index)
    return [np.array(rows, dtype=np.intp) for rows in keys.values()]
