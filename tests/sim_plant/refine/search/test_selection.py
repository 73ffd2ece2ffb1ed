"""Which of several fits is claimed: the rules, with fits made up for them."""

from dataclasses import replace

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.search.candidate import FittedCandidate
from sim_plant.refine.search.selection import (
    AcceptedEffect,
    Extension,
    Selection,
    accept,
    at_noise_floor,
    confirmed_scores,
    imitates,
    later_score,
    least_score,
    preferred,
    standing,
    withdrawn,
    without_accepted,
)
from sim_plant.refine.search.unexplained import Unknown
from tests.sim_plant.refine.small import LINE, fit_of, one_peak, quiet

DRAG = hypothesis(BY_NAME["bearing_drag"], "R3")
FAR_DRAG = hypothesis(BY_NAME["bearing_drag"], "R9")
MODULUS = hypothesis(BY_NAME["web_modulus"], "web")
COST, PENALTY = 41_000.0, 10.0


def selection(cost=COST, nominal=None, **more):
    return Selection(
        nominal=fit_of(cost=cost if nominal is None else nominal),
        fit=fit_of(cost=cost),
        record_axes=(),
        spectra_declared=one_peak(),
        spectra_left=one_peak(),
        **more,
    )


def rival(h, worth, chi2_by_records=0.0, ends_conflict=False, beyond_tolerance=False):
    """Return a fit whose score is this, and what the record alone says of it."""
    fit = fit_of(h, cost=COST - worth - PENALTY)
    return FittedCandidate(
        fit=fit,
        chi2_reduction=COST - fit.cost,
        penalty=PENALTY,
        chi2_by_records=chi2_by_records,
        ends_conflict=ends_conflict,
        beyond_tolerance=beyond_tolerance,
    )


def claimed(rivals, missed, found=None):
    """Return what is accepted, given the score that each effect keeps when it is taken out."""
    found = found or selection()

    def chi2_without(fit):
        return missed[fit.hypotheses[-1].key] + PENALTY

    return accept(found, confirmed_scores(found, rivals, chi2_without, quiet), [], quiet)


def test_a_fit_that_is_not_missed_makes_room_for_the_next():
    missed = {DRAG.key: 10.0, MODULUS.key: 400.0}
    found = claimed([rival(DRAG, 450.0), rival(MODULUS, 420.0)], missed).accepted
    assert found.hypothesis.key == MODULUS.key
    assert found.score == pytest.approx(400.0)
    assert found.ambiguous == ()


def test_two_that_are_missed_alike_are_both_named():
    missed = {DRAG.key: 300.0, FAR_DRAG.key: 296.0}
    found = claimed([rival(DRAG, 310.0), rival(FAR_DRAG, 305.0)], missed).accepted
    assert found.ambiguous == (FAR_DRAG.key,)
    assert found.runner_up == FAR_DRAG.key
    assert found.margin == pytest.approx(4.0)


def test_a_weak_one_that_another_explains_as_well_is_no_claim():
    missed = {DRAG.key: 130.0, FAR_DRAG.key: 126.0}
    assert claimed([rival(DRAG, 130.0), rival(FAR_DRAG, 126.0)], missed) is None
    found = claimed([rival(DRAG, 130.0)], missed)
    assert found.hypothesis.key == DRAG.key


def test_what_has_no_line_of_its_own_needs_more():
    assert claimed([rival(DRAG, 100.0)], {DRAG.key: 100.0}) is None
    eccentric = hypothesis(BY_NAME["eccentric_roller"], "R6")
    found = claimed([rival(eccentric, 100.0)], {eccentric.key: 100.0})
    assert found.hypothesis.key == eccentric.key


def test_the_least_of_a_large_explanation_grows_with_it():
    large = selection(nominal=COST + 1e6)
    assert claimed([rival(DRAG, 500.0)], {DRAG.key: 500.0}, large) is None


def test_what_a_strong_free_term_leaves_is_no_effect():
    beside = selection(chi2_of_free_terms=5e5)  # a flat spot no effect explains; 0.1 % is 500
    assert claimed([rival(DRAG, 500.0)], {DRAG.key: 450.0}, beside) is None
    assert claimed([rival(DRAG, 550.0)], {DRAG.key: 550.0}, beside) is not None


