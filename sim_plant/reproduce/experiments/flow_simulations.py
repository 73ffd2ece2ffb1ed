"""Fig. 4.11, 4.16, 4.17: the line with the wooden insert under three formulas of the flow."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from sim_plant.base.arrays import Array, LineArrays
from sim_plant.base.order_tracking import order_amplitudes
from sim_plant.effects.shape_rows import add_shape
from sim_plant.geometry.roll_profiles import wooden_insert
from sim_plant.geometry.shapes import Shape
from sim_plant.reproduce.drawing import Panel, bars, draw
from sim_plant.reproduce.entry import Disagreement, Experiment, Result, beyond, row_of_claim
from sim_plant.reproduce.euclid import (
    FPM_M_S,
    INCH_M,
    TENSION_N,
    body,
    nominal,
    open_euclid,
    times,
)
from sim_plant.reproduce.experiments.supply import Supply, supply_of

ComplexArray = npt.NDArray[np.complex128]
RADIUS_M, SPEED_M_S = 8.0 * INCH_M, 200.0 * FPM_M_S
ORDERS = (1, 2, 3, 4)
PROBE_M = 2e-4
RECORD_S, FORGET_S, DT_S = 24.0, 8.0, 0.002


def insert_shape() -> Shape:
    """Return the roll wound on the source's insert."""
    return wooden_insert(5.5 * INCH_M, 3.0 * INCH_M, 0.5 * INCH_M, RADIUS_M)


def simulate(extra: Array, shape: Shape | None, turn_rad: float) -> tuple[Array, Array, Array]:
    """Return time, unwind tension and roll angle with ``extra`` added to the roll's supply.

    ``extra`` is one turn of m/rad, its theta turned by ``turn_rad`` against the line's. It enters
    as a velocity at the roll's surface, its mean over each 2 ms by the integral over theta. With
    a shape the line is exact without it; without one the roll is round.
    """

    def shaped(arrays: LineArrays) -> LineArrays:
        return arrays if shape is None else add_shape(arrays, 0, shape)

    line = open_euclid(radius_m=RADIUS_M, speed_m_s=SPEED_M_S, change=shaped, sample_time_s=DT_S)
    table = _integral(extra)
    unwind, slot = body(line, "unwind"), line.layout.bounce + 1
    rows = round(RECORD_S / DT_S)
    tension, angle = np.empty(rows), np.empty(rows)
    inputs = {"line_speed_ref_m_s": SPEED_M_S, "tension_ref_N": TENSION_N}
    for k in range(rows):
        here = float(line.angles()[unwind]) - turn_rad
        omega = float(line.state.y[line.layout.omega + unwind])
        line.state.y[slot] = (_at(table, here + omega * DT_S) - _at(table, here)) / DT_S
        tension[k] = line.step(inputs)["true_unwind_tension_N"]
        angle[k] = line.angles()[unwind]
    return times(rows, DT_S), tension, angle


def orders_of(record: tuple[Array, Array, Array]) -> ComplexArray:
    """Return complex orders 1-4 of the tension after the start is forgotten."""
    time, tension, angle = record
    late = time >= FORGET_S
    return np.asarray(order_amplitudes(tension[late], angle[late], ORDERS), np.complex128)


def _integral(curve: Array) -> Array:
    """Return the integral of one periodic turn over theta, mean removed, first point repeated."""
    spectrum = np.fft.rfft(curve)
    order = np.arange(spectrum.size)
    order[0] = 1
    spectrum = spectrum / (1j * order)
    spectrum[0] = 0.0
    wave = np.fft.irfft(spectrum, curve.size)
    return np.append(wave, wave[0])


def _at(table: Array, theta: float) -> float:
    """Return the table at an angle, linear between points."""
    position = (theta / (2.0 * np.pi)) % 1.0 * (table.size - 1)
    k = min(int(position), table.size - 2)
    return float(table[k] + (position - k) * (table[k + 1] - table[k]))


def turn_to_line_rad() -> float:
    """Return how far the line's first span stands from that of ``supply_of``, rad."""
    across = RADIUS_M + nominal().rollers[1].radius_m
    own = np.arcsin(across / np.hypot(nominal().spans[0].length_m, across))
    return float(np.radians(nominal().spans[0].direction_deg) - own)


