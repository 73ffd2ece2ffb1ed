"""The supervisor's side of a hand on a real socket, a round at a time; the service is a double."""

from __future__ import annotations

import json
import selectors
from collections.abc import Callable
from dataclasses import replace
from itertools import count
from pathlib import Path
from typing import Any

from aff_runtime.app.hand.audit import Audit
from aff_runtime.app.hand.client import HandClient
from aff_runtime.app.hand.may import Action, Code, Place, Role
from aff_runtime.app.hand.messages import VALID_NS, Answer, Command, Said, Welcome
from aff_runtime.app.link.replies import Reply
from aff_runtime.app.report.command_counts import CommandTally
from aff_runtime.app.supervisor.hand.desk import HandDesk, HandRules
from aff_runtime.app.supervisor.hand.entries import ServiceState
from aff_runtime.base.signals import State
from tests.doubles.virtual_clock import VirtualClock

OPERATE = HandRules(ceiling=Role.OPERATE)


class Service:
    """What the desk commands, as lists."""

    def __init__(self, clock: VirtualClock) -> None:
        self._clock = clock
        self.standing = ServiceState(state=State.READY, tick=7, config="3f9a")
        self.bypassed = 0
        self.asked: list[Callable[[Reply], None]] = []
        self.probes: list[Callable[[Reply], None]] = []
        self.louder: list[bool] = []
        self.shadows: list[bool] = []
        self.notes: list[str] = []

    def now(self) -> ServiceState:
        return self.standing

    def bypass(self) -> None:
        self.bypassed += 1
        self.standing = replace(self.standing, bypassed_ns=self._clock.now_ns())

    def arm(self, answer: Callable[[Reply], None]) -> None:
        self.asked.append(answer)

    def probe(self, answer: Callable[[Reply], None], *, louder: bool) -> None:
        self.probes.append(answer)
        self.louder.append(louder)

    def shadow(self, on: bool, answer: Callable[[Reply], None]) -> None:
        self.shadows.append(on)
        self.asked.append(answer)

    def forget(self, answer: Callable[[Reply], None]) -> None:
        self.asked.append(answer)

    def note(self, text: str) -> None:
        self.notes.append(text)

    def answer(self, *, ok: bool = True, message: str = "") -> None:
        self.asked.pop(0)(Reply(id=1, ok=ok, message=message))


class Stand:
    def __init__(self, folder: Path, rules: HandRules = OPERATE, **audit: Any) -> None:
        self.clock = VirtualClock(1)
        self.clock.sleep_until_ns(10**12)
        self.service = Service(self.clock)
        self.selector = selectors.DefaultSelector()
        run = folder / "run"
        run.mkdir(mode=0o700)
        self.path = run / "hand.sock"
        self.audit = Audit(folder / "audit", **audit)
        self.counts = CommandTally()
        self.desk = HandDesk(
            run,
            self.selector,
            self.clock,
            is_private=True,
            rules=rules,
            audit=self.audit,
            service=self.service,
            counts=self.counts,
        )
        self.clients: list[HandClient] = []
        self._numbers = count()

    def client(self) -> HandClient:
        self.clients.append(HandClient(self.path))
        self.round()
        assert isinstance(self.clients[-1].receive(), Welcome)
        return self.clients[-1]

    def command(self, action: Action = Action.ARM, **more: Any) -> Command:
        good = Command(
            id=f"{next(self._numbers):032x}",
            action=action,
            account="anna",
            role=Role.OPERATE,
            place=Place.PANEL,
            seen="READY",
            valid_until_ns=self.clock.now_ns() + VALID_NS,
        )
        return replace(good, **more)

    def round(self) -> None:
        for _ in range(40):
            events = self.selector.select(0.0)
            for key, _ in events:
                assert self.desk.serve(key)
            if not events:
                break
        self.desk.step()

    def say(self, client: HandClient, said: Said) -> Answer | None:
        client.say(said)
        self.round()
        found = client.receive()
        assert found is None or isinstance(found, Answer)
        return found

    def rows(self) -> list[dict[str, Any]]:
        return [json.loads(line) for line in self.audit.path.read_text().splitlines()]

    def close(self) -> None:
        for client in self.clients:
            client.close()
        self.desk.close()
        self.selector.close()


def code(answer: Answer | None) -> Code | None:
    """Return why a command was refused; it was."""
    assert answer is not None
    assert not answer.ok
    assert answer.reason is not None
    return answer.reason.code
