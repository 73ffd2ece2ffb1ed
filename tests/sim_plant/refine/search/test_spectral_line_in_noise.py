"""A sum over channels says less where noise moves them together."""

import numpy as np
import pytest

from sim_plant.refine.search.completeness import remaining_spectra
from sim_plant.refine.search.spectral_line_in_noise import may_be_noise
from sim_plant.refine.search.unexplained import strongest_peak, what_is_left
from tests.sim_plant.refine.small import (
    STEP_S,
    FormulaTwin,
    axes_at,
    fit_of,
    line_with,
    objective_of,
    white,
)

SAMPLES, JUDGED = 3000, 2250
CHANNELS = (
    *("unwind_tension_N", "pullroll_tension_N", "r3_tension_N", "rewind_tension_N"),
    *("unwind_speed_rad_s", "rewind_speed_rad_s", "line_speed_m_s", "pull_roll_speed_m_s"),
)
SPEED = 1.0 + 0.3 * np.sin(np.arange(JUDGED) * 0.004)
RECORD_AXES = [axes_at(SPEED)]


class Noisy(FormulaTwin):
    """A twin whose noise moves all channels alike, with ``noise_sd`` of their own beside it."""

    def simulate(self, case):
        if case.seed is None:
            return np.zeros((len(CHANNELS), SAMPLES))
        return noise(self.noise_sd[0], 1000 + case.seed)


def noise(own, seed):
    return own * white((len(CHANNELS), SAMPLES), seed) + np.sqrt(1.0 - own**2) * white(
        SAMPLES, seed + 500
    )


def objective_with(own):
    twin = Noisy(
        declaration=line_with(),
        channels=CHANNELS,
        speed_m_s=np.ones(SAMPLES),
        tension_N=np.full(SAMPLES, 89.0),
        aff_m_s={},
        formula=None,
        noise_sd=(own,),
    )
    return objective_of(twin, noise(own, 7))


def claimed(own, size):
    """Return whether a wave of this size in every channel may be noise, and what is said."""
    objective = objective_with(own)
    time_s = STEP_S * np.arange(JUDGED)
    left = noise(own, 7)[:, SAMPLES - JUDGED :] + size * np.cos(2.0 * np.pi * 3.0 * time_s)
    residual = np.append(left.ravel(), np.zeros(len(objective.nuisances)))
    fit = fit_of(residual=residual, cost=float(residual @ residual))
    after = remaining_spectra(objective, fit, RECORD_AXES)
    spectrum, at, strength = strongest_peak(after)
    said = what_is_left(objective, fit, fit, RECORD_AXES, after)
    return (
        strength,
        may_be_noise(objective, RECORD_AXES, spectrum, at),
        [u.unknown_class for u in said if u.unknown_class in ("time", "travel")],
    )


def test_a_wave_is_a_line_where_every_channel_has_noise_of_its_own():
    strength, doubtful, kinds = claimed(1.0, 0.2)
    assert strength > 260.0
    assert not doubtful
    assert kinds


@pytest.mark.parametrize(("size", "doubtful"), [(0.2, True), (0.7, False)])
@pytest.mark.sweep(every=2)
def test_the_same_wave_is_none_where_one_noise_moves_all_channels(size, doubtful):
    strength, may_be, kinds = claimed(0.2, size)
    assert strength > 260.0
    assert may_be is doubtful
    assert bool(kinds) is not doubtful
