"""Site file to the settings of the law and of the probe."""

from __future__ import annotations

import math
from collections.abc import Sequence

from aff_runtime.base.errors import RefusedError
from aff_runtime.config.models import Actuator, Roll, Site
from aff_runtime.core.params import (
    ActuatorParams,
    BlockParams,
    OutputKind,
    ProbeParams,
    RollParams,
    SiteParams,
)

_COUNTS = {"u16": 2**16, "i16": 2**16, "u32": 2**32, "i32": 2**32}


def site_params(site: Site) -> SiteParams:
    """Return what the law needs of the site; disabled blocks are left out."""
    return SiteParams(
        cycle_s=site.cycle_s,
        channels=tuple(site.gateway.read.channels),
        rolls=tuple(_roll(site, name, roll) for name, roll in site.rolls.items()),
        actuators=tuple(_actuator(name, a) for name, a in site.actuators.items()),
        line_speed=site.line.speed,
    )


def probe_params(site: Site, actuators: Sequence[str]) -> ProbeParams:
    """Return how the response of ``actuators`` is measured.

    Raises
    ------
    RefusedError
        When one of them does not exist or they differ in kind of output.
    """
    unknown = [name for name in actuators if name not in site.actuators]
    if unknown:
        known = ", ".join(site.actuators)
        raise RefusedError(f"no actuator {unknown[0]!r} in the site file; there are {known}")
    kinds = {site.actuators[name].output for name in actuators}
    if len(kinds) != 1:
        raise RefusedError(
            "velocity and torque references have different amplitudes; "
            "probe them one after the other with --actuator"
        )
    is_velocity = kinds == {"velocity_reference"}
    return ProbeParams(
        actuators=tuple(actuators),
        amplitude=site.probe.amplitude_m_s if is_velocity else site.probe.amplitude_N_m,
        duration_s=site.probe.duration_s,
        offset_Hz=site.probe.offset_Hz,
        extra_frequencies_Hz=tuple(site.probe.extra_frequencies_Hz),
        max_speed_m_s=site.speed_max_m_s if math.isfinite(site.speed_max_m_s) else 0.0,
    )


def _roll(site: Site, name: str, roll: Roll) -> RollParams:
    """Return where the angle of one roll comes from."""
    return RollParams(
        name=name,
        angle=roll.angle,
        angle_modulus_rad=_modulus_rad(site, roll.angle),
        speed=roll.speed,
        speed_is_surface=not (roll.speed or "").endswith("_rad_s"),
        line_speed=roll.line_speed or site.line.speed,
        radius=roll.radius,
        radius_m=roll.radius_m,
        radius_min_m=roll.smallest_radius_m,
        radius_max_m=roll.largest_radius_m,
        resets_on_splice=roll.resets_on == "splice",
    )


def _modulus_rad(site: Site, angle: str | None) -> float | None:
    """Return the range after which an angle's counter starts over, rad."""
    if angle is None or not site.gateway.read.channels[angle].wraps:
        return None
    channel = site.gateway.read.channels[angle]
    return _COUNTS[channel.type] * abs(channel.scale) if channel.type is not None else None


def _actuator(name: str, actuator: Actuator) -> ActuatorParams:
    """Return one correction output and its enabled blocks."""
    return ActuatorParams(
        name=name,
        signal=actuator.error.signal,
        reference=actuator.error.reference,
        output=OutputKind(actuator.output),
        active_above_m_s=actuator.active_above_m_s,
        blocks=tuple(
            BlockParams(
                roll=block.roll,
                orders=tuple(block.orders),
                settle_s=block.settle_s,
                amp_limit=block.amp_limit,
            )
            for block in actuator.blocks
            if block.enabled
        ),
    )
