"""CAN under any frames: sets, commands, CANopen nodes, serial adapters, DBC and EDS files."""

from __future__ import annotations

import math
import warnings
from pathlib import Path

from aff_runtime.base.errors import ConfigError
from aff_runtime.base.signals import Command, Outcome
from aff_runtime.config.can_wire import network_of, signal_names, wire_files
from aff_runtime.config.loader import load_site
from aff_runtime.fieldbus.can.dbc import can_map, field_of, load_dbc
from aff_runtime.fieldbus.can.frames import Frame
from aff_runtime.fieldbus.can.gateway import CanGateway
from aff_runtime.fieldbus.can.reader import CanReader
from aff_runtime.fieldbus.can.slcan_tty import parse_line
from aff_runtime.fieldbus.can.writer import CanWriter
from aff_runtime.fieldbus.canopen.link import CanopenLink
from tests.aff_runtime.fieldbus.euclid_can import DATABASE, euclid_map, scan
from tests.aff_runtime.fieldbus.fake_link import FakeLink
from tests.doubles.virtual_clock import VirtualClock
from tests.fuzz.source import Source

CONFIG = Path(__file__).parents[2] / "config"
MAP = euclid_map()
OURS = {frame_id for frame_id, _ in CanWriter(MAP).ids}
LENGTHS = {layout.can_id: layout.length for layout in MAP.frames_of(MAP.read_fields)}
CAN_SITE = load_site(CONFIG / "euclid_can.yaml")
CANOPEN_SITE = load_site(CONFIG / "euclid_canopen.yaml")
CANOPEN_TEXTS = wire_files(CANOPEN_SITE, CONFIG)
NETWORK = network_of(CANOPEN_SITE, CANOPEN_TEXTS)
DBC = (CONFIG / "euclid.dbc").read_bytes()
TURN = 2.0 * math.pi / 4096.0


def _command(source: Source) -> Command:
    return Command(
        heartbeat=source.word(),
        state_bits=source.word(),
        echo=source.word(),
        corrections=(source.number(), source.number()),
        alarm=source.word(),
        limits=(source.number(),),
        config_revision=source.word(),
    )


def _frames(source: Source, heartbeat: int) -> list[Frame]:
    """One tick's frames: a whole scan, some of it twice, lost, spoilt, or anything."""
    frames = scan(heartbeat, tension_N=source.word() * 0.01, angle=source.word() - 30_000)
    for _ in range(source.below(4)):
        kind, at = source.below(6), source.below(len(frames)) if frames else 0
        if kind == 0:
            frames.insert(
                at,
                Frame(
                    source.pick([*LENGTHS, *OURS, 0x7FF]),
                    source.byte() % 8 == 7,
                    source.take(source.below(9)),
                ),
            )
        elif frames and kind == 1:
            del frames[at]
        elif frames and kind == 2:
            frames.append(frames.pop(at))
        elif frames and kind == 3:
            frames[at] = frames[at]._replace(data=source.spoilt(frames[at].data)[:8])
        elif frames and kind == 4:
            frames.insert(at, frames[source.below(len(frames))])
    return frames


def ticks(data: bytes) -> str:
    """OK means one scan, whole, of the right lengths, and nobody spoke with our identifiers."""
    source, clock = Source(data), VirtualClock()
    link = FakeLink(clock)
    gateway = CanGateway(link, CanReader(MAP), CanWriter(MAP), clock)
    last: dict[int, bytes] = {}
    heartbeat, good = source.word(), 0
    for tick in range(1, 17):
        heartbeat = (heartbeat + source.pick((1, 1, 1, 1, 0, 2, 65535))) & 0xFFFF
        frames = _frames(source, heartbeat)
        link.heard.extend(frames)
        link.up = source.byte() != 255
        clock.advance_ns(5_000_000)
        shot = gateway.exchange(_command(source), tick, clock.now_ns() + 3_000_000)
        if not link.up:
            assert shot.outcome is Outcome.NOT_CONNECTED
            last.clear()
            link.heard.clear()
            continue
        plain = [frame for frame in frames if not frame.extended]
        wrong = any(LENGTHS.get(f.can_id, len(f.data)) != len(f.data) for f in plain)
        foreign = any(frame.can_id in OURS for frame in plain)
        for frame in plain:
            if LENGTHS.get(frame.can_id) == len(frame.data):
                last[frame.can_id] = frame.data
        if shot.outcome is not Outcome.OK:
            assert all(math.isnan(value) for value in shot.values)
            continue
        assert not wrong
        assert not foreign
        good += 1
        if plain and plain[-1].can_id == 0x184:
            _same_as_cantools(gateway.reader, last)
    return "ok" if good else "never ok"


