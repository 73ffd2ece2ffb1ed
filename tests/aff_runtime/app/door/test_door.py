"""Who looks on gets the ring and the facts, and is never listened to."""

from __future__ import annotations

import contextlib
import ctypes
import mmap
import os
import socket
import stat
from collections.abc import Iterator
from pathlib import Path

import pytest

from aff_runtime.app.door.client import DoorClient
from aff_runtime.app.door.messages import (
    DoorMessageError,
    Facts,
    Hello,
    RingGone,
    RingPassed,
    SentAway,
    decode,
    encode,
)
from aff_runtime.app.supervisor.door import FACTS_NS, HURRY_NS, MAX_VISITORS, PATIENCE_NS
from aff_runtime.base.errors import RefusedError, WireError
from aff_runtime.telemetry.ring import RingReader
from tests.aff_runtime.app.door.stand import Stand, heard
from tests.aff_runtime.app.link.left_behind import put
from tests.each_case import each_case


@pytest.fixture
def stand(tmp_path: Path) -> Iterator[Stand]:
    (tmp_path / "rt").mkdir(mode=0o700)
    stand = Stand(tmp_path / "rt")
    yield stand
    stand.close()


def drain(client: DoorClient) -> None:
    """Take what comes until nothing does, or the door is closed."""
    for message in iter(client.receive, None):
        if isinstance(message, RingPassed):
            os.close(message.descriptor)


def ring_of(messages: list[object]) -> RingReader:
    (passed,) = [one for one in messages if isinstance(one, RingPassed)]
    return RingReader(passed.descriptor)


def test_a_visitor_hears_hello_the_ring_and_the_facts(stand: Stand) -> None:
    client = stand.visit()
    stand.round(stand.ring)
    hello, gone, passed, facts = heard(client)
    assert isinstance(hello, Hello)
    assert hello.may == ("view",)
    assert isinstance(gone, RingGone)
    assert isinstance(facts, Facts)
    assert (facts.blocked, facts.also_blocking) == ("WEB_INTACT=0", ("SPLICE",))
    assert facts.status.line == "L"
    ring = ring_of([passed])
    stand.writer.write((0.005, 88.9))
    assert ring.status() == {"time_s": 0.005, "tension_N": 88.9}
    assert ring.writer_alive()
    ring.close()


def test_the_descriptor_reads_and_cannot_write_grow_or_map_for_writing(stand: Stand) -> None:
    client = stand.visit()
    stand.round(stand.ring)
    ring = ring_of(heard(client))
    with pytest.raises(OSError, match="Bad file descriptor"):
        os.write(ring.fileno(), b"x")
    with pytest.raises(OSError, match="Invalid argument"):
        os.ftruncate(ring.fileno(), 0)
    with pytest.raises(PermissionError):
        mmap.mmap(ring.fileno(), 4096, prot=mmap.PROT_READ | mmap.PROT_WRITE)
    ring.close()


def test_a_dead_writer_is_known_by_the_lock(stand: Stand) -> None:
    client = stand.visit()
    stand.round(stand.ring)
    ring = ring_of(heard(client))
    stand.writer.close()
    assert not ring.writer_alive()
    ring.close()


def test_another_ring_is_another_descriptor_and_none_is_told_too(stand: Stand) -> None:
    client = stand.visit()
    stand.round(stand.ring)
    ring_of(heard(client)).close()
    writer, reader = stand.new_ring()
    writer.write((1.0, 2.0))
    stand.round(reader)
    fresh = ring_of(heard(client))
    assert fresh.status() == {"time_s": 1.0, "tension_N": 2.0}
    fresh.close()
    stand.round(None)
    assert [type(one) for one in heard(client)] == [RingGone]
    writer.close()
    reader.close()


