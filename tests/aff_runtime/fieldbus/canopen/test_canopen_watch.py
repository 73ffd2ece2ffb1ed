"""Who is heard on a CANopen bus, and when a silent node is a lost one."""

from __future__ import annotations

from collections import deque
from itertools import pairwise
from typing import Any

import pytest

from aff_runtime.base.python_can import can
from aff_runtime.base.signals import Outcome
from aff_runtime.fieldbus.can.frames import Frame
from aff_runtime.fieldbus.can_catalogue import BusSite, canopen_gateway
from aff_runtime.fieldbus.canopen.link import CanopenLink
from aff_runtime.fieldbus.canopen.node import NodePlan
from tests.aff_runtime.fieldbus.canopen_bench import NETWORK, CanopenBench
from tests.aff_runtime.fieldbus.euclid_can import command
from tests.aff_runtime.fieldbus.fake_link import FakeLink
from tests.doubles.virtual_clock import VirtualClock
from tests.each_case import each_case

MS = 1_000_000
OWN = 100


class KernelBus(can.BusABC):
    """A bus whose driver drops what its filters do not pass, as SocketCAN has the kernel do."""

    _is_filtered = True

    def __init__(self) -> None:
        self.said: deque[can.Message] = deque()
        self.channel_info = "kernel"
        super().__init__(channel=None)

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        del msg, timeout

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        del timeout
        while self.said:
            message = self.said.popleft()
            if self._matches_filters(message):
                return message, True
        return None, True


@pytest.mark.parametrize(
    ("can_id", "data", "word"),
    [(0x700 + OWN, b"\x05", "the heartbeat of node 100"), (0x080, b"", "SYNC")],
)
def test_somebody_in_our_place_is_heard_through_the_filters_that_the_driver_is_given(
    monkeypatch: pytest.MonkeyPatch, can_id: int, data: bytes, word: str
) -> None:
    bus, clock = KernelBus(), VirtualClock()

    def opens(can_filters: Any, **_: Any) -> KernelBus:
        bus.set_filters(can_filters)
        return bus

    monkeypatch.setattr(can, "Bus", opens)
    gateway = canopen_gateway(
        NETWORK,
        BusSite(interface="socketcan", channel="can0", bitrate=500_000),
        clock,
        own_node=OWN,
        heartbeat_ms=20,
    )
    for tick in range(3):
        bus.said.append(can.Message(arbitration_id=0x7F0, is_extended_id=False, data=b"\x01"))
        bus.said.append(can.Message(arbitration_id=can_id, is_extended_id=False, data=data))
        gateway.exchange(command(tick, (0.0, 0.0)), tick, clock.now_ns() + 3 * MS)
        clock.advance_ns(5 * MS)
    passed = {one["can_id"] for one in bus.filters or ()}
    assert 0x7F0 not in passed
    assert {0x080, 0x764, 0x703, 0x583, 0x083} <= passed
    assert word in gateway.troubles[0]


def test_heartbeats_that_waited_while_we_paused_are_read_before_a_node_is_lost() -> None:
    bench = CanopenBench()
    bench.run(0.6)
    assert bench.tick().fresh
    told = [keeper.plan.heartbeat_ms for keeper in bench.link.keepers]
    pause_ms = 4 * max(told)  # lost after three; the frames of the pause wait in the socket
    for _ in range(pause_ms // 5):
        bench.lockstep.advance(0.005)
        bench.clock.advance_ns(5 * MS)
    old = bench.tick()
    assert bench.link.troubles == ()
    # the answer to the SYNC before the pause is older than fault_after_ms: no reading of now
    assert (old.fresh, old.outcome) == (False, Outcome.NOT_CONNECTED)
    bench.run(0.02)
    assert bench.tick().fresh  # nobody was configured anew, which takes 0.1 s and more
    assert bench.link.troubles == ()


def drive(heartbeat_ms: int) -> tuple[CanopenLink, FakeLink, VirtualClock]:
    """Return a link to one node without objects, started, its own tick at 0."""
    clock = VirtualClock()
    inner = FakeLink(clock)
    plan = NodePlan(name="drive", node_id=3, writes=(), heartbeat_ms=heartbeat_ms)
    link = CanopenLink(inner, (plan,), own_node=OWN, heartbeat_ms=20, clock=clock)
    answers = (None, "583 4F 01 10 00 00 00 00 00", "703 05")  # the error register; OPERATIONAL
    for answer in answers:
        link.ready()
        if answer is not None:
            can_id, _, data = answer.partition(" ")
            inner.heard.append(Frame(int(can_id, 16), False, bytes.fromhex(data)))
            link.ready()
    assert link.keepers[0].good
    return link, inner, clock


BEAT = Frame(0x703, False, b"\x05")


def look(link: CanopenLink) -> bool:
    """Do with the link what the gateway does with it in a tick."""
    if not link.ready():
        return False
    while link.receive(0) is not None:
        pass
    return link.ready()


@each_case(("beat_ms", "cycle_ms"), [(10, 40), (10, 60), (50, 5), (13, 40)])
def test_a_node_that_beats_as_asked_is_never_lost_whatever_the_cycle(
    beat_ms: int, cycle_ms: int
) -> None:
    link, inner, clock = drive(beat_ms)
    for _ in range(2000 // cycle_ms):
        before_ms = clock.now_ns() // MS
        clock.advance_ns(cycle_ms * MS)
        beats = clock.now_ns() // MS // beat_ms - before_ms // beat_ms
        inner.heard.extend([BEAT] * beats)
        assert look(link), link.troubles
    # three periods without one, and the tick after them sees it
    for _ in range(3 * beat_ms // cycle_ms + 1):
        clock.advance_ns(cycle_ms * MS)
        good = look(link)
    assert not good
    assert link.troubles == ("drive (node 3): heartbeat lost",)


def test_a_bus_that_is_never_found_empty_does_not_hide_a_silent_node() -> None:
    link, inner, clock = drive(10)
    assert look(link)
    for _ in range(20):
        clock.advance_ns(20 * MS)
        inner.heard.extend([Frame(0x181, False, b"")] * 4)
        link.ready()
        for _ in range(3):  # one frame is always left
            link.receive(0)
    assert link.troubles == ("drive (node 3): heartbeat lost",)


@pytest.mark.parametrize("late_ns", [0, 30_000])
def test_our_heartbeat_keeps_its_period_when_ticks_wake_unevenly(late_ns: int) -> None:
    link, inner, clock = drive(50)
    start_ns = clock.now_ns()
    left = []
    for tick in range(1, 201):
        due_ns = start_ns + tick * 5 * MS + (late_ns if tick % 8 == 0 else 0)
        clock.advance_ns(due_ns - clock.now_ns())
        inner.sent.clear()
        inner.heard.append(BEAT)
        look(link)
        if any(frame.can_id == 0x764 for frame in inner.sent):
            left.append(tick)
    apart = {5 * (b - a) for a, b in pairwise(left)}
    assert apart == {20}
