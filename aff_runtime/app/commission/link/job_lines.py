"""What passes between a commissioner and its job: lines of JSON, as frozen records.

The first line to a job is ``Start``, later ones are ``Reply``; what a job says is a ``JobLine``,
the last of them ``Ended`` or ``Refused``.
"""

from __future__ import annotations

import json
import os
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import TypeAlias

from pydantic import TypeAdapter

from aff_runtime.app.commission.link.answers import Answer, from_plain, to_plain
from aff_runtime.app.commission.link.messages import Request
from aff_runtime.app.commission.paths import Paths
from aff_runtime.app.commission.views.of_line import QuestionView, SaidLine

KINDS = ("say", "complain")


@dataclass(frozen=True, slots=True, kw_only=True)
class Start:
    """What a job does; ``parent`` : process of its commissioner."""

    asked: Request
    where: Paths
    parent: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Reply:
    """A person's answer to the question of this number."""

    number: int
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Ended:
    """The job is over, with its answer."""

    answer: Answer


@dataclass(frozen=True, slots=True, kw_only=True)
class Refused:
    """The job cannot do it; ``text`` says why."""

    text: str


JobLine: TypeAlias = SaidLine | QuestionView | Ended | Refused
_REPLY, _QUESTION = TypeAdapter(Reply), TypeAdapter(QuestionView)


def encode(line: JobLine | Start | Reply) -> str:
    """Return a line without its end."""
    match line:
        case SaidLine():
            return json.dumps({line.kind: line.text})
        case QuestionView():
            return json.dumps({"ask": asdict(line)})
        case Ended():
            return json.dumps({"done": to_plain(line.answer)})
        case Refused():
            return json.dumps({"refused": line.text})
        case Start():
            named = ((one.name, getattr(line.where, one.name)) for one in fields(Paths))
            where = {name: os.fspath(path) for name, path in named if path is not None}
            return json.dumps({**line.asked.to_json(), "where": where, "parent": line.parent})
        case Reply():
            return json.dumps(asdict(line))


def read_start(line: str) -> Start:
    """Return what a job is to do.

    Raises
    ------
    ValueError, KeyError
        When the line is no ``Start``: commissioner and job are not of one installation.
    """
    said = json.loads(line)
    parent = int(said.pop("parent"))
    where = Paths(**{name: Path(path) for name, path in said.pop("where").items()})
    return Start(asked=Request.from_json(said), where=where, parent=parent)


def read_reply(line: str) -> Reply:
    """Return a person's answer.

    Raises
    ------
    ValueError
        When the line is none.
    """
    return _REPLY.validate_json(line)


def read_line(do: str, line: bytes) -> JobLine:
    """Return what a job ``do`` has said.

    Raises
    ------
    ValueError
        When it is no line of ours.
    """
    said = json.loads(line)
    if not isinstance(said, dict) or len(said) != 1:
        raise ValueError(f"no line of a job: {line[:80]!r}")
    ((kind, value),) = said.items()
    if kind in KINDS:
        return SaidLine(kind=kind, text=str(value))
    if kind == "ask":
        return _QUESTION.validate_python(value)
    if kind == "refused":
        return Refused(text=str(value))
    if kind == "done":
        return Ended(answer=from_plain(do, value))
    raise ValueError(f"no line of a job: {line[:80]!r}")
