"""The AFF blocks put into the site file's text, at their place; comments stay the owner's."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from aff_runtime.base.errors import PlantError
from aff_runtime.base.printable import printable
from aff_runtime.base.units import UnitError, read_number
from sim_plant.base.plain_file import read_plain_text
from sim_plant.base.yaml_edit import lost_comments, with_keys
from sim_plant.line.declared.declaration import Declaration
from sim_plant.line.yaml_file import LONGEST_BYTES, parse_yaml
from sim_plant.refine.model.site_match import channels_of, driven_roller, site_name
from sim_plant.refine.records.run_site import RunSite, run_site
from sim_plant.refine.report.aff_block import AffBlock

FILE = "site_proposed.yaml"
KEYS = ("rolls", "actuators")


@dataclass(frozen=True, slots=True, kw_only=True)
class SiteFile:
    """A site file as its owner wrote it; `aff-runtime check` judges whether it is right.

    Attributes
    ----------
    rolls, actuators : these sections, as plain values. ``names`` : what the whole file says of
        channels and actuators.
    """

    path: Path
    text: str
    rolls: Any
    actuators: Any
    names: RunSite

    @classmethod
    def read(cls, path: Path) -> SiteFile:
        """Read it.

        Raises
        ------
        PlantError
            When it cannot be read, or has no actuators with blocks or no channels.
        """
        text = read_plain_text(path, LONGEST_BYTES)
        data, _ = parse_yaml(text, printable(str(path)))
        sections: list[Any] = [data.get(k) if isinstance(data, dict) else None for k in KEYS]
        rolls, actuators = sections
        if (
            not _are_sections(rolls)
            or not _are_sections(actuators)
            or not all(_has_blocks(actuator) for actuator in actuators.values())
        ):
            raise PlantError(
                f"{path}: read a file without rolls and actuators with blocks; expected the site "
                "file of the service; see `aff-runtime check`"
            )
        names = run_site(text, printable(str(path)))
        return cls(path=path, text=text, rolls=rolls, actuators=actuators, names=names)


def _are_sections(value: Any) -> bool:
    return isinstance(value, dict) and all(isinstance(one, dict) for one in value.values())


def _has_blocks(actuator: Any) -> bool:
    """Return whether an actuator has the keys that this module reads."""
    blocks, error = actuator.get("blocks"), actuator.get("error")
    return (
        isinstance(error, dict)
        and isinstance(actuator.get("drive", {}), dict)
        and isinstance(blocks, list)
        and all(isinstance(b, dict) and isinstance(b.get("orders"), list) for b in blocks)
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Proposal:
    """A site file's text with blocks in it.

    Attributes
    ----------
    text : as the owner's but for the blocks; the owner's own where nothing is to be added.
    said : per block what was done, or why nothing was.
    adds : the text differs from the owner's.
    """

    text: str
    said: tuple[str, ...]
    adds: bool


def proposed(
    site: SiteFile,
    blocks: Sequence[AffBlock],
    declaration: Declaration,
    adjustments: Mapping[str, float] | None = None,
) -> Proposal:
    """Return the text with every block in the list of the actuator that acts on its zone.

    Of a roll that has an entry there, only orders that it lacks are added: its tuning is the
    owner's. So is whether it is switched on: of an entry that is not, that is said. A roll that
    the file does not know comes under ``rolls``, with the radius that the records gave. Where a
    comment of the owner's would be lost nothing is added, and that is said.

    Parameters
    ----------
    adjustments : shares added to declared numbers, by dotted path.
    """
    data = {"rolls": deepcopy(site.rolls), "actuators": deepcopy(site.actuators)}
    said = []
    for block in blocks:
        actuator, why = _actuator(block, site, declaration)
        said.append(
            _add(data, block, actuator, declaration, adjustments or {}) if actuator else why
        )
    same = data == {"rolls": site.rolls, "actuators": site.actuators}
    text = site.text if same else with_keys(site.text, data, short=True)
    if lost := lost_comments(site.text, text):
        reason = (
            f"no {FILE}: {len(lost)} comments of the file would be lost, the first is "
            f"{printable(lost[0], 60)!r}; put the entries of aff_block.yaml in by hand"
        )
        return Proposal(text=site.text, said=(reason,), adds=False)
    return Proposal(text=text, said=tuple(said), adds=text != site.text)


def _add(
    data: Any,
    block: AffBlock,
    actuator: str,
    declaration: Declaration,
    adjustments: Mapping[str, float],
) -> str:
    """Put one block into the list of an actuator; return what was done."""
    roll, entries = site_name(block.roll), data["actuators"][actuator]["blocks"]
    where = f"actuators.{actuator}.blocks"
    own = [entry for entry in entries if entry.get("roll") == roll]
    if any(entry.get("enabled") is False for entry in own):
        return (
            f"{where}: {roll} is there, switched off (enabled: false), so nothing cancels it; "
            "nothing is added, switch it on"
        )
    if own:
        known = {order for entry in own for order in entry["orders"]}
        fresh = [order for order in block.orders if order not in known]
        if not fresh:
            return f"{where}: has all orders of {roll} already"
        own[0]["orders"] = sorted([*own[0]["orders"], *fresh])
        return f"{where}: orders {', '.join(map(str, fresh))} of {roll} added"
    limit_m_s = _limit_m_s(data["actuators"][actuator].get("limit_m_s"))
    entries.append(block.entry() | {"amp_limit_m_s": min(block.amp_limit_m_s, limit_m_s)})
    if roll in data["rolls"]:
        radius = _own_radius(data["rolls"][roll])
        if not radius:
            return f"{where}: {roll} added"
        ours = 1e3 * _radius_m(block.roll, declaration, adjustments)
        return f"{where}: {roll} added, {radius}; by the records {ours:.5g} mm"
    radius_m = _radius_m(block.roll, declaration, adjustments)
    data["rolls"][roll] = {"radius_m": round(radius_m, 7)}
    return f"{where}: {roll} added, and rolls.{roll} with a radius of {radius_m * 1e3:.5g} mm"


def _own_radius(given: Any) -> str:
    """Return the radius of the owner's by which a roll turns, in words.

    Nothing of a roll that is followed by its angle or its speed, or whose radius is measured.
    """
    if given.get("angle") or given.get("speed") or given.get("radius_m") is None:
        return ""
    try:
        own_m = read_number(given["radius_m"], "m")
    except UnitError:
        return ""  # `aff-runtime check` names it
    return f"with the file's own radius of {1e3 * own_m:.5g} mm"


def _limit_m_s(given: Any) -> float:
    """Return an actuator's limit as the service reads it; infinite where none can be read."""
    try:
        return math.inf if given is None else read_number(given, "m/s")
    except UnitError:
        return math.inf  # `aff-runtime check` names it