def test_facts_come_twice_a_second_and_at_once_when_something_changed(stand: Stand) -> None:
    client = stand.visit()
    stand.round(stand.ring)
    ring_of(heard(client)).close()
    stand.round(stand.ring)
    assert heard(client) == []
    stand.clock.advance_ns(HURRY_NS)
    stand.door.hurry()
    stand.round(stand.ring)
    assert [type(one) for one in heard(client)] == [Facts]
    stand.clock.advance_ns(FACTS_NS)
    stand.round(stand.ring)
    assert [type(one) for one in heard(client)] == [Facts]


def test_without_a_visitor_nothing_is_worked_out(stand: Stand) -> None:
    stand.round(stand.ring)
    assert stand.asked == 0


@pytest.mark.parametrize(
    "said",
    [b'{"do": "arm"}\n', b'{"do": "bypass"}\n', b'{"do":"stop"}', b"", b"\x00" * 60_000, b"{"],
)
def test_who_says_anything_is_sent_away_and_the_others_stay(stand: Stand, said: bytes) -> None:
    other = stand.visit()
    speaker = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    speaker.connect(str(stand.path))
    stand.round(stand.ring)
    speaker.send(said)
    stand.round(stand.ring)
    told = []
    while packet := speaker.recv(1 << 18):
        told.append(decode(packet))
    if said:  # an empty packet is how the kernel tells of one who has left
        assert isinstance(told[-1], SentAway)
        assert "nothing is heard here" in told[-1].message
    speaker.close()
    ring_of(heard(other)).close()
    stand.clock.advance_ns(HURRY_NS)
    stand.door.hurry()
    stand.round(stand.ring)
    assert [type(one) for one in heard(other)] == [Facts]


def test_who_takes_nothing_is_let_go_and_holds_up_nobody(stand: Stand) -> None:
    deaf, other = stand.visit(), stand.visit()
    stand.round(stand.ring)
    ring_of(heard(other)).close()
    for _ in range(3000):
        stand.clock.advance_ns(FACTS_NS)
        stand.round(stand.ring)
        heard(other)
        if len(stand.door._visitors) == 1:
            break
    assert len(stand.door._visitors) == 1
    assert stand.clock.now_ns() > PATIENCE_NS
    with pytest.raises(WireError, match="closed the door"):
        drain(deaf)


def test_of_too_many_the_first_goes(stand: Stand) -> None:
    first = stand.visit()
    stand.round(stand.ring)
    for _ in range(MAX_VISITORS):
        stand.visit()
        stand.round(stand.ring)
    with pytest.raises(WireError, match="closed the door"):
        drain(first)
    for client in stand.clients[1:]:
        ring_of(heard(client)).close()


def test_a_private_door_is_0600_and_one_for_a_group_0660(tmp_path: Path) -> None:
    for name, is_private, mode in (("a", True, 0o600), ("b", False, 0o660)):
        (tmp_path / name).mkdir(mode=0o750)
        stand = Stand(tmp_path / name, is_private=is_private)
        assert stat.S_IMODE(stand.path.stat().st_mode) == mode
        stand.close()
        assert not stand.path.exists()


def test_a_folder_that_others_may_write_in_is_refused(tmp_path: Path) -> None:
    (tmp_path / "open").mkdir()
    (tmp_path / "open").chmod(0o770)
    with pytest.raises(RefusedError, match="0770 lets others write in it"):
        Stand(tmp_path / "open")


def test_a_door_at_which_another_service_stands_is_not_taken(stand: Stand) -> None:
    with pytest.raises(RefusedError, match="another service listens at this socket"):
        Stand(stand.path.parent)
    stand.visit()


@pytest.mark.parametrize("kind", [socket.SOCK_SEQPACKET, socket.SOCK_STREAM])
def test_a_path_where_a_service_listens_that_cannot_answer_now_is_not_taken(
    tmp_path: Path, kind: socket.SocketKind
) -> None:
    path = str(tmp_path / "door.sock")
    with socket.socket(socket.AF_UNIX, kind) as busy, socket.socket(socket.AF_UNIX, kind) as waits:
        busy.bind(path)
        busy.listen(0)
        waits.connect(path)  # its place in the queue is taken
        with pytest.raises(RefusedError, match="another service listens at this socket"):
            Stand(tmp_path)


