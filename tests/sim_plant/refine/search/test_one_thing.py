"""Unknowns that are ways in which one thing shows are told as that."""

from dataclasses import replace

import numpy as np
import pytest

from sim_plant.refine.fit.gauss_newton import nominal_fit
from sim_plant.refine.search import one_thing
from sim_plant.refine.search.one_thing import (
    is_part_of,
    rhythm_of,
    sticking_reading,
    told_as,
    whole_of,
)
from sim_plant.refine.search.reading_direction import Sticking
from sim_plant.refine.search.selection import Selection
from sim_plant.refine.search.unexplained import Unknown
from tests.each_case import each_case
from tests.sim_plant.refine.small import axes_at, fit_of, formula_twin, objective_of, white

AXES = axes_at(np.ones(6000))


def unknown(kind, **where):
    return Unknown(unknown_class=kind, coordinate=where, chi2_reduction=1.0)


RHYTHM = unknown("time", period_s=2.0)
STICKS = Sticking(channel="a_N", band_N=1.0, chi2_reduction=9.0)
GAP = sticking_reading([STICKS])


@each_case(
    ("whole", "part", "is_one"),
    [
        (RHYTHM, unknown("event", from_s=3.0), True),
        (RHYTHM, unknown("state", declared="gain"), True),
        (RHYTHM, unknown("time", frequency_Hz=7.01), True),  # 14.02 periods, 60 s resolve 0.017
        (RHYTHM, unknown("time", frequency_Hz=7.25), False),
        (RHYTHM, unknown("angle", roll="unwind", order=1.0), False),
        (RHYTHM, unknown("broadband"), True),
        (GAP, unknown("time", frequency_Hz=0.4), True),
        (GAP, unknown("travel", wavenumber_1_m=1.0), False),
    ],
)
def test_harmonics_and_what_has_no_spectral_line_are_parts_and_what_turns_is_none(
    whole, part, is_one
):
    assert is_part_of(part, whole, [60.0]) is is_one


def test_what_is_no_part_stays_beside():
    turns = unknown("angle", roll="unwind", order=1.0)
    fit = fit_of(residual=np.zeros(1), cost=0.0)
    selection = Selection(
        nominal=fit,
        fit=fit,
        record_axes=(AXES,),
        spectra_declared=(),
        spectra_left=(),
        unknown=(unknown("time", frequency_Hz=0.5), turns),
    )
    assert told_as(RHYTHM, selection).unknown == (RHYTHM, turns)


def test_readings_that_stick_name_the_one_that_shows_it_best_and_the_others():
    rows = [Sticking(channel=c, band_N=1.0, chi2_reduction=9.0) for c in ("a_N", "b_N", "c_N")]
    where = sticking_reading(rows).coordinate
    assert where == {"channel": "a_N", "gap_N": 1.0, "also_in": "b_N, c_N"}


CHANNELS = ("unwind_tension_N", "pullroll_tension_N", "unwind_speed_rad_s")
SPEED_M_S = np.linspace(0.6, 1.3, 8000)
METRES = 0.01 * np.cumsum(SPEED_M_S)


def left_by(position, period, *, channel):
    """Return objective and selection of noise that is thrice as large for a third of a period."""
    measured = white((len(CHANNELS), SPEED_M_S.size), seed=3)
    measured[channel] *= np.where(position % period < 0.3 * period, 3.0, 1.0)
    twin = formula_twin(
        lambda _: np.zeros_like(measured), CHANNELS, SPEED_M_S.size, speed_m_s=SPEED_M_S
    )
    objective = objective_of(twin, measured)
    axes = axes_at(SPEED_M_S)
    judged = slice(objective.whitening.noise[0].first, None)
    axes = replace(
        axes,
        time_s=axes.time_s[judged],
        travel_m=axes.travel_m[judged],
        angles_rad=axes.angles_rad[:, judged],
        speed_m_s=axes.speed_m_s[judged],
    )
    fit = nominal_fit(objective)
    selection = Selection(
        nominal=fit,
        fit=fit,
        record_axes=(axes,),
        spectra_declared=(),
        spectra_left=(),
        unknown=(unknown("time", frequency_Hz=0.5), unknown("event", from_s=3.0)),
    )
    return objective, selection


@pytest.fixture(scope="module")
def knocks():
    """What a selection leaves that knocks every 2 s in the pull roll's tension."""
    return left_by(0.01 * np.arange(SPEED_M_S.size), 2.0, channel=1)


def test_what_knocks_every_two_seconds_is_one_rhythm_with_its_zone(knocks):
    found = rhythm_of(*knocks)
    assert found.unknown_class == "time"
    assert found.coordinate["period_s"] == pytest.approx(2.0, rel=5e-3)
    assert found.coordinate["channel"] == "pullroll_tension_N"
    assert found.coordinate["zone"] == "pull_roll_zone"
    assert found.chi2_reduction == 2.0  # of both unknowns that it stands for


def test_a_rhythm_with_a_roll_or_along_the_web_is_none_in_time():
    assert rhythm_of(*left_by(METRES, 2.0, channel=1)) is None


def test_a_rhythm_is_the_whole_where_no_reading_sticks(knocks, monkeypatch):
    objective, selection = knocks
    assert whole_of(objective, selection).coordinate.keys() == {"period_s", "zone", "channel"}
    monkeypatch.setattr(one_thing, "sticking_cells", lambda *rest: [STICKS])
    assert whole_of(objective, selection).coordinate == GAP.coordinate


def test_where_nothing_is_unknown_there_is_no_whole(knocks):
    objective, selection = knocks
    assert whole_of(objective, replace(selection, unknown=())) is None
