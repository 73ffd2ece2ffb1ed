"""Drives of known numbers, their phasors from scipy: what is found, how sure, what is refused."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import pytest

from aff_runtime.base.errors import RefusedError
from aff_runtime.core.identified import IdentifiedDrive
from aff_runtime.core.identify.drive_fit import fit_drive
from tests.aff_runtime.core.identify.linear_line import CYCLE_S, LinearLine

TONES_Hz = np.geomspace(0.4, 10.0, 24)
DRAWS = 12


def found(line: LinearLine, noise: float = 0.01, seed: int = 1) -> IdentifiedDrive:
    return fit_drive(
        line.phasors(TONES_Hz, noise, seed), cycle_s=CYCLE_S, roll="unwind", radius_m=line.radius_m
    )


def true_of(line: LinearLine) -> dict[str, float]:
    return {
        "speed_gain_rad_s": line.gain_rad_s,
        "integral_time_s": 1.0 / line.corner_rad_s,
        "inertia_kg_m2": line.inertia_kg_m2,
        "delay_s": line.delay_s,
        "stiffness_N_m": line.stiffness_N_m,
    }


def test_without_noise_to_speak_of_the_numbers_are_the_true_ones():
    line = LinearLine()
    drive = found(line, noise=1e-3)
    for name, true in true_of(line).items():
        assert getattr(drive, name).value == pytest.approx(true, rel=0.03), name
    assert drive.misfit < 2.0


def test_idlers_that_are_unlike_make_the_drive_no_other():
    line = LinearLine(masses=(2.0, 0.6, 1.4, 0.5))
    drive = found(line, noise=1e-3)
    for name in ("speed_gain_rad_s", "integral_time_s", "inertia_kg_m2"):
        assert getattr(drive, name).value == pytest.approx(true_of(line)[name], rel=0.03), name
    assert drive.misfit < 2.0


def test_tones_below_all_orders_tell_the_integral_time():
    """Twice as well at least, with as many tones of the same size."""
    line = LinearLine()
    spread = []
    for lowest_Hz in (0.1, 1.0):
        tones_Hz = np.geomspace(lowest_Hz, 10.0, 24)
        drive = fit_drive(
            line.phasors(tones_Hz, 0.02), cycle_s=CYCLE_S, roll="unwind", radius_m=line.radius_m
        )
        time_s = drive.integral_time_s
        spread.append(np.log(time_s.high / time_s.low))
    assert spread[0] < 0.5 * spread[1]


def drawn(seed: int) -> LinearLine:
    rng = np.random.default_rng(seed)
    gain = float(np.exp(rng.uniform(np.log(8.0), np.log(50.0))))
    return LinearLine(
        gain_rad_s=gain,
        corner_rad_s=gain / 4.0 / float(rng.uniform(0.8, 1.4)) ** 2,
        inertia_kg_m2=float(rng.uniform(0.2, 0.9)),
        radius_m=float(rng.uniform(0.12, 0.25)),
        stiffness_N_m=float(rng.uniform(700.0, 2500.0)),
        mass_kg=float(rng.uniform(3.0, 9.0)),
        delay_s=float(rng.uniform(0.005, 0.06)),
    )


def held(seeds: Iterable[int]) -> list[bool]:
    """Return for each number of each drawn drive whether its interval holds the true one."""
    said = []
    for seed in seeds:
        line = drawn(seed)
        drive = found(line, noise=0.02, seed=seed)
        for name, true in true_of(line).items():
            said.append(getattr(drive, name).low <= true <= getattr(drive, name).high)
    return said


@pytest.mark.long  # quick: intervals of two drives, below
@pytest.mark.parametrize("seed", range(DRAWS))
def test_drawn_drives_are_found_within_15_percent(seed):
    line = drawn(seed)
    drive = found(line, noise=0.01, seed=seed)
    for name in ("speed_gain_rad_s", "inertia_kg_m2"):
        assert getattr(drive, name).value == pytest.approx(true_of(line)[name], rel=0.15), name


def test_intervals_of_a_drive_hold_what_is_true():
    assert np.mean(held((6,))) >= 0.9


@pytest.mark.long
def test_intervals_hold_what_is_true():
    assert np.mean(held(range(DRAWS))) >= 0.9


@pytest.mark.long  # quick: intervals of two drives
def test_more_noise_makes_wider_intervals():
    quiet, loud = (found(LinearLine(), noise=noise) for noise in (0.005, 0.05))
    for name in ("speed_gain_rad_s", "inertia_kg_m2", "stiffness_N_m"):
        narrow, wide = getattr(quiet, name), getattr(loud, name)
        assert wide.high / wide.low > narrow.high / narrow.low, name


def test_friction_that_cannot_be_told_has_an_interval_around_it():
    drive = found(LinearLine())
    assert drive.friction_N_m_s.low < 0.02 < drive.friction_N_m_s.high


@pytest.mark.long  # quick: the numbers are the true ones
def test_the_unit_of_the_correction_scales_nothing_else():
    """Twice the correction makes twice the answers: the drive is the same."""
    once = LinearLine().phasors(TONES_Hz, 1e-3)
    twice = replace(once, sent=2.0 * once.sent, seen=2.0 * once.seen, noise=4.0 * once.noise)
    drives = [
        fit_drive(phasors, cycle_s=CYCLE_S, roll="unwind", radius_m=0.2)
        for phasors in (once, twice)
    ]
    assert drives[0].inertia_kg_m2.value == pytest.approx(drives[1].inertia_kg_m2.value, rel=1e-3)


def test_tones_that_drown_in_noise_are_refused():
    with pytest.raises(RefusedError, match=r"^0 of 2\d tones below 12 Hz .*, 10 are needed"):
        found(LinearLine(), noise=2.0)


@pytest.mark.parametrize("noise", [1e-3, 2.0])
def test_where_too_few_tones_were_sent_more_are_asked_for_and_no_louder_ones(noise):
    """Seven of them below 12 Hz, as where the first order of a fast line stands above."""
    heard = LinearLine().phasors(np.append(np.geomspace(0.5, 8.0, 7), [13.0, 15.0, 18.0]), noise)
    said = (
        "7 tones were sent below 12 Hz, 10 are needed, and no louder ones help: name 3 more "
        "frequencies or more below 12 Hz, away from orders, under probe.extra_frequencies_Hz, or "
        "probe at a lower line speed"
    )
    with pytest.raises(RefusedError) as refused:
        fit_drive(heard, cycle_s=CYCLE_S, roll="unwind", radius_m=0.2)
    assert str(refused.value) == said


def test_a_correction_that_acts_as_a_torque_is_refused():
    """Told from a dozen slow tones: of more, no path fits, and every one is tried on them all."""
    heard = LinearLine(as_torque=True).phasors(np.geomspace(0.4, 3.4, 12), 0.01)
    with pytest.raises(RefusedError, match="acts on the roll as a torque"):
        fit_drive(heard, cycle_s=CYCLE_S, roll="unwind", radius_m=0.2)


def test_a_tension_that_rises_with_the_rolls_speed_is_refused():
    with pytest.raises(RefusedError, match="the tension rises when the roll turns faster"):
        found(LinearLine(pulls_back=False))
