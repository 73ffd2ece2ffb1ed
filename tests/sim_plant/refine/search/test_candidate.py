"""What an effect is worth: what coarse words show of it counts only beyond their steps."""

from dataclasses import replace

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.search.candidate import Candidate, sure_fall
from sim_plant.refine.search.screening import sure_look, sure_looks
from tests.sim_plant.refine.small import fit_of, formula_twin, objective_of, white

SAMPLES = 3000
STEP = np.where(np.arange(SAMPLES) < SAMPLES // 2, -1.0, 1.0)
TENSION, WORD = 0, 1


@pytest.fixture(scope="module")
def worded():
    """Return an objective of two channels: a tension, and a coarse word that is no analogue."""
    twin = formula_twin(lambda _: np.zeros((2, SAMPLES)), ("unwind_tension_N", "word"), SAMPLES)
    objective = objective_of(twin, white((2, SAMPLES)))
    (noise,) = objective.whitening.noise
    coarse = replace(noise, words=((), ((np.ones(1), 1.0),)))
    return replace(objective, whitening=replace(objective.whitening, noise=(coarse,)))


def left_in(objective, tension=0.0, word=0.0):
    """Return noise with steps of these sizes in both channels, as a projected residual."""
    judged = objective.rows // 2
    rows = white((2, judged), 3)
    rows[TENSION] += tension * STEP[-judged:]
    rows[WORD] += word * STEP[-judged:]
    vector = np.concatenate([rows.ravel(), np.zeros(len(objective.nuisances))])
    return objective.projector.project(vector)


def fit_leaving(residual):
    return fit_of(cost=float(residual @ residual), residual=residual)


@pytest.mark.parametrize(("channel", "counts"), [("tension", True), ("word", False)])
def test_what_a_word_may_show_by_its_steps_alone_is_no_sure_fall(worded, channel, counts):
    """A step of 0.5 noise: 0.25 of the power, less than the half that steps may be."""
    base, fit = (fit_leaving(left_in(worded, **{channel: size})) for size in (0.5, 0.0))
    fall = base.cost - fit.cost
    assert fall > 400.0
    assert (sure_fall(worded, base, fit) > 0.9 * fall) is counts


def test_of_a_word_counts_what_is_beyond_its_steps(worded):
    """A step of 3 noises is 9 times the power: all but the doubtful half of 1 is sure."""
    base, fit = (fit_leaving(left_in(worded, word=size)) for size in (3.0, 0.0))
    (noise,) = worded.whitening.noise
    by_steps = worded.quantisation_chi2(base.residual)
    assert by_steps == pytest.approx(0.5 * noise.share[WORD] * worded.rows / 2)
    assert sure_fall(worded, base, fit) == pytest.approx(base.cost - fit.cost - by_steps, rel=0.02)


def test_a_first_look_at_a_word_gives_way_to_one_that_a_tension_shows(worded):
    """The word's step is the larger one, and says less: 0.16 of the power may be its steps."""
    judged = worded.rows // 2
    residual = left_in(worded, tension=0.3, word=0.4)
    columns = np.zeros((2, residual.size, 1))
    columns[WORD, judged : 2 * judged, 0] = STEP[-judged:]
    columns[TENSION, :judged, 0] = STEP[-judged:]
    rows = zip(("R3", "R9"), columns, strict=True)
    looks = [first_look(place, column[:, 0], residual) for place, column in rows]
    assert looks[1].score > looks[0].score
    ordered = sure_looks(worded, residual, looks, list(columns))
    assert [c.hypothesis.location for c in ordered] == ["R3", "R9"]
    left = worded.projector.project(residual)
    sure = sure_look(worded, left, worded.quantisation_chi2(left), looks[0], columns[TENSION])
    assert sure.score > 0.8 * looks[0].score


def first_look(place, column, residual):
    """Return a drag that changes readings by ``column`` per typical size, at its best size."""
    h = hypothesis(BY_NAME["bearing_drag"], place)
    size = float(column @ residual) / float(column @ column)
    return Candidate(
        hypothesis=h,
        chi2_reduction=size * float(column @ residual),
        penalty=0.0,
        start=(size * h.start[0],),
    )
