"""Future work: pendulum dancer, linear dancer, accumulator between two driven speeds."""

from __future__ import annotations

from functools import partial

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.elements.pendulum_dancer import span_lever
from sim_plant.line.alone import accumulator_section, dancer_section
from sim_plant.line.alone.accumulator_section import Accumulator, rest_lift_N
from sim_plant.line.alone.dancer_section import (
    Dancer,
    DancerWeb,
    LinearDancer,
    PendulumDancer,
    phasor,
    rest_strain,
)
from sim_plant.reproduce.drawing import Panel, draw
from sim_plant.reproduce.entry import Disagreement, Experiment, Result, beyond
from sim_plant.reproduce.euclid import times

V_IN, V_OUT, EPS_UP, EA_N = 1.0, 1.004, 0.005, 9300.0
FREQUENCIES_HZ = (0.5, 1.0, 2.0, 4.0, 8.0)
SIZE_M_S, STEP_S = 2e-4, 1e-3


def linear() -> tuple[DancerWeb, Dancer]:
    """Return a 2 kg linear dancer with a soft spring."""
    web = DancerWeb(
        EA_N=EA_N,
        strain_upstream=EPS_UP,
        length_in_m=1.0,
        length_out_m=0.8,
        roller_radius_m=0.0381,
        roller_inertia_kg_m2=0.0014,
    )
    pull = EA_N * rest_strain(web, V_IN, V_OUT)
    return web, LinearDancer(
        mass_kg=2.0, load_N=2.0 * pull, stiffness_N_m=300.0, damping_N_s_m=60.0
    )


def pendulum() -> tuple[DancerWeb, Dancer]:
    """Return a dancer on a 0.4 m arm."""
    reach, before, after = -2.0 * 0.0381, (0.25, 0.6), (0.55, 0.6)
    lever_in, length_in = span_lever(0.0, 0.0, 0.4, 0.0, *before, reach, True)
    lever_out, length_out = span_lever(0.0, 0.0, 0.4, 0.0, *after, -reach, False)
    web = DancerWeb(
        EA_N=EA_N,
        strain_upstream=EPS_UP,
        length_in_m=length_in,
        length_out_m=length_out,
        roller_radius_m=0.0381,
        roller_inertia_kg_m2=0.0014,
    )
    pull = EA_N * rest_strain(web, V_IN, V_OUT)
    return web, PendulumDancer(
        inertia_kg_m2=0.5,
        load_N_m=15.0 + (lever_in + lever_out) * pull,
        weight_N_m=15.0,
        damping_N_m_s=8.0,
        arm_m=0.4,
        before_m=before,
        after_m=after,
        reach_in_m=reach,
        reach_out_m=-reach,
    )


def linearised(web: DancerWeb, dancer: Dancer, rest: Array, frequency_Hz: float) -> complex:
    """Return d(strain out)/d(outlet speed) from the Jacobian of the section at rest."""

    def at(state: Array, out: float) -> Array:
        return dancer_section.rates(web, dancer, state, (V_IN, out))

    steps = np.array([1e-7, 1e-7, 1e-6, 1e-6, 1e-6])
    jacobian = np.column_stack(
        [
            (at(rest + d, V_OUT) - at(rest - d, V_OUT)) / (2.0 * s)
            for s, d in zip(steps, np.diag(steps), strict=True)
        ]
    )
    drive = (at(rest, V_OUT + 1e-6) - at(rest, V_OUT - 1e-6)) / 2e-6
    s = 2j * np.pi * frequency_Hz
    return complex(np.linalg.solve(s * np.eye(5) - jacobian, drive)[1])


