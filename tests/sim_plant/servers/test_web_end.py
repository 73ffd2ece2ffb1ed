"""A roll that runs out stops the line as a line's controls would, and full rolls start it."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest

from aff_runtime.base.signals import StateBits, Status
from benchmarks.control.lines import nominal
from sim_plant.line.open import make_line
from sim_plant.line.running.simulation import LineSimulation
from sim_plant.servers.control import ControlSocket
from sim_plant.servers.plant import Plant
from sim_plant.servers.plc import Plc
from sim_plant.servers.web_end import STOP_S, RESERVE_m, WebState
from tests.sim_plant.servers.fake_line import FakeLine, default_map, write_block
from tests.sim_plant.servers.served import answered, served, wait_until

pytestmark = pytest.mark.processes

DT_s = 0.01


class RollOfWeb(FakeLine):
    """The fake line with so many metres of web, 1 m/s."""

    def __init__(self, left_m: float) -> None:
        super().__init__(DT_s)
        self.web_left_m = left_m

    def step(self, inputs):
        measured = super().step(inputs)
        self.web_left_m -= measured["line_speed_m_s"] * DT_s
        return {**measured, "line_speed_ref_m_s": self.inputs["line_speed_ref_m_s"]}


class Turret(RollOfWeb):
    def change_rolls(self) -> None:
        self.web_left_m = 600.0


class Bench:
    """Plant and control socket; ``heard`` are the states the web's end went through."""

    def __init__(self, line: FakeLine) -> None:
        self.line = line
        self.plant = Plant(line, Plc(default_map()))
        self.control = ControlSocket(None, self.plant, dict)
        self.heard: list[WebState] = []
        self.plant.web.observers.append(self.heard.append)

    def run(self, duration_s: float) -> list[float]:
        speeds = []
        for _ in range(round(duration_s / self.line.sample_time_s)):
            self.plant.step()
            speeds.append(self.plant.measured["line_speed_m_s"])
        return speeds

    @property
    def runs(self) -> bool:
        return Status.LINE_RUN in self.plant.plc.status


def stopped(line: RollOfWeb) -> Bench:
    """A bench at the end of its web: the line stands."""
    bench = Bench(line)
    bench.run(line.web_left_m + STOP_S)
    assert bench.heard == [WebState.STOPS, WebState.STANDS]
    return bench


def test_the_line_stops_by_a_ramp_and_keeps_its_reserve_of_web():
    # from 1 m/s the ramp needs STOP_S / 2 m: it begins 0.5 m after the start
    bench = Bench(RollOfWeb(RESERVE_m + 0.5 * STOP_S + 0.5))
    speeds = bench.run(0.5 + STOP_S + 5.0)
    begin = round(0.5 / DT_s)
    ramp = [1.0 - k * DT_s / STOP_S for k in range(round(STOP_S / DT_s) + 1)]
    assert set(speeds[: begin - 2]) == {1.0}
    late = next(k for k in range(begin - 2, begin + 3) if speeds[k] < 1.0)
    assert speeds[late - 1 : late + len(ramp) - 1] == pytest.approx(ramp, abs=1e-9)
    assert set(speeds[late + len(ramp) :]) == {0.0}
    assert bench.line.web_left_m == pytest.approx(RESERVE_m, abs=2 * DT_s)


def test_line_run_falls_with_the_first_sample_of_the_ramp_and_no_correction_counts():
    bench = Bench(RollOfWeb(RESERVE_m + 0.5 * STOP_S + 0.5))
    refusals = []
    for heartbeat in range(100):
        state = StateBits.ARMED if heartbeat < 3 else StateBits.ACTIVE
        bench.plant.registers.write(100, write_block(heartbeat, unwind=100, state=state))
        bench.plant.step()
        refusals.append(bench.plant.refusal)
        assert bench.runs == (not bench.heard)
    assert refusals[10] == ""
    assert refusals[-1] == "permissive: LINE_RUN=0"


