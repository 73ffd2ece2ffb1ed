"""The reactions of guard, cycle, gateways and PLC, each with what it is without."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from math import inf
from typing import Any

from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import Outcome, State, Status
from aff_runtime.fieldbus.can import gateway as can_gateway
from aff_runtime.fieldbus.can import reader as can_reader
from aff_runtime.fieldbus.canopen import link as canopen_link
from aff_runtime.fieldbus.canopen import node as canopen_node
from aff_runtime.fieldbus.liveness import HeartbeatOrder, Liveness
from aff_runtime.fieldbus.modbus import gateway
from aff_runtime.loop import cycle
from aff_runtime.safety import (
    applied_check,
    echo_check,
    envelope,
    freshness,
    guard,
    lease,
    limits,
    line_check,
    plc_reset,
)
from sim_plant.servers import canopen_device, plc

Change = Callable[[Any], Any]
SAFETY = "tests/aff_runtime/safety"
LOOP = "tests/aff_runtime/loop"


@dataclass(frozen=True, slots=True, kw_only=True)
class Mutant:
    """One reaction that is gone.

    Attributes
    ----------
    owner, attribute : where it is; ``change`` gets the original and returns the replacement.
    likely : faults (beginnings of their spec) that should notice first.
    wire : the only wire it concerns; empty for all.
    tests : unit tests to ask when no cell notices.
    equal : why nothing can notice, for a mutant that is no different from the original.
    """

    name: str
    owner: Any
    attribute: str
    change: Change
    likely: tuple[str, ...]
    wire: str = ""
    tests: str = ""
    equal: str = ""
    states: tuple[str, ...] = ("ACTIVE", "FADING")


@contextmanager
def applied(mutant: Mutant) -> Iterator[None]:
    """Take the reaction away for the time of the block."""
    original = getattr(mutant.owner, mutant.attribute)
    kept = mutant.owner.__dict__[mutant.attribute]
    setattr(mutant.owner, mutant.attribute, mutant.change(original))
    try:
        yield
    finally:
        setattr(mutant.owner, mutant.attribute, kept)


def always(value: Any) -> Change:
    """Return a change into something that ignores its arguments."""
    return lambda _: lambda *_args, **_kw: value


def _without_overrun(original: Any) -> Any:
    def causes(self: Any, now_ns: int, fresh: Any, overrun: bool, alive: bool) -> int:
        self._observed_ns = None
        return int(original(self, now_ns, fresh, False, alive))

    return causes


def _without_supervisor(original: Any) -> Any:
    return lambda self, now_ns, fresh, overrun, _: original(self, now_ns, fresh, overrun, True)


def _believing(original: Any) -> Any:
    def receive(self: Any, deadline_ns: int) -> Outcome:
        outcome: Outcome = original(self, deadline_ns)
        return Outcome.OK if outcome is Outcome.BAD_REPLY else outcome

    return receive


def _unlimited(_: Any) -> Any:
    def step(self: Any, wanted: Any, level: float, dt_s: float) -> None:
        self.output = 0.0 if wanted is None else wanted.value * level

    return step


def _advance_with(**forced: Any) -> Change:
    def change(original: Any) -> Any:
        return lambda standing, inputs: original(standing, replace(inputs, **forced))

    return change


def _self_arming(original: Any) -> Any:
    def advance(standing: Any, inputs: Any) -> Any:
        rest = standing.state in (State.FAULT, State.BYPASS) and not inputs.bypass_edge
        return original(standing, replace(inputs, arm_edge=True) if rest else inputs)

    return advance


def _every_echo_ours(original: Any) -> Any:
    return lambda self, snapshot, now_ns: original(self, replace(snapshot, echo_age=0), now_ns)


def _between_for_ever(original: Any) -> Any:
    return lambda self, shown, within, _, now_ns: original(self, shown, within, inf, now_ns)


def _quiet_in_bypass(original: Any) -> Any:
    def alarm(self: Any) -> int:
        bypassed = self.standing.state is State.BYPASS
        return BY_NAME["BYPASSED"].code if bypassed else int(original(self))

    return alarm


def _causes_without(name: str) -> Change:
    def change(original: Any) -> Any:
        gone = line_check.bit(name)
        return lambda self, *a: original(self, *a) & ~gone

    return change


def _ever_fresh(original: Any) -> Any:
    def judge(self: Any, outcome: Outcome, heartbeat: int, arrived_ns: int) -> Outcome:
        counts: Outcome = original(self, outcome, heartbeat, arrived_ns)
        if counts is Outcome.OK:
            self.fresh, self._moved_at_ns = True, arrived_ns
        return counts

    return judge


def _first_believed(original: Any) -> Any:
    def judge(self: Any, outcome: Outcome, heartbeat: int, arrived_ns: int) -> Outcome:
        self._lost = False
        return Outcome(original(self, outcome, heartbeat, arrived_ns))

    return judge


def _any_length(original: Any) -> Any:
    def take(self: Any, frame: Any) -> Any:
        known = self._frames.get((frame.can_id, frame.extended))
        if known is not None and len(frame.data) < known.layout.length:
            frame = frame._replace(data=frame.data.ljust(known.layout.length, b"\0"))
        return original(self, frame)

    return take


def _own_frames_ignored(original: Any) -> Any:
    def receive(self: Any, deadline_ns: int) -> Outcome:
        self._ours = frozenset()
        return Outcome(original(self, deadline_ns))

    return receive


def _heard_anew(original: Any) -> Any:
    def moves(self: Any, now_s: float, block: Any) -> bool:
        if self.map.write_word(block, "aff_heartbeat") != self._aff_heartbeat:
            self._silence_s = 0.0
        return bool(original(self, now_s, block))

    return moves


def _jump_unseen(original: Any) -> Any:
    def moves(self: Any, now_s: float, block: Any) -> bool:
        needed = self._needs_rearm
        alive = bool(original(self, now_s, block))
        if self._jumped and alive:
            self._needs_rearm = needed
        return alive

    return moves


def _believes(_: Any) -> Any:
    return property(lambda self: True)


def _no_rest(original: Any) -> Any:
    def advance(self: Any, news: int) -> None:
        self._idle_scans = 99
        original(self, news)

    return advance


MUTANTS: tuple[Mutant, ...] = (
    Mutant(name="freshness: the PLC is always fresh", owner=freshness.FreshnessCheck,
           attribute="judge", change=always(freshness.Freshness.GOOD), likely=("freeze",)),
    Mutant(name="liveness: every answer is fresh", owner=Liveness, attribute="judge",
           change=_ever_fresh, likely=("freeze",)),
    Mutant(name="liveness: a heartbeat may step back", owner=HeartbeatOrder, attribute="takes",
           change=always(True), likely=("turns",)),
    Mutant(name="liveness: the first set after a loss is believed", owner=Liveness,
           attribute="judge", change=_first_believed, likely=("drop", "restart"),
           tests="tests/aff_runtime/fieldbus/modbus/test_gateway.py"),
    Mutant(name="guard: an overrun is no cause", owner=guard.Guard, attribute="_timing_causes",
           change=_without_overrun, likely=("!stall",), tests=SAFETY),
    Mutant(name="guard: a lost supervisor is no cause", owner=guard.Guard,
           attribute="_timing_causes", change=_without_supervisor, likely=("!supervisor",),
           tests=SAFETY),
    Mutant(name="guard: an internal fault is no fault", owner=guard.Guard,
           attribute="internal_fault", change=always(None), likely=("!law",), tests=SAFETY),
    Mutant(name="guard: a wish that is no number makes sense", owner=guard,
           attribute="makes_sense", change=always(True), likely=("!nan",), tests=SAFETY),
    Mutant(name="guard: what cannot be true reaches the law", owner=guard.Guard,
           attribute="believes", change=_believes, likely=("absurd",)),
    Mutant(name="guard: armed before the PLC saw it idle", owner=guard.Guard,
           attribute="_advance", change=_no_rest, likely=("!limit",), tests=SAFETY),
    Mutant(name="echo: whose commands the PLC takes does not count", owner=echo_check.EchoCheck,
           attribute="judge", change=always(False), likely=("last",), tests=SAFETY),
    Mutant(name="echo: another heartbeat is ours", owner=echo_check.EchoCheck, attribute="_take",
           change=_every_echo_ours, likely=("last",), tests=SAFETY),
    Mutant(name="words: the echo is not read", owner=gateway.WordCodec, attribute="aff_echo",
           change=always(None), likely=("last",), wire="modbus",
           tests="tests/aff_runtime/fieldbus/modbus/test_gateway.py"),
    Mutant(name="applied: what the PLC applies does not count", owner=applied_check.AppliedCheck,
           attribute="judge", change=always(False), likely=("third",), tests=SAFETY),
    Mutant(name="applied: what is between ours and zero may stay", owner=applied_check._Output,
           attribute="judge_reading", change=_between_for_ever, likely=("third",), tests=SAFETY),
    Mutant(name="applied: in BYPASS it is no alarm", owner=guard.Guard, attribute="_alarm",
           change=_quiet_in_bypass, likely=("third",), tests=SAFETY, states=("BYPASS",)),
    Mutant(name="words: what is applied is not read", owner=gateway.WordCodec,
           attribute="applied", change=always(()), likely=("third",), wire="modbus",
           tests="tests/aff_runtime/fieldbus/modbus/test_gateway.py"),
    Mutant(name="lease: the law's last word holds for ever", owner=lease.Lease, attribute="tick",
           change=always(False), likely=("!lazy",), tests=SAFETY),
    Mutant(name="states: nothing latches", owner=guard, attribute="advance",
           change=_advance_with(latching=False), likely=("freeze",), tests=SAFETY),
    Mutant(name="states: leaves FAULT and BYPASS by itself", owner=guard, attribute="advance",
           change=_self_arming, likely=("freeze",), tests=SAFETY),
    Mutant(name="states: a lost permissive does not close", owner=guard, attribute="advance",
           change=_advance_with(blocked=False), likely=("permissive", "splice"), tests=SAFETY),
    Mutant(name="states: bypass does nothing", owner=guard, attribute="advance",
           change=_advance_with(bypass_edge=False), likely=("!limit",), tests=SAFETY),
    Mutant(name="states: opens while a correction still fades", owner=guard, attribute="advance",
           change=_advance_with(quiet=True), likely=("!limit", "permissive"), tests=SAFETY),
    Mutant(name="line check: every reading is plausible", owner=line_check.LineCheck,
           attribute="judge", change=always(0), likely=("absurd", "nan")),
    Mutant(name="line check: permissives do not count", owner=line_check.LineCheck,
           attribute="judge", change=_causes_without("PERMISSIVE_LOST"), likely=("permissive",),
           tests=SAFETY),
    Mutant(name="line check: a splice does not count", owner=line_check.LineCheck,
           attribute="judge", change=_causes_without("SPLICE"), likely=("splice",), tests=SAFETY),
    Mutant(name="line check: a tension that is no number counts", owner=line_check.LineCheck,
           attribute="judge", change=_causes_without("TENSION_IMPLAUSIBLE"),
           likely=("nan", "absurd"), tests=SAFETY),
    Mutant(name="reset of the PLC: always an edge", owner=plc_reset.PlcReset, attribute="step",
           change=always(True), likely=("freeze",), tests=SAFETY),
    Mutant(name="envelope: never closes", owner=envelope.Envelope, attribute="_close",
           change=always(None), likely=("nan", "permissive"), tests=SAFETY),
    Mutant(name="limits: nothing is limited", owner=limits.Limiter, attribute="step",
           change=_unlimited, likely=("double",)),
    Mutant(name="cycle: a command outlives a stall", owner=cycle.Cycle, attribute="_withdraw",
           change=always(None), likely=("!stall",), tests=LOOP),
    Mutant(name="cycle: the law sees what the guard does not believe", owner=cycle.Cycle,
           attribute="_believed", change=lambda _: lambda self: self._snapshot,
           likely=("absurd",), tests=LOOP),
    Mutant(name="words: counters go on after a loss", owner=gateway.WordCodec, attribute="reset",
           change=always(None), likely=("restart",), wire="modbus",
           tests="tests/aff_runtime/fieldbus/modbus/test_gateway.py "
                 "tests/aff_runtime/fieldbus/modbus/test_codec.py"),
    Mutant(name="CAN: every set is whole", owner=can_reader.CanReader, attribute="_is_whole",
           change=always(True), likely=("reorder", "lose", "partial"), wire="can"),
    Mutant(name="CAN: every heartbeat is in order", owner=can_reader.CanReader,
           attribute="_in_order", change=always(True), likely=("reorder",), wire="can",
           tests="tests/aff_runtime/fieldbus/can/test_reader.py"),
    Mutant(name="CAN: a frame of any length will do", owner=can_reader.CanReader,
           attribute="take", change=_any_length, likely=("short",), wire="can",
           tests="tests/aff_runtime/fieldbus/can/test_reader.py"),
    Mutant(name="CAN: a bad frame does no harm", owner=can_gateway.CanGateway,
           attribute="_receive", change=_believing, likely=("short", "second"), wire="can",
           tests="tests/aff_runtime/fieldbus/can/test_gateway.py"),
    Mutant(name="CAN: our own identifiers from elsewhere do no harm",
           owner=can_gateway.CanGateway, attribute="_receive", change=_own_frames_ignored,
           likely=("second",), wire="can",
           # in the cells the echo notices the second master as well
           tests="tests/aff_runtime/fieldbus/can/test_gateway.py"),
    Mutant(name="CANopen: operational without asking", owner=canopen_node.NodeKeeper,
           attribute="_heartbeat", change=always(None), likely=("reset",), wire="canopen"),
    Mutant(name="CANopen: no SYNC", owner=canopen_link.CanopenLink, attribute="sync",
           change=always(True), likely=("sync",), wire="canopen"),
    Mutant(name="CANopen: an emergency of a node does not count", owner=canopen_node.NodeKeeper,
           attribute="good", change=lambda _: property(
               lambda self: self.state is canopen_node.NodeState.OPERATIONAL),
           likely=("reset",), wire="canopen",
           tests="tests/aff_runtime/fieldbus/canopen/test_canopen.py"),
    Mutant(name="PLC: no watchdog", owner=plc.Plc, attribute="_heartbeat_moves",
           change=always(True), likely=("!kill",)),
    Mutant(name="PLC: one heartbeat makes up for all silence", owner=plc.Plc,
           attribute="_heartbeat_moves", change=_heard_anew, likely=("lose",), wire="can",
           tests="tests/matrix/test_matrix.py::"
        "test_commands_that_pass_a_bus_that_loses_the_rest_do_not_make_zero_late"),
    Mutant(name="PLC: a heartbeat may jump", owner=plc.Plc, attribute="_heartbeat_moves",
           change=_jump_unseen, likely=("second",), wire="modbus", tests="tests/deploy"),
    Mutant(name="PLC: a refusal is kept from the runtime", owner=plc.Plc, attribute="_hidden",
           change=always(Status(0)), likely=("!limit",), wire="modbus"),
    Mutant(name="PLC: an intact zero does not end the ramp", owner=plc.Plc,
           attribute="_says_zero", change=always(False), likely=("!supervisor",),
           tests="tests/deploy"),
    Mutant(name="device: process data never late", owner=canopen_device.Device, attribute="lost",
           change=always(False), likely=("!kill", "mute"), wire="canopen",
           tests="tests/matrix/test_matrix.py::"
        "test_a_drive_notices_by_itself_that_the_runtime_is_gone"),
)  # fmt: skip
