"""Records, twins, noise and tolerances as one weighted least-squares problem."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import replace

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.fit.projection import Projector
from sim_plant.refine.model.nuisances import Nuisance, declared_nuisances
from sim_plant.refine.model.simulation_pool import SimulationPool
from sim_plant.refine.model.twin import Case
from sim_plant.refine.noise.innovations import declared_noise

NOISE_RUNS = 12
NOMINAL = Case()
LOOSE_ORDERS = 12
LOOSE_M = 2e-5


class Objective:
    """Whitened residuals of all records against the twins, in one vector.

    The vector ends in one row per declared tolerance: what a shift of that number costs.
    """

    def __init__(self, pool: SimulationPool, measured: Sequence[Array]) -> None:
        self.pool = pool
        self.measured = list(measured)
        self.nuisances: list[Nuisance] = declared_nuisances(pool.twins[0].declaration)
        self.anchor = NOMINAL
        self.loose: tuple[int, ...] = ()
        self.changes: list[list[Array]] = []
        self.coarse, self.fine = pool.run([NOMINAL, replace(NOMINAL, coarse=False)])
        self.simulate_noise()
        self.basis: list[Array | None] = [None] * len(self.measured)
        self.rows = sum(
            m.shape[0] * (m.shape[1] - n.first)
            for m, n in zip(self.measured, self.noise, strict=True)
        )
        self.weigh()

    def simulate_noise(self) -> None:
        """Take the noise that the declaration makes of the line at the anchor."""
        cases = [replace(self.anchor, coarse=False, seed=seed) for seed in range(NOISE_RUNS)]
        runs = self.pool.run(cases, keep=False)
        noisy = [np.stack([run[t] for run in runs]) for t in range(len(self.pool.twins))]
        self.noisy = [noise - fine[None] for noise, fine in zip(noisy, self.fine, strict=True)]
        rows = zip(self.pool.twins, self.noisy, strict=True)
        self.quiet = [declared_noise(twin, noise) for twin, noise in rows]
        self.noise = self.quiet

    def weigh(self) -> None:
        """Take the declared noise, its level and colour put right by the data at the anchor."""
        rows = zip(self.quiet, self.measured, self.fine, strict=True)
        self.noise = [n.adjusted_to(m - y) for n, m, y in rows]
        self.project()

    def project(self) -> None:
        """Take the responses to declared numbers, and to what is loose, at the anchor."""
        self.projector = Projector(self._nuisance_columns())

    @property
    def sd(self) -> Array:
        """Prior standard deviation of every nuisance shift."""
        return np.array([0.5 * n.tolerance for n in self.nuisances])

    def whiten(self, values: Sequence[Array]) -> Array:
        """Return one vector of innovations of per-record channels (channels, samples)."""
        rows = zip(self.noise, values, self.basis, strict=True)
        return np.concatenate([_without(n.whiten(v), basis).ravel() for n, v, basis in rows])

    def residual(
        self, run: Sequence[Array], shifts: dict[str, float] | None = None, coarse: bool = True
    ) -> Array:
        """Return the residual vector of a run made with these nuisance shifts.

        To a coarse run the difference fine - coarse at the anchor is added.
        """
        gone = [
            m - (y + f - c) if coarse else m - y
            for m, y, f, c in zip(self.measured, run, self.fine, self.coarse, strict=True)
        ]
        put = np.array([(shifts or {}).get(n.name, 0.0) for n in self.nuisances])
        return np.concatenate([self.whiten(gone), -put / self.sd])

    def column(self, run: Sequence[Array], base: Sequence[Array], step: float) -> Array:
        """Return the whitened derivative between two coarse runs."""
        change = [(y - b) / step for y, b in zip(run, base, strict=True)]
        return self._whole(change)

    def _whole(self, change: Sequence[Array]) -> Array:
        """Return a per-record change as a column, whitened, nothing in the rows of tolerances."""
        return np.concatenate([self.whiten(change), np.zeros(len(self.nuisances))])

    def _nuisance_columns(self) -> Array:
        columns = []
        for at, change in enumerate(self.changes or self._take_changes()):
            column = self._whole(change)
            column[self.rows + at] = 1.0 / self.sd[at]
            columns.append(column)
        return np.stack([*columns, *self._zero_columns(), *self._loose_columns()], axis=1)

    def _take_changes(self) -> list[list[Array]]:
        """Simulate and keep what a unit of every declared number changes, per record.

        Raises
        ------
        PlantError
            When the line does not run at the end of a tolerance.
        """
        put = dict(self.anchor.shifts)
        cases = [
            replace(
                self.anchor,
                shifts=tuple(sorted({**put, n.name: put.get(n.name, 0.0) + n.tolerance}.items())),
            )
            for n in self.nuisances
        ]
        runs = self.pool.run(cases)
        for n, run in zip(self.nuisances, runs, strict=True):
            if not all(np.isfinite(y).all() for y in run):
                raise PlantError(
                    f"tolerances: {n.name} may be {n.tolerance:g} off, and there the line does "
                    "not run; a tolerance is two standard deviations, mostly a share of the "
                    f"number (0.02 is 2 %): give {n.name} a smaller one"
                )
        self.changes = [
            [(y - b) / n.tolerance for y, b in zip(run, self.coarse, strict=True)]
            for n, run in zip(self.nuisances, runs, strict=True)
        ]
        return self.changes

    def _loose_columns(self) -> list[Array]:
        """Return what one typical ripple of each order of each loose shape does, cos and sin."""
        cases = [
            replace(self.anchor, ripples=((body, n, LOOSE_M * c / n, LOOSE_M * s / n),))
            for body in self.loose
            for n in range(1, LOOSE_ORDERS + 1)
            for c, s in ((1.0, 0.0), (0.0, 1.0))
        ]
        return [self.column(run, self.coarse, 1.0) for run in self.pool.run(cases)]

    def _zero_columns(self) -> list[Array]:
        """Return free offsets of angle channels: their zero is the first row, with its noise."""
        columns = []
        for t, twin in enumerate(self.pool.twins):
            for c, name in enumerate(twin.channels):
                if name.endswith("_angle_rad"):
                    ones = [np.zeros_like(m) for m in self.measured]
                    ones[t][c] = 1.0
                    columns.append(np.concatenate([self.whiten(ones), np.zeros(self.sd.size)]))
        return columns

    def relinearised_at(self, case: Case, *, weak: bool = False) -> Objective:
        """Return the same problem with coarse runs put right at ``case``, not at the declaration.

        A coarse tick is some percent off in what an effect does; from here on only changes are.
        Responses to declared numbers are taken anew there, unless what is on the line is too
        ``weak`` to change them.
        """
        near = copy(self)
        if not weak:
            near.changes = []
        self.pool.forget()
        near.anchor = replace(case, coarse=True)
        near.coarse, near.fine = self.pool.run([near.anchor, replace(case, coarse=False)])
        if any(not BY_NAME[added.effect].order_locked for added in case.effects):
            near.simulate_noise()  # a delay, a filter, another web: the loops make other noise
        near.weigh()
        return near

    def with_free_shapes(self, bodies: Sequence[int]) -> Objective:
        """Return the same problem with the shapes of ``bodies`` free in every low order.

        What is then found must explain more than a detail of a shape that is there already.
        """
        near = copy(self)
        near.loose = tuple(sorted(set(bodies)))
        near.project()
        return near

    def beside(self, basis: Sequence[Array]) -> Objective:
        """Return the same problem with free terms taken out of every channel first.

        ``basis`` has orthonormal columns (judged samples, terms) per record. What is left is what
        an effect has to explain that these terms, free in size in every channel, cannot.
        """
        near = copy(self)
        near.basis = list(basis)
        near.project()
        return near

    @property
    def expected_cost(self) -> float:
        """Cost that a true model would leave: rows, channels of coarse words counted less."""
        total = 0.0
        for noise, measured in zip(self.noise, self.measured, strict=True):
            share = np.minimum(1.0, (noise.floor / noise.sd) ** 2)
            coarse = np.array([taps.size == 1 for taps in noise.filters])
            total += float(np.where(coarse, share, 1.0).sum()) * (measured.shape[1] - noise.first)
        taken = [0 if q is None else q.shape[1] for q in self.basis]
        total -= 2.0 * LOOSE_ORDERS * len(self.loose)
        terms = sum(m.shape[0] * k for m, k in zip(self.measured, taken, strict=True))
        return total - float(terms)

    def split(self, vector: Array) -> list[Array]:
        """Return the per-record innovations (channels, judged samples) of a residual vector."""
        parts, at = [], 0
        for noise, measured in zip(self.noise, self.measured, strict=True):
            shape = (measured.shape[0], measured.shape[1] - noise.first)
            parts.append(vector[at : at + shape[0] * shape[1]].reshape(shape))
            at += shape[0] * shape[1]
        return parts


def _without(white: Array, basis: Array | None) -> Array:
    """Return channels (channels, samples) less their part along ``basis`` (samples, terms)."""
    if basis is None:
        return white
    rest: Array = white - (white @ basis) @ basis.T
    return rest
