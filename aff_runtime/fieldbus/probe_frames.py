"""Listen to a CAN bus and show what the map makes of it; sends nothing."""

from __future__ import annotations

from collections.abc import Iterator

from aff_runtime.base.errors import WireError
from aff_runtime.base.ports import Clock
from aff_runtime.fieldbus.can_catalogue import open_bus
from aff_runtime.fieldbus.can_layout import CanMap
from aff_runtime.fieldbus.can_link import PythonCanLink
from aff_runtime.fieldbus.can_reader import CanReader, Taken

_HINTS = {
    "socketcan": "Does `ip -d link show` list it as UP? Set it up: "
    "ip link set CHANNEL up type can bitrate BITRATE restart-ms 100",
    "slcan_tty": "Is the adapter plugged in, channel its tty, this user in its group (dialout)?",
    "frame_socket": "Start the plant first: sim-plant serve LINE --can dbc --channel PATH",
    "udp_multicast": "Write a multicast address as channel and check the network interface",
}


def listen(
    can_map: CanMap, interface: str, channel: str, bitrate: int, clock: Clock, span_s: float = 2.0
) -> Iterator[str]:
    """Yield one line per frame of the map: how often, its raw bytes, then every reading.

    Raises
    ------
    WireError
        The bus cannot be opened.
    """
    reader = CanReader(can_map)
    link = PythonCanLink(lambda: open_bus(interface, channel, bitrate, reader.ids), clock)
    link.ready()
    if not link.ready():
        raise WireError(
            f"gateway: {interface} {channel} cannot be opened ({link.why_closed}). "
            f"{_HINTS[interface]}"
        )
    heard: dict[tuple[int, bool], tuple[int, bytes]] = {}
    sets = moves = 0
    last = -1
    end_ns = clock.now_ns() + round(span_s * 1e9)
    while (left_ns := end_ns - clock.now_ns()) > 0 and link.ready():
        frame = link.receive(left_ns)
        if frame is None or frame.can_id < 0:
            continue
        count, _ = heard.get(frame[:2], (0, b""))
        heard[frame[:2]] = (count + 1, frame.data)
        if reader.take(frame) is Taken.SET:
            sets += 1
            moves += reader.heartbeat != last
            last = reader.heartbeat
    link.close()
    still = "STANDS STILL: wrong signal or a stopped PLC"
    if not heard:
        still = (
            "not heard: no frame of the map came. CANopen nodes send after `aff-runtime run` has "
            "started them; CAN by DBC: check bit rate, wiring and identifiers"
        )
    verdict = "moves" if moves > 1 else still
    yield f"{sets} sets, {reader.torn} torn, {reader.bad_lengths} of wrong length"
    yield f"plc_heartbeat {verdict}; status 0x{reader.status:04X}; roll_id {reader.roll_id}"
    for layout in can_map.frames_of(can_map.read_fields):
        count, data = heard.get((layout.can_id, layout.extended), (0, b""))
        period = f"{span_s * 1e3 / count:7.2f} ms" if count else "  silent"
        yield f"0x{layout.can_id:03X} {layout.name:20} {count:5} {period}  {data.hex(' ').upper()}"
    for reading, value in zip(can_map.channels, reader.values, strict=True):
        yield f"  {reading.name:28} {value:14.6g}  {reading.field}"
