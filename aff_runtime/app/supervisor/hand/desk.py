"""What a screen asks is judged here, done, and put on record: bypass at once, arming with care."""

from __future__ import annotations

import selectors
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

from aff_runtime import __version__
from aff_runtime.app.hand.audit import Audit, AuditEntry
from aff_runtime.app.hand.audit_writer import AuditWriter
from aff_runtime.app.hand.may import Action, Circumstances, Code, Person, Place, Reason, Role, may
from aff_runtime.app.hand.messages import (
    LOGIN_REFUSED,
    LOGINS,
    PRESS_REFUSED,
    VALID_NS,
    Answer,
    Command,
    HandMessageError,
    Notice,
    Welcome,
    read_said,
)
from aff_runtime.app.link.replies import Reply
from aff_runtime.app.report.command_counts import CommandTally, Result, Via
from aff_runtime.app.supervisor.hand.entries import ServiceState, entry_of
from aff_runtime.app.supervisor.hand.quotas import Limits, Quota
from aff_runtime.app.supervisor.hand.visits import ScreenVisitor, Visits
from aff_runtime.base.ports import Clock
from aff_runtime.base.signals import State

REMEMBERED_NS = 5 * VALID_NS
"""An id is remembered for longer than any command with it can be valid."""

RESULT_OF = {Code.LATE: Result.LATE, Code.REPEATED: Result.REPEATED}


@dataclass(frozen=True, slots=True, kw_only=True)
class HandRules:
    """What this installation lets a screen do: the highest role, and from how far."""

    ceiling: Role
    commands_from: Place = Place.PANEL


class CommandedService(Protocol):
    """The service, as far as a screen reaches it."""

    def now(self) -> ServiceState:
        """Return how it stands."""

    def bypass(self) -> None:
        """Take the correction back."""

    def arm(self, answer: Callable[[Reply], None]) -> None:
        """Ask the control process to arm; ``answer`` is called once, now or later."""

    def probe(self, answer: Callable[[Reply], None], *, louder: bool) -> None:
        """Ask it to probe every actuator; ``answer`` is called when it begins, or does not."""

    def shadow(self, on: bool, answer: Callable[[Reply], None]) -> None:
        """Ask it to begin or end shadow operation."""

    def forget(self, answer: Callable[[Reply], None]) -> None:
        """Ask it to drop what was learned of rolls that are exchanged."""

    def note(self, text: str) -> None:
        """Put a sentence into the log and the record."""


