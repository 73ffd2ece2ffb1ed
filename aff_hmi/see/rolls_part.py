"""What the page of rolls shows: shapes in mm, orders in dB, why one rests, crossings."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol

from aff_hmi.commission.sentences import sentence
from aff_hmi.layout import label_of
from aff_hmi.notices import place_key, why_it_rests
from aff_hmi.view import GOES_OUT
from aff_hmi.watch import Observed
from aff_hmi.words import N_, Say
from aff_runtime.app.report.block_status import N_M_PER_MM, SHAPE, WORDS, at_encoder_zero_deg
from aff_runtime.app.report.line_facts import LineFacts, OutputFacts, RollFacts
from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.base.channel_units import unit_of_channel
from aff_runtime.base.printable import printable
from aff_runtime.core.order_status import OrderStatus

FEWEST_ORDERS = 3
STEP_DEG = 3
NEAR, FAR = 0.4, 1.25  # of the present radius: crossings between them are shown
MOST_CROSSINGS = 12
MOST_TEXTS = 8


@dataclass(frozen=True, slots=True, kw_only=True)
class OrderLine:
    """One order; numbers are None where they are not known.

    Attributes
    ----------
    size : in ``unit``. ``deg`` : angle of the order where the outline has its 0 deg.
    out_percent : share of its correction that reaches the drive.
    without, now : amplitude in the signal, in the unit of the roll's ``signal_unit``.
    change_dB : now against without. ``ratio`` : true response over the measured one.
    why : why it rests, empty while it does not. ``grows`` : its size, steadily.
    """

    name: str
    frequency_Hz: float | None
    size: float | None
    unit: str
    deg: float | None
    out_percent: float | None
    without: float | None
    now: float | None
    change_dB: float | None
    ratio: float | None
    state: str
    why: str
    grows: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class CrossingLine:
    """A radius of the roll at which one of its orders meets one of another roll."""

    radius_mm: float
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class RollPart:
    """One roll as one actuator follows it.

    Attributes
    ----------
    outline_mm : deviation of the moment arm every ``step_deg``, from 0 deg on; empty while no
        shape is known. ``scatter_mm`` : twice the standard deviation of it over the last turns;
        empty where it is not known. ``zero`` : where 0 deg is. ``extremes`` : the outline in
        words, in which ``{high}`` and ``{low}`` stand for ``high_mm`` and ``low_mm``.
    crossings : by radius, the largest first.
    """

    key: str
    actuator: str
    roll: str
    radius_mm: float | None
    signal_unit: str
    outline_mm: tuple[float, ...]
    scatter_mm: tuple[float, ...]
    step_deg: int
    zero: str
    extremes: str
    high_mm: float | None
    low_mm: float | None
    orders: tuple[OrderLine, ...]
    crossings: tuple[CrossingLine, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class RollsPart:
    """Everything that changes on the page.

    Attributes
    ----------
    texts : what became of kept shapes.
    roll_number, roll_since_s : the PLC's number of the roll that came last, and since when, wall
        time; None where none came while this screen looked on.
    """

    rolls: tuple[RollPart, ...]
    texts: tuple[str, ...]
    roll_number: float | None
    roll_since_s: float | None


class History(Protocol):
    """What was seen of the shapes before; a key is that of a `RollPart`."""

    @property
    def roll_since(self) -> tuple[float, float]:
        """Number of the roll that came last, and wall time since when; NaN for none."""

    def scatter_mm(self, key: str) -> tuple[float, ...]:
        """Twice the standard deviation of an outline, every ``STEP_DEG``; empty: not known."""

    def grows(self, actuator: str, order: str) -> bool:
        """Whether an order has grown steadily."""


def rolls_part(seen: Observed, say: Say, history: History | None = None) -> RollsPart:
    """Return the part of a frame that is of rolls; empty while no tick is seen.

    Parameters
    ----------
    history : what was seen of the shapes before; None tells nothing of it.
    """
    status = seen.facts.status if seen.facts is not None else None
    row, site = seen.row, seen.site
    if row is None or status is None or site is None:
        return RollsPart(rolls=(), texts=(), roll_number=None, roll_since_s=None)
    number, since_s = history.roll_since if history is not None else (math.nan, math.nan)
    return RollsPart(
        rolls=tuple(
            _roll(row, site, actuator, roll, orders, history, say)
            for (actuator, _), (roll, orders) in of_rolls(row, site).items()
        ),
        texts=tuple(printable(sentence(text, say), 200) for text in status.shapes[:MOST_TEXTS]),
        roll_number=_known(number, 0),
        roll_since_s=_known(since_s, 1),
    )


def _roll(
    row: TickRow,
    site: LineFacts,
    actuator: str,
    facts: RollFacts,
    orders: Sequence[OrderStatus],
    history: History | None,
    say: Say,
) -> RollPart:
    roll, key = facts.name, place_key(actuator, facts.name)
    output = next((one for one in site.outputs if one.actuator == actuator), None)
    degrees, has_zero = degrees_of(row, facts, orders)
    outline = outline_mm([(o, degrees[o.name]) for o in orders])
    encoder = say(N_("0° is where the encoder reads zero"))
    count = say(N_("0° is where the service began to count"))
    growing = {o.name for o in orders if history is not None and history.grows(actuator, o.name)}
    lines = [_order(row, roll, o, degrees[o.name], output, o.name in growing, say) for o in orders]
    lines.sort(key=lambda line: not line.why)
    return RollPart(
        key=key,
        actuator=label_of(actuator),
        roll=label_of(roll),
        radius_mm=_known(1e3 * _radius_m(row, facts), 1),
        signal_unit="mm/s"
        if output is not None and unit_of_channel(output.signal) == "m/s"
        else "N",
        outline_mm=_as_drawn(outline),
        scatter_mm=history.scatter_mm(key) if history is not None and outline else (),
        step_deg=STEP_DEG,
        zero=encoder if has_zero else count,
        extremes=_extremes(outline, say),
        high_mm=_known(max(outline, default=math.nan), 4),
        low_mm=_known(min(outline, default=math.nan), 4),
        orders=tuple(lines),
        crossings=tuple(_crossings(row, site, facts, orders, row.orders(), say)),
    )


def outline_mm(orders: Sequence[tuple[OrderStatus, float]]) -> list[float]:
    """Return the deviation of the moment arm every ``STEP_DEG``, mm.

    Parameters
    ----------
    orders : with their angle, deg; an imbalance is a torque and no part of the outline.
        Fewer than ``FEWEST_ORDERS`` in mm are no shape.
    """
    weights = weights_mm(orders)
    if len(weights) < FEWEST_ORDERS:
        return []
    return [
        sum((w * cmath.exp(1j * n * math.radians(at))).real for n, w in weights)
        for at in range(0, 360, STEP_DEG)
    ]


def weights_mm(orders: Sequence[tuple[OrderStatus, float]]) -> list[tuple[int, complex]]:
    """Return (order, complex amplitude in mm) of what is part of an outline, see `outline_mm`."""
    return [
        (o.order, cmath.rect(o.size, math.radians(deg)))
        for o, deg in orders
        if o.law == SHAPE and not o.is_imbalance and math.isfinite(o.size + deg)
    ]


def degrees_of(
    row: TickRow, roll: RollFacts, orders: Sequence[OrderStatus]
) -> tuple[dict[str, float], bool]:
    """Return the angle of each order, deg, and whether 0 deg is the encoder's zero."""
    of_zero = {o.name: at_encoder_zero_deg(row, roll.name, roll.angle_channel, o) for o in orders}
    has_zero = all(math.isfinite(deg) for deg in of_zero.values())
    return {o.name: of_zero[o.name] if has_zero else o.phase_deg for o in orders}, has_zero


