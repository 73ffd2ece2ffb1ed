"""Outputs of a line: recorded channels, measured and true, and what no sensor sees."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from sim_plant.export.variable import quoted
from sim_plant.line.declared.declaration import CarriagePosition, DriveSpeed, LoadCell, RollAngle
from sim_plant.line.declared.declared_bodies import section_of
from sim_plant.line.running.channels import Channel
from sim_plant.line.running.simulation import LineSimulation

WEB_LEFT = "web_left_m"


@dataclass(frozen=True, slots=True, kw_only=True)
class OutputChannel:
    """How one output is read from a row; the row's last columns are torques and web left."""

    name: str
    description: str
    unit: str
    column: int
    exact_column: int
    scale: float = 1.0
    lsb: float = 0.0
    zero: int = -1
    eccentricity: float = 0.0
    eccentricity_angle_rad: float = 0.0

    @property
    def c_row(self) -> str:
        """The row of the C table."""
        numbers = (self.scale, self.lsb, self.eccentricity, self.eccentricity_angle_rad)
        floats = ", ".join(repr(float(number)) for number in numbers)
        return f"    {{{self.column}, {self.exact_column}, {self.zero}, {floats}}},"


def output_channels(line: LineSimulation) -> Iterator[OutputChannel]:
    """Yield every output, recorded channels first."""
    units = {sensor.channel: _unit_of(sensor) for sensor in line.declaration.sensors}
    rollers = {sensor.channel: sensor.roller for sensor in line.declaration.sensors}
    travels = {s.channel for s in line.declaration.sensors if isinstance(s, CarriagePosition)}
    for channel in line.channels:
        kind = "Travel" if channel.name in travels else _WHAT[units[channel.name]]
        what = f"{kind} at {rollers[channel.name]}"
        yield _measured(channel, units[channel.name], f"{what}, as the line's sensor reads it")
        yield OutputChannel(
            name=quoted(f"true_{channel.name}"),
            description=f"{what}, without noise, resolution and encoder's error",
            unit=units[channel.name],
            column=channel.true_column,
            exact_column=channel.true_column,
            scale=channel.scale,
            zero=channel.theta_body,
        )
    yield from _unseen(line)


_WHAT = {"N": "Tension", "m": "Radius", "rad": "Angle", "rad/s": "Speed", "m/s": "Speed"}


def _unit_of(sensor: object) -> str:
    if isinstance(sensor, LoadCell):
        return "N"
    if isinstance(sensor, DriveSpeed):
        return "m/s" if sensor.scale_radius_m else "rad/s"
    return "rad" if isinstance(sensor, RollAngle) else "m"


def _measured(channel: Channel, unit: str, text: str) -> OutputChannel:
    return OutputChannel(
        name=quoted(channel.name),
        description=text,
        unit=unit,
        column=channel.column,
        exact_column=channel.exact_column,
        scale=channel.scale,
        lsb=channel.lsb,
        zero=channel.zero,
        eccentricity=channel.eccentricity,
        eccentricity_angle_rad=channel.eccentricity_angle_rad,
    )


def _unseen(line: LineSimulation) -> Iterator[OutputChannel]:
    at, names = line.log, [roller.name for roller in line.declaration.rollers]
    for k, name in enumerate(names):
        text = f"Angle that {name} has turned since the start, in its sense of transport"
        yield _true(f"rollers.{quoted(name)}.angle_rad", text, "rad", at.theta_rad + k, k)
    for end, name in enumerate((names[0], names[-1])):
        where = f"rollers.{quoted(name)}.radius_now_m"
        yield _true(where, f"Mean radius of {name} now", "m", at.radius_m + end)
    for d, drive in enumerate(line.declaration.control.drives):
        where = f"rollers.{quoted(drive.roller)}.torque_N_m"
        yield _true(where, f"Torque of the drive of {drive.roller}", "N.m", at.width + d)
    for i in range(len(names) - 1):
        where = f"spans.{quoted(names[i] + '_' + names[i + 1])}.tension_N"
        text = f"Tension of the web between {names[i]} and {names[i + 1]}"
        yield _true(where, text, "N", at.tension_N + i)
    for c, carriage in enumerate(line.declaration.carriages):
        where = f"{section_of(carriage)}.{quoted(carriage.name)}.travel_now_m"
        text = f"Travel of {carriage.name}, 0 where the line file puts its rollers"
        yield _true(where, text, "m", at.travel_m + c)
    left = f"Length of web on {names[0]} down to its core"
    yield _true(WEB_LEFT, left, "m", at.width + line.arrays.drives.size)


def _true(name: str, text: str, unit: str, column: int, zero: int = -1) -> OutputChannel:
    return OutputChannel(
        name=name, description=text, unit=unit, column=column, exact_column=column, zero=zero
    )
