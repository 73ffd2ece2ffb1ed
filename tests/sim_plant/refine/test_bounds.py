"""Physical bounds over the whole catalogue: declared, narrowed by the line, kept by the search."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim_plant.effects.catalogue import BY_NAME, CATALOGUE
from sim_plant.line.arrays.build import build_arrays, timing_of
from sim_plant.line.reading.load import load_declaration
from sim_plant.refine.model.hypotheses import all_hypotheses, hypothesis
from sim_plant.refine.search.screening import linear_candidate
from tests.each_case import each_case
from tests.sim_plant.refine.small import formula_twin, objective_of, white

LINE = load_declaration(Path(__file__).parents[3] / "config/lines/euclid.yaml")
LIBRARY = all_hypotheses(LINE)
FINITE = st.floats(-1e9, 1e9)


SAMPLES = 160
OBJECTIVE = objective_of(
    formula_twin(lambda _: np.zeros((1, SAMPLES)), ["unwind_tension_N"], SAMPLES),
    white((1, SAMPLES)),
)
VECTOR = OBJECTIVE.rows + len(OBJECTIVE.nuisances)


@each_case("effect", CATALOGUE, ids=lambda e: e.name)
def test_every_number_but_an_angle_has_two_finite_bounds(effect):
    for name, p in effect.accepts.items():
        if isinstance(p.default, str) or p.role == "angle":
            continue
        assert math.isfinite(p.low), name
        assert math.isfinite(p.high), name
        assert p.low < p.high, name


def test_what_cannot_be_negative_is_not():
    signs = {
        "bearing_drag": ("constant_N_m", "viscous_N_m_s"),
        "loop_delay": ("delay_s",),
        "viscoelastic_web": ("ratio", "time_s"),
        "web_modulus": ("factor",),
        "rate_limit": ("slew_m_s2",),
        "radius_error": ("ratio",),
        "shaft_compliance_backlash": ("compliance_rad_N_m", "backlash_rad"),
        "load_cell_resonance": ("frequency_Hz", "damping"),
        "out_of_round_roll": ("size_m",),
        "roll_bounce": ("mass_kg", "frequency_Hz", "damping"),
    }
    for effect, names in signs.items():
        for name in names:
            assert BY_NAME[effect].accepts[name].low >= 0.0, (effect, name)


@each_case("h", LIBRARY, ids=lambda h: f"{h.effect.name}@{h.location}{h.fixed}")
def test_a_line_narrows_bounds_and_never_widens_them(h):
    for name, low, high, absent, start in zip(
        h.names, h.low, h.high, h.absent, h.start, strict=True
    ):
        declared = h.effect.accepts[name]
        assert declared.low <= low <= absent <= high <= declared.high
        assert low <= start <= high


def test_a_bearing_drags_no_more_than_the_web_at_its_tension_can_turn():
    radius = LINE.rollers[LINE.body("R6")].radius_m
    h = hypothesis(BY_NAME["bearing_drag"], "R6", line=LINE)
    at = h.names.index("constant_N_m")
    assert h.low[at] == 0.0
    assert h.high[at] == pytest.approx(LINE.web.wound_in_tension_N * radius)


@pytest.mark.parametrize(("roll", "low", "high"), [("unwind", 0.0, 0.05), ("rewind", -0.05, 0.0)])
def test_a_roll_that_unwinds_was_never_smaller_and_one_that_winds_up_never_larger(roll, low, high):
    h = hypothesis(BY_NAME["out_of_round_roll"], roll, fitted=("unwound_m",), line=LINE)
    assert (h.low, h.high) == ((low,), (high,))


def test_a_roll_is_not_wound_with_less_than_no_strain():
    h = hypothesis(BY_NAME["wound_in_strain"], "unwind", line=LINE)
    strain = LINE.web.wound_in_tension_N / LINE.web.EA_N
    assert h.low[0] == pytest.approx(-strain)


def test_a_load_cell_is_not_faster_than_no_filter():
    h = hypothesis(BY_NAME["load_cell_filter"], "R9", line=LINE)
    arrays = build_arrays(LINE, timing_of(LINE, LINE.sample_time_s))
    assert h.low[0] > -1.0 / (2.0 * math.pi * float(arrays.cells["corner_Hz"][0]))


@settings(max_examples=200, deadline=None)
@given(st.sampled_from(LIBRARY), st.lists(FINITE, min_size=12, max_size=12))
def test_whatever_a_step_asks_for_the_line_is_simulated_within_bounds(h, raw):
    added = dict(h.added(raw[: len(h.names)]).parameters)
    for name, low, high in zip(h.names, h.low, h.high, strict=True):
        assert low <= added[name] <= high


@settings(max_examples=200, deadline=None)
@given(st.sampled_from(LIBRARY), st.integers(0, 1000), st.sampled_from([-1e4, -1.0, 1.0, 1e4]))
def test_screening_starts_no_fit_beyond_a_bound(h, seed, size):
    draw = np.random.default_rng(seed)
    columns = draw.standard_normal((VECTOR, h.strength_count))
    columns[OBJECTIVE.rows :] = 0.0
    residual = size * columns @ draw.standard_normal(h.strength_count)
    inner = OBJECTIVE.projector.inner(residual, columns)
    start = linear_candidate(OBJECTIVE, h, inner).start
    assert all(lo <= v <= hi for v, lo, hi in zip(start, h.low, h.high, strict=True))


def test_a_drag_that_would_have_to_push_is_worth_nothing():
    h = hypothesis(BY_NAME["bearing_drag"], "R18", (), ("constant_N_m",), LINE)
    column = np.zeros((VECTOR, 1))
    column[: OBJECTIVE.rows] = 1.0
    push, drag = (OBJECTIVE.projector.inner(s * column[:, 0], column) for s in (-5.0, 5.0))
    assert linear_candidate(OBJECTIVE, h, push).chi2_reduction == 0.0
    assert linear_candidate(OBJECTIVE, h, drag).chi2_reduction > 0.0


def test_an_estimate_at_a_bound_is_none_but_absence_may_lie_there():
    h = hypothesis(BY_NAME["web_modulus"], "web", line=LINE)
    assert h.at_bound([h.low[0]])
    assert h.at_bound([h.high[0]])
    assert not h.at_bound([0.85])
    drag = hypothesis(BY_NAME["bearing_drag"], "R18", (), ("constant_N_m",), LINE)
    assert not drag.at_bound([0.0])
    assert drag.at_bound([drag.high[0]])


def test_web_that_slips_from_standstill_on_is_an_estimate():
    """0 is a threshold that the library itself begins at; nothing is above the fastest line."""
    h = hypothesis(BY_NAME["slip"], "pull_roll", line=LINE)
    assert h.names == ("slope_s_m", "threshold_m_s")
    assert not h.at_bound([0.002, 0.0])
    assert h.at_bound([0.002, h.high[1]])
    assert h.at_bound([h.high[0], 0.0])
