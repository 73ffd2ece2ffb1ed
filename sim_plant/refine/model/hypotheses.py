"""Every effect of the library at every place of a line.

What of it is fitted, from where, and within which bounds.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase

from sim_plant.base.arrays import LineArrays
from sim_plant.base.effects import Demand, Effect, Value
from sim_plant.effects.catalogue import CATALOGUE
from sim_plant.effects.onset import HOLD_S
from sim_plant.line.arrays.build import build_arrays, timing_of
from sim_plant.line.arrays.corrections import declared_numbers
from sim_plant.line.arrays.locations import candidate_locations, places_of
from sim_plant.line.declared.declaration import Declaration
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.model.nuisances import tolerance_of
from sim_plant.refine.model.twin import Added

StartValues = tuple[float, ...]
"""Of a hypothesis: its numbers in the order of ``names``."""
Choice = tuple[tuple[str, Value], ...]
"""Parameters with their values, by name."""
MODEL = CRITERIA.model
STEPS = MODEL.steps


@dataclass(frozen=True, slots=True, kw_only=True)
class Hypothesis:
    """One effect at one place, with the numbers to fit.

    Attributes
    ----------
    effect, location : as in a declaration.
    fixed : options that are chosen, not fitted.
    names : fitted parameters, those of role *strength* first.
    strength_count : how many of them are of that role.
    start : values that a fit starts from: typical ones of the catalogue, or those chosen.
    absent : values at which the effect is exactly absent.
    low, high : physical bounds, from the effect's own file and from the line.
    linear : per strength, whether the response is proportional to it in both directions.
    record_index : the only record that it is in, from 0 of those fitted; None: in all.
    acts_below : of a number that limits something, the value from which upwards the effect leaves
        no trace in the records: they ask no more of the line. It shows below.
    """

    effect: Effect
    location: str
    fixed: Choice
    names: tuple[str, ...]
    strength_count: int
    start: tuple[float, ...]
    absent: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    linear: tuple[bool, ...]
    record_index: int | None = None
    acts_below: Mapping[str, float] = field(default_factory=dict)

    @property
    def key(self) -> EffectAt:
        """Its effect and location, by name."""
        return EffectAt(self.effect.name, self.location)

    @property
    def is_episode(self) -> bool:
        """Whether how long it lasts is fitted: it ends again."""
        return HOLD_S in self.names

    @property
    def idle(self) -> tuple[float, ...]:
        """Values at which the effect leaves no trace in the records: its sizes count from there.

        Those at which it is absent; of a limit ``acts_below``, above which it has none either.
        """
        rows = zip(self.names, self.absent, strict=True)
        return tuple(self.acts_below.get(name, value) for name, value in rows)

    @property
    def highest(self) -> tuple[float, ...]:
        """The highest values that records can tell from each other."""
        rows = zip(self.names, self.high, strict=True)
        return tuple(min(self.acts_below.get(name, high), high) for name, high in rows)

    @property
    def moment_parameter(self) -> str:
        """The parameter that says when it begins; empty where it lasts throughout."""
        onset = self.effect.onset
        return onset.moment if onset is not None and onset.moment in self.names else ""

    def moment_of(self, values: Sequence[float]) -> float:
        """Return when it begins with these values, in the unit of its moments; it has one."""
        return values[self.names.index(self.moment_parameter)]

    @property
    def at_start(self) -> dict[str, Value]:
        """Every parameter at its start, what is neither fixed nor fitted at its default."""
        given = dict(zip(self.names, self.start, strict=True))
        return {**self.effect.parameters, **dict(self.fixed), **given}

    def added(self, values: Sequence[float]) -> Added:
        """Return the effect with these parameter values, clipped to their bounds."""
        clipped = [
            min(max(float(v), lo), hi)
            for v, lo, hi in zip(values, self.low, self.high, strict=True)
        ]
        pairs = zip(self.names, clipped, strict=True)
        return Added(self.effect.name, self.location, (*self.fixed, *pairs), self.record_index)

    def within(self, values: Sequence[float]) -> bool:
        """Return whether all numbers are within their bounds."""
        rows = zip(values, self.low, self.high, strict=True)
        return all(low <= value <= high for value, low, high in rows)

    def at_bound(self, values: Sequence[float]) -> bool:
        """Return whether a number sits at a bound at which it is no estimate.

        Where the bound is its absence it is an estimate, and where the catalogue gives the bound
        as a candidate (``Parameter.tries``): a threshold of slip of 0 says that web slips always.
        """
        rows = zip(self.names, values, self.low, self.high, self.absent, strict=True)
        return any(
            abs(value - bound) < CRITERIA.model.at_bound_share * abs(bound - absent)
            for name, value, low, high, absent in rows
            for bound in (low, high)
            if math.isfinite(bound) and bound not in (absent, *self.effect.accepts[name].tries)
        )

    def is_number_off(self, values: Sequence[float], judged_from_s: float) -> bool:
        """Return whether it is a declared number that is another one all the while it is judged.

        Such a number is off, and no event. No effect of another kind is that: those may be there
        from the start.
        """
        if not self.effect.shifted_by or not self.moment_parameter:
            return False
        return self.moment_of(values) <= judged_from_s

    @property
    def curved(self) -> bool:
        """Whether a slope at its absence says nothing of the effect at a size that matters."""
        rows = [self.effect.accepts[name] for name in self.names[: self.strength_count]]
        return any(not row.linear for row in rows)

    def start_effects(self) -> list[Added]:
        """Return one effect per strength: that one at its start, the others absent.

        Of a curved effect only one, the whole of it.
        """
        if self.curved:
            return [self.added(self.start)]
        effects = []
        for at in range(self.strength_count):
            values = list(self.absent)
            values[self.strength_count :] = self.start[self.strength_count :]
            values[at] = self.start[at]
            effects.append(self.added(values))
        return effects

    def increments(self, values: Sequence[float]) -> list[float]:
        """Return a finite-difference step per number, large against the chaos of quantised loops.

        A parameter that states a ``step`` takes that one, another angle ``angle_rad``. Of a
        strength that is linear it is ``linear_share`` of the larger of its size and its start
        size; of all else ``curved_share`` of the larger of its size and ``curved_least_share`` of
        its start size; ``from_absence`` where both are 0. Below ``acts_below`` the step goes down,
        by at most 1 / ``room_parts`` of the distance to it. A step that would pass ``high`` goes
        down.
        """
        steps = []
        for name, value, start, absent in zip(
            self.names, values, self.start, self.absent, strict=True
        ):
            row = self.effect.accepts[name]
            if row.role == "angle" or row.step > 0.0:
                steps.append(row.step or STEPS.angle_rad)
                continue
            size, start_size = abs(value - absent), abs(start - absent)
            if row.role == "strength" and row.linear:
                step = STEPS.linear_share * max(size, start_size)
            else:
                step = STEPS.curved_share * max(size, STEPS.curved_least_share * start_size)
            step = step if step > 0.0 else STEPS.from_absence
            room = self.acts_below.get(name, math.inf) - value
            steps.append(-min(step, room / STEPS.room_parts) if 0.0 < room < math.inf else step)
        return [-s if v + s > hi else s for s, v, hi in zip(steps, values, self.high, strict=True)]


def variants(effect: Effect) -> list[Choice]:
    """Return every combination of the values that are worth a candidate each."""
    tried = [[(name, value) for value in p.tries] for name, p in effect.accepts.items() if p.tries]
    return [tuple(choice) for choice in itertools.product(*tried)]


def hypothesis(
    effect: Effect,
    location: str,
    choice: Choice = (),
    fitted: Sequence[str] | None = None,
    line: Declaration | None = None,
    arrays: LineArrays | None = None,
) -> Hypothesis:
    """Return one hypothesis; ``choice`` fixes options and replaces values to start from.

    ``fitted`` are the parameters to fit in place of those that the effect names. With ``line`` the
    bounds are narrowed to what is possible at this place of this line; ``arrays`` are its own,
    where they are at hand.
    """
    picked = dict(choice)
    wanted = list(fitted or effect.fitted)
    if line is not None and not fitted and effect.fitted_per_place:
        places = len(places_of(line, effect, location, effect.name))
        wanted += [n.format(k=k) for k in range(1, places) for n in effect.fitted_per_place]
    names = [n for n in wanted if n in effect.accepts and effect.accepts[n].role != "option"]
    names.sort(key=lambda n: effect.accepts[n].role != "strength")
    fixed = tuple((n, v) for n, v in picked.items() if n not in names)
    rows = [effect.accepts[n] for n in names]
    start = [float(picked.get(n, r.typical)) for n, r in zip(names, rows, strict=True)]
    strength_rows = [r for r in rows if r.role == "strength"]
    at_place = bounds_at(line, effect, location, arrays) if line is not None else {}
    low, high = [], []
    for n, r in zip(names, rows, strict=True):
        place_low, place_high = at_place.get(n, (r.low, r.high))
        low.append(max(r.low, place_low))
        high.append(min(r.high, place_high))
    return Hypothesis(
        effect=effect,
        location=location,
        fixed=fixed,
        names=tuple(names),
        strength_count=len(strength_rows),
        start=tuple(start),
        absent=tuple(float(r.default) for r in rows),
        low=tuple(low),
        high=tuple(high),
        linear=tuple(r.linear and low[k] < float(r.default) for k, r in enumerate(strength_rows)),
    )


def onset_hypotheses(
    line: Declaration, record_index: int, without: Collection[str] = ()
) -> list[Hypothesis]:
    """Return every effect that may begin at a moment of one record, each way and at each place."""
    library, arrays = [], _arrays_of(line)
    for effect in CATALOGUE:
        onset = effect.onset
        if onset is None or effect.name in without:
            continue
        # the other values of the grid are tried where the moment is (`events`, `placed_events`)
        first_of_grid = tuple((name, values[0]) for name, values in onset.grid)
        for form in onset.forms:
            grid = ((n, v) for n, v in first_of_grid if n in form)
            choice = (*onset.fixed, *grid, (onset.moment, 0.0))
            names = (*form, onset.moment)
            library += [
                replace(
                    hypothesis(effect, location, (*choice, *size), names, line, arrays),
                    record_index=record_index,
                )
                for location, size in _begun_at(line, effect)
            ]
    return library


def _begun_at(line: Declaration, effect: Effect) -> list[tuple[str, Choice]]:
    """Return where an effect may begin, and the size to start from that the place asks for.

    A declared number starts from its own tolerance, as no one size fits numbers of unlike units.
    Left out are numbers that an effect with an onset is the other name of: it stands for them.
    """
    places = candidate_locations(line, effect)
    if not effect.shifted_by:
        return [(location, ()) for location in places]
    named = _numbers_that_onsets_stand_for()
    kinds = {number.name: number.kind for number in declared_numbers(line)}
    sizes = {name: tolerance_of(line, name, kind) for name, kind in kinds.items()}
    return [
        (name, ((effect.shifted_by, sizes[name] or MODEL.default_tolerance[kinds[name]]),))
        for name in places
        if not any(fnmatchcase(name, pattern) for pattern in named)
    ]


def _numbers_that_onsets_stand_for() -> list[str]:
    """Return patterns of declared numbers that an effect with an onset is the other name of."""
    return [
        row.number.format(place="*")
        for effect in CATALOGUE
        if effect.onset is not None
        for row in effect.declared_as
        if any(row.parameter in form for form in effect.onset.forms)
    ]


def _arrays_of(line: Declaration) -> LineArrays:
    return build_arrays(line, timing_of(line, line.sample_time_s))


def bounds_at(
    line: Declaration, effect: Effect, location: str, arrays: LineArrays | None = None
) -> dict[str, tuple[float, float]]:
    """Return the bounds that this place of this line sets, the tightest of all it names."""
    if effect.shifted_by:
        number = next(n for n in declared_numbers(line) if n.name == location)
        return {effect.shifted_by: (number.low, number.high)}
    if effect.bounds is None:
        return {}
    arrays = _arrays_of(line) if arrays is None else arrays
    bounds: dict[str, tuple[float, float]] = {}
    for place in places_of(line, effect, location, effect.name):
        for name, (low, high) in effect.bounds(arrays, place).items():
            old = bounds.get(name, (low, high))
            bounds[name] = max(low, old[0]), min(high, old[1])
    return bounds


def all_hypotheses(
    line: Declaration, without: Collection[str] = (), demand: Demand | None = None
) -> list[Hypothesis]:
    """Return a hypothesis for every effect at every place of this line, each way to start it.

    Effects in ``without`` are left out.

    With ``demand``, what the records ask of the line, those too that start where that is.
    """
    arrays = _arrays_of(line)
    known = [
        hypothesis(effect, location, choice, line=line, arrays=arrays)
        for effect in CATALOGUE
        if effect.name not in without and effect.fitted
        for location in candidate_locations(line, effect)
        for choice in variants(effect)
        if _possible(line, arrays, effect, location, choice)
    ]
    return known if demand is None else [*known, *_for_demand(line, arrays, without, demand)]


def _for_demand(
    line: Declaration, arrays: LineArrays, without: Collection[str], demand: Demand
) -> list[Hypothesis]:
    """Return the hypotheses that start at what the records ask of the line.

    `_possible` is not asked: what ``starts`` of an effect gives is of these arrays, and of a form
    that every place can have.
    """
    return [
        replace(
            hypothesis(effect, location, tuple(start.choice.items()), line=line, arrays=arrays),
            acts_below=start.acts_below,
        )
        for effect in CATALOGUE
        if effect.starts is not None and effect.name not in without
        for location in candidate_locations(line, effect)
        for start in effect.starts(
            arrays, places_of(line, effect, location, effect.name)[0], demand
        )
    ]


def _possible(
    line: Declaration, arrays: LineArrays, effect: Effect, location: str, choice: Choice
) -> bool:
    """Return whether every place that a location names can have an effect in this form."""
    if effect.refuses is None:
        return True
    values = {**effect.parameters, **dict(choice)}
    places = places_of(line, effect, location, effect.name)
    return not any(effect.refuses(arrays, place, values) for place in places)


def with_number(h: Hypothesis, start: StartValues, name: str, value: float) -> StartValues:
    """Return numbers to start from with another value of one of them."""
    k = h.names.index(name)
    return (*start[:k], value, *start[k + 1 :])
