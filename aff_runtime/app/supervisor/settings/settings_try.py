"""Other settings for a while: applied between two ticks, and taken back unless they are kept.

The former settings are what the site file says all the while. So they return whatever ends: the
time, the console, the control process, or the service itself.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.app.link.replies import Reply
from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.app.supervisor.edit_session import EditSession
from aff_runtime.app.supervisor.processes import Processes
from aff_runtime.app.supervisor.settings.ripple_rise import RippleRise
from aff_runtime.base.ports import Clock

RETURN_TRIES = 3
"""So often the former settings are handed over before the control process is restarted."""
KEEP_GRACE_S = 10.0
"""A try that is being kept does not run out before the site file can be saved."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TryRequest:
    """What is to be tried.

    Attributes
    ----------
    parameters : the settings. ``who``, ``why`` : the caller, and the reason.
    findings : warnings of the check of their text.
    seconds : until the former ones return.
    """

    parameters: ParameterRecord
    seconds: float
    who: str
    why: str
    findings: tuple[str, ...] = ()


class SettingsTry:
    """One try, from the hand-over to its end.

    Parameters
    ----------
    ripple : the error signals recorded until now.
    ended : called once when the former settings run again, with the reason.

    Attributes
    ----------
    plan : what is tried. ``former`` : the record that returns.
    runs : the tried settings are in force. ``is_over`` : they no longer are, or are kept.
    """

    def __init__(
        self,
        plan: TryRequest,
        processes: Processes,
        edits: EditSession,
        clock: Clock,
        ripple: RippleRise,
        *,
        ended: Callable[[str], None],
    ) -> None:
        self.plan = plan
        self.former = processes.parameters
        self.runs = self.is_over = False
        self._processes, self._edits, self._clock = processes, edits, clock
        self._ripple = ripple
        self._ended = ended
        self._until_ns = 0
        self._was_live = processes.is_live()
        self._returning = ""
        self._tries = 0
        self._waits = self._granted = False

    @property
    def returning(self) -> str:
        """Why the former settings are on their way back; empty while they are not."""
        return self._returning

    @property
    def left_s(self) -> float:
        """Seconds until the former settings return; 0 when they are on their way."""
        return max(0.0, (self._until_ns - self._clock.now_ns()) * 1e-9) if self.runs else 0.0

    def begin(self, then: Callable[[Reply], None]) -> None:
        """Hand the settings over; ``then`` gets the reply."""
        self._edits.held = True
        self._edits.saved_meanwhile = False
        self._ripple.begin()

        def taken(reply: Reply) -> None:
            self.runs = reply.ok
            self._until_ns = self._clock.now_ns() + int(self.plan.seconds * 1e9)
            if not reply.ok:
                self._let_go()
            then(reply)

        self._edits.hand_over(self._processes.revised(self.plan.parameters), taken)

    def grant(self) -> None:
        """Leave ``KEEP_GRACE_S`` at least to save the site file; once, or no try would end."""
        if self._granted:
            return
        self._granted = True
        self._until_ns = max(self._until_ns, self._clock.now_ns() + int(KEEP_GRACE_S * 1e9))

    def step(self, latest: TickRow | None) -> None:
        """Look whether it has to end; ``latest``: the newest tick."""
        if not self.runs or self._waits:
            return
        why = self._returning or self._reason(latest)
        if why:
            self.end(why)

    def _reason(self, latest: TickRow | None) -> str:
        """Return why the former settings should return now; empty when they need not."""
        if self._clock.now_ns() >= self._until_ns:
            return "its time is up"
        if self._edits.saved_meanwhile:
            return "a file was saved meanwhile"
        if self._was_live and latest is not None and not latest.is_live:
            return "the correction was taken back"
        return self._ripple.risen()

    def end(self, why: str) -> None:
        """Have the former settings return; may be called again, also while they return."""
        self._returning = self._returning or why  # what came first
        if self._waits or not self.runs:
            return
        if self._processes.control is None:
            self.control_died()
            return
        self._tries += 1
        if self._tries > RETURN_TRIES:
            self._returned_by_restart()
            return
        self._waits = True
        self._edits.hand_over(self._processes.revised(self.former), self._returned)

    def control_died(self) -> None:
        """Have the next start take the former settings: nothing goes out until somebody arms."""
        if self.is_over:
            return
        self._processes.parameters = self.former
        self._finish(self._returning or "the control process died")

    def kept(self) -> None:
        """Go on with these settings: the site file says the same now."""
        self.is_over = True
        self.runs = False
        self._edits.findings = self.plan.findings
        self._let_go()

    def _returned(self, reply: Reply) -> None:
        self._waits = False
        if reply.ok and not self.is_over:
            self._finish(self._returning)

    def _returned_by_restart(self) -> None:
        """Restart idle on the former settings: the control process does not take them."""
        self._edits.restart_on(self.former)
        self._finish(f"{self._returning}; the control process was started anew")

    def _finish(self, why: str) -> None:
        self.is_over = True
        self.runs = False
        self._ripple.end()
        self._let_go()
        self._ended(why)

    def _let_go(self) -> None:
        """Follow the site file again; what was saved meanwhile is an edit."""
        self._edits.held = False
        if self._edits.saved_meanwhile:
            self._edits.saved_meanwhile = False
            self._edits.look_again()
