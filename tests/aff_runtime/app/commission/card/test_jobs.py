"""A card's jobs in this process: what was measured is signed, and only as it was seen."""

import shutil

import pytest

from aff_runtime.app.card.work import CardFile
from aff_runtime.app.commission import paths
from aff_runtime.app.commission.card import jobs as card_jobs
from aff_runtime.app.commission.link.messages import Request
from aff_runtime.app.commission.paths import Paths
from tests.aff_runtime.app.card.measure.recorded import SITE_FILE
from tests.aff_runtime.app.commission.said import plain
from tests.aff_runtime.app.judged_here import judged_here

TYPED = "reaction=ramp\ntime=120 ms"
SIGNS = {"account": "carl", "by": "carl", "reason": "seen on the drive"}


class Talk:
    def say(self, text):
        pass


@pytest.fixture
def done(tmp_path, monkeypatch):
    """Return what does a job on a card that is begun; the job's answer is plain."""
    monkeypatch.setattr(paths, "load_parameters", judged_here)
    site = tmp_path / "site.yaml"
    shutil.copyfile(SITE_FILE, site)
    where = Paths(site=site, state=tmp_path, socket=tmp_path / "none", card=tmp_path / "card")

    def act(do, **said):
        return plain(getattr(card_jobs, do)(where, Request(do=do, **said), Talk()))

    act.where = where
    assert act("begin")["ok"]
    return act


def test_what_was_measured_is_signed_by_the_name_that_is_given(done):
    assert done("step", step=4, typed=TYPED, by="carl")["text"] == "step 4: pass"
    seen = CardFile.of(done.where.card).entries[-1].sha256
    assert done("sign", step=4, measured=seen, **SIGNS)["text"] == "step 4 signed as carl"


def test_a_page_whose_card_cannot_be_compared_with_what_holds_now_says_so(done):
    assert "not compared" not in done("printed", paper="a4")["html"].replace(
        "roll not compared", ""
    )
    done.where.site.write_text("no site file")
    assert "not compared with what holds now: " in done("printed", paper="a4")["html"]


def test_what_somebody_has_measured_anew_is_not_signed_unseen(done):
    done("step", step=4, typed=TYPED, by="carl")
    entries = len(CardFile.of(done.where.card).entries)
    told = done("sign", step=4, measured="0" * 64, **SIGNS)
    assert told == {"ok": False, "why": "changed", "name": ""}
    assert len(CardFile.of(done.where.card).entries) == entries
