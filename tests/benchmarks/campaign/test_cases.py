"""Cases are drawn from seed and number, and their effects have the size they say."""

from collections import Counter

import numpy as np
import pytest

from benchmarks.campaign.cases import (
    CYCLE,
    GROUPS,
    SIZE,
    case_number,
    cases_for,
    dealt,
    draw_several,
    numbers_of,
)
from benchmarks.campaign.effect_table import BY_NAME, LIBRARY
from benchmarks.campaign.effects import flat_outline, outline
from benchmarks.campaign.make import floors, write_case
from benchmarks.campaign.record import simulate
from benchmarks.campaign.sizes import snr_of
from benchmarks.campaign.stage import SIZED_BY, rms, stage
from benchmarks.campaign.work import coordinate_of

pytestmark = pytest.mark.timeout(300)


def first(group, seed=3, **wanted):
    for number in range(400):
        case = case_number(seed, number)
        if case.group == group and all(getattr(case.faults[0], k) == v for k, v in wanted.items()):
            return case
    raise AssertionError(group)


def test_a_case_is_the_same_whenever_it_is_drawn():
    assert [case_number(5, n) for n in range(40)] == [case_number(5, n) for n in range(40)]
    assert case_number(5, 1) != case_number(6, 1)


def test_any_stretch_of_the_campaign_is_a_small_campaign():
    for begin in (0, 13, 111):
        drawn = Counter(
            case_number(1, n).group.partition(":")[0] for n in range(begin, begin + len(GROUPS))
        )
        assert drawn == CYCLE


def test_every_ablation_has_its_turn():
    rows = 3 * len(GROUPS)
    drawn = Counter(c.group for n in range(rows) if "abl" in (c := case_number(1, n)).group)
    assert len(drawn) == 5


@pytest.mark.parametrize("seed", [1, 100, 2026])
def test_every_effect_is_drawn_twenty_times_and_300_records_are_healthy_whatever_the_seed(seed):
    cases = [case_number(seed, n) for n in range(cases_for(20))]
    drawn = Counter(f.effect for c in cases if c.group in SIZE for f in c.faults)
    assert drawn.keys() == {row.name for row in LIBRARY}
    assert min(drawn.values()) >= 20
    assert sum(c.group == "no effect" for c in cases) == 300
    forms = Counter((f.effect, f.form) for c in cases if c.group in SIZE for f in c.faults)
    several = [(row.name, form.name) for row in LIBRARY for form in row.forms if row.forms[1:]]
    assert min(forms[one] for one in several) >= 9


def test_one_cycle_less_would_not_be_enough_for_twenty_times():
    cases = [case_number(1, n) for n in range(cases_for(20) - len(GROUPS))]
    drawn = Counter(f.effect for c in cases if c.group in SIZE for f in c.faults)
    assert min(drawn.values()) < 20


def test_no_two_effects_meet_twice_in_pairs_before_all_have_met_once():
    met = Counter(
        frozenset(hand) for index in range(23 * 12) if len(hand := dealt(5, "pair", index)) == 2
    )
    pairs = len(LIBRARY) * (len(LIBRARY) - 1) // 2
    assert len(met) == pairs
    assert sum(met.values()) == pairs + len(LIBRARY)  # each meets the free seat once


def test_effects_of_one_case_are_at_places_of_their_own_where_they_have_the_choice():
    for seed in range(20):
        rng = np.random.default_rng(seed)
        names = ["eccentric_roller", "bearing_drag", "unbalanced_roller"]
        found = draw_several(rng, names, 0)
        assert len({f.location for f in found}) == 3
    both = draw_several(rng, ["web_modulus", "viscoelastic_web"], 0)
    assert [f.location for f in both] == ["web", "web"]


def test_what_begins_in_record_a_begins_in_b_at_another_moment_before_it_or_never():
    cases = [case_number(3, n) for n in range(cases_for(20))]
    begin = [f for c in cases for f in c.faults if BY_NAME[f.effect].form(f).begins]
    assert all(18.0 <= f.from_s <= 42.0 for f in begin)
    there = [f.in_record("b").from_s for f in begin]
    own, before, never = (
        sum(18.0 <= s <= 42.0 for s in there),
        sum(s < 0.0 for s in there),
        sum(s > 60.0 for s in there),
    )
    assert own + before + never == len(begin)
    assert own > before > 0 < never


