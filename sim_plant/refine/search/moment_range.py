"""Between which moments something may have begun: all are weighed, near and far.

Where what begins has an edge (the speed of a drive, the reading of a cell), two moments a few
samples apart leave two edges each, and those ten times as far apart no more than that. Noise then
puts the best moment anywhere among those that the slow rest of the response does not part: the
cost between is no parabola, and its curvature at the best moment is that of one edge.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.search.likely_range import Held, LikelyRange

REPORT, MOMENTS = CRITERIA.report, CRITERIA.report.moments
LANES = 8
"""Lines that are simulated side by side."""


def is_plain_moment(h: Hypothesis, name: str) -> bool:
    """Return whether a number is the moment, s, of an effect that has a size and no shape."""
    onset = h.effect.onset
    timed = onset is not None and onset.unit == "s" and name == h.moment_parameter
    return timed and len(h.names) == 2 and h.effect.accepts[h.names[0]].linear


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Begun:
    """An effect begun at several moments, each by a simulation.

    Attributes
    ----------
    offsets : of these moments from the fitted one, in order, s (n,).
    gram, against : products of the responses with each other (n, n), and with the record less all
        but the effect (n,), in what all other numbers cannot explain.
    """

    offsets: Array
    gram: Array
    against: Array

    @property
    def fitted(self) -> int:
        """Which of them is the fitted one."""
        return int(np.flatnonzero(self.offsets == 0.0)[0])

    @property
    def saved(self) -> Array:
        """Chi-square that the effect of best size explains, by moment (n,)."""
        found: Array = self.against**2 / _power(self.gram)
        return found


def moment_range(
    objective: Objective, fit: Fit, columns: Array, at: int, effect: int, louder: float
) -> LikelyRange:
    """Return between which ends the moment of effect ``effect``, number ``at`` of all, lies.

    Its size is fitted again at each moment, all other numbers by their slopes. The cost at the
    true moment is above that at the best by what noise makes of it: ``limit_of``.

    Parameters
    ----------
    columns : change of the whitened residual per number, at ``fit`` (rows, q).
    louder : variance of a number, over what the weighing's noise alone makes of it.
    """
    h, values = fit.hypotheses[effect], fit.values[effect]
    moment, first = h.names.index(h.moment_parameter), at - h.names.index(h.moment_parameter)
    others = np.delete(columns, [first, first + 1], axis=1)
    begun = _begun(objective, fit, others, effect, MOMENTS.far_chi2 * louder)
    saved, power = begun.saved, _power(begun.gram)
    best, limit = int(np.argmax(saved)), limit_of(begun.gram, begun.fitted, louder)
    inside = np.flatnonzero(saved[best] - saved <= limit)
    reached = np.pad(begun.offsets, 1, mode="edge")
    reached = 0.5 * (reached[:-1] + reached[1:])  # an end is half way to the next moment
    low, high = float(reached[inside[0]]), float(reached[inside[-1] + 1])
    flat = np.array([x for row in fit.values for x in row], dtype=np.float64)
    rows = np.tile(flat, (inside.size + 1, 1))
    rows[:-1, at] += begun.offsets[inside]
    rows[:-1, first + 1 - moment] = values[1 - moment] * (begun.against / power)[inside]
    there = flat.copy()
    there[at] += begun.offsets[best]
    cost = fit.cost - float(saved[best] - saved[begun.fitted])
    return LikelyRange(
        low=float(flat[at]) + low,
        high=float(flat[at]) + high,
        lowest=rows.min(axis=0),
        highest=rows.max(axis=0),
        best=Held(cost=cost, values=there, residual=None),
    )


def limit_of(gram: Array, true: int, louder: float) -> float:
    """Return how far the cost at the true moment is above the best, in ``confidence`` of noise.

    ``gram`` (n, n) : products of the responses begun at each moment, of which one is the true one.
    Equation: the quantile of max_j E_j - E_t, E_j = (G_tj + z_j)^2 / G_jj, z ~ N(0, k G), k
    ``louder``. Of a response without an edge it is that of chi-square, 3.84 k; of an edge alone
    that of a change point, 7.35 k [Hansen 2000].
    """
    size = np.sqrt(_power(gram))
    values, directions = np.linalg.eigh(gram / np.outer(size, size))
    root = directions * np.sqrt(np.clip(values, 0.0, None))
    drawn = np.random.default_rng(0).standard_normal((MOMENTS.draws, size.size))
    saved = np.square(gram[true] / size + math.sqrt(louder) * drawn @ root.T)
    return float(np.quantile(saved.max(axis=1) - saved[:, true], REPORT.confidence))


def _power(gram: Array) -> Array:
    return np.maximum(np.diag(gram), 1e-300)


def _begun(objective: Objective, fit: Fit, others: Array, effect: int, far_chi2: float) -> _Begun:
    """Return the effect begun at moments to either side, until a response is ``far_chi2`` off.

    Between the moments next to the best of them at every sample.
    """
    simulate = _simulation(objective, fit, effect)
    h, values = fit.hypotheses[effect], fit.values[effect]
    twin, moment_s = objective.pool.twins[h.record_index or 0], h.moment_of(values)
    sample_s = float(twin.declaration.sample_time_s)
    known = {0: simulate([0.0])[:, 0]}
    for sign, room_s in ((-1, moment_s), (1, twin.speed_m_s.size * sample_s - moment_s)):
        for steps in _growing(round(room_s / sample_s)):
            runs = simulate([sign * sample_s * step for step in steps])
            known.update(zip([sign * step for step in steps], runs.T, strict=True))
            off = objective.projector.project(runs[:, -1] - known[0])
            if float(off @ off) > far_chi2:
                break
    found = _products(objective, fit, known, others)
    at, steps = int(np.argmax(found.saved)), sorted(known)
    near = range(steps[max(at - 1, 0)], steps[min(at + 1, len(steps) - 1)])
    more = [step for step in near if step not in known]
    if more:
        runs = simulate([sample_s * step for step in more])
        known.update(zip(more, runs.T, strict=True))
        found = _products(objective, fit, known, others)
    return replace(found, offsets=sample_s * found.offsets)


def _simulation(objective: Objective, fit: Fit, effect: int) -> Callable[[Sequence[float]], Array]:
    """Return what gives the whitened responses (rows, n) to an effect begun so much later, s."""
    h, values = fit.hypotheses[effect], fit.values[effect]
    at = h.names.index(h.moment_parameter)
    absent = [v if k == at else h.absent[k] for k, v in enumerate(values)]

    def responses(offsets: Sequence[float]) -> Array:
        rows = [[v + later * (k == at) for k, v in enumerate(values)] for later in offsets]
        cases = [fit.with_effect_at(effect, h, row).case for row in (absent, *rows)]
        base, *runs = objective.pool.run(cases, keep=False)
        return objective.columns(runs, base, np.ones(len(runs)))

    return responses


def _products(objective: Objective, fit: Fit, known: Mapping[int, Array], others: Array) -> _Begun:
    """Return the products of responses by offset, in samples."""
    steps = sorted(known)
    columns = np.concatenate([np.stack([known[s] for s in steps], axis=1), others], axis=1)
    inner, n = objective.projector.inner(fit.residual, columns), len(steps)
    taken = inner.gram[:n, n:] @ np.linalg.pinv(inner.gram[n:, n:], hermitian=True)
    gram = inner.gram[:n, :n] - taken @ inner.gram[n:, :n]
    left = inner.against[:n] - taken @ inner.against[n:]
    return _Begun(
        offsets=np.array(steps, dtype=np.float64),
        gram=gram,
        against=left + gram[:, steps.index(0)],  # the fit has taken that response out
    )


def _growing(last: int) -> Iterator[list[int]]:
    """Yield samples 1, 2, 3, ..., by ``MOMENTS.growth`` apart further out, some at a time."""
    steps, step = [], 1
    while step < last:
        steps.append(step)
        step = max(step + 1, round(MOMENTS.growth * step))
    for k in range(0, len(steps), LANES):
        yield steps[k : k + LANES]
