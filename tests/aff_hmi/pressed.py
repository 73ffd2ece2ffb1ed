"""A whole screen with a hand, without a network; the service behind it is a double."""

from __future__ import annotations

import asyncio
import json
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from starlette.types import Message
from starlette.websockets import WebSocket

from aff_hmi.gate import Gate, Rates
from aff_hmi.hand import Hand
from aff_hmi.hub import Hub
from aff_hmi.pages import Pages
from aff_hmi.see.kept import Kept
from aff_hmi.viewer import Viewer
from aff_hmi.watch import Observed, Watch
from aff_runtime.app.hand import accounts
from aff_runtime.app.hand.accounts import Account, secret_of, write_accounts
from aff_runtime.app.hand.may import Place, Role
from aff_runtime.app.hand.messages import Answer, Command, Notice, Welcome
from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.base.errors import WireError
from aff_runtime.base.signals import State
from tests.aff_hmi.asgi import HOST, scope
from tests.aff_hmi.moments import facts, row
from tests.doubles.virtual_clock import VirtualClock

PASSWORD = "tension, 90 N"
LOGIN = {"name": "anna", "password": PASSWORD}
NAMES = {"vera": Role.VIEW, "anna": Role.OPERATE, "bert": Role.OPERATE, "carl": Role.COMMISSION}
ORIGIN = f"http://{HOST}"


@dataclass
class Service:
    """What a desk would reach."""

    rules: Welcome | None = None
    said: list[Command | Notice] = field(default_factory=list)
    answer: Answer | None = None

    def poll(self) -> None:
        pass

    async def press(self, command: Command) -> Answer:
        if self.rules is None:
            raise WireError("no service hears this screen")
        self.said.append(command)
        return self.answer or Answer(id=command.id, ok=True, audit=1)

    def notice(self, notice: Notice) -> None:
        self.said.append(notice)

    def close(self) -> None:
        pass

    @property
    def commands(self) -> list[Command]:
        return [one for one in self.said if isinstance(one, Command)]

    @property
    def notices(self) -> list[str]:
        return [f"{one.what} {one.account}" for one in self.said if isinstance(one, Notice)]


@dataclass
class Reply:
    status: int
    headers: dict[str, str]
    said: Any

    @property
    def code(self) -> str:
        return str(self.said.get("code", ""))


def onlooker(topic: str = "") -> Viewer:
    """Return somebody who looks at a page in English and has said nothing yet."""

    async def silence(*_: object) -> Message:
        raise AssertionError("nothing is said to who says nothing")

    asked = scope("/live", [("host", HOST)], "websocket", "GET")
    return Viewer(WebSocket(asked, silence, silence), "en", "127.0.0.1", str, topic)


class Pressed:
    """The app, its clock, and browsers by name."""

    def __init__(
        self, folder: Path, *, is_tls: bool = False, keeps: bool = False, commission: Any = None
    ) -> None:
        self.clock = VirtualClock(1)
        self.clock.sleep_until_ns(10**15)
        self.file = folder / "accounts"
        secret = secret_of(PASSWORD)
        write_accounts(
            self.file, [Account(name=n, role=r, secret=secret) for n, r in NAMES.items()]
        )
        self.hand = Hand(folder / "hand.sock", self.file, self.clock, wall=lambda: self.wall_s)
        self.service = Service(
            rules=Welcome(version="1", ceiling=Role.OPERATE, arms_from=Place.PANEL)
        )
        self.hand.desk = self.service  # type: ignore[assignment]
        self.wall_s = 1.8e9
        self.kept = None
        if keeps:
            self.kept = Kept(None, self.clock, can_be_seen=True, wall=lambda: self.wall_s)
            self.hand.desk.told = self.kept.person
        watch = Watch(folder / "door.sock", self.clock)
        self.hub = Hub(watch, self.clock, self.hand, self.kept, commission)
        self.is_tls = is_tls
        self.pages = Pages(self.hub, "en", self.clock)
        assert self.pages.presses is not None
        self.gate = Gate(
            self.pages.app(),
            [HOST],
            Rates(self.clock),
            is_logged_in=self.pages.presses.is_logged_in,
        )
        self._ids = 0
        self._trying = ""
        self.frame = 0
        self.show(State.READY)

    def show(
        self, state: State, blocked: str = "", also: tuple[str, ...] = (), **more: float
    ) -> None:
        """Make a frame in which the guard has a state."""
        told = facts(blocked=blocked, also_blocking=also)
        seen = Observed(
            facts=replace(told, status=replace(told.status, trying=self._trying)),
            facts_age_s=0.1,
            row=TickRow(row(state, **more)),
            tick_age_s=0.01,
            writer_lives=True,
        )
        self.hub.make_frames(seen)
        self.frame = self.hub._number

    def tries(self, trying: bool) -> None:
        """Make a frame in which other settings are tried, or none are."""
        self._trying = "settings 0123 by carl: 60 s left" if trying else ""
        self.show(State.READY)

    def browser(self, name: str = "", *, client: str = "127.0.0.1") -> Browser:
        """Return a browser, logged in where a name is given."""
        found = Browser(self, client)
        if name:
            reply = found.post("/login", {"name": name, "password": PASSWORD})
            assert reply.status == 200, reply.said
        return found


