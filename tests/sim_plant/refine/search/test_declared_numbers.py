"""Effects that are declared numbers: claimed by their tolerances and by what records show."""

from dataclasses import replace

import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.search.selection import AcceptedEffect, later_score, least_score
from tests.each_case import each_case
from tests.sim_plant.refine.search.claims import (
    COST,
    DRAG,
    FAR_DRAG,
    MODULUS,
    claimed,
    found_first,
    rival,
    selection,
)
from tests.sim_plant.refine.small import fit_of


@each_case(
    ("worth", "chi2_by_records", "beyond", "taken"),
    [
        (54.0, 1500.0, True, True),  # 8 standard deviations of its tolerance, less the price
        (15.0, 1500.0, True, False),  # less than four
        (54.0, 350.0, True, False),  # as much as models have wrong
        (54.0, 1500.0, False, False),  # its interval reaches into its tolerance
        (130.0, 0.0, False, True),
    ],
)
def test_a_first_effect_that_is_a_declared_number_beyond_its_tolerance_needs_no_120(
    worth, chi2_by_records, beyond, taken
):
    modulus = rival(MODULUS, worth, chi2_by_records, beyond_tolerance=beyond)
    assert (claimed([modulus], {MODULUS.key: worth}) is not None) is taken


def test_what_is_no_claim_hides_no_declared_number_beyond_its_tolerance():
    """Healthy records reach 85 to 115 in one effect or another; 8 standard deviations gain 54."""
    rivals = [
        rival(DRAG, 100.0),
        rival(FAR_DRAG, 56.0),
        rival(MODULUS, 54.0, 1500.0, beyond_tolerance=True),
    ]
    missed = {DRAG.key: 100.0, FAR_DRAG.key: 56.0, MODULUS.key: 54.0}
    found = claimed(rivals, missed).accepted
    assert (found.hypothesis.key, found.ambiguous) == (MODULUS.key, ())
    assert found.runner_up is None
    claim = [rival(DRAG, 160.0), *rivals[1:]]
    assert claimed(claim, missed | {DRAG.key: 160.0}).accepted.hypothesis.key == DRAG.key
    assert claimed(rivals[:2], missed) is None


def test_two_declared_numbers_of_which_one_is_beyond_its_tolerance_are_both_named():
    """Below 150 others alike make no claim: here the records show that it is one of these."""
    radius = hypothesis(BY_NAME["radius_error"], "unwind")
    rivals = [
        rival(h, worth, 900.0, beyond_tolerance=True)
        for h, worth in ((radius, 90.0), (MODULUS, 84.0))
    ]
    found = claimed(rivals, {radius.key: 90.0, MODULUS.key: 84.0}).accepted
    assert (found.hypothesis.key, found.ambiguous) == (radius.key, (MODULUS.key,))


def test_beside_a_declared_number_which_does_more_than_it_gains_a_later_effect_needs_all():
    there = AcceptedEffect(
        hypothesis=MODULUS, score=150.0, runner_up=None, margin=150.0, rejected=()
    )
    assert later_score(selection(nominal=COST + 150.0, accepted=(there,))) == pytest.approx(400.0)
    assert later_score(selection()) == pytest.approx(120.0)


@pytest.mark.parametrize(
    ("chi2_by_records", "taken"), [(0.0, False), (350.0, False), (5000.0, True)]
)
def test_a_later_effect_that_is_a_declared_number_counts_by_what_the_record_says(
    chi2_by_records, taken
):
    """13 prior standard deviations gain 170; what a right effect leaves imitates up to 330."""
    found = found_first("torque_ripple", "unwind")
    said = claimed([rival(MODULUS, 170.0, chi2_by_records)], {MODULUS.key: 170.0}, found)
    assert (said is not None) is taken


@pytest.mark.parametrize(
    ("worth", "chi2_by_records", "taken"),
    [(170.0, 5000.0, True), (170.0, 2900.0, False), (110.0, 5000.0, False)],
)
def test_beside_a_strong_effect_a_declared_number_counts_by_what_the_record_says(
    worth, chi2_by_records, taken
):
    """0.1 % of 3e6 are 3000, of what records show: a gain is 13 tolerances squared at most."""
    found = found_first("slip", "swrap")
    found = replace(found, nominal=replace(found.nominal, cost=COST + 3e6), wander_is_free=True)
    missed = {DRAG.key: 900.0, MODULUS.key: worth}
    rivals = [rival(DRAG, 900.0), rival(MODULUS, worth, chi2_by_records)]
    said = claimed(rivals, missed, found)
    assert (said is not None) is taken
    if taken:  # what is no claim neither hides it nor is its rival
        assert (said.accepted.hypothesis.key, said.accepted.ambiguous) == (MODULUS.key, ())
        claim = [rival(DRAG, 3500.0), rivals[1]]
        first = claimed(claim, missed | {DRAG.key: 3500.0}, found)
        assert first.accepted.hypothesis.key == DRAG.key


