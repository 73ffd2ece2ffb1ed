"""Which columns of the ring a scope keeps, and how a person reads them: label, unit, factor."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from aff_hmi.layout import label_of
from aff_hmi.words import N_, Say
from aff_runtime.app.report.line_facts import LineFacts
from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.base.channel_units import unit_of_name

MOST = 32
NEEDED = ("time_s", "tick", "state")
THETA = ".theta_rad"
NAME = N_("{name}")
# columns of outputs by how they begin, of rolls by how they end, and times: their words
OF_OUTPUTS = {
    "correction_": N_("{name}: correction"),
    "plc_applied_": N_("{name}: applied, says the PLC"),
    "wanted_": N_("{name}: wanted by the law"),
    "applied_ratio_": N_("{name}: let out by the guard"),
}
OF_ROLLS = {THETA: N_("{name}: angle"), ".omega_rad_s": N_("{name}: speed of turning")}
TIMES = {
    "age_s": N_("age of the PLC's data"),
    "wake_us": N_("wake-up: how late a tick begins"),
    "io_us": N_("exchange with the PLC"),
    "tick_us": N_("whole tick"),
}
# SI unit of a name: unit on the screen, and what it is multiplied with
SHOWN = {
    "N m": ("N m", 1.0),
    "N": ("N", 1.0),
    "rad/s": ("rad/s", 1.0),
    "m/s": ("mm/s", 1e3),
    "rad": ("deg", math.degrees(1.0)),
    "m": ("mm", 1e3),
    "s": ("ms", 1e3),
}
MICROSECONDS = ("_us", ("ms", 1e-3))


@dataclass(frozen=True, slots=True, kw_only=True)
class Signal:
    """One column.

    Attributes
    ----------
    kind : what it is, in English, with ``{name}`` for ``label``, the site file's own word.
    factor : brings it to ``unit``.
    """

    name: str
    kind: str
    label: str
    unit: str
    factor: float

    def words(self, say: Say) -> str:
        """Return it as a person reads it."""
        return say(self.kind).replace("{name}", self.label)


def signals_of(columns: Sequence[str], site: LineFacts) -> tuple[Signal, ...]:
    """Return what a scope keeps of a ring, ``MOST`` at most: what was measured and sent first."""
    measured = [channel.name for channel in TickRow(dict.fromkeys(columns)).channels]
    ends = [one.column for one in site.outputs]
    first = [f"correction_{end}" for end in ends]
    rolls = [f"{roll.name}{kind}" for roll in site.rolls for kind in OF_ROLLS]
    rest = [f"{kind}{end}" for kind in OF_OUTPUTS for end in ends]
    wanted = dict.fromkeys((*measured[: MOST // 2], *first, *rolls, *TIMES, *rest, *measured))
    there = [name for name in wanted if name in columns]
    return tuple(signal_of(name, site) for name in there[:MOST])


def signal_of(name: str, site: LineFacts) -> Signal:
    """Return how a column is read: mm/s for what moves a web a little, m/min for the line."""
    ending, of_times = MICROSECONDS
    unit, factor = SHOWN.get(unit_of_name(name), ("", 1.0))
    if name.endswith(ending):
        unit, factor = of_times
    elif name.startswith("applied_ratio_"):
        unit, factor = "%", 100.0
    elif name == site.speed:
        unit, factor = "m/min", 60.0
    kind, label = _words(name)
    return Signal(name=name, kind=kind, label=label, unit=unit, factor=factor)


def _words(name: str) -> tuple[str, str]:
    if name in TIMES:
        return TIMES[name], ""
    for begin, kind in OF_OUTPUTS.items():
        if name.startswith(begin):
            return kind, label_of(name.removeprefix(begin))
    for end, kind in OF_ROLLS.items():
        if name.endswith(end):
            return kind, label_of(name.removesuffix(end))
    return NAME, label_of(name)
