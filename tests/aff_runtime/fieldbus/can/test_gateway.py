from __future__ import annotations

import math
from dataclasses import replace

import pytest

from aff_runtime.base.signals import NO_ECHO, Outcome, Snapshot
from aff_runtime.fieldbus.can.frames import Frame
from aff_runtime.fieldbus.can.gateway import CanGateway
from aff_runtime.fieldbus.can.phase_lock import PhaseLock
from aff_runtime.fieldbus.can.reader import CanReader
from aff_runtime.fieldbus.can.writer import CanWriter
from aff_runtime.fieldbus.scan_edge import LOOK_TICKS, ScanEdge
from tests.aff_runtime.fieldbus.euclid_can import command, euclid_map, scan
from tests.aff_runtime.fieldbus.fake_link import FakeLink
from tests.doubles.virtual_clock import VirtualClock
from tests.each_case import each_case

MAP = euclid_map()
MAP_HEARTBEATS = CanReader(MAP).heartbeat_modulus
TICK_NS = 5_000_000
DEADLINE_NS = 3_000_000


class Bench:
    def __init__(self, lock: PhaseLock | None = None, edge: ScanEdge | None = None) -> None:
        self.clock = VirtualClock()
        self.link = FakeLink(self.clock)
        self.gateway = CanGateway(
            self.link, CanReader(MAP), CanWriter(MAP), self.clock, lock, edge=edge
        )
        self.ticks = 0

    def tick(self, *frames: Frame) -> Snapshot:
        start = self.ticks * TICK_NS
        self.clock.sleep_until_ns(start)
        self.ticks += 1
        self.link.heard.extend(frames)
        shot = self.gateway.exchange(command(self.ticks), self.ticks, start + DEADLINE_NS)
        assert self.clock.now_ns() == start  # a tick never waits
        assert shot.outcome is Outcome.OK or all(math.isnan(v) for v in shot.values)
        return shot

    def running(self) -> Bench:
        self.tick(*scan(1))
        self.tick(*scan(2))
        assert self.tick(*scan(3)).fresh
        return self


def test_the_first_set_after_silence_only_gives_the_heartbeat_to_compare_with() -> None:
    bench = Bench()
    assert bench.tick(*scan(1)).outcome is not Outcome.OK
    shots = [bench.tick(*scan(2)), bench.tick(*scan(3))]
    assert [shot.outcome for shot in shots] == [Outcome.NOT_CONNECTED, Outcome.OK]
    assert shots[1].fresh
    assert shots[1].values[0] == pytest.approx(90.0)


def test_the_echo_is_as_old_as_the_command_that_the_plc_took() -> None:
    bench = Bench().running()  # three ticks: the command of this one carries 4
    assert [bench.tick(*scan(4 + k, echo=echo)).echo_age for k, echo in enumerate((3, 3, 1))] == [
        1,
        2,
        5,
    ]
    assert bench.tick(*scan(7, echo=65_535)).echo_age == 8
    assert bench.tick().echo_age == NO_ECHO  # no set, no news


def test_a_map_without_the_echo_has_none() -> None:
    bench = Bench()
    bench.gateway.reader = CanReader(replace(MAP, aff_echo=None))
    assert bench.running().tick(*scan(4, echo=3)).echo_age == NO_ECHO


def test_what_the_plc_applies_is_of_the_set_and_gone_without_one() -> None:
    bench = Bench().running()
    shot = bench.tick(*scan(4, applied_m_s=(0.02, -0.0123)))
    assert shot.applied == pytest.approx((0.02, -0.0123), abs=1e-12)
    assert bench.tick().applied == ()
    without = Bench()
    without.gateway.reader = CanReader(replace(MAP, applied=()))
    assert without.running().tick(*scan(4, applied_m_s=(0.02, 0.0))).applied == ()


def test_silence_is_a_timeout_with_age() -> None:
    bench = Bench().running()
    shots = [bench.tick() for _ in range(4)]
    assert {shot.outcome for shot in shots} == {Outcome.TIMEOUT}
    # without a stamp the last set may have been there since the tick before found the bus empty
    assert shots[-1].age_s == pytest.approx(0.025, abs=1e-9)


