"""Refining for a screen: what is asked of the program, what is kept of it, and what is refused."""

import json
import shutil
import stat
import sys
from dataclasses import asdict, replace

import pytest

from aff_runtime.app.commission.link.messages import Request
from aff_runtime.app.commission.paths import Paths
from aff_runtime.app.commission.records import refine_jobs, refine_program
from aff_runtime.app.commission.records.refine_jobs import (
    OTHER_SITE,
    lacks,
    page,
    refine,
    refined,
    refining,
    try_refined,
)
from aff_runtime.app.commission.records.refine_shelf import MOST_REFINEMENTS, Shelf
from aff_runtime.app.commission.settings import jobs as settings_jobs
from aff_runtime.app.link.settings_answer import SettingsAnswer
from aff_runtime.base.errors import RefusedError, WireError
from aff_runtime.base.refinement import Lacking, RecordLacks, Summary
from aff_runtime.base.text_digest import text_digest
from tests.aff_runtime.app.card.measure.recorded import SITE_FILE
from tests.aff_runtime.app.commission.said import plain

ASKED = Request(do="refine", windows="a@0..60\nb", holdout="c", account="carl")
SUMMARY = Summary(
    kind="traced",
    headline="Traced: eccentric roller at R6.",
    sure="",
    gain="",
    next_step="",
    effects=(),
    unknown=(),
    errors=(),
    limits=(),
    judged_on="c",
    held_out=True,
)
LACKING = Lacking(
    records=(RecordLacks(name="a", is_held=False, lacks=("one speed only",)),), together=()
)
PROGRAM = """\
import json, os, pathlib, sys
words = sys.argv[1:]
out = pathlib.Path(words[words.index("--out") + 1])
print(json.dumps({"words": words, "nice": os.nice(0)}), flush=True)
"""


class Talk:
    def __init__(self):
        self.said = []

    def say(self, text):
        self.said.append(text)


@pytest.fixture
def where(tmp_path):
    site = tmp_path / "site.yaml"
    shutil.copyfile(SITE_FILE, site)
    line = tmp_path / "line.yaml"
    line.write_text("line: 1\n")
    runs = tmp_path / "runs"
    for name in ("a", "b", "c"):
        (runs / name).mkdir(parents=True)
        (runs / name / "run.yaml").write_text("name: Euclid\nstart_utc: '2026-01-02T03:04:05'\n")
    return Paths(
        site=site,
        state=tmp_path,
        socket=tmp_path / "none",
        card=tmp_path / "card",
        line=line,
        runs=runs,
    )


@pytest.fixture
def plays(tmp_path, monkeypatch):
    """Return how a program of one's own is put in the place of `sim-plant`."""
    file = tmp_path / "program"

    def put(script):
        file.write_text(f"#!{sys.executable}\n{PROGRAM}{script}")
        file.chmod(file.stat().st_mode | stat.S_IXUSR)
        monkeypatch.setattr(refine_program, "program", lambda: file)

    return put


def writes(**texts):
    names = {"summary": "summary.json", "lacking": "lacking.json", "site": "site_proposed.yaml"}
    return "out.mkdir()\n" + "".join(
        f"(out / {names[name]!r}).write_text({text!r})\n" for name, text in texts.items()
    )


def as_json(found):
    return json.dumps(asdict(found))


def test_the_program_gets_windows_of_the_runs_folder_and_no_processor_but_its_own(where, plays):
    plays(writes(summary=as_json(SUMMARY)))
    talk = Talk()
    done = refine(where, replace(ASKED, without="roll_bounce, web_draw"), talk)
    assert done.text == "refinement 1: Traced: eccentric roller at R6."
    typed, told = talk.said[0], json.loads(talk.said[1])
    runs, shelf = where.runs, Shelf(where.site, where.state)
    words = [str(where.line), f"{runs}/a@0..60", f"{runs}/b", "--holdout", f"{runs}/c"]
    words += ["--without", "roll_bounce", "--without", "web_draw", "--site", str(where.site)]
    words += ["--workers", "1", "--out", str(shelf.of(1) / "out")]
    assert told["words"] == ["refine", *words]
    assert typed.startswith("sim-plant refine ")
    assert told["nice"] == 19


