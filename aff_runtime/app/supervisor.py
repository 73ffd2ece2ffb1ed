"""The supervisor: starts and watches the other processes, answers requests, follows the file.

It is a normal process and may log, parse and wait. Nothing it does can move the correction but
through the control process, and its own death makes that one fade to zero.
"""

from __future__ import annotations

import logging
import selectors
import signal
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from aff_runtime.app.control_child import ControlChild
from aff_runtime.app.edit_session import EditSession
from aff_runtime.app.notify import Notifier
from aff_runtime.app.pending import Pending
from aff_runtime.app.probe_session import ProbeSession
from aff_runtime.app.recorder_child import RecorderChild
from aff_runtime.app.request_socket import Caller, RequestSocket
from aff_runtime.app.restart_policy import RestartPolicy
from aff_runtime.app.runtime_directory import RuntimePaths
from aff_runtime.app.status import LIVE_STATES, describe
from aff_runtime.app.validation import Verdict, load_record
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import AffError, RefusedError
from aff_runtime.base.signals import State
from aff_runtime.telemetry.ring import RingReader

POLL_S = 0.1
STOP_PATIENCE_S = 3.0
RECORDER_PATIENCE_S = 5.0
EXIT_ALARM = 5
LOG = logging.getLogger("aff_runtime")


@dataclass(frozen=True, slots=True, kw_only=True)
class RunOptions:
    """What the command line says about a run."""

    site: Path
    paths: RuntimePaths
    record_directory: Path | None = None
    shadow: bool = False


