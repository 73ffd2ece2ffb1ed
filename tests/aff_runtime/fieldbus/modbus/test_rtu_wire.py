"""Modbus RTU over a pty pair; the other end is pymodbus' own RTU framer."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.signals import Outcome
from aff_runtime.fieldbus.modbus.codec import WordCodec
from aff_runtime.fieldbus.modbus.connections import modbus, rtu_wire
from aff_runtime.fieldbus.modbus.frames import WireFunction
from aff_runtime.fieldbus.modbus.gateway import WordGateway
from aff_runtime.fieldbus.modbus.rtu_frames import crc16, reply_length, rtu_of
from aff_runtime.fieldbus.modbus.serial_time import transaction_ms
from tests.aff_runtime.fieldbus.euclid_map import euclid_map
from tests.aff_runtime.fieldbus.rtu_slave import Slave
from tests.each_case import each_case

PATIENCE_NS = 2_000_000_000


def test_the_crc_of_the_specification() -> None:
    # Modbus over Serial Line V1.02, 6.2.2: device 2, function 7 -> 0x1241, low byte first 41 12
    assert crc16(bytes.fromhex("02 07")) == 0x1241
    assert rtu_of(bytes.fromhex("0001 0000 0002 02 07")) == bytes.fromhex("02 07 41 12")


def test_hand_written_frame_of_fc3() -> None:
    # widely published example: 11 03 006B 0003 CRC 76 87
    assert rtu_of(bytes.fromhex("0000 0000 0006 11 03 006B 0003")).hex() == "1103006b00037687"


@each_case(
    "frame",
    [
        "11 10 0001 0002 04 000A 0102 C6F0",  # FC16 request, published example
        "11 10 0001 0002 1298",  # its reply
        "11 03 06 AE41 5652 4340 49AD",  # reply to FC3
        "0A 81 02 B053",  # exception 2
    ],
)
def test_published_frames_have_our_crc(frame: str) -> None:
    whole = bytes.fromhex(frame)
    assert rtu_of(bytes(6) + whole[:-2]) == whole


def test_hand_written_frame_of_fc23() -> None:
    # the FC23 example of the application protocol: read 0003 x6, write 000E x3
    body = bytes.fromhex("01 17 0003 0006 000E 0003 06 00FF 00FF 00FF")
    assert rtu_of(bytes(6) + body)[-2:] == crc_by_division(body)


def crc_by_division(data: bytes) -> bytes:
    """CRC-16/MODBUS as long division of bit-reversed bytes by x^16 + x^15 + x^2 + 1."""
    bits = [byte >> k & 1 for byte in data for k in range(8)] + [0] * 16
    for k in range(16):
        bits[k] ^= 1  # the register starts as ones
    for k in range(8 * len(data)):
        if bits[k]:
            for power in (0, 1, 14, 16):  # 0x18005 from its highest power down
                bits[k + power] ^= 1
    rest = bits[-16:]
    return bytes(
        sum(bit << k for k, bit in enumerate(rest[start : start + 8])) for start in (0, 8)
    )


@each_case(
    ("head", "length"),
    [("0103", 0), ("010306", 11), ("011702", 7), ("018302", 5), ("011000", 8), ("016300", -1)],
)
def test_reply_lengths(head: str, length: int) -> None:
    assert reply_length(bytes.fromhex(head)) == length


def test_a_cycle_takes_as_long_as_its_characters() -> None:
    # 13 + 20 request and 5 + 30 reply characters of 11 bits at 115200, two silences of 1.75 ms
    assert transaction_ms(15, 10, 115_200, fc23=True) == pytest.approx(68 * 11 / 115.2 + 3.5)


@pytest.fixture
def slave() -> Iterator[Slave]:
    device = Slave()
    yield device
    device.close()


def exchange(
    slave: Slave, function: WireFunction, ticks: int = 4
) -> list[tuple[Outcome, list[int]]]:
    transport = modbus(
        rtu_wire(slave.path, baud=115_200, parity="none", stop_bits=1),
        device_id=1,
        register_map=euclid_map(),
        clock=MonotonicClock(),
        function=function,
    )
    clock = MonotonicClock()
    seen = [transport.transact([7] * 10, clock.now_ns() + PATIENCE_NS // 10) for _ in range(ticks)]
    transport.close()
    return seen


@pytest.mark.wire
@pytest.mark.parametrize("function", [WireFunction.FC23, WireFunction.FC3_FC16])
def test_words_go_both_ways(slave: Slave, function: WireFunction) -> None:
    slave.registers.publish(list(range(100, 115)))
    seen = exchange(slave, function)
    assert seen[0][0] is Outcome.NOT_CONNECTED  # the tick that opens the line
    assert seen[-1] == (Outcome.OK, list(range(100, 115)))
    assert slave.registers.write_words == [7] * 10


@pytest.mark.wire
def test_a_flipped_bit_is_never_a_value(slave: Slave) -> None:
    slave.spoil = lambda frame: frame[:5] + bytes([frame[5] ^ 1]) + frame[6:]
    assert all(words == [] for _, words in exchange(slave, WireFunction.FC23))


@pytest.mark.wire
def test_an_answer_of_another_device_is_a_bad_reply(slave: Slave) -> None:
    def other(frame: bytes) -> bytes:
        body = b"\x02" + frame[1:-2]
        return body + crc16(body).to_bytes(2, "little")

    slave.spoil = other
    outcomes = {outcome for outcome, _ in exchange(slave, WireFunction.FC23)}
    assert Outcome.BAD_REPLY in outcomes
    assert Outcome.OK not in outcomes


@pytest.mark.wire
def test_a_line_that_does_not_open_is_named_until_it_does(slave: Slave, tmp_path: Path) -> None:
    device = tmp_path / "tty"
    clock = MonotonicClock()
    transport = modbus(
        rtu_wire(str(device), baud=115_200, parity="none", stop_bits=1),
        device_id=1,
        register_map=euclid_map(),
        clock=clock,
    )
    gateway = WordGateway(transport, WordCodec(euclid_map()), clock, lambda: transport.trouble)
    assert gateway.troubles == ()
    transport.transact([0] * 10, clock.now_ns() + PATIENCE_NS // 10)
    (said,) = gateway.troubles
    assert f"the serial line {device} does not open: " in said
    assert "No such file" in said
    device.symlink_to(slave.path)  # plugged in
    end_ns = clock.now_ns() + PATIENCE_NS
    while gateway.troubles and clock.now_ns() < end_ns:
        transport.transact([0] * 10, clock.now_ns() + PATIENCE_NS // 10)
    assert gateway.troubles == ()
    gateway.close()
