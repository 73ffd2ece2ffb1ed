"""The blocks of the law in words, with units: what ``status`` and ``top`` show."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from aff_runtime.core.monitor import Trend
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
AMPLITUDE = "amplitude_"
SHAPE = "shape_mm"
IMBALANCE = "imbalance"
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
UNITS = {"m_s": "m/s", "N_m": "N m", "N": "N", "m": "m"}


def blocks(record: Mapping[str, float], site: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return one row per block in the order of the record; NaN becomes None.

    Parameters
    ----------
    record : newest record by column name.
    site : the site of the parameter record, as plain values.
    """
    rows = []
    for column, value in record.items():
        if column.count(".") == 2 and column.endswith(".state"):
            actuator, name, _ = column.split(".")
            rows.append(_row(record, site, actuator, name, value))
    _say_meetings(rows, site)
    return rows


def _row(
    record: Mapping[str, float], site: Mapping[str, Any], actuator: str, name: str, state: float
) -> dict[str, Any]:
    prefix = f"{actuator}.{name}."
    said = {k.removeprefix(prefix): v for k, v in record.items() if k.startswith(prefix)}
    of_actuator = site.get("actuators", {}).get(actuator, {})
    roll, _, order = name.rpartition("_")
    number = int(order[:-1]) if order[:-1].isdigit() else 0
    if name == IMBALANCE:
        roll, number = str((of_actuator.get("drive") or {}).get("roll", "")), 1
    settings = _settings(site, actuator, roll, number)
    signal = str(of_actuator.get("error", {}).get("signal", ""))
    omega = record.get(f"{roll}.omega_rad_s", math.nan)
    before, now = said.get("ripple_before", math.nan), said.get("ripple", math.nan)
    return {
        "actuator": actuator,
        "name": name,
        "roll": roll,
        "order": number,
        "state": _word(state),
        "why": _why(state, "shape" if SHAPE in said else "blocks"),
        "frequency_Hz": _finite(number * omega / math.tau),
        **_size(said, name, of_actuator, settings),
        "out": _finite(said.get("share", 1.0) * _applied(record, actuator)),
        "phase_deg": _finite(said.get("phase_deg", math.nan)),
        "encoder_deg": _finite(
            _at_encoder_zero_deg(record, site, roll, number, said.get("phase_deg", math.nan))
        ),
        "ripple_before": _finite(before),
        "ripple": _finite(now),
        "benefit_dB": _finite(_benefit_dB(before, now)),
        "ripple_unit": "N" if signal.endswith("_N") else "m/s" if signal.endswith("_m_s") else "",
        "settle_s": settings.get("settle_s"),
    }


def _size(
    said: Mapping[str, float], name: str, actuator: Mapping[str, Any], block: Mapping[str, Any]
) -> dict[str, Any]:
    """Return amplitude, unit and limit of one block; of a shape also what goes out of it."""
    if SHAPE not in said:
        suffix = next((k.removeprefix(AMPLITUDE) for k in said if k.startswith(AMPLITUDE)), "")
        return {
            "law": "blocks",
            "amplitude": _finite(said.get(AMPLITUDE + suffix, math.nan)),
            "unit": UNITS.get(suffix, suffix),
            "limit": block.get(f"amp_limit_{suffix}"),
        }
    factor = N_M_PER_MM if name == IMBALANCE else 1.0
    limit_m = actuator.get("shape_limit_m")
    return {
        "law": "shape",
        "amplitude": _finite(factor * said[SHAPE]),
        "unit": "N m" if name == IMBALANCE else "mm",
        "limit": None if limit_m is None else factor * 1e3 * limit_m,
        "share": _finite(said.get("share", math.nan)),
        "loop_gain": _finite(said.get("gain_of_P", math.nan)),
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


def _why(state: float, law: str) -> str:
    """Return why a block is held or faded, empty when it is not."""
    try:
        trend = Trend(int(state)) if math.isfinite(state) else Trend.IDLE
        return (SHAPE_WHY if law == "shape" else {}).get(trend, WHY.get(trend, ""))
    except ValueError:
        return ""


def _say_meetings(rows: list[dict[str, Any]], site: Mapping[str, Any]) -> None:
    """Add to shapes of different rolls that the signal cannot tell apart now that they meet."""
    shapes = [r for r in rows if r["law"] == "shape" and r["frequency_Hz"] and r["order"]]
    for one in shapes:
        memory = site.get("actuators", {}).get(one["actuator"], {}).get("memory_turns", 9.0)
        for other in shapes:
            if other["actuator"] != one["actuator"] or other["roll"] == one["roll"]:
                continue
            apart_Hz = abs(abs(one["frequency_Hz"]) - abs(other["frequency_Hz"]))
            slowest_Hz = min(abs(r["frequency_Hz"]) / r["order"] for r in (one, other))
            if apart_Hz * memory < slowest_Hz:
                one["why"] = f"meets {other['name']}: not judged, not saved meanwhile"


def _settings(site: Mapping[str, Any], actuator: str, roll: str, order: int) -> Mapping[str, Any]:
    """Return what the site file says of one block; empty when it says nothing."""
    for block in site.get("actuators", {}).get(actuator, {}).get("blocks", []):
        if block["roll"] == roll and order in block["orders"]:
            found: Mapping[str, Any] = block
            return found
    return {}


def _word(state: float) -> str:
    if not math.isfinite(state):
        return ""
    try:
        return WORDS[Trend(int(state))]
    except ValueError:
        return f"state {state:.0f}"


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
