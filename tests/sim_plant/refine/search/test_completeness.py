from types import SimpleNamespace

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.search.completeness import explains_own_lines
from sim_plant.refine.spectra.line_spectrum import LineSpectrum

DELAY = hypothesis(BY_NAME["loop_delay"], "unwind")
NOISE = 66_000.0
OBJECTIVE = SimpleNamespace(expected_cost=NOISE)


def quiet(chi2_reduction=0.0):
    return [
        [
            LineSpectrum(
                kind="time",
                roll="",
                coordinate=np.array([1.0]),
                chi2_reduction=np.array([chi2_reduction]),
                degrees=72,
            )
        ]
    ]


def claimed(before, after, line=0.0):
    base = SimpleNamespace(cost=before, hypotheses=())
    fit = SimpleNamespace(cost=after, hypotheses=(DELAY,))
    return explains_own_lines(OBJECTIVE, base, quiet(line), [None], fit)


@pytest.mark.parametrize("share", [0.05, 0.2])
def test_an_effect_that_explains_little_of_much_is_an_imitation(share):
    assert not claimed(NOISE + 20_000.0, NOISE + (1.0 - share) * 20_000.0)


@pytest.mark.parametrize("share", [0.4, 1.0])
def test_the_largest_of_some_true_effects_is_taken(share):
    assert claimed(NOISE + 20_000.0, NOISE + (1.0 - share) * 20_000.0)


def test_a_small_effect_in_a_record_that_is_else_at_its_floor_is_taken():
    assert claimed(NOISE + 500.0, NOISE + 400.0)


def test_an_effect_that_is_no_line_does_not_stand_beside_a_strong_line():
    assert not claimed(NOISE + 20_000.0, NOISE + 12_000.0, line=15_000.0)
