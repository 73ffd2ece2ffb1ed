"""The screen's way to the commissioner: what it asks, and the key that a password has given."""

from __future__ import annotations

import asyncio
from dataclasses import replace
from pathlib import Path
from typing import TypeVar
from weakref import WeakKeyDictionary

from aff_hmi.sessions import Session
from aff_runtime.app.commission.link.answers import Answer, Done, Good, Opened
from aff_runtime.app.commission.link.client import ask
from aff_runtime.app.commission.link.messages import Refusal, Request, Why

PATIENCE_S = 90.0  # for what a job works out
STATE_PATIENCE_S = 3.0
"""For what a commissioner tells from memory; a page waits a second longer (``PATIENCE_MS``)."""
Shown = TypeVar("Shown", bound=Good)


class Commission:
    """Asks for sessions of this screen.

    Parameters
    ----------
    socket : of the commissioner.
    """

    def __init__(self, socket: Path) -> None:
        self._socket = socket
        self._looks: dict[Request, asyncio.Task[Answer]] = {}
        self._keys: WeakKeyDictionary[Session, str] = WeakKeyDictionary()

    async def look(self, asked: Request, kind: type[Shown]) -> Shown | Refusal:
        """Return what changes nothing; all who look at one moment are answered by one request.

        Parameters
        ----------
        kind : of the answer that is no refusal.
        """
        if asked not in self._looks:
            task = asyncio.create_task(self._ask(asked))
            task.add_done_callback(lambda _: self._looks.pop(asked, None))
            self._looks[asked] = task
        found = await asyncio.shield(self._looks[asked])
        return found if isinstance(found, kind | Refusal) else Refusal(why=Why.SILENT)

    async def open(self, session: Session, password: str, *, over: bool) -> Answer:
        """Have a session commission from now on, where its password is right."""
        found = await self._ask(
            Request(
                do="open",
                account=session.account.name,
                password=password,
                place=session.place.value,
                over=over,
            )
        )
        if not isinstance(found, Opened):
            return found
        self._keys[session] = found.key
        return Done()

    async def press(self, session: Session, asked: Request) -> Answer:
        """Ask what needs the key of a session."""
        key = self._keys.get(session, "")
        return await self._ask(replace(asked, key=key, place=session.place.value))

    def is_open(self, session: Session, by: str) -> bool:
        """Return whether this session commissions now; ``by`` : who does, as it was told."""
        return session in self._keys and by == session.account.name

    async def _ask(self, asked: Request) -> Answer:
        patience_s = STATE_PATIENCE_S if asked.do == "state" else PATIENCE_S
        return await ask(self._socket, asked, patience_s)
