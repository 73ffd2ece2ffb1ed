"""The machine-readable verdict, version 1."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit
from sim_plant.refine.judge.holdout import Evaluation
from sim_plant.refine.report.experiments import experiments
from sim_plant.refine.search.selection import Selection

NINETY_FIVE = 1.959964


def standard_deviations(fit: Fit) -> list[float]:
    """Return one per fitted number: noise and tolerances, and for sizes the model's own error."""
    noise = [math.sqrt(max(0.0, float(v))) for v in fit.covariance.diagonal()]
    found: list[float] = []
    for h, values in zip(fit.hypotheses, fit.values, strict=True):
        change = {n: v - a for n, v, a in zip(h.names, values, h.absent, strict=True)}
        phasors = {name for pair in h.effect.quadratures for name in (pair.cos, pair.sin)}
        phasor = math.hypot(*(v for name, v in change.items() if name in phasors))
        for name, value in change.items():
            strength = h.effect.accepts[name].role == "strength"
            own = phasor if name in phasors else value
            found.append(
                math.hypot(noise[len(found)], CRITERIA.report.model_share * own * strength)
            )
    return found


def effect_rows(selection: Selection) -> list[dict[str, Any]]:
    """Return one row per effect: name, location, parameters, 95 % intervals, score, runner-up."""
    rows: list[dict[str, Any]] = []
    at = 0
    sd = standard_deviations(selection.fit)
    for step, h, values in zip(
        selection.accepted, selection.fit.hypotheses, selection.fit.values, strict=True
    ):
        parameters: dict[str, Any] = dict(h.fixed) | dict(zip(h.names, values, strict=True))
        intervals = {
            name: [value - NINETY_FIVE * sd[at + k], value + NINETY_FIVE * sd[at + k]]
            for k, (name, value) in enumerate(zip(h.names, values, strict=True))
        }
        at += len(values)
        for pair in h.effect.quadratures:
            if pair.amplitude and pair.cos in parameters:
                size = math.hypot(parameters[pair.cos], parameters[pair.sin])
                spread = NINETY_FIVE * max(sd[at - len(values) : at])
                parameters[pair.amplitude] = size
                parameters[pair.angle] = math.atan2(parameters[pair.sin], parameters[pair.cos])
                intervals[pair.amplitude] = [size - spread, size + spread]
        rows.append(
            {
                "effect": h.effect.name_in_version_1 or h.effect.name,
                "location": h.location,
                "parameters": parameters,
                "interval95": intervals,
                "score": step.score,
                "runner_up": step.runner_up or "",
                "margin": step.margin,
                "cancel": bool(h.effect.cancel_orders),
                "text": h.effect.text,
            }
        )
    return rows


def verdict(selection: Selection, evaluation: Evaluation | None, holdout: str) -> dict[str, Any]:
    """Return the whole verdict as plain values."""
    word = "nothing"
    if selection.accepted:
        word = "traced"
    if any(step.ambiguous for step in selection.accepted):
        word = "not_identifiable"
    if selection.unknown:
        word = "unknown"
    table = {}
    if evaluation is not None:
        table = {
            name: {"before": float(b), "after": float(a), "noise_floor": float(f)}
            for name, b, a, f in zip(
                evaluation.channels,
                evaluation.before,
                evaluation.after,
                evaluation.floor,
                strict=True,
            )
        }
    return {
        "version": 1,
        "verdict": word,
        "effects": effect_rows(selection),
        "unknown": [
            {"class": u.kind, "coordinate": u.coordinate, "strength": u.strength}
            for u in selection.unknown
        ],
        "ambiguous": [
            {
                "effect": s.hypothesis.key,
                "with": list(s.ambiguous),
                "experiments": experiments(s.hypothesis.key, s.ambiguous),
            }
            for s in selection.accepted
            if s.ambiguous
        ],
        "residual_rms": table,
        "holdout": holdout,
    }


def declared_entries(fit: Fit) -> list[dict[str, Any]]:
    """Return the effects as entries of a line declaration."""
    return [
        {"effect": e.effect, "location": e.location, "parameters": dict(e.parameters)}
        for e in fit.effects
    ]


def aff_blocks(rows: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return AFF blocks (roll, orders) for effects that a drive can cancel."""
    blocks = []
    for row in rows:
        if not row["cancel"] or row["effect"] not in BY_NAME:
            continue
        orders = list(BY_NAME[row["effect"]].cancelled(row["parameters"]))
        blocks.append(
            {"roll": row["location"], "orders": orders, "settle_s": 6.0, "amp_limit_m_s": 0.02}
        )
    return blocks
