"""The cycle, one tick after the other in one thread.

A tick: exchange words with the PLC (the command of the tick before goes out), the guard judges
the readings, the law steps, the guard bounds what the law wants, the record is published, and the
supervisor's messages are obeyed.
"""

from __future__ import annotations

import traceback
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from math import nan

from aff_runtime.base.events import BY_NAME
from aff_runtime.base.ports import Clock, Gateway, Law
from aff_runtime.base.signals import (
    ActuatorStep,
    Command,
    Outcome,
    Permission,
    Snapshot,
    StateBits,
)
from aff_runtime.loop.inbox import Inbox
from aff_runtime.loop.ports import GuardPort, OutsidePort
from aff_runtime.loop.record import TickTiming, build_record
from aff_runtime.loop.ticker import Ticker

_OK = Outcome.OK
_INTERNAL_FAULT = BY_NAME["INTERNAL_FAULT"].code
_WORD = 0xFFFF


@dataclass(frozen=True, slots=True, kw_only=True)
class CycleSettings:
    """Fixed for the life of the process.

    Attributes
    ----------
    period_ns : cycle time, ns.
    io_budget_ns : how long the exchange with the PLC may take, from the start of a tick, ns.
    fade_s : within this time the cycle itself takes the corrections to zero if the guard is
        lost, s.
    channel_count, output_count, law_columns : sizes of a record.
    overruns_in_a_row : this many late ticks in a row are an overrun.
    advice_every_ticks : ticks from one question to the law's side to the next.
    zero_commands : commands with zero that the PLC takes before the cycle returns.
    zero_patience_s : how long it tries that after the fade, where another command may have
        reached the PLC last, s; whose own watchdog is through by then.
    command_life_s : a command older than this is not applied any more, s.
    config_revision : sent to the PLC in every command, its low 16 bits.
    first_heartbeat : the heartbeat before that of the first command.
    """

    period_ns: int
    io_budget_ns: int
    fade_s: float
    channel_count: int
    output_count: int
    law_columns: int
    overruns_in_a_row: int = 3
    advice_every_ticks: int = 20
    zero_commands: int = 5
    zero_patience_s: float = 1.0
    command_life_s: float = 0.080
    config_revision: int = 0
    first_heartbeat: int = 0


