"""The technician at the screen: what he makes again, and what he answers; no browser, no time."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import SimpleNamespace
from typing import Any

import pytest

from benchmarks.wizard import playing

OFF_S, ON_S, ROLL_LASTS_S = 42.0, 72.0, 500.0


class Screen:
    """In place of page and plant: time passes as the page is waited for.

    Attributes
    ----------
    rolls : times at which a roll was mounted. ``arms`` : at which the correction came on.
    """

    def __init__(self, trips_s: tuple[float, ...] = (), stands: tuple[str, ...] = ("pass",)):
        self.t_s, self.now = 0.0, "ACTIVE"
        self.rolls: list[float] = []
        self.arms: list[float] = []
        self._trips, self._stands = list(trips_s), list(stands)
        self.page: Any = self
        self.keyboard = self.line = self
        self.press: Callable[[str], None] = lambda key: self._is("BYPASS")

    def _is(self, state: str) -> None:
        self.now = state

    def wait_for_selector(self, selector: str) -> None:
        assert self.now in selector

    def wait_for_timeout(self, ms: float) -> None:
        self.t_s += 1e-3 * ms
        if self._trips and self.t_s >= self._trips[0] and self.now == "ACTIVE":
            self._trips.pop(0)
            self.now = "FAULT"

    def hold(self, button: str) -> None:
        assert button == "#arm"
        if self.now != "ACTIVE":
            self.arms.append(self.t_s)
        self.now = "ACTIVE"

    def state(self) -> str:
        return self.now

    def evaluate(self, script: str) -> Mapping[str, float]:
        assert "/data/line" in script
        return {"off_s": OFF_S, "on_s": ON_S}

    def tell(self, word: str) -> None:
        assert word == "roll"
        self.rolls.append(self.t_s)

    def seconds_left(self) -> float:
        return ROLL_LASTS_S - (self.t_s - self.rolls[-1])

    def status(self) -> SimpleNamespace:
        return SimpleNamespace(time_s=self.t_s)

    def step(self, number: int, typed: Mapping[str, str], *, stand: str) -> str:
        assert (number, typed) == (12, {"promised": "3 dB"})
        found = self._stands.pop(0)
        assert found in stand
        return found


def proven(screen: Screen) -> playing.Proof:
    return playing.proven(screen)  # type: ignore[arg-type]


def assert_whole(pair: playing.Pair) -> None:
    """Off as long as the page says, on for as long once it has settled."""
    assert pair.off[1] - pair.off[0] >= OFF_S
    assert pair.on[1] - pair.on[0] >= OFF_S
    assert pair.on[0] - pair.off[1] >= ON_S - OFF_S


def test_a_fresh_roll_is_mounted_before_the_proof_and_two_pairs_are_made_on_it() -> None:
    screen = Screen()
    found = proven(screen)
    assert (found.begun, found.stand, screen.rolls) == (2, "pass", [0.0])
    assert len(found.pairs) == len(screen.arms) == 2
    for pair in found.pairs:
        assert_whole(pair)


def test_a_pair_that_a_fault_cut_short_is_made_again() -> None:
    screen = Screen(trips_s=(100.0,))
    found = proven(screen)
    assert (found.begun, len(found.pairs), screen.rolls) == (3, 2, [0.0])
    assert found.pairs[0].off[0] > 100.0
    assert len(screen.arms) == 3
    for pair in found.pairs:
        assert_whole(pair)


def test_where_the_roll_does_not_last_for_a_repeat_a_fresh_one_begins_anew() -> None:
    """Three ons are cut short: two more pairs would end behind the end of the roll."""
    screen = Screen(trips_s=(100.0, 200.0, 300.0))
    found = proven(screen)
    assert (found.begun, len(found.pairs), len(screen.rolls)) == (5, 2, 2)
    assert found.pairs[0].off[0] > screen.rolls[1] >= 300.0
    assert found.pairs[1].on[1] < screen.rolls[1] + ROLL_LASTS_S


def test_a_machine_that_trips_for_ever_ends_the_proof() -> None:
    screen = Screen(trips_s=tuple(60.0 * k for k in range(1, 200)), stands=("open", "open"))
    found = proven(screen)
    assert (found.begun, found.pairs, found.stand) == (2 * playing.MOST_PAIRS, (), "open")


@pytest.mark.parametrize(("stands", "rolls"), [(("open", "pass"), 2), (("fail",), 1)])
def test_a_proof_that_stays_open_is_made_once_more_and_one_that_fails_is_not(
    stands: tuple[str, ...], rolls: int
) -> None:
    screen = Screen(stands=stands)
    found = proven(screen)
    assert (found.stand, len(screen.rolls)) == (stands[-1], rolls)
