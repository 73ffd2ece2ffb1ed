"""Which of several fits is claimed: the rules, with fits made up for them."""

from dataclasses import replace

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.search.selection import (
    AcceptedEffect,
    Extension,
    at_noise_floor,
    confirmed_scores,
    imitates,
    later_score,
    least_score,
    preferred,
    standing,
)
from sim_plant.refine.search.strongest_zone import Heard
from sim_plant.refine.search.taken_back import withdrawn, without_accepted
from sim_plant.refine.search.unexplained import Unknown
from tests.each_case import each_case
from tests.sim_plant.refine.search.claims import (
    COST,
    DRAG,
    FAR_DRAG,
    MODULUS,
    claimed,
    rival,
    selection,
)
from tests.sim_plant.refine.small import LINE, fit_of, one_peak, quiet


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


@each_case(
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


@each_case(
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


@pytest.mark.parametrize(
    ("line", "kind", "zone"), [(5000.0, "time", "pull_roll_zone"), (100.0, "broadband", None)]
)
def test_effects_that_are_withdrawn_leave_their_line_unknown_or_something_irregular(
    line, kind, zone
):
    known = AcceptedEffect(hypothesis=DRAG, score=900.0, runner_up=None, margin=900.0, rejected=())
    found = selection(cost=COST - 900.0, nominal=COST, accepted=(known,), adjustments={"x": 1.0})
    time_s = 0.01 * np.arange(2000)
    wave = np.cos(2.0 * np.pi * time_s)  # where one_peak has its line
    names = ["unwind_tension_N", "pullroll_tension_N"]
    heard = Heard(line=LINE, names=names, left=np.stack([0.1 * wave, wave]), time_s=time_s)
    left = withdrawn(replace(found, spectra_declared=one_peak(line), heard_declared=(heard,)))
    assert [(u.unknown_class, u.coordinate.get("zone")) for u in left.unknown] == [(kind, zone)]
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
