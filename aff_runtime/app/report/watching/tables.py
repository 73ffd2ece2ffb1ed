"""The tables of a store: one class per row, every column with its unit."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from aff_runtime.app.report.parquet import ABSENT, UNIT, fields_of


def _number(unit: str) -> Any:
    """Return a number in ``unit``, NaN where it is not known."""
    return field(default=math.nan, metadata={UNIT: unit})


@dataclass(frozen=True, slots=True, kw_only=True)
class HourRow:
    """One hour of a run's clock: when, how much web ran, how the ticks were.

    Attributes
    ----------
    covered_s : how much of the hour is recorded. ``stretch_s`` : length of its steady stretch.
    length_m : all web of the hour. ``offset_m`` : what ran of it until the middle of the stretch.
    travelled_km : all web in the store until there.
    missed_count : ticks that never happened in the stretch.
    lacks : why nothing was measured; empty where it was.
    """

    run_id: str
    hour: int
    time_utc: np.datetime64
    run: str
    config_hash: str
    covered_s: float = _number("s")
    length_m: float = _number("m")
    offset_m: float = _number("m")
    travelled_km: float = _number("km")
    stretch_s: float = _number("s")
    speed_m_s: float = _number("m/s")
    correcting: bool = False
    missed_count: float = _number("1")
    wake_p99_us: float = _number("us")
    io_p99_us: float = _number("us")
    tick_p50_us: float = _number("us")
    tick_p99_us: float = _number("us")
    tick_max_us: float = _number("us")
    lacks: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class OrderRow:
    """One order of one roll in one tension, in the stretch of one hour; NaN where not known.

    Attributes
    ----------
    is_roll : it is wound web, exchanged in operation, so that it has no life to follow.
    correcting : corrections went out. ``turns`` : that the ripple rests on; of fewer than
        ``FEWEST_TURNS`` nothing is told.
    floor_N : what noise alone exceeds once in 20 stretches. ``noise_N`` : of one reading.
    shape_m : deviation that law shape has learned. ``stroke_m`` : the plain law's correction as a
        length of web: its speed amplitude over its angular frequency.
    response_ratio : the true response over the measured one.
    limit_m : largest shape or stroke that the site file lets the law use.
    supplier : the PLC's number of the supplier of a roll of web; 0 where it gives none.
    """

    run_id: str
    hour: int
    time_utc: np.datetime64
    signal: str
    roll: str
    order: int
    is_roll: bool
    correcting: bool
    travelled_km: float = _number("km")
    life: int = 1
    roll_id: int = 0
    speed_m_s: float = _number("m/s")
    radius_m: float = _number("m")
    frequency_Hz: float = _number("Hz")
    turns: int = 0
    ripple_N: float = _number("N")
    ripple_error_N: float = _number("N")
    floor_N: float = _number("N")
    noise_N: float = _number("N")
    shape_m: float = _number("m")
    shape_error_m: float = _number("m")
    stroke_m: float = _number("m")
    stroke_error_m: float = _number("m")
    response_ratio: float = _number("1")
    response_ratio_error: float = _number("1")
    limit_m: float = _number("m")
    supplier: int = field(default=0, metadata={ABSENT: 0})


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveRow:
    """The drive of one roll in the stretch of one hour; NaN where not known.

    Attributes
    ----------
    signal : channel of its torque. ``is_roll``, ``correcting`` : as of an order.
    web_N_m : what the tensions beside the roll ask of the drive.
    friction_N_m : the torque less that: of all that turns as far as the cells of these tensions.
    """

    run_id: str
    hour: int
    time_utc: np.datetime64
    signal: str
    roll: str
    is_roll: bool
    correcting: bool
    travelled_km: float = _number("km")
    life: int = 1
    speed_m_s: float = _number("m/s")
    radius_m: float = _number("m")
    speed_rad_s: float = _number("rad/s")
    torque_N_m: float = _number("N m")
    web_N_m: float = _number("N m")
    friction_N_m: float = _number("N m")
    friction_error_N_m: float = _number("N m")


@dataclass(frozen=True, slots=True, kw_only=True)
class ResponseRow:
    """One response that a probe measured, at one fixed frequency.

    Attributes
    ----------
    hour : recorded hour of the run that is the nearest. ``time_utc`` : when it was measured.
    signal : that answers. ``roll`` : the first that the actuator works on.
    gain, gain_error : of the signal per unit of the correction, in ``gain_unit``; a standard
        error, as that of the phase. ``phase_rad`` : all delays included, within one turn.
    speed_m_s, radius_m : at which it was measured.
    """

    run_id: str
    hour: int
    time_utc: np.datetime64
    signal: str
    actuator: str
    roll: str
    is_roll: bool
    travelled_km: float = _number("km")
    life: int = 1
    frequency_Hz: float = _number("Hz")
    gain: float = _number("as gain_unit says")
    gain_error: float = _number("as gain_unit says")
    gain_unit: str = ""
    phase_rad: float = _number("rad")
    phase_error_rad: float = _number("rad")
    speed_m_s: float = _number("m/s")
    radius_m: float = _number("m")


@dataclass(frozen=True, slots=True, kw_only=True)
class ExchangeRow:
    """A roller that was exchanged, as a technician said; it begins a new life."""

    roll: str
    on_utc: np.datetime64
    why: str


HOUR_FIELDS, ORDER_FIELDS, DRIVE_FIELDS, RESPONSE_FIELDS, EXCHANGE_FIELDS = (
    fields_of(row) for row in (HourRow, OrderRow, DriveRow, ResponseRow, ExchangeRow)
)
