"""Follows the service through its door: every tick of the ring, and the facts beside it."""

from __future__ import annotations

import contextlib
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from aff_hmi.recent_window import RecentWindow
from aff_runtime.app.door.client import DoorClient
from aff_runtime.app.door.messages import PROTOCOL, Facts, Hello, RingGone, RingPassed, SentAway
from aff_runtime.app.report.line_facts import LineFacts
from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.base.errors import AffError, WireError
from aff_runtime.base.ports import Clock
from aff_runtime.telemetry.header import RunMeta
from aff_runtime.telemetry.ring import RingReader

RETRY_NS = 500_000_000
KEPT_EVENTS = 50
_S = 1e-9
Rows: TypeAlias = NDArray[np.float64] | Sequence[Sequence[float]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Observed:
    """What is known at one moment; ages in s, None where nothing was ever seen.

    Attributes
    ----------
    facts_age_s : since the facts were told.
    row : the newest tick record.
    tick_age_s : since a tick was last seen to arrive.
    writer_lives : whether the control process exists.
    meta : what it says of itself.
    window : the last seconds of readings and corrections.
    unread : ticks of the ring that were overwritten before they were read here.
    events : (code, argument, age in s), the newest first.
    trouble : why there is no door, in words.
    other_protocol : of a service that opens its door and is of another release; 0 of none.
    clock_step_s : by which the wall clock was set lately; 0 when it was not.
    certificate_s : until the first certificate of this screen ends; None without any.
    """

    facts: Facts | None = None
    facts_age_s: float | None = None
    row: TickRow | None = None
    tick_age_s: float | None = None
    writer_lives: bool = False
    meta: RunMeta | None = None
    window: RecentWindow | None = None
    unread: int = 0
    events: tuple[tuple[int, float, float], ...] = ()
    trouble: str = ""
    other_protocol: int = 0
    clock_step_s: float = 0.0
    certificate_s: float | None = None

    @property
    def site(self) -> LineFacts | None:
        """What the site file says of the line; None until the service has told it."""
        return self.facts.status.facts if self.facts is not None else None


@dataclass(frozen=True, slots=True, kw_only=True)
class News:
    """What one poll has brought, in order.

    Attributes
    ----------
    ring : which ring it is of.
    columns : of ``records``.
    records : ticks that were seen to arrive; those that a new ring held already are not.
    events : (tick, monotonic time in ns, code, argument), those that it held already too.
    """

    ring: str = ""
    columns: tuple[str, ...] = ()
    records: Rows = ()
    events: Sequence[tuple[float, ...]] = ()


class Watch:
    """The only part that touches the door.

    Attributes
    ----------
    news : what the newest poll has brought.

    Notes
    -----
    A ring says nothing of its age until a tick is seen to arrive: one that is found standing
    still has no age, and is not taken for a live one.
    """

    def __init__(self, door: Path, clock: Clock) -> None:
        self._path = door
        self._clock = clock
        self._door: DoorClient | None = None
        self._retry_ns = 0
        self._trouble = ""
        self._other_protocol = 0
        self._facts: Facts | None = None
        self._facts_ns = 0
        self._ring: RingReader | None = None
        self._window: RecentWindow | None = None
        self._row: TickRow | None = None
        self._written = 0
        self._tick_ns: int | None = None
        self._events: deque[tuple[int, float, int]] = deque(maxlen=KEPT_EVENTS)
        self.news = News()

    def poll(self) -> None:
        """Hear the door and read what is new in the ring; returns at once."""
        now_ns = self._clock.now_ns()
        if self._door is None and now_ns >= self._retry_ns:
            self._knock(now_ns)
        if self._door is not None:
            try:
                self._hear(self._door, now_ns)
            except AffError as error:
                self._leave(str(error), now_ns)
        self._follow(now_ns)

    @property
    def hears_ticks(self) -> bool:
        """Whether a tick of this ring was seen to arrive."""
        return self._tick_ns is not None

    def seen(self) -> Observed:
        """Return what is known now."""
        now_ns = self._clock.now_ns()
        facts = self._facts
        return Observed(
            facts=facts,
            facts_age_s=None if facts is None else (now_ns - self._facts_ns) * _S,
            row=self._row,
            tick_age_s=None if self._tick_ns is None else (now_ns - self._tick_ns) * _S,
            writer_lives=self._ring is not None and self._ring.writer_alive(),
            meta=self._ring.header.meta if self._ring is not None else None,
            window=self._window,
            unread=self._ring.signals.overrun_count if self._ring is not None else 0,
            events=tuple(
                (code, argument, (now_ns - t_ns) * _S)
                for code, argument, t_ns in reversed(self._events)
            ),
            trouble=self._trouble,
            other_protocol=self._other_protocol,
        )

    def close(self) -> None:
        """Leave the door and let go of the ring."""
        if self._door is not None:
            self._door.close()
            self._door = None
        self._drop_ring()

    def _knock(self, now_ns: int) -> None:
        self._retry_ns = now_ns + RETRY_NS
        try:
            self._door = DoorClient(self._path)
        except AffError as error:
            self._trouble, self._other_protocol = str(error), 0

    def _hear(self, door: DoorClient, now_ns: int) -> None:
        while (message := door.receive()) is not None:
            match message:
                case Hello(protocol=protocol):
                    self._other_protocol = 0 if protocol == PROTOCOL else protocol
                    if self._other_protocol:
                        raise WireError(f"the service speaks protocol {protocol}, not {PROTOCOL}")
                    self._trouble = ""
                case RingPassed(descriptor=descriptor):
                    self._drop_ring()
                    with contextlib.suppress(
                        ValueError, OSError
                    ):  # what is no ring counts as none
                        self._ring = RingReader(descriptor)
                case RingGone():
                    self._drop_ring()
                case Facts():
                    self._facts, self._facts_ns = message, now_ns
                case SentAway(message=why):
                    raise WireError(why)

    def _leave(self, why: str, now_ns: int) -> None:
        """Let go of a door that has closed; the ring stays while its writer lives."""
        assert self._door is not None
        self._door.close()
        self._door = None
        self._trouble = why
        self._retry_ns = now_ns + RETRY_NS

    def _follow(self, now_ns: int) -> None:
        """Read new ticks and events of the ring."""
        ring = self._ring
        if ring is None:
            self.news = News()
            return
        records = ring.signals.read_rows()
        arrived = records if self._written else records[:0]
        written = ring.signals.written_count()
        if self._window is None and self._facts is not None and self._facts.status.facts:
            self._window = self._new_window(ring)
        if len(records):
            if self._written:
                self._tick_ns = now_ns
            self._row = TickRow(dict(zip(ring.columns, records[-1].tolist(), strict=True)))
            if self._window is not None:
                self._window.add(records)
        self._written = written
        events = ring.events.read_new()
        self._events.extend((int(code), argument, int(t_ns)) for _, t_ns, code, argument in events)
        self.news = News(
            ring=f"{ring.header.start_utc} {ring.header.writer_pid}",
            columns=ring.columns,
            records=arrived,
            events=events,
        )

    def _new_window(self, ring: RingReader) -> RecentWindow:
        assert self._facts is not None
        assert self._facts.status.facts is not None
        facts = self._facts.status.facts
        kept = _measured(ring.columns)
        kept += [f"correction_{output.column}" for output in facts.outputs]
        return RecentWindow(ring.columns, kept, facts.cycle_s)

    def _drop_ring(self) -> None:
        if self._ring is not None:
            self._ring.close()
        self._ring, self._window, self._row, self._tick_ns = None, None, None, None
        self._written = 0
        self._events.clear()


def _measured(columns: Sequence[str]) -> list[str]:
    """Return the channels among the columns of a ring."""
    return [channel.name for channel in TickRow(dict.fromkeys(columns)).channels]
