"""Faults have the size at which their ratio is the wanted one, beside what tolerances take up."""

import numpy as np
import pytest

from benchmarks.campaign import alike as told_by
from benchmarks.campaign import record as recording
from benchmarks.campaign import sizes
from benchmarks.campaign import stage as staging
from benchmarks.campaign.alike import beside, beside_tolerances
from benchmarks.campaign.cases import Case
from benchmarks.campaign.effect_table import BY_NAME
from benchmarks.campaign.fault import Fault
from benchmarks.campaign.make import floors
from benchmarks.campaign.record import simulate
from benchmarks.campaign.sensing import TICK_S
from benchmarks.campaign.sizes import sized, snr_of
from benchmarks.campaign.stage import stage

pytestmark = pytest.mark.timeout(300)
CASE = Case(number=0, group="single 0.4", seed=3, snr=0.4)


@pytest.fixture(scope="module", autouse=True)
def few_tolerances():
    """Let six declared numbers be uncertain, the modulus among them: each is a simulation.

    Of 30 s of a line that has settled for 20 s, not of 60 s after 40 s as in the campaign.
    """
    draws = told_by.tolerances(CASE)[:6]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(staging, "ROWS", 3000)
        patch.setattr(recording, "SETTLE_S", 20.0)
        patch.setattr(told_by, "tolerances", lambda _: draws)
        beside_tolerances.cache_clear()
        yield
    beside_tolerances.cache_clear()


@pytest.fixture(scope="module")
def healthy():
    at = stage(CASE, "a")
    quiet = at.quiet()
    noisy = simulate(at.machine, at.told, at.angles, at.seed, colour=CASE.colour).even()
    return at, quiet, floors(noisy, quiet)


@pytest.mark.long
def test_what_a_tolerance_takes_up_does_not_count(healthy):
    at, quiet, floor = healthy
    fault, reached = sized(
        CASE, at, Fault(effect="web_modulus", location="web", size=0.1), quiet, floor
    )
    assert reached == pytest.approx(0.4, rel=0.06)
    record, columns = beside_tolerances(CASE)
    true = record.response(fault)
    share = np.sqrt(beside(true, columns) / (true @ true))
    raw = snr_of(at.quiet((fault,)), quiet, floor)
    assert raw * share == pytest.approx(0.4, rel=0.1)
    assert raw > 0.5


@pytest.mark.long  # quick: on a formula, below
def test_what_tolerances_take_up_whole_ends_at_a_size_that_speaks_for_itself(healthy, monkeypatch):
    monkeypatch.setattr(sizes, "visible", lambda *_: 1e-3)
    fault = Fault(effect="bearing_drag", location="R1", size=0.01)
    made, reached = sized(CASE, *healthy[:1], fault, *healthy[1:])
    assert made.size == BY_NAME["bearing_drag"].form(fault).largest
    assert reached < 0.2


@pytest.mark.long
def test_a_delay_is_a_whole_number_of_drive_ticks(healthy):
    fault = Fault(effect="loop_delay", location="rewind", size=0.03)
    made, reached = sized(CASE, *healthy[:1], fault, *healthy[1:])
    assert made.size / TICK_S == pytest.approx(round(made.size / TICK_S), abs=1e-9)
    assert reached == pytest.approx(0.4, rel=0.1)


@pytest.mark.long
def test_a_case_without_a_ratio_keeps_its_size(healthy):
    fault = Fault(effect="eccentric_roller", location="R2", size=1e-5)
    case = Case(number=0, group="single", seed=3)
    assert sized(case, *healthy[:1], fault, *healthy[1:])[0] == fault


class Brittle:
    """A line that does not answer up to a size, and hardly runs a third beyond it."""

    def quiet(self, faults=()):
        size = sum(fault.size for fault in faults)
        beyond = max(0.0, size / 7.0 - 1.0)
        return {
            name: np.full(staging.ROWS, 5.0 * beyond + 1e4 * beyond**4)
            for name in staging.SIZED_BY
        }


def test_a_limit_that_is_hardly_reached_is_found_between_nothing_and_too_much(monkeypatch):
    """5 x + 1e4 x^4 = 0.4 at x = 0.0576 beyond the size of 7 at which anything shows."""
    share = {True: 0.0, False: 0.8}
    monkeypatch.setattr(sizes, "visible", lambda _, fault: share[fault.size <= 7.0])
    line, floor = Brittle(), dict.fromkeys(staging.SIZED_BY, 0.8)
    fault = Fault(effect="rate_limit", location="unwind", size=5.0, form="of the reference")
    made, reached = sized(CASE, line, fault, line.quiet(), floor)
    assert reached == pytest.approx(0.4, rel=0.05)
    assert made.size == pytest.approx(7.0 * 1.0576, rel=0.005)
