"""Logins: how often, how many at once, and the one place where a password is checked."""

from __future__ import annotations

import asyncio
from collections import OrderedDict

from aff_runtime.app.hand.accounts import MOST_CHARACTERS, Account, Accounts
from aff_runtime.app.hand.bucket import Bucket
from aff_runtime.base.ports import Clock

PER_ACCOUNT, PER_ADDRESS = 5, 20
PER_S = 1.0 / 60.0
MAX_QUEUE = 8
MAX_KNOWN = 1024


class Doorkeeper:
    """Lets people in.

    Five tries a minute for an account from one address, twenty for an address; nobody is ever shut
    out for good. One password is checked at a time: it costs a third of a second and 32 MB.
    """

    def __init__(self, accounts: Accounts, clock: Clock) -> None:
        self._accounts = accounts
        self._clock = clock
        self._buckets: OrderedDict[tuple[str, str], Bucket] = OrderedDict()
        self._one = asyncio.Lock()
        self._queue = 0

    def is_too_often(self, name: str, address: str) -> bool:
        """Return whether this try has to wait; it counts."""
        if not self._bucket("", address, PER_ADDRESS).take():
            return True  # no bucket of a name: a flood of names would push out those of others
        return not self._bucket(name, address, PER_ACCOUNT).take()

    async def check(self, name: str, password: str) -> Account | None:
        """Return the account whose password this is.

        Raises
        ------
        BlockingIOError
            When too many wait already.
        """
        if len(password) > MOST_CHARACTERS:
            return None
        if self._queue >= MAX_QUEUE:
            raise BlockingIOError
        self._queue += 1
        try:
            async with self._one:
                return await asyncio.to_thread(self._accounts.check, name, password)
        finally:
            self._queue -= 1

    def _bucket(self, name: str, address: str, count: int) -> Bucket:
        key = (name[:64], address)
        found = self._buckets.pop(key, None)
        if found is None:
            found = Bucket(self._clock, per_s=count * PER_S, burst=float(count))
        self._buckets[key] = found
        if len(self._buckets) > MAX_KNOWN:
            self._buckets.popitem(last=False)
        return found
