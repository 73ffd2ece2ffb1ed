"""What a run's line begins with otherwise than at rest is estimated and taken out."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim_plant.lanes import library
from sim_plant.line.reading.load import load_declaration
from sim_plant.refine.fit.start_states import changes_by_starts, shown_directions, with_start_state
from sim_plant.refine.model import cases_in_lanes
from sim_plant.refine.model.cases_in_lanes import attempt, simulated
from sim_plant.refine.model.simulation_pool import SimulationPool
from sim_plant.refine.model.start_state import StartOffset, start_offsets
from sim_plant.refine.model.twin import Case, Twin
from sim_plant.refine.noise.innovations import noise_model

LINE = load_declaration(Path(__file__).parents[4] / "config/lines/euclid.yaml")
STEP_S = LINE.sample_time_s
ROWS = 4000
SPEED_M_S = 1.0
FOLLOWER = "swrap_follower"
CHANNELS = ("pullroll_tension_N", "unwind_tension_N", "pull_roll_speed_m_s", "unwind_angle_rad")


def twin(*, rested: bool = False) -> Twin:
    """Return 20 s at one speed."""
    return Twin(
        declaration=LINE,
        channels=CHANNELS,
        speed_m_s=np.full(ROWS, SPEED_M_S),
        tension_N=np.full(ROWS, 89.0),
        aff_m_s={},
        speed_holds=True,
        rested=rested,
    )


@pytest.fixture(scope="module")
def pool():
    with SimulationPool([twin()], workers=1) as one:
        yield one


def white_noise(size=0.1):
    runs = size * np.random.default_rng(1).standard_normal((2, len(CHANNELS), ROWS))
    return noise_model(runs, 1000, np.zeros(len(CHANNELS)))


def test_what_the_drives_of_an_s_wrap_hold_outlasts_what_the_web_behind_them_holds(pool):
    held = [StartOffset(roller=r, of="drive", tension_N=2.0) for r in ("swrap_lead", FOLLOWER)]
    rest, begun = pool.run([Case(), Case(start=tuple(held))])
    change = (begun[0] - rest[0])[0]
    first, last = (float(np.mean(change[k : k + 400])) for k in (0, 3600))
    body = LINE.body
    zone_m = sum(s.length_m for s in LINE.spans[body(FOLLOWER) : body("pull_roll")])
    assert zone_m == pytest.approx(3.2)
    assert abs(first) > 1.0
    assert last / first > 30.0 * np.exp(-18.0 * SPEED_M_S / zone_m)  # own derivation: L/v


def test_a_record_shows_how_its_line_began(pool):
    case = Case()
    truth = replace(
        case,
        start=(
            StartOffset(roller="swrap_lead", of="drive", tension_N=-3.0),
            StartOffset(roller="swrap_follower", of="zone", tension_N=4.0),
        ),
    )
    rest, begun = (run[0] for run in pool.run([case, truth]))
    noise = white_noise()
    measured = begun + 0.1 * np.random.default_rng(2).standard_normal(begun.shape)
    changes = changes_by_starts(pool, case, (rest,))
    assert len(changes) == len(start_offsets(LINE))
    found = with_start_state(pool.twins[0], rest, measured, changes, noise)
    judged = slice(noise.first, None)
    before = float(np.max(np.abs((begun - rest)[0, judged])))
    after = float(np.max(np.abs((begun - found)[0, judged])))
    assert before > 0.3
    assert after < 0.03


def test_a_line_that_rested_before_its_record_has_no_start_to_be_found():
    rested = twin(rested=True)
    with SimulationPool([rested], workers=1) as pool:
        run = np.ones((len(CHANNELS), ROWS))
        assert changes_by_starts(pool, Case(), (run,)) == ()
        assert pool.simulations == 0
        assert with_start_state(rested, run, 2.0 * run, (), white_noise()) is run


def test_beside_a_run_a_record_before_which_the_line_rested_has_no_columns():
    with SimulationPool([twin(), twin(rested=True)], workers=1) as pool:
        runs = tuple(pool.one(Case()))
        changes = changes_by_starts(pool, Case(), runs)
    assert all(np.any(ours) and not np.any(rested) for ours, rested in changes[1:3])


def test_only_what_is_above_noise_is_a_direction():
    rows = np.eye(6)[:, :3]
    columns = np.column_stack([5.0 * rows[:, 0], 5.0 * rows[:, 0] + 0.2 * rows[:, 1], rows[:, 2]])
    directions = shown_directions(columns * np.array([1.0, 1.0, 3.0]))
    # the difference of the first two is 0.14 of a standard deviation
    assert directions.shape == (6, 2)
    assert directions.T @ directions == pytest.approx(np.eye(2), abs=1e-9)
    assert shown_directions(np.zeros((6, 3))).shape == (6, 0)


def test_side_by_side_a_line_begins_as_one_by_one(monkeypatch):
    lanes = next((found for name in library.BUILDS if (found := library.loaded(name))), None)
    if lanes is None:
        pytest.skip("no binary for lanes here")
    monkeypatch.setattr(cases_in_lanes, "fitting", lambda _lines: lanes)
    short = replace(twin(), speed_m_s=np.full(300, 1.0), tension_N=np.full(300, 89.0))
    cases = [Case(start=(offset,)) for offset in start_offsets(LINE)[:: len(LINE.control.drives)]]
    assert {offset.of for case in cases for offset in case.start} == {"drive", "zone"}
    for case, beside in zip(cases, simulated(short, 0, cases), strict=True):
        alone, rest = attempt(short, case), attempt(short, Case())
        scale = np.max(np.abs(alone), axis=1, keepdims=True)
        assert np.max(np.abs(alone - beside) / scale) < 1e-9
        assert np.max(np.abs(alone - rest)) > 1e-4
