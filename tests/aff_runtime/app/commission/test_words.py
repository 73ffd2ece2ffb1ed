"""The interview for a screen: the same engine, answered elsewhere, left, gone on with."""

import pytest

from aff_runtime.app.commission.line import setup_jobs
from aff_runtime.app.commission.line.setup_jobs import find_words
from aff_runtime.app.commission.link.answers import Done
from aff_runtime.app.commission.link.messages import Request
from aff_runtime.app.commission.paths import Paths
from aff_runtime.app.report.status_answer import StatusAnswer
from aff_runtime.base.errors import RefusedError
from aff_runtime.config.loader import load_site
from tests.aff_runtime.cli.test_setup import ANSWERS, ROOT, words_of
from tests.aff_runtime.cli.virtual_line import VirtualLine
from tests.sim_plant.servers.served import served

PICKS = {  # by word, as its manual names it: a busy machine sees fewer readings
    "unwind_tension_N.pick": "w2",
    "tension_ref_N.pick": "w4",
    "unwind_radius_m.pick": "w6",
    "swrap_follower_speed_m_s.pick": "w7",
    "swrap_follower_tension_N.pick": "w9",
}


class Talk:
    """In place of a commissioner: answers by name until one is asked at which somebody leaves."""

    def __init__(self, answers, leaves_at="", before=lambda name: None):
        self.answers, self.leaves_at, self.before = answers, leaves_at, before
        self.asked, self.lines, self.rows = [], [], {}

    def ask(self, name, text, default, *, choices, rows):
        if name == self.leaves_at:
            raise EOFError
        self.before(name)
        self.asked.append(name)
        self.rows[name] = (tuple(choices), tuple(rows))
        return self.answers.get(name, "")

    def say(self, text):
        self.lines.append(text)

    complain = say


@pytest.fixture
def plc(monkeypatch):
    monkeypatch.setattr("aff_runtime.app.setup.modbus.display_steps.VALUE_S", 0.8)
    monkeypatch.setattr("aff_runtime.app.setup.modbus.steps.LOOK_S", 1.5)
    with served(VirtualLine()) as running:
        yield running


@pytest.fixture
def where(tmp_path):
    return Paths(
        site=tmp_path / "site.yaml",
        state=tmp_path,
        socket=tmp_path / "control.sock",
        card=tmp_path / "card",
    )


@pytest.mark.wire
def test_a_screen_finds_the_words_of_the_shipped_site_file_leaves_and_goes_on(plc, where):
    answers = ANSWERS | PICKS | {"port": str(plc.port)}
    first = Talk(answers, leaves_at="line_speed_m_s.pick")
    assert find_words(where, Request(do="words", again=""), first) == Done(
        text="left; what was answered is kept"
    )
    assert not where.site.exists()
    second = Talk(answers)
    assert find_words(where, Request(do="words", again=""), second).text == f"wrote {where.site}"
    assert second.asked[0] == "line_speed_m_s.display"
    choices, rows = second.rows["line_speed_m_s.pick"]
    assert choices == ("again", "move")
    assert any("word 5" in text for _, text in rows)
    assert second.rows["status.order"][0] == ("yes", "no")
    found, shipped = (
        words_of(load_site(path)) for path in (where.site, ROOT / "config/euclid.yaml")
    )
    assert set(found.pop("channels")) == set(shipped.pop("channels"))  # types: test_setup.py
    assert found == shipped
    counts = plc.command("status")["counts"]
    assert (counts["writes"], counts["foreign_writes"]) == (0, 0)
    third = Talk(answers | {"name": "Other", "replace": "yes"})
    third.before = lambda name: where.site.write_text("of somebody") if name == "replace" else None
    with pytest.raises(RefusedError, match="somebody has saved it meanwhile"):
        find_words(where, Request(do="words", again="name"), third)
    assert third.asked == ["name", "replace"]
    assert where.site.read_text() == "of somebody"


def test_while_a_correction_goes_out_nobody_else_speaks_to_the_plc(where, monkeypatch):
    standing = StatusAnswer(line="Euclid", state="ACTIVE")
    monkeypatch.setattr(setup_jobs, "status_of", lambda socket: standing)
    with pytest.raises(RefusedError, match="bypass first"):
        find_words(where, Request(do="words", again=""), Talk({}))