def of_rolls(
    row: TickRow, site: LineFacts
) -> dict[tuple[str, str], tuple[RollFacts, list[OrderStatus]]]:
    """Return roll and orders by (actuator, name of the roll), in the order of the columns."""
    facts = {one.name: one for one in site.rolls}
    found: dict[tuple[str, str], tuple[RollFacts, list[OrderStatus]]] = {}
    for order in row.orders():
        name = _roll_of(order, site)
        place = (order.actuator, name)
        if place not in found:
            found[place] = (facts.get(name) or RollFacts(name=name), [])
        found[place][1].append(order)
    return found


def _as_drawn(outline: Sequence[float]) -> tuple[float, ...]:
    """Return an outline to a thousandth of its size: finer, no picture shows."""
    size = max(map(abs, outline), default=0.0)
    digits = min(6, max(2, 3 - math.floor(math.log10(size)))) if size > 0.0 else 2
    return tuple(round(mm, digits) for mm in outline)


def _extremes(outline: Sequence[float], say: Say) -> str:
    if not outline:
        return say(N_("no shape is known in mm: the law learns none, or was not armed yet"))
    high, low = max(outline), min(outline)
    words = say(N_("highest {high} at {high_deg}°, lowest {low} at {low_deg}°"))
    at = {"high_deg": STEP_DEG * outline.index(high), "low_deg": STEP_DEG * outline.index(low)}
    return words.format(high="{high}", low="{low}", **at)


