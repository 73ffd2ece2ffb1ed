"""The supervisor: starts and watches the other processes, answers requests, follows the file.

It is a normal process and may log, parse and wait. Nothing it does can move the correction but
through the control process, and its own death makes that one fade to zero.
"""

from __future__ import annotations

import logging
import os
import selectors
import signal
from collections.abc import Mapping
from typing import Any

from aff_runtime.app.link.request_socket import Caller, RequestSocket
from aff_runtime.app.report.status import describe
from aff_runtime.app.supervisor.crossing_forecast import CrossingForecast
from aff_runtime.app.supervisor.edit_session import EditSession
from aff_runtime.app.supervisor.pending import Answer, Pending
from aff_runtime.app.supervisor.probe_session import ProbeSession
from aff_runtime.app.supervisor.processes import Processes
from aff_runtime.app.supervisor.run_options import RunOptions
from aff_runtime.app.supervisor.state_log import StateLog
from aff_runtime.app.supervisor.validation import load_record
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import AffError, ConfigError, RefusedError
from aff_runtime.base.signals import State
from aff_runtime.loop.watchdog import ServiceNotifier

POLL_S = 0.1
EXIT_ALARM = 5
LOG = logging.getLogger("aff_runtime")


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
        verdict = load_record(options.site, options.state_directory)
        self._requests = RequestSocket(options.paths.socket)
        self._clock = MonotonicClock()
        self._notifier = ServiceNotifier(os.environ, every_ticks=1)
        self._selector = selectors.DefaultSelector()
        self._selector.register(self._requests.listener, selectors.EVENT_READ)
        self._pending = Pending(self._clock)
        self._processes = Processes(
            options, verdict.record or {}, self._clock, on_change=self._watch_link
        )
        self._states = StateLog()
        self._forecast = CrossingForecast()
        self._link_fd: int | None = None
        self._edits = EditSession(self._processes, self._pending, options, verdict)
        self._probe: ProbeSession | None = None
        self._stop_callers: list[Caller] = []
        self._stopping = False
        self._stopped_by = ""
        self._forget = options.forget
        self._told_ready = False
        self._exit_code = 0

    def run(self) -> int:
        """Serve until stopped; return the exit code."""
        signal.signal(signal.SIGTERM, lambda *_: self._stop(why="SIGTERM"))
        signal.signal(signal.SIGINT, lambda *_: self._stop(why="SIGINT (ctrl-c)"))
        signal.signal(signal.SIGUSR1, lambda *_: self._processes.bypass())
        for finding in self._edits.findings:
            LOG.warning("%s", finding)
        if self._forget:
            self._processes.shapes.forget(self._processes.record)
        try:
            self._processes.start()
            while not self._stopping:
                self._serve(POLL_S)
                self._look_after()
        finally:
            self._shut_down()
        return self._exit_code

    # --- one round --------------------------------------------------------------------------

    def _serve(self, timeout_s: float) -> None:
        """Wait for callers and for the control process, and hear them."""
        for key, _ in self._selector.select(timeout_s):
            if key.fileobj is self._requests.listener:
                caller = self._requests.accept()
                if caller is not None:
                    self._selector.register(caller.connection, selectors.EVENT_READ, caller)
                surplus = self._requests.surplus()
                if surplus is not None:
                    self._hang_up(surplus)
            elif isinstance(key.data, Caller):
                if self._requests.callers.get(key.fd) is key.data:
                    self._hear(key.data)
            else:
                self._hear_control()

    def _look_after(self) -> None:
        """Do what time brings: children, edits, waiting callers, probe, watchdog."""
        self._pending.expire()
        latest = self._processes.latest()
        if not self._stopping:  # the way to zero is told as what it is
            self._states.step(latest)
        self._forecast.step(self._processes.record, latest)
        if self._processes.watch():
            self._pending.refuse_all("the control process died; see the log")
            self._end_probe("the control process died")
        if self._processes.gave_up:
            self._stop(EXIT_ALARM)
        self._edits.step()
        if self._probe is not None and self._probe.has_answered():
            self._probe = None
        if self._told_ready and self._processes.ring is None:
            self._notifier.tick_done(True)  # nothing goes out before the first tick

    def _hear_control(self) -> None:
        """Take what the control process says."""
        control = self._processes.control
        for message in control.replies() if control is not None else []:
            did = message.get("did")
            if did == "RING":
                self._processes.take_ring()
                self._states.restart()
                self._greet(message)
            elif did == "BLOCKED":
                self._processes.blocked = str(message["text"])
            elif did == "WIRE":
                self._processes.troubles = [str(text) for text in message["troubles"]]
            elif did == "PROBED" and self._probe is not None:
                self._probe.finish(message)
            elif did == "LOG":
                LOG.warning("control: %s", message.get("text", ""))
            elif not self._processes.shapes.hear(self._processes.record, message):
                self._pending.resolve(message)

    def _greet(self, message: dict[str, Any]) -> None:
        """Log real-time rights and tell the service manager, once."""
        if self._told_ready:
            return
        self._told_ready = True
        for right in message.get("rights", []):
            LOG.log(logging.INFO if right["granted"] else logging.WARNING, "%s", right["text"])
        self._notifier.tick_done(True)
        LOG.info("ready; `aff-runtime arm` enables the correction")

    def _watch_link(self) -> None:
        """Watch the link of the present control process."""
        if self._link_fd is not None:
            self._selector.unregister(self._link_fd)
            self._link_fd = None
        if self._processes.control is not None:
            self._link_fd = self._processes.control.link.fileno()
            self._selector.register(self._link_fd, selectors.EVENT_READ)

    # --- requests ---------------------------------------------------------------------------

    def _hear(self, caller: Caller) -> None:
        """Answer what one caller asks."""
        requests = caller.requests()
        if requests is None:
            self._hang_up(caller)
            return
        self._requests.heard(caller)
        for request in requests:
            try:
                self._answer(caller, request)
            except AffError as error:
                caller.reply({"ok": False, "message": str(error), "exit_code": error.exit_code})

    def _hang_up(self, caller: Caller) -> None:
        """Let go of one caller."""
        self._selector.unregister(caller.connection)
        self._pending.forget(caller)
        self._requests.drop(caller)

    def _answer(self, caller: Caller, request: dict[str, Any]) -> None:
        """Do what one request asks, or say why not."""
        match request.get("do"):
            case "status":
                caller.reply(self._status())
            case "arm":
                self._processes.note("OPERATOR", "arm")
                self._ask_control({"do": "ARM"}, caller)
            case "shadow":
                on = bool(request.get("on", True))
                self._processes.note("OPERATOR", f"shadow {'on' if on else 'off'}")
                self._ask_control({"do": "SHADOW", "on": on}, caller)
            case "bypass":
                self._processes.bypass()
                caller.reply({"ok": True})
            case "forget":
                self._processes.note("OPERATOR", "forget")
                self._ask_control({"do": "FORGET"}, caller, self._forget_files)
            case "probe":
                self._start_probe(caller, request)
            case "stop":
                self._processes.note("OPERATOR", "stop")
                self._stop_callers.append(caller)
                self._stop()
            case other:
                raise RefusedError(
                    f"unknown request {other!r}; use arm, bypass, forget, shadow, status, probe "
                    "or stop"
                )

    def _forget_files(self, said: dict[str, Any]) -> dict[str, Any]:
        """Forget in the files too once the control process has; a refusal leaves them alone."""
        if said.get("ok"):
            try:
                self._processes.shapes.forget(self._processes.record)
            except ConfigError as error:
                return {"ok": False, "message": str(error), "exit_code": error.exit_code}
        return said

    def _ask_control(
        self, message: dict[str, Any], caller: Caller, answer: Answer = lambda said: said
    ) -> None:
        """Send ``message`` to the control process; ``answer`` to its reply goes to the caller."""
        control = self._processes.control
        ident = self._pending.expect(caller, answer, 2.0)
        if control is None or not control.link.send({**message, "id": ident}):
            text = "the control process is not running; see `aff-runtime status`"
            self._pending.resolve({"id": ident, "ok": False, "message": text})

    def _start_probe(self, caller: Caller, request: dict[str, Any]) -> None:
        """Have the control process measure; the caller is answered when it is fitted."""
        control = self._processes.control
        if self._probe is not None or control is None:
            raise RefusedError("a probe is already under way" if control else "not running yet")
        actuators = _known(request.get("actuators", []), self._processes.record)
        self._probe = ProbeSession(self._processes, self._edits, caller)
        ident = self._pending.expect(None, self._probe_began, 2.0)
        self._processes.note("OPERATOR", f"probe {' '.join(actuators)}".strip())
        control.link.send({"do": "PROBE", "actuators": actuators, "id": ident})

    def _probe_began(self, said: dict[str, Any]) -> dict[str, Any]:
        """Tell the caller when the control process would not begin."""
        if not said.get("ok"):
            self._end_probe(str(said.get("message", "refused")))
        return said

    def _end_probe(self, reason: str) -> None:
        """Tell the caller of a probe that it came to nothing."""
        if self._probe is not None:
            self._probe.finish({"error": reason})
            self._probe.has_answered()
            self._probe = None

    def _status(self) -> dict[str, Any]:
        """Return the answer to a status request."""
        processes = self._processes
        answer: dict[str, Any] = {
            "ok": True,
            "line": processes.record["site"]["line"]["name"],
            "config_hash": processes.record["config_hash"],
            "config_differs": list(self._edits.differs),
            "control_pid": processes.control.pid if processes.control is not None else 0,
            "state": "STARTING" if processes.control is not None else State.FAULT.name,
            "recorder": processes.recorder_report(),
            "probing": self._probe is not None,
            "shapes": list(processes.shapes.words),
            "crossings": self._forecast.words(),
        }
        latest = processes.latest()
        if processes.ring is not None and latest is not None:
            answer.update(
                describe(latest, processes.record["permissives"], processes.record["site"])
            )
            answer["wire"] = processes.troubles
            answer["blocked_by"] = processes.blocked.removeprefix("blocked by ")
            answer["meta"] = processes.ring.header["meta"]
        return answer

    # --- the end ----------------------------------------------------------------------------

    def _stop(self, exit_code: int = 0, why: str = "") -> None:
        """Leave the main loop; ``why``: the signal that asked for it."""
        self._stopping = True
        self._stopped_by = self._stopped_by or why
        self._exit_code = exit_code

    def _shut_down(self) -> None:
        """Fade out, flush, tell the callers, remove the socket."""
        self._notifier.stopping()
        self._end_probe("the service stops")
        self._edits.close()
        if self._stopped_by:
            LOG.info("%s: the correction fades to zero, the service ends", self._stopped_by)
        zero = self._processes.finish()
        for caller in self._stop_callers:
            caller.reply({"ok": True})
        self._selector.close()
        self._requests.close()
        self._notifier.close()
        LOG.info("stopped%s", "; the correction reached zero" if zero else "")


def _known(names: object, record: Mapping[str, Any]) -> list[str]:
    """Return the names of actuators in a request, or refuse what names none of the site's."""
    actuators = record["site"]["actuators"]
    if not isinstance(names, list):
        raise RefusedError("actuators: a list of names is needed")
    for name in names:
        if not isinstance(name, str) or name not in actuators:
            known = ", ".join(actuators)
            raise RefusedError(f"no actuator {name!a} in the site file; there are {known}")
    return names
