"""Future work: lines to 20 m/s."""

from __future__ import annotations

from functools import partial

import numpy as np

from sim_plant.reproduce.drawing import Panel, draw
from sim_plant.reproduce.entry import ClaimRow, Experiment, Result, beyond
from sim_plant.reproduce.euclid import INCH_M, TENSION_N, effect, open_euclid
from sim_plant.reproduce.feed_forward import (
    Loop,
    decibels,
    orders_after,
    run,
    unwind_tension_error,
)
from sim_plant.reproduce.plant_response import measure_response
from sim_plant.reproduce.source_laws import PhasedAff, PrintedAff

SPEEDS_M_S = (2.0, 5.0, 10.0, 20.0)
RADIUS_M = 16.0 * INCH_M
RECORD_S, LATE_S, ORDERS = 30.0, 20.0, (1, 2)
SIZE_M = 2e-4
"""Out-of-roundness in orders 1 and 2: a fast line's roll is far rounder than a stack of paper."""
TENSION, ANGLE = "true_unwind_tension_N", "true_unwind_angle_rad"


def run_all() -> Result:
    """Run the basic law on the roll angle and the phase-advanced law at four speeds."""
    wrong = effect(
        "out_of_round_roll", "unwind", shape="orders", cos1_m=SIZE_M, sin2_m=SIZE_M, gravity=0.0
    )
    rows: list[ClaimRow] = []
    curves: dict[str, list[float]] = {f"{n}, H{o}": [] for n in ("basic", "ours") for o in ORDERS}
    for speed in SPEEDS_M_S:
        turn_Hz = speed / (2.0 * np.pi * RADIUS_M)
        orders = np.array([0.7, 0.9, 1.0, 1.15, 1.4, 1.7, 2.0, 2.3])
        plant = measure_response(
            partial(open_euclid, radius_m=RADIUS_M, speed_m_s=speed, settle_s=20.0),
            "unwind",
            "unwind_tension_N",
            turn_Hz * orders,
            speed,
            TENSION_N,
            duration_s=25.0,
        )
        laws = {
            "none": None,
            "basic": PrintedAff(orders=ORDERS, gain=0.004),
            "ours": PhasedAff(orders=ORDERS, rate_1_s=0.5, response=plant),
        }
        sizes = {}
        for name, law in laws.items():
            line = open_euclid(
                radius_m=RADIUS_M, speed_m_s=speed, effects=(wrong,), seed=8, settle_s=20.0
            )
            loop = None
            if law is not None:
                loop = Loop(
                    roller="unwind", law=law, error=unwind_tension_error, angle="unwind_angle_rad"
                )
            record = run(line, loop, RECORD_S, speed, (TENSION, ANGLE))
            sizes[name] = orders_after(record, TENSION, ANGLE, ORDERS, LATE_S)
        phases = [float(np.degrees(np.angle(-plant.at(n * turn_Hz)))) for n in ORDERS]
        for name in ("basic", "ours"):
            gains = decibels(sizes["none"], sizes[name])
            for order, gain in zip(ORDERS, gains, strict=True):
                curves[f"{name}, H{order}"].append(gain)
            rows.append(
                beyond(
                    f"{speed:g} m/s ({turn_Hz:.2f} Hz): weaker of H1, H2, {name}",
                    min(gains),
                    "dB",
                    f"PI alone {sizes['none'][0]:.3g}, {sizes['none'][1]:.3g} N; arg(-P) "
                    f"{phases[0]:+.0f} {phases[1]:+.0f} deg",
                    claim="extension to high speed lines named",
                )
            )
    speeds = np.array(SPEEDS_M_S)
    panel = Panel(
        curves={k: (speeds, np.array(v)) for k, v in curves.items()},
        x="line speed [m/s]",
        y="attenuation [dB]",
        log="x",
        title="16 in roll, 0.2 mm in orders 1 and 2, 5 ms",
    )
    return Result(rows=tuple(rows), figures=(draw([panel]),))


EXPERIMENTS = (
    Experiment(
        identity="6.speed",
        chapter=6,
        title="High-speed lines",
        where="Chapter 6, future work",
        run=run_all,
    ),
)