def test_the_cases_of_one_effect_are_those_that_have_it():
    numbers = numbers_of(cases_for(20), effect="splice", seed=4)
    assert len(numbers) >= 20
    assert all("splice" in {f.effect for f in case_number(4, n).faults} for n in numbers)


@pytest.mark.long
def test_a_case_written_has_the_asked_ratio_and_the_noise_it_says(tmp_path):
    case = first("single 0.4", effect="eccentric_roller")
    made = write_case(case, tmp_path)
    at = stage(case, "a")
    noisy = simulate(at.machine, at.told, at.angles, at.seed, colour=case.colour).even()
    healthy = at.quiet()
    reached = snr_of(at.quiet(made.faults), healthy, floors(noisy, healthy))
    assert reached == pytest.approx(0.4, rel=0.06)
    assert made.snr == (pytest.approx(reached, rel=0.05),)
    at = stage(case, "b")
    quiet = at.quiet(made.faults)
    rows = np.loadtxt(tmp_path / "b.csv", delimiter=",", skiprows=1)
    names = (tmp_path / "b.csv").read_text().partition("\n")[0].split(",")
    grid = np.linspace(rows[0, 0], rows[-1, 0], rows.shape[0])
    for name in SIZED_BY:
        read = np.interp(grid, rows[:, 0], rows[:, names.index(name)])
        assert rms(read - quiet[name]) == pytest.approx(made.floor[name], rel=1e-3)
    assert (tmp_path / "a.yaml").exists()
    late = np.diff(rows[:, 0])
    assert late.min() > 0.0
    assert np.ptp(late) == pytest.approx(1e-3)


def test_a_roll_of_orders_and_a_flat_are_closed_and_convex():
    for points, normals in (
        outline(0.18, [(2, 1e-3, 0.4), (3, 3e-4, 1.0)]),
        flat_outline(0.18, 0.144, 6e-3, 0.4),
    ):
        z, n = points @ [1.0, 1j], normals @ [1.0, 1j]
        edges = np.diff(np.append(z, z[0]))
        turns = (np.roll(edges, -1) * np.conj(edges)).imag
        assert turns.min() > -1e-12
        assert np.abs(edges).min() > 0.0
        # no point of the roll stands out beyond the tangent at any other
        for k in range(0, z.size, 257):
            assert np.max((z * np.conj(n[k])).real) <= (z[k] * np.conj(n[k])).real + 1e-9


def test_a_line_is_sought_where_the_fault_makes_it():
    nip = first("outside", effect="hidden_nip")
    as_row = {
        "shape": nip.faults[0].shape,
        "effect": "hidden_nip",
        "kind": "travel",
        "location": "R2",
    }
    assert coordinate_of(as_row) == {"wavenumber_1_m": nip.faults[0].shape}
    hum = {"shape": 60.0, "effect": "mains_hum", "kind": "time", "location": "R2"}
    assert coordinate_of(hum) == {"frequency_Hz": 40.0}
    ecc = {"shape": 0.0, "effect": "eccentric_roller", "kind": "travel", "location": "R1"}
    assert coordinate_of(ecc)["wavenumber_1_m"] == pytest.approx(1.0 / (2 * np.pi * 0.0381))
    gear = {"shape": 6.0, "effect": "torque_ripple", "kind": "angle", "location": "unwind"}
    assert coordinate_of(gear) == {"order": 6.0}


def test_one_group_alone_keeps_the_numbers_that_its_cases_have_among_all():
    assert numbers_of(20) == list(range(20))
    healthy = numbers_of(cases_for(20), "no effect")
    assert len(healthy) == 300
    assert {case_number(102, n).group for n in healthy[:6]} == {"no effect"}
    assert [n for n in healthy if n < 90] == numbers_of(90, "no effect")
