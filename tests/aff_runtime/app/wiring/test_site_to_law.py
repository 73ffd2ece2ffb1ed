"""The law that a site file names is the one that runs."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from aff_runtime.app.wiring.site_to_law import probe_params, site_params
from aff_runtime.config.declared import keys_of
from aff_runtime.config.loader import load_site
from aff_runtime.config.models import Actuator, Site
from aff_runtime.core.controller import Controller
from aff_runtime.core.law import ActuatorLaw, LawSetup
from aff_runtime.core.laws.catalogue import LAW_ROWS, LAWS
from tests.each_case import each_case

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


def probing(**changes: object) -> Site:
    """Return the shipped site with other settings of the probe."""
    site = load_site(EUCLID)
    probe = site.probe.model_copy(update=changes)
    return site.model_copy(update={"probe": probe})


def test_a_given_amplitude_is_sent_as_it_is_and_bounds_no_tension() -> None:
    params = probe_params(probing(amplitude_m_s=0.012), ["unwind"])
    assert (params.amplitude, params.is_chosen) == (0.012, False)
    assert math.isinf(params.bound_N)
    assert math.isinf(params.bound_share)
    assert probe_params(probing(amplitude_m_s=0.012, bound_N=4.0), ["unwind"]).bound_N == 4.0


def test_a_chosen_amplitude_keeps_below_the_least_limit_of_those_that_are_probed() -> None:
    site = probing(amplitude_m_s=None, bound_m_s=0.1)
    limits = [actuator.limit for actuator in site.actuators.values()]
    assert min(limits) < 0.1 < max(limits)
    params = probe_params(site, list(site.actuators))
    assert (params.amplitude, params.is_chosen) == (min(limits), True)
    assert probe_params(site, ["unwind"]).amplitude == 0.1
    assert params.bound_share == 0.1
    assert math.isinf(
        probe_params(probing(amplitude_m_s=None, bound_N=3.0), ["unwind"]).bound_share
    )


@each_case(
    ("given", "louder", "amplitude"),
    [
        (0.005, 0.01, 0.01),  # twice
        (0.015, 0.03, 0.02),  # up to the bound
        (0.03, 0.06, 0.03),  # which a given amplitude may be above, but no louder one
        (None, 0.03, 0.02),
    ],
)
def test_a_louder_probe_goes_no_further_than_the_bound(
    given: float | None, louder: float, amplitude: float
) -> None:
    site = probing(amplitude_m_s=given, bound_m_s=0.02)
    assert probe_params(site, ["unwind"], louder_than=louder).amplitude == amplitude


def test_a_roll_stands_below_the_lowest_speed_at_which_anything_goes_out() -> None:
    site = load_site(EUCLID)
    slowest, *others = site.actuators
    update = {"active_above_m_s": 0.03}
    slow = site.actuators[slowest].model_copy(update=update)
    changed = site.model_copy(update={"actuators": {**site.actuators, slowest: slow}})
    assert all(site.actuators[name].active_above_m_s > 0.03 for name in others)
    assert {roll.moves_above_m_s for roll in site_params(changed).rolls} == {0.03}
