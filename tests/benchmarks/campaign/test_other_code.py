"""The campaign's generator is other code than the product, and says the same of the same line."""

import ast
from pathlib import Path

import numpy as np
import pytest

import benchmarks.campaign
from benchmarks.campaign import line as short
from benchmarks.campaign.effects import NAMES, Fault
from benchmarks.campaign.machine import machine_of
from benchmarks.campaign.make import floors
from benchmarks.campaign.record import References, simulate
from benchmarks.campaign.stage import rms, with_faults
from sim_plant.line.declaration import Declaration, EffectEntry
from sim_plant.line.open import make_line

SAMPLES = 2400
FLAT = {"shape": "orders", "gravity": 0.0}
pytestmark = pytest.mark.timeout(300)  # compiling takes half a minute on a busy machine


def told():
    time_s = np.arange(SAMPLES) * short.SAMPLE_S
    speed = np.interp(time_s, [0.0, 16.0, 18.0, 24.0], [0.9, 0.9, 1.4, 1.4])
    return References(speed_m_s=speed, tension_N=np.where(time_s < 20.0, 89.0, 94.0))


def theirs(*effects):
    declared = Declaration.model_validate(short.declaration())
    run = make_line(
        declared.model_copy(update={"effects": effects}), seed=None, speed_m_s=0.9, tension_N=89.0
    )
    run.settle(90.0)  # it starts where the line without effects rests
    return run.simulate(told().speed_m_s, told().tension_N)


def ours(*faults, noise=False):
    nominal = machine_of(short.declaration(), np.random.default_rng(0), 0.0)
    return simulate(with_faults(nominal, faults), told(), np.zeros(9), 1, noise=noise)


@pytest.fixture(scope="module")
def healthy():
    quiet = ours().even()
    return quiet, theirs(), floors(ours(noise=True).even(), quiet)


def imported(path):
    """Return the modules that a file imports."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        names = [a.name for a in node.names] if isinstance(node, ast.Import) else []
        names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
        found |= {n for n in names if n.startswith(("sim_plant", "aff_runtime", "benchmarks"))}
    return found


def test_only_one_module_knows_the_product_and_only_its_command_line():
    folder = Path(benchmarks.campaign.__file__).parent
    found = {(path.stem, name) for path in folder.glob("*.py") for name in imported(path)}
    own = {row for row in found if row[1].startswith("benchmarks.campaign")}
    assert found - own == {
        ("refine_runs", "sim_plant.cli.main"),
        # places on disk, worker processes and row files: no physics
        ("jit", "sim_plant.base.cache_folder"),
        ("jit", "sim_plant.base.numba_alone"),
        ("__main__", "benchmarks.workers"),
        ("__main__", "benchmarks.rows"),
    }
    assert imported(folder.parent / "workers.py") == {
        "sim_plant.base.worker_pool",
        "sim_plant.fleet.cluster",
    }
    assert imported(folder.parent / "rows.py") == {"aff_runtime.base.files"}


@pytest.mark.campaign
def test_a_healthy_line_is_the_same_to_a_tenth_of_the_noise(healthy):
    quiet, other, floor = healthy
    for name in (*short.CELLS, *short.SPEEDS, "unwind_radius_m"):
        assert rms(quiet[name] - other[name]) < 0.1 * floor[name], name
    for name in short.ANGLES:  # sums of speed over 24 s: 150 rad to a quarter of a count
        assert rms(quiet[name] - other[name]) < 0.25 * short.ANGLE_LSB, name


# the product counts angles from row 0, the generator from before it settled
CASES = [
    (
        Fault(effect="eccentric_roller", location="R2", size=2e-4, angle=0.7),
        lambda f, t: {"eccentricity_m": f.size, "angle_rad": f.angle + t},
    ),
    (
        Fault(effect="eccentric_roller", location="swrap", size=2e-4, angle=0.7),
        lambda f, t: {"eccentricity_m": f.size, "angle_rad": f.angle + t},
    ),
    (
        Fault(effect="out_of_round_roll", location="unwind", size=6e-3, angle=0.7),
        lambda f, t: {
            "shape": "flat",
            "gravity": 0.0,
            "size_m": f.size,
            "angle_rad": f.angle + t,
            "formed_radius_m": 0.8 * 0.18,
        },
    ),
    (
        Fault(effect="out_of_round_roll", location="rewind", size=5e-4, angle=0.7, shape=2.0),
        lambda f, t: (
            FLAT
            | {
                "cos2_m": f.size * np.cos(f.angle + 2 * t),
                "sin2_m": f.size * np.sin(f.angle + 2 * t),
                "cos3_m": f.size / 3 * np.cos(2 * f.angle + 3 * t),
                "sin3_m": f.size / 3 * np.sin(2 * f.angle + 3 * t),
            }
        ),
    ),
    (
        Fault(effect="unbalanced_roller", location="swrap", size=0.05, angle=0.7),
        lambda f, t: {"unbalance_kg_m": f.size, "angle_rad": f.angle + t},
    ),
    (
        Fault(effect="unbalanced_measuring_roller", location="R5", size=1e-3, angle=0.7),
        lambda f, t: {"unbalance_kg_m": f.size, "angle_rad": f.angle - t},
    ),
    (
        Fault(effect="torque_ripple", location="swrap", size=0.5, angle=0.7, shape=6.0),
        lambda f, t: {
            "order": 6.0,
            "cos_N_m": f.size * np.cos(f.angle - 6 * t),
            "sin_N_m": f.size * np.sin(f.angle - 6 * t),
        },
    ),
    (Fault(effect="bearing_drag", location="R3", size=0.03), lambda f, t: {"constant_N_m": 0.03}),
    (Fault(effect="web_modulus", location="web", size=-0.1), lambda f, t: {"factor": 0.9}),
    (
        Fault(effect="thermal_strain", location="pull_roll_zone", size=2e-4),
        lambda f, t: {"strain": f.size},
    ),
    (
        Fault(effect="slip", location="swrap", size=2e-3, shape=0.8),
        lambda f, t: {"slope_s_m": f.size, "threshold_m_s": 0.8},
    ),
    (Fault(effect="load_cell_filter", location="R2", size=0.03), lambda f, t: {"lag_s": 0.03}),
    (Fault(effect="loop_delay", location="unwind", size=0.03), lambda f, t: {"delay_s": 0.03}),
    (
        Fault(effect="encoder_eccentricity", location="swrap", size=1e-3, angle=0.7, shape=1.0),
        lambda f, t: {"loop_share": 1.0, "eccentricity": f.size, "angle_rad": f.angle - t},
    ),
]


@pytest.mark.campaign
@pytest.mark.parametrize(
    ("fault", "parameters"), CASES, ids=[f"{f.effect}-{f.location}-{f.shape:g}" for f, _ in CASES]
)
def test_an_effect_does_the_same_in_both_codes(healthy, fault, parameters):
    quiet, other, floor = healthy
    run = ours(fault)
    body = NAMES.index(fault.location) if fault.location in NAMES else 0
    entry = EffectEntry(
        effect=fault.effect,
        location=fault.location,
        parameters=parameters(fault, float(run.start_rad[body])),
    )
    here, there = run.even(), theirs(entry)
    own = {c: here[c] - quiet[c] for c in (*short.CELLS, *short.SPEEDS)}
    far = {c: there[c] - other[c] for c in own}
    # where it is strongest; elsewhere it may be smaller than what the codes differ by anyway
    name = max(own, key=lambda c: rms(own[c]) / floor[c])
    assert rms(own[name]) > 0.2 * floor[name]
    assert rms(own[name] - far[name]) < 0.03 * rms(own[name]), name
