"""The supervisor's handle on the control process."""

from __future__ import annotations

import os
import signal
import subprocess
from collections import deque
from enum import Enum, auto
from pathlib import Path

from aff_runtime.app.check.limits import ONE_THREAD
from aff_runtime.app.link.messages import EXIT_UNHEARD, LogLine, Message, MessageError, Start, Stop
from aff_runtime.app.link.packets import Link, LinkClosedError, link_pair
from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.base.python_child import module_command
from aff_runtime.telemetry.ring import RingReader


class Ending(Enum):
    """How a control process ended, and what the PLC took last.

    ZERO: the PLC answered zeros last, or got nothing else. UNHEARD: it ended in good order, and no
    answer says that a zero arrived. BADLY: killed, or with an error.
    """

    ZERO = auto()
    UNHEARD = auto()
    BADLY = auto()


class ControlChild:
    """A started control process, its link, and how it ended.

    Parameters
    ----------
    parameters : complete parameter record, sent as the first message.
    shadow : compute and record, transmit zero.
    """

    def __init__(self, parameters: ParameterRecord, *, shadow: bool) -> None:
        ours, theirs = link_pair()
        # A bypass or a hang-up that comes before the process listens does not kill it.
        early = {signal.SIGUSR1, signal.SIGHUP}
        before = signal.pthread_sigmask(signal.SIG_BLOCK, early)
        try:
            self._process = subprocess.Popen(
                [
                    *module_command("aff_runtime.app.control.process"),
                    *("--link-fd", str(theirs.fileno())),
                ],
                pass_fds=[theirs.fileno()],
                stdin=subprocess.DEVNULL,
                # a matrix product of two threads would wait for the one without real-time priority
                env=os.environ | ONE_THREAD,
            )
        except OSError:
            ours.close()
            raise
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
            theirs.close()
        self.link = Link(ours)
        self._rings: deque[int] = deque()
        self.link.send(Start(record=parameters.for_control(), shadow=shadow))

    @property
    def pid(self) -> int:
        """Process id."""
        return self._process.pid

    def ended(self) -> str | None:
        """Return how the process ended, None while it lives."""
        code = self._process.poll()
        if code is None:
            return None
        return f"killed by {signal.Signals(-code).name}" if code < 0 else f"exit {code}"

    def replies(self) -> list[Message]:
        """Return what the process has said since the last call.

        A packet that is no message becomes a line for the log: the service was updated in place
        and this process is of the new release. Messages that both know, bypass first, still pass.
        """
        messages: list[Message] = []
        while True:
            try:
                received = self.link.receive_passed()
            except MessageError as error:
                messages.append(LogLine(text=f"{error}; restart the service"))
                continue
            except LinkClosedError:
                return messages
            if received is None:
                return messages
            message, passed = received
            messages.append(message)
            if passed is not None:
                self._rings.append(passed)

    def open_ring(self) -> RingReader | None:
        """Return the oldest ring that it has made and nobody has looked at yet."""
        if not self._rings:
            return None
        descriptor = self._rings.popleft()
        try:
            return RingReader(Path(f"/dev/fd/{descriptor}"))
        finally:
            os.close(descriptor)

    def bypass_by_signal(self) -> None:
        """Ask for bypass the way that needs no link."""
        os.kill(self.pid, signal.SIGUSR1)

    def stop(self, *, patience_s: float) -> Ending:
        """Let it fade to zero and end; kill it after ``patience_s``; return how it ended."""
        self.link.send(Stop())
        try:
            self._process.wait(patience_s)
        except subprocess.TimeoutExpired:
            self._process.kill()  # the heartbeat stops: the PLC ramps its copy to zero
            self._process.wait()
            return Ending.BADLY
        if self._process.returncode == EXIT_UNHEARD:
            return Ending.UNHEARD
        return Ending.ZERO if self._process.returncode == 0 else Ending.BADLY

    def kill(self) -> None:
        """End a process that never began to tick."""
        self._process.kill()

    def close(self) -> None:
        """Release the link of a process that has ended."""
        self.link.close()
        while self._rings:
            os.close(self._rings.popleft())
