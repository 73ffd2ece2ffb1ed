"""The commissioner: hears a screen, lets one person have jobs done, keeps what was asked.

It sends no correction, arms nothing and writes no word of the PLC. What it changes is the site
file, and settings that it asks the service to try: the service bounds a try and takes it back.
Figures come from records and from the running service; what a screen says of itself is a name, a
value that a display shows, an answer. A signature is below what was shown, with a password that
is checked here.
"""

from __future__ import annotations

import asyncio
from dataclasses import replace

from aff_runtime.app.card.book import NAME as CARD
from aff_runtime.app.commission.link.answers import Answer, Done, Opened, State
from aff_runtime.app.commission.link.messages import LONG, LOOKS, Refusal, Request, Why
from aff_runtime.app.commission.paths import Paths, by_whom
from aff_runtime.app.commission.serving.audit_lines import BEGIN, AuditLines, unended
from aff_runtime.app.commission.serving.looking import Looking
from aff_runtime.app.commission.serving.people import Holder, People
from aff_runtime.app.commission.serving.slot import Slot
from aff_runtime.app.commission.serving.worker import CUT, KEEPS, KILLED, STOPPED, Worker
from aff_runtime.app.commission.views.of_line import LastJob
from aff_runtime.app.hand.accounts import Accounts
from aff_runtime.app.hand.audit import Audit, AuditEntry
from aff_runtime.app.hand.may import Place, Role
from aff_runtime.app.link.peer import Peer
from aff_runtime.base.ports import Clock
from aff_runtime.base.printable import printable

AWAITED = ("sign",)
"""Jobs whose answer the screen waits for, never stopped; of the others it hears by ``state``."""
LOOK_S = 1.0  # between two looks at what nobody asks for


