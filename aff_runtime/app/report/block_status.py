"""The blocks of the law as text, with units: what ``status`` and ``top`` show."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.base.numbers import finite_or_none
from aff_runtime.core.monitor import OrderState
from aff_runtime.core.order_status import OrderStatus
from aff_runtime.core.params import IMBALANCE_N_M_PER_M
from aff_runtime.core.phase import Source

if TYPE_CHECKING:
    from aff_runtime.config.models import Actuator, Block, Site

WORDS = {
    OrderState.IDLE: "idle",
    OrderState.CONVERGING: "adapting",
    OrderState.SETTLED: "settled",
    OrderState.STALLED: "stalled",
    OrderState.RISING: "RISING",
    OrderState.HELD_PHASE: "HELD phase",
    OrderState.HELD_FREQUENCY: "HELD Hz",
    OrderState.CLAMPED: "CLAMPED",
    OrderState.FROZEN: "frozen",
}
SHAPE = "shape"
N_M_PER_MM = 1e-3 * IMBALANCE_N_M_PER_M
WHY = {
    OrderState.RISING: "ripple is larger than without it",
    OrderState.HELD_PHASE: (
        "its response is not sure to 60 deg here; probe at this speed and radius"
    ),
    OrderState.HELD_FREQUENCY: "too fast for the loop or the sample rate; it fades",
    OrderState.CLAMPED: "its limit is reached; raise it when the cause is known",
    OrderState.FROZEN: "learning holds; see the state of the service",
}
RESTS = (
    "makes ripple larger than without, or does nothing to it (does the drive take the "
    "correction?); it fades and rests for 20 turns"
)
SHAPE_WHY = {
    OrderState.RISING: RESTS,
    OrderState.CLAMPED: "the actuator's limit is used up; it gives way to orders that help more",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockStatus:
    """One order as text in plant units; None where nothing is known.

    Attributes
    ----------
    out : share of the order's correction that reaches the drive, 0..1.
    phase_deg, encoder_deg : angle of the order, in the service's count and where the encoder
        reads zero.
    law : family of laws, ``shape`` or ``blocks`` (the iterative law too).
    share, response_ratio : of a shape alone: share that the law lets out, true response over
        the measured one.
    """

    actuator: str
    name: str
    roll: str
    order: int
    state: str
    why: str
    frequency_Hz: float | None
    law: str
    amplitude: float | None
    unit: str
    limit: float | None
    out: float | None
    phase_deg: float | None
    encoder_deg: float | None
    ripple_before: float | None
    ripple: float | None
    benefit_dB: float | None
    ripple_unit: str
    settle_s: float | None
    share: float | None = None
    response_ratio: float | None = None


def blocks(tick: TickRow, site: Site) -> tuple[BlockStatus, ...]:
    """Return one row per block in the order of the record.

    Parameters
    ----------
    tick : newest row of the ring.
    site : the site of the parameter record.
    """
    rows = [_row(tick, site, order) for order in tick.orders()]
    shapes = [row for row in rows if row.law == SHAPE and row.frequency_Hz and row.order]
    return tuple(_with_meeting(row, shapes, site) for row in rows)


def _row(tick: TickRow, site: Site, order: OrderStatus) -> BlockStatus:
    actuator = site.actuators.get(order.actuator)
    roll = order.roll
    if order.is_imbalance:
        roll = actuator.drive.roll if actuator is not None and actuator.drive is not None else ""
    block = _block(actuator, roll, order.order)
    signal = actuator.error.signal if actuator is not None else ""
    omega = tick.roll(roll).omega_rad_s
    share = 1.0 if math.isnan(order.share) else order.share
    angle = site.rolls[roll].angle if roll in site.rolls else None
    of_encoder_deg = at_encoder_zero_deg(tick, roll, angle, order)
    shape = order.law == SHAPE
    size = _shape_size(order, actuator) if shape else _block_size(order, block)
    return BlockStatus(
        actuator=order.actuator,
        name=order.name,
        roll=roll,
        order=order.order,
        state="" if order.state is None else WORDS[order.state],
        why=_why(order.state, order.law),
        frequency_Hz=finite_or_none(order.order * omega / math.tau),
        law=order.law,
        amplitude=finite_or_none(size.amplitude),
        unit=size.unit,
        limit=size.limit,
        out=finite_or_none(share * tick.applied_ratio(order.actuator)),
        phase_deg=finite_or_none(order.phase_deg),
        encoder_deg=finite_or_none(of_encoder_deg),
        ripple_before=finite_or_none(order.ripple_before),
        ripple=finite_or_none(order.ripple),
        benefit_dB=finite_or_none(_benefit_dB(order.ripple_before, order.ripple)),
        ripple_unit="N" if signal.endswith("_N") else "m/s" if signal.endswith("_m_s") else "",
        settle_s=block.settle_s if block is not None else None,
        share=finite_or_none(order.share) if shape else None,
        response_ratio=finite_or_none(order.response_ratio) if shape else None,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Size:
    """How large an order is and may be, in ``unit``; NaN and None where it is not known."""

    amplitude: float
    unit: str
    limit: float | None


def _block_size(order: OrderStatus, block: Block | None) -> _Size:
    """Return amplitude, unit and limit of a plain block."""
    limit = None
    if block is not None:
        limits = {"m/s": block.amp_limit_m_s, "N m": block.amp_limit_N_m}
        limit = limits.get(order.size_unit)
    return _Size(amplitude=order.size, unit=order.size_unit, limit=limit)


def _shape_size(order: OrderStatus, actuator: Actuator | None) -> _Size:
    """Return size, unit and limit of a shape; an imbalance is a torque."""
    factor = N_M_PER_MM if order.is_imbalance else 1.0
    return _Size(
        amplitude=factor * order.size,
        unit="N m" if order.is_imbalance else order.size_unit,
        limit=None if actuator is None else factor * 1e3 * actuator.shape_limit_m,
    )


def at_encoder_zero_deg(
    tick: TickRow, roll: str, angle_channel: str | None, order: OrderStatus
) -> float:
    """Return the angle of an order where the encoder reads zero; NaN while it is not followed.

    Parameters
    ----------
    roll : of the order. ``angle_channel`` : its encoder's, None or empty without one.
    """
    turn = tick.roll(roll)
    if not tick.is_fresh or turn.source is not Source.ENCODER:
        return math.nan
    origin_rad = turn.theta_rad - tick.number(angle_channel)
    if not math.isfinite(origin_rad):
        return math.nan
    return math.remainder(order.phase_deg + order.order * math.degrees(origin_rad), 360.0)


def _benefit_dB(before: float, now: float) -> float:
    """Return by how much the ripple is smaller than without, dB; NaN when unknown."""
    return 20.0 * math.log10(before / now) if before > 0.0 and now > 0.0 else math.nan


def _why(state: OrderState | None, law: str) -> str:
    """Return why a block is held or faded, empty when it is not."""
    if state is None:
        return ""
    return (SHAPE_WHY if law == SHAPE else {}).get(state, WHY.get(state, ""))


def _with_meeting(row: BlockStatus, shapes: Sequence[BlockStatus], site: Site) -> BlockStatus:
    """Return the row; where an order of a shape meets another roll's, ``why`` names that one."""
    actuator = site.actuators.get(row.actuator)
    if actuator is None:
        return row
    memory = actuator.memory_turns
    for other in reversed(shapes if row in shapes else ()):
        if other.actuator == row.actuator and other.roll != row.roll and _meet(row, other, memory):
            return replace(row, why=f"meets {other.name}: not judged, not saved meanwhile")
    return row


def _meet(one: BlockStatus, other: BlockStatus, memory_turns: float) -> bool:
    """Return whether the signal cannot tell two orders apart within the memory."""
    mine_Hz, theirs_Hz = abs(one.frequency_Hz or 0.0), abs(other.frequency_Hz or 0.0)
    slowest_Hz = min(mine_Hz / one.order, theirs_Hz / other.order)
    return abs(mine_Hz - theirs_Hz) * memory_turns < slowest_Hz


def _block(actuator: Actuator | None, roll: str, order: int) -> Block | None:
    """Return what the site file says of one block; None when it says nothing."""
    for block in actuator.blocks if actuator is not None else ():
        if block.roll == roll and order in block.orders:
            return block
    return None
