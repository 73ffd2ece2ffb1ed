"""Where a periodic effect shows as a spectral line: in time, web travel, or a roll's angle."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.base.signatures import Frequency, Orders
from sim_plant.line.declared.declaration import Declaration
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.model.twin import Case, Twin
from sim_plant.refine.spectra.spectral_lines import SpectralLines, spectral_lines, speed_weights

TWO_PI = 2.0 * math.pi
"""One turn, rad."""
SPECTRA = CRITERIA.spectra


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RecordAxes:
    """Time, web travel and the angles of all bodies over the judged samples of one record."""

    declaration: Declaration
    sample_time_s: float
    time_s: Array
    travel_m: Array
    angles_rad: Array  # (bodies, samples)
    speed_m_s: Array


def axes_of(twin: Twin, measured: Array, case: Case, first: int) -> RecordAxes:
    """Return the axes of a record: measured angles where there are, else simulated."""
    _, angles = twin.angles(case)
    for sensor in twin.declaration.sensors:
        if sensor.channel in twin.channels and sensor.channel.endswith("_angle_rad"):
            body = twin.declaration.body(sensor.roller)
            angles[body] = measured[twin.channels.index(sensor.channel)]
    step = twin.declaration.sample_time_s
    ends = {0, len(twin.declaration.rollers) - 1}
    fixed = [
        (k, r.radius_m)
        for k, r in enumerate(twin.declaration.rollers)
        if k not in ends and r.kind == "driven"
    ]
    # travel is that of the first driven roller of fixed radius, else of the second roller
    time_s: Array = np.arange(first, measured.shape[1], dtype=np.float64) * step
    body, radius = fixed[0] if fixed else (1, twin.declaration.rollers[1].radius_m)
    return RecordAxes(
        declaration=twin.declaration,
        sample_time_s=step,
        time_s=time_s,
        travel_m=angles[body, first:] * radius,
        angles_rad=angles[:, first:],
        speed_m_s=twin.speed_m_s[first:],
    )


def spectra(axes: RecordAxes, whitened: Array) -> list[SpectralLines]:
    """Return spectra of free lines in time, in travel and in the angles of unwind and rewind roll.

    In time they go up to half the sample rate less ``fewest_cycles`` per record: mains of 49.7 Hz
    in records of 10 ms are there. The others go nearly as far, by the fastest speed: slots and
    teeth have orders in the tens. At an angle they go to ``highest_order`` at least.
    """
    weights = speed_weights(axes.speed_m_s)
    bodies = (0, len(axes.declaration.rollers) - 1)
    found = [
        _in_time(axes, whitened, weights),
        _in_travel(axes, whitened, weights),
        *(_in_angle(axes, body, whitened, weights) for body in bodies),
    ]
    return [spectrum for spectrum in found if spectrum is not None]


def _in_time(axes: RecordAxes, whitened: Array, weights: Array) -> SpectralLines:
    slow = SPECTRA.fewest_cycles / (axes.time_s[-1] - axes.time_s[0])
    return spectral_lines(
        whitened, axes.time_s, weights, axis="time", highest=_nyquist_Hz(axes) - slow, lowest=slow
    )


def _in_travel(axes: RecordAxes, whitened: Array, weights: Array) -> SpectralLines | None:
    """Return the spectrum in web travel; None for a record that is too short for one."""
    length_m = float(axes.travel_m[-1] - axes.travel_m[0])
    if length_m <= SPECTRA.least_travel_m:
        return None
    fastest_m_s = float(np.max(np.abs(axes.speed_m_s)))
    return spectral_lines(
        whitened,
        axes.travel_m,
        weights,
        axis="travel",
        highest=SPECTRA.nyquist_share * _nyquist_Hz(axes) / fastest_m_s,
        lowest=SPECTRA.fewest_cycles / length_m,
    )


def _in_angle(
    axes: RecordAxes, body: int, whitened: Array, weights: Array
) -> SpectralLines | None:
    """Return the spectrum in the angle of a body; None where that makes too few turns."""
    turns = axes.angles_rad[body] / TWO_PI
    if turns[-1] - turns[0] <= SPECTRA.fewest_turns:
        return None
    return spectral_lines(
        whitened,
        turns,
        weights,
        axis="angle",
        roll=axes.declaration.rollers[body].name,
        highest=highest_order(turns, axes),
        lowest=SPECTRA.fewest_cycles / (turns[-1] - turns[0]),
    )


def _nyquist_Hz(axes: RecordAxes) -> float:
    return 0.5 / axes.sample_time_s


def highest_order(turns: Array, axes: RecordAxes) -> float:
    """Return the highest order looked for over turns (samples,).

    It is ``nyquist_share`` of half the sample rate at the fastest turn, or ``highest_order`` where
    that is more: what is folded there is not so at slower turns.
    """
    highest_Hz = SPECTRA.nyquist_share * _nyquist_Hz(axes)
    return max(SPECTRA.highest_order, highest_Hz / float(np.max(rates_Hz(turns, axes))))


def rates_Hz(turns: Array, axes: RecordAxes) -> Array:
    """Return rates of turns (samples,), 1/s, each over a second: words of an angle have steps."""
    reach = min(max(1, round(1.0 / axes.sample_time_s)), turns.size - 1)
    rates: Array = np.abs(turns[reach:] - turns[:-reach]) / (reach * axes.sample_time_s)
    return rates


def near(
    spectrum: SpectralLines, frequency: float, width: float = SPECTRA.same_coordinate_share
) -> float:
    """Return the largest chi-square reduction within ``width``, a share of the frequency.

    Two bins to either side at least.
    """
    bin_width = float(spectrum.frequency[1] - spectrum.frequency[0])
    reach = max(2.0 * bin_width, width * frequency)
    inside = np.abs(spectrum.frequency - frequency) <= reach
    return float(spectrum.chi2_reduction[inside].max()) if inside.any() else 0.0


def alias_Hz(frequency_Hz: float, sample_time_s: float) -> float:
    """Return where a frequency appears after sampling, 0..half the sample rate."""
    rate = 1.0 / sample_time_s
    folded = math.fmod(frequency_Hz, rate)
    return min(folded, rate - folded)


def orders_of(h: Hypothesis, radius_m: float) -> list[float]:
    """Return the orders at which a hypothesis shows on its roller of this radius; empty: none."""
    shows = h.effect.shows
    return list(shows.at(h.at_start, radius_m)) if isinstance(shows, Orders) else []


def is_periodic(h: Hypothesis) -> bool:
    """Return whether a hypothesis shows as spectral lines, on whatever axis."""
    return isinstance(h.effect.shows, Orders | Frequency)


def rolls_along(h: Hypothesis) -> bool:
    """Return whether a hypothesis shows once per turn of what rolls on the body at its place."""
    return isinstance(h.effect.shows, Orders) and bool(h.effect.shows.rolls_on)


def shown_Hz(h: Hypothesis, axes: RecordAxes) -> float | None:
    """Return where in time a hypothesis shows after sampling, Hz; None where it does not."""
    shows = h.effect.shows
    if not isinstance(shows, Frequency):
        return None
    return alias_Hz(shows.at(h.at_start), axes.sample_time_s)


def wavenumbers_1_m(h: Hypothesis, axes: RecordAxes) -> list[float]:
    """Return where in web travel the orders of a hypothesis at a roller show, 1/m."""
    radius_m = radius_at(h, axes)
    return [n / (TWO_PI * radius_m) for n in orders_of(h, radius_m)]


def radius_at(h: Hypothesis, axes: RecordAxes) -> float:
    """Return the declared radius of the body at the hypothesis' location, m."""
    return axes.declaration.rollers[axes.declaration.body(h.location)].radius_m


