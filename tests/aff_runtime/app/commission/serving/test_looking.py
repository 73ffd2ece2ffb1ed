"""A screen's look: made anew when something changed; a refusal is never kept for good."""

import asyncio
import math

import pytest

from aff_runtime.app.commission.link.answers import Done
from aff_runtime.app.commission.link.messages import Refusal, Request
from aff_runtime.app.commission.paths import Paths
from aff_runtime.app.commission.serving import looking
from aff_runtime.app.commission.serving.looking import LEAST_AGE_NS, MOST_AGE_OF_RUNS_NS, Looking
from aff_runtime.app.report.line_facts import LineFacts
from aff_runtime.app.report.status_answer import Live, StatusAnswer
from tests.doubles.virtual_clock import VirtualClock

REFUSED = Refusal(why="refused", name="card: takes more than 4096 MB to read")
MADE = Done(text="made")


FACTS = LineFacts(cycle_s=0.005, hold_after_s=0.015, fault_after_s=0.08, speed="line_speed_m_s")


def running_at(speed_m_s):
    """Return how a service stands whose line runs at a speed; NaN: it is not read."""
    told = None if math.isnan(speed_m_s) else speed_m_s
    live = Live(signals={"line_speed_m_s": told, "time_s": 0.0})
    return StatusAnswer(line="l", state="READY", facts=FACTS, live=live)


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

    def after(wait_ns, do="line", *, ended=False, speed_m_s=None):
        clock.advance_ns(wait_ns)
        if ended:
            found.job_ended()
        found._service = None if speed_m_s is None else running_at(speed_m_s)
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


@pytest.mark.parametrize("do", ["line", "card"])
@pytest.mark.parametrize(
    ("first_m_s", "then_m_s"),
    [
        (1.5, 0.15),
        (0.0, 1.5),
        (1.5, 0.0),
        (math.nan, 1.0),
        (1.0, math.nan),
        (1.0, 1.021),
        (0.05, 0.056),
    ],
)
def test_what_is_of_the_line_speed_is_looked_at_anew_at_another_one(
    look, do, first_m_s, then_m_s, tmp_path
):
    after, answers = look
    (tmp_path / "card.jsonl").write_text("{}\n")
    answers += [MADE, Done(text="at another speed")]
    assert after(0, do, speed_m_s=first_m_s) == MADE
    assert after(LEAST_AGE_NS - 1, do, speed_m_s=then_m_s) == MADE
    assert after(1, do, speed_m_s=then_m_s).text == "at another speed"


@pytest.mark.parametrize(
    ("do", "first_m_s", "then_m_s"),
    [
        ("line", 1.0, 1.019),
        ("card", 1.0, 0.981),
        ("line", 0.0, 0.0049),
        ("card", 0.05, 0.0549),
        ("settings", 1.5, 0.15),
    ],
)
def test_noise_of_the_speed_and_what_is_of_no_speed_have_nothing_looked_at_anew(
    look, do, first_m_s, then_m_s, tmp_path
):
    after, answers = look
    (tmp_path / "card.jsonl").write_text("{}\n")
    answers += [MADE]
    assert after(0, do, speed_m_s=first_m_s) == MADE
    assert after(100 * LEAST_AGE_NS, do, speed_m_s=then_m_s) == MADE
