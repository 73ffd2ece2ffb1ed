"""Logins: how often, how many at once, and the one place where a password is checked."""

from __future__ import annotations

import asyncio
from collections import OrderedDict
from functools import partial

from aff_runtime.app.hand.accounts import MOST_CHARACTERS, Account, Accounts, is_pin
from aff_runtime.app.hand.bucket import Bucket
from aff_runtime.app.hand.may import Place
from aff_runtime.base.ports import Clock

PER_ACCOUNT, PER_ADDRESS = 5, 20
PER_S = 1.0 / 60.0
PINS, PIN_PER_S = 5.0, 1.0 / 300.0
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
        self._pins: dict[str, Bucket] = {}  # no more than there are accounts with one
        self._one = asyncio.Lock()
        self._queue = 0

    def is_too_often(self, name: str, address: str) -> bool:
        """Return whether this try has to wait; it counts."""
        if not self._bucket("", address, PER_ADDRESS).take():
            return True  # no bucket of a name: a flood of names would push out those of others
        return not self._bucket(name, address, PER_ACCOUNT).take()

    def is_guessed(self, name: str, password: str, place: Place) -> bool:
        """Return whether a PIN was tried for an account too often; it counts.

        Five at once and one in five minutes: a million of them take more than nine years.
        """
        if place is not Place.PANEL or not is_pin(password):
            return False
        known = self._accounts.find(name)
        if known is None or not known.has_pin:
            return False
        bucket = self._pins.setdefault(name, Bucket(self._clock, per_s=PIN_PER_S, burst=PINS))
        return not bucket.take()

    def was_right(self, name: str, address: str, password: str, place: Place) -> None:
        """Take back that this try counted: who knows the word does not guess."""
        self._bucket("", address, PER_ADDRESS).put_back()
        self._bucket(name, address, PER_ACCOUNT).put_back()
        if place is Place.PANEL and is_pin(password) and name in self._pins:
            self._pins[name].put_back()

    async def check(self, name: str, password: str, place: Place) -> Account | None:
        """Return the account whose password this is; a PIN is one at the panel alone.

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
                at_panel = place is Place.PANEL
                check = partial(self._accounts.check, name, password, at_panel=at_panel)
                return await asyncio.to_thread(check)
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
