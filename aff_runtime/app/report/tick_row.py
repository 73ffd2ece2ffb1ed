"""One row per tick as objects.

Who works on whole columns takes their names from ``loop.record``.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from aff_runtime.base.signals import Outcome, State, StateBits, Status
from aff_runtime.core.order_status import OrderStatus, order_statuses
from aff_runtime.core.phase import Source
from aff_runtime.loop.record import HEAD, OF_OUTPUTS, TIMING

CORRECTION, APPLIED_RATIO = "correction_", "applied_ratio_"
_UNITS = ("m_s", "N_m")


@dataclass(frozen=True, slots=True, kw_only=True)
class Timing:
    """How a tick went; None stands for NaN, as JSON has none.

    Attributes
    ----------
    plc_age_s : time since the PLC's heartbeat last moved, s.
    io_us : how long the exchange with the PLC took, us.
    tick_us : from the start of the tick until its record was made, us.
    missed_count : ticks that never happened, since the control process began to tick.
    """

    plc_age_s: float | None
    io_us: float | None
    tick_us: float | None
    missed_count: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Channel:
    """One measured value; ``name`` ends with its unit. None stands for NaN."""

    name: str
    value: float | None

    def is_of(self, *kinds: str) -> bool:
        """Return whether the name ends as one of these kinds does, such as ``tension_N``."""
        return self.name.endswith(kinds)


@dataclass(frozen=True, slots=True, kw_only=True)
class CorrectionDue:
    """What the guard lets out to one drive; it is sent with the next tick.

    Attributes
    ----------
    name : ``correction_`` and the output with its unit.
    value : in that unit; None stands for NaN.
    applied_ratio : share of what the law wanted that the guard let out, 0 to 1, of the tick
        before; None stands for NaN.
    """

    name: str
    value: float | None
    applied_ratio: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class RollTurn:
    """How one roll turns, as the law follows it; NaN where it is not known.

    Attributes
    ----------
    omega_rad_s : angular speed, rad/s. ``theta_rad`` : angle, rad.
    source : where the angle is from; None where the law follows no such roll.
    """

    omega_rad_s: float
    theta_rad: float
    source: Source | None


@dataclass(frozen=True, slots=True)
class TickRow:
    """One row of the ring.

    Of an empty row (``TickRow({})``, before the first tick) every number is NaN, and nothing is
    fresh, measured or sent; ``state``, ``is_live``, ``alarm_code``,
    ``status_word`` and ``outcome`` raise.

    Attributes
    ----------
    values : by column name. None stands for NaN, as JSON has none: a row of the ring has NaN,
        one out of a status answer None.
    """

    values: Mapping[str, float | None]
    _orders: list[tuple[OrderStatus, ...]] = field(
        default_factory=list, init=False, repr=False, compare=False
    )  # worked out once, by who asks first

    @property
    def state(self) -> State:
        """State of the guard.

        Raises
        ------
        ValueError
            When the row is empty.
        """
        return State(int(self.number("state")))

    def tick_age_s(self, start_ns: int, now_ns: int) -> float:
        """Return how old the row is, s; NaN where its control process does not say when it began.

        Parameters
        ----------
        start_ns, now_ns : monotonic time of that start (``RunMeta``), and now.
        """
        return (now_ns - start_ns) * 1e-9 - self.time_s if start_ns else math.nan

    @property
    def is_live(self) -> bool:
        """Whether a correction may be going out.

        Raises
        ------
        ValueError
            When the row is empty.
        """
        bits = StateBits(int(self.number("state_bits")))
        return bool(bits & (StateBits.ARMED | StateBits.ACTIVE | StateBits.FADING))

    @property
    def alarm_code(self) -> int:
        """Code of the alarm that stands; 0: none.

        Raises
        ------
        ValueError
            When the row is empty.
        """
        return int(self.number("alarm"))

    @property
    def status_word(self) -> int:
        """The PLC's status word.

        Raises
        ------
        ValueError
            When the row is empty.
        """
        return int(self.number("status"))

    @property
    def is_remote(self) -> bool:
        """Whether the PLC says that the line is in remote; False where it is not known."""
        status = self.number("status")
        return math.isfinite(status) and bool(int(status) & Status.REMOTE)

    @property
    def outcome(self) -> Outcome:
        """How the exchange with the PLC ended.

        Raises
        ------
        ValueError
            When the row is empty.
        """
        return Outcome(int(self.number("outcome")))

    @property
    def is_fresh(self) -> bool:
        """Whether the PLC's heartbeat moved since the last good exchange."""
        return bool(self.values.get("fresh"))

    @property
    def time_s(self) -> float:
        """Time since the control process began to tick, s."""
        return self.number("time_s")

    @property
    def plc_age_s(self) -> float:
        """Time since the PLC's heartbeat last moved, s; NaN where it is not known."""
        return self.number("age_s")

    @property
    def timing(self) -> Timing:
        """How the tick went."""
        get = self.values.get
        return Timing(
            plc_age_s=get("age_s"),
            io_us=get("io_us"),
            tick_us=get("tick_us"),
            missed_count=get("missed_count"),
        )

    @property
    def channels(self) -> tuple[Channel, ...]:
        """What was measured, in the order of the site file."""
        return tuple(
            Channel(name=name, value=value)
            for name, value in self.values.items()
            if "." not in name
            and not name.startswith(OF_OUTPUTS)
            and name not in HEAD
            and name not in TIMING
        )

    @property
    def corrections(self) -> tuple[CorrectionDue, ...]:
        """What goes out with the next tick, in the order of the site file's actuators."""
        return tuple(self._corrections())

    def _corrections(self) -> Iterator[CorrectionDue]:
        for name, value in self.values.items():
            if name.startswith(CORRECTION):
                ratio = self.values.get(APPLIED_RATIO + name.removeprefix(CORRECTION))
                yield CorrectionDue(name=name, value=value, applied_ratio=ratio)

    def applied_ratio(self, actuator: str) -> float:
        """Return ``applied_ratio`` of an actuator, see ``CorrectionDue``; NaN when unknown."""
        ratios = (self.number(f"{APPLIED_RATIO}{actuator}_{unit}") for unit in _UNITS)
        return next((ratio for ratio in ratios if not math.isnan(ratio)), math.nan)

    def roll(self, name: str) -> RollTurn:
        """Return how a roll turns; NaN and None of one that the law does not follow."""
        source = self.number(f"{name}.source")
        return RollTurn(
            omega_rad_s=self.number(f"{name}.omega_rad_s"),
            theta_rad=self.number(f"{name}.theta_rad"),
            source=Source(int(source)) if math.isfinite(source) else None,
        )

    def number(self, name: str | None) -> float:
        """Return the value of a channel or column; NaN when there is none."""
        value = self.values.get(name) if name is not None else None
        return math.nan if value is None else value

    def orders(self) -> tuple[OrderStatus, ...]:
        """Return every order of every law, in the order of the columns."""
        if not self._orders:
            self._orders.append(order_statuses(self.values))
        return self._orders[0]
