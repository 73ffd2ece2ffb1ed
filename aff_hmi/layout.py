"""What a page consists of: rows by the site's own names. It changes with the site alone."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass
from functools import cached_property

from aff_runtime.app.door.messages import Facts
from aff_runtime.app.report.line_facts import VELOCITY, LineFacts, OutputFacts
from aff_runtime.base.channel_units import suffix_of_unit, unit_of_channel
from aff_runtime.base.printable import printable

LONGEST = 60


@dataclass(frozen=True, slots=True, kw_only=True)
class Tension:
    """One measured tension; ``reference`` is the channel of its set point, or empty."""

    channel: str
    label: str
    reference: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Output:
    """One actuator, in the unit of the screen: mm/s or N m.

    Attributes
    ----------
    limit : largest correction. ``signal`` : label of what it keeps quiet.
    signal_unit : of the ripple, N or mm/s.
    """

    actuator: str
    label: str
    unit: str
    limit: float
    signal: str
    signal_unit: str


@dataclass(frozen=True, kw_only=True)
class Layout:
    """All rows of the overview.

    Attributes
    ----------
    line : name of the line. ``ident`` : changes when any row does, and a page is another one; a
        limit is no part of it, for a try of settings changes it while pages are open.
    rolls : (name, label) of those whose radius is measured.
    """

    line: str = ""
    tensions: tuple[Tension, ...] = ()
    outputs: tuple[Output, ...] = ()
    rolls: tuple[tuple[str, str], ...] = ()
    speed: str = ""

    @cached_property
    def ident(self) -> str:
        """Return a digest of everything that a page shows of it."""
        rows = asdict(self)
        for output in rows["outputs"]:
            del output["limit"]
        return hashlib.sha256(json.dumps(rows).encode()).hexdigest()[:16]


def layout_of(facts: Facts | None, channels: tuple[str, ...]) -> Layout:
    """Return the rows of a line; none before the service has told of one.

    Parameters
    ----------
    channels : measured, in the order of the record.
    """
    site = facts.status.facts if facts is not None else None
    if facts is None or site is None:
        return Layout()
    references = {output.signal: output.reference for output in site.outputs}
    return Layout(
        line=printable(facts.status.line, LONGEST),
        tensions=tuple(
            Tension(channel=name, label=label_of(name), reference=references.get(name, ""))
            for name in channels
            if name.endswith("_tension_N") and name not in site.references
        ),
        outputs=tuple(_output(output) for output in site.outputs),
        rolls=_moving(site),
        speed=site.speed if site.speed in channels else "",
    )


def _moving(site: LineFacts) -> tuple[tuple[str, str], ...]:
    return tuple((roll.name, label_of(roll.name)) for roll in site.rolls if roll.radius_channel)


def _output(output: OutputFacts) -> Output:
    is_speed = output.unit == VELOCITY
    return Output(
        actuator=output.actuator,
        label=label_of(output.actuator),
        unit="mm/s" if is_speed else output.unit,
        limit=output.limit * (1e3 if is_speed else 1.0),
        signal=label_of(output.signal),
        signal_unit="mm/s" if unit_of_channel(output.signal) == "m/s" else "N",
    )


def label_of(name: str) -> str:
    """Return a name of the site file as a person reads it: no unit, no underscores."""
    unit = unit_of_channel(name)
    stem = name.removesuffix(suffix_of_unit(unit)) if unit else name
    return printable(stem.replace("_", " ").rstrip(), LONGEST)
