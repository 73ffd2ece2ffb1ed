"""Which filter and which general effects: chosen by the error on blocks left out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.without_line.general.catalogue import (
    BY_NAME,
    CATALOGUE,
    FILTER,
    OWN,
    PAST,
    SHIFT,
)
from sim_plant.refine.without_line.general.effect import OutputRecord, PlacedEffect
from sim_plant.refine.without_line.general.filter_length import reaches
from sim_plant.refine.without_line.general.least_squares import Moments, fit, refined
from sim_plant.refine.without_line.general.model import Model, regressors

GENERAL = CRITERIA.without_line.general
CONSTANT = "a constant"
GAIN_ALONE = "a gain and a delay alone"
Progress = Callable[[str], None]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Trial:
    """A model that was tried.

    Attributes
    ----------
    effect : name in the catalogue.
    what : as text.
    model : with its numbers fitted.
    weights : of its regressors.
    left_out : squared error of every block that was left out (blocks,).
    samples : of all blocks.
    """

    effect: str
    what: str
    model: Model
    weights: Array
    left_out: Array
    samples: float

    @property
    def rms(self) -> float:
        """Error on blocks left out, in the unit of the output."""
        return float(np.sqrt(self.left_out.sum() / self.samples))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Search:
    """The outcome for one output.

    Attributes
    ----------
    declared : the declared filter.
    plain : plain least squares, taps centred on the sample.
    best : what was chosen.
    gain_alone : a gain and a delay for every input; None without inputs.
    tried : every trial, best start of each.
    """

    declared: Trial
    plain: Trial
    best: Trial
    gain_alone: Trial | None
    tried: tuple[Trial, ...]


def better_by(before: Array, after: Array, records: int) -> tuple[float, float]:
    """Return share of the squared error saved, and Student's t of what the blocks save.

    What a block saves is taken relative to the error of its record, and its spread among the
    blocks of that record: a noisy record does not hide what is saved in a quiet one.
    """
    was = before.reshape(records, -1)
    saved = (was - after.reshape(records, -1)) / np.maximum(was.sum(axis=1), 1e-300)[:, None]
    spread = float(np.sqrt(saved.shape[1] * np.sum(np.var(saved, axis=1, ddof=1))))
    share = 1.0 - float(after.sum()) / max(float(before.sum()), 1e-300)
    return share, float(saved.sum()) / spread if spread > 0.0 else 0.0


def saves_enough(before: Array, after: Array, records: int = 1) -> bool:
    """Return whether an effect saves enough of the squared error on blocks left out."""
    share, t = better_by(before, after, records)
    return share > GENERAL.least_share and t > GENERAL.least_t


def trial_of(effect: str, what: str, model: Model, found: Moments) -> Trial:
    """Return a trial from the moments of its model."""
    return Trial(
        effect=effect,
        what=what,
        model=model,
        weights=found.weights(),
        left_out=found.left_out(),
        samples=float(found.samples.sum()),
    )


def _delays(records: Sequence[OutputRecord]) -> tuple[float, ...]:
    """Return the delay of every input by its strongest correlation with what is left, samples."""
    reach = records[0].end_samples
    left = [record.judged - record.judged.mean() for record in records]
    delays: list[float] = []
    for name in records[0].inputs:
        best = (0.0, 0, 0.0)
        series = [v.rate_of(name) if v.derivative_of_inputs else v.inputs[name] for v in records]
        for at in range(-reach, reach + 1):
            cut = [
                x[v.end_samples - at : x.size - v.end_samples - at] - x.mean()
                for x, v in zip(series, records, strict=True)
            ]
            power = sum(float(x @ x) for x in cut)
            product = sum(float(x @ y) for x, y in zip(cut, left, strict=True))
            if power > 0.0 and product**2 / power > best[0]:
                best = (product**2 / power, at, product / power)
        _, at, gain = best
        for k, (x, v) in enumerate(zip(series, records, strict=True)):
            left[k] = left[k] - gain * (
                x[v.end_samples - at : x.size - v.end_samples - at] - x.mean()
            )
        delays.append(float(at))
    return tuple(delays)


def strongest_lag(
    record: OutputRecord, explained: Array, mask: NDArray[np.bool_] | None = None
) -> float:
    """Return by how many samples what is explained (judged,) has to come later."""
    use = np.ones(explained.size, dtype=np.bool_) if mask is None else mask
    middle = explained - explained.mean()
    target = record.judged - record.judged.mean()
    reach = min(record.end_samples, GENERAL.shift_reach)
    lags = range(-reach, reach + 1)
    left = [float(np.sum((target - np.roll(middle, at))[use] ** 2)) for at in lags]
    return float(lags[int(np.argmin(left))])


def _shifts(model: Model, records: Sequence[OutputRecord]) -> tuple[float, ...]:
    """Return start shifts of the records against the first, by the filter of the first."""
    alone = replace(model, shifts=(), own=False)
    first = fit(alone, records[:1]).weights()
    return (0.0, *(strongest_lag(v, regressors(alone, v, 0.0) @ first) for v in records[1:]))


def _shiftable(model: Model, records: Sequence[OutputRecord]) -> bool:
    """Return whether records can be shifted against each other, and are not yet."""
    return model.back >= 0 and bool(records[0].inputs) and len(records) > 1 and not model.shifts


def _with(model: Model, placed: PlacedEffect) -> Model:
    return replace(model, effects=(*model.effects, placed))


def _candidates(
    model: Model, records: Sequence[OutputRecord]
) -> list[tuple[str, str, list[Model]]]:
    """Return effect, text and start models of all that is not in the model yet.

    Where no zero of the inputs is left, what has one (a sign, a band, a limit) is not tried: two
    levels that were mixed into other columns would pass for it.
    """
    candidates: list[tuple[str, str, list[Model]]] = []
    for effect in CATALOGUE:
        if effect.stage == "shift" and _shiftable(model, records):
            starts = [replace(model, shifts=(0.0,) * len(records))]
            starts.append(replace(model, shifts=_shifts(model, records)))
            candidates.append((effect.name, effect.text, starts))
        elif effect.stage == "own" and not model.own:
            candidates.append((effect.name, effect.text, [replace(model, own=True)]))
        elif effect.stage in ("raw", "driven", "term") and not records[0].standardised:
            here = {(x.effect, x.place) for x in model.effects}
            places: dict[str, list[Model]] = {}
            for placed in effect.starts(records):
                if (placed.effect, placed.place) not in here:
                    places.setdefault(placed.place, []).append(_with(model, placed))
            for place, models in places.items():
                candidates.append((effect.name, f"{effect.text} ({place})", models))
    return candidates


def _filters(records: Sequence[OutputRecord]) -> list[Trial]:
    """Return every filter length, the shortest first; a constant first."""
    constant = Model(ahead=0, back=-1)
    trials = [trial_of(FILTER, CONSTANT, constant, fit(constant, records))]
    if not records[0].inputs:
        return trials
    gain = Model(ahead=0, back=0, delays=_delays(records))
    trials.append(trial_of(FILTER, GAIN_ALONE, *refined(gain, records)))
    for name, ahead, back in reaches(records[0].end_samples):
        model = Model(ahead=ahead, back=back)
        trials.append(trial_of(FILTER, name, model, fit(model, records)))
    return sorted(trials, key=lambda trial: trial.weights.size)


def _shortest(trials: Sequence[Trial], records: int) -> Trial:
    """Return the shortest filter that is not clearly worse than the best."""
    best = min(trials, key=lambda trial: trial.rms)
    for trial in trials:
        share, t = better_by(trial.left_out, best.left_out, records)
        if share < GENERAL.filter_share or t <= 1.0:
            return trial
    return best


def _lengthened(best: Trial, records: Sequence[OutputRecord]) -> Trial:
    """Return the model with a longer filter where, beside the effect just added, that saves.

    Otherwise the next effect would take the place of taps that are missing.
    """
    trials = [best]
    for _, ahead, back in reaches(records[0].end_samples):
        if best.model.back < 0 or ahead + back <= best.model.ahead + best.model.back:
            continue
        longer = replace(best.model, ahead=ahead, back=back, delays=())
        trials.append(trial_of(best.effect, best.what, *refined(longer, records)))
    return _shortest(sorted(trials, key=lambda trial: trial.weights.size), len(records))


def _grown(best: Trial, records: Sequence[OutputRecord]) -> tuple[Trial, list[Trial]]:
    """Return the best model with one more effect, or as it was if none counts, and all trials."""
    tried = []
    for name, what, models in _candidates(best.model, records):
        start = min(models, key=lambda model: fit(model, records).total)
        tried.append(trial_of(name, what, *refined(start, records)))
    good = [trial for trial in tried if saves_enough(best.left_out, trial.left_out, len(records))]
    return min(good, key=lambda trial: trial.rms, default=best), tried


def without(model: Model, name: str, place: str) -> Model:
    """Return the model without one of its effects."""
    if name == SHIFT:
        return replace(model, shifts=())
    if name == OWN:
        return replace(model, own=False)
    kept = tuple(x for x in model.effects if (x.effect, x.place) != (name, place))
    return replace(model, effects=kept)


def effects_in(model: Model) -> list[tuple[str, str]]:
    """Return name and place of every effect of a model."""
    places = [(SHIFT, "output")] if model.shifts else []
    places += [(OWN, "output")] if model.own else []
    return [*places, *((x.effect, x.place) for x in model.effects)]


def _pruned(best: Trial, records: Sequence[OutputRecord]) -> Trial:
    """Return the model without effects that no longer save enough beside the others."""
    for name, place in effects_in(best.model)[:-1]:
        less = trial_of(
            best.effect, best.what, *refined(without(best.model, name, place), records)
        )
        if not saves_enough(less.left_out, best.left_out, len(records)):
            best = less
    return best


def _past(best: Trial, records: Sequence[OutputRecord]) -> list[Trial]:
    """Return the error one step ahead with past outputs of every order."""
    effect = BY_NAME[PAST]
    trials = []
    for placed in effect.starts(records):
        order = int(placed.constants[0])
        base = best.model
        if records[0].inputs:  # what comes after a past output comes after its inputs too
            base = replace(base, back=min(records[0].end_samples, base.back + order))
        model = _with(base, placed)
        what = f"one step ahead with {order} past outputs (ARX)"
        trials.append(trial_of(effect.name, what, model, fit(model, records)))
    return trials


def search(records: Sequence[OutputRecord], progress: Progress) -> Search:
    """Return the filter and the effects that explain one output of the records best.

    The filter first, the shortest that does; then one effect at a time, each with its numbers
    fitted from several sizes, as long as one saves enough on blocks left out.
    """
    filters = _filters(records)
    end_samples = records[0].end_samples
    declared = max(
        filters, key=lambda trial: (trial.model.ahead + trial.model.back, trial.model.ahead)
    )
    half = min(GENERAL.plain_half, end_samples)
    plain = next((t for t in filters if t.model.ahead == t.model.back == half), declared)
    best, tried = _shortest(filters, len(records)), [*filters]
    for _ in range(GENERAL.most_effects):
        grown, more = _grown(best, records)
        tried += more
        if grown is best:
            break
        progress(f"  {grown.what}: {best.rms:.5g} -> {grown.rms:.5g} on blocks left out")
        best = _lengthened(grown, records)
    best = _pruned(best, records)
    tried += _past(best, records)
    alone = next((t for t in filters if t.what == GAIN_ALONE), None)
    return Search(declared=declared, plain=plain, best=best, gain_alone=alone, tried=tuple(tried))
