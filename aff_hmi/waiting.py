"""Polls that wait to be taken together: a call costs as much for one tick as for hundreds."""

from __future__ import annotations

from itertools import groupby

import numpy as np

from aff_hmi.watch import News

MUCH = 500  # ticks: they are taken without being asked for


class Waiting:
    """What polls have brought and nobody has taken yet."""

    def __init__(self) -> None:
        self._news: list[News] = []
        self._ticks = 0

    def add(self, news: News) -> None:
        """Keep what a poll has brought."""
        self._news.append(news)
        self._ticks += len(news.records)

    @property
    def is_much(self) -> bool:
        """Whether so many ticks wait that they are to be taken."""
        return self._ticks >= MUCH

    def take(self) -> list[News]:
        """Return it in order, what is of one ring as one; then nothing waits."""
        news, self._news, self._ticks = self._news, [], 0
        return [_as_one(list(one)) for _, one in groupby(news, lambda n: (n.ring, n.columns))]


def _as_one(news: list[News]) -> News:
    """Return several of one ring as one."""
    records = [np.asarray(one.records, dtype=float) for one in news if len(one.records)]
    return News(
        ring=news[-1].ring,
        columns=news[-1].columns,
        records=np.concatenate(records) if records else (),
        events=[event for one in news for event in one.events],
    )
