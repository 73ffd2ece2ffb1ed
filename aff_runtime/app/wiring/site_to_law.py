"""Site file to the settings of the law and of the probe."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

from aff_runtime.base.channel_units import unit_of_channel
from aff_runtime.base.errors import RefusedError
from aff_runtime.config.models import Actuator, Drive, Roll, Site
from aff_runtime.config.models.drive import slow_band
from aff_runtime.config.probe_bound import probe_bound
from aff_runtime.core.bandwidth import plain_limit_Hz
from aff_runtime.core.params import (
    ActuatorParams,
    BlockParams,
    DriveParams,
    OutputKind,
    ProbeParams,
    RollParams,
    ShapeParams,
    SiteParams,
)

NOISE_N, NOISE_M_S = 0.6, 2e-4
CYCLES_ON_THE_WAY = 3  # the angle's age, one tick to be sent, one PLC scan to the drive
TONE_ABOVE = 1.02  # of the band's end: a tone above the highest order that goes out
LOUDER_FROM = 0.4  # of the band's end: from here on the line answers least
BLOCKS_LOUDER_FROM = 0.3  # of the plain law's: its drive is not declared
SHAPE_GRID = 20
DRIVE_GRID = 7  # tones below all orders, which tell the drive's own numbers
FASTER = 2.0  # than the highest line speed that is believed: no roll turns so
NO_RANGES: Mapping[str, float] = MappingProxyType({})
ORDERS_BEYOND = 8  # ripple above the highest order that the site corrects


def site_params(site: Site, counter_ranges_rad: Mapping[str, float] = NO_RANGES) -> SiteParams:
    """Return what the law needs of the site; disabled blocks are left out.

    ``counter_ranges_rad`` : after how much a counter starts over, by channel, where the files of
    its wire say it and not the site (CAN).
    """
    return SiteParams(
        cycle_s=site.cycle_s,
        channels=tuple(site.gateway.read.channels),
        rolls=tuple(_roll(site, name, r, counter_ranges_rad) for name, r in site.rolls.items()),
        actuators=tuple(_actuator(site, name, a) for name, a in site.actuators.items()),
        line_speed=site.line.speed,
    )


def probe_params(site: Site, actuators: Sequence[str], *, louder_than: float = 0.0) -> ProbeParams:
    """Return how the response of ``actuators`` is measured.

    Parameters
    ----------
    louder_than : an amplitude that is to be reached, within the bound; in the output's unit.

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
    amplitude, is_chosen, bound_N, share = _loudness(site, actuators, louder_than)
    shaped = [site.actuators[name] for name in actuators if site.actuators[name].law == "shape"]
    drives = [actuator.drive for actuator in shaped]
    bands = [d.band(site.cycle_s) if d else slow_band(site.cycle_s) for d in drives]
    end_Hz = max((band.end_Hz for band in bands), default=0.0)
    return replace(
        _shape_probe(site, end_Hz) if bands else _blocks_probe(site),
        actuators=tuple(actuators),
        amplitude=amplitude,
        is_chosen=is_chosen,
        louder_than=louder_than,
        bound_N=bound_N,
        bound_share=share,
        duration_s=site.probe.duration_s,
        offset_Hz=site.probe.offset_Hz,
        extra_frequencies_Hz=tuple(site.probe.extra_frequencies_Hz),
        max_speed_m_s=site.speed_max_m_s if math.isfinite(site.speed_max_m_s) else 0.0,
    )


def _loudness(
    site: Site, actuators: Sequence[str], louder_than: float
) -> tuple[float, bool, float, float]:
    """Return the amplitude or its bound, which of them it is, and by how much tension may move.

    A probe that is to be louder than the amplitude of the site file goes to it, within the bound.
    """
    bounds = [probe_bound(site, name) for name in actuators]
    most = min(one.most for one in bounds)
    given = bounds[0].given
    is_chosen = given is None
    amplitude = most if given is None else max(given, min(louder_than, most))
    bound_N = min((one.bound_N for one in bounds if one.bound_N is not None), default=math.inf)
    share = min((one.share for one in bounds if one.share is not None), default=math.inf)
    return amplitude, is_chosen, bound_N, share


