"""From the selection of the search, and its error on the record judged, to the verdict."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from sim_plant.base.effects import Value
from sim_plant.line.arrays.build import cell_sensors
from sim_plant.line.arrays.corrections import declared_numbers, value_of
from sim_plant.line.declared.declaration import RollAngle
from sim_plant.refine.judge.holdout import Evaluation
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.model.twin import Twin
from sim_plant.refine.report.confidence import interval, phasors, standard_deviations
from sim_plant.refine.report.experiments import experiments
from sim_plant.refine.report.verdict import (
    Ambiguity,
    Answer,
    ChannelRms,
    EffectFinding,
    Moment,
    NumberChange,
    UnknownFinding,
    Verdict,
)
from sim_plant.refine.search.selection import AcceptedEffect, Ranges, Selection
from sim_plant.refine.spectra.moment_axis import moment_axis

Fitted = tuple[str, Twin]
"""A record that was fitted: its file name, and its twin."""


def verdict_of(
    selection: Selection,
    evaluation: Evaluation | None,
    holdout: str,
    fitted: Sequence[Fitted] = (),
    left_by_rivals: Sequence[Mapping[str, float]] = (),
) -> Verdict:
    """Return the whole verdict.

    Parameters
    ----------
    evaluation : errors on the record judged; None where none was judged.
    holdout : path of that record as text, the first held out or else the first fitted: as a key
        of the verdict has it.
    fitted : the records fitted; none: nothing is told by their names and channels.
    left_by_rivals : per effect, what its runner-up leaves on the record judged; none: not judged.
    """
    sensors = fitted[0][1].declaration.sensors if fitted else ()
    encoder_rollers = {sensor.roller for sensor in sensors if isinstance(sensor, RollAngle)}
    along = [roller.name for roller in fitted[0][1].declaration.rollers] if fitted else ()
    return Verdict(
        answer=_answer(selection),
        effects=tuple(
            replace(found, runner_up_rms=left_by_rivals[k] if left_by_rivals else {})
            for k, found in enumerate(effect_findings(selection, fitted))
        ),
        unknown=tuple(
            UnknownFinding(
                unknown_class=u.unknown_class,
                coordinate=u.coordinate,
                chi2_reduction=u.chi2_reduction,
                begins=_beginning(u.coordinate, fitted),
                also=u.also,
            )
            for u in selection.unknown
        ),
        ambiguous=tuple(
            Ambiguity(
                place=a.hypothesis.key,
                alternatives=a.ambiguous,
                experiments=tuple(
                    experiments(
                        a.hypothesis.key,
                        a.ambiguous,
                        dict(h.fixed) | dict(zip(h.names, values, strict=True)),
                        encoder_rollers,
                        along,
                    )
                ),
            )
            for a, h, values in zip(
                selection.accepted, selection.fit.hypotheses, selection.fit.values, strict=True
            )
            if a.ambiguous
        ),
        residual_rms={} if evaluation is None else channel_errors(evaluation),
        holdout=holdout,
    )


def _answer(selection: Selection) -> Answer:
    if selection.unknown:
        return "unknown"
    if any(accepted.ambiguous for accepted in selection.accepted):
        return "not_identifiable"
    return "traced" if selection.accepted else "nothing"


def channel_errors(evaluation: Evaluation) -> dict[str, ChannelRms]:
    """Return the error of every channel before and after."""
    rows = zip(
        evaluation.channels,
        evaluation.rms_declared,
        evaluation.rms_amended,
        evaluation.floor,
        strict=True,
    )
    return {
        name: ChannelRms(before=float(b), after=float(a), noise_floor=float(f))
        for name, b, a, f in rows
    }


def effect_findings(
    selection: Selection, fitted: Sequence[Fitted] = ()
) -> tuple[EffectFinding, ...]:
    """Return one finding per effect: parameters, 95 % intervals, score and runner-up."""
    cells = tuple(s.channel for s in cell_sensors(fitted[0][1].declaration)) if fitted else ()
    findings, at = [], 0  # at: position of the effect's first number in the row of all
    sd = standard_deviations(selection.fit)
    fit = selection.fit
    ranges = selection.ranges or ({},) * len(fit.hypotheses)
    rows = zip(selection.accepted, fit.hypotheses, fit.values, ranges, strict=True)
    for accepted, h, values, known in rows:
        amplitude_sd = {pair.amplitude: spread for pair, spread in phasors(fit, h, at)}
        own_sd = sd[at : at + len(values)]
        found = _finding(accepted, h, values, own_sd, amplitude_sd, known)
        begins, becomes = _onset(h, found.parameters, fitted), _becomes(h, found, fitted)
        findings.append(replace(found, cells=cells, begins=begins, becomes=becomes))
        at += len(values)
    return tuple(findings)


def _onset(h: Hypothesis, values: Mapping[str, Value], fitted: Sequence[Fitted]) -> Moment | None:
    """Return when an effect that has a moment begins; None where it was there from the start."""
    # an effect in every record is told by the first one's clock
    onset, record_index = h.effect.onset, h.record_index or 0
    if onset is None or record_index >= len(fitted):
        return None
    moment = values.get(onset.moment, h.effect.accepts[onset.moment].default)
    if moment == h.effect.accepts[onset.moment].default:
        return None
    name, twin = fitted[record_index]
    if onset.unit == "s":
        return Moment(record=name, time_s=float(moment), record_index=record_index)
    from_sample = 0  # the axis of the whole record
    axis_m = moment_axis(twin, from_sample, onset.unit).moments
    times_s = np.arange(axis_m.size) * twin.declaration.sample_time_s
    time_s = float(np.interp(float(moment), axis_m, times_s))
    return Moment(record=name, time_s=time_s, record_index=record_index)


def _becomes(h: Hypothesis, found: EffectFinding, fitted: Sequence[Fitted]) -> NumberChange | None:
    """Return what a declared number was and became; None of any other effect."""
    name, line = h.effect.shifted_by, fitted[0][1].declaration if fitted else None
    if not name or line is None:
        return None
    number = next(n for n in declared_numbers(line) if n.name == h.location)
    change = float(found.parameters[name])
    ends = found.interval95.get(name, (change, change))
    before, after, low, high = (value_of(line, number, by) for by in (0.0, change, *ends))
    return NumberChange(before=before, after=after, low=low, high=high)


def _beginning(where: Mapping[str, float | str], fitted: Sequence[Fitted]) -> Moment | None:
    """Return when an unknown begins; None where it has no moment in a record fitted."""
    record_index = int(where.get("record", 1)) - 1  # the verdict's key counts from 1
    if "from_s" not in where or "held_out" in where or record_index >= len(fitted):
        return None
    name, time_s = fitted[record_index][0], float(where["from_s"])
    return Moment(record=name, time_s=time_s, record_index=record_index)


def _finding(
    accepted: AcceptedEffect,
    h: Hypothesis,
    values: Sequence[float],
    sd: Sequence[float],
    amplitude_sd: Mapping[str, float],
    known: Ranges,
) -> EffectFinding:
    """Return one finding; intervals that the search found (``known``) replace those of ``sd``."""
    rows = list(zip(h.names, values, sd, strict=True))
    parameters: dict[str, Value] = dict(h.fixed) | {name: value for name, value, _ in rows}
    intervals = {name: interval(value, spread) for name, value, spread in rows} | dict(known)
    for pair in h.effect.quadratures:
        if pair.amplitude and pair.cos in parameters:
            cos, sin = float(parameters[pair.cos]), float(parameters[pair.sin])
            size = math.hypot(cos, sin)
            parameters[pair.amplitude] = size
            parameters[pair.angle] = math.atan2(sin, cos)
            # of a part that left no trace and is fixed, the amplitude's error is the other part's
            of_parts = [spread for name, _, spread in rows if name in (pair.cos, pair.sin)]
            if of_parts:
                spread = amplitude_sd.get(pair.amplitude, max(of_parts))
                intervals[pair.amplitude] = interval(size, spread)
    return EffectFinding(
        place=EffectAt(h.effect.name_in_version_1 or h.effect.name, h.location),
        parameters=parameters,
        interval95=intervals,
        score=accepted.score,
        runner_up=accepted.runner_up,
        margin=accepted.margin,
        cancel=bool(h.effect.cancel_orders),
        text=h.effect.words(parameters)[0],
    )
