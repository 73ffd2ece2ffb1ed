"""Step 12: off, on, off, on over a simulated line, against the plant's own true tension."""

import math

import numpy as np
import pytest

from aff_runtime.app.card.figures import Verdict
from aff_runtime.app.card.measure import proof
from aff_runtime.app.card.measure.phases import Phase, last_two, offs_and_ons, phases
from aff_runtime.app.report.comparison.comparing import OrderRow
from aff_runtime.app.report.comparison.turns import Change, Estimate, change
from aff_runtime.config.loader import load_site
from sim_plant.base.order_tracking import order_amplitudes
from tests.aff_runtime.app.card.measure.recorded import SITE, evidence, figure, window
from tests.parameter_records import CONFIG

pytestmark = pytest.mark.timeout(300)
SETTLE_S = 12.0
NAME = "pullroll_tension_N, swrap_follower 1x: reduction"


def true_size(truth, phase):
    inside = (truth[:, 0] >= phase.from_s) & (truth[:, 0] < phase.to_s)
    _, tension, angle = truth[inside].T
    return float(abs(order_amplitudes(tension, angle, (1,))[0]))


@pytest.fixture(scope="module")
def whole(abab_run):
    """The window of the run, read once; nobody changes it."""
    return window(abab_run[0], from_s=5.0)


@pytest.fixture(scope="module")
def measured(whole):
    """Its four parts, and what is found."""
    first, *_, last = offs_and_ons(phases(whole), SETTLE_S)
    return (*first, *last), proof.measure(evidence(whole, given=[f"settle={SETTLE_S} s"]))


def test_the_reduction_is_that_of_the_plants_true_tension_within_a_decibel(abab_run, measured):
    four, found = measured
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


def test_the_turns_of_each_off_and_on_are_counted_and_shown(abab_run, measured):
    four, found = measured
    for part, phase in zip(proof.PARTS, four, strict=True):
        time_s, _, angle_rad = abab_run[1].T
        passed_rad = np.ptp(angle_rad[(time_s >= phase.from_s) & (time_s < phase.to_s)])
        turns = figure(found, f"{part}: whole turns of swrap_follower")  # it is the larger one
        assert turns.value == pytest.approx(passed_rad / math.tau - 1.0, abs=1.0)
        assert turns.good


def test_a_proof_of_fewer_than_twenty_turns_is_open_and_says_which_part_is_short(whole):
    found = proof.measure(evidence(whole, given=["settle=22 s"]))
    assert [text.partition(":")[0] for text in found.missing] == ["first on", "second on"]
    assert "20 are needed; make it longer" in found.missing[0]
    assert figure(found, "pullroll_tension_N: all").good
    assert found.verdict is Verdict.OPEN


def test_an_on_settles_at_the_speed_that_runs_and_each_part_has_twenty_whole_turns():
    """A shape: twice its memory of turns; the plain law: three settle times at any speed."""
    shape = load_site(CONFIG / "euclid.yaml")
    turn_s = math.tau * shape.rolls["unwind"].largest_radius_m / 0.8
    assert shape.actuators["unwind"].memory_turns == 9
    assert proof.settling_s(shape, 0.8) == pytest.approx(2.0 * 9 * turn_s)
    assert proof.part_s(shape, 0.8) == pytest.approx(22.0 * turn_s)
    assert proof.settling_s(SITE, 0.8) == proof.settling_s(SITE, 0.4) == 30.0


def test_a_promise_that_is_not_kept_fails(whole):
    given = [f"settle={SETTLE_S} s", "promised=90 dB"]
    found = proof.measure(evidence(whole, given=given))
    assert figure(found, "pullroll_tension_N: all").good is False
    assert found.verdict is Verdict.FAIL


def test_a_proof_in_which_no_order_stands_out_is_open_and_no_pass(whole):
    """Of each on a second is left behind its settling: no order can be told in it."""
    on = min(one.to_s - one.from_s for _, one in offs_and_ons(phases(whole), 20.0)) + 20.0
    found = proof.measure(evidence(whole, given=[f"settle={on - 1.0} s", "promised=3 dB"]))
    assert found.verdict is Verdict.OPEN
    assert found.missing[0].startswith("nothing is proven: no corrected order stands out")


def test_a_record_without_the_second_on_is_open(abab_run):
    found = proof.measure(evidence(window(abab_run[0], to_s=60.0), given=["settle=12 s"]))
    assert found.verdict is Verdict.OPEN
    assert "off, on, off, on is not in the window" in found.missing[0]


def parts(pattern):
    return [Phase(on=on, from_s=100.0 * k, to_s=100.0 * k + 90.0) for k, on in enumerate(pattern)]


def test_each_off_counts_with_the_on_behind_it_once_that_has_settled():
    pairs = offs_and_ons(parts([True, False, True, False, True, False]), 30.0)
    assert [(off.from_s, off.to_s, on.from_s, on.to_s) for off, on in pairs] == [
        (100.0, 190.0, 230.0, 290.0),
        (300.0, 390.0, 430.0, 490.0),
    ]
    assert offs_and_ons(parts([False, True]), 95.0) == []


