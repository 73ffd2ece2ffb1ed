"""The Structured Text block and the simulated PLC take the same cases and must agree."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("blark", reason="blark (the Structured Text parser) is not installed")

from aff_runtime.base.signals import StateBits, Status
from sim_plant.servers.plc import ALL_WELL, Plc
from tests.deploy.st_machine import StMachine, parsed, statements_of
from tests.sim_plant.servers.fake_line import default_map

BLOCK = Path(__file__).parents[2] / "deploy" / "plc" / "AFF_GATEWAY.st"
MAP = default_map()
SCAN_S = 0.005
COUNT_M_S = 0.00001
MEASURED = {item.name: 0.0 for item in MAP.channels}
REFUSALS = {
    "": 0,
    "watchdog": 1,
    "state": 2,
    "rearm": 3,
    "permissive": 4,
    "complement": 5,
    "limit": 6,
}
LIMIT_2 = round(MAP.corrections[1].limit_m_s / COUNT_M_S)
ACTIVE, FADING, ARMED = (int(StateBits[name]) for name in ("ACTIVE", "FADING", "ARMED"))


class Both:
    """Scans block and simulated PLC with the same words and compares everything they decide."""

    def __init__(self) -> None:
        self.block = StMachine(BLOCK)
        self.plc = Plc(MAP)
        self.scans = 0

    def scan(
        self,
        heartbeat: int,
        one: int = 0,
        two: int = 0,
        *,
        state: int = ACTIVE,
        well: bool = True,
        spoil: int = 0,
    ) -> dict[str, Any]:
        self.scans += 1
        copies = [~one & 0xFFFF, ~two & 0xFFFF]
        if spoil:
            copies[spoil - 1] ^= 0x0100
        words = [heartbeat, state, 0, one & 0xFFFF, copies[0], 0, 0, 0, two & 0xFFFF, copies[1]]
        self.plc.status = ALL_WELL if well else ALL_WELL & ~Status.WEB_INTACT
        seen = self.plc.scan(self.scans * SCAN_S, MEASURED, words)
        out = self.block.call(
            AffHeartbeat=heartbeat,
            AffState=state,
            Word1=one,
            Copy1=copies[0],
            Word2=two,
            Copy2=copies[1],
            Permissives=well,
            ScanTime=SCAN_S,
            Wanted=True,
        )
        assert out["Refusal"] == REFUSALS[seen.refusal.partition(":")[0]], self.scans
        assert out["Accepted"] is (not seen.refusal)
        assert out["Trips"] == min(self.plc.trips, 65_535)
        status = Status(seen.read_words[MAP.read["status"] - MAP.read_start])
        assert out["EnableRequest"] is (Status.AFF_ENABLE_REQUEST in status), self.scans
        for word, key in (("plc_heartbeat", "PlcHeartbeat"), ("aff_echo", "AffEcho")):
            assert out[key] == seen.read_words[MAP.read[word] - MAP.read_start], key
        assert out["AffEcho"] == heartbeat
        for name, key in (("unwind", "Correction1"), ("swrap_follower", "Correction2")):
            counts = seen.corrections_m_s[name] / COUNT_M_S
            assert out[key] == pytest.approx(counts, abs=0.05), (self.scans, name)
        for row, key in zip(MAP.applied, ("Applied1", "Applied2"), strict=True):
            shown = row.from_words([seen.read_words[row.address - MAP.read_start]]) / row.scale
            assert abs(out[key] - shown) < 1.5, (self.scans, key)  # 32 bits may round a half away
            assert abs(out[key] - out[key.replace("Applied", "Correction")]) <= 0.5
        return out

    def accepted(self) -> Both:
        self.scan(1, state=0)
        self.scan(2, state=0)
        assert self.scan(3, 1234, -567)["Correction1"] == 1234.0
        return self


@pytest.mark.long  # parses for 6 s; quick: each statement runs here
def test_the_file_is_one_block_of_the_statements_that_run_here() -> None:
    text = BLOCK.read_text()
    whole = parsed(text)
    assert str(whole.name) == "AFF_GATEWAY"
    assert list(map(str, whole.body.statements)) == list(map(str, statements_of(text)))


def test_nothing_counts_before_a_heartbeat_moved_and_a_state_without_active_was_seen() -> None:
    both = Both()
    assert both.scan(7, 100)["Refusal"] == 1
    assert both.scan(8, 100)["Refusal"] == 3
    assert both.scan(9, 100, state=0)["Refusal"] == 2
    assert both.scan(10, 100)["Refusal"] == 0


def test_a_dead_heartbeat_trips_after_the_watchdog_and_is_zero_after_the_fade() -> None:
    both = Both().accepted()
    outs = [dict(both.scan(3, 1234, -567)) for _ in range(60)]
    tripped = next(i for i, out in enumerate(outs) if out["Refusal"] == 1)
    assert tripped == 16  # 80 ms are 16 scans; the 17th is late
    assert outs[tripped + 18]["Correction1"] > 0.0
    assert all(out["Correction1"] == 0.0 for out in outs[tripped + 19 :])  # 180 ms in all
    assert both.scan(4, 1234)["Refusal"] == 3


NO_TIME = (0.0, -SCAN_S, math.nan)


@pytest.mark.parametrize("scan_s", NO_TIME)
def test_without_a_scan_time_nothing_counts_and_the_refusal_says_so(scan_s: float) -> None:
    """A watchdog and a fade that count no time would let the last correction stand for ever."""
    block = Both().accepted().block
    heard = dict(block.call(AffHeartbeat=4, ScanTime=scan_s))
    assert (heard["Refusal"], heard["Accepted"], heard["EnableRequest"]) == (7, False, False)
    assert (heard["Correction1"], heard["Correction2"]) == (0.0, 0.0)
    silent = dict(block.call(ScanTime=scan_s))
    assert (silent["Refusal"], silent["Applied1"], silent["Applied2"]) == (7, 0, 0)
    # with its time back it asks for a state without ACTIVE, as after a trip of the watchdog
    block.call(AffHeartbeat=5, ScanTime=SCAN_S)
    assert block.call(AffHeartbeat=6)["Refusal"] == 3
    block.call(AffHeartbeat=7, AffState=0)
    again = block.call(AffHeartbeat=8, AffState=ACTIVE)
    assert (again["Refusal"], again["Correction1"]) == (0, 1234.0)


def test_a_block_whose_scan_time_is_not_connected_never_adds_anything() -> None:
    block = StMachine(BLOCK)
    words = {"Word1": 1234, "Copy1": ~1234 & 0xFFFF, "Copy2": 0xFFFF, "Permissives": True}
    for heartbeat, state in enumerate((0, 0, ACTIVE, ACTIVE, ACTIVE), start=1):
        out = block.call(AffHeartbeat=heartbeat, AffState=state, Wanted=True, **words)
        assert (out["Refusal"], out["Correction1"]) == (7, 0.0)


def test_what_is_shown_as_applied_is_what_is_left_after_limit_and_fade() -> None:
    both = Both().accepted()
    shown = [both.scan(4 + k, 15_001)["Applied1"] for k in range(21)]  # beyond the limit
    assert shown[:2] == [1172, 1111]  # 1234 less 5 and 10 of 100 ms
    assert shown[19:] == [0, 0]


def test_a_heartbeat_now_and_then_does_not_hold_a_correction() -> None:
    """One command in ten scans: 45 ms of silence each time, of which 20 ms are regained."""
    both = Both().accepted()
    outs = [dict(both.scan(4 + k // 10 * 10, 1234, -567)) for k in range(70)]
    tripped = next(i for i, out in enumerate(outs) if out["Refusal"] == 1)
    # silence after scan k of the first three: 45, 25 + 45, 50 + 35 ms > 80 ms
    assert tripped == 27
    assert all(out["Correction1"] == 0.0 for out in outs[tripped + 19 :])


def test_a_pause_of_50_ms_is_forgotten_after_three_commands() -> None:
    both = Both().accepted()
    heartbeat = 3
    for _ in range(20):
        for moves in (*(False,) * 10, True, True, True):
            heartbeat += moves
            assert both.scan(heartbeat, 1234, -567)["Accepted"]


def test_a_refusal_takes_the_enable_request_away_until_the_runtime_is_disarmed() -> None:
    both = Both().accepted()
    assert both.scan(4, 1234, spoil=1)["EnableRequest"] is False
    for heartbeat, state in enumerate((ACTIVE, FADING, ARMED, 0x80 | ARMED), start=5):
        assert both.scan(heartbeat, 0, 0, state=state)["EnableRequest"] is False
    assert both.scan(9, state=0x80)["EnableRequest"] is True
    assert both.scan(10, 1234, state=ACTIVE | ARMED)["EnableRequest"] is True


def test_a_missing_permissive_leaves_the_enable_request_alone() -> None:
    both = Both().accepted()
    assert both.scan(4, 1234, well=False)["EnableRequest"] is True


def test_another_master_that_is_idle_does_not_bring_the_enable_request_back() -> None:
    both = Both().accepted()
    assert both.scan(40_000, 1234)["EnableRequest"] is False
    assert both.scan(4, state=0)["EnableRequest"] is False
    assert both.scan(5, state=0)["EnableRequest"] is True


def test_the_plc_can_acknowledge_a_refusal_by_an_edge_of_reset() -> None:
    block = StMachine(BLOCK)
    idle = {"Copy1": 0xFFFF, "Copy2": 0xFFFF, "Permissives": True, "ScanTime": SCAN_S}
    block.call(AffHeartbeat=1, Wanted=True, **idle)
    assert block.call(AffHeartbeat=2, AffState=ACTIVE | ARMED)["EnableRequest"] is False  # rearm
    assert block.call(AffHeartbeat=3, AffState=ARMED)["EnableRequest"] is False
    assert block.call(AffHeartbeat=4, Reset=True)["EnableRequest"] is True
    block.call(AffHeartbeat=400, AffState=ACTIVE | ARMED)
    held = block.call(AffHeartbeat=401, AffState=ARMED)  # no edge
    assert held["EnableRequest"] is False
    block.call(AffHeartbeat=402, Reset=False)
    assert block.call(AffHeartbeat=403, Reset=True)["EnableRequest"] is True
    assert block.call(AffHeartbeat=404, Wanted=False)["EnableRequest"] is False


@pytest.mark.parametrize(
    ("case", "refusal"),
    [
        ({"state": 0}, 2),
        ({"well": False}, 4),
        ({"spoil": 1}, 5),
        ({"spoil": 2}, 5),
        ({"one": 15001}, 6),
        ({"one": -15001}, 6),
        ({"two": LIMIT_2 + 1}, 6),
        ({"one": -32768}, 6),
    ],
)
def test_a_correction_that_breaks_a_rule_fades_and_comes_back(
    case: dict[str, Any], refusal: int
) -> None:
    both = Both().accepted()
    first = dict(both.scan(4, **{"one": 1234, "two": -567, **case}))
    assert first["Refusal"] == refusal
    assert 0.0 < first["Correction1"] < 1234.0
    for heartbeat in range(5, 50):
        last = both.scan(heartbeat, **{"one": 1234, "two": -567, **case})
    assert last["Correction1"] == 0.0
    assert both.scan(50, 1234, -567, state=FADING)["Correction1"] == 1234.0


def test_an_intact_zero_of_a_live_runtime_ends_the_fade() -> None:
    both = Both().accepted()
    assert both.scan(4, 0, 0, state=0)["Correction1"] == 0.0


@pytest.mark.parametrize("state", [0, ACTIVE])
def test_a_second_master_takes_the_correction_to_zero(state: int) -> None:
    both = Both().accepted()
    for scan in range(4, 60):
        other = both.scan(40_000 + scan, 0, 0, state=state)
        assert not other["Accepted"]
        ours = both.scan(scan, 1234, -567)
        assert not ours["Accepted"]
        assert scan < 30 or ours["Correction1"] == 0.0
    both.scan(60, state=0)
    assert both.scan(61, 1234, -567)["Accepted"]


@pytest.mark.parametrize("before", [3, 65_500, 65_535])
def test_a_heartbeat_may_step_by_64_and_wrap(before: int) -> None:
    for step, refusal in ((1, 0), (64, 0), (65, 3), (40_000, 3)):
        both = Both()
        for heartbeat in (before - 2, before - 1, before):
            both.scan(heartbeat, state=0)
        assert both.scan((before + step) & 0xFFFF, 100)["Refusal"] == refusal, step


def test_our_heartbeat_wraps_without_an_overflow() -> None:
    both = Both()
    both.block.v["PlcHeartbeat"] = 65534
    both.plc._heartbeat = 65534
    assert both.scan(1)["PlcHeartbeat"] == 65535
    assert both.scan(2)["PlcHeartbeat"] == 0


def test_the_watchdog_s_trips_stay_at_the_end_of_their_range() -> None:
    both = Both().accepted()
    both.block.v["Trips"] = both.plc.trips = 65_534
    for heartbeat in (10, 60):
        for _ in range(18):  # the heartbeat moves once, then 85 ms of silence
            out = both.scan(heartbeat)
        assert (out["Refusal"], out["Trips"]) == (1, 65_535)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.sweep(every=3)
def test_block_and_simulated_plc_agree_on_random_runs(seed: int) -> None:
    dice = random.Random(seed)
    both = Both()
    heartbeat, state, well, silent = 0, 0, True, 0
    for _ in range(800):
        silent = max(0, silent - 1) or (dice.random() < 0.01) * dice.randrange(1, 40)
        heartbeat = heartbeat if silent else (heartbeat + 1) & 0xFFFF
        if dice.random() < 0.05:
            state = dice.choice((0, ACTIVE, ACTIVE, FADING, 3, 0x80))
        well = dice.random() > 0.2 if dice.random() < 0.03 else well
        one = dice.choice((0, 1, -1, dice.randrange(-15100, 15101), 15000, -15000))
        two = dice.choice((0, dice.randrange(-LIMIT_2 - 50, LIMIT_2 + 51)))
        spoil = dice.choice((0,) * 30 + (1, 2))
        both.scan(heartbeat, one, two, state=state, well=well, spoil=spoil)


MUTANTS = (
    ("AffEcho := AffHeartbeat;\n", ""),
    ("Applied1 := REAL_TO_INT(Correction1);\n", ""),
    ("REAL_TO_INT(Correction2)", "Word2"),
    ("REAL_TO_INT(Correction1)", "REAL_TO_INT(Held1)"),
    ("Silence <= Watchdog", "Silence <= Watchdog + 1.0"),
    ("Timed := ScanTime > 0.0", "Timed := TRUE"),
    ("Timed := ScanTime > 0.0", "Timed := ScanTime <> 0.0"),
    ("Heard AND Timed AND", "Heard AND"),
    ("IF Timed AND Since", "IF Since"),
    ("NeedsRearm := TRUE;\n    IF Trips", "IF Trips"),
    ("Trips < 65535", "Trips >= 0"),
    ("ELSIF NOT Permissives THEN\n    Refusal := 4;\n", ""),
    ("(INT_TO_WORD(Word2) XOR Copy2) = 16#FFFF", "TRUE"),
    ("Word1 > Limit1", "Word1 > 32000"),
    ("Word2 < -Limit2", "Word2 < -32000"),
    ("16#000C", "16#00FF"),
    ("1.0 - Since / FadeTime", "1.0"),
    ("        Held1 := 0.0;\n", ""),
    ("Known AND AffHeartbeat", "AffHeartbeat"),
    ("LastHeartbeat > 64", "LastHeartbeat > 65"),
    ("65535 - 63", "65535 - 64"),
    ("Silence := Silence - Regain", "Silence := 0.0"),
    ("NOT Heard OR (Silence", "(Silence"),
    ("Alive AND NOT Jumped AND", "Alive AND"),
    ("16#000E", "16#000C"),
    (" AND (Refusal <> 4)", ""),
    ("    Withdrawn := TRUE;\n", "    Withdrawn := Withdrawn;\n"),
    ("Reset AND NOT LastReset", "Reset"),
)


@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda pair: pair[1][:30] or pair[0][:30])
@pytest.mark.sweep(every=6)
def test_every_rule_of_the_block_is_missed_when_it_is_gone(
    mutant: tuple[str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = BLOCK.read_text()
    assert text.count(mutant[0]) == 1, mutant[0]
    spoilt = tmp_path / "mutant.st"
    spoilt.write_text(text.replace(*mutant))
    monkeypatch.setattr("tests.deploy.test_aff_gateway_st.BLOCK", spoilt)
    without_time = test_without_a_scan_time_nothing_counts_and_the_refusal_says_so
    cases = (
        test_nothing_counts_before_a_heartbeat_moved_and_a_state_without_active_was_seen,
        test_a_dead_heartbeat_trips_after_the_watchdog_and_is_zero_after_the_fade,
        *(partial(without_time, scan_s) for scan_s in NO_TIME),
        test_an_intact_zero_of_a_live_runtime_ends_the_fade,
        test_a_heartbeat_now_and_then_does_not_hold_a_correction,
        test_a_refusal_takes_the_enable_request_away_until_the_runtime_is_disarmed,
        test_a_missing_permissive_leaves_the_enable_request_alone,
        test_another_master_that_is_idle_does_not_bring_the_enable_request_back,
        test_the_plc_can_acknowledge_a_refusal_by_an_edge_of_reset,
        test_the_watchdog_s_trips_stay_at_the_end_of_their_range,
        lambda: test_a_second_master_takes_the_correction_to_zero(0),
        *(lambda b=b: test_a_heartbeat_may_step_by_64_and_wrap(b) for b in (3, 65_500)),
        *(lambda s=s: test_block_and_simulated_plc_agree_on_random_runs(s) for s in range(3)),
    )
    assert any(map(_misses, cases))


def _misses(case: Callable[[], None]) -> bool:
    try:
        case()
    except AssertionError:
        return True
    return False
