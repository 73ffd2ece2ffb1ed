"""What a measurement rests on: the site file, and a service only where that runs the same."""

from types import SimpleNamespace

import pytest

from aff_runtime.app.card.gather import inputs_of
from aff_runtime.base.errors import RefusedError
from tests.parameter_records import record_of


def sources(**said):
    """Return a site file of hash a and a service that says so much."""
    answer = {"site_hash": "a", "config_hash": "c", "trying": "", "live": None} | said
    return SimpleNamespace(
        parameters=record_of(site_hash="a", config_hash="b"),
        answer=SimpleNamespace(learned=(), **answer),
        plc="",
        machine=None,
    )


def test_what_the_service_runs_on_is_what_a_measurement_rests_on():
    assert inputs_of(sources()).config_hash == "c"


def test_a_service_on_other_settings_than_the_file_says_is_no_source():
    with pytest.raises(
        RefusedError, match=r"runs on other settings \(b\) than the site file says"
    ):
        inputs_of(sources(site_hash="b"))


def test_settings_that_are_being_tried_are_no_source():
    with pytest.raises(RefusedError, match="other settings are being tried"):
        inputs_of(sources(trying="12 s left"))
