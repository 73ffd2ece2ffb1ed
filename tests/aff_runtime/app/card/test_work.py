"""What goes on a card can be read back, however much a step has to say."""

from dataclasses import replace
from pathlib import Path

import pytest

from aff_runtime.app.card import work
from aff_runtime.app.card.evidence import CheckedSite
from aff_runtime.app.card.figures import Figure, Verdict
from aff_runtime.app.card.gather import Sources, inputs_of
from aff_runtime.app.card.lines import signed_line
from aff_runtime.app.card.page import page
from aff_runtime.app.card.standing import Stand
from aff_runtime.app.card.typed_values import typed
from aff_runtime.app.report.status_answer import StatusAnswer
from aff_runtime.base.errors import ConfigError, RefusedError
from aff_runtime.base.machine import Machine, machine_name
from aff_runtime.config.facts import facts_of
from tests.aff_runtime.app.card.made import add, measured
from tests.aff_runtime.app.card.measure.recorded import SITE, SITE_FILE
from tests.parameter_records import record_of

RECORD = record_of(SITE, site_text=SITE_FILE.read_text(), responses={"unwind": "{}"})
WHY = "seen on the drive"


def sources(warnings=(), **more):
    checked = CheckedSite(site=SITE, warnings=tuple(warnings), limits=facts_of(SITE).limits)
    return Sources(parameters=RECORD, checked=checked, **more)


@pytest.fixture
def begun(tmp_path):
    work.begin(tmp_path, Path("site.yaml"), RECORD)
    return tmp_path


def test_a_step_with_far_too_much_to_say_is_cut_and_read_back(begun):
    many = ["x" * 9_000 + "\n\u202e"] * 5_000
    record = replace_responses()
    typed_values = tuple(map(typed, ["unwind=1", "swrap_follower=1", "warnings_understood=5000"]))
    found = work.measure(
        work.CardFile.of(begun), 3, replace(sources(many), parameters=record), typed_values, "root"
    )
    assert found.verdict is Verdict.PASS
    kept = work.CardFile.of(begun).card().steps[3].measured
    assert kept == found
    assert len(kept.result.remarks) < 50
    assert max(map(len, kept.result.remarks)) <= work.LONGEST_SENTENCE


def replace_responses():
    """Return the record without responses: step 3 asks for none."""
    return RECORD.model_copy(update={"responses": {}})


def test_what_could_not_be_read_back_is_not_written(begun):
    card = work.CardFile.of(begun)
    before = card.book.path.read_bytes()
    many = replace(inputs_of(sources()), responses={f"a{k}": "5" * 64 for k in range(3_000)})
    with pytest.raises(RefusedError, match="too much for one entry"):
        work.leave_out(card, 4, "the gateway has no watchdog", many, "root")
    assert card.book.path.read_bytes() == before


def test_inputs_are_those_of_the_file_and_of_the_service():
    alone = inputs_of(sources())
    assert (alone.site_hash, alone.config_hash, alone.roll_id) == ("5e", "abc", "")
    assert set(alone.responses) == {"unwind"}
    live = StatusAnswer(line="Euclid", state="READY", site_hash="5e", config_hash="with shapes")
    assert inputs_of(sources(answer=live)).config_hash == "with shapes"
    for other, said in (
        (replace(live, site_hash="other"), "runs on other settings"),
        (replace(live, trying="settings 12 by root"), "are being tried"),
    ):
        with pytest.raises(RefusedError, match=said):
            inputs_of(sources(answer=other))


@pytest.mark.parametrize(
    ("name", "reason"), [("", WHY), ("A", WHY), ("x" * 90, WHY), ("Ada", "ok"), ("Ada", "x" * 900)]
)
def test_a_signature_has_a_name_and_a_reason(begun, name, reason):
    inputs = inputs_of(sources())
    work.leave_out(work.CardFile.of(begun), 4, "the gateway has no watchdog", inputs, "root")
    with pytest.raises(ConfigError, match="characters; write"):
        work.sign(work.CardFile.of(begun), 4, inputs, name=name, reason=reason, by="root")


def test_two_who_add_at_once_are_told(begun):
    inputs = inputs_of(sources())
    one, other = work.CardFile.of(begun), work.CardFile.of(begun)
    work.leave_out(one, 4, "the gateway has no watchdog", inputs, "root")
    with pytest.raises(RefusedError, match="added to it meanwhile"):
        work.leave_out(other, 4, "the gateway has no watchdog", inputs, "root")


