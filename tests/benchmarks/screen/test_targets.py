"""A target that was missed is told as missed, and so is one that was not measured."""

from __future__ import annotations

import math

from benchmarks.runtime.facts import FactRow, Section
from benchmarks.screen.churn import verdict
from benchmarks.screen.targets import of_targets, target
from tests.each_case import each_case


@each_case(
    ("found", "said"), [(60.0, "met"), (60.1, "MISSED"), (math.nan, "MISSED"), (-1.0, "met")]
)
def test_the_bound_itself_is_met_and_what_is_not_known_is_missed(found: float, said: str) -> None:
    assert target("p99 60 ms", (found, 60.0)) == f"target p99 60 ms: {said}"
    assert target("both", (1.0, 2.0), (found, 60.0)) == f"target both: {said}"


def test_every_miss_stands_in_the_list_of_targets() -> None:
    rows = (
        FactRow(name="P6", value="14 ms", remark=target("60 ms", (14.0, 60.0)) + "; of 20"),
        FactRow(name="P7", value="1.3 s", remark=target("1 s", (1.3, 1.0)) + "; cold"),
        FactRow(name="P9", value="not measured", remark="RuntimeError: no browser"),
        FactRow(
            name="P10", value="94 MB", remark=target("150 MB", (94.0, 150.0), is_judged=False)
        ),
        FactRow(name="processor", value="any"),
    )
    found = of_targets([Section(title="", note="", rows=rows)])
    assert [(row.name, row.value) for row in found.rows] == [
        ("met", "1"),
        ("missed", "1"),
        ("missed: P7", "1.3 s"),
        ("too short to judge: P10", "94 MB"),
        ("not measured: P9", "not measured"),
    ]


@each_case(
    ("seconds", "most_MB", "slope_MB_h", "after", "said"),
    [
        (120.0, 94.0, 52.1, (11, 2), "too short to judge"),
        (120.0, 94.0, 52.1, (12, 2), "MISSED"),  # one descriptor more is a miss at once
        (120.0, 151.0, 0.0, (11, 2), "MISSED"),
        (7200.0, 94.0, 0.1, (11, 2), "met"),
        (7200.0, 94.0, 0.2, (11, 2), "MISSED"),
        (7200.0, 94.0, math.nan, (11, 2), "MISSED"),
    ],
)
def test_memory_that_grows_is_judged_over_two_hours_alone(
    seconds: float, most_MB: float, slope_MB_h: float, after: tuple[int, int], said: str
) -> None:
    assert verdict(seconds, most_MB, slope_MB_h, (11, 2), after).endswith(f": {said}")
