"""The whole way on a short record of the Euclid line with one effect that is no line in time."""

import json
from pathlib import Path

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.line.declared.declaration import Declaration, EffectEntry
from sim_plant.line.open import make_line
from sim_plant.line.reading.load import load_declaration, load_line
from sim_plant.refine.fit.gauss_newton import gauss_newton_fit, nominal_fit
from sim_plant.refine.fit.objective import declared_objective
from sim_plant.refine.judge.holdout import evaluate
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.model.record_match import twin_of
from sim_plant.refine.model.simulation_pool import SimulationPool
from sim_plant.refine.records.recording import Recording
from sim_plant.refine.report.aff_block import write_block
from sim_plant.refine.report.amend import write_amended
from sim_plant.refine.report.findings import verdict_of
from sim_plant.refine.search.profile_detail import joint_refit
from sim_plant.refine.search.selection import AcceptedEffect, Selection
from tests import quick_yaml
from tests.sim_plant.effects.tracing import settling

LINE_FILE = Path(__file__).parents[3] / "config/lines/euclid.yaml"
SAMPLES = 1200
STEP_S = 0.01


SETTLE_S = 6.0


@pytest.fixture(autouse=True, scope="module")
def settled_shortly():
    """Let the models run as long before their record as the line did before the true one."""
    with settling(SETTLE_S):
        yield


@pytest.fixture(scope="module")
def line():
    data = quick_yaml.safe_load(LINE_FILE.read_text())
    return Declaration.model_validate(data | {"sample_time_s": STEP_S})


@pytest.fixture(scope="module")
def record(line):
    hidden = EffectEntry(
        effect="eccentric_roller",
        location="R6",
        parameters={"eccentricity_m": 3e-4, "angle_rad": 0.7},
    )
    guilty = line.model_copy(update={"effects": (hidden,)})
    speed = np.interp(np.arange(SAMPLES), [0, 600, 800, 1200], [0.9, 0.9, 1.2, 1.2])
    tension = np.full(SAMPLES, 88.9644)
    run = make_line(guilty, seed=3, speed_m_s=0.9, tension_N=88.9644)
    run.settle(SETTLE_S)
    out = run.simulate(speed, tension)
    columns = {"line_speed_ref_m_s": speed, "tension_ref_N": tension}
    columns |= {s.channel: out[s.channel] for s in line.sensors}
    return Recording(path=Path("short.csv"), sha256="abc", sample_time_s=STEP_S, columns=columns)


@pytest.fixture(scope="module")
def fitted(line, record):
    few = {
        "*.gain": 0.0,
        "*.offset": 0.0,
        "control.*": 0.0,
        "*.friction_constant_N_m": 0.0,
        "*.inertia_kg_m2": 0.0,
        "sensors.low_pass_Hz": 0.0,
    }
    own = line.model_copy(update={"tolerances": few})
    twin = twin_of(own, record)
    measured = np.stack([record.columns[c] for c in twin.channels])
    with SimulationPool([twin], 1) as pool:
        objective = declared_objective(pool, [measured])
        nominal = nominal_fit(objective)
        rough = gauss_newton_fit(
            objective,
            [hypothesis(BY_NAME["eccentric_roller"], "R6")],
            [(1e-5, 1e-5)],
            {},
            rounds=3,
        )
        near, right = joint_refit(objective, rough)
        wrong = gauss_newton_fit(
            objective,
            [hypothesis(BY_NAME["unbalanced_roller"], "R12")],
            [(1e-5, 1e-5)],
            {},
            rounds=2,
        )
        judged = evaluate(pool, measured, right.effects, find_angles=False)
    return near, nominal, right, wrong, judged


@pytest.mark.long  # quick: a nip is measured, effects/test_nip_pulse.py
def test_the_effect_is_measured_and_the_rest_is_noise(fitted):
    objective, nominal, right, _, _ = fitted
    cos_m, sin_m = right.values[0]
    assert np.hypot(cos_m, sin_m) == pytest.approx(3e-4, rel=0.05)
    assert np.arctan2(sin_m, cos_m) == pytest.approx(0.7, abs=0.1)
    assert nominal.cost > 2.0 * objective.expected_cost
    assert right.cost == pytest.approx(objective.expected_cost, rel=0.08)


@pytest.mark.long  # quick: the right one is told, effects/test_nip_pulse.py
def test_another_effect_elsewhere_explains_less(fitted):
    _, nominal, right, wrong, _ = fitted
    assert right.cost < wrong.cost < nominal.cost


@pytest.mark.long  # quick: judge/test_frequencies.py
def test_errors_fall_to_the_floor(fitted):
    judged = fitted[-1]
    at = judged.channels.index("unwind_speed_rad_s")
    assert judged.rms_declared[at] > 1.5 * judged.floor[at]
    assert judged.rms_amended[at] < 1.2 * judged.floor[at]


def test_declared_numbers_estimated_anew_are_in_the_error_after(line, record):
    hidden = EffectEntry(
        effect="eccentric_roller",
        location="R6",
        parameters={"eccentricity_m": 3e-4, "angle_rad": 0.7},
    )
    other = line.model_copy(update={"effects": (hidden,), "tolerances": {"*": 0.0}})
    twin = twin_of(other, record)
    measured = np.stack([record.columns[c] for c in twin.channels])
    shift = 0.05  # of the pull-roll draw zone: what a radius 5e-4 off does
    wrong = (("rollers.pull_roll.radius_m", 0.01 * shift),)
    with SimulationPool([twin], 1) as pool:
        plain = evaluate(pool, measured, (), find_angles=False)
        shifted = evaluate(pool, measured, (), wrong, find_angles=False)
    at = plain.channels.index("pullroll_tension_N")
    # a pull roll larger by 5e-4 draws the web by as much: EA times it in tension
    risen = np.mean(shifted.amended[at, shifted.first :] - plain.amended[at, plain.first :])
    assert risen == pytest.approx(line.web.EA_N * 5e-4, rel=0.05)
    assert shifted.rms_amended[at] > plain.rms_amended[at]


@pytest.mark.long  # quick: report/test_amend.py
def test_the_amended_line_is_read_back_with_effect_and_provenance(fitted, record, tmp_path):
    _, nominal, right, _, judged = fitted
    accepted = AcceptedEffect(
        hypothesis=right.hypotheses[0],
        score=nominal.cost - right.cost,
        runner_up=None,
        margin=100.0,
        rejected=(),
    )
    found = Selection(
        nominal=nominal,
        fit=right,
        record_axes=(),
        spectra_declared=(),
        spectra_left=(),
        accepted=(accepted,),
        adjustments={"web.EA_N": 0.01},
    )
    result = verdict_of(found, judged, "short.csv")
    path = write_amended(
        load_line(LINE_FILE), tmp_path, found, [record], "sim-plant refine", result
    )
    amended = load_declaration(path)
    assert [(e.effect, e.location) for e in amended.effects] == [("eccentric_roller", "R6")]
    assert amended.provenance["records"] == [{"path": "short.csv", "sha256": "abc"}]
    assert amended.corrections == {"web.EA_N": 0.01}
    make_line(amended)
    block = quick_yaml.safe_load(write_block(tmp_path, result.effects).read_text())
    assert block["blocks"][0] | {"roll": "r6", "orders": [1]} == block["blocks"][0]
    row = json.loads(result.to_json())["effects"][0]
    assert row["parameters"]["eccentricity_m"] == pytest.approx(3e-4, rel=0.05)
    low, high = row["interval95"]["eccentricity_m"]
    assert low < 3e-4 < high