def dancer_run(kind: str) -> Result:
    """Disturb the outlet speed and see what the dancer takes away."""
    web, dancer = linear() if kind == "linear" else pendulum()
    rest = np.array([rest_strain(web, V_IN, V_OUT)] * 2 + [V_OUT, 0.0, 0.0])
    fixed_rest = rest[:3]
    found, model, fixed = [], [], []
    for f in FREQUENCIES_HZ:

        def speeds(t: float, f: float = f) -> tuple[float, float]:
            return V_IN, V_OUT + SIZE_M_S * float(np.cos(2.0 * np.pi * f * t))

        states = dancer_section.simulate(web, dancer, rest, speeds, 10.0, STEP_S)
        found.append(EA_N * phasor(states[:, 1], STEP_S, f, 2) / SIZE_M_S)
        model.append(EA_N * linearised(web, dancer, rest, f))
        fixed.append(EA_N * without_dancer(web, float(fixed_rest[0]), f))
    gap = float(np.max(np.abs(np.array(found) / np.array(model) - 1.0)))
    frequency = np.array(FREQUENCIES_HZ)
    ratio = 20.0 * np.log10(np.abs(np.array(fixed)) / np.abs(np.array(found)))
    panel = Panel(
        curves={
            "simulated": (frequency, np.abs(found)),
            "linear model": (frequency, np.abs(model)),
            "axis fixed": (frequency, np.abs(fixed)),
        },
        x="frequency [Hz]",
        y="tension over outlet speed [N s/m]",
        log="xy",
        points=("simulated",),
        title=f"{kind} dancer",
    )
    return Result(
        rows=tuple(
            beyond(
                f"ripple taken away at {f:g} Hz",
                float(r),
                "dB",
                "against the same spans with the axis fixed; inertia brings it back above "
                "the dancer's own frequency",
                claim="named as future work",
            )
            for f, r in zip(FREQUENCIES_HZ, ratio, strict=True)
        ),
        disagreements=(
            Disagreement(
                what="tension response, 0.5-8 Hz, complex",
                first="simulation",
                second="linear model",
                difference=gap,
                unit="relative",
                limit=0.02,
            ),
        ),
        figures=(draw([panel]),),
    )


def without_dancer(web: DancerWeb, strain: float, frequency_Hz: float) -> complex:
    """Return d(strain out)/d(outlet speed) with the axis fixed: two spans and an idler."""
    s, grow = 2j * np.pi * frequency_Hz, 1.0 + strain
    spin = web.roller_radius_m**2 * EA_N / web.roller_inertia_kg_m2
    A = np.array(
        [
            [-V_IN / (1.0 + EPS_UP) * grow / web.length_in_m, 0.0, grow / web.length_in_m],
            [V_OUT / web.length_out_m, -V_OUT / web.length_out_m, -grow / web.length_out_m],
            [-spin, spin, 0.0],
        ]
    )
    drive = np.array([0.0, grow / web.length_out_m, 0.0])
    return complex(np.linalg.solve(s * np.eye(3) - A, drive)[1])


def accumulator_run() -> Result:
    """Stop the inlet for a splice: the carriage feeds the line."""
    v = 2.0
    a = Accumulator(
        EA_N=EA_N, strain_upstream=EPS_UP, spans=10, mass_kg=50.0, damping_N_s_m=2000.0
    )
    strain = (1.0 + EPS_UP) * 1.002 - 1.0
    lift = rest_lift_N(a, strain)

    def speeds(t: float) -> tuple[float, float]:
        stop = float(np.clip(min(t - 1.0, 5.0 - t), 0.0, 1.0))
        return v * (1.0 - stop), 1.002 * v

    states = accumulator_section.simulate(
        a, np.array([strain, 1.5, 0.0]), speeds, lift, 8.0, STEP_S
    )
    time = times(len(states), STEP_S)
    pull = EA_N * states[:, 0]
    used = float(states[0, 1] - states[:, 1].min())
    expected = v * 3.0 / a.spans
    panels = [
        Panel(curves={"height": (time, states[:, 1])}, x="time [s]", y="carriage [m]"),
        Panel(curves={"tension": (time, pull)}, x="time [s]", y="tension [N]"),
    ]
    return Result(
        rows=(
            beyond(
                "carriage travel during the splice",
                used,
                "m",
                f"missing inlet length over 10 spans: {expected:.3f} m",
                claim="named as future work",
            ),
            beyond(
                "largest tension change",
                float(np.max(np.abs(pull - pull[0]))),
                "N",
                "carriage inertia and damping against a constant lift",
            ),
        ),
        disagreements=(
            Disagreement(
                what="carriage travel",
                first="simulation",
                second="length balance",
                difference=abs(used - expected),
                unit="m",
                limit=0.02,
            ),
        ),
        figures=(draw(panels),),
    )


EXPERIMENTS = (
    Experiment(
        identity="6.pendulum",
        chapter=6,
        title="Pendulum dancer",
        where="Chapter 6, future work",
        run=partial(dancer_run, "pendulum"),
    ),
    Experiment(
        identity="6.linear",
        chapter=6,
        title="Linear dancer",
        where="Chapter 6, future work",
        run=partial(dancer_run, "linear"),
    ),
    Experiment(
        identity="6.accumulator",
        chapter=6,
        title="Accumulator during a splice",
        where="Chapter 6, future work",
        run=accumulator_run,
    ),
)
