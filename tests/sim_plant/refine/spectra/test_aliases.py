import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.spectra.aliases import (
    origins_Hz,
    whole_orders,
    with_orders,
    with_radii,
    with_resonances,
)
from sim_plant.refine.spectra.coordinates import spectra
from tests.each_case import each_case
from tests.sim_plant.refine.small import axes_at, line_with

LINE = line_with()
LEAD = next(roller for roller in LINE.rollers if roller.name == "swrap_lead")
RIPPLE = hypothesis(BY_NAME["torque_ripple"], "swrap_lead", (("order", 6.0),))


def of_order(order: float):
    """Return coordinates and spectra of a line so many times per turn of the leading roller."""
    axes = axes_at(np.linspace(0.8, 1.2, 6000), LINE)
    rng = np.random.default_rng(2)
    wave = 0.5 * np.cos(order * axes.travel_m / LEAD.radius_m)
    return axes, spectra(axes, rng.standard_normal((2, wave.size)) + wave)


@pytest.mark.parametrize(("order", "expected"), [(9.0, [9]), (17.0, [17]), (9.4, [])])
def test_a_line_is_a_whole_order_of_a_body_or_none(order, expected):
    axes, found = of_order(order)
    assert whole_orders(RIPPLE, [axes], [found]) == expected


def test_an_order_that_no_list_holds_is_one_more_start():
    axes, found = of_order(9.0)
    library = with_orders([RIPPLE], [axes], [found])
    assert [dict(h.fixed)["order"] for h in library] == [6.0, 9.0]
    assert with_orders(library, [axes], [found]) == library


def hum_origins(cycles: float, slow_cycles: float = 0.0):
    """Return where a line of so many cycles in the record may come from, beside a slower one."""
    axes = axes_at(np.linspace(0.8, 1.2, 6000), LINE)
    turns = np.arange(6000) / 5999.0
    rng = np.random.default_rng(2)
    wave = 0.5 * np.cos(2 * np.pi * cycles * turns)
    wave += 2.0 * np.cos(2 * np.pi * slow_cycles * turns) if slow_cycles else 0.0
    hum = hypothesis(BY_NAME["mains_hum"], "all", line=LINE)
    found = spectra(axes, rng.standard_normal((2, wave.size)) + wave)
    return origins_Hz(hum, hum.effect.shows, [axes], [found])


def test_a_slow_change_is_no_alias_of_the_mains_and_hides_none():
    cycle_Hz = 1.0 / (5999.0 * LINE.sample_time_s)
    alone = hum_origins(18.0)
    assert alone
    assert hum_origins(18.0, slow_cycles=4.0) == pytest.approx(alone, abs=0.6 * cycle_Hz)
    slow_Hz = 4.0 * cycle_Hz
    rate_Hz = 1.0 / LINE.sample_time_s
    assert all(
        abs(f - k * rate_Hz) > 1.5 * slow_Hz for f in hum_origins(4.0) for k in range(1, 12)
    )


@pytest.mark.parametrize("swing_Hz", [0.45, 0.7, 1.0, 1.5, 3.889, 7.0, 12.0, 19.4, 33.0, 39.6])
def test_what_swings_slowly_is_no_alias_of_the_mains(swing_Hz):
    """At 100 Hz, 400 Hz less 1 % would fold to 4 Hz, 100 less 0.7 % to 0.7 Hz: no grid is there.

    Nor are 119.4 Hz, which folds to 19.4, and 60.4, which folds to 39.6.
    """
    assert hum_origins(swing_Hz * 5999 * LINE.sample_time_s) == []


@pytest.mark.parametrize(("mains_Hz", "harmonic"), [(50.2, 2), (49.8, 2), (60.2, 2), (59.8, 1)])
def test_mains_at_the_ends_of_what_a_grid_does_are_named_where_they_fold(mains_Hz, harmonic):
    """0.2 Hz of 50 Hz, and as much of 60; 120.4 Hz is seen at 20.4, 59.8 Hz at 40.2 Hz."""
    true_Hz = harmonic * mains_Hz
    seen_Hz = abs(true_Hz - round(true_Hz * LINE.sample_time_s) / LINE.sample_time_s)
    bin_Hz = 1.0 / (5999 * LINE.sample_time_s)
    (found_Hz,) = hum_origins(seen_Hz / bin_Hz)
    # 100.4 and 99.6 Hz are one line
    assert min(abs(found_Hz - f) for f in (true_Hz, 200.0 - true_Hz)) < bin_Hz


