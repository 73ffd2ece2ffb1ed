"""What the cycle needs of the rooms it must not know: the guard, and where records go."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from aff_runtime.base.ports import Law
from aff_runtime.base.signals import ActuatorStep, Permission, Snapshot, State
from aff_runtime.loop.messages import Message


class GuardPort(Protocol):
    """The guard as the cycle sees it; implemented by ``safety.guard.Guard``."""

    objections: tuple[str, ...]
    ripple_rose: bool

    @property
    def state(self) -> State:
        """State of the guard."""
        ...

    @property
    def believes(self) -> bool:
        """Whether the last readings can be true."""
        ...

    @property
    def quiet(self) -> bool:
        """Whether every output is closed and zero."""
        ...

    @property
    def limits(self) -> tuple[float, ...]:
        """Limit in force per actuator, SI."""
        ...

    def observe(
        self, snapshot: Snapshot, now_ns: int, overrun: bool, supervisor_alive: bool
    ) -> Permission:
        """Judge one tick's readings."""
        ...

    def limit(
        self, steps: tuple[ActuatorStep, ...] | None, dt_s: float
    ) -> tuple[tuple[float, ...], int, int]:
        """Return corrections, state bits and alarm code."""
        ...

    def withdraw(self) -> tuple[int, int]:
        """Close all outputs at once and latch OVERRUN; return state bits and alarm code."""
        ...

    def arm(self) -> str:
        """Ask for an armed output."""
        ...

    def bypass(self) -> None:
        """Take the correction back."""
        ...

    def shadow(self, on: bool) -> None:
        """Compute without transmitting."""
        ...

    def fade_once(self) -> None:
        """Fade to zero and come back."""
        ...

    def internal_fault(self) -> None:
        """Latch INTERNAL_FAULT."""
        ...

    def first_blocking(self) -> str:
        """Return what stands against an armed output, or ``''``."""
        ...

    def reasons(self) -> tuple[str, ...]:
        """Return all that stands against an armed output, the first one first."""
        ...

    def drain_events(self) -> list[tuple[int, int]]:
        """Return (tick, code) since the last call."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Advice:
    """What the law's side tells the guard: reasons against arming, and whether ripple rose."""

    objections: tuple[str, ...] = ()
    ripple_rose: bool = False


class OutsidePort(Protocol):
    """Everything around the control process, as calls that never block and return at once."""

    def publish(self, record: Sequence[float]) -> None:
        """Keep one record; columns by ``record.record_columns``."""
        ...

    def event(self, tick: int, t_ns: int, code: int) -> None:
        """Keep one event."""
        ...

    def fault_text(self, text: str) -> None:
        """Pass on the traceback of an internal fault."""
        ...

    def blocked(self, reasons: tuple[str, ...]) -> None:
        """Pass on all that stands against an armed output, the first one first; on change."""
        ...

    def poll(self) -> Sequence[Message]:
        """Return what the supervisor said since the last call."""
        ...

    def advise(self, law: Law) -> Advice:
        """Return the law side's advice; asked every few ticks and before arming."""
        ...

    def adopt(self, guard_params: object) -> None:
        """Hand new settings to the guard."""
        ...

    def tick_done(self, first_exchange_ok: bool) -> None:
        """Feed the service watchdog."""
        ...
