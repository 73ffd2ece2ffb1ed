"""Future work: a heated span, with and without the density change in the flow."""

from __future__ import annotations

import numpy as np

from sim_plant.base.arrays import LineArrays
from sim_plant.elements.web_climate import mass_per_length
from sim_plant.line.alone.climate_section import WarmSpan, pull_N, simulate
from sim_plant.reproduce.drawing import Panel, draw
from sim_plant.reproduce.entry import Disagreement, Experiment, Result, beyond
from sim_plant.reproduce.euclid import FPM_M_S, open_euclid, steady, times

V_IN, V_OUT, EPS_UP, OVEN_K, STEP_S = 1.0, 1.004, 0.005, 30.0, 2e-3
SPAN = WarmSpan(
    EA_N=9300.0, strain_upstream=EPS_UP, length_m=2.0, expansion_1_K=6e-5, exchange_s=1.5
)
HEATED = 12
"""R12-R13, in the pull-roll zone between two speed-controlled drives."""


def run() -> Result:
    """Switch the oven on: between two speeds, then in a zone of the whole line."""
    strain = (1.0 + EPS_UP) * V_OUT / V_IN - 1.0
    states = simulate(
        SPAN,
        np.array([strain, 0.0]),
        lambda _t: (V_IN, V_OUT),
        lambda t: OVEN_K if t > 2.0 else 0.0,
        20.0,
        STEP_S,
    )
    time = times(len(states), STEP_S)
    pull = np.array([pull_N(SPAN, float(e), float(w)) for e, w in states])
    drop = float(pull[0] - pull[-1])
    warming = OVEN_K / (1.0 + SPAN.exchange_s * V_IN / SPAN.length_m)
    closed = SPAN.EA_N * SPAN.expansion_1_K * warming
    # mass balance with the density of the warm web, and with the cold one taken throughout
    density = mass_per_length(0.0114, float(states[-1, 0]))
    leak = density * V_OUT - mass_per_length(0.0114, EPS_UP) * V_IN
    cold = mass_per_length(0.0114, float(states[-1, 0]) - SPAN.expansion_1_K * warming)
    wrong = cold * V_OUT - mass_per_length(0.0114, EPS_UP) * V_IN

    def heat(arrays: LineArrays) -> LineArrays:
        arrays.spans["free_strain"][HEATED] = SPAN.expansion_1_K * warming
        return arrays

    speed = 200.0 * FPM_M_S
    tensions = [
        steady(open_euclid(speed_m_s=speed, change=change), 10.0, speed)["span_tension_N"][-1]
        for change in (None, heat)
    ]
    change_N = tensions[1] - tensions[0]
    number = np.arange(change_N.size, dtype=np.float64)
    panels = [
        Panel(
            curves={"tension": (time, pull)},
            x="time [s]",
            y="tension [N]",
            title="oven on at 2 s, both speeds held",
        ),
        Panel(
            curves={"change": (number, change_N)},
            x="span number",
            y="tension change [N]",
            title="one heated span of the Euclid line",
            points=("change",),
        ),
    ]
    return Result(
        rows=(
            beyond(
                "tension lost in the heated span",
                drop,
                "N",
                "speeds hold the whole strain; the free part of it no longer pulls",
                claim="which mechanism is right?",
            ),
            beyond(
                "moisture uptake that loses the same tension (swelling 0.1)",
                100.0 * closed / SPAN.EA_N / 0.1,
                "% of mass",
                "heat and moisture enter by one free strain: alpha dTheta + beta dm",
            ),
            beyond(
                "mass balance at rest with the warm web's density",
                leak,
                "kg/s",
                "rho A = rho_n A_n / (1 + eps) with the free strain inside",
            ),
            beyond(
                "the same with the cold web's density",
                wrong,
                "kg/s",
                "mass appears from nothing: density change belongs in the flow",
            ),
            beyond(
                "tension change of the heated span in the Euclid line",
                change_N[HEATED],
                "N",
                "no speed is held at its ends: idlers turn with the warm web",
            ),
            beyond(
                "tension change in the next span",
                change_N[HEATED + 1],
                "N",
                "the web has cooled; the drives still set the strain at the end",
            ),
        ),
        disagreements=(
            Disagreement(
                what="tension loss at rest",
                first="simulation",
                second="EA alpha dTheta in closed form",
                difference=abs(drop - closed),
                unit="N",
                limit=1e-3,
            ),
        ),
        figures=(draw(panels),),
    )


EXPERIMENTS = (
    Experiment(
        identity="6.thermal",
        chapter=6,
        title="Heated span with density change",
        where="Chapter 6, future work",
        run=run,
    ),
)
