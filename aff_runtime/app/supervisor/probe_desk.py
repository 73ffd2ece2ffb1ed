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

BEGIN_PATIENCE_S = 2.0
MEASURED = "measured"


class Probes:
    """Begins a probe and looks after it.

    Parameters
    ----------
    edits, settings : hand new responses on; refuse while other settings are tried.

    Attributes
    ----------
    said : what came of the last one: ``measured``, why not, or nothing.
    """

    def __init__(
        self, processes: Processes, pending: Pending, edits: EditSession, settings: SettingsDesk
    ) -> None:
        self._processes = processes
        self._pending = pending
        self._edits = edits
        self._settings = settings
        self._session: ProbeSession | None = None
        self.said = ""

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
        self._session = ProbeSession(self._processes, self._edits, self._telling(tell))

        def answered(reply: Reply) -> Done:
            if not reply.ok:
                self.end(reply.message or "refused")
            began(reply)
            return as_answer(reply)

        ident = self._pending.expect(None, answered, BEGIN_PATIENCE_S)
        control.link.send(MeasureResponse(id=ident, actuators=tuple(actuators), louder=louder))

    def begin_by_hand(self, began: Callable[[Reply], None], *, louder: bool = False) -> None:
        """Probe every actuator for a screen, which sees what comes of it in the status.

        Raises
        ------
        RefusedError
            As `begin`.
        """
        self.begin((), lambda done: None, began, louder=louder)

    def finish(self, probed: Probed) -> None:
        """Take what was measured."""
        if self._session is not None:
            self._session.finish(probed)

    def end(self, reason: str) -> None:
        """Tell who asked that it came to nothing."""
        if self._session is not None:
            self._session.finish(Probed(error=reason))
            self._session.has_answered()
            self._session = None

    def step(self) -> None:
        """Let go of one that has answered."""
        if self._session is not None and self._session.has_answered():
            self._session = None

    def _telling(
        self, tell: Callable[[Done | ProbeDone], None]
    ) -> Callable[[Done | ProbeDone], None]:
        def told(done: Done | ProbeDone) -> None:
            self.said = MEASURED if done.ok else getattr(done, "message", "")
            tell(done)

        return told
