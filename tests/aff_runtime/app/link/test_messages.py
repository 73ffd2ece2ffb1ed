"""Every message of the link comes back as it was said, or is refused."""

from __future__ import annotations

import pytest

from aff_runtime.app.link import messages, replies
from aff_runtime.app.link.messages import MessageError, decode, encode
from aff_runtime.safety.reasons import REMOTE, SHADOW
from tests.each_case import each_case
from tests.parameter_records import record_of

SAID = [
    messages.Start(
        record=record_of(loops={"unwind": (1.0, 1.5e-17)}, shapes={"unwind": "{}"}), shadow=True
    ),
    messages.Arm(id=1),
    messages.Bypass(),
    messages.Shadow(id=2, on=False),
    messages.MeasureResponse(id=3, actuators=("unwind", "swrap")),
    messages.Parameters(id=4, record=record_of()),
    messages.Forget(id=5),
    messages.ConfigDiffers(),
    messages.Stop(),
    messages.RingMade(rights=(messages.Right(granted=False, text="FIFO: no"),)),
    messages.Blocked(text="LINE_RUN=0", others=("WEB_INTACT=0",)),
    messages.WireTroubles(troubles=("a", "b")),
    messages.LogLine(text="\u00e9"),
    messages.Probed(error="aborted"),
    messages.Probed(
        results=(
            replies.ProbeResult(
                actuator="u", sign=-1, remarks=("short",), delay_s=0.05, text="{}"
            ),
        )
    ),
    messages.ShapeNews(actuator="u", text="kept"),
    messages.ShapeLearned(actuator="u", file="{}"),
    replies.Reply(id=6, ok=True, state="ARMED"),
    replies.Reply(id=7, ok=True, duration_s=47.5),
]


def test_all_reasons_are_told_or_how_many_more_there_are() -> None:
    assert messages.Blocked.by(()) == messages.Blocked(text="")
    assert messages.Blocked.by(("a", "b")) == messages.Blocked(text="a", others=("b",))
    many = tuple(f"order {i}" for i in range(40))
    told = messages.Blocked.by(many)
    *named, last = told.text, *told.others
    assert tuple(named) == many[: len(named)]
    assert last == f"and {len(many) - len(named)} more"
    for size in (len(named) - 1, len(named)):  # nothing is left that had a number
        told = messages.Blocked.by((*many[:size], SHADOW, REMOTE))
        assert (told.text, *told.others) == (*many[:size], SHADOW, REMOTE)
    told = messages.Blocked.by((*many, SHADOW, REMOTE))
    assert (told.text, *told.others) == (*named, SHADOW, REMOTE, last)


@each_case("said", SAID, ids=lambda said: type(said).__name__)
def test_a_message_comes_back_as_it_was_said(said: messages.Message) -> None:
    assert decode(encode(said)) == said


def test_every_kind_of_message_is_tried_here() -> None:
    kinds = {*messages.Command.__args__, *messages.Report.__args__}
    assert {type(said) for said in SAID} == kinds


@each_case(
    "packet",
    [
        b"",
        b"{",
        b"[]",
        b"null",
        b"{}",
        b'{"word": "Launch"}',
        b'{"word": "Arm"}',
        b'{"word": "Arm", "id": "x"}',
        b'{"word": ["Arm"]}',
        b'{"word": "RingMade", "rights": [{"granted": true}]}',
        b"\xff",
    ],
)
def test_what_is_no_message_is_refused_with_what_was_read(packet: bytes) -> None:
    with pytest.raises(MessageError, match="not a message of this link"):
        decode(packet)
