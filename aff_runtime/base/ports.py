"""The ports between rooms: what the cycle needs of a law, a guard, a gateway and a clock."""

from __future__ import annotations

from typing import Protocol

from aff_runtime.base.signals import ActuatorStep, Command, Outcome, Permission, Snapshot


class Clock(Protocol):
    """Monotonic time; virtual in tests."""

    def now_ns(self) -> int:
        """Return monotonic time, ns."""
        ...

    def sleep_until_ns(self, deadline_ns: int) -> None:
        """Return at ``deadline_ns`` or at once when it has passed."""
        ...


class WordTransport(Protocol):
    """Moves 16-bit words: one write block out, one read block in, in one transaction."""

    def transact(self, write_words: list[int], deadline_ns: int) -> tuple[Outcome, list[int]]:
        """Exchange the blocks before ``deadline_ns``; never blocks longer, never raises."""
        ...

    def close(self) -> None:
        """Release the connection."""
        ...


class Gateway(Protocol):
    """The wire in SI: one transaction per tick.

    Attributes
    ----------
    heartbeat_modulus : counts after which the PLC's heartbeat starts over.
    shift_ns : how much later (negative: earlier) the next tick should start so that it meets the
        other side's scan; 0 where that side keeps no pace of its own.
    """

    @property
    def heartbeat_modulus(self) -> int:
        """Counts after which the PLC's heartbeat starts over."""
        ...

    @property
    def shift_ns(self) -> int:
        """Wanted shift of the next tick, ns."""
        ...

    @property
    def troubles(self) -> tuple[str, ...]:
        """What keeps the wire from working, one sentence each, where the wire knows."""
        ...

    def exchange(self, command: Command, tick: int, deadline_ns: int) -> Snapshot:
        """Send ``command``, return what the PLC says; never blocks past the deadline."""
        ...

    def close(self) -> None:
        """Release the connection."""
        ...


class Law(Protocol):
    """A control law: knows no limits, no clock, no wire."""

    def step(
        self, snapshot: Snapshot, dt_s: float, permission: Permission
    ) -> tuple[ActuatorStep, ...]:
        """Advance by ``dt_s`` (whole periods) and return one step per actuator."""
        ...

    def telemetry(self) -> tuple[float, ...]:
        """Return the law's numbers for the record, in the order of ``telemetry_names``."""
        ...

    def telemetry_names(self) -> tuple[str, ...]:
        """Return column names with units, fixed for the life of the law."""
        ...
