"""Which of several fitted effects is claimed, and what it was chosen against."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from sim_plant.refine.fit.gauss_newton import Fit, gauss_newton_fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.search.degenerate_pair import better_pair
from sim_plant.refine.search.effect_fit import fit_candidate
from sim_plant.refine.search.screening import Candidate, bic_penalty
from sim_plant.refine.search.unexplained import Unknown
from sim_plant.refine.spectra.coordinates import Travel, line_support
from sim_plant.refine.spectra.line_spectrum import LineSpectrum

SCORE_THRESHOLD = 120.0
"""Effects that are no lines: healthy records of other code, and line01, reach 85 to 115."""
LINE_SCORE = 50.0
"""An effect with a coordinate of its own needs less: what a model lacks seldom has the same."""
BEYOND_DOUBT = 3000.0
"""A score above this needs no second look at the declared drive tick."""
WEAK = 150.0
"""An effect without a line is not claimed below this when another explains nearly as much."""
MARGIN = 10.0
"""Effects whose scores are closer than this cannot be told apart."""
MOST_LOOKS = 5
RUNNERS = 4
DISCREPANCY = 0.006
"""A further effect must explain more than this share of what was explained: no model is exact."""
IMPERFECT = 0.001
"""The same of what free terms took up: they leave about this much, at coordinates of their own."""

Progress = Callable[[str], None]
FittedCandidate = tuple[float, Fit, Hypothesis]
"""Score, fit, and the effect that the fit adds."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AcceptedEffect:
    """One accepted effect, and what it was chosen against."""

    hypothesis: Hypothesis
    score: float
    runner_up: str
    margin: float
    rejected: tuple[tuple[str, str, float], ...]  # effect, location, score
    ambiguous: tuple[tuple[str, str], ...] = ()


@dataclass(slots=True, kw_only=True, eq=False)
class Selection:
    """Everything the search found.

    ``corrections`` are the declared numbers as re-estimated with the effects, by path: none where
    structure is left that is no line, for they may then have imitated it. ``aside`` is the cost
    that free terms took up before the search.
    """

    nominal: Fit
    fit: Fit
    travels: list[Travel]
    before: list[list[LineSpectrum]]
    after: list[list[LineSpectrum]]
    steps: list[AcceptedEffect] = field(default_factory=list)
    unknown: list[Unknown] = field(default_factory=list)
    corrections: dict[str, float] = field(default_factory=dict)
    aside: float = 0.0
    first_look: list[Candidate] = field(default_factory=list)


def is_line(h: Hypothesis, found: Selection) -> bool:
    """Return whether a hypothesis shows at a coordinate of its own."""
    return line_support(h, found.travels[0], found.before[0]) is not None


def claim(
    objective: Objective,
    found: Selection,
    ranked: list[Candidate],
    progress: Progress,
    pulled: Sequence[FittedCandidate] = (),
) -> tuple[AcceptedEffect, Fit] | None:
    """Return the effect that explains most, fitted, or None when none may be claimed."""
    fits = list(pulled)
    for s in _shortlist(ranked):
        fit = fit_candidate(objective, found.fit, s)
        if fit is None:
            continue
        h = fit.hypotheses[-1]
        score = found.fit.cost - fit.cost - bic_penalty(objective, len(h.names))
        progress(f"  {h.effect.name} at {h.location}: score {score:.0f}")
        fits.append((score, fit, h))
    fits = sorted((row for row in fits if np.isfinite(row[0])), key=lambda row: -row[0])
    fits = [row for k, row in enumerate(fits) if row[2].key not in {f[2].key for f in fits[:k]}]
    fits = _looked_at_again(objective, found, fits, progress)
    if not fits:
        return None
    score, fit, h = fits[0]
    if score < _least(found, h):
        return None
    others = [(s, k) for s, _, k in fits[1:] if k.key != h.key]
    others += [
        (s.score, s.hypothesis)
        for s in ranked
        if s.hypothesis.key not in {k.key for _, _, k in fits}
    ]
    others.sort(key=lambda row: -row[0])
    runner, second = (others[0][1], others[0][0]) if others else (None, 0.0)
    if runner and score < WEAK and score - second < MARGIN and not is_line(h, found):
        progress(
            f"  {h.effect.name} at {h.location}: weak, and not to be told from "
            f"{runner.effect.name} at {runner.location}"
        )
        return None
    progress(f"  best: {h.effect.name} at {h.location}, score {score:.0f}")
    two: tuple[tuple[str, str], ...] = ()
    if score < BEYOND_DOUBT:  # above this, two places only mend what the model has wrong
        two = better_pair(objective, found.fit, found.travels[0], h, ranked)
    if two:
        progress(f"  as well told by {' and '.join(' at '.join(key) for key in two)} together")
    alike = [k.key for s, k in others if score - s < MARGIN]
    step = AcceptedEffect(
        hypothesis=h,
        score=score,
        runner_up=" at ".join(runner.key) if runner else "",
        margin=score - max(second, 0.0),
        rejected=tuple((k.effect.name, k.location, s) for s, k in others[:12]),
        ambiguous=tuple(dict.fromkeys([*alike, *two])),
    )
    return step, fit


