"""Cases are drawn from seed and number, and their effects have the size they say."""

from collections import Counter

import numpy as np
import pytest

from benchmarks.campaign.cases import GROUPS, case_number, numbers_of
from benchmarks.campaign.effect_table import EFFECTS
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
        assert drawn == Counter(GROUPS)


def test_every_ablation_has_its_turn():
    rows = 5 * len(GROUPS)
    drawn = Counter(c.group for n in range(rows) if "abl" in (c := case_number(1, n)).group)
    assert sorted(drawn.values()) == [1] * 5


def test_every_effect_drawn_can_be_put_on_the_machine():
    drawn = {f.effect for n in range(600) for f in case_number(2, n).faults}
    assert drawn <= {row.name for row in EFFECTS if row.change}
    assert len(drawn) >= 18


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
    healthy = numbers_of(364, "no effect")
    assert len(healthy) == 78
    assert {case_number(102, n).group for n in healthy[:6]} == {"no effect"}
    assert [n for n in healthy if n < 90] == numbers_of(90, "no effect")
