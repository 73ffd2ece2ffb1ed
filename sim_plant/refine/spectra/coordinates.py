"""Where a periodic effect shows as a spectral line: in time, web travel, or a roll's angle."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.base.signatures import Frequency, Orders
from sim_plant.line.declaration import Declaration
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.model.twin import Case, Twin
from sim_plant.refine.spectra.spectral_lines import SpectralLines, spectral_lines, speed_weights

TWO_PI = 2.0 * math.pi
SPECTRA = CRITERIA.spectra


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Travel:
    """Time, web travel and the angles of all bodies over the judged samples of one record."""

    declaration: Declaration
    sample_time_s: float
    time_s: Array
    travel_m: Array
    angles_rad: Array  # (bodies, samples)
    speed_m_s: Array


def travel_of(twin: Twin, measured: Array, case: Case, first: int) -> Travel:
    """Return the coordinates of a record: measured angles where there are, else simulated."""
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
    return Travel(
        declaration=twin.declaration,
        sample_time_s=step,
        time_s=time_s,
        travel_m=angles[body, first:] * radius,
        angles_rad=angles[:, first:],
        speed_m_s=twin.speed_m_s[first:],
    )


def spectra(travel: Travel, whitened: Array) -> list[SpectralLines]:
    """Return spectra of free lines in time, in travel and in the angles of unwind and rewind roll.

    In time they go up to half the sample rate less ``fewest_cycles`` per record: mains of 49.7 Hz
    in records of 10 ms are there. The others go nearly as far, by the fastest speed: slots and
    teeth have orders in the tens. None has more bins than that in time.
    """
    weights = speed_weights(travel.speed_m_s)
    nyquist = 0.5 / travel.sample_time_s
    slow = SPECTRA.fewest_cycles / (travel.time_s[-1] - travel.time_s[0])
    fastest = float(np.max(np.abs(travel.speed_m_s)))
    length = float(travel.travel_m[-1] - travel.travel_m[0])
    found = [
        spectral_lines(
            whitened, travel.time_s, weights, kind="time", highest=nyquist - slow, lowest=slow
        )
    ]
    if length > SPECTRA.least_travel_m:
        found.append(
            spectral_lines(
                whitened,
                travel.travel_m,
                weights,
                kind="travel",
                highest=SPECTRA.nyquist_share * nyquist / fastest,
                lowest=SPECTRA.fewest_cycles / length,
            )
        )
    for body in (0, len(travel.declaration.rollers) - 1):
        turns = travel.angles_rad[body] / TWO_PI
        if turns[-1] - turns[0] > SPECTRA.fewest_turns:
            found.append(
                spectral_lines(
                    whitened,
                    turns,
                    weights,
                    kind="angle",
                    roll=travel.declaration.rollers[body].name,
                    highest=SPECTRA.nyquist_share
                    * nyquist
                    / float(np.max(rates_Hz(turns, travel))),
                    lowest=SPECTRA.fewest_cycles / (turns[-1] - turns[0]),
                )
            )
    return found


def rates_Hz(turns: Array, travel: Travel) -> Array:
    """Return rates of turns (samples,), 1/s, each over a second: words of an angle have steps."""
    reach = min(max(1, round(1.0 / travel.sample_time_s)), turns.size - 1)
    rates: Array = np.abs(turns[reach:] - turns[:-reach]) / (reach * travel.sample_time_s)
    return rates


def near(
    spectrum: SpectralLines, coordinate: float, width: float = SPECTRA.same_coordinate_share
) -> float:
    """Return the largest chi-square reduction within ``width``, a share of the coordinate.

    Two bins to either side at least.
    """
    bin_width = float(spectrum.coordinate[1] - spectrum.coordinate[0])
    reach = max(2.0 * bin_width, width * coordinate)
    inside = np.abs(spectrum.coordinate - coordinate) <= reach
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
    """Return whether a hypothesis shows as spectral lines, in whatever coordinate."""
    return isinstance(h.effect.shows, Orders | Frequency)


def rolls_along(h: Hypothesis) -> bool:
    """Return whether a hypothesis shows once per turn of what rolls on the body at its place."""
    return isinstance(h.effect.shows, Orders) and bool(h.effect.shows.rolls_on)


def shown_Hz(h: Hypothesis, travel: Travel) -> float | None:
    """Return where in time a hypothesis shows after sampling, Hz; None where it does not."""
    shows = h.effect.shows
    if not isinstance(shows, Frequency):
        return None
    return alias_Hz(shows.at(h.at_start), travel.sample_time_s)


def wavenumbers_1_m(h: Hypothesis, travel: Travel) -> list[float]:
    """Return where in web travel the orders of a hypothesis at a roller show, 1/m."""
    radius_m = radius_at(h, travel)
    return [n / (TWO_PI * radius_m) for n in orders_of(h, radius_m)]


def radius_at(h: Hypothesis, travel: Travel) -> float:
    """Return the declared radius of the body at the hypothesis' location, m."""
    return travel.declaration.rollers[travel.declaration.body(h.location)].radius_m


def line_at_body(
    h: Hypothesis, travel: Travel, found: Sequence[SpectralLines]
) -> tuple[float, float] | None:
    """Return order of the strongest line over the turns of the hypothesis' body, and bin width."""
    seen = _over_turns(h, travel, found) if h.location != "all" else None
    if seen is None:
        return None
    spectrum, orders = seen
    bin_width = float(spectrum.coordinate[1] - spectrum.coordinate[0])
    return spectrum.peak[0] * orders, bin_width * orders


def _over_turns(
    h: Hypothesis, travel: Travel, found: Sequence[SpectralLines]
) -> tuple[SpectralLines, float] | None:
    """Return the spectrum in which orders of a body show, and orders per unit of its coordinate.

    That of the body's own angle where there is one, else the travel's.
    """
    by_kind = {(s.kind, s.roll): s for s in found}
    own = by_kind.get(("angle", h.location))
    if own is not None:
        return own, 1.0
    shared = by_kind.get(("travel", ""))
    return None if shared is None else (shared, TWO_PI * radius_at(h, travel))


def periodic_support(
    h: Hypothesis, travel: Travel, found: Sequence[SpectralLines]
) -> float | None:
    """Return the chi-square reduction of a free line where a hypothesis shows; None: no line."""
    if not is_periodic(h):
        return None
    frequency_Hz = shown_Hz(h, travel)
    if frequency_Hz is not None:
        in_time = next(s for s in found if s.kind == "time")
        return near(in_time, frequency_Hz, SPECTRA.same_frequency_share)
    if h.location == "all":
        return max((s.peak[1] for s in found if s.kind == "travel"), default=0.0)
    seen = _over_turns(h, travel, found)
    if seen is None:
        return 0.0
    spectrum, orders = seen
    return max(near(spectrum, n / orders) for n in orders_of(h, radius_at(h, travel)))
