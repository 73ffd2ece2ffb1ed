"""What a step proposes is tried as it stands on the card, and nothing else."""

import shutil
from dataclasses import replace

import pytest

from aff_runtime.app.card.book import CardBook
from aff_runtime.app.commission import paths
from aff_runtime.app.commission.link.messages import Request
from aff_runtime.app.commission.paths import Paths, parameters_of
from aff_runtime.app.commission.settings import jobs as settings_jobs
from aff_runtime.app.commission.settings.jobs import keep, proposed, try_proposed, undo
from aff_runtime.app.link.settings_answer import SettingsAnswer
from aff_runtime.base.errors import RefusedError
from tests.aff_runtime.app.card.made import add, book, measured
from tests.aff_runtime.app.card.measure.recorded import SITE_FILE
from tests.aff_runtime.app.commission.said import plain
from tests.aff_runtime.app.judged_here import judged_here

PROPOSED = "actuators.unwind.blocks.0.settle_s: 3  # was 6"
ASKED = Request(do="try", step=9, seconds=60, reason="falls no more", account="carl")


class Talk:
    def say(self, text):
        pass


@pytest.fixture
def where(tmp_path, monkeypatch):
    monkeypatch.setattr(paths, "load_parameters", judged_here)
    site = tmp_path / "site.yaml"
    shutil.copyfile(SITE_FILE, site)
    return Paths(site=site, state=tmp_path, socket=tmp_path / "none", card=tmp_path / "card")


@pytest.fixture
def asked(monkeypatch):
    """What reaches the service; it answers with one change."""
    found = []

    def ask(where, **arguments):
        found.append(arguments)
        return SettingsAnswer()

    monkeypatch.setattr(settings_jobs, "ask_settings", ask)
    return found


def proposing(where, *sentences):
    """Return the hash of a measurement of step 9 on a card."""
    made: CardBook = book(where.card)
    return add(made, measured(step=9, proposals=sentences))


def test_the_proposed_number_alone_is_another_one_in_what_is_tried(where, asked):
    digest = proposing(where, PROPOSED)
    assert "tried for 60 s" in try_proposed(where, replace(ASKED, measured=digest), Talk()).text
    (sent,) = asked
    before = parameters_of(where.site, where.state).site_text.split("\n")
    after = sent.pop("text").split("\n")
    changed = [(a, b) for a, b in zip(before, after, strict=True) if a != b]
    assert len(changed) == 1
    assert changed[0][1] == changed[0][0].replace("settle_s: 6", "settle_s: 3")
    assert sent == {"act": "try", "seconds": 60.0, "why": "falls no more (carl at the screen)"}


def test_what_somebody_has_measured_anew_is_not_tried_unseen(where, asked):
    proposing(where, PROPOSED)
    told = plain(try_proposed(where, replace(ASKED, measured="0" * 64), Talk()))
    assert told == {"ok": False, "why": "changed", "name": ""}
    assert asked == []


@pytest.mark.parametrize("sentences", [(), ("look at the drive",), ("line.name: Euclid",)])
def test_a_step_without_numbers_to_try_says_so(sentences):
    with pytest.raises(RefusedError):
        proposed(sentences)


def test_a_measured_noise_is_a_number_with_its_remark():
    text = "actuators.unwind.error.noise_N: 0.21  # measured; was 0.5"
    assert proposed([text]) == {("actuators", "unwind", "error", "noise_N"): 0.21}


@pytest.mark.parametrize(("act", "job"), [("keep", keep), ("undo", undo)])
def test_an_end_is_asked_for_with_who_why_and_of_what_was_seen(
    where, asked, act, job, monkeypatch
):
    saved = []
    monkeypatch.setattr(settings_jobs, "save_handed_out", lambda *given: saved.append(given))
    said = Request(do=act, measured="0" * 64, reason="it is better", account="carl")
    job(where, said, Talk())
    assert asked == [{"act": act, "why": "it is better (carl at the screen)", "tried": "0" * 64}]
    assert len(saved) == (1 if act == "keep" else 0)


@pytest.mark.parametrize("reason", ["", "short", "       ", " seven77 "])
@pytest.mark.parametrize("job", [keep, undo, try_proposed])
def test_the_name_at_the_screen_is_no_part_of_a_reason_that_is_long_enough(
    where, asked, job, reason
):
    digest = proposing(where, PROPOSED)
    said = replace(ASKED, measured=digest, reason=reason)
    short = f"read {len(reason.strip())} characters, a reason of 8"
    with pytest.raises(RefusedError, match=short):
        job(where, said, Talk())
    assert asked == []
