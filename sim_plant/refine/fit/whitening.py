"""How the channels of every record are weighed: prediction-error filters and free terms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.model.simulation_pool import SimulationPool
from sim_plant.refine.model.twin import Case
from sim_plant.refine.noise.innovations import NoiseModel, declared_noise


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Whitening:
    """Filters that make white what a true model would leave, one entry per record.

    Attributes
    ----------
    realisations : noise alone, as the declaration makes it (runs, channels, samples).
    declared : filters and innovation sd of that noise.
    noise : the same, level and colour put right by the data; these weigh residuals.
    basis : orthonormal free terms (judged samples, terms) taken out of every channel; or None.
    """

    realisations: tuple[Array, ...]
    declared: tuple[NoiseModel, ...]
    noise: tuple[NoiseModel, ...]
    basis: tuple[Array | None, ...]

    def adjusted_to(self, residuals: Sequence[Array]) -> Whitening:
        """Return the whitening with the declared noise put right by per-record residuals."""
        rows = zip(self.declared, residuals, strict=True)
        return replace(self, noise=tuple(n.adjusted_to(r) for n, r in rows))

    def vector(self, values: Sequence[Array]) -> Array:
        """Return one vector of innovations of per-record channels (channels, samples)."""
        found: Array = self.matrix([values])[:, 0]
        return found

    def matrix(self, changes: Sequence[Sequence[Array]], tolerances: int = 0) -> Array:
        """Return innovations of several changes, each per record, as columns (rows, changes).

        0 in ``tolerances`` rows at the end. Every column is contiguous in memory.
        """
        parts = [self.rows(t, [change[t] for change in changes]) for t in range(len(self.noise))]
        parts.append(np.zeros((len(changes), tolerances)))
        return np.concatenate(parts, axis=1).T

    def rows(self, record: int, changes: Sequence[Array]) -> Array:
        """Return innovations of changes of one record (channels, samples), a row each."""
        white = np.stack([self.noise[record].whiten(change) for change in changes])
        rows: Array = _without(white, self.basis[record]).reshape(len(changes), -1)
        return rows


def declared_whitening(pool: SimulationPool, point: Case, quiet: Sequence[Array]) -> Whitening:
    """Simulate the noise that the declaration makes of the line at ``point``.

    ``quiet`` is the run without noise there, at the declared drive tick, per record.

    Raises
    ------
    PlantError
        When a channel has no noise at all.
    """
    cases = [replace(point, quick=False, seed=seed) for seed in range(CRITERIA.fit.noise_runs)]
    runs = pool.run(cases, keep=False)
    noisy = [np.stack([run[t] for run in runs]) for t in range(len(pool.twins))]
    realisations = tuple(noise - y[None] for noise, y in zip(noisy, quiet, strict=True))
    declared = tuple(
        declared_noise(twin, noise) for twin, noise in zip(pool.twins, realisations, strict=True)
    )
    return Whitening(
        realisations=realisations, declared=declared, noise=declared, basis=(None,) * len(declared)
    )


def _without(white: Array, basis: Array | None) -> Array:
    """Return rows (..., samples) less their part along ``basis`` (samples, terms)."""
    if basis is None:
        return white
    rows = white.reshape(-1, white.shape[-1])
    rest: Array = (rows - (rows @ basis) @ basis.T).reshape(white.shape)
    return rest
