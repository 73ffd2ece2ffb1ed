"""What passes through the hand is whole, or it is refused."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import pytest

from aff_runtime.app.hand.may import Action, Code, Place, Reason, Role
from aff_runtime.app.hand.messages import (
    MAX_PACKET_BYTES,
    Answer,
    Command,
    HandMessageError,
    Notice,
    Welcome,
    encode,
    read_said,
    read_told,
)
from tests.each_case import each_case

COMMAND = Command(
    id="0123456789abcdef",
    action=Action.ARM,
    account="anna",
    role=Role.OPERATE,
    place=Place.PANEL,
    seen="READY",
    valid_until_ns=5,
)
NOTICE = Notice(what="login", account="anna", place=Place.NETWORK)


REFUSED = replace(NOTICE, what="press refused", action="arm", code="no hand", more=2, ago_s=9)
OVER = replace(NOTICE, what="hand taken over", other="bert")


@each_case("said", [COMMAND, NOTICE, REFUSED, OVER])
def test_what_is_said_comes_through(said: Command | Notice) -> None:
    assert read_said(encode(said)) == said


@pytest.mark.parametrize(
    "told",
    [
        Welcome(version="1", ceiling=Role.VIEW, arms_from=Place.PANEL),
        Answer(id="a", ok=True, audit=3),
        Answer(id="a", ok=False, reason=Reason(code=Code.CHANGED, name="OFF")),
    ],
)
def test_what_is_told_comes_through(told: Welcome | Answer) -> None:
    assert read_told(encode(told)) == told


def test_an_answer_fits_its_packet_however_long_the_reason() -> None:
    long = Answer(id="a" * 64, ok=False, reason=Reason(code=Code.REFUSED, name="\u202e" * 9999))
    assert len(encode(long)) < MAX_PACKET_BYTES
    assert isinstance(read_told(encode(long)), Answer)


@each_case(
    ("key", "value"),
    [
        ("id", "short"),
        ("id", "x" * 65),
        ("id", "0123456789abcde\n"),
        ("id", 7),
        ("action", "stop"),
        ("action", ["arm"]),
        ("account", "anna\nbert"),
        ("account", ""),
        ("account", "a" * 33),
        ("account", "\u202eanna"),
        ("role", "root"),
        ("role", {}),
        ("place", "moon"),
        ("seen", "RUNNING"),
        ("seen", None),
        ("valid_until_ns", 1.5),
        ("valid_until_ns", True),
        ("valid_until_ns", -1),
        ("valid_until_ns", 2**63),
        ("more", 1),
    ],
)
def test_a_command_with_one_wrong_part_is_none(key: str, value: Any) -> None:
    said = json.loads(encode(COMMAND))
    said[key] = value
    with pytest.raises(HandMessageError):
        read_said(json.dumps(said).encode())


@each_case(
    ("key", "value"),
    [
        ("what", "stop"),
        ("action", "stop"),
        ("action", None),
        ("code", "because"),
        ("code", 1),
        ("other", "anna bert"),
        ("other", None),
        ("more", -1),
        ("more", True),
        ("ago_s", 1.5),
        ("ago_s", 2**63),
        ("why", "free text"),
    ],
)
def test_a_notice_with_one_wrong_part_is_none(key: str, value: Any) -> None:
    said = json.loads(encode(REFUSED))
    said[key] = value
    with pytest.raises(HandMessageError):
        read_said(json.dumps(said).encode())


@each_case("key", ["id", "action", "account", "role", "place", "seen"])
def test_a_command_that_lacks_a_part_is_none(key: str) -> None:
    said = json.loads(encode(COMMAND))
    del said[key]
    with pytest.raises(HandMessageError):
        read_said(json.dumps(said).encode())
