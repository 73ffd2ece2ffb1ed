"""Orders at frequencies that a probe heard badly: who goes on, who rests, who comes back."""

from __future__ import annotations

import math

import numpy as np
import pytest

from aff_runtime.core.monitor import OrderState
from aff_runtime.core.response import Response
from tests.aff_runtime.core.plants import CYCLE_S, LagDelay, measured
from tests.aff_runtime.core.shape_site import GAIN_N_S_M, Rig

SURE_UP_TO_HZ = 2.0
SURE_RAD_S, UNSURE_RAD_S = (math.pi * f for f in (1.98, 2.02))  # of a roll whose 2x is there
RIPPLE = {("unwind", 1): 1.2 - 0.4j, ("unwind", 2): -0.5 + 0.8j}
SECOND = 1
RMS_N = abs(RIPPLE["unwind", 2]) / math.sqrt(2.0)


def heard(plant: LagDelay) -> Response:
    """Return the plant's own response, below 2 Hz with 2 % of error, above with its whole size."""
    sure, unsure = (
        measured(plant.at, f, relative_error=e, coherence=1.0 / (1.0 + e * e))
        for f, e in (([0.5, 1.0, SURE_UP_TO_HZ], 0.02), ([3.0, 4.0], 1.0))
    )
    points = [*sure.points, *unsure.points]
    return Response(points=points, delay_s=0.0, provenance=sure.provenance)


def rig(omega_rad_s: float) -> Rig:
    plant = LagDelay(GAIN_N_S_M, delay=2, lag=0.6)
    made = Rig(plant=plant, ripple=RIPPLE, omega=omega_rad_s, response=heard(plant))
    made.noise_N = 0.1
    return made


@pytest.fixture
def beyond() -> Rig:
    """A rig that learned where its response is sure; its 2x has just left that frequency."""
    made = rig(SURE_RAD_S)
    made.run(12.0)
    assert made.law.states()[SECOND] == OrderState.SETTLED
    for phase in made.phases.values():
        phase.omega_rad_s *= UNSURE_RAD_S / SURE_RAD_S
    return made


def test_a_quiet_order_goes_on_where_its_phase_is_no_longer_sure(beyond):
    left = beyond.run(10.0)
    assert beyond.law.shares()[SECOND] == 1.0
    assert np.std(left[-round(5.0 / CYCLE_S) :]) < 0.1 * RMS_N


def test_it_rests_once_its_correction_no_longer_helps_and_stays_so(beyond):
    beyond.run(2.0)
    beyond.plant.gain *= -1.0
    beyond.run(4.0)
    assert beyond.law.confidence.held[SECOND]
    beyond.plant.gain *= -1.0
    beyond.run(10.0)
    assert beyond.law.states()[SECOND] == OrderState.HELD_PHASE
    assert beyond.law.shares()[SECOND] == 0.0


def test_it_comes_back_where_its_response_is_sure(beyond):
    beyond.plant.gain *= -1.0
    beyond.run(4.0)
    assert beyond.law.confidence.held[SECOND]
    for phase in beyond.phases.values():
        phase.omega_rad_s *= SURE_RAD_S / UNSURE_RAD_S
    beyond.run(1.0)
    assert not beyond.law.confidence.held[SECOND]


def test_an_order_that_begins_where_its_phase_is_not_sure_rests():
    begun = rig(UNSURE_RAD_S)
    begun.run(12.0)
    assert begun.law.states()[SECOND] == OrderState.HELD_PHASE
    assert begun.law.weight[SECOND] == 0.0
