"""The screen's one connection to the service's hand: presses go out, answers come back."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable
from pathlib import Path

from aff_runtime.app.hand.client import HandClient
from aff_runtime.app.hand.messages import PROTOCOL, Answer, Command, Notice, Welcome
from aff_runtime.base.errors import AffError, WireError
from aff_runtime.base.ports import Clock

RETRY_NS = 500_000_000
PATIENCE_S = 3.0


class PressDesk:
    """Says commands to the service, and matches its answers.

    Attributes
    ----------
    rules : what the service allows to a screen; None while it does not hear us.
    trouble : why not.
    told : called with what is said for the audit, and of whom.
    """

    def __init__(self, path: Path, clock: Clock) -> None:
        self._path = path
        self._clock = clock
        self._client: HandClient | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self._retry_ns = 0
        self._waiting: dict[str, asyncio.Future[Answer]] = {}
        self.rules: Welcome | None = None
        self.trouble = ""
        self.told: Callable[[str, str], None] = lambda what, account: None

    def poll(self) -> None:
        """Hear the service; returns at once."""
        now_ns = self._clock.now_ns()
        if self._client is None and now_ns >= self._retry_ns:
            self._retry_ns = now_ns + RETRY_NS
            self._connect()
        self._hear_all()

    async def press(self, command: Command) -> Answer:
        """Say a command and wait for its answer.

        Raises
        ------
        WireError
            When the service does not hear us, or says nothing in time.
        """
        if self._client is None:
            self._connect()
        answer: asyncio.Future[Answer] = asyncio.get_running_loop().create_future()
        self._waiting[command.id] = answer
        try:
            self._say(command)
            found = await asyncio.wait_for(answer, PATIENCE_S)
            outcome = "done" if found.ok else "refused"
            self.told(f"{command.action}: {outcome}", command.account)
            return found
        except TimeoutError:
            raise WireError("the service does not answer") from None
        finally:
            self._waiting.pop(command.id, None)

    def notice(self, notice: Notice) -> None:
        """Have something of a session put into the audit, if anybody hears it."""
        self.told(notice.what, notice.account)
        try:
            self._say(notice)
        except WireError:
            return

    def close(self) -> None:
        """Leave."""
        self._leave("")

    def _connect(self) -> None:
        try:
            self._client = HandClient(self._path)
        except AffError as error:
            self.trouble = str(error)
            return
        with contextlib.suppress(RuntimeError):  # without a loop it is heard when it is polled
            self._loop = asyncio.get_running_loop()
            self._loop.add_reader(self._client.fileno(), self._hear_all)

    def _say(self, message: Command | Notice) -> None:
        if self._client is None:
            raise WireError(self.trouble or "no service hears this screen")
        try:
            self._client.say(message)
        except WireError as error:
            self._leave(str(error))
            raise

    def _hear_all(self) -> None:
        """Hear what was said; an answer waits for no poll."""
        try:
            while self._client is not None and (told := self._client.receive()) is not None:
                self._hear(told)
        except AffError as error:
            self._leave(str(error))

    def _hear(self, told: Welcome | Answer) -> None:
        if isinstance(told, Welcome):
            if told.protocol != PROTOCOL:
                raise WireError(f"the service speaks protocol {told.protocol}, not {PROTOCOL}")
            self.rules, self.trouble = told, ""
            return
        waiting = self._waiting.get(told.id)
        if waiting is not None and not waiting.done():
            waiting.set_result(told)

    def _leave(self, why: str) -> None:
        """Let go of the connection; nobody waits for what cannot come."""
        if self._client is not None:
            if self._loop is not None:
                self._loop.remove_reader(self._client.fileno())
            self._client.close()
            self._client = self._loop = None
        self.rules, self.trouble = None, why
        self._retry_ns = self._clock.now_ns() + RETRY_NS
        for waiting in self._waiting.values():
            if not waiting.done():
                waiting.set_exception(WireError(why or "the screen ends"))
