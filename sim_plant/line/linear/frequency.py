"""The closed loop of a declared line in the frequency domain, independent of the kernel.

Assembled from the declaration alone: frozen radii, round bodies, small signals about the steady
state. Unknowns per frequency are the angular speeds and the strains, then travels of carriages
and warming of spans. Sampled controllers enter
with their own pulse transfer function and hold; images above half their rate are left out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array
from sim_plant.line.arrays.build import cell_sensors
from sim_plant.line.declared.declaration import CarriagePosition, Declaration, DriveSpeed, LoadCell
from sim_plant.line.declared.laws import sign_of
from sim_plant.line.linear.frequency_bodies import SmallBodies, tension_rows
from sim_plant.line.rest.operating_point import SteadyLine, friction_of, inertias_of, steady_line

ComplexArray = npt.NDArray[np.complex128]


def response(
    declaration: Declaration,
    drive_roller: str,
    channel: str,
    frequencies_Hz: Array,
    line_speed_m_s: float,
    *,
    tension_N: float | None = None,
    sample_time_s: float | None = None,
) -> ComplexArray:
    """Return P(jw) from a velocity-reference correction at a drive to a recorded channel.

    The correction is a sequence at the control sample time, each value held for one sample; the
    channel is read at the instants the values start to act. P is the ratio of the two phasors.

    Parameters
    ----------
    drive_roller : a driven roller.
    channel : a tension (P in N s/m), a speed (per m/s of correction) or a travel of ``sensors``.
    frequencies_Hz : shape (f,), below half the control rate, above 0.
    tension_N : tension reference; the declared operating point when None.
    sample_time_s : control sample time; the declared one when None.

    Raises
    ------
    PlantError
        When the roller has no drive, the channel is nothing of these, or nothing is at rest.
    """
    where = {d.roller: k for k, d in enumerate(declaration.control.drives)}
    if drive_roller not in where:
        raise PlantError(f"roller {drive_roller!r} has no drive; expected one of {sorted(where)}")
    sensor = next((s for s in declaration.sensors if s.channel == channel), None)
    if not isinstance(sensor, LoadCell | DriveSpeed | CarriagePosition):
        raise PlantError(f"channel {channel!r} is no tension, speed or travel of this line")
    tension = declaration.operating_point.tension_N if tension_N is None else tension_N
    rest = steady_line(declaration, line_speed_m_s, tension)
    sample = sample_time_s or declaration.sample_time_s
    result = np.empty(len(frequencies_Hz), dtype=np.complex128)
    for row, frequency in enumerate(frequencies_Hz):
        net = _Network.at(declaration, rest, 2j * math.pi * float(frequency))
        result[row] = net.read(sensor, net.solve(where[drive_roller], sample))
    return result


def hold_factor(s: complex, period_s: float, tick_s: float) -> complex:
    """Return the share of a sine that survives sampling at ``period_s``, seen every ``tick_s``.

    (1 - z^-N) / (N (1 - z^-1)) with z = exp(s tick) and N ticks to the period.
    """
    count = round(period_s / tick_s)
    return complex((1.0 - np.exp(-s * period_s)) / (count * (1.0 - np.exp(-s * tick_s))))


@dataclass(frozen=True, slots=True, kw_only=True)
class _Network:
    """The line at one complex frequency: A x = b, x = angular speeds (n), then strains."""

    line: Declaration
    s: complex
    A: ComplexArray
    tensions: ComplexArray  # (n - 1, unknowns) from the unknowns, N
    more: SmallBodies | None
    torque_per_reference: ComplexArray  # (d,) N m per m/s at each drive

    @classmethod
    def at(cls, line: Declaration, rest: SteadyLine, s: complex) -> _Network:
        more = SmallBodies.at(line, rest, s)
        tensions = tension_rows(line, s, more)
        A = np.zeros((tensions.shape[1],) * 2, dtype=np.complex128)
        _add_bodies(A, line, rest, s, tensions)
        if more is None:
            _add_spans(A, line, rest, s)
        else:
            for i in range(len(line.spans)):
                more.add_span(A, i)
            more.add_carriages(A, tensions)
            more.add_heat(A)
        gains = _add_drives(A, line, rest, s)
        net = cls(line=line, s=s, A=A, tensions=tensions, more=more, torque_per_reference=gains)
        net.close_loops()
        return net

    def close_loops(self) -> None:
        """Feed cells and travels back to drives: v = -+ k (1 + w_c T / (1 - z^-1)) (-reading)."""
        control = self.line.control
        period, tick = control.tension_loop_sample_time_s, control.drive_sample_time_s
        integral = period / (1.0 - np.exp(-self.s * period))
        drives = [d.roller for d in control.drives]
        held = hold_factor(self.s, period, tick)
        for loop in control.tension_pi:
            sensor = next(c for c in cell_sensors(self.line) if c.roller == loop.load_cell)
            sign = sign_of(self.line, loop.acts_on, loop.load_cell, loop.law)
            law = sign * loop.gain_m_s_per_N * (1.0 + loop.corner_rad_s * integral)
            gain = self.torque_per_reference[drives.index(loop.acts_on)]
            self.A[self.line.body(loop.acts_on)] += gain * law * held * self.reading(sensor)
        for travel in control.position_pi:
            assert self.more is not None
            carriage = self.line.carriage(travel.carriage)
            first = self.line.carriages[carriage].rollers[0]
            row = self.line.body(travel.acts_on)
            sign = 1.0 if row < self.line.body(first) else -1.0
            law = sign * travel.gain_m_s_per_m * (1.0 + travel.corner_rad_s * integral)
            gain = self.torque_per_reference[drives.index(travel.acts_on)]
            self.A[row] += gain * law * held * self.more.travel_row(carriage)

    def reading(self, sensor: LoadCell | DriveSpeed | CarriagePosition) -> ComplexArray:
        """Return the row that takes the unknowns to a channel."""
        body = self.line.body(sensor.roller)
        if isinstance(sensor, CarriagePosition):
            assert self.more is not None
            return self.more.travel_row(self.line.carriage_of(sensor.roller))
        row = np.zeros(self.A.shape[0], dtype=np.complex128)
        if isinstance(sensor, DriveSpeed):
            row[body] = sensor.scale_radius_m or 1.0
            return row
        low_pass = 1.0 / (1.0 + self.s / (2.0 * math.pi * sensor.low_pass_Hz))
        return np.asarray(0.5 * low_pass * (self.tensions[body - 1] + self.tensions[body]))

    def solve(self, drive: int, sample_time_s: float) -> ComplexArray:
        """Return the unknowns for a unit correction at ``drive``."""
        control = self.line.control
        b = np.zeros(self.A.shape[0], dtype=np.complex128)
        row = self.line.body(control.drives[drive].roller)
        held = hold_factor(self.s, sample_time_s, control.drive_sample_time_s)
        b[row] = self.torque_per_reference[drive] * held
        return np.asarray(np.linalg.solve(self.A, b), dtype=np.complex128)

    def read(self, sensor: LoadCell | DriveSpeed | CarriagePosition, x: ComplexArray) -> complex:
        """Return the channel's phasor."""
        return complex(self.reading(sensor) @ x)


