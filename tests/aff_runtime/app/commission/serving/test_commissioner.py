"""The commissioner with its own jobs, on a site file without a service: who, what, on record.

Answers, refusals and its socket are in ``test_commissioner_words.py``.
"""

import asyncio
import json

import pytest

from aff_runtime.app.card.entries import Signed
from aff_runtime.app.card.work import CardFile
from aff_runtime.app.commission.serving.people import IDLE_NS
from aff_runtime.app.commission.serving.worker import CUT, STOPPED
from aff_runtime.app.hand.audit import verify
from tests.aff_runtime.app.commission import made_jobs
from tests.aff_runtime.app.commission.made_jobs import say
from tests.aff_runtime.app.commission.made_line import PASSWORD, PERSON

TYPED = "reaction=ramp\ntime=120 ms"


def step(key, number=4, typed=TYPED, **more):
    return {
        "key": key,
        **PERSON,
        "step": number,
        "typed": typed,
        "plc": "",
        "leave_out": "",
    } | more


def test_a_step_is_measured_and_signed_by_who_gives_the_password_again(line, monkeypatch):
    async def played():
        made_jobs.do_here(monkeypatch)  # in a process of its own: test_commissioner_words.py
        key = await line.open()
        assert (await line.ask("begin", key=key, **PERSON))["ok"]
        assert (await line.done())["ok"]
        assert (await line.ask("step", **step(key)))["ok"]
        assert (await line.done())["text"] == "step 4: pass"
        card = (await line.ask("card"))["card"]
        seen = next(one for one in card["steps"] if one["number"] == 4)
        assert seen["stand"] == "pass"
        assert seen["can_sign"]
        assert seen["typed_names"] == ["reaction", "time"]
        below = {"key": key, **PERSON, "step": 4, "reason": "seen on the drive"}
        wrong = await line.ask(
            "sign", **below, measured=seen["entry"]["sha256"], password="another one"
        )
        other = await line.ask("sign", **below, measured="0" * 64, password=PASSWORD)
        right = await line.ask(
            "sign", **below, measured=seen["entry"]["sha256"], password=PASSWORD
        )
        return seen, wrong, other, right

    seen, wrong, other, right = asyncio.run(played())
    assert wrong == {"ok": False, "why": "password", "name": ""}
    assert other == {"ok": False, "why": "changed", "name": ""}
    assert right["ok"]
    said = [one.content for one in CardFile.of(line.where.card).entries]
    signatures = [one for one in said if isinstance(one, Signed)]
    assert [one.measured for one in signatures] == [seen["entry"]["sha256"]]
    assert signatures[0].name == "carl"
    assert signatures[0].by.endswith("carl, password given for this signature")
    assert line.rows() == [
        ("commissioning opened", "done"),
        ("commissioning: begin", "asked"),
        ("commissioning: begin", "done"),
        ("commissioning: step 4", "asked"),
        ("commissioning: step 4", "done"),
        ("commissioning: sign 4", "refused"),
        ("commissioning: sign 4", "asked"),
        ("commissioning: sign 4", "refused"),
        ("commissioning: sign 4", "asked"),
        ("commissioning: sign 4", "done"),
    ]
    assert not verify(line.audit.path).wrong
    assert PASSWORD not in line.audit.path.read_text()


def test_without_a_key_nothing_is_done_and_nothing_is_written(line):
    async def played():
        for key in ("", "k" * 43):
            assert (await line.ask("begin", key=key, **PERSON))["why"] == "closed"
            assert (await line.ask("step", **step(key)))["why"] == "closed"
        assert (await line.ask("card"))["name"] == "no card is begun"

    asyncio.run(played())
    assert not line.where.card.exists()
    assert line.rows() == []


def test_one_job_at_a_time_and_it_can_be_stopped(line):
    async def played():
        key = await line.open()
        assert (await line.ask("begin", key=key, **PERSON))["ok"]
        second = await line.ask("verify", key=key, **PERSON)
        assert (second["why"], second["name"]) == ("running", "begin")
        assert (await line.ask("stop", key=key, **PERSON))["ok"]
        return await line.done()

    last = asyncio.run(played())
    assert (last["ok"], last["text"]) == (False, CUT)
    assert line.rows()[-1] == ("commissioning: begin", "noted")


WINDOWS = {"windows": "a", "holdout": "", "without": ""}


def test_what_takes_hours_runs_beside_the_other_jobs_and_when_nobody_is_in(
    line, clock, monkeypatch
):
    release = line.folder / "release"
    script = "if asked['do'] == 'refine':\n    " + made_jobs.until(release).replace("\n", "\n    ")
    made_jobs.play(monkeypatch, script + "pass\n" + say(done={"text": "it is done"}))

    async def played():
        key = await line.open()
        assert (await line.ask("refine", key=key, **PERSON, **WINDOWS))["ok"]
        second = await line.ask("lacks", key=key, **PERSON, **WINDOWS)
        assert (second["why"], second["name"]) == ("running", "refine")
        assert (await line.ask("begin", key=key, **PERSON))["ok"]
        assert (await line.done())["do"] == "begin"
        clock.advance_ns(IDLE_NS + 1)
        state = await line.ask("state")
        assert (state["by"], state["long"]["do"]) == ("", "refine")
        assert state["long"]["seconds"] > 900.0
        release.touch()
        return await line.done("long")

    last = asyncio.run(played())
    assert (last["do"], last["ok"], last["text"]) == ("refine", True, "it is done")
    assert line.rows()[-1] == ("commissioning: refine", "done")


