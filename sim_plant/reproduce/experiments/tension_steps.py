"""Fig. 2.7 and 2.8: tension steps of the ideal model, at rest and under way."""

from __future__ import annotations

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.identify.validation import norms
from sim_plant.line.running.simulation import LineSimulation
from sim_plant.reproduce.drawing import Panel, draw
from sim_plant.reproduce.entry import Disagreement, Experiment, Result, beyond, row_of_claim
from sim_plant.reproduce.euclid import FPM_M_S, INCH_M, LBF_N, effect, open_euclid, times

STEP_S, START_N, STEP_N = 5.0, 10.0 * LBF_N, 20.0 * LBF_N
DURATION_S = 25.0
RADIUS_M = 6.375 * INCH_M


def run_step(line: LineSimulation, speed_m_s: float) -> tuple[Array, Array]:
    """Return time and unwind tension for a step of the reference by 20 lbf."""
    time = times(round(DURATION_S / line.sample_time_s), line.sample_time_s)
    reference = np.where(time >= STEP_S, START_N + STEP_N, START_N)
    record = line.simulate(np.full(time.size, speed_m_s), reference)
    return time, record["true_unwind_tension_N"]


def overshoot_percent(tension_N: Array) -> float:
    """Return the overshoot over the step."""
    return 100.0 * (float(np.max(tension_N)) - START_N - STEP_N) / STEP_N


def settling_s(time: Array, tension_N: Array) -> float:
    """Return when the tension stays within 2 % of the step, from the step on."""
    outside = np.abs(tension_N - START_N - STEP_N) > 0.02 * STEP_N
    return float(time[np.flatnonzero(outside)[-1]]) - STEP_S


def at_rest() -> Result:
    """Step at zero line speed."""
    line = open_euclid(radius_m=RADIUS_M, speed_m_s=0.0, tension_N=START_N)
    time, tension = run_step(line, 0.0)
    fine = open_euclid(radius_m=RADIUS_M, speed_m_s=0.0, tension_N=START_N, substeps=4)
    _, same = run_step(fine, 0.0)
    late = time > DURATION_S - 5.0
    ripple = float(np.std(tension[late]))
    offset = abs(float(np.mean(tension[late])) - START_N - STEP_N)
    return Result(
        rows=(
            row_of_claim(
                "steady error after the step",
                "simulated data follow closely",
                offset,
                "N",
                offset < 0.2,
                "the tension PI removes it",
            ),
            row_of_claim(
                "ripple at rest, rms",
                "no speed-induced disturbance",
                ripple,
                "N",
                ripple < 0.05,
                "nothing turns",
            ),
            beyond(
                "overshoot",
                overshoot_percent(tension),
                "%",
                "made by the zero of the PI at 10 rad/s",
                claim="picture only",
            ),
            beyond("settling to 2 %", settling_s(time, tension), "s", "", claim="picture only"),
        ),
        disagreements=(
            Disagreement(
                what="tension over the whole step",
                first="Runge-Kutta, 1 ms",
                second="Runge-Kutta, 0.25 ms",
                difference=float(np.max(np.abs(tension - same))),
                unit="N",
                limit=1e-2,
            ),
        ),
        figures=(draw([_panel({"ideal model": (time, tension)}, "20 lbf step at rest")]),),
    )


def under_way() -> Result:
    """Step at 200 FPM: ideal model beside the same line with what is wrong with it."""
    speed = 200.0 * FPM_M_S
    wrong = (
        effect("out_of_round_roll", "unwind", shape="flat", size_m=0.012),
        effect("eccentric_roller", "swrap_lead", eccentricity_m=0.0005),
    )
    records = [
        run_step(
            open_euclid(radius_m=RADIUS_M, speed_m_s=speed, tension_N=START_N, effects=effects),
            speed,
        )
        for effects in ((), wrong)
    ]
    (time, ideal), (_, real) = records
    late = time > DURATION_S - 10.0
    mean_gap = abs(float(np.mean(real[late] - ideal[late])))
    ripples = [float(np.std(tension[late])) for tension in (ideal, real)]
    error = norms(real, ideal, time[1] - time[0])
    return Result(
        rows=(
            row_of_claim(
                "mean tension, ideal against the line with faults",
                "follows the average value",
                mean_gap,
                "N",
                mean_gap < 0.5,
                "loops hold the mean; faults add ripple only",
            ),
            row_of_claim(
                "ripple of the ideal model, rms",
                "does not reproduce the oscillations",
                ripples[0],
                "N",
                ripples[0] < 0.05 * ripples[1],
                f"the line with faults has {ripples[1]:.3g} N",
            ),
            beyond("overshoot of the ideal model", overshoot_percent(ideal), "%", ""),
            beyond("L1 of the error", error.l1, "N s", "section 2.2.2"),
            beyond("L2 of the error", error.l2, "N2 s", "section 2.2.2"),
            beyond("L-infinity of the error", error.linf, "N", "section 2.2.2"),
        ),
        figures=(
            draw(
                [
                    _panel(
                        {"line with faults": (time, real), "ideal model": (time, ideal)},
                        "20 lbf step at 200 FPM",
                    )
                ]
            ),
        ),
        notes=(
            "The recorded line stands in for the source's experiment: the declared line with "
            "a 12 mm flat spot and an S-wrap lead 0.5 mm off centre.",
        ),
    )


def _panel(curves: dict[str, tuple[Array, Array]], title: str) -> Panel:
    return Panel(curves=curves, x="time [s]", y="unwind tension [N]", title=title)


EXPERIMENTS = (
    Experiment(
        identity="2.7",
        chapter=2,
        title="Tension step at rest, ideal model",
        where="Fig. 2.7, (2.22)-(2.25)",
        run=at_rest,
    ),
    Experiment(
        identity="2.8",
        chapter=2,
        title="Tension step under way, ideal model",
        where="Fig. 2.8",
        run=under_way,
    ),
)
