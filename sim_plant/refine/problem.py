"""Records, twins, noise and tolerances as one weighted least-squares problem."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.bench import Bench
from sim_plant.refine.linear import Projector
from sim_plant.refine.noise import NoiseModel, first_judged, measured_scale, noise_model
from sim_plant.refine.nuisances import Nuisance, declared_nuisances
from sim_plant.refine.twin import Case, Twin

NOISE_RUNS = 2
NOMINAL = Case()


class Problem:
    """Whitened residuals of all records against the twins, in one vector.

    The vector ends in one row per declared tolerance: what a shift of that number costs.
    """

    def __init__(self, bench: Bench, measured: Sequence[Array]) -> None:
        self.bench = bench
        self.measured = list(measured)
        self.nuisances: list[Nuisance] = declared_nuisances(bench.twins[0].declaration)
        cases = [Case(coarse=False, seed=s) for s in (None, *range(NOISE_RUNS))]
        runs = bench.run([NOMINAL, *cases])
        self.coarse, self.fine = runs[0], runs[1]
        noisy = [np.stack([run[t] for run in runs[2:]]) for t in range(len(bench.twins))]
        self.noise = [
            self._noise(twin, noise - fine[None], record - fine)
            for twin, noise, fine, record in zip(
                bench.twins, noisy, self.fine, self.measured, strict=True
            )
        ]
        self.rows = sum(
            m.shape[0] * (m.shape[1] - n.first)
            for m, n in zip(self.measured, self.noise, strict=True)
        )
        self.projector = Projector(self._nuisance_columns())

    @staticmethod
    def _noise(twin: Twin, runs: Array, residual: Array) -> NoiseModel:
        line = twin.declaration
        steps = {s.channel: s.lsb_m or 0.0 for s in line.sensors}
        first = first_judged(residual.shape[1], line.sample_time_s)
        model = noise_model(runs, first, np.array([steps[c] for c in twin.channels]))
        return model.scaled(measured_scale(model.whiten(residual)))

    @property
    def sd(self) -> Array:
        """Prior standard deviation of every nuisance shift."""
        return np.array([0.5 * n.tolerance for n in self.nuisances])

    def whiten(self, values: Sequence[Array]) -> Array:
        """Return one vector of innovations of per-record channels (channels, samples)."""
        parts = [n.whiten(v).ravel() for n, v in zip(self.noise, values, strict=True)]
        return np.concatenate(parts)

    def residual(
        self, run: Sequence[Array], shifts: dict[str, float] | None = None, coarse: bool = True
    ) -> Array:
        """Return the residual vector of a run made with these nuisance shifts.

        To a coarse run the difference of the two nominal runs is added.
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
        return np.concatenate([self.whiten(change), np.zeros(len(self.nuisances))])

    def _nuisance_columns(self) -> Array:
        cases = [replace(NOMINAL, shifts=((n.name, n.tolerance),)) for n in self.nuisances]
        runs = self.bench.run(cases)
        columns = []
        for at, (row, run) in enumerate(zip(self.nuisances, runs, strict=True)):
            column = self.column(run, self.coarse, row.tolerance)
            column[self.rows + at] = 1.0 / self.sd[at]
            columns.append(column)
        return np.stack([*columns, *self._zero_columns()], axis=1)

    def _zero_columns(self) -> list[Array]:
        """Return free offsets of angle channels: their zero is the first row, with its noise."""
        columns = []
        for t, twin in enumerate(self.bench.twins):
            for c, name in enumerate(twin.channels):
                if name.endswith("_angle_rad"):
                    ones = [np.zeros_like(m) for m in self.measured]
                    ones[t][c] = 1.0
                    columns.append(np.concatenate([self.whiten(ones), np.zeros(self.sd.size)]))
        return columns

    @property
    def expected_cost(self) -> float:
        """Cost that a true model would leave: rows, channels of coarse words counted less."""
        total = 0.0
        for noise, measured in zip(self.noise, self.measured, strict=True):
            share = np.minimum(1.0, (noise.floor / noise.sd) ** 2)
            coarse = np.array([taps.size == 1 for taps in noise.filters])
            total += float(np.where(coarse, share, 1.0).sum()) * (measured.shape[1] - noise.first)
        return total

    def split(self, vector: Array) -> list[Array]:
        """Return the per-record innovations (channels, judged samples) of a residual vector."""
        parts, at = [], 0
        for noise, measured in zip(self.noise, self.measured, strict=True):
            shape = (measured.shape[0], measured.shape[1] - noise.first)
            parts.append(vector[at : at + shape[0] * shape[1]].reshape(shape))
            at += shape[0] * shape[1]
        return parts
