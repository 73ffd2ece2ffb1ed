"""No reply of a serial wire is taken for the answer to another question; in virtual time.

The device does what a device on one line does: it answers in order, and may be slow, deaf while
it is busy, or not understood. Every reply names the request that it answers.
"""

from __future__ import annotations

from unittest.mock import patch

import pytest
from hypothesis import given
from hypothesis import strategies as st

from aff_runtime.base.signals import Outcome
from aff_runtime.fieldbus.modbus import rtu_frames, rtu_tcp_wire
from aff_runtime.fieldbus.modbus.frames import ModbusFrames, WireFunction
from aff_runtime.fieldbus.modbus.rtu_frames import RtuFraming, rtu_of
from aff_runtime.fieldbus.modbus.transport import ModbusTransport
from tests.aff_runtime.fieldbus.fake_wire import Arrivals, FakeWire
from tests.aff_runtime.fieldbus.modbus_rig import (
    DEADLINE_NS,
    MS,
    PERIOD_NS,
    READ_COUNT,
    WORDS,
    good,
)
from tests.doubles.virtual_clock import VirtualClock
from tests.drawn import drawn
from tests.each_case import each_case

NOISE = {  # before a late reply
    "noise": bytes(1),
    "noise of 3": b"\x00\x00\x55",
    "noise of 6": b"\xff\x02\xfe\x00\x10\xff",
}
GLUED = {
    "00": bytes(1),
    "0000": bytes(2),
    "ffffff": b"\xff" * 3,
}  # before a reply, in one piece with it
HABITS = st.sampled_from(("good", "slow", "lost", "not heard", "flipped", *NOISE, *GLUED))
SILENCE_NS = 50 * MS


