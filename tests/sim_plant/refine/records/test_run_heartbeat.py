"""A heartbeat of 8 bits or more counts scans; what is expected follows from how rows were made."""

from dataclasses import replace

import numpy as np
import pytest
import yaml

from aff_runtime.base.runs.table import read_table
from aff_runtime.base.runs.window import run_window
from aff_runtime.base.yaml_section import Section
from sim_plant.demo.loop.drawn import IDLER, drawn, write_files
from sim_plant.refine.records.read import read_record
from sim_plant.refine.records.run_grid import scans_of
from sim_plant.refine.records.run_heartbeat import modulus_of, scans_between
from tests.aff_runtime.app.card.measure.recorded import recorded, steady
from tests.aff_runtime.app.fake_plc import READY_STATUS
from tests.doubles.recorded_run import PLC_FILE, Files, RecordedRun
from tests.each_case import each_case
from tests.sim_plant.refine.records.test_run_grid import CYCLE_S, rows

NOT_SAID = Section()
BITS = [8, 12, 15, 16, 20]


def beats(scans, bits):
    return rows(scans) | {"plc_heartbeat": np.mod(scans, 2.0**bits)}


@pytest.mark.parametrize("bits", BITS)
def test_scans_are_counted_over_every_start_of_the_heartbeat(bits):
    scans = np.arange(2.0**bits - 400.0, 2.0**bits + 2600.0)
    found = scans_of(beats(scans, bits), (), 2.0**bits)
    assert found.taken_s == pytest.approx((scans - scans[0]) * CYCLE_S)
    assert found.scan_s == pytest.approx(CYCLE_S)
    assert not found.breaks


def test_a_hole_longer_than_a_round_of_the_heartbeat_is_a_hole_and_no_jump():
    scans = np.delete(np.arange(3000.0), np.arange(1000, 1700))  # 700 scans: 2.7 rounds
    columns = rows(scans, ticks=scans + 1.0) | {"plc_heartbeat": np.mod(scans, 256.0)}
    found = scans_of(columns, (), 256.0)
    assert [(one.scan, one.why) for one in found.breaks] == [(1000, "nothing was read for 3.5 s")]
    assert found.taken_s == pytest.approx(scans * CYCLE_S)


def test_a_heartbeat_that_goes_back_has_not_gone_on_by_less_than_nothing():
    beat = np.concatenate([np.arange(100.0), np.arange(80.0, 300.0)])
    _, moved = scans_between(beat, np.full(beat.size - 1, CYCLE_S), 65536.0)
    assert moved.min() > 0.0


@each_case("bits", BITS)
def test_of_an_older_run_it_is_the_least_power_of_two_that_the_clock_agrees_with(bits):
    columns = beats(np.arange(2.0**bits - 400.0, 2.0**bits + 2600.0), bits)
    modulus, said = modulus_of(NOT_SAID, columns)
    assert modulus == 2.0**bits
    assert (said == "") == (bits == 16)


def test_of_an_older_run_without_a_start_over_in_it_it_is_that_of_a_word():
    assert modulus_of(NOT_SAID, beats(np.arange(200.0), 16)) == (65536.0, "")


def test_a_plc_that_started_anew_is_no_start_over_of_its_heartbeat():
    """From 5699 to 0: at 13 bits that would be 2493 scans, 12 s, within one cycle."""
    scans = np.concatenate([np.arange(5000.0, 5700.0), np.arange(700.0)])
    columns = rows(scans, ticks=np.arange(1.0, 1401.0))
    assert modulus_of(NOT_SAID, columns)[0] == 65536.0


def test_what_run_yaml_says_counts_unless_it_is_no_modulus():
    columns = beats(np.arange(3000.0), 8)
    assert modulus_of(Section({"heartbeat_modulus": 4096}), columns) == (4096.0, "")
    for wrong in (0, -1, 3, "256", True, 2**70, None):
        assert modulus_of(Section({"heartbeat_modulus": wrong}), columns)[0] == 256.0


def test_a_run_with_a_heartbeat_of_eight_bits_is_one_record(tmp_path):
    """It starts over every 1.28 s: each was a jump by 65281 scans."""
    columns = steady(30.0)
    columns["plc_heartbeat"] = np.mod(columns["plc_heartbeat"], 256.0)
    columns["status"][:] = READY_STATUS
    path = recorded(tmp_path, columns)
    about = yaml.safe_load((path / "run.yaml").read_text())
    for said in (256, 0):
        (path / "run.yaml").write_text(yaml.safe_dump(about | {"heartbeat_modulus": said}))
        record = read_record(path)
        assert record.duration_s == pytest.approx(30.0, abs=0.1)
        guessed = [text for text in record.findings if "start over after 256 counts" in text]
        assert len(guessed) == (said == 0)


@pytest.mark.long  # quick: the same rows by a formula, above
@pytest.mark.timeout(300)
@pytest.mark.parametrize("bits", [8, 12])
def test_a_plc_on_can_with_a_short_heartbeat_gives_a_run_that_is_one_record(tmp_path, bits):
    """The whole way: signal of the DBC, frames, gateway, ring's head, run.yaml, record."""
    made = write_files(tmp_path, drawn(IDLER, 1), "can")
    dbc = tmp_path / "euclid.dbc"
    text, whole = dbc.read_text(), "PlcHeartbeat : 0|16@1+ (1,0) [0|65535]"
    assert text.count(whole) == 1
    dbc.write_text(text.replace(whole, f"PlcHeartbeat : 0|{bits}@1+ (1,0) [0|{2**bits - 1}]"))
    files = Files(line=made.plant, site=made.site, plc_map=PLC_FILE)
    run = RecordedRun(files, tmp_path / "runs", can_map=made.plc)
    run.bench.run(25.0)
    path = run.end()
    table = read_table(run_window(path))
    assert table.about.get("heartbeat_modulus") == 2**bits
    assert table.columns["plc_heartbeat"].max() == 2**bits - 1
    record = read_record(path)
    assert record.duration_s == pytest.approx(25.0, abs=0.2)
    assert record.sample_time_s == pytest.approx(0.005)
    unknown = replace(table.about, data={})
    assert modulus_of(unknown, table.columns)[0] == 2.0**bits
