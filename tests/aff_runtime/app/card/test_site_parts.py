"""Which edits undo which steps: none that the card itself asks for."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from aff_runtime.app.card.entries import entries_of
from aff_runtime.app.card.figures import Sample
from aff_runtime.app.card.gather import Sources, inputs_of
from aff_runtime.app.card.site_parts import Part, part_of, parts_of
from aff_runtime.app.card.standing import Stand, card_of, former_samples
from aff_runtime.app.card.steps import STEPS, step_of
from aff_runtime.app.report.status_answer import StatusAnswer
from aff_runtime.app.supervisor.response_ledger import ResponseLedger, learned_sentences
from aff_runtime.base.text_digest import text_digest
from aff_runtime.config.leaves import leaves
from aff_runtime.config.loader import load_recorded_site, load_site
from aff_runtime.config.revision import SHORT, site_hash_of
from tests.aff_runtime.app.card.made import add, book, measured
from tests.aff_runtime.app.card.measure.recorded import SITE, SITE_FILE
from tests.parameter_records import CONFIG, record_of

TEXT = SITE_FILE.read_text()
NOISE = ("reference: tension_ref_N }", "reference: tension_ref_N, noise_N: 0.4 }")
SETTLE = ("settle_s: 6", "settle_s: 3")
ORDERS = ("[1, 2, 3, 4]", "[1]")
AMPLITUDE = ("amp_limit_m_s: 0.02", "amp_limit_m_s: 0.005")
PROBE = ("amplitude_m_s: 0.008", "amplitude_m_s: 0.012")
RECORDS = ("max_MB: 500", "max_MB: 400")
SCALE = ("register: 5, type: i16, scale: 0.001", "register: 5, type: i16, scale: 0.002")
STALE = ("fault_after_ms: 80", "fault_after_ms: 90")
LIMIT = ("    limit_m_s: 0.05\n", "    limit_m_s: 0.045\n")
CASES = {
    NOISE: {8, 9, 10, 12},
    SETTLE: {10, 12},
    ORDERS: {10, 12},
    AMPLITUDE: {10, 12},
    PROBE: set(),
    RECORDS: set(),
    SCALE: {1, 2, 6, 7, 8, 9, 10, 11, 12},
    STALE: {2, 5, 11, 12},
    LIMIT: {3, 10, 11, 12},
}
"""Edit, and the steps that have to be done again: those whose figures it may change, less those
that come before the step of the card or the runbook that asks for it."""


def site_record(text):
    """Return what the check says of a site file; one with a response of its unwind."""
    site = load_recorded_site(text, "site.yaml")
    digest = site_hash_of(site)
    files = {"unwind": Path("learned/euclid_unwind.json")}
    made = record_of(site, site_text=text, site_hash=digest, response_files=files)
    return made.model_copy(update={"responses": {"unwind": "{}"}}).with_shapes({})


@cache
def inputs(text=TEXT, plc="7"):
    """Return what a measurement on this site file rests on."""
    return inputs_of(Sources(parameters=site_record(text), checked=None, plc=plc))


@pytest.mark.parametrize("edit", CASES, ids=lambda edit: edit[1].strip())
def test_an_edit_turns_to_again_what_comes_after_it_and_nothing_else(tmp_path, edit):
    card, now = book(tmp_path), inputs(TEXT.replace(edit[0], edit[1], 1))
    assert now.site_hash != inputs().site_hash
    for step in STEPS:
        add(card, measured(step.number, inputs=inputs()))
    stands = card_of(entries_of(card.read()), now).steps
    assert {one.step.number for one in stands if one.stand is Stand.AGAIN} == CASES[edit]
    assert all(why.startswith("site file, ") for one in stands for why in one.why)


def test_samples_outlive_an_edit_that_the_card_asks_for(tmp_path):
    card = book(tmp_path)
    of = {step: Sample(kind="k", of=str(step)) for step in (1, 7, 11)}
    for step, sample in of.items():
        add(card, measured(step, inputs=inputs(), samples=(sample,)))
    entries = entries_of(card.read())
    for edit in (NOISE, SETTLE, ORDERS, PROBE):
        now = inputs(TEXT.replace(*edit))
        for step, sample in of.items():
            assert former_samples(step_of(step), entries, now) == (sample,), (edit, step)
    assert former_samples(step_of(1), entries, inputs(TEXT.replace(*SCALE))) == ()


def test_the_first_version_of_the_plc_that_is_typed_drops_no_sample(tmp_path):
    card, sample = book(tmp_path), Sample(kind="load", of="unwind_tension_N")
    add(card, measured(1, inputs=inputs(plc=""), samples=(sample,)))
    entries = entries_of(card.read())
    assert former_samples(step_of(1), entries, inputs(plc="3.1")) == (sample,)
    add(card, measured(1, inputs=inputs(plc="3.1"), samples=(sample,)))
    assert former_samples(step_of(1), entries_of(card.read()), inputs(plc="3.2")) == ()


def test_every_key_of_every_site_file_is_in_a_part_and_turns_that_part_alone():
    for file in sorted(CONFIG.glob("*.yaml")):
        site = load_site(file)
        assert {part_of(leaf.path) for leaf in leaves(site)} == set(Part), file
    before, after = parts_of(SITE, {}), parts_of(SITE, {"line.dbc": "5" * 64})
    assert {name for name in before if before[name] != after[name]} == {"CHANNELS", "WIRE"}


def test_a_shape_that_is_saved_at_each_bypass_is_stated_and_undoes_no_proof(tmp_path):
    """`ProcessSet.start` puts the shape's digest into the configuration's hash; the check none."""
    shapes = {"unwind": '{"weights": [1]}'}
    record = site_record(TEXT)
    service = record.with_shapes(shapes)
    assert service.config_hash != record.config_hash
    sentences = tuple(learned_sentences(service, ResponseLedger(print)))
    answer = StatusAnswer(
        line="Euclid",
        state="ACTIVE",
        site_hash=record.site_hash,
        config_hash=service.config_hash,
        learned=sentences,
    )
    on = inputs_of(Sources(parameters=record, checked=None, plc="7", answer=answer))
    assert on.shapes == {"unwind": text_digest(shapes["unwind"])[:SHORT]}
    card = book(tmp_path)
    add(card, measured(12, inputs=on))
    stopped = inputs_of(Sources(parameters=record, checked=None, plc="7"))
    later = replace(
        on, config_hash=record.with_shapes({"unwind": "{}"}).config_hash, shapes={"unwind": "9"}
    )
    for now in (stopped, later):
        assert now.config_hash != on.config_hash
        assert card_of(entries_of(card.read()), now).steps[12].stand is Stand.PASS
    described = record.model_copy(update={"wire_digests": {"line.dbc": "5" * 64}})
    other = inputs_of(Sources(parameters=described, checked=None, plc="7"))
    assert card_of(entries_of(card.read()), other).steps[12].stand is Stand.AGAIN
