"""A whole supervisor in this process; a double stands for the control process and its link."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from aff_runtime.app.check.validate import check_result
from aff_runtime.app.link.messages import Message
from aff_runtime.app.link.runtime_directory import runtime_paths
from aff_runtime.app.supervisor import edit_session, processes, supervisor
from aff_runtime.app.supervisor.control_child import Ending
from aff_runtime.app.supervisor.run_options import RunOptions
from aff_runtime.app.supervisor.supervisor import Supervisor
from aff_runtime.base.signals import State, StateBits
from aff_runtime.config.loader import load_site
from aff_runtime.loop.record import record_columns
from aff_runtime.telemetry.header import RunMeta
from aff_runtime.telemetry.ring import RingReader, RingWriter
from tests.doubles.virtual_clock import VirtualClock
from tests.security.learned_files import SITE, CheckInProcess, site_in

CHANNELS = tuple(load_site(SITE).gateway.read.channels)
COLUMNS = record_columns(CHANNELS, ("unwind_m_s", "swrap_follower_m_s"), ())


class Control:
    """A control process: what it was sent, and what it says when it is heard next.

    Attributes
    ----------
    last_words : what it says while it is being stopped.
    ending : how it ends then.
    """

    pid = 4711

    def __init__(self, *_: object, **__: object) -> None:
        self.link = self
        self._read, self._write = os.pipe()
        self.sent: list[Any] = []
        self.says: list[Message] = []
        self.last_words: Callable[[], list[Message]] = list
        self.how_it_ended: str | None = None
        self.ending = Ending.ZERO

    def fileno(self) -> int:
        return self._read

    def send(self, message: Message) -> bool:
        self.sent.append(message)
        return True

    def replies(self) -> list[Message]:
        said, self.says = self.says, []
        return said

    def ended(self) -> str | None:
        return self.how_it_ended

    def bypass_by_signal(self) -> None:
        pass

    def kill(self) -> None:
        self.how_it_ended = "killed by SIGKILL"

    def stop(self, *, patience_s: float) -> Ending:
        self.says += self.last_words()
        return self.ending

    def open_ring(self) -> None:
        return None

    def close(self) -> None:
        os.close(self._read)
        os.close(self._write)


class Whole:
    """A service of ``config/euclid_blocks.yaml`` that has just started its control process."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch, **options: Any) -> None:
        self._is_over = False
        self.clock = VirtualClock(10**12)
        monkeypatch.setattr(supervisor, "MonotonicClock", lambda: self.clock)
        monkeypatch.setattr(supervisor, "load_parameters", lambda site, _: check_result(site))
        monkeypatch.setattr(processes, "ControlChild", Control)
        monkeypatch.setattr(edit_session, "Validation", CheckInProcess)
        (folder / "run").mkdir(mode=0o700)
        (folder / "state").mkdir()
        self.site = site_in(folder)
        self.service = Supervisor(
            RunOptions(
                site=self.site,
                paths=runtime_paths(folder / "run"),
                state_directory=folder / "state",
                **options,
            )
        )
        self.children = self.service._processes
        self.probes = self.service._probes
        self.children.start()
        self._ring = RingWriter(COLUMNS, meta=RunMeta(start_ns=self.clock.now_ns()))
        self.children.ring = RingReader(self._ring.open_for_readers())
        self._start_ns = self.clock.now_ns()

    def tick(self, state: State, **more: float) -> None:
        """Have the control process tick once, now."""
        time_s = (self.clock.now_ns() - self._start_ns) * 1e-9
        bits = StateBits.ARMED | StateBits.ACTIVE if state is State.ACTIVE else StateBits(0)
        values = {"time_s": time_s, "state": float(state), "state_bits": float(bits)} | more
        self._ring.write([values.get(name, 0.0) for name in COLUMNS])

    @property
    def control(self) -> Control:
        found = self.children.control
        assert isinstance(found, Control)
        return found

    def wait(self, seconds: float) -> None:
        """Let time pass, in one piece."""
        self.clock.advance_ns(round(seconds * 1e9))
        self.round()

    def round(self) -> None:
        """One round of the supervisor."""
        self.service._hear_control()
        self.service._look_after()

    def stop(self) -> None:
        """End the service, as a signal does; once."""
        if self._is_over:
            return
        self._is_over = True
        self.service._stop(why="SIGTERM")
        self.service._shut_down()
        self._ring.close()
