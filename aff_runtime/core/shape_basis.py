"""What a shape does to the web, turned round: the velocity reference per metre of deviation."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from aff_runtime.core.params import DriveParams
from aff_runtime.core.phase import RollPhase

Complexes = npt.NDArray[np.complex128]
Floats = npt.NDArray[np.float64]
FADE_FROM_HZ, FADE_TO_HZ = 17.0, 19.0
SPEED_TAU_S = 0.3
ABSURD = 1e4  # no line runs at that speed (m/s), no roll turns at it (rad/s)
IMBALANCE_N_M_PER_M = 100.0


class SpeedTrack:
    """Line speed and its slope: a critically damped tracker, no lag behind a ramp."""

    __slots__ = ("_seeded", "slope_m_s2", "speed_m_s")

    def __init__(self) -> None:
        self.speed_m_s = 0.0
        self.slope_m_s2 = 0.0
        self._seeded = False

    def step(self, measured_m_s: float, dt_s: float) -> None:
        """Take one reading; a missing one is predicted."""
        self.speed_m_s += self.slope_m_s2 * dt_s
        if not abs(measured_m_s) < ABSURD:
            return
        if not self._seeded:
            self.speed_m_s = measured_m_s
            self._seeded = True
            return
        keep = math.exp(-dt_s / SPEED_TAU_S)
        miss = measured_m_s - self.speed_m_s
        self.speed_m_s += (1.0 - keep * keep) * miss
        self.slope_m_s2 += (1.0 - keep) ** 2 * miss / dt_s


class ShapeBasis:
    r"""b_n: the velocity reference that cancels one metre of deviation of order n.

    Derivation. A roll of mean radius R with moment arm R + p, p = Re W q, q = e^{j n theta}, lets
    out web at (R + p) w and its drive obeys J w' = J K (1 + c/s)(v/R - w) + T p, c = K/(4 zeta^2)
    (source 2.24 and 4.37 with the moment arm). The web sees no ripple when w = w0 (1 - p/R); then

        v = -[ z + s^2/(K (s + c)) z + (R T/(J K)) s/(s + c) q ],    z = w0 q

    per metre of W: length rate through the velocity loop, and the torque that the tension puts on
    the roll through the varying arm, which does not grow with speed. With z' = w0' q + j n w0 z
    the middle term is (z' - c z + c^2/(s + c) z)/K, so one low-pass per column is the only memory.

    Columns: every order of the drive's own roll with both terms; one for an imbalance of it,
    -(R/(J K)) s/(s + c) q_1, 0.1 N m per millimetre; orders of other rolls with the first term.
    Orders fade out between 17 and 19 Hz, where the loop gives no authority.
    """

    __slots__ = (
        "_before", "_drive", "_index", "_lead_s", "_low", "_owns", "_phases", "_pull", "_track",
        "b", "fade", "frequency_Hz", "names", "omega_rad_s", "order", "rolls", "turn_s",
    )  # fmt: skip

    def __init__(
        self,
        columns: list[tuple[str, int]],
        phases: dict[str, RollPhase],
        drive: DriveParams,
        lead_s: float,
    ) -> None:
        """Lay out the columns; an imbalance column follows when the drive's roll has order 1."""
        heavy = drive.imbalance and (drive.roll, 1) in columns
        entries = [*columns, (drive.roll, 1)] if heavy else list(columns)
        self.rolls = tuple(dict.fromkeys(roll for roll, _ in entries))
        self.names = [f"{roll}_{n}x" for roll, n in columns] + ["imbalance"] * heavy
        self._phases = [phases[roll] for roll in self.rolls]
        self._index = np.array([self.rolls.index(roll) for roll, _ in entries])
        self.order = np.array([float(n) for _, n in entries])
        own = np.array([float(roll == drive.roll) for roll, _ in entries])
        self._owns = np.ones(len(entries))
        self._pull = own * float(drive.torque_term)
        if heavy:
            self._owns[-1] = 0.0
            self._pull[-1] = 1.0
        self._drive = drive
        self._lead_s = lead_s
        self._track = SpeedTrack()
        self._low = np.zeros((2, len(entries)), dtype=np.complex128)
        self._before = np.zeros((2, len(entries)), dtype=np.complex128)
        self.b = np.zeros(len(entries), dtype=np.complex128)
        self.fade = np.zeros(len(entries))
        self.frequency_Hz = np.zeros(len(entries))
        self.omega_rad_s = np.zeros(len(entries))
        self.turn_s = np.full(len(entries), math.inf)

    def step(self, line_speed_m_s: float, tension_N: float, dt_s: float) -> None:
        """Advance to the angles the phases have now; the result is in ``b``, 1/s."""
        drive = self._drive
        self._track.step(line_speed_m_s, dt_s)
        angle, omega, alpha = [], [], []
        for phase in self._phases:
            radius = phase.radius_m
            turning = self._track.speed_m_s / radius if radius > 0.0 else phase.omega_rad_s
            acts_at = phase.theta_rad + phase.omega_rad_s * self._lead_s
            believable = abs(turning) < ABSURD and math.isfinite(acts_at)
            angle.append(math.remainder(acts_at, math.tau) if believable else 0.0)
            omega.append(turning if believable else 0.0)
            alpha.append(self._track.slope_m_s2 / radius if radius > 0.0 else 0.0)
        at = self._index
        turns = np.array([angle, omega, alpha])[:, at]
        order = self.order
        self.omega_rad_s = turns[1]
        self.frequency_Hz = np.abs(order * turns[1]) * (1.0 / math.tau)
        self.turn_s = math.tau / np.maximum(np.abs(turns[1]), 1e-6)
        room = (FADE_TO_HZ - self.frequency_Hz) * (1.0 / (FADE_TO_HZ - FADE_FROM_HZ))
        self.fade = np.minimum(1.0, np.maximum(0.0, room))
        q = np.exp(1j * (order * turns[0]))
        z = turns[1] * q
        K, c = drive.K_ref_rad_s, drive.corner_rad_s
        now = np.array([z, q])
        keep = math.exp(-c * dt_s)
        self._low = keep * self._low + (0.5 * (1.0 - keep)) * (now + self._before)
        self._before = now
        slope = turns[2] * q + 1j * (order * turns[1]) * z
        first = z + (slope - c * (z - self._low[0])) / K
        own = self._phases[self.rolls.index(drive.roll)].radius_m
        arm = own / (drive.inertia_at(own) * K) if own > 0.0 else 0.0
        gain = np.where(self._owns > 0.0, tension_N, IMBALANCE_N_M_PER_M) * self._pull * arm
        self.b = -self.fade * (self._owns * first + gain * (q - self._low[1]))

    def restart(self) -> None:
        """Forget the filters."""
        self._low[:] = 0.0
        self._before[:] = 0.0
        self.b = np.zeros_like(self.b)
        self._track = SpeedTrack()

    def adopt(self, old: ShapeBasis) -> None:
        """Go on from the filters of ``old``, which has the same columns."""
        self._low, self._before, self._track = old._low, old._before, old._track
        self.b, self.fade, self.frequency_Hz = old.b, old.fade, old.frequency_Hz
        self.omega_rad_s, self.turn_s = old.omega_rad_s, old.turn_s