def _same_as_cantools(reader: CanReader, last: dict[int, bytes]) -> None:
    low = reader.heartbeat & 0xFF
    if int.from_bytes(last[0x184][:2], "little") != reader.heartbeat:
        return  # the last set was torn: the values are those of an earlier one in this tick
    if [last[0x180][6], last[0x181][4], last[0x182][7]] != [low] * 3:
        return
    shown = DATABASE.decode_message(0x180, last[0x180], decode_choices=False)
    angles = DATABASE.decode_message(0x182, last[0x182], decode_choices=False)
    assert isinstance(shown, dict)
    assert isinstance(angles, dict)
    value = reader.values[0]
    assert math.isnan(value) or abs(value - float(shown["UnwindTension"])) < 1e-6
    turned = round(reader.values[6] / TURN) - int(angles["UnwindAngle"])
    assert turned % 2**28 == 0


def command(data: bytes) -> str:
    """Any command leaves as frames that cantools reads back, in range, with its complement."""
    source = Source(data)
    wanted = _command(source)
    frames = CanWriter(MAP).encode(wanted)
    for frame, name, wish in zip(
        frames, ("Unwind", "SwrapFollower"), wanted.corrections, strict=False
    ):
        shown = DATABASE.decode_message(frame.can_id, frame.data)
        raw = DATABASE.decode_message(frame.can_id, frame.data, scaling=False)
        assert isinstance(shown, dict)
        assert isinstance(raw, dict)
        clear = max(-0.32767, min(0.32767, wish)) if abs(wish) < 1e13 else 0.0
        assert abs(float(shown[name]) - clear) < 0.5001e-5
        assert (int(raw[name]) & 0xFFFF) ^ int(raw[f"{name}Complement"]) == 0xFFFF
    return "ok"


def canopen(data: bytes) -> str:
    """No node counts as working that was not written, read back and started."""
    source, clock = Source(data), VirtualClock()
    inner = FakeLink(clock)
    link = CanopenLink(inner, NETWORK.plans, own_node=100, heartbeat_ms=20, clock=clock)
    gateway = CanGateway(link, CanReader(NETWORK.can_map), CanWriter(NETWORK.can_map), clock)
    heard: set[tuple[int, bytes]] = set()
    honest = source.byte() & 1
    for tick in range(1, 160):
        inner.sent.clear()
        clock.advance_ns(5_000_000)
        shot = gateway.exchange(_ZERO, tick, clock.now_ns() + 3_000_000)
        answers = [_answer(frame) for frame in inner.sent] if honest or source else []
        frames = [frame for frame in answers if frame is not None]
        if source:
            frames += [
                Frame(source.pick(_IDS), False, source.take(source.below(9)))
                for _ in range(source.below(3))
            ]
            frames = [
                f._replace(data=source.spoilt(f.data)) if source.byte() > 250 else f
                for f in frames
            ]
        if honest and tick % 8 == 0:
            frames += [
                Frame(0x700 + keeper.plan.node_id, False, b"\x05")
                for keeper in link.keepers
                if keeper.state >= 3
            ]
        inner.heard.extend(frames)
        heard |= {(frame.can_id, frame.data) for frame in frames}
        assert shot.outcome is not Outcome.OK or all(k.good for k in link.keepers)
        for keeper in link.keepers:
            if keeper.good:
                _was_read_back(keeper.plan, heard)
    return "ok" if all(keeper.good for keeper in link.keepers) else "not working"


_ZERO = Command(
    heartbeat=1,
    state_bits=0,
    echo=0,
    corrections=(0.0, 0.0),
    alarm=0,
    limits=(),
    config_revision=0,
)
_IDS = [base + node for node in (1, 3, 4) for base in (0x080, 0x180, 0x280, 0x480, 0x580, 0x700)]
_WRITTEN = {
    (plan.node_id, write.index, write.subindex): write.data
    for plan in NETWORK.plans
    for write in plan.writes
} | {(plan.node_id, 0x1001, 0): b"\0" for plan in NETWORK.plans}  # the error register: none


