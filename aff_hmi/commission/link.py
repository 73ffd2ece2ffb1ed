"""The screen's way to the commissioner: what it asks, and the key that a password has given."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any
from weakref import WeakKeyDictionary

from aff_hmi.sessions import Session
from aff_runtime.app.commission.client import ask
from aff_runtime.app.commission.messages import Told

PATIENCE_S = 90.0


class Commission:
    """Asks for sessions of this screen.

    Parameters
    ----------
    socket : of the commissioner.
    """

    def __init__(self, socket: Path) -> None:
        self._socket = socket
        self._looks: dict[tuple[str, ...], asyncio.Task[Told]] = {}
        self._keys: WeakKeyDictionary[Session, str] = WeakKeyDictionary()

    async def look(self, do: str, **said: Any) -> Told:
        """Return what changes nothing; all who look at one moment are answered by one request."""
        which = (do, *map(str, said.values()))
        if which not in self._looks:
            asked = asyncio.create_task(self._ask({"do": do, **said}, PATIENCE_S))
            asked.add_done_callback(lambda _: self._looks.pop(which, None))
            self._looks[which] = asked
        return dict(await asyncio.shield(self._looks[which]))

    async def open(self, session: Session, password: str, *, over: bool) -> Told:
        """Have a session commission from now on, where its password is right."""
        said = {
            "account": session.account.name,
            "password": password,
            "place": session.place.value,
            "over": over,
        }
        found = await self._ask({"do": "open", **said}, PATIENCE_S)
        if found["ok"]:
            self._keys[session] = str(found.pop("key"))
        return found

    async def press(self, session: Session, do: str, **said: Any) -> Told:
        """Ask what needs the key of a session."""
        key = self._keys.get(session, "")
        asked = {"do": do, "key": key, "place": session.place.value, **said}
        return await self._ask(asked, PATIENCE_S)

    def is_open(self, session: Session, by: str) -> bool:
        """Return whether this session commissions now; ``by`` : who does, as it was told."""
        return session in self._keys and by == session.account.name

    async def _ask(self, said: Told, patience_s: float) -> Told:
        return await ask(self._socket, said, patience_s)
