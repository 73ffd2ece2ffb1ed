"""From phasors to the drive's numbers: which tones, which web path, how sure."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from aff_runtime.base.confidence import TWO_SIDED_95
from aff_runtime.base.errors import RefusedError
from aff_runtime.core.identified import Estimate, IdentifiedDrive
from aff_runtime.core.identify.drive_model import BALANCES, NAMES, DriveModel, sizes
from aff_runtime.core.identify.phasors import Phasors
from aff_runtime.core.identify.search import Minimum, least_squares

Floats = npt.NDArray[np.float64]
BANDS_Hz = (12.0, 9.0, 7.0, 5.0, 3.5)
PATHS = ((9, 1), (4, 1), (9, 2), (4, 2), (9, 5))
"""Idlers and place of the load cell; the first one leads the search."""
FEWEST_TONES = 10
CLEAR = 3.0
"""A tone counts whose speed and tension are this many standard errors."""
STRANGE, MOST_STRANGE = 30.0, 0.2
"""What one tone may add to the sum of squares, and the share of tones that may be left out."""
ODD = 3.0
"""Standard deviations of chi squared that a band's fit may be off by."""
WORST_MISFIT = 4.0
STRUCTURE = {
    "gain_rad_s": 0.012,
    "corner_rad_s": 0.012,
    "pull_per_kg": 0.015,
    "stiffness_N_m": 0.015,
    "delay_s": 0.0003,
}
"""What a web path that is none of these leaves wrong where no noise is left: one standard error,
as a share (a delay: in s). So large is what the fit misses of twelve drawn lines (seeds 0 to 11)
when it is given their exact phasors; stiffness counts the strain that the web runs with."""
STARTS = tuple((gain, delay_s) for gain in (7.0, 18.0, 45.0) for delay_s in (0.012, 0.05))
"""Speed gain (rad/s) and delay: where a search begins, in the narrowest band."""
TORQUE_BY = 20.0
"""How much better, in the sum of squares, the torque's path must fit to be believed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Fitted:
    """One path of the web, fitted."""

    model: DriveModel
    minimum: Minimum

    @property
    def misfit(self) -> float:
        """Return chi squared per degree of freedom."""
        left = self.model.residual(self.minimum.at[None, :])[0]
        return float(left @ left) / self.degrees

    def by_tone(self) -> Floats:
        """Return what each tone adds to the sum of squares."""
        left = self.model.residual(self.minimum.at[None, :])[0]
        return np.asarray((left.reshape(2, -1, BALANCES) ** 2).sum(axis=(0, 2)))

    @property
    def degrees(self) -> float:
        """Return how many numbers are explained beyond those that are found from them."""
        spread = self.model.usual[1]
        told = spread.size - float((np.diag(self.minimum.covariance) / spread**2).sum())
        return max(1.0, self.model.numbers - told)


def fit_drive(phasors: Phasors, *, cycle_s: float, roll: str, radius_m: float) -> IdentifiedDrive:
    """Return the drive's numbers.

    The signals of ``phasors`` are the roll's surface speed (m/s), the tension (N) and the line
    speed (m/s). How many idlers the web passes is not known: several paths are fitted, and each
    counts as much as its fit is likely. The widest band counts in which one of them fits as well
    as noise lets it; a misfit that is left widens the intervals.

    Raises
    ------
    RefusedError
        When too few tones are heard, the web pulls the other way, the correction acts as a
        torque, or no path fits.
    """
    heard = _heard(phasors)
    if heard.below(BANDS_Hz[0]).omega_rad_s.size < FEWEST_TONES:
        raise RefusedError(_too_few(phasors))
    _refuse_other_way(heard)
    fits = _fit_bands(heard, cycle_s)
    best = fits[0]
    _refuse_torque(best)
    if best.misfit > WORST_MISFIT:
        raise RefusedError(
            f"no simple web path explains what was heard (misfit {best.misfit:.1f}, at most "
            f"{WORST_MISFIT:g}): is line.speed that of the driven roller that ends this zone, "
            "and the tension this zone's? If so, probe again at a steady speed, or declare the "
            "drive"
        )
    return _numbers(fits, roll, radius_m)


def _fit_bands(heard: Phasors, cycle_s: float) -> Sequence[_Fitted]:
    """Return the fits of the widest band that noise explains, else those with the least misfit.

    The search begins in the narrowest band, where no phase has turned far, and takes what it
    finds into the next one: in the widest, a delay that is off by a turn is a minimum too.
    """
    leads: list[tuple[Phasors, Floats]] = []
    for band_Hz in reversed(BANDS_Hz):
        narrow = heard.below(band_Hz)
        if narrow.omega_rad_s.size < FEWEST_TONES:
            continue
        if not leads or narrow.omega_rad_s.size > leads[-1][0].omega_rad_s.size:
            model = DriveModel(
                phasors=narrow, cycle_s=cycle_s, idlers=PATHS[0][0], cell=PATHS[0][1]
            )
            starts = [leads[-1][1]] if leads else [_begin(model, *start) for start in STARTS]
            leads.append((narrow, _least(model, starts).at))
    chosen: Sequence[_Fitted] = ()
    for narrow, lead in reversed(leads):
        fits = _fit_sound(narrow, cycle_s, lead)
        if not chosen or fits[0].misfit < chosen[0].misfit:
            chosen = fits
        if _is_likely(fits[0]):
            break
    return chosen


def _heard(phasors: Phasors) -> Phasors:
    """Return the tones that stand out of the noise in the roll's speed and in the tension."""
    return phasors.only(np.asarray(_clear(phasors).all(axis=1)))


