"""The blind simulator is other code than the product, and says the same of the same line."""

import ast
from pathlib import Path

import numpy as np
import pytest

import benchmarks.blind
from benchmarks.blind.cases import changed, drawn, kinds, put
from benchmarks.blind.changed import CHANGED, NUMBERS
from benchmarks.blind.effects import Hidden, outline, tangents
from benchmarks.blind.line import CELLS, NAMES, SPEEDS, WEBS, WOUND_N, centres, declaration
from benchmarks.blind.machine import Scatter, Told, machine, simulate
from benchmarks.blind.table import TABLE
from sim_plant.line.declared.declaration import Declaration, EffectEntry
from sim_plant.line.open import make_line

ROWS = 4400
JUDGED = slice(2000, None)
LINE = declaration(WEBS[0], centres(np.random.default_rng(3)), (0.16, 0.15))
for row in LINE["sensors"]:  # without noise the product reads a coarse word's mean, not ours
    if "lsb_rad_s" in row:
        row["lsb_rad_s"] = 5e-4
CHANNELS = (*CELLS, *SPEEDS)
BEGINS = {"from_record_time_s": {"a": 24.0}}
WOUND_STRAIN = WOUND_N / LINE["web"]["EA_N"]


def told():
    time_s = np.arange(ROWS + 1) * 0.01
    speed = np.interp(time_s, [0.0, 32.0, 34.0, 44.0], [0.9, 0.9, 1.2, 1.2])
    return Told(speed_m_s=speed, tension_N=np.where(time_s[:-1] < 29.0, 89.0, 94.0))


def theirs(*effects):
    declared = Declaration.model_validate(LINE)
    run = make_line(
        declared.model_copy(update={"effects": effects}), seed=None, speed_m_s=0.9, tension_N=89.0
    )
    if any(effect.effect == "roll_bounce" for effect in effects):
        run.settle(8.0)  # the others start at rest
    return run.simulate(told().speed_m_s[:-1], told().tension_N)


def ours(*hidden, noise=False):
    p = machine(LINE, Scatter(np.random.default_rng(0), 0.0))
    for one in hidden:
        p = put(p, one, "a")
    return simulate(p, LINE, told(), np.zeros(len(NAMES)), 1, noise=noise)


def rms(values):
    return float(np.sqrt(np.mean(np.square(values[JUDGED]))))


@pytest.fixture(scope="module")
def healthy():
    quiet, noisy = ours(), ours(noise=True)
    return quiet, theirs(), {name: rms(noisy[name] - quiet[name]) for name in CHANNELS}


