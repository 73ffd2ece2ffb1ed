"""Who runs code as the screen's user: what the door gives him, and nothing besides."""

from __future__ import annotations

import codecs
import contextlib
import os
import socket
import tempfile
from collections.abc import Callable, Iterator
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

pytestmark = pytest.mark.skipif(os.geteuid() != 0, reason="only root can be another user")
NOBODY, DOOR_GROUP = 65534, 60
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
    child = os.fork()
    if child:
        return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    with contextlib.suppress(BaseException):
        deed()
        os._exit(0)
    os._exit(1)


def as_screen(deed: Callable[[], object], groups: tuple[int, ...] = (DOOR_GROUP,)) -> bool:
    """Return whether a deed is done by another user with the door's group."""

    def become_and_do() -> None:
        os.setgroups(groups)
        os.setresgid(NOBODY, NOBODY, NOBODY)
        os.setresuid(NOBODY, NOBODY, NOBODY)
        deed()

    return is_done(become_and_do)


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

    child = os.fork()
    if not child:
        os._exit(not as_screen(come_and_wait))
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


@pytest.mark.parametrize("deed", [*DEEDS.values(), *RIGHTS.values()], ids=[*DEEDS, *RIGHTS])
def test_it_can_do_nothing_to_the_service(place: Place, deed: Callable[[Place], object]) -> None:
    assert not as_screen(lambda: deed(place))
    assert place.door.exists()


@pytest.mark.parametrize("deed", DEEDS.values(), ids=DEEDS)
def test_root_can_so_that_the_refusals_above_mean_something(
    place: Place, deed: Callable[[Place], object]
) -> None:
    assert is_done(lambda: deed(place))


def in_child_as_screen(deed: Callable[[], object]) -> int:
    """Begin a deed as the screen's user; its process."""
    child = os.fork()
    if not child:
        os._exit(not as_screen(deed))
    return child


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


@pytest.mark.parametrize("action", BY_HAND)
def test_whatever_role_it_claims_it_gets_the_ceiling_and_no_more(
    hand: HandStand, action: Action
) -> None:
    said: Command = hand.command(action, role=Role.COMMISSION)

    def press() -> None:
        client = HandClient(hand.path)
        client.say(said)
        told = []
        while len(told) < 2:
            message = client.receive()
            told += [message] if message is not None else []
        welcome, answer = told
        assert isinstance(welcome, Welcome)
        assert isinstance(answer, Answer)
        assert answer.ok is (action is Action.BYPASS)

    child = in_child_as_screen(press)
    while (ended := os.waitpid(child, os.WNOHANG))[0] == 0:
        hand.round()
    assert os.waitstatus_to_exitcode(ended[1]) == 0
    assert not hand.service.asked
    assert hand.service.bypassed == (action is Action.BYPASS)
    (row,) = hand.rows()
    assert row["peer"].startswith(f"uid {NOBODY}")


@pytest.mark.parametrize("action", OF_SETTINGS)
def test_settings_are_no_word_of_the_hand(hand: HandStand, action: Action) -> None:
    said: Command = hand.command(action, role=Role.COMMISSION)

    def press() -> None:
        client = HandClient(hand.path)
        client.say(said)
        told: list[object] = []
        with contextlib.suppress(WireError):  # the service hangs up
            while len(told) < 2:
                message = client.receive()
                told += [message] if message is not None else []
        assert len(told) < 2
        assert not any(isinstance(one, Answer) for one in told)

    child = in_child_as_screen(press)
    while (ended := os.waitpid(child, os.WNOHANG))[0] == 0:
        hand.round()
    assert os.waitstatus_to_exitcode(ended[1]) == 0
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


@pytest.mark.parametrize("deed", AUDIT_DEEDS.values(), ids=AUDIT_DEEDS)
def test_it_cannot_touch_the_audit(hand: HandStand, deed: Callable[[HandStand], object]) -> None:
    assert not as_screen(lambda: deed(hand))
    assert hand.audit.path.exists()