def _clear(phasors: Phasors) -> npt.NDArray[np.bool_]:
    """Return which tones stand out of the noise, (tones, 2): in the roll's speed, the tension."""
    noise = np.sqrt(np.einsum("kii->ki", phasors.noise).real)
    return np.asarray(np.abs(phasors.seen[:, :2]) > CLEAR * noise[:, :2])


def _too_few(phasors: Phasors) -> str:
    """Return how many tones are heard and are needed, and which signal they are lacking in."""
    clear = _clear(phasors.below(BANDS_Hz[0]))
    if len(clear) < FEWEST_TONES:
        return (
            f"{len(clear)} tones were sent below {BANDS_Hz[0]:g} Hz, {FEWEST_TONES} are needed, "
            f"and no louder ones help: name {FEWEST_TONES - len(clear)} more frequencies or more "
            f"below {BANDS_Hz[0]:g} Hz, away from orders, under probe.extra_frequencies_Hz, or "
            "probe at a lower line speed"
        )
    speed, tension = clear.sum(axis=0)
    both = clear.all(axis=1).sum()
    return (
        f"{both} of {len(clear)} tones below {BANDS_Hz[0]:g} Hz are {CLEAR:g} standard errors "
        f"above the noise in speed and tension, {FEWEST_TONES} are needed (in the roll's speed "
        f"{speed}, in the tension {tension}): raise probe.amplitude_m_s, or probe.bound_m_s where "
        "it is chosen, or probe.duration_s"
    )


def _refuse_other_way(heard: Phasors) -> None:
    """Refuse a web that pulls less when the roll slows: it comes to the roll, or a sign is off."""
    slow = heard.below(3.0)
    if slow.omega_rad_s.size == 0:
        return
    rate = 1j * slow.omega_rad_s * slow.seen[:, 1] / (slow.seen[:, 0] - slow.seen[:, 2])
    if float(np.median(rate.real)) >= 0.0:
        raise RefusedError(
            "the tension rises when the roll turns faster: this is known for a roll that the web "
            "leaves; on one that winds up, or with a wrong sign, declare the drive"
        )


def _begin(model: DriveModel, gain_rad_s: float, delay_s: float) -> Floats:
    start = model.usual[0]
    start[NAMES.index("gain_rad_s")] = math.log(gain_rad_s)
    start[NAMES.index("delay_s")] = delay_s
    return start


def _least(model: DriveModel, starts: Iterable[Floats]) -> Minimum:
    minima = [least_squares(model.all_residuals, start) for start in starts]
    return min(minima, key=lambda one: one.cost)


def _fit_paths(phasors: Phasors, cycle_s: float, lead: Floats) -> list[_Fitted]:
    """Return the fit of every path, the likeliest first.

    Parameters
    ----------
    lead : where the search of the first path begins; the numbers that all have begin there too.
    """
    fits: list[_Fitted] = []
    for idlers, cell in PATHS:
        model = DriveModel(phasors=phasors, cycle_s=cycle_s, idlers=idlers, cell=cell)
        start = model.usual[0]
        start[: len(NAMES)] = lead[: len(NAMES)]
        starts = [start] if fits else [lead]
        fits.append(_Fitted(model=model, minimum=_least(model, starts)))
    return sorted(fits, key=lambda one: one.minimum.cost)


