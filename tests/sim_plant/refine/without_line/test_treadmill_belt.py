"""The measured belt: each speed held out from the other, and a second record of its own kind."""

from functools import cache
from pathlib import Path

import pytest

from sim_plant.line.reading.load import read_source
from sim_plant.refine.without_line.general.judging import judge
from sim_plant.refine.without_line.general.search import search
from sim_plant.refine.without_line.record_filter import (
    output_record,
    read_stamped,
    record_declaration_in,
)

ROOT = Path(__file__).parents[4]
SHARED = ROOT.parent / "shared/data"
if not SHARED.exists():
    SHARED = ROOT.parents[1] / "shared/data"
pytestmark = [
    pytest.mark.skipif(not SHARED.exists(), reason="measured records are not here (shared/data)"),
    pytest.mark.timeout(600),  # three records of 350 s: a minute alone
]
STEP_S = 0.01


@pytest.fixture(scope="module")
def records():
    declaration = record_declaration_in(read_source(ROOT / "config/records/treadmill_belt.yaml"))
    folder = SHARED / "treadmill_belt"
    return {
        name: output_record(
            declaration,
            read_stamped(declaration, folder / f"Random{name}.txt.gz").record,
            "Pitch_Moment_N_m",
        )
        for name in ("SlowSpeed1", "SlowSpeed2", "FastSpeed1")
    }


@pytest.fixture(scope="module")
def found(records):
    """What a search in one record finds, by its name: half a minute of a slow machine each."""
    return {name: search([records[name]], lambda _: None) for name in ("SlowSpeed1", "FastSpeed1")}


@pytest.fixture(scope="module")
def judged(records, found):
    """What is found in one record, judged on another, by the names of both."""
    return cache(lambda fitted, held: judge(found[fitted], records[held]))


@pytest.mark.long  # quick: a shift that is known, general/
@pytest.mark.parametrize(
    ("fitted", "held", "plain", "shift_ms"),
    [
        ("SlowSpeed1", "FastSpeed1", 7.05, 4.7),
        ("FastSpeed1", "SlowSpeed1", 4.80, -5.3),
        ("SlowSpeed1", "SlowSpeed2", 4.86, -4.2),
        ("FastSpeed1", "SlowSpeed2", 5.14, -9.7),
    ],
)
@pytest.mark.sweep(every=4)
def test_the_shift_between_records_is_found_and_beats_plain_least_squares(
    judged, fitted, held, plain, shift_ms
):
    there = judged(fitted, held)
    assert there.plain_rms == pytest.approx(plain, abs=0.02)
    assert there.chosen_rms < 0.99 * there.plain_rms
    assert there.chosen_rms < (6.88 if held == "FastSpeed1" else 5.03)
    assert there.shift_samples is not None
    assert 1e3 * STEP_S * there.shift_samples[0] == pytest.approx(shift_ms, abs=0.7)


@pytest.mark.long  # quick: one shift, above
def test_the_shifts_of_three_records_add_up(judged):
    """What one record is later than a second and that than a third is found between the ends."""
    fast_of_slow = judged("SlowSpeed1", "FastSpeed1")
    slow_of_fast = judged("FastSpeed1", "SlowSpeed2")
    slow_of_slow = judged("SlowSpeed1", "SlowSpeed2")
    around = fast_of_slow.shift_samples[0] + slow_of_fast.shift_samples[0]
    assert around == pytest.approx(slow_of_slow.shift_samples[0], abs=0.15)
