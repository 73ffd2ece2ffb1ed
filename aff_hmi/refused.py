"""Presses that this screen refused itself: the service hears of them, for its audit."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

from aff_runtime.app.hand.bucket import Bucket
from aff_runtime.app.hand.may import BY_HAND, Action, Code, Place
from aff_runtime.app.hand.messages import PRESS_REFUSED, Notice
from aff_runtime.base.ports import Clock

PER_S, AT_ONCE = 1.0, 10.0


class RefusedPresses:
    """Says who wanted what, from where, and why not; of a flood of one account some, and how many.

    Parameters
    ----------
    note : says it to the service.
    """

    def __init__(self, note: Callable[[Notice], None], clock: Clock) -> None:
        self._note = note
        self._clock = clock
        self._buckets: dict[str, Bucket] = {}  # no more than there are accounts
        self._unsaid: Counter[str] = Counter()

    def note(self, action: str, code: Code, account: str, place: Place) -> None:
        """Say one; what is no action of the hand is no press."""
        if action not in BY_HAND:
            return
        if account not in self._buckets:
            self._buckets[account] = Bucket(self._clock, per_s=PER_S, burst=AT_ONCE)
        if not self._buckets[account].take():
            self._unsaid[account] += 1
            return
        self._note(
            Notice(
                what=PRESS_REFUSED,
                account=account,
                place=place,
                action=Action(action),
                code=code,
                more=self._unsaid.pop(account, 0),
            )
        )
