"""Presses that this screen refused itself: the service hears of them, for its audit."""

from __future__ import annotations

from collections.abc import Callable

from aff_runtime.app.hand.bucket import Bucket
from aff_runtime.app.hand.may import BY_HAND, Action, Code, Place
from aff_runtime.app.hand.messages import PRESS_REFUSED, Notice
from aff_runtime.base.ports import Clock

PER_S, AT_ONCE = 1.0, 10.0


class RefusedPresses:
    """Says who wanted what, from where, and why not; of a flood of one account some, and how many.

    The last of a flood is said once there is room, though nothing follows it.

    Parameters
    ----------
    note : says it to the service.
    """

    def __init__(self, note: Callable[[Notice], None], clock: Clock) -> None:
        self._note = note
        self._clock = clock
        self._buckets: dict[str, Bucket] = {}  # no more than there are accounts
        self._unsaid: dict[str, Notice] = {}  # the last of each, with how many were before it

    def note(self, action: str, code: Code, account: str, place: Place) -> None:
        """Say one; what is no action of the hand is no press."""
        if action not in BY_HAND:
            return
        before = self._unsaid.pop(account, None)
        said = Notice(
            what=PRESS_REFUSED,
            account=account,
            place=place,
            action=Action(action),
            code=code,
            more=before.more + 1 if before is not None else 0,
        )
        if self._has_room(account):
            self._note(said)
        else:
            self._unsaid[account] = said

    def tend(self) -> None:
        """Say the last of a flood that has ended."""
        for account in [one for one in self._unsaid if self._has_room(one)]:
            self._note(self._unsaid.pop(account))

    def close(self) -> None:
        """Say what is left: there is no later."""
        for said in self._unsaid.values():
            self._note(said)
        self._unsaid.clear()

    def _has_room(self, account: str) -> bool:
        if account not in self._buckets:
            self._buckets[account] = Bucket(self._clock, per_s=PER_S, burst=AT_ONCE)
        return self._buckets[account].take()
