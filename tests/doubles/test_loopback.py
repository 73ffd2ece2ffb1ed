from __future__ import annotations

from aff_runtime.base.signals import Outcome
from tests.doubles.loopback import LoopbackTransport


def test_the_function_sees_what_is_written_and_its_words_come_back() -> None:
    transport = LoopbackTransport(lambda written: [word + 1 for word in written])
    assert transport.transact([1, 2], 0) == (Outcome.OK, [2, 3])


def test_the_function_may_commit_any_fault() -> None:
    faults = iter(outcome for outcome in Outcome if outcome is not Outcome.OK)
    transport = LoopbackTransport(lambda _written: next(faults))
    seen = [transport.transact([0], 0) for _ in range(4)]
    assert seen == [
        (Outcome.TIMEOUT, []),
        (Outcome.NOT_CONNECTED, []),
        (Outcome.EXCEPTION, []),
        (Outcome.BAD_REPLY, []),
    ]


def test_the_function_may_keep_what_it_was_given() -> None:
    kept: list[list[int]] = []
    transport = LoopbackTransport(lambda written: kept.append(written) or [])  # type: ignore[func-returns-value]
    words = [1]
    transport.transact(words, 0)
    words[0] = 2
    assert kept == [[1]]


def test_after_close_there_is_nobody() -> None:
    transport = LoopbackTransport(lambda written: written)
    transport.close()
    assert transport.transact([1], 0) == (Outcome.NOT_CONNECTED, [])
