"""A screen's look: made anew when something changed; a refusal is never kept for good."""

import asyncio

import pytest

from aff_runtime.app.commission import looking
from aff_runtime.app.commission.answers import Done
from aff_runtime.app.commission.looking import LEAST_AGE_NS, MOST_AGE_OF_RUNS_NS, Looking
from aff_runtime.app.commission.messages import Refusal, Request
from aff_runtime.app.commission.sources import Paths
from tests.doubles.virtual_clock import VirtualClock

REFUSED = Refusal(why="refused", name="card: takes more than 4096 MB to read")
MADE = Done(text="made")


@pytest.fixture
def look(tmp_path, monkeypatch):
    """Return how a screen looks at the line after some nanoseconds, and the answers to come."""
    site = tmp_path / "site.yaml"
    site.write_text("site: 1\n")
    where = Paths(site=site, state=tmp_path, socket=tmp_path / "none", card=tmp_path)
    clock, answers = VirtualClock(1), []
    found = Looking(where, clock)

    class Job:
        def __init__(self, asked, where):
            pass

        async def run(self):
            return answers.pop(0)

    monkeypatch.setattr(looking, "Worker", Job)

    def after(wait_ns, do="line", *, ended=False):
        clock.advance_ns(wait_ns)
        if ended:
            found.job_ended()
        return asyncio.run(found.look(Request(do=do)))

    return after, answers


def test_a_refusal_is_tried_again_after_the_least_time_and_not_before(look):
    after, answers = look
    answers += [REFUSED, MADE]
    assert after(0) == REFUSED
    assert after(LEAST_AGE_NS - 1) == REFUSED
    assert after(1) == MADE


def test_an_answer_is_kept_as_long_as_nothing_is_another_one(look):
    after, answers = look
    answers += [MADE]
    assert after(0) == MADE
    assert after(100 * LEAST_AGE_NS) == MADE


def test_a_job_that_has_ended_has_everything_looked_at_anew(look):
    after, answers = look
    answers += [MADE, Done(text="another")]
    assert after(0) == MADE
    assert after(LEAST_AGE_NS, ended=True).text == "another"


@pytest.mark.parametrize("do", ["refining", "maintenance"])
def test_runs_grow_by_themselves_so_a_look_at_them_is_old_after_half_a_minute(look, do):
    after, answers = look
    answers += [MADE, Done(text="more runs")]
    assert after(0, do) == MADE
    assert after(MOST_AGE_OF_RUNS_NS - 1, do) == MADE
    assert after(1, do).text == "more runs"
