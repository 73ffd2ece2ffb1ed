"""The report: what is wrong, and what follows from a good file."""

import math

import pytest

from aff_runtime.config.check import check_site
from tests.aff_runtime.config.shipped import EUCLID, edited
from tests.each_case import each_case


def test_good_file_gives_facts_and_exit_code_0():
    report = check_site(EUCLID)
    assert report.ok
    assert report.exit_code == 0
    assert report.lines()[-1] == f"{EUCLID}: ok, 2 warnings"


def test_bad_file_gives_every_finding_and_exit_code_2(tmp_path):
    path = edited(tmp_path, ("port: 5020", "port: 0"), ("settle_s: 6,", "settle_s: 0,"))
    report = check_site(path)
    assert not report.ok
    assert report.exit_code == 2
    assert [finding.path for finding in report.errors] == [
        "gateway.modbus_tcp.port",
        "actuators.unwind.blocks[0].settle_s",
    ]
    assert report.lines()[-1] == (
        f"{path}: refused, 2 errors, no warnings; the service does not start with this file"
    )


def test_findings_and_result_come_last_and_brief_leaves_the_rest_out():
    report = check_site(EUCLID)
    assert len(report.warnings) == 2
    *facts, gap, wire, warning, result = report.lines()
    assert len(facts) > 60
    assert not any(line.startswith(("warning", "error")) for line in facts)
    assert gap == ""
    assert [wire, warning] == [f"warning  {finding}" for finding in report.warnings]
    assert report.lines(brief=True) == [wire, warning, result]


def test_frequencies_are_those_of_the_source():
    # 6.375 in and 200 FPM: 0.9986 Hz; 6.05 in: 1.0523 Hz
    facts = check_site(EUCLID, speeds_m_s=[200 * 0.3048 / 60]).facts
    unwind = [o for o in facts.orders if o.roll == "unwind" and o.order == 1]
    at_core = next(o for o in unwind if o.radius_m == pytest.approx(0.1016))
    assert at_core.frequency_Hz * 0.1016 / (6.375 * 0.0254) == pytest.approx(0.9986, abs=1e-4)
    follower = next(o for o in facts.orders if o.roll == "swrap_follower")
    assert follower.frequency_Hz == pytest.approx(1.0523, abs=1e-4)
    assert follower.per_minute == pytest.approx(1.0523 * 60, abs=1e-2)
    assert follower.samples_per_period == pytest.approx(1 / (1.0523 * 0.005), rel=1e-4)


def test_order_n_has_n_times_the_frequency_at_every_speed():
    facts = check_site(EUCLID, speeds_m_s=[0.5, 1.5]).facts
    for order in facts.orders:
        expected = order.order * order.speed_m_s / (2 * math.pi * order.radius_m)
        assert order.frequency_Hz == pytest.approx(expected, rel=1e-12)
    assert len(facts.orders) == 2 * (4 * 2 + 1 + 1)


def test_words_counts_and_meetings():
    facts = check_site(EUCLID).facts
    assert facts.read_block == (0, 18)
    assert facts.write_block == (100, 10)
    assert facts.words_per_tick == 28
    assert [round(limit.counts) for limit in facts.limits] == [5000, 2000, 1000, 4000, 3000]
    (name, meeting) = facts.meetings[0]
    assert (name, meeting.order, meeting.other_order) == ("unwind", 1, 1)
    assert meeting.radius_m == pytest.approx(0.15367)


def test_T6_the_forecast_of_crossings_is_that_of_the_field_notes(tmp_path):
    # swrap 6.05 in meets 2x/1x at 12.1 in; with orders 1..4 on both also 3x/2x and 4x/3x
    path = edited(
        tmp_path,
        ("radius_max_m: 12 in", "radius_max_m: 12.5 in"),
        ("orders: [1], settle_s: 10", "orders: [1, 2, 3], settle_s: 10"),
    )
    facts = check_site(path).facts
    met = {(c.order, c.other_order): c.radius_m / 0.0254 for _, c in facts.meetings}
    assert met[2, 1] == pytest.approx(12.1, abs=0.01)
    assert met[3, 2] == pytest.approx(9.075, abs=0.01)
    assert met[4, 3] == pytest.approx(8.067, abs=0.01)
    assert met[1, 1] == pytest.approx(6.05, abs=0.01)


def test_disabled_blocks_meet_nothing(tmp_path):
    path = edited(tmp_path, ("settle_s: 10, ", "settle_s: 10, enabled: false, "))
    assert check_site(path).facts.meetings == ()


def test_defaults_in_use_are_listed_and_given_keys_are_not():
    defaults = check_site(EUCLID).facts.defaults
    assert "gateway.modbus_tcp.deadline_ms: 3 ms" in defaults
    assert "line.speed: line_speed_m_s" in defaults
    assert not any(line.startswith("line.cycle_ms") for line in defaults)


@each_case("speed", [0.0, -1.0, math.nan, math.inf])
def test_speed_without_meaning_is_refused(speed):
    with pytest.raises(ValueError, match="above 0"):
        check_site(EUCLID, speeds_m_s=[speed])
