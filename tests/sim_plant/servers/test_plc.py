from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from aff_runtime.base.signals import StateBits, Status
from sim_plant.servers.plc import Plc
from tests.each_case import each_case
from tests.sim_plant.servers.fake_line import FakeLine, default_map, write_block

SCAN_s = 0.005
MEASURED = FakeLine().step({})
MAP = default_map()


class Bench:
    """A PLC with a runtime beside it that changes its heartbeat in every scan."""

    def __init__(self) -> None:
        self.plc = Plc(MAP)
        self.scans = 0
        self.heartbeat = 0

    def scan(self, *, alive=True, times=1, **words):
        for _ in range(times):
            self.scans += 1
            self.heartbeat += alive
            block = write_block(self.heartbeat, **words)
            last = self.plc.scan(self.scans * SCAN_s, MEASURED, block)
        return last

    def armed(self):
        self.scan(times=3, state=StateBits.ARMED)
        return self


def unwind(scan):
    return scan.corrections_m_s["unwind"]


def test_a_good_correction_counts_at_once_on_both_actuators():
    scan = Bench().armed().scan(unwind=1234, follower=-567)
    assert scan.refusal == ""
    assert scan.corrections_m_s == pytest.approx({"unwind": 0.01234, "swrap_follower": -0.00567})


def test_the_heartbeat_counts_scans_and_wraps():
    bench = Bench()
    bench.plc._heartbeat = 0xFFFE
    assert [bench.scan().read_words[0] for _ in range(3)] == [0xFFFF, 0, 1]


def test_the_echo_is_the_heartbeat_that_this_scan_judged_whatever_it_was_worth():
    bench = Bench()
    at = MAP.read["aff_echo"] - MAP.read_start
    assert bench.plc.scan(0.0, MEASURED, [0] * MAP.write_count).read_words[at] == 0
    bench.heartbeat = 0xFFFD
    echoes = [bench.scan(alive=alive).read_words[at] for alive in (True, True, False)]
    assert echoes == [0xFFFE, 0xFFFF, 0xFFFF]
    assert bench.scan(unwind=20_000).refusal != ""  # above the limit
    assert bench.scan().read_words[at] == bench.heartbeat & 0xFFFF


def test_fading_counts_like_active():
    assert unwind(Bench().armed().scan(unwind=100, state=StateBits.FADING)) == pytest.approx(1e-3)


@each_case(
    "state", [0, StateBits.READY, StateBits.ARMED, StateBits.BYPASS, StateBits.FAULT, 0x0400]
)
def test_a_state_without_active_or_fading_does_not_count(state):
    scan = Bench().armed().scan(unwind=1000, state=state)
    assert unwind(scan) == 0.0
    assert scan.refusal.startswith("state")


@each_case(
    ("words", "rule"),
    [
        ({"unwind": 1000, "broken_complement": True}, "complement: unwind"),
        ({"unwind": 15001}, "limit: unwind"),
        ({"unwind": -15001}, "limit: unwind"),
        ({"follower": 5001}, "limit: swrap_follower"),
    ],
)
def test_a_broken_or_excessive_correction_counts_for_no_actuator(words, rule):
    scan = Bench().armed().scan(**({"follower": 100} | words))
    assert set(scan.corrections_m_s.values()) == {0.0}
    assert scan.refusal == rule


def test_a_correction_at_the_limit_counts():
    scan = Bench().armed().scan(unwind=-15000, follower=5000)
    assert scan.corrections_m_s == pytest.approx({"unwind": -0.15, "swrap_follower": 0.05})


@each_case("bit", ["AFF_ENABLE_REQUEST", "LINE_RUN", "WEB_INTACT", "TENSION_VALID", "ESTOP_OK"])
def test_a_missing_permissive_stops_the_correction_and_its_return_restores_it(bit):
    bench = Bench().armed()
    bench.scan(unwind=1000)
    bench.plc.set_status(Status[bit], False)
    stopped = bench.scan(unwind=1000, times=40)
    assert unwind(stopped) == pytest.approx(0.0, abs=1e-12)
    assert bit in stopped.refusal
    assert not stopped.read_words[1] & Status[bit]
    bench.plc.set_status(Status[bit], True)
    assert unwind(bench.scan(unwind=1000)) == pytest.approx(0.01)


def test_remote_is_shown_but_not_needed():
    bench = Bench().armed()
    assert not bench.plc.status & Status.REMOTE
    bench.plc.set_status(Status.REMOTE, True)
    assert unwind(bench.scan(unwind=1000)) == pytest.approx(0.01)


def test_the_ramp_is_linear_from_the_value_held_and_ends_within_the_fade_time():
    bench = Bench().armed()
    bench.scan(unwind=2000)
    ramp = [unwind(bench.scan(state=StateBits.FAULT, unwind=2000)) for _ in range(45)]
    expected = [max(0.0, 0.02 * (1 - (k + 1) * SCAN_s / 0.1)) for k in range(45)]
    assert ramp == pytest.approx(expected, abs=1e-12)
    assert ramp[19] == 0.0  # 100 ms after the last good scan


def test_a_still_heartbeat_trips_after_80_ms_and_is_zero_100_ms_later():
    bench = Bench().armed()
    bench.scan(unwind=2000)
    held = [unwind(bench.scan(alive=False, unwind=2000)) for _ in range(60)]
    assert held[:16] == pytest.approx([0.02] * 16)  # 16 scans of 5 ms = 80 ms
    assert held[16] < 0.02
    assert held[34] > 0.0
    assert held[35] == 0.0  # 180 ms after the heartbeat last moved
    assert bench.plc.trips == 1


