"""Steps a served plant on command: real sockets, virtual time."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable

from aff_runtime.base.errors import PlantError

MOST_SAMPLES = 100_000
"""Of one command: the answer comes after the last of them."""
_ROUNDS = 8  # of the event loop: accept, read, obey, answer, hang up, with some to spare


class SteppedClock:
    """Calls ``step`` when told and never else.

    What clients sent before the command is obeyed before its first sample. The samples of one
    command are not divided by the wire; what they cause there is done before the answer.

    Attributes
    ----------
    late_samples, skipped_samples : always 0.
    failure : set when ``step`` raised; nothing is stepped any more.

    Parameters
    ----------
    settled : waits until the wire has done what a sample began.
    """

    def __init__(self, step: Callable[[], None], settled: Callable[[], Awaitable[None]]) -> None:
        self._step = step
        self._settled = settled
        self._turn = asyncio.Lock()
        self.late_samples = 0
        self.skipped_samples = 0
        self.failure: asyncio.Future[None] | None = None

    def start(self) -> asyncio.Future[None]:
        """Begin; the future never completes but carries the exception of a failed step."""
        self.failure = asyncio.get_running_loop().create_future()
        return self.failure

    def stop(self) -> None:
        """Do nothing: no timer runs."""

    async def next_sample(self) -> None:
        """Take one sample."""
        await self.advance(1)

    async def advance(self, samples: int) -> None:
        """Take ``samples`` samples, one command at a time.

        Raises
        ------
        PlantError
            The number is out of range, or the line failed; then the service ends.
        """
        if not 1 <= samples <= MOST_SAMPLES:
            raise PlantError(f"step {samples}: write 1 to {MOST_SAMPLES} samples")
        async with self._turn:
            await self._quiet()
            try:
                for _ in range(samples):
                    self._step()
            except Exception as error:
                if self.failure is not None and not self.failure.done():
                    self.failure.set_exception(error)
                raise PlantError(f"the line failed and the plant ends: {error}") from error
            await self._quiet()

    async def _quiet(self) -> None:
        """Let the wire do what is waiting for it."""
        await self._settled()
        for _ in range(_ROUNDS):
            await asyncio.sleep(0)
