"""A word transport without a wire: the other side is a function, in lockstep."""

from __future__ import annotations

from collections.abc import Callable

from aff_runtime.base.signals import Outcome

Answer = Callable[[list[int]], list[int] | Outcome]


class LoopbackTransport:
    """``WordTransport`` around a function.

    Parameters
    ----------
    answer : takes a copy of the write block; returns the read block, or the outcome to report
        instead of one.
    """

    def __init__(self, answer: Answer) -> None:
        self._answer = answer
        self._closed = False

    def transact(self, write_words: list[int], deadline_ns: int) -> tuple[Outcome, list[int]]:
        """Call the function; NOT_CONNECTED after ``close``. The deadline plays no part."""
        if self._closed:
            return Outcome.NOT_CONNECTED, []
        said = self._answer(list(write_words))
        if isinstance(said, Outcome):
            return said, []
        return Outcome.OK, said

    def close(self) -> None:
        """End the conversation."""
        self._closed = True
