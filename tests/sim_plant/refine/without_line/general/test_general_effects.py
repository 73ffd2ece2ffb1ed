"""Every general effect that may be claimed is found in a record made with it, with its number.

How long the filter is: test_filter_length.py. Past outputs are never taken.
"""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from sim_plant.refine.without_line.general.catalogue import CATALOGUE
from sim_plant.refine.without_line.general.effect import OutputRecord
from sim_plant.refine.without_line.general.findings import findings
from sim_plant.refine.without_line.general.judging import judge
from sim_plant.refine.without_line.general.search import search

SIZE = 2500
STEP_S = 0.01
NOISE = 0.1


def smooth(rng, size=SIZE, width=15):
    kernel = np.hanning(width)
    values = np.convolve(rng.standard_normal(size + width - 1), kernel, "valid")
    return values / values.std()


def record_of(output, u, speed=None, derivative_of_inputs=False, end_samples=20):
    inputs = {} if u is None else {"u": u}
    return OutputRecord(
        output=output,
        inputs=inputs,
        speed_m_s=speed,
        step_s=STEP_S,
        derivative_of_inputs=derivative_of_inputs,
        end_samples=end_samples,
    )


def made(seed, act, *, scale=1.0, middle=0.0, speed=None):
    """Return a record whose output is ``act`` of its input, in white noise."""
    rng = np.random.default_rng(seed)
    u = middle + scale * smooth(rng)
    return record_of(act(u) + NOISE * rng.standard_normal(SIZE), u, speed)


def traced(fitted, held):
    found = search(fitted, lambda _: None)
    judged = judge(found, held)
    names = ("y", [f"r{k}" for k in range(len(fitted))], "held")
    return {f.effect: f for f in findings(found, judged, fitted, held, names)}, judged


def only(act, effect, number, **how):
    """Return value and interval of the one effect that is claimed."""
    found, judged = traced([made(1, act, **how), made(2, act, **how)], made(3, act, **how))
    assert set(found) == {effect}
    assert judged.chosen_rms == pytest.approx(NOISE, rel=0.05)
    assert judged.chosen_rms < judged.plain_rms
    return found[effect].numbers[number], found[effect].interval95[number]


def within(value, interval, truth, rel):
    assert value == pytest.approx(truth, rel=rel)
    width = interval[1] - interval[0]
    assert interval[0] - width < truth < interval[1] + width  # 95 % interval, half as wide again


def test_a_plain_filter_claims_nothing():
    found, judged = traced([made(1, lambda u: 2.0 * u)], made(3, lambda u: 2.0 * u))
    assert found == {}
    assert not judged.fell_back


@pytest.mark.parametrize(("size", "seed"), [(6000, 0), (4000, 0)])
def test_noise_alone_claims_nothing(size, seed):
    """At 4000 samples a gain of chance was told with its delay, 239 ms (215 to 262)."""
    records = []
    for k in (1, 2, 3):
        rng = np.random.default_rng(1000 * seed + k)
        u = smooth(rng, size)
        records.append(record_of(NOISE * rng.standard_normal(size), u))
    found, _ = traced(records[:2], records[2])
    assert found == {}


def play(u, width):
    out, at = [], u[0]
    for x in u:
        at = min(max(at, x - width / 2), x + width / 2)
        out.append(at)
    return np.array(out)


def test_friction_by_sign_is_found_with_its_step():
    act = lambda u: 2.0 * u + 0.8 * np.sign(u)  # noqa: E731
    within(*only(act, "friction_by_sign", "step"), 0.8, 0.03)


@pytest.mark.long  # quick: friction, play, zero and shift
def test_a_dead_band_is_found_with_its_half_width():
    act = lambda u: 2.0 * np.sign(u) * np.maximum(np.abs(u) - 0.4, 0.0)  # noqa: E731
    within(*only(act, "dead_band", "half_width"), 0.4, 0.02)


