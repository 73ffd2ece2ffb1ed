"""The guard: whether a correction may go out, how much of it, and when it must be zero."""

from __future__ import annotations

from collections.abc import Iterator

from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import (
    LATCHED_STATES,
    ActuatorStep,
    Outcome,
    Permission,
    Snapshot,
    State,
)
from aff_runtime.safety.applied_check import AppliedCheck
from aff_runtime.safety.causes import FADING, HOLDING, LATCHING, bit, first_code
from aff_runtime.safety.echo_check import EchoCheck
from aff_runtime.safety.envelope import Envelope
from aff_runtime.safety.freshness import Freshness, FreshnessCheck
from aff_runtime.safety.lease import Lease
from aff_runtime.safety.limits import Limiter, makes_sense
from aff_runtime.safety.line_check import LineCheck
from aff_runtime.safety.params import GuardParams
from aff_runtime.safety.plc_reset import PlcReset
from aff_runtime.safety.reasons import reasons
from aff_runtime.safety.state_machine import Inputs, Standing, advance
from aff_runtime.safety.state_word import state_word

_ACTIVE, _FAULT, _OK, _GOOD = State.ACTIVE, State.FAULT, Outcome.OK, Freshness.GOOD
_POWER_UP = BY_NAME["POWER_UP"].code
_BYPASSED = BY_NAME["BYPASSED"].code
_PERMISSIVE_LOST = bit("PERMISSIVE_LOST")
_SECOND_MASTER = bit("SECOND_MASTER")
_APPLIED_DIFFERS = bit("APPLIED_DIFFERS")
_APPLIED_CODE = BY_NAME["APPLIED_DIFFERS"].code
_STAYS = HOLDING | FADING  # causes in which nothing is learned
_OF_START = bit("PLC_STALE") | bit("OVERRUN")  # no news until there was a connection
_IDLE_SCANS = 3  # of the PLC, without ACTIVE and FADING, before a new start
_ZEROS_TO_SEND = 3  # commands with zero that still say FADING: the PLC holds what it last accepted


