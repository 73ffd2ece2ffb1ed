"""What a screen is shown of a line over weeks, as frozen records.

Their names and order are those of the JSON that passes through ``commission.sock``. Times are
Unix seconds; sizes are in ``unit``: um, N, or none for a ratio.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple


@dataclass(frozen=True, slots=True, kw_only=True)
class LifeRow:
    """One life of a roller; ``since_s`` and ``until_s`` None: before the store, or to now."""

    roll: str
    number: int
    since_s: float | None
    until_s: float | None
    why: str
    web_km: float
    running_h: float
    turns: float | None


class Reading(NamedTuple):
    """One reading of a trend; a row of numbers in JSON."""

    at_s: float
    size: float
    error: float


@dataclass(frozen=True, slots=True, kw_only=True)
class SlopeRow:
    """A slope per 1000 km of web, with its 95 % interval."""

    value: float
    low: float
    high: float


@dataclass(frozen=True, slots=True, kw_only=True)
class FitRow:
    """A straight fit through readings, at the first and at the last of them."""

    from_size: float
    to_size: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ReachedRow:
    """When a limit is reached: the day, and its 95 % interval; ``late_s`` None: without end."""

    at_s: float
    early_s: float
    late_s: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class TrendRow:
    """One quantity of one order in the present life of a roller, or of its drive.

    Attributes
    ----------
    order : 0 of what is the roll's as a whole.
    quantity : its name for people. ``limit`` : None where nobody gave one.
    speed_m_s : at which the hours are comparable. ``left_out`` : hours at another speed.
    stands_out : the slope differs from 0 by 4 sigma, over web and over days.
    line : straight fit over days. ``jump_s`` : when it jumped, None where it did not.
    """

    roll: str
    order: int
    signal: str
    quantity: str
    unit: str
    life: int
    count: int
    left_out: int
    speed_m_s: float
    now: float
    limit: float | None
    stands_out: bool
    per_1000_km: SlopeRow | None
    line: FitRow | None
    reached: ReachedRow | None
    jump_s: float | None
    readings: tuple[Reading, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class WorstRow:
    """The order with the largest amplitude of a roll of web, with its standard error."""

    order: int
    size: float
    error: float
    unit: str


@dataclass(frozen=True, slots=True, kw_only=True)
class WoundRow:
    """One roll of web; what was never read is None. ``left`` : ripple while corrected."""

    roll_id: int
    first_s: float
    last_s: float
    hours: int
    shape: WorstRow | None
    stroke: WorstRow | None
    ripple: WorstRow | None
    left: WorstRow | None


@dataclass(frozen=True, slots=True, kw_only=True)
class RankingRow:
    """Rolls of one place, the farthest from round first; ``by`` : quantity they are ranked by."""

    roll: str
    by: str
    rolls: tuple[WoundRow, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class MedianRow:
    """The median of an order over a supplier's rolls; its 95 % interval None of too few."""

    order: int
    size: float
    low: float | None
    high: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class SupplierRow:
    """The rolls of one supplier; ``number`` is the PLC's, ``rolls`` how many ran.

    ``worst_roll``, ``worst`` : its roll that is the farthest from round; None where none was read.
    """

    number: int
    rolls: int
    medians: tuple[MedianRow, ...]
    worst_roll: int | None
    worst: WorstRow | None


@dataclass(frozen=True, slots=True, kw_only=True)
class SupplierRankingRow:
    """Suppliers at one place, those first whose rolls are the farthest from round.

    Attributes
    ----------
    by : quantity that they are ranked by, in ``unit``. ``orders`` : that have medians.
    unknown : rolls without a supplier's number; where there are no others none is known.
    """

    roll: str
    by: str
    unit: str
    orders: tuple[int, ...]
    suppliers: tuple[SupplierRow, ...]
    unknown: int


@dataclass(frozen=True, slots=True, kw_only=True)
class MaintenanceView:
    """A line over weeks.

    Attributes
    ----------
    store : its folder. ``nothing`` : why there is none, or nothing in it; else empty.
    line : name of the production line.
    hours : of record in the store, from ``from_s`` to ``to_s``; ``web_km`` passed in them.
    notes : what to know first, a sentence each. ``without_a_line`` : of which roller, or roll of
        web that is on, there is no line, and why.
    """

    store: str
    nothing: str = ""
    line: str = ""
    hours: int = 0
    from_s: float | None = None
    to_s: float | None = None
    web_km: float = 0.0
    notes: tuple[str, ...] = ()
    lives: tuple[LifeRow, ...] = ()
    trends: tuple[TrendRow, ...] = ()
    without_a_line: tuple[str, ...] = ()
    rankings: tuple[RankingRow, ...] = ()
    suppliers: tuple[SupplierRankingRow, ...] = ()