def predicted_error(supply: Supply) -> ComplexArray:
    """Return the tension error of (4.46) in orders 1-4 from the line's frequency response.

    Four sines of supply on a line with a round roll give tension over supply at n w; times the
    Fourier coefficients of the supply error. Phases turn with the span's direction.
    """
    probe = sum(np.cos(n * supply.theta_rad + n * n) for n in ORDERS) * PROBE_M
    response = orders_of(simulate(np.asarray(probe), None, 0.0)) / PROBE_M
    response = response / np.exp(1j * np.array([n * n for n in ORDERS]))
    error = 2.0 * np.fft.rfft(supply.arc_length - supply.exact) / supply.theta_rad.size
    turn = np.exp(-1j * np.array(ORDERS) * turn_to_line_rad())
    return np.asarray(response * error[list(ORDERS)] * turn)


def run() -> Result:
    """Simulate all three and compare harmonics with each other and with the frequency domain."""
    supply = supply_of(insert_shape(), nominal().rollers[1].radius_m, nominal().spans[0].length_m)
    formulas = {
        "peripheral speed (4.11)": supply.peripheral,
        "arc length (4.46)": supply.arc_length,
        "exact": supply.exact,
    }
    spectra, panels_x, phasors = {}, {}, {}
    for name, curve in formulas.items():
        record = simulate(curve - supply.exact, insert_shape(), turn_to_line_rad())
        time, tension, _ = record
        phasors[name] = orders_of(record)
        spectra[name] = np.abs(phasors[name]).tolist()
        show = (time >= FORGET_S) & (time < FORGET_S + 4.0)
        panels_x[name] = (time[show], tension[show])
    exact = np.array(spectra["exact"])
    arc = np.abs(phasors["arc length (4.46)"] - phasors["exact"]) / exact
    outer = np.abs(phasors["peripheral speed (4.11)"] - phasors["exact"]) / exact
    difference = phasors["arc length (4.46)"] - phasors["exact"]
    gap = float(np.linalg.norm(predicted_error(supply) - difference) / np.linalg.norm(difference))
    degrees = np.degrees(supply.theta_rad)
    panels = [
        Panel(curves=panels_x, x="time [s]", y="unwind tension [N]", title="Fig. 4.11, 4.17"),
        Panel(
            curves={
                "peripheral d_ex": (degrees, supply.exit_distance),
                "dl/dt": (degrees, supply.flow),
                "dL/dt": (degrees, supply.length_rate),
                "p": (degrees, supply.exact),
            },
            x="theta [deg]",
            y="at 1 rad/s [m/s]",
            title="Fig. 4.16",
        ),
    ]
    return Result(
        rows=(
            row_of_claim(
                "peripheral speed: H1-H4 over exact, largest",
                "larger oscillations (Fig. 4.11)",
                float(np.max(np.array(spectra["peripheral speed (4.11)"]) / exact)),
                "-",
                bool(np.max(outer) > 1.0),
                "length variation that nothing compensates; the web even goes slack",
            ),
            row_of_claim(
                "arc length: error of H1",
                "better correlation (Fig. 4.17)",
                100.0 * float(arc[0]),
                "%",
                bool(arc[0] < outer[0]),
                "better than peripheral speed, yet not exact",
            ),
            row_of_claim(
                "arc length: error of H4",
                "appropriate simulation",
                100.0 * float(arc[3]),
                "%",
                bool(arc[3] < 0.01),
                "the next contact point wanders, n R_B / L of the supply;"
                " less of the ripple, which the arm of the tension makes too",
            ),
            beyond("exact identity: H1", exact[0], "N", "moment arm alone"),
            beyond("exact identity: H2", exact[1], "N", ""),
        ),
        disagreements=(
            Disagreement(
                what="tension error of (4.46), H1-H4, complex",
                first="simulation",
                second="frequency response times supply error",
                difference=gap,
                unit="relative",
                limit=0.2,
            ),
        ),
        figures=(draw(panels), bars(spectra, [f"H{n}" for n in ORDERS], "tension [N]", log=True)),
    )


EXPERIMENTS = (
    Experiment(
        identity="4.11",
        chapter=4,
        title="Simulation under three formulas of the flow",
        where="Fig. 4.11, 4.16, 4.17",
        run=run,
    ),
)
