"""What a run is worth: ripple by order on the true tension, against the same run with PI alone."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from benchmarks.control.lockstep import Recording

Array = npt.NDArray[np.float64]
ORDERS = 8
FITTED = 16
NYQUIST_SHARE = 0.8
NOISE_N = 0.25


def order_amplitudes(
    signal: Array, own_rad: Array, other_rad: Array, cycle_s: float, fitted: int = FITTED
) -> Array:
    """Return the peak amplitude of orders 1..8 of one body, (8,), by least squares.

    Order 1 of the other body is fitted beside them unless it keeps within a turn of one of them
    over the record: then nothing can tell the two apart, and all of it counts.
    """
    turn_rad = (own_rad[-1] - own_rad[0]) / (signal.size * cycle_s)
    room = int(NYQUIST_SHARE * math.pi / (max(turn_rad, 1e-6) * cycle_s))
    count = max(1, min(fitted, room))
    time = np.linspace(-1.0, 1.0, signal.size)
    columns = [np.ones_like(time), time]
    for n in range(1, count + 1):
        columns += [np.cos(n * own_rad), np.sin(n * own_rad)]
    slips = [
        abs((n * (own_rad[-1] - own_rad[0])) - (other_rad[-1] - other_rad[0]))
        for n in range(1, count + 1)
    ]
    if min(slips) > math.tau:
        columns += [np.cos(other_rad), np.sin(other_rad)]
    design = np.column_stack(columns)
    solution = np.linalg.lstsq(design, signal, rcond=None)[0]
    pairs = solution[2 : 2 + 2 * count].reshape(-1, 2)
    found = np.zeros(ORDERS)
    used = min(count, ORDERS)
    found[:used] = np.hypot(pairs[:used, 0], pairs[:used, 1])
    return found


def between(record: Recording, start_s: float, end_s: float) -> slice:
    """Return the samples from ``start_s`` to ``end_s``."""
    cycle_s = float(record.time_s[1])
    return slice(round(start_s / cycle_s), round(end_s / cycle_s))


def amplitudes(record: Recording, part: slice, signal: Array | None = None) -> Array:
    """Return amplitudes of unwind orders 1..8 in a part of the record, N."""
    source = record.tension_N if signal is None else signal
    return order_amplitudes(
        source[part], record.unwind_rad[part], record.follower_rad[part], float(record.time_s[1])
    )


def ratio_dB(before: Array, after: Array) -> Array:
    """Return 20 log10(before / after) per entry."""
    return np.asarray(20.0 * np.log10(np.maximum(before, 1e-9) / np.maximum(after, 1e-9)))


def rms(signal: Array) -> float:
    """Return the standard deviation."""
    return float(np.std(signal))


@dataclass(frozen=True, slots=True, kw_only=True)
class Constant:
    """Verdict on one run at constant speed; orders in dB against PI alone, settle in turns."""

    late_dB: Array
    middle_dB: Array
    reference_dB: Array
    settle_20_turns: float
    first_20_turns: float
    ripple_ratio: float
    peak_ratio: float
    plain_N: Array


def turn_times_s(record: Recording, on_s: float) -> Array:
    """Return when each whole roll turn since ``on_s`` ends; entry 0 is ``on_s``."""
    first = round(on_s / float(record.time_s[1]))
    turned = (record.unwind_rad[first:] - record.unwind_rad[first]) / math.tau
    whole = np.arange(0, int(turned[-1]) + 1)
    return np.asarray(np.interp(whole, turned, record.time_s[first:]))


def settle_turns(
    record: Recording, plain: Recording, on_s: float, wanted_dB: float
) -> tuple[float, float]:
    """Return the turns after which 1x-4x stay, and first are, down by ``wanted_dB``.

    Infinite when never.

    Windows of two turns, every half turn, judged over the first thirty turns; a window counts at
    its middle. The PI-only amplitude is that of the whole run: short windows of it beat with the
    S-wrap.
    """
    ends = turn_times_s(record, on_s)
    halves = np.interp(
        np.arange(0.0, min(ends.size - 1, 30) + 0.01, 0.5), np.arange(ends.size), ends
    )
    without = amplitudes(plain, between(plain, on_s, float(plain.time_s[-1])))[:4]
    last_bad, first_good = -1, math.inf
    for i in range(halves.size - 4):
        part = between(record, halves[i], halves[i + 4])
        with_law = amplitudes(record, part)[:4]
        if np.min(ratio_dB(without, with_law)) < wanted_dB:
            last_bad = i
        else:
            first_good = min(first_good, 0.5 * i + 1.0)
    if last_bad == halves.size - 5:
        return math.inf, first_good
    return (0.5 * (last_bad + 1) + 1.0 if last_bad >= 0 else 1.0), first_good


def score_constant(record: Recording, plain: Recording, on_s: float) -> Constant:
    """Return the verdict on a run at constant speed."""
    end_s = float(record.time_s[-1])
    ends = turn_times_s(record, on_s)
    late = between(record, max(on_s + 15.0, end_s - 20.0), end_s)
    if ends.size > 10:
        late = between(record, min(late.start * float(record.time_s[1]), ends[-9]), end_s)
    middle_dB = np.full(ORDERS, math.nan)
    reference_dB = np.full(ORDERS, math.nan)
    if ends.size > 20:
        middle = between(record, ends[10], ends[20])
        before = amplitudes(plain, middle)
        middle_dB = ratio_dB(before, amplitudes(record, middle))
        ten = between(record, ends[0], ends[10])
        samples = ten.stop - ten.start
        reference_dB = ratio_dB(before, np.full(ORDERS, 2.0 * NOISE_N / math.sqrt(samples)))
    before_late = amplitudes(plain, late)
    start = between(record, on_s, min(end_s, float(ends[min(10, ends.size - 1)])))
    mean = float(np.mean(plain.tension_N[start]))
    settled = settle_turns(record, plain, on_s, 20.0)
    return Constant(
        late_dB=ratio_dB(before_late, amplitudes(record, late)),
        middle_dB=middle_dB,
        reference_dB=reference_dB,
        settle_20_turns=settled[0],
        first_20_turns=settled[1],
        ripple_ratio=rms(record.tension_N[late]) / rms(plain.tension_N[late]),
        peak_ratio=float(
            np.max(np.abs(record.tension_N[start] - mean)) / np.max(np.abs(plain.tension_N - mean))
        ),
        plain_N=before_late,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Moving:
    """Verdict on a ramp or a whole roll, in windows of whole turns."""

    mean_dB: Array
    worst_dB: Array
    ripple_ratio: float
    worst_5s: float
    worse_share: float


def score_moving(
    record: Recording, plain: Recording, start_s: float, end_s: float, turns: int
) -> Moving:
    """Return the verdict between two times, in windows of ``turns`` turns.

    Orders in dB: mean over the windows of the root-mean-square amplitudes, and the worst window.
    """
    times = turn_times_s(record, start_s)
    times = times[times <= end_s]
    before, after = [], []
    for i in range(0, times.size - turns, turns):
        part = between(record, float(times[i]), float(times[i + turns]))
        before.append(amplitudes(plain, part))
        after.append(amplitudes(record, part))
    first, second = np.array(before), np.array(after)
    windows = np.arange(start_s, end_s - 5.0 + 1e-9, 5.0)
    ratios = np.array(
        [
            rms(record.tension_N[between(record, t, t + 5.0)])
            / rms(plain.tension_N[between(plain, t, t + 5.0)])
            for t in windows
        ]
    )
    whole = between(record, start_s, end_s)
    return Moving(
        mean_dB=ratio_dB(np.sqrt((first**2).mean(axis=0)), np.sqrt((second**2).mean(axis=0))),
        worst_dB=np.min(ratio_dB(first, second), axis=0),
        ripple_ratio=rms(record.tension_N[whole]) / rms(plain.tension_N[whole]),
        worst_5s=float(ratios.max()),
        worse_share=float((ratios > 1.0).mean()),
    )


def score_transient(
    record: Recording, plain: Recording, event_s: float, back_s: float
) -> dict[str, float]:
    """Return ripple over that of PI alone: before, worst 2 s since the event, at the end.

    ``peak`` is the largest excursion from the mean since the event over that of PI alone;
    ``back_turns`` counts from ``back_s`` to the first window of two turns below a tenth.
    """

    def ratio(start_s: float, end_s: float) -> float:
        part = between(record, start_s, end_s)
        return rms(record.tension_N[part]) / rms(plain.tension_N[part])

    end_s = float(record.time_s[-1])
    since = between(record, event_s, end_s)
    mean = float(np.mean(plain.tension_N[between(plain, event_s - 20.0, event_s)]))
    turns = turn_times_s(record, back_s)
    back = math.inf
    for i in range(turns.size - 2):
        if ratio(float(turns[i]), float(turns[i + 2])) < 0.1:
            back = float(i + 1)
            break
    return {
        "before": ratio(event_s - 20.0, event_s),
        "worst_2s": max(ratio(t, t + 2.0) for t in np.arange(event_s, end_s - 2.0, 1.0)),
        "after": ratio(end_s - 20.0, end_s),
        "peak": float(
            np.max(np.abs(record.tension_N[since] - mean))
            / np.max(np.abs(plain.tension_N[since] - mean))
        ),
        "back_turns": back,
    }
