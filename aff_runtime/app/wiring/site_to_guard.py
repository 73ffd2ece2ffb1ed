"""Site file to the settings of the guard."""

from __future__ import annotations

import math

from aff_runtime.base.channel_units import unit_of_channel
from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import Status
from aff_runtime.config.models import Actuator, PlausibleRange, Site
from aff_runtime.safety.params import (
    ActuatorLimits,
    AppliedParams,
    ChannelParams,
    EchoParams,
    FreshnessParams,
    GuardParams,
    PermissiveParams,
    RadiusParams,
)

_PLC_FADE_S = 0.100  # the PLC's ramp to zero: docs/technician/gateway-block.md
_DRIVE_LAG_S = 0.015  # a drive may show what it took three cycles of 5 ms before


def guard_params(site: Site) -> GuardParams:
    """Return everything the guard needs of the site."""
    channels = list(site.gateway.read.channels)
    return GuardParams(
        actuators=tuple(_limits(name, a) for name, a in site.actuators.items()),
        fade_s=site.freshness.fade_ms * 1e-3,
        permissives=permissive_params(site),
        freshness=FreshnessParams(
            hold_after_s=site.freshness.hold_after_ms * 1e-3,
            fault_after_s=site.freshness.fault_after_ms * 1e-3,
        ),
        echo=echo_params(site),
        applied=applied_params(site),
        channels=tuple(
            _channel(channels.index(name), name, believable)
            for name, believable in site.plausibility.items()
        ),
        radii=tuple(
            RadiusParams(
                channel=channels.index(roll.radius), name=roll.radius, shrinks=not roll.winds(name)
            )
            for name, roll in site.rolls.items()
            if roll.radius is not None and roll.resets_on == "splice"
        ),
        line_speed_channel=channels.index(site.line.speed),
    )


def echo_params(site: Site) -> EchoParams:
    """Return how old an echo may be: way out, scan and way back, each up to ``fault_after_ms``.

    Two ticks more, as the PLC's scans and our ticks do not begin together.
    """
    stale_s = site.freshness.fault_after_ms * 1e-3
    return EchoParams(ticks=math.ceil(3.0 * stale_s / site.cycle_s) + 2, missing_after_s=stale_s)


def applied_params(site: Site) -> AppliedParams:
    """Return how far what the PLC applies may be from what was sent: a count of each word."""
    shown, sent = site.gateway.applied, site.gateway.write.corrections
    stale_s = site.freshness.fault_after_ms * 1e-3
    return AppliedParams(
        tolerances=tuple(
            shown[name].scale + sent[name].scale if name in shown else None
            for name in site.actuators
        )
        if shown
        else (),
        units=tuple(actuator.unit for actuator in site.actuators.values()),
        ticks=echo_params(site).ticks,
        lag_ticks=math.ceil(_DRIVE_LAG_S / site.cycle_s),
        between_s=_PLC_FADE_S + stale_s,
        gap_s=stale_s,
    )


def permissive_params(site: Site) -> PermissiveParams:
    """Return which status bits must be set, in order."""
    return PermissiveParams(
        need=tuple(Status[name] for name in site.permissives.need),
        enable_from_plc=site.permissives.enable_from_plc,
    )


def _limits(name: str, actuator: Actuator) -> ActuatorLimits:
    """Return the bounds of one output."""
    return ActuatorLimits(
        name=name,
        limit=actuator.limit,
        slew_limit=actuator.slew,
        soft_start_s=actuator.soft_start_s,
        active_above_m_s=actuator.active_above_m_s,
    )


def _channel(index: int, name: str, believable: PlausibleRange) -> ChannelParams:
    """Return what one channel may read; a tension has its own alarm."""
    event = "TENSION_IMPLAUSIBLE" if unit_of_channel(name) == "N" else "SIGNAL_IMPLAUSIBLE"
    stuck_s = believable.stuck_after_s
    return ChannelParams(
        channel=index,
        name=name,
        minimum=believable.low,
        maximum=believable.high,
        stuck_after_s=math.inf if stuck_s is None else stuck_s,
        event=BY_NAME[event].code,
    )
