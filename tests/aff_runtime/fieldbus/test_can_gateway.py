from __future__ import annotations

import math

import pytest

from aff_runtime.base.clock import VirtualClock
from aff_runtime.base.signals import Outcome, Snapshot
from aff_runtime.fieldbus.can_frames import Frame
from aff_runtime.fieldbus.can_gateway import CanGateway
from aff_runtime.fieldbus.can_reader import CanReader
from aff_runtime.fieldbus.can_writer import CanWriter
from tests.aff_runtime.fieldbus.euclid_can import command, euclid_map, scan
from tests.aff_runtime.fieldbus.fake_link import FakeLink

MAP = euclid_map()
TICK_NS = 5_000_000
DEADLINE_NS = 3_000_000


class Bench:
    def __init__(self) -> None:
        self.clock = VirtualClock()
        self.link = FakeLink(self.clock)
        self.gateway = CanGateway(self.link, CanReader(MAP), CanWriter(MAP), self.clock)
        self.ticks = 0

    def tick(self, *frames: Frame) -> Snapshot:
        start = self.ticks * TICK_NS
        self.clock.sleep_until_ns(start)
        self.ticks += 1
        self.link.heard.extend(frames)
        shot = self.gateway.exchange(command(self.ticks), self.ticks, start + DEADLINE_NS)
        assert self.clock.now_ns() <= start + DEADLINE_NS
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


def test_silence_is_a_timeout_with_age() -> None:
    bench = Bench().running()
    shots = [bench.tick() for _ in range(4)]
    assert {shot.outcome for shot in shots} == {Outcome.TIMEOUT}
    assert shots[-1].age_s == pytest.approx(0.023, abs=1e-9)  # 4 ticks and the wait of the last


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
