"""(2.27)-(2.46) on recorded data: inertia, driven friction, idler friction, Table 2.2."""

from __future__ import annotations

import numpy as np

from sim_plant.identify.driven_roller import coast_downs, fit_driven_roller, response
from sim_plant.identify.idler_friction import (
    Plateau,
    fit_idler_friction,
    plateaus,
    rollers_between_cells,
)
from sim_plant.identify.roller_run import run_up_and_coast, simulate_roller, with_sensor
from sim_plant.reproduce.drawing import Panel, draw
from sim_plant.reproduce.entry import Disagreement, Experiment, Result, beyond, row_of_claim
from sim_plant.reproduce.euclid import (
    FPM_M_S,
    LBF_FT_N_M,
    LBF_N,
    nominal,
    open_euclid,
    steady,
    times,
)

SPEEDS_FPM = (100.0, 150.0, 200.0, 250.0, 300.0, 350.0)
TABLE_OMEGA = np.array([13.33, 20.0, 26.66, 33.33, 40.0, 46.66])
TABLE_DROP_LBF = np.array([0.755, 0.84, 0.905, 0.865, 0.935, 0.97])
IDLER_RADIUS_M = 0.0381


def driven() -> Result:
    """Inertia by run-up, friction by coast-down, of the S-wrap lead without web."""
    roller = nominal().rollers[nominal().body("swrap_lead")]
    truth = (roller.inertia_kg_m2, roller.friction_constant_N_m, roller.friction_viscous_N_m_s)
    clean = simulate_roller(
        inertia_kg_m2=truth[0],
        constant_N_m=truth[1],
        viscous_N_m_s=truth[2],
        torque_N_m=run_up_and_coast(2.0, 5.0, 40.0, 0.01),
        sample_time_s=0.01,
    )
    run = with_sensor(clean, 5e-4, 2e-3, 3)
    fit = fit_driven_roller([run])
    (coast,) = coast_downs(run)
    keep = coast.speed_rad_s > 1.5
    time = times(coast.speed_rad_s.size, 0.01)
    start = float(coast.speed_rad_s[0])
    viscous = response(coast, truth[0], 0.0, fit.viscous_only_N_m_s, start)
    full = response(
        coast, fit.inertia_kg_m2.value, fit.constant_N_m.value, fit.viscous_N_m_s.value, start
    )
    gain = fit.viscous_only_residual_rad_s / fit.residual_rad_s
    off = fit.nominal_inertia_kg_m2 / truth[0] - 1.0
    panel = Panel(
        curves={
            "record": (time, coast.speed_rad_s),
            "b alone (2.31)": (time, viscous),
            "c and b (2.33)": (time[keep], full[keep]),
        },
        x="time [s]",
        y="speed [rad/s]",
        title="Fig. 2.5: free run-out",
    )
    return Result(
        rows=(
            row_of_claim(
                "J by tau_n t_n / w_n (2.29), error",
                "gives the inertia",
                100.0 * off,
                "%",
                abs(off) < 0.01,
                "friction takes part of the nominal torque",
            ),
            beyond(
                "J by run-up and coast-down together, error",
                100.0 * (fit.inertia_kg_m2.value / truth[0] - 1.0),
                "%",
                fit.inertia_kg_m2.text(),
            ),
            row_of_claim(
                "fit error of b alone over c and b",
                "visible improvement",
                gain,
                "-",
                gain > 3.0,
                "a constant term cannot be mimicked by an exponential",
            ),
            beyond(
                "c, error",
                100.0 * (fit.constant_N_m.value / truth[1] - 1.0),
                "%",
                fit.constant_N_m.text(),
            ),
            beyond(
                "b, error",
                100.0 * (fit.viscous_N_m_s.value / truth[2] - 1.0),
                "%",
                fit.viscous_N_m_s.text(),
            ),
        ),
        figures=(draw([panel]),),
    )


