import math
from types import SimpleNamespace

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.figures import told_by, wavenumber_map
from sim_plant.refine.holdout import Judgement
from sim_plant.refine.hypotheses import hypothesis
from sim_plant.refine.report import gain, headline, next_step
from sim_plant.refine.verdict import MODEL_SHARE, standard_deviations

CHANNELS = ("unwind_tension_N", "unwind_angle_rad", "unwind_radius_m", "line_speed_m_s")
STEP_S = 0.01


def judged(wavenumber_1_m=4.0):
    """One tension with a line in web travel while the speed doubles, gone when amended."""
    speed = np.where(np.arange(4000) < 2000, 1.0, 2.0)
    travel = np.cumsum(speed) * STEP_S
    measured = np.zeros((4, 4000))
    measured[0] = np.cos(2.0 * np.pi * wavenumber_1_m * travel)
    declared, amended = np.zeros((4, 4000)), measured.copy()
    return Judgement(
        channels=CHANNELS, before=np.array([3.0, 900.0, 90.0, 2.0]),
        after=np.array([0.26, 1.0, 1.0, 1.0]), floor=np.array([0.25, 1.0, 1.0, 1.0]),
        measured=measured, declared=declared, amended=amended, effects=(), angles_rad={},
        unwound_m={}, first=100, travel_m=travel,
    )  # fmt: skip


def result(**more):
    return {"verdict": "traced", "effects": [], "unknown": [], "ambiguous": [], **more}


EFFECT = {"effect": "out_of_round_roll", "location": "unwind",
          "parameters": {"shape": "flat", "size_m": 0.0119, "angle_rad": 1.0}}  # fmt: skip


def test_sums_are_not_what_the_figures_show():
    assert [CHANNELS[k] for k in told_by(judged())] == ["unwind_tension_N", "line_speed_m_s"]


def test_the_first_lines_say_what_how_much_what_it_brings_and_what_to_do():
    assert headline(result(effects=[EFFECT])) == (
        "Traced: out of round roll at unwind (flat, size_m 0.0119)."
    )
    said = gain(judged(), held=True)
    assert "3 N rms as declared, 0.26 N as amended; noise alone leaves 0.25 N" in said
    assert "no proof" in gain(judged(), held=False)


@pytest.mark.parametrize(
    ("found", "block", "word"),
    [
        (result(effects=[EFFECT]), True, "Paste the AFF block"),
        (result(effects=[EFFECT]), False, "no ripple to cancel"),
        (result(unknown=[{"class": "travel"}]), False, "turns or swings"),
        (result(unknown=[{"class": "state"}]), False, "more speeds"),
        (result(effects=[EFFECT], ambiguous=[{}]), True, "tells the candidates apart"),
        (result(), False, "declaration stands"),
    ],
)
def test_the_next_step_fits_the_verdict(found, block, word):
    assert word in next_step(found, block)


def test_a_line_in_web_travel_stands_still_on_the_map_at_every_speed(monkeypatch):
    drawn = []
    monkeypatch.setattr("matplotlib.axes.Axes.pcolormesh",
                        lambda axis, x, y, level, **_: drawn.append((x, y, level)))  # fmt: skip
    wavenumber_map(judged(4.0), STEP_S)
    (time_s, wavenumber, before), (_, _, after) = drawn
    ridge = wavenumber[np.argmax(before, axis=0)]
    slow = time_s < 18.0
    assert 0 < slow.sum() < slow.size
    assert np.abs(ridge - 4.0).max() < 2.0 * (wavenumber[1] - wavenumber[0])
    assert before.max() > after.max() + 60.0


def test_a_size_is_as_uncertain_as_the_model_and_an_angle_only_as_the_noise():
    flat = hypothesis(BY_NAME["out_of_round_roll"], "unwind", (("shape", "flat"),),
                      ("size_m", "angle_rad"))  # fmt: skip
    off_axis = hypothesis(BY_NAME["eccentric_roller"], "R6")
    fit = SimpleNamespace(hypotheses=(flat, off_axis), values=((0.012, 1.0), (3e-4, 4e-4)),
                          covariance=np.diag([1e-10, 1e-6, 1e-14, 1e-14]))  # fmt: skip
    size, angle, cos, sin = standard_deviations(fit)
    assert size == pytest.approx(math.hypot(1e-5, MODEL_SHARE * 0.012))
    assert angle == pytest.approx(1e-3)
    # either component is as uncertain as the phasor: the error may stand across it
    assert cos == pytest.approx(math.hypot(1e-7, MODEL_SHARE * 5e-4)) == pytest.approx(sin)
