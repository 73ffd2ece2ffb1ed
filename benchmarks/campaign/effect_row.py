"""What a row of the effect table says: where and how an effect is drawn, what is true of it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from benchmarks.campaign.beyond import Coordinate, Draw
from benchmarks.campaign.fault import Fault
from benchmarks.campaign.state import Machine

Change = Callable[[Machine, Fault], Machine]
Range = tuple[float, float]
Told = Callable[[Fault], Mapping[str, Range]]
"""Fault -> per parameter of a verdict its true value, and the value at which it is absent."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Form:
    """One way in which an effect comes.

    Attributes
    ----------
    name : empty for the only or the common one.
    change : puts a fault on the machine; None: as its row says.
    drawn_at : places; none: those of its row.
    first_size, least, largest : size to begin with; size below which nothing of it is left, and
        beyond which nobody would ask why, of what tolerances may hide.
    shapes : further numbers of which one is drawn.
    numbers : further numbers by name, drawn evenly in the logarithm within bounds.
    either_sign : or its size is positive.
    begins : from a moment of the record on.
    proportional : the response grows with the size, so one run tells the size that is wanted.
    step : its size is a multiple of this.
    told : what a right verdict says of its size.
    """

    name: str = ""
    change: Change | None = None
    drawn_at: tuple[str, ...] = ()
    first_size: float
    least: float = 0.0
    largest: float = math.inf
    shapes: tuple[float, ...] = (0.0,)
    numbers: tuple[tuple[str, Range], ...] = ()
    either_sign: bool = False
    begins: bool = False
    proportional: bool = False
    step: float = 0.0
    told: Told


def size_is(parameter: str, absent: float = 0.0) -> Told:
    """Return what is told of an effect whose size is what a parameter has beyond its absence."""
    return lambda fault: {parameter: (absent + fault.size, absent)}


@dataclass(frozen=True, slots=True, kw_only=True)
class EffectRow:
    """One effect of the library, or something beyond it.

    Attributes
    ----------
    name : in a verdict, or of something no library has.
    change : puts a fault on the machine.
    drawn_at, forms : where and how it is drawn as an effect of the library, form by form in turn.
    in_ablations, taken_out : drawn for a poor record; taken out of the library in some cases.
    outside : draws something beyond any library; None: the library has it.
    line : where it makes lines of its own: at orders of its body, or in time.
    order : (shape of the fault) -> order of its body, of what has one line or a first one.
    coordinate : (fault as a mapping) -> where its free line is; None: at ``order``.
    alike : effects of one word may answer alike: at the same line, or standing.
    rival_at, rival_shapes : where and with which further numbers it is such a rival.
    standing : without a line of its own: a declared number within its tolerance may hide it.
    proportional : of what is beyond: the response grows with the size.
    put_last : it is laid on a machine that has its radii already.
    said_as : its name in a version 1 verdict.
    """

    name: str
    change: Change
    drawn_at: tuple[str, ...] = ()
    forms: tuple[Form, ...] = ()
    in_ablations: bool = False
    taken_out: bool = False
    outside: Draw | None = None
    line: Literal["", "turn", "time"] = ""
    order: Callable[[float], float] = lambda _: 1.0
    coordinate: Coordinate | None = None
    alike: Literal["", "one line", "standing"] = ""
    rival_at: tuple[str, ...] = ()
    rival_shapes: tuple[float, ...] = (0.0,)
    standing: bool = False
    proportional: bool = False
    put_last: bool = False
    said_as: str = ""

    def form(self, fault: Fault) -> Form:
        """Return the form that a fault has."""
        found = [form for form in self.forms if form.name == fault.form]
        if found:
            return found[0]
        return Form(first_size=fault.size, told=lambda _: {}, proportional=self.proportional)

    def put_on(self, machine: Machine, fault: Fault) -> Machine:
        """Return the machine with this fault."""
        return (self.form(fault).change or self.change)(machine, fault)

    def rivals(self) -> list[Fault]:
        """Return it at every place where it may answer like another, in each of its forms."""
        return [
            Fault(
                effect=self.name,
                location=place,
                size=form.first_size,
                shape=shape,
                form=form.name,
                numbers=tuple((n, math.sqrt(low * high)) for n, (low, high) in form.numbers),
            )
            for form in self.forms
            for place in self.rival_at
            for shape in self.rival_shapes
        ]


def further(form: Form, rng: np.random.Generator) -> tuple[tuple[str, float], ...]:
    """Return the further numbers of a form, drawn evenly in the logarithm."""
    return tuple(
        (name, float(math.exp(rng.uniform(math.log(low), math.log(high)))))
        for name, (low, high) in form.numbers
    )


def truth(row: EffectRow, fault: Fault) -> Mapping[str, Any]:
    """Return per parameter of a verdict (true value, value at which it is absent)."""
    return row.form(fault).told(fault)
