"""Which driven roller each actuator of a site file is, and which sensor each channel is.

A site calls actuators and signals as it likes. An actuator is of the roller that its declared
drive turns, else of the one that it is named after; a channel is what has its name, else what the
site file uses it for.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping

from sim_plant.line.declared.declaration import (
    CarriagePosition,
    Declaration,
    DriveSpeed,
    LoadCell,
    RollAngle,
    RollRadius,
    Sensor,
)
from sim_plant.refine.records.run_site import RunActuator, RunSite


def site_name(roller: str) -> str:
    """Return a roller's name as a site file takes it: small letters, digits, underscores."""
    name = re.sub(r"[^a-z0-9_]", "_", roller.lower())[:48]
    return name if name[:1].isalpha() else f"roller_{name}"[:48]


def driven_roller(line: Declaration, actuator: str, roll: str) -> str:
    """Return the driven roller of the line that an actuator turns; empty where it is none.

    ``roll`` : of its declared drive, or empty. It goes before the actuator's own name.
    """
    drives = {site_name(drive.roller): drive.roller for drive in line.control.drives}
    return drives.get(site_name(roll)) or drives.get(site_name(actuator)) or ""


def actuators_of(line: Declaration, site: RunSite, roller: str) -> list[RunActuator]:
    """Return the actuators that turn a roller."""
    return [a for name, a in site.actuators.items() if driven_roller(line, name, a.roll) == roller]


def channels_of(line: Declaration, site: RunSite, recorded: Collection[str]) -> dict[str, str]:
    """Return the channel of the site by that of the line, of every sensor that is ``recorded``."""
    return dict(_channels(line, site, recorded))


def _channels(
    line: Declaration, site: RunSite, recorded: Collection[str]
) -> Iterator[tuple[str, str]]:
    taken = {s.channel for s in line.sensors if s.channel in recorded}
    for sensor in line.sensors:
        if sensor.channel in recorded:
            yield sensor.channel, sensor.channel
            continue
        by_use = _by_use(line, site, sensor, recorded)
        if by_use in recorded and by_use not in taken:
            taken.add(by_use)
            yield sensor.channel, by_use


def _by_use(line: Declaration, site: RunSite, sensor: Sensor, recorded: Collection[str]) -> str:
    """Return the channel that the site file uses for what this sensor measures, or nothing."""
    rolls = {site_name(name): uses for name, uses in site.rolls.items()}
    uses = rolls.get(site_name(sensor.roller), {})
    if isinstance(sensor, RollAngle):
        return uses.get("angle", "")
    if isinstance(sensor, RollRadius):
        return uses.get("radius", "")
    if isinstance(sensor, CarriagePosition):
        return ""  # a site file has no key for it
    if isinstance(sensor, LoadCell):
        return _signal_of(line, site, sensor) or _signal_downstream_of_drive(
            line, site, sensor, recorded
        )
    unit_suffix = "_m_s" if sensor.scale_radius_m is not None else "_rad_s"
    speed = uses.get("speed", "")
    if speed.endswith(unit_suffix):
        return speed
    # a drive without a speed of its own: the line speed is that of the first one in m/s
    first = next((s for s in line.sensors if isinstance(s, DriveSpeed) and s.scale_radius_m), None)
    return site.speed if sensor is first else ""


def _signal_of(line: Declaration, site: RunSite, cell: LoadCell) -> str:
    """Return the error signal of the actuator of this cell's tension loop, if it is a tension."""
    for loop in line.control.tension_pi:
        acting = actuators_of(line, site, loop.acts_on) if loop.load_cell == cell.roller else []
        if acting:
            return acting[0].signal if acting[0].signal.endswith("_N") else ""
    return ""


def _signal_downstream_of_drive(
    line: Declaration, site: RunSite, cell: LoadCell, recorded: Collection[str]
) -> str:
    """Return the error signal of the actuator on the drive upstream, if no loop acts on that.

    It is a tension of the zone downstream of the drive. Which cell measures it is clear only if at
    most one cell there is not recorded by its own name.
    """
    at = line.body(cell.roller)
    driven = sorted(line.body(d.roller) for d in line.control.drives)
    drive_upstream = max((k for k in driven if k < at), default=-1)
    next_drive = min((k for k in driven if k > at), default=len(line.rollers))
    unnamed_cells = [
        s
        for s in line.sensors
        if isinstance(s, LoadCell)
        and s.channel not in recorded
        and drive_upstream < line.body(s.roller) < next_drive
    ]
    roller = line.rollers[drive_upstream].name if drive_upstream >= 0 else ""
    if len(unnamed_cells) > 1 or roller in (
        "",
        *(loop.acts_on for loop in line.control.tension_pi),
    ):
        return ""
    acting = actuators_of(line, site, roller)
    return acting[0].signal if acting and acting[0].signal.endswith("_N") else ""


def tension_references(
    line: Declaration, site: RunSite, channels: Mapping[str, str]
) -> Iterator[str]:
    """Yield the site's channels for the set point of a tension loop of the line.

    That is the reference of what keeps the loop's own tension quiet: of the actuator that the
    loop acts on or whose signal is the loop's cell, and not where it is that of another cell.
    """
    channel_of_cell = {
        s.roller: channels.get(s.channel) for s in line.sensors if isinstance(s, LoadCell)
    }
    for loop in line.control.tension_pi:
        loop_channel = channel_of_cell.get(loop.load_cell)
        for name, actuator in site.actuators.items():
            acts = driven_roller(line, name, actuator.roll) == loop.acts_on
            elsewhere = (
                actuator.signal != loop_channel and actuator.signal in channel_of_cell.values()
            )
            is_own = actuator.signal == loop_channel or (acts and not elsewhere)
            if is_own and actuator.reference.endswith("_N"):
                yield actuator.reference
