"""The law that a site file names is the one that runs."""

from __future__ import annotations

from pathlib import Path

import pytest

from aff_runtime.app.wiring.site_to_law import site_params
from aff_runtime.config.declared import keys_of
from aff_runtime.config.loader import load_site
from aff_runtime.config.models import Actuator, Site
from aff_runtime.core.controller import Controller
from aff_runtime.core.law import ActuatorLaw, LawSetup
from aff_runtime.core.laws.catalogue import LAW_ROWS, LAWS

EUCLID = Path(__file__).parents[4] / "config" / "euclid.yaml"


def with_law(word: str, **changes: object) -> Site:
    """Return the shipped site with every actuator on one law."""
    site = load_site(EUCLID)
    update = {"law": word, **changes}
    actuators = {name: a.model_copy(update=update) for name, a in site.actuators.items()}
    return site.model_copy(update={"actuators": actuators})


@pytest.mark.parametrize("word", LAW_ROWS)
def test_the_reference_says_what_a_law_does(word: str) -> None:
    description = keys_of(Actuator)["law"].description
    assert f"{word}: {LAW_ROWS[word].text}" in description


def test_a_law_that_is_a_row_is_built_for_every_actuator_that_names_it() -> None:
    built: list[str] = []

    def third(setup: LawSetup) -> ActuatorLaw:
        built.append(setup.params.name)
        return LAWS["blocks"](setup)

    site = with_law("third")
    Controller(site_params(site), {}, laws={**LAWS, "third": third})
    assert built == list(site.actuators)


def test_without_a_drive_the_plain_blocks_stand_in_for_the_shape_law() -> None:
    assert {a.law for a in site_params(with_law("shape", drive=None)).actuators} == {"blocks"}