@each_case("stragglers", range(5))
@each_case("last_at", [16, 12, 5])
def test_commands_that_get_through_a_lossy_wire_do_not_make_zero_late(stragglers, last_at):
    """Each costs at most ``regain_s`` and its own scan: 80 + n (20 + 5) + 100 ms."""
    bench = Bench().armed()
    bench.scan(unwind=2000)
    moves = {last_at - 2 * k for k in range(stragglers)}
    held = [unwind(bench.scan(alive=k in moves, unwind=2000)) for k in range(80)]
    assert not any(held[36 + 5 * stragglers :])
    assert len(held[: 36 + 5 * stragglers]) * SCAN_s <= 0.3


def test_what_the_runtime_cannot_see_is_told_by_the_enable_request():
    bench = Bench().armed()
    asks = Status.AFF_ENABLE_REQUEST
    assert bench.scan(unwind=1000).read_words[1] & asks
    assert not bench.scan(alive=False, unwind=1000, times=17).read_words[1] & asks
    assert not bench.scan(unwind=1000).read_words[1] & asks
    assert not bench.scan(state=StateBits.ARMED).read_words[1] & asks
    assert bench.scan(state=StateBits.FAULT).read_words[1] & asks
    assert unwind(bench.scan(unwind=1000)) == pytest.approx(0.01)


def test_after_a_trip_the_runtime_must_first_leave_active_and_fading():
    bench = Bench().armed()
    bench.scan(unwind=1000)
    bench.scan(alive=False, unwind=1000, times=80)
    for state in (StateBits.ACTIVE, StateBits.FADING, StateBits.ACTIVE):
        scan = bench.scan(unwind=1000, state=state)
        assert unwind(scan) == 0.0
        assert scan.refusal.startswith("rearm")
    bench.scan(state=StateBits.READY)
    assert unwind(bench.scan(unwind=1000)) == pytest.approx(0.01)


def test_leaving_active_while_the_heartbeat_is_still_does_not_rearm():
    bench = Bench().armed()
    bench.scan(alive=False, times=40)
    bench.scan(alive=False, state=StateBits.READY, times=5)
    assert bench.scan(unwind=1000).refusal.startswith("rearm")


def test_a_runtime_that_is_active_when_the_plc_starts_is_not_accepted():
    bench = Bench()
    assert bench.scan(unwind=1000, times=10).refusal.startswith("rearm")
    bench.armed()
    bench.plc.restart()
    assert bench.scan(unwind=1000, times=10).refusal.startswith("rearm")


def test_a_lost_complement_does_not_latch():
    bench = Bench().armed()
    bench.scan(unwind=1000)
    bench.scan(unwind=1000, broken_complement=True)
    assert unwind(bench.scan(unwind=900)) == pytest.approx(0.009)


def test_a_float_correction_that_is_not_a_number_does_not_count():
    row = MAP.corrections[0]
    item = replace(row.item, type="f32", address=110, scale=1.0)
    row = replace(row, item=item, complement_address=112)
    plc = Plc(replace(MAP, corrections=(row,), applied=MAP.applied[:1], write_count=14))
    nan = (0x7FC0, 0x0000)
    for heartbeat in range(3):
        idle = [*write_block(heartbeat, state=0), 0, 0, 0, 0]
        plc.scan(heartbeat * SCAN_s, MEASURED, idle)
    block = [*write_block(3), *nan, *(word ^ 0xFFFF for word in nan)]
    assert plc.scan(3 * SCAN_s, MEASURED, block).refusal == "limit: unwind"


WORD = st.integers(0, 0xFFFF)
STEPS = st.lists(
    st.tuples(
        st.booleans(),  # heartbeat moves
        st.sampled_from([0, 2, 4, 8, 4, 4, 0xFFFF]),
        st.integers(-32768, 32767) | st.integers(-6100, 6100),
        st.integers(-32768, 32767) | st.integers(-3100, 3100),
        st.booleans(),  # web intact
        st.floats(0.0, 0.3),
    ),
    max_size=60,
)


@settings(max_examples=60, deadline=None)
@given(STEPS)
def test_whatever_is_written_the_limit_holds_and_refusal_never_raises_the_correction(steps):
    bench = Bench().armed()
    now_s, before = 1.0, {"unwind": 0.0, "swrap_follower": 0.0}
    for moves, state, unwind_counts, follower_counts, intact, dt_s in steps:
        now_s += dt_s
        bench.heartbeat += moves
        bench.plc.set_status(Status.WEB_INTACT, intact)
        block = write_block(
            bench.heartbeat, unwind=unwind_counts, follower=follower_counts, state=state
        )
        scan = bench.plc.scan(now_s, MEASURED, block)
        assert abs(scan.corrections_m_s["unwind"]) <= 0.15
        assert abs(scan.corrections_m_s["swrap_follower"]) <= 0.05
        if not intact:
            assert scan.refusal
        if scan.refusal:
            assert all(abs(v) <= abs(before[n]) for n, v in scan.corrections_m_s.items())
        before = dict(scan.corrections_m_s)


@settings(max_examples=60, deadline=None)
@given(st.lists(st.lists(WORD, min_size=10, max_size=10), max_size=40))
def test_random_words_never_exceed_the_limit(blocks):
    bench = Bench().armed()
    for number, block in enumerate(blocks):
        scan = bench.plc.scan(1.0 + number * SCAN_s, MEASURED, block)
        assert abs(scan.corrections_m_s["unwind"]) <= 0.15
        assert abs(scan.corrections_m_s["swrap_follower"]) <= 0.05
