"""Listen to a CAN bus and show what the map makes of it; sends nothing."""

from __future__ import annotations

import math
from collections.abc import Iterator

from aff_runtime.base.errors import WireError
from aff_runtime.base.ports import Clock
from aff_runtime.fieldbus.can.heard_frames import HeardFrames
from aff_runtime.fieldbus.can.layout import CanMap
from aff_runtime.fieldbus.can.link import PythonCanLink
from aff_runtime.fieldbus.can.reader import CanReader, Taken
from aff_runtime.fieldbus.can_catalogue import open_bus

_HINTS = {
    "socketcan": "Does `ip -d link show` list it as UP? Set it up: "
    "ip link set CHANNEL up type can bitrate BITRATE restart-ms 100",
    "slcan_tty": "Is the adapter plugged in, channel its tty, this user in its group (dialout)?",
    "frame_socket": "Start the plant first: sim-plant serve LINE --can dbc|canopen --channel PATH",
    "udp_multicast": "Write a multicast address as channel and check the network interface",
}


def listen(
    can_map: CanMap, interface: str, channel: str, bitrate: int, clock: Clock, span_s: float = 2.0
) -> Iterator[str]:
    """Yield one line per frame of the map: how often, its raw bytes, then every reading.

    A reading is that of its newest frame, whole set or not; where none is whole, why.

    Raises
    ------
    WireError
        The bus cannot be opened.
    """
    reader = CanReader(can_map)
    link = listener(interface, channel, bitrate, reader.ids, clock)
    heard = HeardFrames(can_map)
    sets = 0
    end_ns = clock.now_ns() + round(span_s * 1e9)
    try:
        while (left_ns := end_ns - clock.now_ns()) > 0 and link.ready():
            frame = link.receive(left_ns)
            if frame is None or frame.can_id < 0:
                continue
            heard.take(frame)
            sets += reader.take(frame) is Taken.SET
    finally:
        link.close()
    yield f"{sets} sets, {reader.torn} torn, {reader.bad_lengths} of wrong length"
    yield _verdict(can_map, heard)
    if heard and not sets and heard.hindrance():
        yield f"NO WHOLE SET: {heard.hindrance()}"
    yield from heard.frame_lines(span_s)
    for reading in (*can_map.channels, *(shown for shown in can_map.applied if shown is not None)):
        field = reading.field
        physical = heard.value(field)
        remark = ""
        if not math.isnan(physical) and not field.minimum <= physical <= field.maximum:
            remark = f"  OUTSIDE {field.minimum:g}..{field.maximum:g}: counts as missing"
        yield f"  {reading.name:28} {physical * reading.scale:14.6g}  {field}{remark}"


def listener(
    interface: str, channel: str, bitrate: int, ids: tuple[tuple[int, bool], ...], clock: Clock
) -> PythonCanLink:
    """Return an open bus that hears ``ids``: identifiers, and whether each is a long one.

    Raises
    ------
    WireError
        The bus cannot be opened.
    """
    link = PythonCanLink(lambda: open_bus(interface, channel, bitrate, ids), clock)
    link.ready()
    if not link.ready():
        raise WireError(
            f"gateway: {interface} {channel} cannot be opened ({link.why_closed}). "
            f"{_HINTS[interface]}"
        )
    return link


def _verdict(can_map: CanMap, heard: HeardFrames) -> str:
    words = [heard.word(field) for field in (can_map.status, can_map.roll_id)]
    status = "-" if words[0] is None else f"0x{words[0]:04X}"
    roll_id = "-" if words[1] is None else str(words[1])
    if heard.moves:
        said = "moves"
    elif not heard:
        said = (
            "not heard: no frame of the map came. CANopen nodes send after `aff-runtime run` has "
            "started them; CAN by DBC: check bit rate, wiring and identifiers"
        )
    elif heard.word(can_map.plc_heartbeat) is None:
        said = f"not heard: {can_map.plc_heartbeat.frame} is silent"
    else:
        said = "STANDS STILL: wrong signal or a stopped PLC"
    return f"plc_heartbeat {said}; status {status}; roll_id {roll_id}"
