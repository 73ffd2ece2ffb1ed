"""Requests about settings: what is no such request is refused with what is needed."""

import json

import pytest

from aff_runtime.app.link.requests import (
    MAX_REQUEST_BYTES,
    BabbleError,
    BadRequestError,
    longest,
    read_request,
)
from aff_runtime.app.link.settings_request import MAX_BYTES
from tests.each_case import each_case


def line(**keys):
    return json.dumps({"do": "settings", **keys}).encode()


def test_a_whole_site_file_fits_and_nothing_else_gets_that_room():
    text = "a" * 200_000
    found = read_request(line(act="try", text=text, seconds=60, why="hunting at 1x"))
    assert found.settings is not None
    assert (found.settings.text, found.settings.seconds) == (text, 60.0)
    assert longest(b'{"do": "settings", "act"') == MAX_BYTES
    assert longest(b'{"do": "arm", "text"') == MAX_REQUEST_BYTES
    with pytest.raises(BabbleError):
        read_request(json.dumps({"do": "arm", "by": text}).encode())


@each_case(
    ("keys", "said"),
    [
        ({}, "act: one of state, diff, try, keep, save, undo, history is needed"),
        ({"act": "arm"}, "act: one of"),
        ({"act": "try", "seconds": 60, "why": "12345678"}, "text: the text of a whole site"),
        ({"act": "diff", "text": 7}, "text: the text"),
        ({"act": "try", "text": "a", "why": "12345678"}, "seconds: 5 to 3600 are needed"),
        ({"act": "try", "text": "a", "seconds": 4, "why": "12345678"}, "seconds: 5 to 3600"),
        ({"act": "try", "text": "a", "seconds": True, "why": "12345678"}, "seconds: 5 to 3600"),
        (
            {"act": "try", "text": "a", "seconds": 60, "why": "short"},
            "why: read 5 characters, a reason of 8 to 400",
        ),
        ({"act": "keep"}, "why: read no text, a reason"),
        ({"act": "undo", "why": "12345678", "version": "1"}, "version: a number"),
        ({"act": "history", "version": -1}, "version: a number"),
        ({"act": "undo", "why": "12345678", "tried": "0" * 63}, "tried: the sha256 of a site"),
        ({"act": "try", "text": "a", "seconds": 9, "why": "12345678", "base": 1}, "base: the sha"),
        ({"act": "state", "colour": 1}, "unknown key 'colour'"),
    ],
)
def test_what_is_no_request_about_settings_is_refused_with_what_is_needed(keys, said):
    with pytest.raises(BadRequestError, match=said):
        read_request(line(**keys))
