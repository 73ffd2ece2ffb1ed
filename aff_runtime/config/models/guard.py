"""Sections ``permissives``, ``freshness`` and ``plausibility``: when a correction may go out."""

from __future__ import annotations

from typing import Annotated, Literal

from aff_runtime.config.quantity import (
    Few,
    Flag,
    Metres,
    MetresPerSecond,
    Milliseconds,
    NewtonMetres,
    Newtons,
    RadiansPerSecond,
    Seconds,
    Section,
    key,
)

PermissiveName = Literal["LINE_RUN", "REMOTE", "WEB_INTACT", "TENSION_VALID", "ESTOP_OK"]


class Permissives(Section):
    """Status bits of the PLC without which no correction goes out."""

    need: Annotated[tuple[PermissiveName, ...], *Few] = key(
        "Status bits that must all be 1. Leave one out only when the PLC cannot supply it."
    )
    enable_from_plc: Flag = key(
        "true: the PLC must also set AFF_ENABLE_REQUEST. false: arming at the service is enough.",
        default=True,
    )


class Freshness(Section):
    """How old PLC data may become; fault_after_ms + fade_ms stays within 300 ms."""

    hold_after_ms: Milliseconds = key(
        "PLC heartbeat unmoved for this long: learning holds, output goes on. Raise it for a "
        "slow PLC scan; at least two PLC scans.",
        default=15.0,
        ge=2,
        le=200,
    )
    fault_after_ms: Milliseconds = key(
        "PLC heartbeat unmoved for this long: the output fades, the alarm latches. Raise it "
        "when PLC_STALE trips on a healthy network. On Modbus five eighths of it are "
        "waited for a late reply; a connection that is lost is replaced in time where it is 11 "
        "cycles or more.",
        default=80.0,
        ge=5,
        le=290,
    )
    fade_ms: Milliseconds = key(
        "Time of the fade to zero, in every case. Shorten it when a fault must clear sooner; "
        "lengthen it when the fade itself disturbs the web.",
        default=150.0,
        ge=10,
        le=290,
    )


class PlausibleRange(Section):
    """Believable values of one channel; beyond them the output fades and the alarm latches.

    The two bounds carry the channel's unit: ``min_N``/``max_N`` for a tension, and so on.
    """

    min_N: Newtons | None = key("Lowest believable tension.", default=None, ge=-1e6, le=1e6)
    max_N: Newtons | None = key("Highest believable tension.", default=None, ge=-1e6, le=1e6)
    min_m_s: MetresPerSecond | None = key(
        "Lowest believable speed; a little below 0 when the line may jog back.",
        default=None,
        ge=-100,
        le=100,
    )
    max_m_s: MetresPerSecond | None = key(
        "Highest believable speed.", default=None, ge=-100, le=100
    )
    min_m: Metres | None = key("Lowest believable length.", default=None, ge=-100, le=100)
    max_m: Metres | None = key("Highest believable length.", default=None, ge=-100, le=100)
    min_rad_s: RadiansPerSecond | None = key(
        "Lowest believable angular speed.", default=None, ge=-1e4, le=1e4
    )
    max_rad_s: RadiansPerSecond | None = key(
        "Highest believable angular speed.", default=None, ge=-1e4, le=1e4
    )
    min_N_m: NewtonMetres | None = key("Lowest believable torque.", default=None, ge=-1e6, le=1e6)
    max_N_m: NewtonMetres | None = key("Highest believable torque.", default=None, ge=-1e6, le=1e6)
    stuck_after_s: Seconds | None = key(
        "Fault when the raw value did not move for this long while the line runs. Absent: not "
        "watched. Raise it for a coarse or strongly filtered signal.",
        default=None,
        ge=0.05,
        le=60,
    )

    @property
    def low(self) -> float:
        """Return the lower bound in the channel's SI unit, -inf when none is given."""
        return _given(self, "min_", float("-inf"))

    @property
    def high(self) -> float:
        """Return the upper bound in the channel's SI unit, inf when none is given."""
        return _given(self, "max_", float("inf"))


def _given(limits: PlausibleRange, prefix: str, absent: float) -> float:
    for name in type(limits).model_fields:
        value = getattr(limits, name)
        if name.startswith(prefix) and value is not None:
            return float(value)
    return absent
