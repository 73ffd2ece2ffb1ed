"""Where counts start over, from formulas: ranges near the whole word, fast ones, pauses, lags."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass

import pytest

from aff_runtime.app.setup.words.angles import AngleCandidate, angle_candidates, doubt
from aff_runtime.app.setup.words.behaviour import behaviour
from aff_runtime.app.setup.words.reading import Watched
from tests.each_case import each_case

RADIUS_M = 0.1
WORD = 1 << 16


@dataclass(frozen=True, kw_only=True)
class Encoder:
    """Counts of a roll: ``whole`` of them from ``lowest`` on, then it starts over."""

    counts: int
    whole: int
    turns_per_s: float
    lowest: int = 0
    start: float = 5.0

    def words(self, times_s: list[float]) -> tuple[int, ...]:
        rate = self.counts * self.turns_per_s
        came = (math.floor(self.start + rate * t_s) % self.whole for t_s in times_s)
        return tuple((self.lowest + one) % WORD for one in came)

    def found(
        self, times_s: list[float], read_s: list[float] | None = None
    ) -> list[AngleCandidate]:
        """Return the candidates; ``read_s`` are the times at which it was noted."""
        noted_s = read_s or times_s
        seen = Watched(
            times_s=tuple(noted_s), words={3: self.words(times_s), 4: (7,) * len(times_s)}
        )
        web_m_s = abs(self.turns_per_s) * math.tau * RADIUS_M
        return angle_candidates(seen, speeds_m_s=[web_m_s] * len(times_s), radius_m=RADIUS_M)

    def said(self, best: AngleCandidate) -> bool:
        """Return whether a candidate says what this encoder is."""
        ends = 0 if self.whole == WORD else self.whole
        is_read = not ends or best.decoding.type == ("i16" if self.lowest else "u16")
        size = math.copysign(self.counts, self.turns_per_s)
        return is_read and (best.counts_per_turn, best.wraps_after) == (size, ends)


def every(period_s: float, seconds: float, pause_s: float = 0.0, at_s: float = 2.0) -> list[float]:
    times_s = (n * period_s for n in range(round(seconds / period_s)))
    return [t_s for t_s in times_s if not at_s < t_s < at_s + pause_s]


@each_case(
    ("counts", "whole", "lowest", "turns_per_s", "pause_s", "seconds"),
    [
        (4096, 4096, 0, 1.25, 0.0, 5.0),  # 40 readings a turn, the highest is 3998
        (8192, 8192, 0, 1.25, 0.0, 5.0),
        (1024, 1024, 0, 1.25, 0.0, 5.0),
        (65536, WORD, 0, 1.0, 0.3, 5.0),  # more than a quarter of the word in one pause
        (65536, WORD, 0, 0.7, 0.9, 6.0),  # more than half of it
        (16384, WORD, 0, 3.5, 0.3, 5.0),
        (36000, 36000, -18000, 0.5, 0.1, 8.0),
        (36000, 36000, -18000, 0.5, 0.3, 8.0),
        (3600, 3600, -1800, 0.8, 0.3, 8.0),
        (1000, 50000, 0, 6.0, 0.0, 12.0),  # little short of the word: a small jump on
        (28800, 57600, 0, 1.6, 0.0, 4.0),
        (16000, 64000, 0, 1.6, 0.0, 4.0),
        (16000, 64000, -32000, -1.6, 0.0, 5.0),
        (3600, 54000, 0, 5.0, 0.0, 5.0),
        (3600, 64800, 0, 5.0, 0.0, 5.0),
        (32768, 32768, 0, 4.8, 0.0, 3.0),  # ten readings a turn
    ],
)
def test_a_count_is_found_with_its_end(
    counts: int, whole: int, lowest: int, turns_per_s: float, pause_s: float, seconds: float
) -> None:
    encoder = Encoder(counts=counts, whole=whole, lowest=lowest, turns_per_s=turns_per_s)
    rate_per_s = counts * abs(turns_per_s)
    end_s = (math.ceil(2.0 * rate_per_s / whole) * whole - encoder.start) / rate_per_s
    for begin_s in (end_s - pause_s / 2, 1.4):  # over its end, and elsewhere
        rows = encoder.found(every(0.02, seconds, pause_s, begin_s))
        assert rows[0].usable
        assert doubt(rows) == ""
        assert encoder.said(rows[0])


def drawn(seed: int) -> tuple[Encoder, list[float]]:
    """Return an encoder of any kind that shows its end, and uneven times with a pause."""
    draw = random.Random(seed)
    counts = draw.choice([1000, 1024, 2500, 3600, 4000, 4096, 8192, 14400, 16384, 36000, 65536])
    most = WORD // counts
    turns = draw.choice([1, draw.randint(1, most), most])
    period_s = draw.uniform(0.005, 0.05)
    fastest = min(4.0, turns / (10.0 * period_s))
    turns_per_s = draw.choice([-1, 1]) * draw.uniform(min(max(0.5, turns / 8), fastest), fastest)
    seconds = max(3.1, 1.3 * turns) / abs(turns_per_s)
    encoder = Encoder(
        counts=counts,
        whole=counts * turns,
        lowest=draw.choice([0, -(counts * turns // 2)]),
        turns_per_s=turns_per_s,
        start=draw.uniform(0, counts * turns),
    )
    even_s = every(period_s, seconds, draw.uniform(0.0, 0.3), draw.uniform(0.0, seconds))
    return encoder, [t_s + draw.uniform(-0.1, 0.1) * period_s for t_s in even_s]


def test_whatever_is_sure_is_right_and_most_are_sure() -> None:
    sure = 0
    for seed in range(20):
        encoder, times_s = drawn(seed)
        rows = encoder.found(times_s)
        if rows and rows[0].usable and not doubt(rows):
            sure += 1
            assert encoder.said(rows[0]), seed
    assert sure >= 18


def test_a_signed_word_that_went_through_zero_has_not_shown_its_end() -> None:
    encoder = Encoder(counts=600, whole=10200, lowest=-5100, turns_per_s=2.0)
    early, late = every(0.02, 6.0), every(0.02, 9.0)
    assert behaviour(early, encoder.words(early)).wrap.seen == 0
    assert "wraps at 65536" not in encoder.found(early)[0].why
    assert behaviour(late, encoder.words(late)).wrap.seen == 1
    assert encoder.said(encoder.found(late)[0])


@pytest.mark.parametrize(("seconds", "seen"), [(12.0, False), (20.5, True)])
def test_a_word_is_not_sure_before_its_end_was_seen(seconds: float, seen: bool) -> None:
    """65536 counts at 0.8 turns of 4096 a second take 20 s: in 12 s it may be one word or two."""
    encoder = Encoder(counts=4096, whole=WORD, turns_per_s=0.8, start=100.0)
    rows = encoder.found(every(0.02, seconds))
    assert encoder.said(rows[0])
    why = "its end was not seen in 12 s"
    assert (why in rows[0].why) is (why in doubt(rows)) is not seen


def test_readings_too_uneven_to_tell_two_ends_apart_leave_it_open() -> None:
    encoder = Encoder(counts=3600, whole=64800, turns_per_s=5.0)
    noted_s = every(0.05, 9.0)
    draw = random.Random(1)
    rows = encoder.found([t_s - draw.uniform(0.0, 0.045) for t_s in noted_s], noted_s)
    assert {one.wraps_after for one in rows if one.counts_per_turn == 3600} == {0, 64800}
    assert doubt(rows).startswith("another")


def test_a_count_that_is_set_back_now_and_then_is_no_ramp() -> None:
    times_s = every(0.02, 6.0)
    words = [math.floor(1500 * t_s) - 3000 * (t_s > 3.0) - 900 * (t_s > 4.0) for t_s in times_s]
    assert behaviour(times_s, words).rate_per_s == 0.0
