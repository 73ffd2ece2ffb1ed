"""What passes through ``commission.sock``: a request a connection, a line of JSON each way.

Every request is checked in full before anything of it is used. What changes something needs the
key that ``open`` gives for a password; a signature needs the password itself, once more.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from enum import StrEnum
from typing import Any, TypeAlias

from aff_runtime.app.hand.accounts import MOST_CHARACTERS
from aff_runtime.app.hand.messages import is_account_name
from aff_runtime.config.yaml_marks import MAX_BYTES

PROTOCOL = 1
NAME = "commission.sock"
MAX_ASKED_BYTES = 8192
MAX_TEXTS_BYTES = 1 << 21  # of a request with texts of site files in it
PACKET_BYTES = 1 << 15  # of a request, or an answer, that go at once; a shorter one is the last
MAX_TOLD_BYTES = 8 << 20
LONGEST_TEXT = 2000
Value: TypeAlias = str | int | bool
Keys: TypeAlias = Mapping[str, Callable[[Any], bool]]


class Why(StrEnum):
    """Why something was not done."""

    NO_SENSE = "no sense"
    PASSWORD = "password"
    WAIT = "wait"
    ROLE = "role"
    PLACE = "place"
    BUSY = "busy"
    CLOSED = "closed"
    RUNNING = "running"
    CHANGED = "changed"
    UNRECORDED = "unrecorded"
    REFUSED = "refused"
    SILENT = "silent"


WORDS = {
    Why.NO_SENSE: "that is no request of this screen",
    Why.PASSWORD: "name or password is wrong",
    Why.WAIT: "too many tries: wait a minute",
    Why.ROLE: "the role commission is needed",
    Why.PLACE: "commissioning is for the panel at the machine, not for the network",
    Why.BUSY: "{name} is at it; take it over?",
    Why.CLOSED: "open it with your password first",
    Why.RUNNING: "{name} is under way; stop it or wait",
    Why.CHANGED: "somebody has changed it since you looked; look again",
    Why.UNRECORDED: "the audit cannot be kept, so nothing is done",
    Why.REFUSED: "{name}",
    Why.SILENT: "no commissioner answers: start `aff-runtime commission`",
}


class RequestError(ValueError):
    """What was asked is no request of this release."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Request:
    """What is asked, by the row of ``TABLE`` that ``do`` names; other fields are as by default.

    Attributes
    ----------
    key, place, account, password, over : who asks, from where; whether to take it over.
    step, measured : number of the card's step, and the hash of its measurement that was shown; of
        settings the sha256 of their text.
    typed, plc, leave_out : values of displays, one a line; name of the PLC; why a step does not
        apply.
    seconds, reason : how long to try something, and why something is done.
    again : names of questions or quantities to be asked once more, separated by spaces.
    number, text : which question, and its answer.
    paper : of a page that prints.
    windows, holdout : parts of runs to fit and to judge on, one a line: ``NAME[@FROM..TO]``.
    without : effects that are left out of refine's library, a word each.
    back : whether it is said, too, what going back to a version would change: it takes a check of
        the service.
    base, edits : hash of the settings that were seen, and what is to be changed of them, a line
        ``PATH: VALUE`` each.
    site_text : of a whole site file, which the edits are of; empty: of what the file says.
    former : the text that ``site_text`` was begun on, where somebody has saved another one since.
    roll, on : a roller that was exchanged, and when.
    by : who has a job done, in words; said by the commissioner alone.
    """

    do: str
    key: str = ""
    place: str = ""
    account: str = ""
    password: str = ""
    over: bool = False
    step: int = -1
    measured: str = ""
    typed: str = ""
    plc: str = ""
    leave_out: str = ""
    seconds: int = 0
    reason: str = ""
    again: str = ""
    number: int = 0
    text: str = ""
    paper: str = ""
    windows: str = ""
    holdout: str = ""
    without: str = ""
    roll: str = ""
    on: str = ""
    base: str = ""
    edits: str = ""
    site_text: str = ""
    former: str = ""
    back: bool = False
    by: str = ""

    @property
    def called(self) -> str:
        """What is asked in a word or two, for people."""
        return f"{self.do} {self.step}" if self.step >= 0 else self.do

    def for_job(self, *, account: str, by: str) -> Request:
        """Return what a job is told: who has it done, and no secret."""
        return replace(self, key="", password="", account=account, by=by)

    def to_json(self) -> dict[str, Value]:
        """Return plain values; what is as by default is left out."""
        rows = ((one.name, getattr(self, one.name), one.default) for one in fields(self))
        return {name: value for name, value, default in rows if value != default}

    @classmethod
    def from_json(cls, said: Mapping[str, Value]) -> Request:
        """Read ``to_json``'s values back; they are this release's own."""
        return cls(**said)  # type: ignore[arg-type]


def _text(value: Any) -> bool:
    """Whether it is text that shows as itself; several lines are."""
    is_short = isinstance(value, str) and len(value) <= LONGEST_TEXT
    return is_short and value.replace("\n", "").isprintable()


def _site_text(value: Any) -> bool:
    """Whether it may be the text of a site file; what is in it the job says in words."""
    is_short = isinstance(value, str) and len(value) <= MAX_BYTES
    return is_short and not any("\ud800" <= char <= "\udfff" for char in value)


