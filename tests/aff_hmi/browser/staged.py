"""Any moment of a line on the real screen server, without a service: for how pages look."""

from __future__ import annotations

import asyncio
import threading
from dataclasses import replace
from pathlib import Path
from typing import Any

from aff_hmi.commission.link import Commission
from aff_hmi.hand import Hand
from aff_hmi.hub import Hub
from aff_hmi.listening import listening
from aff_hmi.see.kept import Kept
from aff_hmi.server import Unhurried, config_of
from aff_hmi.watch import News, Observed
from aff_runtime.app.hand.accounts import Account, secret_of, write_accounts
from aff_runtime.app.hand.may import Place, Role
from aff_runtime.app.hand.messages import Answer, Command, Notice, Welcome
from aff_runtime.app.report.line_facts import OutputFacts
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import State
from aff_runtime.core.monitor import OrderState
from sim_plant.demo.wires import free_port
from tests.aff_hmi.moments import LINE, facts, row, seen
from tests.processes import until

PASSWORD = "tension, 90 N"
FOLLOWER = OutputFacts(
    actuator="swrap_follower",
    column="swrap_m_s",
    unit="m/s",
    limit=0.04,
    signal="pullroll_tension_N",
    reference="",
)
SITE = replace(LINE, outputs=(*LINE.outputs, FOLLOWER))
STATES = [*(state.name for state in State), "RESTING", "PROBING", "GONE", "SILENT"]


class Shown:
    """In place of a watch: what is seen is what a test says."""

    hears_ticks = True
    news = News()

    def __init__(self) -> None:
        self.moment = moment("ACTIVE")

    def poll(self) -> None:
        pass

    def seen(self) -> Observed:
        return self.moment

    def close(self) -> None:
        pass


class Desk:
    """In place of the way to a service: hears every press, and says yes."""

    def __init__(self) -> None:
        self.rules = Welcome(version="1", ceiling=Role.OPERATE, arms_from=Place.PANEL)
        self.said: list[Command] = []

    def poll(self) -> None:
        pass

    async def press(self, command: Command) -> Answer:
        self.said.append(command)
        return Answer(id=command.id, ok=True, audit=1)

    def notice(self, notice: Notice) -> None:
        pass

    def close(self) -> None:
        pass


class Stage:
    """A screen server in a thread of its own.

    Parameters
    ----------
    folder : None for a screen without a hand; else where its accounts are kept.
    keeps : whether it has history, in memory, and the pages of it.
    commission : None for a screen without a commissioner.
    """

    def __init__(
        self,
        folder: Path | None = None,
        *,
        keeps: bool = False,
        commission: Commission | None = None,
    ) -> None:
        self.watch = Shown()
        self.desk = Desk()
        hand = self._hand(folder) if folder is not None else None
        kept = Kept(None, MonotonicClock(), can_be_seen=hand is not None) if keeps else None
        if hand is not None and kept is not None:
            hand.desk.told = kept.person
        self._hub = Hub(self.watch, MonotonicClock(), hand, kept, commission)  # type: ignore[arg-type]
        place = listening(f"127.0.0.1:{free_port()}", (), None, None, None)
        (self.url,) = place.urls
        self._server = Unhurried(config_of(place, self._hub, "en"), place)
        self._thread = threading.Thread(target=lambda: asyncio.run(self._serve()), daemon=True)
        self._thread.start()
        until("the screen is heard", lambda: self._server.started)

    def _hand(self, folder: Path) -> Hand:
        accounts = folder / "accounts"
        secret = secret_of(PASSWORD)
        names = {"vera": Role.VIEW, "anna": Role.OPERATE, "bert": Role.OPERATE}
        names["carl"] = Role.COMMISSION
        rows = [Account(name=name, role=role, secret=secret) for name, role in names.items()]
        write_accounts(accounts, rows)
        hand = Hand(folder / "hand.sock", accounts, MonotonicClock())
        hand.desk = self.desk  # type: ignore[assignment]
        return hand

    async def _serve(self) -> None:
        polling = asyncio.create_task(self._hub.run())
        await self._server.serve()
        polling.cancel()
        await asyncio.gather(polling, return_exceptions=True)

    def show(self, shown: Observed) -> int:
        """Have every page show a moment; return the number of the newest frame without it."""
        self.watch.moment = shown
        return self._hub._number

    def calm(self) -> None:
        """Have a page that is opened next find a line at work, whatever was shown before."""
        self.watch.moment = moment("ACTIVE")

    def close(self) -> None:
        self._server.should_exit = True
        self._thread.join(20.0)


def moment(name: str, **more: Any) -> Observed:
    """Return a moment of a line with two actuators: a guard's state, or one of ``STATES``."""
    if name == "GONE":
        return Observed(trouble="/run/aff-door/door.sock: no service opens this door")
    state = State.ACTIVE if name in ("RESTING", "PROBING", "SILENT") else State[name]
    values = _row(state)
    status = facts(facts=SITE, probing=name == "PROBING", **more).status
    blocked = ""
    age_s = 0.1
    if name == "RESTING":
        values |= {k: float(OrderState.CLAMPED) for k in values if k.endswith("1x.state")}
    elif name == "SILENT":
        age_s = 7.0
    elif state in (State.FAULT, State.OFF):
        code = BY_NAME["SECOND_MASTER" if state is State.FAULT else "PERMISSIVE_LOST"].code
        values["alarm"] = float(code)
        blocked = "SECOND_MASTER" if state is State.FAULT else "WEB_INTACT=0"
    elif state is State.READY:
        blocked = "unwind: unwind_2x: 31.40 Hz is outside the probed 0.20..12.00 Hz"
    elif state is State.BYPASS:
        values["alarm"] = float(BY_NAME["BYPASSED"].code)
    told = facts(blocked=blocked)
    return seen(
        values,
        facts=replace(told, status=status),
        facts_age_s=age_s,
        events=((18, 0.0, 12.0), (17, 0.0, 95.0), (15, 0.0, 4000.0)),
    )


def ready() -> Observed:
    """Return a line at which nothing stands against arming."""
    found = moment("READY")
    assert found.facts is not None
    return replace(found, facts=replace(found.facts, blocked=""))


def _row(state: State) -> dict[str, float]:
    values = row(state)
    more = {
        "pullroll_tension_N": 61.3,
        "correction_swrap_m_s": 0.0,
        "applied_ratio_swrap_m_s": 1.0,
        "limit_ratio_swrap_m_s": 1.0,
    }
    more |= {
        key.replace("unwind.unwind", "swrap_follower.pullroll"): value
        for key, value in values.items()
        if key.startswith("unwind.unwind")
    }
    return values | more
