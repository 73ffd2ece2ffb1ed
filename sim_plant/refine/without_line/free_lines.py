"""Free lines in records without a line declaration: clock, time or travel, with radii."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.spectra.line_spectrum import LineSpectrum, line_spectrum, speed_weights
from sim_plant.refine.without_line.record_filter import Explained, whiten

WITHOUT_LINE = CRITERIA.without_line


@dataclass(frozen=True, slots=True, kw_only=True)
class SpectralLine:
    """One line found.

    Attributes
    ----------
    kind : ``time`` or ``travel``.
    coordinate : Hz or 1/m.
    per_record : coordinate found in each record alone.
    strength : drop over all records.
    clock : why it is no effect of the machine; empty when it may be one.
    """

    kind: str
    coordinate: float
    per_record: tuple[float, ...]
    strength: float
    clock: str = ""

    @property
    def where(self) -> dict[str, float | str]:
        """The coordinate by name, as a verdict has it."""
        if self.kind == "time":
            return {"frequency_Hz": self.coordinate}
        return {"wavenumber_1_m": self.coordinate, "equivalent_radius_m": self.equivalent_radius_m}

    @property
    def equivalent_radius_m(self) -> float:
        """Radius of a roller that turns once per line period of travel."""
        return 1.0 / (2.0 * math.pi * self.coordinate)


def _spectra(item: Explained, white: Array) -> list[LineSpectrum]:
    rate = 1.0 / item.record.sample_time_s
    size = white.shape[1]
    time_s: Array = np.arange(size, dtype=np.float64) * item.record.sample_time_s
    moving = item.speed_m_s if item.speed_m_s is not None else np.ones(size)
    weights = speed_weights(moving, 2)
    found = [
        line_spectrum(
            white,
            time_s,
            weights,
            kind="time",
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
        found.append(
            line_spectrum(
                white,
                item.travel_m,
                weights,
                kind="travel",
                highest=highest,
                lowest=WITHOUT_LINE.fewest_cycles / extent,
            )
        )
    return found


def threshold(spectrum: LineSpectrum) -> float:
    """Return the drop that noise exceeds in one record of ten thousand, with a margin."""
    per_bin = WITHOUT_LINE.false_alarm / max(1, spectrum.coordinate.size)
    return WITHOUT_LINE.safety * float(chi2.isf(per_bin, spectrum.degrees))


def find_spectral_lines(items: Sequence[Explained]) -> list[SpectralLine]:
    """Return significant lines over all records, strongest first, each taken out before the next.

    A line counts in the coordinate in which it is sharper: that with the larger drop.
    """
    whites = [item.whitened for item in items]
    found: list[SpectralLine] = []
    for _ in range(WITHOUT_LINE.most_spectral_lines):
        spectra = [_spectra(item, white) for item, white in zip(items, whites, strict=True)]
        best = _best(spectra)
        if best is None:
            break
        kind, at, strength = best
        singles = tuple(
            sharpest(item, white, kind, at) for item, white in zip(items, whites, strict=True)
        )
        joint = float(np.median(singles))
        found.append(
            SpectralLine(
                kind=kind,
                coordinate=joint,
                per_record=singles,
                strength=strength,
                clock=_clock(items, kind, joint),
            )
        )
        whites = [
            _without(item, white, kind, own)
            for item, white, own in zip(items, whites, singles, strict=True)
        ]
    return found


def clocks(items: Sequence[Explained]) -> list[SpectralLine]:
    """Return lines of the raw outputs that are clocks of the experiment, not of the machine."""
    found = []
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
                    found.append(
                        SpectralLine(
                            kind="time",
                            coordinate=at,
                            per_record=(at,),
                            strength=chi2_reduction,
                            clock=reason,
                        )
                    )
    return found


def _best(spectra: Sequence[Sequence[LineSpectrum]]) -> tuple[str, float, float] | None:
    best: tuple[str, float, float] | None = None
    for k, first in enumerate(spectra[0]):
        total = first.chi2_reduction.copy()
        limit = threshold(first)
        for record in spectra[1:]:
            total += np.interp(first.coordinate, record[k].coordinate, record[k].chi2_reduction)
            limit += first.degrees
        at = int(np.argmax(total))
        if total[at] > limit and (best is None or total[at] > best[2]):
            best = (first.kind, float(first.coordinate[at]), float(total[at]))
    return best


def _phase(item: Explained, kind: str) -> Array:
    phase: Array = np.arange(item.residual.shape[1], dtype=np.float64) * item.record.sample_time_s
    if kind == "travel" and item.travel_m is not None:
        phase = item.travel_m - item.travel_m[0]
    return phase


def sharpest(item: Explained, white: Array, kind: str, near: float) -> float:
    """Return the coordinate of the strongest line within 0.5 % (or two bins) in one record."""
    u = _phase(item, kind)
    reach = max(1.0 / float(u[-1]), 0.002 * near)
    best = near
    for _ in range(3):
        grid = np.linspace(best - reach, best + reach, 21)
        power = [float(np.sum(np.abs(white @ np.exp(-2j * np.pi * g * u)) ** 2)) for g in grid]
        best, reach = float(grid[int(np.argmax(power))]), 0.15 * reach
    return best


def basis(item: Explained, kind: str, coordinate: float) -> Array:
    """Return cos and sin of a line, each also times relative speed (samples, 2 or 4)."""
    turn = 2.0 * np.pi * coordinate * _phase(item, kind)
    columns = [np.cos(turn), np.sin(turn)]
    if item.speed_m_s is not None:
        relative = item.speed_m_s / np.mean(item.speed_m_s) - 1.0
        columns += [columns[0] * relative, columns[1] * relative]
    return np.stack(columns, axis=1)


def _without(item: Explained, white: Array, kind: str, coordinate: float) -> Array:
    b = basis(item, kind, coordinate)
    rest: Array = white - (b @ np.linalg.lstsq(b, white.T, rcond=None)[0]).T
    return rest


def _clock(items: Sequence[Explained], kind: str, coordinate: float) -> str:
    """Return why a line is a clock of the experiment, empty when nothing says so."""
    if kind != "time":
        return ""
    rate = 1.0 / items[0].record.sample_time_s
    divisor = rate / coordinate
    width = max(
        WITHOUT_LINE.clock_share,
        1.0 / (items[0].residual.shape[1] * items[0].record.sample_time_s) / coordinate,
    )
    reasons = []
    if (
        abs(divisor - round(divisor)) < width * divisor
        and round(divisor) <= WITHOUT_LINE.highest_divisor
    ):
        reasons.append(f"is 1/{round(divisor)} of the sample rate")
    for item in items:
        white = np.stack([whiten(row) for row in item.inputs])
        time_s = _phase(item, "time")
        spectrum = line_spectrum(
            white,
            time_s,
            np.ones((1, time_s.size)),
            kind="time",
            highest=WITHOUT_LINE.highest_frequency_share * rate,
            lowest=WITHOUT_LINE.fewest_cycles / float(time_s[-1]),
        )
        near = np.abs(spectrum.coordinate - coordinate) < 2.0 * width * coordinate
        if near.any() and float(spectrum.chi2_reduction[near].max()) > threshold(spectrum):
            reasons.append("is in the excitation as well")
            break
    for mains in WITHOUT_LINE.mains_Hz:
        folded = math.fmod(mains, rate)
        if abs(min(folded, rate - folded) - coordinate) < WITHOUT_LINE.clock_share * coordinate:
            reasons.append(f"may be {mains:g} Hz mains, aliased")
    return ", ".join(reasons)
