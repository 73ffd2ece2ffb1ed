"""The README's picture: what is drawn is what was measured."""

import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from sim_plant.demo.evaluation import OrderReduction
from sim_plant.demo.picture import write_picture
from sim_plant.demo.session import DemoPlan, Session

ARMED_S = 100.0


def session(tension_N):
    time_s = np.arange(0.0, 200.0, 0.005)
    record = {"time_s": time_s, "true_unwind_tension_N": tension_N(time_s)}
    plan = DemoPlan(line=Path("a"), site=Path("b"), out=Path("c"), line_speed_m_s=1.0)
    return Session(
        plan=plan,
        record=record,
        before_s=(20.0, 36.0),
        after_s=(160.0, 180.0),
        armed_at_s=ARMED_S,
        run_folder=Path("d"),
        probe_text="",
        exit_codes={},
    )


def row(roll, order, before_N, after_N):
    return OrderReduction(
        tension="unwind_tension_N",
        roll=roll,
        order=order,
        frequency_Hz=float(order),
        before_N=before_N,
        after_N=after_N,
        floor_N=0.0,
        target_dB=0.0,
    )


@pytest.fixture(scope="module")
def drawn(tmp_path_factory):
    """Return the picture of ripple that ends when the output is armed, and its bars."""
    path = tmp_path_factory.mktemp("picture") / "picture.svg"
    rows = [row("unwind", 1, 2.0, 0.5), row("unwind", 3, 1.0, 0.0), row("other", 7, 9.0, 9.0)]
    write_picture(session(lambda t: 90.0 + np.where(t < ARMED_S, np.sin(t), 0.0)), rows, path)
    return path.read_text(encoding="utf-8")


def test_the_picture_is_a_whole_file_that_loads_nothing(drawn):
    assert ElementTree.fromstring(drawn).tag.endswith("svg")
    assert re.findall(r'href="(?!#)', drawn) == []


def test_the_picture_is_small_enough_for_a_readme(drawn):
    assert len(drawn) < 200_000


def test_only_orders_of_the_unwind_roll_have_bars(drawn):
    words = [t.text for t in ElementTree.fromstring(drawn).iter() if t.tag.endswith("text")]
    assert {"1", "3", "PI alone", "with AFF"} <= set(words)
    assert "7" not in words


def test_the_same_run_gives_the_same_bytes(drawn, tmp_path):
    rows = [row("unwind", 1, 2.0, 0.5), row("unwind", 3, 1.0, 0.0), row("other", 7, 9.0, 9.0)]
    path = tmp_path / "again.svg"
    write_picture(session(lambda t: 90.0 + np.where(t < ARMED_S, np.sin(t), 0.0)), rows, path)
    assert path.read_text(encoding="utf-8") == drawn
