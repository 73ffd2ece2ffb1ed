"""What a caller may ask: one JSON object per line, checked in full before anything is done."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, TypeAlias

from aff_runtime.app.link import settings_request
from aff_runtime.app.link.settings_request import SettingsRequest
from aff_runtime.base.errors import RefusedError

MAX_REQUEST_BYTES = 4096
MAX_ID_CHARACTERS = 64
MAX_ID_NUMBER = 2**53
MAX_BY_CHARACTERS = 64
VERBS = ("arm", "bypass", "forget", "shadow", "status", "probe", "settings", "stop")
QUESTIONS = frozenset({"arm", "forget", "shadow", "probe"})  # answered by the control process
_KEYS = {"do", "id", "by", "on", "actuators", "rolls", "louder", *settings_request.KEYS}
Ident: TypeAlias = str | int | None


class BabbleError(RefusedError):
    """A line is no request at all; its caller is sent away."""


class BadRequestError(RefusedError):
    """A request is refused; ``ident`` is the caller's number of it."""

    def __init__(self, message: str, ident: Ident = None) -> None:
        super().__init__(message)
        self.ident = ident


@dataclass(frozen=True, slots=True, kw_only=True)
class Request:
    """One request.

    Attributes
    ----------
    do : one of ``VERBS``.
    ident : the caller's own number or name of the request, echoed in its answer.
    by : on whose behalf, as the caller claims; empty when it claims nothing.
    on : of ``shadow``.
    actuators : of ``probe``; empty for all. ``louder`` : than the last one, within its bound.
    rolls : of ``forget``; empty for those that a splice exchanges.
    settings : of ``settings``.
    """

    do: str
    ident: Ident = None
    by: str = ""
    on: bool = True
    actuators: tuple[str, ...] = ()
    rolls: tuple[str, ...] = ()
    louder: bool = False
    settings: SettingsRequest | None = None


def longest(line: bytes) -> int:
    """Return how many bytes a line that begins so may have: one may hold a whole site file."""
    holds_text = line.startswith(settings_request.START)
    return settings_request.MAX_BYTES if holds_text else MAX_REQUEST_BYTES


def read_request(line: bytes) -> Request:
    """Return what one line asks.

    Raises
    ------
    BabbleError
        When it is not one JSON object.
    BadRequestError
        When a key, a verb or a value is none of those that there are.
    """
    try:
        said = json.loads(line.decode()) if len(line) <= longest(line) else None
    except (ValueError, RecursionError):
        said = None
    if not isinstance(said, dict):
        raise BabbleError(
            f"one JSON object per line is needed, {MAX_REQUEST_BYTES} bytes at most; good-bye"
        )
    ident = _ident(said.get("id"))
    try:
        return _checked(said, ident)
    except RefusedError as error:
        raise BadRequestError(str(error), ident) from None


def _checked(said: dict[str, Any], ident: Ident) -> Request:
    unknown = [key for key in said if key not in _KEYS]
    if unknown:
        known = ", ".join(sorted(_KEYS))
        raise RefusedError(f"unknown key {unknown[0][:40]!a}; a request has {known}")
    do = said.get("do")
    if not isinstance(do, str) or do not in VERBS:
        words = f"{', '.join(VERBS[:-1])} or {VERBS[-1]}"
        raise RefusedError(f"unknown request {_short(do)}; use {words}")
    by = said.get("by", "")
    if not isinstance(by, str) or len(by) > MAX_BY_CHARACTERS:
        raise RefusedError(f"by: a text of {MAX_BY_CHARACTERS} characters at most is needed")
    on, louder = _flag("on", said.get("on", True)), _flag("louder", said.get("louder", False))
    actuators = _names("actuators", said.get("actuators", []))
    rolls = _names("rolls", said.get("rolls", []))
    settings = settings_request.settings_request(said) if do == "settings" else None
    return Request(
        do=do,
        ident=ident,
        by=by,
        on=on,
        actuators=actuators,
        rolls=rolls,
        louder=louder,
        settings=settings,
    )


def _names(key: str, given: object) -> tuple[str, ...]:
    """Return the names of a request, refused when it is anything else."""
    if not isinstance(given, list) or not all(isinstance(name, str) for name in given):
        raise RefusedError(f"{key}: a list of names is needed")
    return tuple(given)


def _flag(name: str, given: object) -> bool:
    """Return true or false of a request, refused when it is anything else."""
    if not isinstance(given, bool):
        raise RefusedError(f"{name}: true or false is needed, not {_short(given)}")
    return given


def _ident(given: object) -> Ident:
    """Return the caller's number of a request, refused when it is none."""
    if given is None:
        return None
    if isinstance(given, str) and len(given) <= MAX_ID_CHARACTERS:
        return given
    if isinstance(given, int) and not isinstance(given, bool) and abs(given) <= MAX_ID_NUMBER:
        return given
    raise BadRequestError(
        f"id: a whole number, or a text of {MAX_ID_CHARACTERS} characters at most, is needed"
    )


def _short(given: object) -> str:
    """Return a value as it came, not too long; what holds other values by its kind."""
    if isinstance(given, dict | list):
        return "a list" if isinstance(given, list) else "an object"
    return ascii(given)[:60]
