"""What an importer sees of a line: its inputs, outputs and parameters, each with a unit."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from sim_plant.export.channels import WEB_LEFT, OutputChannel, output_channels
from sim_plant.export.parameters import parameters_of
from sim_plant.export.variable import Variable, quoted
from sim_plant.line.running.simulation import LineSimulation


@dataclass(frozen=True, slots=True, kw_only=True)
class Interface:
    """All variables of an FMU in the order of their value references, which count from 0."""

    variables: tuple[Variable, ...]
    channels: tuple[OutputChannel, ...]

    def numbered(self, causality: str) -> list[tuple[int, Variable]]:
        """Return the variables of one causality with their value references."""
        pairs = enumerate(self.variables)
        return [(number, found) for number, found in pairs if found.causality == causality]


def interface_of(line: LineSimulation, speed_m_s: float, tension_N: float) -> Interface:
    """Return what an importer may set and read, with the values of the start.

    Parameters
    ----------
    line : settled, at ``speed_m_s`` and ``tension_N``.
    """
    channels = tuple(output_channels(line))
    outputs = (
        Variable(
            name=channel.name,
            description=channel.description,
            causality="output",
            variability="continuous",
            unit=channel.unit,
            shown=channel.name != WEB_LEFT,
            place=f"outputs[{number}]",
        )
        for number, channel in enumerate(channels)
    )
    time = Variable(
        name="time",
        description="Simulation time",
        causality="independent",
        variability="continuous",
        unit="s",
        place="now_s",
    )
    inputs = _inputs(line, speed_m_s, tension_N)
    every = (time, *inputs, *outputs, *parameters_of(line), _sample_time(line))
    return Interface(variables=every, channels=channels)


def _sample_time(line: LineSimulation) -> Variable:
    return Variable(
        name="sample_time_s",
        description="Sample time of the line: communication steps are whole multiples of it",
        causality="local",
        variability="constant",
        unit="s",
        start=line.sample_time_s,
        place="numbers.sample_time_s",
    )


def _inputs(line: LineSimulation, speed_m_s: float, tension_N: float) -> Iterator[Variable]:
    yield _held("line_speed_ref_m_s", "Line speed reference", "m/s", speed_m_s, 100.0)
    largest_N = max(0.1 * line.declaration.web.EA_N, tension_N)
    for number, loop in enumerate(line.declaration.control.tension_pi):
        text = f"Tension reference of the loop {loop.loop}: load cell {loop.load_cell}, "
        yield replace(
            _held(f"tension_ref_{loop.loop}_N", text, "N", tension_N, largest_N),
            description=text + f"acts on {loop.acts_on}",
            low=min(0.0, tension_N),
            place=f"tension_ref_N[{number}]",
        )
    drives = line.declaration.control.drives
    for number, drive in enumerate(drives):
        text = f"Correction added to the velocity reference of the drive of {drive.roller}"
        made = _held(f"aff_{drive.roller}_m_s", text, "m/s", 0.0, 100.0)
        yield replace(made, place=f"corrections[{number}]")
    for number, drive in enumerate(drives):
        text = f"Correction added to the torque of the drive of {drive.roller}, within its limit"
        made = _held(f"aff_{drive.roller}_N_m", text, "N.m", 0.0, 1e6)
        yield replace(made, place=f"corrections[{len(drives) + number}]")
    for c, carriage in enumerate(line.declaration.carriages):
        if carriage.name in line.driven_travels:
            text = f"Speed of {carriage.name} by its own drive: positive fills it"
            made = _held(f"travel_{carriage.name}_m_s", text, "m/s", 0.0, 10.0)
            yield replace(made, place=f"numbers.carriages[{c}].speed_m_s")
    for name, text in (
        ("splice", "From false to true: the unwind goes on with web as splice.* say"),
        ("roll_change", "From false to true: full rolls at both ends, at the web's speed"),
    ):
        yield replace(
            _held(name, text, "", 0.0, 1.0), kind="truth", variability="discrete", low=0.0
        )


def _held(name: str, text: str, unit: str, start: float, largest: float) -> Variable:
    """Return an input that its name is the place of."""
    return Variable(
        name=quoted(name),
        description=text,
        causality="input",
        variability="continuous",
        unit=unit,
        start=start,
        low=min(-largest, start),
        high=max(largest, start),
        place=name,
    )
