"""The link over python-can: what it takes from a bus, what it drops, and when."""

from __future__ import annotations

from collections import deque
from typing import Any

import pytest

from aff_runtime.base.python_can import can
from aff_runtime.fieldbus.can.frames import Frame
from aff_runtime.fieldbus.can.link import PythonCanLink
from aff_runtime.fieldbus.can_catalogue import open_bus
from tests.doubles.virtual_clock import VirtualClock


class ScriptedBus(can.BusABC):
    """A python-can bus that says what a test gave it."""

    def __init__(self) -> None:
        self.said: deque[can.Message | OSError] = deque()
        self.channel_info = "scripted"
        super().__init__(channel=None)

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        raise NotImplementedError

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        if not self.said:
            return None, True
        said = self.said.popleft()
        if isinstance(said, OSError):
            raise said
        return said, True


def opened() -> tuple[PythonCanLink, ScriptedBus, VirtualClock]:
    bus, clock = ScriptedBus(), VirtualClock()
    link = PythonCanLink(lambda: bus, clock)
    link.ready()
    assert link.ready()
    return link, bus, clock


def message(**words: Any) -> can.Message:
    return can.Message(arbitration_id=0x180, is_extended_id=False, data=b"\x01\x02", **words)


@pytest.mark.parametrize("is_rx", [True, False])
def test_a_frame_counts_whether_another_machine_or_a_program_on_this_one_sent_it(
    is_rx: bool,
) -> None:
    # SocketCAN marks what another socket of this very machine sent (python-can: is_rx False); a
    # PLC on the gateway, a bench on vcan and a second master started here all look like that
    link, bus, _ = opened()
    bus.said.append(message(is_rx=is_rx))
    assert link.receive(0) == Frame(0x180, False, b"\x01\x02")


def test_a_bus_that_does_not_open_says_why_until_it_does() -> None:
    clock, answers = VirtualClock(), [OSError("No such device: can0"), ScriptedBus()]

    def open_bus() -> can.BusABC:
        answer = answers.pop(0)
        if isinstance(answer, OSError):
            raise answer
        return answer

    link = PythonCanLink(open_bus, clock)
    assert not link.ready()
    assert link.troubles == ("the CAN bus does not open: No such device: can0",)
    clock.advance_ns(200_000_000)
    link.ready()
    assert link.ready()
    assert link.troubles == ()


@pytest.mark.parametrize("kind", [{"is_remote_frame": True}, {"is_fd": True}])
def test_a_remote_or_fd_frame_is_nobody_s_data(kind: dict[str, bool]) -> None:
    link, bus, _ = opened()
    bus.said.append(message(**kind))
    taken = link.receive(0)
    assert taken is not None
    assert taken.can_id == -1


def test_an_error_frame_is_counted_and_only_bus_off_closes_the_bus() -> None:
    link, bus, clock = opened()
    error = {"is_error_frame": True, "is_extended_id": False}
    bus.said.append(can.Message(arbitration_id=0x80, **error))
    assert link.receive(0) is not None
    assert link.ready()
    bus.said.append(can.Message(arbitration_id=0x40, **error))
    assert link.receive(0) is None
    assert not link.ready()
    assert (link.error_frames, link.bus_offs) == (2, 1)
    clock.advance_ns(100_000_000)
    link.ready()
    assert link.ready()


def test_a_driver_that_fails_closes_the_bus() -> None:
    link, bus, _ = opened()
    bus.said.append(OSError("network is down"))
    assert link.receive(0) is None
    assert not link.carries


def reopens_after_ms(link: PythonCanLink, clock: VirtualClock) -> int:
    for ms in range(5000):
        link.ready()
        if link.carries:
            return ms
        clock.advance_ns(1_000_000)
    return -1


def fail_after(bus: ScriptedBus, link: PythonCanLink, clock: VirtualClock, seconds: float) -> None:
    bus.said.append(message())
    link.receive(0)
    clock.advance_ns(round(seconds * 1e9))
    bus.said.append(OSError("the bus went away"))
    link.receive(0)
    assert not link.carries


def test_a_bus_that_served_is_opened_again_at_once_and_the_next_time_after_a_pause() -> None:
    link, bus, clock = opened()
    fail_after(bus, link, clock, 2.0)
    assert reopens_after_ms(link, clock) == 0
    fail_after(bus, link, clock, 1.999)
    assert reopens_after_ms(link, clock) == 100


def test_a_bus_that_brought_nothing_waits_longer_each_time() -> None:
    link, bus, clock = opened()
    waits = []
    for _ in range(6):
        clock.advance_ns(3_000_000_000)
        bus.said.append(OSError("the bus went away"))
        link.receive(0)
        waits.append(reopens_after_ms(link, clock))
    assert waits == [100, 200, 400, 800, 1600, 2000]


def test_bus_off_has_its_quiet_time_however_long_the_bus_served() -> None:
    link, bus, clock = opened()
    bus.said.append(message())
    link.receive(0)
    clock.advance_ns(5_000_000_000)
    bus.said.append(can.Message(arbitration_id=0x40, is_error_frame=True, is_extended_id=False))
    link.receive(0)
    assert reopens_after_ms(link, clock) == 100


def test_the_driver_s_stamp_becomes_monotonic_time() -> None:
    bus, clock = ScriptedBus(), VirtualClock(7_000_000_000)
    link = PythonCanLink(lambda: bus, clock, wall_s=lambda: 1_800_000_000.004)
    link.ready()
    bus.said.append(message(timestamp=1_800_000_000.001))
    link.receive(0)
    assert link.arrived_ns == pytest.approx(6_997_000_000, abs=1000)
    bus.said.append(message(timestamp=0.0))
    link.receive(0)
    assert link.arrived_ns == -1


OURS = (0x180, False)


def test_a_frame_of_somebody_else_is_not_taken_for_an_empty_bus() -> None:
    # python-can's own virtual bus: it filters in software, as udp_multicast does
    with can.Bus(interface="virtual", channel="aff test") as other:
        link = PythonCanLink(
            lambda: open_bus("virtual", "aff test", 500_000, (OURS,)), VirtualClock()
        )
        link.ready()
        for can_id in (0x7F0, 0x180):
            other.send(can.Message(arbitration_id=can_id, is_extended_id=False, data=b"\x01"))
        heard = [link.receive(0) for _ in range(3)]
        link.close()
    assert heard == [Frame(0x7F0, False, b"\x01"), Frame(0x180, False, b"\x01"), None]


def test_a_driver_that_filters_by_itself_keeps_its_filters(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class Kernel(ScriptedBus):
        _is_filtered = True  # as SocketCAN says when the kernel took them

    def opens(can_filters: Any, **_: Any) -> Kernel:
        bus = Kernel()
        bus.set_filters(can_filters)
        return bus

    monkeypatch.setattr(can, "Bus", opens)
    filters = open_bus("socketcan", "can0", 500_000, (OURS, (0x1234, True))).filters
    assert filters == [
        {"can_id": 0x180, "can_mask": 0x7FF, "extended": False},
        {"can_id": 0x1234, "can_mask": 0x1FFFFFFF, "extended": True},
    ]
