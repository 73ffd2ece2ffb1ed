"""The request socket under callers who babble, crowd, pipeline, fall silent or are refused."""

from __future__ import annotations

import array
import contextlib
import json
import os
import re
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from aff_runtime.app.link.answers import Done, ProbeDone
from aff_runtime.app.link.request_client import ServiceClient
from aff_runtime.app.link.request_socket import BACKLOG, MAX_CALLERS
from aff_runtime.app.link.requests import MAX_ID_CHARACTERS, MAX_REQUEST_BYTES
from aff_runtime.app.supervisor.request_desk import MAX_OWED, MAX_WAITING
from aff_runtime.base.errors import WireError
from tests.security.desk import STATUS_BYTES, Desk, ended

pytestmark = pytest.mark.wire


@pytest.fixture
def desk(tmp_path: Path) -> Iterator[Desk]:
    made = Desk(tmp_path)
    yield made
    made.close()


# --- what is no request ---------------------------------------------------------------------

BABBLE = {
    "text without an end": b"x" * 5000,
    "a megabyte": b"x" * 60_000,
    "brackets": b"[" * 4000 + b"\n",
    "NUL": b"\0\0\0\n",
    "a number of 4000 digits": b"9" * 4000 + b"\n",
    "an array": b'["arm"]\n',
    "an empty line": b"\n",
    "half an object": b'{"do": "arm"\n',
    "UTF-16": '{"do": "arm"}\n'.encode("utf-16"),
    "a byte order mark": '\ufeff{"do": "arm"}\n'.encode(),
    "a line of 8 kB": b'{"do": "status", "by": "' + b"x" * 4300 + b'"}\n',
    "bytes that are no text": b"\xff\xfe\xfd{}\n",
}


@pytest.mark.parametrize("said", BABBLE.values(), ids=BABBLE.keys())
def test_babble_is_told_what_a_request_is_and_its_caller_sent_away(
    desk: Desk, said: bytes
) -> None:
    client = desk.connect()
    other = desk.connect()
    while said:
        try:
            said = said[client.send(said) :]
        except (BrokenPipeError, ConnectionResetError):
            break
        desk.serve_all()
    (answer,) = desk.answers(client)
    assert answer["ok"] is False
    assert f"{MAX_REQUEST_BYTES} bytes at most" in answer["message"]
    assert ended(client)
    other.send(b'{"do": "status"}\n')
    assert [a["ok"] for a in desk.answers(other)] == [True]
    assert [asked.request.do for asked in desk.asked] == ["status"]


# --- requests that are refused --------------------------------------------------------------

REFUSED = {
    "an inner word": ({"do": "STOP"}, "unknown request 'STOP'"),
    "another inner word": ({"do": "PARAMS", "record": {}}, "unknown key 'record'"),
    "no word": ({}, "unknown request None"),
    "a list for a word": ({"do": [[[]]]}, "unknown request a list"),
    "an escape for a word": ({"do": "\x1b[2J\n"}, r"unknown request '\\x1b\[2J\\n'"),
    "text for a boolean": ({"do": "shadow", "on": "false"}, "on: true or false .* not 'false'"),
    "a number for a boolean": ({"do": "shadow", "on": 0}, "on: true or false .* not 0"),
    "null for a boolean": ({"do": "shadow", "on": None}, "on: true or false .* not None"),
    "a misspelt key": ({"do": "probe", "actuator": ["unwind"]}, "unknown key 'actuator'"),
    "a text for a list": ({"do": "probe", "actuators": "unwind"}, "a list of names"),
    "numbers for names": ({"do": "probe", "actuators": [1, 2]}, "a list of names"),
    "lists for names": ({"do": "probe", "actuators": [[["unwind"]]]}, "a list of names"),
    "null for a list": ({"do": "probe", "actuators": None}, "a list of names"),
    "a text for rolls": ({"do": "forget", "rolls": "r4"}, "rolls: a list of names"),
    "numbers for rolls": ({"do": "forget", "rolls": [4]}, "rolls: a list of names"),
    "a long claim": ({"do": "arm", "by": "x" * 65}, "by: a text of 64 characters"),
    "a claim that is no text": ({"do": "arm", "by": ["x"]}, "by: a text of 64 characters"),
    "a long id": ({"do": "arm", "id": "x" * (MAX_ID_CHARACTERS + 1)}, "id: a whole number"),
    "a broken id": ({"do": "arm", "id": 1.5}, "id: a whole number"),
    "a huge id": ({"do": "arm", "id": 10**400}, "id: a whole number"),
    "a boolean id": ({"do": "arm", "id": True}, "id: a whole number"),
    "an object for an id": ({"do": "arm", "id": {}}, "id: a whole number"),
    "NaN for an id": ({"do": "arm", "id": float("nan")}, "id: a whole number"),
}


