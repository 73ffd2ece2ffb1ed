"""What a screen looks at: card, site file and service, worked out anew only when one changed."""

from __future__ import annotations

import asyncio
import contextlib
import math
from pathlib import Path
from typing import NamedTuple

from aff_runtime.app.card.book import NAME as CARD
from aff_runtime.app.commission.link.answers import Answer
from aff_runtime.app.commission.link.messages import Refusal, Request, Why
from aff_runtime.app.commission.paths import Paths, status_of
from aff_runtime.app.commission.serving.worker import Worker
from aff_runtime.app.commission.views.of_line import NoService, ServiceView, SiteView
from aff_runtime.app.report.status_answer import StatusAnswer
from aff_runtime.base.errors import AffError
from aff_runtime.base.ports import Clock
from aff_runtime.base.signals import State
from aff_runtime.base.text_digest import text_digest
from aff_runtime.config.plain_file import read_plain
from aff_runtime.config.yaml_marks import MAX_BYTES

LOOK_S = 1.0  # between two looks at the service
LEAST_AGE_NS = 2_000_000_000
"""A view that is younger is shown again, whatever has changed."""
MOST_AGE_OF_RUNS_NS = 30_000_000_000
"""A view of recorded runs that is older is made anew, since runs grow by themselves."""
VIEWS_OF_RUNS = ("refining", "maintenance")
VIEWS_OF_CARD = ("card", "page")
VIEWS_OF_SPEED = ("line", "card")
"""They say what a probe moves at this line speed, and how long a proof takes at it."""
SAME_SPEED = 0.02
"""Speeds that are nearer count as one: as near as the four parts of a proof have to be."""
SAME_SPEED_M_S = 0.005
"""So do speeds that are nearer than this: 2 % of a slow jog are less than a reading's own noise,
and another speed costs a second of a processor. Nobody probes or proves at a jog."""
MOST_KEPT = 32  # views; the oldest goes
NO_CARD, NO_SITE = "no card is begun", "no site file is there"
Fingerprint = tuple[object, ...]


class _Made(NamedTuple):
    """A view that is kept: of what, at which line speed, and when it was made."""

    of: Fingerprint
    speed_m_s: float
    at_ns: int
    answer: Answer


class Looking:
    """Looks at the service once a second, and at the rest when it is asked for.

    A view of the card checks the site file, which takes a second of a processor: it is made at
    most every two seconds, and only when card, site file or service are others than before, or
    the line runs at another speed, where the view is of it. A refused view is tried again: memory
    or time that it lacked may be there by now.
    """

    def __init__(self, where: Paths, clock: Clock) -> None:
        self._where = where
        self._clock = clock
        self._service: StatusAnswer | None = None
        self._trouble = ""
        self._made: dict[str, _Made] = {}
        self._one_at_a_time = asyncio.Lock()
        self._jobs_ended = 0
        self._site: tuple[Fingerprint, str] = ((), "")

    async def run(self) -> None:
        """Look at the service for ever."""
        while True:
            try:
                self._service = await asyncio.to_thread(status_of, self._where.socket)
                self._trouble = ""
            except AffError as error:
                self._service, self._trouble = None, str(error)
            await asyncio.sleep(LOOK_S)

    def site(self) -> SiteView:
        """Return where the site file is, and its digest as far as it can be read."""
        path, fingerprint = self._where.site, _of_file(self._where.site)
        if fingerprint != self._site[0]:
            digest = ""
            with contextlib.suppress(OSError, ValueError):
                digest = text_digest(read_plain(path, MAX_BYTES).decode("utf-8"))
            self._site = (fingerprint, digest)
        return SiteView(path=str(path), there=bool(fingerprint), sha256=self._site[1])

    def service(self) -> NoService | ServiceView:
        """Return how the service stands."""
        now = self._service
        if now is None:
            return NoService(trouble=self._trouble)
        return ServiceView(
            state=now.state,
            heard=now.live is not None and now.live.comm == "OK",
            blocked=now.live.blocked_by if now.live is not None else "",
            probing=now.probing,
            probed=now.probed,
            trying=now.trying,
            trying_left_s=now.trying_left_s,
            tried=now.tried,
            differs=now.config_differs,
            learned=now.learned,
        )

    def job_ended(self) -> None:
        """Have every view made anew: a job may have changed what it shows."""
        self._jobs_ended += 1

    async def look(self, asked: Request) -> Answer:
        """Return a view: the former one while card, site, service and jobs are as they were."""
        if asked.do == "line" and not self._where.site.exists():
            return Refusal(why=Why.REFUSED, name=NO_SITE)
        if asked.do in VIEWS_OF_CARD and not (self._where.card / CARD).exists():
            return Refusal(why=Why.REFUSED, name=NO_CARD)
        named = (asked.do, asked.paper, str(asked.number), asked.base, asked.edits)
        texts = (text_digest(asked.site_text), text_digest(asked.former))
        key = " ".join((*named, str(asked.back), *texts))
        longest_ns = MOST_AGE_OF_RUNS_NS if asked.do in VIEWS_OF_RUNS else math.inf
        async with self._one_at_a_time:
            fingerprint, now_ns = self._fingerprint(), self._clock.now_ns()
            speed_m_s = self._speed_m_s() if asked.do in VIEWS_OF_SPEED else math.nan
            kept = self._made.get(key)
            if kept is not None:
                age_ns = now_ns - kept.at_ns
                is_same = kept.of == fingerprint and not isinstance(kept.answer, Refusal)
                is_same = is_same and is_one_speed(kept.speed_m_s, speed_m_s)
                if (is_same and age_ns < longest_ns) or age_ns < LEAST_AGE_NS:
                    return kept.answer
            answer = await Worker(asked, self._where).run()
            self._made.pop(key, None)
            self._made[key] = _Made(fingerprint, speed_m_s, self._clock.now_ns(), answer)
            while len(self._made) > MOST_KEPT:
                del self._made[next(iter(self._made))]
            return answer

    def _speed_m_s(self) -> float:
        """Return the line speed that the service has told last, NaN where it is not known."""
        now = self._service
        if now is None or now.live is None or now.facts is None:
            return math.nan
        return now.live.tick.number(now.facts.speed)

    def _fingerprint(self) -> Fingerprint:
        now = self._service
        service: Fingerprint = ()
        if now is not None:
            roll = now.live.tick.number("roll_id") if now.live is not None else -1.0
            goes_out = now.state in (State.ARMED.name, State.ACTIVE.name)
            service = (now.site_hash, now.config_hash, f"{roll:.0f}", now.trying, goes_out)
        card, site = _of_file(self._where.card / CARD), _of_file(self._where.site)
        return (card, site, service, self._jobs_ended)


def is_one_speed(one_m_s: float, other_m_s: float) -> bool:
    """Return whether what holds at one line speed holds at another; NaN: it is not known."""
    known = math.isfinite(one_m_s), math.isfinite(other_m_s)
    if not all(known):
        return not any(known)
    return abs(one_m_s - other_m_s) <= max(SAME_SPEED * abs(one_m_s), SAME_SPEED_M_S)


def _of_file(path: Path) -> Fingerprint:
    """Return what tells a file and its content from another; empty where there is none."""
    try:
        found = path.stat()
    except OSError:
        return ()
    return (found.st_ino, found.st_mtime_ns, found.st_size)
