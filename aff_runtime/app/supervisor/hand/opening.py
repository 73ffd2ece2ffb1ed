"""The service as a screen reaches it, and the hand opened over it where a command line asks."""

from __future__ import annotations

import logging
import selectors
from collections.abc import Callable
from dataclasses import replace

from aff_runtime.app.hand.audit import Audit
from aff_runtime.app.link.answers import Done, as_answer
from aff_runtime.app.link.messages import Arm, Forget, Question, Shadow
from aff_runtime.app.link.replies import Reply
from aff_runtime.app.report.command_counts import CommandTally
from aff_runtime.app.supervisor.hand.desk import HandDesk, HandRules
from aff_runtime.app.supervisor.hand.entries import ServiceState
from aff_runtime.app.supervisor.pending import Pending
from aff_runtime.app.supervisor.probe_desk import ProbeDesk
from aff_runtime.app.supervisor.processes import Processes
from aff_runtime.app.supervisor.run_options import RunOptions
from aff_runtime.app.supervisor.settings.history import kept_folder
from aff_runtime.base.errors import ConfigError, RefusedError
from aff_runtime.base.ports import Clock
from aff_runtime.config.revision import SHORT

LOG = logging.getLogger("aff_runtime")


class ServiceEnd:
    """What a screen reaches of the service: its state, and the questions that the hand may ask.

    Parameters
    ----------
    probes : begins a probe, and says whether one is under way.
    """

    def __init__(self, processes: Processes, pending: Pending, probes: ProbeDesk) -> None:
        self._probes = probes
        self._processes = processes
        self._pending = pending

    def now(self) -> ServiceState:
        """Return how the service stands."""
        processes = self._processes
        latest = processes.latest() if processes.control is not None else None
        fresh = processes.fresh()
        return ServiceState(
            remote=latest is not None and latest.is_remote,
            state=fresh.state if fresh is not None else None,
            blocked=processes.blocked,
            also_blocking=processes.also_blocking,
            tick=int(latest.number("tick")) if latest is not None else 0,
            config=processes.parameters.config_hash[:SHORT],
            bypassed_ns=processes.bypassed_ns,
            probing=self._probes.is_under_way,
        )

    def bypass(self) -> None:
        """Take the correction back."""
        self._processes.bypass()

    def arm(self, answer: Callable[[Reply], None]) -> None:
        """Ask the control process to arm."""
        self._ask(Arm(), answer)

    def shadow(self, on: bool, answer: Callable[[Reply], None]) -> None:
        """Ask the control process to begin or end shadow operation."""
        self._ask(Shadow(on=on), answer)

    def forget(self, answer: Callable[[Reply], None]) -> None:
        """Ask the control process to drop what it learned of exchanged rolls; the files follow."""

        def said(reply: Reply) -> None:
            try:
                text = reply.message
                if reply.ok:
                    shelf, parameters = self._processes.shapes, self._processes.parameters
                    text = shelf.forget(parameters, (), reply.rolls)
                answer(replace(reply, message=text))
            except ConfigError as error:
                answer(replace(reply, ok=False, message=str(error)))

        self._ask(Forget(), said)

    def _ask(self, question: Question, answer: Callable[[Reply], None]) -> None:
        """Put a question to the control process; ``answer`` is called once, now or later."""

        def said(reply: Reply) -> Done:
            answer(reply)
            return as_answer(reply)

        self._pending.ask(self._processes.control, question, said)

    def probe(self, answer: Callable[[Reply], None], *, louder: bool) -> None:
        """Ask the control process to probe every actuator, louder than the last time."""
        try:
            self._probes.begin_by_hand(answer, louder=louder)
        except RefusedError as error:
            answer(Reply(id=0, ok=False, message=str(error)))

    def note(self, text: str) -> None:
        """Put a sentence into the log and the record."""
        self._processes.note("SCREEN", text)


def open_hand(
    options: RunOptions,
    selector: selectors.BaseSelector,
    clock: Clock,
    processes: Processes,
    pending: Pending,
    probes: ProbeDesk,
    counts: CommandTally,
) -> HandDesk | None:
    """Return the hand of a service; None unless it was asked for and its audit can be kept.

    Raises
    ------
    RefusedError
        When the socket cannot be made.
    """
    if options.hand is None:
        return None
    try:
        audit = Audit(kept_folder(options.site, options.state_directory, "audit"))
    except RefusedError as error:
        LOG.error("no screen is heard until the audit can be kept: %s", error)
        return None
    folder = options.hand_directory
    return HandDesk(
        folder or options.paths.directory,
        selector,
        clock,
        is_private=folder is None,
        rules=HandRules(ceiling=options.hand, commands_from=options.hand_from),
        audit=audit,
        service=ServiceEnd(processes, pending, probes),
        counts=counts,
    )
