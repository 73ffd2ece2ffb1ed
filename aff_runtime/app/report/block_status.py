"""The blocks of the law in words, with units: what ``status`` and ``top`` show."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from aff_runtime.core.monitor import Trend
from aff_runtime.core.order_status import OrderStatus, order_statuses
from aff_runtime.core.phase import Source
from aff_runtime.core.shape.basis import IMBALANCE_N_M_PER_M

WORDS = {
    Trend.IDLE: "idle",
    Trend.CONVERGING: "adapting",
    Trend.SETTLED: "settled",
    Trend.STALLED: "stalled",
    Trend.DIVERGING: "RISING",
    Trend.HELD_PHASE: "HELD phase",
    Trend.HELD_FREQUENCY: "HELD Hz",
    Trend.CLAMPED: "CLAMPED",
    Trend.FROZEN: "frozen",
}
SHAPE = "shape"
N_M_PER_MM = 1e-3 * IMBALANCE_N_M_PER_M
WHY = {
    Trend.DIVERGING: "ripple is larger than without it",
    Trend.HELD_PHASE: "its response is not sure to 60 deg here; probe at this speed and radius",
    Trend.HELD_FREQUENCY: "too fast for the loop or the sample rate; it fades",
    Trend.CLAMPED: "its limit is reached; raise it when the cause is known",
    Trend.FROZEN: "learning holds; see the state of the service",
}
RESTS = (
    "makes ripple larger than without, or does nothing to it (does the drive take the "
    "correction?); it fades and rests for 20 turns"
)
SHAPE_WHY = {
    Trend.DIVERGING: RESTS,
    Trend.CLAMPED: "the actuator's limit is used up; it gives way to orders that help more",
}
LIMIT_KEYS = {"m/s": "amp_limit_m_s", "N m": "amp_limit_N_m"}


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockStatus:
    """One order in words and plant units; None where nothing is known.

    Attributes
    ----------
    out : share of the order's correction that reaches the drive, 0..1.
    phase_deg, encoder_deg : angle of the order, in the service's count and where the encoder
        reads zero.
    share, loop_gain : of a shape alone: share that the law lets out, true response over measured.
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
    loop_gain: float | None = None


def blocks(record: Mapping[str, float], site: Mapping[str, Any]) -> tuple[BlockStatus, ...]:
    """Return one row per block in the order of the record.

    Parameters
    ----------
    record : newest record by column name.
    site : the site of the parameter record, as plain values.
    """
    rows = [_row(record, site, order) for order in order_statuses(record)]
    shapes = [row for row in rows if row.law == SHAPE and row.frequency_Hz and row.order]
    return tuple(_with_meeting(row, shapes, site) for row in rows)


def _row(record: Mapping[str, float], site: Mapping[str, Any], order: OrderStatus) -> BlockStatus:
    of_actuator = site.get("actuators", {}).get(order.actuator, {})
    roll = order.roll
    if order.is_imbalance:
        roll = str((of_actuator.get("drive") or {}).get("roll", ""))
    settings = _settings(site, order.actuator, roll, order.order)
    signal = str(of_actuator.get("error", {}).get("signal", ""))
    omega = record.get(f"{roll}.omega_rad_s", math.nan)
    share = 1.0 if math.isnan(order.share) else order.share
    of_encoder_deg = _at_encoder_zero_deg(record, site, roll, order.order, order.phase_deg)
    shape = order.law == SHAPE
    return BlockStatus(
        actuator=order.actuator,
        name=order.name,
        roll=roll,
        order=order.order,
        state="" if order.state is None else WORDS[order.state],
        why=_why(order.state, order.law),
        frequency_Hz=_finite(order.order * omega / math.tau),
        law=order.law,
        **(_shape_size(order, of_actuator) if shape else _block_size(order, settings)),
        out=_finite(share * _applied(record, order.actuator)),
        phase_deg=_finite(order.phase_deg),
        encoder_deg=_finite(of_encoder_deg),
        ripple_before=_finite(order.ripple_before),
        ripple=_finite(order.ripple),
        benefit_dB=_finite(_benefit_dB(order.ripple_before, order.ripple)),
        ripple_unit="N" if signal.endswith("_N") else "m/s" if signal.endswith("_m_s") else "",
        settle_s=settings.get("settle_s"),
        share=_finite(order.share) if shape else None,
        loop_gain=_finite(order.response_ratio) if shape else None,
    )


