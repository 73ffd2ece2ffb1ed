"""The door under floods, slow readers and lies: who serves it and who looks through it live."""

from __future__ import annotations

import array
import gc
import os
import socket
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from aff_hmi.layout import Layout, layout_of
from aff_hmi.metrics import Metrics
from aff_hmi.view import view_of
from aff_hmi.watch import RETRY_NS, Watch
from aff_runtime.app.door.client import DoorClient
from aff_runtime.app.door.messages import Facts, Hello, RingPassed, encode
from aff_runtime.app.supervisor.door import FACTS_NS, HURRY_NS, MAX_VISITORS, PATIENCE_NS
from aff_runtime.base.errors import WireError
from tests.aff_hmi.moments import facts, row
from tests.aff_runtime.app.door.stand import Stand, heard
from tests.aff_runtime.app.link.left_behind import put
from tests.doubles.virtual_clock import VirtualClock


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "rt").mkdir(mode=0o700)
    return tmp_path / "rt"


@pytest.fixture
def stand(folder: Path) -> Iterator[Stand]:
    found = Stand(folder)
    yield found
    found.close()


@pytest.fixture(scope="module", autouse=True)
def few_to_look_through() -> None:
    """Leave what thousands of earlier tests made out of the collections of these."""
    gc.collect()
    gc.freeze()


def open_files() -> int:
    gc.collect()  # what earlier tests left open is no change of this one
    return len(os.listdir("/proc/self/fd"))


def knock(path: Path) -> socket.socket:
    """Return one end that has come to a door and hears nothing."""
    end = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    end.connect(str(path))
    return end


# --- who serves it ---------------------------------------------------------------------------


def test_300_who_come_and_go_leave_nothing_and_cost_one_look_at_the_service(stand: Stand) -> None:
    before = open_files()
    for _ in range(300):
        end = knock(stand.path)
        stand.round(stand.ring)
        end.close()
    stand.round(stand.ring)
    assert open_files() == before
    assert stand.asked == 1  # no time has gone by
    stand.clock.advance_ns(FACTS_NS)
    last = stand.visit()
    stand.round(stand.ring)
    assert any(isinstance(one, Facts) for one in heard_and_closed(last))


def test_who_comes_in_a_flood_is_told_the_facts_a_moment_later(stand: Stand) -> None:
    first = stand.visit()
    stand.round(stand.ring)
    assert any(isinstance(one, Facts) for one in heard_and_closed(first))
    second = stand.visit()
    stand.round(stand.ring)
    assert not any(isinstance(one, Facts) for one in heard_and_closed(second))
    stand.clock.advance_ns(HURRY_NS)
    stand.round(stand.ring)
    assert [type(one) for one in heard(second)] == [Facts]


def test_of_200_who_stay_no_more_are_kept_than_there_are_places(stand: Stand) -> None:
    before = open_files()
    ends = []
    for _ in range(200):
        ends.append(knock(stand.path))
        stand.round(stand.ring)
        assert len(stand.door._visitors) <= MAX_VISITORS
    assert open_files() == before + len(ends) + MAX_VISITORS
    for end in ends:
        end.close()
    stand.round(stand.ring)
    assert open_files() == before
    assert not stand.door._visitors


