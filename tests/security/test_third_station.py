"""Who reaches the PLC can do what AFF can: it is told, and a PLC that behaves is never accused."""

from __future__ import annotations

import math

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import State, StateBits
from sim_plant.servers.modbus_device import ModbusDevice
from sim_plant.servers.plant import THIRD_M_S
from tests.drawn import drawn
from tests.matrix.bench import SAMPLE_S, MatrixBench
from tests.security.behaving_plc import FOREIGN, RAMPS, TICK_MS, Line, Plc, Spans

pytestmark = pytest.mark.processes

TOLD_S = 0.300
WIRES = ("modbus", "can", "canopen")
SECOND = BY_NAME["SECOND_MASTER"].code


def working(wire: str, *, applied: bool = True) -> MatrixBench:
    """Return a bench whose correction is at work."""
    bench = MatrixBench(wire, applied=applied)
    bench.run(1.0 if wire == "canopen" else 0.3)
    bench.arm()
    assert bench.until(State.ACTIVE, within_s=1.0)
    bench.run(0.4)
    assert any(bench.applied[-20:])
    return bench


def told_after_s(bench: MatrixBench, *, most_s: float = TOLD_S) -> float:
    """Run until APPLIED_DIFFERS is told; return how long that took, s."""
    for samples in range(1, round(most_s / SAMPLE_S) + 1):
        bench.run(SAMPLE_S)
        if FOREIGN in bench.around.codes:
            return samples * SAMPLE_S
    return math.inf


@pytest.mark.parametrize("wire", WIRES)
@pytest.mark.parametrize("phase_s", [0.0, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 1.4])
@pytest.mark.sweep(every=8)
def test_in_active_it_is_told_within_300_ms_and_ours_fades_and_latches(
    wire: str, phase_s: float
) -> None:
    bench = working(wire)
    bench.run(phase_s)  # of the law's sine of 1.57 s
    bench.begin("third:2")
    assert told_after_s(bench) <= TOLD_S
    assert bench.guard.state is State.FAULT
    assert bench.plant.refusal == ""  # the PLC sees one healthy master
    assert SECOND not in bench.around.codes
    bench.run(bench.site.freshness.fade_ms * 1e-3 + SAMPLE_S)
    assert bench.sent == (0.0, 0.0)
    assert set(bench.plant.applied_m_s.values()) == {THIRD_M_S}  # the web is still his


@pytest.mark.parametrize("wire", WIRES)
@pytest.mark.sweep(every=3)
def test_in_bypass_it_is_told_by_alarm_event_and_refusal_to_arm_while_it_lasts(wire: str) -> None:
    bench = working(wire)
    bench.bypass()
    bench.run(0.5)
    assert bench.guard.state is State.BYPASS
    bench.begin("third:1")
    assert told_after_s(bench) <= TOLD_S
    assert bench.alarm == FOREIGN
    bench.arm()
    bench.run(0.3)
    assert bench.guard.state is State.BYPASS
    said = bench.guard.first_blocking()
    assert said.startswith("blocked by APPLIED_DIFFERS (unwind: 0.02 m/s applied, 0 sent)")
    assert bench.around.codes.count(FOREIGN) == 1
    bench.run(1.5)  # he is gone
    assert (bench.guard.state, bench.alarm) == (State.BYPASS, BY_NAME["BYPASSED"].code)
    bench.arm()
    assert bench.until(State.ACTIVE)


@pytest.mark.parametrize("wire", WIRES)
@pytest.mark.sweep(every=3)
def test_without_the_word_it_is_as_it_was_before_there_was_one(wire: str) -> None:
    """What the word is there for: the web moves, and nobody knows."""
    bench = working(wire, applied=False)
    bench.bypass()
    bench.run(0.5)
    bench.begin("third:1")
    assert THIRD_M_S in bench.run(0.9)
    assert FOREIGN not in bench.around.codes
    assert bench.guard.first_blocking() == ""