def test_a_door_that_a_dead_service_left_behind_is_taken(tmp_path: Path) -> None:
    with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as left:
        left.bind(str(tmp_path / "door.sock"))
        left.listen(1)
    stand = Stand(tmp_path)
    stand.visit()
    stand.close()


def identity(found: os.stat_result) -> tuple[int, ...]:
    """Return what says that a file is the same; a link that was followed has another atime."""
    return (found.st_dev, found.st_ino, found.st_mode, found.st_size, found.st_mtime_ns)


@pytest.mark.parametrize("kind", ["file", "link", "pipe", "folder"])
def test_what_is_no_socket_stays_where_it_is(tmp_path: Path, kind: str) -> None:
    path = tmp_path / "door.sock"
    before = put(kind, path)
    with pytest.raises(RefusedError, match=r"is no socket and stays; .*--door-dir"):
        Stand(tmp_path)
    assert identity(path.lstat()) == identity(before)


@pytest.mark.parametrize("kind", ["file", "socket"])
def test_a_door_that_closes_takes_away_its_own_socket_alone(tmp_path: Path, kind: str) -> None:
    (tmp_path / "rt").mkdir(mode=0o700)
    stand = Stand(tmp_path / "rt")
    stand.path.rename(tmp_path / "aside")
    before = put(kind, stand.path)
    stand.close()
    assert identity(stand.path.lstat()) == identity(before)


def test_where_nobody_opens_the_reason_and_the_way_are_told(tmp_path: Path) -> None:
    with pytest.raises(WireError, match="no service opens this door"):
        DoorClient(tmp_path / "door.sock")


@each_case("packet", [b"", b"1", b"[]", b'{"push": 1}', b'{"push": "facts"}', b"\xff"])
def test_what_is_no_message_is_an_error_and_nothing_worse(packet: bytes) -> None:
    with pytest.raises(DoorMessageError):
        decode(packet)


def test_messages_come_back_as_they_went_out() -> None:
    for message in (Hello(version="1"), RingPassed(), RingGone(), SentAway()):
        assert decode(encode(message)) == message


def test_a_service_gone_is_told(stand: Stand) -> None:
    client = stand.visit()
    stand.round(None)
    heard(client)
    for key in list(stand.selector.get_map().values()):
        with contextlib.suppress(OSError):
            if key.data is not None:
                key.data.connection.close()
    with pytest.raises(WireError):
        client.receive()
    stand.door._visitors.clear()


def as_another_user(descriptor: int) -> int:
    """Return what another user can do with a descriptor: 1 reads, 2 opens it anew, 4 to write."""
    child = os.fork()
    if child:
        return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    can = 0
    os.setresuid(65534, 65534, 65534)
    ctypes.CDLL(None).prctl(4, 1, 0, 0, 0)  # dumpable again: /proc/self is its own
    with contextlib.suppress(Exception):
        can += RingReader(descriptor).status() == {"time_s": 0.005, "tension_N": 88.9}
    for bit, flags in ((2, os.O_RDONLY), (4, os.O_RDWR)):
        with contextlib.suppress(OSError):
            os.open(f"/proc/self/fd/{descriptor}", flags)
            can += bit
    os._exit(can)


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can be another user")
def test_another_user_reads_what_was_passed_and_can_open_nothing(stand: Stand) -> None:
    client = stand.visit()
    stand.writer.write((0.005, 88.9))
    stand.round(stand.ring)
    (passed,) = [one for one in heard(client) if isinstance(one, RingPassed)]
    assert as_another_user(passed.descriptor) == 1
    os.close(passed.descriptor)
