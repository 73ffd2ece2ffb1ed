"""The noise a perfect model would leave: simulated from the declaration, checked on the data."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import solve_toeplitz

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array
from sim_plant.line.declared.declaration import CarriagePosition, RollAngle, RollRadius
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.model.twin import Twin
from sim_plant.refine.noise.drift import drift_standard_deviations, drift_whitened, slow_terms

NOISE = CRITERIA.noise


def first_judged(samples: int, sample_time_s: float) -> int:
    """Return the first sample to judge: 20 s, or a quarter of a short record."""
    return min(round(NOISE.settling_s / sample_time_s), int(NOISE.settling_share * samples))


def filter_taps(sample_time_s: float) -> int:
    """Return how many taps whiten noise: what spans ``whitening_s``, no fewer than at 10 ms."""
    return max(NOISE.whitening_taps, round(NOISE.whitening_s / sample_time_s))


def whitening_filter(
    noise: Array, order: int = NOISE.whitening_taps, white_share: float = 0.0
) -> tuple[Array, float]:
    """Return prediction-error taps (order + 1,) and innovation sd of noise (runs, samples).

    ``white_share`` of the power is taken as white. Equation: Yule-Walker, R a = r, with a ridge
    of 1e-6 R(0)  [Hayes 1996, 3.6].
    """
    centred = noise - noise.mean(axis=1, keepdims=True)
    length = centred.shape[1]
    size = 1 << (2 * length - 1).bit_length()
    power = np.abs(np.fft.rfft(centred, size, axis=1)) ** 2
    lags = np.fft.irfft(power, size, axis=1)[:, : order + 1].mean(axis=0) / length
    if lags[0] <= 0.0:
        return np.array([1.0]), 0.0
    lags[1:] *= 1.0 - white_share
    ridge = lags.copy()
    ridge[0] *= 1.0 + 1e-6
    weights = solve_toeplitz(ridge[:-1], ridge[1:])
    variance = float(lags[0] - weights @ lags[1:])
    return np.concatenate(([1.0], -weights)), float(np.sqrt(max(variance, 1e-12 * lags[0])))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class NoiseModel:
    """Per channel: prediction-error filter, innovation sd, and rms of the noise itself.

    Attributes
    ----------
    filters : coefficient rows, one per channel.
    sd : innovation sd per channel (channels,), channel units.
    floor : rms of the noise per channel (channels,), the residual of a perfect model.
    first : first judged sample.
    words : per channel, the filters to choose from by the data (taps, sd), where the noise is
        that of a coarse word alone: a sawtooth that late scans make white; else empty.
    slow : sd of the slowest cosines of the innovations (channels, terms), see
        ``drift_standard_deviations``.
    """

    filters: tuple[Array, ...]
    sd: Array
    floor: Array
    first: int
    words: tuple[tuple[tuple[Array, float], ...], ...] = ()
    slow: Array | None = None

    @property
    def analogue(self) -> Array:
        """Which channels (channels,) have more noise than a coarse word; all when none has."""
        found = np.array(
            [
                taps.size > 1 and not choice
                for taps, choice in zip(
                    self.filters, self.words or ((),) * len(self.filters), strict=True
                )
            ]
        )
        return found if found.any() else np.ones(found.size, dtype=bool)

    @property
    def share(self) -> Array:
        """Power of a channel's noise over that of its innovations (channels,), 1 at most."""
        return np.minimum(1.0, (self.floor / self.sd) ** 2)

    def whiten(self, values: Array) -> Array:
        """Return unit-variance innovations (channels, judged) of (channels, samples)."""
        out = np.empty((values.shape[0], values.shape[1] - self.first))
        for c, taps in enumerate(self.filters):
            start = max(0, self.first - taps.size)
            part = values[c, start:]
            row = np.convolve(taps, part)[: part.size]
            out[c] = row[self.first - start :] / self.sd[c]
        return out if self.slow is None else drift_whitened(out, self.slow)

    def adjusted_to(self, residual: Array) -> NoiseModel:
        """Return the noise that ``residual`` (channels, samples) shows, close to this one.

        Late scans, another colour than declared, or the sawtooth of a coarse word that jitter
        breaks up: all change level and colour by a little. Channels that are weighed by their
        quantum alone (one tap) stay as they are.
        """
        filters, sd = list(self.filters), self.sd.copy()
        for c, choice in enumerate(self.words):
            if choice:
                part = residual[c, self.first :]
                filters[c], sd[c] = min(choice, key=lambda pair: _unlikely(part, pair[0]))
        declared = replace(self, filters=tuple(filters), sd=sd)
        for c, row in enumerate(declared.whiten(residual)):
            if filters[c].size > 1:
                more, size = colour_filter(noise_power(row))
                filters[c] = np.convolve(filters[c], more)
                sd[c] *= size
        return replace(declared, filters=tuple(filters))


