"""The velocity reference that cancels what a shape does to the web, per metre of deviation."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from aff_runtime.core.bandwidth import Band
from aff_runtime.core.compiled.binary import chosen, holding
from aff_runtime.core.params import IMBALANCE_N_M_PER_M, DriveParams
from aff_runtime.core.phase import RollPhase
from aff_runtime.core.shape.columns import ColumnMap, ColumnState

Complexes = npt.NDArray[np.complex128]
Floats = npt.NDArray[np.float64]
SPEED_TAU_S = 0.3  # time constant of the tracker
ABSURD = 1e4  # no line runs at that speed (m/s), no roll turns at it (rad/s)


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
    the middle term is (z' - c z + c l)/K with the low-pass l = c/(s + c) z, and s/(s + c) q is
    q - c/(s + c) q: two low-passes per column are the only memory.

    Columns: every order of the drive's own roll with both terms, T plus the weight of what sticks
    out (``DriveParams.weight_of_shape_N``) for order 1; one for an imbalance beyond that,
    -(R/(J K)) s/(s + c) q_1, 0.1 N m per millimetre; orders of other rolls with the first term.
    Orders fade out where ``band`` ends: drive or hold give no authority there.
    """

    __slots__ = (
        "_K",
        "_arm",
        "_before",
        "_c",
        "_compiled",
        "_core",
        "_drive",
        "_heaves",
        "_held",
        "_imbalance",
        "_index",
        "_known",
        "_lead_s",
        "_low",
        "_now",
        "_own",
        "_owns",
        "_phases",
        "_pull",
        "_rolls",
        "_span",
        "_track",
        "_turns",
        "_work",
        "b",
        "band",
        "carrier",
        "fade",
        "frequency_Hz",
        "names",
        "omega_rad_s",
        "order",
        "rolls",
        "state",
        "turn_s",
    )

    def __init__(
        self,
        columns: list[tuple[str, int]],
        phases: dict[str, RollPhase],
        drive: DriveParams,
        lead_s: float,
        band: Band,
    ) -> None:
        """Lay out the columns; an imbalance column follows when the drive's roll has order 1."""
        has_imbalance = drive.imbalance and (drive.roll, 1) in columns
        entries = [*columns, (drive.roll, 1)] if has_imbalance else list(columns)
        count = len(entries)
        self.rolls = tuple(dict.fromkeys(roll for roll, _ in entries))
        self.names = [f"{roll}_{n}x" for roll, n in columns] + ["imbalance"] * has_imbalance
        self._phases = [phases[roll] for roll in self.rolls]
        self._own = self.rolls.index(drive.roll)
        self._index = np.array([self.rolls.index(roll) for roll, _ in entries], dtype=np.int64)
        self.order = np.array([float(n) for _, n in entries])
        # per column, 0 or 1: the tension pulls at it; its first term; its weight pulls at it
        self._pull = np.array([float(roll == drive.roll) for roll, _ in entries])
        self._pull *= float(drive.torque_term)
        self._owns = np.ones(count)
        self._imbalance = np.zeros(count)
        if has_imbalance:
            self._owns[-1] = self._pull[-1] = 0.0
            self._imbalance[-1] = IMBALANCE_N_M_PER_M
        self._heaves = self._pull * (self.order == 1.0)
        self._drive = drive
        self._K, self._c = drive.K_ref_rad_s, drive.corner_rad_s
        self._lead_s = lead_s
        self._track = SpeedTrack()
        # angle, omega, first term per metre (real; imaginary per order), s per turn, Hz: per roll
        self._rolls = np.zeros((6, len(self.rolls)))
        self._turns = np.zeros((6, count))
        self._turns[4] = math.inf
        self.state = ColumnState(count)
        self._low = self.state.array("basis.low", dtype=np.complex128, rows=2)
        self._before = self.state.array("basis.before", dtype=np.complex128, rows=2)
        self._now = np.zeros((2, count), dtype=np.complex128)
        self._work = np.zeros((2, count), dtype=np.complex128)
        self._core = np.zeros(count, dtype=np.complex128)
        self._arm = np.zeros(count, dtype=np.complex128)
        self._known = (math.nan, math.nan)
        self.band = band
        self._span = 1.0 / (band.end_Hz - band.full_Hz)
        self.b = self.state.array("basis.b", dtype=np.complex128)
        self.fade = self.state.array("basis.fade")
        self.frequency_Hz = np.zeros(count)
        self.omega_rad_s, self.turn_s = self._turns[1], self._turns[4]
        self.carrier = self._before[1]  # e^{j n theta} at the angle where the output acts
        self._compiled = chosen()
        self._held = holding(
            *(self.order, self._owns, self._index, self._rolls, self._arm, self._turns),
            *(self._low, self._before, self.b, self.fade, self.frequency_Hz),
            np.array([self._K, self._c, lead_s, band.end_Hz, self._span, ABSURD]),
        )

    def step(self, line_speed_m_s: float, tension_N: float, dt_s: float) -> None:
        """Advance to the angles the phases have now; the result is in ``b``, 1/s."""
        K, c = self._K, self._c
        track = self._track
        track.step(line_speed_m_s, dt_s)
        gain = self._torque(tension_N, K)
        if self._compiled is not None:
            self._compiled.basis_step(
                self._held, self._phases, track.speed_m_s, track.slope_m_s2, dt_s
            )
            return
        self._read_rolls(K, c)
        self._turn(gain, math.exp(-c * dt_s), c / K)

    def _turn(self, gain: Complexes, keep: float, c_over_K: float) -> None:
        """Work out every column from its roll's numbers and the torque per metre."""
        turns = self._turns
        np.take(self._rolls, self._index, axis=1, out=turns, mode="clip")
        order, now, work, low = self.order, self._now, self._work, self._low
        np.multiply(order, turns[5], out=self.frequency_Hz)
        np.subtract(self.band.end_Hz, self.frequency_Hz, out=self.fade)
        self.fade *= self._span
        np.maximum(self.fade, 0.0, out=self.fade)
        np.minimum(self.fade, 1.0, out=self.fade)
        np.multiply(order, turns[0], out=work[0].imag)
        work[0].real = 0.0
        np.exp(work[0], out=now[1])
        np.multiply(turns[1], now[1], out=now[0])
        np.add(now, self._before, out=work)
        work *= 0.5 * (1.0 - keep)
        low *= keep
        low += work
        self._before[:] = now
        core = self._core
        np.multiply(self._owns, turns[2], out=core.real)
        np.multiply(order, turns[3], out=core.imag)
        core.imag *= self._owns
        core += gain
        np.multiply(core, now[1], out=self.b)
        np.multiply(self._owns, low[0], out=core)
        core *= c_over_K
        self.b += core
        np.multiply(gain, low[1], out=core)
        self.b -= core
        self.b *= self.fade
        np.negative(self.b, out=self.b)

    def _read_rolls(self, K: float, c: float) -> None:
        """Fill the numbers that every order of a roll shares; an absurd speed counts as none."""
        rolls, track = self._rolls, self._track
        for i, phase in enumerate(self._phases):
            radius = phase.radius_m
            known = radius > 0.0
            omega = track.speed_m_s / radius if known else phase.omega_rad_s
            acts_at = phase.theta_rad + phase.omega_rad_s * self._lead_s
            alpha = track.slope_m_s2 / radius if known else 0.0
            if abs(omega) < ABSURD and math.isfinite(acts_at):
                angle = math.remainder(acts_at, math.tau)
            else:
                angle = omega = 0.0
            size = abs(omega)
            rolls[:, i] = (
                angle,
                omega,
                omega - (c * omega - alpha) / K,
                omega * omega / K,
                math.tau / max(size, 1e-6),
                size / math.tau,
            )

    def _torque(self, tension_N: float, K: float) -> Complexes:
        """Return R/(J K) times a metre's torque per column, s.

        T, with the weight of what sticks out for order 1; 0.1 N m per millimetre of an imbalance.
        """
        radius = self._phases[self._own].radius_m
        if (radius, tension_N) != self._known:
            self._known = (radius, tension_N)
            arm = radius / (self._drive.inertia_at(radius) * K) if radius > 0.0 else 0.0
            weight_N = self._drive.weight_of_shape_N(radius) if radius > 0.0 else 0j
            self._arm[:] = tension_N * self._pull + self._imbalance + weight_N * self._heaves
            self._arm *= arm
        return self._arm

    @property
    def imbalance_pair(self) -> tuple[int, int]:
        """Columns of the own roll's order 1 and of its imbalance; (-1, -1) without one."""
        if not self._imbalance.any():
            return -1, -1
        first = next(
            i for i, o in enumerate(self.order) if o == 1.0 and self._index[i] == self._own
        )
        return first, self.order.size - 1

    def restart(self) -> None:
        """Forget the filters."""
        self._low[:] = 0.0
        self._before[:] = 0.0
        self.b[:] = 0.0
        self._track = SpeedTrack()

    def adopt(self, old: ShapeBasis, both: ColumnMap) -> None:
        """Go on with every array per column, and with how fast the rolls of ``old`` turn.

        A new order of a known roll has its speed, too.
        """
        self.state.adopt(old.state, both)
        self._track = old._track
        for i, roll in enumerate(self.rolls):
            if roll in old.rolls:
                self._rolls[:, i] = old._rolls[:, old.rolls.index(roll)]
                mine = np.flatnonzero(self._index == i)
                self._turns[:, mine] = self._rolls[:, i : i + 1]
                self.frequency_Hz[mine] = self.order[mine] * self._turns[5, mine]
