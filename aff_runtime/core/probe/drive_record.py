"""What a probe writes down of one drive beside the response, and what becomes of it."""

from __future__ import annotations

import math
from array import array
from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from aff_runtime.base.channel_units import unit_of_channel
from aff_runtime.base.errors import RefusedError
from aff_runtime.core.identified import IdentifiedDrive
from aff_runtime.core.identify.drive_fit import fit_drive
from aff_runtime.core.identify.phasors import read_phasors
from aff_runtime.core.params import ActuatorParams, OutputKind, RollParams, SiteParams
from aff_runtime.core.phase import RollPhase, Source
from aff_runtime.core.probe.estimate import FIRST_TONE, Fit, Tone

OWN_MOTION = (Source.ENCODER, Source.ROLL_SPEED)
STRANGE_SHARE = 0.02
"""Of the readings, for which line speed over radius may stand in for the roll's own motion."""


class DriveRecord:
    """The angle and radius of the roll that a drive turns, and the line speed, sample by sample.

    Parameters
    ----------
    actuator : whose drive; of a roll that the web leaves, or nothing is found.
    """

    def __init__(
        self,
        site: SiteParams,
        actuator: ActuatorParams,
        phases: Mapping[str, RollPhase],
        samples: int,
    ) -> None:
        self._actuator = actuator
        self._roll: RollParams | None = next(
            (roll for roll in site.rolls if roll.name == actuator.turned_roll), None
        )
        self._phase = phases.get(actuator.turned_roll)
        self._cycle_s = site.cycle_s
        known = site.line_speed in site.channels
        self._line_speed = site.channels.index(site.line_speed or "") if known else -1
        self._theta = array("d", [math.nan]) * samples
        self._speed = array("d", [math.nan]) * samples
        self._radius_m = math.nan
        self._readings = self._foreign = 0

    def take(self, k: int, values: Sequence[float]) -> None:
        """Write down one fresh snapshot as sample ``k``."""
        if self._phase is None:
            return
        self._theta[k] = self._phase.theta_rad
        self._speed[k] = values[self._line_speed] if self._line_speed >= 0 else math.nan
        self._readings += 1
        self._foreign += self._phase.source not in OWN_MOTION
        if 2 * k <= len(self._theta):
            self._radius_m = self._phase.radius_m

    def identified(
        self,
        *,
        time_s: npt.NDArray[np.float64],
        keep: npt.NDArray[np.bool_],
        signal: npt.NDArray[np.float64],
        fit: Fit,
        sent: Sequence[Tone],
    ) -> tuple[IdentifiedDrive | None, str]:
        """Return the drive's numbers, or why there are none.

        Parameters
        ----------
        time_s, signal, keep : of every sample, and which of them ``fit`` used.
        """
        try:
            self._refuse_unseen(keep)
            phasors = read_phasors(
                time_s[keep],
                np.column_stack(
                    [np.asarray(self._theta)[keep], signal[keep], np.asarray(self._speed)[keep]]
                ),
                fit.design,
                [(tone.omega_rad_s, tone.phase_rad, tone.amplitude) for tone in sent],
                FIRST_TONE,
            )
            return (
                fit_drive(
                    phasors.scaled((self._radius_m, 1.0, 1.0), (1, 0, 0)),
                    cycle_s=self._cycle_s,
                    roll=self._actuator.turned_roll,
                    radius_m=self._radius_m,
                ),
                "",
            )
        except RefusedError as error:
            return None, str(error)
        except np.linalg.LinAlgError:
            return None, "the tones do not suffice for a fit; raise probe.duration_s"

    def _refuse_unseen(self, keep: npt.NDArray[np.bool_]) -> None:
        """Refuse where the balances lack a signal; each refusal says which.

        Raises
        ------
        RefusedError
            With what cannot be known and what to do.
        """
        actuator, roll = self._actuator, self._roll
        if actuator.output is not OutputKind.VELOCITY_REFERENCE:
            raise RefusedError(
                "a torque goes in behind the speed loop, which law shape does not correct"
            )
        if unit_of_channel(actuator.signal) != "N":
            raise RefusedError(
                f"{actuator.signal} is no tension: without a force no inertia is known"
            )
        if roll is None or roll.radius is None:
            raise RefusedError(
                f"{actuator.turned_roll} has no radius channel: on a roller the web pulls on both "
                "sides, and one tension does not tell its inertia; declare the drive"
            )
        if roll.angle is None and roll.speed is None:
            raise RefusedError(
                f"{roll.name} has no angle and no speed channel: what it does with a correction "
                "is not seen, so neither its speed loop nor its inertia is known; give it one, or "
                "declare the drive"
            )
        if self._foreign > STRANGE_SHARE * self._readings:
            share = self._foreign / self._readings
            raise RefusedError(
                f"the angle of {roll.name} was lost in {share:.1%} of the readings, "
                f"{STRANGE_SHARE:.0%} may be; look at its encoder, then probe again"
            )
        missing = ~np.isfinite(np.asarray(self._theta)) | ~np.isfinite(np.asarray(self._speed))
        if not self._radius_m > 0.0:
            raise RefusedError(
                f"{roll.radius} was no radius above 0 m; look at that channel, then probe again"
            )
        if bool(missing[keep].any()):
            raise RefusedError(
                f"line speed or angle was missing in {missing[keep].sum()} of {keep.sum()} "
                "readings, none may be; look at those channels, then probe again"
            )
