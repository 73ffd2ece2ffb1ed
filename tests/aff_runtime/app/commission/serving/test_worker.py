"""What became of a job: its own answer, whatever was stopped later, else that it is not known."""

import asyncio

import pytest

from aff_runtime.app.commission.job import JOBS
from aff_runtime.app.commission.link.messages import Request
from aff_runtime.app.commission.paths import Paths
from aff_runtime.app.commission.serving.worker import CUT, DIED, KEEPS, STOPPED, Worker
from tests.aff_runtime.app.commission import made_jobs
from tests.aff_runtime.app.commission.made_jobs import say
from tests.aff_runtime.app.commission.said import plain

NEVER = "time.sleep(600)\n"


@pytest.fixture
def where(tmp_path):
    return Paths(site=tmp_path, state=tmp_path, socket=tmp_path, card=tmp_path)


def stopped_after_words(where, do):
    """Return what became of a job that is stopped once it has said something, and its worker."""
    found = Worker(Request(do=do), where)

    async def played():
        running = asyncio.create_task(found.run())
        while not found.said:
            await asyncio.sleep(0.01)
        found.stop()
        return await running

    return plain(asyncio.run(played())), found


def test_an_answer_that_was_given_counts_though_a_stop_came_later(where, monkeypatch):
    made_jobs.play(monkeypatch, say(done={"text": "kept"}) + say(say="heard") + NEVER)
    told, worker = stopped_after_words(where, "keep")
    assert told == {"ok": True, "text": "kept"}
    assert not worker.is_unsure


LASTING = ["begin", "step", "sign", "words", "try", "keep", "undo", "try_refined", "exchange"]
LASTING += ["try_settings", "save_settings", "go_back"]
"""Jobs that write the card, the site file, answers of the setup or a life, or change what runs."""
OF_RUNS = {"refining", "refined", "refined_page", "lacks", "refine", "maintenance", "add_runs"}
OF_SETTINGS = {"settings", "settings_diff", "settings_text", "settings_version"}
"""Jobs that look, or whose results are there as a whole or not at all."""


def test_every_job_either_only_looks_or_may_have_changed_what_lasts():
    assert set(KEEPS) == set(LASTING)
    assert set(JOBS) - set(LASTING) == {"card", "page", "line", "verify", *OF_RUNS, *OF_SETTINGS}


@pytest.mark.parametrize("do", LASTING)
def test_of_a_stopped_job_that_keeps_something_nobody_knows_whether_it_did(where, monkeypatch, do):
    made_jobs.play(monkeypatch, say(say="at it") + NEVER)
    told, worker = stopped_after_words(where, do)
    assert told == {"ok": False, "why": "refused", "name": CUT}
    assert worker.is_unsure


def test_a_stopped_look_is_stopped(where, monkeypatch):
    made_jobs.play(monkeypatch, say(say="at it") + NEVER)
    told, worker = stopped_after_words(where, "verify")
    assert told["name"] == STOPPED
    assert not worker.is_unsure


def test_a_job_that_talks_no_sense_is_ended_and_has_not_answered(where, monkeypatch):
    made_jobs.play(monkeypatch, "print('no JSON', flush=True)\n" + NEVER)
    found = Worker(Request(do="verify"), where)
    assert plain(asyncio.run(found.run()))["name"] == DIED
