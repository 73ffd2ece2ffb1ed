"""Amplitude of a roll's orders turn by turn, and its uncertainty from how turns differ."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aff_runtime.base.confidence import ONE_SIDED_95, TWO_SIDED_95

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Flags = NDArray[np.bool_]

FEWEST_TURNS = 8
"""Of fewer turns no interval is given."""
BATCHES = 20
"""Turns are averaged in so many batches: neighbours are not independent."""
BATCH_TURNS = 20
"""Turns of a batch without encoder: within it the angle is taken to keep its zero."""
FEWEST_OF_A_PART = 4
"""Turns of a stretch that is joined with others by its size: two batches of two at least."""
FEWEST_SAMPLES = 8
"""Samples per period that an order needs; with fewer it is left out."""
LONGEST_STEP = 0.3
"""Share of a turn between two samples: one missed tick of ``FEWEST_SAMPLES`` a turn, not two."""
WHOLE_WITHIN = 0.2
"""Share of a turn by which the angles that its samples cover may differ from it."""
NOISE_LIMIT = math.sqrt(math.log(20.0))
"""Size a of complex noise over its rms sigma, exceeded once in 20: exp(-a^2 / sigma^2) = 0.05."""
NOT_TOLD = ("none", "unknown")
"""Of ``Change.bound``: there is no figure of the change."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """Amplitude of one order in one window.

    Attributes
    ----------
    amplitude : in the signal's unit.
    low, high : 95 % interval; NaN below ``FEWEST_TURNS``.
    floor : amplitude that noise alone exceeds once in 20 windows.
    turns : that it rests on.
    """

    amplitude: float
    low: float
    high: float
    floor: float
    turns: int

    @property
    def stands_out(self) -> bool:
        """Return whether it is more than noise."""
        return self.amplitude > self.floor

    @property
    def most(self) -> float:
        """Return what it is at most, for sure to 95 %: the floor is no bound of what hides in it.

        An order just above the floor is found below it in half of the windows.
        """
        return self.high if self.stands_out else max(self.high, self.floor)


def order_per_turn(
    angle_rad: Array, signal: Array, good: Flags, orders: Sequence[int]
) -> tuple[Complex, Array]:
    """Return complex amplitudes (turns, orders), and the samples per turn (turns,).

    Equation: c_n = (2 / 2 pi) integral (x - mean x) e^{-j n theta} d theta over one turn, by the
    trapezoid rule on the samples' own angles. A turn with a sample that is not ``good``, or with
    two that are more than ``LONGEST_STEP`` apart, is left out, as are the broken ones at both
    ends; ``angle_rad`` rises.
    """
    if angle_rad.size < 2:
        return np.empty((0, len(orders)), dtype=np.complex128), np.empty(0)
    turn = np.floor((angle_rad - angle_rad[0]) / math.tau).astype(np.int64)
    starts = np.flatnonzero(np.diff(turn, prepend=turn[0] - 1))
    width = np.gradient(angle_rad)
    covered = np.add.reduceat(width, starts)
    is_far = np.diff(angle_rad) > LONGEST_STEP * math.tau
    lacks = ~good | np.append(False, is_far) | np.append(is_far, False)
    bad = np.add.reduceat(lacks.astype(np.float64), starts) > 0.0
    usable = ~bad & (np.abs(covered / math.tau - 1.0) < WHOLE_WITHIN)
    usable[0] = usable[-1] = False
    mean = np.add.reduceat(signal * width, starts) / covered
    swing = (signal - mean[turn_number(starts, signal.size)]) * width
    once = np.exp(-1j * np.mod(angle_rad, math.tau))
    samples = np.diff(np.append(starts, signal.size)).astype(np.float64)
    amplitudes = np.empty((int(usable.sum()), len(orders)), dtype=np.complex128)
    for k, order in enumerate(orders):
        whole = np.add.reduceat(swing * once**order, starts)
        amplitudes[:, k] = (2.0 * whole / covered)[usable]
    return amplitudes, samples[usable]


def turn_number(starts: NDArray[np.intp], size: int) -> NDArray[np.intp]:
    """Return for every sample the number of its turn, from where turns start."""
    begins = np.zeros(size, dtype=np.intp)
    begins[starts[1:]] = 1
    return np.cumsum(begins)


def estimate(per_turn: Complex, *, encoder: bool) -> Estimate:
    """Return the amplitude of one order from its complex amplitudes per turn (turns,).

    With an ``encoder`` it is the size of their mean. Without, the zero of the angle drifts: it
    is the rms size of means over ``BATCH_TURNS`` turns, less noise. A steady advance of their
    phase is taken out first; what then differs from one mean to the next is taken for noise.
    """
    turns = per_turn.size
    if turns < FEWEST_TURNS:
        size = float(abs(per_turn.mean())) if turns else math.nan
        return Estimate(amplitude=size, low=math.nan, high=math.nan, floor=math.nan, turns=turns)
    if encoder:
        return _coherent(_batches(per_turn, min(BATCHES, turns // 2)), turns)
    return _by_size(_batches(per_turn, max(4, turns // BATCH_TURNS)), turns)


def estimate_of_parts(parts: Sequence[Complex], *, encoder: bool) -> Estimate:
    """Return the amplitude of one order from stretches whose phases have nothing in common.

    ``parts`` : complex amplitudes per turn (turns,) of each. Of one part as ``estimate``. Of
    several it is the rms size of their means, less what noise adds to each of them.
    """
    used = [part for part in parts if part.size >= FEWEST_OF_A_PART]
    turns = sum(part.size for part in used)
    if len(used) < 2 or turns < FEWEST_TURNS:
        return estimate(max(parts, key=len, default=np.empty(0, complex)), encoder=encoder)
    length = min(turns // min(BATCHES, turns // 2), min(part.size for part in used) // 2)
    return _of_parts([_batches(part, part.size // length) for part in used], turns)


def _of_parts(parts: Sequence[Complex], turns: int) -> Estimate:
    """Equation: A^2 = sum K_s |m_s|^2 / K - S sigma^2 / K; S parts of K_s batches each.

    ``m_s`` are their means, sigma^2 the power of a batch about the mean of its part: own
    derivation. Of noise alone the first sum is sigma^2 / K times a gamma variate of S degrees.
    """
    count, freedom = sum(part.size for part in parts), sum(part.size - 1 for part in parts)
    means = [complex(part.mean()) for part in parts]
    off = [np.abs(part - mean) ** 2 for part, mean in zip(parts, means, strict=True)]
    noise = float(np.sum(np.concatenate(off))) / freedom / count
    power = sum(part.size * abs(mean) ** 2 for part, mean in zip(parts, means, strict=True))
    size = math.sqrt(max(0.0, power / count - len(parts) * noise))
    turned = [
        np.real(part * np.conj(mean)) / max(abs(mean), 1e-300)
        for part, mean in zip(parts, means, strict=True)
    ]
    along = np.concatenate(turned)
    spread = math.sqrt(float(np.sum((along - along.mean()) ** 2)) / freedom)
    half = student_t(freedom) * spread / math.sqrt(count)
    beyond = _gamma_95(len(parts)) - len(parts)
    return Estimate(
        amplitude=size,
        low=max(0.0, size - half),
        high=size + half,
        floor=math.sqrt(beyond * noise),
        turns=turns,
    )


def _gamma_95(shape: float) -> float:
    """Return what a gamma variate of this shape exceeds once in 20, by Wilson and Hilferty."""
    cube = 1.0 - 1.0 / (9.0 * shape) + ONE_SIDED_95 / (3.0 * math.sqrt(shape))
    return shape * cube**3


def _batches(values: Complex, count: int) -> Complex:
    """Return the means of ``count`` equal parts; a rest at the end is left out."""
    length = values.size // count
    found: Complex = values[: count * length].reshape(count, length).mean(axis=1)
    return found


def _coherent(batches: Complex, turns: int) -> Estimate:
    count, mean = batches.size, complex(batches.mean())
    size = abs(mean)
    along = np.real(batches * np.conj(mean)) / size if size > 0.0 else np.abs(batches)
    half = student_t(count - 1) * float(np.std(along, ddof=1)) / math.sqrt(count)
    spread = float(np.sum(np.abs(batches - mean) ** 2)) / (count * (count - 1))
    return Estimate(
        amplitude=size,
        low=max(0.0, size - half),
        high=size + half,
        floor=NOISE_LIMIT * math.sqrt(spread),
        turns=turns,
    )


def _by_size(batches: Complex, turns: int) -> Estimate:
    """Return the size of batches whose phase advances steadily, as a wrong radius makes it."""
    count = batches.size
    advance = float(np.angle(np.sum(batches[1:] * np.conj(batches[:-1]))))
    left = float(np.sinc(advance / math.tau))  # of a batch's mean, as the phase advances in it
    even = batches * np.exp(-1j * advance * np.arange(count)) / left
    noise = 0.5 * float(np.mean(np.abs(np.diff(even)) ** 2))
    power = np.abs(even) ** 2
    size = math.sqrt(max(0.0, float(power.mean()) - noise))
    half_power = student_t(count - 1) * float(np.std(power, ddof=1)) / math.sqrt(count)
    return Estimate(
        amplitude=size,
        low=math.sqrt(max(0.0, size**2 - half_power)),
        high=math.sqrt(size**2 + half_power),
        # the power of noise less its mean
        floor=math.sqrt(ONE_SIDED_95 * noise / math.sqrt(count)),
        turns=turns,
    )


def student_t(freedom: int, normal: float = TWO_SIDED_95) -> float:
    """Return the point of Student's t with the tail of ``normal`` standard deviations.

    By an expansion in 1 / ``freedom``, its degrees of freedom; by default the 97.5 % point.
    """
    z, v = normal, float(max(1, freedom))
    return (
        z
        + (z**3 + z) / (4.0 * v)
        + (5.0 * z**5 + 16.0 * z**3 + 3.0 * z) / (96.0 * v**2)
        + (3.0 * z**7 + 19.0 * z**5 + 17.0 * z**3 - 15.0 * z) / (384.0 * v**3)
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """From one amplitude to another, dB; NaN where it is not known.

    Attributes
    ----------
    value_dB : after over before; of a bound the ends of both that make it hold to 95 %.
    low_dB, high_dB : 95 % interval; of a bound NaN, but for the end that it is.
    bound : ``at_most``: the amplitude after is in the noise, the change is that or less;
        ``at_least``: that before is; ``none``: both are; ``unknown``: of one or both too few
        turns were seen to tell; else empty.
    """

    value_dB: float
    low_dB: float
    high_dB: float
    bound: str


def _log10(size: float) -> float:
    """Return the logarithm of a size; minus infinity of 0."""
    return math.log10(size) if size else -math.inf


def change(before: Estimate, after: Estimate) -> Change:
    """Return the change between two windows."""
    before_seen, after_seen = before.stands_out, after.stands_out
    is_unknown = math.isnan(before.floor) or math.isnan(after.floor)  # too few turns for one
    if is_unknown or not (before_seen or after_seen):
        bound = "unknown" if is_unknown else "none"
        return Change(value_dB=math.nan, low_dB=math.nan, high_dB=math.nan, bound=bound)
    if not before_seen or not after_seen:
        return _bound(before, after)
    value = 20.0 * (_log10(after.amplitude) - _log10(before.amplitude))
    shares = ((e.high - e.low) / (2.0 * e.amplitude) for e in (before, after))
    half = 20.0 / math.log(10.0) * math.hypot(*shares)
    return Change(value_dB=value, low_dB=value - half, high_dB=value + half, bound="")


def _bound(before: Estimate, after: Estimate) -> Change:
    """Return what a change is at most or at least, where one of the two is in the noise.

    Of few turns the lower end of what stands out may be 0: then nothing is known of the change.
    """
    there = before.stands_out
    large, small = (before.low, after.most) if there else (after.low, before.most)
    if not large > 0.0:
        return Change(value_dB=math.nan, low_dB=math.nan, high_dB=math.nan, bound="unknown")
    size_dB = 20.0 * (_log10(large) - _log10(small))
    if there:
        return Change(value_dB=-size_dB, low_dB=math.nan, high_dB=-size_dB, bound="at_most")
    return Change(value_dB=size_dB, low_dB=size_dB, high_dB=math.nan, bound="at_least")