def line_at_body(
    h: Hypothesis, axes: RecordAxes, found: Sequence[SpectralLines]
) -> tuple[float, float] | None:
    """Return order of the strongest line over the turns of the hypothesis' body, and bin width."""
    seen = _over_turns(h, axes, found) if h.location != "all" else None
    if seen is None:
        return None
    spectrum, orders = seen
    bin_width = float(spectrum.frequency[1] - spectrum.frequency[0])
    return spectrum.peak[0] * orders, bin_width * orders


def _over_turns(
    h: Hypothesis, axes: RecordAxes, found: Sequence[SpectralLines]
) -> tuple[SpectralLines, float] | None:
    """Return the spectrum in which orders of a body show, and orders per unit of its axis.

    That of the body's own angle where there is one, else the travel's.
    """
    by_axis = {(s.axis, s.roll): s for s in found}
    own = by_axis.get(("angle", h.location))
    if own is not None:
        return own, 1.0
    shared = by_axis.get(("travel", ""))
    return None if shared is None else (shared, TWO_PI * radius_at(h, axes))


def periodic_chi2_reduction(
    h: Hypothesis, axes: RecordAxes, found: Sequence[SpectralLines]
) -> float | None:
    """Return the chi-square reduction of a free line where a hypothesis shows; None: no line."""
    if not is_periodic(h):
        return None
    frequency_Hz = shown_Hz(h, axes)
    if frequency_Hz is not None:
        in_time = next(s for s in found if s.axis == "time")
        return near(in_time, frequency_Hz, SPECTRA.same_frequency_share)
    if h.location == "all":
        return max((s.peak[1] for s in found if s.axis == "travel"), default=0.0)
    seen = _over_turns(h, axes, found)
    if seen is None:
        return 0.0
    spectrum, orders = seen
    return max(near(spectrum, n / orders) for n in orders_of(h, radius_at(h, axes)))
