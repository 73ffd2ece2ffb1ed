"""The bench's own parts: geometry, order tracking, verdicts, lockstep."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from aff_runtime.base.signals import ActuatorStep
from benchmarks.control import store
from benchmarks.control.__main__ import SECTIONS, chosen_jobs, only
from benchmarks.control.cases import ON_S, constant_cases, mismatch_cases, roll_duration_s
from benchmarks.control.jobs import Job
from benchmarks.control.laws import (
    OWN,
    RIVALS,
    TUNED,
    drive_of,
    plain_blocks,
    shape_law,
    web_leaves_rad,
)
from benchmarks.control.lines import ALL_FIVE, INCH_M, Hidden, nominal, spoilt, with_hidden
from benchmarks.control.lockstep import Recording, run
from benchmarks.control.memory import ROUND_TICKS, Eventful, footprint
from benchmarks.control.nominal_loop import RADII_M, nominal_loop
from benchmarks.control.report import page
from benchmarks.control.scores import order_amplitudes, ratio_dB, score_transient
from benchmarks.control.verdicts import beaten, targets
from sim_plant.geometry.wound_mass import WoundMass, gravity_torque_N_m
from sim_plant.line.declared.declaration import LoadCell
from sim_plant.line.reading.load import consistency

CYCLE_S = 0.005


@pytest.mark.parametrize("radius_in", [8.0, 6.375, 4.75, 2.5])
def test_a_line_with_another_radius_is_consistent(radius_in):
    line = nominal("tyvek", radius_in * INCH_M)
    assert consistency(line) == []
    assert line.spans[0].direction_deg == pytest.approx(
        nominal("tyvek", 0.2032).spans[0].direction_deg, abs=12.0
    )


def test_the_declared_radius_gives_the_declared_span_back():
    line = nominal("tyvek", 0.2032)
    assert line.spans[0].length_m == pytest.approx(1.19239, abs=1e-4)
    assert line.spans[0].direction_deg == pytest.approx(1.9771, abs=0.01)


def test_hidden_means_the_declaration_does_not_say_it():
    line = nominal("pe", 0.2032)
    spoilt_line = with_hidden(line, ALL_FIVE)
    assert pytest.approx(0.7 * line.web.EA_N) == spoilt_line.web.EA_N
    assert spoilt_line.web.wound_in_tension_N == pytest.approx(0.5 * line.web.wound_in_tension_N)
    assert {s.low_pass_Hz for s in spoilt_line.sensors if isinstance(s, LoadCell)} == {3.0}


def test_order_tracking_finds_known_amplitudes_beside_another_roll():
    rng = np.random.default_rng(0)
    theta = np.arange(8000) * 0.005 * 5.0
    other = np.arange(8000) * 0.005 * 6.7
    signal = 3.0 + 0.5 * np.cos(theta + 0.4) + 0.2 * np.sin(3 * theta) + 0.7 * np.cos(other)
    found = order_amplitudes(signal + 0.05 * rng.standard_normal(8000), theta, other, 0.005)
    assert found[:3] == pytest.approx([0.5, 0.0, 0.2], abs=0.01)


def test_a_ratio_of_ten_is_twenty_dB():
    assert ratio_dB(np.array([1.0]), np.array([0.1])) == pytest.approx([20.0])


def test_names_of_cases_are_unique():
    for cases in (constant_cases(), mismatch_cases()):
        assert len({c.name for c in cases}) == len(cases)


def test_a_roll_lasts_as_long_as_its_web():
    case = constant_cases()[3]
    web_m = math.pi * ((8 * INCH_M) ** 2 - (2.5 * INCH_M) ** 2) / case.line().web.thickness_m
    assert roll_duration_s(case) == pytest.approx(web_m / case.speed_m_s)


def test_a_silent_law_leaves_the_line_as_it_is_and_the_seed_decides():
    line = spoilt(nominal("tyvek", 0.2032), shape="flat", lead_m=0.0, follower_m=0.0)
    speed = np.full(400, 1.016)
    a = run(line, {}, speed, seed=1, on_s=ON_S)
    b = run(line, {}, speed, seed=1, on_s=ON_S, hidden=Hidden(delay_s=0.05))
    c = run(line, {}, speed, seed=2, on_s=ON_S)
    assert (a.tension_N == b.tension_N).all()
    assert (a.tension_N != c.tension_N).any()
    assert not a.correction_m_s.any()


def test_targets_say_what_share_of_rows_meets_them():
    row = {
        "section": "follower",
        "law": "follower and unwind",
        "case": "x",
        "seed": 1,
        "pullroll_1x_dB": 35.0,
        "pullroll": 0.1,
        "unwind": 1.2,
        "follower_speed": 1.0,
    }
    found = {t.what: t.met for t in targets([row, {**row, "unwind": 0.9}])}
    assert found["4 follower, pull-roll 1x"] == "yes"
    assert found["4 unwind tension meanwhile"] == "50 %"


def test_a_film_row_is_as_good_as_its_worst_order_in_its_worst_ramp():
    row = {"section": "film", "law": OWN, "case": "x", "seed": 1, "ripple": [0.02, 0.01]}
    steady, ramps = {**row, "worst_dB": [28.0]}, {**row, "worst_dB": [22.0, 9.0]}
    rows = [steady, {**ramps, "ripple": [0.04, 0.11]}, {**steady, "worst_dB": [20.0]}]
    found = {t.what: t for t in targets(rows)}
    orders = found["8 film, every order below 60 Hz, ramps included"]
    assert (orders.reached, orders.met) == ("9 / 20 / 28", "67 %")
    ripple = found["8 film, total ripple, ramps included"]
    assert (ripple.reached, ripple.met) == ("0.020 / 0.020 / 0.110", "67 %")
    assert "8 the same with a perfect roll" not in found


def test_a_rival_with_less_ripple_is_named_with_its_ratio():
    own = {"section": "constant", "law": OWN, "case": "x", "seed": 1, "ripple": 0.05}
    rival = {**own, "law": "FxLMS", "ripple": 0.04}
    ((row, ratio),) = beaten([own, rival, {**own, "law": "repetitive", "ripple": 0.4}])
    assert row["law"] == "FxLMS"
    assert ratio == pytest.approx(0.8)


def test_a_row_is_kept_until_its_sources_change(tmp_path, monkeypatch):
    job = Job(section="constant", case=constant_cases()[0], law="FxLMS", seed=1)
    assert store.load(tmp_path, job) is None
    store.save(tmp_path, job, {"ripple": 0.5})
    assert store.load(tmp_path, job) == {"ripple": 0.5}
    assert store.load(tmp_path, Job(section="constant", case=job.case, law=OWN, seed=1)) is None
    monkeypatch.setitem(TUNED["FxLMS"]["setting"], "turns", 77.0)
    store.fingerprint.cache_clear()
    assert store.load(tmp_path, job) is None
    store.fingerprint.cache_clear()


def test_every_law_stands_on_every_row():
    jobs = chosen_jobs(SECTIONS, [1, 101], quick=False)
    for section in ("constant", "ramp", "roll", "mismatch"):
        rows = {(j.case.name, j.law, j.seed) for j in jobs if j.section == section}
        for name, _, seed in rows:
            assert all((name, law, seed) in rows for law in (OWN, *RIVALS))
    assert len({store.place(Path(), j) for j in jobs}) == len(jobs)


def test_the_short_set_does_not_claim_what_was_found_on_the_whole_one():
    whole, short = page([]), page([], quick=True)
    assert "Why targets are missed" in whole
    assert "Why targets are missed" not in short
    assert "Short set" in short


def test_one_row_is_chosen_by_the_names_of_the_tables():
    jobs = chosen_jobs(("constant", "roll"), (1, 101), quick=False)
    chosen = only(jobs, laws="FxLMS;perfect roll", names="PE 300 FPM R8 flat")
    assert {(j.law, j.seed, j.section) for j in chosen} == {
        *(("FxLMS", seed, section) for seed in (1, 101) for section in ("constant", "roll")),
        *(("perfect roll", seed, "constant") for seed in (1, 101)),
    }
    assert only(jobs, laws="", names="") == jobs
    with pytest.raises(SystemExit, match=r"no row of .'FXLMS'.; there are: .*FxLMS"):
        only(jobs, laws="FXLMS", names="")


def test_the_compiled_run_without_a_law_is_the_run_with_a_silent_one():
    line = spoilt(nominal("tyvek", 0.2032), shape="flat", lead_m=0.0, follower_m=0.0)
    speed = np.linspace(1.0, 1.2, 300)

    class Silent:
        def step(self, _inputs):
            return ActuatorStep(value=0.0, peak_bound=0.0, slew_bound=0.0)

    alone = run(line, {}, speed, seed=3, on_s=0.5)
    silent = run(line, {"unwind": lambda _phases, _cycle_s: Silent()}, speed, seed=3, on_s=0.5)
    for name in ("tension_N", "pullroll_N", "unwind_rad", "follower_m_s", "radius_m"):
        assert (getattr(alone, name) == getattr(silent, name)).all()


def test_a_new_roll_shows_its_shape_at_another_angle_of_the_encoder():
    line = spoilt(nominal("tyvek", 0.2032), shape="flat", lead_m=0.0, follower_m=0.0)
    seen = []

    class Watcher:
        def __init__(self, phases):
            self.phases = phases

        def step(self, _inputs):
            seen.append(self.phases["unwind"].theta_rad)
            return ActuatorStep(value=0.0, peak_bound=0.0, slew_bound=0.0)

        def reset_roll(self, roll):
            seen.append(roll)

    roll_id = np.repeat([1, 2], 50)
    run(
        line,
        {"unwind": lambda phases, _: Watcher(phases)},
        np.full(100, 1.0),
        seed=None,
        on_s=0.0,
        roll_id=roll_id,
    )
    assert seen.index("unwind") == 50


def test_back_after_a_transient_is_counted_in_turns():
    time_s = np.arange(0.0, 60.0, 0.005)
    angle = 2.0 * math.tau * time_s / 4.0
    ripple = np.sin(angle)
    blank = np.zeros_like(time_s)

    def record(tension):
        return Recording(
            time_s=time_s,
            tension_N=tension,
            pullroll_N=blank,
            follower_m_s=blank,
            unwind_rad=angle,
            follower_rad=angle,
            radius_m=blank,
            speed_m_s=blank,
            correction_m_s=np.zeros((1, time_s.size)),
        )

    left = ripple * np.where((time_s > 30.0) & (time_s < 36.0), 1.0, 0.05)
    found = score_transient(record(left), record(ripple), 30.0, 30.0)
    assert found["before"] == pytest.approx(0.05, rel=0.01)
    assert found["worst_2s"] == pytest.approx(1.0, rel=0.01)
    assert found["back_turns"] == pytest.approx(4.0)  # the window from 6 to 10 s, at its middle


@pytest.mark.parametrize("law", ["blocks", "shape"])
@pytest.mark.sweep(every=2)
def test_no_container_of_a_law_grows_whatever_happens(law, monkeypatch):
    """What hangs on the law, and its bytes, after N and after 2 N ticks of events."""
    two = partial(nominal_loop, radii_m=(RADII_M[0], RADII_M[-1]))  # of six: any P does
    monkeypatch.setattr("benchmarks.control.laws.nominal_loop", two)
    blocks = plain_blocks("tyvek", CYCLE_S, 4, 6.0)
    line = Eventful(shape_law("tyvek", orders=4) if law == "shape" else blocks)
    wish = np.zeros(ROUND_TICKS)

    def after(rounds):
        for _ in range(rounds):
            for k in range(ROUND_TICKS):
                line.prepare()
                wish[k] = line.step().value
        return footprint(line)

    first = after(1)
    splices = line.splices
    assert after(1) == first
    assert (splices, line.splices) == (0, 1)
    # it crawled (gate shut) and it corrected
    assert (wish[1280:1300] == 0.0).all()
    assert np.abs(wish[:1000]).max() > 0.0


@pytest.mark.parametrize("rotation", ["ccw", "cw"])
def test_the_laws_gravity_of_a_shape_is_the_lines(rotation):
    """An eccentric roll: arm by drawing its circle, torque by the line model, ratio by the law."""
    line = nominal("tyvek", 0.2)
    roll = line.rollers[0].model_copy(update={"rotation": rotation})
    line = line.model_copy(update={"rollers": (roll, *line.rollers[1:])})
    sense = 1 if rotation == "ccw" else -1
    offset_m, at_rad = 1e-3, 0.4
    density, width, core = line.web.density_kg_m3, line.web.width_m, line.initial_radii_m.core
    mass_kg = density * width * math.pi * (0.2**2 - core**2)
    mass = WoundMass(
        mass_kg=mass_kg, offset_m=offset_m, offset_angle_rad=at_rad, inertia_kg_m2=1.0
    )
    along = math.radians(line.spans[0].direction_deg)
    theta = np.arange(64) * math.tau / 64
    center = offset_m * np.exp(1j * sense * (theta + at_rad))
    # where a circle turning this way has the web's direction: a quarter turn behind it
    outwards = np.exp(1j * (along - sense * 0.5 * math.pi))
    arm = 0.2 + (center * np.conj(outwards)).real
    torque = np.array([gravity_torque_N_m(mass, float(t), sense) for t in theta])
    first = np.exp(-1j * theta)
    ratio = (torque @ first) / (arm @ first)
    drive = replace(drive_of("tyvek"), web_leaves_rad=web_leaves_rad(line))
    assert drive.weight_of_shape_N(0.2) == pytest.approx(ratio, rel=1e-3)
