import pytest

from tests.sim_plant.effects.running import at_rest, effect, span


def test_the_loop_holds_the_reading_not_the_tension() -> None:
    made = at_rest(effect("load_cell_calibration", "R9", gain=1.05, offset_N=2.0))
    tensions = made["span_tension_N"].mean(axis=0)
    true_N = 0.5 * (tensions[span("R8-R9")] + tensions[span("R9-swrap_lead")])
    assert made["unwind_tension_N"].mean() == pytest.approx(88.9644, abs=5e-3)
    assert true_N == pytest.approx((88.9644 - 2.0) / 1.05, abs=5e-3)