def _fit_sound(phasors: Phasors, cycle_s: float, lead: Floats) -> list[_Fitted]:
    """Return fits without tones that no path explains: ripple swept over them."""
    spared = int(MOST_STRANGE * phasors.omega_rad_s.size)
    fits = _fit_paths(phasors, cycle_s, lead)
    for _ in range(spared):
        best = fits[0]
        worst = best.by_tone()
        if worst.max() < STRANGE * max(1.0, float(np.median(worst)) / 4.0):
            break
        kept = np.arange(worst.size) != int(worst.argmax())
        phasors = phasors.only(kept)
        same = next(one for one in fits if one.model.idlers == PATHS[0][0])
        fits = _fit_paths(phasors, cycle_s, same.minimum.at)
    return fits


def _is_likely(fitted: _Fitted) -> bool:
    """Return whether noise alone leaves as much now and then."""
    return fitted.misfit < 1.0 + ODD * math.sqrt(2.0 / max(1, fitted.degrees))


def _refuse_torque(best: _Fitted) -> None:
    """Refuse a correction that acts behind the speed loop: the law needs it before."""
    model = replace(best.model, as_torque=True)
    torque = least_squares(model.all_residuals, best.minimum.at)
    if torque.cost < best.minimum.cost - TORQUE_BY:
        raise RefusedError(
            "the correction acts on the roll as a torque, not as a speed: it goes in behind the "
            "speed loop; wire it to the speed reference, behind the ramp"
        )


def _numbers(fits: Sequence[_Fitted], roll: str, radius_m: float) -> IdentifiedDrive:
    """Return means over the paths, and intervals that hold their differences too."""
    misfit = max(1.0, fits[0].misfit)
    least = fits[0].minimum.cost
    weight = np.array([math.exp(-0.5 * (one.minimum.cost - least) / misfit) for one in fits])
    weight /= weight.sum()
    common = len(NAMES)
    at = np.array([one.minimum.at[:common] for one in fits])
    own = np.array([np.diag(one.minimum.covariance)[:common] for one in fits]) * misfit
    mean = weight @ at
    structure = np.array([STRUCTURE.get(name, 0.0) for name in NAMES])
    spread = np.sqrt(weight @ (own + (at - mean) ** 2) + structure**2)
    value, low, high = (sizes(mean + side * TWO_SIDED_95 * spread) for side in (0.0, -1.0, 1.0))

    def of(name: str) -> Estimate:
        return Estimate(value=value[name], low=low[name], high=high[name])

    pull, corner = of("pull_per_kg"), of("corner_rad_s")
    square_m2 = radius_m**2
    inertia = Estimate(
        value=square_m2 / pull.value, low=square_m2 / pull.high, high=square_m2 / pull.low
    )
    model = fits[0].model
    friction = of("friction_rad_s")
    by = inertia.value
    return IdentifiedDrive(
        roll=roll,
        radius_m=radius_m,
        speed_gain_rad_s=of("gain_rad_s"),
        integral_time_s=Estimate(
            value=1.0 / corner.value, low=1.0 / corner.high, high=1.0 / corner.low
        ),
        inertia_kg_m2=inertia,
        friction_N_m_s=Estimate(
            value=by * friction.value, low=by * friction.low, high=by * friction.high
        ),
        delay_s=_less_half_a_cycle(of("delay_s"), model.cycle_s),
        stiffness_N_m=of("stiffness_N_m"),
        misfit=fits[0].misfit,
        band_Hz=float(model.phasors.omega_rad_s[-1]) / math.tau,
        tones=model.phasors.omega_rad_s.size,
    )


def _less_half_a_cycle(found: Estimate, cycle_s: float) -> Estimate:
    """Return the way to the drive without the half cycle by which holding a value is late."""
    return Estimate(
        value=found.value - 0.5 * cycle_s,
        low=found.low - 0.5 * cycle_s,
        high=found.high - 0.5 * cycle_s,
    )