def _blocks_probe(site: Site) -> ProbeParams:
    """Return what the plain law needs: tones up to the highest order that it corrects."""
    end_Hz = plain_limit_Hz(site.cycle_s)
    return ProbeParams(
        actuators=(), amplitude=0.0, f_max_Hz=end_Hz, louder_from_Hz=BLOCKS_LOUDER_FROM * end_Hz
    )


def _shape_probe(site: Site, end_Hz: float) -> ProbeParams:
    """Return what differs for the shape law: tones up to its fade, more ripple to tell apart."""
    highest = max(max(b.orders) for a in site.actuators.values() for b in a.blocks)
    return ProbeParams(
        actuators=(),
        amplitude=0.0,
        f_max_Hz=TONE_ABOVE * end_Hz,
        louder_from_Hz=LOUDER_FROM * end_Hz,
        grid_points=SHAPE_GRID,
        low_points=DRIVE_GRID,
        nuisance_orders=highest + ORDERS_BEYOND,
    )


def _roll(site: Site, name: str, roll: Roll, ranges_rad: Mapping[str, float]) -> RollParams:
    """Return where the angle of one roll comes from."""
    slowest = min((a.active_above_m_s for a in site.actuators.values()), default=0.0)
    return RollParams(
        name=name,
        angle=roll.angle,
        angle_modulus_rad=_modulus_rad(site, roll.angle, ranges_rad),
        angle_counts=site.gateway.read.channels[roll.angle].range_counts if roll.angle else 0,
        speed=roll.speed,
        speed_is_surface=unit_of_channel(roll.speed or "") != "rad/s",
        line_speed=roll.line_speed or site.line.speed,
        radius=roll.radius,
        radius_m=roll.radius_m,
        radius_min_m=roll.smallest_radius_m,
        radius_max_m=roll.largest_radius_m,
        resets_on_splice=roll.resets_on == "splice",
        max_omega_rad_s=FASTER * site.plausibility[site.line.speed].high / roll.smallest_radius_m,
        moves_above_m_s=slowest,
    )


def _modulus_rad(site: Site, angle: str | None, ranges_rad: Mapping[str, float]) -> float | None:
    """Return the range after which an angle's counter starts over, rad."""
    if angle is None or not site.gateway.read.channels[angle].wraps:
        return None
    channel = site.gateway.read.channels[angle]
    return ranges_rad.get(angle) if channel.type is None else channel.range_rad


def _actuator(site: Site, name: str, actuator: Actuator) -> ActuatorParams:
    """Return one correction output and its enabled blocks."""
    params = _plain(name, actuator)
    drive = actuator.drive
    if not actuator.uses_shape or drive is None:
        return params
    transport_s = CYCLES_ON_THE_WAY * site.cycle_s
    if drive.transport_ms is not None:
        transport_s = drive.transport_ms * 1e-3
    return replace(
        params,
        transport_s=transport_s,
        drive=_drive(drive),
        shape=ShapeParams(
            memory_turns=actuator.memory_turns,
            signal_sd=_noise(actuator),
            weight_limit_m=actuator.shape_limit_m,
            response_s=actuator.response_memory_s,
        ),
    )


def _drive(drive: Drive) -> DriveParams:
    """Return the declared drive, with what turns behind its gear seen at the roll."""
    return DriveParams(
        roll=drive.roll,
        K_ref_rad_s=drive.speed_gain_rad_s or 0.0,
        zeta=drive.damping,
        inertia_kg_m2=drive.total_inertia_kg_m2,
        web_density_kg_m3=drive.web_density_kg_m3,
        web_width_m=drive.web_width_m,
        core_radius_m=drive.core_radius_m,
        tension_N=drive.tension_N or 0.0,
        torque_term=drive.tension_pulls,
        imbalance=drive.imbalance,
        web_leaves_rad=math.nan if drive.web_leaves_rad is None else drive.web_leaves_rad,
    )


def _noise(actuator: Actuator) -> float:
    """Return how far one reading may be off, in the signal's unit."""
    if unit_of_channel(actuator.error.signal) == "N":
        return actuator.error.noise_N or NOISE_N
    return actuator.error.noise_m_s or NOISE_M_S


def _plain(name: str, actuator: Actuator) -> ActuatorParams:
    """Return what every law needs."""
    return ActuatorParams(
        name=name,
        turns=actuator.drive.roll if actuator.drive is not None else "",
        law=actuator.law_that_runs,
        stands_in=actuator.stands_in,
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
