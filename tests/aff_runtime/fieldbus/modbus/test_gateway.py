from __future__ import annotations

import math

import pytest

from aff_runtime.base.signals import NO_ECHO, Outcome, Snapshot
from aff_runtime.fieldbus.modbus.codec import WordCodec
from aff_runtime.fieldbus.modbus.gateway import WordGateway
from aff_runtime.fieldbus.modbus.registers import Register, WordType
from aff_runtime.fieldbus.scan_edge import LOOK_TICKS, ScanEdge
from tests.aff_runtime.fieldbus.euclid_map import ANGLE_SCALE, command, euclid_map
from tests.doubles.loopback import LoopbackTransport
from tests.doubles.virtual_clock import VirtualClock
from tests.each_case import each_case

PERIOD_NS = 5_000_000
ANGLE = 6


def block(heartbeat: int, *, status: int = 45, speed: int = 1016, angle: int = 0) -> list[int]:
    words = [heartbeat, status, 0, 0, 0, speed, 10000, 0, 12, 0, 0, 0, 0, 0, 0]
    words[11], words[12] = (angle >> 16) & 0xFFFF, angle & 0xFFFF
    return words


class Rig:
    def __init__(self, *, edge: ScanEdge | None = None, **words: object) -> None:
        self.clock = VirtualClock()
        self.said: list[int] | Outcome = Outcome.NOT_CONNECTED
        self.heard: list[int] = []
        self.gateway = WordGateway(
            LoopbackTransport(self._answer), WordCodec(euclid_map(**words)), self.clock, edge=edge
        )
        self.ticks = 0

    def _answer(self, words: list[int]) -> list[int] | Outcome:
        self.heard = words
        return self.said

    def tick(self, said: list[int] | Outcome) -> Snapshot:
        self.said = said
        self.clock.advance_ns(PERIOD_NS)
        self.ticks += 1
        deadline_ns = self.clock.now_ns() + PERIOD_NS
        return self.gateway.exchange(command(heartbeat=self.ticks), self.ticks, deadline_ns)


def test_the_command_goes_out_and_the_reading_comes_in_with_its_time() -> None:
    rig = Rig()
    snapshot = rig.tick(block(5))
    assert rig.heard[0] == 1
    assert (snapshot.tick, snapshot.t_ns) == (1, PERIOD_NS)
    assert (snapshot.plc_heartbeat, snapshot.status, snapshot.roll_id) == (5, 45, 12)
    assert snapshot.values[2] == pytest.approx(1.016)


def test_the_echo_is_as_old_as_the_command_that_the_plc_took() -> None:
    rig = Rig(aff_echo=15)
    ages = [rig.tick([*block(5 + k), echo]).echo_age for k, echo in enumerate((0, 0, 65_535, 4))]
    assert ages == [1, 2, 4, 0]
    assert rig.tick(Outcome.TIMEOUT).echo_age == NO_ECHO
    assert rig.tick(block(9)).echo_age == NO_ECHO  # a word too few
    assert Rig().tick(block(5)).echo_age == NO_ECHO


def test_what_the_plc_applies_is_read_with_the_echo_and_with_nothing_but_a_good_reply() -> None:
    shown = Register(name="unwind", address=16, type=WordType.I16, scale=0.00001)
    rig = Rig(aff_echo=15, applied=(shown, None))
    rig.tick([*block(5), 0, 0])
    first, second = rig.tick([*block(6), 0, 0xFFFE]).applied
    assert first == pytest.approx(-0.00002)
    assert math.isnan(second)
    assert rig.tick(Outcome.TIMEOUT).applied == ()
    assert Rig().tick(block(5)).applied == ()


def test_fresh_means_the_heartbeat_moved_not_that_the_server_answered() -> None:
    rig = Rig()
    beats = [65532, 65533, 65533, 65533, 65534, 65535, 0]
    snapshots = [rig.tick(block(beat)) for beat in beats]
    assert [s.fresh for s in snapshots] == [False, True, False, False, True, True, True]
    assert [round(s.age_s * 1e3) for s in snapshots] == [5, 0, 5, 10, 0, 0, 0]


@each_case(
    "outcome", [Outcome.TIMEOUT, Outcome.NOT_CONNECTED, Outcome.EXCEPTION, Outcome.BAD_REPLY]
)
def test_without_a_good_reply_there_are_no_values_and_age_grows(outcome: Outcome) -> None:
    rig = Rig()
    rig.tick(block(5))
    rig.tick(block(6))
    snapshots = [rig.tick(outcome) for _ in range(3)]
    assert [s.outcome for s in snapshots] == [outcome] * 3
    assert all(math.isnan(value) for s in snapshots for value in s.values)
    assert len(snapshots[0].values) == 8
    assert not any(s.fresh for s in snapshots)
    assert [round(s.age_s * 1e3) for s in snapshots] == [5, 10, 15]
    last = snapshots[-1]
    assert (last.plc_heartbeat, last.status, last.roll_id) == (6, 45, 12)