def _least(found: Selection, h: Hypothesis) -> float:
    explained = found.nominal.cost - found.fit.cost
    least = LINE_SCORE if is_line(h, found) else SCORE_THRESHOLD
    return max(least, DISCREPANCY * explained, IMPERFECT * found.aside)


def _shortlist(ranked: Sequence[Candidate]) -> list[Candidate]:
    """Return the best few of distinct effect and place; curved ones get a second chance."""
    best = ranked[0].score if ranked else 0.0
    kept: list[Candidate] = []
    for s in ranked:
        curved = not all(s.hypothesis.linear)
        share = 0.25 if curved else 0.85
        if s.score < max(0.5 * LINE_SCORE, share * best):
            continue
        same = [k for k in kept if k.hypothesis.key == s.hypothesis.key]
        effect = [k for k in kept if k.hypothesis.effect.name == s.hypothesis.effect.name]
        if same or len(effect) >= 3:
            continue
        kept.append(s)
    return kept[: RUNNERS + 2]


def _looked_at_again(
    objective: Objective, found: Selection, fits: Sequence[FittedCandidate], progress: Progress
) -> list[FittedCandidate]:
    """Return the fits with small scores put right by what is lost without the effect, best first.

    One that is not missed makes room for the next; those that come near the best are looked at
    as well, so that a margin is between like and like.
    """
    again: list[FittedCandidate] = []
    best = 0.0
    for raw, fit, h in fits:
        least = _least(found, h)
        if raw < max(least, best - MARGIN) or len(again) == MOST_LOOKS:
            break
        score = raw
        if raw < BEYOND_DOUBT:
            score = min(raw, _missed(objective, fit) - bic_penalty(objective, len(h.names)))
            if score < least:
                progress(
                    f"  {h.effect.name} at {h.location}: not missed when all else is fitted again"
                )
        again.append((score, fit, h))
        best = max(best, score)
    rest = [(min(raw, best) if again else raw, fit, h) for raw, fit, h in fits[len(again) :]]
    return sorted([*again, *rest], key=lambda row: -row[0])


def _missed(objective: Objective, fit: Fit) -> float:
    """Return how much the cost rises without the last effect, all else fitted anew from here.

    Both at the declared drive tick. A fit that was made again finds a better place for the
    declared numbers too, and a coarse tick moves the speed at which a quantised loop rests:
    those shares are not the effect's.
    """
    there = gauss_newton_fit(
        objective, fit.hypotheses, fit.values, fit.shifts, rounds=4, coarse=False
    )
    gone = gauss_newton_fit(
        objective, fit.hypotheses[:-1], there.values[:-1], there.shifts, rounds=4, coarse=False
    )
    return gone.cost - there.cost
