"""A cycle on a virtual clock, between a PLC that answers well and a law that hums."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos

from aff_runtime.base.events import BY_CODE
from aff_runtime.base.ports import Law
from aff_runtime.base.signals import (
    ActuatorStep,
    Command,
    Outcome,
    Permission,
    Snapshot,
    State,
    StateBits,
    Status,
)
from aff_runtime.loop.cycle import Cycle, CycleSettings
from aff_runtime.loop.messages import Arm, Message
from aff_runtime.loop.ports import Advice
from aff_runtime.loop.record import record_columns
from aff_runtime.safety.guard import Guard
from aff_runtime.safety.params import ActuatorLimits, GuardParams
from tests.doubles.virtual_clock import VirtualClock

PERIOD_NS = 5_000_000
FADE_TICKS = 30
ALL_BITS = int(Status(0xFF) & ~(Status.REMOTE | Status.SPLICE_ACTIVE | Status.RESET_EDGE))
CHANNELS = ("tension_N",)
PARAMS = GuardParams(
    actuators=(ActuatorLimits(name="unwind", limit=0.05, slew_limit=2.0, soft_start_s=0.05),),
    fade_s=0.150,
)
COLUMNS = record_columns(CHANNELS, ("unwind_m_s",), ("law_k",))


class Plc:
    """Answers at once; keeps every command with its time."""

    def __init__(self, clock: VirtualClock) -> None:
        self.clock = clock
        self.commands: list[tuple[int, Command]] = []
        self.outcome = Outcome.OK
        self.raises: Exception | None = None
        self.heartbeat = 0
        self.deadlines: list[int] = []
        self.shift_ns = 0
        self.only_reads = False

    def exchange(self, command: Command, tick: int, deadline_ns: int) -> Snapshot:
        if self.raises is not None:
            raise self.raises
        self.commands.append((self.clock.now_ns(), command))
        self.deadlines.append(deadline_ns - self.clock.now_ns())
        self.clock.advance_ns(300_000)
        good = self.outcome is Outcome.OK
        self.heartbeat += good
        return Snapshot(
            tick=tick,
            t_ns=self.clock.now_ns(),
            outcome=self.outcome,
            fresh=good,
            age_s=0.0,
            plc_heartbeat=self.heartbeat,
            status=ALL_BITS,
            roll_id=1,
            values=(90.0,),
            command_sent=not self.only_reads,
        )

    def close(self) -> None:
        pass

    @property
    def last(self) -> Command:
        return self.commands[-1][1]


class Hum:
    """A law with one slow cosine; spoil it by setting ``trouble``."""

    def __init__(self, amplitude: float = 0.01) -> None:
        self.amplitude = amplitude
        self.k = 0
        self.trouble: Exception | None = None
        self.hang_ns = 0
        self.clock: VirtualClock | None = None
        self.value: float | None = None
        self.dt_s: list[float] = []

    def step(
        self, snapshot: Snapshot, dt_s: float, permission: Permission
    ) -> tuple[ActuatorStep, ...]:
        self.k += 1
        self.dt_s.append(dt_s)
        if self.clock is not None:
            self.clock.advance_ns(self.hang_ns)
        if self.trouble is not None:
            raise self.trouble
        value = self.amplitude * cos(0.01 * self.k) if self.value is None else self.value
        peak = abs(self.amplitude)
        return (ActuatorStep(value=value, peak_bound=peak, slew_bound=2.0 * peak),)

    def telemetry(self) -> tuple[float, ...]:
        return (float(self.k),)

    def telemetry_names(self) -> tuple[str, ...]:
        return ("law_k",)


class Memory:
    """The outside of the cycle, remembered."""

    def __init__(self, guard: Guard) -> None:
        self.guard = guard
        self.records: list[tuple[float, ...]] = []
        self.events: list[str] = []
        self.faults: list[str] = []
        self.reasons: list[tuple[str, ...]] = []
        self.inbox: list[Message] = []
        self.advice = Advice()
        self.publish_trouble: Exception | None = None
        self.ticks_done = 0

    def publish(self, record: Sequence[float]) -> None:
        if self.publish_trouble is not None:
            raise self.publish_trouble
        self.records.append(tuple(record))

    def event(self, tick: int, t_ns: int, code: int) -> None:
        self.events.append(BY_CODE[code].name)

    def fault_text(self, text: str) -> None:
        self.faults.append(text)

    def blocked(self, reasons: tuple[str, ...]) -> None:
        self.reasons.append(reasons)

    def poll(self) -> Sequence[Message]:
        messages, self.inbox = self.inbox, []
        return messages

    def advise(self, law: Law) -> Advice:
        return self.advice

    def adopt(self, guard_params: object) -> None:
        assert isinstance(guard_params, GuardParams)
        self.guard.adopt(guard_params)

    def tick_done(self, first_exchange_ok: bool) -> None:
        self.ticks_done += 1


class Rig:
    def __init__(self) -> None:
        self.clock = VirtualClock(10**9)
        self.plc = Plc(self.clock)
        self.guard = Guard(PARAMS)
        self.law = Hum()
        self.memory = Memory(self.guard)
        settings = CycleSettings(
            period_ns=PERIOD_NS,
            io_budget_ns=3_000_000,
            fade_s=0.150,
            channel_count=1,
            output_count=1,
            law_columns=1,
            config_revision=0x1_2345,
        )
        self.cycle = Cycle(
            settings=settings,
            clock=self.clock,
            gateway=self.plc,
            guard=self.guard,
            law=self.law,
            outside=self.memory,
        )

    def run(self, ticks: int) -> None:
        for _ in range(ticks):
            assert self.cycle.tick()

    def say(self, *messages: Message) -> None:
        self.memory.inbox.extend(messages)

    def active(self) -> Rig:
        self.run(2)
        self.say(Arm())
        self.run(30)
        assert self.guard.state is State.ACTIVE
        assert abs(self.plc.last.corrections[0]) > 0.009
        self.memory.events.clear()
        return self

    def column(self, name: str) -> list[float]:
        return [record[COLUMNS.index(name)] for record in self.memory.records]

    def assert_faded_from(self, first: int) -> None:
        """The command is zero one fade (and the tick in flight) after command ``first``."""
        later = self.plc.commands[first + FADE_TICKS + 2 :]
        assert later
        assert all(command.corrections == (0.0,) for _, command in later)
        assert all(command.state_bits & StateBits.FAULT for _, command in later)