def test_a_frozen_heartbeat_is_answered_but_not_fresh() -> None:
    bench = Bench().running()
    shots = [bench.tick(*scan(3)) for _ in range(10)]
    assert {shot.outcome for shot in shots} == {Outcome.OK}
    assert not any(shot.fresh for shot in shots)
    assert shots[-1].age_s > 0.045


def test_two_scans_in_one_tick_give_the_newer() -> None:
    bench = Bench().running()
    shot = bench.tick(*scan(4, tension_N=50.0), *scan(5, tension_N=60.0))
    assert shot.plc_heartbeat == 5
    assert shot.values[0] == pytest.approx(60.0)


def test_half_a_scan_waits_for_the_next_tick() -> None:
    bench = Bench().running()
    frames = scan(4)
    assert bench.tick(*frames[:2]).outcome is Outcome.TIMEOUT
    assert bench.tick(*frames[2:]).fresh


def test_our_own_identifier_from_somebody_else_is_never_good() -> None:
    bench = Bench().running()
    shot = bench.tick(*scan(4), Frame(0x200, False, bytes(8)))
    assert shot.outcome is Outcome.BAD_REPLY
    assert bench.gateway.foreign == 1


def test_a_wrong_length_spoils_the_tick() -> None:
    bench = Bench().running()
    assert bench.tick(Frame(0x180, False, bytes(8)), *scan(4)).outcome is Outcome.BAD_REPLY


def test_a_dead_bus_is_not_connected_and_its_first_set_goes_nowhere() -> None:
    bench = Bench().running()
    bench.link.up = False
    assert bench.tick().outcome is Outcome.NOT_CONNECTED
    bench.link.up = True
    bench.link.heard.clear()
    assert bench.tick(*scan(90)).outcome is not Outcome.OK
    assert bench.tick(*scan(91)).outcome is Outcome.NOT_CONNECTED
    assert bench.tick(*scan(92)).fresh


def test_a_refused_frame_is_a_dead_bus() -> None:
    bench = Bench().running()
    bench.link.takes = False
    assert bench.tick(*scan(4)).outcome is Outcome.NOT_CONNECTED


def test_a_babbling_bus_does_not_hold_the_tick() -> None:
    bench = Bench().running()
    bench.link.heard.extend([Frame(0x7F0, False, b"")] * 5000)
    bench.tick()
    assert len(bench.link.heard) >= 4000


def test_each_tick_sends_every_frame_once() -> None:
    bench = Bench().running()
    bench.link.sent.clear()
    bench.tick(*scan(4))
    assert [frame.can_id for frame in bench.link.sent] == [0x200, 0x201, 0x202]


def test_the_stamp_of_the_frame_that_closed_the_set_is_its_age() -> None:
    bench = Bench().running()
    bench.link.arrived_ns = bench.ticks * TICK_NS - 1_250_000
    assert bench.tick(*scan(4)).age_s == pytest.approx(0.00125, abs=1e-9)


@each_case("wrong_ns", [-1, 0, 5 * TICK_NS, 10**18])
def test_a_stamp_that_cannot_be_leaves_the_set_as_old_as_it_can_be(wrong_ns: int) -> None:
    # no stamp; before the bus was last found empty; in the future: what a stepped clock gives
    bench = Bench().running()
    bench.link.arrived_ns = wrong_ns
    assert bench.tick(*scan(4)).age_s == pytest.approx(0.005, abs=1e-9)


def test_what_a_babbling_bus_left_over_counts_from_before_it() -> None:
    bench = Bench().running()
    bench.link.heard.extend([Frame(0x7F0, False, b"")] * 300)
    assert bench.tick(*scan(4)).outcome is Outcome.TIMEOUT
    shot = bench.tick()
    assert (shot.fresh, shot.plc_heartbeat) == (True, 4)
    assert shot.age_s == pytest.approx(0.010, abs=1e-9)


