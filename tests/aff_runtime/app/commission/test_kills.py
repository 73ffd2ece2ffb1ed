"""Who is killed in the middle of a signature: the commissioner, or the screen that asked for it.

A signature that is killed at each of its steps is in ``card/test_book.py``; probe and try between
real processes in ``app/test_commissioning_kills.py``.
"""

import asyncio
import json
import shutil
import socket

import pytest

from aff_runtime.app.commission.link.listening import Listener
from aff_runtime.app.commission.link.messages import Request, Why
from aff_runtime.app.commission.serving.audit_lines import unended
from aff_runtime.app.commission.serving.commissioner import Commissioner
from aff_runtime.app.commission.serving.worker import KEEPS, KILLED
from aff_runtime.app.hand.accounts import Accounts
from aff_runtime.app.hand.audit import START, Audit, AuditEntry, verify
from aff_runtime.app.hand.may import Place
from tests.aff_runtime.app.commission import made_jobs
from tests.aff_runtime.app.commission.made_jobs import say
from tests.aff_runtime.app.commission.made_line import PASSWORD, PEER, PERSON

SIGN = {"step": 4, "reason": "seen on the drive", "measured": "0" * 64, "password": PASSWORD}


async def begun(line):
    while (await line.ask("state"))["job"] is None:
        await asyncio.sleep(0.01)


def another(line, audit, clock):
    """Return the commissioner that follows on what the killed one has left on the disk."""
    accounts = Accounts(line.folder / "accounts")
    return Commissioner(line.where, accounts, Audit(audit), clock, Place.PANEL)


@pytest.mark.parametrize(("do", "said"), [("sign", SIGN), ("keep", {"reason": "it is quiet"})])
def test_a_commissioner_killed_in_the_middle_of_a_job_says_so_when_it_is_back(
    line, monkeypatch, clock, do, said
):
    release, left = line.folder / "release", line.folder / "left"
    made_jobs.play(monkeypatch, made_jobs.until(release) + say(done={"text": "signed"}))

    async def played():
        key = await line.open()
        asked = asyncio.create_task(line.ask(do, key=key, **PERSON, **said))
        await begun(line)
        shutil.copytree(line.folder / "audit", left)  # what a SIGKILL leaves, to the byte
        release.touch()
        return await asked, await line.done()

    asyncio.run(played())
    shutil.copytree(line.folder / "audit", line.folder / "whole")
    found = another(line, left, clock)
    state = asyncio.run(found.answer(Request(do="state"), PEER))
    assert (state.last.do, state.last.ok, state.last.text) == (do, False, KILLED)
    assert state.last.step == said.get("step", -1)
    found.close()
    rows = [json.loads(row) for row in (left / "audit.jsonl").read_text().splitlines()]
    assert [(one["result"], one["account"], one["why"]) for one in rows[-2:]] == [
        ("asked", "carl", said["reason"]),
        ("noted", "carl", KILLED),
    ]
    assert not verify(left / "audit.jsonl").wrong
    for folder in (left, line.folder / "whole"):  # said once; of a job that has ended, nothing
        quiet = another(line, folder, clock)
        assert asyncio.run(quiet.answer(Request(do="state"), PEER)).last is None
        quiet.close()


def left_behind(folder, *said, max_bytes=1 << 20):
    """Return what has no end in an audit of these lines: (account, what, result, why)."""
    audit = Audit(folder, max_bytes=max_bytes)
    for account, what, result, why in said:
        audit.add(AuditEntry(what=what, result=result, why=why, account=account))
    audit.close()
    return [(one.account, one.what) for one in unended(audit.path, KEEPS)]


STEP = "commissioning: sign 4"
ASKED = ("carl", STEP, "asked", "seen on the drive")


@pytest.mark.parametrize(
    ("then", "is_left"),
    [
        (("carl", STEP, "refused", Why.PASSWORD.value), True),  # another press: it ran on
        (("carl", STEP, "refused", Why.WAIT.value), True),
        (("dora", STEP, "done", ""), True),
        (("carl", STEP, "refused", "the response was measured at another radius"), False),
        (("carl", STEP, "noted", KILLED), False),
        (("carl", STEP, "done", ""), False),
    ],
)
def test_only_the_end_of_a_job_ends_it_on_record(tmp_path, then, is_left):
    assert left_behind(tmp_path / "a", ASKED, then) == [("carl", STEP)] * is_left


def test_a_job_that_was_killed_after_another_file_began_is_found(tmp_path):
    other = ("carl", "commissioning opened", "done", "")
    assert left_behind(tmp_path, ASKED, other, other, max_bytes=400) == [("carl", STEP)]
    assert [path.name for path in sorted(tmp_path.glob("*.jsonl*"))] == [
        "audit.jsonl",
        "audit.jsonl.1",
    ]


def test_a_line_that_says_nothing_of_a_job_keeps_no_commissioner_from_starting(tmp_path):
    (tmp_path / "audit.jsonl").write_text(f'{{"n":1,"prev":"{START}"}}\n')
    (tmp_path / "audit.jsonl.1").write_bytes(b'\xff\n[1]\n{"what":3}\n')
    tmp_path.chmod(0o700)
    assert left_behind(tmp_path, ASKED) == [("carl", STEP)]


def test_a_screen_killed_while_it_waits_for_a_signature_leaves_it_whole_and_the_place_free(
    line, monkeypatch
):
    release = line.folder / "release"
    made_jobs.play(monkeypatch, made_jobs.until(release) + say(done={"text": "signed"}))

    async def played():
        key = await line.open()
        listener = Listener(line.folder / "rt", line.commissioner.answer, is_private=True)
        serving = asyncio.create_task(listener.run())
        screen = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        try:
            screen.connect(str(line.folder / "rt" / "commission.sock"))
            screen.send(json.dumps({"do": "sign", "key": key, **PERSON, **SIGN}).encode())
            await begun(line)
            screen.close()  # as the kernel does it for who is killed
            release.touch()
            last = await line.done()
            again = await line.ask("sign", key=key, **PERSON, **SIGN)
        finally:
            screen.close()
            serving.cancel()
            listener.close()
        return last, again

    last, again = asyncio.run(played())
    assert (last["do"], last["step"], last["ok"], last["text"]) == ("sign", 4, True, "signed")
    assert again == {"ok": True, "text": "signed"}
    assert (
        line.rows()[-4:]
        == [("commissioning: sign 4", "asked"), ("commissioning: sign 4", "done")] * 2
    )
