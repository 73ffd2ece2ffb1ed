"""What an effect is: a named change of the line's arrays, shared by simulation and tracing.

Beside how an effect acts, a row says all that is known of it: how it shows in a record, which
numbers are worth fitting and between which bounds, what tells it from another effect, what to do
about it. Tracing, verdict and report ask the row and know no effect by its name.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from sim_plant.base.arrays import LineArrays
from sim_plant.base.profiles import Profiles
from sim_plant.base.signatures import Onset, Orders, Signature

PlaceKind = Literal["body", "drive", "cell", "web", "span", "loop", "number"]
Candidates = Literal[
    "roll",
    "unwind",
    "roller",
    "turning",
    "driven",
    "gripping",
    "drive",
    "trimmed_drive",
    "cell",
    "web",
    "zone",
    "number",
]
Value = float | str
Shift = Callable[[LineArrays, float], LineArrays]
"""(arrays, change) -> those with a declared number moved by it, as the key ``corrections`` of a
line file counts it: mostly a share of the number. Those given may be changed in place."""
Apply = Callable[[LineArrays, Any, Mapping[str, Value]], LineArrays]
"""(arrays, what a location names, all parameters) -> arrays with the effect."""
Bounds = Callable[[LineArrays, int], Mapping[str, tuple[float, float]]]
Beside = Callable[[Mapping[str, Value], Mapping[str, Value]], str]
Refusal = Callable[[LineArrays, int, Mapping[str, Value]], str]
Starts = Callable[[LineArrays, int, "Demand"], Sequence["Start"]]
RunOut = Callable[[Mapping[str, Value]], float]
Experiment = Callable[[str, "Effect", str], str]
"""(own location, another effect, its location) -> what to do at the machine; empty: no help."""
Among = Callable[[str], str]
"""(places of the effect, as text) -> what to do at the machine to tell which of them it is."""
Seen = Callable[[Mapping[str, Value], float], str]
"""(all parameters, sample time of the record, s) -> what was seen; empty: nothing to add."""


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
    known_to : a record tells the number no better than this, in its unit, whatever its noise; or
        than one drive tick, or one sample of the record (a length: the web that passes in it).
    words : what a word may be; empty for a number.
    detail : says nothing of how much of the effect there is; a report's summary leaves it out.
    called : what a reader calls it, where the name without its unit does not say it: per word
        that the effect has, "" for every other.
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
    known_to: float | Literal["drive tick", "sample"] = 0.0
    words: tuple[str, ...] = ()
    detail: bool = False
    called: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Quadrature:
    """Two ways to say one phasor: cos = amplitude cos(angle), sin = amplitude sin(angle).

    Both may be given at once; they add. ``amplitude`` and ``angle`` are empty where an effect is
    declared by its two components only. ``order`` names the parameter that says how often a turn
    the phasor turns; empty: see `Effect.pairs`. A body further on by a adds n a to the angle of a
    mark on it, of the response cos(n theta + angle); with ``against`` the response is
    cos(n theta - angle), and a takes n a off.
    """

    cos: str
    sin: str
    amplitude: str = ""
    angle: str = ""
    order: str = ""
    against: bool = False


def _as_it_is(_arrays: LineArrays, _place: int) -> float:
    return 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class DeclaredNumber:
    """A parameter that changes nothing but one declared number: the effect is its other name.

    Attributes
    ----------
    number : dotted path in the declaration; ``{place}`` stands for the roller, of a load cell for
        its channel.
    parameter : of the effect.
    scale : (arrays, index of the place) -> change of the number, as its tolerance counts it, per
        unit of the parameter.
    proposed : a number pulled beyond its tolerance is tried as this effect.
    """

    number: str
    parameter: str
    scale: Callable[[LineArrays, int], float] = _as_it_is
    proposed: bool = True


@dataclass(frozen=True, slots=True, kw_only=True)
class Demand:
    """What the records ask of the line.

    Attributes
    ----------
    fastest_ramp_m_s2 : of the line speed reference; 0: it never ramps.
    slowest_m_s, fastest_m_s : of the line speed reference.
    highest_Hz : that every record shows, half its sample rate.
    """

    fastest_ramp_m_s2: float
    slowest_m_s: float
    fastest_m_s: float
    highest_Hz: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Start:
    """Where a search begins because of what the records ask.

    Attributes
    ----------
    choice : of parameters, by name.
    acts_below : of numbers among them, the value from which on the effect is idle in the records.
    """

    choice: Mapping[str, Value]
    acts_below: Mapping[str, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Form:
    """What an effect is, and what to do about it, where these strengths alone are there.

    Attributes
    ----------
    remedy : empty: the effect's own.
    sign : of the change of the first of them from its default; 0: either.
    """

    strengths: tuple[str, ...]
    text: str
    remedy: str = ""
    sign: Literal[-1, 0, 1] = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Effect:
    """One catalogue row.

    Attributes
    ----------
    name : as in declarations and verdicts.
    place : what a location names: a body, a drive, a load cell, the web, a span, a tension loop,
        a declared number. A span effect also takes a zone, a cell effect also takes ``all``.
    candidates : which locations are worth trying, see ``line/locations.py``: material rolls, the
        unwind, rollers that are no rolls, every turning body, driven rollers, those and S-wraps,
        every drive, drives that a tension loop trims, load cells (one by one, and
        all), the web, zones, declared numbers that may change during a run.
    accepts : every parameter; the keys are the only ones a declaration may give.
    fitted : the parameters tracing fits; others keep their default or one of their ``tries``.
    fitted_later : parameters fitted once the effect is there, where the record tells them.
    fitted_per_place : more of them where a location names several places (an S-wrap, ``all``),
        ``{k}`` standing for the number of each but the first.
    apply : returns arrays with the effect added at the index of its place, or where that is a
        declared number by the `Shift` of it; the arrays given may be changed in place.
    shifted_by : where the place is a declared number, the parameter that says by how much; its
        bounds and the size that a search begins at are those of the number.
    text : one sentence for a process engineer.
    shows : its signature in a record where it lasts; None: no line of its own.
    onset : its form that begins at a moment of the record; None: it has none.
    remedy : what to do at the machine or in the declaration, without a stop at its end;
        ``{place}`` stands for where.
    forms : other words than ``text`` and ``remedy``, for those that have only some strengths, or
        one of a known sign.
    run_out : (all parameters) -> total indicator reading, m, of a dial gauge on its body when that
        is turned with the web off; None: a gauge shows nothing of it.
    experiment : what tells it from another effect, where the signatures of both do not say it.
    among : what tells at which of several places it is; None: nothing of its own.
    seen : what the record itself showed, where the numbers fitted are a reading of it.
    sensor_only : acts in a reading, not in the web: must not be cancelled.
    wander : share of what it explains that it leaves, where its size is not quite constant.
    cancel_orders : whole orders of its body that a drive can cancel, or the parameter that says
        which; empty: none.
    quadratures : pairs among ``accepts``.
    pairs : what they stand for. ``orders``: the orders 1, 2, 3 ... of a body. ``cells``: where the
        location is ``all``, the first is what the first load cell that the line declares has, each
        further one what the next cell has *more* than the first.
    bounds : returns narrower bounds (low, high) of some parameters at an index of its place on a
        given line, where physics knows them; None where the line says nothing.
    refuses : says why an index of its place on a given line cannot have it in this form, "" where
        it can; None: every place can have every form.
    beside : (parameters of one that is there, of another of the same effect at the same place) ->
        why there cannot be both, "" where they add; None: any two add.
    starts : returns further starts of a search at an index of its place, from what the records
        ask; None: ``tries`` are all.
    declared_as : declared numbers that it is another name of.
    profiles : its named profiles, where tracing finds it by orders first.
    name_in_version_1 : what a version 1 verdict calls it; empty: its name.
    """

    name: str
    place: PlaceKind
    candidates: Candidates
    accepts: Mapping[str, Parameter]
    fitted: tuple[str, ...]
    apply: Apply
    text: str
    shows: Signature | None
    remedy: str
    onset: Onset | None = None
    fitted_later: tuple[str, ...] = ()
    fitted_per_place: tuple[str, ...] = ()
    forms: tuple[Form, ...] = ()
    run_out: RunOut | None = None
    experiment: Experiment | None = None
    among: Among | None = None
    seen: Seen | None = None
    sensor_only: bool = False
    wander: float = 0.0
    cancel_orders: tuple[int, ...] | str = ()
    quadratures: tuple[Quadrature, ...] = ()
    pairs: Literal["orders", "cells"] = "orders"
    bounds: Bounds | None = None
    refuses: Refusal | None = None
    beside: Beside | None = None
    starts: Starts | None = None
    declared_as: tuple[DeclaredNumber, ...] = ()
    profiles: Profiles | None = None
    name_in_version_1: str = ""
    shifted_by: str = ""

    @property
    def parameters(self) -> Mapping[str, Value]:
        """Defaults of every parameter: the effect exactly absent."""
        return {name: parameter.default for name, parameter in self.accepts.items()}

    @property
    def order_locked(self) -> bool:
        """Whether its response stands still over the angle of the body at its location."""
        return isinstance(self.shows, Orders) and not self.shows.resonant

    @property
    def resonant(self) -> bool:
        """Whether it shows at an order that something rings at."""
        return isinstance(self.shows, Orders) and self.shows.resonant

    def words(self, values: Mapping[str, Value]) -> tuple[str, str]:
        """Return text and remedy by the strengths that are there."""
        there = {
            name
            for name, row in self.accepts.items()
            if row.role == "strength" and values.get(name, row.default) != row.default
        }
        fits = (form for form in self.forms if there and there <= set(form.strengths))
        form = next((f for f in fits if not f.sign or f.sign == self._sign(f, values)), None)
        if form is None:
            return self.text, self.remedy
        return form.text, form.remedy or self.remedy

    def _sign(self, form: Form, values: Mapping[str, Value]) -> int:
        """Return the sign of the change of a form's first strength from its default."""
        default = float(self.accepts[form.strengths[0]].default)
        change = float(values.get(form.strengths[0], default)) - default
        return (change > 0.0) - (change < 0.0)

    def cancelled(self, values: Mapping[str, Value]) -> tuple[int, ...]:
        """Return the whole orders of its body that a drive can cancel, none where it must not."""
        if isinstance(self.cancel_orders, str):
            name = self.cancel_orders
            return (round(float(values.get(name, self.accepts[name].default))),)
        return self.cancel_orders
