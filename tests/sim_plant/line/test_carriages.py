"""Dancers and accumulators: where they rest, what they carry, what they leave as it was."""

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.elements.carriage import CREEP_M_S, buffer_force, friction_force
from sim_plant.line.reading.load import consistency
from sim_plant.line.rest.operating_point import steady_line
from tests.sim_plant.line.bodies import (
    SPEED_M_S,
    TENSION_N,
    circles,
    coater,
    declared_anew,
    exact_coater,
)
from tests.sim_plant.line.lines import declared, exact_line, hold, with_effect

GRAVITY_M_S2 = 9.80665


@pytest.fixture(scope="module")
def rested():
    """The line after 4 s, and its span tensions."""
    line = exact_coater()
    tensions = hold(line, 0.1, SPEED_M_S, TENSION_N)["span_tension_N"][-1]
    return line, tensions


def named(line, start):
    """Return the index of the span that leaves a roller."""
    return [span.start for span in line.declaration.spans].index(start)


def test_a_dancer_at_rest_has_tensions_that_balance_load_and_weight(rested):
    """(T_in + T_out) arm = load + weight * arm, both spans square to the arm (own drawing)."""
    line, tensions = rested
    arm_m, load_N_m, weight_N = 0.5, 70.0, 40.0
    both = tensions[named(line, "R1")] + tensions[named(line, "D1")]
    assert both == pytest.approx(load_N_m / arm_m + weight_N, abs=0.02)
    assert abs(line.state.y[line.layout.carriage]) < 1e-5  # where its loop holds it


def test_a_drive_carries_what_lift_weight_and_four_spans_leave(rested):
    line, tensions = rested
    first = named(line, "A0")
    wanted = 40.0 * GRAVITY_M_S2 + tensions[first : first + 4].sum() - 750.0
    assert line.state.carriage_force_N[1] == pytest.approx(wanted, abs=0.05)


def test_a_line_starts_where_it_rests(rested):
    line, _tensions = rested
    rest = steady_line(coater(), SPEED_M_S, TENSION_N)
    lay, y = line.layout, line.state.y
    assert y[lay.strain : lay.strain + lay.n - 1] == pytest.approx(rest.strain, rel=2e-5)
    started = exact_coater(settle_s=0.0)
    run = hold(started, 5.0, SPEED_M_S, TENSION_N)["span_tension_N"][1:]
    assert np.ptp(run, axis=0).max() < 0.02


def test_a_dancer_that_leans_on_a_spring_rests_where_the_forces_say():
    """Linear, two spans along its travel: 2 T = F - k s - M g sin(direction) [virtual work]."""
    dancer = {
        "name": "dancer",
        "kind": "linear",
        "rollers": ["D1"],
        "mass_kg": 6.0,
        "direction_deg": -90.0,
        "load_N": 160.0,
        "stiffness_N_m": 4000.0,
        "damping_N_s_m": 80.0,
        "travel_m": [-0.2, 0.2],
    }
    base = coater()
    control = base.control.model_copy(update={"position_pi": ()})
    line = declared_anew(base.model_copy(update={"control": control}), dancers=[dancer])
    run = exact_coater(line)
    tensions = hold(run, 0.1, SPEED_M_S, TENSION_N)["span_tension_N"][-1]
    travel = run.state.y[run.layout.carriage]
    both = tensions[named(run, "R1")] + tensions[named(run, "D1")]
    assert both == pytest.approx(160.0 - 4000.0 * travel + 6.0 * GRAVITY_M_S2, rel=1e-5)
    assert abs(travel) > 1e-3


def locked(roller: str, **more):
    """Return the shipped Euclid line with a roller on a carriage that nothing moves."""
    line = declared("euclid")
    dancer = {
        "name": "locked",
        "kind": "linear",
        "rollers": [roller],
        "mass_kg": 1e9,
        "weight_N": 0.0,
        "direction_deg": 40.0 if roller == "R5" else 220.0,  # away from where the web pulls
        "load_N": 0.0,
        "stiffness_N_m": 1e13,
        "travel_m": [-0.1, 0.1],
    } | more
    return declared_anew(line, dancers=[dancer])


@pytest.mark.parametrize("roller", ["R4", "R5"])
def test_a_locked_dancer_is_an_idler(roller):
    speed = np.concatenate((np.full(100, 1.016), np.linspace(1.016, 1.3, 300)))
    tension = np.where(np.arange(400) < 200, 88.9644, 95.0)
    turned = locked(roller)
    assert consistency(turned) == []
    found = []
    for line in (declared("euclid"), turned):
        run = exact_line(with_effect(line, "eccentric_roller", roller, eccentricity_m=2e-4))
        found.append(run.simulate(speed, tension)["span_tension_N"])
    moved = np.ptp(found[0], axis=0).max()
    assert moved > 5.0
    assert np.abs(found[1] - found[0]).max() < 1e-6 * moved


def test_an_accumulator_that_stands_is_its_spans():
    standing = (
        coater()
        .accumulators[0]
        .model_copy(update={"mass_kg": 1e8, "weight_N": 0.0, "lift_N": 360.0})
    )
    with_it, without = coater(accumulators=(standing,)), coater(accumulators=(), sensors=())
    runs = []
    for line in (with_it, without):
        sensors = tuple(s for s in coater().sensors if s.channel != "accumulator_position_m")
        run = exact_coater(line.model_copy(update={"sensors": sensors}))
        speed = np.linspace(SPEED_M_S, 2.2, 400)
        runs.append(run.simulate(speed, np.full(400, TENSION_N))["span_tension_N"])
    assert np.ptp(runs[1], axis=0).max() > 1.0
    assert np.abs(runs[0] - runs[1]).max() < 1e-4