@pytest.mark.parametrize("count", [0, 14, 16])
def test_a_block_of_the_wrong_size_is_a_bad_reply(count: int) -> None:
    rig = Rig()
    rig.tick(block(5))
    snapshot = rig.tick(([6] * 20)[:count])
    assert (snapshot.outcome, snapshot.fresh, snapshot.plc_heartbeat) == (
        Outcome.BAD_REPLY,
        False,
        5,
    )
    assert math.isnan(snapshot.values[0])


def test_the_first_reply_of_a_new_connection_is_no_data() -> None:
    rig = Rig()
    rig.tick(block(5))
    rig.tick(block(6))
    rig.tick(Outcome.NOT_CONNECTED)
    first = rig.tick(block(9, status=0, speed=0))
    second = rig.tick(block(10))
    assert (first.outcome, first.fresh, first.status) == (Outcome.NOT_CONNECTED, False, 45)
    assert math.isnan(first.values[2])
    assert (second.outcome, second.fresh) == (Outcome.OK, True)
    assert second.values[2] == pytest.approx(1.016)


def test_a_plc_that_answers_with_a_frozen_heartbeat_after_reconnect_stays_stale() -> None:
    rig = Rig()
    rig.tick(block(5))
    rig.tick(Outcome.NOT_CONNECTED)
    snapshots = [rig.tick(block(77)) for _ in range(4)]
    assert not any(s.fresh for s in snapshots)
    assert round(snapshots[-1].age_s * 1e3) == 30


def test_an_angle_keeps_turning_through_a_missed_reply_and_restarts_after_a_reconnect() -> None:
    rig = Rig()
    rig.tick(block(1, angle=0x7FFFFFFF))
    rig.tick(Outcome.TIMEOUT)
    over = rig.tick(block(2, angle=0x80000001))
    rig.tick(Outcome.NOT_CONNECTED)
    rig.tick(block(3, angle=0x80000002))
    again = rig.tick(block(4, angle=0x80000003))
    assert over.values[ANGLE] == (2**31 + 1) * ANGLE_SCALE
    assert again.values[ANGLE] == (3 - 2**31) * ANGLE_SCALE


def test_closing_the_gateway_closes_the_wire() -> None:
    rig = Rig()
    rig.gateway.close()
    assert rig.tick(block(1)).outcome is Outcome.NOT_CONNECTED


def test_two_old_replies_by_turns_are_no_living_plc() -> None:
    rig = Rig()
    for beat in (5, 6, 7):
        rig.tick(block(beat))
    shots = [rig.tick(block(beat)) for beat in (6, 7) * 20]
    assert not any(shot.fresh for shot in shots)
    assert {shot.outcome for shot in shots[::2]} == {Outcome.BAD_REPLY}
    assert all(math.isnan(value) for value in shots[0].values)
    assert shots[-1].age_s == pytest.approx(len(shots) * PERIOD_NS * 1e-9)


def test_a_plc_that_began_again_on_the_same_connection_is_believed_soon() -> None:
    rig = Rig()
    for beat in (20000, 20005, 20010):
        rig.tick(block(beat))
    shots = [rig.tick(block(beat)) for beat in (0, 5, 10)]
    assert [shot.fresh for shot in shots] == [False, True, True]


def test_a_counter_of_a_byte_loses_one_reply_where_it_starts_over_and_a_toggle_never_lives() -> (
    None
):
    rig = Rig()
    shots = [rig.tick(block(beat)) for beat in (253, 254, 255, 0, 1, 2)]
    assert [shot.fresh for shot in shots] == [False, True, True, False, True, True]
    rig = Rig()
    shots = [rig.tick(block(beat)) for beat in (0, 1) * 10]
    assert [shot.fresh for shot in shots[:2]] == [False, True]
    assert not any(shot.fresh for shot in shots[2:])


def test_a_heartbeat_that_stands_and_leaps_by_turns_moves_the_ticks() -> None:
    at_edge, beside, without = (
        Rig(edge=ScanEdge(PERIOD_NS, 1 << 16)),
        Rig(edge=ScanEdge(PERIOD_NS, 1 << 16)),
        Rig(),
    )
    for tick in range(LOOK_TICKS + 1):
        edge_beat = 5 + tick - (tick % 4 == 1)  # 1, 0, 2, 1 scans further
        at_edge.tick(block(edge_beat))
        without.tick(block(edge_beat))
        beside.tick(block(5 + tick))
    assert at_edge.gateway.shift_ns == PERIOD_NS // 200
    assert (beside.gateway.shift_ns, without.gateway.shift_ns) == (0, 0)
    at_edge.tick(Outcome.TIMEOUT)
    assert at_edge.gateway.shift_ns == 0