def _whole(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value < 2**53


def _flag(value: Any) -> bool:
    return isinstance(value, bool)


def _key(value: Any) -> bool:
    return isinstance(value, str) and re.fullmatch(r"[A-Za-z0-9_-]{0,64}", value) is not None


def _digest(value: Any) -> bool:
    return isinstance(value, str) and re.fullmatch(r"[0-9a-f]{64}", value) is not None


def _password(value: Any) -> bool:
    return isinstance(value, str) and len(value) <= MOST_CHARACTERS


def _account(value: Any) -> bool:
    return isinstance(value, str) and is_account_name(value)


def _place(value: Any) -> bool:
    return value in ("panel", "network")


def _paper(value: Any) -> bool:
    return value in ("a4", "letter")


_PERSON = {"key": _key, "place": _place}
_WINDOWS = {**_PERSON, "windows": _text, "holdout": _text, "without": _text}
_TRIED = {**_PERSON, "measured": _digest, "reason": _text}
_EDITS = {"base": _digest, "edits": _text, "site_text": _site_text}
# what may be asked: its keys, each with what its value must be
TABLE: Mapping[str, Keys] = {
    "state": {},
    "card": {},
    "page": {"paper": _paper},
    "line": {},
    "open": {"account": _account, "password": _password, "place": _place, "over": _flag},
    "close": _PERSON,
    "begin": _PERSON,
    "step": {**_PERSON, "step": _whole, "typed": _text, "plc": _text, "leave_out": _text},
    "sign": {
        **_PERSON,
        "step": _whole,
        "measured": _digest,
        "reason": _text,
        "password": _password,
    },
    "verify": _PERSON,
    "try": {**_PERSON, "step": _whole, "measured": _digest, "seconds": _whole, "reason": _text},
    "keep": _TRIED,
    "undo": _TRIED,
    "words": {**_PERSON, "again": _text},
    "answer": {**_PERSON, "number": _whole, "text": _text},
    "stop": _PERSON,
    "refining": {},
    "refined": {"number": _whole},
    "refined_page": {"number": _whole},
    "lacks": _WINDOWS,
    "refine": _WINDOWS,
    "try_refined": {
        **_PERSON,
        "number": _whole,
        "measured": _digest,
        "seconds": _whole,
        "reason": _text,
    },
    "maintenance": {},
    "add_runs": _PERSON,
    "exchange": {**_PERSON, "roll": _text, "on": _text, "reason": _text},
    "stop_long": _PERSON,
    "settings": {},
    "settings_version": {"number": _whole, "back": _flag},
    "settings_diff": _EDITS,
    "settings_text": {**_EDITS, "former": _site_text},
    "try_settings": {**_PERSON, **_EDITS, "measured": _digest, "seconds": _whole, "reason": _text},
    "save_settings": {**_PERSON, **_EDITS, "measured": _digest, "reason": _text},
    "go_back": {
        **_PERSON,
        "number": _whole,
        "base": _digest,
        "measured": _digest,
        "reason": _text,
    },
}
LOOKS = (
    *("state", "card", "page", "line", "refining", "refined", "refined_page", "maintenance"),
    *("settings", "settings_version", "settings_diff", "settings_text"),
)
"""What changes nothing and needs no key."""
WITH_TEXTS = ("settings_diff", "settings_text", "try_settings", "save_settings")
"""What may hold whole site files."""
LONG = ("lacks", "refine", "add_runs")
"""Jobs that take minutes to hours: one at a time, beside the others."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Refusal:
    """Why not.

    Attributes
    ----------
    why : one of ``Why``; another release may have others.
    name : what ``{name}`` of its words stands for.
    """

    why: str
    name: str = ""


def encode(asked: Request) -> bytes:
    """Return a request as one line of JSON: the keys of its row.

    Of texts every character stands for itself, so that the longest have room.
    """
    said = {name: getattr(asked, name) for name in ("do", *TABLE[asked.do])}
    line = json.dumps(said, ensure_ascii=False).encode("utf-8")
    return line if len(line) % PACKET_BYTES else line + b" "


def read_request(line: bytes) -> Request:
    """Return a request.

    Raises
    ------
    RequestError
        When it is none of this release, or any part of it is not what it must be.
    """
    said: Any
    try:
        said = json.loads(line.decode()) if len(line) <= MAX_TEXTS_BYTES else None
    except (ValueError, RecursionError):
        said = None
    do = said.get("do") if isinstance(said, dict) else None
    is_long = len(line) > MAX_ASKED_BYTES and do not in WITH_TEXTS
    if said is None or is_long or not isinstance(do, str) or do not in TABLE:
        raise RequestError(f"one of {', '.join(TABLE)} is needed, {MAX_ASKED_BYTES} bytes at most")
    wanted = TABLE[do]
    if set(said) != {"do", *wanted}:
        raise RequestError(f"{do}: needs {', '.join(sorted(wanted)) or 'nothing'}")
    for key, is_right in wanted.items():
        if not is_right(said[key]):
            raise RequestError(f"{do}: {key} is not what it must be")
    return Request(**said)
