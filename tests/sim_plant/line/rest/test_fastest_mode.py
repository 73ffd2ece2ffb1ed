"""Steps are as fine as the line needs; one that no sensible step follows is refused."""

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.line.open import make_line
from sim_plant.line.rest.fastest_mode import FastestMode, fastest_mode, substeps_for
from tests.each_case import each_case
from tests.sim_plant.line.lines import declared, with_effect


def stiffer(times):
    line = declared("euclid")
    return line.model_copy(update={"web": line.web.model_copy(update={"EA_N": times * 9300.0})})


def mode_of(line):
    made = make_line(line, seed=None)
    return fastest_mode(line, made.arrays, made.lengths_m)


def test_two_idlers_against_each_other_are_the_fastest_of_the_shipped_line():
    """Above the mode of any span alone, sqrt(EA/L 2 R2/J); a long row has at most sqrt 2 of it."""
    line = declared("euclid")
    made = make_line(line, seed=None)
    mode = mode_of(line)
    bodies, lengths = made.arrays.bodies[1:-1], made.lengths_m[1:-1]
    pull = bodies["radius_m"] ** 2 / bodies["inertia_kg_m2"]
    alone = np.sqrt(line.web.EA_N / lengths * (pull[:-1] + pull[1:]))
    assert alone.max() < mode.rate_rad_s < np.sqrt(2.0) * alone.max()
    assert mode.where == "the web between R3 and R4"


def test_a_web_four_times_as_stiff_moves_twice_as_fast():
    viscous = {"kelvin_voigt_eta_s": 0.0}
    rates = []
    for times in (1.0, 4.0):
        line = stiffer(times)
        line = line.model_copy(update={"web": line.web.model_copy(update=viscous)})
        rates.append(mode_of(line).rate_rad_s)
    assert rates[1] == pytest.approx(2.0 * rates[0], rel=1e-9)


def test_a_stiff_web_takes_finer_steps_and_does_not_diverge():
    line = stiffer(400.0)
    made = make_line(line, seed=None)
    steps = int(made.arrays.timing["substeps"][0])
    assert steps > 1
    rows = np.full(40, 1.016), np.full(40, 88.9644)
    chosen = made.simulate(*rows)["unwind_tension_N"]
    finer = make_line(line, seed=None, substeps=4 * steps).simulate(*rows)["unwind_tension_N"]
    assert chosen == pytest.approx(finer, abs=0.05)
    coarse = make_line(line, seed=None)
    coarse.arrays.timing["substeps"] = 1
    with pytest.raises(PlantError, match="diverged"):
        coarse.simulate(*rows)


def test_a_line_of_todays_kind_takes_one_step_per_tick():
    assert int(make_line(declared("euclid"), seed=None).arrays.timing["substeps"][0]) == 1


def test_a_stiff_shaft_and_a_fast_load_cell_count():
    shaft = {"compliance_rad_N_m": 1e-5, "backlash_rad": 0.0}
    stiff = with_effect(declared("euclid"), "shaft_compliance_backlash", "unwind", **shaft)
    assert mode_of(stiff).where == "the shaft of unwind"
    ringing = {"frequency_Hz": 60.0, "damping": 0.01}
    cell = with_effect(declared("euclid"), "load_cell_resonance", "R9", **ringing)
    mode = mode_of(cell)
    assert (mode.where, mode.rate_rad_s) == ("the load cell of R9", pytest.approx(120.0 * np.pi))


@each_case(("rate_rad_s", "steps"), [(0.0, 1), (999.0, 1), (1001.0, 2), (31900.0, 32)])
def test_a_step_is_at_most_one_radian_of_the_fastest_mode(rate_rad_s, steps):
    mode = FastestMode(rate_rad_s=rate_rad_s, where="the web")
    assert substeps_for(mode, 1e-3, 1.0) == steps


def test_a_line_that_no_sensible_step_follows_is_refused_with_its_place():
    with pytest.raises(PlantError, match=r"the web between \w+ and \w+, has \d+ rad/s and takes"):
        make_line(stiffer(1e6), seed=None)
