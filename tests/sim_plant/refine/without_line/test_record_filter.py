import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.cli.main import main
from sim_plant.line.reading.load import read_source
from sim_plant.refine.report.outcome import RefineRequest
from sim_plant.refine.without_line.pipeline import refine_records
from sim_plant.refine.without_line.record_filter import read_stamped, record_declaration_in

ROOT = Path(__file__).parents[4]
SHARED = ROOT.parent / "shared/data"
if not SHARED.exists():
    SHARED = ROOT.parents[1] / "shared/data"

DECLARATION = """\
schema: record-declaration/1
sample_time_s: 0.01
outputs: [moment_N_m]
inputs: [belt_m_s]
derivative_of_inputs: true
taps: 10
travel_speed: belt_m_s
"""


def smooth(rng, size, width):
    return np.convolve(rng.standard_normal(size + width - 1), np.ones(width) / width, "valid")


def write_belt(path, seed, speed, wavenumber=1.6, amplitude=0.4, size=6000):
    rng = np.random.default_rng(seed)
    belt = speed + 2.0 * smooth(rng, size, 100)
    travel = np.cumsum(belt) * 0.01
    moment = 3.0 * np.gradient(belt, 0.01) + amplitude * np.cos(
        2.0 * np.pi * wavenumber * travel + rng.uniform(0.0, 6.28)
    )
    moment += rng.standard_normal(size)
    table = np.column_stack([np.arange(size) * 0.01, moment, belt])
    np.savetxt(path, table, "%.6f", ",", header="time_s,moment_N_m,belt_m_s", comments="")
    return path


def declared_in(path):
    return record_declaration_in(read_source(path))


def refined(plan):
    return refine_records(plan, declared_in(plan.line), lambda _: None)


@pytest.fixture
def plan(tmp_path):
    (tmp_path / "belt.yaml").write_text(DECLARATION)
    records = [write_belt(tmp_path / f"{k}.csv", k, v) for k, v in enumerate((1.2, 2.0, 1.4))]
    return RefineRequest(
        line=tmp_path / "belt.yaml",
        records=tuple(records[:2]),
        holdout=(records[2],),
        out=tmp_path / "out",
    )


def test_a_travel_line_is_found_with_its_radius_and_judged_held_out(plan):
    result = refined(plan)
    assert [x.axis for x in result.unknown] == ["travel"]
    where = result.unknown[0].where
    assert where["equivalent_radius_m"] == pytest.approx(1.0 / (2.0 * np.pi * 1.6), rel=0.003)
    row = result.residual_rms["moment_N_m"]
    assert row.before == pytest.approx(np.sqrt(1.0 + 0.08), rel=0.02)
    assert row.after == pytest.approx(1.0, rel=0.02)
    written = json.loads((plan.out / "verdict.json").read_text())
    assert written["verdict"] == "unknown"
    assert written["effects"] == []
    page = (plan.out / "report.html").read_text()
    assert "equivalent_radius_m" in page
    assert "Unknown, strongest first: something that repeats every 62" in page  # 1 / 1.6 m
    assert f"Command: <code>sim-plant refine {plan.line} {plan.records[0]}" in page
    assert "on the held-out record" in page


def test_no_line_no_claim(plan, tmp_path):
    quiet = [write_belt(tmp_path / f"q{k}.csv", 10 + k, 1.3, amplitude=0.0) for k in (0, 1)]
    still = RefineRequest(line=plan.line, records=tuple(quiet), holdout=(), out=tmp_path / "quiet")
    assert refined(still).answer == "nothing"
    page = (still.out / "report.html").read_text()
    assert "Nothing found: what the declared filter leaves" in page
    assert "no proof" in page
    assert "travel_speed" not in page  # it is declared


def test_the_example_needs_a_line(plan, tmp_path, capsys):
    assert main(["refine", str(plan.line), "--example", "--out", str(tmp_path / "x")]) == 2
    assert "declares records; --example needs a line" in capsys.readouterr().err
    assert not (tmp_path / "x").exists()


@pytest.mark.long
def test_of_two_held_out_records_the_first_is_judged_and_that_is_said(plan, tmp_path):
    held = tuple(write_belt(tmp_path / f"h{k}.csv", 20 + k, 1.3, amplitude=0.0) for k in (0, 1))
    two = RefineRequest(line=plan.line, records=plan.records, holdout=held, out=tmp_path / "two")
    result = refined(two)
    assert result.holdout == str(held[0])
    said = "more than one held-out record: the errors are those of h0.csv"
    assert said in result.not_claimed