def test_when_all_who_look_are_deaf_a_new_one_is_heard_out_at_once(stand: Stand) -> None:
    deaf = [knock(stand.path) for _ in range(MAX_VISITORS)]
    for _ in range(500):  # until no queue takes anything more
        stand.clock.advance_ns(min(FACTS_NS, PATIENCE_NS // 600))
        stand.door.hurry()
        stand.round(stand.ring)
    client = stand.visit()
    stand.round(stand.ring)
    stand.clock.advance_ns(FACTS_NS)
    stand.round(stand.ring)
    kinds = [type(one) for one in heard_and_closed(client)]
    assert kinds[0] is Hello
    assert Facts in kinds
    for end in deaf:
        end.close()


def test_what_a_visitor_passes_along_with_words_is_not_kept(stand: Stand) -> None:
    end = knock(stand.path)
    stand.round(stand.ring)
    before = open_files()
    rights = array.array("i", [0] * 50)
    end.sendmsg([b'{"do": "arm"}'], [(socket.SOL_SOCKET, socket.SCM_RIGHTS, rights)])
    stand.round(stand.ring)
    assert open_files() == before - 1  # the visitor's own
    end.close()


def test_a_door_whose_file_was_taken_away_serves_who_is_there_and_closes(stand: Stand) -> None:
    client = stand.visit()
    stand.round(stand.ring)
    heard_and_closed(client)
    stand.path.unlink()
    with pytest.raises(WireError, match="no service opens this door"):
        stand.visit()
    stand.clock.advance_ns(FACTS_NS)
    stand.round(stand.ring)
    assert [type(one) for one in heard(client)] == [Facts]


def heard_and_closed(client: DoorClient) -> list[object]:
    """Return what a visitor has been told; a ring is let go of."""
    found = heard(client)
    for one in found:
        if isinstance(one, RingPassed):
            os.close(one.descriptor)
    return list(found)


# --- who looks through it --------------------------------------------------------------------

HELLO = encode(Hello(version="1"))
RING = encode(RingPassed())
LIES = {
    "half a line": [HELLO, encode(facts())[:200]],
    "no hello": [encode(facts())[:-1]],
    "empty facts": [HELLO, b'{"push": "facts", "status": {}, "blocked": "", "wire": []}'],
    "no words": [HELLO, b"\xff\x00" * 300],
    "deep": [HELLO, b"[" * 100_000],
    "another protocol": [encode(Hello(version="1", protocol=2))],
    "a ring without one": [HELLO, RING],
    "a number that is none": [HELLO, encode(facts()).replace(b"0.005", b'"x"')[:-20]],
}


class Liar:
    """Listens where a service should and says what it is told to."""

    def __init__(self, path: Path) -> None:
        self.listener = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.listener.bind(str(path))
        self.listener.listen(1)
        self.ends: list[socket.socket] = []

    def let_in(self) -> socket.socket:
        self.ends.append(self.listener.accept()[0])
        return self.ends[-1]

    def close(self) -> None:
        for end in (*self.ends, self.listener):
            end.close()


@pytest.fixture
def liar(folder: Path) -> Iterator[Liar]:
    found = Liar(folder / "door.sock")
    yield found
    found.close()


@pytest.fixture
def watch(folder: Path) -> Iterator[Watch]:
    found = Watch(folder / "door.sock", VirtualClock(1))
    yield found
    found.close()


def is_shown(watch: Watch) -> str:
    """Return the state that a page would show, and have all of it worked out."""
    seen = watch.seen()
    layout = Layout()
    if seen.facts is not None and seen.row is not None:
        layout = layout_of(seen.facts, tuple(one.name for one in seen.row.channels))
    Metrics(VirtualClock(1)).text(seen)
    return view_of(seen, layout, str).state


@pytest.mark.parametrize("said", LIES.values(), ids=LIES)
def test_a_door_that_lies_is_left_and_the_screen_lives(
    liar: Liar, watch: Watch, said: list[bytes]
) -> None:
    watch.poll()
    end = liar.let_in()
    for packet in said:
        end.send(packet)
    end.close()
    watch.poll()
    assert watch.seen().trouble
    assert is_shown(watch) == "GONE"


@pytest.mark.parametrize("kind", ["null", "pipe", "folder", "empty", "garbage"])
def test_a_ring_that_is_none_is_as_if_none_had_come(
    liar: Liar, watch: Watch, tmp_path: Path, kind: str
) -> None:
    watch.poll()
    end = liar.let_in()
    before = open_files()
    passed = made(kind, tmp_path)
    socket.send_fds(end, [HELLO], [])
    socket.send_fds(end, [RING], [passed])
    os.close(passed)
    watch.poll()
    assert watch.seen().row is None
    assert open_files() <= before
    assert is_shown(watch) == "GONE"


def made(kind: str, folder: Path) -> int:
    """Return a descriptor of something that is no ring."""
    if kind == "pipe":
        ours, theirs = os.pipe()
        os.close(theirs)
        return ours
    if kind in ("null", "folder"):
        return os.open("/dev/null" if kind == "null" else folder, os.O_RDONLY)
    path = folder / "ring"
    path.write_bytes(b"" if kind == "empty" else b"AFFRING\0" + b"\xff" * 5000)
    return os.open(path, os.O_RDONLY)


def test_more_descriptors_than_were_told_are_closed(liar: Liar, watch: Watch) -> None:
    watch.poll()
    end = liar.let_in()
    before = open_files()
    null = os.open("/dev/null", os.O_RDONLY)
    for packet in (HELLO, RING, RING):
        socket.send_fds(end, [packet], [null] * 20)
    os.close(null)
    watch.poll()
    watch.poll()
    assert open_files() <= before


@pytest.mark.parametrize("kind", ["nothing", "file", "link", "pipe", "folder", "socket"])
def test_a_door_that_is_none_is_told_and_knocked_at_again(folder: Path, kind: str) -> None:
    path, clock = folder / "door.sock", VirtualClock(1)
    if kind != "nothing":
        put(kind, path)
    watch = Watch(path, clock)
    before = open_files()
    for _ in range(3):
        watch.poll()
        clock.advance_ns(RETRY_NS)
    assert "no service opens this door" in watch.seen().trouble
    assert is_shown(watch) == "GONE"
    assert open_files() == before
    watch.close()


def test_a_door_at_which_nobody_answers_holds_up_nothing(folder: Path, liar: Liar) -> None:
    queue = []
    for _ in range(20):  # until its queue is full
        end = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        end.setblocking(False)
        queue.append(end)
        try:
            end.connect(str(folder / "door.sock"))
        except BlockingIOError:
            break
    watch = Watch(folder / "door.sock", VirtualClock(1))
    watch.poll()
    assert watch.seen().trouble
    for end in queue:
        end.close()
    watch.close()


def test_a_service_that_says_nothing_is_no_line(liar: Liar, watch: Watch) -> None:
    watch.poll()
    liar.let_in()
    watch.poll()
    assert is_shown(watch) == "GONE"


HOSTILE = "<script>\u202e{{7*7}}\x1b[2J\n\"'"


def test_hostile_names_pass_through_the_door_as_text_of_one_line(folder: Path) -> None:
    said = facts(line=HOSTILE, blocked=HOSTILE, wire=(HOSTILE,))
    assert said.status.facts is not None
    outputs = tuple(replace(one, actuator=HOSTILE) for one in said.status.facts.outputs)
    meetings = tuple(replace(one, actuator=HOSTILE, roll=HOSTILE) for one in said.status.meetings)
    line = replace(said.status.facts, outputs=outputs)
    said = replace(said, status=replace(said.status, facts=line, meetings=meetings))
    values = row() | {f"{HOSTILE}_tension_N": 1.0}
    stand = Stand(folder, columns=tuple(values), said=said)
    watch = Watch(stand.path, stand.clock)
    watch.poll()
    stand.writer.write(tuple(values.values()))
    stand.round(stand.ring)
    watch.poll()
    seen = watch.seen()
    assert seen.facts == said
    assert seen.row is not None
    layout = layout_of(said, tuple(one.name for one in seen.row.channels))
    view = view_of(seen, layout, str)
    shown = [view.why, view.to_do, *(one.text for one in (*view.coming, *view.alarms))]
    assert any("<script>" in one for one in shown)  # as text; the page puts it in as text
    assert [one for one in shown if not one.isprintable()] == []
    watch.close()
    stand.close()