@pytest.mark.parametrize(("chi2_by_records", "taken"), [(900.0, False), (5000.0, True)])
def test_a_later_effect_that_settles_what_no_tolerance_is_is_named_with_all_that_would(
    chi2_by_records, taken
):
    """Which of the numbers that stood in for one is off, no tolerance tells."""
    found = found_first("torque_ripple", "unwind")
    found = replace(found, nominal=replace(found.nominal, cost=COST + 1e6))  # 0.1 % are 1000
    offset = hypothesis(BY_NAME["load_cell_calibration"], "R3")
    near = hypothesis(BY_NAME["bearing_drag"], "R1")
    delay = hypothesis(BY_NAME["loop_delay"], "unwind")
    scores = [(DRAG, 230.0), (FAR_DRAG, 190.0), (offset, 50.0), (near, 45.0)]
    rivals = [rival(h, worth, chi2_by_records, h is not near) for h, worth in scores]
    rivals.append(rival(delay, 300.0, 0.0, True))
    missed = {h.key: worth for h, worth in scores} | {delay.key: 300.0}
    said = claimed(rivals, missed, found)
    assert (said is not None) is taken
    if taken:
        assert said.accepted.shared
        # another cause that ends it as well is named, claim or not; what does not is not
        assert said.accepted.ambiguous == (delay.key, FAR_DRAG.key, offset.key)
        alone = [replace(r, ends_conflict=False) for r in rivals[:3]]
        assert claimed(alone, missed, found).accepted.ambiguous == ()


@pytest.mark.parametrize(
    ("chi2_by_records", "ends_conflict", "taken"),
    [(5000.0, True, False), (5000.0, False, True), (25_000.0, True, True)],
)
def test_several_numbers_together_answer_what_a_size_wanders(
    chi2_by_records, ends_conflict, taken
):
    """Of a slip that explains 1e6 that is 2 %, 20 000."""
    found = found_first("slip", "swrap")
    found = replace(
        found,
        nominal=replace(found.nominal, cost=COST + 1e6),
        accepted=(replace(found.accepted[0], score=1e6),),
        wander_is_free=True,
    )
    rivals = [rival(DRAG, 230.0, chi2_by_records, ends_conflict)]
    assert (claimed(rivals, {DRAG.key: 230.0}, found) is not None) is taken


@pytest.mark.parametrize(
    ("name", "taken"), [("out_of_round_roll", False), ("torque_ripple", True)]
)
def test_the_mean_radius_of_a_roll_with_a_profile_is_the_profile_s(name, taken):
    radius = hypothesis(BY_NAME["radius_error"], "unwind")
    found = found_first(name, "unwind")
    said = claimed([rival(radius, 170.0, 1e5)], {radius.key: 170.0}, found)
    assert (said is not None) is taken


@pytest.mark.parametrize("drag", [215.0, 225.0, 299.0])
def test_what_is_no_claim_hides_no_later_declared_number_either(drag):
    """A modulus of 300 that keeps 220 when all else is fitted again; a drag needs 400 there."""
    found = found_first("torque_ripple", "unwind")
    rivals = [rival(MODULUS, 300.0, 5000.0), rival(DRAG, drag)]
    said = claimed(rivals, {MODULUS.key: 220.0, DRAG.key: drag}, found)
    assert said is not None
    assert said.hypothesis.key == MODULUS.key
    assert said.accepted.score == pytest.approx(220.0)


def test_beside_half_of_a_pair_a_declared_number_needs_what_any_first_effect_needs():
    """16 is for a number alone: beside others their model error is in it."""
    half = fit_of(hypothesis(BY_NAME["torque_ripple"], "unwind"), cost=COST)
    beside = replace(selection(nominal=COST + 1e4), fit=half)
    radius = rival(hypothesis(BY_NAME["radius_error"], "unwind"), 54.0, 1500.0, False, True)
    assert least_score(selection(), radius) == pytest.approx(16.0)
    assert least_score(beside, radius) == pytest.approx(120.0)
