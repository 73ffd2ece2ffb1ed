"""Load cells whose reading depends on which way the tension went last.

How a zone is stretched is told twice: by its load cells, and by the speeds at its ends. A reading
that follows the other one with a gap, alike at every rate of change, sticks: play or friction in
the cell's mount. A filter or a delay lags by more the faster the tension changes; what a drive
does to the web shows in both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import butter, sosfiltfilt

from sim_plant.base.arrays import Array
from sim_plant.line.arrays.build import cell_sensors
from sim_plant.line.arrays.locations import zones
from sim_plant.line.declared.declaration import Declaration, DriveSpeed
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.model.twin import Twin

STICKING = CRITERIA.search.sticking


@dataclass(frozen=True, slots=True, kw_only=True)
class Sticking:
    """A reading with a gap.

    Attributes
    ----------
    channel : of the load cell. band_N : how far a rising and a falling reading are apart.
    chi2_reduction : by how much the gap lowers chi-square.
    """

    channel: str
    band_N: float
    chi2_reduction: float


def sticking_cells(objective: Objective, fit: Fit) -> list[Sticking]:
    """Return the readings that stick, the one that shows it best first.

    Of the first record in which any does.
    """
    run = objective.pool.one(fit.case)
    rows = zip(
        objective.pool.twins, objective.measured, run, objective.whitening.noise, strict=True
    )
    for twin, measured, simulated, noise in rows:
        found = sticking_in(twin, measured, simulated, noise.first)
        if found:
            return found
    return []


def sticking_in(twin: Twin, measured: Array, simulated: Array, first: int) -> list[Sticking]:
    """Return the readings of one record (channels, samples) that stick; ``first``: judged from."""
    line, names = twin.declaration, list(twin.channels)
    left = measured - simulated
    by_speeds = tensions_by_speeds(twin, left)
    found = []
    for cell in cell_sensors(line):
        zone = zone_at(line, cell.roller)
        if zone in by_speeds and cell.channel in names:
            at = names.index(cell.channel)
            change_N = by_speeds[zone]
            seen = gap_in(left[at], change_N, simulated[at] + change_N, line.sample_time_s, first)
            if seen is not None:
                found.append(
                    Sticking(channel=cell.channel, band_N=seen[0], chi2_reduction=seen[1])
                )
    return sorted(found, key=lambda s: -s.chi2_reduction)


def zone_at(line: Declaration, roller: str) -> str:
    """Return the zone in which a roller is that no drive turns; empty: in none."""
    body = line.body(roller)
    return next((z for z, spans in zones(line).items() if spans[0] < body <= spans[-1]), "")


def tensions_by_speeds(twin: Twin, left: Array) -> dict[str, Array]:
    """Return what the speeds say of each zone's tension beyond the simulated one (samples,), N.

    ``left`` is measured less simulated (channels, samples). A zone whose ends have no speed is
    not there; one behind it takes the tension that comes in as simulated.
    Equation: L dF/dt = EA (v2 - v1) + v (F1 - F), small changes of the law of a span
    [source 2.20], F1 in the zone before.
    """
    line, names = twin.declaration, list(twin.channels)
    step_s, stiffness = line.sample_time_s, line.web.EA_N
    speed_of = {
        s.roller: left[names.index(s.channel)]
        * (line.rollers[line.body(s.roller)].radius_m if s.scale_radius_m is None else 1.0)
        for s in line.sensors
        if isinstance(s, DriveSpeed) and s.channel in names
    }
    found: dict[str, Array] = {}
    before = np.zeros(left.shape[1])
    for zone, spans in zones(line).items():
        ends = [line.rollers[k].name for k in (spans[0], spans[-1] + 1)]
        if not all(name in speed_of for name in ends):
            continue
        length_m = sum(line.spans[k].length_m for k in spans)
        stretch = stiffness * (speed_of[ends[1]] - speed_of[ends[0]])
        carried = np.abs(twin.speed_m_s)
        tension = np.zeros(left.shape[1])
        for k in range(1, tension.size):
            last = tension[k - 1]
            rate = stretch[k - 1] + carried[k - 1] * (before[k - 1] - last)
            tension[k] = last + step_s * rate / length_m
        found[zone] = before = tension
    return found


def gap_in(
    reading_N: Array, change_N: Array, tension_N: Array, step_s: float, first: int
) -> tuple[float, float] | None:
    """Return the width of the gap with which a reading follows, N, and its chi-square, or None.

    ``reading_N`` and ``change_N`` are beyond the simulated tension, by cell and by speeds;
    ``tension_N`` is all of it by speeds (samples,) each. A gap counts beside a scale and a lag,
    where its own size comes out as that of a gap.
    Equation: reading - change = a change + b dchange/dt + c (play(tension) - tension), c near 1
    [own].
    """
    nyquist_Hz = 0.5 / step_s
    low_Hz, high_Hz = STICKING.band_Hz
    high_Hz = min(high_Hz, 0.5 * nyquist_Hz)
    if tension_N.size - first < round(STICKING.fewest_s / step_s):
        return None
    band = butter(2, (low_Hz, high_Hz), btype="band", fs=1.0 / step_s, output="sos")

    def seen(values: Array) -> Array:
        passed: Array = sosfiltfilt(band, values)[first:]
        return passed

    slow = [seen(change_N), seen(np.gradient(change_N, step_s))]
    left = seen(reading_N - change_N)
    _, without = _least(left, slow)
    halves_N = np.array(STICKING.halves_N)
    gaps = play(tension_N, halves_N) - tension_N
    fits = [_least(left, [*slow, seen(gap)]) for gap in gaps]
    at = min(range(len(fits)), key=lambda k: fits[k][1])
    (share, rest), band_N = fits[at], float(2.0 * halves_N[at])
    if rest <= 0.0:
        return None
    independent = left.size * (high_Hz - low_Hz) / nyquist_Hz
    chi2 = independent * (without / rest - 1.0)
    sure = chi2 > CRITERIA.search.acceptance.score and rest < STICKING.left_share * without
    return (band_N, chi2) if sure and abs(share - 1.0) < STICKING.off_share else None


def play(values: Array, halves: Array) -> Array:
    """Return what follows ``values`` (samples,) with gaps of these halves (k,) to either side."""
    followed = np.empty((values.size, halves.size))
    at = np.full(halves.size, values[0])
    for k, value in enumerate(values):
        at = followed[k] = np.minimum(np.maximum(at, value - halves), value + halves)
    rows: Array = followed.T
    return rows


def _least(values: Array, columns: Sequence[Array]) -> tuple[float, float]:
    """Return the share of the last column that fits best, and the mean square that is left."""
    matrix = np.stack(columns, axis=1)
    shares = np.linalg.lstsq(matrix, values, rcond=None)[0]
    return float(shares[-1]), float(np.mean((values - matrix @ shares) ** 2))
