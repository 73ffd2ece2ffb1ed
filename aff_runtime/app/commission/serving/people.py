"""Who commissions: one person at a time, by a password that is checked here and nowhere else."""

from __future__ import annotations

import asyncio
import hmac
import secrets
from dataclasses import dataclass

from aff_runtime.app.commission.link.messages import Refusal, Why
from aff_runtime.app.hand.accounts import Account, Accounts
from aff_runtime.app.hand.bucket import Bucket
from aff_runtime.app.hand.may import Place, Role
from aff_runtime.base.ports import Clock

IDLE_NS = 15 * 60 * 1_000_000_000
TRIES, PER_S = 5.0, 5.0 / 60.0  # passwords of one account at once, and further ones a second
MAX_QUEUE = 4  # passwords that wait to be checked, of all accounts


@dataclass(slots=True, kw_only=True)
class Holder:
    """Who commissions; ``key`` is what his screen says with every request."""

    account: str
    place: Place
    key: str
    pressed_ns: int


class People:
    """Lets one person in.

    Parameters
    ----------
    accounts : read anew whenever the file is another one.
    farthest : place from which one may commission.
    """

    def __init__(self, accounts: Accounts, clock: Clock, farthest: Place) -> None:
        self._accounts = accounts
        self._clock = clock
        self._farthest = farthest
        self._buckets: dict[str, Bucket] = {}
        self._unknown = self._full()
        self._one_check = asyncio.Lock()
        self._queue = 0
        self._holder: Holder | None = None

    @property
    def holder(self) -> Holder | None:
        """Who is in; nobody after a quarter of an hour without a press."""
        held = self._holder
        if held is not None:
            account = self._accounts.find(held.account)
            is_idle = self._clock.now_ns() - held.pressed_ns > IDLE_NS
            if is_idle or account is None or account.role < Role.COMMISSION:
                self._holder = None
        return self._holder

    async def open(
        self, name: str, password: str, place: Place, *, over: bool
    ) -> Holder | Refusal:
        """Let somebody in.

        Parameters
        ----------
        over : whether to take it over from somebody else who is in.
        """
        against = self._away(place) or await self.against(name, password)
        if against is not None:
            return against
        held = self.holder
        if held is not None and held.account != name and not over:
            return Refusal(why=Why.BUSY, name=held.account)
        now_ns = self._clock.now_ns()
        key = secrets.token_urlsafe(32)
        self._holder = Holder(account=name, place=place, key=key, pressed_ns=now_ns)
        return self._holder

    def close(self) -> None:
        """Let nobody be in."""
        self._holder = None

    def by_key(self, key: str, place: Place) -> Holder | None:
        """Return who shows this key, from the place where it was given; a press keeps him in."""
        held = self.holder
        if held is None or not hmac.compare_digest(held.key.encode(), key.encode()):
            return None
        if held.place is not place:
            return None
        held.pressed_ns = self._clock.now_ns()
        return held

    async def against(self, name: str, password: str) -> Refusal | None:
        """Return why this is not somebody who may commission; None when it is."""
        if self._queue >= MAX_QUEUE or not self._bucket(name).take():
            return Refusal(why=Why.WAIT)
        self._queue += 1
        try:
            async with self._one_check:
                account: Account | None = await asyncio.to_thread(
                    self._accounts.check, name, password
                )
        finally:
            self._queue -= 1
        if account is None:
            return Refusal(why=Why.PASSWORD)
        self._buckets.pop(name, None)  # who signs thirteen steps does not guess
        return None if account.role >= Role.COMMISSION else Refusal(why=Why.ROLE)

    def _bucket(self, name: str) -> Bucket:
        """Return the bucket of an account, or the one of all names that are no account's.

        Made-up names push out no account's bucket, and keep no account's password waiting.
        """
        if self._accounts.find(name) is None:
            return self._unknown
        return self._buckets.setdefault(name, self._full())

    def _full(self) -> Bucket:
        return Bucket(self._clock, per_s=PER_S, burst=TRIES)

    def _away(self, place: Place) -> Refusal | None:
        is_away = place is Place.NETWORK and self._farthest is not Place.NETWORK
        return Refusal(why=Why.PLACE) if is_away else None
