"""Channels: their names carry a unit, who uses them exists, the units agree."""

from __future__ import annotations

from collections.abc import Iterator

from aff_runtime.base.channel_units import ENDINGS, suffix_of_unit, unit_of_channel
from aff_runtime.base.runs.counted_angle import WORD_COUNTS
from aff_runtime.base.suggest import meant
from aff_runtime.config.findings import KeyPath
from aff_runtime.config.models import Channel, PlausibleRange, Site
from aff_runtime.config.rules.issue import Issue


def issues(site: Site) -> Iterator[Issue]:
    """Yield what is wrong with channels and with those who name them."""
    for name, channel in site.gateway.read.channels.items():
        yield from _channel(name, channel)
    yield from _uses(site)
    yield from _plausibility(site)


def _channel(name: str, channel: Channel) -> Iterator[Issue]:
    path: KeyPath = ("gateway", "read", "channels", name)
    unit = unit_of_channel(name)
    if unit is None:
        text = f"the name does not end with its SI unit. Let it end with one of: {ENDINGS}."
        yield Issue(path=path, text=text, at_key=True)
    if channel.scale == 0:
        text = "0 would make every value 0. Write the SI units in one count."
        yield Issue(path=(*path, "scale"), text=text)
    if unit == "" and channel.scale not in (0, 1):
        text = "a number is taken as the PLC has it. Write scale: 1."
        yield Issue(path=(*path, "scale"), text=text)
    if unit == "rad" and not channel.wraps:
        text = "an angle count starts over some day. Write wraps: true."
        yield Issue(path=path, text=text, at_key=True, warning=True)
    if channel.wraps and unit not in ("rad", None):
        text = f"only an angle starts over; {name} is {_in(unit)}. Remove wraps."
        yield Issue(path=(*path, "wraps"), text=text)
    if channel.wraps_after is not None:
        yield from _wraps_after((*path, "wraps_after"), channel, channel.wraps_after)


def _wraps_after(path: KeyPath, channel: Channel, counts: int) -> Iterator[Issue]:
    """Yield what is wrong with the range of a count that starts over early."""
    if channel.type is None:
        text = "on CAN the range of the signal says after how much it starts over. Remove it."
        yield Issue(path=path, text=text, at_key=True)
        return
    if not channel.wraps:
        text = "needs wraps: true. Add it, or remove wraps_after."
        yield Issue(path=path, text=text, at_key=True)
    if counts > (most := WORD_COUNTS[channel.type]):
        text = f"{counts} is more than {channel.type} holds, {most}. Correct it, or leave it out."
        yield Issue(path=path, text=text)


def _uses(site: Site) -> Iterator[Issue]:
    yield from _use(site, ("line", "speed"), site.line.speed, ("m/s",))
    yield from _use(site, ("line", "speed_reference"), site.line.speed_reference, ("m/s",))
    for name, roll in site.rolls.items():
        path: KeyPath = ("rolls", name)
        yield from _use(site, (*path, "angle"), roll.angle, ("rad",))
        yield from _use(site, (*path, "speed"), roll.speed, ("rad/s", "m/s"))
        yield from _use(site, (*path, "line_speed"), roll.line_speed, ("m/s",))
        yield from _use(site, (*path, "radius"), roll.radius, ("m",))
        yield from _use(site, (*path, "supplier"), roll.supplier, ("",))
        yield from _use(site, (*path, "torque"), roll.torque, ("N m",))
        yield from _use(site, (*path, "tension_before"), roll.tension_before, ("N",))
        yield from _use(site, (*path, "tension_after"), roll.tension_after, ("N",))
    for name, actuator in site.actuators.items():
        path = ("actuators", name, "error")
        error = actuator.error
        yield from _use(site, (*path, "signal"), error.signal, ("N", "m/s", "rad/s"))
        unit = unit_of_channel(error.signal)
        if unit is not None:
            yield from _use(site, (*path, "reference"), error.reference, (unit,))


def _use(
    site: Site, path: KeyPath, channel: str | None, units: tuple[str, ...]
) -> Iterator[Issue]:
    if channel is None:
        return
    channels = site.gateway.read.channels
    unit = unit_of_channel(channel)
    if channel not in channels:
        text = f"{channel} is no channel of gateway.read. {meant(channel, channels)}"
        yield Issue(path=path, text=text)
    elif unit is not None and unit not in units:
        wanted = f"in {' or '.join(units)}" if any(units) else "that ends with _number"
        text = f"{channel} is {_in(unit)}. Name a channel {wanted}."
        yield Issue(path=path, text=text)


def _in(unit: str | None) -> str:
    return f"in {unit}" if unit else "a number without a unit"


def _plausibility(site: Site) -> Iterator[Issue]:
    for name, limits in site.plausibility.items():
        path: KeyPath = ("plausibility", name)
        channels = site.gateway.read.channels
        if name not in channels:
            text = f"is no channel of gateway.read. {meant(name, channels)}"
            yield Issue(path=path, text=text, at_key=True)
            continue
        unit = unit_of_channel(name)
        if unit is not None:
            yield from _range(path, limits, unit)
    for name in _must_be_plausible(site):
        if name not in site.plausibility and name in site.gateway.read.channels:
            text = f"{name} has no believable range, but the correction depends on it. Add it."
            yield Issue(path=("plausibility",), text=text, at_key=True)


def _range(path: KeyPath, limits: PlausibleRange, unit: str) -> Iterator[Issue]:
    if unit in ("rad", ""):
        text = "an angle has no believable range; its speed is watched. Remove this line."
        if not unit:
            text = "a number has no believable range. Remove this line."
        yield Issue(path=path, text=text, at_key=True)
        return
    suffix = suffix_of_unit(unit)
    wanted = {f"min_{suffix}", f"max_{suffix}"}
    given = limits.model_dump(exclude_none=True).keys() - {"stuck_after_s"}
    for name in sorted(given - wanted):
        text = f"the channel is in {unit}. Write {name[:4]}{suffix}."
        yield Issue(path=(*path, name), text=text, at_key=True)
    missing = sorted(wanted - given, reverse=True)
    if missing and given <= wanted:
        text = f"required key is missing. Write min_{suffix} and max_{suffix}."
        yield Issue(path=(*path, missing[0]), text=text, at_key=True)
    if given == wanted and limits.low >= limits.high:
        text = f"{limits.high:g} is not above the minimum {limits.low:g}. Exchange the two."
        yield Issue(path=(*path, f"max_{suffix}"), text=text)


def _must_be_plausible(site: Site) -> list[str]:
    names = [site.line.speed]
    for actuator in site.actuators.values():
        if actuator.error.signal not in names:
            names.append(actuator.error.signal)
    return names
