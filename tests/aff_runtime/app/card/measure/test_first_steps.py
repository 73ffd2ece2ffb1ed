"""Steps 0 to 6 but the words: every figure against the formula that its record was made by."""

import math

import numpy as np
import pytest

from aff_runtime.app.card.figures import Verdict, mean_and_half, quantile
from aff_runtime.app.card.measure import limits, load_cell, machine, plug, shadow
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.machine import Machine
from aff_runtime.base.signals import State
from aff_runtime.telemetry.header import Right
from tests.aff_runtime.app.card.measure.recorded import (
    CYCLE_S,
    RADIUS_M,
    SITE,
    SPEED_M_S,
    evidence,
    figure,
    in_memory,
    steady,
)

RNG_SEED = 3
FIFO = Right(granted=True, text="SCHED_FIFO 80")
TWO = Machine(governors="performance", isolated="1", is_realtime=False, processors=2)


def test_a_quantile_is_that_of_the_order_and_its_interval_that_of_the_binomial():
    values = np.arange(1.0, 10_001.0)
    value, low, high = quantile(values, 0.99)
    half = 1.96 * math.sqrt(10_000 * 0.99 * 0.01)
    assert value == 9900.0
    assert (low, high) == (
        pytest.approx(9900 - half, abs=1.5),
        pytest.approx(9900 + half, abs=1.5),
    )


def test_the_interval_of_a_mean_holds_the_truth_in_about_95_of_100():
    rng = np.random.default_rng(RNG_SEED)
    hits = 0
    for _ in range(300):
        mean, half = mean_and_half(5.0 + rng.standard_normal(400))
        hits += abs(mean - 5.0) <= half
    assert 0.90 <= hits / 300 <= 0.99


def machine_step(folder, wake_us, rights=(FIFO,), seconds=61.0):
    columns = steady(seconds)
    columns["wake_us"] = np.resize(wake_us, columns["time_s"].size)
    return machine.measure(evidence(in_memory(folder, columns), rights=rights, machine=TWO))


def test_wake_up_is_its_99_percent_point(tmp_path):
    found = machine_step(tmp_path, np.arange(1.0, 101.0))  # 1 to 100 us, as often each
    assert figure(found, "wake-up").value == 99.0
    assert found.verdict is Verdict.PASS


def test_a_slow_machine_fails_and_a_short_window_too(tmp_path):
    assert machine_step(tmp_path / "a", np.array([501.0])).verdict is Verdict.FAIL
    assert machine_step(tmp_path / "b", np.array([50.0]), seconds=30.0).verdict is Verdict.FAIL


@pytest.mark.parametrize(
    ("step", "seconds"),
    [(machine, 58.9), (machine, 59.5), (shadow, 598.9), (shadow, 599.5)],
    ids=["machine, short", "machine", "shadow, short", "shadow"],
)
def test_the_length_of_a_window_is_judged_by_the_limit_that_is_printed(tmp_path, step, seconds):
    columns = {"time_s": np.array([0.0, seconds]), "state": np.full(2, State.SHADOW)}
    found = step.measure(evidence(in_memory(tmp_path, columns), rights=(FIFO,), machine=TWO))
    length = figure(found, "length of the window")
    printed_s = float(length.limit.removeprefix("at least ").removesuffix(" s"))
    assert length.good is (seconds >= printed_s)


def test_without_fifo_it_fails_and_without_a_word_on_it_it_stays_open(tmp_path):
    refused = Right(granted=False, text="SCHED_FIFO: not permitted")
    found = machine_step(tmp_path / "a", np.array([50.0]), rights=(refused,))
    assert found.verdict is Verdict.FAIL
    assert "right refused: SCHED_FIFO: not permitted" in found.remarks
    assert machine_step(tmp_path / "b", np.array([50.0]), rights=()).verdict is Verdict.OPEN


def loaded(folder, mean_N, noise_N, given, former=()):
    columns = steady(10.0)
    rng = np.random.default_rng(RNG_SEED)
    noise = rng.standard_normal(columns["time_s"].size)
    columns["unwind_tension_N"] = mean_N + noise_N * (noise - noise.mean()) / noise.std()
    return load_cell.measure(evidence(in_memory(folder, columns), given=given, former=former))


CELL = ["signal=unwind_tension_N"]


def test_zero_and_span_are_in_percent_of_the_weight_and_noise_is_proposed(tmp_path):
    first = loaded(tmp_path / "a", 0.3, 1.2, ["load=0", *CELL])
    assert first.verdict is Verdict.OPEN
    assert first.samples[0].number("sd_N") == pytest.approx(1.2)
    assert any("span weight" in text for text in first.missing)
    second = loaded(tmp_path / "b", 90.0, 1.2, ["load=20 lbf", *CELL], former=first.samples)
    span_N = 20.0 * 4.4482216152605
    zero = figure(second, "unwind_tension_N: error of zero")
    span = figure(second, "unwind_tension_N: error of span")
    assert zero.value == pytest.approx(100.0 * 0.3 / span_N)
    assert span.value == pytest.approx(100.0 * (90.0 - span_N) / span_N, abs=1e-6)
    assert (zero.good, span.good) == (True, False)
    assert second.verdict is Verdict.FAIL
    assert any("noise_N: 1.2" in text for text in second.proposals)


def test_a_noise_like_that_of_the_file_proposes_nothing(tmp_path):
    assert loaded(tmp_path, 0.0, 0.6, ["load=0", *CELL]).proposals == ()


