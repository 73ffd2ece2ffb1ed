"""Find an episode: the beginning and the end of an effect at once, over all pairs of moments.

The response to an episode is that to an effect without an end, less the same response shifted to
the episode's end: one simulation serves every pair. Ends are as sharp as beginnings; a fit finds
neither from seconds away.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.effects.onset import FOREVER_S, HOLD_S
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.fit.projection import Inner
from sim_plant.refine.model.hypotheses import Hypothesis, StartValues
from sim_plant.refine.search.candidate import Candidate
from sim_plant.refine.search.distinct_events import moment_of
from sim_plant.refine.search.shifted_responses import lasting_response
from sim_plant.refine.spectra.moment_axis import MomentAxis, shifted

EVENTS = CRITERIA.search.events


def ended_again(
    objective: Objective, axis: MomentAxis, shown: Sequence[Candidate], residual: Array
) -> list[Candidate]:
    """Return the best episode of the record for each place in ``shown``.

    The matched filter takes an episode of one length, 6 s, and finds of one of 20 s a fifth of
    what that explains. Here every pair of a beginning and an end is weighed.
    """
    found: list[Candidate] = []
    step = EVENTS.ends_step_s
    moments = np.arange(axis.grid[0] + step, axis.grid[-1], step)
    places = {c.hypothesis.key: c for c in reversed(shown) if c.hypothesis.is_episode}
    for c in places.values():
        h = c.hypothesis
        columns = objective.whitened_all(
            [lasting_response(objective, axis, h, m) for m in moments.tolist()]
        )
        inner = objective.projector.inner(residual, columns)
        begin, end, chi2 = _best_of_pairs(inner, moments, moments, slice(None), slice(None))
        start = with_episode(c, begin - moment_of(c), end - begin)
        found.append(replace(c, chi2_reduction=chi2, start=start))
    return found


def best_episodes(
    objective: Objective, fit: Fit, c: Candidate, residual: Array
) -> list[StartValues]:
    """Return two starts: with the best beginning and end, and with that beginning and no end.

    The response is simulated at the candidate's own moment and shifted from there.
    """
    h = c.hypothesis
    endless = replace(
        h,
        start=(*h.start[: h.strength_count], *with_episode(c, 0.0, FOREVER_S)[h.strength_count :]),
    )
    case = replace(fit.case, effects=(*fit.case.effects, endless.start_effects()[0]))
    base, run = objective.pool.run([fit.case, case], keep=False)
    change = [y - b for y, b in zip(run, base, strict=True)]
    if not all(np.isfinite(part).all() for part in change):
        return []
    record = h.record_index or 0
    step_s = objective.pool.twins[record].declaration.sample_time_s
    moment = moment_of(c)
    last = change[record].shape[1] * step_s - moment
    wide, reach = EVENTS.episode_step_s, EVENTS.episode_reach_s
    begins = np.arange(max(-reach, -moment), min(reach, last), wide)
    ends = np.arange(begins[0] + wide, last, wide)
    begin, end = _best_pair(objective, h, change, residual, begins, ends)
    close = wide * np.array(EVENTS.beside_edge)
    begins, ends = begin + close[begin + close >= -moment], end + close
    begin, end = _best_pair(objective, h, change, residual, begins, ends[ends < last])
    return [with_episode(c, begin, end - begin), with_episode(c, begin, FOREVER_S)]


def with_episode(c: Candidate, later_s: float, hold_s: float) -> StartValues:
    """Return the candidate's numbers with its moment ``later_s`` later and held for ``hold_s``."""
    h = c.hypothesis
    change = {h.moment_parameter: moment_of(c) + later_s, HOLD_S: hold_s}
    return tuple(change.get(n, v) for n, v in zip(h.names, c.start, strict=True))


def _best_pair(
    objective: Objective,
    h: Hypothesis,
    change: Sequence[Array],
    residual: Array,
    begins: Array,
    ends: Array,
) -> tuple[float, float]:
    """Return the beginning and the end, s from that of ``change``, that explain most."""
    record = h.record_index or 0
    step_s = objective.pool.twins[record].declaration.sample_time_s

    def begun_later(shift_s: float) -> list[Array]:
        moved = list(change)
        moved[record] = shifted(change[record], round(shift_s / step_s))
        return moved

    columns = objective.whitened_all([begun_later(float(s)) for s in (*begins, *ends)])
    inner = objective.projector.inner(residual, columns)
    at = begins.size
    return _best_of_pairs(inner, begins, ends, slice(None, at), slice(at, None))[:2]


def _best_of_pairs(
    inner: Inner, begins: Array, ends: Array, first: slice, last: slice
) -> tuple[float, float, float]:
    """Return the beginning and the end that explain most, and the chi-square that they explain.

    ``first`` and ``last`` are the columns of beginnings and ends in ``inner``.
    Equation: (v_b - v_e)^2 / (G_bb - 2 G_be + G_ee), v = S' P r, G = S' P S over the shifted
    responses S, P what nuisances cannot explain; an end not before ``episode_step_s``.
    """
    gram, against, size = inner.gram, inner.against, np.diag(inner.gram)
    power = size[first, None] - 2.0 * gram[first, last] + size[None, last]
    gain = (against[first, None] - against[None, last]) ** 2
    apart = ends[None, :] - begins[:, None] > 0.99 * EVENTS.episode_step_s
    floor = max(1e-9 * float(size.max()), 1e-300)
    explained = np.where(apart & (power > floor), gain / np.maximum(power, floor), 0.0)
    row, column = np.unravel_index(int(np.argmax(explained)), explained.shape)
    return float(begins[row]), float(ends[column]), float(explained[row, column])
