"""A model that explains one output: filter of the inputs, shifts, and general effects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.without_line.general.catalogue import BY_NAME, OWN
from sim_plant.refine.without_line.general.effect import OutputRecord, PlacedEffect, Stage, shifted
from sim_plant.refine.without_line.general.state_dependence import BY

GENERAL = CRITERIA.without_line.general


@dataclass(frozen=True, slots=True, kw_only=True)
class Model:
    """What is fitted, but for the weights of its regressors.

    Attributes
    ----------
    ahead, back : samples of every input that the filter takes after and before the output's own;
        ``back`` is -1 for a filter that takes none.
    delays : of every input, samples; empty for none.
    shifts : of every record fitted, samples, the first 0; empty for none.
    own : each record has an own zero and drift.
    effects : those on inputs and terms beside the filter.
    """

    ahead: int
    back: int
    delays: tuple[float, ...] = ()
    shifts: tuple[float, ...] = ()
    own: bool = False
    effects: tuple[PlacedEffect, ...] = ()

    def shift_of(self, record: int) -> float:
        """Return the shift of a record fitted, samples."""
        return self.shifts[record] if self.shifts else 0.0

    def acting(self, stage: Stage) -> list[PlacedEffect]:
        """Return the effects of a stage."""
        return [x for x in self.effects if BY_NAME[x.effect].stage == stage]

    @property
    def numbers(self) -> Array:
        """All numbers that are fitted by steps: delays, shifts but the first, effects' own."""
        of_effects = [value for x in self.effects for value in x.numbers]
        return np.array([*self.delays, *self.shifts[1:], *of_effects])

    def with_numbers(self, numbers: Sequence[float] | Array) -> Model:
        """Return the same model with these numbers, in the order of ``numbers``."""
        left = [float(value) for value in numbers]

        def take(count: int) -> tuple[float, ...]:
            found = tuple(left[:count])
            del left[:count]
            return found

        delays = take(len(self.delays))
        shifts = (0.0, *take(len(self.shifts) - 1)) if self.shifts else ()
        effects = tuple(replace(x, numbers=take(len(x.numbers))) for x in self.effects)
        return replace(self, delays=delays, shifts=shifts, effects=effects)

    def steps(self) -> Array:
        """Return a small step of every number: ``slope_samples`` of a time, else ``slope_share``.

        A number counts as ``slope_least_share`` of its effect's largest at least.
        """
        times = len(self.delays) + max(0, len(self.shifts) - 1)
        found = [GENERAL.slope_samples] * times
        for x in self.effects:
            largest = max((abs(v) for v in x.numbers), default=0.0)
            least = max(GENERAL.slope_least_share * largest, 1e-12)
            found += [GENERAL.slope_share * max(abs(v), least) for v in x.numbers]
        return np.array(found)


def _driven(model: Model, record: OutputRecord, index: int, name: str, shift: float) -> Array:
    """Return an input as it enters the filter (samples,)."""
    later = shift + (model.delays[index] if model.delays else 0.0)
    raw = [x for x in model.acting("raw") if x.place == name]
    values = record.inputs[name]
    for x in raw:
        change = BY_NAME[x.effect].change
        if change:
            values = change(record, x, values)
    values = shifted(values, later) if raw else record.later(name, later)
    if record.derivative_of_inputs:
        values = np.gradient(values, record.step_s)
    for x in model.acting("driven"):
        change = BY_NAME[x.effect].change
        if x.place.split(BY)[0] == name and change:
            values = change(record, x, values)
    return values


def regressors(model: Model, record: OutputRecord, shift: float) -> Array:
    """Return 1, the lagged inputs and the terms where the record is judged (judged, columns)."""
    first, last = record.end_samples, record.output.size - record.end_samples
    rows = [np.ones(last - first)]
    for index, name in enumerate(record.inputs):
        values = _driven(model, record, index, name, shift)
        rows += [values[first - s : last - s] for s in range(-model.ahead, model.back + 1)]
    for x in model.acting("term"):
        its_regressors = BY_NAME[x.effect].regressors
        if its_regressors:
            rows += [shifted(row, shift)[first:last] for row in its_regressors(record, x).T]
    for x in model.acting("past"):
        its_regressors = BY_NAME[x.effect].regressors
        if its_regressors:
            rows += list(its_regressors(record, x)[first:last].T)
    return np.stack(rows).T


def own_regressors(record: OutputRecord) -> Array:
    """Return 1 and time where the record is judged (judged, 2): its own zero and drift."""
    zero_and_drift = BY_NAME[OWN].regressors
    assert zero_and_drift is not None
    return zero_and_drift(record, PlacedEffect(effect=OWN, place="output"))[record.keep]
