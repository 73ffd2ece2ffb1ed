"""Records, twins, noise and tolerances as one weighted least-squares objective.

The objective is a value: what is simulated and weighed otherwise is another objective
(`relinearised_at`, `with_free_shapes`, `conditioned_on`). Results of simulations are kept by the
pool, never here.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.linearisation import Linearisation, linearised_at, with_free_bodies
from sim_plant.refine.fit.projection import AT_ONCE, Projector
from sim_plant.refine.fit.start_states import Changes, shown_directions
from sim_plant.refine.fit.whitening import Whitening, declared_whitening
from sim_plant.refine.model.nuisances import Nuisance, declared_nuisances
from sim_plant.refine.model.simulation_pool import SimulationPool
from sim_plant.refine.model.twin import Case


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Objective:
    """Whitened residuals of all records against the twins, in one vector.

    The vector ends in one row per declared tolerance: what a shift of that number costs.

    Attributes
    ----------
    pool : simulates the twins of the records.
    measured : channels of every record (channels, samples).
    nuisances : declared numbers with a tolerance.
    linearisation : the point where responses were taken, with these responses.
    whitening : how the channels are weighed.
    projector : takes out what nuisances explain: shifts within tolerances, zeros of angles, free
        shapes, wander and start states.
    """

    pool: SimulationPool
    measured: tuple[Array, ...]
    nuisances: tuple[Nuisance, ...]
    linearisation: Linearisation
    whitening: Whitening
    projector: Projector

    @property
    def rows(self) -> int:
        """Number of judged samples of all channels and records."""
        return judged_rows(self.measured, self.whitening)

    @property
    def prior_sd(self) -> Array:
        """Prior standard deviation of every nuisance shift."""
        return prior_sd(self.nuisances)

    @property
    def expected_cost(self) -> float:
        """Cost that a true model would leave: rows, quantised channels counted less."""
        total = 0.0
        for noise, measured in zip(self.whitening.noise, self.measured, strict=True):
            quantised = np.array([taps.size == 1 for taps in noise.filters])
            total += float(np.where(quantised, noise.share, 1.0).sum()) * (
                measured.shape[1] - noise.first
            )
        taken = [0 if q is None else q.shape[1] for q in self.whitening.basis]
        total -= 2.0 * CRITERIA.fit.free_orders * len(self.linearisation.free_bodies)
        if not self.linearisation.wander_sd:
            total -= len(self.linearisation.wander_changes)
        terms = sum(m.shape[0] * k for m, k in zip(self.measured, taken, strict=True))
        return total - float(terms)

    @property
    def cost_standard_deviation(self) -> float:
        """Standard deviation of the cost of a true model, that of chi-square."""
        return math.sqrt(2.0 * self.expected_cost)

    def excess(self, cost: float, residual: Array) -> float:
        """Return by how much a cost is more than noise; below zero where it is less.

        How much the steps of a coarse word leave depends on the rate at which they pass, which
        the speed of the true line decides: of a channel of such words only what is beyond
        ``coarse_power`` times what is expected counts.
        """
        return cost - self.expected_cost - self.quantisation_chi2(residual)

    def quantisation_chi2(self, residual: Array) -> float:
        """Return the part of a residual's cost that the steps of coarse words alone may leave."""
        chi2 = 0.0
        rows = zip(self.whitening.noise, self.split(residual), strict=True)
        for noise, part in rows:
            expected = noise.share * part.shape[1]
            over = np.sum(part**2, axis=1) - expected
            by_steps = np.clip(over, 0.0, (CRITERIA.fit.coarse_power - 1.0) * expected)
            chi2 += float(np.sum(by_steps[np.logical_not(noise.analogue)]))
        return chi2

    def residual(
        self, run: Sequence[Array], shifts: dict[str, float] | None = None, quick: bool = True
    ) -> Array:
        """Return the residual vector of a run made with these nuisance shifts.

        ``quick``: the run is at the quick drive tick. The difference between the declared and
        the quick tick, as it is at the linearisation point, is added to it.
        """
        here = self.linearisation
        residuals = [
            m - (y + d - q) if quick else m - y
            for m, y, d, q in zip(
                self.measured, run, here.declared_tick, here.quick_tick, strict=True
            )
        ]
        shift = np.array([(shifts or {}).get(n.name, 0.0) for n in self.nuisances])
        return np.concatenate([self.whitening.vector(residuals), -shift / self.prior_sd])

    def column(self, run: Sequence[Array], base: Sequence[Array], increment: float) -> Array:
        """Return the whitened derivative between runs at the quick tick, zero for tolerances."""
        return self.whitened([(y - b) / increment for y, b in zip(run, base, strict=True)])

    def columns(
        self,
        runs: Sequence[Sequence[Array]],
        base: Sequence[Array],
        increments: Sequence[float] | Array,
    ) -> Array:
        """Return the whitened derivatives between runs and ``base``, side by side (rows, runs)."""
        return self.whitened_all(
            [
                [(y - b) / increment for y, b in zip(run, base, strict=True)]
                for run, increment in zip(runs, increments, strict=True)
            ]
        )

    def whitened(self, change: Sequence[Array]) -> Array:
        """Return a per-record change (channels, samples) as a column, zero in tolerances' rows."""
        column: Array = self.whitened_all([change])[:, 0]
        return column

    def whitened_all(self, changes: Sequence[Sequence[Array]]) -> Array:
        """Return several changes as columns (rows, changes), see ``whitened``."""
        return _matrix(self.whitening, changes, len(self.nuisances))

    def split(self, vector: Array) -> list[Array]:
        """Return the per-record innovations (channels, judged samples) of a residual vector."""
        parts, at = [], 0
        for noise, measured in zip(self.whitening.noise, self.measured, strict=True):
            shape = (measured.shape[0], measured.shape[1] - noise.first)
            parts.append(vector[at : at + shape[0] * shape[1]].reshape(shape))
            at += shape[0] * shape[1]
        return parts


