"""Step 12: off, on, off, on over a simulated line, against the plant's own true tension."""

import math

import pytest

from aff_runtime.app.card.figures import Verdict
from aff_runtime.app.card.measure import proof
from aff_runtime.app.card.measure.phases import Phase, phases
from aff_runtime.app.report.comparison.turns import Change, Estimate
from sim_plant.base.order_tracking import order_amplitudes
from tests.aff_runtime.app.card.measure.recorded import evidence, figure, window

pytestmark = pytest.mark.timeout(300)
SETTLE_S = 12.0
NAME = "pullroll_tension_N, swrap_follower 1x: reduction"


def true_size(truth, phase):
    inside = (truth[:, 0] >= phase.from_s) & (truth[:, 0] < phase.to_s)
    _, tension, angle = truth[inside].T
    return float(abs(order_amplitudes(tension, angle, (1,))[0]))


def test_the_reduction_is_that_of_the_plants_true_tension_within_a_decibel(abab_run):
    whole = window(abab_run[0], from_s=5.0)
    found = proof.measure(evidence(whole, given=[f"settle={SETTLE_S} s"]))
    four = proof.abab(phases(whole), SETTLE_S)
    assert [phase.on for phase in four] == [False, True, False, True]
    sizes = [true_size(abab_run[1], phase) for phase in four]
    true_dB = 10.0 * math.log10(sizes[0] * sizes[2] / sizes[1] / sizes[3])
    order = figure(found, NAME)
    assert order.value == pytest.approx(true_dB, abs=1.0)
    assert order.low - 0.5 <= true_dB <= order.high + 0.5
    assert order.value > 5.0
    together = figure(found, "pullroll_tension_N: all")
    assert together.value == pytest.approx(order.value, abs=0.2)  # it is the only one there
    assert figure(found, "line speed").value < 1.0
    assert found.verdict is Verdict.PASS


def test_a_promise_that_is_not_kept_fails(abab_run):
    whole = window(abab_run[0], from_s=5.0)
    given = [f"settle={SETTLE_S} s", "promised=90 dB"]
    found = proof.measure(evidence(whole, given=given))
    assert figure(found, "pullroll_tension_N: all").good is False
    assert found.verdict is Verdict.FAIL


def test_a_proof_in_which_no_order_stands_out_is_open_and_no_pass(abab_run):
    """Of each on a second is left behind its settling: no order can be told in it."""
    whole = window(abab_run[0], from_s=5.0)
    on = min(one.to_s - one.from_s for one in phases(whole) if one.on)
    found = proof.measure(evidence(whole, given=[f"settle={on - 1.0} s", "promised=3 dB"]))
    assert found.verdict is Verdict.OPEN
    assert found.missing[0].startswith("nothing is proven: no corrected order stands out")


def test_a_record_without_the_second_on_is_open(abab_run):
    found = proof.measure(evidence(window(abab_run[0], to_s=60.0), given=["settle=12 s"]))
    assert found.verdict is Verdict.OPEN
    assert "off, on, off, on is not in the window" in found.missing[0]


def parts(pattern):
    return [Phase(on=on, from_s=100.0 * k, to_s=100.0 * k + 90.0) for k, on in enumerate(pattern)]


def test_the_last_four_count_and_each_on_settles_first():
    four = proof.abab(parts([False, True, False, True, False, True]), 30.0)
    assert [(p.from_s, p.to_s) for p in four] == [
        (200.0, 290.0),
        (330.0, 390.0),
        (400.0, 490.0),
        (530.0, 590.0),
    ]
    assert proof.abab(parts([False, True, False]), 30.0) == []
    assert proof.abab(parts([False, True, False, True]), 95.0) == []


def test_two_changes_are_one_reduction_with_both_their_spreads():
    def of(value, half):
        return Change(value_dB=-value, low_dB=-value - half, high_dB=-value + half, bound="")

    near = proof.reduction([of(20.0, 3.0), of(21.0, 4.0)])
    assert near.value_dB == pytest.approx(20.5)
    assert near.high_dB - near.value_dB == pytest.approx(2.5)  # hypot(3, 4) / 2
    apart = proof.reduction([of(10.0, 1.0), of(20.0, 1.0)])
    assert apart.high_dB - apart.value_dB == pytest.approx(5.0)


def test_what_is_in_the_noise_is_a_bound_or_nothing():
    some = Change(value_dB=-20.0, low_dB=-21.0, high_dB=-19.0, bound="")
    bound = Change(value_dB=-30.0, low_dB=math.nan, high_dB=math.nan, bound="at_most")
    none = Change(value_dB=math.nan, low_dB=math.nan, high_dB=math.nan, bound="none")
    found = proof.reduction([some, bound])
    assert (found.value_dB, found.bound) == (20.0, "at_least")
    assert proof.reduction([some, none]).bound == "none"


def size(amplitude, half=0.0, floor=0.01):
    low, high = amplitude - half, amplitude + half
    return Estimate(amplitude=amplitude, low=low, high=high, floor=floor, turns=50)


def test_orders_together_are_the_root_of_the_sum_of_their_squares():
    total, half = proof.root_sum([size(3.0, 0.3), size(4.0, 0.1)], 1.0)
    assert total == pytest.approx(5.0)
    assert half == pytest.approx(math.hypot(3.0 * 0.3, 4.0 * 0.1) / 5.0)


def test_what_is_in_the_noise_counts_for_nothing_when_off_and_for_its_floor_when_on():
    noise = size(0.001, floor=0.2)
    assert proof.root_sum([noise], 0.0)[0] == 0.0
    assert proof.root_sum([noise], 1.0)[0] == pytest.approx(0.2)
