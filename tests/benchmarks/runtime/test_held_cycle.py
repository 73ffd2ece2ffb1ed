"""What counts as a late tick, and what a ratio says of its target."""

import pytest

from benchmarks.runtime.hold import Keeper, late_ticks, section
from benchmarks.runtime.shape_tick import ratio_row
from benchmarks.runtime.whole_tick import CONNECT_TICKS


def test_a_tick_is_late_that_ends_after_the_next_grid_point():
    assert late_ticks([30.0, 700.0, 1200.0, 0.0], [900.0, 301.0, 50.0, 1000.0], 1000.0) == 2


def record(tick, *, missed, wake=20.0, whole=300.0):
    """A record as the cycle publishes it: what is not asked for is 0."""
    return (0.0, float(tick), 1.0, *(0.0,) * 10, 5.0, wake, 90.0, whole, float(missed))


def test_ticks_count_once_the_wire_is_warm():
    keeper = Keeper(seconds=1.0)
    for tick, missed in (
        (1, 0),
        (CONNECT_TICKS, 7),
        (CONNECT_TICKS + 1, 7),
        (CONNECT_TICKS + 3, 9),
    ):
        keeper.publish(record(tick, missed=missed, wake=tick))
    assert keeper.wake_us.tolist() == [CONNECT_TICKS + 1, CONNECT_TICKS + 3]
    assert keeper.tick_us.tolist() == [300.0, 300.0]
    assert keeper.skipped == 2


@pytest.mark.parametrize(("share", "verdict"), [(0.001, "held"), (0.0011, "missed")])
def test_the_table_says_whether_a_thousandth_was_held(share, verdict):
    found = {"share": share, "late": 1, "skipped": 0, "due": 1000, "good": 999, "active": 998}
    rows = section({**found, "refused": [], "wake_us": [1.0], "tick_us": [2.0]}, 10.0).rows
    assert rows[0].remark.endswith(verdict)
    assert rows[1].value == "1 ended late, 0 skipped, of 1000"


@pytest.mark.parametrize(("ours", "verdict"), [(160.0, "held"), (161.0, "missed")])
def test_a_ratio_stands_beside_its_target(ours, verdict):
    row = ratio_row("ratio p50", ours, 100.0, 1.6)
    assert (row.value, row.remark) == (f"{ours / 100.0:.2f}", f"target at most 1.6: {verdict}")