def table() -> Result:
    """Table 2.2 with the divisor as printed, 7, and as derived, 6."""
    points = [
        Plateau(omega_rad_s=float(w), tension_drop_N=float(d) * LBF_N, standard_error_N=0.02)
        for w, d in zip(TABLE_OMEGA, TABLE_DROP_LBF, strict=True)
    ]
    radius = 1.5 * 0.0254
    fits = {n: fit_idler_friction(points, radius, float(n)) for n in (7, 6)}
    in_lbf = {
        n: (f.constant_N_m.value / LBF_FT_N_M, f.viscous_N_m_s.value / LBF_FT_N_M)
        for n, f in fits.items()
    }
    # (2.45) by its normal equations, apart from the tool
    torque = 0.125 * TABLE_DROP_LBF / 7.0
    slope, level = np.polyfit(TABLE_OMEGA, torque, 1)
    gap = max(abs(slope - in_lbf[7][1]), abs(level - in_lbf[7][0]))
    curves = {
        "Table 2.2 / 7": (TABLE_OMEGA, torque),
        "Table 2.2 / 6": (TABLE_OMEGA, torque * 7.0 / 6.0),
    }
    for n, (c, b) in in_lbf.items():
        curves[f"c + b w, divisor {n}"] = (TABLE_OMEGA, c + b * TABLE_OMEGA)
    panel = Panel(
        curves=curves,
        x="idler speed [rad/s]",
        y="torque [lbf ft]",
        points=("Table 2.2 / 7", "Table 2.2 / 6"),
        title="Table 2.2",
    )
    return Result(
        rows=(
            row_of_claim(
                "c, divisor 7 as printed",
                "0.0127 lbf ft",
                in_lbf[7][0],
                "lbf ft",
                abs(in_lbf[7][0] - 0.0127) < 1e-4,
                "regression of the printed table",
            ),
            row_of_claim(
                "b, divisor 7 as printed",
                "1.054e-4 lbf ft s",
                in_lbf[7][1],
                "lbf ft s",
                abs(in_lbf[7][1] - 1.054e-4) < 1e-6,
                "the printed b is 4 % high",
            ),
            row_of_claim(
                "c, divisor 6 as derived",
                "0.0127 lbf ft",
                in_lbf[6][0],
                "lbf ft",
                abs(in_lbf[6][0] - 0.0127) < 1e-4,
                "cells read means of their spans: 1/2 + 5 + 1/2 = 6 rollers lie between",
            ),
            row_of_claim(
                "b, divisor 6 as derived",
                "1.054e-4 lbf ft s",
                in_lbf[6][1],
                "lbf ft s",
                abs(in_lbf[6][1] - 1.054e-4) < 1e-6,
                "7/6 of the regression by 7",
            ),
        ),
        disagreements=(
            Disagreement(
                what="c and b of Table 2.2",
                first="identify",
                second="normal equations",
                difference=gap,
                unit="lbf ft",
                limit=1e-8,
            ),
        ),
        figures=(draw([panel]),),
    )


def idlers() -> Result:
    """Follow (2.34)-(2.45) on simulated multi-speed records with sensor noise."""
    roller = nominal().rollers[1]
    points = []
    for number, fpm in enumerate(SPEEDS_FPM):
        line = open_euclid(speed_m_s=fpm * FPM_M_S, seed=number, settle_s=20.0)
        r = steady(line, 30.0, fpm * FPM_M_S)
        points += plateaus(
            r["time_s"],
            r["line_speed_m_s"],
            r["unwind_tension_N"],
            r["r3_tension_N"],
            IDLER_RADIUS_M,
            settle_s=1.0,
        )
    fits = {
        n: fit_idler_friction(points, IDLER_RADIUS_M, n) for n in (7.0, rollers_between_cells(5))
    }
    truth = (roller.friction_constant_N_m, roller.friction_viscous_N_m_s)
    errors = {
        n: [
            100.0 * (e.value / t - 1.0)
            for e, t in zip((f.constant_N_m, f.viscous_N_m_s), truth, strict=True)
        ]
        for n, f in fits.items()
    }
    omega = np.array(fits[6.0].omega_rad_s)
    curves = {f"divisor {n:g}": (omega, np.array(f.torque_N_m)) for n, f in fits.items()}
    curves["truth"] = (omega, truth[0] + truth[1] * omega)
    panel = Panel(
        curves=curves,
        x="idler speed [rad/s]",
        y="torque [N m]",
        points=("divisor 7", "divisor 6"),
        title="records at six speeds",
    )
    return Result(
        rows=(
            row_of_claim(
                "c with divisor 7, error",
                "average friction torque (2.43)",
                errors[7.0][0],
                "%",
                abs(errors[7.0][0]) < 5.0,
                "one seventh too small",
            ),
            beyond("c with divisor 6, error", errors[6.0][0], "%", fits[6.0].constant_N_m.text()),
            beyond("b with divisor 6, error", errors[6.0][1], "%", fits[6.0].viscous_N_m_s.text()),
            row_of_claim(
                "tension downstream minus upstream at 200 FPM",
                "T1 - T2 > 0, 1 upstream (2.41)",
                points[2].tension_drop_N,
                "N",
                points[2].tension_drop_N < 0.0,
                "drag raises tension downstream: cell 1 must be R9",
            ),
        ),
        figures=(draw([panel]),),
    )


EXPERIMENTS = (
    Experiment(
        identity="2.5",
        chapter=2,
        title="Driven roller: inertia and friction",
        where="Fig. 2.5, (2.27)-(2.33)",
        run=driven,
    ),
    Experiment(
        identity="T2.2",
        chapter=2,
        title="Idler friction from Table 2.2, both divisors",
        where="Table 2.2, (2.42)-(2.46)",
        run=table,
    ),
    Experiment(
        identity="2.45",
        chapter=2,
        title="Idler friction from simulated records",
        where="(2.34)-(2.45)",
        run=idlers,
    ),
)
