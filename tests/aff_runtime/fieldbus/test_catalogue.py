from __future__ import annotations

import pytest

from aff_runtime.base.errors import WireError
from aff_runtime.fieldbus.catalogue import ADAPTERS, BY_NAME
from tests.aff_runtime.fieldbus.euclid_map import euclid_map
from tests.doubles.virtual_clock import VirtualClock


def test_names_are_unique_and_every_row_explains_itself() -> None:
    assert len(BY_NAME) == len(ADAPTERS)
    assert all(adapter.text for adapter in ADAPTERS)


def test_every_row_builds_a_transport_that_can_be_closed() -> None:
    arguments = {
        "modbus_tcp": {
            "host": "127.0.0.1",
            "port": 502,
            "device_id": 1,
            "register_map": euclid_map(),
            "clock": VirtualClock(),
        },
        "modbus_rtu": {
            "device": "/nonexistent",
            "baud": 115_200,
            "parity": "N",
            "stop_bits": 1,
            "device_id": 1,
            "register_map": euclid_map(),
            "clock": VirtualClock(),
        },
    }
    assert set(arguments) == set(BY_NAME)
    for name, given in arguments.items():
        transport = BY_NAME[name].build(**given)
        transport.close()


def test_an_unknown_host_is_refused_when_building() -> None:
    with pytest.raises(WireError):
        BY_NAME["modbus_tcp"].build(
            host="no such host",
            port=502,
            device_id=1,
            register_map=euclid_map(),
            clock=VirtualClock(),
        )