def declared_objective(pool: SimulationPool, measured: Sequence[Array]) -> Objective:
    """Return the objective of records (channels, samples) linearised at the declared line.

    Raises
    ------
    PlantError
        When a channel has no noise, or the line does not run at the end of a tolerance.
    """
    nuisances = tuple(declared_nuisances(pool.twins[0].declaration))
    here = linearised_at(pool, nuisances, Case())
    whitening = declared_whitening(pool, here.point, here.declared_tick)
    return _weighed(pool, tuple(measured), nuisances, here, whitening)


def relinearised_at(
    objective: Objective, case: Case, *, keep_nuisance_changes: bool = False
) -> Objective:
    """Return the objective linearised at ``case``: there, quick runs are corrected exactly.

    Until then they were so at the declared line. At the quick tick what an effect does is some
    percent off; from here on only what it does beyond ``case`` is.
    Responses to declared numbers and start states are taken anew there, or kept; noise is
    simulated anew where an effect of ``case`` is not locked to an angle (a delay, a filter,
    another web): the loops make other noise of it.
    Results of earlier simulations are dropped: a search does not come back to them.
    """
    pool, before = objective.pool, objective.linearisation
    pool.forget()
    here = linearised_at(
        pool,
        objective.nuisances,
        case,
        nuisance_changes=before.nuisance_changes if keep_nuisance_changes else None,
        start_changes=before.start_changes if keep_nuisance_changes else None,
        free_bodies=before.free_bodies,
    )
    whitening = objective.whitening
    if any(not BY_NAME[added.effect].order_locked for added in case.effects):
        fresh = declared_whitening(pool, here.point, here.declared_tick)
        whitening = replace(fresh, basis=whitening.basis)
    return _weighed(pool, objective.measured, objective.nuisances, here, whitening)


def with_free_shapes(objective: Objective, bodies: Sequence[int]) -> Objective:
    """Return the objective with the shapes of ``bodies`` free in every low order.

    What is then found must explain more than a detail of a shape that is there already.
    """
    here = with_free_bodies(objective.pool, objective.linearisation, bodies)
    return _projected(replace(objective, linearisation=here))


def with_wander(
    objective: Objective, changes: Sequence[Changes], sd: Sequence[float] = ()
) -> Objective:
    """Return the objective with these changes in it, each of one size in all channels.

    Without ``sd`` their sizes are free: what is then found must explain more than slow changes of
    what is there already. With it each size is random, of this standard deviation: where wander
    is large the residual counts less than where it is small.
    """
    here = replace(objective.linearisation, wander_changes=tuple(changes), wander_sd=tuple(sd))
    return _projected(replace(objective, linearisation=here))


def conditioned_on(objective: Objective, basis: Sequence[Array]) -> Objective:
    """Return the objective with free terms taken out of every channel first.

    ``basis`` has orthonormal columns (judged samples, terms) per record. What is left is what an
    effect has to explain that these terms, free in size in every channel, cannot.
    """
    whitening = replace(objective.whitening, basis=tuple(basis))
    return _projected(replace(objective, whitening=whitening))


