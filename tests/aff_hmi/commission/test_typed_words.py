"""What a step of the card wants typed is said in words, in both languages."""

from __future__ import annotations

import pytest

from aff_hmi.commission.typed_words import OF_STEP, wanted
from aff_hmi.words import say_in
from aff_runtime.app.card.evidence import CheckedSite, Evidence
from aff_runtime.app.card.steps import STEPS
from aff_runtime.app.card.typed_values import TypedValues
from tests.parameter_records import EUCLID

CHECKED = Evidence(checked=CheckedSite(site=EUCLID), typed=TypedValues(()))
NAMES = [(step.number, name) for step in STEPS for name in step.typed(CHECKED)]
CHANNELS = [(2, name) for name in EUCLID.gateway.read.channels]


@pytest.mark.parametrize("language", ["en", "de"])
def test_every_name_that_a_step_asks_for_is_told_in_words(language: str) -> None:
    told = {(step, name): wanted(step, name, say_in(language)) for step, name in NAMES}
    assert [key for key, text in told.items() if text == key[1]] == CHANNELS
    for (_, name), text in told.items():
        if name.removeprefix("sign_") in EUCLID.actuators:  # which of them is told
            assert name.removeprefix("sign_") in text
    assert len(set(told.values())) == len(told)


def test_no_word_is_of_a_name_that_no_step_asks_for() -> None:
    assert set(OF_STEP) <= set(NAMES)
