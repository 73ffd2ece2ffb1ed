"""Probes of the service: one at a time, whoever asks for it, and what came of the last one."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from aff_runtime.app.link.answers import Done, ProbeDone, as_answer
from aff_runtime.app.link.messages import MeasureResponse, Probed
from aff_runtime.app.link.replies import Reply
from aff_runtime.app.supervisor.edit_session import EditSession
from aff_runtime.app.supervisor.pending import Pending
from aff_runtime.app.supervisor.probe_session import ProbeSession
from aff_runtime.app.supervisor.processes import Processes
from aff_runtime.app.supervisor.settings.desk import SettingsDesk
from aff_runtime.base.errors import RefusedError
from aff_runtime.base.ports import Clock

FIT_PATIENCE_S = 30.0  # beside the probe's own time: the fit takes 0.1 s, on a busy machine longer
MEASURED = "measured"
NOT_HEARD = "nothing was heard of the probe in its time; probe again"


class ProbeDesk:
    """Begins a probe and looks after it.

    Parameters
    ----------
    edits, settings : hand new responses on; refuse while other settings are tried.

    Attributes
    ----------
    said : what came of the last one: ``measured``, why not, or nothing.
    """

    def __init__(
        self,
        processes: Processes,
        pending: Pending,
        edits: EditSession,
        settings: SettingsDesk,
        clock: Clock,
    ) -> None:
        self._processes = processes
        self._pending = pending
        self._edits = edits
        self._settings = settings
        self._clock = clock
        self._session: ProbeSession | None = None
        self._until_ns: int | None = None
        self.said = ""
        edits.is_measuring = self._is_measuring

    @property
    def is_under_way(self) -> bool:
        """Whether one is."""
        return self._session is not None

    def begin(
        self,
        actuators: Sequence[str],
        tell: Callable[[Done | ProbeDone], None],
        began: Callable[[Reply], None] = lambda reply: None,
        *,
        louder: bool = False,
    ) -> None:
        """Have the control process measure.

        Parameters
        ----------
        actuators : empty: all of them.
        tell : called once with what came of it. ``began`` : when it begins, or does not.
        louder : send twice what was sent for the responses in force, as far as the bound lets.

        Raises
        ------
        RefusedError
            One is under way, other settings are tried, or nothing runs.
        """
        control = self._processes.control
        if self._session is not None or control is None:
            raise RefusedError("a probe is already under way" if control else "not running yet")
        self._settings.refuse_while_trying()
        session = ProbeSession(self._processes, self._edits, self._telling(tell))
        self._session = session
        self._until_ns = None  # until it begins, the patience with the question holds

        def answered(reply: Reply) -> Done:
            if self._session is session and not reply.ok:
                self.end(reply.message or "refused")
            elif self._session is session:
                patience_s = (reply.duration_s or 0.0) + FIT_PATIENCE_S
                self._until_ns = self._clock.now_ns() + int(patience_s * 1e9)
            began(reply)
            return as_answer(reply)

        question = MeasureResponse(actuators=tuple(actuators), louder=louder)
        self._pending.ask(control, question, answered)

    def begin_by_hand(self, began: Callable[[Reply], None], *, louder: bool = False) -> None:
        """Probe every actuator for a screen, which sees what comes of it in the status.

        Raises
        ------
        RefusedError
            As `begin`.
        """
        self.begin((), lambda done: None, began, louder=louder)

    def finish(self, probed: Probed) -> None:
        """Take what was measured; what came first stands."""
        if self._session is not None and not self._session.is_finished:
            self._session.finish(probed)

    def end(self, reason: str) -> None:
        """Tell who asked that it came to nothing; one that has a result goes on to its answer."""
        if self._session is not None and not self._session.is_finished:
            self.close(reason)

    def close(self, reason: str) -> None:
        """Answer who asked, now: with what is known, else with the reason."""
        if self._session is not None:
            self._session.close(reason)
            self._session = None

    def step(self) -> None:
        """Let go of one that has answered, and of one whose result is lost."""
        if self._until_ns is not None and self._clock.now_ns() >= self._until_ns:
            self.end(NOT_HEARD)
        if self._session is not None and self._session.has_answered():
            self._session = None

    def _is_measuring(self) -> bool:
        """Whether a result is to come."""
        return self._session is not None and not self._session.is_finished

    def _telling(
        self, tell: Callable[[Done | ProbeDone], None]
    ) -> Callable[[Done | ProbeDone], None]:
        def told(done: Done | ProbeDone) -> None:
            self.said = MEASURED if done.ok else getattr(done, "message", "")
            tell(done)

        return told
