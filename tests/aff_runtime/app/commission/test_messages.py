"""Requests to the commissioner: checked in full, or none."""

import json

import pytest

from aff_runtime.app.commission.messages import (
    LOOKS,
    MAX_ASKED_BYTES,
    TABLE,
    WORDS,
    Request,
    RequestError,
    Why,
    read_request,
)

SIGN = {
    "do": "sign",
    "key": "k" * 43,
    "place": "panel",
    "step": 4,
    "measured": "0" * 64,
    "reason": "seen on the drive",
    "password": "tension, 90 N",
}


def line(**said):
    return json.dumps(said).encode()


def test_a_request_that_is_whole_is_taken_as_it_is():
    assert read_request(line(**SIGN)) == Request(**SIGN)
    assert read_request(b'{"do": "state"}') == Request(do="state")


@pytest.mark.parametrize("do", sorted(TABLE))
def test_a_request_has_a_field_for_every_key_of_the_table(do):
    assert set(TABLE[do]) <= set(Request.__dataclass_fields__)


def test_what_a_job_is_told_comes_back_as_it_was_and_has_no_secret():
    told = Request(**SIGN | {"step": 0}).for_job(account="carl", by="root; carl")
    assert Request.from_json(json.loads(json.dumps(told.to_json()))) == told
    assert not {"key", "password"} & set(told.to_json())
    assert (told.step, told.account, told.called) == (0, "carl", "sign 0")


@pytest.mark.parametrize(
    "change",
    [
        {"do": "arm"},
        {"do": "probe"},
        {"key": "../../etc"},
        {"key": 7},
        {"place": "moon"},
        {"step": True},
        {"step": -1},
        {"step": 4.0},
        {"measured": "0" * 63},
        {"measured": "G" * 64},
        {"reason": "x" * 2001},
        {"reason": "\ud800 half a sign"},
        {"reason": "turned \u202e round"},
        {"reason": "\x1b[2J"},
        {"password": "x" * 257},
        {"more": 1},
        {"by": "somebody else"},
        {"site": "/etc/shadow"},
    ],
)
def test_what_is_not_what_it_must_be_is_no_request(change):
    with pytest.raises(RequestError):
        read_request(line(**(SIGN | change)))


@pytest.mark.parametrize("missing", sorted(SIGN))
def test_a_part_that_is_missing_is_missed(missing):
    with pytest.raises(RequestError):
        read_request(line(**{key: value for key, value in SIGN.items() if key != missing}))


@pytest.mark.parametrize(
    "text", [b"", b"{", b"[]", b"\xff", b"[" * 8000, b" " * (MAX_ASKED_BYTES + 1), b'{"do": []}']
)
def test_what_is_no_json_object_is_no_request(text):
    with pytest.raises(RequestError):
        read_request(text)


def test_nothing_that_moves_the_line_can_be_asked_and_what_changes_something_needs_a_key():
    assert not {"arm", "bypass", "probe", "shadow", "forget", "stop service"} & set(TABLE)
    assert {do for do, keys in TABLE.items() if "key" not in keys} == {*LOOKS, "open"}
    assert set(WORDS) == set(Why)
