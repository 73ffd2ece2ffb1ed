"""Law shape: its drive fits the roll and the output, its start values fit the orders."""

from __future__ import annotations

from collections.abc import Iterator

from aff_runtime.base.channel_units import unit_of_channel
from aff_runtime.base.suggest import meant
from aff_runtime.base.units import plain
from aff_runtime.config.findings import KeyPath
from aff_runtime.config.models import Actuator, Block, Drive, Site
from aff_runtime.config.rules.issue import Issue

FASTEST_RAD_S2 = 1e5  # of a roll that its tension alone turns; rolls reach hundreds


def issues(site: Site) -> Iterator[Issue]:
    """Yield what is wrong with laws, drives and start values."""
    for name, actuator in site.actuators.items():
        path: KeyPath = ("actuators", name)
        yield from _law(path, actuator)
        yield from _noise(path, actuator)
        if actuator.drive is not None:
            yield from _drive((*path, "drive"), actuator.drive, actuator, site)
        for index, block in enumerate(actuator.blocks):
            yield from _start((*path, "blocks", index), block, actuator, site)


def _law(path: KeyPath, actuator: Actuator) -> Iterator[Issue]:
    where = (*path, "law")
    if actuator.law == "shape" and actuator.output != "velocity_reference":
        text = "law shape corrects a velocity_reference; this is a torque_reference. Write blocks."
        yield Issue(path=where, text=text)
    elif actuator.stands_in:
        text = (
            "no whole drive is declared: until a probe has identified the rest, the plain blocks "
            "stand in. Add drive (roll, speed_gain_rad_s, zeta, inertia_kg_m2), probe, or write "
            "law: blocks."
        )
        yield Issue(path=where, text=text, warning=True)
    elif actuator.law == "blocks" and actuator.drive is not None:
        text = "law: blocks does not use it. Write law: shape, or remove drive."
        yield Issue(path=(*path, "drive"), text=text, warning=True, at_key=True)


def _noise(path: KeyPath, actuator: Actuator) -> Iterator[Issue]:
    unit = unit_of_channel(actuator.error.signal)
    for key, wanted in (("noise_N", "N"), ("noise_m_s", "m/s")):
        if getattr(actuator.error, key) is not None and unit not in (None, wanted):
            text = f"the signal is in {unit}. Remove it."
            yield Issue(path=(*path, "error", key), text=text, at_key=True)


def _drive(path: KeyPath, drive: Drive, actuator: Actuator, site: Site) -> Iterator[Issue]:
    both = drive.zeta is not None and drive.integral_time_s is not None
    neither = drive.zeta is None and drive.integral_time_s is None
    if both or (neither and drive.speed_gain_rad_s is not None):
        text = (
            "zeta and integral_time_s both say how the speed loop is damped. Remove one."
            if both
            else "needs one of zeta and integral_time_s. Add one."
        )
        yield Issue(path=path, text=text, at_key=True)
    if drive.roll not in site.rolls:
        text = f"{drive.roll} is no roll. {meant(drive.roll, site.rolls)}"
        yield Issue(path=(*path, "roll"), text=text)
        return
    if drive.roll not in {block.roll for block in actuator.blocks if block.enabled}:
        text = f"no enabled block is on {drive.roll}. Add one, or name the roll that it turns."
        yield Issue(path=(*path, "roll"), text=text)
    yield from _web(path, drive, site)
    yield from _weight(path, drive, actuator, site)
    if actuator.error.reference is not None:
        return
    if unit_of_channel(actuator.error.signal) != "N":
        text = "law shape needs the set point of a speed. Name its channel."
        yield Issue(path=(*path[:-1], "error", "reference"), text=text, at_key=True)
    elif drive.tension_N is None:
        text = "required key is missing: error has no reference. Write the usual tension."
        yield Issue(path=(*path, "tension_N"), text=text, at_key=True)


def _web(path: KeyPath, drive: Drive, site: Site) -> Iterator[Issue]:
    roll = site.rolls[drive.roll]
    if drive.web_density_kg_m3 == 0:
        return
    if drive.web_width_m == 0:
        text = "required key is missing: wound web has a density but no width."
        yield Issue(path=(*path, "web_width_m"), text=text, at_key=True)
    if roll.radius is None:
        text = f"{drive.roll} has a fixed radius, so no web is wound on it. Remove it."
        yield Issue(path=(*path, "web_density_kg_m3"), text=text)
    elif not 0 < drive.core_radius_m <= roll.smallest_radius_m:
        text = (
            f"{plain(drive.core_radius_m)} m is not above 0 and at most the smallest radius "
            f"{plain(roll.smallest_radius_m)} m of {drive.roll}. Write the radius of the core."
        )
        yield Issue(path=(*path, "core_radius_m"), text=text)


def _weight(path: KeyPath, drive: Drive, actuator: Actuator, site: Site) -> Iterator[Issue]:
    """Refuse an inertia that the tension would whirl round: a slip of the unit, and it harms."""
    tension_N, limits = drive.tension_N, site.plausibility.get(actuator.error.signal)
    if tension_N is None and limits is not None and limits.max_N is not None:
        tension_N = limits.max_N
    if tension_N is None or not drive.tension_pulls or drive.inertia_kg_m2 is None:
        return
    # wound web only adds to this
    torque_N_m = tension_N * site.rolls[drive.roll].smallest_radius_m
    least_kg_m2 = torque_N_m / FASTEST_RAD_S2
    if drive.total_inertia_kg_m2 < least_kg_m2:
        text = (
            f"{plain(drive.total_inertia_kg_m2)} kg m2 with its motor: the tension would turn "
            f"such a roll faster than any roll turns. At least {least_kg_m2:.1g} kg m2; count "
            "core, chuck and coupling."
        )
        yield Issue(path=(*path, "inertia_kg_m2"), text=text)


def _start(path: KeyPath, block: Block, actuator: Actuator, site: Site) -> Iterator[Issue]:
    seen: set[int] = set()
    if block.start and actuator.law != "shape":
        text = "law: blocks starts from nothing. Write law: shape, or remove start."
        yield Issue(path=(*path, "start"), text=text, warning=True, at_key=True)
    roll = site.rolls.get(block.roll)
    if block.start and roll is not None and roll.angle is None:
        text = f"{block.roll} has no angle channel, so no start angle means anything. Remove it."
        yield Issue(path=(*path, "start"), text=text, at_key=True)
    for place, entry in enumerate(block.start):
        where = (*path, "start", place)
        if entry.order not in block.orders:
            orders = ", ".join(map(str, block.orders))
            text = (
                f"order {entry.order} is none of this block's ({orders}). Add it, or remove this."
            )
            yield Issue(path=(*where, "order"), text=text)
        elif entry.order in seen:
            text = f"order {entry.order} is given twice. Remove one."
            yield Issue(path=(*where, "order"), text=text)
        seen.add(entry.order)
        if entry.deviation_m > actuator.shape_limit_m:
            text = (
                f"{plain(entry.deviation_m)} m is above shape_limit_m "
                f"{plain(actuator.shape_limit_m)} m. Lower it, or raise the limit."
            )
            yield Issue(path=(*where, "deviation_m"), text=text)
