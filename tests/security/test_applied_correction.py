"""Who is accused of writing corrections beside us: a stranger, and never a PLC that behaves."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from dataclasses import dataclass, replace

import pytest

from aff_runtime.base.signals import State, StateBits
from tests.security.behaving_plc import RAMPS, Line, Plc, Spans, Told

AMPLITUDE_M_S = 0.03
LENGTH_MS = 2000
BEGIN_MS = 1000  # armed, soft start over, settled


def wave(time_s: float) -> float:
    return AMPLITUDE_M_S * math.sin(2.0 * math.pi * time_s)


def some(draw: random.Random, most: int, longest_ms: int) -> Spans:
    starts = [draw.randint(500, LENGTH_MS) for _ in range(draw.randint(0, most))]
    return tuple((start, start + draw.randint(1, longest_ms)) for start in starts)


@pytest.mark.parametrize("seed", range(12))
def test_a_plc_that_behaves_is_not_accused_whatever_happens_to_the_line(seed: int) -> None:
    draw = random.Random(seed)
    frequency_Hz, offset_m_s = draw.choice((0.3, 1.0, 5.0, 20.0)), draw.choice((0.0, 0.01))
    plc = Plc(
        scan_ms=draw.choice((2, 5, 10, 31)),
        fade_ms=draw.choice((0, 50, 100)),
        ramp=draw.choice(list(RAMPS)),
        limit=draw.choice((5000, 3000, 1500, 200)),
        cuts=draw.random() < 0.5,
        refuses=some(draw, 3, 400),
        stops=some(draw, 2, 400),
        rounds=draw.random() < 0.5,
        zero_ends=draw.random() < 0.5,
        tells=draw.random() < 0.5,
    )
    line = Line(
        plc=plc,
        outs=(0, 3, 10),
        backs=(0, 4, 18),
        cut=some(draw, 1, 400),
        lost=some(draw, 2, 120),
        skips={draw.randint(100, 400): draw.choice((2, 9, 20)) for _ in range(3)},
        new_runtime=draw.choice((-1, 1300)),
        new_plc=draw.choice((-1, 1500)),
        limits=((draw.randint(500, LENGTH_MS), 0.01),),
        wish=lambda t: offset_m_s + 0.03 * math.sin(2.0 * math.pi * frequency_Hz * t),
    )
    line.run(LENGTH_MS)
    assert max(map(abs, line.applied)) > 0
    assert not line.accused


STRANGERS: dict[str, Callable[[int, int], float]] = {
    "a constant": lambda now_ms, counts: 4000,
    "ours, turned round": lambda now_ms, counts: -counts,
    "half of ours": lambda now_ms, counts: counts / 2,
    "ours and a little more": lambda now_ms, counts: counts + 100,
    "a slow ramp": lambda now_ms, counts: counts + now_ms - BEGIN_MS,
    "one scan in twenty": lambda now_ms, counts: 4000 if now_ms % 100 < 5 else counts,
}


@pytest.mark.parametrize("name", STRANGERS)
def test_a_stranger_is_accused_and_our_own_correction_ends(name: str) -> None:
    plc = Plc()

    def writes(now_ms: int) -> int | None:
        if now_ms < BEGIN_MS or plc.told is None:
            return None
        return int(STRANGERS[name](now_ms, plc.told.counts))

    plc.stranger = writes
    line = Line(plc=plc, wish=wave).run(LENGTH_MS)
    assert line.accused
    assert line.accused_ms[0] >= BEGIN_MS
    assert State.FAULT in line.states[BEGIN_MS // 5 :]


# What it does not see. Whoever can write to the PLC can also hold the correction back.
UNSEEN: dict[str, Callable[[int, int], float]] = {
    "zero": lambda now_ms, counts: 0,
    "zero by turns": lambda now_ms, counts: counts * (now_ms // 5 % 2),
    "zero in place of one sign": lambda now_ms, counts: max(counts, 0),
    "two scans in half a second": lambda now_ms, counts: 4000 if now_ms % 520 < 10 else counts,
}


@pytest.mark.parametrize("name", UNSEEN)
def test_a_stranger_who_only_takes_away_or_writes_seldom_is_not_seen(name: str) -> None:
    plc = Plc()

    def writes(now_ms: int) -> int | None:
        if now_ms < BEGIN_MS or plc.told is None:
            return None
        return int(UNSEEN[name](now_ms, plc.told.counts))

    plc.stranger = writes
    assert not Line(plc=plc, wish=wave).run(LENGTH_MS).accused


@dataclass(kw_only=True)
class ForgedEcho(Plc):
    """A stranger writes a heartbeat some ticks ahead of ours, waits for ours to come up, goes on.

    No echo steps back, so the PLC does not take it for a jump, and it changes once only.
    """

    every_ms: int
    held_ms: int
    more_ms: int
    _from: Told | None = None

    def scan(self, now_ms: int) -> tuple[int, int, int]:
        ours, phase_ms = self.told, (now_ms - BEGIN_MS) % self.every_ms
        if ours is None or now_ms < BEGIN_MS or phase_ms >= self.held_ms + self.more_ms:
            self._from = None
            return super().scan(now_ms)
        if phase_ms < self.held_ms and self._from is None:
            self._from = replace(ours, tick=ours.tick + self.held_ms // 5)
        forged = self._from if phase_ms < self.held_ms and self._from is not None else ours
        self.told = replace(forged, counts=4000, bits=int(StateBits.ACTIVE))
        shown = super().scan(now_ms)
        self.told = ours
        return shown


@pytest.mark.parametrize("arms", [True, False], ids=["armed", "at rest"])
@pytest.mark.parametrize(
    ("every_ms", "held_ms", "more_ms"), [(510, 60, 0), (510, 60, 170), (600, 75, 175)]
)
def test_a_heartbeat_that_is_forged_for_a_moment_does_not_hide_a_correction(
    every_ms: int, held_ms: int, more_ms: int, arms: bool
) -> None:
    """Every echo that was not ours once gave a stranger the time of a PLC's start."""
    plc = ForgedEcho(every_ms=every_ms, held_ms=held_ms, more_ms=more_ms)
    line = Line(plc=plc, wish=wave, arms=arms).run(3000)
    assert line.applied.count(4000) > 30
    assert line.accused