def test_a_missing_column_is_refused_and_nothing_written(plan, tmp_path, capsys):
    bad = tmp_path / "bad.csv"
    bad.write_text(plan.records[0].read_text().replace("belt_m_s", "band_m_s", 1))
    code = main(["refine", str(plan.line), str(bad), "--out", str(tmp_path / "none")])
    assert code == 2
    assert "column belt_m_s is missing" in capsys.readouterr().err
    assert not (tmp_path / "none").exists()


def test_another_sample_time_is_refused(plan, tmp_path):
    other = tmp_path / "slow.yaml"
    other.write_text(DECLARATION.replace("0.01", "0.02"))
    with pytest.raises(PlantError, match="correct sample_time_s"):
        read_stamped(declared_in(other), plan.records[0])


@pytest.mark.long  # quick: the travel line, below
@pytest.mark.skipif(not SHARED.exists(), reason="measured records are not here (shared/data)")
def test_the_winding_record_names_its_clock_and_no_roller(tmp_path):
    plan = RefineRequest(
        line=ROOT / "config/records/winding.yaml",
        holdout=(),
        out=tmp_path,
        records=(SHARED / "winding/winding.dat.gz",),
    )
    result = refined(plan)
    assert result.answer == "nothing"
    assert result.unknown == ()
    assert [round(c.frequency, 3) for c in result.clocks] == [1.0]
    assert any("no roller" in text for text in result.not_claimed)


@pytest.mark.skipif(not SHARED.exists(), reason="measured records are not here (shared/data)")
@pytest.mark.long
def test_the_belt_has_the_same_travel_lines_fast_and_slow(tmp_path):
    folder = SHARED / "treadmill_belt"
    plan = RefineRequest(
        line=ROOT / "config/records/treadmill_belt.yaml",
        out=tmp_path,
        records=(folder / "RandomSlowSpeed1.txt.gz", folder / "RandomFastSpeed1.txt.gz"),
        holdout=(folder / "RandomSlowSpeed2.txt.gz",),
    )
    result = refined(plan)
    assert {x.axis for x in result.unknown} == {"travel"}
    for line in result.unknown:
        slow, fast = line.per_record
        assert slow == pytest.approx(fast, rel=5e-4)
    found = [line.frequency for line in result.unknown if all(line.presence.present)]
    for wavenumber in (1.5829, 6.2713, 7.898, 9.186):
        assert min(abs(k / wavenumber - 1.0) for k in found) < 3e-4
    row = result.residual_rms["Pitch_Moment_N_m"]
    model = result.models["Pitch_Moment_N_m"]
    assert row.after < 5.03 < model.plain_rms < 5.08  # 5.03: 41 taps that never were left out
    assert not model.fell_back
    at_stamps = model.at_stamps
    assert at_stamps["chosen"] < at_stamps["plain"]
    (shift,) = [x for x in result.general_effects if x.effect == "channel_shift"]
    low, high = shift.interval95["shift_s of RandomSlowSpeed2.txt.gz"]
    assert -0.006 < low < high < -0.003
    assert shift.after_rms < shift.before_rms


@pytest.mark.parametrize("at", ["records", "holdout"])
def test_a_record_too_short_for_its_filter_is_refused(plan, tmp_path, at):
    short = write_belt(tmp_path / "short.csv", 5, 1.2, size=119)
    with pytest.raises(PlantError, match=r"short\.csv: 119 rows .* of 10 taps .* at least 120"):
        refined(replace(plan, **{at: (short,)}))
    assert not plan.out.exists()


@pytest.mark.parametrize("speed", [0.0, -1.0])
def test_a_web_that_stands_or_runs_backwards_has_no_travel(plan, tmp_path, speed):
    table = np.column_stack([np.arange(400) * 0.01, np.sin(np.arange(400)), np.full(400, speed)])
    np.savetxt(
        tmp_path / "still.csv",
        table,
        "%.6f",
        ",",
        header="time_s,moment_N_m,belt_m_s",
        comments="",
    )
    with pytest.raises(PlantError, match="column belt_m_s is above 0 in 0 % of the rows"):
        refined(replace(plan, records=(tmp_path / "still.csv",)))


def test_a_repeated_key_of_the_declaration_is_refused(plan):
    plan.line.write_text(DECLARATION + "taps: 4\n")
    with pytest.raises(PlantError, match="taps: is given twice"):
        refined(plan)
