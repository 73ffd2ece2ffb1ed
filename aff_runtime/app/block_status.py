"""The blocks of the law in words, with units: what ``status`` and ``top`` show."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from aff_runtime.core.monitor import Trend

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
    return rows


def _row(
    record: Mapping[str, float], site: Mapping[str, Any], actuator: str, name: str, state: float
) -> dict[str, Any]:
    prefix = f"{actuator}.{name}."
    said = {k.removeprefix(prefix): v for k, v in record.items() if k.startswith(prefix)}
    suffix = next((k.removeprefix(AMPLITUDE) for k in said if k.startswith(AMPLITUDE)), "")
    roll, _, order = name.rpartition("_")
    number = int(order[:-1]) if order[:-1].isdigit() else 0
    settings = _settings(site, actuator, roll, number)
    signal = str(site.get("actuators", {}).get(actuator, {}).get("error", {}).get("signal", ""))
    omega = record.get(f"{roll}.omega_rad_s", math.nan)
    return {
        "actuator": actuator,
        "name": name,
        "state": _word(state),
        "frequency_Hz": _finite(number * omega / math.tau),
        "amplitude": _finite(said.get(AMPLITUDE + suffix, math.nan)),
        "unit": UNITS.get(suffix, suffix),
        "limit": settings.get(f"amp_limit_{suffix}"),
        "phase_deg": _finite(said.get("phase_deg", math.nan)),
        "ripple_before": _finite(said.get("ripple_before", math.nan)),
        "ripple": _finite(said.get("ripple", math.nan)),
        "ripple_unit": "N" if signal.endswith("_N") else "m/s" if signal.endswith("_m_s") else "",
        "settle_s": settings.get("settle_s"),
    }


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
