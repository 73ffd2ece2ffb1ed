"""Every way to a PLC that a site file can name has its row, and the row makes it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from aff_runtime.app.wiring.wires import WIRES, gateway_of, wire_of
from aff_runtime.base.errors import ConfigError, WireError
from aff_runtime.config.can_wire import wire_files
from aff_runtime.config.loader import load_site
from aff_runtime.config.models import Site, gateway
from aff_runtime.fieldbus.modbus.connections import CONNECTIONS, tcp_wire
from tests.doubles.virtual_clock import VirtualClock

CONFIG = Path(__file__).parents[4] / "config"
FILES = {"can_dbc": "euclid_can.yaml", "canopen_402": "euclid_canopen.yaml"}
SECTIONS = {"modbus_rtu": "{ device: /dev/nowhere, baud: 115200, deadline_ms: 15 }"}
KEYS = tuple(WIRES)


def site_on(key: str, folder: Path) -> Site:
    """Return the shipped site on this wire; its section is put in where none is shipped."""
    if key in FILES:
        return load_site(CONFIG / FILES[key])
    text = (CONFIG / "euclid.yaml").read_text()
    if key != "modbus_tcp":
        section = f"  {key}: {SECTIONS.get(key, '{ host: 127.0.0.1, deadline_ms: 15 }')}"
        text = re.sub(r"(?m)^  modbus_tcp:.*(\n    .*)*", section, text, count=1)
        text = text.replace("cycle_ms: 5", "cycle_ms: 20", 1)
    path = folder / "site.yaml"
    path.write_text(text)
    return load_site(path)


def test_every_key_that_the_model_takes_has_a_row_and_no_other() -> None:
    assert set(WIRES) == set(gateway.WIRES)
    assert all(row.text and row.key == key for key, row in WIRES.items())


@pytest.mark.parametrize("key", KEYS)
def test_the_row_makes_the_wire_of_a_site(key: str, tmp_path: Path) -> None:
    site = site_on(key, tmp_path)
    assert site.gateway.wire == key
    made = gateway_of(site, wire_files(site, CONFIG), VirtualClock(), CONFIG)
    made.close()


@pytest.mark.parametrize("key", ["can_dbc", "canopen_402"])
def test_a_wire_without_words_says_so(key: str, tmp_path: Path) -> None:
    site = site_on(key, tmp_path)
    with pytest.raises(ConfigError, match=f"{key} carries no Modbus words"):
        wire_of(site, CONFIG)


@pytest.mark.parametrize("key", CONNECTIONS)
def test_a_modbus_row_carries_bytes(key: str, tmp_path: Path) -> None:
    site = site_on(key, tmp_path)
    wire_of(site, CONFIG).close(abort=True)


def test_an_unknown_host_is_refused_when_building() -> None:
    with pytest.raises(WireError):
        tcp_wire("no such host", 502)
