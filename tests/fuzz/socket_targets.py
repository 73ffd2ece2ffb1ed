"""The control socket under any bytes of a caller: every line is answered or refused, in bounds."""

from __future__ import annotations

import json
import tempfile
from pathlib import Path

from aff_runtime.app.link.answers import Done
from aff_runtime.app.link.requests import MAX_ID_CHARACTERS, VERBS
from tests.fuzz.source import Source
from tests.security.desk import STATUS_BYTES, Desk, ended

MAX_ANSWER_BYTES = STATUS_BYTES + 1000
_FOLDER = tempfile.TemporaryDirectory(prefix="aff-fuzz-")
_DESK = Desk(Path(_FOLDER.name))
KEYS = ("do", "id", "by", "on", "actuators", "record", "", "do\n")
VALUES = (
    *VERBS,
    "ARM",
    "",
    "\x1b[2J",
    "\u202e",
    "\ud800",
    "x" * (MAX_ID_CHARACTERS + 1),
    0,
    -1,
    10**30,
    1.5,
    float("nan"),
    True,
    None,
    [],
    ["unwind"],
    ["unwind", 7],
    [[[[]]]],
    {},
    {"do": "arm"},
)


def socket_lines(data: bytes) -> str:
    """Whatever a caller sends: each line gets one answer, short and readable, or the door."""
    source = Source(data)
    client = _DESK.connect()
    _DESK.asked.clear()
    _DESK.waiting.clear()
    sent = _said(source)
    while sent:
        try:
            sent = sent[client.send(sent[: 1 + source.word()]) :]
        except (BrokenPipeError, ConnectionResetError):
            break
        _DESK.serve_all()
    for asked in _DESK.waiting:
        asked.answer(Done())
    answers = list(_DESK.answers(client))
    for answer in answers:
        assert isinstance(answer["ok"], bool)
        assert len(json.dumps(answer)) <= MAX_ANSWER_BYTES
        assert answer["ok"] or answer["message"].isprintable()
        assert answer["ok"] or answer["message"]
    done = [asked.request for asked in _DESK.asked]
    assert all(request.do in VERBS and type(request.on) is bool for request in done)
    away = ended(client)
    answered = sum(answer["ok"] for answer in answers)
    assert answered == len(done) or (away and answered <= len(done) and not answers[-1]["ok"])
    client.close()
    _DESK.serve_all()
    assert not _DESK.requests.callers
    if done:
        return "ok"
    return "sent away" if away else "refused" if answers else "silent"


def _said(source: Source) -> bytes:
    """Some lines: requests with any values, spoilt ones, raw bytes."""
    lines = b""
    for _ in range(1 + source.below(12)):
        kind = source.below(8)
        if kind == 7:
            lines += source.take(source.below(64))
            continue
        request = {"do": source.pick(VERBS)} if kind < 4 else {}
        for _ in range(source.below(4)):
            request[source.pick(KEYS)] = source.pick(VALUES)
        line = json.dumps(request).encode() + b"\n"
        lines += source.spoilt(line) if kind == 6 else line
    return lines


SEEDS = [bytes(12), bytes(range(1, 60)), b"\x07\x07\xff\n{}\n", b"\x04\x01\x00\x03" * 12]
