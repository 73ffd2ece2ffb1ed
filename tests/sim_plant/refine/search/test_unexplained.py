"""When what is left is called broadband, and which channels count."""

from types import SimpleNamespace

import numpy as np
import pytest

from sim_plant.refine.search import completeness
from sim_plant.refine.search import unexplained as unknown
from sim_plant.refine.search.coherence import Coupling
from sim_plant.refine.search.unexplained import COUPLED, LOUD, loudest

ANALOGUE = np.array([True, False, True])


def left(*sizes, seed=1):
    """Return a problem and a fit that leaves noise of these sizes in three channels."""
    rng = np.random.default_rng(seed)
    part = np.asarray(sizes)[:, None] * rng.standard_normal((3, 4000))
    noise = SimpleNamespace(analogue=ANALOGUE)
    objective = SimpleNamespace(
        noise=[noise], expected_cost=12_000.0, split=lambda _: [part], basis=[None]
    )
    cost = float(np.sum(part**2))
    return objective, SimpleNamespace(residual=part, cost=cost, hypotheses=())


def test_the_loudest_channel_counts_and_a_coarse_word_does_not():
    objective, fit = left(1.0, 3.0, 1.2)
    assert loudest(objective, fit) == pytest.approx(1.44, rel=0.1)
    objective, fit = left(1.0, 3.0, 1.0)
    assert loudest(objective, fit) < LOUD


@pytest.mark.parametrize(("size", "kinds"), [(1.0, []), (1.15, ["broadband"])])
def test_broadband_is_claimed_for_a_channel_that_is_clearly_loud(monkeypatch, size, kinds):
    objective, fit = left(1.0, 1.0, size)
    monkeypatch.setattr(unknown, "strongest_line", lambda _: (None, 1.0, 0.0))
    monkeypatch.setattr(unknown, "joint_conflict", lambda *_: None)
    monkeypatch.setattr(unknown, "oddest_coupling", lambda *_: SimpleNamespace(score=0.0))
    assert [u.kind for u in unknown.unexplained_parts(objective, fit, fit, [])] == kinds


@pytest.mark.parametrize(("share", "kinds"), [(0.9, []), (1.1, ["broadband"])])
def test_channels_that_move_together_as_no_noise_does_are_broadband(monkeypatch, share, kinds):
    objective, fit = left(1.0, 1.0, 1.0)
    pair = Coupling(
        channels=("rewind_tension_N", "rewind_speed_rad_s"),
        from_Hz=1.25,
        to_Hz=2.5,
        score=share * COUPLED,
    )
    monkeypatch.setattr(unknown, "strongest_line", lambda _: (None, 1.0, 0.0))
    monkeypatch.setattr(unknown, "joint_conflict", lambda *_: None)
    monkeypatch.setattr(unknown, "oddest_coupling", lambda *_: pair)
    found = unknown.unexplained_parts(objective, fit, fit, [])
    assert [u.kind for u in found] == kinds
    assert all("rewind_tension_N and rewind_speed_rad_s" in u.text for u in found)
    objective.basis = [np.zeros((4000, 2))]  # beside a free line, what it leaves is coupled
    assert unknown.unexplained_parts(objective, fit, fit, []) == []


def test_free_lines_are_sought_in_channels_with_noise_of_their_own(monkeypatch):
    objective, fit = left(1.0, 9.0, 1.0)
    seen = []
    monkeypatch.setattr(completeness, "spectra", lambda _, part: seen.append(part.shape) or [])
    completeness.remaining_spectra(objective, fit, [None])
    assert seen == [(2, 4000)]
