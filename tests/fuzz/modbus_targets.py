"""Modbus under any bytes: replies, streams in any pieces, serial lines, words."""

from __future__ import annotations

import math
import struct

from pymodbus.framer import FramerRTU

from aff_runtime.base.errors import ConfigError
from aff_runtime.base.signals import Command, Outcome
from aff_runtime.fieldbus.modbus.codec import WordCodec
from aff_runtime.fieldbus.modbus.frames import (
    READ,
    READ_WRITE,
    WRITE,
    ModbusFrames,
    WireFunction,
    frame_length,
)
from aff_runtime.fieldbus.modbus.registers import (
    Correction,
    Register,
    RegisterMap,
    WordOrder,
    WordType,
)
from aff_runtime.fieldbus.modbus.rtu_wire import RtuWire
from aff_runtime.fieldbus.modbus.transport import ModbusTransport
from sim_plant.servers.modbus_device import ModbusDevice
from sim_plant.servers.registers import Registers
from tests.aff_runtime.fieldbus.fake_wire import Arrivals, FakeWire
from tests.aff_runtime.fieldbus.modbus_bytes import function_of, register_reply, write_reply
from tests.doubles.virtual_clock import VirtualClock
from tests.fuzz.source import Source
from tests.sim_plant.servers.fake_line import default_map

UNIT, COUNT = 0x11, 3
MS = 1_000_000
PLC_MAP = default_map()
BOUNDS = {
    WordType.I16: (16, True),
    WordType.U16: (16, False),
    WordType.I32: (32, True),
    WordType.U32: (32, False),
}


def reply(data: bytes) -> str:
    """No bytes are a reply but those the protocol writes for these very words."""
    source = Source(data)
    function = source.pick((READ, WRITE, READ_WRITE))
    body = (
        bytes((UNIT, WRITE)) + b"\x00\x64\x00\x02"
        if function == WRITE
        else bytes((UNIT, function, 2 * COUNT)) + source.take(2 * COUNT).ljust(2 * COUNT, b"\0")
    )
    good = b"\x12\x34\0\0" + len(body).to_bytes(2, "big") + body
    said = source.spoilt(good) if source.byte() & 1 else source.take(64)
    buffer = bytearray(said.ljust(300, b"\0"))
    length = frame_length(buffer, len(said))
    if length <= 0:
        return "no frame"
    assert length <= len(said)
    frames = ModbusFrames(
        device_id=UNIT, read_start=0x6B, read_count=COUNT, write_start=0x64, write_count=2
    )
    outcome, words = frames.parse_reply(said[:length], function)
    if outcome is Outcome.OK:
        wanted = b"" if function == WRITE else struct.pack(f">{COUNT}H", *words)
        assert said[6:length] == (body if function == WRITE else body[:3] + wanted)
        return "ok"
    assert words == []
    if outcome is Outcome.EXCEPTION:
        assert said[6:length] == bytes((UNIT, function | 0x80, frames.last_exception_code))
    return outcome.name.lower()


class _Heard(FakeWire):
    """A wire that keeps what it handed over, in that order, since it was connected."""

    heard = b""

    def start_connect(self) -> bool:
        self.heard = b""
        return super().start_connect()

    def receive(self, into: memoryview, wait_ns: int) -> int:
        count = super().receive(into, wait_ns)
        self.heard += bytes(into[: max(0, count)])
        return count


def stream(data: bytes) -> str:
    """In whatever pieces and order bytes come, OK means: this request's own, whole reply."""
    source, clock = Source(data), VirtualClock(10**9)
    function = source.pick(tuple(WireFunction))

    def answer(request: bytes) -> Arrivals:
        whole = (
            write_reply(request)
            if function_of(request) == WRITE
            else register_reply(request, [source.word() for _ in range(COUNT)])
        )
        arrivals: Arrivals = []
        for _ in range(source.below(4)):
            kind, delay_ns = source.below(8), source.below(8) * MS
            piece: bytes | None = whole
            if kind == 1:
                cut = source.below(len(whole))
                arrivals.append((delay_ns, whole[:cut]))
                delay_ns, piece = delay_ns + source.below(6) * MS, whole[cut:]
            elif kind == 2:
                piece = source.spoilt(whole)
            elif kind == 3:
                piece = source.take(source.below(40))
            elif kind == 4:
                piece = None
            if piece != b"":
                arrivals.append((delay_ns, piece))
        return arrivals

    wire = _Heard(clock, answer)
    frames = ModbusFrames(
        device_id=1, read_start=0, read_count=COUNT, write_start=100, write_count=2
    )
    transport = ModbusTransport(frames=frames, wire=wire, clock=clock, function=function)
    good = 0
    for _ in range(24):
        start_ns = clock.now_ns()
        outcome, words = transport.transact([1, 2], start_ns + 3 * MS)
        assert clock.now_ns() <= start_ns + 3 * MS
        if outcome is Outcome.OK:
            good += 1
            assert register_reply(wire.requests[-1], words) in wire.heard
        else:
            assert words == []
        clock.sleep_until_ns(start_ns + 5 * MS)
        if outcome is Outcome.NOT_CONNECTED:
            clock.advance_ns(2000 * MS)
    return "ok" if good else "never ok"


