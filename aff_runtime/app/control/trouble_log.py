"""Tells the log what the wire knows about its own troubles, once for each change."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Final

from aff_runtime.base.events import STALE_BEGAN
from aff_runtime.base.ports import Gateway
from aff_runtime.base.signals import Outcome

EVERY_TICKS: Final = 100
"""Between two looks; half a second at a cycle of 5 ms."""
WENT: Final[Mapping[int, str]] = MappingProxyType(
    {
        Outcome.OK: "its heartbeat did not move",
        Outcome.TIMEOUT: "nothing new came in time",
        Outcome.NOT_CONNECTED: "there was no connection",
        Outcome.EXCEPTION: "it refused what was asked",
        Outcome.BAD_REPLY: "its replies or heartbeats were not to be believed",
    }
)
"""What a tick without fresh data was, where the wire knows of no trouble."""


class TroubleLog:
    """Looks at the gateway every ``EVERY_TICKS``; a trouble of less than two looks is not logged.

    One that has made the PLC's data stale is, however short.

    Parameters
    ----------
    gateway : the wire.
    readings : what is wrong with what it brings.
    say : takes one sentence for the service's log.
    show : takes the troubles as they are now, for ``status``.
    """

    def __init__(
        self,
        gateway: Gateway,
        readings: Callable[[], tuple[str, ...]],
        say: Callable[[str], None],
        show: Callable[[tuple[str, ...]], None] = lambda troubles: None,
    ) -> None:
        self._gateway = gateway
        self._readings = readings
        self._say = say
        self._show = show
        self._seen: tuple[str, ...] = ()
        self._said: tuple[str, ...] = ()
        self._first: tuple[str, ...] = ()
        self._began: tuple[str, ...] = ()
        self._went: Counter[int] = Counter()

    def follow(self, outcome: int, *, fresh: bool, latched: bool) -> None:
        """Keep what the wire said first since the PLC's data were fresh; each tick.

        Parameters
        ----------
        outcome : how the tick's exchange ended.
        latched : PLC_STALE is the alarm; what it began with is shown until it is none any more.
        """
        if self._began and fresh and not latched:
            self._began = ()
            self._show(self._said)
        if fresh:
            self._first = ()
            self._went.clear()
            return
        self._went[outcome] += 1
        if not self._first:
            self._first = self._gateway.troubles

    def stale(self) -> None:
        """Tell what the loss of the PLC began with: when it is told, the wire may work again."""
        first = self._first or (self._usual(),)
        self._say(f"{STALE_BEGAN}{'; '.join(first)}")
        self._began = tuple(f"{STALE_BEGAN}{trouble}" for trouble in first)
        self._show((*self._said, *self._began))

    def _usual(self) -> str:
        """Return what most ticks since then were."""
        if not self._went:
            return "no tick without fresh data"
        ((outcome, _),) = self._went.most_common(1)
        return f"no trouble of the wire: {WENT[outcome]}"

    def look(self, tick: int) -> None:
        """Log the troubles when two looks in a row found the same and they are not logged yet."""
        if tick % EVERY_TICKS:
            return
        before, self._seen = self._seen, (*self._gateway.troubles, *self._readings())
        if self._seen != before or self._seen == self._said:
            return
        self._said = self._seen
        self._show((*self._seen, *self._began))
        for trouble in self._seen or ("no trouble any more",):
            self._say(f"wire: {trouble}")
