"""How steps stand: the last counts, a signature is below one of them, what changed is named."""

from dataclasses import replace

import pytest

from aff_runtime.app.card.entries import UNKNOWN, entries_of
from aff_runtime.app.card.figures import Sample
from aff_runtime.app.card.site_parts import Part
from aff_runtime.app.card.standing import (
    Stand,
    card_of,
    changed,
    former_samples,
    newest_plc,
    not_compared,
)
from aff_runtime.app.card.steps import STEPS, Basis, step_of
from aff_runtime.base.errors import ConfigError, RefusedError
from tests.aff_runtime.app.card.made import BAD, BEGUN_OF, INPUTS, add, book, measured, signed

OTHERS = {
    Basis.SITE: replace(INPUTS, site_hash="9" * 64),
    Basis.PLC: replace(INPUTS, plc="8"),
    Basis.ROLL: replace(INPUTS, roll_id="5"),
    Basis.RESPONSES: replace(INPUTS, responses={"unwind": "9" * 64}),
    Basis.MACHINE: replace(INPUTS, machine="Linux 6 x86_64, 2 processors"),
}


def stands(card, now=INPUTS):
    return {one.step.number: one for one in card_of(entries_of(card.read()), now).steps}


def test_steps_are_numbered_0_to_12_and_say_what_is_good():
    assert [step.number for step in STEPS] == list(range(13))
    assert all(step.title and step.measured and step.limit for step in STEPS)
    with pytest.raises(RefusedError, match="0 to 12"):
        step_of(13)


def test_of_a_fresh_card_nothing_is_measured(tmp_path):
    assert {one.stand for one in stands(book(tmp_path)).values()} == {Stand.NOT_MEASURED}


def test_the_last_measurement_counts_and_all_are_kept(tmp_path):
    card = book(tmp_path)
    add(card, measured(3, [BAD]))
    add(card, measured(3))
    assert (stands(card)[3].stand, stands(card)[3].earlier) == (Stand.PASS, 1)
    add(card, measured(3, [BAD]))
    assert (stands(card)[3].stand, stands(card)[3].earlier) == (Stand.FAIL, 2)


def test_a_signature_is_of_one_measurement_and_not_of_the_next(tmp_path):
    card = book(tmp_path)
    add(card, signed(3, add(card, measured(3))))
    assert stands(card)[3].is_finished
    add(card, measured(3))
    assert stands(card)[3].signed is None
    assert not stands(card)[3].is_finished


@pytest.mark.parametrize("rest", list(Basis))
@pytest.mark.parametrize("step", STEPS, ids=lambda step: str(step.number))
def test_a_step_is_due_again_by_what_it_rests_on_and_nothing_else(tmp_path, step, rest):
    card = book(tmp_path)
    add(card, measured(step.number))
    assert stands(card)[step.number].stand is Stand.PASS
    again = stands(card, OTHERS[rest])[step.number]
    assert (again.stand is Stand.AGAIN) == (rest in step.rests_on)
    assert bool(again.why) == (rest in step.rests_on)


def test_what_is_not_known_on_one_side_is_no_change_and_said():
    unknown = replace(INPUTS, plc="", roll_id="", machine="", responses={"unwind": UNKNOWN})
    names = {Basis.PLC, Basis.ROLL, Basis.MACHINE}
    for step in STEPS:
        wanted = {f"{rest} not compared" for rest in step.rests_on if rest in names}
        if Basis.RESPONSES in step.rests_on:
            wanted.add("measured responses of unwind not compared")
        for then, now in ((INPUTS, unknown), (unknown, INPUTS)):
            assert list(changed(step, then, now)) == []
            assert set(not_compared(step, then, now)) == wanted
        assert list(not_compared(step, INPUTS, INPUTS)) == []