class _Line:
    """A serial line that says what it was given."""

    timeout = 0.0

    def __init__(self) -> None:
        self.said = b""

    def read(self, count: int) -> bytes:
        part, self.said = self.said[:count], self.said[count:]
        return part

    def write(self, data: bytes) -> int:
        return len(data)

    def reset_input_buffer(self) -> None:
        self.said = b""

    def close(self) -> None:
        pass


def serial(data: bytes) -> str:
    """What comes off a serial line has the CRC of another library, and is what was sent."""
    source = Source(data)
    wire, line = RtuWire("none", baud=9600, parity="N", stop_bits=1), _Line()
    wire._line = line
    wire.send(bytes.fromhex("0001 0000 0006 01 03 0000 0003"))
    body = b"\x01\x03\x06" + source.take(6).ljust(6, b"\0")
    good = body + FramerRTU.compute_CRC(body).to_bytes(2, "big")
    said = source.spoilt(good) if source.byte() & 1 else source.take(40)
    line.said = said
    into = bytearray(300)
    for _ in range(6):
        found = wire.receive(memoryview(into), source.below(2))
        if found < 0:
            return "closed"
        if found > 0:
            frame = bytes(into[6:found])
            assert frame + FramerRTU.compute_CRC(frame).to_bytes(2, "big") in said
            assert into[:6] == b"\0\x01\0\0" + len(frame).to_bytes(2, "big")
            return "ok"
    return "nothing"


def words(data: bytes) -> str:
    """Any words of any map decode as ``struct`` reads them; any command fits its words."""
    source = Source(data)
    channels, address = [], 3
    for index in range(1 + source.below(4)):
        kind = source.pick(tuple(WordType))
        channels.append(
            Register(
                name=f"c{index}",
                address=address,
                type=kind,
                scale=source.pick((1.0, 0.001, -2.5)),
                word_order=source.pick(tuple(WordOrder)),
            )
        )
        address += kind.word_count
    unwind = Register(name="unwind", address=102, type=WordType.I16, scale=0.00001)
    try:
        codec = WordCodec(
            RegisterMap(
                plc_heartbeat=0,
                status=1,
                roll_id=2,
                channels=tuple(channels),
                aff_heartbeat=100,
                state=101,
                echo=104,
                alarm=None,
                limit=105,
                config_revision=None,
                corrections=(Correction(register=unwind, complement_address=103),),
            )
        )
    except ConfigError:
        return "refused"
    block = [source.word() for _ in range(codec.read_count)]
    heartbeat, status, roll_id, values = codec.decode(block)
    assert [heartbeat, status, roll_id] == block[:3]
    for channel, value in zip(channels, values, strict=True):
        part = block[channel.address : channel.address + channel.type.word_count]
        if channel.word_order is WordOrder.LOW_FIRST:
            part.reverse()
        raw = b"".join(word.to_bytes(2, "big") for word in part)
        if channel.type is WordType.F32:
            wanted = struct.unpack(">f", raw)[0] * channel.scale
        else:
            wanted = int.from_bytes(raw, "big", signed=BOUNDS[channel.type][1]) * channel.scale
        assert value == wanted or (math.isnan(value) and math.isnan(wanted))
    wish = source.number()
    said = codec.encode(
        Command(
            heartbeat=source.word(),
            state_bits=source.word(),
            echo=source.word(),
            corrections=(wish,),
            alarm=0,
            limits=(source.number(),),
            config_revision=0,
        )
    )
    assert all(0 <= word <= 0xFFFF for word in said)
    assert said[2] ^ said[3] == 0xFFFF
    sent = (said[2] ^ 0x8000) - 0x8000
    clear = max(-32768.0, min(32767.0, wish / 0.00001)) if math.isfinite(wish) else 0.0
    assert abs(sent - clear) <= 0.5 or not math.isfinite(wish / 0.00001)
    return "ok"


PDUS = (
    bytes.fromhex("17 0000 000f 0064 000a 14"),
    bytes.fromhex("10 0064 000a 14"),
    bytes.fromhex("03 0000 000f"),
    bytes.fromhex("06 0064"),
)


def plc_pdu(data: bytes) -> str:
    """The simulated PLC answers anything, and a refusal changes nothing."""
    source = Source(data)
    good = source.pick(PDUS) + source.take(20).ljust(20, b"\0")
    asked = source.spoilt(good) if source.byte() & 1 else good[: 1 + source.below(40)]
    if not asked:
        return "nothing"  # the frame around it has at least a function code
    registers = Registers(PLC_MAP)
    before = list(registers.write_words)
    said = ModbusDevice(registers).answer(asked)
    assert len(said) <= 253
    if said[0] & 0x80:
        assert registers.write_words == before
        return "refused"
    return "ok"


SEEDS = [bytes(16), bytes(range(64)), b"\x02\x01" * 40, b"\x00\x01" * 60, b"\x01" * 120]