def _answer(frame: Frame) -> Frame | None:
    """What an honest node answers to an SDO request."""
    node = frame.can_id - 0x600
    if node not in (1, 3, 4) or len(frame.data) != 8:
        return None
    head = frame.data[1:4]
    if frame.data[0] != 0x40:
        return Frame(0x580 + node, False, b"\x60" + head + bytes(4))
    value = _WRITTEN[(node, head[0] | head[1] << 8, head[2])]
    command_byte = 0x43 | (4 - len(value)) << 2
    return Frame(0x580 + node, False, bytes((command_byte,)) + head + value.ljust(4, b"\0"))


def _was_read_back(plan: object, heard: set[tuple[int, bytes]]) -> None:
    for write in plan.writes:  # type: ignore[attr-defined]
        if write.verify:
            head = bytes((write.index & 0xFF, write.index >> 8, write.subindex))
            size = len(write.data)
            assert any(
                can_id == 0x580 + plan.node_id  # type: ignore[attr-defined]
                and said[0] & 0xE3 == 0x43
                and said[1:4] == head
                and said[4 : 4 + size] == write.data
                for can_id, said in heard
                if len(said) == 8
            ), f"{write}: never read back"


def slcan_line(data: bytes) -> str:
    """A line is a frame only if writing that frame gives the line."""
    source = Source(data)
    good = source.pick((b"t1802AABB", b"T1ABCDEF08" + b"01" * 8, b"t7FF0", b"sb128255"))
    line = source.spoilt(good) if source.byte() & 1 else source.take(40)
    found = parse_line(line)
    if found is None:
        return "no frame"
    if found.is_error_frame:
        assert line[:2] == b"sb"
        return "bus-off"
    head = (
        f"T{found.arbitration_id:08X}"
        if found.is_extended_id
        else (f"t{found.arbitration_id:03X}")
    )
    said = f"{head}{found.dlc:X}{bytes(found.data).hex()}".upper().encode()
    assert line[: len(said)].upper() == said
    assert len(line) - len(said) in (0, 4)
    return "ok"


def dbc_text(data: bytes) -> str:
    """A spoilt DBC file is refused, or its signals sit where cantools finds them."""
    source = Source(data)
    pattern = source.take(8).ljust(8, b"\x5a")
    text = source.spoilt(DBC).decode("utf-8", "replace")
    try:
        database = load_dbc(text, "x.dbc")
        found = can_map(database, signal_names(CAN_SITE))
    except ConfigError:
        return "refused"
    for message in database.messages:
        if message.name not in {layout.name for layout in found.frames} or message.length > 8:
            continue
        body = pattern[: message.length]
        if message.is_multiplexed():
            continue
        raw = message.decode(body, scaling=False, decode_choices=False)
        for signal in message.signals:
            field = field_of(message, signal)
            whole = int.from_bytes(body, "big" if field.big_endian else "little")
            bits = whole >> field.shift & field.mask
            if not field.is_float:
                assert bits == int(raw[signal.name]) & field.mask
    CanWriter(found).encode(_ZERO)
    return "ok"


def eds_text(data: bytes) -> str:
    """A spoilt EDS file is refused, or describes PDOs that can be packed."""
    source = Source(data)
    name = source.pick(tuple(CANOPEN_TEXTS))
    text = source.spoilt(CANOPEN_TEXTS[name].encode()).decode("utf-8", "replace")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = network_of(CANOPEN_SITE, CANOPEN_TEXTS | {name: text})
    except ConfigError:
        return "refused"
    lengths = {layout.name: layout.length for layout in found.can_map.frames}
    for field in (*found.can_map.read_fields, *found.can_map.write_fields):
        assert field.length in (8, 16, 32, 64), field
        assert field.shift + field.length <= 8 * lengths[field.frame] <= 64, field
    CanWriter(found.can_map).encode(_ZERO)
    CanReader(found.can_map)
    return "ok"


SEEDS = [bytes(16), bytes(range(80)), b"\x01" * 200, b"\x00\x01\x02\x03" * 40, b"\xff" * 60]