def frames(value: int) -> list[bytes]:
    """Return his requests: FC16 on state, then on each correction with its complement."""
    pair = value.to_bytes(2, "big") + (value ^ 0xFFFF).to_bytes(2, "big")
    state = int(StateBits.ACTIVE).to_bytes(2, "big")
    return [
        bytes.fromhex("10 0065 0001 02") + state,
        bytes.fromhex("10 0067 0002 04") + pair,
        bytes.fromhex("10 006C 0002 04") + pair,
    ]


@pytest.mark.parametrize("every", [1, 3])
@pytest.mark.parametrize("state", [State.ACTIVE, State.BYPASS])
def test_a_third_client_on_modbus_that_leaves_the_heartbeat_alone_is_told(
    state: State, every: int
) -> None:
    bench = working("modbus")
    if state is State.BYPASS:
        bench.bypass()
        bench.run(0.5)
    device = ModbusDevice(bench.plant.registers)
    for samples in range(round(TOLD_S / SAMPLE_S)):
        if samples % every == 0:
            assert [device.answer(pdu)[0] for pdu in frames(2000)] == [16, 16, 16]
        bench.run(SAMPLE_S)
    assert FOREIGN in bench.around.codes
    assert bench.guard.state is (State.BYPASS if state is State.BYPASS else State.FAULT)


RUN_MS = 1200


def spans(most: int, longest_ms: int) -> st.SearchStrategy[Spans]:
    row = st.tuples(st.integers(0, RUN_MS), st.integers(1, longest_ms))
    return st.lists(row.map(lambda r: (r[0], r[0] + r[1])), max_size=most).map(tuple)


def delays(most_ms: int) -> st.SearchStrategy[tuple[int, ...]]:
    return st.lists(st.integers(0, most_ms), min_size=1, max_size=40).map(tuple)


@st.composite
def plcs(draw: st.DrawFn) -> Plc:
    limit = draw(st.sampled_from([200, 1000, 2500, 5000, 32767]))
    return Plc(
        scan_ms=draw(st.sampled_from([1, 2, 5, 7, 10, 20, 40, 80])),
        fade_ms=draw(st.integers(0, 100)),
        ramp=draw(st.sampled_from(sorted(RAMPS))),
        limit=limit,
        cuts=limit < 5000 and draw(st.booleans()),
        refuses=draw(spans(3, 300)),
        stops=draw(spans(3, 300)),
        rounds=draw(st.booleans()),
        zero_ends=draw(st.booleans()),
        tells=draw(st.booleans()),
    )


@st.composite
def lines(draw: st.DrawFn) -> Line:
    """Of a law that sends nothing faster than half the PLC's scans: the drive would get an alias.

    One period a scan stands still at the PLC's limit, and is taken for a stranger's (threat
    model, applied word).
    """
    most_ms = draw(st.sampled_from([0, 5, 25, 80]))
    plc = draw(plcs())
    fastest_Hz = min(17.0, 0.45 / (1e-3 * plc.scan_ms))
    sine = st.tuples(st.floats(0.002, 0.06), st.floats(0.1, fastest_Hz), st.floats(0.0, 6.3))
    sines = draw(st.lists(sine, min_size=1, max_size=3))
    return Line(
        plc=plc,
        outs=draw(delays(most_ms)),
        backs=draw(delays(most_ms)),
        cut=draw(spans(2, 200)),
        lost=draw(spans(3, 70)),
        skips=draw(st.dictionaries(st.integers(1, 240), st.integers(1, 30), max_size=4)),
        new_runtime=draw(st.integers(-1, RUN_MS)),
        new_plc=draw(st.integers(-1, RUN_MS)),
        limits=tuple(
            draw(st.lists(st.tuples(st.integers(0, RUN_MS), st.floats(0.001, 0.1)), max_size=3))
        ),
        wish=lambda t: sum(a * math.cos(2.0 * math.pi * f * t + p) for a, f, p in sines),
        peak_m_s=sum(a for a, _, _ in sines),
        bypasses=tuple(draw(st.lists(st.integers(0, RUN_MS), max_size=3))),
    )


@drawn(quick=5, long=100, without=list(HealthCheck))
@given(lines())
def test_a_plc_that_behaves_is_never_accused(line: Line) -> None:
    line.run(RUN_MS)
    assert not line.accused, line.accused_ms[:3]


