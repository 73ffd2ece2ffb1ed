"""What comes over the link and is no message ends nothing and leaves nothing open."""

from __future__ import annotations

import os
import socket
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from aff_runtime.app.link.messages import LogLine, MessageError, decode, encode
from aff_runtime.app.link.packets import MAX_PACKET_BYTES
from aff_runtime.app.link.replies import Reply
from aff_runtime.app.supervisor.control_child import ControlChild
from tests.parameter_records import record_of

pytestmark = pytest.mark.processes

DEEP = (MAX_PACKET_BYTES // 2) * b"["
NONE_OF_OURS = (
    *(b"1", b"[]", b"null", b"\xff", b'{"word": 1}', b'{"word": "Message"}'),
    *(b'{"word": "OfTheNextRelease"}', b'{"word": "Reply", "id": 1e999, "ok": true}', DEEP),
)


@pytest.mark.parametrize("packet", NONE_OF_OURS)
def test_what_is_no_message_is_always_told_as_that(packet: bytes) -> None:
    with pytest.raises(MessageError, match="not a message of this link"):
        decode(packet)


@pytest.fixture
def child(monkeypatch: pytest.MonkeyPatch) -> Iterator[tuple[ControlChild, socket.socket]]:
    """A control process that says what a test says; the end that the test speaks into."""
    ends: list[socket.socket] = []

    def started(_command: Any, *, pass_fds: list[int], **_how: Any) -> None:
        ends.append(socket.socket(fileno=os.dup(pass_fds[0])))

    monkeypatch.setattr(subprocess, "Popen", started)
    control = ControlChild(record_of(), shadow=False)
    yield control, ends[0]
    control.close()
    ends[0].close()


@pytest.mark.parametrize("packet", NONE_OF_OURS)
def test_the_supervisor_logs_what_is_no_message_and_hears_the_next(
    child: tuple[ControlChild, socket.socket], packet: bytes
) -> None:
    """Its own end would take the correction back, and the record with it."""
    control, end = child
    answer = Reply(id=1, ok=True)
    end.send(packet)
    end.send(encode(answer))
    said, heard = control.replies()
    assert isinstance(said, LogLine)
    assert said.text.startswith("not a message of this link: ")
    assert heard == answer


def test_a_descriptor_that_comes_with_no_message_is_closed(
    child: tuple[ControlChild, socket.socket], tmp_path: Path
) -> None:
    control, end = child
    control.replies()
    with (tmp_path / "ring").open("wb") as ring:
        before = len(os.listdir("/proc/self/fd"))
        for _ in range(20):
            socket.send_fds(end, [b"1"], [ring.fileno()])
            control.replies()
        assert len(os.listdir("/proc/self/fd")) == before
