import math
from dataclasses import replace

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.report.confidence import (
    amplitude_standard_deviation,
    sizes_shown,
    standard_deviations,
)
from sim_plant.refine.search.selection import Selection
from tests.sim_plant.refine.small import LINE, fit_of, one_peak

DRAG = hypothesis(BY_NAME["bearing_drag"], "R7", (), ("constant_N_m",), LINE)


def test_a_size_is_known_to_its_noise_and_the_models_own_error():
    fit = replace(fit_of(DRAG, values=[(0.2,)]), covariance=np.array([[0.01**2]]))
    both = math.hypot(0.01, 0.2 * CRITERIA.report.model_share)
    assert standard_deviations(fit) == pytest.approx([both])


def test_of_a_number_of_which_no_step_ran_nothing_is_known_but_its_bounds():
    fit = replace(fit_of(DRAG, values=[(0.2,)]), covariance=np.zeros((0, 0)))
    width = DRAG.high[0] - DRAG.low[0]
    (found,) = standard_deviations(fit)
    assert found == pytest.approx(
        math.hypot(width / math.sqrt(12.0), 0.2 * CRITERIA.report.model_share)
    )


def test_a_mass_is_a_size_and_a_frequency_is_none():
    bounce = hypothesis(BY_NAME["roll_bounce"], "unwind", (), ("frequency_Hz", "mass_kg"), LINE)
    fit = replace(fit_of(bounce, values=[(3.4, 30.0)]), covariance=np.diag([0.002, 0.1]) ** 2)
    mass = math.hypot(0.1, 30.0 * CRITERIA.report.model_share)
    assert standard_deviations(fit) == pytest.approx([0.002, mass])


def test_what_turns_a_phasor_says_nothing_of_its_length():
    off_axis = hypothesis(BY_NAME["eccentric_roller"], "R6", (), ("cos_m", "sin_m"), LINE)
    along, across = np.array([0.6, 0.8]), np.array([-0.8, 0.6])
    known = 1e-6**2 * np.outer(along, along) + 1e-4**2 * np.outer(across, across)
    fit = replace(fit_of(off_axis, values=[(3e-4, 4e-4)]), covariance=known)
    own = 5e-4 * CRITERIA.report.model_share
    assert amplitude_standard_deviation(fit, 0, 1) == pytest.approx(math.hypot(1e-6, own))


def test_of_a_phasor_of_which_no_step_ran_the_length_is_known_as_its_parts():
    off_axis = hypothesis(BY_NAME["eccentric_roller"], "R6", (), ("cos_m", "sin_m"), LINE)
    fit = replace(fit_of(off_axis, values=[(3e-4, 4e-4)]), covariance=np.zeros((0, 0)))
    assert amplitude_standard_deviation(fit, 0, 1) == max(standard_deviations(fit))


def test_a_size_is_as_uncertain_as_the_model_and_an_angle_only_as_the_noise():
    flat = hypothesis(
        BY_NAME["out_of_round_roll"], "unwind", (("shape", "flat"),), ("size_m", "angle_rad")
    )
    off_axis = hypothesis(BY_NAME["eccentric_roller"], "R6")
    fit = replace(
        fit_of(flat, off_axis, values=((0.012, 1.0), (3e-4, 4e-4))),
        covariance=np.diag([1e-10, 1e-6, 1e-14, 1e-14]),
    )
    size, angle, cos, sin = standard_deviations(fit)
    assert size == pytest.approx(math.hypot(1e-5, CRITERIA.report.model_share * 0.012))
    assert angle == pytest.approx(1e-3)
    # either component is as uncertain as the phasor: the error may stand across it
    assert (
        cos
        == pytest.approx(math.hypot(1e-7, CRITERIA.report.model_share * 5e-4))
        == pytest.approx(sin)
    )


def selected(*hypotheses, values, sd, ranges=()):
    """Return these effects selected, with these standard deviations of all their numbers."""
    fit = replace(fit_of(*hypotheses, values=values), covariance=np.diag(sd) ** 2)
    return Selection(
        nominal=fit_of(cost=1e4),
        fit=fit,
        record_axes=(),
        spectra_declared=one_peak(),
        spectra_left=one_peak(),
        accepted=(),
        ranges=ranges,
    )


def test_an_effect_has_a_size_where_an_interval_leaves_out_its_absence():
    both = selected(DRAG, DRAG, values=[(0.2,), (0.2,)], sd=[0.09, 0.11])
    assert sizes_shown(both) == [True, False]  # 2.2 and 1.8 standard deviations
    searched = ({}, {"constant_N_m": (0.1, 0.3)})
    assert sizes_shown(replace(both, ranges=searched)) == [True, True]


def test_a_phasor_has_a_size_where_its_length_has_one_though_neither_part_has():
    off_axis = hypothesis(BY_NAME["eccentric_roller"], "R6", (), ("cos_m", "sin_m"), LINE)
    either = selected(off_axis, values=[(3e-5, 3e-5)], sd=[2e-5, 2e-5])
    assert sizes_shown(either) == [True]  # 1.5 standard deviations each, 2.1 together
    assert sizes_shown(selected(off_axis, values=[(3e-5, 0.0)], sd=[2e-5, 2e-5])) == [False]


def test_a_moment_alone_is_no_size():
    late = hypothesis(BY_NAME["bearing_drag"], "R7", (), ("constant_N_m", "from_s"), LINE)
    assert sizes_shown(selected(late, values=[(0.2, 40.0)], sd=[0.3, 0.01])) == [False]


def test_without_a_covariance_scores_alone_speak():
    one = selected(DRAG, values=[(0.2,)], sd=[0.3])
    unknown = replace(one, fit=replace(one.fit, covariance=np.zeros((0, 0))))
    assert sizes_shown(unknown) == [True]