def test_a_pair_that_a_fault_cut_short_is_left_out_and_the_one_made_again_counts(
    abab_run, measured
):
    """By formula there are three: 4 s of the second's on are left once it has settled."""
    made = offs_and_ons(phases(window(abab_run[0], from_s=5.0)), SETTLE_S)
    left_out = [
        text for text in measured[1].remarks if text.startswith("left out, fewer than 20 ")
    ]
    assert len(left_out) == len(made) - 2
    assert all(text.endswith(", 4 s") for text in left_out)
    assert measured[1].verdict is Verdict.PASS


def test_the_last_two_whole_ones_count_and_without_them_the_last_two():
    def of(*pairs):
        return last_two(reversed(pairs), str.isupper)

    assert of("A", "B", "C") == (["B", "C"], [])
    assert of("A", "B", "c", "D", "e") == (["B", "D"], ["c", "e"])
    assert of("A", "b", "c") == (["b", "c"], [])


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
    bound = Change(value_dB=-30.0, low_dB=math.nan, high_dB=-30.0, bound="at_most")
    none = Change(value_dB=math.nan, low_dB=math.nan, high_dB=math.nan, bound="none")
    found = proof.reduction([some, bound])
    assert (found.value_dB, found.bound) == (19.0, "at_least")
    assert proof.reduction([some, none]).bound == "none"


def test_an_order_that_rises_out_of_the_noise_whenever_on_is_a_rise():
    def rises(low):
        return Change(value_dB=20.0, low_dB=low, high_dB=math.nan, bound="at_least")

    found = proof.reduction([rises(15.0), rises(3.0)])
    assert (found.value_dB, found.high_dB, found.bound) == (-20.0, -3.0, "at_most")
    assert proof.reduction_figure(("T", "unwind", 1), [rises(15.0)], 0.1).good is False
    assert proof.reduction([rises(15.0), rises(-1.0)]).bound == "none"


def size(amplitude, half=0.0, floor=0.01):
    low, high = amplitude - half, amplitude + half
    return Estimate(amplitude=amplitude, low=low, high=high, floor=floor, turns=50)


def row(order, before, after, signal="T"):
    return OrderRow(
        signal=signal,
        roll="unwind",
        order=order,
        frequency_Hz=(1.0, 1.0),
        before=before,
        after=after,
        change=change(before, after),
        labels=(),
    )


@pytest.mark.parametrize(("rise_N", "good"), [(0.09, True), (0.11, False)])
def test_an_order_that_rises_by_less_than_a_fiftieth_of_all_orders_when_off_fails_nothing(
    rise_N, good
):
    """5 N in all when off: 0.1 N is a fiftieth; the interval alone says of both that they rose."""
    rows = {
        ("T", "unwind", 1): row(1, size(3.0), size(0.3)),
        ("T", "unwind", 2): row(2, size(4.0), size(0.4)),
        ("T", "unwind", 16): row(16, size(0.03, 0.002), size(0.03 + rise_N, 0.002)),
        ("U", "unwind", 1): row(1, size(0.1), size(0.01), signal="U"),
    }
    key = ("T", "unwind", 16)
    share = proof.rise_shares(rows)[key]
    assert share == pytest.approx(rise_N / 5.0, rel=1e-3)
    found = proof.reduction_figure(key, [rows[key].change], share)
    assert found.high < 0.0
    assert found.good is good
    assert "2 % of all" in found.limit


def test_orders_together_are_the_root_of_the_sum_of_their_squares():
    total, half = proof.root_sum([size(3.0, 0.3), size(4.0, 0.1)], 1.0)
    assert total == pytest.approx(5.0)
    assert half == pytest.approx(math.hypot(3.0 * 0.3, 4.0 * 0.1) / 5.0)


def test_what_is_in_the_noise_counts_for_nothing_when_off_and_for_its_most_when_on():
    noise = size(0.001, floor=0.2)
    assert proof.root_sum([noise], 0.0)[0] == 0.0
    assert proof.root_sum([noise], 1.0)[0] == pytest.approx(0.2)
    assert proof.root_sum([size(0.1, 0.15, floor=0.2)], 1.0)[0] == pytest.approx(0.25)


@pytest.mark.parametrize(("promised_dB", "good"), [(15.0, True), (25.0, None), (35.0, False)])
def test_a_promise_that_the_noise_hides_is_undecided_and_one_that_it_cannot_hide_fails(
    promised_dB, good
):
    """5 N when off; when on 0.1 N is seen, 0.4 N may be there: 34 dB at best, 21.7 at least."""
    seen, hidden = row(1, size(4.0), size(0.1)), row(2, size(3.0), size(0.1, floor=0.4))
    pairs = [[seen, hidden]] * 2
    change = proof.reduction([proof._together(one) for one in pairs])
    assert change.value_dB == pytest.approx(20.0 * math.log10(5.0 / math.hypot(0.1, 0.4)))
    assert proof._is_kept(change, pairs, promised_dB) is good
