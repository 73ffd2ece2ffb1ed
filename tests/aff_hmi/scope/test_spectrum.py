"""Tones of a window come back with frequency and amplitude; noise alone, and holes, have none."""

from __future__ import annotations

import numpy as np
import pytest

from aff_hmi.scope.spectrum import MOST_LINES, lines_of
from tests.each_case import each_case

CYCLE_S = 0.005
TIME_S = 100.0 + CYCLE_S * np.arange(1000)  # five seconds: lines 0.2 Hz apart
RNG = np.random.default_rng(3)
NOISE = 0.02 * RNG.standard_normal(len(TIME_S))


def tone(f_Hz: float, size: float) -> np.ndarray:
    return size * np.cos(2.0 * np.pi * f_Hz * TIME_S + 1.0)


@each_case("f_Hz", [1.6, 3.0, 3.07, 12.5, 61.33])
def test_two_tones_on_a_slope_in_noise_are_told_with_their_size(f_Hz: float) -> None:
    """Amplitudes to 2 %, frequencies to a twentieth of a line, wherever they lie between lines."""
    values = 90.0 + 0.5 * TIME_S + tone(f_Hz, 1.2) + tone(30.0, 0.4) + NOISE
    (f1, a1), (f2, a2), *others = lines_of(TIME_S, values, CYCLE_S)
    assert (f1, f2) == (pytest.approx(f_Hz, abs=0.01), pytest.approx(30.0, abs=0.01))
    assert (a1, a2) == (pytest.approx(1.2, rel=0.02), pytest.approx(0.4, rel=0.02))
    assert all(size < 0.01 for _, size in others)


def test_there_are_at_most_so_many_and_the_largest_come_first() -> None:
    values = sum((tone(4.0 * n, 0.1 * n) for n in range(1, 13)), NOISE)
    found = lines_of(TIME_S, values, CYCLE_S)
    assert len(found) == MOST_LINES
    assert [round(f) for f, _ in found] == [4 * n for n in range(12, 4, -1)]


def test_a_few_missing_ticks_are_filled_in_and_many_are_not() -> None:
    few = np.delete(np.arange(len(TIME_S)), [100, 400, 700])
    values = tone(5.0, 1.0)
    ((f, size), *_) = lines_of(TIME_S[few], values[few], CYCLE_S)
    assert (f, size) == (pytest.approx(5.0, abs=0.01), pytest.approx(1.0, rel=0.02))
    many = np.delete(np.arange(len(TIME_S)), np.arange(300, 340))
    assert lines_of(TIME_S[many], values[many], CYCLE_S) == []


@pytest.mark.parametrize("values", [np.full(1000, np.nan), np.full(1000, 7.0), np.zeros(1000)])
def test_what_stands_still_or_is_not_known_has_no_lines(values: np.ndarray) -> None:
    assert lines_of(TIME_S, values, CYCLE_S) == []
    assert lines_of(TIME_S[:10], values[:10], CYCLE_S) == []