@pytest.mark.parametrize(
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


def found_first(name, place):
    h = hypothesis(BY_NAME[name], place)
    there = AcceptedEffect(hypothesis=h, score=1e4, runner_up=None, margin=1e4, rejected=())
    return selection(accepted=(there,))


@pytest.mark.parametrize(
    ("explained", "least"),
    [
        (905.0, 120.0),  # 4 % of it are 36: no more than noise may show
        (5000.0, 200.0),
        (1e4, 400.0),
        (1e5, 400.0),
    ],
)
def test_beside_a_weak_effect_a_later_one_needs_what_the_model_of_that_can_have_wrong(
    explained, least
):
    shaft = hypothesis(BY_NAME["shaft_compliance_backlash"], "unwind")
    resonance = hypothesis(BY_NAME["load_cell_resonance"], "R3")
    there = AcceptedEffect(
        hypothesis=shaft, score=explained, runner_up=None, margin=explained, rejected=()
    )
    found = selection(nominal=COST + explained, accepted=(there,))
    for worth, taken in ((least - 1.0, False), (least + 1.0, True)):
        said = claimed([rival(resonance, worth)], {resonance.key: worth}, found)
        assert (said is not None) is taken
    apart = replace(found, nominal=replace(found.nominal, cost=COST + 0.1 * explained))
    assert later_score(apart) == pytest.approx(least)  # its error is none the smaller


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


def test_a_score_beyond_doubt_is_not_looked_at_again():
    asked = []
    found = confirmed_scores(
        selection(), [rival(DRAG, 5000.0)], lambda fit: asked.append(fit) or 0.0, quiet
    )
    assert [c.score for c in found] == [pytest.approx(5000.0)]
    assert asked == []


@pytest.mark.parametrize(
    ("explained", "left", "ended"),
    [
        (649.0, -470.0, False),  # noise of 40 000 rows is known to 283: a weak line may be left
        (1e7, 1000.0, True),  # 2e-4 of what a strong effect explained
        (1e7, 1500.0, False),
    ],
)
def test_the_search_ends_when_what_is_left_is_surely_no_effect(explained, left, ended):
    expected = 40_000.0
    cost = expected + left
    found = selection(cost=cost, nominal=cost + explained)
    assert at_noise_floor(found, expected, 3.0 * (2.0 * expected) ** 0.5) is ended


def extension(h, cost):
    accepted = AcceptedEffect(hypothesis=h, score=1e4, runner_up=None, margin=1e4, rejected=())
    return Extension(accepted=accepted, fit=fit_of(h, cost=cost))


def test_an_effect_that_explains_less_than_half_of_a_pair_does_not_take_its_place():
    """Roll bounce, complete at its one line, against a flat spot that a delay has turned."""
    flat = extension(hypothesis(BY_NAME["out_of_round_roll"], "unwind"), cost=2e5)
    bounce = extension(hypothesis(BY_NAME["roll_bounce"], "unwind"), cost=6e5)
    assert preferred([bounce], [flat]) == (flat, False)
    cheaper = replace(bounce, fit=replace(bounce.fit, cost=1e5))
    assert preferred([bounce, cheaper], [flat]) == (cheaper, True)
    assert preferred([], []) == (None, False)


@pytest.mark.parametrize(("worth", "taken"), [(900.0, False), (1100.0, True)])
def test_beside_slip_of_50000_an_effect_explains_more_than_slip_leaves_by_nature(worth, taken):
    """Slip wanders by 2 % of what it explains: 1000."""
    slip = hypothesis(BY_NAME["slip"], "swrap_lead")
    there = AcceptedEffect(
        hypothesis=slip, score=50_000.0, runner_up=None, margin=1e3, rejected=()
    )
    found = claimed(
        [rival(DRAG, worth)],
        {DRAG.key: worth},
        selection(nominal=COST + 50_000.0, accepted=(there,)),
    )
    assert (found is not None) == taken


def test_beside_something_that_is_no_line_only_strong_periodic_effects_are_claimed():
    eccentric = hypothesis(BY_NAME["eccentric_roller"], "R3")
    hum = hypothesis(BY_NAME["mains_hum"], "R9")

    def found(h, worth):
        return AcceptedEffect(hypothesis=h, score=worth, runner_up=None, margin=worth, rejected=())

    effects = [found(eccentric, 9000.0), found(DRAG, 8000.0), found(hum, 1100.0)]
    assert standing(effects, 5000.0) == [0]
    assert standing(effects, 1000.0) == [0, 2]
    assert standing(effects, 0.0) == [0, 2]


@pytest.mark.parametrize(
    ("excess", "there", "said"),
    [
        (60_000.0, 3e6, True),  # three tenths of what was there beside the line, and 2 % of all
        (300.0, 3e6, False),
        (10_000.0, 3e6, False),  # a model may be wrong by as much of the line
        (20_000.0, 3e6, False),  # 18 % of what was there beside it: what remains of a right one
    ],
)
def test_effects_beside_a_line_that_leave_a_fair_share_imitate_something(excess, there, said):
    def found(h, worth):
        return AcceptedEffect(hypothesis=h, score=worth, runner_up=None, margin=worth, rejected=())

    roll = found(hypothesis(BY_NAME["eccentric_roller"], "R3"), there)
    drag = found(DRAG, 90_000.0)
    assert imitates([roll, drag], excess, there) is said
    assert not imitates([roll], excess, there)
    assert not imitates([drag], excess, there)


@pytest.mark.parametrize(("line", "kind"), [(5000.0, "time"), (100.0, "broadband")])
def test_effects_that_are_withdrawn_leave_their_line_unknown_or_something_irregular(line, kind):
    known = AcceptedEffect(hypothesis=DRAG, score=900.0, runner_up=None, margin=900.0, rejected=())
    found = selection(cost=COST - 900.0, nominal=COST, accepted=(known,), adjustments={"x": 1.0})
    left = withdrawn(replace(found, spectra_declared=one_peak(line)))
    assert [u.unknown_class for u in left.unknown] == [kind]
    assert (left.accepted, left.adjustments, left.fit) == ((), {}, left.nominal)


def test_effects_that_are_withdrawn_beside_something_unknown_leave_that():
    known = AcceptedEffect(hypothesis=DRAG, score=900.0, runner_up=None, margin=900.0, rejected=())
    line = Unknown(unknown_class="time", chi2_reduction=9000.0, coordinate={"frequency_Hz": 0.39})
    found = selection(cost=COST - 900.0, nominal=COST, accepted=(known,), unknown=(line,))
    left = withdrawn(found)
    assert (left.unknown, left.accepted, left.fit) == ((line,), (), left.nominal)


def test_one_of_several_is_left_out_with_its_numbers_and_what_is_known_of_them():
    def known(h):
        return AcceptedEffect(hypothesis=h, score=900.0, runner_up=None, margin=9.0, rejected=())

    found = selection(accepted=(known(DRAG), known(MODULUS), known(FAR_DRAG)))
    fit = replace(
        found.fit,
        hypotheses=(DRAG, MODULUS, FAR_DRAG),
        values=((0.1,), (0.2,), (0.3,)),
        covariance=np.arange(9.0).reshape(3, 3),
    )
    left = without_accepted(replace(found, fit=fit), 1)
    assert [a.hypothesis for a in left.accepted] == [DRAG, FAR_DRAG]
    assert left.fit.hypotheses == (DRAG, FAR_DRAG)
    assert left.fit.values == ((0.1,), (0.3,))
    assert left.fit.covariance.tolist() == [[0.0, 2.0], [6.0, 8.0]]


@pytest.mark.parametrize(("detailed", "least"), [(False, 0.0), (True, 2000.0)])
def test_beside_an_outline_that_no_profile_has_a_later_effect_needs_a_share_of_it(detailed, least):
    """0.1 % of 2e6: what the orders of a roll leave as it gets smaller is anywhere."""
    names = ("size_m", "angle_rad", *(("cos1_m", "sin1_m") if detailed else ()))
    roll = hypothesis(BY_NAME["out_of_round_roll"], "unwind", (("shape", "flat"),), names, LINE)
    there = AcceptedEffect(hypothesis=roll, score=2e6, runner_up=None, margin=0.0, rejected=())
    found = selection(accepted=(there,))
    later = hypothesis(BY_NAME["viscoelastic_web"], "web", line=LINE)
    plain = CRITERIA.search.acceptance.later_score
    assert least_score(found, rival(later, 0.0)) == pytest.approx(max(plain, least))


def test_several_imitations_hide_no_effect_behind_them():
    """Three that are not missed, as many as are looked at, stand before a right one."""
    places = ["R4", "R5", "R6"]
    imitations = [hypothesis(BY_NAME["bearing_drag"], place) for place in places]
    missed = {h.key: 20.0 for h in imitations} | {MODULUS.key: 690.0}
    rivals = [rival(h, 700.0 - k) for k, h in enumerate(imitations)] + [rival(MODULUS, 690.0)]
    assert claimed(rivals, missed).accepted.hypothesis.key == MODULUS.key


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
