"""Golden bytes, written by hand from the Modbus application protocol and MBAP header layout."""

from __future__ import annotations

import random

import pytest
from pymodbus.framer import FramerSocket
from pymodbus.pdu import DecodePDU
from pymodbus.pdu.register_message import (
    ReadWriteMultipleRegistersRequest,
    ReadWriteMultipleRegistersResponse,
)

from aff_runtime.base.errors import ConfigError
from aff_runtime.base.signals import Outcome
from aff_runtime.fieldbus.modbus.frames import (
    READ,
    READ_WRITE,
    WRITE,
    ModbusFrames,
    frame_length,
    transaction_id,
)
from tests.each_case import each_case


def frames() -> ModbusFrames:
    return ModbusFrames(
        device_id=0x11, read_start=0x006B, read_count=3, write_start=0x0064, write_count=2
    )


def test_fc3_request() -> None:
    # tid 1234, protocol 0, length 6, unit 11, function 03, address 006B, count 3
    assert frames().read_request(0x1234) == bytes.fromhex("1234 0000 0006 11 03 006B 0003")


def test_fc16_request() -> None:
    assert frames().write_request(0x0001, [0x000A, 0x0102]) == bytes.fromhex(
        "0001 0000 000B 11 10 0064 0002 04 000A 0102"
    )


def test_fc23_request() -> None:
    assert frames().read_write_request(0xFFFF, [0xFFFF, 0x8000]) == bytes.fromhex(
        "FFFF 0000 000F 11 17 006B 0003 0064 0002 04 FFFF 8000"
    )


@pytest.mark.parametrize(
    ("function", "reply"),
    [
        (READ, "1234 0000 0009 11 03 06 022B 0000 FFFF"),
        (READ_WRITE, "1234 0000 0009 11 17 06 022B 0000 FFFF"),
    ],
)
def test_register_replies_give_their_words(function: int, reply: str) -> None:
    assert frames().parse_reply(bytes.fromhex(reply), function) == (
        Outcome.OK,
        [0x022B, 0, 0xFFFF],
    )


def test_a_write_reply_must_echo_address_and_count() -> None:
    asked = frames()
    good = bytes.fromhex("0001 0000 0006 11 10 0064 0002")
    assert asked.parse_reply(good, WRITE) == (Outcome.OK, [])


@pytest.mark.parametrize("function", [READ, WRITE, READ_WRITE])
def test_an_exception_reply_gives_its_code(function: int) -> None:
    asked = frames()
    reply = bytes.fromhex("0001 0000 0003 11") + bytes([function | 0x80, 6])
    assert asked.parse_reply(reply, function)[0] is Outcome.EXCEPTION
    assert asked.last_exception_code == 6


@pytest.mark.parametrize(
    ("fault", "function", "reply"),
    [
        ("device id", READ, "0001 0000 0009 12 03 06 0001 0002 0003"),
        ("function", READ, "0001 0000 0009 11 04 06 0001 0002 0003"),
        ("fc3 to fc23", READ_WRITE, "0001 0000 0009 11 03 06 0001 0002 0003"),
        ("too few registers", READ, "0001 0000 0007 11 03 04 0001 0002"),
        ("too many registers", READ, "0001 0000 000B 11 03 08 0001 0002 0003 0004"),
        ("byte count too small", READ, "0001 0000 0009 11 03 04 0001 0002 0003"),
        ("byte count too large", READ, "0001 0000 0009 11 03 08 0001 0002 0003"),
        ("odd byte count", READ, "0001 0000 0008 11 03 05 0001 0002 00"),
        ("echoed address", WRITE, "0001 0000 0006 11 10 0065 0002"),
        ("echoed count", WRITE, "0001 0000 0006 11 10 0064 0003"),
        ("write reply too long", WRITE, "0001 0000 0007 11 10 0064 0002 00"),
        ("exception of another function", READ, "0001 0000 0003 11 90 06"),
        ("exception too long", READ, "0001 0000 0004 11 83 06 00"),
    ],
)
def test_a_reply_wrong_in_one_place_is_refused_without_a_log_line(
    fault: str, function: int, reply: str, caplog: pytest.LogCaptureFixture
) -> None:
    assert frames().parse_reply(bytes.fromhex(reply), function) == (Outcome.BAD_REPLY, []), fault
    assert caplog.records == []


@each_case(
    ("head", "length"),
    [
        ("", 0),
        ("0001 0000 00", 0),
        ("0001 0000 0009 11 03 06 0001 0002 00", 0),
        ("0001 0000 0009 11 03 06 0001 0002 0003", 15),
        ("0001 0000 0009 11 03 06 0001 0002 0003 0001", 15),
        ("0001 0001 0009", -1),
        ("0001 0000 0002", -1),
        ("0001 0000 00FF", -1),
        ("0001 0000 FFFF", -1),
    ],
)
def test_the_header_says_where_a_frame_ends(head: str, length: int) -> None:
    buffer = bytearray(64)
    got = bytes.fromhex(head)
    buffer[: len(got)] = got
    assert frame_length(buffer, len(got)) == length


def test_transaction_id_is_big_endian() -> None:
    assert transaction_id(bytearray.fromhex("1234 0000 0003")) == 0x1234


@each_case(
    "bad",
    [
        {"device_id": 256},
        {"read_count": 0},
        {"read_count": 126},
        {"write_count": 122},
        {"read_start": 65535, "read_count": 2},
        {"write_start": 65535, "write_count": 2},
    ],
)
def test_numbers_no_frame_can_carry_are_refused(bad: dict[str, int]) -> None:
    with pytest.raises(ConfigError):
        ModbusFrames(**({"device_id": 1, "read_start": 0, "read_count": 1} | bad))


def test_a_library_makes_the_same_request_and_its_reply_is_read() -> None:
    """Blocks of other sizes than the golden bytes, against pymodbus."""
    framer, chance = FramerSocket(DecodePDU(is_server=False)), random.Random(1)
    for _ in range(20):
        read_count, write_count = chance.randint(1, 125), chance.randint(1, 121)
        read_start, write_start = chance.randint(0, 9000), chance.randint(0, 9000)
        words = [chance.randrange(1 << 16) for _ in range(write_count)]
        tid, device = chance.randrange(1, 1 << 16), chance.randrange(256)
        ours = ModbusFrames(
            device_id=device,
            read_start=read_start,
            read_count=read_count,
            write_start=write_start,
            write_count=write_count,
        )
        theirs = ReadWriteMultipleRegistersRequest(
            read_address=read_start,
            read_count=read_count,
            write_address=write_start,
            write_registers=words,
            dev_id=device,
            transaction_id=tid,
        )
        assert ours.read_write_request(tid, words) == framer.buildFrame(theirs)
        seen = [chance.randrange(1 << 16) for _ in range(read_count)]
        reply = ReadWriteMultipleRegistersResponse(
            registers=seen, dev_id=device, transaction_id=tid
        )
        assert ours.parse_reply(framer.buildFrame(reply), READ_WRITE) == (Outcome.OK, seen)
