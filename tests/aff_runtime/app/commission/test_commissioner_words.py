"""What the commissioner is told and tells: answers, refusals by the hundred, its socket."""

import asyncio
import json
import logging

from aff_runtime.app.commission.link.answers import State
from aff_runtime.app.commission.link.client import ask, exchanged
from aff_runtime.app.commission.link.listening import Listener
from aff_runtime.app.commission.link.messages import Request
from aff_runtime.app.commission.serving.worker import CUT
from aff_runtime.app.hand.audit import verify
from aff_runtime.app.hand.audit_writer import RETRY_NS
from aff_runtime.base.errors import RefusedError
from aff_runtime.config.yaml_marks import MAX_BYTES
from tests.aff_runtime.app.commission import made_jobs
from tests.aff_runtime.app.commission.made_jobs import say
from tests.aff_runtime.app.commission.made_line import PEER, PERSON, Line
from tests.aff_runtime.app.commission.said import plain

MORE = f"{{count}} more refusals of carl, of uid {PEER.uid}, not written one by one"


async def guessed(line, account, count):
    said = {"account": account, "password": "guessed", "over": False, **PERSON}
    for _ in range(count):
        assert not (await line.ask("open", **said))["ok"]


def full(entry):
    raise RefusedError("No space left on device")


def test_of_an_answer_the_question_stands_in_the_audit_and_not_what_was_said(line, monkeypatch):
    made_jobs.play(monkeypatch, made_jobs.ask("host") + say(done={"text": "answered"}))

    async def played():
        key = await line.open()
        await line.waits(key)
        said = {"key": key, **PERSON, "text": "10.0.0.9"}
        late = await line.ask("answer", number=7, **said)
        right = await line.ask("answer", number=1, **said)
        return late, right, await line.done()

    late, right, last = asyncio.run(played())
    assert late["why"] == "changed"
    assert right == {"ok": True}
    assert last["ok"]
    assert line.rows()[1:] == [
        ("commissioning: words", "asked"),
        ("commissioning: answer host", "done"),
        ("commissioning: words", "done"),
    ]
    assert "10.0.0.9" not in line.audit.path.read_text()


def test_an_answer_that_cannot_be_put_on_record_is_not_passed_on(line, monkeypatch):
    made_jobs.play(monkeypatch, made_jobs.ask() + say(done={"text": "answered"}))

    async def played():
        key = await line.open()
        await line.waits(key)
        line.audit._is_whole = False
        found = await line.ask("answer", key=key, **PERSON, number=1, text="10.0.0.9")
        await line.ask("stop", key=key, **PERSON)
        return found, await line.done()

    found, last = asyncio.run(played())
    assert found["why"] == "unrecorded"
    assert last["text"] == CUT


def test_of_a_flood_of_refusals_sixty_are_written_and_then_their_number(line, clock):
    asyncio.run(guessed(line, "carl", 500))
    assert line.rows() == [("commissioning opened", "refused")] * 60
    clock.advance_ns(34 * 10**9)  # 0.03 lines a second: room for one
    asyncio.run(line.ask("state"))
    assert line.rows()[60:] == [("more", "noted")]
    assert line.whys()[60:] == [MORE.format(count=440)]


def test_a_flood_of_one_account_takes_no_line_of_another(line):
    asyncio.run(guessed(line, "carl", 500))
    asyncio.run(guessed(line, "cleo", 5))
    assert line.rows() == [("commissioning opened", "refused")] * 65


def test_what_was_not_written_is_said_at_the_end(line, clock, tmp_path):
    asyncio.run(guessed(line, "carl", 70))
    line.commissioner.close()
    assert line.whys()[60:] == [MORE.format(count=10)]
    (tmp_path / "other").mkdir()
    line.commissioner = Line(tmp_path / "other", clock).commissioner  # for the fixture to close


def test_refusals_on_a_full_disk_are_in_the_log_and_their_number_in_the_audit(
    line, clock, monkeypatch, caplog
):
    caplog.set_level(logging.INFO, "aff_runtime")
    with monkeypatch.context() as broken:
        broken.setattr(line.audit, "add", full)
        asyncio.run(guessed(line, "carl", 7))
    assert line.audit.last == 0
    lost = [one for one in caplog.messages if one.endswith("; not in the audit")]
    assert len(lost) == 7
    assert "No space left on device" in caplog.text
    clock.advance_ns(RETRY_NS)
    asyncio.run(line.ask("state"))
    assert line.rows() == [("lost", "noted")]
    assert line.whys() == ["7 lines could not be written"]
    assert verify(line.audit.path).last == 1


def test_wrong_signatures_are_refusals_too(line, clock):
    what = {"step": 4, "reason": "seen", "measured": "0" * 64, "password": "guessed"}

    async def flooded():
        key = await line.open()
        for _ in range(500):
            assert not (await line.ask("sign", key=key, **PERSON, **what))["ok"]

    asyncio.run(flooded())
    assert line.rows() == [
        ("commissioning opened", "done"),
        *[("commissioning: sign 4", "refused")] * 60,
    ]
    clock.advance_ns(34 * 10**9)
    asyncio.run(line.ask("state"))
    assert line.whys()[-1] == MORE.format(count=440)


def test_a_screen_finds_it_at_its_socket_and_others_say_what_they_like(line):
    folder = line.folder / "rt"

    async def said(path, asked):
        return json.loads(await exchanged(path, json.dumps(asked).encode()))

    async def played():
        listener = Listener(folder, line.commissioner.answer, is_private=True)
        serving = asyncio.create_task(listener.run())
        path = folder / "commission.sock"
        try:
            assert path.stat().st_mode & 0o777 == 0o600
            state = plain(await ask(path, Request(do="state")))
            assert state["site"]["there"]
            assert not state["service"]["answers"]
            assert (await said(path, {"do": "arm"}))["why"] == "no sense"
            assert (await said(path, {"do": "state", "more": "x" * 9000}))["why"] == "no sense"
            texts = {"site_text": "\n" * MAX_BYTES, "former": "\n" * MAX_BYTES}
            long = Request(do="settings_text", base="0" * 64, **texts)
            assert plain(await ask(path, long))["why"] == "changed"  # read to its end
            found = await asyncio.gather(*(ask(path, Request(do="state")) for _ in range(12)))
            assert all(isinstance(one, State) for one in found)
        finally:
            serving.cancel()
            listener.close()
        assert plain(await ask(path, Request(do="state")))["why"] == "silent"

    asyncio.run(played())
