"""CANopen golden bytes, written by hand from CiA 301 and CiA 402: what a tick says and hears."""

from __future__ import annotations

import math

import pytest

from aff_runtime.fieldbus.can.frames import Frame
from aff_runtime.fieldbus.can.reader import CanReader, Taken
from aff_runtime.fieldbus.can.writer import CanWriter
from aff_runtime.fieldbus.canopen.link import CanopenLink
from aff_runtime.fieldbus.canopen.node import SYNC
from tests.aff_runtime.fieldbus.canopen_bench import NETWORK, CanopenBench
from tests.aff_runtime.fieldbus.euclid_can import command
from tests.aff_runtime.fieldbus.fake_link import FakeLink
from tests.doubles.virtual_clock import VirtualClock

COUNT = 2.0 * math.pi / 4096.0


def test_transmitted_pdos_are_read_little_endian_object_after_object() -> None:
    reader = CanReader(NETWORK.can_map)
    frames = (
        # 0x606C = 10160 (1.016 m/s), 0x2010 = 90123 (90.123 N)
        ("183", "B0270000 0B600100"),
        # 0x606C = -5000 (-0.5 m/s), 0x2010 = -1500 (-1.5 N)
        ("184", "78ECFFFF 24FAFFFF"),
        # 0x6064 = 4096 counts (one turn), 0x2011 = 7500 (0.15 m), 0x2012 = -1234 (-0.01234 m/s)
        ("283", "00100000 4C1D 2EFB"),
        # 0x6064 = -2048; the second object of this PDO is nobody's; 0x2012 = 2
        ("284", "00F8FFFF 0000 0200"),
        # the heartbeat 0x1201 that was taken
        ("381", "0112"),
        # heartbeat 0x0102, status 0x002F, roll 41, reference 9000 (90 N): closes the set
        ("481", "0201 2F00 2900 2823"),
    )
    taken = [
        reader.take(Frame(int(can_id, 16), False, bytes.fromhex(data))) for can_id, data in frames
    ]
    assert taken == [Taken.STORED] * 5 + [Taken.SET]
    wanted = (90.123, 90.0, 1.016, 0.15, -0.5, -1.5, 4096 * COUNT, -2048 * COUNT)
    assert reader.values == pytest.approx(wanted, rel=1e-12)
    assert (reader.heartbeat, reader.status, reader.roll_id) == (0x0102, 0x2F, 41)
    assert reader.aff_echo == 0x1201
    assert reader.applied == pytest.approx((-0.01234, 0.00002), rel=1e-12)


def test_received_pdos_carry_the_words_and_the_velocity_offsets() -> None:
    frames = CanWriter(NETWORK.can_map).encode(command(0x1203, (-0.01234, 0.00002)))
    assert frames == [
        (0x201, False, bytes.fromhex("0312 0400 0700 0000")),  # heartbeat, state, echo, alarm
        (0x203, False, bytes.fromhex("2EFBFFFF")),  # 0x60B1 = -1234
        (0x204, False, bytes.fromhex("02000000")),  # 0x60B1 = 2
        (0x301, False, bytes.fromhex("8813 EFBE")),  # limit 5000 counts, revision
    ]


def test_sync_is_identifier_0x080_without_data() -> None:
    assert (SYNC.can_id, SYNC.extended, SYNC.data) == (0x080, False, b"")


def test_our_heartbeat_says_pre_operational_until_the_nodes_work() -> None:
    clock = VirtualClock()
    link = CanopenLink(FakeLink(clock), NETWORK.plans, own_node=100, heartbeat_ms=20, clock=clock)
    link.ready()
    beats = [frame for frame in link._inner.sent if frame.can_id == 0x764]  # type: ignore[attr-defined]
    assert beats == [Frame(0x764, False, b"\x7f")]
    bench = CanopenBench()
    bench.run(0.6)
    bench.bus.sent.clear()
    bench.run(0.02)
    assert [frame.data for frame in bench.bus.sent if frame.can_id == 0x764] == [b"\x05"]


def test_every_node_is_told_in_the_bytes_of_the_standard() -> None:
    bench = CanopenBench()
    bench.bus.sent = type(bench.bus.sent)()
    bench.run(0.6)
    said = [f"{frame.can_id:03X} {frame.data.hex(' ').upper()}" for frame in bench.bus.sent]
    for line in (
        "000 80 03",  # NMT: enter pre-operational
        "603 23 16 10 01 50 00 64 00",  # 0x1016:1 = node 100, 80 ms
        "603 2B 17 10 00 32 00 00 00",  # 0x1017 = 50 ms
        "603 23 00 14 01 03 02 00 80",  # 0x1400:1 = RPDO off, identifier 0x203
        "603 2F 00 14 02 01 00 00 00",  # 0x1400:2 = 1: acts on every SYNC
        "603 2F 00 16 00 00 00 00 00",  # 0x1600:0 = 0: mapping may change
        "603 23 00 16 01 20 00 B1 60",  # 0x1600:1 = 0x60B1:0, 32 bits
        "603 2F 00 16 00 01 00 00 00",  # 0x1600:0 = 1 object
        "603 23 00 14 01 03 02 00 00",  # RPDO on
        "603 2B 07 60 00 FF FF 00 00",  # 0x6007 = -1
        "603 40 07 60 00 00 00 00 00",  # read back
        "000 01 03",  # NMT: start
    ):
        assert line in said, line