@pytest.mark.parametrize("lacks", ["then", "now"])
def test_a_part_of_the_site_file_that_one_side_alone_knows_is_no_change_and_said(tmp_path, lacks):
    """Another release draws the parts otherwise: what it knows is compared, the rest is said."""
    wide = replace(INPUTS, parts={part.name: "1" * 64 for part in Part})
    narrow = replace(wide, parts={n: v for n, v in wide.parts.items() if n != Part.ROLLS.name})
    then, now = (narrow, wide) if lacks == "then" else (wide, narrow)
    card = book(tmp_path)
    for step in STEPS:
        add(card, measured(step.number, inputs=then))
    for step in STEPS:
        found = stands(card, now)[step.number]
        assert found.stand is Stand.PASS
        wanted = ("site file, rolls not compared",) if Part.ROLLS in step.parts else ()
        assert found.not_compared == wanted


def test_a_site_file_that_one_side_alone_knows_is_no_change_and_said():
    unknown = replace(INPUTS, site_hash="", parts={})
    for step in STEPS:
        wanted = ["site file not compared"] if Basis.SITE in step.rests_on else []
        for then, now in ((INPUTS, unknown), (unknown, INPUTS)):
            assert list(changed(step, then, now)) == []
            assert list(not_compared(step, then, now)) == wanted


def test_an_older_card_has_its_machine_in_the_first_entry(tmp_path):
    card = book(tmp_path)
    add(card, measured(0, inputs=replace(INPUTS, machine="")))
    assert stands(card, INPUTS)[0].stand is Stand.PASS
    other = replace(INPUTS, machine="Linux 7 x86_64, 4 processors")
    assert stands(card, other)[0].why == (f"machine: {BEGUN_OF.machine}, now {other.machine}",)


def test_samples_count_as_long_as_site_and_plc_are_the_same(tmp_path):
    card = book(tmp_path)
    one, two = (Sample(kind="load", of=name) for name in "ab")
    for sample in (one, two):
        add(card, measured(1, samples=(sample,)))
    entries = entries_of(card.read())
    assert former_samples(step_of(1), entries, INPUTS) == (one, two)
    assert former_samples(step_of(1), entries, OTHERS[Basis.RESPONSES]) == (one, two)
    assert former_samples(step_of(1), entries, OTHERS[Basis.SITE]) == ()
    assert former_samples(step_of(2), entries, INPUTS) == ()
    assert newest_plc(entries) == "7"


def test_a_card_of_something_else_is_refused_with_its_place(tmp_path):
    card = book(tmp_path)
    card.add("measured", {"step": 0, "verdict": "pass", "inputs": {}, "figures": [{"name": 3}]})
    with pytest.raises(ConfigError, match=r"entry 2.figures\[0\].name: read 3, expected a text"):
        entries_of(card.read())


@pytest.mark.parametrize(
    "body",
    [
        [],
        {"step": -1},
        {"step": True},
        {"step": 1, "verdict": "perhaps"},
        {"step": 1, "verdict": "pass"},
        {"step": 1, "verdict": "pass", "inputs": {}, "figures": {}},
        {"step": 1, "verdict": "pass", "inputs": {}, "figures": [{"value": "1"}]},
        {"step": 1, "verdict": "pass", "inputs": {}, "figures": [{"value": 10**400}]},
        {"step": 1, "verdict": "pass", "inputs": {"responses": {"a": 1}}},
        {"step": 1, "verdict": "pass", "inputs": {}, "samples": [{"names": ["a"]}]},
        {"step": 1, "verdict": "pass", "inputs": {}, "remarks": ["x" * 5000]},
        {"step": 1, "verdict": "pass", "inputs": {}, "remarks": ["x"] * 5000},
    ],
)
def test_a_body_of_wrong_types_is_refused(tmp_path, body):
    card = book(tmp_path)
    card.add("measured", body)
    with pytest.raises(ConfigError, match=r"entry"):
        entries_of(card.read())


def test_a_card_begins_once(tmp_path):
    card = book(tmp_path)
    card.add("begun", {"line": "Euclid"})
    with pytest.raises(ConfigError, match="begins with what it is of"):
        entries_of(card.read())
    strange = book(tmp_path / "b")
    strange.add("other", {})
    with pytest.raises(ConfigError, match="of a kind that this release does not know"):
        entries_of(strange.read())
