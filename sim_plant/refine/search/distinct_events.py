"""Which of the events that a matched filter found are worth a look on a grid of moments."""

from __future__ import annotations

from collections.abc import Sequence

from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.search.candidate import Candidate

EVENTS = CRITERIA.search.events


def moment_of(c: Candidate) -> float:
    """Return when a candidate begins, in the unit of its effect's moments."""
    return c.hypothesis.moment_of(c.start)


def distinct(seen: Sequence[Candidate], least_score: float) -> list[Candidate]:
    """Return the best few of ``seen`` (best first): moments and places of each effect.

    None far behind the best, nor so weak that on a grid of moments it would not reach
    ``least_score``. Near moments of an episode at one place are one.
    """
    kept: list[Candidate] = []
    floor = max(EVENTS.least_chi2, EVENTS.least_share * least_score)
    for c in seen:
        if c.score < max(floor, EVENTS.best_share * seen[0].score):
            break
        same = [k for k in kept if k.hypothesis.key == c.hypothesis.key]
        if any(k.hypothesis.is_episode and _near(k, c) for k in same):
            continue
        of_this_effect = [k for k in kept if k.hypothesis.effect is c.hypothesis.effect]
        if len(same) < EVENTS.most_moments and len(of_this_effect) < EVENTS.most_places:
            kept.append(c)
    return kept[: EVENTS.most_candidates]


def _near(one: Candidate, other: Candidate) -> bool:
    return abs(moment_of(one) - moment_of(other)) < EVENTS.episode_reach_s
