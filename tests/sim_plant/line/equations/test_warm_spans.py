"""Heated spans: how warm the web is, what that does to tension, and to the next span."""

import numpy as np
import pytest

from sim_plant.elements.web_climate import leaving_value
from sim_plant.line.rest.operating_point import steady_line
from tests.sim_plant.line.bodies import SPEED_M_S, TENSION_N, coater, declared_anew, exact_coater
from tests.sim_plant.line.lines import declared, exact_line, hold

EXPANSION_1_K, EXCHANGE_S, LENGTH_M = 2e-5, 1.5, 2.0
OVEN = 5  # the span R3-R4


def one_zone(air_K=60.0):
    oven = coater().heated_spans[0].model_copy(update={"warming_K": (air_K,)})
    return coater(heated_spans=(oven,))


def parts(line, span):
    """Return the warming of the parts of a span now, K."""
    first, count = (line.arrays.spans[name][span] for name in ("heat_first", "heat_parts"))
    return line.state.y[line.layout.heat + first : line.layout.heat + first + count]


def end_K(line, span, speed_m_s):
    """Return the warming of the web that leaves a span of one zone."""
    warm = parts(line, span)
    j = line.arrays.spans["heat_first"][span] + warm.size - 1
    renewal = warm.size * speed_m_s / line.lengths_m[span]
    return leaving_value(
        warm[-1],
        *(float(line.arrays.heats[n][j]) for n in ("air_K",)),
        renewal,
        float(line.arrays.heats["time_s"][j]),
    )


@pytest.mark.parametrize("speed_m_s", [0.2, 2.0, 5.0])
def test_web_leaves_an_oven_as_warm_as_its_time_in_it_makes_it(speed_m_s):
    """W = W_air (1 - exp(-L / (v tau))), at any speed, however many parts."""
    line = exact_coater(one_zone(), settle_s=0.0)
    for _ in range(round(8.0 / line.sample_time_s)):
        line.step({"line_speed_ref_m_s": speed_m_s})
    wanted = 60.0 * (1.0 - np.exp(-LENGTH_M / (speed_m_s * EXCHANGE_S)))
    v = line.state.y[line.layout.omega + OVEN] * 0.04
    assert end_K(line, OVEN, v) == pytest.approx(wanted, rel=2e-3)


def test_a_change_of_speed_passes_with_the_web():
    """The exact profile follows each piece of web: its time in the oven, by characteristics."""
    line = exact_coater(one_zone(), settle_s=6.0)
    step_s, found, speeds = line.sample_time_s, [], []
    for _ in range(900):
        line.step({"line_speed_ref_m_s": 1.0})
        speeds.append(line.state.y[line.layout.omega + OVEN] * 0.04)
        found.append(end_K(line, OVEN, speeds[-1]))
    travel = np.concatenate((np.arange(-400, 0) * step_s * SPEED_M_S, np.cumsum(speeds) * step_s))
    time = np.arange(-400, 900) * step_s
    inside = time[400:] - np.interp(travel[400:] - LENGTH_M, travel, time)
    exact = 60.0 * (1.0 - np.exp(-inside / EXCHANGE_S))
    rise = exact[-1] - exact[0]
    assert rise > 10.0
    assert np.abs(np.array(found) - exact).max() < 0.13 * rise  # eight parts smooth the corner
    assert found[-1] == pytest.approx(exact[-1], rel=2e-3)


def test_tension_between_two_speeds_follows_from_what_passes():
    """v_A (1 + eps_end) = v_B (1 + eps_up): draw = strains at the ends [source 2.14, 2.20]."""
    line = exact_coater(settle_s=10.0)
    tensions = hold(line, 0.1, SPEED_M_S, TENSION_N)["span_tension_N"][-1]
    y, lay, EA_N = line.state.y, line.layout, 60000.0
    before = tensions[3] / EA_N  # web before the infeed is as cold as on the unwind
    last = 7  # R5-pull_roll
    after = tensions[last] / EA_N + EXPANSION_1_K * end_K(line, last, y[lay.omega + last] * 0.04)
    infeed, pull = y[lay.omega + 4] * 0.1, y[lay.omega + 8] * 0.08
    assert pull / infeed == pytest.approx((1.0 + after) / (1.0 + before), rel=1e-9)
    cold = steady_line(coater(heated_spans=()), SPEED_M_S, TENSION_N)
    fall = EA_N * cold.strain[last] - tensions[last]
    assert fall == pytest.approx(EA_N * EXPANSION_1_K * 25.0, rel=0.05)  # some 25 K, 30 N


@pytest.mark.parametrize("line", ["euclid", "film"])
def test_an_oven_at_the_webs_temperature_is_a_plain_span(line):
    plain = declared(line)
    span = plain.spans[5]
    web = plain.web.model_dump() | {"thermal_expansion_1_K": 2e-5}
    oven = {
        "name": "o",
        "start": span.start,
        "end": span.end,
        "warming_K": [0.0],
        "exchange_s": 1.0,
    }
    warm = declared_anew(plain, heated_spans=[oven], web=web)
    found = []
    for each in (plain, warm):
        run = exact_line(each, frozen=False, settle_s=1.0)
        point = each.operating_point
        speed = point.line_speed_m_s * np.linspace(1.0, 1.1, 200)
        found.append(run.simulate(speed, np.full(200, point.tension_N))["span_tension_N"])
    assert np.ptp(found[0], axis=0).max() > 0.1
    assert np.abs(found[1] - found[0]).max() < 1e-8


def test_heat_is_conserved_from_oven_to_room():
    """What flows in less what flows out is what the surroundings gave, at rest [own balance]."""
    line = exact_coater(settle_s=30.0)
    y, spans, heats = line.state.y, line.arrays.spans, line.arrays.heats
    given = 0.0
    for i in np.flatnonzero(spans["heat_parts"]):
        warm = parts(line, i)
        j = slice(spans["heat_first"][i], spans["heat_first"][i] + warm.size)
        speed = y[line.layout.omega + i] * line.arrays.bodies["radius_m"][i]
        each_s = line.lengths_m[i] / (warm.size * speed)
        given += np.sum((heats["air_K"][j] - warm) / heats["time_s"][j]) * each_s
    last = line.layout.n - 2
    speed = y[line.layout.omega + last] * 0.04
    assert end_K(line, last, speed) == pytest.approx(given, rel=1e-4)
    assert given > 15.0


def test_warmth_of_the_end_stays_between_that_of_the_web_and_of_the_air():
    assert leaving_value(20.0, 60.0, 0.0, 1.5) == 60.0  # the web stands
    assert leaving_value(20.0, 60.0, 1e9, 1.5) == pytest.approx(20.0, abs=1e-6)
    assert 20.0 < leaving_value(20.0, 60.0, 1.0, 1.5) < 60.0
