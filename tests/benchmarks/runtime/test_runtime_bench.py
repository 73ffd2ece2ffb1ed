"""The bench counts what it says it counts."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from aff_runtime.core.response import MAX_PHASE_ERROR_RAD, Response
from benchmarks.runtime.facts import FactRow, Section, quantiles_us, timing_row
from benchmarks.runtime.instructions import costs_of_calls
from benchmarks.runtime.latency import parse
from benchmarks.runtime.paced import law_of, law_step
from benchmarks.runtime.page import judged, markdown, read, text
from benchmarks.runtime.parts import Stopwatch, respond, table
from benchmarks.runtime.reckoned import carried_ms
from benchmarks.runtime.shape_time import ratios, shape_work
from benchmarks.runtime.targets import targets
from tests.house.documents import ROOT

CYCLICTEST = """# Histogram
000000 000000
000003 000050
000004 000049
000200 000001
# Total: 000000100
# Min Latencies: 00003
# Avg Latencies: 00005
# Max Latencies: 00200
# Histogram Overflows: 00000
"""


def test_the_histogram_of_cyclictest_gives_its_quantiles() -> None:
    found = parse(CYCLICTEST)
    assert (found.p50_us, found.p99_us, found.max_us) == (3.0, 4.0, 200.0)
    assert not found.reason


def test_no_histogram_is_a_reason_and_not_a_number() -> None:
    found = parse("unable to set scheduler\n")
    assert found.reason
    assert math.isnan(found.p99_us)


def test_durations_become_quantiles_in_microseconds() -> None:
    p50, p99, most = quantiles_us([1000 * k for k in range(101)])
    assert (p50, p99, most) == (50.0, 99.0, 100.0)
    assert timing_row("x", [2000, 2000]).value == "p50 2 us, p99 2 us, max 2 us"


@pytest.mark.parametrize("blocks", [1, 16, 64])
def test_the_timed_law_has_that_many_blocks_and_all_of_them_may_adapt(blocks: int) -> None:
    names = law_of(blocks).telemetry_names()
    assert sum(name.endswith(".state") for name in names) == blocks
    step = law_step(blocks)
    for tick in range(20):
        step(tick)


def test_page_and_table_carry_every_row() -> None:
    section = Section(title="T", note="n", rows=(FactRow(name="a", value="1 us", remark="r"),))
    assert "a                        1 us  (r)" in text([section])
    page = markdown([section], date="2026-01-02T03:04:05Z")
    assert "| a | 1 us | r |" in page
    assert "2026-01-02" in page


def test_the_timed_shape_law_has_its_orders_and_learns_them() -> None:
    law, line, step = shape_work(4)
    assert law.weight.size == 4 + 1 + 1  # orders, S-wrap 1x, imbalance
    for tick in range(1500):  # six turns
        line(tick)
        step(tick)
    assert law.adapting
    assert law.monitor.calm
    assert law.monitor.now[0] < 0.1  # N, of 1 N without a correction


def test_ratios_are_of_medians_of_one_run() -> None:
    found = {
        ("numpy", 16): [4000, 4000],
        ("numpy", 24): [6000],
        ("compiled", 16): [1000],
        ("compiled", 24): [2000],
    }
    assert [row.value for row in ratios(found)] == [
        "p50 4.0, p99 4.0",
        "p50 3.0, p99 3.0",
        "1.50",
        "2.00",
    ]
    numpy_alone = {key: value for key, value in found.items() if key[0] == "numpy"}
    assert [row.value for row in ratios(numpy_alone)] == ["1.50"]


def test_a_part_inside_another_is_taken_out_of_it() -> None:
    clock = iter([0, 10, 14, 20, 27, 100])  # begins and ends, as they are asked for
    watch = Stopwatch(lambda: next(clock))
    codec = watch.around(lambda: None, "codec")
    watch.around(lambda: (codec(), codec()), "wire")()
    assert watch.take() == {"codec": 4 + 7, "wire": 100 - 11}
    assert watch.take() == {}


def test_the_table_of_parts_adds_them_up_tick_by_tick() -> None:
    found = {("numpy", "law"): [3000, 1000], ("numpy", "ring"): [1000, 1000]}
    rows = {row.name: row.value for row in table(found)}
    assert rows["law, by numpy"].startswith("p50 2 us")
    assert rows["all, by numpy"] == "p50 3 us, p99 4 us, max 4 us"


def test_the_written_response_is_that_of_the_declared_line(tmp_path: Path) -> None:
    respond(tmp_path)
    text = (tmp_path / "learned" / "euclid_unwind.json").read_text(encoding="utf-8")
    found = Response.from_json(text)
    # the tension loop takes slow pushes away
    assert abs(found.at(0.2)) < abs(found.at(2.0))
    assert found.phase_error_bound_rad(2.0) < MAX_PHASE_ERROR_RAD


def test_calls_through_the_door_of_a_part_cost_what_runs_inside() -> None:
    """Names are given once; a door inside a door has a level of recursion in its name."""
    counts = """fn=(1) cfunction_call
12 30
cfn=(2) guard_door
calls=2 7
12 500
cfn=(3) law_door
calls=1 7
12 900
fn=(3)
7 11
cfn=(4) PyObject_Call
calls=1 4
7 870
fn=(5) cfunction_call'2
cfn=(2)
calls=1 7
12 250
cfn=(6) guard_door'2
calls=1 7
12 50
"""
    assert costs_of_calls(counts) == {"guard": 800, "law": 900}


BENCH = [
    Section(
        title="Tick of the law", note="", rows=(FactRow(name="16 blocks", value="p50 41 us"),)
    ),
    Section(
        title="Whole tick of the shape law over a bare FC23",
        note="",
        rows=(
            FactRow(name="whole tick", value="p50 170 us, p99 350 us, max 4 us"),
            FactRow(name="bare FC23", value="p50 100 us, p99 200 us, max 3 us"),
            FactRow(name="ratio p50", value="1.70"),
            FactRow(name="ratio p99", value="1.75"),
        ),
    ),
]


def test_a_target_stands_beside_its_figure_and_says_why_it_is_missed() -> None:
    """A ratio of 1.6 leaves 0.6 of the exchange; what was never measured is no pass."""
    rows = {row.name: row for row in targets(BENCH).rows}
    blocks, whole = rows["16 plain blocks, paced, p50"], rows["whole tick over bare FC23, p50"]
    assert (blocks.value, blocks.remark[:21]) == ("41 us", "at most 40: missed; p")
    assert whole.remark.startswith("at most 1.6: missed; beside a bare exchange of 100 us it")
    assert "leaves 60 us" in whole.remark
    assert whole.remark.endswith("take 70 us")
    assert rows["whole tick over bare FC23, p99"].remark == "at most 1.8: met"
    assert rows["simulated line"].remark == "at least 400: not measured"


def test_a_gateway_carries_the_cycle_of_which_a_tick_takes_half() -> None:
    assert carried_ms(1.0e6, 1.0e9) == 2  # 1 ms a tick: exactly half
    assert carried_ms(1.01e6, 1.0e9) == 5
    assert carried_ms(1.0e6, 1.0e7) is None


def test_the_page_of_speed_says_what_its_own_figures_say() -> None:
    """``python -m benchmarks.runtime --again`` writes it anew."""
    page = (ROOT / "docs" / "results" / "bench.md").read_text(encoding="utf-8")
    date, sections = read(page)
    assert markdown(judged(sections), date=date) == page
