"""General effects that are claimed: numbers with intervals, and the error without each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from scipy.special import stdtrit

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.without_line.general.catalogue import BY_NAME, OWN, SHIFT
from sim_plant.refine.without_line.general.effect import OutputRecord
from sim_plant.refine.without_line.general.judging import Judged, explained_by, judge, rms
from sim_plant.refine.without_line.general.least_squares import fit, refined, with_slopes
from sim_plant.refine.without_line.general.search import (
    Search,
    Trial,
    effects_in,
    saves_enough,
    trial_of,
    without,
)

Interval = tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Delay:
    """How far an output is behind an input, s, with the ends of its 95 % interval."""

    value_s: float
    low_s: float
    high_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One general effect of one output.

    Attributes
    ----------
    effect : name in the catalogue.
    output : the column that it changes.
    place : the input or state on which it acts; ``output`` for the output itself.
    text : what it is.
    numbers : by name, with unit.
    interval95 : of the numbers.
    before_rms, after_rms : error on the record judged, without and with it.
    """

    effect: str
    output: str
    place: str
    text: str
    numbers: Mapping[str, float]
    interval95: Mapping[str, Interval]
    before_rms: float
    after_rms: float


def _between(value: float, deviation: float, blocks: int) -> Interval:
    """Return a value's interval, by Student's t with one degree of freedom less than blocks."""
    reach = deviation * float(stdtrit(blocks - 1, 0.5 + 0.5 * CRITERIA.report.confidence))
    return (value - reach, value + reach)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Estimates:
    """Weights and numbers of a trial with their standard deviations, in the order of the model."""

    weights: Array
    weight_sd: Array
    numbers: Array
    number_sd: Array
    blocks: int


def _estimates(trial: Trial, records: Sequence[OutputRecord]) -> _Estimates:
    found = with_slopes(trial.model, records)
    numbers = trial.model.numbers
    spread = found.spread()
    free = spread.size - numbers.size
    return _Estimates(
        weights=trial.weights,
        weight_sd=spread[:free],
        numbers=numbers,
        number_sd=spread[free:],
        blocks=int(found.power.size),
    )


def delays_of(trial: Trial, records: Sequence[OutputRecord]) -> dict[str, Delay]:
    """Return by input how far the output is behind it.

    Parameters
    ----------
    trial : a gain and a delay alone.
    """
    estimates = _estimates(trial, records)
    step_s = records[0].step_s
    delays = {}
    for name, value, deviation in zip(
        records[0].inputs, estimates.numbers, estimates.number_sd, strict=False
    ):
        low, high = _between(float(value), float(deviation), estimates.blocks)
        delays[name] = Delay(
            value_s=float(value) * step_s, low_s=low * step_s, high_s=high * step_s
        )
    return delays


def pruned(
    search: Search, records: Sequence[OutputRecord], record: OutputRecord
) -> tuple[Search, list[str]]:
    """Return the search less effects that the record held out is better without, and why."""
    reasons = []
    for name, place in effects_in(search.best.model):
        smaller = refined(without(search.best.model, name, place), records)
        less = replace(search, best=trial_of("chosen", search.best.what, *smaller))
        with_it, without_it = judge(search, record), judge(less, record)
        saved = 1.0 - (without_it.chosen_rms / with_it.chosen_rms) ** 2
        if saved > CRITERIA.without_line.general.least_share:
            search = less
            reasons.append(
                f"{name} ({place}) saves on the records fitted, not on the one held out"
            )
    return search, reasons


def findings(
    search: Search,
    judged: Judged,
    records: Sequence[OutputRecord],
    record: OutputRecord,
    names: tuple[str, Sequence[str], str],
) -> list[Finding]:
    """Return what is claimed of one output; nothing where plain least squares took over.

    Parameters
    ----------
    names : of the output, of the records fitted, of the record judged.
    """
    if judged.fell_back:
        return []
    output, fitted, held = names
    best = search.best
    estimates = _estimates(best, records)
    claims = [
        _finding(best, estimates, records, (name, place), output)
        for name, place in effects_in(best.model)
        if name != SHIFT
    ]
    claims = [
        replace(
            x,
            before_rms=_without_it(best, x, records, record, judged),
            after_rms=judged.chosen_rms,
        )
        for x in claims
    ]
    return [*_shift(best, estimates, judged, records, record, (output, fitted, held)), *claims]