def _add_bodies(
    A: ComplexArray, line: Declaration, rest: SteadyLine, s: complex, tensions: ComplexArray
) -> None:
    """Add J s w - R (T_down - T_up) + friction slope w = 0 (source 2.9, 2.32)."""
    n, radius = rest.radius_m.size, rest.radius_m
    inertia = inertias_of(line, rest)
    _torque, slope = friction_of(line, rest.speed_m_s / radius)
    for k in range(n):
        A[k, k] += inertia[k] * s + slope[k]
        if k > 0:
            A[k] += radius[k] * tensions[k - 1]
        if k < n - 1:
            A[k] -= radius[k] * tensions[k]


def _add_spans(A: ComplexArray, line: Declaration, rest: SteadyLine, s: complex) -> None:
    """Add the strain balances (source 2.20 corrected), in small signals.

    L s e / (1 + eps) = v_B - v_A (1 + eps)/(1 + up) - V_A/(1 + up) (e - e_up (1 + eps)/(1 + up)).
    """
    n = rest.radius_m.size
    upstream = line.web.wound_in_tension_N / line.web.EA_N
    for i, span in enumerate(line.spans):
        row, strain = n + i, float(rest.strain[i])
        ratio = (1.0 + strain) / (1.0 + upstream)
        carried = rest.speed_m_s[i] / (1.0 + upstream)
        A[row, n + i] += span.length_m * s / (1.0 + strain) + carried
        if i > 0:
            A[row, n + i - 1] -= carried * ratio
        A[row, i + 1] -= rest.radius_m[i + 1]
        A[row, i] += rest.radius_m[i] * ratio
        upstream = strain


def _add_drives(A: ComplexArray, line: Declaration, rest: SteadyLine, s: complex) -> ComplexArray:
    """Add every speed PI and return torque per velocity reference.

    tau = J K (1 + w h / (1 - z^-1)) (v/R - w), held for one tick h (source 2.24).
    """
    tick = line.control.drive_sample_time_s
    shift = 1.0 - np.exp(-s * tick)
    hold = shift / (s * tick)
    inertia = inertias_of(line, rest)
    gains = np.zeros(len(line.control.drives), dtype=np.complex128)
    for d, drive in enumerate(line.control.drives):
        k = line.body(drive.roller)
        corner = drive.K_ref_rad_s / (4.0 * drive.zeta**2)
        law = inertia[k] * drive.K_ref_rad_s * (1.0 + corner * tick / shift)
        A[k, k] += law * hold
        gains[d] = law * hold / rest.radius_m[k]
    return gains