class Cycle:
    """Runs gateway, guard and law on the grid of a clock until a stop is asked for.

    What the exchange, the guard's judgement, the law, the record or a message raises is caught in
    ``_attempt`` and latched in the guard as INTERNAL_FAULT: the guard fades the corrections to
    zero, heartbeats go on, and an operator may arm again. The guard is lost when ``limit``,
    ``limits``, ``withdraw`` or ``internal_fault`` raise: from then on the cycle does not ask it
    for corrections any more, but ramps them to zero on its own and keeps them there until the
    process ends.
    """

    def __init__(
        self,
        *,
        settings: CycleSettings,
        clock: Clock,
        gateway: Gateway,
        guard: GuardPort,
        law: Law,
        outside: OutsidePort,
    ) -> None:
        self._settings = settings
        self._clock = clock
        self._gateway = gateway
        self._guard = guard
        self._inbox = Inbox(
            guard=guard, law=law, outside=outside, advice_every_ticks=settings.advice_every_ticks
        )
        self._outside = outside
        self._ticker = Ticker(clock, settings.period_ns)
        zeros = (0.0,) * settings.output_count
        self._blank = _blank_snapshot(settings.channel_count)
        self._snapshot = self._blank
        self._permission = Permission(
            adapt=False, applied_ratio=zeros, limit_ratio=(1.0,) * settings.output_count
        )
        self._steps: tuple[ActuatorStep, ...] | None = None
        self._corrections: tuple[float, ...] = zeros
        self._limits: tuple[float, ...] = zeros
        self._bits = int(StateBits.FAULT)
        self._alarm = BY_NAME["POWER_UP"].code
        self._inbox.config_revision = settings.config_revision
        self._tick = self._periods = self._periods_total = self._late_in_a_row = 0
        self._started_ns = self._io_ns = 0
        self._guard_lost = self._wire_worked = False
        self._last_fault = ""
        self._ramp_from = zeros
        self._ramp_left = 1.0
        self._is_quiet = False  # after a stop, and the fade
        self._quiet_ticks = self._zeros_taken = self._echo = 0
        self._zero_stands = True  # nothing was sent yet

    def run(self) -> None:
        """Tick until stopped; returns after the fade and a few commands with zero."""
        self._ticker.start()
        while self.tick():
            pass

    def request_stop(self) -> None:
        """Stop from a signal handler; the output fades first."""
        self._inbox.stop_wanted = True

    @property
    def zero_stands(self) -> bool:
        """Whether the PLC answered a zero after everything else that may have reached it."""
        return self._zero_stands

    def tick(self) -> bool:
        """Wait for the next tick and do it; False when the cycle has ended."""
        self._periods = self._ticker.wait()
        self._begin()
        self._attempt(self._think)
        if self._guard_lost or not self._attempt(self._bound):
            self._guard_lost = True
            self._ramp_down()
        self._attempt(self._tell)
        self._attempt(self._listen)
        return not self._has_stopped()

    def _begin(self) -> None:
        self._tick += 1
        self._periods_total += self._periods
        before_ns, self._started_ns = self._started_ns, self._clock.now_ns()
        stalled = self._started_ns - before_ns > self._settings.command_life_s * 1e9
        if stalled and before_ns:  # 0: the first tick
            self._withdraw()
        self._late_in_a_row = self._late_in_a_row + 1 if self._ticker.late else 0
        self._snapshot = self._blank
        self._steps = None

    def _withdraw(self) -> None:
        """After a stall: what was meant for the line as it was then is not for it now.

        Nor is the rest of its fade: a PLC that took this zero would be given a rise after it.
        """
        self._corrections = self._ramp_from = (0.0,) * self._settings.output_count
        self._bits &= ~int(StateBits.ACTIVE | StateBits.FADING)
        if not self._guard_lost and not self._attempt(self._latch_stall):
            self._guard_lost = True

    def _latch_stall(self) -> None:
        self._bits, self._alarm = self._guard.withdraw()

    def _think(self) -> None:
        """Send the last command, read, judge, and let the law think."""
        command = self._command()
        is_zero = not any(command.corrections)
        self._zero_stands = self._zero_stands and is_zero
        self._snapshot = self._gateway.exchange(
            command, self._tick, self._started_ns + self._settings.io_budget_ns
        )
        if is_zero and self._snapshot.outcome is _OK and self._snapshot.command_sent:
            self._zero_stands = True
            self._zeros_taken += self._is_quiet
            self._quiet_ticks = 0
        self._ticker.shift(self._gateway.shift_ns)
        read_ns = self._clock.now_ns()
        self._io_ns = read_ns - self._started_ns
        if self._snapshot.outcome is _OK:
            self._wire_worked = True
            self._echo = self._snapshot.plc_heartbeat
        overrun = self._late_in_a_row >= self._settings.overruns_in_a_row
        self._permission = self._guard.observe(
            self._snapshot, read_ns, overrun, self._inbox.supervisor_alive
        )
        self._steps = self._inbox.law.step(self._believed(), self._dt_s, self._permission)

    def _believed(self) -> Snapshot:
        """Return what the law may see: readings that cannot be true are no readings."""
        if self._guard.believes:
            return self._snapshot
        return replace(self._snapshot, fresh=False, values=self._blank.values)

    def _bound(self) -> None:
        self._corrections, self._bits, self._alarm = self._guard.limit(self._steps, self._dt_s)
        self._ramp_from = self._corrections
        self._limits = self._guard.limits

    def _tell(self) -> None:
        """Keep the record and the events, and tell the service manager."""
        tick_ns = self._clock.now_ns() - self._started_ns
        self._outside.publish(self._record(tick_ns))
        for tick, code in self._guard.drain_events():
            self._outside.event(tick, self._started_ns, code)
        self._outside.tick_done(self._wire_worked)

    def _listen(self) -> None:
        self._inbox.listen(self._tick)

    def _attempt(self, work: Callable[[], None]) -> bool:
        """Do one part of the tick; the only place where something unexpected is caught."""
        try:
            work()
        except Exception as error:
            self._note_fault(error)
            return False
        return True

    def _note_fault(self, error: Exception) -> None:
        """Latch INTERNAL_FAULT in the guard, and send the log the reason.

        Only a guard that cannot latch it is lost. A log that cannot be reached changes nothing.
        """
        try:
            self._guard.internal_fault()
        except Exception:
            self._guard_lost = True
        with suppress(Exception):
            self._tell_fault(error)

    def _tell_fault(self, error: Exception) -> None:
        """Send the traceback; once as long as the same error comes again and again."""
        text = repr(error)
        if text != self._last_fault:
            self._last_fault = text
            self._outside.fault_text("".join(traceback.format_exception(error)))

    def _ramp_down(self) -> None:
        """Without a guard: straight to zero within the fade time, and stay there."""
        is_fading = self._ramp_left > 0.0  # true for the first zero as well: the PLC must take it
        self._ramp_left = max(0.0, self._ramp_left - self._dt_s / self._settings.fade_s)
        self._corrections = tuple(value * self._ramp_left for value in self._ramp_from)
        self._bits = int(StateBits.FAULT | (StateBits.FADING if is_fading else 0))
        self._alarm = _INTERNAL_FAULT

    def _has_stopped(self) -> bool:
        """Return whether, after a stop, the fade has ended and its last zeros were taken.

        Where nobody answers them it is over at some time too: see ``zero_patience_s``.
        """
        if not self._inbox.stopping:
            return False
        self._is_quiet = self._ramp_left <= 0.0 if self._guard_lost else self._guard.quiet
        self._quiet_ticks += self._is_quiet  # since a zero was taken; it goes out a tick later
        settings = self._settings
        if self._zeros_taken >= settings.zero_commands:
            return True
        patience_s = 0.0 if self._zero_stands else settings.zero_patience_s
        most = max(settings.zero_commands, round(patience_s * 1e9 / settings.period_ns))
        return self._quiet_ticks > most

    @property
    def _dt_s(self) -> float:
        return self._periods * self._settings.period_ns * 1e-9

    def _command(self) -> Command:
        return Command(
            heartbeat=(self._settings.first_heartbeat + self._tick) & _WORD,
            state_bits=self._bits,
            echo=self._echo,
            corrections=self._corrections,
            alarm=self._alarm,
            limits=self._limits,
            config_revision=self._inbox.config_revision & _WORD,
        )

    def _record(self, tick_ns: int) -> tuple[float, ...]:
        steps = self._steps
        count = self._settings.output_count
        if steps is not None and len(steps) == count:
            wanted = tuple(step.value for step in steps)
        else:
            wanted = (nan,) * count
        return build_record(
            snapshot=self._snapshot,
            state=self._guard.state,
            state_bits=self._bits,
            alarm=self._alarm,
            wanted=wanted,
            corrections=self._corrections,
            permission=self._permission,
            timing=TickTiming(
                tick=self._tick,
                time_s=self._periods_total * self._settings.period_ns * 1e-9,
                periods=self._periods,
                wake_ns=self._ticker.wake_ns,
                io_ns=self._io_ns,
                tick_ns=tick_ns,
                missed=self._ticker.missed,
            ),
            law_values=self._inbox.law.telemetry(),
            law_columns=self._settings.law_columns,
        )


def _blank_snapshot(channel_count: int) -> Snapshot:
    return Snapshot(
        tick=0,
        t_ns=0,
        outcome=Outcome.BAD_REPLY,
        fresh=False,
        age_s=nan,
        plc_heartbeat=0,
        status=0,
        roll_id=0,
        values=(nan,) * channel_count,
    )