def _radius_m(name: str, declaration: Declaration, adjustments: Mapping[str, float]) -> float:
    """Return a roller's radius as the records show it."""
    radius_m = declaration.rollers[declaration.body(name)].radius_m
    return radius_m * (1.0 + adjustments.get(f"rollers.{name}.radius_m", 0.0))


def _actuator(block: AffBlock, site: SiteFile, declaration: Declaration) -> tuple[str, str]:
    """Return the actuator that a block belongs to, or an empty name and why there is none."""
    at = declaration.body(block.roll)
    actuator = _of_drive(block.roll, site, declaration) or _of_zone(at, site, declaration)
    if not actuator:
        return "", (
            f"{block.roll}: no actuator of the site file corrects the tension where it runs; "
            "nothing is added"
        )
    if site.actuators[actuator].get("output") != "velocity_reference":
        return "", f"{block.roll}: actuators.{actuator} is no velocity reference; nothing is added"
    return actuator, ""


def _of_drive(roller: str, site: SiteFile, declaration: Declaration) -> str:
    """Return the actuator that turns a roller itself."""
    for name, actuator in site.names.actuators.items():
        if driven_roller(declaration, name, actuator.roll) == roller:
            return name
    return ""


def _of_zone(at: int, site: SiteFile, declaration: Declaration) -> str:
    """Return the actuator whose tension is measured between the same driven rollers as ``at``."""
    driven = sorted(declaration.body(drive.roller) for drive in declaration.control.drives)
    before = max((k for k in driven if k <= at), default=-1)
    after = min((k for k in driven if k > at), default=len(declaration.rollers))
    channels = channels_of(declaration, site.names, site.names.count_sizes)
    signals = {
        channels.get(sensor.channel, "")
        for sensor in declaration.sensors
        if before <= declaration.body(sensor.roller) <= after
    }
    for name, actuator in site.names.actuators.items():
        if actuator.signal and actuator.signal in signals:
            return name
    return ""
