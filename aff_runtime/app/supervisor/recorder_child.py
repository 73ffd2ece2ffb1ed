"""The supervisor's handle on the recorder process."""

from __future__ import annotations

import contextlib
import fcntl
import os
import signal
import subprocess
from pathlib import Path

from aff_runtime.app.supervisor.child_environment import without_service_manager
from aff_runtime.base.python_child import module_command
from aff_runtime.telemetry.recorder_messages import Note, RecorderReport, RunContext, report_of
from aff_runtime.telemetry.ring import RingReader

# A pipe that holds the whole context, a site file of 256 kB with every letter escaped: the
# supervisor must not wait for a recorder that starts slowly, or not at all.
_CONTEXT_BYTES = 1 << 20


class RecorderChild:
    """A started recorder: takes notes, reports about itself; its death disturbs nobody."""

    def __init__(self, ring: RingReader, directory: Path, context: RunContext) -> None:
        # By descriptor: the file may be removed or replaced before the recorder has started.
        name = f"/dev/fd/{ring.fileno()}"
        self._process = subprocess.Popen(
            [*module_command("aff_runtime.telemetry.recorder"), name, str(directory)],
            pass_fds=[ring.fileno()],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=without_service_manager(),
        )
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._input = self._process.stdin.fileno()
        self._output = self._process.stdout.fileno()
        self._begun_line = self._unsent = b""
        self._report = RecorderReport()
        with contextlib.suppress(OSError):
            fcntl.fcntl(self._input, fcntl.F_SETPIPE_SZ, _CONTEXT_BYTES)
        self._write(context.encode())
        os.set_blocking(self._input, False)
        os.set_blocking(self._output, False)

    @property
    def pid(self) -> int:
        """Process id."""
        return self._process.pid

    def how_it_ended(self) -> str:
        """Return in words how it ended; empty while it lives."""
        code = self._process.poll()
        if code is None:
            return ""
        how = f"killed by {signal.Signals(-code).name}" if code < 0 else f"exit {code}"
        return f"recorder {self.pid}: {how}"

    def note(self, name: str, text: str, *, site_text: str = "", site_hash: str = "") -> None:
        """Have a line put into ``events.csv``, and a site file that runs from then on kept."""
        self._write(Note(name=name, text=text, site_text=site_text, site_hash=site_hash).encode())

    def keep_response(self, actuator: str, text: str) -> None:
        """Have a response kept that was measured; no event tells of it."""
        self._write(Note(name="", actuator=actuator, response=text).encode())

    def report(self) -> RecorderReport:
        """Return the newest report (folder, rows, losses), with ``alive``."""
        self._write(b"")
        with contextlib.suppress(OSError):
            while chunk := os.read(self._output, 1 << 16):
                self._begun_line += chunk
        *lines, self._begun_line = self._begun_line.split(b"\n")
        if lines:
            self._report = report_of(lines[-1]) or self._report
        return self._report.seen(alive=self._process.poll() is None)

    def wait(self, patience_s: float) -> None:
        """Let it write what is left in the ring; kill it after ``patience_s``."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        try:
            self._process.wait(patience_s)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        for stream in (self._process.stdin, self._process.stdout):
            with contextlib.suppress(OSError):
                stream.close()

    def _write(self, line: bytes) -> None:
        """Send one line, after what the pipe had no room for; lost when nobody takes it.

        Half a line would swallow the next one: the rest of one that was begun is never left out.
        """
        if len(self._unsent) + len(line) <= 2 * _CONTEXT_BYTES:
            self._unsent += line
        with contextlib.suppress(OSError):
            self._unsent = self._unsent[os.write(self._input, self._unsent) :]