@pytest.mark.long  # quick: friction, play, zero and shift
def test_saturation_is_found_with_its_limit():
    act = lambda u: 2.0 * np.clip(u, -1.1, 1.1)  # noqa: E731
    within(*only(act, "saturation", "limit"), 1.1, 0.02)


def test_backlash_is_found_with_its_play():
    act = lambda u: 2.0 * play(u, 0.5)  # noqa: E731
    within(*only(act, "backlash", "play"), 0.5, 0.02)


@pytest.mark.long  # quick: friction, play, zero and shift
def test_a_static_curve_is_found_with_its_bend():
    act = lambda u: 2.0 * (u + 0.2 * u**2)  # noqa: E731
    within(*only(act, "static_nonlinearity", "square_per_unit"), 0.2, 0.03)


@pytest.mark.long  # quick: friction, play, zero and shift
def test_friction_by_speed_is_found_where_the_filter_takes_rates():
    records = []
    for seed in (1, 2, 3):
        rng = np.random.default_rng(seed)
        v = 2.0 + smooth(rng, width=101)
        y = 0.05 * np.gradient(v, STEP_S) + 0.7 * v * np.abs(v) + NOISE * rng.standard_normal(SIZE)
        records.append(record_of(y, v, derivative_of_inputs=True))
    found, _ = traced(records[:2], records[2])
    assert set(found) == {"friction_by_speed"}
    said = found["friction_by_speed"]
    within(said.numbers["per_unit2"], said.interval95["per_unit2"], 0.7, 0.05)


@pytest.mark.long  # quick: friction, play, zero and shift
def test_a_gain_that_depends_on_the_speed_is_found_with_its_slope():
    speed = 2.0 + np.sin(2.0 * np.pi * np.arange(SIZE) / 2000.0)
    act = lambda u: 2.0 * (1.0 + 0.25 * (speed - 2.0)) * u  # noqa: E731
    within(*only(act, "state_dependence", "gain_share_per_unit", speed=speed), 0.25, 0.03)


def test_zero_and_drift_are_found_for_every_record():
    time_s = (np.arange(SIZE) - 0.5 * (SIZE - 1)) * STEP_S
    rows = [
        made(k, lambda u, z=zero, d=drift: 2.0 * u + z + d * time_s)
        for k, (zero, drift) in enumerate(((1.0, 0.01), (-1.0, 0.0), (3.0, -0.02)))
    ]
    found, judged = traced(rows[:2], rows[2])
    assert set(found) == {"offset_drift"}
    numbers = found["offset_drift"].numbers
    assert numbers["offset of record 1"] == pytest.approx(1.0, rel=0.02)  # about their mean, 0
    assert numbers["offset of record 2"] == pytest.approx(-1.0, rel=0.02)
    assert numbers["drift_per_s of record 1"] == pytest.approx(0.01, rel=0.05)
    assert judged.chosen_rms == pytest.approx(NOISE, rel=0.05)


def delayed(seed, samples, gain=2.0):
    rng = np.random.default_rng(seed)
    u = smooth(rng, SIZE + 40)
    at = np.arange(SIZE) + 20.0
    y = gain * CubicSpline(np.arange(u.size), u)(at - samples)
    return record_of(y + NOISE * rng.standard_normal(SIZE), u[20:-20])


@pytest.mark.parametrize("late", [3.7, -5.25, 0.4])
@pytest.mark.sweep(every=3)
def test_a_shift_between_records_is_found_to_a_hundredth_of_a_sample(late):
    found, judged = traced([delayed(1, 0.0), delayed(2, late)], delayed(3, -1.3))
    shift = found["channel_shift"]
    value, interval = shift.numbers["shift_s of r1"], shift.interval95["shift_s of r1"]
    assert value == pytest.approx(late * STEP_S, abs=0.03 * STEP_S)
    within(value, interval, late * STEP_S, 0.1)
    assert shift.numbers["shift_s of held"] == pytest.approx(-1.3 * STEP_S, abs=0.03 * STEP_S)
    assert judged.chosen_rms == pytest.approx(NOISE, rel=0.05)
    assert shift.before_rms > 2.0 * shift.after_rms


