"""Who runs code as the screen's user: what the door gives him, and nothing besides."""

from __future__ import annotations

import codecs
import contextlib
import os
import socket
import tempfile
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path

import pytest

from aff_runtime.app.door.messages import Hello, decode
from aff_runtime.app.hand.client import HandClient
from aff_runtime.app.hand.may import BY_HAND, OF_SETTINGS, Action, Role
from aff_runtime.app.hand.messages import Answer, Command, Welcome
from aff_runtime.app.link.request_socket import RequestSocket
from aff_runtime.app.supervisor import door as door_module
from aff_runtime.app.supervisor.hand import visits as visits_module
from aff_runtime.app.supervisor.hand.desk import HandRules
from aff_runtime.base.errors import WireError
from tests.aff_runtime.app.door.stand import Stand
from tests.aff_runtime.app.supervisor.hand.stand import Stand as HandStand
from tests.processes import forked, kill, pause

pytestmark = pytest.mark.skipif(os.geteuid() != 0, reason="only root can be another user")
NOBODY, DOOR_GROUP = 65534, 60
MOST_ROUNDS = 10_000
codecs.lookup("ascii")  # a child as another user may not read where Python would load it from


class Place:
    """Folders as the installer and the unit make them, with a door and a request socket."""

    def __init__(self, root: Path) -> None:
        root.chmod(0o755)
        folder = root / "aff-door"
        folder.mkdir()
        os.chown(folder, 0, DOOR_GROUP)
        folder.chmod(0o2750)
        self.requests = RequestSocket(root / "run" / "control.sock")
        self.stand = Stand(folder, is_private=False)
        self.site = root / "site.yaml"
        self.site.write_text("line: {}\n")
        self.door, self.control = self.stand.path, root / "run" / "control.sock"
        self.service = os.getpid()

    def close(self) -> None:
        self.stand.close()
        self.requests.close()


@pytest.fixture
def place(monkeypatch: pytest.MonkeyPatch) -> Iterator[Place]:
    monkeypatch.setattr(door_module, "viewer_uids", lambda: frozenset({0, NOBODY}))
    with tempfile.TemporaryDirectory() as root:
        found = Place(Path(root))
        yield found
        found.close()


def is_done(deed: Callable[[], object]) -> bool:
    """Return whether a deed is done, by a process of its own."""
    return has_done(forked(deed))


def has_done(child: int) -> bool:
    """Return whether a process has ended with its deed done; waits for it."""
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


def become_the_screen(groups: tuple[int, ...] = (DOOR_GROUP,)) -> None:
    """Be another user with the door's group from here on."""
    os.setgroups(groups)
    os.setresgid(NOBODY, NOBODY, NOBODY)
    os.setresuid(NOBODY, NOBODY, NOBODY)


def in_child_as_screen(deed: Callable[[], object], groups: tuple[int, ...] = (DOOR_GROUP,)) -> int:
    """Begin a deed as another user with the door's group; its process."""

    def become_and_do() -> None:
        become_the_screen(groups)
        deed()

    return forked(become_and_do)


def as_screen(deed: Callable[[], object], groups: tuple[int, ...] = (DOOR_GROUP,)) -> bool:
    """Return whether a deed is done by another user with the door's group."""
    return has_done(in_child_as_screen(deed, groups))


def done_as_screen(deeds: Mapping[str, Callable[[], object]]) -> list[str]:
    """Return which deeds are done by another user with the door's group, all in one process."""
    ours, theirs = os.pipe()

    def become_and_try() -> None:
        become_the_screen()
        for name, deed in deeds.items():
            with contextlib.suppress(OSError):
                deed()
                os.write(theirs, f"{name}\n".encode())
        os.write(theirs, b"tried\n")

    assert is_done(become_and_try)
    os.close(theirs)
    with open(ours, encoding="utf-8") as heard:
        *done, tried = heard.read().splitlines()
    assert tried == "tried"
    return done


def connected(path: Path, kind: socket.SocketKind = socket.SOCK_SEQPACKET) -> socket.socket:
    """Return an end that has come to a socket."""
    end = socket.socket(socket.AF_UNIX, kind)
    end.settimeout(20.0)
    end.connect(str(path))
    return end


def test_the_door_opens_to_its_group_and_to_no_other(place: Place) -> None:
    assert as_screen(lambda: connected(place.door))
    assert not as_screen(lambda: connected(place.door), groups=())


def test_it_says_hello_to_the_screens_user(place: Place) -> None:
    ours, theirs = os.pipe()

    def come_and_wait() -> None:
        end = connected(place.door)
        os.write(theirs, end.recv(1000))

    child = in_child_as_screen(come_and_wait)
    os.set_blocking(ours, False)
    said = b""
    while not said and os.waitpid(child, os.WNOHANG)[0] == 0:
        place.stand.round(None)
        with contextlib.suppress(BlockingIOError):
            said = os.read(ours, 1000)
    said = said or os.read(ours, 1000)
    assert isinstance(decode(said), Hello)
    for descriptor in (ours, theirs):
        os.close(descriptor)


