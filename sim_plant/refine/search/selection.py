"""Which of several fitted effects is claimed, and what it was chosen against."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from sim_plant.refine.fit.gauss_newton import Fit, refine_fit
from sim_plant.refine.fit.objective import Problem
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.model.place import Place
from sim_plant.refine.search.degenerate_pair import two_instead
from sim_plant.refine.search.effect_fit import fit_one
from sim_plant.refine.search.screening import Scored, price
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

Say = Callable[[str], None]
Rival = tuple[float, Fit, Hypothesis]
"""Score, fit, and the effect that the fit adds."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Step:
    """One accepted effect, and what it was chosen against."""

    hypothesis: Hypothesis
    score: float
    runner_up: Place | None
    margin: float
    rejected: tuple[tuple[Place, float], ...]  # and its score
    ambiguous: tuple[Place, ...] = ()


@dataclass(slots=True, kw_only=True, eq=False)
class Trace:
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
    steps: list[Step] = field(default_factory=list)
    unknown: list[Unknown] = field(default_factory=list)
    corrections: dict[str, float] = field(default_factory=dict)
    aside: float = 0.0
    first_look: list[Scored] = field(default_factory=list)


def is_line(h: Hypothesis, found: Trace) -> bool:
    """Return whether a hypothesis shows at a coordinate of its own."""
    return line_support(h, found.travels[0], found.before[0]) is not None


def claim(
    problem: Problem, found: Trace, ranked: list[Scored], say: Say, pulled: Sequence[Rival] = ()
) -> tuple[Step, Fit] | None:
    """Return the effect that explains most, fitted, or None when none may be claimed."""
    fits = list(pulled)
    for s in _shortlist(ranked):
        fit = fit_one(problem, found.fit, s)
        if fit is None:
            continue
        h = fit.hypotheses[-1]
        score = found.fit.cost - fit.cost - price(problem, len(h.names))
        say(f"  {h.key}: score {score:.0f}")
        fits.append((score, fit, h))
    fits = sorted((row for row in fits if np.isfinite(row[0])), key=lambda row: -row[0])
    fits = [row for k, row in enumerate(fits) if row[2].key not in {f[2].key for f in fits[:k]}]
    fits = _looked_at_again(problem, found, fits, say)
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
        say(f"  {h.key}: weak, and not to be told from {runner.key}")
        return None
    say(f"  best: {h.key}, score {score:.0f}")
    two: tuple[Place, ...] = ()
    if score < BEYOND_DOUBT:  # above this, two places only mend what the model has wrong
        two = two_instead(problem, found.fit, found.travels[0], h, ranked)
    if two:
        say(f"  as well told by {' and '.join(map(str, two))} together")
    alike = [k.key for s, k in others if score - s < MARGIN]
    step = Step(
        hypothesis=h,
        score=score,
        runner_up=runner.key if runner else None,
        margin=score - max(second, 0.0),
        rejected=tuple((k.key, s) for s, k in others[:12]),
        ambiguous=tuple(dict.fromkeys([*alike, *two])),
    )
    return step, fit


def _least(found: Trace, h: Hypothesis) -> float:
    explained = found.nominal.cost - found.fit.cost
    least = LINE_SCORE if is_line(h, found) else SCORE_THRESHOLD
    return max(least, DISCREPANCY * explained, IMPERFECT * found.aside)


def _shortlist(ranked: Sequence[Scored]) -> list[Scored]:
    """Return the best few of distinct effect and place; curved ones get a second chance."""
    best = ranked[0].score if ranked else 0.0
    kept: list[Scored] = []
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
    problem: Problem, found: Trace, fits: Sequence[Rival], say: Say
) -> list[Rival]:
    """Return the fits with small scores put right by what is lost without the effect, best first.

    One that is not missed makes room for the next; those that come near the best are looked at
    as well, so that a margin is between like and like.
    """
    again: list[Rival] = []
    best = 0.0
    for raw, fit, h in fits:
        least = _least(found, h)
        if raw < max(least, best - MARGIN) or len(again) == MOST_LOOKS:
            break
        score = raw
        if raw < BEYOND_DOUBT:
            score = min(raw, _missed(problem, fit) - price(problem, len(h.names)))
            if score < least:
                say(f"  {h.key}: not missed when all else is fitted again")
        again.append((score, fit, h))
        best = max(best, score)
    rest = [(min(raw, best) if again else raw, fit, h) for raw, fit, h in fits[len(again) :]]
    return sorted([*again, *rest], key=lambda row: -row[0])


def _missed(problem: Problem, fit: Fit) -> float:
    """Return how much the cost rises without the last effect, all else fitted anew from here.

    Both at the declared drive tick. A fit that was made again finds a better place for the
    declared numbers too, and a coarse tick moves the speed at which a quantised loop rests:
    those shares are not the effect's.
    """
    there = refine_fit(problem, fit.hypotheses, fit.values, fit.shifts, rounds=4, coarse=False)
    gone = refine_fit(
        problem, fit.hypotheses[:-1], there.values[:-1], there.shifts, rounds=4, coarse=False
    )
    return gone.cost - there.cost
