"""The link keeps packet borders and tells death from silence."""

from __future__ import annotations

import os

import pytest

from aff_runtime.app.link.messages import Arm, Bypass, LogLine, RingMade, Start, Stop
from aff_runtime.app.link.packets import MAX_PACKET_BYTES, Link, LinkClosedError, link_pair
from tests.parameter_records import record_of


def test_messages_keep_their_borders_and_silence_is_none() -> None:
    a, b = (Link(end) for end in link_pair())
    a.send(Arm(id=1))
    a.send(Bypass())
    assert [b.receive(), b.receive(), b.receive()] == [Arm(id=1), Bypass(), None]
    a.close()
    b.close()


def test_a_parameter_record_of_100_kB_passes_in_one_packet() -> None:
    a, b = (Link(end) for end in link_pair())
    record = Start(record=record_of(site_text="x" * 100_000))
    assert a.send(record)
    assert b.receive() == record
    a.close()
    b.close()


def test_what_was_said_before_death_is_heard_and_then_the_death() -> None:
    a, b = (Link(end) for end in link_pair())
    a.send(Stop())
    a.close()
    assert b.receive() == Stop()
    with pytest.raises(LinkClosedError):
        b.receive()
    b.close()


def test_a_message_that_would_be_cut_is_not_sent_at_all() -> None:
    a, b = (Link(end) for end in link_pair())
    assert not a.send(LogLine(text="x" * (MAX_PACKET_BYTES + 1)))
    assert b.receive() is None
    a.close()
    b.close()


def test_a_descriptor_goes_with_its_message_and_with_no_other() -> None:
    a, b = (Link(end) for end in link_pair())
    ours, theirs = os.pipe()
    assert a.send(RingMade(rights=()), ours)
    assert a.send(LogLine(text=""))
    os.close(ours)
    message, passed = b.receive_passed() or (None, None)
    assert message == RingMade(rights=())
    assert passed is not None
    os.write(theirs, b"through")
    assert os.read(passed, 100) == b"through"
    assert not os.get_inheritable(passed)
    assert b.receive_passed() == (LogLine(text=""), None)
    assert b.receive_passed() is None
    for descriptor in (theirs, passed):
        os.close(descriptor)
    a.close()
    with pytest.raises(LinkClosedError):
        b.receive_passed()
    b.close()
