"""What a screen asks of the commissioner under any bytes: a request, or an error of ours."""

from __future__ import annotations

import json

from aff_runtime.app.commission.link.messages import TABLE, RequestError, read_request
from tests.fuzz.source import Source

PERSON = {"key": "k" * 43, "place": "panel"}
LINES = [
    json.dumps(said).encode()
    for said in (
        {"do": "state"},
        {"do": "answer", **PERSON, "number": 7, "text": "20.2 lbf"},
        {
            "do": "sign",
            **PERSON,
            "step": 4,
            "measured": "0" * 64,
            "reason": "seen on the drive",
            "password": "tension, 90 N",
        },
    )
]


def request(data: bytes) -> str:
    """A line, spoilt or made of the bytes themselves; what is taken has the keys of its row."""
    source = Source(data)
    kind = source.below(len(LINES) + 1)
    said = source.take(9000) if kind == len(LINES) else source.spoilt(LINES[kind])
    try:
        found = read_request(said)
    except RequestError as error:
        why = str(error)
        assert why
        assert why.isprintable()
        return "refused"
    names = ("do", *TABLE[found.do])
    assert set(found.to_json()) <= set(names)
    again = {name: getattr(found, name) for name in names}
    assert read_request(json.dumps(again).encode()) == found
    return "ok"


SEEDS = [bytes(8), b"\x01" + bytes(7), b"\x02" + LINES[2], b"\x03" + LINES[1], bytes(range(1, 40))]