@pytest.mark.parametrize("given", [[], ["load=0"], ["load=x", *CELL], ["load=3 m", *CELL]])
def test_a_load_that_is_none_is_asked_for(tmp_path, given):
    with pytest.raises(ConfigError, match=r"load|signal"):
        loaded(tmp_path, 0.0, 0.6, given)


LIMITS = ["unwind=0.05 m/s", "swrap_follower=40 mm/s"]


def test_limits_are_compared_with_the_plcs_and_counted():
    found = limits.measure(evidence(given=LIMITS))
    assert found.verdict is Verdict.PASS
    scale = SITE.gateway.write.corrections["unwind"].scale
    assert figure(found, "actuators.unwind.limit in counts").value == pytest.approx(0.05 / scale)
    beyond = limits.measure(evidence(given=["unwind=0.049 m/s", LIMITS[1]]))
    assert figure(beyond, "unwind: limit of").good is False
    assert limits.measure(evidence(given=LIMITS[:1])).verdict is Verdict.OPEN


def test_every_warning_has_to_be_understood():
    two = ("one", "two")
    for typed, verdict in (("2", Verdict.PASS), ("1", Verdict.FAIL)):
        given = [*LIMITS, f"warnings_understood={typed}"]
        assert limits.measure(evidence(given=given, warnings=two)).verdict is verdict
    assert limits.measure(evidence(given=LIMITS, warnings=two)).verdict is Verdict.OPEN


@pytest.mark.parametrize(
    ("given", "verdict"),
    [
        (["reaction=ramp", "time=120 ms"], Verdict.PASS),
        (["reaction=hold", "time=120 ms"], Verdict.FAIL),
        (["reaction=zero", "time=0.4 s"], Verdict.FAIL),
        (["reaction=zero"], Verdict.OPEN),
        ([], Verdict.OPEN),
        (["reaction=perhaps", "time=1 ms"], Verdict.OPEN),
    ],
)
def test_the_watchdog_is_what_was_typed(given, verdict):
    assert limits.watchdog(evidence(given=given)).verdict is verdict


def pulled(folder, stale_ticks, given=("base_reference=200 ms",), state=State.SHADOW):
    columns = steady(10.0)
    columns["state"][:] = state
    columns["fresh"][1000:] = 0.0
    columns["alarm"][999 + stale_ticks :] = 1.0
    columns["state"][999 + stale_ticks :] = State.FAULT
    return plug.measure(evidence(in_memory(folder, columns), given=given))


def test_stale_is_timed_from_the_last_movement_to_the_alarm(tmp_path):
    found = pulled(tmp_path, 17)
    stale = figure(found, "PLC_STALE")
    assert stale.value == pytest.approx(85.0)
    assert (stale.low, stale.high) == (pytest.approx(80.0), pytest.approx(90.0))
    assert figure(found, "fault_after_ms + fade_ms").value == 80.0 + 150.0
    assert found.verdict is Verdict.PASS


def test_a_plug_that_is_noticed_late_or_not_at_all_does_not_pass(tmp_path):
    assert pulled(tmp_path / "a", 40).verdict is Verdict.FAIL
    assert pulled(tmp_path / "b", 17, given=()).verdict is Verdict.OPEN
    assert pulled(tmp_path / "c", 17, state=State.READY).verdict is Verdict.OPEN
    still = plug.measure(evidence(in_memory(tmp_path / "d", steady(5.0))))
    assert still.verdict is Verdict.OPEN
    assert "no PLC_STALE" in still.missing[0]


def in_shadow(folder, frequency_ratio=1.0, seconds=601.0, change=None, events=()):
    columns = steady(seconds)
    time_s = columns["time_s"]
    rng = np.random.default_rng(RNG_SEED)
    radius = RADIUS_M * (1.0 - 0.1 * time_s / seconds)  # the roll runs down
    angle = np.cumsum(SPEED_M_S / radius) * CYCLE_S
    columns["unwind_radius_m"], columns["unwind_angle_rad"] = radius, angle
    columns["unwind_tension_N"] += np.cos(2.0 * frequency_ratio * angle) + 0.3 * (
        rng.standard_normal(time_s.size)
    )
    if change is not None:
        change(columns)
    return shadow.measure(evidence(in_memory(folder, columns, events)))


def test_a_rolls_frequency_is_that_of_its_peak_though_its_radius_changes(tmp_path):
    found = in_shadow(tmp_path)
    peak = figure(found, "unwind: frequency")
    assert peak.value == pytest.approx(0.0, abs=0.05)
    assert found.verdict is Verdict.PASS
    follower = figure(found, "swrap_follower: frequency")
    assert math.isnan(follower.value)  # it makes no ripple here, and that is said
    assert any("swrap_follower" in text for text in found.remarks)


def test_a_peak_two_percent_beside_its_roll_fails(tmp_path):
    found = in_shadow(tmp_path, frequency_ratio=1.02)
    assert figure(found, "unwind: frequency").value == pytest.approx(2.0, abs=0.1)
    assert found.verdict is Verdict.FAIL


def test_missed_ticks_overruns_and_other_states_fail(tmp_path):
    def miss(columns):
        columns["missed_count"][500:] = 2.0
        columns["state"][:6000] = State.READY

    found = in_shadow(tmp_path, change=miss, events=[(30.0, "OVERRUN")])
    assert figure(found, "ticks missed").value == 2.0
    assert figure(found, "overruns").value == 1.0
    assert figure(found, "in shadow").value == pytest.approx(95.0, abs=0.1)
    assert found.verdict is Verdict.FAIL