class Commissioner:
    """Answers requests.

    Parameters
    ----------
    where : site file, state, service and card.
    farthest : place from which one may commission.
    """

    def __init__(
        self, where: Paths, accounts: Accounts, audit: Audit, clock: Clock, farthest: Place
    ) -> None:
        self._where = where
        self._audit = AuditLines(audit, clock)
        self._people = People(accounts, clock, farthest)
        self._short, self._long = Slot(clock), Slot(clock)
        self.looking = Looking(where, clock)
        for entry in unended(audit.path, KEEPS):
            self._audit.write(entry, "noted", KILLED)
            self._short.last = LastJob.of(entry.what.removeprefix(BEGIN), text=KILLED)

    async def answer(self, asked: Request, peer: Peer) -> Answer:
        """Return the answer to a request that was checked."""
        try:
            return await self._answer(asked, peer)
        finally:
            self._tend()

    async def run(self) -> None:
        """Do for ever what nobody asks for."""
        while True:
            self._tend()
            await asyncio.sleep(LOOK_S)

    async def _answer(self, asked: Request, peer: Peer) -> Answer:
        do = asked.do
        if do == "state":
            return self._state()
        if do in LOOKS:
            return await self.looking.look(asked)
        if do == "open":
            return await self._open(asked, peer)
        held = self._people.by_key(asked.key, Place(asked.place))
        return Refusal(why=Why.CLOSED) if held is None else await self._do(asked, held, peer)

    async def _do(self, asked: Request, held: Holder, peer: Peer) -> Answer:
        """Do what the person asks who commissions."""
        if asked.do == "close":
            self._audit.write(_entry(asked, held, peer), "done")
            self._people.close()
            return Done()
        if asked.do in ("answer", "stop", "stop_long"):
            return self._steer(asked, held, peer)
        return await self._start(asked, held, peer)

    def _tend(self) -> None:
        """Write the count of refusals; end a job that waits for somebody who is no longer in."""
        self._audit.tend()
        worker, held = self._short.worker, self._people.holder
        if worker is None or worker.question is None:
            return
        account = worker.asked.account
        if held is None or held.account != account:
            said = AuditEntry(
                what=f"commissioning: {worker.asked.called}", result="", account=account
            )
            self._audit.write(said, "noted", "stopped: it waits for somebody who is not in")
            worker.stop()

    def close(self) -> None:
        """End what runs."""
        self._short.stop()
        self._long.stop()
        self._audit.close()

    # --- who ----------------------------------------------------------------------------------

    async def _open(self, asked: Request, peer: Peer) -> Answer:
        opened = await self._people.open(
            asked.account, asked.password, Place(asked.place), over=asked.over
        )
        said = AuditEntry(
            what="commissioning opened",
            result="done",
            account=asked.account,
            place=asked.place,
            peer=str(peer),
        )
        if isinstance(opened, Refusal):
            self._audit.refuse(said, peer.uid, opened.why)
            return opened
        if not self._audit.write(said, "done"):
            self._people.close()
            return Refusal(why=Why.UNRECORDED)
        return Opened(key=opened.key)

    # --- jobs ---------------------------------------------------------------------------------

    def _steer(self, asked: Request, held: Holder, peer: Peer) -> Answer:
        """Pass an answer on to the job that waits for one, or end the job."""
        worker = (self._long if asked.do == "stop_long" else self._short).worker
        if worker is None:
            return Refusal(why=Why.CHANGED)
        if asked.do == "answer":
            return self._pass_on(worker, asked, held, peer)
        if worker.asked.do in AWAITED:
            self._audit.refuse(_entry(asked, held, peer), peer.uid, Why.RUNNING)
            return Refusal(why=Why.RUNNING, name=worker.asked.called)
        self._audit.write(_entry(asked, held, peer), "done")
        worker.stop()
        return Done()

    def _pass_on(self, worker: Worker, asked: Request, held: Holder, peer: Peer) -> Answer:
        """Pass an answer on, once its question stands in the audit; the answer does not."""
        entry = _entry(asked, held, peer)
        if worker.asked.account != held.account:
            self._audit.refuse(entry, peer.uid, Why.RUNNING)
            return Refusal(why=Why.RUNNING, name=worker.asked.called)
        question = worker.question
        if question is None or question.number != asked.number:
            return Refusal(why=Why.CHANGED)
        entry = replace(entry, what=f"{entry.what} {question.name}")
        if not self._audit.write(entry, "done"):
            return Refusal(why=Why.UNRECORDED)
        worker.answer(asked.number, asked.text)
        return Done()

    async def _start(self, asked: Request, held: Holder, peer: Peer) -> Answer:
        """Begin a job, once it stands in the audit."""
        how = "at the screen, opened by password"
        if asked.do == "sign":
            against = await self._people.against(held.account, asked.password)
            if against is not None:
                self._audit.refuse(_entry(asked, held, peer), peer.uid, against.why)
                return against
            how = "password given for this signature"
        slot = self._long if asked.do in LONG else self._short
        if slot.worker is not None:
            return Refusal(why=Why.RUNNING, name=slot.worker.asked.called)
        entry = _entry(asked, held, peer)
        if not self._audit.write(entry, "asked", printable(asked.reason)):
            return Refusal(why=Why.UNRECORDED)
        by = f"{by_whom()}; {held.account}, {how}"
        worker = Worker(asked.for_job(account=held.account, by=by), self._where)
        slot.hold(worker)
        slot.running = asyncio.create_task(self._run(slot, worker, entry))
        if asked.do in AWAITED:
            return await asyncio.shield(slot.running)
        return Done()

    async def _run(self, slot: Slot, worker: Worker, entry: AuditEntry) -> Answer:
        try:
            answer = await worker.run()
        except OSError as error:
            answer = Refusal(why=Why.REFUSED, name=str(error))
        except asyncio.CancelledError:
            self._audit.write(entry, "noted", CUT if worker.asked.do in KEEPS else STOPPED)
            raise
        finally:
            slot.worker = None
            self.looking.job_ended()
        is_done, text = slot.ended(worker, answer)
        result = "done" if is_done else "noted" if worker.is_unsure else "refused"
        self._audit.write(entry, result, text)
        return answer

    # --- how it stands ------------------------------------------------------------------------

    def _state(self) -> State:
        held = self._people.holder
        return State(
            by=held.account if held is not None else "",
            site=self.looking.site(),
            service=self.looking.service(),
            card=(self._where.card / CARD).exists(),
            job=self._short.shown(),
            last=self._short.last,
            long=self._long.shown(),
            long_last=self._long.last,
        )


def _entry(asked: Request, held: Holder, peer: Peer) -> AuditEntry:
    return AuditEntry(
        what=f"{BEGIN}{asked.called}",
        result="asked",
        account=held.account,
        role=Role.COMMISSION.word,
        place=held.place,
        peer=str(peer),
        id=asked.measured,
    )
