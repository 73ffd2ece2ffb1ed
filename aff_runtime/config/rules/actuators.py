"""Actuators, their corrections and blocks: names pair up, limits fit unit and word."""

from __future__ import annotations

from collections.abc import Iterator

from aff_runtime.base.channel_units import suffix_of_unit
from aff_runtime.base.suggest import meant
from aff_runtime.base.units import plain
from aff_runtime.config.findings import KeyPath
from aff_runtime.config.models import Actuator, Block, Site
from aff_runtime.config.rules.issue import Issue

MIN_COUNTS = 5
"""Of the correction word in the largest amplitude of a block: with fewer it goes in steps."""
_I16_MAX = 32767


def issues(site: Site) -> Iterator[Issue]:
    """Yield what is wrong with actuators, corrections and blocks."""
    corrections = site.gateway.write.corrections
    for name in corrections:
        if name not in site.actuators:
            text = f"{name} is no actuator. {meant(name, site.actuators)}"
            path: KeyPath = ("gateway", "write", "corrections", name)
            yield Issue(path=path, text=text, at_key=True)
    for name in site.gateway.applied:
        if name not in site.actuators:
            text = f"{name} is no actuator. {meant(name, site.actuators)}"
            path = ("gateway", "read", "applied", name)
            yield Issue(path=path, text=text, at_key=True)
    responses: dict[str, str] = {}
    for name, actuator in site.actuators.items():
        path = ("actuators", name)
        if name not in corrections:
            text = f"{name} has no gateway.write.corrections. {meant(name, corrections)}"
            yield Issue(path=path, text=text, at_key=True)
        yield from _limits(path, actuator)
        if name in corrections:
            scale = corrections[name].scale
            if site.gateway.modbus is not None:  # elsewhere the signal's own bits: config.can_wire
                yield from _reach(path, actuator, scale)
            yield from _resolution(path, actuator, scale)
        yield from _applied(name, site)
        yield from _blocks(path, actuator, site)
        other = responses.setdefault(actuator.response, name)
        if other != name:
            text = f"{actuator.response} is the response of {other}. Name a file of its own."
            yield Issue(path=(*path, "response"), text=text)
    if tuple(corrections) != tuple(site.actuators) and set(corrections) == set(site.actuators):
        text = f"the order differs from actuators. Write {', '.join(site.actuators)}."
        yield Issue(path=("gateway", "write", "corrections"), text=text, at_key=True)


def _applied(name: str, site: Site) -> Iterator[Issue]:
    """Yield that the word of an applied correction cannot show the whole limit; on Modbus."""
    actuator, shown = site.actuators[name], site.gateway.applied.get(name)
    if shown is None or site.gateway.modbus is None:
        return
    counts = actuator.limit / shown.scale
    if counts > _I16_MAX:
        text = (
            f"the limit {plain(actuator.limit)} {actuator.unit} is {counts:.0f} counts of "
            f"{plain(shown.scale)}; the word holds {_I16_MAX}. Need a coarser scale."
        )
        yield Issue(path=("gateway", "read", "applied", name, "scale"), text=text)


def _limits(path: KeyPath, actuator: Actuator) -> Iterator[Issue]:
    unit = actuator.unit
    suffix = suffix_of_unit(unit)
    yield from _one_unit(path, actuator, "limit", suffix, unit)
    yield from _one_unit(path, actuator, "slew", f"{suffix}2" if unit == "m/s" else "N_m_s", unit)
    for index, block in enumerate(actuator.blocks):
        where = (*path, "blocks", index)
        yield from _one_unit(where, block, "amp_limit", suffix, unit)
        if block.amp_limit > actuator.limit > 0:
            text = (
                f"{plain(block.amp_limit)} {unit} is above the actuator's limit "
                f"{plain(actuator.limit)} {unit}. Lower it."
            )
            yield Issue(path=(*where, f"amp_limit_{suffix}"), text=text)


def _one_unit(
    path: KeyPath, section: Actuator | Block, stem: str, suffix: str, unit: str
) -> Iterator[Issue]:
    """Yield that a key is not in the unit of the output: ``stem`` and ``suffix`` make its name."""
    given = {name for name in section.model_dump(exclude_none=True) if name.startswith(f"{stem}_")}
    wanted = f"{stem}_{suffix}"
    for name in sorted(given - {wanted}):
        text = f"the actuator's output is in {unit}. Write {wanted}."
        yield Issue(path=(*path, name), text=text, at_key=True)
    if not given:
        text = f"required key is missing for an output in {unit}."
        yield Issue(path=(*path, wanted), text=text, at_key=True)


def _reach(path: KeyPath, actuator: Actuator, scale: float) -> Iterator[Issue]:
    """Yield that the word of a correction does not hold the limit."""
    unit, counts = actuator.unit, actuator.limit / scale
    if counts > _I16_MAX:
        text = (
            f"{plain(actuator.limit)} {unit} is {counts:.0f} counts of {plain(scale)}; the word "
            f"holds {_I16_MAX}. Need a coarser scale or a lower limit."
        )
        yield Issue(path=(*path, f"limit_{suffix_of_unit(unit)}"), text=text)


def _resolution(path: KeyPath, actuator: Actuator, scale: float) -> Iterator[Issue]:
    unit = actuator.unit
    suffix = suffix_of_unit(unit)
    for index, block in enumerate(actuator.blocks):
        counts = block.amp_limit / scale
        if 0 < counts < MIN_COUNTS * (1 - 1e-9):
            text = (
                f"{plain(block.amp_limit)} {unit} is {counts:.2g} counts of the correction word "
                f"({plain(scale)}). Need >= {MIN_COUNTS}: a finer scale or a higher limit."
            )
            yield Issue(path=(*path, "blocks", index, f"amp_limit_{suffix}"), text=text)


def _blocks(path: KeyPath, actuator: Actuator, site: Site) -> Iterator[Issue]:
    seen: dict[tuple[str, int], int] = {}
    for index, block in enumerate(actuator.blocks):
        where = (*path, "blocks", index)
        if block.roll not in site.rolls:
            text = f"{block.roll} is no roll. {meant(block.roll, site.rolls)}"
            yield Issue(path=(*where, "roll"), text=text)
        for at, order in enumerate(block.orders):
            other = seen.setdefault((block.roll, order), index)
            if other != index or block.orders.index(order) != at:
                text = (
                    f"order {order} of {block.roll} is already in blocks[{other}]; twice doubles "
                    "its gain. Remove one."
                )
                yield Issue(path=(*where, "orders", at), text=text)
