"""A line is claimed for the speeds at which it is there; orders of a turn are orders."""

import json

import numpy as np
import pytest

from sim_plant.line.reading.load import read_source
from sim_plant.refine.report.outcome import RefineRequest
from sim_plant.refine.without_line.pipeline import refine_records
from sim_plant.refine.without_line.record_filter import record_declaration_in
from sim_plant.refine.without_line.spectral_line_presence import harmonic_series

RATE_HZ = 1000.0
SIZE = 16000
DECLARATION = """\
schema: record-declaration/1
sample_time_s: 0.001
outputs: [torque_N_m]
taps: 4
{travel}
"""


def write_motor(path, seed, turns_s, orders=(), tones=()):
    """Write a record of a motor at a set speed: orders (order, size) and tones (Hz, size)."""
    rng = np.random.default_rng(seed)
    time_s = np.arange(SIZE) / RATE_HZ
    speed = turns_s * (1.0 + 1e-5 * rng.standard_normal(SIZE))
    turns = np.cumsum(speed) / RATE_HZ
    torque = rng.standard_normal(SIZE)
    for order, size in orders:
        torque += size * np.cos(2.0 * np.pi * order * turns + rng.uniform(0.0, 6.28))
    for frequency_Hz, size in tones:
        torque += size * np.cos(2.0 * np.pi * frequency_Hz * time_s + rng.uniform(0.0, 6.28))
    np.savetxt(
        path,
        np.column_stack([time_s, torque, speed]),
        "%.8g",
        ",",
        header="time_s,torque_N_m,motor_m_s",
        comments="",
    )
    return path


def refined(folder, records, holdout=(), travel="travel_speed: motor_m_s"):
    (folder / "motor.yaml").write_text(DECLARATION.format(travel=travel))
    plan = RefineRequest(
        line=folder / "motor.yaml",
        records=tuple(records),
        holdout=tuple(holdout),
        out=folder / "out",
    )
    declaration = record_declaration_in(read_source(plan.line))
    return refine_records(plan, declaration, lambda _: None), plan


def test_an_order_whose_size_differs_from_speed_to_speed_is_one_order(tmp_path):
    slow = write_motor(tmp_path / "slow.csv", 1, 5.3, orders=[(6, 1.0)])
    fast = write_motor(tmp_path / "fast.csv", 2, 10.0, orders=[(6, 0.2)])
    held = write_motor(tmp_path / "held.csv", 3, 7.65, orders=[(6, 0.6)])
    result, _ = refined(tmp_path, [slow, fast], [held])
    (line,) = result.unknown
    assert line.axis == "travel"
    assert line.frequency == pytest.approx(6.0, rel=1e-4)
    assert line.presence.scope == "every speed"
    row = result.residual_rms["torque_N_m"]
    assert row.before == pytest.approx(np.sqrt(1.0 + 0.18), rel=0.01)
    assert row.after == pytest.approx(1.0, rel=0.01)  # half way between the sizes of the two


def test_orders_of_one_record_are_no_frequencies_at_every_speed(tmp_path):
    """40, 110, 120 and 240 Hz at 10 turns/s are orders 4, 11, 12 and 24."""
    orders = [(4, 0.3), (11, 0.4), (12, 0.5), (24, 0.3)]
    slow = write_motor(tmp_path / "slow.csv", 1, 5.3)
    fast = write_motor(tmp_path / "fast.csv", 2, 10.0, orders=orders)
    result, plan = refined(tmp_path, [slow, fast])
    assert {x.axis for x in result.unknown} == {"travel"}
    found = sorted((x.presence.order, round(x.frequency, 2)) for x in result.unknown)
    assert found == [(4, 4.0), (11, 11.0), (12, 12.0), (24, 24.0)]
    assert {x.presence.scope for x in result.unknown} == {"one speed"}
    assert all(x.presence.present == (False, True) for x in result.unknown)
    assert "at every speed" not in (plan.out / "report.html").read_text()


def test_a_lone_line_of_one_record_is_seen_at_one_speed(tmp_path):
    slow = write_motor(tmp_path / "slow.csv", 1, 5.3)
    fast = write_motor(tmp_path / "fast.csv", 2, 10.0, tones=[(43.7, 0.4)])
    result, plan = refined(tmp_path, [slow, fast])
    (line,) = result.unknown
    assert line.presence.scope == "one speed"
    both = {line.axis: line.frequency, "other": line.presence.other_frequency}
    assert sorted(both.values()) == pytest.approx([4.37, 43.7], rel=1e-3)
    page = (plan.out / "report.html").read_text()
    assert "seen at one speed only, 10 m/s (1 of 2 records)" in page


def test_a_frequency_that_is_there_at_each_speed_is_one_at_every_speed(tmp_path):
    tones = [(43.7, 0.3)]
    slow = write_motor(tmp_path / "slow.csv", 1, 5.3, tones=tones)
    fast = write_motor(tmp_path / "fast.csv", 2, 10.0, tones=tones)
    result, plan = refined(tmp_path, [slow, fast])
    (line,) = result.unknown
    assert (line.axis, line.presence.scope) == ("time", "every speed")
    assert line.frequency == pytest.approx(43.7, rel=1e-4)
    assert "43.7 Hz, at every speed (5.3 and 10 m/s)" in (plan.out / "report.html").read_text()


def test_without_inputs_and_without_a_speed_lines_are_still_found(tmp_path):
    records = [write_motor(tmp_path / f"{k}.csv", k, 10.0, tones=[(43.7, 0.3)]) for k in (1, 2, 3)]
    result, plan = refined(tmp_path, records[:2], records[2:], travel="")
    (line,) = result.unknown
    assert (line.axis, line.presence.scope) == ("time", "every record")
    assert result.residual_rms["torque_N_m"].after == pytest.approx(1.0, rel=0.01)
    written = json.loads((plan.out / "verdict.json").read_text())["residual_rms"]
    assert written["torque_N_m"].keys() == {"before", "after"}  # no noise is declared: no floor
    assert any("no inputs are declared" in text for text in result.not_claimed)
    assert "a constant" in (plan.out / "report.html").read_text()


def test_lines_share_the_largest_fundamental_of_which_they_are_whole_multiples():
    base, orders = harmonic_series([4.0, 11.0, 12.0, 24.0, 6.37], [0.002] * 5)
    assert base == pytest.approx(1.0)
    assert orders == [4, 11, 12, 24, 0]


def test_lines_that_share_no_fundamental_are_no_orders():
    assert harmonic_series([4.07, 11.31, 17.63], [0.002] * 3) == (0.0, [])
