"""What ``probe-map`` says of a bus whose sets are not whole; frames are cantools' own."""

from __future__ import annotations

import math
import struct
from collections.abc import Callable

import pytest

from aff_runtime.base.python_can import can
from aff_runtime.fieldbus import probe_frames
from aff_runtime.fieldbus.can.frames import Frame
from aff_runtime.fieldbus.can.heard_frames import HeardFrames
from aff_runtime.fieldbus.can.layout import Field
from tests.aff_runtime.fieldbus.euclid_can import euclid_map, scan
from tests.doubles.virtual_clock import VirtualClock

MAP = euclid_map()
SCANS = 6


class Tape(can.BusABC):
    """Plays frames, then silence; a frame takes 1 ms."""

    def __init__(self, frames: list[Frame], clock: VirtualClock) -> None:
        self._left, self._clock, self.shut = list(frames), clock, 0
        super().__init__(channel="tape")

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        if not self._left:
            raise KeyboardInterrupt
        self._clock.advance_ns(1_000_000)
        one = self._left.pop(0)
        return can.Message(arbitration_id=one.can_id, is_extended_id=False, data=one.data), True

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        raise AssertionError("probe-map sends nothing")

    def shutdown(self) -> None:
        self.shut += 1
        super().shutdown()


def said_of(monkeypatch: pytest.MonkeyPatch, spoil: Callable[[Frame], Frame | None]) -> list[str]:
    frames = [spoil(one) for beat in range(SCANS) for one in scan(beat)]
    kept = [one for one in frames if one is not None]
    clock = VirtualClock()
    bus = Tape(kept, clock)
    monkeypatch.setattr(probe_frames, "open_bus", lambda *_: bus)
    span_s = len(kept) * 1e-3
    return list(probe_frames.listen(MAP, "socketcan", "tape", 500_000, clock, span_s=span_s))


def test_a_silent_frame_is_named_and_the_others_are_read(monkeypatch: pytest.MonkeyPatch) -> None:
    said = said_of(monkeypatch, lambda one: None if one.can_id == 0x181 else one)
    assert said[0].startswith("0 sets")
    assert said[1] == "plc_heartbeat moves; status 0x002F; roll_id 41"
    assert said[2].startswith("NO WHOLE SET: silent: 0x181 PLC_MOTION.")
    values = {line.split()[0]: float(line.split()[1]) for line in said if line.startswith("  ")}
    assert values["unwind_tension_N"] == 90.0
    assert values["unwind_radius_m"] == pytest.approx(0.2)
    assert math.isnan(values["line_speed_m_s"])


def test_a_silent_heartbeat_frame_is_not_a_stopped_plc(monkeypatch: pytest.MonkeyPatch) -> None:
    said = said_of(monkeypatch, lambda one: None if one.can_id == 0x184 else one)
    assert said[1] == "plc_heartbeat not heard: PLC_STATUS is silent; status -; roll_id -"


def test_a_frame_of_another_length_is_named_with_both(monkeypatch: pytest.MonkeyPatch) -> None:
    said = said_of(
        monkeypatch, lambda o: o._replace(data=o.data + b"\0") if o.can_id == 0x181 else o
    )
    assert said[2].startswith("NO WHOLE SET: wrong length: PLC_MOTION.")
    (line,) = (line for line in said if line.startswith("0x181"))
    assert line.endswith("WRONG LENGTH: 9 bytes, the map says 8")


def test_a_counter_that_is_not_the_heartbeat_s_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    ahead = lambda o: o._replace(data=o.data[:-1] + b"\x77") if o.can_id == 0x182 else o  # noqa: E731
    said = said_of(monkeypatch, ahead)
    assert said[2].startswith(
        "NO WHOLE SET: PLC_ANGLES.Counter differs from the low bits of PLC_STATUS.PlcHeartbeat."
    )


def test_a_healthy_bus_shows_its_values_and_no_complaint(monkeypatch: pytest.MonkeyPatch) -> None:
    said = said_of(monkeypatch, lambda one: one)
    assert not any("NO WHOLE SET" in line or "OUTSIDE" in line for line in said)
    assert said[1] == "plc_heartbeat moves; status 0x002F; roll_id 41"


def test_a_value_beyond_the_range_of_the_dbc_is_shown_and_marked(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # 0x7FFFFF = 8388607 counts = 8388.607 N; the DBC file ends at 8388 N
    said = said_of(
        monkeypatch,
        lambda o: o._replace(data=b"\x7f\xff\xff" + o.data[3:]) if o.can_id == 0x180 else o,
    )
    (line,) = (line for line in said if line.startswith("  unwind_tension_N"))
    assert "8388.61" in line
    assert "OUTSIDE -8388..8388: counts as missing" in line


def test_control_c_lets_go_of_the_bus(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = VirtualClock()
    bus = Tape([], clock)
    monkeypatch.setattr(probe_frames, "open_bus", lambda *_: bus)
    with pytest.raises(KeyboardInterrupt):
        list(probe_frames.listen(MAP, "socketcan", "tape", 500_000, clock))
    assert bus.shut == 1


def test_a_float_signal_is_read() -> None:
    heard = HeardFrames(MAP)
    heard.take(Frame(0x182, False, struct.pack("<f", -2.5) + bytes(4)))
    field = Field(name="F", frame="PLC_ANGLES", shift=0, length=32, is_float=True)
    assert heard.value(field) == -2.5