class Guard:
    """Stands between any law and the wire; one ``observe`` and one ``limit`` per tick.

    Pure: time is an argument, nothing is logged, nothing raises, nothing blocks.

    Attributes
    ----------
    objections : the law side's reasons against arming, as sentences; set from outside.
    ripple_rose : the monitor finds that ripple grew since the output opened; judged while it is.
    standing : state and whether the operator's request to be armed holds.
    """

    def __init__(self, params: GuardParams) -> None:
        self.params = params
        self.objections: tuple[str, ...] = ()
        self.ripple_rose = False
        self.standing = Standing()
        self._freshness = FreshnessCheck(params.freshness)
        self._line = LineCheck(params)
        self._echo = EchoCheck(params.echo)
        self._applied = AppliedCheck(params.applied, len(params.actuators))
        self._lease = Lease(params.lease_ticks)
        self._envelopes = tuple(
            Envelope(soft_start_s=actuator.soft_start_s, fade_s=params.fade_s)
            for actuator in params.actuators
        )
        self._limiters = tuple(Limiter(actuator, params.fade_s) for actuator in params.actuators)
        self._outputs = tuple(zip(self._envelopes, self._limiters, strict=True))
        self._steps: tuple[ActuatorStep | None, ...] = (None,) * len(params.actuators)
        self._arm_edge = self._bypass_edge = self._shadow_edge = False
        self._shadow = self._fade_once = False
        self._causes = self._found_in_tick = 0
        self._first_cause = _POWER_UP
        self._comm_warn = True
        self._was_connected = False
        self._plc_reset = PlcReset()
        self._zeros = _ZEROS_TO_SEND
        self._idle_scans = _IDLE_SCANS
        self._idle_sent = True
        self._observed_ns: int | None = None
        self._tick = 0
        self._events: list[tuple[int, int]] = [(0, _POWER_UP)]

    # --- the operator -----------------------------------------------------------------------

    def arm(self) -> str:
        """Ask for an armed output at the next tick; return what stands against it now, or ''.

        In remote the PLC alone arms, by its reset: the request of anybody else changes nothing.
        """
        if not self._plc_reset.remote:
            self._take_arm_edge()
        return self.first_blocking()

    def _take_arm_edge(self) -> None:
        self._arm_edge = True
        self.ripple_rose = False
        if self.standing.state in LATCHED_STATES:
            self._line.confirm_rolls()
            self._causes &= ~bit("RADIUS_JUMP")

    def bypass(self) -> None:
        """Take the correction back now; works in every state and outlives pending requests."""
        self._bypass_edge = True
        self._arm_edge = False

    def shadow(self, on: bool) -> None:
        """Compute without transmitting, or end that; an armed output is given up either way."""
        self._shadow = self._shadow_edge = on
        self._arm_edge = False

    # --- the assembly -----------------------------------------------------------------------
    def adopt(self, params: GuardParams) -> bool:
        """Take new settings between two ticks; False and no change when the outputs differ."""
        if [a.name for a in params.actuators] != [a.name for a in self.params.actuators]:
            return False
        self.params = params
        self._freshness.params = params.freshness
        self._echo.params = params.echo
        self._applied.params = params.applied
        self._line.adopt(params)
        for index, actuator in enumerate(params.actuators):
            self._envelopes[index].soft_start_s = actuator.soft_start_s
            self._envelopes[index].fade_s = params.fade_s
            self._limiters[index].adopt(actuator, params.fade_s)
        return True

    def fade_once(self) -> None:
        """Fade to zero and come back by itself; for an exchange that cannot be bumpless."""
        self._fade_once = True

    def internal_fault(self) -> None:
        """Latch INTERNAL_FAULT now: something unexpected happened in this tick."""
        self._latch(bit("INTERNAL_FAULT"))

    def withdraw(self) -> tuple[int, int]:
        """Latch OVERRUN with every output at zero now; return (state bits, alarm code).

        For a process that was held up for longer than its commands live: a zero without ACTIVE and
        FADING goes out in place of the last one, and nothing rises again after it.
        """
        self._latch(bit("OVERRUN"))
        for envelope, limiter in self._outputs:
            envelope.shut()
            limiter.output = 0.0
        self._applied.note_sent((0.0,) * len(self._limiters))
        return self._state_word(zeros_sent=True), self._alarm()

    @property
    def state(self) -> State:
        """State of the guard."""
        return self.standing.state

    @property
    def believes(self) -> bool:
        """Whether the last readings can be true; what cannot must not reach a law."""
        return self._line.believes

    @property
    def quiet(self) -> bool:
        """Whether every output is closed and zero."""
        return all(envelope.level == 0.0 for envelope in self._envelopes)

    @property
    def has_connected(self) -> bool:
        """Whether a reading was good since the start: before, nothing can be armed."""
        return self._was_connected

    @property
    def limits(self) -> tuple[float, ...]:
        """Limit in force per actuator, in its SI unit."""
        return tuple([limiter.limit for limiter in self._limiters])

    def first_blocking(self) -> str:
        """Return ``blocked by <reason>`` for the first thing against an armed output, or ''."""
        reason = next(self._reasons(), "")
        return f"blocked by {reason}" if reason else ""

    def reasons(self) -> tuple[str, ...]:
        """Return all that stands against an armed output; the first is ``first_blocking``'s."""
        return tuple(self._reasons())

    def drain_events(self) -> list[tuple[int, int]]:
        """Return (tick, event code) of everything since the last call."""
        events, self._events = self._events, []
        return events

    # --- the cycle --------------------------------------------------------------------------
    def observe(
        self, snapshot: Snapshot, now_ns: int, overrun: bool, supervisor_alive: bool
    ) -> Permission:
        """Judge one tick's readings and return what the law may do.

        Parameters
        ----------
        snapshot : the readings of this tick.
        now_ns : monotonic time, ns; a gap longer than ``fault_after_s`` is an overrun.
        overrun : the cycle overran too often.
        supervisor_alive : False latches SUPERVISOR_LOST.
        """
        self._tick = snapshot.tick
        if self._idle_sent and snapshot.fresh and self._idle_scans < _IDLE_SCANS:
            self._idle_scans += 1
        freshness = self._freshness.judge(snapshot, now_ns)
        is_good = freshness is _GOOD
        self._comm_warn = not is_good or snapshot.outcome is not _OK
        # before the readings are judged: it accepts the radius that they bring, as `arm` does
        if self._plc_reset.step(snapshot, trusted=is_good):
            self._take_arm_edge()
        causes = self._found_in_tick | self._line.judge(snapshot, now_ns)
        causes |= self._timing_causes(now_ns, freshness, overrun, supervisor_alive)
        if self._echo.judge(snapshot, now_ns):
            causes |= _SECOND_MASTER
        if self._applied.judge(snapshot, now_ns):
            causes |= _APPLIED_DIFFERS
        self._found_in_tick = 0
        self._was_connected = self._was_connected or is_good
        news = causes if self._was_connected else causes & ~_OF_START
        if not self._echo.heard:
            news &= ~_SECOND_MASTER
        self._note_events(news)
        self._causes = causes
        self._advance(news & LATCHING)
        return Permission(
            adapt=self.standing.state is _ACTIVE and not self._comm_warn and not causes & _STAYS,
            applied_ratio=tuple(
                [envelope.level * limiter.scale for envelope, limiter in self._outputs]
            ),
            limit_ratio=tuple([limiter.wanted_scale for limiter in self._limiters]),
            headroom=tuple([limiter.headroom for limiter in self._limiters]),
        )

    def limit(
        self, steps: tuple[ActuatorStep, ...] | None, dt_s: float
    ) -> tuple[tuple[float, ...], int, int]:
        """Bound the law's wish and return (corrections, state bits, alarm code) for the wire.

        Parameters
        ----------
        steps : one per actuator; None or another number of them does not renew the lease.
        dt_s : whole periods since the last call, s.
        """
        dt_s = dt_s if dt_s > 0.0 else 0.0
        self._take(steps)
        is_active = self.standing.state is _ACTIVE
        for index, (envelope, limiter) in enumerate(self._outputs):
            level = envelope.step(is_active and self._line.gates[index], dt_s)
            limiter.step(self._steps[index], level, dt_s)
        corrections = tuple([limiter.output for limiter in self._limiters])
        self._applied.note_sent(corrections)
        quiet = self.quiet
        zeros_sent = quiet and self._zeros >= _ZEROS_TO_SEND
        self._zeros = min(self._zeros + 1, _ZEROS_TO_SEND) if quiet else 0
        self._idle_sent = zeros_sent and not is_active
        if not self._idle_sent:
            self._idle_scans = 0
        return corrections, self._state_word(zeros_sent=zeros_sent), self._alarm()

    # --- inside -----------------------------------------------------------------------------
    def _take(self, steps: tuple[ActuatorStep, ...] | None) -> None:
        """Judge the law's wishes before any output moves; a wish without sense becomes zero."""
        if steps is None or len(steps) != len(self._limiters):
            if self._lease.tick(renewed=False):
                self._latch(bit("LEASE_EXPIRED"))
            return
        self._lease.tick(renewed=True)
        self._steps = steps
        for step in steps:
            if not makes_sense(step):
                self._latch(bit("INTERNAL_FAULT"))
                self._steps = tuple(wish if makes_sense(wish) else None for wish in steps)
                return

    def _timing_causes(
        self, now_ns: int, freshness: Freshness, overrun: bool, supervisor_alive: bool
    ) -> int:
        causes = 0
        previous_ns, self._observed_ns = self._observed_ns, now_ns
        gap_s = 0.0 if previous_ns is None else (now_ns - previous_ns) * 1e-9
        if overrun or gap_s > self.params.freshness.fault_after_s:
            causes |= bit("OVERRUN")
        if freshness is Freshness.STALE:
            causes |= bit("PLC_STALE")
        if not supervisor_alive:
            causes |= bit("SUPERVISOR_LOST")
        if self.ripple_rose and self.standing.state is _ACTIVE:
            causes |= bit("RIPPLE_ROSE")
        return causes

    def _note_events(self, causes: int) -> None:
        rising = causes & ~self._causes
        if not self.standing.armed:
            rising &= ~_PERMISSIVE_LOST
        while rising:
            self._events.append((self._tick, first_code(rising)))
            rising &= rising - 1
        if self._bypass_edge:
            self._events.append((self._tick, _BYPASSED))

    def _advance(self, news: int) -> None:
        before = self.standing.state
        latching = self._causes & LATCHING
        # a PLC that refuses starts to listen again only after it has seen us idle
        rested = self._idle_scans >= _IDLE_SCANS or before not in LATCHED_STATES
        quiet = self.quiet and rested
        self.standing = advance(
            self.standing,
            Inputs(
                arm_edge=self._arm_edge,
                bypass_edge=self._bypass_edge,
                shadow=self._shadow,
                shadow_edge=self._shadow_edge,
                latching=latching != 0,
                blocked=self._is_blocked(),
                moving=self._line.fast_enough,
                quiet=quiet,
            ),
        )
        is_news = before is not _FAULT or self._first_cause == _POWER_UP
        if self.standing.state is _FAULT and news and is_news:
            self._first_cause = first_code(news)
        # An early press of "arm" waits for the end of a fade, but never outlives a new cause.
        waits = before in LATCHED_STATES and self.standing.state is before and not quiet
        self._arm_edge = self._arm_edge and waits and not latching and not self._bypass_edge
        self._bypass_edge = self._shadow_edge = False
        self._fade_once = self._fade_once and not quiet

    def _is_blocked(self) -> bool:
        """Objections keep an output closed; an open one they leave to the law."""
        objects = self.standing.state is not _ACTIVE and len(self.objections) > 0
        return objects or self._fade_once or self._causes & FADING != 0

    def _latch(self, cause: int) -> None:
        """Fault at once, inside the tick; ``observe`` notes the event in the next one."""
        self._found_in_tick |= cause
        if self.standing.state not in LATCHED_STATES:
            self.standing = Standing(state=State.FAULT)
            self._first_cause = first_code(cause)

    def _reasons(self) -> Iterator[str]:
        return reasons(
            self._causes,
            detail=self._detail,
            missing=self._line.missing() if self._causes & _PERMISSIVE_LOST else (),
            objections=self.objections,
            shadow=self._shadow,
            by_plc=self._plc_reset.remote and not self.standing.armed,
        )

    def _detail(self, code: int) -> str:
        if code == _APPLIED_CODE:
            return self._applied.finding([a.name for a in self.params.actuators])
        return self._line.unbelievable.get(code, "")

    def _state_word(self, *, zeros_sent: bool) -> int:
        return state_word(
            self.standing,
            zeros_sent=zeros_sent,
            saturated=any(limiter.saturated for limiter in self._limiters),
            comm_warn=self._comm_warn,
        )

    def _alarm(self) -> int:
        state = self.standing.state
        if state in LATCHED_STATES and self._causes & _APPLIED_DIFFERS:
            return first_code(_APPLIED_DIFFERS)  # the one alarm that matters while at rest
        if state is _FAULT:
            return self._first_cause
        if state is State.BYPASS:
            return _BYPASSED
        return first_code(self._causes & FADING) if self.standing.armed else 0