def _order(
    row: TickRow,
    roll: str,
    order: OrderStatus,
    deg: float,
    output: OutputFacts | None,
    grows: bool,
    say: Say,
) -> OrderLine:
    is_speed = output is not None and unit_of_channel(output.signal) == "m/s"
    factor = 1e3 if is_speed else 1.0
    size, unit = order.size, order.size_unit
    if order.law == SHAPE and order.is_imbalance:
        size, unit = N_M_PER_MM * size, "N m"
    elif unit == "m/s":
        size, unit = 1e3 * size, "mm/s"
    share = 1.0 if math.isnan(order.share) else order.share
    # of what a law says it would be without, nothing is known while nothing goes out
    goes_out = row.state in GOES_OUT
    before, now = order.ripple_before if goes_out else math.nan, order.ripple
    is_both = before > 0.0 and now > 0.0
    why = why_it_rests(order)
    return OrderLine(
        name=say(N_("imbalance")) if order.is_imbalance else f"{order.order}×",
        frequency_Hz=_known(order.order * abs(row.roll(roll).omega_rad_s) / math.tau, 2),
        size=_known(size, 3),
        unit=unit,
        deg=_known(deg % 360.0, 0),
        out_percent=_known(100.0 * share * row.applied_ratio(order.actuator), 0),
        without=_known(factor * before, 3),
        now=_known(factor * now, 3),
        change_dB=_known(20.0 * math.log10(now / before), 1) if is_both else None,
        ratio=_known(order.response_ratio, 2),
        state="" if order.state is None else say(WORDS[order.state]),
        why=say(why) if why else "",
        grows=grows,
    )


def _crossings(
    row: TickRow,
    site: LineFacts,
    facts: RollFacts,
    orders: Sequence[OrderStatus],
    others: Sequence[OrderStatus],
    say: Say,
) -> Iterator[CrossingLine]:
    """Yield where orders of a roll whose radius moves meet those of a roll of fixed radius.

    Order n at radius R and order m at radius r have one frequency where n / R = m / r.
    """
    now_m = _radius_m(row, facts)
    if not facts.radius_channel or not now_m > 0.0:
        return
    fixed = {one.name: one.radius_m for one in site.rolls if one.radius_m is not None}
    meetings: dict[float, list[str]] = {}
    for order in orders:
        for other in others:
            name = _roll_of(other, site)
            if other.actuator != order.actuator or name == facts.name or name not in fixed:
                continue
            radius_m = order.order * fixed[name] / other.order if other.order else math.nan
            if NEAR * now_m <= radius_m <= FAR * now_m and order.order:
                meets = f"{order.order}× – {label_of(name)} {other.order}×"
                meetings.setdefault(round(1e3 * radius_m, 1), []).append(meets)
    near = sorted(meetings, key=lambda mm: abs(mm - 1e3 * now_m))[:MOST_CROSSINGS]
    for mm in sorted(near, reverse=True):
        yield CrossingLine(radius_mm=mm, text=", ".join(dict.fromkeys(meetings[mm])))


def _roll_of(order: OrderStatus, site: LineFacts) -> str:
    """Return the roll of an order; an imbalance is of the roll that its drive turns."""
    if not order.is_imbalance:
        return order.roll
    turned = {one.actuator: one.drive_roll for one in site.outputs}
    return turned.get(order.actuator, "")


def _radius_m(row: TickRow, facts: RollFacts) -> float:
    if facts.radius_channel:
        return row.number(facts.radius_channel)
    return math.nan if facts.radius_m is None else facts.radius_m


def _known(value: float, digits: int) -> float | None:
    """Return a number as it is shown: a page does not change for what nobody sees."""
    return round(value, digits) if math.isfinite(value) else None
