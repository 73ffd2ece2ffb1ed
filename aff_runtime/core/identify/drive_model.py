"""Two balances that a probe's phasors obey: of the roll's torque and of the web's length."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from aff_runtime.core.identify.phasors import Phasors
from aff_runtime.core.identify.regression import SIDES
from aff_runtime.core.identify.web_chain import WebChain, seen_from_the_far_end

Floats = npt.NDArray[np.float64]
Complexes = npt.NDArray[np.complex128]
BALANCES = 2


@dataclass(frozen=True, slots=True, kw_only=True)
class Unknown:
    """One number to be found: its usual size, and how far off that it may be.

    ``is_log``: above zero, found as its logarithm; ``spread`` is then that of the logarithm.
    """

    name: str
    usual: float
    spread: float
    is_log: bool = True

    @property
    def start(self) -> float:
        """Return the usual size as it is searched."""
        return math.log(self.usual) if self.is_log else self.usual


UNKNOWNS = (
    Unknown(name="gain_rad_s", usual=20.0, spread=2.0),
    Unknown(name="corner_rad_s", usual=5.0, spread=2.0),
    Unknown(name="pull_per_kg", usual=0.1, spread=3.0),
    Unknown(name="friction_rad_s", usual=0.0, spread=0.2, is_log=False),
    Unknown(name="delay_s", usual=0.02, spread=0.1, is_log=False),
    Unknown(name="lag_s", usual=0.0007, spread=0.0007, is_log=False),
    Unknown(name="loop_gain_m_s_N", usual=2e-3, spread=3.0),
    Unknown(name="loop_corner_rad_s", usual=5.0, spread=1.5),
    Unknown(name="loop_later_s", usual=0.0, spread=0.03, is_log=False),
    Unknown(name="stiffness_N_m", usual=2e3, spread=3.0),
    Unknown(name="mass_kg", usual=6.0, spread=1.5),
    Unknown(name="loss_s", usual=0.002, spread=0.005, is_log=False),
    Unknown(name="cell_s", usual=0.01, spread=0.03, is_log=False),
    Unknown(name="renewal_rad_s", usual=0.2, spread=0.2, is_log=False),
    Unknown(name="drag_rad_s", usual=0.1, spread=0.2, is_log=False),
)
NAMES = tuple(unknown.name for unknown in UNKNOWNS)
"""Of the numbers that every path has; those of its idlers and spans come behind them."""
_COMMON = len(UNKNOWNS)
_LOG = np.array([unknown.is_log for unknown in UNKNOWNS])
MASS_SPREAD = 0.35
"""Of the logarithm: how unlike the idlers of one path are."""
LENGTHS = {"last": (1.0, 0.5), "between": (1.0, 0.35), "first": (1.5, 0.5)}
"""Span lengths over that of a usual one, and the spread of their logarithm."""


def _sized(found: Floats) -> Floats:
    """Return the common unknowns in their own units."""
    common = found[..., :_COMMON]
    return np.where(_LOG, np.exp(np.where(_LOG, common, 0.0)), common)


def sizes(found: Floats) -> dict[str, float]:
    """Return one set of common unknowns by name, in their own units."""
    return dict(zip(NAMES, map(float, _sized(found)), strict=True))


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveModel:
    r"""The balances of a roll whose correction is added to its speed reference.

    Derivation, small signals at s = j omega. The drive's torque J K (1 + c/s)(v/r - w) and the
    web's pull turn the roll (source 2.24, 4.37); v is the correction U as it arrives, plus that of
    a tension loop a (1 + d/s) on the tension, its set point at rest. With V = r w:

        s V = K (1 + c/s) (U e^{-s tau} h + a (1 + d/s) e^{-s tau'} T_cell - V) + (r^2/J) T_roll
              - (b/J) V

    h holds a correction for one cycle, whose half is in tau; the V that the drive reads acts a
    sample of its own late (``lag_s``). The web's length is

        V = A T_end + B V_end                                        (``web_chain``)

    with V_end the measured line speed: of the driven roller that ends this zone. T_cell
    is the reading with the lag of its amplifier taken out; it gives T_end, and that T_roll. Only
    ``pull_per_kg`` = r^2/J has a mass in it, so inertia is known as well as the tension is.

    What is measured (V, T, V_end) has noise, U has none; a balance is weighed by what the noise of
    all that enters it makes of it.

    Attributes
    ----------
    idlers, cell : of the web path, see ``web_chain``. Its idlers and spans are not alike: the
        logarithm of every mass and length is an unknown of its own.
    as_torque : the correction enters as a torque behind the speed loop instead.
    """

    phasors: Phasors
    cycle_s: float
    idlers: int
    cell: int
    as_torque: bool = False

    def up_to(self, frequency_Hz: float) -> DriveModel:
        """Return the same model on the tones below a frequency."""
        return replace(self, phasors=self.phasors.below(frequency_Hz))

    @property
    def numbers(self) -> int:
        """How many real numbers the balances have to explain."""
        return 2 * BALANCES * self.phasors.omega_rad_s.size

    def balances(self, found: Floats) -> tuple[Complexes, Complexes]:
        """Return (variants, tones, 2, 3) on what is seen, (variants, tones, 2) of what was sent.

        Parameters
        ----------
        found : (variants, unknowns).
        """
        p = {name: column[:, None] for name, column in zip(NAMES, _sized(found).T, strict=True)}
        omega = self.phasors.omega_rad_s
        s = np.asarray(1j * omega, dtype=np.complex128)
        masses, lengths = np.split(np.exp(found[:, _COMMON:]), [self.idlers], axis=1)
        chain = WebChain(
            stiffness_N_m=p["stiffness_N_m"],
            loss_s=p["loss_s"],
            renewal_rad_s=p["renewal_rad_s"],
            drag_rad_s=p["drag_rad_s"],
            masses_kg=p["mass_kg"] / self.idlers * masses,
            lengths=lengths,
        )
        web = seen_from_the_far_end(chain, s, self.cell)
        by_cell = (1.0 + s * p["cell_s"]) / web.cell_tension[0]
        by_end = -web.cell_tension[1] / web.cell_tension[0]
        speed_loop = p["gain_rad_s"] * (1.0 + p["corner_rad_s"] / s)
        tension_loop = p["loop_gain_m_s_N"] * (1.0 + p["loop_corner_rad_s"] / s)
        tension_loop = tension_loop * np.exp(-s * (p["delay_s"] + p["loop_later_s"]))
        pull = p["pull_per_kg"] * web.roll_tension
        on_seen = np.zeros((len(found), omega.size, BALANCES, 3), dtype=np.complex128)
        on_seen[..., 0, 0] = s + speed_loop * np.exp(-s * p["lag_s"]) + p["friction_rad_s"]
        on_seen[..., 0, 1] = -speed_loop * tension_loop - pull[0] * by_cell
        on_seen[..., 0, 2] = -pull[1] - pull[0] * by_end
        on_seen[..., 1, 0] = 1.0
        on_seen[..., 1, 1] = -web.roll_speed[0] * by_cell
        on_seen[..., 1, 2] = -web.roll_speed[1] - web.roll_speed[0] * by_end
        sent = np.zeros((len(found), omega.size, BALANCES), dtype=np.complex128)
        held = np.sinc(omega * self.cycle_s / math.tau)
        enters = p["gain_rad_s"] if self.as_torque else speed_loop
        sent[..., 0] = enters * self.phasors.sent * held * np.exp(-s * p["delay_s"])
        return on_seen, sent

    def residual(self, found: Floats) -> Floats:
        """Return what the balances leave over its standard error, (variants, numbers).

        The noise is known from a few places beside each tone; that makes its inverse too large by
        SIDES / (SIDES - balances) in the mean, which is taken out.
        """
        on_seen, sent = self.balances(found)
        left = (on_seen @ self.phasors.seen[:, :, None])[..., 0] - sent
        noise = on_seen @ self.phasors.noise @ on_seen.conj().swapaxes(-1, -2)
        white = np.linalg.solve(np.linalg.cholesky(noise), left[..., None])
        white = white.reshape(len(found), -1) * math.sqrt(2.0 * (SIDES - BALANCES) / SIDES)
        return np.concatenate([white.real, white.imag], axis=1)

    def all_residuals(self, found: Floats) -> Floats:
        """Return ``residual`` and how far the unknowns are from what is usual."""
        usual, spread = self.usual
        return np.concatenate([self.residual(found), (found - usual) / spread], axis=1)

    @property
    def usual(self) -> tuple[Floats, Floats]:
        """Return what is usual of every unknown, where a search begins, and its spread."""
        spans = [LENGTHS["last"], *[LENGTHS["between"]] * (self.idlers - 1), LENGTHS["first"]]
        usual = [*(one.start for one in UNKNOWNS), *[0.0] * self.idlers]
        spread = [*(one.spread for one in UNKNOWNS), *[MASS_SPREAD] * self.idlers]
        return (
            np.array([*usual, *(math.log(length) for length, _ in spans)]),
            np.array([*spread, *(width for _, width in spans)]),
        )
