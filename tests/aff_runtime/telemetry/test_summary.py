"""The running statistics against numpy on the whole record."""

from __future__ import annotations

import numpy as np
import pytest

from aff_runtime.telemetry.summary import ColumnStatistics, RunSummary


def test_statistics_in_batches_equal_those_of_the_whole() -> None:
    rows = np.random.default_rng(3).normal(1e6, 2.0, (500, 2))
    rows[10, 1] = np.nan
    statistics = ColumnStatistics(2)
    for part in np.split(rows, [1, 17, 18, 300]):
        statistics.add(part)
    result = statistics.result(["a_N", "b_N"])
    for i, name in enumerate(("a_N", "b_N")):
        assert result[name]["mean"] == pytest.approx(np.nanmean(rows[:, i]), rel=1e-6)
        assert result[name]["sd"] == pytest.approx(np.nanstd(rows[:, i]), rel=1e-6)
        assert result[name]["max"] == pytest.approx(np.nanmax(rows[:, i]), rel=1e-6)


def test_rows_are_grouped_by_the_name_of_their_state() -> None:
    summary = RunSummary(["time_s", "state", "tension_N"], ["FAULT", "OFF"])
    summary.add([(0.0, 0.0, 5.0), (0.1, 1.0, 7.0), (0.2, 1.0, 9.0)])
    result = summary.result()
    assert result.rows_by_state == {"FAULT": 1, "OFF": 2}
    assert result.columns_by_state["OFF"]["tension_N"]["mean"] == 8.0
    assert result.columns_by_state["FAULT"]["tension_N"]["mean"] == 5.0


def test_percentiles_of_timing_are_within_one_bin_of_exact() -> None:
    values = np.random.default_rng(4).lognormal(4.0, 1.0, 5000)
    summary = RunSummary(["time_s", "wake_us"], [])
    summary.add([(0.0, float(v)) for v in values])
    timing = summary.result().timing_us["wake_us"]
    assert timing["p50"] == pytest.approx(np.percentile(values, 50), rel=0.06)
    assert timing["p99"] == pytest.approx(np.percentile(values, 99), rel=0.06)
    assert timing["max"] == pytest.approx(values.max(), rel=1e-6)


def test_a_column_that_never_had_a_number_is_left_out() -> None:
    summary = RunSummary(["time_s", "x_N"], [])
    summary.add([(0.0, float("nan"))])
    assert "x_N" not in summary.result().columns_by_state["ALL"]