@pytest.mark.parametrize(("frequency_Hz", "seen_Hz"), [(49.7, 49.7), (99.7, 0.3)])
def test_mains_at_half_the_sample_rate_or_folded_are_named(frequency_Hz, seen_Hz):
    """At 100 Hz, 50.3, 149.7 and 350.3 fold to 49.7 Hz as well; 200.3 and 299.7 to 0.3 Hz."""
    assert LINE.sample_time_s == 0.01
    cycles = seen_Hz * 5999 * LINE.sample_time_s
    assert hum_origins(cycles) == pytest.approx([frequency_Hz], abs=0.01)


NIP = hypothesis(BY_NAME["nip_pulse"], "swrap_lead", (("nip_radius_m", 0.05),))


@pytest.mark.parametrize("radius_m", [0.0355, 0.0619, 0.0852])
def test_a_nip_begins_at_the_radius_that_turns_with_the_line_however_odd_it_is(radius_m):
    axes, found = of_order(LEAD.radius_m / radius_m)
    library = with_radii([NIP], [axes], [found])
    assert library[0] is NIP
    (proposed,) = library[1:]
    web_m = float(axes.travel_m[-1] - axes.travel_m[0])
    turns = web_m / (2.0 * np.pi * radius_m)
    # a fit needs to begin within a third of a turn at the end of the record
    assert proposed.at_start["nip_radius_m"] == pytest.approx(radius_m, rel=0.33 / turns)


@pytest.mark.parametrize("order", [1.0, 2.0, 4.0])
def test_a_line_at_a_whole_order_of_the_drive_proposes_no_nip(order):
    """As every ripple of the drive's own; two ground radii meet a whole ratio by chance."""
    axes, found = of_order(order)
    assert with_radii([NIP], [axes], [found]) == [NIP]
    beside = with_radii([NIP], *([one] for one in of_order(order + 0.05)))
    assert len(beside) == 2


def test_no_nip_is_as_small_as_the_shaft_that_a_fast_line_would_need():
    axes, found = of_order(LEAD.radius_m / 0.008)
    assert with_radii([NIP], [axes], [found]) == [NIP]


UNWIND = LINE.rollers[0]


def bounces(order, speed_m_s):
    """Return the frequencies at which a bounce at this order begins, a row of speeds a record."""
    h = hypothesis(BY_NAME["roll_bounce"], "unwind", (("order", order),), line=LINE)
    record_axes = [axes_at(np.asarray(row), LINE) for row in np.atleast_2d(speed_m_s)]
    library = with_resonances([RIPPLE, h], record_axes)
    assert library[0] is RIPPLE
    return np.array([h.at_start["frequency_Hz"] for h in library[1:]])


def passed_Hz(order, speed_m_s):
    return order * speed_m_s / (2.0 * np.pi * UNWIND.radius_m)


@each_case("order", [1.0, 2.0, 6.0])
@each_case("ends_m_s", [(0.8, 1.2), (0.9, 0.9), (0.5, 4.0)])
def test_a_bounce_begins_near_every_frequency_that_its_order_passes(order, ends_m_s):
    """Two half widths of a damping of 0.06 are 12 %; beyond the ends by as much is none."""
    starts = bounces(order, np.linspace(*ends_m_s, 3000))
    low, high = (passed_Hz(order, speed) for speed in ends_m_s)
    for true_Hz in np.geomspace(low, high, 50):
        assert np.min(np.abs(starts / true_Hz - 1.0)) < 0.13
    assert starts[0] > low / 1.13
    assert starts[-1] < high * 1.13
    assert starts.size <= np.log(high / low) / np.log(1.24) + 3


def test_what_two_records_pass_is_begun_at_and_not_what_lies_between():
    starts = bounces(4.0, [np.full(3000, 0.6), np.full(3000, 3.0)])
    slow, fast = passed_Hz(4.0, 0.6), passed_Hz(4.0, 3.0)
    near = [min(abs(f / slow - 1.0), abs(f / fast - 1.0)) for f in starts]
    assert 2 <= starts.size <= 4
    assert max(near) < 0.13


def test_of_a_roll_that_stands_no_more_is_tried_than_a_mandrel_can_do():
    assert bounces(4.0, np.zeros(3000)).size == 1  # nothing is passed: as it was
    starts = bounces(4.0, np.linspace(0.0, 1.0, 3000))
    assert starts[0] >= 0.2
