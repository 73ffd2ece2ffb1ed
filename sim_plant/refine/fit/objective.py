"""Records, twins, noise and tolerances as one weighted least-squares objective.

The objective is a value: what is simulated and weighed otherwise is another objective
(`relinearised_at`, `with_free_shapes`, `conditioned_on`). Results of simulations are kept by the
pool, never here.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.linearisation import Linearisation, linearised_at, with_free_bodies
from sim_plant.refine.fit.projection import Projector
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
    linearisation : where responses were taken, and they.
    whitening : how the channels are weighed.
    projector : takes out what tolerances, free zeros and free shapes explain.
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
        """Cost that a true model would leave: rows, channels of coarse words counted less."""
        total = 0.0
        for noise, measured in zip(self.whitening.noise, self.measured, strict=True):
            share = np.minimum(1.0, (noise.floor / noise.sd) ** 2)
            coarse = np.array([taps.size == 1 for taps in noise.filters])
            total += float(np.where(coarse, share, 1.0).sum()) * (measured.shape[1] - noise.first)
        taken = [0 if q is None else q.shape[1] for q in self.whitening.basis]
        total -= 2.0 * CRITERIA.fit.free_orders * len(self.linearisation.free_bodies)
        terms = sum(m.shape[0] * k for m, k in zip(self.measured, taken, strict=True))
        return total - float(terms)

    @property
    def cost_standard_deviation(self) -> float:
        """Standard deviation of the cost of a true model, that of chi-square."""
        return math.sqrt(2.0 * self.expected_cost)

    def residual(
        self, run: Sequence[Array], shifts: dict[str, float] | None = None, coarse: bool = True
    ) -> Array:
        """Return the residual vector of a run made with these nuisance shifts.

        To a coarse run the difference fine - coarse at the anchor is added.
        """
        here = self.linearisation
        gone = [
            m - (y + f - c) if coarse else m - y
            for m, y, f, c in zip(self.measured, run, here.fine, here.coarse, strict=True)
        ]
        put = np.array([(shifts or {}).get(n.name, 0.0) for n in self.nuisances])
        return np.concatenate([self.whitening.vector(gone), -put / self.prior_sd])

    def column(self, run: Sequence[Array], base: Sequence[Array], increment: float) -> Array:
        """Return the whitened derivative between two coarse runs, zero in rows of tolerances."""
        change = [(y - b) / increment for y, b in zip(run, base, strict=True)]
        return _column(self.whitening, change, len(self.nuisances))

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
    whitening = declared_whitening(pool, here.anchor, here.fine)
    return _weighed(pool, tuple(measured), nuisances, here, whitening)


def relinearised_at(
    objective: Objective, case: Case, *, keep_nuisance_changes: bool = False
) -> Objective:
    """Return the objective with coarse runs put right at ``case``, not at the declaration.

    A coarse tick is some percent off in what an effect does; from here on only changes are.
    Responses to declared numbers are taken anew there unless those there are kept, and the noise
    as well where a delay, a filter or another web is there: the loops make other noise of it.
    Results of earlier simulations are dropped: a search does not come back to them.
    """
    pool, before = objective.pool, objective.linearisation
    pool.forget()
    here = linearised_at(
        pool,
        objective.nuisances,
        case,
        nuisance_changes=before.nuisance_changes if keep_nuisance_changes else None,
        free_bodies=before.free_bodies,
    )
    whitening = objective.whitening
    if any(not BY_NAME[added.effect].order_locked for added in case.effects):
        fresh = declared_whitening(pool, here.anchor, here.fine)
        whitening = replace(fresh, basis=whitening.basis)
    return _weighed(pool, objective.measured, objective.nuisances, here, whitening)


def with_free_shapes(objective: Objective, bodies: Sequence[int]) -> Objective:
    """Return the objective with the shapes of ``bodies`` free in every low order.

    What is then found must explain more than a detail of a shape that is there already.
    """
    here = with_free_bodies(objective.pool, objective.linearisation, bodies)
    return _projected(replace(objective, linearisation=here))


def conditioned_on(objective: Objective, basis: Sequence[Array]) -> Objective:
    """Return the objective with free terms taken out of every channel first.

    ``basis`` has orthonormal columns (judged samples, terms) per record. What is left is what an
    effect has to explain that these terms, free in size in every channel, cannot.
    """
    whitening = replace(objective.whitening, basis=tuple(basis))
    return _projected(replace(objective, whitening=whitening))


def prior_sd(nuisances: Sequence[Nuisance]) -> Array:
    """Return the standard deviation of every nuisance: a tolerance is two of them."""
    return np.array([0.5 * n.tolerance for n in nuisances])


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
    """Return the objective with the declared noise put right by the data at the anchor."""
    residuals = [m - y for m, y in zip(measured, linearisation.fine, strict=True)]
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
    """Return what takes out nuisances with their priors, zeros of angles and free shapes."""
    sd, rows = prior_sd(nuisances), judged_rows(measured, whitening)
    columns = []
    for at, change in enumerate(linearisation.nuisance_changes):
        column = _column(whitening, change, len(nuisances))
        column[rows + at] = 1.0 / sd[at]
        columns.append(column)
    zeros = [_column(whitening, change, len(nuisances)) for change in _zeros(pool, measured)]
    shapes = [_column(whitening, c, len(nuisances)) for c in linearisation.shape_changes]
    return Projector(np.stack([*columns, *zeros, *shapes], axis=1))


def _column(whitening: Whitening, change: Sequence[Array], tolerances: int) -> Array:
    """Return a per-record change as a column, whitened, nothing in the rows of tolerances."""
    return np.concatenate([whitening.vector(change), np.zeros(tolerances)])


def _zeros(pool: SimulationPool, measured: Sequence[Array]) -> list[list[Array]]:
    """Return free offsets of angle channels: their zero is the first row, with its noise."""
    found = []
    for t, twin in enumerate(pool.twins):
        for c, name in enumerate(twin.channels):
            if name.endswith("_angle_rad"):
                ones = [np.zeros_like(m) for m in measured]
                ones[t][c] = 1.0
                found.append(ones)
    return found