def test_an_open_step_is_not_signed_and_the_figure_that_is_not_there_is_told(begun):
    card = work.CardFile.of(begun)
    inputs = inputs_of(sources())
    lacking = Figure(name="wake-up", value=float("nan"), limit="at most 500 us")
    add(card.book, measured(4, [lacking], inputs=inputs))
    with pytest.raises(RefusedError, match=r"step 4 is open \(no figure: wake-up\)"):
        work.sign(work.CardFile.of(begun), 4, inputs, name="Ada Miller", reason=WHY, by="root")


def test_a_signature_says_what_could_not_be_compared(begun):
    """The service is stopped: the roll may have been exchanged since the proof."""
    card = work.CardFile.of(begun)
    known = replace(inputs_of(sources()), roll_id="4")
    add(card.book, measured(12, inputs=known))
    now = inputs_of(sources())
    assert now.roll_id == ""
    by = {"name": "Ada Miller", "reason": WHY, "by": "root"}
    kept = work.sign(work.CardFile.of(begun), 12, now, **by)
    assert kept.not_compared == ("roll not compared",)
    assert signed_line(kept) == "signed as Ada Miller; roll not compared"
    stands = work.CardFile.of(begun).card(now)
    assert stands.steps[12].signed == kept
    assert f"{WHY}; roll not compared" in page(stands)
    other = replace(now, roll_id="5")
    with pytest.raises(RefusedError, match="step 12 is again"):
        work.sign(work.CardFile.of(begun), 12, other, **by)


def test_a_card_that_is_opened_on_another_machine_has_its_step_0_again(begun, tmp_path):
    number = tmp_path / "machine-id"
    seen = Machine(governors="", isolated="", is_realtime=None, processors=4)
    names = []
    for text in ("a" * 32, "b" * 32):
        number.write_text(text)
        names.append(machine_name(seen, number))
        names.append(machine_name(replace(seen, processors=2), number))
    assert len(set(names)) == 4
    assert not any("a" * 32 in name for name in names)
    here = inputs_of(sources(machine=seen))
    assert here.machine == machine_name(seen)
    card = work.CardFile.of(begun)
    add(card.book, measured(0, inputs=here))
    card = work.CardFile.of(begun)
    assert card.standing(0, here).stand is Stand.PASS
    assert card.standing(0, replace(here, machine=names[3])).stand is Stand.AGAIN


@pytest.mark.parametrize(
    ("added", "is_kept"),
    [({"step": 4}, True), ({"step": 4, "plc": "3.2"}, False), ({"step": 9}, False)],
    ids=["another step", "another PLC program", "the same step"],
)
def test_a_search_is_kept_though_somebody_adds_to_the_card_meanwhile(begun, added, is_kept):
    """Another signs step 3 and measures a step while the search runs."""
    inputs = replace(inputs_of(sources()), plc="3.1")
    signs = {"name": "Ada Miller", "reason": WHY, "by": "root"}
    work.leave_out(work.CardFile.of(begun), 3, "no limit in this drive", inputs, "root")
    mine = work.CardFile.of(begun)
    work.sign(work.CardFile.of(begun), 3, inputs, **signs)
    other = replace(inputs, plc=added.get("plc", "3.1"))
    work.leave_out(work.CardFile.of(begun), added["step"], "not for this line", other, "root")
    before = mine.book.path.read_bytes()
    if is_kept:
        work.leave_out(mine, 9, "a search of an hour", inputs, "root")
        stands = work.CardFile.of(begun).card()
        assert stands.steps[9].measured.reason == "a search of an hour"
        assert stands.steps[3].is_finished
    else:
        with pytest.raises(RefusedError, match="added to it meanwhile"):
            work.leave_out(mine, 9, "a search of an hour", inputs, "root")
        assert mine.book.path.read_bytes() == before


def test_a_signature_follows_what_was_seen_and_nothing_else(begun):
    inputs = inputs_of(sources())
    work.leave_out(work.CardFile.of(begun), 4, "the gateway has no watchdog", inputs, "root")
    seen = work.CardFile.of(begun)
    work.leave_out(work.CardFile.of(begun), 3, "no limit in this drive", inputs, "root")
    with pytest.raises(RefusedError, match="added to it meanwhile"):
        work.sign(seen, 4, inputs, name="Ada Miller", reason=WHY, by="root")