DEEDS: dict[str, Callable[[Place], object]] = {
    "command": lambda place: connected(place.control, socket.SOCK_STREAM),
    "take the door away": lambda place: place.door.unlink(),
    "put a door of its own": lambda place: place.door.with_name("other").touch(),
    "move the door": lambda place: place.door.rename(place.door.with_name("other")),
    "open the door to others": lambda place: place.door.chmod(0o666),
    "change the site file": lambda place: place.site.write_text("x"),
    "signal the service": lambda place: os.kill(place.service, 0),
    "look into its memory": lambda place: Path(f"/proc/{place.service}/mem").open("rb").close(),
    "take its descriptors": lambda place: os.listdir(f"/proc/{place.service}/fd"),
}
RIGHTS: dict[str, Callable[[Place], object]] = {
    "take its processor": lambda place: os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1)),
    "be nicer to itself": lambda place: os.nice(-5),
}


def test_it_can_do_nothing_to_the_service(place: Place) -> None:
    deeds = {name: partial(deed, place) for name, deed in (DEEDS | RIGHTS).items()}
    assert done_as_screen(deeds) == []
    assert place.door.exists()


@pytest.mark.parametrize("deed", DEEDS.values(), ids=DEEDS)
def test_root_can_so_that_the_refusals_above_mean_something(
    place: Place, deed: Callable[[Place], object]
) -> None:
    assert is_done(lambda: deed(place))


@pytest.fixture
def hand(monkeypatch: pytest.MonkeyPatch) -> Iterator[HandStand]:
    """A hand at the lowest ceiling, its socket in a folder of the door's group."""
    monkeypatch.setattr(visits_module, "screen_uids", lambda: frozenset({0, NOBODY}))
    with tempfile.TemporaryDirectory() as root:
        Path(root).chmod(0o755)
        found = HandStand(Path(root), HandRules(ceiling=Role.VIEW))
        for path, mode in ((found.path.parent, 0o2750), (found.path, 0o660)):
            os.chown(path, 0, DOOR_GROUP)
            path.chmod(mode)
        yield found
        found.close()


def serve_until_ended(hand: HandStand, child: int) -> None:
    """Be the service until a process has ended, in good order."""
    for _ in range(MOST_ROUNDS):
        hand.round()
        pause(0.001)
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            break
    else:
        kill(child)
        _, status = os.waitpid(child, 0)
    assert os.waitstatus_to_exitcode(status) == 0


def test_whatever_role_it_claims_it_gets_the_ceiling_and_no_more(hand: HandStand) -> None:
    orders = [hand.command(action, role=Role.COMMISSION) for action in BY_HAND]

    def press(said: Command) -> None:
        client = HandClient(hand.path)
        client.say(said)
        told = []
        while len(told) < 2:
            message = client.receive()
            told += [message] if message is not None else []
        welcome, answer = told
        assert isinstance(welcome, Welcome)
        assert isinstance(answer, Answer)
        assert answer.ok is (said.action is Action.BYPASS)

    serve_until_ended(hand, in_child_as_screen(lambda: [*map(press, orders)]))
    assert not hand.service.asked
    assert hand.service.bypassed == 1
    rows = hand.rows()
    assert len(rows) == len(orders)
    assert all(row["peer"].startswith(f"uid {NOBODY}") for row in rows)


def test_settings_are_no_word_of_the_hand(hand: HandStand) -> None:
    orders = [hand.command(action, role=Role.COMMISSION) for action in OF_SETTINGS]

    def press(said: Command) -> None:
        client = HandClient(hand.path)
        client.say(said)
        told: list[object] = []
        with contextlib.suppress(WireError):  # the service hangs up
            while len(told) < 2:
                message = client.receive()
                told += [message] if message is not None else []
        assert len(told) < 2
        assert not any(isinstance(one, Answer) for one in told)

    serve_until_ended(hand, in_child_as_screen(lambda: [*map(press, orders)]))
    assert not hand.service.asked
    assert not hand.service.bypassed


AUDIT_DEEDS: dict[str, Callable[[HandStand], object]] = {
    "read": lambda stand: stand.audit.path.read_bytes(),
    "write": lambda stand: stand.audit.path.open("ab").close(),
    "take away": lambda stand: stand.audit.path.unlink(),
    "move": lambda stand: stand.audit.path.parent.rename(stand.audit.path.parent.with_name("x")),
    "lock": lambda stand: stand.audit.path.with_name("audit.lock").open("r+b").close(),
    "put another socket": lambda stand: stand.path.unlink(),
}


def test_it_cannot_touch_the_audit(hand: HandStand) -> None:
    assert done_as_screen({name: partial(deed, hand) for name, deed in AUDIT_DEEDS.items()}) == []
    assert hand.audit.path.exists()
