"""Lives of rollers and rolls of web by rank, against what was put into the store."""

import math
from datetime import UTC, datetime

import numpy as np
import pytest

from aff_runtime.app.report.watching import sentences
from aff_runtime.app.report.watching.lives import lives
from aff_runtime.app.report.watching.store import Store
from aff_runtime.app.report.watching.wound_rolls import rankings
from tests.aff_runtime.app.report.watching.made_store import (
    BEGAN,
    DAY,
    HOUR_M,
    RADIUS_M,
    ROLLS,
    made_store,
)

EXCHANGED = 20


def test_a_roller_without_an_exchange_has_one_life_with_all_the_web():
    (life,) = lives(made_store(30))
    assert (life.roll, life.number, life.since, life.until) == ("r6", 1, None, None)
    assert life.web_km == pytest.approx(30 * HOUR_M / 1e3)
    assert life.running_h == pytest.approx(30.0)
    assert life.turns == pytest.approx(30 * HOUR_M / (2.0 * math.pi * RADIUS_M))


def test_an_exchange_ends_one_life_and_begins_the_next_with_what_was_said():
    store = made_store(30)
    on = BEGAN + EXCHANGED * DAY
    store.exchange("r6", on.astype(datetime).replace(tzinfo=UTC), "serial 4711")
    first, second = lives(store)
    assert (first.until, second.since, second.until) == (on, on, None)
    assert (first.why, second.why) == ("", "serial 4711")
    assert first.web_km == pytest.approx(EXCHANGED * HOUR_M / 1e3)
    assert second.web_km == pytest.approx((30 - EXCHANGED) * HOUR_M / 1e3)
    assert first.turns + second.turns == pytest.approx(lives(made_store(30))[0].turns)


def test_web_that_stood_counts_no_running_hour():
    store = made_store(4)
    store.hours["length_m"][1] = 0.0
    (life,) = lives(store)
    assert life.running_h == pytest.approx(3.0)


def test_rolls_are_ranked_by_how_far_they_are_from_round_each_by_its_worst_order():
    (ranking,) = rankings(made_store(30))
    assert (ranking.roll, ranking.by.name) == ("unwind", "shape_m")
    assert [one.roll_id for one in ranking.rolls] == [42, 41, 43]
    worst = ranking.rolls[0].worst["shape_m"]
    assert (worst.order, worst.size) == (1, pytest.approx(ROLLS[42]))
    assert worst.error == pytest.approx(1e-5 / math.sqrt(10.0))  # ten days, each with its own
    assert ranking.rolls[0].hours == 10
    assert ranking.rolls[0].left.size == pytest.approx(0.2)


def test_rolls_whose_shape_nobody_learned_are_ranked_by_what_most_of_them_have():
    store = made_store(30)
    rolls = store.orders["is_roll"]
    store.orders["shape_m"][rolls] = np.nan
    store.orders["correcting"][rolls] = False
    ripple = store.orders["ripple_N"]
    ripple[rolls & (store.orders["roll_id"] == 43)] = 3.0
    (ranking,) = rankings(store)
    assert ranking.by.name == "ripple_N"
    assert ranking.rolls[0].roll_id == 43


def test_the_ranking_is_told_a_roll_a_line_with_order_interval_and_day():
    head, *told = sentences.rolls(rankings(made_store(30)))
    assert head == "rolls at unwind, the farthest from round first, by their shape:"
    assert told == [
        "  1. roll 42: 5000 um (+- 6.2) at 1x, 10 hours from 2026-01-15 on",
        "  2. roll 41: 2000 um (+- 6.2) at 1x, 10 hours from 2026-01-05 on",
        "  3. roll 43: 1000 um (+- 6.2) at 1x, 10 hours from 2026-01-25 on",
    ]


def test_one_roll_alone_is_not_ranked():
    assert list(sentences.rolls(rankings(made_store(5)))) == []


def test_an_empty_store_has_neither():
    assert lives(Store()) == []
    assert rankings(Store()) == []
