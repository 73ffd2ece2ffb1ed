"""Free spectral lines in records without a line declaration: clock, time or travel, with radii."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import chdtri

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.spectra.spectral_lines import SpectralLines, spectral_lines, speed_weights
from sim_plant.refine.without_line.record_filter import Remainder, whiten
from sim_plant.refine.without_line.spectral_line_presence import (
    SpectralLinePresence,
    as_orders,
    position_of,
    presence_of,
)

WITHOUT_LINE = CRITERIA.without_line


@dataclass(frozen=True, slots=True, kw_only=True)
class SpectralLine:
    """One spectral line found.

    Attributes
    ----------
    axis : ``time`` or ``travel``.
    frequency : Hz or 1/m.
    per_record : frequency found in each record alone.
    chi2_reduction : reduction of chi-square over all records.
    clock : why the machine does not make it; empty when it may.
    presence : in which records and at which speeds; None for a clock of a raw output.
    """

    axis: str
    frequency: float
    per_record: tuple[float, ...]
    chi2_reduction: float
    clock: str = ""
    presence: SpectralLinePresence | None = None

    @property
    def where(self) -> dict[str, float | str]:
        """The coordinate by name, as a verdict has it."""
        if self.axis == "time":
            return {"frequency_Hz": self.frequency}
        return {"wavenumber_1_m": self.frequency, "equivalent_radius_m": self.equivalent_radius_m}

    @property
    def equivalent_radius_m(self) -> float:
        """Radius of a roller that turns once per period of the spectral line in travel."""
        return 1.0 / (2.0 * math.pi * self.frequency)


def _spectra(item: Remainder, white: Array) -> list[SpectralLines]:
    """Return the spectra of whitened rows (rows, samples) in time and, with a speed, in travel."""
    rate = 1.0 / item.record.sample_time_s
    size = white.shape[1]
    time_s: Array = np.arange(size, dtype=np.float64) * item.record.sample_time_s
    moving = item.speed_m_s if item.speed_m_s is not None else np.ones(size)
    weights = speed_weights(moving, 2)
    spectra = [
        spectral_lines(
            white,
            time_s,
            weights,
            axis="time",
            highest=WITHOUT_LINE.highest_frequency_share * rate,
            lowest=WITHOUT_LINE.fewest_cycles / float(time_s[-1]),
        )
    ]
    if item.travel_m is not None and item.speed_m_s is not None:
        extent = float(np.ptp(item.travel_m))
        highest = min(
            WITHOUT_LINE.highest_travel_share * rate / float(np.mean(item.speed_m_s)),
            WITHOUT_LINE.highest_wavenumber_1_m,
        )
        spectra.append(
            spectral_lines(
                white,
                item.travel_m,
                weights,
                axis="travel",
                highest=highest,
                lowest=WITHOUT_LINE.fewest_cycles / extent,
            )
        )
    return spectra


def threshold(spectrum: SpectralLines) -> float:
    """Return ``safety`` times the chi-square reduction that noise exceeds by ``false_alarm``."""
    per_bin = WITHOUT_LINE.false_alarm / max(1, spectrum.frequency.size)
    return WITHOUT_LINE.safety * float(chdtri(spectrum.degrees, per_bin))


def find_spectral_lines(items: Sequence[Remainder]) -> list[SpectralLine]:
    """Return significant spectral lines over all records, strongest first.

    Each is taken out before the next is looked for. A spectral line counts on the axis on
    which it is sharper: that with the larger reduction of chi-square.
    """
    whites = first = [item.whitened for item in items]
    lines: list[SpectralLine] = []
    for _ in range(WITHOUT_LINE.most_spectral_lines):
        spectra = [_spectra(item, white) for item, white in zip(items, whites, strict=True)]
        best = _best(spectra)
        if best is None:
            break
        axis, at, chi2_reduction = best
        line, own = _line(items, whites, axis, at, chi2_reduction)
        if not any(_same(line, other) for other in lines):
            lines.append(line)
        whites = [
            _without(item, white, line.axis, at)
            for item, white, at in zip(items, whites, own, strict=True)
        ]
    return _orders(items, first, lines)


def _same(line: SpectralLine, other: SpectralLine) -> bool:
    """Return whether ``line`` is what was left of ``other``, a stronger one that wanders."""
    if line.axis != other.axis:
        return False
    apart = abs(line.frequency / other.frequency - 1.0)
    return apart < CRITERIA.spectra.same_coordinate_share


def _line(
    items: Sequence[Remainder],
    whites: Sequence[Array],
    axis: str,
    at: float,
    chi2_reduction: float,
) -> tuple[SpectralLine, list[float]]:
    """Return a spectral line with where it was seen, and its own frequency in every record.

    A record in which it is not there on its own has no say in the frequency.
    """
    own = [sharpest(item, white, axis, at) for item, white in zip(items, whites, strict=True)]
    where = presence_of(items, whites, axis, own)
    joint = float(np.median([c for c, yes in zip(own, where.present, strict=True) if yes]))
    own = [c if yes else joint for c, yes in zip(own, where.present, strict=True)]
    line = SpectralLine(
        axis=axis,
        frequency=joint,
        per_record=tuple(own),
        chi2_reduction=chi2_reduction,
        clock=_clock(items, axis, joint),
        presence=where,
    )
    return line, own


def _orders(
    items: Sequence[Remainder], whites: Sequence[Array], lines: Sequence[SpectralLine]
) -> list[SpectralLine]:
    """Return the spectral lines, those that are orders of one turn in travel and named so."""
    if items[0].travel_m is None:
        return list(lines)
    rows = [
        (x.axis, x.frequency, x.presence) for x in lines if x.presence is not None and not x.clock
    ]
    extents = [float(np.ptp(x.travel_m)) for x in items if x.travel_m is not None]
    named = iter(as_orders(rows, extents))
    result = []
    for x in lines:
        if x.presence is None or x.clock:
            result.append(x)
            continue
        axis, at, where = next(named)
        per_record = x.per_record
        if axis != x.axis:
            own = [sharpest(i, w, axis, at) for i, w in zip(items, whites, strict=True)]
            where = replace(where, present=presence_of(items, whites, axis, own).present)
            at = float(np.median([c for c, p in zip(own, where.present, strict=True) if p]))
            per_record = tuple(c if p else at for c, p in zip(own, where.present, strict=True))
        result.append(replace(x, axis=axis, frequency=at, per_record=per_record, presence=where))
    return result


def clocks(items: Sequence[Remainder]) -> list[SpectralLine]:
    """Return spectral lines of the raw outputs that the experiment makes, not the machine."""
    lines = []
    for item in items:
        for row in item.outputs:
            white = whiten(row)[None, :]
            spectrum = _spectra(item, white)[0]
            at, chi2_reduction = spectrum.peak
            if (
                chi2_reduction
                > threshold(spectrum) * WITHOUT_LINE.clock_safety / WITHOUT_LINE.safety
            ):
                at = sharpest(item, white, "time", at)
                reason = _clock([item], "time", at)
                if reason:
                    lines.append(
                        SpectralLine(
                            axis="time",
                            frequency=at,
                            per_record=(at,),
                            chi2_reduction=chi2_reduction,
                            clock=reason,
                        )
                    )
    return lines


def _best(spectra: Sequence[Sequence[SpectralLines]]) -> tuple[str, float, float] | None:
    """Return axis, frequency and chi-square reduction of the strongest; None: all are noise."""
    best: tuple[str, float, float] | None = None
    for k, first in enumerate(spectra[0]):
        total = first.chi2_reduction.copy()
        limit = threshold(first)
        for record in spectra[1:]:
            total += np.interp(first.frequency, record[k].frequency, record[k].chi2_reduction)
            limit += first.degrees  # what noise of one more record adds on average
        at = int(np.argmax(total))
        if total[at] > limit and (best is None or total[at] > best[2]):
            best = (first.axis, float(first.frequency[at]), float(total[at]))
    return best


def sharpest(item: Remainder, white: Array, axis: str, near: float) -> float:
    """Return the frequency of the strongest spectral line near ``near``, in one record alone."""
    u = position_of(item, axis)
    reach = max(1.0 / float(u[-1]), WITHOUT_LINE.sharp_share * near)
    best = near
    for _ in range(WITHOUT_LINE.sharp_passes):
        four = int(8.0 * reach * float(u[-1])) + 1  # per 1 / extent of the record
        points = max(WITHOUT_LINE.sharp_points, four)
        grid = np.linspace(best - reach, best + reach, points)
        best = float(grid[int(np.argmax(_power(white, u, grid)))])
        reach *= WITHOUT_LINE.sharp_narrows
    return best


def _power(white: Array, u: Array, grid: Array) -> Array:
    """Return the power of all outputs (grid,) at evenly spaced frequencies.

    From one frequency to the next every sample's phasor turns by the same angle: a product
    takes the place of an exponential.
    """
    phasor = np.exp(-2j * np.pi * grid[0] * u)
    onward = np.exp(-2j * np.pi * (grid[1] - grid[0]) * u)
    power = np.empty(grid.size)
    for k in range(grid.size):
        power[k] = np.sum(np.abs(white @ phasor) ** 2)
        phasor *= onward
    return power


def basis(item: Remainder, axis: str, frequency: float) -> Array:
    """Return cos and sin of a spectral line, each also times relative speed (samples, 2 or 4)."""
    turn = 2.0 * np.pi * frequency * position_of(item, axis)
    columns = [np.cos(turn), np.sin(turn)]
    if item.speed_m_s is not None:
        relative = item.speed_m_s / np.mean(item.speed_m_s) - 1.0
        columns += [columns[0] * relative, columns[1] * relative]
    return np.stack(columns, axis=1)


def _without(item: Remainder, white: Array, axis: str, frequency: float) -> Array:
    """Return whitened outputs less a spectral line, fitted to them (outputs, samples)."""
    b = basis(item, axis, frequency)
    rest: Array = white - (b @ np.linalg.lstsq(b, white.T, rcond=None)[0]).T
    return rest


def _clock(items: Sequence[Remainder], axis: str, frequency: float) -> str:
    """Return why a spectral line is a clock of the experiment; empty when it is not."""
    if axis != "time":
        return ""
    rate = 1.0 / items[0].record.sample_time_s
    divisor = rate / frequency
    width = max(
        WITHOUT_LINE.clock_share,
        1.0 / (items[0].residual.shape[1] * items[0].record.sample_time_s) / frequency,
    )
    reasons = []
    if (
        abs(divisor - round(divisor)) < width * divisor
        and round(divisor) <= WITHOUT_LINE.highest_divisor
    ):
        reasons.append(f"is 1/{round(divisor)} of the sample rate")
    for item in items:
        if not item.inputs.shape[0]:
            continue
        white = np.stack([whiten(row) for row in item.inputs])
        time_s = position_of(item, "time")
        spectrum = spectral_lines(
            white,
            time_s,
            np.ones((1, time_s.size)),
            axis="time",
            highest=WITHOUT_LINE.highest_frequency_share * rate,
            lowest=WITHOUT_LINE.fewest_cycles / float(time_s[-1]),
        )
        near = np.abs(spectrum.frequency - frequency) < 2.0 * width * frequency
        if near.any() and float(spectrum.chi2_reduction[near].max()) > threshold(spectrum):
            reasons.append("is in the excitation as well")
            break
    for mains in WITHOUT_LINE.mains_Hz:
        folded = math.fmod(mains, rate)
        if abs(min(folded, rate - folded) - frequency) < WITHOUT_LINE.clock_share * frequency:
            reasons.append(f"may be {mains:g} Hz mains, aliased")
    return ", ".join(reasons)
