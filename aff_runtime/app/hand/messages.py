"""What passes through ``hand.sock``: one JSON object a packet.

What a screen says is checked in full (`read_said`): the service acts on it. Of what the service
says a screen only takes the parts (`read_told`); it grants nothing.
The screen says ``Command`` and ``Notice``; the service says ``Welcome`` once and ``Answer`` to
every command. The account is what the screen claims: the service cannot know who stands before it.
"""

from __future__ import annotations

import json
import re
from dataclasses import asdict, dataclass
from typing import Any, TypeAlias

from aff_runtime.app.hand.may import BY_HAND, ROLES, Action, Code, Place, Reason, Role
from aff_runtime.base.signals import State

PROTOCOL = 2
MAX_PACKET_BYTES = 2048
"""An answer whose reason names something at its longest, six bytes a character, fits in it."""
LONGEST_NAME = 200  # characters of what a reason names
NOBODY = "nobody"  # account of a bypass for which nobody has logged in
VALID_NS = 2_000_000_000
"""A press does nothing later than so long after what the person saw: one that comes later was held
up on its way, and was meant for another moment."""
LOGIN_REFUSED = "login refused"
PRESS_REFUSED = "press refused"
# whats of a `Notice`; those of a login first
LOGINS = ("login", "logout", "session ended", "session ended by")
NOTICES = (
    *LOGINS,
    LOGIN_REFUSED,
    PRESS_REFUSED,
    "hand taken",
    "hand taken over",
    "hand released",
    "hand ended",
    "alarm seen",
    "alarm put aside",
    "alarm taken back",
    "window kept",
    "window let go",
)
_ID = re.compile(r"[A-Za-z0-9-]{16,64}")
_ACCOUNT = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,31}")


class HandMessageError(ValueError):
    """A packet is no message of this release."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Welcome:
    """What the service allows to a screen.

    Attributes
    ----------
    ceiling : the highest role that it hears.
    arms_from : the farthest place from which anything but a bypass is heard; the key of the packet
        is older than the other presses, elsewhere it is ``commands_from``.
    """

    version: str
    ceiling: Role
    arms_from: Place
    protocol: int = PROTOCOL


@dataclass(frozen=True, slots=True, kw_only=True)
class Command:
    """One press.

    Attributes
    ----------
    id : of this press, never used again.
    seen : name of the guard's state that the person saw.
    valid_until_ns : by the machine's monotonic clock; later it does nothing.
    """

    id: str
    action: Action
    account: str
    role: Role
    place: Place
    seen: str
    valid_until_ns: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Notice:
    """Something of a session, for the audit alone; ``what`` is one of ``NOTICES``.

    Attributes
    ----------
    action, code : of a press that the screen itself refused, and why.
    other : whose hand was taken over.
    more : notices before this one that were dropped.
    ago_s : how long ago it happened, s.
    """

    what: str
    account: str
    place: Place
    action: str = ""
    code: str = ""
    other: str = ""
    more: int = 0
    ago_s: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """What became of a command; ``reason`` is why nothing did. ``audit`` : number of its line."""

    id: str
    ok: bool
    reason: Reason | None = None
    audit: int = 0


Said: TypeAlias = Command | Notice
Told: TypeAlias = Welcome | Answer


def encode(message: Said | Told) -> bytes:
    """Return a message as one packet."""
    packet = asdict(message)
    for name in ("role", "ceiling"):
        if name in packet:
            packet[name] = packet[name].word
    if packet.get("reason"):
        packet["reason"]["name"] = packet["reason"]["name"][:LONGEST_NAME]
    return json.dumps({"say": type(message).__name__.lower(), **packet}).encode()


def read_said(packet: bytes) -> Said:
    """Return what a screen says.

    Raises
    ------
    HandMessageError
        When it is no message of this release, or any part of it is not what it must be.
    """
    said = _object(packet)
    kind = said.pop("say", None)
    if kind == "notice":
        _check_keys(said, Notice)
        return Notice(
            what=_one_of(said, "what", NOTICES),
            account=_account(said),
            place=_place(said),
            action=_one_of(said, "action", ("", *BY_HAND)),
            code=_one_of(said, "code", ("", *Code)),
            other=_matching(said, "other", _ACCOUNT) if said["other"] != "" else "",
            more=_number(said, "more", "a count is needed"),
            ago_s=_number(said, "ago_s", "a time in s is needed"),
        )
    if kind != "command":
        raise HandMessageError("say: command or notice is needed")
    _check_keys(said, Command)
    return Command(
        id=_matching(said, "id", _ID),
        action=Action(_one_of(said, "action", BY_HAND)),
        account=_account(said),
        role=ROLES[_one_of(said, "role", tuple(ROLES))],
        place=_place(said),
        seen=_one_of(said, "seen", ("", *State.__members__)),
        valid_until_ns=_number(said, "valid_until_ns", "a time of the monotonic clock is needed"),
    )


def read_told(packet: bytes) -> Told:
    """Return what a service says.

    Raises
    ------
    HandMessageError
        When it is no message of this release.
    """
    told = _object(packet)
    try:
        if told["say"] == "welcome":
            return Welcome(
                version=str(told["version"]),
                ceiling=ROLES[told["ceiling"]],
                arms_from=Place(told["arms_from"]),
                protocol=int(told["protocol"]),
            )
        why = told["reason"]
        return Answer(
            id=str(told["id"]),
            ok=told["ok"] is True,
            reason=Reason(code=Code(why["code"]), name=str(why["name"])) if why else None,
            audit=int(told["audit"]),
        )
    except (ValueError, KeyError, TypeError, OverflowError) as error:
        raise HandMessageError(f"no message of this release ({error!a:.80})") from None


def _object(packet: bytes) -> Any:
    try:
        said = json.loads(packet.decode()) if len(packet) <= MAX_PACKET_BYTES else None
    except (ValueError, RecursionError):
        said = None
    if not isinstance(said, dict):
        raise HandMessageError(f"one JSON object of {MAX_PACKET_BYTES} bytes at most is needed")
    return said


def _check_keys(said: Any, kind: type[Said]) -> None:
    wanted = set(kind.__dataclass_fields__)
    if set(said) != wanted:
        raise HandMessageError(f"{kind.__name__.lower()}: needs {', '.join(sorted(wanted))}")


def _one_of(said: Any, key: str, values: tuple[str, ...]) -> str:
    if not isinstance(said[key], str) or said[key] not in values:
        raise HandMessageError(f"{key}: one of {', '.join(values)} is needed")
    return str(said[key])


def _matching(said: Any, key: str, pattern: re.Pattern[str]) -> str:
    if not isinstance(said[key], str) or not pattern.fullmatch(said[key]):
        raise HandMessageError(f"{key}: must match {pattern.pattern}")
    return str(said[key])


def _number(said: Any, key: str, wanted: str) -> int:
    value = said[key]
    if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value < 2**63:
        raise HandMessageError(f"{key}: {wanted}")
    return value


def _account(said: Any) -> str:
    return _matching(said, "account", _ACCOUNT)


def _place(said: Any) -> Place:
    return Place(_one_of(said, "place", tuple(Place)))


def is_account_name(name: str) -> bool:
    """Return whether an account may have this name."""
    return _ACCOUNT.fullmatch(name) is not None


def is_command_id(ident: str) -> bool:
    """Return whether a press may have this id."""
    return _ID.fullmatch(ident) is not None