class HandDesk:
    """Hears the screens.

    A bypass is never refused, whatever it carries; more than ten a second of one user are done as
    ten, the last among them. What arms is refused when it comes late, twice, for a state that is
    gone, from before a bypass, too often, against ``may``, or when it cannot be put on record
    first.
    """

    def __init__(
        self,
        folder: Path,
        selector: selectors.BaseSelector,
        clock: Clock,
        *,
        is_private: bool,
        rules: HandRules,
        audit: Audit,
        service: CommandedService,
        counts: CommandTally,
    ) -> None:
        self._clock = clock
        self._counts = counts
        self._rules = rules
        self._audit = AuditWriter(audit, clock, without="no screen arms")
        self._service = service
        self._limits: dict[int, Limits] = {}
        self._ids: OrderedDict[str, int] = OrderedDict()
        self._bypass_due: set[int] = set()
        self._visits = Visits(folder, selector, self._welcome, self._hear, is_private=is_private)

    @property
    def audit_records(self) -> int:
        """Number of the newest line of the audit."""
        return self._audit.last

    @property
    def is_kept(self) -> bool:
        """Whether no line since the audit was opened is lost: each is in it, or counted there."""
        return self._audit.is_kept

    def serve(self, key: selectors.SelectorKey) -> bool:
        """Do what a selector's event asks for; False when it is none of the hand's."""
        return self._visits.serve(key)

    def step(self) -> None:
        """Do a bypass that had to wait, tend the audit, say how many lines were left out."""
        if any(self._limits[uid].bypasses.take() for uid in self._bypass_due):
            self._take_back()
        self._audit.tend()
        self._say_more(at_end=False)

    def close(self) -> None:
        """Send the screens away; the audit ends."""
        self._visits.close()
        self._say_more(at_end=True)
        self._audit.close()

    # --- one visitor ------------------------------------------------------------------------

    def _welcome(self, visitor: ScreenVisitor) -> None:
        rules = self._rules
        said = Welcome(version=__version__, ceiling=rules.ceiling, arms_from=rules.commands_from)
        visitor.tell(said)

    def _hear(self, visitor: ScreenVisitor, packet: bytes) -> bool:
        """Do what one packet says; False when its visitor has to go."""
        limits = self._limits.setdefault(visitor.peer.uid, Limits(self._clock))
        try:
            said = read_said(packet)
        except HandMessageError as error:
            self._refuse_unreadable(visitor, str(error), limits)
            return False
        if isinstance(said, Notice) and said.what == LOGIN_REFUSED:
            self._keep(limits.strangers, entry_of(said, visitor))
            return True  # what strangers try sends no screen away
        is_heard = limits.packets.take()
        if isinstance(said, Command) and said.action is Action.BYPASS:
            self._bypass(visitor, said, limits)
        elif is_heard and isinstance(said, Command):
            self._press(visitor, said, limits)
        elif is_heard and isinstance(said, Notice):
            kinds = {PRESS_REFUSED: limits.presses, **dict.fromkeys(LOGINS, limits.logins)}
            shares = kinds.get(said.what, limits.lines)
            self._keep(shares.of(said.account), entry_of(said, visitor))
        else:
            limits.lines.of(said.account).leave_out()
        return is_heard

    def _refuse_unreadable(self, visitor: ScreenVisitor, why: str, limits: Limits) -> None:
        entry = AuditEntry(what="no command", result="refused", why=why, peer=str(visitor.peer))
        self._keep(limits.lines.of(""), entry)

    # --- commands ---------------------------------------------------------------------------

    def _bypass(self, visitor: ScreenVisitor, command: Command, limits: Limits) -> None:
        """Take the correction back first; everything else comes after."""
        before = self._service.now().state
        is_at_once = limits.bypasses.take()
        if is_at_once:
            self._take_back()
        else:
            self._bypass_due.add(visitor.peer.uid)
        entry = replace(entry_of(command, visitor, self._service.now()), result="done")
        if is_at_once and before not in (None, State.BYPASS):
            number = self._write(entry)
        else:
            number = self._keep(limits.lines.of(command.account), entry)
        self._counts.add(command.action, Via.HMI, Result.DONE)
        visitor.tell(Answer(id=command.id, ok=True, audit=number))

    def _take_back(self) -> None:
        """Take the correction back: of all who asked before, nothing is left to do."""
        self._service.bypass()
        self._bypass_due.clear()

    def _press(self, visitor: ScreenVisitor, command: Command, limits: Limits) -> None:
        """Have what changes something done, or say why not; it is on record before it is done."""
        now = self._service.now()
        entry = entry_of(command, visitor, now)
        against = self._against(command, now, limits)
        if against is not None:
            became = RESULT_OF.get(against.code, Result.REFUSED)
            self._counts.add(command.action, Via.HMI, became)
            refused = replace(entry, result="refused", why=against.text)
            number = self._keep(limits.lines.of(command.account), refused)
            visitor.tell(Answer(id=command.id, ok=False, reason=against, audit=number))
        elif not self._write(replace(entry, result="asked")):
            reason = Reason(code=Code.UNRECORDED)
            self._counts.add(command.action, Via.HMI, Result.REFUSED)
            visitor.tell(Answer(id=command.id, ok=False, reason=reason))
        else:
            self._begin(command.action, lambda reply: self._answered(visitor, command, reply))

    def _begin(self, action: Action, answer: Callable[[Reply], None]) -> None:
        """Have the service do what was judged."""
        match action:
            case Action.ARM:
                self._service.arm(answer)
            case Action.PROBE | Action.PROBE_LOUDER:
                self._service.probe(answer, louder=action is Action.PROBE_LOUDER)
            case Action.SHADOW | Action.END_SHADOW:
                self._service.shadow(action is Action.SHADOW, answer)
            case Action.FORGET:
                self._service.forget(answer)
            case _:
                answer(Reply(id=0, ok=False, message=f"{action}: no screen has that done here"))

    def _against(self, command: Command, now: ServiceState, limits: Limits) -> Reason | None:
        """Return the first reason why nothing is done; None when it is."""
        if not limits.commands.take():
            return Reason(code=Code.FAST)
        now_ns = self._clock.now_ns()
        if not now_ns <= command.valid_until_ns <= now_ns + VALID_NS:
            return Reason(code=Code.LATE)
        if command.valid_until_ns - VALID_NS < now.bypassed_ns:  # was seen before that bypass
            return Reason(code=Code.LATE)
        if not self._is_new(command.id, now_ns):
            return Reason(code=Code.REPEATED)
        if now.state is not None and command.seen != now.state.name:
            return Reason(code=Code.CHANGED, name=now.state.name)
        # whose session has the hand, the screen alone can know
        person = Person(role=command.role, place=command.place, has_hand=True)
        circumstances = Circumstances(
            state=now.state,
            blocked=now.blocked,
            also_blocking=now.also_blocking,
            ceiling=self._rules.ceiling,
            commands_from=self._rules.commands_from,
            probing=now.probing,
            remote=now.remote,
        )
        reasons = may(command.action, person, circumstances)
        return reasons[0] if reasons else None

    def _is_new(self, ident: str, now_ns: int) -> bool:
        """Return whether an id was never heard; it is remembered for longer than it is valid."""
        while self._ids and now_ns - next(iter(self._ids.values())) > REMEMBERED_NS:
            self._ids.popitem(last=False)
        if ident in self._ids:
            return False
        self._ids[ident] = now_ns
        return True

    def _answered(self, visitor: ScreenVisitor, command: Command, reply: Reply) -> None:
        """Put the control process's answer on record and pass it on."""
        entry = entry_of(command, visitor, self._service.now())
        result = Result.DONE if reply.ok else Result.REFUSED
        self._counts.add(command.action, Via.HMI, result)
        number = self._write(replace(entry, result=result.value, why=reply.message))
        reason = None if reply.ok else Reason(code=Code.REFUSED, name=reply.message)
        visitor.tell(Answer(id=command.id, ok=reply.ok, reason=reason, audit=number))

    # --- the record -------------------------------------------------------------------------

    def _keep(self, quota: Quota, entry: AuditEntry) -> int:
        """Write what changes nothing; of a flood the count is written."""
        return self._write(entry) if quota.take() else 0

    def _say_more(self, *, at_end: bool) -> None:
        """Write how many lines of whom were left out."""
        for uid, limits in self._limits.items():
            for why in limits.told(uid, at_end=at_end):
                self._write(AuditEntry(what="more", result="noted", why=why))

    def _write(self, entry: AuditEntry) -> int:
        """Write one line, here and into the service's log; its number, 0 when it cannot be."""
        number = self._audit.write(entry)
        who = f' by "{entry.account}" of a screen as it says' if entry.account else ""
        why = f" ({entry.why})" if entry.why else ""
        kept = self._audit.kept_as(number)
        self._service.note(f"{entry.what} {entry.result}{who}{why}; {entry.peer}; {kept}")
        return number
