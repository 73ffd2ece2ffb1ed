"""A real commissioner on its socket, in a thread of the test."""

from __future__ import annotations

import asyncio
import threading
from pathlib import Path

from aff_runtime.app.commission.link.listening import Listener
from aff_runtime.app.commission.paths import Paths
from aff_runtime.app.commission.serving.commissioner import Commissioner
from aff_runtime.app.hand.accounts import Accounts
from aff_runtime.app.hand.audit import Audit
from aff_runtime.app.hand.may import Place
from aff_runtime.base.clock import MonotonicClock


class Serving:
    """A commissioner in a thread of its own."""

    def __init__(self, where: Paths, accounts: Path, folder: Path) -> None:
        self.audit = Audit(folder / "audit")
        self._commissioner = Commissioner(
            where, Accounts(accounts), self.audit, MonotonicClock(), Place.PANEL
        )
        self._ready, self._ended = threading.Event(), threading.Event()
        self._thread = threading.Thread(
            target=lambda: asyncio.run(self._serve(where.socket.parent))
        )
        self._thread.start()
        assert self._ready.wait(20.0)

    async def _serve(self, folder: Path) -> None:
        listener = Listener(folder, self._commissioner.answer, is_private=True)
        serving = asyncio.create_task(listener.run())
        self._ready.set()
        while not self._ended.is_set():
            await asyncio.sleep(0.05)
        serving.cancel()
        self._commissioner.close()
        await asyncio.gather(serving, return_exceptions=True)
        listener.close()

    def close(self) -> None:
        self._ended.set()
        self._thread.join(20.0)
