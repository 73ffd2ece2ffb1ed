"""What the control process answers to a wish to forget, and what it leaves alone."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from aff_runtime.app.link.messages import Forget
from aff_runtime.app.link.replies import Reply
from tests.aff_runtime.app.control.test_late_questions import Ends


@pytest.fixture
def ends() -> Iterator[Ends]:
    found = Ends()
    yield found
    found.close()


def answer(ends: Ends, *rolls: str) -> tuple[bool, str, tuple[str, ...]]:
    ends.ask(Forget(rolls=rolls))
    assert ends.done() == set()
    for said in ends.heard():
        if isinstance(said, Reply):
            ends.pending.resolve(said)
    told = ends.told.pop()
    return told.ok, told.message, told.rolls


def learn(ends: Ends) -> dict[tuple[str, int], complex]:
    """Have the plain blocks that stand in (there is no response) know both rolls."""
    (law, _) = ends.outside._law.controller._laws
    for slot in law.slots:  # type: ignore[attr-defined]
        slot.block.weight = 1e-3 + 2e-3j
    return dict(law.weights())


def test_it_names_the_rolls_of_which_something_was_known(ends: Ends) -> None:
    before = learn(ends)
    assert answer(ends) == (True, "", ("unwind",))
    (law, _) = ends.outside._law.controller._laws
    kept = {key: w if key[0] == "swrap_follower" else 0j for key, w in before.items()}
    assert law.weights() == kept
    assert answer(ends, "swrap_follower", "unwind") == (True, "", ("swrap_follower",))
    assert not any(law.weights().values())


def test_a_roll_that_the_site_file_lacks_is_refused_and_nothing_is_forgotten(ends: Ends) -> None:
    before = learn(ends)
    ok, message, _ = answer(ends, "unwind", "rewind")
    assert (ok, message) == (False, "no roll 'rewind'; there are: unwind, swrap_follower")
    (law, _) = ends.outside._law.controller._laws
    assert law.weights() == before