def with_free_numbers(objective: Objective, names: Collection[str]) -> Objective:
    """Return the objective in which the tolerances of these declared numbers do not count.

    What is then found must explain what no value of theirs does.
    """
    nuisances = tuple(
        replace(n, is_free=n.is_free or n.name in names) for n in objective.nuisances
    )
    return _projected(replace(objective, nuisances=nuisances))


def prior_sd(nuisances: Sequence[Nuisance]) -> Array:
    """Return the standard deviation of every nuisance: a tolerance is two of them."""
    free = CRITERIA.fit.free_number
    return np.array([0.5 * n.tolerance * (free if n.is_free else 1.0) for n in nuisances])


def judged_rows(measured: Sequence[Array], whitening: Whitening) -> int:
    """Return the number of judged samples of all channels and records."""
    rows = zip(measured, whitening.noise, strict=True)
    return sum(m.shape[0] * (m.shape[1] - n.first) for m, n in rows)


def _weighed(
    pool: SimulationPool,
    measured: tuple[Array, ...],
    nuisances: tuple[Nuisance, ...],
    linearisation: Linearisation,
    whitening: Whitening,
) -> Objective:
    """Return the objective with declared noise put right by the data there."""
    residuals = [m - y for m, y in zip(measured, linearisation.declared_tick, strict=True)]
    weighed = whitening.adjusted_to(residuals)
    return Objective(
        pool=pool,
        measured=measured,
        nuisances=nuisances,
        linearisation=linearisation,
        whitening=weighed,
        projector=_projector(pool, measured, nuisances, linearisation, weighed),
    )


def _projected(objective: Objective) -> Objective:
    """Return the objective with the projector that belongs to its parts."""
    projector = _projector(
        objective.pool,
        objective.measured,
        objective.nuisances,
        objective.linearisation,
        objective.whitening,
    )
    return replace(objective, projector=projector)


def _projector(
    pool: SimulationPool,
    measured: Sequence[Array],
    nuisances: Sequence[Nuisance],
    linearisation: Linearisation,
    whitening: Whitening,
) -> Projector:
    """Return what takes out nuisances with their priors, zeros, free shapes and start states."""
    sd, rows = prior_sd(nuisances), judged_rows(measured, whitening)
    free = (*linearisation.shape_changes, *linearisation.wander_changes)
    changes = [*linearisation.nuisance_changes, *_zeros(pool, measured), *free]
    nothing = np.empty((rows + len(nuisances), 0))
    columns = _matrix(whitening, changes, len(nuisances)) if changes else nothing
    for at in range(len(nuisances)):
        columns[rows + at, at] = 1.0 / sd[at]
    if linearisation.start_changes:
        starts = _starts(whitening, linearisation.start_changes, rows + len(nuisances))
        columns = np.concatenate([columns.T, starts]).T
    precision = np.zeros(columns.shape[1])
    if linearisation.wander_sd:
        wander_sd, end = np.array(linearisation.wander_sd), len(changes)
        precision[end - wander_sd.size : end] = wander_sd**-2.0
    return Projector(columns, precision)


def _matrix(whitening: Whitening, changes: Sequence[Sequence[Array]], tolerances: int) -> Array:
    """Return per-record changes as columns, whitened, nothing in the rows of tolerances."""
    bundles = [changes[at : at + AT_ONCE] for at in range(0, len(changes), AT_ONCE)]
    parts = [whitening.matrix(some, tolerances).T for some in bundles]
    return np.concatenate(parts).T


def _starts(whitening: Whitening, changes: Sequence[Sequence[Array]], length: int) -> Array:
    """Return directions (k, length) of the start states, each in the rows of one record."""
    found, at = [], 0
    for t in range(len(changes[0])):
        own = whitening.rows(t, [change[t] for change in changes])
        directions = shown_directions(own.T).T
        found.append(np.zeros((directions.shape[0], length)))
        found[-1][:, at : at + own.shape[1]] = directions
        at += own.shape[1]
    return np.concatenate(found)


def _zeros(pool: SimulationPool, measured: Sequence[Array]) -> list[list[Array]]:
    """Return an offset per angle channel: angles count from their first row, which has noise."""
    offsets = []
    for t, twin in enumerate(pool.twins):
        for c, name in enumerate(twin.channels):
            if name.endswith("_angle_rad"):
                ones = [np.zeros_like(m) for m in measured]
                ones[t][c] = 1.0
                offsets.append(ones)
    return offsets