def test_a_tick_reads_no_longer_than_its_deadline() -> None:
    bench = Bench().running()

    class Slow(FakeLink):
        def receive(self, wait_ns: int) -> Frame | None:
            self.clock.advance_ns(500_000)
            return super().receive(wait_ns)

    slow = Slow(bench.clock)
    slow.heard.extend([Frame(0x7F0, False, b"")] * 300)
    gateway = CanGateway(slow, CanReader(MAP), CanWriter(MAP), bench.clock)
    start_ns = bench.clock.now_ns()
    gateway.exchange(command(), 1, start_ns + DEADLINE_NS)
    assert bench.clock.now_ns() - start_ns == DEADLINE_NS
    assert [frame.can_id for frame in slow.sent] == [0x200, 0x201, 0x202]


def test_the_command_leaves_after_what_was_heard_was_taken() -> None:
    bench = Bench().running()
    order: list[str] = []
    receive, send = bench.link.receive, bench.link.send
    bench.link.receive = lambda wait: (order.append("in"), receive(wait))[1]  # type: ignore[method-assign]
    bench.link.send = lambda frame: (order.append("out"), send(frame))[1]  # type: ignore[method-assign]
    bench.tick(*scan(4))
    assert order == ["in"] * 6 + ["out"] * 3


def test_only_a_stamped_set_moves_the_ticks() -> None:
    bench = Bench(PhaseLock(TICK_NS, margin_ns=1_000_000)).running()
    assert bench.gateway.shift_ns == 0
    bench.link.arrived_ns = bench.ticks * TICK_NS - 2_600_000
    bench.tick(*scan(4))
    assert bench.gateway.shift_ns == -100_000  # 1.6 ms too old: a sixteenth of that earlier
    bench.tick()
    assert bench.gateway.shift_ns == 0  # nothing arrived


def test_answers_that_show_no_scan_and_two_by_turns_move_the_ticks() -> None:
    bench = Bench(edge=ScanEdge(TICK_NS, MAP_HEARTBEATS)).running()
    for tick in range(LOOK_TICKS):
        bench.tick(*scan((4 + tick - (tick % 4 == 1)) % MAP_HEARTBEATS))
    assert bench.gateway.shift_ns == TICK_NS // 200
    bench.tick()
    assert bench.gateway.shift_ns == 0


def test_somebody_who_sends_our_frames_is_named_until_he_is_gone() -> None:
    bench = Bench().running()
    assert bench.gateway.troubles == ()
    assert bench.tick(Frame(0x200, False, bytes(8)), *scan(4)).outcome is Outcome.BAD_REPLY
    assert "somebody else sends the frames of this gateway" in bench.gateway.troubles[0]
    for beat in range(5, 5 + 201):
        bench.tick(*scan(beat))
    assert bench.gateway.troubles == ()


@each_case("where", ["ready", "receive"])
@each_case(("held_ms", "sent_m_s", "bits"), [(60, 0.01, 4), (1000, 0.0, 0)])
def test_a_command_that_is_too_old_when_the_bus_is_read_goes_out_as_zero(
    where: str, held_ms: int, sent_m_s: float, bits: int
) -> None:
    bench = Bench().running()

    class Held(FakeLink):
        def ready(self) -> bool:
            self.hold("ready")
            return super().ready()

        def receive(self, wait_ns: int) -> Frame | None:
            self.hold("receive")
            return super().receive(wait_ns)

        def hold(self, here: str) -> None:
            self.clock.advance_ns(held_ms * 1_000_000 if here == where else 0)

    held = Held(bench.clock)
    gateway = CanGateway(held, CanReader(MAP), CanWriter(MAP), bench.clock, command_life_s=0.15)
    said = command(9, (0.01, -0.01))
    gateway.exchange(said, 9, bench.clock.now_ns() + DEADLINE_NS)
    wanted = replace(said, corrections=(sent_m_s, -sent_m_s), state_bits=bits)
    assert held.sent == list(CanWriter(MAP).encode(wanted))