@pytest.mark.long
@settings(deadline=None, max_examples=150, suppress_health_check=list(HealthCheck))
@given(lines())
def test_of_many_that_behave_none_is_accused(line: Line) -> None:
    line.run(RUN_MS)
    assert not line.accused, line.accused_ms[:3]


def sine(t: float) -> float:
    return 0.04 * math.sin(2.0 * math.pi * 2.0 * t)


@pytest.mark.parametrize(
    "line",
    [
        Line(wish=sine),
        Line(wish=sine, plc=Plc(limit=1000, cuts=True)),
        Line(wish=sine, plc=Plc(limit=1000, tells=False)),
        Line(wish=sine, plc=Plc(scan_ms=80), outs=(80, 0), backs=(0, 80, 40)),
        Line(wish=sine, plc=Plc(scan_ms=20, ramp="slow", refuses=((700, 1000),))),
        Line(wish=sine, new_plc=700, new_runtime=900),
        Line(wish=sine, cut=((600, 700),), lost=((900, 960),)),
        Line(wish=sine, skips={100: 10, 130: 40}, limits=((500, 0.01), (700, 0.05))),
    ],
    ids=["plain", "cuts", "refuses", "slow", "ramps", "restarts", "lossy", "stalls and edits"],
)
def test_the_healthy_lines_of_this_page_really_apply_something(line: Line) -> None:
    line.run(RUN_MS)
    assert not line.accused
    assert State.ACTIVE in line.states
    assert sum(map(bool, line.applied)) > 0.2 * len(line.applied)


def test_a_plc_that_gets_and_cuts_one_side_of_a_fast_sine_is_not_accused() -> None:
    """Delays repeat every 60 ms, the sine every 60.9 ms: the PLC takes its positive half."""
    line = Line(
        plc=Plc(scan_ms=1, fade_ms=0, limit=200, cuts=True, rounds=False, tells=False),
        outs=(1, 0, 0, 31, 26, 21, 16, 11, 6, 1, 0, 6),
        backs=(5,),
        wish=lambda t: 0.047 * math.cos(2.0 * math.pi * 16.42 * t + 1.42),
    ).run(RUN_MS)
    assert not line.accused, line.accused_ms[:3]
    assert State.ACTIVE in line.states


@pytest.mark.parametrize(("frequency_Hz", "phase_rad"), [(1.0, 4.2), (1.25, 3.5)])
def test_a_plc_that_cuts_the_other_sign_when_readings_come_back_is_not_accused(
    frequency_Hz: float, phase_rad: float
) -> None:
    """The runtime stalls for 50 ms while a slow sine passes zero: the next reading is cut."""
    line = Line(
        plc=Plc(scan_ms=40, fade_ms=0, limit=200, cuts=True, rounds=False, zero_ends=False),
        skips={120: 10},
        wish=lambda t: 0.03125 * math.cos(2.0 * math.pi * frequency_Hz * t + phase_rad),
    ).run(RUN_MS)
    assert not line.accused, line.accused_ms[:3]
    assert State.ACTIVE in line.states


@drawn(quick=8, long=100)
@given(
    counts=st.integers(3, 5000) | st.integers(-5000, -3),
    scan_ms=st.sampled_from([1, 5, 10, 20, 40]),
    outs=delays(25),
    backs=delays(25),
    begins_ms=st.integers(400, 700),
    ramp=st.sampled_from(sorted(RAMPS)),
)
def test_at_rest_whatever_is_more_than_a_count_of_each_word_is_told_within_300_ms(
    counts: int,
    scan_ms: int,
    outs: tuple[int, ...],
    backs: tuple[int, ...],
    begins_ms: int,
    ramp: str,
) -> None:
    plc = Plc(scan_ms=scan_ms, ramp=ramp, stranger=lambda ms: counts if ms >= begins_ms else None)
    line = Line(plc=plc, outs=outs, backs=backs, arms=False).run(begins_ms + 320)
    told = [ms for ms, code in line.events if code == FOREIGN]
    assert told
    assert 0 <= told[0] - begins_ms <= TOLD_S * 1e3 + TICK_MS