@pytest.mark.parametrize(("request_", "why"), REFUSED.values(), ids=REFUSED.keys())
def test_a_request_with_a_wrong_value_is_refused_and_nothing_is_done(
    desk: Desk, request_: dict[str, object], why: str
) -> None:
    client = desk.connect()
    client.send(json.dumps(request_).encode() + b"\n")
    client.send(b'{"do": "status"}\n')
    refused, status = desk.answers(client)
    assert refused["ok"] is False
    assert refused["exit_code"] == 4
    assert re.search(why, refused["message"])
    assert status["ok"] is True
    assert [asked.request.do for asked in desk.asked] == ["status"]


def test_escapes_and_a_key_given_twice_do_no_harm(desk: Desk) -> None:
    client = desk.connect()
    client.send(b'{"do": "\\u0062ypass"}\n{"do": "arm", "do": "bypass"}\n')
    assert [a["ok"] for a in desk.answers(client)] == [True, True]
    assert [asked.request.do for asked in desk.asked] == ["bypass", "bypass"]


# --- every request gets its answer ----------------------------------------------------------


def test_each_of_250_pipelined_requests_gets_its_own_answer(desk: Desk) -> None:
    client = desk.connect()
    lines = b"".join(b'{"do": "status", "id": %d}\n' % k for k in range(250))
    heard = []
    while lines:
        lines = lines[client.send(lines) :]
        heard += [answer["id"] for answer in desk.answers(client)]
    heard += [answer["id"] for answer in desk.answers(client)]
    assert heard == list(range(250))


def test_who_does_not_listen_is_not_heard_either_and_others_are(desk: Desk) -> None:
    deaf, other = desk.connect(), desk.connect()
    deaf.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 8192)
    with contextlib.suppress(BlockingIOError):
        for _ in range(1000):
            deaf.send(b'{"do": "status"}\n' * 50)
            desk.serve_all()
    served = len(desk.asked)
    assert served < 100  # what fits the socket's buffers, and no more
    (caller,) = [one for one in desk.requests.callers.values() if one.has_more]
    assert len(caller._unsent) <= STATUS_BYTES + 100  # of one answer at most
    other.send(b'{"do": "bypass", "id": "now"}\n')
    assert list(desk.answers(other)) == [{"ok": True, "id": "now"}]
    answers = len(list(desk.answers(deaf)))
    assert answers == len(desk.asked) - 1 > served


def test_an_answer_given_later_carries_the_id_of_its_request(desk: Desk) -> None:
    client = desk.connect()
    client.send(b'{"do": "arm", "id": "a"}\n{"do": "probe", "id": 2}\n{"do": "status"}\n')
    (status,) = desk.answers(client)
    assert "id" not in status
    for asked in reversed(desk.waiting):
        asked.answer(Done(message=asked.request.do))
    assert list(desk.answers(client)) == [
        {"ok": True, "message": "probe", "id": 2},
        {"ok": True, "message": "arm", "id": "a"},
    ]


def test_a_later_answer_that_is_not_taken_at_once_arrives_whole(desk: Desk) -> None:
    client = desk.connect()
    client.send(b'{"do": "probe"}\n')
    desk.serve_all()
    desk.waiting[0].answer(Done(message="y" * 3_000_000))
    (answer,) = desk.answers(client)
    assert len(answer["message"]) == 3_000_000


def test_questions_beyond_the_bound_are_refused_with_their_id_and_bypass_is_not(
    desk: Desk,
) -> None:
    client = desk.connect()
    for k in range(MAX_OWED + 3):
        client.send(b'{"do": "arm", "id": %d}\n' % k)
    client.send(b'{"do": "bypass", "id": "off"}\n')
    *refused, bypassed = desk.answers(client)
    assert [answer["id"] for answer in refused] == [MAX_OWED, MAX_OWED + 1, MAX_OWED + 2]
    assert all("busy" in answer["message"] for answer in refused)
    assert bypassed == {"ok": True, "id": "off"}


