"""A running service against a PLC of its own, for tests of the processes."""

from __future__ import annotations

import contextlib
import json
import os
import re
import socket
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from tests.processes import PATIENCE_S, Operator, until

ROOT = Path(__file__).parents[3]


class ServiceRun(Operator):
    """PLC and service in processes of their own below ``folder``.

    Parameters
    ----------
    run_as : words before the service's command: who runs it.
    cycle_ms : of the control process. What is tested is processes and what they say to each
        other: at 5 ms service and PLC take a third of a core for the same. The shipped orders
        arm at 10 ms or less.
    """

    def __init__(
        self,
        folder: Path,
        *arguments: str,
        patience_s: float = PATIENCE_S,
        run_as: Sequence[str] = (),
        cycle_ms: int = 20,
    ) -> None:
        super().__init__(folder / "rt")
        self.folder = folder
        self.plc = subprocess.Popen(
            [sys.executable, str(Path(__file__).with_name("fake_plc.py"))],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        assert self.plc.stdout is not None
        port = self.plc.stdout.readline().strip()
        text = (
            (ROOT / "config" / "euclid_blocks.yaml")
            .read_text()
            .replace("port: 5020", f"port: {port}")
        )
        text = text.replace("cycle_ms: 5\n", f"cycle_ms: {cycle_ms}\n")
        text = re.sub(r"stuck_after_s: [\d.]+", "stuck_after_s: 30", text)
        text = text.replace("fault_after_ms: 80", "fault_after_ms: 140")
        text = text.replace("hold_after_ms: 15", "hold_after_ms: 60")
        text = re.sub(r"duration_s: \d+", "duration_s: 9", text)
        self.site = folder / "site.yaml"
        self.site.write_text(text)
        self.log = folder / "log"
        self.notified = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.notified.bind(str(folder / "notify"))
        self.notified.setblocking(False)
        self._arguments, self._patience_s, self._run_as = arguments, patience_s, run_as
        self.start_again()

    def start_again(self) -> None:
        """Start the service, once more after it was killed; the PLC lives on."""
        with self.log.open("a") as log:
            self._log_begins = log.tell()
            self.process = subprocess.Popen(
                [
                    *(*self._run_as, sys.executable, "-m", "aff_runtime.cli.main"),
                    *("run", str(self.site)),
                    *("--runtime-dir", str(self.runtime_dir), *self._arguments),
                ],
                stderr=log,
                cwd=ROOT,
                env={**os.environ, "NOTIFY_SOCKET": str(self.folder / "notify")},
            )
        try:
            until(
                "the service has signals",
                lambda: self.status().get("signals") is not None,
                self._patience_s,
            )
            until(
                "the service sees the PLC", lambda: self.status()["comm"] == "OK", self._patience_s
            )
        except BaseException:
            self.close()
            raise

    def has_ended(self) -> bool:
        """Return whether there is no service any more: a test has ended it."""
        return self.process.poll() is not None

    def tell_plc(self, command: str) -> list[int]:
        """Give the PLC a command; return the words last written to it."""
        assert self.plc.stdin is not None
        assert self.plc.stdout is not None
        self.plc.stdin.write(command + "\n")
        self.plc.stdin.flush()
        words: list[int] = json.loads(self.plc.stdout.readline())
        return words

    def notifications(self) -> list[bytes]:
        """Return what the service manager has been told since the last call."""
        heard: list[bytes] = []
        with contextlib.suppress(BlockingIOError):
            while True:
                heard.append(self.notified.recv(200))
        return heard

    def edit(self, before: str, after: str) -> None:
        """Replace text in the site file the way editors do."""
        text = self.site.read_text()
        assert before in text
        fresh = self.site.with_suffix(".new")
        fresh.write_text(text.replace(before, after))
        fresh.replace(self.site)

    def said(self, text: str) -> bool:
        """Return whether the service that was started last has logged ``text``."""
        return text.encode() in self.log.read_bytes()[self._log_begins :]

    def close(self) -> None:
        """End both processes."""
        if self.process.poll() is None:
            self.process.terminate()
        with contextlib.suppress(subprocess.TimeoutExpired):
            self.process.wait(10)
        self.process.kill()
        self.process.wait()
        self.plc.kill()
        self.plc.communicate()
        self.notified.close()
