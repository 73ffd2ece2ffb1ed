"""The demo's PLC shows words that plant and service read alike and no correction waits for."""

from pathlib import Path

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from aff_runtime.base.runs.table import read_table
from aff_runtime.base.runs.window import run_window
from aff_runtime.config.can_wire import can_map_of, wire_files
from aff_runtime.config.loader import load_site, read_site
from sim_plant.demo.loop.drawn import drawn, write_files
from sim_plant.demo.loop.further_words import REFERENCE, SIGNALS, WORDS
from sim_plant.servers.can_dbc_node import load_dbc_map
from sim_plant.servers.map_file import load_plc_map
from tests.doubles.recorded_run import PLC_FILE, Files, RecordedRun


def _files(tmp_path, wire):
    return write_files(tmp_path, drawn("eccentric_roller", 1), wire)


def _named(files, option):
    return files.plant_arguments[files.plant_arguments.index(option) + 1]


def test_on_modbus_site_and_plc_name_the_same_registers(tmp_path):
    files = _files(tmp_path, "modbus")
    read = load_site(files.site).gateway.read.channels
    plc = {c.name: c for c in load_plc_map(Path(_named(files, "--plc"))).channels}
    for name in WORDS:
        assert (read[name].register_number, read[name].scale) == (
            plc[name].address,
            plc[name].scale,
        )


def test_on_can_site_and_plc_name_the_same_signals_of_the_folders_dbc(tmp_path):
    files = _files(tmp_path, "can")
    read = load_site(files.site).gateway.read.channels
    rows, database = load_dbc_map(tmp_path / "can_map.yaml")
    assert _named(files, "--can-map") == str(tmp_path / "can_map.yaml")
    for name, signal in SIGNALS.items():
        assert read[name].signal == rows.channels[name].signal == signal
    told = database.get_message_by_name("PLC_FURTHER")
    values = {"LineSpeedRef": 0.85, "R3Tension": 90.0, "RewindTension": 88.96, "Counter": 7}
    # 850 mm/s, the counter, 90000 mN, 8896 cN: low byte first
    assert told.encode(values) == bytes.fromhex("5203 07 905f01 c022")


@pytest.mark.parametrize(("wire", "words"), [("modbus", WORDS), ("can", SIGNALS)])
def test_they_are_for_the_record_alone_and_the_site_has_no_finding_more(wire, words, tmp_path):
    files = _files(tmp_path, wire)
    site = load_site(files.site)
    assert set(words) <= site.recorded_only
    shipped = Path("config") / files.site.name
    found = [f.text for f in read_site(files.site).warnings]
    assert found == [f.text for f in read_site(shipped).warnings]


def test_the_further_frame_is_no_part_of_a_set(tmp_path):
    files = _files(tmp_path, "can")
    site = load_site(files.site)
    frames = can_map_of(site, wire_files(site, tmp_path))
    assert {f.name for f in frames.frames} - frames.set_frames == {
        "PLC_FURTHER",
        "AFF_UNWIND",
        "AFF_FOLLOWER",
        "AFF_INFO",
    }
    assert REFERENCE in frames.recorded_only


@pytest.mark.parametrize(
    ("wire", "text"), [("canopen", "modbus or can"), ("cann", "no such wire")]
)
def test_another_wire_is_refused(wire, text, tmp_path):
    with pytest.raises(PlantError, match=text):
        _files(tmp_path, wire)


@pytest.mark.parametrize(
    ("wire", "words"), [("modbus", WORDS), pytest.param("can", SIGNALS, marks=pytest.mark.long)]
)  # quick of CAN: both name the same signals, and the bytes of a frame, above
def test_what_the_service_records_of_them_is_what_the_plant_measured(wire, words, tmp_path):
    files = _files(tmp_path, wire)
    made = Files(
        line=files.plant, site=files.site, plc_map=files.plc if wire == "modbus" else PLC_FILE
    )
    run = RecordedRun(made, tmp_path / "runs", can_map=files.plc if wire == "can" else None)
    truth = []
    run.bench.plant.observers.append(lambda plant: truth.append(dict(plant.measured)))
    run.bench.run(0.5)
    columns = read_table(run_window(run.end())).columns
    for name in words:
        shown = columns[name][40:60]
        measured = np.array([row[name] for row in truth])
        step = 0.01 if name == "rewind_tension_N" and wire == "can" else 0.001
        off = [np.max(np.abs(measured[k : k + 20] - shown)) for k in range(30, 50)]
        assert min(off) <= 0.51 * step, name
