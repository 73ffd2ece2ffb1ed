"""A site file, a commissioner of it, and people who may open it; no service."""

import asyncio
import json
import shutil

from aff_runtime.app.commission.link.messages import Request
from aff_runtime.app.commission.paths import Paths
from aff_runtime.app.commission.serving.commissioner import Commissioner
from aff_runtime.app.hand.accounts import Account, Accounts, secret_of, write_accounts
from aff_runtime.app.hand.audit import Audit
from aff_runtime.app.hand.may import Place, Role
from aff_runtime.app.link.peer import Peer
from tests.aff_runtime.app.card.measure.recorded import SITE_FILE
from tests.aff_runtime.app.commission.said import plain

PASSWORD = "tension, 90 N"
PEER = Peer(uid=0, pid=1)
PERSON = {"place": "panel"}


class Line:
    """A site file, a commissioner of it, and who has opened it."""

    def __init__(self, folder, clock):
        site = folder / "site.yaml"
        shutil.copyfile(SITE_FILE, site)
        people = folder / "accounts"
        secret = secret_of(PASSWORD)
        names = ("carl", "cleo")
        write_accounts(
            people, [Account(name=one, role=Role.COMMISSION, secret=secret) for one in names]
        )
        self.folder = folder
        self.where = Paths(
            site=site,
            state=folder / "none",
            socket=folder / "rt" / "control.sock",
            card=folder / "card",
        )
        self.audit = Audit(folder / "audit")
        self.commissioner = Commissioner(
            self.where, Accounts(people), self.audit, clock, Place.PANEL
        )

    async def ask(self, do, **said):
        return plain(await self.commissioner.answer(Request(do=do, **said), PEER))

    async def open(self, account="carl", *, over=False):
        said = {"account": account, "password": PASSWORD, "over": over}
        return (await self.ask("open", **said, **PERSON))["key"]

    async def done(self, job="job"):
        """Return the last job, or the last long one, once none is under way."""
        async with asyncio.timeout(60.0):
            while (state := await self.ask("state"))[job] is not None:
                await asyncio.sleep(0.02)
        return state["last" if job == "job" else f"{job}_last"]

    async def waits(self, key):
        """Begin an interview and return once it waits for an answer."""
        assert (await self.ask("words", key=key, **PERSON, again=""))["ok"]
        while (await self.ask("state"))["job"]["ask"] is None:
            await asyncio.sleep(0.01)

    def rows(self):
        text = (self.folder / "audit" / "audit.jsonl").read_text()
        return [(row["what"], row["result"]) for row in map(json.loads, text.splitlines())]

    def whys(self):
        text = (self.folder / "audit" / "audit.jsonl").read_text()
        return [row["why"] for row in map(json.loads, text.splitlines())]