def _block_size(order: OrderStatus, block: Mapping[str, Any]) -> dict[str, Any]:
    """Return amplitude, unit and limit of a plain block."""
    limit = block.get(LIMIT_KEYS.get(order.size_unit, ""))
    return {"amplitude": _finite(order.size), "unit": order.size_unit, "limit": limit}


def _shape_size(order: OrderStatus, actuator: Mapping[str, Any]) -> dict[str, Any]:
    """Return size, unit and limit of a shape; an imbalance is a torque."""
    factor = N_M_PER_MM if order.is_imbalance else 1.0
    limit_m = actuator.get("shape_limit_m")
    return {
        "amplitude": _finite(factor * order.size),
        "unit": "N m" if order.is_imbalance else order.size_unit,
        "limit": None if limit_m is None else factor * 1e3 * limit_m,
    }


def _applied(record: Mapping[str, float], actuator: str) -> float:
    """Return how much of an actuator's correction the guard lets out, 0..1; NaN when unknown."""
    found = (record.get(f"applied_ratio_{actuator}_{unit}") for unit in ("m_s", "N_m"))
    return next((ratio for ratio in found if ratio is not None), math.nan)


def _at_encoder_zero_deg(
    record: Mapping[str, float], site: Mapping[str, Any], roll: str, order: int, phase_deg: float
) -> float:
    """Return the angle of an order where the encoder reads zero; NaN while it is not followed."""
    channel = str(site.get("rolls", {}).get(roll, {}).get("angle", ""))
    read = record.get("fresh") and record.get(f"{roll}.source") == Source.ENCODER
    if not read or channel not in record:
        return math.nan
    origin_rad = record[f"{roll}.theta_rad"] - record[channel]
    if not math.isfinite(origin_rad):
        return math.nan
    return math.remainder(phase_deg + order * math.degrees(origin_rad), 360.0)


def _benefit_dB(before: float, now: float) -> float:
    """Return by how much the ripple is smaller than without, dB; NaN when unknown."""
    return 20.0 * math.log10(before / now) if before > 0.0 and now > 0.0 else math.nan


def _why(state: Trend | None, law: str) -> str:
    """Return why a block is held or faded, empty when it is not."""
    if state is None:
        return ""
    return (SHAPE_WHY if law == SHAPE else {}).get(state, WHY.get(state, ""))


def _with_meeting(
    row: BlockStatus, shapes: Sequence[BlockStatus], site: Mapping[str, Any]
) -> BlockStatus:
    """Return the row; a shape whose order meets another roll's says so."""
    memory = site.get("actuators", {}).get(row.actuator, {}).get("memory_turns", 9.0)
    for other in reversed(shapes if row in shapes else ()):
        if other.actuator == row.actuator and other.roll != row.roll and _meet(row, other, memory):
            return replace(row, why=f"meets {other.name}: not judged, not saved meanwhile")
    return row


def _meet(one: BlockStatus, other: BlockStatus, memory_turns: float) -> bool:
    """Return whether the signal cannot tell two orders apart within the memory."""
    mine_Hz, theirs_Hz = abs(one.frequency_Hz or 0.0), abs(other.frequency_Hz or 0.0)
    slowest_Hz = min(mine_Hz / one.order, theirs_Hz / other.order)
    return abs(mine_Hz - theirs_Hz) * memory_turns < slowest_Hz


def _settings(site: Mapping[str, Any], actuator: str, roll: str, order: int) -> Mapping[str, Any]:
    """Return what the site file says of one block; empty when it says nothing."""
    for block in site.get("actuators", {}).get(actuator, {}).get("blocks", []):
        if block["roll"] == roll and order in block["orders"]:
            found: Mapping[str, Any] = block
            return found
    return {}


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
