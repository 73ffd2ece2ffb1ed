"""One probe inside the control process: how loud it is asked to be, and why it came to nothing."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest

from aff_runtime.app.control.probe_run import ProbeRun
from aff_runtime.base.signals import State
from aff_runtime.config.loader import load_site
from aff_runtime.core.probe.probe import Stage
from aff_runtime.core.response import Response
from tests.aff_runtime.core.plants import measured

SITE = load_site(Path(__file__).parents[4] / "config" / "euclid_blocks.yaml")
GIVEN_M_S = 0.008


def former(sent_m_s: float) -> dict[str, Response]:
    one = measured(lambda _f: 250.0 + 0j, [0.5, 1.0])
    about = replace(one.provenance, amplitude=sent_m_s)
    return {"unwind": Response(points=one.points, delay_s=0.0, provenance=about)}


def run_of(responses: dict[str, Response], *, louder: bool) -> ProbeRun:
    return ProbeRun(
        SITE,
        ["unwind"],
        was_armed=False,
        config_hash="",
        version="",
        former=responses,
        louder=louder,
    )


@pytest.mark.parametrize(
    ("sent_m_s", "louder", "peak_m_s"),
    [
        (GIVEN_M_S, False, GIVEN_M_S),
        (GIVEN_M_S, True, 2 * GIVEN_M_S),
        (0.015, True, 0.02),  # the bound that the site file leaves at its default
        (math.nan, True, GIVEN_M_S),  # a response of an older release does not say
    ],
)
def test_a_louder_probe_sends_twice_what_was_sent_before(
    sent_m_s: float, louder: bool, peak_m_s: float
) -> None:
    run = run_of(former(sent_m_s), louder=louder)
    assert run._settings.amplitude == pytest.approx(peak_m_s)


def test_a_probe_that_never_begins_says_what_it_waited_for() -> None:
    run = run_of({}, louder=False)
    run.probe.waiting = "the line speed went from 1 to 1.1 m/s"
    assert run.probe.stage is Stage.LISTENING
    assert run.watch_tick(State.ACTIVE, 0) is False
    assert run.watch_tick(State.ACTIVE, round(run.duration_s / SITE.cycle_s) + 1) is True
    said = run.failure(State.ACTIVE, "")
    assert "did not end in" in said
    assert said.endswith("the line speed went from 1 to 1.1 m/s")
