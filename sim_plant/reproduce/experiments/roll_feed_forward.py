"""Fig. 5.12-5.15: three shapes, two webs, 100 FPM, 8 in: printed law, on the angle, ours."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, partial

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.line.linear.frequency import response as frequency_response
from sim_plant.line.running.simulation import LineSimulation
from sim_plant.reproduce.drawing import Panel, bars, draw
from sim_plant.reproduce.entry import (
    ClaimRow,
    Disagreement,
    Experiment,
    Result,
    beyond,
    row_of_claim,
)
from sim_plant.reproduce.euclid import (
    FPM_M_S,
    INCH_M,
    TENSION_N,
    declaration,
    effect,
    open_euclid,
    spectrum,
)
from sim_plant.reproduce.feed_forward import (
    Law,
    Loop,
    Readings,
    decibels,
    orders_after,
    run,
    unwind_tension_error,
)
from sim_plant.reproduce.plant_response import PlantResponse, measure_response
from sim_plant.reproduce.source_laws import PhasedAff, PrintedAff

SPEED_M_S, RADIUS_M = 100.0 * FPM_M_S, 8.0 * INCH_M
RECORD_S, LATE_S, ORDERS = 90.0, 62.0, (1, 2, 3, 4)
TENSION, ANGLE = "true_unwind_tension_N", "true_unwind_angle_rad"
PRINTED_GAIN, RATE_1_S = 0.002, 0.2
"""One gain for all shapes and webs, as in the source: (m/s)/(N s); and 1/s of our law."""
PROBE_HZ = np.sort(np.append(np.geomspace(0.2, 9.0, 24), 0.39789 * np.array(ORDERS)))


@dataclass(frozen=True, slots=True)
class Case:
    """A figure of section 5.2."""

    identity: str
    web: str
    shape: str
    size_m: float
    text: str


CASES = (
    Case("5.12", "tyvek", "flattened_bulge", 0.005, "shape 1, flattened bulge, Tyvek"),
    Case("5.13", "tyvek", "bulge", 0.005, "shape 2, bulge, Tyvek"),
    Case("5.14", "tyvek", "asym", 0.006, "shape 3, asymmetric, Tyvek"),
    Case("5.15", "pe", "flattened_bulge", 0.005, "shape 1, flattened bulge, polyethylene"),
)


@cache
def response(web: str) -> PlantResponse:
    """Return P of the line with this web and a round roll, measured once."""
    return measure_response(
        lambda: open_euclid(web=web, radius_m=RADIUS_M, speed_m_s=SPEED_M_S),
        "unwind",
        "unwind_tension_N",
        PROBE_HZ,
        SPEED_M_S,
        TENSION_N,
    )


def line_of(case: Case) -> LineSimulation:
    """Return the line with the case's roll, sensors noisy."""
    wrong = effect("out_of_round_roll", "unwind", shape=case.shape, size_m=case.size_m)
    return open_euclid(
        web=case.web, radius_m=RADIUS_M, speed_m_s=SPEED_M_S, effects=(wrong,), seed=4
    )


def loops(web: str) -> dict[str, Loop | None]:
    """Return PI alone and the laws: printed, printed on a radius 1 % off, on the angle, ours."""

    def loop(law: Law, believed: float | None = None) -> Loop:
        rate = None if believed is None else partial(_turning, believed)
        return Loop(
            roller="unwind",
            law=law,
            error=unwind_tension_error,
            angle="unwind_angle_rad",
            psi_rate_rad_s=rate,
        )

    def printed() -> PrintedAff:
        return PrintedAff(orders=ORDERS, gain=PRINTED_GAIN)

    ours = PhasedAff(orders=ORDERS, rate_1_s=RATE_1_S, response=response(web))
    return {
        "PI alone": None,
        "printed (5.14)": loop(printed(), 1.0),
        "printed, radius +1 %": loop(printed(), 1.01),
        "on roll angle": loop(printed()),
        "ours": loop(ours),
    }


def _turning(believed: float, readings: Readings) -> float:
    """Return omega of (5.9) from line speed and measured radius, ``believed`` times the true."""
    return readings["line_speed_m_s"] / (believed * readings["unwind_radius_m"])


