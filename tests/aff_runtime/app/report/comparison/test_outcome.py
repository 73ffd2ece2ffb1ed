"""What a comparison comes to: which orders are told, by estimates from hand."""

import math

import numpy as np
import pytest

from aff_runtime.app.report.comparison.comparing import Comparison, OrderRow
from aff_runtime.app.report.comparison.outcome import direction, outcome
from aff_runtime.app.report.comparison.steady_parts import longest_parts, steady_parts
from aff_runtime.app.report.comparison.turns import Estimate, change
from tests.aff_runtime.app.report.watching.test_stretches import SPEED, between, table


def size(amplitude, half, floor=0.05):
    return Estimate(
        amplitude=amplitude, low=amplitude - half, high=amplitude + half, floor=floor, turns=30
    )


def order_row(before, after, order=1, signal="web_tension_N"):
    return OrderRow(
        signal=signal,
        roll="r2",
        order=order,
        frequency_Hz=(3.0, 3.0),
        before=before,
        after=after,
        change=change(before, after),
        labels=(),
    )


def said(*rows, labels=()):
    return list(
        outcome(Comparison(line="L", windows=(), rows=rows, differences=(), labels=labels))
    )


@pytest.mark.parametrize(
    ("before", "after", "way"),
    [
        (size(1.2, 0.1), size(0.2, 0.05), -1),
        (size(0.2, 0.05), size(1.2, 0.1), 1),
        (size(0.3, 0.2), size(0.25, 0.2), 0),  # the intervals are wider than the change
        (size(1.2, 0.1), size(0.01, 0.01), -1),  # into the noise, from clear of it
        (size(0.06, 0.03), size(0.01, 0.01), 0),  # into the noise, from the edge of it
        (size(0.01, 0.01), size(1.2, 0.1), 1),
        (size(0.01, 0.01), size(0.06, 0.03), 0),
        (size(0.01, 0.01), size(0.02, 0.01), 0),  # both in the noise
        (size(1.2, 0.1), size(0.2, 0.05, floor=math.nan), 0),  # too few turns
    ],
)
def test_an_order_moved_only_where_its_interval_says_so(before, after, way):
    assert direction(order_row(before, after)) == way


def test_an_order_is_told_once_in_the_tension_in_which_it_changed_most():
    lines = said(
        order_row(size(0.6, 0.05), size(0.1, 0.02), signal="far_tension_N"),
        order_row(size(1.2, 0.1), size(0.2, 0.05)),
        order_row(size(0.3, 0.2), size(0.25, 0.2), order=2),
        labels=("another speed",),
    )
    assert lines[0].startswith("fell: r2 1x in web_tension_N from 1.2 to 0.2 N, -15.6 dB (")
    assert lines[0].endswith("; in 1 more of the tensions too")
    assert lines[1] == "grew: no order beyond its interval"
    assert lines[2].startswith("of 2 orders 1 did not change")
    assert lines[3].startswith("read with care")


def test_of_many_orders_the_largest_changes_are_named_and_the_rest_counted():
    lines = said(*(order_row(size(1.0 + k, 0.1), size(0.2, 0.05), order=k) for k in range(1, 8)))
    assert [line.split(" in ")[0] for line in lines[:2]] == ["fell: r2 7x", "fell: r2 6x"]
    assert lines[5] == "fell: 2 more orders, by less"


def test_parts_end_where_speed_or_output_changes_and_at_a_probe():
    columns = {
        SPEED: between(0.0, 60.0, 1.0, otherwise=0.7),
        "correction_unwind_m_s": between(100.0, 200.0, 0.01),
    }
    found = steady_parts(table(**columns), SPEED)
    assert [str(part) for part in found] == [
        "1000.0..1060.0 (1 m/s, AFF off)",
        "1060.0..1100.0 (0.7 m/s, AFF off)",
        "1100.0..1200.0 (0.7 m/s, AFF on)",
    ]
    assert "1060.0..1100.0 (0.7" in longest_parts(table(**columns), SPEED)[0]
    assert longest_parts(table(), SPEED) == []
    assert longest_parts(table(), "no_such_m_s") == []
    assert np.isclose(sum(part.bins for part in found), 200)
