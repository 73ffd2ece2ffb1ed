from __future__ import annotations

import pytest

from sim_plant.demo.pace import Pace, pace_of
from sim_plant.demo.runtime_status import RuntimeStatus
from sim_plant.servers.answers import PlantStatus
from tests.sim_plant.servers.test_answers import STATUS

BEFORE = Pace(missed_ticks=30, skipped_samples=2)


def test_the_counts_are_those_of_the_two_status_answers() -> None:
    runtime = RuntimeStatus.from_json({"signals": {"missed_count": 31.0, "age_s": 0.001}})
    plant = PlantStatus.from_json(STATUS)
    assert pace_of(runtime, plant) == Pace(missed_ticks=31, skipped_samples=7)


@pytest.mark.parametrize(("missed", "skipped"), [(30, 2), (34, 2)])
def test_a_few_missed_ticks_are_no_pause(missed: int, skipped: int) -> None:
    assert Pace(missed_ticks=missed, skipped_samples=skipped).lost_since(BEFORE) == ""


@pytest.mark.parametrize(("missed", "skipped"), [(35, 2), (30, 3)])
def test_a_pause_of_either_process_is_told_with_its_size(missed: int, skipped: int) -> None:
    said = Pace(missed_ticks=missed, skipped_samples=skipped).lost_since(BEFORE)
    assert said.startswith(f"{missed - 30} ticks of the runtime and {skipped - 2} samples")