# --- crowds ---------------------------------------------------------------------------------


def test_a_caller_who_waits_for_a_probe_keeps_its_place_when_others_crowd_in(desk: Desk) -> None:
    patient = desk.connect()
    patient.send(b'{"do": "probe"}\n')
    desk.serve_all()
    crowd = [desk.connect() for _ in range(MAX_CALLERS + 1)]
    assert ended(crowd[0])
    desk.waiting[0].answer(ProbeDone(results=()))
    assert list(desk.answers(patient)) == [{"ok": True, "results": []}]


def test_who_is_sent_away_from_a_crowd_is_told_why(desk: Desk) -> None:
    crowd = [desk.connect() for _ in range(MAX_CALLERS + 1)]
    (answer,) = desk.answers(crowd[0])
    assert answer["ok"] is False
    assert "too many callers" in answer["message"]
    assert not any(ended(one) for one in crowd[1:])


def test_however_many_wait_the_next_bypass_is_heard(desk: Desk) -> None:
    waiting = []
    for _ in range(MAX_WAITING + 4):
        client = desk.connect()
        client.send(b'{"do": "arm"}\n')
        waiting.append(client)
    desk.serve_all()
    assert len(desk.waiting) == MAX_WAITING
    last = desk.connect()
    last.send(b'{"do": "bypass"}\n')
    assert list(desk.answers(last)) == [{"ok": True}]


def test_200_callers_who_come_and_go_and_40_who_say_half_a_word_leave_nothing_behind(
    desk: Desk,
) -> None:
    before = len(os.listdir("/proc/self/fd"))
    for _ in range(200):
        desk.connect().close()
    half = [desk.connect() for _ in range(40)]
    for one in half:
        try:
            one.send(b'{"do": "ar')
        except (BrokenPipeError, ConnectionResetError):
            continue
    last = desk.connect()
    last.send(b'{"do": "status"}\n')
    assert len(list(desk.answers(last))) == 1
    for one in (*half, last):
        one.close()
    desk.serve_all()
    assert not desk.requests.callers
    assert len(os.listdir("/proc/self/fd")) == before


def test_descriptors_passed_with_a_request_are_not_kept(desk: Desk) -> None:
    client = desk.connect()
    ours, theirs = os.pipe()
    before = len(os.listdir("/proc/self/fd"))
    rights = [(socket.SOL_SOCKET, socket.SCM_RIGHTS, array.array("i", [ours] * 50))]
    client.sendmsg([b'{"do": "status"}\n'], rights)
    assert len(list(desk.answers(client))) == 1
    assert len(os.listdir("/proc/self/fd")) == before
    for descriptor in (ours, theirs):
        os.close(descriptor)


def test_a_caller_who_hangs_up_with_a_question_open_is_forgotten(desk: Desk) -> None:
    client = desk.connect()
    client.send(b'{"do": "probe"}\n')
    desk.serve_all()
    client.close()
    desk.serve_all()
    (gone,) = desk.gone
    assert gone is desk.waiting[0].caller
    desk.waiting[0].answer(Done())  # to nobody
    assert not desk.requests.callers


# --- the other side -------------------------------------------------------------------------


def test_a_full_queue_is_told_as_busy_and_not_as_no_service(desk: Desk) -> None:
    with contextlib.ExitStack() as queue:
        for _ in range(BACKLOG + 1):
            one = queue.enter_context(socket.socket(socket.AF_UNIX, socket.SOCK_STREAM))
            one.connect(str(desk.path))
        with pytest.raises(WireError, match=r"busy: its queue stayed full .* try again"):
            ServiceClient(desk.path, timeout_s=0.05)


@pytest.mark.parametrize(
    "answer", [b"no JSON\n", b"[1]\n", b"[" * 100_000 + b"\n", b"\xff\n", b'{"ok": true']
)
def test_an_answer_that_cannot_be_read_is_an_error_in_words(tmp_path: Path, answer: bytes) -> None:
    (tmp_path / "rt").mkdir(mode=0o700)
    path = tmp_path / "rt" / "control.sock"
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as server:
        server.bind(str(path))
        server.listen(1)
        client = ServiceClient(path)
        connection, _ = server.accept()
        connection.sendall(answer)
        connection.shutdown(socket.SHUT_WR)
        with pytest.raises(WireError, match="the answer cannot be read"):
            client.ask("status")
        client.close()
        connection.close()
