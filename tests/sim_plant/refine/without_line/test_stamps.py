"""Uneven stamps: on the declared grid, with the readings kept."""

import json

import numpy as np
import pytest

from sim_plant.line.reading.load import read_source
from sim_plant.refine.report.outcome import RefineRequest
from sim_plant.refine.without_line.pipeline import refine_records
from sim_plant.refine.without_line.record_filter import read_stamped, record_declaration_in

DECLARATION = """\
schema: record-declaration/1
sample_time_s: 0.01
outputs: [y_N]
inputs: [u_N]
taps: 20
"""
SIZE = 6000
NOISE = 0.05


def input_at(time_s, seed):
    """Return a sum of slow waves of seeded phases: known at any time."""
    rng = np.random.default_rng(seed)
    waves = rng.uniform(0.3, 6.0, 30)
    phases = rng.uniform(0.0, 6.28, 30)
    return np.sin(2.0 * np.pi * np.outer(time_s, waves) + phases).sum(axis=1) / np.sqrt(15.0)


def write(path, seed, late_s=0.0, jitter=0.2, step_s=0.01):
    rng = np.random.default_rng(100 + seed)
    time_s = step_s * (np.arange(SIZE) + jitter * rng.uniform(-1.0, 1.0, SIZE))
    time_s -= time_s[0]
    y = 2.0 * input_at(time_s - late_s, seed) + NOISE * rng.standard_normal(SIZE)
    table = np.column_stack([time_s, y, input_at(time_s, seed)])
    np.savetxt(path, table, "%.8f", ",", header="time_s,y_N,u_N", comments="")
    return path


@pytest.fixture
def declaration(tmp_path):
    (tmp_path / "y.yaml").write_text(DECLARATION)
    return record_declaration_in(read_source(tmp_path / "y.yaml"))


def test_uneven_stamps_are_put_on_the_declared_grid(declaration, tmp_path):
    found = read_stamped(declaration, write(tmp_path / "a.csv", 1, step_s=0.010003))
    assert found.record.sample_time_s == 0.01
    grid = 0.01 * np.arange(found.record.samples)
    truth = input_at(grid, 1)
    assert np.std(found.record.columns["u_N"] - truth) < 0.01 * np.std(truth)
    assert found.time_s.size == SIZE
    assert found.readings["y_N"].size == SIZE
    assert any("put on the declared grid of 0.01 s" in text for text in found.record.findings)


def test_even_stamps_stay_as_they_are(declaration, tmp_path):
    found = read_stamped(declaration, write(tmp_path / "a.csv", 1, jitter=0.0))
    assert found.time_s is None
    assert found.record.samples == SIZE


@pytest.mark.long  # quick: the grid, above; the shift, general/
def test_a_shift_is_found_through_uneven_stamps_and_judged_on_them(declaration, tmp_path):
    plan = RefineRequest(
        line=tmp_path / "y.yaml",
        records=(write(tmp_path / "a.csv", 1), write(tmp_path / "b.csv", 2, late_s=0.0234)),
        holdout=(write(tmp_path / "c.csv", 3, late_s=-0.0071),),
        out=tmp_path / "out",
    )
    result = refine_records(plan, declaration, lambda _: None)
    assert result.answer == "traced"
    (shift,) = result.general_effects
    assert shift.numbers["shift_s of b.csv"] == pytest.approx(0.0234, abs=2e-4)
    assert shift.numbers["shift_s of c.csv"] == pytest.approx(-0.0071, abs=2e-4)
    stamps = result.models["y_N"].at_stamps
    assert stamps["chosen"] == pytest.approx(NOISE, rel=0.1)
    assert stamps["plain"] > 3.0 * stamps["chosen"]
    written = json.loads((plan.out / "verdict.json").read_text())
    assert written["verdict"] == "traced"
    assert written["effects"] == []  # the library's are of lines
    (row,) = written["general_effects"]
    assert row["effect"] == "channel_shift"
    assert row["rms_with"] < row["rms_without"]
    tried = written["models"]["y_N"]["tried"]
    assert {"what", "effect", "left_out_rms", "held_out_rms", "taken"} == set(tried[0])
    page = (plan.out / "report.html").read_text()
    assert "What was tried, and what it gave" in page
    assert "Traced: channel_shift in y_N" in page
