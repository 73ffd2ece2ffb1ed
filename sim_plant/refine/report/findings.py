"""From the selection of the search, and its error on the record judged, to the verdict."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from sim_plant.base.effects import Value
from sim_plant.line.build import cell_sensors
from sim_plant.line.declaration import Declaration
from sim_plant.refine.judge.holdout import Evaluation
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.report.confidence import (
    amplitude_standard_deviation,
    interval,
    standard_deviations,
)
from sim_plant.refine.report.experiments import experiments
from sim_plant.refine.report.verdict import (
    Ambiguity,
    Answer,
    ChannelError,
    EffectFinding,
    UnknownFinding,
    Verdict,
)
from sim_plant.refine.search.selection import AcceptedEffect, Ranges, Selection


def verdict_of(
    selection: Selection,
    evaluation: Evaluation | None,
    holdout: str,
    line: Declaration | None = None,
) -> Verdict:
    """Return the whole verdict.

    Parameters
    ----------
    evaluation : errors on the record judged; None where none was judged.
    holdout : path of that record, the first held out or else the first fitted.
    line : as the first record fitted was made on it; None: nothing is told by its channels.
    """
    return Verdict(
        answer=_answer(selection),
        effects=effect_findings(selection, line),
        unknown=tuple(
            UnknownFinding(kind=u.kind, coordinate=u.coordinate, strength=u.strength)
            for u in selection.unknown
        ),
        ambiguous=tuple(
            Ambiguity(
                place=a.hypothesis.key,
                alternatives=a.ambiguous,
                experiments=tuple(experiments(a.hypothesis.key, a.ambiguous)),
            )
            for a in selection.accepted
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


def channel_errors(evaluation: Evaluation) -> dict[str, ChannelError]:
    """Return the error of every channel before and after."""
    rows = zip(
        evaluation.channels, evaluation.before, evaluation.after, evaluation.floor, strict=True
    )
    return {
        name: ChannelError(before=float(b), after=float(a), noise_floor=float(f))
        for name, b, a, f in rows
    }


def effect_findings(
    selection: Selection, line: Declaration | None = None
) -> tuple[EffectFinding, ...]:
    """Return one finding per effect: parameters, 95 % intervals, score and runner-up."""
    cells = tuple(sensor.channel for sensor in cell_sensors(line)) if line is not None else ()
    findings, at = [], 0  # at: position of the effect's first number in the row of all
    sd = standard_deviations(selection.fit)
    fit = selection.fit
    ranges = selection.ranges or ({},) * len(fit.hypotheses)
    rows = zip(selection.accepted, fit.hypotheses, fit.values, ranges, strict=True)
    for accepted, h, values, known in rows:
        position = {name: at + k for k, name in enumerate(h.names)}
        amplitude_sd = {
            pair.amplitude: amplitude_standard_deviation(
                fit, position[pair.cos], position[pair.sin]
            )
            for pair in h.effect.quadratures
            if pair.cos in position and pair.sin in position
        }
        own_sd = sd[at : at + len(values)]
        found = _finding(accepted, h, values, own_sd, amplitude_sd, known)
        findings.append(replace(found, cells=cells))
        at += len(values)
    return tuple(findings)


def _finding(
    accepted: AcceptedEffect,
    h: Hypothesis,
    values: Sequence[float],
    sd: Sequence[float],
    amplitude_sd: Mapping[str, float],
    known: Ranges,
) -> EffectFinding:
    """Return one finding; ``known`` are intervals that the search found, they go before others."""
    rows = list(zip(h.names, values, sd, strict=True))
    parameters: dict[str, Value] = dict(h.fixed) | {name: value for name, value, _ in rows}
    intervals = {name: interval(value, spread) for name, value, spread in rows} | dict(known)
    for pair in h.effect.quadratures:
        if pair.amplitude and pair.cos in parameters:
            cos, sin = float(parameters[pair.cos]), float(parameters[pair.sin])
            size = math.hypot(cos, sin)
            parameters[pair.amplitude] = size
            parameters[pair.angle] = math.atan2(sin, cos)
            intervals[pair.amplitude] = interval(size, amplitude_sd.get(pair.amplitude, max(sd)))
    return EffectFinding(
        place=EffectAt(h.effect.name_in_version_1 or h.effect.name, h.location),
        parameters=parameters,
        interval95=intervals,
        score=accepted.score,
        runner_up=accepted.runner_up,
        margin=accepted.margin,
        cancel=bool(h.effect.cancel_orders),
        text=h.effect.text,
    )
