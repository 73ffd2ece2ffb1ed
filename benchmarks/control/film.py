"""The film line's rows: every order below 60 Hz that shows, at constant speed and in ramps."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from benchmarks.control import cases
from benchmarks.control.lockstep import Recording
from benchmarks.control.scores import NOISE_N, between, rms, turn_times_s

Array = npt.NDArray[np.float64]
TO_HZ = 60.0
FITTED_TO_HZ = 100.0
RUN_S, LATE_S = 45.0, 15.0
WINDOW_TURNS = 8


def profile(case: cases.Case) -> Array:
    """Return the line speed per sample, m/s."""
    if "ramp" in case.note:
        return cases.film_ramp(case)
    return np.full(round(RUN_S / case.cycle_s), case.speed_m_s)


def judge(case: cases.Case, record: Recording, plain: Recording) -> dict[str, Any]:
    """Return attenuation per order and total ripple; in ramps of the first and of the second."""
    if "ramp" in case.note:
        parts = [_moving(record, plain, *ramp) for ramp in cases.RAMPS_S]
    else:
        end_s = float(record.time_s[-1])
        parts = [_moving(record, plain, end_s - LATE_S, end_s)]
    return {
        "orders_dB": [part[0] for part in parts],
        "worst_dB": [min(part[0]) for part in parts],
        "ripple": [part[1] for part in parts],
        "largest_m_s": float(np.abs(record.correction_m_s).max()),
    }


def _moving(
    record: Recording, plain: Recording, start_s: float, end_s: float
) -> tuple[list[float], float]:
    """Return dB per order over windows of whole turns, and the ratio of the ripples.

    An order counts in the windows where it has less than 60 Hz, by its mean square.
    """
    times = turn_times_s(record, start_s)
    times = times[times <= end_s]
    squares: dict[int, list[tuple[float, float]]] = {}
    for i in range(0, times.size - WINDOW_TURNS, WINDOW_TURNS):
        part = between(record, float(times[i]), float(times[i + WINDOW_TURNS]))
        turn_Hz = WINDOW_TURNS / float(times[i + WINDOW_TURNS] - times[i])
        fitted = int(FITTED_TO_HZ / turn_Hz)
        before, after = (_amplitudes(run, part, fitted) for run in (plain, record))
        for n in range(1, math.ceil(TO_HZ / turn_Hz)):
            squares.setdefault(n, []).append((before[n - 1] ** 2, after[n - 1] ** 2))
    sizes = {n: np.sqrt(np.mean(found, axis=0)) for n, found in squares.items()}
    shows = 3.0 * NOISE_N * math.sqrt(2.0 / ((end_s - start_s) / float(record.time_s[1])))
    found = [20.0 * math.log10(b / max(a, 1e-9)) for b, a in sizes.values() if b > shows]
    whole = between(record, start_s, end_s)
    return found, rms(record.tension_N[whole]) / rms(plain.tension_N[whole])


def _amplitudes(record: Recording, part: slice, count: int) -> Array:
    """Return the peak amplitude of the unwind's orders, beside order 1 of the follower."""
    own, other = record.unwind_rad[part], record.follower_rad[part]
    time = np.linspace(-1.0, 1.0, own.size)
    columns = [np.ones_like(time), time, np.cos(other), np.sin(other)]
    for n in range(1, count + 1):
        columns += [np.cos(n * own), np.sin(n * own)]
    solution = np.linalg.lstsq(np.column_stack(columns), record.tension_N[part], rcond=None)[0]
    return np.asarray(np.hypot(solution[4::2], solution[5::2]))
