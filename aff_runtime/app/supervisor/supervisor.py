"""The supervisor: starts and watches the other processes, answers requests, follows the file.

It is a normal process and may log, parse and wait. Nothing it does can move the correction but
through the control process, and its own death makes that one fade to zero.
"""

from __future__ import annotations

import logging
import os
import selectors
import signal
from collections.abc import Sequence
from functools import partial

from aff_runtime.app.hand.may import OF_SETTINGS, Circumstances
from aff_runtime.app.link.answers import Answer, Done, as_answer, refusal
from aff_runtime.app.link.messages import (
    Arm,
    Blocked,
    Forget,
    LogLine,
    Message,
    Probed,
    Question,
    RingMade,
    Shadow,
    WireTroubles,
)
from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.app.link.replies import Reply
from aff_runtime.app.link.request_socket import Asked, RequestSocket
from aff_runtime.app.report.command_counts import CommandTally, Result, Via
from aff_runtime.app.supervisor.control_child import Ending
from aff_runtime.app.supervisor.door import Door
from aff_runtime.app.supervisor.edit_session import EditSession
from aff_runtime.app.supervisor.file_watch import FileWatch
from aff_runtime.app.supervisor.hand.opening import open_hand
from aff_runtime.app.supervisor.meeting_forecast import MeetingForecast
from aff_runtime.app.supervisor.pending import AnswerOf, Pending
from aff_runtime.app.supervisor.probe_desk import ProbeDesk
from aff_runtime.app.supervisor.processes import DIED, STOPS, Processes
from aff_runtime.app.supervisor.request_desk import RequestDesk
from aff_runtime.app.supervisor.run_options import RunOptions
from aff_runtime.app.supervisor.settings.desk import SettingsDesk
from aff_runtime.app.supervisor.standing import Standing
from aff_runtime.app.supervisor.state_log import StateLog
from aff_runtime.app.supervisor.validation import load_parameters
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import ConfigError, RefusedError
from aff_runtime.loop.watchdog import ServiceNotifier

