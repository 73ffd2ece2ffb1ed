"""Settings of the guard in SI: what the site file allows, as frozen records."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf

from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import Status


@dataclass(frozen=True, slots=True, kw_only=True)
class PermissiveParams:
    """Status bits that must be set before anything goes out.

    Attributes
    ----------
    need : bits of the PLC, in the order in which the first missing one is named.
    enable_from_plc : AFF_ENABLE_REQUEST must be set as well.
    """

    need: tuple[Status, ...] = (
        Status.LINE_RUN,
        Status.WEB_INTACT,
        Status.TENSION_VALID,
        Status.ESTOP_OK,
    )
    enable_from_plc: bool = True

    @property
    def all_bits(self) -> tuple[Status, ...]:
        """Every bit that must be set, in order."""
        if self.enable_from_plc and Status.AFF_ENABLE_REQUEST not in self.need:
            return (*self.need, Status.AFF_ENABLE_REQUEST)
        return self.need


@dataclass(frozen=True, slots=True, kw_only=True)
class FreshnessParams:
    """How old the PLC's heartbeat may be.

    Attributes
    ----------
    hold_after_s : older than this freezes adaptation, s.
    fault_after_s : older than this fades to zero and latches, s.
    """

    hold_after_s: float = 0.015
    fault_after_s: float = 0.080


@dataclass(frozen=True, slots=True, kw_only=True)
class EchoParams:
    """How old our heartbeat may be when the PLC shows that it took it.

    Attributes
    ----------
    ticks : ticks of ours that may pass until a command has been taken and its echo is here.
    missing_after_s : no echo of ours for longer than this, in fresh data, is a fault, s.
    """

    ticks: int = 50
    missing_after_s: float = 0.080


@dataclass(frozen=True, slots=True, kw_only=True)
class AppliedParams:
    """How the correction that the PLC shows as applied may differ from what we sent.

    Attributes
    ----------
    tolerances : per actuator, what rounding in both words may make of it, in its SI unit; None
        for one that is not shown. Empty: nothing is judged.
    units : per actuator its SI unit, for the operator.
    ticks : as in ``EchoParams``: how old the command may be that the PLC took.
    lag_ticks : how much older than that command may be what a drive shows as applied.
    between_s : what is neither ours nor zero is over within this time: the PLC's own ramp to zero
        (0.1 s), and what a scan and the way back may differ meanwhile, s.
    gap_s : no fresh reading for longer than this: what comes then is a beginning, s.
    """

    tolerances: tuple[float | None, ...] = ()
    units: tuple[str, ...] = ()
    ticks: int = 50
    lag_ticks: int = 3
    between_s: float = 0.180
    gap_s: float = 0.080


@dataclass(frozen=True, slots=True, kw_only=True)
class ChannelParams:
    """What one channel may read; limits in the channel's SI unit.

    Attributes
    ----------
    channel : index into ``Snapshot.values``.
    name : channel name with unit, for the operator.
    minimum, maximum : plausible range while the line runs.
    stuck_after_s : no change at all for this long while the line runs is a fault, s; inf: never.
    rate_max : fastest plausible change, SI unit per second; inf: never judged.
    event : code of the event table raised by this channel.
    """

    channel: int
    name: str
    minimum: float = -inf
    maximum: float = inf
    stuck_after_s: float = inf
    rate_max: float = inf
    event: int = BY_NAME["SIGNAL_IMPLAUSIBLE"].code


@dataclass(frozen=True, slots=True, kw_only=True)
class RadiusParams:
    """A measured roll radius that may only shrink (or grow) until the next roll.

    Attributes
    ----------
    channel : index into ``Snapshot.values``.
    name : channel name, for the operator.
    tolerance_m : play against the allowed direction, and largest step from the readings before, m.
    shrinks : True for an unwind, False for a rewind.
    """

    channel: int
    name: str
    tolerance_m: float = 0.005
    shrinks: bool = True


@dataclass(frozen=True, slots=True, kw_only=True)
class ActuatorLimits:
    """Bounds of one correction output, in its SI unit (m/s or N m).

    Attributes
    ----------
    name : actuator of the site file.
    limit : largest correction either way.
    slew_limit : fastest change, unit per second.
    soft_start_s : time from zero to the whole correction, s.
    active_above_m_s : line speed from which the output opens, m/s.
    """

    name: str
    limit: float
    slew_limit: float
    soft_start_s: float = 1.5
    active_above_m_s: float = 0.1


@dataclass(frozen=True, slots=True, kw_only=True)
class GuardParams:
    """Everything the guard needs; order of ``actuators`` is the order of the law's steps.

    Attributes
    ----------
    actuators : bounds per correction output.
    fade_s : time within which any output reaches zero, s.
    line_speed_channel : index of the line speed, m/s; None: the outputs do not wait for speed.
    speed_release_ratio : an open output closes below this share of ``active_above_m_s``.
    splice_settle_s : a new roll id keeps the outputs closed for this long, s.
    lease_ticks : ticks that an output may live without the law renewing it.
    """

    actuators: tuple[ActuatorLimits, ...]
    fade_s: float = 0.150
    permissives: PermissiveParams = field(default_factory=PermissiveParams)
    freshness: FreshnessParams = field(default_factory=FreshnessParams)
    echo: EchoParams = field(default_factory=EchoParams)
    applied: AppliedParams = field(default_factory=AppliedParams)
    channels: tuple[ChannelParams, ...] = ()
    radii: tuple[RadiusParams, ...] = ()
    line_speed_channel: int | None = None
    speed_release_ratio: float = 0.8
    splice_settle_s: float = 0.5
    lease_ticks: int = 3
