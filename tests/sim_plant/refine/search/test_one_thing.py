"""Unknowns that are ways in which one thing shows are told as that."""

from types import SimpleNamespace

import numpy as np

from sim_plant.refine.search.one_thing import is_part_of, sticking_reading, told_as
from sim_plant.refine.search.reading_direction import Sticking
from sim_plant.refine.search.selection import Selection
from sim_plant.refine.search.unexplained import Unknown
from tests.each_case import each_case
from tests.sim_plant.refine.small import axes_at, fit_of

AXES = axes_at(np.ones(6000))


def unknown(kind, **where):
    return Unknown(unknown_class=kind, coordinate=where, chi2_reduction=1.0)


RHYTHM = unknown("time", period_s=2.0)
GAP = sticking_reading([Sticking(channel="a_N", band_N=1.0, chi2_reduction=9.0)])
FOUND = SimpleNamespace(record_axes=(AXES,))


@each_case(
    ("whole", "part", "is_one"),
    [
        (RHYTHM, unknown("event", from_s=3.0), True),
        (RHYTHM, unknown("state", declared="gain"), True),
        (RHYTHM, unknown("time", frequency_Hz=7.01), True),  # 14.02 periods, 60 s resolve 0.017
        (RHYTHM, unknown("time", frequency_Hz=7.25), False),
        (RHYTHM, unknown("angle", roll="unwind", order=1.0), False),
        (GAP, unknown("time", frequency_Hz=0.4), True),
        (GAP, unknown("travel", wavenumber_1_m=1.0), False),
    ],
)
def test_harmonics_moments_and_declared_numbers_are_parts_and_what_turns_is_none(
    whole, part, is_one
):
    assert is_part_of(part, whole, FOUND) is is_one


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
    assert told_as(selection, RHYTHM, selection).unknown == (RHYTHM, turns)


def test_readings_that_stick_name_the_one_that_shows_it_best_and_the_others():
    rows = [Sticking(channel=c, band_N=1.0, chi2_reduction=9.0) for c in ("a_N", "b_N", "c_N")]
    where = sticking_reading(rows).coordinate
    assert where == {"channel": "a_N", "gap_N": 1.0, "also_in": "b_N, c_N"}