def test_who_is_in_stops_what_takes_hours_and_the_audit_says_so(line, monkeypatch):
    made_jobs.play(monkeypatch, say(say="at it") + "time.sleep(600)\n")

    async def played():
        key = await line.open()
        stop = {"key": key, **PERSON}
        assert (await line.ask("stop_long", **stop))["why"] == "changed"
        assert (await line.ask("refine", key=key, **PERSON, **WINDOWS))["ok"]
        assert (await line.ask("stop", **stop))["why"] == "changed"
        assert (await line.ask("stop_long", key="", **PERSON))["why"] == "closed"
        assert (await line.ask("stop_long", **stop))["ok"]
        return await line.done("long")

    last = asyncio.run(played())
    assert (last["ok"], last["text"]) == (False, STOPPED)
    assert ("commissioning: stop_long", "done") in line.rows()


def test_a_signature_that_is_asked_for_is_not_stopped(line, monkeypatch):
    release = line.folder / "release"
    made_jobs.play(monkeypatch, made_jobs.until(release) + say(done={"text": "signed"}))
    what = {"step": 4, "reason": "seen on the drive", "measured": "0" * 64}

    async def played():
        key = await line.open()
        signing = asyncio.create_task(
            line.ask("sign", key=key, **PERSON, **what, password=PASSWORD)
        )
        while (await line.ask("state"))["job"] is None:
            await asyncio.sleep(0.01)
        stopped = await line.ask("stop", key=key, **PERSON)
        release.touch()
        return stopped, await signing

    stopped, signed = asyncio.run(played())
    assert stopped == {"ok": False, "why": "running", "name": "sign 4"}
    assert signed == {"ok": True, "text": "signed"}
    assert line.rows()[-2:] == [
        ("commissioning: stop", "refused"),
        ("commissioning: sign 4", "done"),
    ]


@pytest.mark.parametrize("do", ["keep", "undo", "go_back"])
def test_the_audit_has_of_settings_their_reason_and_the_sha256_of_their_text(
    line, monkeypatch, do
):
    made_jobs.play(monkeypatch, say(done={"text": "kept"}))
    what = {"measured": "7" * 64, "reason": "3 dB less\nat 1x"}
    if do == "go_back":
        what |= {"number": 3, "base": "1" * 64}

    async def played():
        key = await line.open()
        assert (await line.ask(do, key=key, **PERSON, **what))["ok"]
        return await line.done()

    assert asyncio.run(played())["ok"]
    said = [json.loads(row) for row in line.audit.path.read_text().splitlines()]
    found = [(row["what"], row["result"], row["why"], row["id"]) for row in said[1:]]
    assert found == [
        (f"commissioning: {do}", "asked", "3 dB less\\nat 1x", "7" * 64),
        (f"commissioning: {do}", "done", "kept", "7" * 64),
    ]


def test_what_cannot_be_put_on_record_is_not_done(line, monkeypatch):
    async def played():
        key = await line.open()
        line.audit._is_whole = False
        return await line.ask("begin", key=key, **PERSON)

    assert asyncio.run(played())["why"] == "unrecorded"
    assert not line.where.card.exists()


async def closed(line, clock, key):
    assert (await line.ask("close", key=key, **PERSON))["ok"]


async def idle(line, clock, key):
    clock.advance_ns(IDLE_NS + 1)
    tending = asyncio.create_task(line.commissioner.run())
    await asyncio.sleep(0)
    tending.cancel()


async def replaced(line, clock, key):
    await line.open("cleo", over=True)


@pytest.mark.parametrize("leave", [closed, idle, replaced])
def test_a_job_that_waits_for_somebody_who_is_not_in_any_more_is_stopped(
    line, clock, monkeypatch, leave
):
    made_jobs.play(monkeypatch, made_jobs.ask() + say(done={"text": "answered"}))

    async def played():
        key = await line.open()
        await line.waits(key)
        await leave(line, clock, key)
        return await line.done()

    last = asyncio.run(played())
    assert (last["ok"], last["text"]) == (False, CUT)
    assert "stopped: it waits for somebody who is not in" in line.whys()


def test_who_takes_it_over_does_not_answer_for_who_began(line, monkeypatch):
    release = line.folder / "release"
    made_jobs.play(monkeypatch, made_jobs.until(release) + made_jobs.ask())

    async def played():
        await line.ask("words", key=await line.open(), **PERSON, again="")
        key = await line.open("cleo", over=True)
        found = await line.ask("answer", key=key, **PERSON, number=1, text="10.0.0.9")
        release.touch()
        return found, await line.done()

    found, last = asyncio.run(played())
    assert found == {"ok": False, "why": "running", "name": "words"}
    assert last["text"] == CUT
    assert ("commissioning: answer", "refused") in line.rows()
