import numpy as np
import pytest

from tests.sim_plant.line.lines import declared, exact_line, hold, with_effect

CELLS = ("r3_tension_N", "unwind_tension_N", "pullroll_tension_N", "rewind_tension_N")


def tensions(line, substeps, duration_s=3.0):
    """The four measured tensions of a run from the same, unsettled start, (samples, 4)."""
    run = exact_line(line, settle_s=0.0, substeps=substeps)
    rows = hold(run, duration_s)
    return np.column_stack([rows[name] for name in CELLS])


def distance(a, b):
    return float(np.sqrt(np.mean((a - b) ** 2)))


def test_smooth_bodies_converge_with_the_fourth_order_of_the_rule():
    line = with_effect(declared("euclid"), "eccentric_roller", "swrap_lead", eccentricity_m=5e-4)
    runs = [tensions(line, substeps) for substeps in (1, 2, 4)]
    order = np.log2(distance(runs[0], runs[1]) / distance(runs[1], runs[2]))
    assert order == pytest.approx(4.0, abs=0.4)


def test_shipped_step_has_converged_to_two_millionths_of_the_ripple():
    """One Runge-Kutta step per drive tick, and one look at the bodies of a span per slope.

    Steps of a quarter leave less of both. Begun where the slope before it left a span, a look
    alone costs 6e-6.
    """
    shipped, fine = (tensions(declared("euclid_ripple"), substeps) for substeps in (1, 4))
    ripple = np.std(fine[200:], axis=0)
    error = np.sqrt(np.mean((shipped - fine)[200:] ** 2, axis=0))
    assert np.min(ripple) > 0.1
    assert np.max(error / ripple) < 2e-6