class Line:
    """A transport on RTU over TCP, and the device; its habits last one request each."""

    def __init__(self, function: WireFunction, deaf: bool = False) -> None:
        self.clock = VirtualClock(10**9)
        self.socket = FakeWire(self.clock, self._answer)
        self.habits: list[tuple[str, int]] = []
        self.deaf = deaf  # while busy
        self._busy_until_ns = 0
        with patch.object(rtu_tcp_wire, "TcpWire", lambda *_: self.socket):
            wire = rtu_tcp_wire.RtuTcpWire("127.0.0.1", 4001)
        frames = ModbusFrames(
            device_id=1, read_start=0, read_count=READ_COUNT, write_start=100, write_count=2
        )
        self.transport = ModbusTransport(
            frames=frames, wire=wire, clock=self.clock, function=function
        )
        assert self.outcomes(2) == [Outcome.NOT_CONNECTED, Outcome.OK]

    def _answer(self, request: bytes) -> Arrivals:
        habit, delay_ns = self.habits.pop(0) if self.habits else ("good", MS // 2)
        now_ns = self.clock.now_ns()
        busy = now_ns < self._busy_until_ns
        if habit == "not heard" or (busy and self.deaf):
            return []
        length = (len(request) - 2).to_bytes(2, "big")
        name = len(self.socket.requests).to_bytes(2, "big")
        reply = bytearray(rtu_of(good(name + bytes(2) + length + request[:-2])))
        wait_ns = delay_ns + max(0, self._busy_until_ns - now_ns)
        if habit.startswith(("slow", "noise")):
            wait_ns += 10 * delay_ns
        if habit.endswith("flipped"):
            reply[delay_ns % len(reply)] ^= 1 << delay_ns % 8
        self._busy_until_ns = now_ns + wait_ns
        reply = bytearray(GLUED.get(habit.removeprefix("slow "), b"")) + reply
        noise = NOISE.get(habit, b"")
        turning: Arrivals = [(MS // 8, noise)] if noise else []
        return [] if habit == "lost" else [*turning, (wait_ns, bytes(reply))]

    def tick(self) -> Outcome:
        start_ns = self.clock.now_ns()
        outcome, words = self.transport.transact(WORDS, start_ns + DEADLINE_NS)
        assert self.clock.now_ns() <= start_ns + DEADLINE_NS
        if outcome is Outcome.OK:
            assert words == [len(self.socket.requests)] * READ_COUNT, "of the newest question"
        self.clock.sleep_until_ns(start_ns + PERIOD_NS)
        return outcome

    def outcomes(self, ticks: int) -> list[Outcome]:
        return [self.tick() for _ in range(ticks)]

    def asked(self, since: int) -> list[int]:
        return [request[1] for request in self.socket.requests[since:]]


@drawn(quick=30, long=300)
@given(
    st.sampled_from((WireFunction.FC23, WireFunction.FC3_FC16)),
    st.booleans(),
    st.lists(st.tuples(HABITS, st.integers(MS // 4, 4 * MS)), max_size=30),
)
def test_every_reading_answers_the_newest_question(
    function: WireFunction, deaf: bool, habits: list[tuple[str, int]]
) -> None:
    line = Line(function, deaf)
    line.habits = habits
    for _ in range(8 * len(habits) + 20):
        line.tick()
        if line.transport.trouble:
            line.clock.advance_ns(100 * MS)  # some of the pause before an attempt
    line.habits.clear()
    line.clock.advance_ns(2000 * MS)
    assert Outcome.OK in line.outcomes(20), "it recovers from whatever that was"


@each_case("lost", ["lost", "not heard"])
@each_case(
    ("function", "which", "asked"),
    [
        (WireFunction.FC23, 0, [23, 3, 23]),
        (WireFunction.FC3_FC16, 0, [16, 3, 16, 3]),
        (WireFunction.FC3_FC16, 1, [16, 3, 16, 3, 16, 3]),
    ],
)
def test_a_lost_frame_is_followed_by_a_question_of_another_function(
    function: WireFunction, which: int, asked: list[int], lost: str
) -> None:
    line = Line(function)
    line.habits = [*[("good", MS // 2)] * which, (lost, MS)]
    since = len(line.socket.requests)
    expected = [Outcome.TIMEOUT, Outcome.TIMEOUT, Outcome.OK, Outcome.OK]
    assert (line.outcomes(4), line.asked(since)) == (expected, asked)


@pytest.mark.parametrize("habit", ["lost", "noise of 3"])
def test_a_tick_that_asked_anew_without_the_command_says_so(habit: str) -> None:
    line = Line(WireFunction.FC23)
    line.habits = [(habit, MS // 2)]
    since = len(line.socket.requests)
    told = [line.transport.wrote for _ in range(6) if line.tick() is Outcome.OK]
    assert told == [function == 23 for function in line.asked(since)[1:]]
    assert told.count(False) == 1


def test_a_reader_waits_for_the_only_reply_that_there_is() -> None:
    line = Line(WireFunction.FC3)
    line.habits = [("slow", 4 * MS)]
    since = len(line.socket.requests)
    assert line.outcomes(9) == [Outcome.TIMEOUT] * 9  # 44 ms
    assert line.asked(since) == [3]
    assert line.tick() is Outcome.OK


@pytest.mark.parametrize("deaf", [False, True])
def test_a_reply_that_comes_after_the_second_question_is_thrown_away(deaf: bool) -> None:
    line = Line(WireFunction.FC23, deaf)
    line.habits = [("slow", MS), ("good", MS), ("good", MS // 2)]  # 11 ms; asked anew at 10 ms
    since = len(line.socket.requests)
    third = Outcome.TIMEOUT if deaf else Outcome.OK
    assert line.outcomes(4) == [Outcome.TIMEOUT, Outcome.TIMEOUT, third, Outcome.OK]
    assert line.asked(since) == [23, 3, 23]
    assert line.socket.aborted == []


def test_noise_before_a_late_reply_does_not_end_its_request() -> None:
    line = Line(WireFunction.FC23)
    line.habits = [("noise", MS // 2)]  # 5.5 ms
    since = len(line.socket.requests)
    expected = [Outcome.TIMEOUT, Outcome.TIMEOUT, Outcome.OK]
    assert (line.outcomes(3), line.asked(since)) == (expected, [23, 23])


@each_case("noise", ["noise of 3", "noise of 6"])
@each_case(
    ("function", "asked"),
    [(WireFunction.FC23, [23, 3, 23]), (WireFunction.FC3_FC16, [16, 3, 16, 3])],
)
def test_noise_as_long_as_a_reply_is_followed_by_a_question_of_another_function(
    function: WireFunction, asked: list[int], noise: str
) -> None:
    line = Line(function)
    line.habits = [(noise, MS // 2)]  # the reply comes at 5.5 ms
    since = len(line.socket.requests)
    expected = [Outcome.TIMEOUT, Outcome.OK, Outcome.OK]
    assert (line.outcomes(3), line.asked(since)) == (expected, asked)


@each_case("place", range(8))
@each_case(
    ("function", "before", "spoilt", "n_bytes"),
    [
        (WireFunction.FC3_FC16, [("good", MS // 2)], 1, 8),  # the read lost, the write spoilt
        (WireFunction.FC23, [], 2, 5 + 2 * READ_COUNT),
    ],
)
def test_a_lost_reply_and_spoilt_ones_after_it_cost_their_ticks_and_no_connection(
    function: WireFunction, before: list[tuple[str, int]], spoilt: int, n_bytes: int, place: int
) -> None:
    line = Line(function)
    flipped = ("flipped", 1000 * n_bytes + place)  # a byte of the reply
    line.habits = [*before, ("lost", MS), *[flipped] * spoilt]
    expected = [*[Outcome.TIMEOUT] * (2 + spoilt), Outcome.OK, Outcome.OK]
    assert (line.outcomes(4 + spoilt), line.socket.aborted) == (expected, [])


@pytest.mark.parametrize("noise", GLUED)
@pytest.mark.parametrize("first_comes", [True, False])
@pytest.mark.parametrize(
    ("function", "asked"),
    [(WireFunction.FC23, [23, 3, 23]), (WireFunction.FC3_FC16, [16, 3, 16, 3])],
)
def test_noise_in_one_piece_with_a_reply_to_one_of_two_questions_throws_no_reply_away(
    function: WireFunction, asked: list[int], first_comes: bool, noise: str
) -> None:
    line = Line(function)
    line.habits = [(f"slow {noise}", MS)] if first_comes else [("lost", MS), (noise, MS)]
    since = len(line.socket.requests)
    expected = [Outcome.TIMEOUT, Outcome.TIMEOUT, Outcome.OK, Outcome.OK]
    assert (line.outcomes(4), line.asked(since), line.socket.aborted) == (expected, asked, [])


@each_case("noise", [*GLUED.values(), b"\x55\x01", b"\x00\x01\x03\x04", b"\0\x01\x10"])
@each_case("cut", range(1, 22))
def test_both_replies_are_found_behind_noise_however_they_come(noise: bytes, cut: int) -> None:
    framing, into = RtuFraming(), memoryview(bytearray(256))
    framing.request(b"\0\1\0\0\0\x06\x01\x10\0\x64\0\x02")
    framing.request(b"\0\2\0\0\0\x06\x01\x03\0\0\0\x02")
    write = rtu_of(b"\0\0\0\0\0\x06\x01\x10\0\x64\0\x02")
    read = rtu_of(b"\0\0\0\0\0\x07\x01\x03\x04\xde\xad\xbe\xef")
    came = noise + write + read
    found = [framing.deliver(piece, into) for piece in (came[:cut], came[cut:])]
    count = max(found)
    assert bytes(into[:count]) == b"\0\2\0\0\0\x07\x01\x03\x04\xde\xad\xbe\xef"


def test_noise_that_looks_like_many_replies_costs_a_few_checks(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    framing, checked = RtuFraming(), list[bytes]()
    framing.request(b"\0\1\0\0\0\x06\x01\x10\0\x64\0\x02")
    framing.request(b"\0\2\0\0\0\x06\x01\x03\0\0\0\x02")
    monkeypatch.setattr(rtu_frames, "crc16", lambda body: checked.append(body) or 0)
    assert framing.deliver(bytes(3) + b"\1\3\x78" * 84, memoryview(bytearray(256))) == 0
    assert 0 < len(checked) < 10


def test_noise_without_a_reply_to_two_questions_is_forgotten_by_the_next_tick() -> None:
    framing, into = RtuFraming(), memoryview(bytearray(256))
    framing.request(b"\0\1\0\0\0\x06\x01\x10\0\x64\0\x02")
    framing.request(b"\0\2\0\0\0\x06\x01\x03\0\0\0\x02")
    assert framing.deliver(b"\0\x55\x01\x03\x40", into) == 0
    assert framing.nothing_more() == 0
    read = rtu_of(b"\0\0\0\0\0\x07\x01\x03\x04\xde\xad\xbe\xef")
    assert bytes(into[: framing.deliver(read, into)])[:2] == b"\0\2"


def test_a_reply_that_is_spoilt_after_a_tick_of_noise_is_judged_at_once() -> None:
    framing, into = RtuFraming(), memoryview(bytearray(256))
    framing.request(b"\0\1\0\0\0\x06\x01\x10\0\x64\0\x02")
    framing.request(b"\0\2\0\0\0\x06\x01\x03\0\0\0\x02")
    assert framing.deliver(b"\0\x55\x01\x03\x40", into) == 0
    assert framing.nothing_more() == 0
    read = bytearray(rtu_of(b"\0\0\0\0\0\x07\x01\x03\x04\xde\xad\xbe\xef"))
    read[4] ^= 1
    assert framing.deliver(bytes(read), into) == rtu_frames.SPOILT


def test_a_late_reply_that_is_spoilt_leaves_the_one_to_the_second_question() -> None:
    line = Line(WireFunction.FC23)
    # asked anew at 10 ms, spoilt at 11, a third question at 15, the second's reply after it
    line.habits = [("slow flipped", MS), ("good", 17 * MS // 4)]
    since = len(line.socket.requests)
    expected = [*[Outcome.TIMEOUT] * 3, Outcome.OK]
    assert (line.outcomes(4), line.asked(since)) == (expected, [23, 3, 23])


def test_a_line_that_is_gone_is_asked_twice_and_then_replaced() -> None:
    line = Line(WireFunction.FC23)
    line.habits = [("lost", MS)] * 2
    since = len(line.socket.requests)
    assert line.outcomes(11) == [Outcome.TIMEOUT] * (SILENCE_NS // PERIOD_NS + 1)
    assert line.asked(since) == [23, 3]
    assert line.socket.aborted == [True]
