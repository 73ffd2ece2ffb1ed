"""What a look told is set beside what its line hides; a page says what is there, and no more."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from benchmarks.fleet.page import page
from benchmarks.fleet.scored import Scored, fate_of, in_order
from sim_plant.fleet.example import GROWTH
from sim_plant.fleet.findings import write_parquet
from sim_plant.fleet.refine_look import LookResult
from sim_plant.line.declared.declaration import EffectEntry
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.report.verdict import (
    Ambiguity,
    ChannelRms,
    EffectFinding,
    UnknownFinding,
    Verdict,
)
from tests.each_case import each_case

TRUE, OTHER = EffectAt("eccentric_roller", "R6"), EffectAt("eccentric_roller", "R7")
HIDDEN = EffectEntry(
    effect=TRUE.effect, location=TRUE.location, parameters={"cos_m": 3e-4, "sin_m": -4e-4}
)
LEFT = UnknownFinding(unknown_class="time", coordinate={"frequency_Hz": 3.0}, chi2_reduction=200.0)


def told(*places: EffectAt, size_m: float = 5e-4, **more: object) -> Verdict:
    """Return a verdict that names effects, each of a size to a fiftieth."""
    effects = tuple(
        EffectFinding(
            place=at,
            parameters={"eccentricity_m": size_m},
            interval95={"eccentricity_m": (0.98 * size_m, 1.02 * size_m)},
            score=100.0,
            runner_up=None,
            margin=9.0,
            cancel=True,
            text="",
        )
        for at in places
    )
    given = {"answer": "traced" if places else "nothing", "unknown": (), "ambiguous": ()} | more
    return Verdict(effects=effects, residual_rms={}, holdout="b.csv", **given)


def alike(said: EffectAt, *others: EffectAt) -> dict[str, object]:
    one = Ambiguity(place=said, alternatives=others, experiments=("run faster",))
    return {"answer": "not_identifiable", "ambiguous": (one,)}


def look(verdict: Verdict | None, day: str = "2026-09-28") -> LookResult:
    return LookResult(line="line0001", recorded=day, verdict=verdict, error="", time_s=36.0)


def test_what_is_told_in_the_place_of_another_stands_there_with_the_error_it_leaves():
    left = {"r3_tension_N": ChannelRms(before=9.0, after=5.5, noise_floor=0.25)}
    wrong = Scored(result=look(replace(told(OTHER), residual_rms=left)), hidden=HIDDEN)
    text = page([wrong], 200, None, None, None)
    row = "| line0001 | eccentric_roller at R6 | traced | eccentric_roller at R7, named | 22.0 |"
    assert row in text
    right = Scored(result=look(told(TRUE)), hidden=HIDDEN)
    assert "Told as another" not in page([right], 200, None, None, None)


def test_a_look_costs_what_it_took_of_a_core_where_that_was_counted():
    counted = [replace(look(told()), cpu_s=cpu_s) for cpu_s in (9.0, 18.0, 27.0)]
    text = page([Scored(result=r, hidden=None) for r in counted], 200, None, None, None)
    assert "took 18 s in the median, 9 to 27 s" in text
    assert "by the clock 36 s in the median" in text
    assert "25 h of a core: 2.5 cores" in text  # 5000 looks of 18 s
    without = [*counted, look(told())]
    text = page([Scored(result=r, hidden=None) for r in without], 200, None, None, None)
    assert "50 h of a core: 5.0 cores" in text  # 36 s each by the clock


@each_case(
    ("verdict", "fate"),
    [
        (told(TRUE), "named"),
        (told(TRUE, **alike(TRUE, OTHER)), "one of several"),
        (told(OTHER, **alike(OTHER, TRUE)), "one of several"),
        (told(TRUE, OTHER), "beside others"),
        (told(TRUE, answer="unknown", unknown=(LEFT,)), "beside others"),
        (told(OTHER), "another"),
        (told(answer="unknown", unknown=(LEFT,)), "unknown"),
        (told(), "missed"),
    ],
)
def test_a_verdict_is_one_of_these_beside_the_truth(verdict, fate):
    assert fate_of(verdict, TRUE) == fate
    assert Scored(result=look(verdict), hidden=HIDDEN).fate == fate


def test_of_a_healthy_line_anything_said_is_a_claim():
    assert Scored(result=look(told()), hidden=None).fate == "nothing"
    assert Scored(result=look(told(TRUE)), hidden=None).fate == "claimed"
    assert Scored(result=look(None), hidden=None).fate == "failed"


@pytest.mark.parametrize(("size_m", "holds"), [(5e-4, True), (5.2e-4, False), (4.8e-4, False)])
def test_an_interval_is_held_against_the_size_of_both_components(size_m, holds):
    assert math.hypot(3e-4, 4e-4) == pytest.approx(5e-4)
    assert Scored(result=look(told(TRUE, size_m=size_m)), hidden=HIDDEN).holds is holds


def test_what_is_not_rightly_named_has_no_interval_to_judge():
    assert Scored(result=look(told(OTHER)), hidden=HIDDEN).holds is None
    assert Scored(result=look(told()), hidden=None).holds is None


def test_a_growing_effect_is_as_large_as_on_the_day_also_where_a_look_is_missing():
    days = ("2026-10-19", "2026-09-28", "2026-10-05")  # three weeks on, at first, one week on
    found = in_order(HIDDEN, [look(told(TRUE), day) for day in days])
    assert [s.result.recorded for s in found] == sorted(days)
    sizes = [s.hidden.parameters["cos_m"] for s in found]
    assert sizes == pytest.approx([3e-4 * GROWTH**weeks for weeks in (0, 1, 3)])


def test_the_page_counts_what_is_there_and_leaves_out_what_was_not_measured(tmp_path):
    days = ("2026-09-28", "2026-10-05", "2026-10-12", "2026-10-19")
    results = [look(told(TRUE, size_m=5e-4 * GROWTH**k), d) for k, d in enumerate(days)]
    scored = [*in_order(HIDDEN, results), Scored(result=look(told()), hidden=None)]
    table = tmp_path / "fleet.parquet"
    write_parquet([f for s in scored for f in s.findings], table)
    text = page(scored, 200, table, None, None)
    assert "5 looks at 1 lines of 200; 4 looks hide an effect" in text
    assert "| eccentric_roller | 4 | 4 |  |  |  |  |  |  | 4 of 4 |" in text
    assert "Of 1 looks at healthy lines 1 are told to lack nothing" in text
    assert "Of 1 lines with a growing effect and more than one look, 1 are told to grow" in text
    assert "| eccentric_roller | 1 | 0.000703 m |" in text  # between weeks one and two
    assert "50 h of a core: 5.0 cores" in text  # 5000 looks of 36 s
    assert "Scaling" not in text
    assert "lost worker" not in text


def test_the_page_says_where_tables_differ_and_no_worker_was_killed():
    walls = {"1": 300.0, "2": 160.0}
    scaling = {"looks": 8, "cores": 2, "walls_s": walls, "each_s": walls, "tables_alike": False}
    lost = {"looks": 4, "killed": False, "rows": 3, "alike": False}
    text = page([], 200, None, scaling, lost)
    assert "| 2 | 160 s | 160 s | 1.88 |" in text
    assert "the tables **differ**" in text
    assert "**no worker was killed**: 3 of 4 looks have a row" in text
    assert "is **another than** that of a run in peace" in text
    assert "What was told" not in text