def _without_it(
    best: Trial, x: Finding, records: Sequence[OutputRecord], record: OutputRecord, judged: Judged
) -> float:
    """Return the error on the record judged when all else is fitted without the effect."""
    less = trial_of("", "", *refined(without(best.model, x.effect, x.place), records))
    shift, own = judged.shift_samples is not None, judged.own and x.effect != OWN
    return rms(record.judged - explained_by(less, record, shift=shift, own=own))


def _finding(
    best: Trial,
    e: _Estimates,
    records: Sequence[OutputRecord],
    which: tuple[str, str],
    output: str,
) -> Finding:
    """Return one effect with its numbers; the errors are filled in later.

    ``at`` and ``column``: where an effect's numbers and its weights begin in the estimates.
    """
    name, place = which
    model = best.model
    at = len(model.delays) + max(0, len(model.shifts) - 1)
    column = 1 + len(records[0].inputs) * (model.ahead + model.back + 1)
    values: dict[str, tuple[float, float]] = {}
    for x in model.effects:
        effect = BY_NAME[x.effect]
        width = effect.regressors(records[0], x).shape[1] if effect.regressors else 0
        sizes = effect.sizes[:width]
        if (x.effect, x.place) == which:
            for k, value in enumerate(x.numbers):
                values[effect.numbers[k].name] = (value, float(e.number_sd[at + k]))
            for k, size in enumerate(sizes):
                mine = column + k
                values[size.name] = (float(e.weights[mine]), float(e.weight_sd[mine]))
        at += len(x.numbers)
        column += width
    if name == OWN:
        values = _own(e, column, len(records))
    return _claimed(name, output, place, values, e.blocks)


def _claimed(
    name: str, output: str, place: str, values: Mapping[str, tuple[float, float]], blocks: int
) -> Finding:
    """Return an effect from its numbers with their standard deviations."""
    return Finding(
        effect=name,
        output=output,
        place=place,
        text=BY_NAME[name].text,
        numbers={n: value for n, (value, _) in values.items()},
        interval95={n: _between(value, sd, blocks) for n, (value, sd) in values.items()},
        before_rms=0.0,
        after_rms=0.0,
    )


def _own(e: _Estimates, column: int, records: int) -> dict[str, tuple[float, float]]:
    """Return zero and drift of every record fitted, each zero less the mean of all.

    That mean belongs to the constant that all records share.
    """
    values: dict[str, tuple[float, float]] = {}
    for k, size in enumerate(BY_NAME[OWN].sizes):
        mine = e.weights[column + k :: 2][:records]
        spread = e.weight_sd[column + k :: 2][:records]
        mean = float(mine.mean()) if k == 0 else 0.0
        for r, (value, sd) in enumerate(zip(mine, spread, strict=True)):
            values[f"{size.name} of record {r + 1}"] = (float(value) - mean, float(sd))
    return values


def _shift(
    best: Trial,
    e: _Estimates,
    judged: Judged,
    records: Sequence[OutputRecord],
    record: OutputRecord,
    names: tuple[str, Sequence[str], str],
) -> list[Finding]:
    """Return the shift of every record against the first, and the delay of a gain alone.

    Nothing where the inputs do not count: the best of many shifts would follow the noise.
    """
    no_inputs = replace(best.model, ahead=0, back=-1, delays=(), shifts=())
    if not saves_enough(fit(no_inputs, records).left_out(), best.left_out, len(records)):
        return []
    output, fitted, held = names
    step_s = record.step_s
    model, delays = best.model, len(best.model.delays)
    values: dict[str, tuple[float, float]] = {}
    for r, samples in enumerate(model.shifts[1:]):
        sd = float(e.number_sd[delays + r])
        values[f"shift_s of {fitted[r + 1]}"] = (samples * step_s, sd * step_s)
    if judged.shift_samples is not None and held not in fitted:
        samples, sd = judged.shift_samples
        values[f"shift_s of {held}"] = (samples * step_s, sd * step_s)
    for k, name in enumerate(records[0].inputs if delays else ()):
        samples, sd = float(e.numbers[k]), float(e.number_sd[k])
        low, high = _between(samples, sd, e.blocks)
        if low * high > 0.0 and abs(samples) > CRITERIA.without_line.general.least_delay_samples:
            values[f"delay_s behind {name}"] = (samples * step_s, sd * step_s)
    if not values:
        return []
    unshifted = refined(replace(model, shifts=(), delays=()), records)
    explained = explained_by(trial_of("", "", *unshifted), record, shift=False, own=judged.own)
    claimed = _claimed(SHIFT, output, "output", values, e.blocks)
    before = rms(record.judged - explained)
    return [replace(claimed, before_rms=before, after_rms=judged.chosen_rms)]