def _unlikely(values: Array, taps: Array) -> float:
    """Return how badly noise of this colour explains the upper half band, its level free.

    Equation: Whittle's likelihood [Whittle 1953], log(mean P/S) + mean log S with S = 1 / |A|^2.
    """
    power = periodogram(values)
    upper = slice(power.size // 2, None)
    gain = np.abs(np.fft.rfft(taps, values.size)[upper]) ** 2
    return float(np.log(np.mean(power[upper] * gain)) - np.mean(np.log(gain)))


def noise_model(
    runs: Array,
    first: int,
    coarse_steps: Array,
    words: Sequence[bool] = (),
    order: int = NOISE.whitening_taps,
) -> NoiseModel:
    """Return the noise model of noise realisations (runs, channels, samples).

    ``coarse_steps`` (channels,) is the quantum of channels whose error is a slow sawtooth
    (a radius word): they count as one sample per quantum passed; 0 elsewhere. ``words`` says
    which other channels have no noise but their quantum; ``order`` is the taps of a filter.
    """
    filters, sd, floor = [], [], []
    choices: list[tuple[tuple[Array, float], ...]] = []
    for c in range(runs.shape[1]):
        noise = runs[:, c, first:]
        floor.append(float(np.sqrt(np.mean(noise**2))))
        if coarse_steps[c] > 0.0:
            floor[-1] = float(coarse_steps[c] / np.sqrt(12.0))
            filters.append(np.array([1.0]))
            sd.append(NOISE.coarse_word_factor * floor[-1])
            choices.append(())
            continue
        taps, innovation = whitening_filter(noise, order)
        filters.append(taps)
        sd.append(max(innovation, 1e-12))
        is_word = bool(words) and words[c]
        choices.append(
            tuple(whitening_filter(noise, order, s) for s in NOISE.white_shares) if is_word else ()
        )
    return NoiseModel(
        filters=tuple(filters),
        sd=np.array(sd),
        floor=np.array(floor),
        first=first,
        words=tuple(choices),
    )


def rounding_step(own: float, word: float) -> float:
    """Return the step that rounds by as much as a sensor's ``own`` step and then a coarser word's.

    Half of the readings lie between two counts of a word of twice the step, and go either way: of
    10 um, then 20 um, the error is that of 26 um.
    Equation: the second rounding of a word of m own steps takes m values of equal likelihood,
    variance (m^2 - 1) / 12 of a step where m is odd, (m^2 + 2) / 12 with ties where it is
    even; as if apart from the first where m is no whole number  [own derivation].
    """
    if word <= own or own <= 0.0:
        return max(own, word)
    ratio = word / own
    whole = round(ratio)
    if abs(ratio - whole) > NOISE.same_ratio:
        return float(np.hypot(own, word))
    return float(own * np.sqrt(whole**2 + (3.0 if whole % 2 == 0 else 0.0)))


def declared_noise(twin: Twin, runs: Array) -> NoiseModel:
    """Return the noise model of a twin from its noise realisations (runs, channels, samples).

    Raises
    ------
    PlantError
        When a channel has no noise at all.
    """
    line = twin.declaration
    steps = {
        s.channel: rounding_step(s.lsb_m, twin.word_steps.get(s.channel, 0.0))
        for s in line.sensors
        if isinstance(s, RollRadius | CarriagePosition)
    }
    words = {s.channel for s in line.sensors if isinstance(s, RollAngle)}
    words |= _rounded(twin, runs)
    noise = noise_model(
        runs,
        first_judged(runs.shape[2], line.sample_time_s),
        np.array([steps.get(c, 0.0) for c in twin.channels]),
        [c in words for c in twin.channels],
        filter_taps(line.sample_time_s),
    )
    silent = [name for name, rms in zip(twin.channels, noise.floor, strict=True) if not rms > 0.0]
    if silent:
        raise PlantError(
            f"sensors.{silent[0]}: the line file declares no noise that reaches this channel: no "
            "difference can be weighed; give its noise_sd or lsb"
        )
    white = np.stack([noise.whiten(run) for run in runs])
    terms = slow_terms(white.shape[2], line.sample_time_s)
    return replace(noise, slow=drift_standard_deviations(white, terms))


def _rounded(twin: Twin, runs: Array) -> set[str]:
    """Return channels whose noise (runs, channels, samples) is mostly the rounding of their word.

    A ripple of some counts comes out of the rounding with orders that no roll has.
    """
    rms = np.sqrt(np.mean(np.square(runs - runs.mean(axis=2, keepdims=True)), axis=(0, 2)))
    return {
        name
        for name, size in zip(twin.channels, rms, strict=True)
        if twin.word_steps.get(name, 0.0) ** 2 / 12.0 > NOISE.rounded_share * size**2
    }


def periodogram(values: Array) -> Array:
    """Return the power of every bin, 1 for unit white noise; a window keeps drift in its bins."""
    window = np.hanning(values.size)
    spectrum = np.fft.rfft((values - values.mean()) * window)
    power: Array = np.abs(spectrum) ** 2 / float(window @ window)
    return power


def band_power(whitened: Array) -> Array:
    """Return the power of the calm part of every band (bands,), 1 for unit white noise.

    Equation: mean of the quietest 75 % of the bins of a periodogram over what exponentially
    distributed bins of mean 1 would give, 1 - q e^-q / (1 - e^-q) with q = ln 4.
    """
    power = periodogram(whitened)[1:]
    edges = np.round(np.array(NOISE.bands) * power.size).astype(int)
    tail = 1.0 - NOISE.calm_share
    calm = 1.0 + tail * np.log(tail) / NOISE.calm_share
    powers = []
    for low, high in itertools.pairwise(edges):
        part = np.sort(power[low:high])
        powers.append(float(part[: max(1, round(NOISE.calm_share * part.size))].mean()) / calm)
    return np.array(powers)


def noise_power(whitened: Array) -> Array:
    """Return the power per band (bands,) that counts as noise: never much over the upper half.

    What is louder below than noise may be stays in the residual, to be explained.
    """
    power = band_power(whitened)
    level = max(1.0, float(np.mean(power[-NOISE.upper_bands :])))
    return np.clip(power, NOISE.quietest, NOISE.loudest * level)


def colour_filter(power: Array) -> tuple[Array, float]:
    """Return prediction-error taps and innovation sd of noise with this power per band."""
    edges = np.array(NOISE.bands)
    grid = np.linspace(0.0, 1.0, 257)
    shape = np.interp(grid, 0.5 * (edges[1:] + edges[:-1]), power)
    lags = np.fft.irfft(shape)[: NOISE.colour_taps + 1]
    weights = solve_toeplitz(lags[:-1], lags[1:])
    taps = np.concatenate(([1.0], -weights))
    return taps, float(np.sqrt(lags[0] - weights @ lags[1:]))