@pytest.mark.long  # quick: a shift between records
def test_a_delay_common_to_all_records_is_found_where_a_gain_alone_explains():
    found, _ = traced([delayed(1, 2.6), delayed(2, 2.6)], delayed(3, 2.6))
    numbers = found["channel_shift"].numbers
    assert set(numbers) == {"delay_s behind u"}
    assert numbers["delay_s behind u"] == pytest.approx(2.6 * STEP_S, abs=0.03 * STEP_S)


def test_a_shift_of_the_held_out_record_alone_is_found_there():
    found, judged = traced([delayed(1, 0.0)], delayed(3, 1.5))
    numbers = found["channel_shift"].numbers
    assert numbers["shift_s of held"] == pytest.approx(1.5 * STEP_S, abs=0.03 * STEP_S)
    assert judged.chosen_rms < 0.5 * judged.plain_rms


def test_a_filter_that_fails_held_out_gives_way_to_plain_least_squares():
    """What the records fitted have and the held-out one has not must not cost it anything."""
    act = lambda u: 2.0 * u + 0.8 * np.sign(u)  # noqa: E731
    fitted = [made(1, act), made(2, act)]
    held = made(3, lambda u: 2.5 * u)
    found = search(fitted, lambda _: None)
    judged = judge(found, held)
    assert judged.chosen_rms > judged.plain_rms
    assert judged.fell_back
    left = held.judged - judged.explained
    assert np.sqrt(np.mean(left**2)) <= judged.plain_rms
    names = ("y", ["r0", "r1"], "held")
    assert findings(found, judged, fitted, held, names) == []


def test_without_inputs_zero_drift_and_past_outputs_are_left():
    rng = np.random.default_rng(4)
    rows = [record_of(z + NOISE * rng.standard_normal(SIZE), None) for z in (1.0, -1.0, 5.0)]
    found, judged = traced(rows[:2], rows[2])
    assert set(found) == {"offset_drift"}
    assert judged.chosen_rms == pytest.approx(NOISE, rel=0.05)


def test_past_outputs_say_how_coloured_the_rest_is():
    """y = 2 u + n, n = 0.9 n' + e: one step ahead leaves e."""
    rows = []
    for seed in (1, 2):
        rng = np.random.default_rng(seed)
        u, e = smooth(rng), NOISE * rng.standard_normal(SIZE)
        n = np.zeros(SIZE)
        for k in range(1, SIZE):
            n[k] = 0.9 * n[k - 1] + e[k]
        rows.append(record_of(2.0 * u + n, u))
    judged = judge(search(rows[:1], lambda _: None), rows[1])
    ahead = [r for r in judged.rows if r.effect == "past_outputs"]
    assert judged.chosen_rms == pytest.approx(NOISE / np.sqrt(1.0 - 0.81), rel=0.1)
    assert min(r.held_out_rms for r in ahead) < 1.5 * NOISE
    assert not any(r.taken for r in ahead)


def test_standardised_inputs_have_no_zero_and_no_effect_about_one():
    act = lambda u: 2.0 * u + 0.8 * np.sign(u)  # noqa: E731
    rows = []
    for seed in (1, 2):
        rng = np.random.default_rng(seed)
        u = smooth(rng)
        u = (u - u.mean()) / u.std()
        rows.append(record_of(act(u) + NOISE * rng.standard_normal(SIZE), u))
    found, _ = traced(rows[:1], rows[1])
    assert found == {}


def test_every_effect_of_the_catalogue_is_tried_and_in_the_table():
    rows = [made(k, lambda u: 2.0 * u, middle=0.3) for k in (1, 2, 3)]
    speed = np.linspace(1.0, 2.0, SIZE)
    records = [record_of(v.output, v.inputs["u"], speed) for v in rows]
    judged = judge(search(records[:2], lambda _: None), records[2])
    assert {e.name for e in CATALOGUE} <= {row.effect for row in judged.rows}
