"""What an effect is: a named change of the line's arrays, shared by simulation and tracing.

Beside how an effect acts, a row says what tracing has to know: which numbers are worth fitting,
how large they usually are, between which bounds, and whether the response is linear in them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

from sim_plant.base.arrays import LineArrays

Place = Literal["body", "drive", "cell", "web", "span", "loop"]
Candidates = Literal[
    "roll",
    "unwind",
    "roller",
    "turning",
    "driven",
    "drive",
    "trimmed_drive",
    "cell",
    "web",
    "zone",
]
Value = float | str
Apply = Callable[[LineArrays, int, Mapping[str, Value]], LineArrays]
Limits = Callable[[LineArrays, int], Mapping[str, tuple[float, float]]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """One number or word of an effect.

    Attributes
    ----------
    default : at the defaults of all its parameters an effect is exactly absent.
    unit : SI; ``1`` for a ratio, empty for a word.
    typical : a size worth starting a search from, as the parameter's value (not as a change); a
        finite difference may step a small share of ``typical - default`` away from the default.
    low, high : physical bounds, inclusive, finite for every number but an angle: what a machine
        that still runs can have. Tracing neither tries nor reports anything beyond them.
    linear : the response is proportional to ``value - default`` to first order, from the default
        on and in both directions (where the bounds allow both).
    role : ``strength`` makes the effect; ``shape`` only modifies it (no response while every
        strength is at its default); ``angle`` is a shape that turns; ``option`` is
        chosen, not fitted.
    step : finite difference to take, where the line answers in steps; 0: chosen by the search.
    tries : values worth a candidate each, where a search by slope is hopeless; empty otherwise.
    """

    default: Value
    unit: str
    typical: float = 0.0
    low: float = float("-inf")
    high: float = float("inf")
    linear: bool = False
    role: Literal["strength", "shape", "angle", "option"] = "strength"
    step: float = 0.0
    tries: tuple[Value, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Quadrature:
    """Two ways to say one phasor: cos = amplitude cos(angle), sin = amplitude sin(angle).

    Both may be given at once; they add. ``amplitude`` and ``angle`` are empty where an effect is
    declared by its two components only. ``order`` names the parameter that says how often a turn
    the phasor turns; empty: the pairs of an effect are its orders 1, 2, 3 ...
    """

    cos: str
    sin: str
    amplitude: str = ""
    angle: str = ""
    order: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Effect:
    """One catalogue row.

    Attributes
    ----------
    name : as in declarations and verdicts.
    place : what a location names: a body, a drive, a load cell, the web, a span, a tension loop.
        A span effect also takes a zone, a cell effect also takes ``all``.
    candidates : which locations are worth trying, see ``line/locations.py``: material rolls, the
        unwind, rollers that are no rolls, every turning body, driven rollers, every drive, drives
        that a tension loop trims, load cells (one by one, and all), the web, zones.
    accepts : every parameter; the keys are the only ones a declaration may give.
    traced : the parameters tracing fits; others keep their default or one of their ``tries``.
    apply : returns arrays with the effect added at the index of its place; the arrays given may
        be changed in place.
    text : one sentence for a process engineer.
    order_locked : its response stands still over the angle of the body at its location.
    sensor_only : acts in a reading, not in the web: must not be cancelled.
    quadratures : pairs among ``accepts``.
    limits : returns narrower bounds (low, high) of some parameters at an index of its place on a
        given line, where physics knows them; None where the line says nothing.
    """

    name: str
    place: Place
    candidates: Candidates
    accepts: Mapping[str, Parameter]
    traced: tuple[str, ...]
    apply: Apply
    text: str
    order_locked: bool = False
    sensor_only: bool = False
    quadratures: tuple[Quadrature, ...] = ()
    limits: Limits | None = None

    @property
    def parameters(self) -> Mapping[str, Value]:
        """Defaults of every parameter: the effect exactly absent."""
        return {name: parameter.default for name, parameter in self.accepts.items()}