POLL_S = 0.1
EXIT_ALARM = 5
COUNTED = ("arm", "bypass", "shadow", "forget", "probe", "stop")
"""Requests that command something; of those about settings, what is tried, kept or undone."""
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
        watch = FileWatch([options.site])  # before the check: it may take its time
        result = load_parameters(options.site, options.state_directory)
        requests = RequestSocket(options.paths.socket)
        self._clock = MonotonicClock()
        self._notifier = ServiceNotifier(os.environ, every_ticks=1)
        self._selector = selectors.DefaultSelector()
        self._pending = Pending(self._clock)
        folder = options.door_directory
        self._door = Door(
            folder or options.paths.directory,
            self._selector,
            self._clock,
            is_private=folder is None,
        )
        self._desk = RequestDesk(
            requests, self._selector, self._serve_request, self._pending.forget
        )
        self._processes = Processes(
            *(options, result.checked(), self._clock),
            on_change=self._watch_link,
            hear=self._hear,
            on_end=self._control_ended,
        )
        self._states = StateLog()
        self._forecast = MeetingForecast()
        self._link_fd: int | None = None
        self._edits = EditSession(
            self._processes, self._pending, options.site, result, options.state_directory, watch
        )
        self._settings = SettingsDesk(
            self._processes, self._edits, options, self._clock, self._circumstances
        )
        self._probes = ProbeDesk(
            self._processes, self._pending, self._edits, self._settings, self._clock
        )
        self._counts = CommandTally()
        self._hand = open_hand(
            *(options, self._selector, self._clock, self._processes, self._pending, self._probes),
            self._counts,
        )
        self._standing = Standing(
            *(self._processes, self._edits, self._settings, self._probes, self._forecast),
            self._counts,
            self._hand,
            hand_is_wanted=options.hand is not None,
        )
        self._stop_asked: list[Asked] = []
        self._stopping = False
        self._stopped_by = ""
        self._forget = options.forget
        self._ready_announced = False
        self._exit_code = 0

    def run(self) -> int:
        """Serve until stopped; return the exit code."""
        signal.signal(signal.SIGTERM, lambda *_: self._stop(why="SIGTERM"))
        signal.signal(signal.SIGINT, lambda *_: self._stop(why="SIGINT (ctrl-c)"))
        if signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN:  # ignored: by nohup
            signal.signal(signal.SIGHUP, lambda *_: self._stop(why="SIGHUP (terminal closed)"))
        signal.signal(signal.SIGUSR1, lambda *_: self._bypass_by_signal())
        for finding in self._edits.findings:
            LOG.warning("%s", finding)
        if self._forget:
            self._processes.shapes.forget(self._processes.parameters)
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
        for key, events in self._selector.select(timeout_s):
            if self._desk.serve(key, events) or self._door.serve(key):
                continue
            if self._hand is None or not self._hand.serve(key):
                self._hear_control()

    def _look_after(self) -> None:
        """Do what time brings: children, edits, waiting callers, probe, watchdog."""
        self._pending.expire()
        latest = self._processes.latest()
        if not self._stopping:  # the way to zero is told as what it is
            self._states.step(latest)
        self._forecast.step(self._processes.parameters, latest)
        if self._processes.watch():
            self._settings.control_died()
        if self._processes.gave_up:
            self._stop(EXIT_ALARM)
        self._settings.step(latest)
        self._edits.step()
        self._probes.step()
        self._desk.look_after()
        if self._hand is not None:
            self._hand.step()
        self._door.step(self._processes.ring, self._standing.facts)
        if self._ready_announced and self._processes.ring is None:
            self._notifier.tick_done(True)  # nothing goes out before the first tick

    def _hear_control(self) -> None:
        """Take what the control process says."""
        control = self._processes.control
        for message in control.replies() if control is not None else []:
            self._hear(message)

    def _hear(self, message: Message) -> None:
        """Take one message of it."""
        match message:
            case RingMade():
                self._processes.take_ring()
                self._states.restart()
                self._announce_ready(message)
            case Blocked():
                self._processes.blocked = message.text
                self._processes.also_blocking = message.others
                self._door.hurry()
            case WireTroubles():
                self._processes.troubles = message.troubles
            case Probed():
                self._probes.finish(message)
            case LogLine():
                LOG.warning("control: %s", message.text)
            case Reply():
                self._pending.resolve(message)
            case _:
                self._processes.shapes.hear(self._processes.parameters, message)

    def _control_ended(self, why: str) -> None:
        """Answer what one was asked that is gone, and has been heard to its end; once and for all.

        Whoever reads the audit finds what became of everything that was asked.
        """
        self._probes.end(why)
        self._pending.refuse_all(f"{why}; see the log" if why == DIED else why)

    def _announce_ready(self, made: RingMade) -> None:
        """Log real-time rights and tell the service manager, once."""
        if self._ready_announced:
            return
        self._ready_announced = True
        for right in made.rights:
            LOG.log(logging.INFO if right.granted else logging.WARNING, "%s", right.text)
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

    def _serve_request(self, asked: Asked) -> None:
        """Do what one request asks, or say why not."""
        request = asked.request
        if request.do in COUNTED:
            asked.then = partial(self._count, request.do)
        match request.do:
            case "status":
                asked.answer(self._standing.status())
            case "arm":
                self._note_command(asked)
                self._ask_control(Arm(), asked)
            case "shadow":
                self._note_command(asked, "on" if request.on else "off")
                self._ask_control(Shadow(on=request.on), asked)
            case "bypass":
                self._processes.bypass()
                self._note_command(asked)
                asked.answer(Done())
            case "forget":
                self._note_command(asked, *request.rolls)
                forget = partial(self._forget_files, request.rolls)
                self._ask_control(Forget(rolls=request.rolls), asked, forget)
            case "probe":
                self._start_probe(asked)
            case "settings":
                self._change_settings(asked)
            case "stop":
                self._note_command(asked)
                self._stop_asked.append(asked)
                self._stop()

    def _count(self, action: str, answer: Answer) -> None:
        """Count a command of the console with its answer."""
        is_done = not isinstance(answer, Done) or answer.ok
        self._counts.add(action, Via.CLI, Result.DONE if is_done else Result.REFUSED)

    def _note_command(self, asked: Asked, *details: str) -> None:
        """Put on record who commands what."""
        said = " ".join((asked.request.do, *details))
        self._processes.note_operator(said, asked.who)

    def _forget_files(self, rolls: tuple[str, ...], reply: Reply) -> Done:
        """Forget in the files too once the control process has; a refusal leaves them alone."""
        if reply.ok:
            processes = self._processes
            try:
                said = processes.shapes.forget(processes.parameters, rolls, reply.rolls)
            except ConfigError as error:
                return refusal(error)
            return Done(message=said)
        return as_answer(reply)

    def _ask_control(self, question: Question, asked: Asked, answer: AnswerOf = as_answer) -> None:
        """Put a question to the control process; ``answer`` to its reply goes to the caller."""
        self._pending.ask(self._processes.control, question, answer, asked=asked)

    def _change_settings(self, asked: Asked) -> None:
        """Have the settings' desk do what is asked; what only looks is not put on record."""
        act = asked.request.settings.act if asked.request.settings is not None else ""
        if act in OF_SETTINGS:
            self._note_command(asked, act)
            asked.then = partial(self._count, f"settings-{act}")
        self._settings.do(asked)

    def _circumstances(self) -> Circumstances:
        """Return what ``may`` has to know of the service for a try of settings."""
        latest, fresh = self._processes.latest(), self._processes.fresh()
        return Circumstances(
            state=fresh.state if fresh is not None else None,
            remote=latest is not None and latest.is_remote,
            probing=self._probes.is_under_way,
        )

    def _start_probe(self, asked: Asked) -> None:
        """Have the control process measure; the caller is answered when it is fitted."""
        actuators = _known(asked.request.actuators, self._processes.parameters)
        self._probes.begin(actuators, asked.answer, louder=asked.request.louder)
        self._note_command(asked, *actuators)

    def _bypass_by_signal(self) -> None:
        """Take the correction back; a signal does not tell who sent it."""
        self._processes.bypass()
        self._counts.add("bypass", Via.SIGNAL, Result.DONE)
        self._processes.note_operator("bypass", "SIGUSR1; who sent it is not known")

    # --- the end ----------------------------------------------------------------------------

    def _stop(self, exit_code: int = 0, why: str = "") -> None:
        """Leave the main loop; ``why``: the signal that asked for it."""
        self._stopping = True
        self._stopped_by = self._stopped_by or why
        self._exit_code = exit_code

    def _shut_down(self) -> None:
        """Fade out, flush, tell the callers, remove the socket."""
        self._notifier.stopping()
        self._settings.close()
        if self._stopped_by:
            LOG.info("%s: the correction fades to zero, the service ends", self._stopped_by)
        ending = self._processes.finish()
        if ending not in {Ending.ZERO, None}:
            self._exit_code = self._exit_code or EXIT_ALARM
        self._probes.close(STOPS)
        self._edits.close()
        for asked in self._stop_asked:
            asked.answer(Done())
        self._desk.close()
        self._door.close()
        if self._hand is not None:
            self._hand.close()
        self._selector.close()  # after those who are registered with it
        self._notifier.close()
        LOG.info("stopped%s", "; the correction reached zero" if ending is Ending.ZERO else "")


def _known(names: Sequence[str], parameters: ParameterRecord) -> list[str]:
    """Return the names of actuators in a request, or refuse what names none of the site's."""
    actuators = parameters.site.actuators
    for name in names:
        if name not in actuators:
            known = ", ".join(actuators)
            raise RefusedError(f"no actuator {name[:60]!a} in the site file; there are {known}")
    return list(names)