def test_what_was_asked_and_found_is_there_for_whoever_looks_later(where, plays):
    plays(writes(summary=as_json(SUMMARY)))
    refine(where, ASKED, Talk())
    (row,) = refining(where, Request(do="refining"), Talk()).refining.refined
    assert (row.number, row.kind, row.text) == (1, "traced", SUMMARY.headline)
    assert (row.asked.windows, row.asked.holdout, row.asked.by) == (
        ("a@0..60", "b"),
        ("c",),
        "carl",
    )
    found = refined(where, Request(do="refined", number=1), Talk()).refined
    assert found.summary == SUMMARY
    assert found.proposal is None
    assert f"{where.runs}/a@0..60" in found.command


def test_what_the_program_says_last_is_why_there_is_no_verdict(where, plays):
    plays("print('sim-plant: a: no 20 s of the running line', file=sys.stderr)\nsys.exit(2)\n")
    with pytest.raises(RefusedError, match="no 20 s of the running line"):
        refine(where, ASKED, Talk())
    (row,) = refining(where, Request(do="refining"), Talk()).refining.refined
    assert (row.kind, row.text) == ("", "a: no 20 s of the running line")


def test_a_program_that_takes_too_long_is_ended(where, plays, monkeypatch):
    monkeypatch.setattr(refine_program, "LONGEST_S", 0.3)
    monkeypatch.setattr(refine_program, "LOOK_S", 0.05)
    plays("import time\ntime.sleep(600)\n")
    with pytest.raises(RefusedError, match="took longer"):
        refine(where, ASKED, Talk())


def test_only_the_last_ones_are_kept(where, plays):
    shelf = Shelf(where.site, where.state)
    plays(writes(summary=as_json(SUMMARY)))
    refine(where, ASKED, Talk())
    first = shelf.of(1)
    for number in range(2, MOST_REFINEMENTS + 3):
        shutil.copytree(first, shelf.folder / f"{number:04d}")
    refine(where, ASKED, Talk())
    assert shelf.numbers() == list(range(4, MOST_REFINEMENTS + 4))
    with pytest.raises(RefusedError, match="no refinement 1 is kept"):
        page(where, Request(do="refined_page", number=1), Talk())


@pytest.mark.parametrize(
    "windows",
    ["", "../a", "/etc", "a/../b", ".", "nothing", "a@9..1", "a\n" * 9, "a@0..60/../../b"],
)
def test_a_window_that_names_no_run_of_the_folder_is_refused_before_anything_is_made(
    where, plays, windows
):
    plays("raise AssertionError\n")
    with pytest.raises(RefusedError):
        refine(where, replace(ASKED, windows=windows), Talk())
    assert Shelf(where.site, where.state).numbers() == []


def test_an_option_is_no_effect(where, plays):
    plays("raise AssertionError\n")
    with pytest.raises(RefusedError, match="by their names"):
        refine(where, replace(ASKED, without="--out=/etc"), Talk())


def test_what_records_lack_stands_until_the_next_look(where, plays):
    plays("out.parent.joinpath('seen').touch()\n" + writes(lacking=as_json(LACKING)))
    assert lacks(where, ASKED, Talk()).text == "looked at; every window can be used"
    view = refining(where, Request(do="refining"), Talk()).refining
    assert view.lacking.found == LACKING
    assert view.refined == ()
    bad = Lacking(records=(RecordLacks(name="a", is_held=False, refused="no run"),), together=())
    plays(writes(lacking=as_json(bad)) + "sys.exit(2)\n")
    assert lacks(where, ASKED, Talk()).text == "looked at; not every window can be used"


