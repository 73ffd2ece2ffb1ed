"""The demo's PLC shows the speed reference in a word that plant and service read alike."""

from pathlib import Path

import pytest

from aff_runtime.base.errors import PlantError
from aff_runtime.config.loader import load_site
from sim_plant.demo.loop.drawn import drawn, write_files
from sim_plant.demo.loop.reference import REFERENCE
from sim_plant.servers.can_dbc_node import load_dbc_map
from sim_plant.servers.map_file import load_plc_map


def _files(tmp_path, wire):
    return write_files(tmp_path, drawn("eccentric_roller", 1), wire)


def _named(files, option):
    return files.plant_arguments[files.plant_arguments.index(option) + 1]


def test_on_modbus_site_and_plc_name_one_register(tmp_path):
    files = _files(tmp_path, "modbus")
    site = load_site(files.site)
    word = site.gateway.read.channels[REFERENCE]
    (row,) = [
        c for c in load_plc_map(Path(_named(files, "--plc"))).channels if c.name == REFERENCE
    ]
    assert (word.register_number, word.scale) == (row.address, row.scale)


def test_on_can_site_and_plc_name_one_signal_of_the_folders_dbc(tmp_path):
    files = _files(tmp_path, "can")
    site = load_site(files.site)
    rows, database = load_dbc_map(tmp_path / "can_map.yaml")
    assert _named(files, "--can-map") == str(tmp_path / "can_map.yaml")
    signal = rows.channels[REFERENCE].signal
    assert site.gateway.read.channels[REFERENCE].signal == signal
    message, name = signal.split(".")
    told = database.get_message_by_name(message)
    raw = told.encode({name: 0.85, "Counter": 7})
    assert raw == bytes.fromhex("520307")  # 850 mm/s, low byte first


@pytest.mark.parametrize(
    ("wire", "text"), [("canopen", "modbus or can"), ("cann", "no such wire")]
)
def test_another_wire_is_refused(wire, text, tmp_path):
    with pytest.raises(PlantError, match=text):
        _files(tmp_path, wire)
