from dataclasses import replace

import numpy as np
import pytest

from sim_plant.refine.report.page import gain
from sim_plant.refine.report.plots import overlay, part_around, wavenumber_map, worst_part
from tests.sim_plant.refine.report.judged_line import STEP_S, judged


def test_the_overlay_shows_where_the_declared_line_is_worst():
    one = judged()
    one.measured[0] = 0.0
    one.measured[0, 2500:2600] = 5.0
    part = worst_part(one, 0, 200)
    assert part.stop - part.start == 200
    assert part.start <= 2500
    assert part.stop >= 2600
    early = replace(one, first=2700)
    assert worst_part(early, 0, 200).start >= 2700
    assert worst_part(early, 0, 9999) == slice(2700, 4000)


def test_what_begins_is_shown_a_quarter_into_its_part_of_the_record():
    assert part_around(judged(), STEP_S, 20.0) == slice(1500, 3500)
    assert part_around(judged(), STEP_S, 0.5) == slice(0, 2000)
    assert part_around(judged(), STEP_S, 39.9) == slice(2000, 4000)
    short = replace(judged(), measured=np.zeros((4, 900)))
    assert part_around(short, STEP_S, 5.0) == slice(0, 900)


def test_without_an_amended_line_one_curve_and_one_map_are_drawn(monkeypatch):
    drawn, marks = [], []
    monkeypatch.setattr("sim_plant.refine.report.plots.svg", lambda *_, **__: "<svg></svg>")
    monkeypatch.setattr(
        "matplotlib.axes.Axes.plot", lambda _axis, *_, label, **__: drawn.append(label)
    )
    monkeypatch.setattr("matplotlib.axes.Axes.axvline", lambda _axis, x, **_: marks.append(x))
    monkeypatch.setattr("matplotlib.axes.Axes.legend", lambda _axis, **_: None)
    part = part_around(judged(), STEP_S, 20.0)
    overlay(judged(), STEP_S, part, draw_amended=False, mark_s=20.0)
    assert set(drawn) == {"measured", "declared", "error as declared"}
    assert set(marks) == {20.0}
    overlay(judged(), STEP_S, part)
    assert {"amended", "error as amended"} < set(drawn)
    assert len(marks) == 2 * 2  # of two channels, measured and error: the first overlay's only
    assert len(wavenumber_map(judged(), STEP_S, draw_amended=False)) == 1
    assert "as amended" not in gain(judged(), held=True, is_amended=False).casefold()


def test_a_line_in_web_travel_stands_still_on_the_map_at_every_speed(monkeypatch):
    drawn = []
    monkeypatch.setattr(
        "matplotlib.axes.Axes.pcolormesh",
        lambda axis, x, y, level, **_: drawn.append((x, y, level)),
    )
    wavenumber_map(judged(4.0), STEP_S)
    (time_s, wavenumber, before), (_, _, after) = drawn
    ridge = wavenumber[np.argmax(before, axis=0)]
    slow = time_s < 18.0
    assert 0 < slow.sum() < slow.size
    assert np.abs(ridge - 4.0).max() < 2.0 * (wavenumber[1] - wavenumber[0])
    assert before.max() > after.max() + 60.0


def test_noise_of_the_floors_size_is_at_zero_decibels_of_the_map(monkeypatch):
    """Mean power of white noise through a window: its variance times the window's energy."""
    drawn = []
    monkeypatch.setattr(
        "matplotlib.axes.Axes.pcolormesh",
        lambda _axis, _x, _y, level, *, vmin, vmax, **_: drawn.append((level, vmin, vmax)),
    )
    one = judged()
    noise = one.floor[0] * np.random.default_rng(5).standard_normal(one.travel_m.size)
    steady = replace(one, measured=one.declared + noise, travel_m=STEP_S * np.arange(4000.0))
    wavenumber_map(steady, STEP_S, draw_amended=False)
    ((level, lowest, highest),) = drawn
    # without the mean of each part, and what the window brings of it
    power = 10.0 * np.log10(np.mean(10.0 ** (level[3:] / 10.0)))
    assert (lowest, highest) == pytest.approx((power - 6.0, power + 30.0), abs=0.3)
