"""Future work: the sampling period of the feed-forward, 1 to 20 ms."""

from __future__ import annotations

import numpy as np

from sim_plant.reproduce.drawing import Panel, draw
from sim_plant.reproduce.entry import ClaimRow, Experiment, Result, beyond
from sim_plant.reproduce.euclid import FPM_M_S, INCH_M, TENSION_N, effect, open_euclid
from sim_plant.reproduce.feed_forward import (
    Loop,
    decibels,
    orders_after,
    run,
    unwind_tension_error,
)
from sim_plant.reproduce.plant_response import measure_response
from sim_plant.reproduce.source_laws import PhasedAff, PrintedAff

PERIODS_S = (0.001, 0.002, 0.005, 0.01, 0.02)
SPEED_M_S, RADIUS_M = 200.0 * FPM_M_S, 6.375 * INCH_M
RECORD_S, LATE_S, ORDERS = 40.0, 26.0, (1, 2, 3, 4)
TENSION, ANGLE = "true_unwind_tension_N", "true_unwind_angle_rad"


def run_all() -> Result:
    """Run (5.14) on the roll angle and the phase-advanced law at five periods."""
    nominal = measure_response(
        lambda: open_euclid(radius_m=RADIUS_M, speed_m_s=SPEED_M_S),
        "unwind",
        "unwind_tension_N",
        np.geomspace(0.4, 9.0, 20),
        SPEED_M_S,
        TENSION_N,
    )
    wrong = effect("out_of_round_roll", "unwind", shape="flat", size_m=0.008)
    before = None
    gains: dict[str, list[list[float]]] = {"basic, H1 alone": [], "ours": []}
    for period in PERIODS_S:
        for name in ("none", *gains):
            if name == "none" and before is not None:
                continue
            loop = None
            if name == "ours":
                loop = _loop(PhasedAff(orders=ORDERS, rate_1_s=0.3, response=nominal))
            elif name != "none":
                loop = _loop(PrintedAff(orders=(1,), gain=0.003))
            line = open_euclid(
                radius_m=RADIUS_M,
                speed_m_s=SPEED_M_S,
                effects=(wrong,),
                seed=6,
                sample_time_s=period,
                settle_s=20.0,
            )
            record = run(line, loop, RECORD_S, SPEED_M_S, (TENSION, ANGLE))
            sizes = orders_after(record, TENSION, ANGLE, ORDERS, LATE_S)
            if name == "none":
                before = sizes
            elif before is not None:
                gains[name].append(decibels(before, sizes))
    table = {name: np.array(rows) for name, rows in gains.items()}
    periods = 1e3 * np.array(PERIODS_S)
    curves = {f"ours, H{n}": (periods, table["ours"][:, n - 1]) for n in ORDERS}
    curves["basic, H1"] = (periods, table["basic, H1 alone"][:, 0])
    panel = Panel(
        curves=curves,
        x="sampling period [ms]",
        y="attenuation [dB]",
        log="x",
        title="200 FPM, 6.375 in, flat spot 8 mm",
    )
    rows: list[ClaimRow] = [
        beyond(
            f"{1e3 * p:g} ms: weakest of H1-H4 (ours)",
            float(np.min(row)),
            "dB",
            "one response, measured at 5 ms, for all periods",
            claim="faster may be better",
        )
        for p, row in zip(PERIODS_S, table["ours"], strict=True)
    ]
    gain = float(np.min(table["ours"][0]) - np.min(table["ours"][2]))
    rows.append(
        beyond(
            "1 ms over 5 ms",
            gain,
            "dB",
            "drive and cell, not the sampling, limit it: half a sample is 2 deg at 1 Hz and 5 ms",
            claim="a faster sampling time might improve",
        )
    )
    return Result(rows=tuple(rows), figures=(draw([panel]),))


def _loop(law: PrintedAff | PhasedAff) -> Loop:
    return Loop(roller="unwind", law=law, error=unwind_tension_error, angle="unwind_angle_rad")


EXPERIMENTS = (
    Experiment(
        identity="6.sampling",
        chapter=6,
        title="Sampling period and feed-forward",
        where="Chapter 6, future work",
        run=run_all,
    ),
)
