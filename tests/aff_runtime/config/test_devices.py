from __future__ import annotations

from pathlib import Path

import pytest

from aff_runtime.base.errors import ConfigError
from aff_runtime.config.check import check_site
from aff_runtime.config.devices import load_device
from tests.each_case import each_case

FOLDER = Path(__file__).parents[3] / "config" / "devices"
NAMES = {"abb", "siemens", "danfoss", "schneider", "sew", "lenze", "generic_plc"}


def test_every_promised_device_has_a_profile_with_its_source() -> None:
    devices = {path.stem: load_device(path) for path in FOLDER.glob("*.yaml")}
    assert set(devices) == NAMES
    assert not any(device.verified for device in devices.values())  # none was on a bench yet
    assert all(device.manual and device.lost_master for device in devices.values())


@each_case(
    ("name", "register", "wire"),
    [
        ("abb", 400001, 0),
        ("siemens", 40101, 100),
        ("danfoss", 50010, 50009),
        ("schneider", 8502, 8502),
        ("sew", 5, 5),
        ("lenze", 1, 0),
    ],
)
def test_manual_numbers_become_wire_addresses(name: str, register: int, wire: int) -> None:
    device = load_device(FOLDER / f"{name}.yaml")
    (row,) = {
        r.register_number: r for r in device.registers if r.register_number == register
    }.values()
    assert device.wire_address(row) == wire


def test_a_profile_with_an_unknown_key_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "x.yaml"
    path.write_text((FOLDER / "abb.yaml").read_text() + "more: 1\n")
    with pytest.raises(ConfigError, match="more"):
        load_device(path)


@each_case("name", sorted(NAMES))
def test_a_profile_in_the_place_of_a_site_file_is_named_once(name: str) -> None:
    (error,) = check_site(FOLDER / f"{name}.yaml").errors
    assert "this is a device profile" in error.text
    assert "aff-runtime map --device" in error.text


def test_a_site_file_in_the_place_of_a_profile_is_named() -> None:
    with pytest.raises(ConfigError, match="this is a site file; leave --device out"):
        load_device(FOLDER.parent / "euclid.yaml")
