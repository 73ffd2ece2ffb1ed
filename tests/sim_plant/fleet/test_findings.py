"""From verdicts to the table of a fleet."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from sim_plant.fleet.findings import findings_of, slope_of, with_trends, write_parquet
from sim_plant.fleet.refine_look import LookResult
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.report.verdict import (
    Ambiguity,
    ChannelRms,
    EffectFinding,
    UnknownFinding,
    Verdict,
)

RMS = {
    "unwind_tension_N": ChannelRms(before=2.0, after=1.1, noise_floor=1.0),
    "r3_tension_N": ChannelRms(before=0.9, after=0.6, noise_floor=0.3),
    "line_speed_m_s": ChannelRms(before=9.0, after=9.0, noise_floor=1.0),
}
R6 = EffectAt("eccentric_roller", "R6")


def look(answer="traced", error="", **found):
    parts = {"effects": (), "unknown": (), "ambiguous": ()} | found
    verdict = Verdict(answer=answer, residual_rms=RMS, holdout="b.csv", **parts)
    return LookResult(
        line="film1",
        recorded="2026-11-20",
        verdict=None if error else verdict,
        error=error,
        time_s=1.0,
    )


def traced(low=0.9e-4, high=1.1e-4):
    return EffectFinding(
        place=R6,
        parameters={"eccentricity_m": 1e-4, "angle_rad": 0.3},
        interval95={"eccentricity_m": (low, high)},
        score=900.0,
        runner_up=None,
        margin=900.0,
        cancel=True,
        text="",
    )


def test_an_effect_has_its_amplitude_its_unit_and_what_to_do():
    (found,) = findings_of(look(effects=(traced(),)))
    assert (found.effect, found.place, found.number) == (
        "eccentric_roller",
        "R6",
        "eccentricity_m",
    )
    assert (found.size, found.size_low, found.size_high) == (1e-4, 0.9e-4, 1.1e-4)
    assert found.sure == "named"
    assert "dial gauge on R6" in found.to_do
    assert (found.error_before, found.error_after) == (pytest.approx(3.0), pytest.approx(2.0))


def test_one_of_several_says_how_to_tell_them_apart():
    beside = EffectAt("eccentric_roller", "R5")
    same = Ambiguity(place=R6, alternatives=(beside,), experiments=("turn R6 by hand",))
    (found,) = findings_of(look(effects=(traced(),), ambiguous=(same,)))
    assert found.sure == "one of several"
    assert found.to_do == "to tell it from eccentric_roller at R5: turn R6 by hand"


def test_nothing_unknown_and_a_failure_have_a_row_each():
    line = UnknownFinding(
        unknown_class="time", coordinate={"frequency_Hz": 0.3917321}, chi2_reduction=9.0
    )
    (nothing,) = findings_of(look("nothing"))
    (unknown,) = findings_of(look("unknown", unknown=(line,)))
    (failed,) = findings_of(look(error="film1.yaml: no roller R9"))
    assert (nothing.verdict, nothing.effect) == ("nothing", "")
    assert (unknown.effect, unknown.place) == ("unknown, time", "frequency_Hz 0.3917")
    assert (failed.verdict, failed.to_do) == ("failed", "film1.yaml: no roller R9")


def grown(sizes, half=2e-6, days=(1, 8, 15, 22)):
    (one,) = findings_of(look(effects=(traced(),)))
    return [
        replace(one, recorded=f"2026-11-{d:02d}", size=s, size_low=s - half, size_high=s + half)
        for d, s in zip(days, sizes, strict=True)
    ]


def test_a_straight_growth_has_the_slope_of_a_weighted_line():
    series = grown([1.00e-4, 1.12e-4, 1.19e-4, 1.32e-4])
    days = [1.0, 8.0, 15.0, 22.0]
    slope, deviation = slope_of(series)
    peer = stats.linregress(days, [f.size for f in series])  # equal weights: the same line
    assert slope == pytest.approx(peer.slope)
    sd = 2e-6 / stats.norm.ppf(0.975)
    from_intervals = sd / np.sqrt(np.sum((np.array(days) - np.mean(days)) ** 2))
    assert deviation == pytest.approx(max(from_intervals, peer.stderr), rel=1e-6)
    *others, last = with_trends(series)
    assert last.trend == pytest.approx(30.0 * slope)
    assert last.trend_low < last.trend < last.trend_high
    assert np.isnan([f.trend for f in others]).all()


def test_what_the_intervals_allow_is_no_trend_nor_are_two_days():
    assert np.isnan(
        [f.trend for f in with_trends(grown([1.0e-4, 1.01e-4, 1.0e-4, 1.01e-4]))]
    ).all()
    two = grown([1e-4, 9e-4], days=(1, 8))
    assert np.isnan([f.trend for f in with_trends(two)]).all()


def test_another_place_is_another_series():
    moved = [
        replace(f, place=p) for f, p in zip(grown([1e-4, 2e-4, 3e-4, 4e-4]), "abab", strict=True)
    ]
    assert np.isnan([f.trend for f in with_trends(moved)]).all()


def test_a_size_under_another_line_file_is_another_series():
    grows = grown([1e-4, 2e-4, 3e-4, 4e-4])
    assert np.isfinite(with_trends([replace(f, declared="one") for f in grows])[-1].trend)
    two = [replace(f, declared=d) for f, d in zip(grows, "aabb", strict=True)]
    assert np.isnan([f.trend for f in with_trends(two)]).all()


def of(effect, place, **numbers):
    found = replace(traced(), place=EffectAt(effect, place), parameters=numbers)
    (one,) = findings_of(look(effects=(replace(found, interval95={}),)))
    return one


def test_two_of_a_kind_at_one_place_are_told_apart_by_order_or_frequency():
    """Each of two grows by itself; one steady size each is no change, however far apart."""
    hum = {"amplitude_N": 1.0}
    tones = [
        of("mains_hum", "R9", frequency_Hz=50.0, **hum).tone,
        of("mains_hum", "R9", frequency_Hz=99.9, **hum).tone,
        of("torque_ripple", "R1", order=6.0, amplitude_N_m=1.0).tone,
        of("eccentric_roller", "R6", eccentricity_m=1e-4).tone,
    ]
    assert tones[:3] == [50.0, 99.9, 6.0]
    assert np.isnan(tones[3])
    small, large = grown([1e-4] * 4), grown([9e-4, 8e-4, 7e-4, 6e-4])
    both = [
        *(replace(f, tone=50.0 + 0.1 * at) for at, f in enumerate(small)),
        *(replace(f, tone=100.0 - 0.1 * at) for at, f in enumerate(large)),
    ]
    told = with_trends(both)
    assert np.isnan([f.trend for f in told[:7]]).all()
    assert told[7].trend == pytest.approx(-30.0 * 1e-4 / 7.0)


def test_the_parquet_file_reads_back_with_days_and_the_meaning_of_its_columns(tmp_path):
    import pyarrow.parquet as pq

    rows = [*findings_of(look(effects=(traced(),))), *findings_of(look("nothing"))]
    write_parquet(rows, tmp_path / "fleet.parquet")
    table = pq.read_table(tmp_path / "fleet.parquet")
    assert table.column("size").to_pylist()[0] == 1e-4
    assert table.column("recorded").to_pylist()[0].isoformat() == "2026-11-20"
    assert b"SI" in table.schema.metadata[b"units"]
    assert table.num_rows == 2


def test_a_table_without_rows_has_the_same_columns(tmp_path):
    import pyarrow.parquet as pq

    write_parquet([], tmp_path / "none.parquet")
    write_parquet([*findings_of(look(effects=(traced(),)))], tmp_path / "one.parquet")
    none, one = (pq.read_table(tmp_path / f"{name}.parquet") for name in ("none", "one"))
    assert none.num_rows == 0
    assert none.schema == one.schema
    assert str(none.schema.field("recorded").type) == "date32[day]"