class Supervisor:
    """One running service.

    Raises
    ------
    ConfigError
        When the site file is not good.
    RefusedError
        When another service runs in the same runtime directory.
    """

    def __init__(self, options: RunOptions) -> None:
        verdict = load_record(options.site)
        self._options = options
        self.record: dict[str, Any] = verdict.record or {}
        self._requests = RequestSocket(options.paths.socket)
        self._clock = MonotonicClock()
        self._notifier = Notifier()
        self._policy = RestartPolicy()
        self._selector = selectors.DefaultSelector()
        self._selector.register(self._requests.listener, selectors.EVENT_READ)
        self.pending = Pending(self._clock)
        self.control: ControlChild | None = None
        self.ring: RingReader | None = None
        self._recorder: RecorderChild | None = None
        self._old_recorders: list[RecorderChild] = []
        self._restart_at_ns: int | None = None
        self._told_ready = False
        self._stop_callers: list[Caller] = []
        self._stopping = False
        self._exit_code = 0
        self.edits = EditSession(self, options.site, verdict)
        self.probe: ProbeSession | None = None

    # --- life -------------------------------------------------------------------------------

    def run(self) -> int:
        """Serve until stopped; return the exit code."""
        signal.signal(signal.SIGTERM, self._on_stop_signal)
        signal.signal(signal.SIGINT, self._on_stop_signal)
        signal.signal(signal.SIGUSR1, lambda *_: self._bypass_now())
        for finding in self.edits.findings:
            LOG.warning("%s", finding)
        try:
            self.start_control()
            while not self._stopping:
                self._serve(POLL_S)
                self._look_after()
        finally:
            self._shut_down()
        return self._exit_code

    def start_control(self) -> None:
        """Start the control process and wait for its first words in the main loop."""
        self._restart_at_ns = None
        self.control = ControlChild(
            self.record, self._options.paths.ring, shadow=self._options.shadow
        )
        self._selector.register(self.control.link, selectors.EVENT_READ)
        LOG.info("control process %d started", self.control.pid)

    def stop_control(self) -> None:
        """Let the control process fade and end, and the recorder flush."""
        if self.control is not None:
            self._selector.unregister(self.control.link)
            if not self.control.stop(patience_s=STOP_PATIENCE_S):
                LOG.error("control process %d did not stop and was killed", self.control.pid)
            self.control.close()
            self.control = None
        self._release_ring()

    def stop(self, exit_code: int = 0) -> None:
        """Leave the main loop."""
        self._stopping = True
        self._exit_code = exit_code

    def note(self, name: str, text: str) -> None:
        """Put a line into the log and into the record's events."""
        LOG.info("%s: %s", name, text)
        if self._recorder is not None:
            self._recorder.note(name, text)

    # --- one round --------------------------------------------------------------------------

    def _serve(self, timeout_s: float) -> None:
        """Wait for callers and for the control process, and hear them."""
        for key, _ in self._selector.select(timeout_s):
            if key.fileobj is self._requests.listener:
                caller = self._requests.accept()
                if caller is not None:
                    self._selector.register(caller.connection, selectors.EVENT_READ, caller)
            elif isinstance(key.data, Caller):
                self._hear(key.data)
            else:
                self._hear_control()

    def _look_after(self) -> None:
        """Do what time brings: children, edits, waiting callers, probe, watchdog."""
        self.pending.expire()
        self._watch_control()
        self.edits.step()
        if self.probe is not None and self.probe.step():
            self.probe = None
        if self.control is None:
            self._notifier.send(b"WATCHDOG=1")  # zero goes out while there is no control process
            due = self._restart_at_ns is not None and self._clock.now_ns() >= self._restart_at_ns
            if due:
                self.start_control()
        self._old_recorders = [r for r in self._old_recorders if r.report()["alive"]]

    def _watch_control(self) -> None:
        """Notice the death of the control process and decide whether it may come back."""
        if self.control is None or (how := self.control.ended()) is None:
            return
        pid = self.control.pid
        self._selector.unregister(self.control.link)
        self._hear_control()
        self.control.close()
        self.control = None
        self.pending.refuse_all("the control process died; see the log")
        pause_s = self._policy.died(self._clock.now_ns() * 1e-9)
        self.note("CONTROL_DIED", f"control process {pid}: {how}; the PLC ramps to zero")
        self._release_ring()
        if pause_s is None:
            LOG.error("the control process died three times within 60 s; giving up")
            self.stop(EXIT_ALARM)
            return
        LOG.warning("control restarts idle in %.1f s; it needs an operator's arm", pause_s)
        self._restart_at_ns = self._clock.now_ns() + int(pause_s * 1e9)

    def _hear_control(self) -> None:
        """Take the replies of the control process."""
        if self.control is None:
            return
        for message in self.control.replies():
            if message.get("did") == "RING":
                self._take_ring(message)
            elif message.get("did") == "LOG":
                LOG.warning("control: %s", message.get("text", ""))
            else:
                self.pending.resolve(message)

    def _take_ring(self, message: dict[str, Any]) -> None:
        """Follow the ring that the control process has just made; begin a new record."""
        self._release_ring()
        self.ring = RingReader(self._options.paths.ring)
        site = self.record["site"]
        recording = site["recording"]
        directory = self._options.record_directory
        if directory is None:
            directory = self._options.site.absolute().parent / recording["directory"]
        context = {
            "name": site["line"]["name"],
            "site_file": str(self._options.site.absolute()),
            "config_hash": self.record["config_hash"],
            "versions": self.record["versions"],
            "max_MB": recording["max_MB"],
            "segment_s": recording["segment_s"],
            "site_text": self.record["site_text"],
        }
        self._recorder = RecorderChild(self._options.paths.ring, directory, context)
        for right in message.get("rights", []):
            LOG.log(logging.INFO if right["granted"] else logging.WARNING, "%s", right["text"])
        if not self._told_ready:
            self._told_ready = True
            self._notifier.send(b"READY=1\nSTATUS=running, needs an operator's arm")
            LOG.info("ready: `aff-runtime arm` enables the correction")

    def _release_ring(self) -> None:
        """Let go of the ring; its recorder ends by itself when everything is written."""
        if self.ring is not None:
            self.ring.close()
            self.ring = None
        if self._recorder is not None:
            self._old_recorders.append(self._recorder)
            self._recorder = None

    # --- requests ---------------------------------------------------------------------------

    def _hear(self, caller: Caller) -> None:
        """Answer what one caller asks."""
        requests = caller.requests()
        if requests is None:
            self._selector.unregister(caller.connection)
            self.pending.forget(caller)
            self._requests.drop(caller)
            return
        for request in requests:
            try:
                self._answer(caller, request)
            except AffError as error:
                caller.reply({"ok": False, "message": str(error), "exit_code": error.exit_code})

    def _answer(self, caller: Caller, request: dict[str, Any]) -> None:
        """Do what one request asks, or say why not."""
        do = str(request.get("do", ""))
        if do == "status":
            self.ask_control({"do": "WHY"}, caller, self.status, patience_s=0.5)
        elif do in ("arm", "shadow"):
            self._require_control()
            self.note("OPERATOR", do)
            message = {"do": do.upper(), "on": bool(request.get("on", True))}
            self.ask_control(message, caller, lambda said: _as_answer(said))
        elif do == "bypass":
            self._bypass_now()
            caller.reply({"ok": True})
        elif do == "probe":
            self._require_control()
            if self.probe is not None:
                raise RefusedError("a probe is already under way")
            self.probe = ProbeSession(self, caller, request)
        elif do == "stop":
            self.note("OPERATOR", "stop")
            self._stop_callers.append(caller)
            self.stop()
        else:
            raise RefusedError(f"unknown request {do!r}; use arm, bypass, shadow, status, stop")

    def ask_control(
        self,
        message: dict[str, Any],
        caller: Caller | None,
        answer: Callable[[dict[str, Any]], dict[str, Any]],
        *,
        patience_s: float = 2.0,
    ) -> None:
        """Send ``message`` to the control process; its reply, put through ``answer``, goes back.

        Without a reply in time ``answer`` is given ``{"ok": False, "message": ...}``.
        """
        ident = self.pending.expect(caller, answer, patience_s)
        if self.control is None or not self.control.link.send({**message, "id": ident}):
            self.pending.resolve(
                {"id": ident, "ok": False, "message": "the control process is not running"}
            )

    def status(self, why: dict[str, Any]) -> dict[str, Any]:
        """Return the answer to a status request; ``why`` is the control process's own word."""
        answer: dict[str, Any] = {
            "ok": True,
            "line": self.record["site"]["line"]["name"],
            "config_hash": self.record["config_hash"],
            "config_differs": list(self.edits.differs),
            "control": "running" if self.control is not None else "restarting",
            "control_pid": self.control.pid if self.control is not None else 0,
            "state": "STARTING",
            "recorder": self._recorder.report() if self._recorder is not None else {},
            "probe": self.probe.progress() if self.probe is not None else "",
        }
        latest = self.ring.status() if self.ring is not None else None
        if self.ring is not None and latest is not None:
            answer.update(describe(latest, self.record["permissives"]))
            answer["meta"] = self.ring.header["meta"]
            answer["blocked_by"] = str(why.get("blocked_by", answer["blocked_by"]))
            answer["objections"] = why.get("objections", [])
        if self.control is None:
            answer["state"] = State.FAULT.name
        return answer

    def is_live(self) -> bool:
        """Return whether a correction may be going out."""
        latest = self.ring.status() if self.ring is not None else None
        return latest is not None and State(int(latest["state"])) in LIVE_STATES

    def _require_control(self) -> None:
        """Refuse what needs a running control process when there is none."""
        if self.control is None or self.ring is None:
            raise RefusedError("the control process is not running yet; see `aff-runtime status`")

    def _bypass_now(self) -> None:
        """Take the correction back, by link and by signal: one of them works."""
        if self.control is not None:
            self.note("OPERATOR", "bypass")
            self.control.link.send({"do": "BYPASS"})
            if self.control.ended() is None:
                self.control.bypass_by_signal()

    def _on_stop_signal(self, number: int, _frame: object) -> None:
        """Leave the main loop on SIGTERM and SIGINT."""
        self.stop()

    def _shut_down(self) -> None:
        """Fade out, flush, tell the callers, remove the socket."""
        self._notifier.send(b"STOPPING=1")
        self.edits.close()
        self.stop_control()
        for recorder in self._old_recorders:
            recorder.wait(RECORDER_PATIENCE_S)
        for caller in self._stop_callers:
            caller.reply({"ok": True})
        self._selector.close()
        self._requests.close()
        self._options.paths.ring.unlink(missing_ok=True)
        self._notifier.close()
        LOG.info("stopped")


def _as_answer(said: dict[str, Any]) -> dict[str, Any]:
    """Return the control process's word as an answer to a caller."""
    return {**said, "exit_code": RefusedError.exit_code}
