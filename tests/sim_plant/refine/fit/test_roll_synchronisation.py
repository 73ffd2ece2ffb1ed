import numpy as np
import pytest

from sim_plant.refine.fit.roll_synchronisation import (
    recorded_angles,
    shifts_in_step,
    synchronising_shifts,
)
from sim_plant.refine.model.twin import Case
from tests.sim_plant.refine.small import (
    STEP_S,
    formula_twin,
    line_with,
    objective_of,
    pool_of,
    white,
)

SAMPLES, FIRST = 4000, 1000
CHANNELS = ("unwind_angle_rad", "unwind_speed_rad_s", "rewind_speed_rad_s", "line_speed_m_s")
UNWIND, REWIND = "rollers.unwind.effective_radius", "rollers.rewind.effective_radius"
SPEED_RAD_S = np.linspace(6.0, 9.0, SAMPLES)
SHRINK = np.linspace(1.0, 0.8, SAMPLES)
"""Share of the first radius that is left: a shift in metres counts for more and more."""
TOLERANCES = {UNWIND: 2e-3, REWIND: 2e-3, "*": 0.0}


def line(unwind_shift, rewind_shift):
    """Return channels of rolls whose effective radii are this much larger."""
    unwind = SPEED_RAD_S / (1.0 + unwind_shift / SHRINK)
    rewind = SPEED_RAD_S / (1.0 + rewind_shift)
    angle = np.cumsum(unwind) * STEP_S
    return np.stack([angle, unwind, rewind, np.ones(SAMPLES)])


def of_case(case):
    shifts = dict(case.shifts)
    return line(shifts.get(UNWIND, 0.0), shifts.get(REWIND, 0.0))


def twin(formula=of_case):
    return formula_twin(formula, CHANNELS, SAMPLES, noise_sd=1e-3, line=line_with(TOLERANCES))


def test_rolls_are_brought_into_step_by_angle_and_by_speed():
    found = synchronising_shifts(objective_of(twin(), line(-0.004, 0.002)), {})
    ours, theirs = line(found[UNWIND], found[REWIND]), line(-0.004, 0.002)
    late = (ours - theirs)[0, FIRST:]
    assert np.ptp(late) < 0.02
    assert found[UNWIND] == pytest.approx(-0.004, rel=0.02)
    assert found[REWIND] == pytest.approx(0.002, rel=0.02)


def test_rolls_that_are_in_step_stay_as_they_are():
    shifts = {"web.EA_N": 0.01}
    assert synchronising_shifts(objective_of(twin(), line(2e-5, 0.0)), shifts) == shifts


def test_a_line_that_does_not_run_leaves_the_shifts_alone():
    def breaks(case):
        return of_case(case) + (np.nan if dict(case.shifts).get(UNWIND) == 0.001 else 0.0)

    objective = objective_of(twin(breaks), line(0.0, 0.0) + 1e-3 * white((4, SAMPLES)))
    assert synchronising_shifts(objective, {UNWIND: 0.001}) == {UNWIND: 0.001}


def test_an_angle_word_goes_before_an_added_up_speed():
    found = recorded_angles(twin(), line(0.0, 0.0) + np.array([[5.0], [0.0], [0.0], [0.0]]))
    assert set(found) == {UNWIND, REWIND}
    assert found[UNWIND][0] > 5.0


def test_a_record_held_out_is_brought_into_step_from_what_another_asked_for():
    case = Case(shifts=((UNWIND, -0.004), ("web.EA_N", 0.01)))
    found = dict(shifts_in_step(pool_of(twin()), line(-0.0035, 0.002), case, FIRST))
    ours, theirs = line(found[UNWIND], found[REWIND]), line(-0.0035, 0.002)
    assert np.ptp((ours - theirs)[0, FIRST:]) < 0.02
    assert found[REWIND] == pytest.approx(0.002, rel=0.02)
    assert found["web.EA_N"] == 0.01


def test_a_record_held_out_that_is_in_step_asks_for_nothing():
    case = Case(shifts=((UNWIND, -0.004),))
    assert shifts_in_step(pool_of(twin()), line(-0.004, 0.0), case, FIRST) == case.shifts
