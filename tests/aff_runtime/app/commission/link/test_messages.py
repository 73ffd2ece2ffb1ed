"""Requests to the commissioner: checked in full, or none."""

import json

import pytest

from aff_runtime.app.commission.link.messages import (
    LOOKS,
    MAX_ASKED_BYTES,
    PACKET_BYTES,
    TABLE,
    WORDS,
    Request,
    RequestError,
    Why,
    encode,
    read_request,
)
from aff_runtime.config.yaml_marks import MAX_BYTES
from tests.each_case import each_case

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


@each_case("do", sorted(TABLE))
def test_a_request_has_a_field_for_every_key_of_the_table(do):
    assert set(TABLE[do]) <= set(Request.__dataclass_fields__)


def test_what_a_job_is_told_comes_back_as_it_was_and_has_no_secret():
    told = Request(**SIGN | {"step": 0}).for_job(account="carl", by="root; carl")
    assert Request.from_json(json.loads(json.dumps(told.to_json()))) == told
    assert not {"key", "password"} & set(told.to_json())
    assert (told.step, told.account, told.called) == (0, "carl", "sign 0")


@each_case(
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


@each_case("missing", sorted(SIGN))
def test_a_part_that_is_missing_is_missed(missing):
    with pytest.raises(RequestError):
        read_request(line(**{key: value for key, value in SIGN.items() if key != missing}))


EDIT = {"do": "settings_diff", "base": "0" * 64, "edits": "", "site_text": "a: 1\n"}


@pytest.mark.parametrize("size", [1, PACKET_BYTES - 200, MAX_BYTES])
def test_a_request_with_the_longest_site_file_has_room_and_ends_with_a_short_packet(size):
    for char in "\n\u00fc":
        asked = Request(**EDIT | {"site_text": char * (size // len(char.encode()))})
        said = encode(asked)
        assert read_request(said) == asked
        assert len(said) % PACKET_BYTES
    both = encode(
        Request(**EDIT | {"do": "settings_text", "site_text": "\n" * size, "former": "\n" * size})
    )
    assert len(read_request(both).former) == size


def test_every_length_ends_with_a_short_packet():
    least = len(encode(Request(**EDIT | {"site_text": ""})))
    for more in (-1, 0, 1):
        text = "a" * (PACKET_BYTES - least + more)
        said = encode(Request(**EDIT | {"site_text": text}))
        assert len(said) == PACKET_BYTES + (more if more else 1)
        assert read_request(said).site_text == text


@each_case(
    "wrong",
    [
        {"site_text": "a" * (MAX_BYTES + 1)},
        {"site_text": "\ud800"},
        {"site_text": 7},
        {"edits": "a" * (MAX_ASKED_BYTES + 1)},
        {"base": ""},
    ],
)
def test_what_no_site_file_can_be_is_no_request(wrong):
    with pytest.raises(RequestError):
        read_request(line(**(EDIT | wrong)))


def test_only_requests_with_site_files_are_long():
    said = line(**SIGN) + b" " * MAX_ASKED_BYTES
    with pytest.raises(RequestError):
        read_request(said)
    assert read_request(line(**EDIT) + b" " * MAX_ASKED_BYTES) == Request(**EDIT)


@each_case(
    "text", [b"", b"{", b"[]", b"\xff", b"[" * 8000, b" " * (MAX_ASKED_BYTES + 1), b'{"do": []}']
)
def test_what_is_no_json_object_is_no_request(text):
    with pytest.raises(RequestError):
        read_request(text)


def test_nothing_that_moves_the_line_can_be_asked_and_what_changes_something_needs_a_key():
    assert not {"arm", "bypass", "probe", "shadow", "forget", "stop service"} & set(TABLE)
    assert {do for do, keys in TABLE.items() if "key" not in keys} == {*LOOKS, "open"}
    assert set(WORDS) == set(Why)
