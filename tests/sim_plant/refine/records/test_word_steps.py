"""One count of a recorded word: the site file's scale, or what readings say where it is none."""

import numpy as np
import pytest

from sim_plant.demo.loop.drawn import IDLER, drawn, write_files
from sim_plant.refine.records.read import read_record
from sim_plant.refine.records.run_site import run_site
from sim_plant.refine.records.word_steps import counts_of, one_count
from tests.doubles.recorded_run import PLC_FILE, Files, RecordedRun
from tests.lockstep.known_response import ROOT

NOISE = np.random.default_rng(1).standard_normal(4000)


def words(size, count):
    """Return readings as a recorder writes them, ten digits each."""
    return np.array([float(f"{count * round(float(x) / count):.10g}") for x in size])


def test_the_scale_of_a_register_is_one_count():
    assert one_count(words(90.0 + 0.25 * NOISE, 0.02), 0.02) == 0.02
    turned = words(1e5 + np.cumsum(np.abs(NOISE)), 2.0 * np.pi / 4096)
    assert one_count(turned, 2.0 * np.pi / 4096) == 2.0 * np.pi / 4096


def test_a_factor_of_what_a_dbc_gives_or_of_a_float_is_no_count():
    assert one_count(words(90.0 + 0.25 * NOISE, 0.05), 1.0) == pytest.approx(0.05)
    assert one_count(90.0 + 0.25 * NOISE, 1.0) < 1e-3


def test_what_stands_still_or_was_not_read_keeps_the_scale():
    columns = {"a": np.full(50, 3.0), "b": np.full(50, np.nan)}
    assert counts_of(columns, {"a": 0.5, "b": 0.5, "c": 0.5}) == {"a": 0.5, "b": 0.5, "c": 0.5}
    assert one_count(NOISE, 0.0) == 0.0


def test_a_correction_sent_as_a_float_is_not_rounded_to_its_scale():
    text = (ROOT / "config/euclid.yaml").read_text()
    old = "unwind: { register: 103, complement: 104, scale: 0.00001 }"
    assert old in text
    new = "unwind: { register: 103, type: f32, scale: 1 }"
    site = run_site(text.replace(old, new), "site.yaml")
    assert site.actuators["unwind"].count == 0.0


@pytest.mark.long  # quick: the factor of a DBC, above
@pytest.mark.timeout(300)
def test_on_can_by_dbc_counts_are_those_of_the_database_not_the_site_files_factor(tmp_path):
    made = write_files(tmp_path, drawn(IDLER, 1), "can")
    files = Files(line=made.plant, site=made.site, plc_map=PLC_FILE)
    run = RecordedRun(files, tmp_path / "runs", can_map=made.plc)
    run.bench.run(25.0)
    record = read_record(run.end())
    steps = record.run.site.count_sizes
    assert steps["line_speed_m_s"] == pytest.approx(0.001)
    assert steps["unwind_tension_N"] == pytest.approx(0.05)  # the cell's own, 0.001 on the bus
    assert steps["unwind_radius_m"] == pytest.approx(2e-5)
    assert steps["unwind_angle_rad"] == pytest.approx(2.0 * np.pi / 4096)
