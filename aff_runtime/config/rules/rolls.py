"""Rolls: radius and phase source are known; orders are sampled often enough and stay apart."""

from __future__ import annotations

import math
from collections.abc import Iterator

from aff_runtime.config.findings import KeyPath
from aff_runtime.config.meetings import frequency_Hz, meetings_of
from aff_runtime.config.models import Actuator, Roll, Site
from aff_runtime.config.rules.issue import Issue
from aff_runtime.core.bandwidth import SAMPLES_PER_PERIOD, plain_limit_Hz


def issues(site: Site) -> Iterator[Issue]:
    """Yield what is wrong with rolls, and what their orders will meet."""
    for name, roll in site.rolls.items():
        yield from _radius(("rolls", name), roll)
        yield from _angle(("rolls", name), roll, site)
        is_judged = roll.radius is not None and roll.resets_on == "splice"
        if is_judged and roll.winding is None and not name.startswith(("unwind", "rewind")):
            yield _assumed(("rolls", name))
        yield from _of_record(("rolls", name), roll)
    used = {block.roll for actuator in site.actuators.values() for block in actuator.blocks}
    for name in site.rolls:
        if name not in used:
            text = "no block uses this roll. Remove it, or add a block."
            yield Issue(path=("rolls", name), text=text, warning=True, at_key=True)
    for name, actuator in site.actuators.items():
        yield from _sampling(("actuators", name), actuator, site)
        meetings = meetings_of(site, actuator)
        if meetings:
            met = "The blocks share their gain there; expect slower settling near it."
            if actuator.uses_shape:
                met = "The signal cannot tell them apart there: not judged, not saved meanwhile."
            text = f"{'; '.join(map(str, meetings))}. {met}"
            path: KeyPath = ("actuators", name, "blocks")
            yield Issue(path=path, text=text, warning=True, at_key=True)


def _angle(path: KeyPath, roll: Roll, site: Site) -> Iterator[Issue]:
    """Yield where the range of an encoder is too short for what its roll turns in a cycle."""
    channel = site.gateway.read.channels.get(roll.angle or "")
    range_rad = None if channel is None else channel.range_rad
    if range_rad is None or roll.smallest_radius_m == 0:
        return
    turned_rad = _speed_max_m_s(site) / roll.smallest_radius_m * site.cycle_s
    if 2.0 * turned_rad >= range_rad:
        text = (
            f"{roll.angle} starts over after {math.degrees(range_rad):.4g} degrees; its roll "
            f"turns {math.degrees(turned_rad):.3g} within a cycle, and half the range is what can "
            "be followed. Let the PLC count further, or shorten cycle_ms."
        )
        yield Issue(path=(*path, "angle"), text=text)


def _assumed(path: KeyPath) -> Issue:
    text = (
        "no winding: it counts as an unwind, whose radius only shrinks; a larger one is a fault. "
        "Write winding: unwind, or winding: rewind."
    )
    return Issue(path=path, text=text, warning=True, at_key=True)


def _of_record(path: KeyPath, roll: Roll) -> Iterator[Issue]:
    """Yield what keeps `watch` from using what a roll has for the record alone."""
    if roll.supplier is not None and roll.resets_on != "splice":
        text = "only a roll that is exchanged on the run has a supplier. Write resets_on: splice."
        yield Issue(path=(*path, "supplier"), text=text)
    sides = (roll.tension_before, roll.tension_after)
    if roll.torque is not None and sides == (None, None):
        text = "without tension_before or tension_after nothing of it is known to be friction."
        yield Issue(path=(*path, "torque"), text=text, warning=True)
    is_end = roll.radius is not None or roll.resets_on == "splice"
    if roll.torque is not None and sides.count(None) == 1 and not is_end:
        lacking = "tension_before" if roll.tension_before is None else "tension_after"
        text = (
            f"no {lacking}: the pull of the web on that side counts as friction, and its changes "
            f"as growth of it. Add {lacking}."
        )
        yield Issue(path=(*path, "torque"), text=text, warning=True)
    if roll.torque is None and sides != (None, None):
        text = "a tension beside the roll is for the friction of its drive. Add torque."
        yield Issue(path=path, text=text, warning=True, at_key=True)


def _radius(path: KeyPath, roll: Roll) -> Iterator[Issue]:
    if (roll.radius is None) == (roll.radius_m is None):
        text = "needs one of radius (a channel) and radius_m (a fixed radius)."
        yield Issue(path=path, text=text, at_key=True)
        return
    bounds = {"radius_min_m": roll.radius_min_m, "radius_max_m": roll.radius_max_m}
    for name, bound in bounds.items():
        if roll.radius is not None and bound is None:
            text = "required key is missing. A measured radius needs the range that occurs."
            yield Issue(path=(*path, name), text=text, at_key=True)
        if roll.radius is None and bound is not None:
            text = "only a measured radius has a range. Remove it, or name a radius channel."
            yield Issue(path=(*path, name), text=text, at_key=True)
    low, high = roll.radius_min_m, roll.radius_max_m
    if low is not None and high is not None and low >= high:
        text = f"{high:g} m is not above radius_min_m {low:g} m. Exchange the two."
        yield Issue(path=(*path, "radius_max_m"), text=text)


def _sampling(path: KeyPath, actuator: Actuator, site: Site) -> Iterator[Issue]:
    speed_m_s = _speed_max_m_s(site)
    if actuator.uses_shape:
        return  # its orders fade by themselves where the loop has no authority; `check` says which
    for index, block in enumerate(actuator.blocks):
        roll = site.rolls.get(block.roll)
        if roll is None or roll.smallest_radius_m == 0 or speed_m_s <= 0:
            continue
        order = max(block.orders)
        frequency = frequency_Hz(order, speed_m_s, roll.smallest_radius_m)
        samples = 1.0 / (frequency * site.cycle_s)
        if samples < SAMPLES_PER_PERIOD:
            limit_Hz = plain_limit_Hz(site.cycle_s)
            slower = speed_m_s * limit_Hz / frequency
            first = ""
            if actuator.stands_in:
                first = "it stands in until the drive is known: probe, or declare drive; else "
            text = (
                f"order {order} has {samples:.1f} samples per period at {speed_m_s:g} m/s and "
                f"radius {roll.smallest_radius_m:g} m ({frequency:.2f} Hz). The plain law sends "
                f"nothing above {limit_Hz:.4g} Hz at a cycle of {1e3 * site.cycle_s:g} ms: "
                f"{first}stay under {slower:.3g} m/s, leave the order out or shorten cycle_ms."
            )
            place = block.orders.index(order)
            where = (*path, "blocks", index, "orders", place)
            yield Issue(path=where, text=text, warning=True)


def _speed_max_m_s(site: Site) -> float:
    limits = site.plausibility.get(site.line.speed)
    if site.line.speed_max_m_s is None and (limits is None or limits.max_m_s is None):
        return 0.0
    return site.speed_max_m_s
