"""Cases side by side beside the same cases one by one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim_plant.base.arrays import Array
from sim_plant.base.effects import Effect
from sim_plant.effects.catalogue import CATALOGUE
from sim_plant.lanes import library
from sim_plant.line.arrays.locations import candidate_locations
from sim_plant.line.reading.load import load_declaration
from sim_plant.refine.model import cases_in_lanes
from sim_plant.refine.model.cases_in_lanes import attempt, in_groups, simulated
from sim_plant.refine.model.simulation_pool import SimulationPool
from sim_plant.refine.model.twin import Added, Case, Twin

LINE = load_declaration(Path(__file__).parents[4] / "config/lines/euclid.yaml")
ROWS = 600
CLOSE = 1e-9
"""Of what moves in a channel."""
BUILDS = [
    pytest.param(name, marks=() if name == "avx512" else pytest.mark.long)
    for name in library.BUILDS
]


@pytest.fixture(params=BUILDS)
def build(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> library.Lanes:
    lanes = library.loaded(request.param)
    if lanes is None:
        pytest.skip(f"no binary for {request.param} here, or not for this processor")
    monkeypatch.setattr(cases_in_lanes, "fitting", lambda _lines: lanes)
    return lanes


def twin() -> Twin:
    at = np.arange(ROWS) * LINE.sample_time_s
    return Twin(
        declaration=LINE,
        channels=tuple(sensor.channel for sensor in LINE.sensors),
        speed_m_s=1.0 + 0.05 * np.sin(4.0 * at) + 0.1 * (at > 1.0),
        tension_N=np.where(at > 1.5, 99.0, 89.0),
        aff_m_s={"unwind": 0.005 * np.sin(9.0 * at)},
        word_steps={"unwind_tension_N": 0.05},
    )


def drawn(rng: np.random.Generator, rows: list[Effect], quick: bool) -> list[Case]:
    """Return cases with one drawn effect each and, some of them, ripples, shifts and noise."""
    seed = int(rng.integers(1, 99))
    return [
        Case(
            effects=(_drawn_effect(rng, row),),
            ripples=((int(rng.integers(0, 3)), int(rng.integers(0, 4)), 2e-5, 1e-5),)
            * int(rng.integers(0, 2)),
            shifts=(("web.EA_N", float(rng.uniform(-0.02, 0.02))),) * int(rng.integers(0, 2)),
            seed=seed + number if rng.integers(0, 2) else None,
            quick=quick,
        )
        for number, row in enumerate(rows)
    ]


def _drawn_effect(rng: np.random.Generator, row: Effect) -> Added:
    share = rng.uniform(0.01, 0.02)
    put = {
        name: (1.0 - share) * float(given.default) + share * given.typical
        for name, given in row.accepts.items()
        if given.role == "strength"
    }
    if row.onset is not None:
        put[row.onset.moment] = float(rng.uniform(0.5, 2.0))
    place = str(rng.choice(candidate_locations(LINE, row)))
    return Added(row.name, place, tuple(put.items()))


def worst(one: Array, other: Array) -> float:
    """Return the largest difference as a share of what moves in its channel."""
    moves = np.std(one, axis=1, keepdims=True) + 1e-6 * np.abs(one).max(axis=1, keepdims=True)
    return float(np.max(np.abs(one - other) / moves))


@pytest.mark.parametrize("quick", [True, pytest.param(False, marks=pytest.mark.long)])
@pytest.mark.parametrize("draw", [1, *(pytest.param(n, marks=pytest.mark.long) for n in (2, 3))])
def test_side_by_side_is_one_by_one_to_a_billionth_of_the_ripple(
    draw: int, quick: bool, build: library.Lanes
) -> None:
    rng, mine = np.random.default_rng(draw), twin()
    cases = drawn(rng, [CATALOGUE[i] for i in rng.permutation(len(CATALOGUE))], quick)
    for number, group in in_groups([(0, case) for case in cases], build.width):
        for case, record in zip(group, simulated(mine, number, group), strict=True):
            assert worst(attempt(mine, case), record) < CLOSE, case


def test_loops_are_limited_side_by_side_as_one_by_one(build: library.Lanes) -> None:
    """One limit differs from the next, and one line has none."""
    limits = [(("slew_m_s2", 0.02 * number), ("limits", "loop")) for number in range(build.width)]
    cases = [Case(effects=(Added("rate_limit", "unwind", limit),)) for limit in limits]
    mine = twin()
    records = simulated(mine, 0, tuple(cases))
    for case, record in zip(cases, records, strict=True):
        assert worst(attempt(mine, case), record) < CLOSE, case
    assert worst(records[0], records[1]) > 0.01


def test_a_line_that_diverges_leaves_the_others_as_they_are(build: library.Lanes) -> None:
    mine = twin()
    wild = Case(shifts=(("control.drives.1.K_ref_rad_s", 1e9),))
    calm = [Case(ripples=((0, k, 1e-5, 0.0),)) for k in range(1, build.width)]
    records = simulated(mine, 0, (wild, *calm))
    assert np.isnan(records[0]).all()
    for case, record in zip(calm, records[1:], strict=True):
        assert worst(attempt(mine, case), record) < CLOSE


def test_what_is_no_line_is_no_record(build: library.Lanes) -> None:
    mine, nowhere = twin(), Added("slip", "nowhere", ())
    records = simulated(mine, 0, (Case(effects=(nowhere,)), Case(), Case(seed=3)))
    assert np.isnan(records[0]).all()
    assert all(np.isfinite(record).all() for record in records[1:])


def test_groups_hold_one_record_one_tick_and_noise_or_none() -> None:
    jobs = [
        (number, Case(seed=seed, quick=quick))
        for number in (0, 1)
        for seed in (None, 1, 2, 3)
        for quick in (True, False)
    ]
    groups = in_groups(jobs, 2)
    assert sorted((n, c.seed or 0, c.quick) for n, group in groups for c in group) == sorted(
        (n, c.seed or 0, c.quick) for n, c in jobs
    )
    for _number, group in groups:
        assert len(group) <= 2
        assert len({(case.quick, case.seed is None) for case in group}) == 1


@pytest.mark.long
def test_two_processes_give_the_numbers_of_one() -> None:
    cases = drawn(np.random.default_rng(4), list(CATALOGUE), quick=True)
    found = []
    for workers in (1, 2):
        with SimulationPool([twin()], workers) as pool:
            found.append([run[0] for run in pool.run(cases)])
    for one, two in zip(*found, strict=True):
        assert np.array_equal(one, two)


def test_a_case_has_the_same_bits_in_every_company_and_in_every_binary(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    builds = [lanes for lanes in map(library.loaded, library.BUILDS) if lanes is not None]
    if not builds:
        pytest.skip("no binary here")
    mine = twin()
    cases = drawn(np.random.default_rng(8), list(CATALOGUE[:7]), quick=True)
    cases = [replace(case, seed=None) for case in cases]
    found = []
    for lanes in builds:
        monkeypatch.setattr(cases_in_lanes, "fitting", lambda _lines, lanes=lanes: lanes)
        found += [simulated(mine, 0, cases), [simulated(mine, 0, [c])[0] for c in cases]]
    for records in found[1:]:
        for one, other in zip(found[0], records, strict=True):
            assert np.array_equal(one, other)