def test_a_carriage_that_moves_takes_its_speed_times_its_spans_from_the_rewind():
    """v_out = v_in - N V at one tension [Pagilla, Singh, Dwivedula 2004]: four spans here."""
    line = exact_coater()
    lay, y = line.layout, line.state.y
    before = y[lay.omega + lay.n - 1] * y[lay.radius + 1]
    for k in range(1600):
        line.step({"travel_accumulator_m_s": 0.02 * min(1.0, k / 400)})
    slower = before - y[lay.omega + lay.n - 1] * y[lay.radius + 1]
    assert y[lay.carriage + 3] == pytest.approx(0.02, rel=1e-3)
    assert slower == pytest.approx(4 * 0.02, rel=2e-3)


def test_a_schedule_moves_the_carriage_as_far_as_it_says():
    moves = ({"from_s": 0.5, "rise_s": 1.0, "until_s": 2.5, "speed_m_s": 0.02},)
    given = coater().accumulators[0].model_dump(exclude_none=True) | {"schedule": moves}
    line = exact_coater(declared_anew(coater(), accumulators=[given]))
    run = hold(line, 10.0, SPEED_M_S, TENSION_N)
    travel = run["true_accumulator_position_m"]
    assert travel[-1] - travel[0] == pytest.approx(0.02 * 2.0, abs=2e-4)
    assert np.abs(travel[:90] - travel[0]).max() < 1e-5


def test_a_stop_holds_a_dancer_that_is_pushed_beyond_it():
    free = coater().dancers[0].model_copy(update={"load_N_m": 200.0})
    line = coater(dancers=(free,))
    run = exact_coater(line, settle_s=0.0)
    travel = hold(run, 20.0, SPEED_M_S, TENSION_N)["true_dancer_position_m"]
    assert travel.max() < 0.15 + 0.02


def test_friction_and_stops_have_the_sign_that_opposes():
    assert friction_force(5.0, 10.0, 1.0) == pytest.approx(15.0)
    assert friction_force(5.0, 10.0, -CREEP_M_S) == pytest.approx(-5.0 * np.tanh(1.0) - 0.05)
    assert buffer_force(2.0, -0.1, 0.1, 0.05, 3.0) == 0.0
    assert buffer_force(2.0, -0.1, 0.1, 0.11, 0.0) == pytest.approx(-2.0 * 100.0**2 * 0.01)
    assert buffer_force(2.0, -0.1, 0.1, -0.11, 0.0) == pytest.approx(2.0 * 100.0**2 * 0.01)
    assert buffer_force(2.0, -0.1, 0.1, 0.11, -10.0) == 0.0  # a stop does not pull


def test_unstretched_length_is_conserved_while_dancer_and_accumulator_move():
    """Web out of the unwind = web into the rewind + what spans and wraps hold more.

    Of every roller the wrap changes as the spans beside it turn; what it holds has the strain of
    the web that comes [own derivation].
    """
    line = exact_coater(frozen=False)
    lay, y = line.layout, line.state.y
    radius, sigma = line.arrays.bodies["radius_m"], line.arrays.bodies["sigma"]
    expansion, parts = line.arrays.web["expansion_1_K"][0], line.arrays.spans["heat_parts"]
    first = line.arrays.spans["heat_first"]

    def ends():
        """Strain at the end of every span: its mean, more where the end is warmer."""
        found = y[lay.strain : lay.strain + lay.n - 1].copy()
        for i in np.flatnonzero(parts):
            warm = y[lay.heat + first[i] : lay.heat + first[i] + parts[i]]
            j = first[i] + parts[i] - 1
            air, time_s = line.arrays.heats["air_K"][j], line.arrays.heats["time_s"][j]
            speed = y[lay.omega + i] * (y[lay.radius] if i == 0 else radius[i])
            a = circles(line, y)[0][i] / (parts[i] * speed * time_s)
            end = air + (warm[-1] - air) * a / np.expm1(a)
            found[i] += expansion * (end - warm.mean())
        return found

    def held():
        length = circles(line, y)[0]
        return np.sum(length / (1.0 + y[lay.strain : lay.strain + lay.n - 1]))

    start, wrapped, phi, strain = held(), 0.0, circles(line, y)[1], ends()
    drift, more = [], []
    for k in range(400):
        line.step({"travel_accumulator_m_s": 0.06 * min(1.0, k / 200), "line_speed_ref_m_s": 2.1})
        now, turned = ends(), circles(line, y)[1]
        mean = 1.0 + 0.5 * (now + strain)
        inner = sigma[1:-1] * radius[1:-1] * np.diff(turned - phi) / mean[:-1]
        wrapped += np.sum(inner)
        phi, strain = turned, now
        more.append(held() + wrapped - start)
        drift.append(more[-1] - (y[lay.flow] - y[lay.flow + 1]))
    assert max(map(abs, more)) > 0.3
    assert np.ptp(circles(line, y)[1] - phi) == 0.0
    assert max(map(abs, drift)) < 2e-8


def test_a_carriage_of_another_name_or_without_a_drive_is_refused():
    with pytest.raises(PlantError, match="no accumulator 'dancer' with a drive"):
        exact_coater(settle_s=0.0).step({"travel_dancer_m_s": 0.1})