class Browser:
    """Keeps a cookie and the token of its page."""

    def __init__(self, at: Pressed, client: str) -> None:
        self.at, self.client = at, client
        self.cookie = ""
        self.token = ""

    def ask(
        self,
        method: str,
        path: str,
        headers: list[tuple[str, str]],
        body: bytes = b"",
        *,
        leaves: bool = False,
    ) -> Reply:
        told: list[Message] = []
        parts = [{"type": "http.request", "body": body, "more_body": leaves}]

        async def receive() -> Message:
            return parts.pop(0) if parts else {"type": "http.disconnect"}

        async def send(message: Message) -> None:
            told.append(message)

        made = scope(path, headers, "http", method, is_tls=self.at.is_tls)
        made |= {"client": (self.client, 5000)}
        asyncio.run(self.at.gate(made, receive, send))
        start, *rest = told
        found = {k.decode(): v.decode() for k, v in start["headers"]}
        text = b"".join(one.get("body", b"") for one in rest).decode(errors="replace")
        if "set-cookie" in found:
            self.cookie = found["set-cookie"].split(";")[0]
        is_json = found.get("content-type", "").startswith("application/json")
        return Reply(start["status"], found, json.loads(text) if is_json else {"text": text})

    def headers(self, body: bytes, **more: str | None) -> list[tuple[str, str]]:
        origin = ORIGIN.replace("http:", "https:") if self.at.is_tls else ORIGIN
        given: dict[str, str | None] = {
            "host": HOST,
            "origin": origin,
            "content-type": "application/json",
            "content-length": str(len(body)),
            "sec-fetch-site": "same-origin",
            "x-aff-token": self.token,
            "cookie": self.cookie,
        }
        given |= {name.replace("_", "-"): value for name, value in more.items()}
        return [(name, value) for name, value in given.items() if value is not None]

    def post(self, path: str, said: Any, **more: str | None) -> Reply:
        body = said if isinstance(said, bytes) else json.dumps(said).encode()
        reply = self.ask("POST", path, self.headers(body, **more), body)
        if path == "/login" and reply.status == 200:
            session = self.session()
            self.token = session.csrf if session is not None else ""
        return reply

    def get(self, path: str = "/") -> Reply:
        return self.ask("GET", path, [("host", HOST), ("cookie", self.cookie)])

    def session(self) -> Any:
        place = Place.PANEL if self.client == "127.0.0.1" else Place.NETWORK
        return self.at.hand.sessions.find(self.cookie.partition("=")[2], place)

    def act(self, action: str = "arm", **more: Any) -> Reply:
        self.at._ids += 1
        said = {"action": action, "id": f"{self.at._ids:032x}", "seen": "READY"}
        said["frame"] = self.at.frame  # type: ignore[assignment]
        headers = {k: more.pop(k) for k in ("origin", "x_aff_token", "cookie") if k in more}
        return self.post("/act", said | more, **headers)

    def take(self, do: str = "take", of: str = "") -> Reply:
        return self.post("/hand", {"do": do, "of": of})


def quick(monkeypatch: Any) -> None:
    """Have passwords cost nothing."""
    monkeypatch.setattr(accounts, "_N", 2)


def namespace(**more: Any) -> Any:
    return SimpleNamespace(**more)


def armed(at: Pressed, name: str = "anna") -> Browser:
    """Return a browser whose session has the hand."""
    found = at.browser(name)
    assert found.take().status == 200
    return found


def later(at: Pressed, by_ns: int) -> dict[str, Any]:
    frame = at.frame
    at.clock.advance_ns(by_ns)
    at.show(State.READY)
    return {"frame": frame}
