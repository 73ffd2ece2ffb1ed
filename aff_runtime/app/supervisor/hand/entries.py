"""How the service stands, and what a line of the audit says of it."""

from __future__ import annotations

from dataclasses import dataclass

from aff_runtime.app.hand.audit import AuditEntry
from aff_runtime.app.hand.messages import Command, Notice
from aff_runtime.app.supervisor.hand.visits import ScreenVisitor
from aff_runtime.base.signals import State


@dataclass(frozen=True, slots=True, kw_only=True)
class ServiceState:
    """How the service stands.

    Attributes
    ----------
    state : of the guard; None without a tick.
    blocked : the guard's first reason against an armed output, empty for none; ``also_blocking`` :
        its others.
    tick, config : number of the tick that this was read from, and the revision in force.
    bypassed_ns : when anybody last took the correction back, by the monotonic clock.
    probing : a probe is under way.
    remote : the line is in remote.
    """

    state: State | None
    blocked: str = ""
    also_blocking: tuple[str, ...] = ()
    tick: int = 0
    config: str = ""
    bypassed_ns: int = 0
    probing: bool = False
    remote: bool = False


def entry_of(
    message: Command | Notice, visitor: ScreenVisitor, now: ServiceState | None = None
) -> AuditEntry:
    """Return the audit entry of a message, before its result is known (a notice has none)."""
    peer = str(visitor.peer)
    if isinstance(message, Notice):
        return AuditEntry(
            what=message.what,
            result="noted",
            why=_why(message),
            account=message.account,
            place=message.place,
            peer=peer,
        )
    state = now.state.name if now is not None and now.state is not None else ""
    return AuditEntry(
        what=message.action,
        result="asked",
        account=message.account,
        role=message.role.word,
        place=message.place,
        peer=peer,
        seen=message.seen,
        state=state,
        tick=now.tick if now is not None else 0,
        config=now.config if now is not None else "",
        id=message.id,
    )


def _why(notice: Notice) -> str:
    """Return what is said of a notice beside what it is."""
    parts = {
        f"{notice.action}: {notice.code}": notice.code,
        f"from {notice.other}": notice.other,
        f"{notice.more} before it were not said": notice.more,
        f"{notice.ago_s} s before this line": notice.ago_s,
    }
    return "; ".join(text for text, is_said in parts.items() if is_said)
