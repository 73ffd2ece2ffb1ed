"""What an importer sees of a line: its inputs, outputs and parameters, each with a unit."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from sim_plant.export.channels import OutputChannel, output_channels
from sim_plant.export.parameters import parameters_of
from sim_plant.export.variable import Variable
from sim_plant.line.simulation import LineSimulation


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
    def held(name: str, text: str, unit: str, place: str, start: float = 0.0) -> Variable:
        return Variable(
            name=name,
            description=text,
            causality="input",
            variability="continuous",
            unit=unit,
            start=start,
            low=-1e9,
            high=1e9,
            place=place,
        )

    yield held(
        "line_speed_ref_m_s", "Line speed reference", "m/s", "line_speed_ref_m_s", speed_m_s
    )
    for number, loop in enumerate(line.declaration.control.tension_pi):
        yield held(
            f"tension_ref_{loop.loop}_N",
            f"Tension reference of the loop {loop.loop}: load cell {loop.load_cell}, "
            f"acts on {loop.acts_on}",
            "N",
            f"tension_ref_N[{number}]",
            tension_N,
        )
    drives = line.declaration.control.drives
    for shift, ending, unit, text in (
        (0, "m_s", "m/s", "velocity reference"),
        (len(drives), "N_m", "N.m", "torque, within the drive's limit"),
    ):
        for number, drive in enumerate(drives):
            yield held(
                f"aff_{drive.roller}_{ending}",
                f"Correction added to the {text} of the drive of {drive.roller}",
                unit,
                f"corrections[{shift + number}]",
            )
    for name, text in (
        ("splice", "From false to true: the unwind goes on with web as splice.* say"),
        ("roll_change", "From false to true: full rolls at both ends, at the web's speed"),
    ):
        yield Variable(
            name=name,
            description=text,
            kind="truth",
            causality="input",
            variability="discrete",
            start=0,
            low=0,
            high=1,
            place=name,
        )