def test_nothing_but_full_rolls_starts_the_line_again():
    bench = stopped(RollOfWeb(8.0))
    assert "`roll`" in answered(bench.control, "set line_speed_ref_m_s 1.0")["error"]
    assert "`roll`" in answered(bench.control, "set LINE_RUN 1")["error"]
    assert "no rolls that can be exchanged" in answered(bench.control, "roll")["error"]
    assert set(bench.run(2.0)) == {0.0}
    assert not bench.runs


def test_full_rolls_bring_line_run_and_the_speed_back_by_a_ramp():
    bench = stopped(Turret(8.0))
    due_s = answered(bench.control, "roll")["change_s"]
    bench.run(due_s - bench.plant.time_s)
    assert Status.SPLICE_ACTIVE in bench.plant.plc.status
    speeds = bench.run(STOP_S + 1.0)
    assert bench.heard[2:] == [WebState.STARTS, WebState.RUNS]
    assert bench.runs
    assert all(0.0 <= b - a <= DT_s / STOP_S + 1e-9 for a, b in pairwise(speeds))
    assert speeds[-1] == 1.0
    assert answered(bench.control, "set line_speed_ref_m_s 0.5") == {"ok": True}
    assert bench.run(0.1)[-1] == 0.5


def test_line_run_that_somebody_took_away_does_not_come_back_by_itself():
    bench = stopped(Turret(8.0))
    assert answered(bench.control, "set LINE_RUN 0") == {"ok": True}
    answered(bench.control, "roll")
    bench.run(3.0)
    assert bench.heard[2] is WebState.STARTS
    assert not bench.runs


def test_a_line_at_rest_with_little_web_is_not_stopped():
    line = RollOfWeb(1.0)
    line.inputs["line_speed_ref_m_s"] = 0.0
    bench = Bench(line)
    bench.run(1.0)
    assert bench.heard == []
    assert bench.runs


@pytest.mark.wire
def test_log_and_status_say_that_the_web_is_at_its_end_and_how_to_go_on(tmp_path):
    control, said = tmp_path / "plant.sock", []
    with served(line=Turret(6.0), said=said, control=control) as plant:
        wait_until(lambda: len(said) > 1)
        web = plant.command("status")["web"]
        assert web["state"] == "stops"
        assert web["left_m"] < RESERVE_m + 0.5 * STOP_S
        plant.command("roll")
        wait_until(lambda: len(said) > 2)
        assert plant.command("status")["web"]["say"] == ""
    for text in (said[1], web["say"]):
        assert text.startswith("web at its end: ")
        assert f"To go on: `sim-plant tell {control} roll`" in text
        assert "start sim-plant serve again" in text
    assert said[2] == "full rolls are on: the line starts again, LINE_RUN as before"


def short_line(radius_m: float) -> LineSimulation:
    """The Euclid line with a roll of this radius, the first span as its circles give it."""
    line = make_line(nominal("tyvek", radius_m), seed=1)
    line.settle()
    return line


def test_the_web_on_a_roll_is_its_area_over_its_thickness_and_leaves_with_the_line():
    line = short_line(0.05)
    full_m = math.pi * (0.05**2 - 0.04445**2) / 0.00019
    assert line.web_left_m == pytest.approx(full_m, rel=1e-9)
    speed_m_s = line.step({})["line_speed_ref_m_s"]
    for _ in range(399):
        line.step({})
    # 400 samples of 5 ms; the web on the roll is strained by no more than 2 %
    assert full_m - line.web_left_m == pytest.approx(2.0 * speed_m_s, rel=0.02)


def test_the_compiled_line_stands_under_tension_with_web_on_its_core():
    line = short_line(0.05)
    bench = Bench(line)
    tensions = []
    for _ in range(round(25.0 / line.sample_time_s)):
        bench.plant.step()
        tensions.append(bench.plant.measured["true_unwind_tension_N"])
    assert bench.heard == [WebState.STOPS, WebState.STANDS]
    assert line.web_left_m == pytest.approx(RESERVE_m, abs=0.15)
    assert abs(bench.plant.measured["true_line_speed_m_s"]) < 0.02
    reference_N = bench.plant.measured["tension_ref_N"]
    assert all(0.5 * reference_N < tension < 1.5 * reference_N for tension in tensions)
