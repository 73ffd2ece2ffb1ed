"""A door on a real socket with a ring behind it, served by hand."""

from __future__ import annotations

import contextlib
import os
import selectors
from collections.abc import Sequence
from pathlib import Path

from aff_runtime.app.door.client import DoorClient
from aff_runtime.app.door.messages import DoorMessage, Facts
from aff_runtime.app.report.status_answer import StatusAnswer
from aff_runtime.app.supervisor.door import Door
from aff_runtime.telemetry.header import RunMeta
from aff_runtime.telemetry.ring import RingReader, RingWriter
from tests.doubles.virtual_clock import VirtualClock

COLUMNS = ("time_s", "tension_N")


class Stand:
    """The supervisor's side of a door, a round at a time."""

    def __init__(
        self,
        folder: Path,
        *,
        is_private: bool = True,
        columns: Sequence[str] = COLUMNS,
        meta: RunMeta | None = None,
        said: Facts | None = None,
        time: VirtualClock | None = None,
    ) -> None:
        self.clock = time or VirtualClock(1)
        self.columns, self.meta = columns, meta or RunMeta(config_hash="3f9a")
        self.said = said or Facts(
            status=StatusAnswer(line="L", state="READY"),
            blocked="WEB_INTACT=0",
            also_blocking=("SPLICE",),
        )
        self.selector = selectors.DefaultSelector()
        self.path = folder / "door.sock"
        self.door = Door(folder, self.selector, self.clock, is_private=is_private)
        self.writer, self.ring = self.new_ring()
        self.clients: list[DoorClient] = []
        self.asked = 0

    def new_ring(self) -> tuple[RingWriter, RingReader]:
        """Return a writer, and the supervisor's reader of it."""
        writer = RingWriter(self.columns, meta=self.meta, capacity=64)
        descriptor = writer.open_for_readers()
        try:
            return writer, RingReader(Path(f"/dev/fd/{descriptor}"))
        finally:
            os.close(descriptor)

    def facts(self) -> Facts:
        """Return what the supervisor would say."""
        self.asked += 1
        return self.said

    def round(self, ring: RingReader | None) -> None:
        """Serve everything that waits."""
        for _ in range(20):
            events = self.selector.select(0.0)
            for key, _ in events:
                self.door.serve(key)
            if not events:
                break
        self.door.step(ring, self.facts)

    def visit(self) -> DoorClient:
        """Return a new visitor."""
        self.clients.append(DoorClient(self.path))
        return self.clients[-1]

    def close(self) -> None:
        for client in self.clients:
            client.close()
        self.door.close()
        with contextlib.suppress(OSError):  # a test may have ended it
            self.writer.close()
        self.ring.close()
        self.selector.close()


def heard(client: DoorClient) -> list[DoorMessage]:
    """Return everything that a visitor has been told."""
    found: list[DoorMessage] = []
    while (message := client.receive()) is not None:
        found.append(message)
    return found