@pytest.mark.parametrize("gone", ["line", "program", "site"])
def test_what_is_missing_is_said_with_what_to_do_and_nothing_begins(
    where, plays, monkeypatch, gone
):
    plays("raise AssertionError\n")
    if gone == "program":
        monkeypatch.setattr(refine_program, "program", lambda: None)
    elif gone == "line":
        where = replace(where, line=None)
    else:
        where.site.unlink()
    (said,) = refining(where, Request(do="refining"), Talk()).refining.missing[:1]
    assert {"line": "--line LINE.yaml", "program": "install.sh --plant", "site": "no site file"}[
        gone
    ] in said
    with pytest.raises(RefusedError):
        refine(where, ASKED, Talk())
    with pytest.raises(RefusedError):
        lacks(where, ASKED, Talk())


def test_hours_of_work_do_not_begin_beside_a_correction_on_a_small_machine(
    where, plays, monkeypatch
):
    class Stands:
        state = "ACTIVE"

    plays("raise AssertionError\n")
    monkeypatch.setattr(refine_jobs, "status_of", lambda socket: Stands())
    monkeypatch.setattr(refine_jobs.os, "cpu_count", lambda: 2)
    with pytest.raises(RefusedError, match="bypass first"):
        refine(where, ASKED, Talk())


# --- what is proposed ---------------------------------------------------------------------------


@pytest.fixture
def proposing(where, plays, monkeypatch):
    """A refinement whose verdict a drive can cancel, and what reaches the service."""
    text = where.site.read_text().replace("settle_s: 6", "settle_s: 5", 1)
    assert text != where.site.read_text()
    plays(writes(summary=as_json(SUMMARY), site=text))
    refine(where, ASKED, Talk())
    asked = []

    def ask(where, **arguments):
        asked.append(arguments)
        return SettingsAnswer(changes=("settle_s: 6 s -> 5 s (applies at once)",))

    for module in (refine_jobs, settings_jobs):
        monkeypatch.setattr(module, "ask_settings", ask)
    return text, asked


def proposal(where):
    return refined(where, Request(do="refined", number=1), Talk()).refined.proposal


def tried(where, measured, reason="it is named"):
    said = {"measured": measured, "seconds": 60, "reason": reason, "account": "carl"}
    return try_refined(where, Request(do="try_refined", number=1, **said), Talk())


def test_a_proposal_is_shown_as_lines_of_the_text_and_as_settings_with_units(where, proposing):
    text, _ = proposing
    found = proposal(where)
    assert found.sha256 == text_digest(text)
    assert found.changes == ("settle_s: 6 s -> 5 s (applies at once)",)
    signs = [line.strip() for line in found.lines if line[0] in "+-"]
    assert [line[0] for line in signs] == ["-", "+"]
    assert found.against == ""


def test_it_is_tried_as_it_was_shown_with_who_and_why(where, proposing):
    text, asked = proposing
    assert tried(where, text_digest(text)).text.startswith("tried for 60 s: settle_s")
    why = "it is named (carl at the screen, refinement 1)"
    assert asked == [{"act": "try", "text": text, "seconds": 60.0, "why": why}]


def test_a_reason_that_is_too_short_tries_nothing(where, proposing):
    with pytest.raises(RefusedError, match="read 5 characters, a reason of 8"):
        tried(where, text_digest(proposing[0]), reason="named")
    assert proposing[1] == []


def test_what_was_not_seen_is_not_tried(where, proposing):
    assert plain(tried(where, "0" * 64)) == {"ok": False, "why": "changed", "name": ""}
    assert proposing[1] == []


def test_an_edit_since_it_began_would_be_lost_so_it_is_refused(where, proposing):
    text, asked = proposing
    where.site.write_text(where.site.read_text() + "# mine\n")
    assert proposal(where).against == OTHER_SITE
    with pytest.raises(RefusedError, match="refine again"):
        tried(where, text_digest(text))
    assert asked == []


def test_what_is_kept_already_is_not_offered_again(where, proposing):
    where.site.write_text(proposing[0])
    assert proposal(where).against == "the site file says so already"


def test_without_a_service_the_lines_stand_there_and_why_it_cannot_be_tried(
    where, proposing, monkeypatch
):
    def silent(where, **arguments):
        raise WireError("no service answers")

    monkeypatch.setattr(refine_jobs, "ask_settings", silent)
    found = proposal(where)
    assert found.against == "no service answers"
    assert len(found.lines) > 2