def imported(path):
    """Return the modules of the product, and of the other generator, that a file imports."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        names = [a.name for a in node.names] if isinstance(node, ast.Import) else []
        names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
        found |= {
            n for n in names if n.startswith(("sim_plant", "aff_runtime", "benchmarks.campaign"))
        }
    return found


def test_no_module_knows_the_product_but_for_where_compiled_code_is_kept():
    folder = Path(benchmarks.blind.__file__).parent
    found = {(path.stem, name) for path in folder.glob("*.py") for name in imported(path)}
    assert found == {("jit", "benchmarks.campaign.jit")}


def test_every_effect_is_dealt_before_any_comes_again():
    cases = drawn(40, 7)
    hidden = [h.effect for case in cases if case.kind in ("pair", "single") for h in case.hidden]
    assert [case.kind for case in cases] == kinds(40)
    assert len(hidden) == 2 * 16 + 18
    counts = [hidden.count(name) for name in TABLE]
    assert min(counts) >= 2
    assert max(counts) <= 3
    assert all(len({h.effect for h in case.hidden}) == len(case.hidden) for case in cases)


def test_every_number_is_changed_before_any_comes_again():
    hidden = [case.hidden[0] for case in changed(2 * len(NUMBERS), 7)]
    paths = [h.location for h in hidden]
    assert set(paths[: len(NUMBERS)]) == set(NUMBERS)
    assert sorted(paths) == sorted([*NUMBERS, *NUMBERS])
    assert {"a"} < {r for h in hidden for r in h.parameters["from_record_time_s"]}


def test_a_flat_is_as_deep_as_drawn_and_its_corner_keeps_the_web_off():
    h, slope, curvature = tangents(outline(0.16, "flat", 0.01))
    half = np.arccos(1.0 - 0.01 / 0.16)
    share = h.size // 36  # 10 degrees from the middle of the flat: the tangent is on its corner
    psi = 2.0 * np.pi * share / (h.size - 1)
    assert h[share] == pytest.approx(0.16 * np.cos(half - psi), abs=2e-5)
    assert h[(h.size - 1) // 2] == pytest.approx(0.16, abs=2e-5)
    assert np.trapezoid(curvature) == pytest.approx(np.trapezoid(h), rel=1e-9)
    assert slope[share] == pytest.approx(0.16 * np.sin(half - psi), abs=1e-4)


@pytest.mark.long
def test_a_healthy_line_is_the_same_to_a_tenth_of_the_noise(healthy):
    quiet, other, floor = healthy
    for name in CHANNELS:
        assert rms(quiet[name] - other[name]) < 0.1 * floor[name], name


# the product counts angles from row 0, this one from before it settled
CASES = [
    (
        Hidden(effect="eccentric_roller", location="R6", parameters={"eccentricity_m": 2e-4}),
        lambda t: {"eccentricity_m": 2e-4, "angle_rad": t},
    ),
    (
        Hidden(
            effect="out_of_round_roll",
            location="unwind",
            parameters={"shape": "flat", "size_m": 8e-3},
            angle=0.7,
        ),
        lambda t: {
            "shape": "flat",
            "size_m": 8e-3,
            "angle_rad": 0.7 + t,
            "smoothing_rad": 0.0121,  # with the 0.7 degrees of the product's hull 1 degree
            "finest_order": 64.0,
        },
    ),
    (
        Hidden(effect="unbalanced_roller", location="R6", parameters={"imbalance_kg_m": 2e-3}),
        lambda t: {"unbalance_kg_m": 2e-3, "angle_rad": t},
    ),
    (
        Hidden(
            effect="bearing_drag", location="R6", parameters={"added_torque_N_m": 0.05, **BEGINS}
        ),
        lambda t: {"constant_N_m": 0.05, "from_s": 24.0},
    ),
    (
        Hidden(
            effect="torque_ripple",
            location="swrap_lead",
            parameters={"amplitude_N_m": 1.0, "order": 6},
        ),
        lambda t: {"order": 6.0, "cos_N_m": np.cos(6 * t), "sin_N_m": -np.sin(6 * t)},
    ),
    (
        Hidden(
            effect="thermal_strain",
            location="unwind_zone",
            parameters={"strain": 4e-4, "rise_s": 1.0, "hold_s": 6.0, **BEGINS},
        ),
        lambda t: {"strain": 4e-4, "from_s": 24.0, "rise_s": 1.0, "hold_s": 6.0},
    ),
    (
        Hidden(
            effect="splice",
            location="web",
            parameters={"step_m": 5e-4, "length_m": 0.08, "record_time_s": {"a": 24.0}},
        ),
        lambda t: {
            "step_m": 5e-4,
            "piece_m": 0.08,
            "at_length_m": 24.0 * 0.9 / (1.0 + 89.0 / LINE["web"]["EA_N"]),
        },
    ),
    (
        Hidden(
            effect="rate_limit",
            location="unwind",
            parameters={"limit_m_s2": 0.1, "of": "correction"},
        ),
        lambda t: {"slew_m_s2": 0.1, "limits": "correction"},
    ),
    (
        Hidden(effect="loop_delay", location="unwind", parameters={"delay_s": 0.06}),
        lambda t: {"delay_s": 0.06},
    ),
    (
        Hidden(effect="load_cell_filter", location="R9", parameters={"corner_Hz": 3.0}),
        lambda t: {"corner_Hz": 3.0},
    ),
    (
        Hidden(
            effect="load_cell_calibration",
            location="R3",
            parameters={"gain": 1.04, "offset_N": -1.5},
        ),
        lambda t: {"gain": 1.04, "offset_N": -1.5},
    ),
    (
        Hidden(
            effect="load_cell_resonance",
            location="R3",
            parameters={"frequency_Hz": 3.0, "damping_ratio": 0.02},
        ),
        lambda t: {"frequency_Hz": 3.0, "damping": 0.02},
    ),
    (
        Hidden(
            effect="mains_hum",
            location="R9",
            parameters={"amplitude_N": 1.0, "frequency_Hz": 49.7},
            angle=0.7,
        ),
        lambda t: {"frequency_Hz": 49.7, "amplitude_N": 1.0, "phase_rad": 0.7},
    ),
    (
        Hidden(effect="radius_error", location="unwind", parameters={"relative": 5e-3}),
        lambda t: {"ratio": 1.005},
    ),
    (
        Hidden(effect="wound_in_strain", location="unwind", parameters={"factor": 0.6}),
        lambda t: {"strain": -0.4 * WOUND_STRAIN},
    ),
    (
        Hidden(effect="web_modulus", location="web", parameters={"factor": 0.8}),
        lambda t: {"factor": 0.8},
    ),
    (
        Hidden(
            effect="viscoelastic_web",
            location="web",
            parameters={"branch_fraction": 0.3, "relaxation_s": 0.3},
        ),
        lambda t: {"ratio": 0.3, "time_s": 0.3},
    ),
    (
        Hidden(
            effect="roll_bounce",
            location="unwind",
            parameters={
                "frequency_Hz": 3.0,
                "mass_kg": 20.0,
                "order": 3,
                "damping": 0.06,
                "unbalance_kg_m": 0.05,
            },
        ),
        lambda t: {
            "frequency_Hz": 3.0,
            "mass_kg": 20.0,
            "order": 3.0,
            "damping": 0.06,
            "cosn_kg_m": 0.05 * np.cos(3 * t),
            "sinn_kg_m": -0.05 * np.sin(3 * t),
            "cos1_kg_m": 0.025 * np.cos(t),
            "sin1_kg_m": -0.025 * np.sin(t),
        },
    ),
    (
        Hidden(
            effect="shaft_compliance_backlash",
            location="unwind",
            parameters={"stiffness_N_m_rad": 100.0, "gap_rad": 0.004},
        ),
        lambda t: {"compliance_rad_N_m": 0.01, "backlash_rad": 0.004},
    ),
]


def test_every_effect_drawn_at_one_place_is_held_against_the_other_code():
    assert {hidden.effect for hidden, _ in CASES} == {*TABLE} - {"slip"}


@pytest.mark.long
@pytest.mark.parametrize(("hidden", "parameters"), CASES, ids=[h.effect for h, _ in CASES])
def test_an_effect_does_the_same_in_both_codes(healthy, hidden, parameters):
    assert_same(healthy, [hidden], lambda t: [(hidden.location, parameters(t))])


@pytest.mark.long
def test_slip_on_both_rollers_of_the_s_wrap_does_the_same_in_both_codes(healthy):
    numbers = {"creep_per_m_s": 2e-3, "above_m_s": 0.8}
    hidden = Hidden(effect="slip", location="swrap", parameters=numbers)
    told_to = {"slope_s_m": 2e-3, "threshold_m_s": 0.8}
    places = ("swrap_lead", "swrap_follower")
    assert_same(healthy, [hidden], lambda _t: [(place, told_to) for place in places])


@pytest.mark.long
@pytest.mark.parametrize("path", NUMBERS)
def test_a_number_that_changes_at_a_moment_does_the_same_in_both_codes(healthy, path):
    size = NUMBERS[path][-1]
    hidden = Hidden(effect=CHANGED, location=path, parameters={"change": size, **BEGINS})
    assert_same(healthy, [hidden], lambda _t: [(path, {"change": size, "from_s": 24.0})])


def assert_same(healthy, hidden, entries):
    quiet, other, floor = healthy
    here = ours(*hidden)
    place = hidden[0].location
    turned = float(here["start_rad"][NAMES.index(place) if place in NAMES else 0])
    effects = [
        EffectEntry(effect=hidden[0].effect, location=where, parameters=parameters)
        for where, parameters in entries(turned)
    ]
    there = theirs(*effects)
    own = {name: here[name] - quiet[name] for name in CHANNELS}
    name = max(own, key=lambda c: rms(own[c]) / floor[c])
    assert rms(own[name]) > 0.5 * floor[name]
    # a seam is where it is to a millimetre or two, and its edges are 10 mm long
    most = 0.1 if hidden[0].effect == "splice" else 0.03
    assert rms(own[name] - (there[name] - other[name])) < most * rms(own[name]), name
