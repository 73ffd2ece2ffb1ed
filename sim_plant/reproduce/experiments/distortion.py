"""Section 2.2.2: norms and the model-distortion test on a coast-down, both models of friction."""

from __future__ import annotations

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.identify.driven_roller import Run, response, viscous_only
from sim_plant.identify.roller_run import simulate_roller, with_sensor
from sim_plant.identify.validation import model_distortion, norms
from sim_plant.reproduce.drawing import Panel, draw
from sim_plant.reproduce.entry import Experiment, Result, beyond, row_of_claim
from sim_plant.reproduce.euclid import times

J, C, B = 0.35, 0.15, 0.01
DT_S, NOISE_RAD_S, SEGMENTS, TOLERANCE = 0.02, 0.01, 8, 0.3


def drifting(coast: Run, constant: float, viscous: float, drift: Array) -> Array:
    """Return the coast-down of a model whose b drifts from stretch to stretch."""
    parts, start = [], float(START_RAD_S)
    for rows, factor in zip(
        np.array_split(np.arange(coast.speed_rad_s.size), drift.shape[0]),
        1.0 + drift[:, 0],
        strict=True,
    ):
        piece = Run(
            sample_time_s=DT_S,
            speed_rad_s=np.zeros(rows.size + 1),
            torque_N_m=np.zeros(rows.size + 1),
        )
        speed = response(piece, J, constant, viscous * float(factor), start)
        parts.append(speed[:-1])
        start = float(speed[-1])
    return np.concatenate(parts)


START_RAD_S = 20.0


def run() -> Result:
    """Distort b of both models until they follow one record."""
    clean = simulate_roller(
        inertia_kg_m2=J,
        constant_N_m=C,
        viscous_N_m_s=B,
        torque_N_m=np.zeros(1200),
        sample_time_s=DT_S,
        start_rad_s=START_RAD_S,
    )
    coast = with_sensor(clean, NOISE_RAD_S, 0.0, 5)
    b_only, _ = viscous_only([coast], J)
    models = {"b alone (2.30)": (0.0, b_only), "c and b (2.32)": (C, B)}
    rows = []
    time = times(coast.speed_rad_s.size, DT_S)
    edges = time[:: time.size // SEGMENTS][:SEGMENTS]
    curves, drifts = {"record": (time, coast.speed_rad_s)}, {}
    for name, (constant, viscous) in models.items():

        def simulate(drift: Array, c: float = constant, b: float = viscous) -> Array:
            return drifting(coast, c, b, drift)

        plain = simulate(np.zeros((SEGMENTS, 1)))
        error = norms(coast.speed_rad_s, plain, DT_S)
        found = model_distortion(
            coast.speed_rad_s,
            simulate,
            np.array([TOLERANCE]),
            segments=SEGMENTS,
            noise_sd=NOISE_RAD_S,
        )
        curves[name], drifts[name] = (time, plain), (edges, 100.0 * found.drift[:, 0])
        good = name.startswith("c")
        rows += [
            row_of_claim(
                f"{name}: rms drift of b that explains the record",
                "needs less distortion if the model is close",
                100.0 * found.rms_drift[0],
                "%",
                found.accepted == good,
                f"declared tolerance {100.0 * TOLERANCE:.0f} %: "
                f"{'accepted' if found.accepted else 'rejected'}, misfit {found.misfit:.2f}",
            ),
            beyond(f"{name}: L1", error.l1, "rad", ""),
            beyond(f"{name}: L2", error.l2, "rad2/s", ""),
            beyond(f"{name}: L-infinity", error.linf, "rad/s", ""),
        ]
    panels = [
        Panel(curves=curves, x="time [s]", y="speed [rad/s]", title="one record, two models"),
        Panel(
            curves=drifts,
            x="start of stretch [s]",
            y="drift of b [%]",
            title="smallest drift that explains it",
        ),
    ]
    return Result(rows=tuple(rows), figures=(draw(panels),))


EXPERIMENTS = (
    Experiment(
        identity="2.2.2",
        chapter=2,
        title="Validation norms and model distortion",
        where="Section 2.2.2",
        run=run,
    ),
)