def run_case(case: Case) -> Result:
    """Run PI alone and the laws; compare orders 1-4 on the roll's angle."""
    amplitudes: dict[str, Array] = {}
    curves = {}
    for name, loop in loops(case.web).items():
        record = run(line_of(case), loop, RECORD_S, SPEED_M_S, (TENSION, ANGLE))
        amplitudes[name] = orders_after(record, TENSION, ANGLE, ORDERS, LATE_S)
        late = record["time_s"] >= LATE_S
        frequency, amplitude = spectrum(record[TENSION][late], 0.005, 3.0)
        curves[name] = (frequency, np.maximum(amplitude, 1e-4))
    before = amplitudes["PI alone"]
    gains = {name: decibels(before, a) for name, a in amplitudes.items() if name != "PI alone"}
    turn_Hz = SPEED_M_S / (2.0 * np.pi * RADIUS_M)
    errors = [float(np.degrees(np.angle(-response(case.web).at(n * turn_Hz)))) for n in ORDERS]
    simulated = [g > 0.0 for g in gains["on roll angle"]]
    foretold = [abs(e) < 90.0 for e in errors]
    panel = Panel(
        curves=curves, x="frequency [Hz]", y="unwind tension [N]", log="y", title=case.text
    )
    return Result(
        rows=tuple(_rows(case, gains, before, errors)),
        disagreements=(
            Disagreement(
                what="orders 1-4 that the unshifted law attenuates",
                first="simulation on the angle",
                second="|arg(-P)| < 90 deg",
                difference=float(sum(a != b for a, b in zip(simulated, foretold, strict=True))),
                unit="orders",
                limit=0.0,
            ),
            Disagreement(
                what="P at H1-H4, complex",
                first="simulation, sum of sines",
                second="frequency domain",
                difference=_response_gap(case.web, turn_Hz),
                unit="relative",
                limit=0.03,
            ),
        ),
        figures=(draw([panel]), bars(gains, [f"H{n}" for n in ORDERS], "attenuation [dB]")),
    )


def _response_gap(web: str, turn_Hz: float) -> float:
    """Return the largest relative difference of both responses at orders 1-4."""
    frequency = turn_Hz * np.array(ORDERS)
    model = frequency_response(
        declaration(web, RADIUS_M), "unwind", "unwind_tension_N", frequency, SPEED_M_S
    )
    simulated = np.array([response(web).at(float(f)) for f in frequency])
    return float(np.max(np.abs(simulated / model - 1.0)))


def _rows(
    case: Case, gains: dict[str, list[float]], before: Array, errors: list[float]
) -> list[ClaimRow]:
    printed, angle, ours = gains["printed (5.14)"], gains["on roll angle"], gains["ours"]
    wrong = gains["printed, radius +1 %"]
    phases = " ".join(f"{e:+.0f}" for e in errors)
    rows = [
        row_of_claim(
            f"printed law: H{n}",
            "very well",
            printed[n - 1],
            "dB",
            printed[n - 1] > 10.0,
            f"PI alone {before[n - 1]:.3g} N; arg(-P) of H1-H4: {phases} deg",
        )
        for n in (1, 2)
    ]
    rows += [
        row_of_claim(
            "printed law: H3",
            "not as good, its frequency moves faster",
            printed[2],
            "dB",
            0.0 < printed[2] < printed[0] - 10.0,
            f"a radius tag 1 % off gives {wrong[0]:.0f} {wrong[1]:.0f} {wrong[2]:.0f} dB, this "
            "picture; else it is the phase of P, not the changing frequency",
        ),
        row_of_claim(
            "printed law: H4",
            "stable with small gain, no retuning",
            printed[3],
            "dB",
            printed[3] > 0.0,
            "needs |arg(-P)| < 90 deg, however small the gain",
        ),
    ]
    rows += [
        beyond(
            f"printed law, radius believed 1 % large: H{n}",
            wrong[n - 1],
            "dB",
            "the angle from v / R runs away: 1 % is one turn in a hundred",
            claim="robust, no retuning",
        )
        for n in ORDERS
    ]
    rows += [
        beyond(
            f"same law on the roll angle: H{n}",
            angle[n - 1],
            "dB",
            "strain, radius and shape errors drop out",
        )
        for n in ORDERS
    ] + [
        beyond(f"with measured P (ours): H{n}", ours[n - 1], "dB", "one rate for all orders, webs")
        for n in ORDERS
    ]
    return rows


EXPERIMENTS = tuple(
    Experiment(
        identity=case.identity,
        chapter=5,
        title=f"Feed-forward on tension: {case.text}",
        where=f"Fig. {case.identity}, (5.14)",
        run=partial(run_case, case),
    )
    for case in CASES
)
