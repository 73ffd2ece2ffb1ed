"""A PLC that behaves, on a wire with delays: what the guard of a healthy line may see.

Written from the rules of docs/technician/gateway-block.md, not from the simulated PLC: of its own
it may have any ramp to zero within 100 ms, any limit (it refuses what is beyond, or cuts it), any
scan.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import ActuatorStep, Outcome, Snapshot, State, StateBits, Status
from aff_runtime.safety.guard import Guard
from aff_runtime.safety.params import (
    ActuatorLimits,
    AppliedParams,
    EchoParams,
    FreshnessParams,
    GuardParams,
)

MS = 1_000_000
TICK_MS = 5
COUNT_M_S = 0.00001
WATCHDOG_MS = 80
LIMIT_M_S = 0.05
FOREIGN = BY_NAME["APPLIED_DIFFERS"].code
WELL = Status.LINE_RUN | Status.AFF_ENABLE_REQUEST | Status.WEB_INTACT | Status.TENSION_VALID
PARAMS = GuardParams(
    actuators=(ActuatorLimits(name="unwind", limit=LIMIT_M_S, slew_limit=10.0, soft_start_s=0.1),),
    freshness=FreshnessParams(hold_after_s=0.015, fault_after_s=0.080),
    echo=EchoParams(ticks=50, missing_after_s=0.080),
    applied=AppliedParams(tolerances=(2 * COUNT_M_S,), units=("m/s",), ticks=50),
)
RAMPS: dict[str, Callable[[float], float]] = {
    "linear": lambda x: 1.0 - x,
    "round": lambda x: 0.5 * (1.0 + math.cos(math.pi * x)),
    "quick": lambda x: (1.0 - x) ** 3,
    "slow": lambda x: 1.0 - x**3,
}
Spans = tuple[tuple[int, int], ...]  # ms: from, to


def _within(now_ms: int, spans: Spans) -> bool:
    return any(begin <= now_ms < end for begin, end in spans)


@dataclass(frozen=True, kw_only=True)
class Told:
    """One command as it was sent; value in counts."""

    tick: int
    counts: int
    bits: int


@dataclass(frozen=True, kw_only=True)
class Read:
    """One scan as it was shown."""

    at_ms: int
    scan: int
    echo_tick: int
    counts: int
    status: int


@dataclass(kw_only=True)
class Plc:
    """The rules, in counts and ms.

    Attributes
    ----------
    limit : of its own, counts; ``cuts``: what is beyond is cut, not refused.
    refuses, stops : when it does not take a correction: for reasons of its own, or a permissive.
    rounds : what it shows is rounded, else cut off at the point.
    zero_ends : an intact zero ends its ramp at once.
    tells : takes AFF_ENABLE_REQUEST away from a runtime that it refuses, until that is disarmed.
    stranger : writes into the PLC after each command; None: nobody.
    """

    scan_ms: int = 5
    fade_ms: int = 100
    ramp: str = "linear"
    limit: int = 5000
    cuts: bool = False
    refuses: Spans = ()
    stops: Spans = ()
    rounds: bool = True
    zero_ends: bool = True
    tells: bool = True
    stranger: Callable[[int], int | None] = lambda _: None
    told: Told | None = None
    _held: float = 0.0
    _held_ms: int = -1000
    _beat_ms: int = -1000
    _beat: int = -1
    _rearm: bool = True
    _withdrawn: bool = False

    def restart(self) -> None:
        """Begin again: nothing is known, nothing applied."""
        self.told, self._held, self._held_ms, self._beat, self._rearm = None, 0.0, -1000, -1, True

    def scan(self, now_ms: int) -> tuple[int, int, int]:
        """Return tick of the command taken (-1: none), applied counts and status."""
        told = self.told
        status = int(WELL | Status.ESTOP_OK)
        if _within(now_ms, self.stops):
            status &= ~int(Status.WEB_INTACT)
        if told is None:
            return -1, 0, status
        foreign = self.stranger(now_ms)
        if foreign is not None:
            told = replace(told, counts=foreign, bits=int(StateBits.ACTIVE))
        takes = self._takes(told, now_ms)
        armed = StateBits.ACTIVE | StateBits.FADING | StateBits.ARMED
        self._withdrawn = self._withdrawn and bool(told.bits & int(armed))
        if not takes and not _within(now_ms, self.stops):
            self._withdrawn = self._withdrawn or bool(told.bits & int(armed & ~StateBits.ARMED))
        if self.tells and self._withdrawn:
            status &= ~int(Status.AFF_ENABLE_REQUEST)
        if takes:
            self._held = float(max(-self.limit, min(self.limit, told.counts)))
            self._held_ms = now_ms
        elif self.zero_ends and told.counts == 0:
            self._held = 0.0
        past = (now_ms - self._held_ms) / self.fade_ms if self.fade_ms else math.inf
        past = 0.0 if now_ms == self._held_ms else past
        shown = self._held * RAMPS[self.ramp](past) if past < 1.0 else 0.0
        return told.tick, round(shown) if self.rounds else int(shown), status

    def _takes(self, told: Told, now_ms: int) -> bool:
        if told.tick != self._beat:
            self._beat, self._beat_ms = told.tick, now_ms
        alive = now_ms - self._beat_ms <= WATCHDOG_MS
        counts = bool(told.bits & int(StateBits.ACTIVE | StateBits.FADING))
        self._rearm = self._rearm or not alive
        if alive and not counts:
            self._rearm = False
        if not alive or not counts or self._rearm:
            return False
        if _within(now_ms, self.refuses) or _within(now_ms, self.stops):
            return False
        return self.cuts or abs(told.counts) <= self.limit


@dataclass(kw_only=True)
class Line:
    """Guard, wire and PLC in virtual time; the guard is armed whenever it rests.

    Attributes
    ----------
    outs, backs : delay of each command and each reading, ms, by turns.
    cut : when nothing passes; ``lost``: when no reading does.
    skips : ticks of the runtime that last so many periods.
    new_runtime, new_plc : ms at which it starts again.
    limits : live edits of our own limit: ms, m/s.
    wish : what the law wants, m/s, by time in s; never more than ``peak_m_s``.
    arms : an operator arms whenever the guard rests, and bypasses first where the PLC refuses.
    bypasses : ms at which he bypasses all the same.
    """

    plc: Plc = field(default_factory=Plc)
    outs: tuple[int, ...] = (0,)
    backs: tuple[int, ...] = (0,)
    cut: Spans = ()
    lost: Spans = ()
    skips: dict[int, int] = field(default_factory=dict)
    new_runtime: int = -1
    new_plc: int = -1
    limits: tuple[tuple[int, float], ...] = ()
    wish: Callable[[float], float] = lambda _: 0.0
    peak_m_s: float = LIMIT_M_S
    arms: bool = True
    bypasses: tuple[int, ...] = ()
    events: list[tuple[int, int]] = field(default_factory=list)
    accused_ms: list[int] = field(default_factory=list)
    applied: list[int] = field(default_factory=list)
    states: list[State] = field(default_factory=list)

    def run(self, length_ms: int) -> Line:
        """Run the line from its start."""
        self._start()
        commands: list[tuple[int, Told]] = []
        self._readings: list[Read] = []
        due_ms = scans = 0
        for now_ms in range(length_ms):
            is_cut = _within(now_ms, self.cut)
            if is_cut:
                commands.clear()
                self._readings.clear()
            if now_ms == self.new_plc:
                self.plc.restart()
                commands.clear()
            if now_ms == self.new_runtime:
                self._start()
            if now_ms >= due_ms:
                periods = self.skips.get(self.ticks, 1)
                told = self._tick(now_ms, periods, is_cut)
                due_ms = now_ms + periods * TICK_MS
                if not is_cut:
                    commands.append((now_ms + self.outs[told.tick % len(self.outs)], told))
            if now_ms % self.plc.scan_ms == 0:
                scans += 1
                here = [told for at, told in commands if at <= now_ms]
                if here:
                    self.plc.told = max(here, key=lambda told: told.tick)
                    commands = [c for c in commands if c[1].tick > self.plc.told.tick]
                echo, counts, status = self.plc.scan(now_ms)
                self.applied.append(counts)
                if not is_cut and not _within(now_ms, self.lost):
                    at_ms = now_ms + self.backs[scans % len(self.backs)]
                    read = Read(
                        at_ms=at_ms, scan=scans, echo_tick=echo, counts=counts, status=status
                    )
                    self._readings = [*self._readings[-60:], read]
        return self

    @property
    def accused(self) -> bool:
        """Whether the guard has said that somebody else writes."""
        return bool(self.accused_ms) or any(code == FOREIGN for _, code in self.events)

    def _start(self) -> None:
        """Start the runtime; the ticks of its heartbeat go on where no other one's were."""
        self.guard = Guard(PARAMS)
        self.ticks = getattr(self, "ticks", 0) + 1000 if hasattr(self, "guard_ticks") else 0
        self.guard_ticks = 0
        self._seen, self._was_lost = -1, True
        self._fresh_ms = 0
        self._out, self._bits = 0.0, int(StateBits.FAULT)

    def _tick(self, now_ms: int, periods: int, is_cut: bool) -> Told:
        self.ticks += 1
        self.guard_ticks += 1
        for at_ms, limit in self.limits:
            if at_ms <= now_ms < at_ms + TICK_MS:
                actuator = replace(PARAMS.actuators[0], limit=limit)
                self.guard.adopt(replace(PARAMS, actuators=(actuator,)))
        told = Told(tick=self.ticks, counts=round(self._out / COUNT_M_S), bits=self._bits)
        self.guard.observe(self._snapshot(now_ms, is_cut), now_ms * MS, False, True)
        if self.guard.first_blocking().startswith("blocked by APPLIED_DIFFERS"):
            self.accused_ms.append(now_ms)
        wish = self.wish(now_ms * 1e-3)
        step = ActuatorStep(value=wish, peak_bound=self.peak_m_s, slew_bound=2.0)
        dt_s = periods * TICK_MS * 1e-3
        (self._out,), self._bits, _ = self.guard.limit((step,), dt_s)
        if periods * TICK_MS > WATCHDOG_MS:  # as the cycle withdraws what is too old
            self._out, self._bits = 0.0, self._bits & ~int(StateBits.ACTIVE | StateBits.FADING)
        self.events += [(now_ms, code) for _, code in self.guard.drain_events()]
        self.states.append(self.guard.state)
        self._operate(now_ms)
        return told

    def _operate(self, now_ms: int) -> None:
        if any(at_ms <= now_ms < at_ms + TICK_MS for at_ms in self.bypasses):
            self.guard.bypass()
        elif self.arms and self.guard.state in (State.FAULT, State.BYPASS, State.READY):
            self.guard.arm()
        elif self.arms and "AFF_ENABLE_REQUEST" in self.guard.first_blocking():
            self.guard.bypass()

    def _snapshot(self, now_ms: int, is_cut: bool) -> Snapshot:
        here = [r for r in self._readings if r.at_ms <= now_ms]
        newest = max(here, key=lambda r: r.scan, default=None)
        moved = newest is not None and newest.scan > self._seen
        fresh = moved and not self._was_lost
        if moved and newest is not None:
            self._seen, self._was_lost = newest.scan, False
            self._fresh_ms = now_ms
        self._was_lost = self._was_lost or is_cut
        good = newest is not None and not is_cut
        age = 0x7000 if newest is None or newest.echo_tick < 0 else self.ticks - newest.echo_tick
        return Snapshot(
            tick=self.guard_ticks,
            t_ns=now_ms * MS,
            outcome=Outcome.OK if good else Outcome.TIMEOUT,
            fresh=fresh and good,
            age_s=(now_ms - self._fresh_ms) * 1e-3,
            plc_heartbeat=newest.scan if newest is not None else 0,
            status=newest.status if newest is not None else 0,
            roll_id=1,
            values=(),
            echo_age=(age & 0xFFFF) if good else -1,
            applied=(newest.counts * COUNT_M_S,) if good and newest is not None else (),
        )
