"""The screen's one connection to the service's hand: presses go out, answers come back."""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections import deque
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from aff_runtime.app.hand.bucket import Bucket
from aff_runtime.app.hand.client import HandClient
from aff_runtime.app.hand.messages import PRESS_REFUSED, PROTOCOL, Answer, Command, Notice, Welcome
from aff_runtime.base.errors import AffError, WireError
from aff_runtime.base.ports import Clock

RETRY_NS = 500_000_000
PATIENCE_S = 3.0
MOST_HELD = 64  # notices that wait until the service hears us
CLOSE_NS, CLOSE_LOOK_NS = 2_000_000_000, 50_000_000  # for what waits when the screen ends
NOTICES_PER_S, AT_ONCE = 20.0, 40.0  # who says more than 50 packets a second is sent away
LOG = logging.getLogger("aff_hmi")


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
        self._held: deque[tuple[int, Notice]] = deque()
        self._unsaid = 0  # notices that found no room, since the last one that was said
        self._pace = Bucket(clock, per_s=NOTICES_PER_S, burst=AT_ONCE)
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
        self._say_held()

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
        """Have something of a session put into the audit, now or when the service hears us.

        While it does not the newest wait.
        """
        is_press = notice.what == PRESS_REFUSED
        self.told(f"{notice.action}: refused" if is_press else notice.what, notice.account)
        if len(self._held) >= MOST_HELD:
            self._unsaid += 1 + self._held.popleft()[1].more
        self._held.append((self._clock.now_ns(), notice))
        self._say_held()

    def close(self) -> None:
        """Leave; what waits is said while the service hears us, what cannot be is in the log."""
        until_ns = self._clock.now_ns() + CLOSE_NS
        if self._held and self._client is None:
            self._connect()
        self._hear_all()
        self._say_held()
        while self._held and self._client is not None and self._clock.now_ns() < until_ns:
            self._clock.sleep_until_ns(self._clock.now_ns() + CLOSE_LOOK_NS)
            self._hear_all()
            self._say_held()
        for since_ns, notice in self._held:
            self._log(notice, (self._clock.now_ns() - since_ns) // 1_000_000_000)
        self._held.clear()
        self._leave("")

    @staticmethod
    def _log(notice: Notice, ago_s: int) -> None:
        """Put into the screen's log what the service was not told."""
        parts = (notice.action, notice.code, f"from {notice.other}" if notice.other else "")
        more = f"{notice.more} before it" if notice.more else ""
        what = "; ".join(part for part in (notice.what, *parts, more) if part)
        where = f'by "{notice.account}", {notice.place}'
        LOG.warning("not in the audit, no service hears it: %s %s, %d s ago", what, where, ago_s)

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

    def _say_held(self) -> None:
        """Say what waits to a service that has let us in, the oldest first."""
        with contextlib.suppress(WireError):
            while self._held and self.rules is not None and self._pace.take():
                since_ns, notice = self._held[0]
                ago_s = (self._clock.now_ns() - since_ns) // 1_000_000_000
                self._say(replace(notice, more=notice.more + self._unsaid, ago_s=ago_s))
                self._held.popleft()
                self._unsaid = 0

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
